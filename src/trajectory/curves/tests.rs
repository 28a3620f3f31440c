//! Curves against exact arithmetic: what is kept is as near the curve meant as the error bounds say.

use super::{Keyframe, PositionOptions};
use crate::error::{Error, Quantity};
use crate::rounding::exact::{Exact, number};
use crate::trajectory::{Outside, Segment, State, Trajectory};
use dashu::rational::RBig;
use glam::DVec3;
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};

const ROUNDS: u32 = 300;

fn vector(rng: &mut ChaCha8Rng, half: f64) -> DVec3 {
    DVec3::from_array([0; 3].map(|_| half * rng.random_range(-1.0..1.0)))
}

/// Near and far from the origin, and now and then without any motion.
fn points(rng: &mut ChaCha8Rng, round: u32, count: usize) -> Vec<DVec3> {
    let size = [1.0, 1e-3, 1e5, 0.0][round as usize % 4];
    let around = vector(rng, [0.0, 1.0, 1e7][round as usize % 3]);
    (0..count).map(|_| around + vector(rng, size)).collect()
}

/// Increasing instants, near and far from 0.
fn times(rng: &mut ChaCha8Rng, round: u32, count: usize) -> Vec<f64> {
    let mut time = [0.0, -3.7, 1.7e9][round as usize / 2 % 3];
    let mut next = || {
        time += rng.random_range(0.1..3.0);
        time
    };
    (0..count).map(|_| next()).collect()
}

fn made(plan: Result<Trajectory, Error>) -> Trajectory {
    plan.unwrap_or_else(|error| unreachable!("{error}"))
}

/// Returns an instant's place between two others: 0 and 1 there.
fn share(time: f64, (from, to): (f64, f64)) -> RBig {
    (number(time) - number(from)) / (number(to) - number(from))
}

/// Asserts the error of a segment's control points, and that it is some roundings.
fn assert_points(segment: &Segment, exact: &[Exact; 4]) {
    for (point, exact) in segment.control_points().into_iter().zip(exact) {
        let off = Exact::of(segment.origin())
            .plus(&Exact::of(point))
            .minus(exact);
        assert!(off.is_within(segment.error()), "{segment:?} {off:?}");
    }
    let size = segment.origin().length() + segment.extent();
    assert!(
        segment.error() <= 4.0 * f64::EPSILON * size + 1e-300,
        "{segment:?}"
    );
}

/// Asserts the end motions of a plan whose first and last cubic have these control points.
fn assert_ends(plan: &Trajectory, first: &[Exact; 4], last: &[Exact; 4]) {
    let on = plan.clone().with_outside(Outside::Extrapolate);
    let knots = plan.knots();
    let intervals = [
        (knots[0], knots[1]),
        (knots[knots.len() - 2], knots[knots.len() - 1]),
    ];
    let motions = [on.segment_before(), on.segment_after()];
    let knots = [intervals[0].0, intervals[1].1];
    for place in [0, 1] {
        let (exact, interval, motion) = ([first, last][place], intervals[place], motions[place]);
        for lengths in [0.5, 2.5] {
            let way = [-1.0, 1.0][place] * lengths * (interval.1 - interval.0);
            let far = knots[place] + way;
            let ends = [knots[place].min(far), knots[place].max(far)];
            let shares = ends.map(|time| share(time, interval));
            let part = motion.restrict(ends[0], ends[1]);
            for (number, point) in part.points.into_iter().enumerate() {
                let off = Exact::of(motion.origin())
                    .plus(&Exact::of(point))
                    .minus(&Exact::blossom(exact, number, &shares));
                assert!(off.is_within(part.error), "{motion:?} {off:?}");
            }
        }
    }
    // At one velocity from the knot on.
    for (place, motion) in [plan.carrier_before(), plan.carrier_after()]
        .into_iter()
        .enumerate()
    {
        let (line, exact) = (motion.straight(), [first, last][place]);
        let lasting = number(intervals[place].1) - number(intervals[place].0);
        let whole = line.restrict(line.start(), line.end());
        let step = exact[2 * place + 1].minus(&exact[2 * place]);
        let third = (number(line.end()) - number(line.start())) / lasting;
        for (count, point) in (0_u8..).zip(whole.points) {
            let meant = exact[3 * place].plus(&step.times(&(&third * RBig::from(count))));
            let off = Exact::of(line.origin())
                .plus(&Exact::of(point))
                .minus(&meant);
            assert!(off.is_within(whole.error), "{line:?} {off:?}");
        }
    }
}

