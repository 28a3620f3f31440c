//! Trajectories in f32: of a motion, the part that a screening reads most.

use super::bundle::{Bundle, bundle_up};
use super::{Extremes, FAR, Frame, ROUNDING, nearest};
use crate::knots::Knots;
use crate::rounding::normalising_power;
use crate::trajectory::Segment;
use glam::{DVec3, Vec4};

/// One cubic of a sketch, 64 bytes: its Bézier points, relative to the sketch's frame.
///
/// Each coordinate is rounded once from f64. The fourth lane of the first point is what all other
/// rounding of the cubic is relative to: no point is farther from the first one; more where the
/// segment itself is known less well than f32 could tell.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(crate) struct Stroke([Vec4; 4]);

impl Stroke {
    /// None where `f32` does not serve its coordinates.
    #[inline(always)]
    pub(super) fn of(segment: &Segment, (from, to): (f64, f64), frame: &Frame) -> Option<Self> {
        let is_whole =
            segment.start().to_bits() == from.to_bits() && segment.end().to_bits() == to.to_bits();
        let (points, spread) = if is_whole {
            (
                segment.control(),
                segment.extent() + segment.error() / f64::from(ROUNDING),
            )
        } else {
            // The first point is not the segment's origin.
            let error = segment.own_error(from, to) / f64::from(ROUNDING);
            let spread = 2.0 * segment.reach(from, to) + error;
            (segment.restrict(from, to).points, spread)
        };
        let (offset, near) = (segment.origin() - frame.origin, spread * frame.power);
        let lanes = |point: DVec3, last: f64| {
            let DVec3 { x, y, z } = (offset + point) * frame.power;
            Vec4::new(nearest(x), nearest(y), nearest(z), nearest(last))
        };
        let is_served = offset.abs().max_element() * frame.power + near < FAR;
        let [p0, p1, p2, p3] = points;
        is_served.then(|| {
            Self([
                lanes(p0, near),
                lanes(p1, 0.0),
                lanes(p2, 0.0),
                lanes(p3, 0.0),
            ])
        })
    }

    const NONE: Self = Self([Vec4::ZERO; 4]);

    /// The points in another unit, and what their rounding is relative to.
    #[inline(always)]
    pub(super) fn points(&self, factor: f32) -> ([Vec4; 4], f32) {
        let points = self.0.map(|point| point * factor);
        (points, points[0].w)
    }
}

/// A trajectory in f32.
#[derive(Clone, Debug)]
pub(crate) struct Sketch {
    /// Where it is drawn: around itself.
    pub(super) frame: Frame,
    /// No coordinate is larger, in the frame's unit; infinite where `f32` does not serve them.
    pub(super) size: f64,
    /// Of the knots.
    ends: (f64, f64),
    /// A copy, allocated next to the cubics: whoever reads these reads those, and the trajectory's
    /// own lie elsewhere.
    knots: Vec<f64>,
    strokes: Vec<Stroke>,
    bundles: Vec<Bundle>,
}

impl Sketch {
    pub(crate) const EMPTY: Self = Self {
        frame: Frame::OF_NOTHING,
        size: 0.0,
        ends: Knots::NONE.ends(),
        knots: Vec::new(),
        strokes: Vec::new(),
        bundles: Vec::new(),
    };

    /// Of the cubics of a motion, each between two knots.
    #[cfg(test)]
    pub(crate) fn of(knots: &[f64], segments: &[Segment]) -> Self {
        let mut sketch = Self::EMPTY;
        sketch.redraw(knots, segments);
        sketch
    }

    /// Draws another motion in this one's memory; gives how far it goes.
    pub(crate) fn redraw(&mut self, knots: &[f64], segments: &[Segment]) -> Extremes {
        let (mut extremes, mut spread) = (Extremes::NOTHING, 0.0_f64);
        for (segment, ends) in segments.iter().zip(knots.windows(2)) {
            let reach = segment.reach(ends[0], ends[1]);
            let error = segment.own_error(ends[0], ends[1]) / f64::from(ROUNDING);
            extremes.include(Extremes::of_segment(segment, reach));
            // It may be lost in the extremes: below their resolution.
            spread = spread.max(2.0 * reach + error);
        }
        self.frame = Frame::around(extremes, 0.0);
        self.size = 0.0;
        if !segments.is_empty() {
            // Numbers near one: whatever underflows is nothing next to them, in any other unit.
            let size = (extremes.high - self.frame.origin).max_element() + spread;
            self.frame.power = normalising_power(size);
            self.size = size * self.frame.power;
        }
        self.ends = Knots::of(knots).ends();
        self.knots.clear();
        self.knots.extend_from_slice(knots);
        self.strokes.clear();
        let pieces = segments.iter().zip(knots.windows(2));
        let (frame, size) = (&self.frame, &mut self.size);
        self.strokes.extend(pieces.map(|(segment, ends)| {
            let stroke = Stroke::of(segment, (ends[0], ends[1]), frame);
            stroke.unwrap_or_else(|| {
                *size = f64::INFINITY;
                Stroke::NONE
            })
        }));
        bundle_up(knots, &self.strokes, &mut self.bundles);
        extremes
    }

    pub(crate) fn knots(&self) -> Knots<'_> {
        Knots::with_ends(&self.knots, self.ends)
    }

    pub(crate) fn strokes(&self) -> &[Stroke] {
        &self.strokes
    }

    pub(crate) fn bundles(&self) -> &[Bundle] {
        &self.bundles
    }
}
