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
        // with the offset. The solver's error, of at most 36, is held more than twice, as that of any cubic is.
        const ERROR: f64 = 24.0 * UNIT_ROUNDOFF / ROUNDING as f64;
        let [origin, velocity] = motion.lanes();
        let DVec3 { x, y, z } = frame.origin;
        let middle = [x, y, z, 0.0];
        // The fourth number of each has no meaning, and comes to nothing by this.
        let power = [frame.power, frame.power, frame.power, 0.0];
        let since = [from - motion.start(), to - motion.start()];
        // A loop over four lanes: the compiler takes one instruction for all.
        let (mut start, mut end, mut spread) = ([0.0; 4], [0.0; 4], [0.0; 4]);
        for lane in 0..4 {
            let (first, last) = (velocity[lane] * since[0], velocity[lane] * since[1]);
            let way = (last - first).abs();
            // The larger displacement is half of this, which takes no comparison.
            let twice = (last + first).abs() + way;
            spread[lane] = (way + twice * (0.5 * ERROR)) * power[lane];
            let offset = origin[lane] - middle[lane];
            start[lane] = (offset + first) * power[lane];
            end[lane] = (offset + last) * power[lane];
        }
        let spread = (spread[0] + spread[2]) + (spread[1] + spread[3]);
        let mut is_served = true;
        for lane in start {
            is_served &= lane.abs() + spread < FAR;
        }
        if !is_served {
            return Self {
                first: Vec4::ZERO,
                last: Vec4::ZERO,
                spread: f32::INFINITY,
                from,
                to,
            };
        }
        let (mut first, mut last) = ([0.0; 4], [0.0; 4]);
        for lane in 0..4 {
            first[lane] = nearest(start[lane]);
            last[lane] = nearest(end[lane]);
        }
        Self {
            first: Vec4::from_array(first),
            last: Vec4::from_array(last),
            spread: nearest(spread),
            from,
            to,
        }
    }
}
