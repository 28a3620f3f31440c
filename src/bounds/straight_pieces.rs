//! Straight motions, one after another, and their bounds in a slice.

use super::builder::BoundsBuilder;
use super::fat_line::FatLine;
use super::frame::{Frame, MovingFrame, Padding};
use super::placement::FramePlacement;
use super::slice_interval::SliceInterval;
use super::straight_part::StraightPart;
use crate::count::short;
use crate::rounding::earliest_exact;
use crate::trajectory::{StraightMotion, Trajectory, count_at_end};
use arrayvec::ArrayVec;
use parry3d::bounding_volume::Aabb;
use std::iter::once;
use std::ops::RangeInclusive;

/// Largest number of places of a body that teleports in a slice.
pub(crate) const MAX_PLACES: usize = 4;

/// Straight motions, one after another. The last one goes on for ever.
#[derive(Clone, Copy, Debug)]
pub(crate) struct StraightPieces<'a> {
    motions: &'a [StraightMotion],
    /// The beginning of each motion, and the end of the first piece of the last one.
    knots: &'a [f64],
    /// Number of the first motion among the body's cubics.
    before: usize,
    placement: FramePlacement,
}

impl<'a> StraightPieces<'a> {
    /// Returns the pieces of a motion, with so many cubics before them, if it follows nothing else from an instant (s)
    /// on.
    #[inline(always)]
    pub(crate) fn over(
        plan: &'a Trajectory,
        before: usize,
        from: f64,
        (padding, frame): (&Padding, &Frame),
    ) -> Option<Self> {
        // Not anchored at a state, which may be far away if it is old.
        let placement = || FramePlacement::of_frame(padding, frame);
        Self::placed((plan, before), from, placement)
    }

    /// Returns them in another placement.
    #[inline(always)]
    pub(super) fn placed(
        (plan, before): (&'a Trajectory, usize),
        from: f64,
        placement: impl FnOnce() -> FramePlacement,
    ) -> Option<Self> {
        let (motions, knots) = (plan.straight_motions(), plan.piece_knots());
        // A piece before the first knot that ends as the slice begins counts with its last point. Without one, the first motion
        // may be followed back by what rounds to the instant of the knot.
        let is_within = knots[0] < from || (before == 0 && earliest_exact(knots[0]) <= from);
        (!motions.is_empty() && is_within).then(|| Self {
            motions,
            knots,
            before,
            placement: placement(),
        })
    }

    /// Returns the bounds of the body in a slice that begins no earlier than what rounds to the first knot. (Beyond the listed knots, their
    /// first cubic is named as the last one that is listed: searches for cubics go on from there.)
    #[inline(always)]
    pub(crate) fn bounds<const MOVES: bool>(
        &self,
        slice_interval: &SliceInterval<MOVES>,
    ) -> (FatLine, Aabb) {
        let (first, last) = self.pieces_in(slice_interval);
        let (from, to) = (slice_interval.from, slice_interval.to);
        let builder = if first == last {
            BoundsBuilder::straight(&self.part(first, (from, to)), slice_interval)
        } else {
            let head = self.part(first, (from, self.knots[first + 1]));
            let tail = self.part(last, (self.knots[last], to));
            let mut builder = BoundsBuilder::along(&head, &tail, slice_interval);
            for number in first + 1..last {
                let ends = (self.knots[number], self.knots[number + 1]);
                builder.go_straight(&self.part(number, ends));
            }
            builder.go_straight(&tail);
            builder
        };
        builder.finish(&self.placement, short(self.before + first))
    }

    /// Returns the bounds in each part of a slice between the instants at which the body teleports; none if it does not. The
    /// bounds of the whole slice hold all that lies between the places. The last part holds what there is no room for.
    pub(crate) fn bounds_by_teleport(
        &self,
        frame: &MovingFrame,
        (from, to): (f64, f64),
    ) -> ArrayVec<(FatLine, Aabb), MAX_PLACES> {
        if frame.moves() {
            self.parts_by_teleport(&frame.slice_interval(from, to))
        } else {
            self.parts_by_teleport(&SliceInterval::new(from, to))
        }
    }

    fn parts_by_teleport<const MOVES: bool>(
        &self,
        slice_interval: &SliceInterval<MOVES>,
    ) -> ArrayVec<(FatLine, Aabb), MAX_PLACES> {
        let (first, last) = self.pieces_in(slice_interval);
        let (from, to) = (slice_interval.from, slice_interval.to);
        let part = |number: usize| {
            let until = if number < last {
                self.knots[number + 1]
            } else {
                to
            };
            self.part(number, (from.max(self.knots[number]), until))
        };
        let teleports = |&number: &usize| self.teleports_between(&part(number - 1), &part(number));
        let later = (first + 1..=last).filter(teleports);
        let begins: ArrayVec<usize, MAX_PLACES> =
            once(first).chain(later).take(MAX_PLACES).collect();
        if begins.len() < 2 {
            return ArrayVec::new();
        }
        let bounds = |pieces: RangeInclusive<usize>| {
            let (head, tail) = (part(*pieces.start()), part(*pieces.end()));
            let mut builder = BoundsBuilder::along(&head, &tail, slice_interval);
            for number in pieces.skip(1) {
                builder.go_straight(&part(number));
            }
            // All are examined from the first cubic of the slice on.
            builder.finish(&self.placement, short(self.before + first))
        };
        let ends = begins[1..].iter().map(|next| next - 1).chain(once(last));
        begins
            .iter()
            .zip(ends)
            .map(|(&begin, end)| bounds(begin..=end))
            .collect()
    }

    /// Returns the numbers of the first and the last piece in a slice.
    #[inline(always)]
    fn pieces_in<const MOVES: bool>(
        &self,
        slice_interval: &SliceInterval<MOVES>,
    ) -> (usize, usize) {
        /// Pieces that are gone through one by one.
        const FEW: usize = 8;
        let ends = &self.knots[1..self.motions.len()];
        // A piece that ends as the slice begins counts with its last point, as one does that begins at its end.
        let first = if ends.len() <= FEW {
            ends.iter()
                .take_while(|&&end| end < slice_interval.from)
                .count()
        } else {
            count_before(ends, slice_interval.from)
        };
        let later = ends[first..]
            .iter()
            .take_while(|&&end| end <= slice_interval.to);
        (first, first + later.count())
    }

    /// Returns true if a part begins farther from the end of the part before it than either of them moves.
    #[inline(always)]
    fn teleports_between(&self, before: &StraightPart, after: &StraightPart) -> bool {
        let displacements = (before.last - before.first).abs() + (after.last - after.first).abs();
        let jump = (after.first - before.last).abs();
        jump.max_element() > displacements.max_element() + self.placement.reach
    }

    /// Returns the part of a motion between two instants (s).
    #[inline(always)]
    fn part(&self, number: usize, ends: (f64, f64)) -> StraightPart {
        StraightPart::new(&self.motions[number], ends, &self.placement.anchor)
    }
}

/// Returns the number of instants (s) before another one. Not part of the loop that forms boxes.
#[inline(never)]
fn count_before(instants: &[f64], time: f64) -> usize {
    count_at_end(instants, |instant| instant < time)
}

#[cfg(test)]
mod tests {
    use super::super::CubicSource;
    use super::*;
    use crate::hitbox::Hitbox;
    use crate::knots::Knots;
    use crate::rounding::exact::{Exact, number};
    use crate::search::SliceBlock;
    use crate::trajectory::{Segment, State, Trajectory};
    use crate::window::Window;
    use glam::DVec3;
    use rand::rngs::ChaCha8Rng;
    use rand::{RngExt, SeedableRng};

