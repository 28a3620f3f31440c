//! Parts of straight motions.

use super::frame::Frame;
use super::{FAR, ROUNDING, nearest};
use crate::rounding::UNIT_ROUNDOFF;
use crate::trajectory::StraightMotion;
use glam::{DVec3, Vec4};

/// Part of a straight motion: its ends, relative to a body's anchor, in the frame's unit.
#[derive(Clone, Copy, Debug)]
pub(super) struct StraightPart {
    pub(super) first: Vec4,
    pub(super) last: Vec4,
    /// The other magnitude to which rounding is relative, as of a [cubic](super::SubCubic).
    pub(super) spread: f32,
    pub(super) from: f64,
    pub(super) to: f64,
}

impl StraightPart {
    /// Returns the part of a motion between two instants (s), relative to a frame's origin and in its unit.
    #[inline(always)]
    pub(super) fn new(motion: &StraightMotion, (from, to): (f64, f64), frame: &Frame) -> Self {
        // A box is larger by four roundings of `spread`. Each displacement has two roundings, and two where it cancels
        // with the offset. The solver's error, of at most 36, is relative to the displacement over a whole piece. That ends
        // after the motion's duration or, later, after up to three times that since its state. What it may report lies
        // within two and a quarter times its error: 243 of these 256 roundings.
        const ERROR: f64 = 64.0 * UNIT_ROUNDOFF / ROUNDING as f64;
        let [origin, velocity] = motion.numbers();
        let DVec3 { x, y, z } = frame.origin;
        let middle = [x, y, z, 0.0];
        // The fourth number of each has no meaning, and comes to nothing by this.
        let power = [frame.power, frame.power, frame.power, 0.0];
        let since = [from - motion.start(), to - motion.start()];
        let mut farthest = motion.duration();
        for time in [-since[0], since[1]] {
            farthest = if time > farthest { time } else { farthest };
        }
        // A loop over four lanes: the compiler takes one instruction for all.
        let (mut first, mut last, mut error) = ([0.0; 4], [0.0; 4], [0.0; 4]);
        for lane in 0..4 {
            let moved = since.map(|since| velocity[lane] * since);
            error[lane] = nearest((velocity[lane].abs() * (ERROR * power[lane])) * farthest);
            let offset = origin[lane] - middle[lane];
            first[lane] = nearest((offset + moved[0]) * power[lane]);
            last[lane] = nearest((offset + moved[1]) * power[lane]);
        }
        let [first, last, error] = [first, last, error].map(Vec4::from_array);
        let spread = (last - first).abs() + error;
        let spread = (spread.x + spread.z) + (spread.y + spread.w);
        // Also false where a number is none.
        if !(first.abs() + spread)
            .cmplt(Vec4::splat(nearest(FAR)))
            .all()
        {
            return Self {
                first: Vec4::ZERO,
                last: Vec4::ZERO,
                spread: f32::INFINITY,
                from,
                to,
            };
        }
        Self {
            first,
            last,
            spread,
            from,
            to,
        }
    }
}
