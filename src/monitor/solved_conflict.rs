//! Conflicts and closest approaches of pairs, with what is known of the rounding of constant distances.

use crate::conflict::{ClosestApproach, Conflict};

/// A conflict of a pair, from its solved spans.
#[derive(Clone, Copy, Debug)]
pub(super) struct SolvedConflict {
    pub(super) conflict: Conflict,
    /// Rounding of the closest approach's separation if the distance is constant there, m; else 0.
    pub(super) plateau: f64,
    /// True if the distance is constant over one of the pair's spans.
    pub(super) has_plateau: bool,
    /// Instant from which on neither body moves, s; infinite if one always does.
    pub(super) rests_from: f64,
}

impl SolvedConflict {
    pub(super) const fn closest(&self) -> SolvedApproach {
        SolvedApproach {
            approach: self.conflict.closest,
            plateau: self.plateau,
        }
    }
}

/// A closest approach of a pair, from its solved spans.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct SolvedApproach {
    pub(super) approach: ClosestApproach,
    /// Rounding of the separation if the distance is constant there, m; else 0.
    plateau: f64,
}

impl SolvedApproach {
    /// Returns the approach, or one that has passed if that is no farther. A constant distance that is lower by rounding is
    /// not lower.
    pub(super) fn or_passed(self, passed: Option<Self>) -> Self {
        let is_no_farther = |passed: &Self| {
            let tie = passed.plateau.min(self.plateau);
            passed.approach.separation <= self.approach.separation + tie
        };
        passed.filter(is_no_farther).map_or(self, |mut passed| {
            // The model errors are those of the bodies as they are now.
            passed.approach.model_error = self.approach.model_error;
            passed
        })
    }

    pub(super) fn is_finite(&self) -> bool {
        self.approach.is_finite() && self.plateau.is_finite()
    }
}