#[test]
fn legs_are_straight() {
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    for round in 0..ROUNDS {
        let count = rng.random_range(2..6);
        let (times, places) = (
            times(&mut rng, round, count),
            points(&mut rng, round, count),
        );
        let waypoints: Vec<_> = times.into_iter().zip(places).collect();
        let plan = made(Trajectory::from_waypoints(&waypoints));
        let exact: Vec<[Exact; 4]> = waypoints
            .windows(2)
            .map(|pair| {
                let from = Exact::of(pair[0].1);
                let way = Exact::of(pair[1].1).minus(&from);
                [0_u8, 1, 2, 3]
                    .map(|thirds| from.plus(&way.times(&(RBig::from(thirds) / RBig::from(3)))))
            })
            .collect();
        for (segment, exact) in plan.segments().iter().zip(&exact) {
            assert!(segment.is_straight());
            assert_points(segment, exact);
        }
        assert_ends(&plan, &exact[0], &exact[count - 2]);
        let coasts = plan.clone().with_outside(Outside::Coast);
        for &(time, position) in &waypoints {
            let found = coasts.position(time);
            assert_eq!(found, Some(position));
        }
    }
}

#[cfg(feature = "serde")]
#[test]
fn legs_in_files() {
    let corner = DVec3::new(0.1, 0.7, -1e3);
    let legs = [
        (0.3, DVec3::ZERO),
        (1.7, corner),
        (2.0, corner),
        (7.1, DVec3::X),
    ];
    let plan = made(Trajectory::from_waypoints(&legs));
    let text = serde_json::to_string(&plan).unwrap_or_default();
    assert_eq!(serde_json::from_str::<Trajectory>(&text).ok(), Some(plan));
}

#[test]
fn bezier_pieces() {
    let mut rng = ChaCha8Rng::seed_from_u64(2);
    for round in 0..ROUNDS {
        let count = rng.random_range(1..4);
        let knots = times(&mut rng, round, count + 1);
        let all = points(&mut rng, round, 3 * count + 1);
        let pieces: Vec<[DVec3; 4]> = (0..count)
            .map(|piece| [0, 1, 2, 3].map(|point| all[3 * piece + point]))
            .collect();
        let plan = made(Trajectory::from_bezier(&knots, &pieces));
        assert_eq!(plan.knots(), knots);
        let exact: Vec<_> = pieces.iter().map(|piece| piece.map(Exact::of)).collect();
        for (segment, exact) in plan.segments().iter().zip(&exact) {
            assert_points(segment, exact);
            // The way of each point is rounded once.
            assert!(segment.error() <= 0.6 * f64::EPSILON * segment.extent() + 1e-300);
        }
        assert_ends(&plan, &exact[0], &exact[count - 1]);
    }
}

/// Returns the value of a basis function of order 4 or less (Cox and de Boor), from the left at the last knot.
fn basis(knots: &[RBig], order: usize, time: &RBig, is_last: bool) -> RBig {
    if order == 1 {
        let is_in = match is_last {
            true => knots[0] < *time && *time <= knots[1],
            false => knots[0] <= *time && *time < knots[1],
        };
        return if is_in { RBig::ONE } else { RBig::ZERO };
    }
    let part = |knots: &[RBig], numerator: RBig| {
        let lasting = &knots[order - 1] - &knots[0];
        if lasting == RBig::ZERO {
            return RBig::ZERO;
        }
        numerator / lasting * basis(knots, order - 1, time, is_last)
    };
    part(&knots[..order], time - &knots[0]) + part(&knots[1..=order], &knots[order] - time)
}

