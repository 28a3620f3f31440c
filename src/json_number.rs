//! Settings that may be infinite, which JSON cannot express: text formats have none there. Binary formats can.

use serde::ser::Error as _;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

#[allow(
    clippy::trivially_copy_pass_by_ref,
    reason = "the signature that serde asks for"
)]
pub(crate) fn serialize<S: Serializer>(value: &f64, serializer: S) -> Result<S::Ok, S::Error> {
    if !serializer.is_human_readable() {
        value.serialize(serializer)
    } else if value.is_finite() || *value == f64::INFINITY {
        value.is_finite().then_some(value).serialize(serializer)
    } else {
        Err(S::Error::custom(format_args!("{value} is no setting")))
    }
}

pub(crate) fn deserialize<'d, D: Deserializer<'d>>(deserializer: D) -> Result<f64, D::Error> {
    if deserializer.is_human_readable() {
        let value = Option::deserialize(deserializer)?;
        Ok(value.unwrap_or(f64::INFINITY))
    } else {
        f64::deserialize(deserializer)
    }
}
