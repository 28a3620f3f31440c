//! Comparison of each box with all that follow, 16 at a time.

use super::region::Region;
use super::row_sweep::mask;
use super::rows::STEP;
use crate::broad_phase::{BodyBox, Candidate, PairFilter, emit};
use crate::simd::Task;

/// Finds overlapping pairs by comparing each box with all others.
pub(super) struct CompareAll<'a> {
    pub(super) boxes: &'a [BodyBox],
    pub(super) region: &'a Region,
    /// Low and high faces by axis, each list followed by enough unused elements for a whole step.
    pub(super) faces: &'a mut [[Vec<f32>; 3]; 2],
    pub(super) filter: &'a dyn PairFilter,
    pub(super) candidates: &'a mut Vec<Candidate>,
}

impl Task for CompareAll<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self { boxes, faces, .. } = self;
        let length = boxes.len() + STEP;
        let [low, high] = faces;
        for face in low.iter_mut().chain(high.iter_mut()) {
            if face.len() < length {
                face.resize(length, 0.0);
            }
        }
        let [low_x, low_y, low_z] = low.each_mut().map(|face| &mut face[..length]);
        let [high_x, high_y, high_z] = high.each_mut().map(|face| &mut face[..length]);
        for (number, one) in boxes.iter().enumerate() {
            let (low, high) = (one.aabb.mins, one.aabb.maxs);
            (low_x[number], low_y[number], low_z[number]) = (low.x, low.y, low.z);
            (high_x[number], high_y[number], high_z[number]) = (high.x, high.y, high.z);
        }
        for (number, one) in boxes.iter().enumerate() {
            if self.filter.gives_up() {
                return;
            }
            let (low, high) = (one.aabb.mins, one.aabb.maxs);
            let mut next = number + 1;
            while next < boxes.len() {
                let to = next + STEP;
                let (lows_x, highs_x) = (&low_x[next..to], &high_x[next..to]);
                let (lows_y, highs_y) = (&low_y[next..to], &high_y[next..to]);
                let (lows_z, highs_z) = (&low_z[next..to], &high_z[next..to]);
                let mut lanes = [0_u8; STEP];
                for lane in 0..STEP {
                    lanes[lane] = u8::from(
                        (low.x <= highs_x[lane])
                            & (high.x >= lows_x[lane])
                            & (low.y <= highs_y[lane])
                            & (high.y >= lows_y[lane])
                            & (low.z <= highs_z[lane])
                            & (high.z >= lows_z[lane]),
                    );
                }
                let mut meeting = mask(lanes);
                while meeting != 0 {
                    let lane = meeting.trailing_zeros() as usize;
                    meeting &= meeting - 1;
                    // What follows the last box is no box.
                    if let Some(other) = boxes.get(next + lane)
                        && self.region.owns(one, other)
                    {
                        emit(one.body, other.body, self.filter, self.candidates);
                    }
                }
                next = to;
            }
        }
    }
}