    /// Returns a body that was told its state again and again, at last at 0 s: up to three straight
    /// motions from -1 s on.
    fn told(rng: &mut ChaCha8Rng, age: f64, far: f64) -> Trajectory {
        let mut vector =
            |half: f64| DVec3::from_array([0; 3].map(|_| rng.random_range(-half..half)));
        let mut motion = |told: f64| {
            let (position, velocity) = (vector(far), vector(20.0));
            let state = State::new(told - age, position - age * velocity, velocity);
            Trajectory::coasting_motion(&state).unwrap_or_else(|_| unreachable!("it is usable"))
        };
        let mut trajectory = Trajectory::of_straight(motion(-1.0));
        let window = Window::new(-0.5, 3.0).unwrap_or_else(|_| unreachable!());
        for told in [-0.8, -0.5, -0.2, 0.0] {
            let next = motion(told);
            let since = told - 0.25;
            if trajectory.can_replace((told, since), &next, window) {
                trajectory.replace(told, &next, since);
            } else {
                let mut plan = Trajectory::of_straight(next);
                assert!(plan.precede_by(&trajectory, told, told - 0.1).is_ok());
                trajectory = plan;
            }
        }
        trajectory
    }

    /// Returns the bounds in the parts of a slice, if the body teleports in it.
    fn parts_by_teleport(
        trajectory: &Trajectory,
        padding: &Padding,
        frame: &MovingFrame,
        ends: &[f64],
    ) -> ArrayVec<(FatLine, Aabb), MAX_PLACES> {
        let interval = (ends[0], ends[1]);
        let pieces = StraightPieces::over(trajectory, 0, interval.0, (padding, frame));
        let parts = pieces.map(|pieces| pieces.bounds_by_teleport(frame, interval));
        parts.unwrap_or_default()
    }