/// Returns the exact place on a B-spline.
fn on_b_spline(knots: &[RBig], points: &[DVec3], time: &RBig) -> Exact {
    let is_last = *time == knots[points.len()];
    points
        .iter()
        .enumerate()
        .fold(Exact::of(DVec3::ZERO), |sum, (first, &point)| {
            let weight = basis(&knots[first..first + 5], 4, time, is_last);
            sum.plus(&Exact::of(point).times(&weight))
        })
}

/// Compares a plan with exact places at instants of all its segments; `at` tells them by the number of the segment and
/// the share of it.
fn assert_places(plan: &Trajectory, at: impl Fn(usize, f64, &RBig) -> Exact) {
    for (piece, segment) in plan.segments().iter().enumerate() {
        let interval = (segment.start(), segment.end());
        for step in 0..=6 {
            let time = interval.0 + (interval.1 - interval.0) * f64::from(step) / 6.0;
            let time = time.min(interval.1);
            let part = segment.restrict(time, time);
            // Short of the end, where the next segment begins.
            let meant = at(piece, time, &share(time, interval));
            let off = Exact::of(segment.origin())
                .plus(&Exact::of(part.points[0]))
                .minus(&meant);
            assert!(off.is_within(part.error), "{time} {segment:?} {off:?}");
        }
        let size = segment.origin().length() + segment.extent();
        assert!(
            segment.error() <= f64::EPSILON * size + 1e-300,
            "{segment:?}"
        );
    }
}

/// Single knots, knots that occur several times, clamped ends and others.
#[test]
fn b_splines() {
    let mut rng = ChaCha8Rng::seed_from_u64(3);
    let mut repeated = 0;
    for round in 0..ROUNDS {
        let count = rng.random_range(4..9);
        let control = points(&mut rng, round, count);
        let mut knots = times(&mut rng, round, count + 4);
        for knot in 1..knots.len() {
            let run = knots[..knot]
                .iter()
                .filter(|&&it| it >= knots[knot - 1])
                .count();
            let most = if knot <= 3 || knot >= count { 4 } else { 3 };
            if run < most && rng.random_bool(0.3) {
                knots[knot] = knots[knot - 1];
                repeated += 1;
            }
        }
        if round % 3 == 0 {
            let [first, last] = [knots[0], knots[count + 3]];
            knots[..4].fill(first);
            knots[count..].fill(last);
        }
        let Ok(plan) = Trajectory::from_b_spline(&knots, &control) else {
            continue;
        };
        let exact: Vec<RBig> = knots.iter().copied().map(number).collect();
        assert_eq!(plan.knots().first(), Some(&knots[3]));
        assert_eq!(plan.knots().last(), Some(&knots[count]));
        assert_places(&plan, |_, time, _| {
            on_b_spline(&exact, &control, &number(time))
        });
        if round % 3 == 0 {
            assert_eq!(plan.position(knots[0]), Some(control[0]));
        }
    }
    assert!(repeated > 200, "{repeated}");
}

#[test]
fn uniform_b_splines() {
    let mut rng = ChaCha8Rng::seed_from_u64(4);
    for round in 0..ROUNDS {
        let count = rng.random_range(4..9);
        let control = points(&mut rng, round, count);
        let start = [0.0, 1.7e9, -0.3][round as usize % 3];
        let plan = Trajectory::from_uniform_b_spline(start, rng.random_range(0.1..2.0), &control);
        let plan = made(plan);
        assert_eq!(plan.knots().len(), count - 2);
        let exact: Vec<RBig> = (0_u8..20).map(RBig::from).collect();
        assert_places(&plan, |piece, _, share| {
            on_b_spline(&exact, &control, &(RBig::from(piece + 3) + share))
        });
    }
}

