//! Parts of straight motions.

use super::frame::Frame;
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
        let error = first.abs().max(last.abs()) * (24.0 * UNIT_ROUNDOFF / f64::from(ROUNDING));
        let near = ((last - first).abs() + error).element_sum() * frame.power;
        let [start, end] = [first, last].map(|way| (offset + way) * frame.power);
        let lanes = |DVec3 { x, y, z }: DVec3| Vec4::new(nearest(x), nearest(y), nearest(z), 0.0);
        let is_served = start.abs().max_element() + near < FAR;
        Self {
            first: if is_served { lanes(start) } else { Vec4::ZERO },
            last: if is_served { lanes(end) } else { Vec4::ZERO },
            near: if is_served {
                nearest(near)
            } else {
                f32::INFINITY
            },
            from,
            to,
        }
    }
}
