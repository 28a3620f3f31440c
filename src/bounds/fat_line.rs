//! Fat lines: a line and a radius that bound a body in a slice, closer than a box.

/// A fat line (Sederberg, Nishita, 1990) over a slice: a line with a radius, in the frame's unit.
///
/// At the share `s` of the slice, 0..=1, every sphere of the body, enlarged by half the margin, is
/// within `radius` of `start + s change`. The exact solver's rounding is included.
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
    /// Returns false of most bodies that do not teleport in the slice. One that does strays from
    /// its line by about half of its way, for an instant.
    #[inline]
    pub(crate) fn may_teleport(&self) -> bool {
        let way = self
            .change
            .into_iter()
            .fold(0.0, |most: f32, lane| most.max(lane.abs()));
        0.3 * way < self.radius && self.radius < 1.2 * way
    }
}
