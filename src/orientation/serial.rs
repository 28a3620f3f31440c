//! Serialised orientations: the numbers as given.

use super::Orientation;
use super::turning::{OrientationPart, Turning};
use crate::error::Error;
use crate::rounding::without_negative_zero;
use serde::{Deserialize, Serialize};

/// The serialised fields of an orientation; no parts if the body does not turn.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct OrientationNumbers {
    parts: Vec<OrientationPart>,
    tolerance: Option<f64>,
}

impl From<Orientation> for OrientationNumbers {
    fn from(orientation: Orientation) -> Self {
        match orientation.turning {
            None => Self {
                parts: Vec::new(),
                tolerance: None,
            },
            Some(turning) => Self {
                parts: turning.parts,
                tolerance: turning.tolerance,
            },
        }
    }
}

impl TryFrom<OrientationNumbers> for Orientation {
    type Error = Error;

    fn try_from(
        OrientationNumbers {
            mut parts,
            tolerance,
        }: OrientationNumbers,
    ) -> Result<Self, Error> {
        let mut before = None;
        for (knot, part) in parts.iter_mut().enumerate() {
            part.from = part.from.map(without_negative_zero);
            // The first one begins with time, each other one after the one before.
            let is_later = match (before, part.from) {
                (None, None) => knot == 0,
                (None, Some(from)) => knot == 1 && from.is_finite(),
                (Some(before), Some(from)) => from.is_finite() && before < from,
                (Some(_), None) => false,
            };
            if !is_later {
                return Err(Error::TimeNotIncreasing {
                    knot,
                    previous: before.unwrap_or(f64::NEG_INFINITY),
                    time: part.from.unwrap_or(f64::NEG_INFINITY),
                });
            }
            before = part.from;
        }
        if parts.is_empty() {
            // What does not turn does not remember a tolerance, but must not have one that is none.
            return match tolerance {
                None => Ok(Self::FIXED),
                Some(tolerance) => Self::FIXED.with_tolerance(tolerance),
            };
        }
        Turning::of(parts, tolerance).map(Self::of_turning)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tolerances_without_parts_are_checked() {
        let read = |tolerance| {
            let parts = Vec::new();
            Orientation::try_from(OrientationNumbers { parts, tolerance })
        };
        assert_eq!(read(None), Ok(Orientation::FIXED));
        assert_eq!(read(Some(1e-3)), Ok(Orientation::FIXED));
        assert_eq!(read(Some(5.0)), Err(Error::Tolerance { value: 5.0 }));
    }
}