/// Where position and velocity at the ends vanish but for what cancels, too.
#[test]
fn ends_of_b_splines() {
    let mut rng = ChaCha8Rng::seed_from_u64(5);
    for round in 0..ROUNDS {
        let knots = times(&mut rng, round, 8);
        let mut control = points(&mut rng, round, 4);
        if round % 2 == 0 {
            control = [0.0, 0.0, 0.0, 1.0]
                .map(|x| control[0] + x * control[1])
                .to_vec();
        }
        let interval = (knots[3], knots[4]);
        let exact_knots: Vec<RBig> = knots.iter().copied().map(number).collect();
        // The cubic through the places at 0, 1/3, 2/3 and 1.
        let third = (number(interval.1) - number(interval.0)) / RBig::from(3);
        let [a, b, c, d] = [0_u8, 1, 2, 3].map(|count| {
            let time = number(interval.0) + &third * RBig::from(count);
            on_b_spline(&exact_knots, &control, &time)
        });
        let sum = |weights: [i8; 4]| {
            let terms = [&a, &b, &c, &d].into_iter().zip(weights);
            terms.fold(Exact::of(DVec3::ZERO), |sum, (point, weight)| {
                sum.plus(&point.times(&(RBig::from(weight) / RBig::from(6))))
            })
        };
        let exact = [
            a.clone(),
            sum([-5, 18, -9, 2]),
            sum([2, -9, 18, -5]),
            d.clone(),
        ];
        let plan = made(Trajectory::from_b_spline(&knots, &control));
        assert_points(&plan.segments()[0], &exact);
        assert_ends(&plan, &exact, &exact);
    }
}

#[test]
fn keyframes_with_two_tangents() {
    let mut rng = ChaCha8Rng::seed_from_u64(6);
    for round in 0..ROUNDS {
        let count = rng.random_range(2..5);
        let (times, places) = (
            times(&mut rng, round, count),
            points(&mut rng, round, count),
        );
        let frames: Vec<Keyframe> = times
            .into_iter()
            .zip(places)
            .map(|(time, place)| {
                Keyframe::new(time, vector(&mut rng, 2.0), place, vector(&mut rng, 2.0))
            })
            .collect();
        let plan = made(Trajectory::from_keyframes(&frames));
        let exact: Vec<[Exact; 4]> = frames
            .windows(2)
            .map(|pair| {
                let [p, q] = [&pair[0], &pair[1]].map(|frame| Exact::of(frame.position));
                let third = (number(pair[1].time) - number(pair[0].time)) / RBig::from(3);
                let leave = Exact::of(pair[0].out_tangent).times(&third);
                let arrive = Exact::of(pair[1].in_tangent).times(&third);
                [p.clone(), p.plus(&leave), q.minus(&arrive), q]
            })
            .collect();
        for (segment, exact) in plan.segments().iter().zip(&exact) {
            assert_points(segment, exact);
        }
        assert_ends(&plan, &exact[0], &exact[count - 2]);
        // With one tangent they are states.
        let smooth: Vec<Keyframe> = frames
            .iter()
            .map(|frame| Keyframe {
                in_tangent: frame.out_tangent,
                ..*frame
            })
            .collect();
        let states: Vec<State> = smooth
            .iter()
            .map(|frame| State::new(frame.time, frame.position, frame.in_tangent))
            .collect();
        assert_eq!(
            Trajectory::from_keyframes(&smooth),
            Trajectory::from_states(&states)
        );
    }
}