    /// Boxes and fat lines of slices in which a motion is replaced hold the body, and more than twice the
    /// solver's error around it: also where its states are old, and their displacement cancels with their position.
    #[test]
    fn motions_told_one_after_another_are_held() {
        const SEEN: f64 = 2.25;
        let mut rng = ChaCha8Rng::seed_from_u64(11);
        let (mut tightest, mut replaced, mut teleported) = (f64::INFINITY, 0, 0);
        for round in 0..600 {
            let age = [0.0, 1.0, 1e6, 1e9, 1e13][round % 5];
            let far = [1.0, 1e5][round / 5 % 2];
            let trajectory = told(&mut rng, age, far);
            assert!(!trajectory.straight_motions().is_empty());
            let frame = Frame::amid(
                super::super::DAabb {
                    low: DVec3::splat(-far),
                    high: DVec3::splat(far),
                },
                super::super::DAabb::NOTHING,
                0.0,
            );
            let padding = Padding::of(&Hitbox::POINT, 0.0, &frame);
            let window = Window::new(-0.1, 70.0).unwrap_or_else(|_| unreachable!());
            let extension = trajectory.extension(window);
            let extension = extension.unwrap_or_else(|_| unreachable!("it goes on for ever"));
            let knots = Knots::over(&trajectory, extension.as_ref());
            let source = CubicSource::<Segment>::straight(knots, &padding, &frame);
            let common = [DVec3::ZERO, DVec3::new(9.0, -3.0, 1.0)][round % 2];
            let moving = frame.moving(common);
            // From the fifth on beyond the listed knots, but of old states.
            let ends = [-0.1, 0.0, 0.7, 0.7, 2.0, 6.5, 7.0, 60.0, 70.0];
            let mut block = SliceBlock::default();
            block.form_one(&moving, &source, &ends);
            for (slice, ends) in block.slices.iter().zip(ends.windows(2)) {
                let whole = (slice.fat_lines[0], slice.boxes[0].aabb);
                let parts = parts_by_teleport(&trajectory, &padding, &moving, ends);
                teleported += usize::from(!parts.is_empty());
                for step in 0..=4 {
                    let share = f64::from(step) / 4.0;
                    let time = ends[0] + share * (ends[1] - ends[0]);
                    let piece = trajectory.piece_knots()[1..]
                        .iter()
                        .take_while(|&&cut| cut < time)
                        .count();
                    replaced += usize::from(piece > 0);
                    let motion = &trajectory.straight_motions()
                        [piece.min(trajectory.straight_motions().len() - 1)];
                    let since = number(time) - number(motion.start());
                    let position = Exact::of(motion.origin())
                        .plus(&Exact::of(motion.velocity()).times(&since));
                    let position = position.minus(&Exact::of(frame.origin));
                    let moved = Exact::of(common).times(&(number(time) - number(ends[0])));
                    let error = motion.segment().restrict(time, time).error;
                    let inside = |aabb: &Aabb, seen: f64| {
                        let room = DVec3::splat(seen * error);
                        let [low, high] = [aabb.mins, aabb.maxs].map(|corner| {
                            DVec3::new(corner.x.into(), corner.y.into(), corner.z.into())
                        });
                        let middle = (low + high) * 0.5;
                        let relative = position.minus(&moved).minus(&Exact::of(middle));
                        relative.is_within_box((high - low) * 0.5 - room)
                    };
                    assert!(inside(&whole.1, SEEN), "{round} {time} {trajectory:?}");
                    // Of the solver over the whole piece.
                    let since = (time - motion.start()).max(motion.duration());
                    let piece = (motion.start(), motion.start() + 3.0 * since);
                    let solver = motion.segment().restrict(piece.0, piece.1).error / error;
                    assert!(
                        time < 0.0 || inside(&whole.1, SEEN * solver),
                        "{round} {time} {solver} {trajectory:?}"
                    );
                    let mut most = SEEN;
                    while most < 1e3 && inside(&whole.1, most) {
                        most *= 1.2;
                    }
                    tightest = tightest.min(most);
                    let vector =
                        |coordinates: [f32; 3]| DVec3::from_array(coordinates.map(f64::from));
                    let on_line = |line: &FatLine| {
                        let point = Exact::of(vector(line.start))
                            .plus(&Exact::of(vector(line.change)).times(&number(share)));
                        position.minus(&point).is_within(line.radius.into())
                    };
                    assert!(on_line(&whole.0), "{round} {time}");
                    let is_held =
                        |(line, aabb): &(FatLine, Aabb)| on_line(line) && inside(aabb, SEEN);
                    assert!(
                        parts.is_empty() || parts.iter().any(is_held),
                        "{round} {time} {trajectory:?}"
                    );
                }
            }
        }
        // Where that error is all there is, it is held about twenty times; that of a state whose time is coarse is three
        // times as large.
        assert!(tightest < 32.0 && replaced > 1_000, "{tightest} {replaced}");
        assert!(teleported > 400, "{teleported}");
    }
}
