//! Question for the pairs of spheres that are the nearest ones at some time.
//!
//! A pair is left out if at each time some other pair is nearer by more than the solver's rounding. What
//! remains suffices for contacts within any margin, and for the closest approach, in any window.

use super::proven::{BoundStep, BoundSteps};
use super::search::Question;
use super::shares::{FEWEST_HALVINGS, MOST_HALVINGS, Shares, WHOLE};
use crate::narrow_phase::profile::DistanceProfile;
use crate::narrow_phase::sphere_pair::SpherePair;
use arrayvec::ArrayVec;
use std::iter;

/// Largest number of equal parts of a stretch.
const MOST_PARTS: usize = 2 << MOST_HALVINGS;

/// Asks for the pairs that may come within `margin` (m) and be the nearest ones then; `solve` returns the profile of a
/// pair's distance if that comes within the margin.
pub(super) struct NearestQuestion<F> {
    margin: f64,
    /// Separation that a pair must reach to matter in each equal part of the stretch, m. None if that is the margin.
    bounds: ArrayVec<f64, MOST_PARTS>,
    /// Number of equal parts, twice that of the intervals into which the stretch is halved.
    parts: usize,
    stretch: Shares,
    solve: F,
}

impl<F> NearestQuestion<F> {
    pub(super) fn new(margin: f64, solve: F) -> Self {
        Self {
            margin,
            bounds: ArrayVec::new(),
            parts: 2 << FEWEST_HALVINGS,
            stretch: WHOLE,
            solve,
        }
    }
}

impl<F: FnMut(&SpherePair) -> Option<DistanceProfile>> Question for NearestQuestion<F> {
    fn is_of_all_times(&self) -> bool {
        true
    }

    fn restrict(&mut self, stretch: Shares, halvings: i32) {
        self.stretch = stretch;
        self.parts = 2 << halvings;
        self.bounds.clear();
    }

    fn list_bounds(&self, (start, end): (f64, f64), steps: &mut BoundSteps) {
        if self.bounds.is_empty() {
            let bound = self.margin;
            return steps.push(BoundStep { end: 1.0, bound });
        }
        for (number, &bound) in (1_u8..).zip(&self.bounds) {
            let part_end = f64::from(number) / self.parts as f64;
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
        if self.bounds.is_empty() {
            self.bounds.extend(iter::repeat_n(self.margin, self.parts));
        }
        let radii = pair.radius_a + pair.radius_b;
        let (ends, mut bounds) = ((self.stretch, self.parts), self.bounds.iter_mut());
        profile.each_largest_in_parts(&pair.cubic, ends, |largest| {
            if let Some(bound) = bounds.next() {
                *bound = bound.min(largest - radii + slack);
            }
        });
    }
}
