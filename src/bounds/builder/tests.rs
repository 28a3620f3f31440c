//! Tests of boxes and fat lines under construction.

use super::super::compact_trajectory::CompactTrajectory;
use super::super::cubic_run::largest;
use super::super::{CubicSource, DAabb, Frame, Padding};
use super::*;
use crate::hitbox::Hitbox;
use crate::knots::Knots;
use crate::rounding::exact::{Exact, number};
use crate::search::SliceBlock;
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
        let frame = Frame::around(DAabb::NOTHING, 0.0);
        let fat_line = fat_line_in(&flight, &frame, ([0.0, 2.0], DVec3::ZERO));
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

/// Returns the fat line of a motion in a slice whose boxes move with a velocity (m/s).
fn fat_line_in(flight: &Trajectory, frame: &Frame, (ends, velocity): ([f64; 2], DVec3)) -> FatLine {
    let (compact, cache_lines) = CompactTrajectory::of(flight.knots(), flight.segments());
    let padding = Padding::of(&Hitbox::POINT, 0.0, frame);
    let knots = Knots::of(flight.knots());
    let view = compact.on(&cache_lines);
    let mut block = SliceBlock::default();
    let source = CubicSource::compact(knots, &view, &padding, frame);
    block.form_one(&frame.moving(velocity), &source, &ends);
    block.slices[0].fat_lines[0]
}

/// Bodies that begin or end in mid-slice are held at all their instants, by fat lines no thicker than twice those of the
/// motion in all of the slice, of which theirs is a part: straight, bent, in several cubics and in runs of them.
#[test]
fn bodies_that_exist_in_part_of_a_slice_have_thin_fat_lines() {
    let mut rng = ChaCha8Rng::seed_from_u64(10);
    let mut thinner = 0;
    for round in 0..2_000 {
        let bend = [0.0, 1.0, 30.0][round % 3];
        let far = [10.0, 1e5][round / 3 % 2];
        let count = [1, 3, 70][round / 6 % 3];
        let mut vector =
            |half: f64| DVec3::from_array([0; 3].map(|_| rng.random_range(-half..half)));
        let (place, velocity, fall) = (vector(far), vector(100.0), vector(1.0) * bend);
        let state = |time: f64| {
            let position = place + velocity * time + 0.5 * time * time * fall;
            State::new(time, position, velocity + time * fall)
        };
        let common = [DVec3::ZERO, vector(100.0)][round / 18 % 2];
        let flight = |from: f64, to: f64| {
            let step = (to - from) / f64::from(count);
            let states = (0..=count).map(|k| state(from + step * f64::from(k)));
            let Ok(flight) = Trajectory::from_states(&states.collect::<Vec<_>>()) else {
                unreachable!("the states are in order")
            };
            flight
        };
        // From the first instant or later on, up to the last one or less far; also for a short time.
        let least = [0.125, 1e-3][round / 36 % 2];
        let from = f64::max(rng.random_range(-0.2..1.0 - least), 0.0);
        let to = f64::min(rng.random_range(from + least..1.2), 1.0);
        let frame = Frame::around(DAabb::NOTHING, 0.0);
        let slice = ([0.0, 1.0], common);
        let part = fat_line_in(&flight(from, to), &frame, slice);
        let whole = fat_line_in(&flight(0.0, 1.0), &frame, slice);
        let wide = |lanes: [f32; 3]| DVec3::from_array(lanes.map(f64::from));
        for step in 0..=64 {
            let time = from + (to - from) * f64::from(step) / 64.0;
            let line = wide(part.start) + time * wide(part.change);
            let deviation = state(time).position.distance(line);
            assert!(deviation <= part.radius.into(), "{round} {time} {part:?}");
        }
        let [radius, of_whole] = [part, whole].map(|line| f64::from(line.radius));
        // In less than an eighth of the slice the line changes as much as in an eighth.
        let is_short = to - from < 0.125;
        let strayed = f64::from(u8::from(is_short)) * velocity.length() / 60.0;
        let rounding = 64.0 * f64::from(f32::EPSILON) * (far + 100.0);
        assert!(
            radius <= 2.0 * of_whole + strayed + rounding,
            "{round} {part:?} {whole:?}"
        );
        let missed = (1.0 - (to - from)) * (to - from) * velocity.length();
        thinner += u32::from(radius < 0.25 * missed);
    }
    // As they would be if their lines went from one end to the other in all of the slice.
    assert!(thinner > 1_000, "{thinner}");
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
        let (compact, cache_lines) = CompactTrajectory::of(knots, flight.segments());
        let view = compact.on(&cache_lines);
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
        let (start, end) = ((start, knots[first]), (end, knots[first + count]));
        let mut whole = BoundsBuilder::toward(start, end, &slice);
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
        let mut coordinate = || unit * rng.random_range(0.0_f32..1.0);
        let deviation = Vec4::new(coordinate(), coordinate(), coordinate(), 0.0);
        let rounding =
            Vec4::new(coordinate(), coordinate(), coordinate(), 0.0) * [0.0, 1.0][round / 3 % 2];
        let reach = coordinate() * [0.0, 1.0][round / 6 % 2];
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

/// Runs of cubics of no duration: the deviation contains that of the cubics, and the way to the end of the line.
#[test]
fn strays_of_runs_are_rounded_outward() {
    let mut rng = ChaCha8Rng::seed_from_u64(8);
    for _ in 0..5_000 {
        let (deviation, end): (f32, f32) = (rng.random(), rng.random());
        let (nowhere, slice) = ((Vec4::ZERO, 1.0), SliceInterval::new(1.0, 1.0));
        let mut builder = BoundsBuilder::toward(nowhere, nowhere, &slice);
        (builder.least, builder.most) = (Vec4::splat(-deviation), Vec4::splat(deviation));
        let run = builder.finish_run(Vec4::splat(end)).unpack(1.0);
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
    let run = builder.finish_run(points[3]).unpack(1.0);
    let farthest = (run.end.x - points[0].x).max(points[3].x - run.start.x);
    assert!(run.deviation.x >= farthest, "{farthest}");
}
