//! Courses: the straight line that a body nearly follows through a slice, closer than any box.

/// A straight line through a slice of time, and how far a body strays from it, in the frame's unit.
///
/// At the share `s` of the slice, 0..=1, every sphere of the body with half the margin around it is
/// within `slack` of `start + s change`, what the exact solver's rounding can add included.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FatLine {
    pub(crate) start: [f32; 3],
    pub(crate) change: [f32; 3],
    /// Infinite where the frame does not serve.
    pub(crate) slack: f32,
    /// The cubic that the body follows first in the slice.
    pub(crate) first: u32,
}
