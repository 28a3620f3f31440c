//! A body's box and fat line in one slice, under construction.

use super::ROUNDING;
use super::cubic_run::{CubicRun, ScaledRun};
use super::fat_line::{FatLine, LINE_ROUNDINGS};
use super::placement::FramePlacement;
use super::slice_interval::SliceInterval;
use super::straight_part::StraightPart;
use super::sub_cubic::SubCubic;
use glam::Vec4;
use parry3d::bounding_volume::Aabb;
use parry3d::math::Vector;

/// The bounds of a body's motion over the pieces so far of one slice, relative to the body's anchor.
/// The fourth lane is unused.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BoundsBuilder<const MOVES: bool> {
    /// The body's box, which moves with the slice interval.
    low: Vec4,
    high: Vec4,
    /// Largest `spread` and largest number of splits of a piece: rounding grows with both. See [`SubCubic`].
    spread: f32,
    splits: f32,
    /// Least and largest deviation from the line on each axis.
    least: Vec4,
    most: Vec4,
    /// The line through the start of the first piece and the end of the last one: see [`toward`](Self::toward).
    start: Vec4,
    change: Vec4,
    /// Point on the line at the end of the pieces so far, and the elapsed share of the slice.
    line: Vec4,
    share: f32,
    slice: SliceInterval<MOVES>,
}

impl<const MOVES: bool> BoundsBuilder<MOVES> {
    /// Starts a builder with the first piece of a slice, on the line to the end of the last one.
    #[inline(always)]
    pub(crate) fn between(head: &SubCubic, tail: &SubCubic, slice: &SliceInterval<MOVES>) -> Self {
        let (first, last) = ((head.points[0], head.from), (tail.points[3], tail.to));
        let mut builder = Self::toward(first, last, slice);
        builder.follow(head);
        builder
    }

    /// Returns the bounds of a single piece that fills the slice.
    #[inline(always)]
    pub(crate) fn alone(piece: &SubCubic, slice: &SliceInterval<MOVES>) -> Self {
        let [p0, p1, p2, p3] = piece.points;
        let change = p3 - p0;
        let third = change * (1.0 / 3.0);
        // The piece begins and ends on the line. Its deviation is 3 s (1 - s) times a mean of d1 and d2: at most
        // 3/4 of the larger one.
        let (d1, d2) = ((p1 - p0) - third, (p2 - p3) + third);
        let [q0, q1, q2, q3] = slice.relative(piece.points, 0.0, 1.0);
        Self {
            low: q0.min(q1).min(q2.min(q3)),
            high: q0.max(q1).max(q2.max(q3)),
            spread: piece.spread,
            splits: piece.splits,
            least: d1.min(d2).min(Vec4::ZERO) * 0.75,
            most: d1.max(d2).max(Vec4::ZERO) * 0.75,
            start: p0,
            change,
            line: p3,
            share: 1.0,
            slice: *slice,
        }
    }

    /// Starts a builder at the beginning of a run of cubics, on the line to the end of another.
    pub(super) fn between_runs(
        first: &ScaledRun,
        last: &ScaledRun,
        slice: &SliceInterval<MOVES>,
    ) -> Self {
        Self {
            // The new line does not go through the ends of the runs' lines.
            low: first.low,
            high: first.high,
            ..Self::toward((first.start, slice.from), (last.end, slice.to), slice)
        }
    }

    /// Returns the bounds of a single straight piece that lasts for all of a slice.
    #[inline(always)]
    pub(super) fn straight(piece: &StraightPart, slice: &SliceInterval<MOVES>) -> Self {
        let last = slice.relative_at(piece.last, 1.0);
        let displacement = piece.last - piece.first;
        // The line of a slice of no duration is a point.
        let (change, aside) = if slice.rate > 0.0 {
            (displacement, Vec4::ZERO)
        } else {
            (Vec4::ZERO, displacement)
        };
        Self {
            low: piece.first.min(last),
            high: piece.first.max(last),
            spread: piece.spread,
            splits: 0.0,
            least: aside.min(Vec4::ZERO),
            most: aside.max(Vec4::ZERO),
            start: piece.first,
            change,
            line: piece.last,
            share: 1.0,
            slice: *slice,
        }
    }

    /// Starts a builder with a straight piece, on the line to the end of the last one.
    #[inline(always)]
    pub(super) fn along(
        head: &StraightPart,
        tail: &StraightPart,
        slice: &SliceInterval<MOVES>,
    ) -> Self {
        let mut builder = Self::toward((head.first, head.from), (tail.last, tail.to), slice);
        builder.go_straight(head);
        builder
    }

