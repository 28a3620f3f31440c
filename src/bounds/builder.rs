//! A body's box and fat line in one slice, under construction.

use super::ROUNDING;
use super::cubic_run::{CubicRun, ScaledRun};
use super::fat_line::FatLine;
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
    /// The other magnitude of rounding, and the largest number of splits of a piece.
    spread: f32,
    splits: f32,
    /// Least and largest deviation from the line on each axis.
    least: Vec4,
    most: Vec4,
    /// The line from the start of the first piece to the end of the last one.
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
        let mut builder = Self::toward((head.points[0], head.from), tail.points[3], slice);
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
            // It does not go through the ends of their lines.
            low: first.low,
            high: first.high,
            ..Self::toward((first.start, slice.from), last.end, slice)
        }
    }

    /// Returns the bounds of a single straight piece that lasts for all of a slice.
    #[inline(always)]
    pub(super) fn straight(piece: &StraightPart, slice: &SliceInterval<MOVES>) -> Self {
        let last = slice.relative_at(piece.last, 1.0);
        let way = piece.last - piece.first;
        // The line of a slice of no duration is a point.
        let (change, aside) = if slice.rate > 0.0 {
            (way, Vec4::ZERO)
        } else {
            (Vec4::ZERO, way)
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
        let mut builder = Self::toward((head.first, head.from), tail.last, slice);
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

    /// Starts a builder on the line from a point at an instant (s) to another point.
    #[inline(always)]
    fn toward((start, from): (Vec4, f64), end: Vec4, slice: &SliceInterval<MOVES>) -> Self {
        // The line of a slice of no duration is a point: any distance from it counts as deviation.
        let change = if slice.rate > 0.0 {
            end - start
        } else {
            Vec4::ZERO
        };
        let share = slice.share(from);
        let line = start + change * share;
        let point = slice.relative_at(start, share);
        Self {
            low: point,
            high: point,
            spread: 0.0,
            splits: 0.0,
            least: start - line,
            most: start - line,
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
    pub(super) fn sum_up(&self, end: Vec4) -> CubicRun {
        let (middle, deviation) = self.middle();
        // Of the line: three of where it starts, eight of its change, shares of time included; one
        // where either end is moved.
        let size = self.start.abs() + self.change.abs() + middle.abs();
        let rounding = size * (9.0 * ROUNDING);
        // A run of cubics is about the line to its end, even if that takes no time.
        let turned = (end - self.start - self.change).abs();
        CubicRun::new(&ScaledRun {
            start: self.start + middle,
            end: end + middle,
            low: self.low,
            high: self.high,
            spread: self.spread,
            deviation: (deviation + rounding + turned) * (1.0 + 4.0 * ROUNDING),
        })
    }

    /// Returns the fat line, and the box rounded outward, in the frame's unit; infinite where the
    /// frame does not serve. `first` is the cubic that the body follows first.
    #[inline(always)]
    pub(crate) fn finish(&self, placement: &FramePlacement, first: u32) -> (FatLine, Aabb) {
        let Self { low, high, .. } = *self;
        // How far rounding can have moved each coordinate, before it was measured from a moving box.
        let displacement = self.slice.displacement().abs();
        let largest = low.abs().max(high.abs()) + displacement;
        let rounding = SubCubic::roundings(largest, self.spread, self.splits) + placement.steady;
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
    // Eight of the line's change; of where it starts relative to the anchor, `rounding` holds those.
    let rounding = rounding + (start.abs() + change.abs()) * (8.0 * ROUNDING);
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
mod tests {
    use super::super::compact_trajectory::CompactTrajectory;
    use super::super::cubic_run::largest;
    use super::super::{CubicSource, DAabb, Frame, Padding};
    use super::*;
    use crate::hitbox::Hitbox;
    use crate::knots::Knots;
    use crate::rounding::exact::{Exact, number};
    use crate::search::{FormBounds, SliceBlock};
    use crate::simd::InstructionSet;
    use crate::trajectory::{State, Trajectory};
    use glam::DVec3;
    use rand::rngs::ChaCha8Rng;
    use rand::{RngExt, SeedableRng};

    /// A motion that bends one way deviates from its fat line half as far as from the chord.
    #[test]
    fn fat_lines_lie_in_the_middle_of_a_bend() {
        let thrown = |time: f64| {
            let (start, velocity) = (DVec3::new(3.0, 5.0 * time, 0.0), DVec3::new(4.0, 5.0, 0.0));
            let fall = DVec3::X * (-4.0 * time);
            State::new(
                time,
                start + velocity.x * DVec3::X * time + 0.5 * time * fall,
                velocity + fall,
            )
        };
        // It rises 2 m and falls again, in one cubic, in several, and in runs of them.
        for count in [1, 3, 40] {
            let states = (0..=count).map(|k| thrown(2.0 * f64::from(k) / f64::from(count)));
            let Ok(flight) = Trajectory::from_states(&states.collect::<Vec<_>>()) else {
                unreachable!("the states are in order")
            };
            let (compact, lines) = CompactTrajectory::of(flight.knots(), flight.segments());
            let frame = Frame::around(DAabb::NOTHING, 0.0);
            let hitbox = Hitbox::POINT;
            let padding = Padding::of(&hitbox, 0.0, &frame);
            let source = CubicSource::compact(
                Knots::of(flight.knots()),
                &compact.on(&lines),
                &padding,
                &frame,
            );
            let mut block = SliceBlock::default();
            InstructionSet::best().run(FormBounds {
                block: &mut block,
                frame: &frame.moving(DVec3::ZERO),
                sources: &[source],
                present: &[0],
                ends: &[0.0, 2.0],
            });
            let fat_line = block.slices[0].fat_lines[0];
            assert!(
                (fat_line.start[0] - 4.0).abs() < 0.15,
                "{count} {fat_line:?}"
            );
            assert!(
                fat_line.radius > 1.0 && fat_line.radius < 1.15,
                "{count} {fat_line:?}"
            );
        }
    }

    /// The deviation of a run bounds that of its cubics for every line, and is not much larger.
    #[test]
    fn runs_stray_as_far_as_their_cubics() {
        let mut rng = ChaCha8Rng::seed_from_u64(4);
        let mut lengths = [0; 65];
        for round in 0..400 {
            // Straight flight strays at its ends, wild flight in between.
            let wild = if round % 2 == 0 { 0.0 } else { 3.0 };
            let mut vector =
                |half: f64| DVec3::from_array([0; 3].map(|_| rng.random_range(-half..=half)));
            let velocity = vector(1.0);
            let states: Vec<State> = (0..=64)
                .map(|k| {
                    let time = f64::from(k) + 0.3 * f64::from(k % 3);
                    State::new(
                        time,
                        velocity * time + vector(wild),
                        velocity + vector(wild),
                    )
                })
                .collect();
            let Ok(flight) = Trajectory::from_states(&states) else {
                unreachable!("the states are in order")
            };
            let knots = flight.knots();
            let (compact, lines) = CompactTrajectory::of(knots, flight.segments());
            let view = compact.on(&lines);
            let (compact_cubics, runs) = (view.compact_cubics, view.runs);
            assert_eq!(runs.len(), 16 + 4 + 1);
            let first = 4 * rng.random_range(0..16);
            let Some((run, count)) = largest(runs, compact_cubics.len(), first, 64) else {
                unreachable!("there is one of four cubics at least")
            };
            lengths[count] += 1;
            let slice = SliceInterval::new(knots[first] - 1.0, knots[first + count] + 2.0);
            let mut anywhere = || Vec4::from_array([0; 4].map(|_| rng.random_range(-1.0..=1.0)));
            let (start, end) = (anywhere(), anywhere());
            let mut whole = BoundsBuilder::toward((start, knots[first]), end, &slice);
            let mut by_run = whole;
            by_run.pass(&run.unpack(1.0), knots[first + count]);
            for number in first..first + count {
                let ends = (knots[number], knots[number + 1]);
                whole.follow_from_start(&SubCubic::whole(&compact_cubics[number], ends, 1.0));
            }
            let curved = run.unpack(1.0).deviation.truncate();
            // To either side.
            for (near, far) in [(whole.most, by_run.most), (-whole.least, -by_run.least)] {
                let (near, far) = (near.truncate(), far.truncate());
                assert!(far.cmpge(near - 1e-6 * near.abs()).all(), "{near} {far}");
                assert!(far.cmple(near + 2.0 * curved + 1e-6).all(), "{near} {far}");
            }
            assert_eq!((whole.low.truncate(), whole.high.truncate()), {
                (by_run.low.truncate(), by_run.high.truncate())
            });
        }
        assert!(lengths[4] > 100 && lengths[16] > 30 && lengths[64] > 5);
    }

    /// Deviation and extent of a body against an exactly known line, for all sizes, also where
    /// squares underflow.
    #[test]
    fn slacks_are_rounded_outward() {
        let mut rng = ChaCha8Rng::seed_from_u64(7);
        for round in 0..20_000 {
            let unit = [1.0, 1e-10, 1e-23][round % 3];
            let mut lane = || unit * rng.random_range(0.0_f32..1.0);
            let deviation = Vec4::new(lane(), lane(), lane(), 0.0);
            let rounding = Vec4::new(lane(), lane(), lane(), 0.0) * [0.0, 1.0][round / 3 % 2];
            let reach = lane() * [0.0, 1.0][round / 6 % 2];
            let found = fat_line(Vec4::ZERO, Vec4::ZERO, (deviation, rounding), reach, 0);
            let parts = [reach, rounding.x, rounding.y, rounding.z];
            let others = parts.map(|part| number(f64::from(part))).into_iter();
            let left = number(f64::from(found.radius)) - others.fold(number(0.0), |a, b| a + b);
            let deviation = Exact::of(deviation.truncate().as_dvec3());
            assert!(
                deviation.is_within_exactly(&left),
                "{round} {deviation:?} {found:?}"
            );
        }
    }

    /// Returns the deviation of a run of cubics of no duration, and the end of its line.
    #[test]
    fn strays_of_runs_are_rounded_outward() {
        let mut rng = ChaCha8Rng::seed_from_u64(8);
        for _ in 0..5_000 {
            let (deviation, end): (f32, f32) = (rng.random(), rng.random());
            let mut builder =
                BoundsBuilder::toward((Vec4::ZERO, 1.0), Vec4::ZERO, &SliceInterval::new(1.0, 1.0));
            (builder.least, builder.most) = (Vec4::splat(-deviation), Vec4::splat(deviation));
            let run = builder.sum_up(Vec4::splat(end)).unpack(1.0);
            let exact = number(f64::from(deviation)) + number(f64::from(end));
            assert!(
                number(f64::from(run.deviation.x)) >= exact,
                "{deviation} {end}"
            );
        }
    }

    /// Bodies at rest, in boxes that move far, and bodies that move along with them, from any
    /// instant of a slice.
    #[test]
    fn places_in_moving_boxes_are_within_their_rounding() {
        let mut rng = ChaCha8Rng::seed_from_u64(9);
        for round in 0..20_000 {
            let mut vector =
                |half: f64| DVec3::from_array([0; 3].map(|_| half * rng.random_range(-1.0..1.0)));
            let (way, aside) = (vector(1e6).as_vec3().as_dvec3(), vector(1.0));
            let from = [0.0_f32, 0.5, 0.999, 0.999_999][round % 4] * rng.random_range(0.9_f32..1.0);
            let from = f64::from(from);
            let slice = SliceInterval::new(0.0, 1.0).moving(way);
            let rests = round % 3 == 0;
            let points = [0.0, 1.0, 2.0, 3.0].map(|step| {
                let share = if rests {
                    1.0
                } else {
                    from + (1.0 - from) * step / 3.0
                };
                (way * share + aside).as_vec3().extend(0.0)
            });
            let spread = (points[3] - points[0]).truncate().length();
            let piece = SubCubic {
                points,
                spread,
                splits: 0.0,
                from,
                to: 1.0,
            };
            let builder = BoundsBuilder::between(&piece, &piece, &slice);
            let (_, aabb) = builder.finish(&FramePlacement::NONE, 0);
            let [low, high] = [aabb.mins, aabb.maxs]
                .map(|edge| DVec3::new(edge.x.into(), edge.y.into(), edge.z.into()));
            for (share, point) in [(from, points[0]), (1.0, points[3])] {
                let point = point.truncate().as_dvec3() - way * share;
                assert!(low.cmple(point).all() && high.cmpge(point).all(), "{round}");
            }
        }
    }

    /// In a slice of no duration, a body and the line may be anywhere on the body's path.
    #[test]
    fn runs_of_no_duration_stray_as_far_as_both_ends() {
        let points = [0.0, 0.25, 0.5, 1.0].map(|x| Vec4::new(x, 0.0, 0.0, 0.0));
        let piece = SubCubic {
            points,
            spread: 1.0,
            splits: 0.0,
            from: 1.0,
            to: 1.0,
        };
        let builder = BoundsBuilder::between(&piece, &piece, &SliceInterval::new(1.0, 1.0));
        let run = builder.sum_up(points[3]).unpack(1.0);
        let farthest = (run.end.x - points[0].x).max(points[3].x - run.start.x);
        assert!(run.deviation.x >= farthest, "{farthest}");
    }
}
