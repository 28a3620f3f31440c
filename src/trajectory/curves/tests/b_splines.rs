//! B-splines against their basis functions in exact arithmetic.

use super::{ROUNDS, assert_ends, assert_points, made, points, share, times};
use crate::rounding::exact::{Exact, number};
use crate::trajectory::Trajectory;
use crate::trajectory::exact_cubic::assert_within;
use dashu::rational::RBig;
use glam::DVec3;
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};

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
            assert_within(segment, [part.points[0]], &[meant], part.error);
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

/// The ends are exact also where their position and velocity vanish but for terms that cancel.
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
