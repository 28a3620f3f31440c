//! Options of a cover.

/// Options of [`SphereCover::fit`](crate::SphereCover::fit).
///
/// Options can hold any values: the fit checks them.
///
/// ```
/// use nearmiss::CoverOptions;
///
/// let at_most_32 = CoverOptions::new(32);
/// let few = CoverOptions::new(64).with_target_overshoot(0.05).with_seed(7);
/// assert_eq!(at_most_32.max_spheres(), 32);
/// assert_eq!(few.target_overshoot(), Some(0.05));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
pub struct CoverOptions {
    max_spheres: usize,
    #[cfg_attr(feature = "serde", serde(serialize_with = "serialize_target"))]
    target_overshoot: Option<f64>,
    seed: u64,
    effort: u32,
}

impl Default for CoverOptions {
    /// Returns options for at most 16 spheres.
    fn default() -> Self {
        Self::new(16)
    }
}

impl CoverOptions {
    /// Largest number of spheres of a fit: 4,096.
    pub const MAX_SPHERES: usize = 4_096;

    /// Largest effort of a fit: 65,536.
    pub const MAX_EFFORT: u32 = 65_536;

    /// Returns options for the least overshoot with at most this many spheres, seed 0.
    #[must_use]
    pub const fn new(max_spheres: usize) -> Self {
        Self {
            max_spheres,
            target_overshoot: None,
            seed: 0,
            effort: 1,
        }
    }

    /// Returns the options with a target: as few spheres as reach this overshoot, m. The numbers
    /// tried are found by doubling and halving, so a smaller number may do by luck. Each number tried is a fit of its own: a
    /// target takes about ten times as long as a fit with the resulting number of spheres.
    #[must_use]
    pub const fn with_target_overshoot(mut self, target: f64) -> Self {
        self.target_overshoot = Some(target);
        self
    }

    /// Returns the options with a seed. Each seed leads to other starts of the search.
    #[must_use]
    pub const fn with_seed(mut self, seed: u64) -> Self {
        self.seed = seed;
        self
    }

    /// Returns the options with this many times the default number of starts; 0 counts as 1, and more
    /// than [`MAX_EFFORT`](Self::MAX_EFFORT) are refused. The default number depends on the number of
    /// spheres and on the shape, never on the clock.
    #[must_use]
    pub const fn with_effort(mut self, effort: u32) -> Self {
        self.effort = effort;
        self
    }

    /// Returns the largest number of spheres.
    #[must_use]
    pub const fn max_spheres(&self) -> usize {
        self.max_spheres
    }

    /// Returns the target overshoot, m.
    #[must_use]
    pub const fn target_overshoot(&self) -> Option<f64> {
        self.target_overshoot
    }

    /// Returns the seed.
    #[must_use]
    pub const fn seed(&self) -> u64 {
        self.seed
    }

    /// Returns the factor of the number of starts.
    #[must_use]
    pub const fn effort(&self) -> u32 {
        self.effort
    }
}

/// Writes a target. Text formats would write one that is not finite, which a fit refuses, as none.
#[cfg(feature = "serde")]
fn serialize_target<S: serde::Serializer>(
    target: &Option<f64>,
    serializer: S,
) -> Result<S::Ok, S::Error> {
    use serde::Serialize;
    use serde::ser::Error;

    match target {
        Some(target) if serializer.is_human_readable() && !target.is_finite() => {
            Err(S::Error::custom(format_args!("{target} is no target")))
        }
        _ => target.serialize(serializer),
    }
}

#[cfg(feature = "serde")]
#[cfg(test)]
mod tests {
    use super::*;

    /// They are not saved as options without a target.
    #[test]
    fn targets_that_are_not_finite_are_not_written() {
        let saved = |target| {
            let options = CoverOptions::new(8).with_target_overshoot(target);
            serde_json::to_string(&options).is_ok()
        };
        assert!(saved(0.5));
        assert!(!saved(f64::NAN));
        assert!(!saved(f64::INFINITY));
    }
}
