//! Bézier points of a part of a segment, with all f64 errors.

use super::ROUNDING;
use crate::rounding::{largest_norm, norm};
use crate::trajectory::{Restriction, Segment};
use glam::DVec3;

/// Bézier points relative to the segment's origin, m: the input of a compact cubic.
pub(super) struct InexactPoints {
    pub(super) points: [DVec3; 4],
    /// Largest distance of a point from the first one, m.
    pub(super) extent: f64,
    /// Error of the points and the solver's rounding, m: a quarter of what a box adds for both.
    pub(super) error: f64,
}

impl InexactPoints {
    /// Returns the points of a segment between two instants (s), also beyond its knots.
    ///
    /// Four times the error covers all f64 errors:
    ///
    /// - The points are off by `e`, their own error, which grows with the distance from the knots.
    ///   So are the solver's points. The solver reports contacts within its tolerance of the
    ///   threshold: 2 `e` from the motion, or 2.25 `e` if certified: the certified
    ///   search ends within a quarter of `e`. With the box's own points that is 3.25 `e`.
    /// - The rest of its tolerance: 48 roundings of the extents of both bodies in the span,
    ///   negligible against f32; one of the points' distance from the origin; two of the distance
    ///   between both segments' origins. For near bodies the last is at most the sum of both
    ///   bodies' distances. `e` contains 12 roundings of the points' distance, so this part is 0.25
    ///   `e`.
    ///
    /// `e` does not follow from the position: terms of an extrapolated cubic may far exceed their
    /// sum.
    #[inline(always)]
    pub(super) fn of(segment: &Segment, (from, to): (f64, f64)) -> Self {
        let is_whole =
            segment.start().to_bits() == from.to_bits() && segment.end().to_bits() == to.to_bits();
        if is_whole {
            // The first point is the origin, and what the others are rounded by is below the f32
            // roundings that a box has to spare for the extent.
            return Self {
                points: segment.control_points(),
                extent: segment.extent(),
                error: segment.error(),
            };
        }
        let Restriction { points, error } = segment.restrict(from, to);
        let [p0, p1, p2, p3] = points;
        // A few roundings of the lengths are below those of f32.
        let extent = if segment.is_straight() {
            norm(p3 - p0)
        } else {
            largest_norm(&[p1 - p0, p2 - p0, p3 - p0])
        };
        Self {
            points,
            extent,
            error,
        }
    }

    /// Returns the magnitude to which f32 rounding of the points is relative, besides their size,
    /// m. A box takes at least four roundings of it ([`SubCubic::OF_SPREAD`](super::SubCubic::OF_SPREAD)),
    /// hence four times the error.
    pub(super) fn spread(&self) -> f64 {
        self.extent + self.error / f64::from(ROUNDING)
    }
}

#[cfg(test)]
mod tests {
    use super::super::{
        CompactCubic, CompactTrajectory, CubicSource, DAabb, Frame, Padding, ROUNDING, SubCubic,
    };
    use super::InexactPoints;
    use crate::hitbox::Hitbox;
    use crate::knots::Knots;
    use crate::search::{SliceBlock, SliceBounds};
    use crate::trajectory::{DoubleDouble, Outside, Pieces, State, TimeBase, Trajectory};
    use crate::window::Window;
    use glam::DVec3;
    use rand::rngs::ChaCha8Rng;
    use rand::{RngExt, SeedableRng};

    /// A plan over a window, and its pieces.
    struct PlanPieces {
        plan: Trajectory,
        window: Window,
        pieces: Pieces,
        /// Replaces the plan's own pieces if true.
        by_points: bool,
    }

    /// Two states, and the rule before and after them.
    struct Flight {
        states: [State; 2],
        outside: Outside,
        /// Continues as the segment between them, given by its control points alone.
        by_points: bool,
    }