/// No coordinate leaves the range of the two positions between which it is; without the limit some do.
#[test]
fn limited_velocities_do_not_overshoot() {
    let mut rng = ChaCha8Rng::seed_from_u64(7);
    let limited = PositionOptions::new().with_limited_velocities();
    let (mut beyond, mut same) = (0, 0);
    for round in 0..ROUNDS {
        let count = rng.random_range(2..9);
        let times = times(&mut rng, round, count);
        // Often at rest on an axis, and of very different speeds.
        let mut place = DVec3::ZERO;
        let mut positions = Vec::new();
        for time in times {
            positions.push((time, place));
            let size = 10_f64.powi(rng.random_range(-2..3));
            let moves = [0; 3].map(|_| f64::from(rng.random_bool(0.8)));
            place += vector(&mut rng, size) * DVec3::from_array(moves);
        }
        let free = made(Trajectory::from_positions(&positions));
        let held = made(Trajectory::from_positions_with(&positions, &limited));
        let overshoot = |plan: &Trajectory| {
            let mut most = f64::NEG_INFINITY;
            for pair in positions.windows(2) {
                let (low, high) = (pair[0].1.min(pair[1].1), pair[0].1.max(pair[1].1));
                for step in 0..=40 {
                    let time = pair[0].0 + (pair[1].0 - pair[0].0) * f64::from(step) / 40.0;
                    let found = plan.position(time.min(pair[1].0)).unwrap_or(DVec3::NAN);
                    most = most.max((low - found).max(found - high).max_element());
                }
            }
            most
        };
        assert!(overshoot(&held) < 1e-12, "{positions:?}");
        beyond += usize::from(overshoot(&free) > 1e-3);
        same += usize::from(free == held);
    }
    assert!(beyond > 200 && same > 10, "{beyond} {same}");
}

#[test]
fn velocities_at_the_ends() {
    let positions = [
        (0.0, DVec3::ZERO),
        (1.0, DVec3::X),
        (3.0, DVec3::Y),
        (4.0, DVec3::Z),
    ];
    let [first, last] = [DVec3::new(9.0, -8.0, 7.0), DVec3::new(-1.0, 2.0, 0.0)];
    let options = PositionOptions::new()
        .with_first_velocity(first)
        .with_last_velocity(last);
    // Velocities are good to some roundings.
    let is_near = |found: Option<DVec3>, meant: DVec3| {
        found.is_some_and(|found| found.distance(meant) < 1e-14)
    };
    for options in [options, options.with_limited_velocities()] {
        let plan = made(Trajectory::from_positions_with(&positions, &options));
        assert!(is_near(plan.velocity(0.0), first));
        assert!(is_near(plan.velocity(4.0), last));
    }
    let plan = made(Trajectory::from_positions_with(&positions, &options));
    let free = made(Trajectory::from_positions(&positions));
    assert_eq!(plan.segments()[1], free.segments()[1]);
    let two = made(Trajectory::from_positions_with(&positions[..2], &options));
    assert!(is_near(two.velocity(0.0), first) && is_near(two.velocity(1.0), last));
}

fn refused<T: std::fmt::Debug>(made: Result<T, Error>) -> Error {
    made.err().unwrap_or_else(|| unreachable!("refused"))
}

