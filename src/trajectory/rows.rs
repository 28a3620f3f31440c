//! From rows of a table, a body's together, to trajectories.

use super::{State, Trajectory};
use crate::error::Error;
use std::collections::HashSet;

/// Builds one trajectory from each body's rows: `(body, state)`, a body's rows together and in
/// the order of time, as in the files that the `screen` example reads.
///
/// The result is in the order of the rows.
///
/// # Errors
///
/// [`Error::InBody`] with the body and, within, [`Error::RowsApart`] or what
/// [`Trajectory::from_states`] says of its states. A body with a single row that comes again later,
/// as in a table in the order of time, has its rows apart; it is not too short.
pub fn trajectories_from_rows(
    rows: impl IntoIterator<Item = (u64, State)>,
) -> Result<Vec<(u64, Trajectory)>, Error> {
    let mut bodies = Vec::new();
    let mut seen = HashSet::new();
    let mut states: Vec<State> = Vec::new();
    let mut current: Option<u64> = None;
    let mut rows = rows.into_iter().enumerate();
    while let Some((row, (body, state))) = rows.next() {
        if current != Some(body) {
            if !seen.insert(body) {
                return Err(Error::RowsApart { row }.in_body(body));
            }
            if let Some(previous) = current.replace(body) {
                if states.len() < 2
                    && let Some((row, _)) = rows.find(|&(_, (later, _))| later == previous)
                {
                    return Err(Error::RowsApart { row }.in_body(previous));
                }
                bodies.push(finish(previous, &mut states)?);
            }
        }
        states.push(state);
    }
    if let Some(last) = current {
        bodies.push(finish(last, &mut states)?);
    }
    Ok(bodies)
}

fn finish(body: u64, states: &mut Vec<State>) -> Result<(u64, Trajectory), Error> {
    let trajectory = Trajectory::from_states(states).map_err(|error| error.in_body(body))?;
    states.clear();
    Ok((body, trajectory))
}