    impl Flight {
        /// Returns a segment of any size and duration; it bends, often only by rounding.
        fn any(rng: &mut ChaCha8Rng) -> Self {
            let mut power = |from: f64, to: f64| 10f64.powf(rng.random_range(from..to));
            let (size, duration, bend) = (power(-3.0, 3.0), power(-3.0, 3.0), power(-18.0, 0.0));
            let far = size * [0.0, 1e4][usize::from(rng.random_bool(0.5))];
            let begin = [0.0, 1.7e9][usize::from(rng.random_bool(0.5))];
            let mut vector =
                |half: f64| DVec3::from_array([0; 3].map(|_| half * rng.random_range(-1.0..1.0)));
            let (position, velocity) = (vector(far), vector(size / duration));
            let state = |time: f64, bend: DVec3| {
                let position = position + velocity * (time - begin);
                State::new(time, position, velocity + bend)
            };
            let bends = [0, 1].map(|_| vector(bend * size / duration));
            Self {
                states: [state(begin, bends[0]), state(begin + duration, bends[1])],
                outside: [Outside::Extrapolate, Outside::Coast][usize::from(rng.random_bool(0.2))],
                by_points: rng.random_bool(0.5),
            }
        }

        /// Returns its pieces over so many of its durations, before and after.
        fn pieces(&self, (before, after): (f64, f64)) -> PlanPieces {
            let plan = Trajectory::from_states(&self.states);
            let plan = plan.map(|plan| plan.with_outside(self.outside));
            let [first, last] = [0, 1].map(|k: usize| self.states[k].time);
            let duration = last - first;
            let window = Window::new(first - before * duration, last + after * duration);
            let (Ok(plan), Ok(window)) = (plan, window) else {
                unreachable!("the states are in order")
            };
            let mut pieces = Pieces::over(&plan, window);
            let by_points = self.by_points && self.outside == Outside::Extrapolate;
            if by_points {
                pieces.segments.fill(plan.segments()[0]);
            }
            PlanPieces {
                plan,
                window,
                pieces,
                by_points,
            }
        }

        /// Returns the position in a frame, in double-double and rounded once.
        fn position(&self, time: f64, frame: &Frame) -> DVec3 {
            let [first, last] = &self.states;
            let since = |state: &State| DoubleDouble::difference(time, state.time);
            let exact = DoubleDouble::from;
            let straight = |state: &State, axis: usize| {
                exact(state.position[axis]) + exact(state.velocity[axis]) * since(state)
            };
            let duration = DoubleDouble::difference(last.time, first.time);
            let position = |axis: usize| match self.outside {
                Outside::Coast if time < first.time => straight(first, axis),
                Outside::Coast if time > last.time => straight(last, axis),
                // The straight motion through both, and what both velocities add to it.
                _ => {
                    let [from, to] = [first, last].map(|state| state.position[axis]);
                    let rate = DoubleDouble::difference(to, from).quotient(duration);
                    let (s, r) = (
                        since(first).quotient(duration),
                        since(last).quotient(duration),
                    );
                    let [leave, arrive] =
                        [first, last].map(|state| exact(state.velocity[axis]) + exact(-1.0) * rate);
                    let bend = leave * since(first) * r * r + arrive * since(last) * s * s;
                    exact(from) + rate * since(first) + bend
                }
            };
            let in_frame = |axis: usize| {
                let position = position(axis) + exact(-frame.origin[axis]);
                (position * exact(frame.power)).rounded()
            };
            DVec3::from_array([0, 1, 2].map(in_frame))
        }
    }

