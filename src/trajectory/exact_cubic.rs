//! Cubics in exact arithmetic, and end motions against them, for tests of error bounds.

use super::{Outside, Segment, State, Trajectory};
use crate::rounding::UNIT_ROUNDOFF;
use crate::rounding::exact::{Exact, number};
use dashu::rational::RBig;
use glam::DVec3;

/// Returns the control points of the cubic between two states.
pub(super) fn between_states(from: &State, to: &State) -> [Exact; 4] {
    let third = (number(to.time) - number(from.time)) / RBig::from(3);
    let [p, q] = [from, to].map(|state| Exact::of(state.position));
    let leave = Exact::of(from.velocity).times(&third);
    let arrive = Exact::of(to.velocity).times(&third);
    [p.clone(), p.plus(&leave), q.minus(&arrive), q]
}

/// Returns a polynomial's control points between two knots; its variable starts at `shift`.
pub(super) fn of_polynomial(coefficients: &[DVec3; 4], shift: f64, knots: [f64; 2]) -> [Exact; 4] {
    // The blossom at three instants: products of all, of two, of one, of none.
    let blossom = |x: &RBig, y: &RBig, z: &RBig| {
        let three = RBig::from(3);
        let factors = [
            x * y * z,
            (x * y + y * z + z * x) / &three,
            (x + y + z) / &three,
            RBig::ONE,
        ];
        let terms = coefficients.iter().zip(&factors);
        terms.fold(Exact::of(DVec3::ZERO), |sum, (coefficient, factor)| {
            sum.plus(&Exact::of(*coefficient).times(factor))
        })
    };
    let start = number(shift);
    let end = &start + number(knots[1]) - number(knots[0]);
    [
        blossom(&start, &start, &start),
        blossom(&start, &start, &end),
        blossom(&start, &end, &end),
        blossom(&end, &end, &end),
    ]
}

/// Asserts that points from the origin of a segment are within an error of exact ones.
pub(super) fn assert_within<const N: usize>(
    segment: &Segment,
    points: [DVec3; N],
    exact: &[Exact; N],
    error: f64,
) {
    let origin = Exact::of(segment.origin());
    for (point, exact) in points.into_iter().zip(exact) {
        let off = origin.plus(&Exact::of(point)).minus(exact);
        assert!(off.is_within(error), "{segment:?} {off:?}");
    }
}

/// Asserts that the end motions of a plan are within their errors, on the first piece and that many durations away. Returns
/// the largest share of an error that is needed, and the largest error as a share of the rounding of a motion's way.
///
/// `first` and `last` are the control points of the first and the last cubic.
pub(super) fn assert_ends(
    plan: &Trajectory,
    first: &[Exact; 4],
    last: &[Exact; 4],
    durations: f64,
) -> (f64, f64) {
    let (mut needed, mut largest) = (0.0_f64, 0.0_f64);
    let knots = plan.knots();
    let count = knots.len();
    // From the knot inwards.
    let mut reversed = last.clone();
    reversed.reverse();
    let ends = [
        ([knots[0], knots[1]], first),
        ([knots[count - 1], knots[count - 2]], &reversed),
    ];
    for outside in [Outside::Extrapolate, Outside::Coast] {
        let plan = plan.clone().with_outside(outside);
        let motions = [plan.segment_before(), plan.segment_after()];
        for (motion, ([knot, inner], points)) in motions.into_iter().zip(ends) {
            let [p0, p1, p2, p3] = points;
            let step = p1.minus(p0);
            let exact = match outside {
                Outside::Coast => [0_u8, 1, 2, 3].map(|k| p0.plus(&step.times(&RBig::from(k)))),
                _ => points.clone(),
            };
            let quadratic = p2.minus(p1).minus(&step);
            let cubic = p3.minus(p2).minus(&p2.minus(p1)).minus(&quadratic);
            let three = RBig::from(3);
            let [linear, quadratic, cubic] =
                [step.times(&three), quadratic.times(&three), cubic].map(|term| term.length());
            // All terms of the displacement, however much they cancel.
            let way = |time: f64| {
                let x = ((time - knot) / (inner - knot)).abs();
                match outside {
                    Outside::Coast => x * linear,
                    _ => x * (linear + x * (quadratic + x * cubic)),
                }
            };
            let share = |time: f64| (number(time) - number(knot)) / (number(inner) - number(knot));
            let unit = (motion.end() - motion.start()).copysign(knot - inner);
            let [near, far] = [1.0, 2.0].map(|k| knot + k * durations * unit);
            for ends in [[near, far], [knot, knot + unit]] {
                let interval = [ends[0].min(ends[1]), ends[0].max(ends[1])];
                let part = motion.restrict(interval[0], interval[1]);
                let shares = interval.map(share);
                for (number, point) in part.points.into_iter().enumerate() {
                    let place = Exact::of(motion.origin()).plus(&Exact::of(point));
                    let off = place.minus(&Exact::blossom(&exact, number, &shares));
                    assert!(off.is_within(part.error), "{motion:?} {off:?} {part:?}");
                    needed = needed.max(off.length() / part.error.max(f64::MIN_POSITIVE));
                }
                let growth = 1.0 + 128.0 * UNIT_ROUNDOFF * durations;
                let bound = 1e-14 * (way(knot + unit) + motion.origin().length())
                    + 40.0 * UNIT_ROUNDOFF * way(ends[1]) * growth * growth;
                largest = largest.max(part.error / (bound + 1e-200));
                let place = motion.motion_at(ends[1]).0;
                let share = share(ends[1]);
                let off =
                    Exact::of(place).minus(&Exact::blossom(&exact, 0, &[share.clone(), share]));
                let rounding = 2.0 * UNIT_ROUNDOFF * (place.length() + motion.origin().length());
                assert!(off.is_within(part.error + rounding), "{motion:?} {off:?}");
            }
        }
    }
    (needed, largest)
}
