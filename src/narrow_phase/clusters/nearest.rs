//! Question for the pairs of spheres that are the nearest ones at some time.
//!
//! A pair is left out if at each time some other pair is nearer by more than the solver's rounding. What
//! remains suffices for contacts within any margin, and for the closest approach, in any window.

use super::proven::{BoundedPiece, Pieces};
use super::search::Question;
use crate::narrow_phase::profile::DistanceProfile;
use crate::narrow_phase::sphere_pair::SpherePair;

/// Number of equal cells of a part, a multiple of that of the intervals into which it is halved.
const CELLS: usize = 8;

/// Asks for the pairs that may come within `margin` (m) and be the nearest ones then; `solve` returns the profile of a
/// pair's distance if that comes within the margin.
pub(super) struct NearestQuestion<F> {
    margin: f64,
    /// Separation that a pair must reach to matter in each cell of the part, m. `None` if that is the margin.
    bounds: Option<[f64; CELLS]>,
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

    fn list_pieces(&self, (start, end): (f64, f64), pieces: &mut Pieces) {
        let Some(bounds) = &self.bounds else {
            let bound = self.margin;
            return pieces.push(BoundedPiece { end: 1.0, bound });
        };
        for (number, &bound) in (1_u8..).zip(bounds) {
            let cell_end = f64::from(number) / CELLS as f64;
            if start < cell_end && cell_end <= end {
                let end = (cell_end - start) / (end - start);
                pieces.push(BoundedPiece { end, bound });
            }
        }
    }

    fn solve(&mut self, pair: &SpherePair, slack: Option<f64>) {
        let profile = (self.solve)(pair);
        let (Some(profile), Some(slack)) = (profile, slack) else {
            return;
        };
        let bounds = self.bounds.get_or_insert([self.margin; CELLS]);
        let largest: [f64; CELLS] = profile.largest_in_cells(&pair.cubic);
        for (bound, largest) in bounds.iter_mut().zip(largest) {
            *bound = bound.min(largest - (pair.radius_a + pair.radius_b) + slack);
        }
    }
}