    /// Returns the pieces in a frame around them, and the slices between some instants.
    fn check(
        plan_pieces: &PlanPieces,
        ends: &[f64],
        mut each: impl FnMut(&Frame, &CubicSource<'_, CompactCubic>, &[SliceBounds]),
    ) {
        let PlanPieces { plan, pieces, .. } = plan_pieces;
        let (compact, cache_lines) = CompactTrajectory::of(&pieces.knots, &pieces.segments);
        let (own, own_lines) = CompactTrajectory::of(plan.knots(), plan.segments());
        let all = compact.on(&cache_lines);
        let frame = all.frame;
        let padding = Padding::of(&Hitbox::POINT, 0.0, &frame);
        let source = if plan_pieces.by_points {
            CubicSource::compact(all.knots, &all, &padding, &frame)
        } else {
            let extension = plan.extension(plan_pieces.window);
            let extension = extension.unwrap_or_else(|_| unreachable!("it is near enough"));
            let knots = Knots::over(plan, extension.as_ref());
            assert_eq!(knots.cubics(), pieces.segments.len());
            CubicSource::compact(knots, &own.on(&own_lines), &padding, &frame)
        };
        let mut block = SliceBlock::default();
        block.form_one(&frame.moving(DVec3::ZERO), &source, ends);
        each(&frame, &source, &block.slices);
    }

    fn wide(lanes: [f32; 3]) -> DVec3 {
        DVec3::from_array(lanes.map(f64::from))
    }

    /// Pieces, boxes and fat lines contain the exact cubic, and the solver's error around it,
    /// however far beyond the knots.
    #[test]
    fn what_goes_beyond_the_knots_is_held() {
        /// Errors of the motion, without the box's own: see `InexactPoints::of`.
        const SEEN: f64 = 2.25;
        let mut rng = ChaCha8Rng::seed_from_u64(12);
        let mut tightest = f64::INFINITY;
        for round in 0..1_000 {
            let flight = Flight::any(&mut rng);
            let lengths = 10f64.powf(rng.random_range(0.0..9.0));
            let plan_pieces = flight.pieces([(lengths, lengths), (-0.5, lengths)][round % 2]);
            let pieces = &plan_pieces.pieces;
            let (first, last) = (pieces.knots[0], pieces.knots[pieces.knots.len() - 1]);
            // Short slices in the middle: numbers are small there, and those they come from are not.
            let ends = [0.0, 0.1, 0.4999, 0.5, 0.5001, 0.75, 1.0];
            let ends = ends.map(|share| first + share * (last - first));
            let between = |(from, to): (f64, f64), share: f64| (from + (to - from) * share).min(to);
            check(&plan_pieces, &ends, |frame, source, slices| {
                for (number, segment) in pieces.segments.iter().enumerate() {
                    let ends = (pieces.knots[number], pieces.knots[number + 1]);
                    let piece = source.sub_cubic::<true>(number);
                    let [p0, p1, p2, p3] = piece.points;
                    let at = source.placement.origin;
                    let rounding = piece.rounding() + source.placement.constant_rounding;
                    let rounding = rounding + at.abs() * (6.0 * ROUNDING);
                    let low = at + p0.min(p1).min(p2.min(p3)) - rounding;
                    let high = at + p0.max(p1).max(p2.max(p3)) + rounding;
                    let [low, high] = [low, high].map(|edge| wide(edge.truncate().to_array()));
                    let error = segment.restrict(ends.0, ends.1).error * frame.power;
                    for step in 0..=4 {
                        let position = flight.position(between(ends, f64::from(step) / 4.0), frame);
                        let room = (position - low).min(high - position).min_element();
                        assert!(room >= SEEN * error, "{round} {number} {room} {error}");
                        tightest = tightest.min(room / error);
                    }
                }
                for (slice, ends) in slices.iter().zip(ends.windows(2)) {
                    let ends = (ends[0], ends[1]);
                    let (fat_line, aabb) = (&slice.fat_lines[0], &slice.boxes[0].aabb);
                    let [low, high] = [aabb.mins, aabb.maxs].map(|edge| wide(edge.to_array()));
                    for step in 0..=4 {
                        let time = between(ends, f64::from(step) / 4.0);
                        let position = flight.position(time, frame);
                        // Instants may be coarse.
                        let share = (time - ends.0) / (ends.1 - ends.0).max(f64::MIN_POSITIVE);
                        let line = wide(fat_line.start) + share * wide(fat_line.change);
                        let deviation = position.distance(line);
                        assert!(
                            low.cmple(position).all() && high.cmpge(position).all(),
                            "{round}"
                        );
                        assert!(
                            deviation <= f64::from(fat_line.radius),
                            "{round} {deviation} {fat_line:?}"
                        );
                    }
                }
            });
        }
        // Four errors, where those are all.
        assert!(tightest < 4.5, "{tightest}");
    }

    /// Absolute-time polynomials whose coefficients are large next to their extent: boxes are
    /// larger by four times their error (in f32), whole or in part.
    #[test]
    fn what_is_badly_known_is_held() {
        for share in [0.0, 0.25] {
            let times = [1e6, 1e6 + 1.0];
            let terms = [0.0, 1.0, -2e6, 1e12].map(|x| DVec3::splat(1e-3 * x));
            let plan = Trajectory::from_coefficients(&times, &[terms], TimeBase::Absolute);
            let plan = plan.unwrap_or_else(|error| unreachable!("{error}"));
            let mut far = terms;
            far[3] += DVec3::splat(1e15);
            let far = Trajectory::from_coefficients(&times, &[far], TimeBase::Absolute);
            let far = far.unwrap_or_else(|error| unreachable!("{error}"));
            for plan in [plan, far] {
                let segment = &plan.segments()[0];
                let ends = (times[0] + share, times[1] - share);
                let part = InexactPoints::of(segment, ends);
                let error = segment.restrict(ends.0, ends.1).error;
                let known = if share > 0.0 { error } else { segment.error() };
                let frame = Frame {
                    origin: segment.origin(),
                    power: 1.0,
                };
                let compact_cubic = CompactCubic::of(segment, ends, &frame);
                let compact_cubic =
                    compact_cubic.unwrap_or_else(|| unreachable!("all is near the frame"));
                let piece = SubCubic::whole(&compact_cubic, ends, 1.0);
                let room = f64::from(piece.rounding().min_element());
                assert!(room >= 3.99 * known, "{room} {known}");
                assert!(known < 1e-6 || room < 5.0 * known + 1e-6 * part.extent);
            }
        }
    }

    /// Boxes far beyond the knots hardly exceed the body's path, also for short segments.
    #[test]
    fn what_goes_beyond_the_knots_is_held_closely() {
        /// Some f32 roundings of a compact trajectory whose numbers are near one.
        const FINE: f64 = 1.0 / 1_048_576.0;
        let turn = |time: f64| {
            let (sine, cosine) = (0.5 * time).sin_cos();
            let position = DVec3::new(2.0 * cosine, 2.0 * sine, 0.0);
            State::new(time, position, DVec3::new(-sine, cosine, 0.0))
        };
        let straight = |time: f64| State::new(time, DVec3::X * time, DVec3::X);
        let flights = [[turn(0.0), turn(0.2)], [straight(0.0), straight(0.2)]];
        for states in flights {
            let flight = Flight {
                states,
                outside: Outside::Extrapolate,
                by_points: false,
            };
            let plan_pieces = flight.pieces((3_000.0, 3_000.0));
            for begin in [1.0, 60.0, 300.0, 560.0] {
                let ends = [0.0, 1.0, 2.0, 3.0, 4.0].map(|second| begin + second);
                check(&plan_pieces, &ends, |frame, _, slices| {
                    for (slice, ends) in slices.iter().zip(ends.windows(2)) {
                        let mut way = DAabb::NOTHING;
                        for step in 0..=16 {
                            let time = ends[0] + (ends[1] - ends[0]) * f64::from(step) / 16.0;
                            let position = flight.position(time, frame);
                            way.include(DAabb::about(position, 0.0));
                        }
                        let aabb = &slice.boxes[0].aabb;
                        let size = f64::from(aabb.extents().max_element());
                        let needed = (way.high - way.low).max_element();
                        assert!(size < 1.1 * needed + FINE, "{begin}: {size} {needed}");
                        let radius = f64::from(slice.fat_lines[0].radius);
                        assert!(radius < needed + FINE, "{begin}: {radius} {needed}");
                    }
                });
            }
        }
    }
}