    /// Adds a straight piece that begins when the previous one ends: between its ends it strays no farther.
    #[inline(always)]
    pub(super) fn go_straight(&mut self, part: &StraightPart) {
        let point = self.slice.relative_at(part.first, self.share);
        (self.low, self.high) = (self.low.min(point), self.high.max(point));
        self.include_deviation(part.first - self.line);
        self.share = self.slice.share(part.to);
        self.line = self.start + self.change * self.share;
        let point = self.slice.relative_at(part.last, self.share);
        (self.low, self.high) = (self.low.min(point), self.high.max(point));
        self.include_deviation(part.last - self.line);
        self.spread = self.spread.max(part.spread);
    }

    /// Starts a builder on the line through two points, each at an instant (s). A body that begins or ends in mid-slice
    /// has a line that goes on beyond both points as it goes between them.
    ///
    /// Any line bounds the body: deviations are measured from the line as it is rounded here, at the shares of the pieces.
    /// Their rounding is counted in the body's coordinates and the line's change. That holds for every line: from the
    /// first instant to the last one it lies between both points. It starts at most its change farther from the anchor
    /// than the body: see [`fat_line`].
    #[inline(always)]
    fn toward(
        (first, from): (Vec4, f64),
        (last, to): (Vec4, f64),
        slice: &SliceInterval<MOVES>,
    ) -> Self {
        /// Least share of the slice between both instants by which the line's change is told. A body of less time does not go
        /// far, and a larger change would add rounding.
        const LEAST: f32 = 0.125;
        let share = slice.share(from);
        let between = slice.share(to) - share;
        let displacement = last - first;
        let (start, change) = if slice.rate <= 0.0 {
            // The line of a slice of no duration is a point: any distance from it counts as deviation.
            (first, Vec4::ZERO)
        } else if between < 1.0 {
            let change = displacement * (1.0 / between.max(LEAST));
            (first - change * share, change)
        } else {
            (first, displacement)
        };
        let line = start + change * share;
        let point = slice.relative_at(first, share);
        Self {
            low: point,
            high: point,
            spread: 0.0,
            splits: 0.0,
            least: first - line,
            most: first - line,
            start,
            change,
            line,
            share,
            slice: *slice,
        }
    }

    /// Adds a piece that begins when the previous one ends, possibly at another position.
    #[inline(always)]
    pub(crate) fn follow_from_start(&mut self, piece: &SubCubic) {
        let start = piece.points[0];
        let point = self.slice.relative_at(start, self.share);
        self.low = self.low.min(point);
        self.high = self.high.max(point);
        self.include_deviation(start - self.line);
        self.follow(piece);
    }

    /// Adds a piece whose start is already included. Its difference from the line is a cubic as
    /// well, with the differences at every third of the piece as control points.
    #[inline(always)]
    fn follow(&mut self, piece: &SubCubic) {
        let [_, p1, p2, p3] = piece.points;
        let share = self.slice.share(piece.to);
        let [_, q1, q2, q3] = self.slice.relative(piece.points, self.share, share);
        self.low = self.low.min(q1.min(q2).min(q3));
        self.high = self.high.max(q1.max(q2).max(q3));
        self.spread = self.spread.max(piece.spread);
        self.splits = self.splits.max(piece.splits);
        let line_3 = self.start + self.change * share;
        let third = (line_3 - self.line) * (1.0 / 3.0);
        let (line_1, line_2) = (self.line + third, line_3 - third);
        let (d1, d2, d3) = (p1 - line_1, p2 - line_2, p3 - line_3);
        self.least = self.least.min(d1.min(d2).min(d3));
        self.most = self.most.max(d1.max(d2).max(d3));
        (self.line, self.share) = (line_3, share);
    }

    /// Adds a deviation from the line.
    #[inline(always)]
    fn include_deviation(&mut self, point: Vec4) {
        self.least = self.least.min(point);
        self.most = self.most.max(point);
    }

