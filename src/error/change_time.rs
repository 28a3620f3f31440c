//! The check of the instant of a change.

use crate::error::{Error, MAX_MAGNITUDE};

/// Checks the instant at which a plan or an orientation is to change, s.
///
/// # Errors
///
/// [`Error::ChangeTime`].
pub(crate) fn check_change_time(from: f64) -> Result<(), Error> {
    if from.abs() <= MAX_MAGNITUDE {
        Ok(())
    } else {
        Err(Error::ChangeTime { time: from })
    }
}
