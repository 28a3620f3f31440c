//! Trajectories in f32: the data that a screening reads most.

use super::compact_cubic::CompactCubic;
use super::cubic_run::{CubicRun, count_of_runs};
use super::form_runs::form_runs;
use super::frame::{DAabb, Frame};
use super::points::InexactPoints;
use crate::knots::Knots;
use crate::rounding::scale_to_one;
use crate::trajectory::Segment;
use bytemuck::{Pod, Zeroable, cast_slice, cast_slice_mut};

/// One cache line of untyped storage.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C, align(64))]
pub(crate) struct CacheLine([f64; 8]);

impl CacheLine {
    pub(crate) const BLANK: Self = Self([0.0; Self::KNOTS]);

    /// Knots in a line.
    const KNOTS: usize = 8;
}

/// Header of a trajectory in f32. Its knots, cubics and runs of cubics follow one another on cache lines
/// stored elsewhere. The knots are a copy, so that they lie next to the cubics.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CompactTrajectory {
    /// The frame of the cubics: around the trajectory.
    frame: Frame,
    /// Upper bound of all coordinates, in the frame's unit; infinite where f32 does not serve them.
    size: f64,
    /// First and last knot, s.
    ends: (f64, f64),
    knots: usize,
    cubics: usize,
}

/// A compact trajectory with its cache lines.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CompactView<'a> {
    pub(super) frame: Frame,
    pub(super) size: f64,
    pub(crate) knots: Knots<'a>,
    pub(super) compact_cubics: &'a [CompactCubic],
    pub(super) runs: &'a [CubicRun],
}

impl CompactTrajectory {
    /// Returns the number of cache lines for a motion with these counts of knots and cubics.
    pub(crate) const fn cache_lines(knots: usize, cubics: usize) -> usize {
        knots.div_ceil(CacheLine::KNOTS) + cubics + count_of_runs(cubics)
    }

    /// Writes the cubics of a motion, each between two knots, to its cache lines; returns the header, the
    /// motion's extremes, and the largest error of the points of its cubics, m.
    pub(crate) fn write(
        knots: &[f64],
        segments: &[Segment],
        cache_lines: &mut [CacheLine],
    ) -> (Self, DAabb, f64) {
        let (mut extremes, mut spread, mut error) = (DAabb::NOTHING, 0.0_f64, 0.0_f64);
        for (segment, ends) in segments.iter().zip(knots.windows(2)) {
            let part = InexactPoints::of(segment, (ends[0], ends[1]));
            let first = segment.origin() + part.points[0];
            extremes.include(DAabb::about(first, part.extent));
            // It may be lost in the extremes: below their resolution.
            spread = spread.max(part.spread());
            error = error.max(part.error);
        }
        let mut compact = Self {
            frame: Frame::around(extremes, 0.0),
            size: 0.0,
            ends: Knots::of(knots).ends(),
            knots: knots.len(),
            cubics: segments.len(),
        };
        if !segments.is_empty() {
            // Numbers near one: whatever underflows is nothing next to them, in any other unit.
            let size = (extremes.high - compact.frame.origin).max_element() + spread;
            compact.frame.power = scale_to_one(size);
            compact.size = size * compact.frame.power;
        }
        let (of_knots, rest) = cache_lines.split_at_mut(knots.len().div_ceil(CacheLine::KNOTS));
        let (compact_cubics, runs) = rest.split_at_mut(segments.len());
        cast_slice_mut(of_knots)[..knots.len()].copy_from_slice(knots);
        let compact_cubics: &mut [CompactCubic] = cast_slice_mut(compact_cubics);
        let pieces = segments.iter().zip(knots.windows(2));
        for (compact_cubic, (segment, ends)) in compact_cubics.iter_mut().zip(pieces) {
            *compact_cubic = CompactCubic::of(segment, (ends[0], ends[1]), &compact.frame)
                .unwrap_or_else(|| {
                    compact.size = f64::INFINITY;
                    CompactCubic::NONE
                });
        }
        form_runs(knots, compact_cubics, cast_slice_mut(runs));
        (compact, extremes, error)
    }

    /// Returns the first and last knot, s; the first is later only if there are no knots.
    pub(crate) const fn ends(&self) -> (f64, f64) {
        self.ends
    }

    /// Returns the view of the data on these cache lines.
    pub(crate) fn on<'a>(&self, cache_lines: &'a [CacheLine]) -> CompactView<'a> {
        let (knots, rest) = cache_lines.split_at(self.knots.div_ceil(CacheLine::KNOTS));
        let (compact_cubics, runs) = rest.split_at(self.cubics);
        CompactView {
            frame: self.frame,
            size: self.size,
            knots: Knots::with_ends(&cast_slice(knots)[..self.knots], self.ends),
            compact_cubics: cast_slice(compact_cubics),
            runs: cast_slice(&runs[..count_of_runs(self.cubics)]),
        }
    }

    /// Returns a compact trajectory on cache lines of its own.
    #[cfg(test)]
    pub(crate) fn of(knots: &[f64], segments: &[Segment]) -> (Self, Vec<CacheLine>) {
        let mut cache_lines =
            vec![CacheLine::BLANK; Self::cache_lines(knots.len(), segments.len())];
        (
            Self::write(knots, segments, &mut cache_lines).0,
            cache_lines,
        )
    }
}
