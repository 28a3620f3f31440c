//! Fat lines: a line and a radius that bound a body in a slice, closer than a box.

use super::ROUNDING;

/// Roundings of a line's coordinates that its radius holds, on each axis.
pub(super) const LINE_ROUNDINGS: f32 = 8.0;

/// A fat line (Sederberg, Nishita, 1990) over a slice: a line with a radius, in the frame's unit.
///
/// At the share `s` of the slice, 0..=1, every sphere of the body, enlarged by half the margin, is
/// within `radius` of `start + s change`, while the body exists. The exact solver's rounding is included.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct FatLine {
    pub(crate) start: [f32; 3],
    pub(crate) change: [f32; 3],
    /// Infinite where the frame does not serve.
    pub(crate) radius: f32,
    /// Number of the cubic that the body follows first in the slice.
    pub(crate) first: u32,
}

impl FatLine {
    /// Returns true if the radius is large next to the change of position. So it is of a body that teleports in the
    /// slice, far from its line for an instant, and of bodies that are large next to the way they go.
    #[inline]
    pub(crate) fn may_teleport(&self) -> bool {
        let displacement = self
            .change
            .into_iter()
            .fold(0.0, |most: f32, coordinate| most.max(coordinate.abs()));
        self.radius > 0.3 * displacement
    }

    /// Returns true if most of the radius is rounding, since the frame's origin is far away.
    pub(crate) fn is_coarse(&self) -> bool {
        let size: f32 = self.start.into_iter().map(f32::abs).sum();
        LINE_ROUNDINGS * ROUNDING * size > 0.5 * self.radius
    }
}