#[test]
fn numbers_that_are_refused() {
    let (nan, far) = (DVec3::new(0.0, f64::NAN, 0.0), DVec3::new(2e300, 0.0, 0.0));
    let text = |error: Error| error.to_string();
    let waypoints = Trajectory::from_waypoints;
    assert_eq!(
        refused(waypoints(&[(0.0, DVec3::X)])),
        Error::TooFewStates { count: 1 }
    );
    let found = text(refused(waypoints(&[(0.0, DVec3::X), (1.0, nan)])));
    assert_eq!(found, "knot 1: position y is NaN, not a finite number");
    let found = text(refused(waypoints(&[(0.0, DVec3::X), (0.0, DVec3::X)])));
    assert_eq!(
        found,
        "knot 1: time 0.0 s is not later than the knot before it, 0.0 s"
    );
    let fast = [(0.0, DVec3::ZERO), (1e-200, 1e200 * DVec3::X)];
    assert!(matches!(
        refused(waypoints(&fast)),
        Error::OutOfRange { knot: 1, .. }
    ));

    let piece = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
    let bezier = Trajectory::from_bezier;
    let found = text(refused(bezier(&[0.0, 1.0, 2.0], &[piece, piece])));
    assert_eq!(
        found,
        "knot 1: the curve before it ends 1.0 m from where the curve after it begins: give both the same point"
    );
    let found = text(refused(bezier(
        &[0.0, 1.0],
        &[[DVec3::ZERO, far, DVec3::Y, DVec3::Z]],
    )));
    assert_eq!(
        found,
        "knot 0: control point 1 in x reaches 2e300, beyond ±1e300"
    );
    assert!(matches!(
        refused(bezier(&[0.0, 1.0], &[])),
        Error::SegmentCount { .. }
    ));

    let spline = Trajectory::from_b_spline;
    let found = text(refused(spline(&[0.0; 7], &piece[..3])));
    assert_eq!(
        found,
        "a cubic B-spline needs at least four control points, not 3"
    );
    let found = text(refused(spline(&[0.0, 1.0], &piece)));
    assert_eq!(
        found,
        "a cubic B-spline of 4 control points needs 8 knots, not 2"
    );
    let clamped = [0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0];
    for (knot, time) in [
        (2, -1.0),
        (4, 0.0),
        (5, f64::NAN),
        (6, 0.5),
        (7, f64::INFINITY),
    ] {
        let mut knots = clamped;
        knots[knot] = time;
        let found = refused(spline(&knots, &piece));
        let is_named = match found {
            Error::TimeNotIncreasing { knot: named, .. } => named == knot,
            Error::NotFinite {
                knot: named,
                quantity,
                ..
            } => named == knot && quantity == Quantity::Time,
            _ => false,
        };
        assert!(is_named, "{knot} {found}");
    }
    let found = refused(spline(&[0.0, 1.0, 2.0, 3.0, 3.0, 4.0, 5.0, 6.0], &piece));
    assert!(
        matches!(found, Error::TimeNotIncreasing { knot: 4, .. }),
        "{found}"
    );
    // A knot that occurs four times parts the curve, if its points differ.
    let broken = [0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0, 2.0, 2.0, 2.0, 2.0];
    let mut eight = [piece, piece.map(|point| point + 2.0 * DVec3::Z)].concat();
    assert_eq!(
        refused(spline(&broken, &eight)),
        Error::Discontinuous {
            knot: 4,
            distance: 1.0
        }
    );
    eight[4] = eight[3];
    assert_eq!(made(spline(&broken, &eight)).segments().len(), 2);
    let uniform = Trajectory::from_uniform_b_spline;
    for interval in [0.0, -1.0, f64::NAN, 1e-20] {
        let found = refused(uniform(1.0, interval, &piece));
        let is_named = matches!(
            found,
            Error::TimeNotIncreasing { knot: 1, .. } | Error::NotFinite { knot: 1, .. }
        );
        assert!(is_named, "{interval} {found}");
    }
    let found = text(refused(uniform(
        0.0,
        1.0,
        &[piece.to_vec(), vec![nan]].concat(),
    )));
    assert_eq!(
        found,
        "knot 1: control point 4 in y is NaN, not a finite number"
    );

    // Also what shapes no segment.
    let frame = |time| Keyframe {
        time,
        ..Keyframe::default()
    };
    let unused = Keyframe {
        in_tangent: nan,
        ..frame(0.0)
    };
    let found = text(refused(Trajectory::from_keyframes(&[unused, frame(1.0)])));
    assert_eq!(found, "knot 0: velocity y is NaN, not a finite number");
    let options = PositionOptions::new().with_last_velocity(far);
    let two = [(0.0, DVec3::ZERO), (1.0, DVec3::X)];
    let found = text(refused(Trajectory::from_positions_with(&two, &options)));
    assert_eq!(found, "knot 1: velocity x reaches 2e300, beyond ±1e300");
}