    /// Adds a run of cubics that lasts until an instant (s).
    #[inline(always)]
    pub(super) fn pass(&mut self, run: &ScaledRun, until: f64) {
        let share = self.slice.share(until);
        let (low, high) = if MOVES {
            let first = self.slice.relative_at(run.start, self.share);
            let last = self.slice.relative_at(run.end, share);
            (
                first.min(last) - run.deviation,
                first.max(last) + run.deviation,
            )
        } else {
            (run.low, run.high)
        };
        self.low = self.low.min(low);
        self.high = self.high.max(high);
        self.spread = self.spread.max(run.spread);
        let line = self.start + self.change * share;
        let (first, last) = (run.start - self.line, run.end - line);
        self.least = self.least.min(first.min(last) - run.deviation);
        self.most = self.most.max(first.max(last) + run.deviation);
        (self.line, self.share) = (line, share);
    }

    /// Returns the offset that centres the line between the extreme deviations, and the deviation
    /// that remains. For a motion that bends one way this halves the deviation.
    #[inline(always)]
    fn middle(&self) -> (Vec4, Vec4) {
        let middle = (self.least + self.most) * 0.5;
        (middle, (self.most - middle).max(middle - self.least))
    }

    /// Summarises the bounds as a run of cubics that ends at `end`.
    pub(super) fn finish_run(&self, end: Vec4) -> CubicRun {
        let (middle, deviation) = self.middle();
        // Of the line: three of where it starts, eight of its change, shares of time included; one
        // where either end is moved.
        let size = self.start.abs() + self.change.abs() + middle.abs();
        let rounding = size * (9.0 * ROUNDING);
        // A run of cubics is about the line to its end, even if that takes no time.
        let end_shift = (end - self.start - self.change).abs();
        CubicRun::new(&ScaledRun {
            start: self.start + middle,
            end: end + middle,
            low: self.low,
            high: self.high,
            spread: self.spread,
            deviation: (deviation + rounding + end_shift) * (1.0 + 4.0 * ROUNDING),
        })
    }

    /// Returns the fat line, and the box rounded outward, in the frame's unit. `first` is the cubic
    /// that the body follows first. Where the frame does not serve, the fat line is infinite, and the
    /// box as large as `f32` allows.
    #[inline(always)]
    pub(crate) fn finish(&self, placement: &FramePlacement, first: u32) -> (FatLine, Aabb) {
        let Self { low, high, .. } = *self;
        // How far rounding can have moved each coordinate, before it was measured from a moving box.
        let displacement = self.slice.displacement().abs();
        let largest = low.abs().max(high.abs()) + displacement;
        let rounding =
            SubCubic::roundings(largest, self.spread, self.splits) + placement.constant_rounding;
        let (middle, deviation) = self.middle();
        let (start, change) = (placement.origin + (self.start + middle), self.change);
        // One where the line is moved.
        let moved = rounding + middle.abs() * ROUNDING;
        let fat_line = fat_line(start, change, (deviation, moved), placement.reach, first);
        // Of the origin, of the two sums with it, and of the subtraction below: 4; and more than the
        // clearance of rejections. Of the displacement at an instant: six at most, with that of the difference.
        let rounding = rounding + (placement.origin.abs() + displacement) * (6.0 * ROUNDING);
        let low = (placement.low + low - rounding).max(Vec4::splat(f32::MIN));
        let high = (placement.high + high + rounding).min(Vec4::splat(f32::MAX));
        let aabb = Aabb::new(
            Vector::new(low.x, low.y, low.z),
            Vector::new(high.x, high.y, high.z),
        );
        (fat_line, aabb)
    }
}

/// Returns the fat line with this deviation of the control points per axis, rounding included.
#[inline(always)]
fn fat_line(
    start: Vec4,
    change: Vec4,
    (deviation, rounding): (Vec4, Vec4),
    reach: f32,
    first: u32,
) -> FatLine {
    let deviation = deviation * deviation;
    // Eight of the line's change. Two are for a point of the line (share and product), one is for its thirds. A line may
    // start farther from the anchor than its body goes, by at most the change: one more where the line is moved and one of
    // the origin. The others exceed all terms of second order. `rounding` holds those of the body's coordinates.
    let rounding = rounding + (start.abs() + change.abs()) * (LINE_ROUNDINGS * ROUNDING);
    let radius = (deviation.x + deviation.y + deviation.z).sqrt()
        + VANISHING
        + reach
        + (rounding.x + rounding.y + rounding.z);
    FatLine {
        start: [start.x, start.y, start.z],
        change: [change.x, change.y, change.z],
        // A few roundings of itself.
        radius: radius * (1.0 + 8.0 * ROUNDING),
        first,
    }
}

/// Lengths below this may vanish when squared. The frame's unit keeps worlds larger than 1e-10.
const VANISHING: f32 = 1e-18;

#[cfg(test)]
mod tests;
