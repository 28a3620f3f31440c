//! Question for the pairs of spheres that are the nearest ones at some time.
//!
//! A pair is left out if at each time some other pair is nearer by more than the solver's rounding. What
//! remains suffices for contacts within any margin, and for the closest approach, in any window.

use super::proven::{BoundStep, BoundSteps};
use super::search::Question;
use crate::narrow_phase::profile::DistanceProfile;
use crate::narrow_phase::sphere_pair::SpherePair;

/// Number of equal parts of a section, a multiple of that of the intervals into which it is halved.
const PARTS: usize = 8;

/// Asks for the pairs that may come within `margin` (m) and be the nearest ones then; `solve` returns the profile of a
/// pair's distance if that comes within the margin.
pub(super) struct NearestQuestion<F> {
    margin: f64,
    /// Separation that a pair must reach to matter in each equal part of the section, m. `None` if that is the margin.
    bounds: Option<[f64; PARTS]>,
    solve: F,
}

impl<F> NearestQuestion<F> {
    pub(super) const fn new(margin: f64, solve: F) -> Self {
        Self {
            margin,
            bounds: None,
            solve,
        }
    }
}

impl<F: FnMut(&SpherePair) -> Option<DistanceProfile>> Question for NearestQuestion<F> {
    fn is_of_all_times(&self) -> bool {
        true
    }

    fn list_bounds(&self, (start, end): (f64, f64), steps: &mut BoundSteps) {
        let Some(bounds) = &self.bounds else {
            let bound = self.margin;
            return steps.push(BoundStep { end: 1.0, bound });
        };
        for (number, &bound) in (1_u8..).zip(bounds) {
            let part_end = f64::from(number) / PARTS as f64;
            if start < part_end && part_end <= end {
                let end = (part_end - start) / (end - start);
                steps.push(BoundStep { end, bound });
            }
        }
    }

    fn solve(&mut self, pair: &SpherePair, slack: Option<f64>) {
        let profile = (self.solve)(pair);
        let (Some(profile), Some(slack)) = (profile, slack) else {
            return;
        };
        let bounds = self.bounds.get_or_insert([self.margin; PARTS]);
        let largest: [f64; PARTS] = profile.largest_in_parts(&pair.cubic);
        for (bound, largest) in bounds.iter_mut().zip(largest) {
            *bound = bound.min(largest - (pair.radius_a + pair.radius_b) + slack);
        }
    }
}
