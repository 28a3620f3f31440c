//! Parts of straight motions.

use super::frame::{Frame, larger};
use super::{FAR, ROUNDING, nearest};
use crate::rounding::UNIT_ROUNDOFF;
use crate::trajectory::StraightMotion;
use glam::{DVec3, Vec4};

/// Part of a straight motion: its ends, relative to a body's place, in the frame's unit.
#[derive(Clone, Copy, Debug)]
pub(super) struct StraightPart {
    pub(super) first: Vec4,
    pub(super) last: Vec4,
    /// The other magnitude to which rounding is relative, as of a [cubic](super::SubCubic).
    pub(super) near: f32,
    pub(super) from: f64,
    pub(super) to: f64,
}

impl StraightPart {
    /// Returns the part of a motion between two instants (s), relative to a frame's origin and in its unit.
    #[inline(always)]
    pub(super) fn new(motion: &StraightMotion, (from, to): (f64, f64), frame: &Frame) -> Self {
        let (first, last) = (motion.way_to(from), motion.way_to(to));
        let offset = motion.origin() - frame.origin;
        // A box is larger by four roundings of `near`. Each way has two roundings, and two where it cancels with the
        // offset. The solver's error, of at most 36, is held more than twice, as that of any cubic is.
        const ERROR: f64 = 24.0 * UNIT_ROUNDOFF / ROUNDING as f64;
        let error = larger(first.abs(), last.abs()) * ERROR;
        let near = ((last - first).abs() + error).element_sum() * frame.power;
        let [start, end] = [first, last].map(|way| (offset + way) * frame.power);
        let size = start.abs() + near;
        if !(size.x < FAR && size.y < FAR && size.z < FAR) {
            return Self {
                first: Vec4::ZERO,
                last: Vec4::ZERO,
                near: f32::INFINITY,
                from,
                to,
            };
        }
        let lanes = |DVec3 { x, y, z }: DVec3| Vec4::new(nearest(x), nearest(y), nearest(z), 0.0);
        Self {
            first: lanes(start),
            last: lanes(end),
            near: nearest(near),
            from,
            to,
        }
    }
}
