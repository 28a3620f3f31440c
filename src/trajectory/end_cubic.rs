//! Extrapolation of the end cubics: coefficients around the knot, each good to its own rounding.
//!
//! With T the duration between two states, e = v T - (p1 - p0) at either of them, and s the time
//! since a knot in units of T, the cubic through both is
//!
//! ```text
//! p0 + v0 T s - (2 e0 + e1) s² + (e0 + e1) s³      around the first knot,
//! p1 + v1 T s + (e0 + 2 e1) s² + (e0 + e1) s³      around the second one.
//! ```
//!
//! Position and velocity are the user's numbers, so the extrapolation is as good as the
//! coefficients of s² and s³. Between straight states e vanishes. Rounded control points would
//! instead give a rounding of the distance between the states, times s³.
//!
//! Products and differences of two f64 are exact sums of two f64. A sum of two such pairs has an
//! error of 3 u² of itself (u = 2^-53; Joldes, Muller, Popescu, "Tight and rigorous error bounds
//! for basic building blocks of double-word arithmetic", 2017). T = T' + T'', the second at most u
//! T. So e = (v T' - (p1 - p0)) + v T'' has an error of at most 7 u² |e| + 4 u³ |v T|. As e0 and e1
//! follow from both coefficients b and c, the errors of b and c are
//!
//! - their own rounding, and that of the powers of the unit: 7 u |b|, 10 u |c|;
//! - 64 u² (|b| + |c|) + 16 u³ (|a| + 2 |b| + 3 |c|), with a the coefficient of s.
//!
//! The second line, times s² and s³, is below u (|a| s + |b| s² + |c| s³) (1 + 64 u s)² from s = 1
//! on. Before that, the error of the first piece covers it. Polynomials: all coefficients are
//! formed exactly and rounded once. The computation from them adds 12 roundings, so 32 roundings of
//! each term cover everything. 32 of the first piece's extent are added throughout. Underflow loses
//! less than 2^-1022, times s³.

use super::State;
use super::double_double::{DoubleDouble, Expansion, taylor_shift};
use glam::DVec3;

/// Returns the quadratic and cubic coefficient of the cubic through two states, around the first
/// and around the second state, in units of the duration between them.
pub(super) fn of_states(first: &State, second: &State) -> [[DVec3; 2]; 2] {
    let duration = DoubleDouble::difference(second.time, first.time);
    let [most, rest] = duration.parts();
    let (mut leaving, mut arriving, mut cubic) = (DVec3::ZERO, DVec3::ZERO, DVec3::ZERO);
    for axis in 0..3 {
        let back = DoubleDouble::difference(first.position[axis], second.position[axis]);
        let [leave, arrive] = [first, second].map(|state| {
            let velocity = state.velocity[axis];
            let excess = DoubleDouble::product(velocity, most) + back;
            if rest.abs() > 0.0 {
                excess + DoubleDouble::product(velocity, rest)
            } else {
                excess
            }
        });
        leaving[axis] = -leave.twice().rounded_sum(arrive);
        arriving[axis] = arrive.twice().rounded_sum(leave);
        cubic[axis] = leave.rounded_sum(arrive);
    }
    [[leaving, cubic], [arriving, cubic]]
}

/// Returns position, velocity, and the coefficients of time squared and cubed of the polynomial
/// `a t³ + b t² + c t + d` around the instant `time`. The second value bounds the rounding of the
/// position, m.
pub(super) fn of_polynomial(polynomial: &[DVec3; 4], time: DoubleDouble) -> ([DVec3; 4], f64) {
    let mut around = [DVec3::ZERO; 4];
    let mut lost = DVec3::ZERO;
    for axis in 0..3 {
        let [a, b, c, d] = polynomial.map(|coefficient| Expansion::from(coefficient[axis]));
        let exact = taylor_shift([d, c, b, a], |term| term.times(time));
        for (sum, around) in exact.iter().zip(&mut around) {
            around[axis] = sum.rounded();
        }
        let [position, ..] = exact;
        lost[axis] = (position + Expansion::from(-around[0][axis])).rounded();
    }
    (
        around,
        lost.abs().element_sum() * (1.0 + f64::EPSILON * 4.0),
    )
}

#[cfg(test)]
mod tests {
    use crate::rounding::UNIT_ROUNDOFF;
    use crate::rounding::exact::number;
    use crate::trajectory::{Outside, Segment, State, TimeBase, Trajectory};
    use dashu::rational::RBig;
    use glam::DVec3;
    use rand::rngs::ChaCha8Rng;
    use rand::{RngExt, SeedableRng};

    /// Coefficients of 1, τ, τ², τ³ with τ the time since an instant, by axis.
    struct ExactCubic {
        since: RBig,
        coefficients: [[RBig; 4]; 3],
    }

    impl ExactCubic {
        fn of_states(first: &State, second: &State) -> Self {
            let duration = number(second.time) - number(first.time);
            let coefficients = [0, 1, 2].map(|axis| {
                let [p, q] = [first, second].map(|state| number(state.position[axis]));
                let [v, w] = [first, second].map(|state| number(state.velocity[axis]));
                let rate = (q - &p) / &duration;
                let quadratic = (RBig::from(3) * &rate - RBig::from(2) * &v - &w) / &duration;
                let cubic = (&v + w - RBig::from(2) * rate) / (&duration * &duration);
                [p, v, quadratic, cubic]
            });
            Self {
                since: number(first.time),
                coefficients,
            }
        }

        fn of_polynomial(polynomial: &[DVec3; 4], since: f64) -> Self {
            let [a, b, c, d] = polynomial;
            Self {
                since: number(since),
                coefficients: [0, 1, 2].map(|axis| [d, c, b, a].map(|one| number(one[axis]))),
            }
        }

        fn around(&self, time: f64) -> Self {
            let shift = number(time) - &self.since;
            let coefficients = self.coefficients.clone().map(|[p, v, b, a]| {
                let [two, three] = [2, 3].map(RBig::from);
                [
                    ((&a * &shift + &b) * &shift + &v) * &shift + p,
                    (&three * &a * &shift + two * &b) * &shift + v,
                    three * &a * &shift + b,
                    a,
                ]
            });
            Self {
                since: number(time),
                coefficients,
            }
        }

        fn straight(mut self) -> Self {
            for [.., quadratic, cubic] in &mut self.coefficients {
                (*quadratic, *cubic) = (RBig::ZERO, RBig::ZERO);
            }
            self
        }

        /// Returns the size of all terms but the first, `time` s later: m.
        fn way(&self, time: f64) -> f64 {
            let norm = |power: usize| {
                let of_axis = |axis: usize| self.coefficients[axis][power].to_f64().value();
                DVec3::from_array([0, 1, 2].map(of_axis)).length()
            };
            let time = time.abs();
            time * (norm(1) + time * (norm(2) + time * norm(3)))
        }

        /// Returns the largest distance between control points over an interval and given ones.
        fn farthest(&self, points: &[DVec3; 4], from: DVec3, interval: (f64, f64)) -> f64 {
            let [a, b] = [interval.0, interval.1].map(|time| number(time) - &self.since);
            let instants = [[&a, &a, &a], [&a, &a, &b], [&a, &b, &b], [&b, &b, &b]];
            let distances = points.iter().zip(instants).map(|(point, [x, y, z])| {
                let apart = [0, 1, 2].map(|axis| {
                    let [p, v, b, c] = &self.coefficients[axis];
                    let three = RBig::from(3);
                    let place = p
                        + v * (x + y + z) / &three
                        + b * (x * y + y * z + z * x) / &three
                        + c * (x * y * z);
                    let apart = place - number(from[axis]) - number(point[axis]);
                    apart.to_f64().value()
                });
                DVec3::from_array(apart).length()
            });
            distances.fold(0.0, f64::max)
        }
    }

    /// Returns plans with the exact motion of their first and last cubic.
    fn any(rng: &mut ChaCha8Rng) -> (Trajectory, [ExactCubic; 2]) {
        let mut power = |from: f64, to: f64| 10_f64.powf(rng.random_range(from..to));
        let (size, duration, bend) = (power(-3.0, 4.0), power(-3.0, 3.0), power(-20.0, 0.0));
        let far = [0.0, size, 1e3 * size, 1e7][rng.random_range(0..4)];
        let begin = [0.0, 0.3 * duration, 3.7, -1e5, 1.7e9][rng.random_range(0..5)];
        let knots = [0.0, 1.0, 2.6].map(|k| begin + k * duration);
        let bend = [0.0, bend][usize::from(rng.random_bool(0.8))];
        let (kind, still) = (rng.random_range(0..3), rng.random_bool(0.2));
        // Often nothing on some axes.
        let mut vector = |half: f64| {
            let one = |_| half * rng.random_range(-1.0..1.0) * f64::from(rng.random_bool(0.8));
            DVec3::from_array([0; 3].map(one))
        };
        let speed = if still { 0.0 } else { size / duration };
        let (place, velocity) = (vector(far), vector(speed));
        let bend = bend * speed;
        if kind == 0 {
            let states = knots.map(|time| {
                let way = velocity * (time - begin);
                State::new(time, place + way, velocity + vector(bend))
            });
            let [first, middle, last] = &states;
            let ends = [(first, middle), (middle, last)];
            let plan = Trajectory::from_states(&states);
            let plan = plan.unwrap_or_else(|_| unreachable!("the states are in order"));
            return (plan, ends.map(|(from, to)| ExactCubic::of_states(from, to)));
        }
        let base = [TimeBase::Absolute, TimeBase::SegmentLocal][kind - 1];
        let polynomials = [0; 2].map(|_| {
            let [b, a] = [duration, duration * duration].map(|unit| vector(bend) / unit);
            [a, b, velocity, place]
        });
        let ends = [0, 1].map(|k| {
            let since = [0.0, knots[k]][kind - 1];
            ExactCubic::of_polynomial(&polynomials[k], since)
        });
        let plan = Trajectory::from_coefficients(&knots, &polynomials, base);
        (plan.unwrap_or_else(|_| unreachable!("in order")), ends)
    }

    /// Compares extrapolations with exact arithmetic: the error bound holds and is some roundings
    /// of the distance travelled.
    #[test]
    fn what_goes_on_is_as_good_as_its_way() {
        let mut rng = ChaCha8Rng::seed_from_u64(23);
        let mut worst = 0.0_f64;
        for round in 0..300 {
            let (plan, motions) = any(&mut rng);
            for outside in [Outside::Extrapolate, Outside::Coast] {
                let plan = plan.clone().with_outside(outside);
                let [first, last] = [0, plan.knots().len() - 1].map(|knot| plan.knots()[knot]);
                let ends = [
                    (first, plan.segment_before(), -1.0),
                    (last, plan.segment_after(), 1.0),
                ];
                for ((knot, end_motion, sign), motion) in ends.iter().zip(&motions) {
                    let motion = motion.around(*knot);
                    let motion = match outside {
                        Outside::Coast => motion.straight(),
                        _ => motion,
                    };
                    let unit = end_motion.end() - end_motion.start();
                    let durations = 10_f64.powf(rng.random_range(-1.0..16.0));
                    let [near, far] = [1.0, 2.0].map(|k| knot + sign * k * durations * unit);
                    let first = knot + sign * unit;
                    for ends in [(near, far), (*knot, first)] {
                        let interval = (ends.0.min(ends.1), ends.0.max(ends.1));
                        let part = end_motion.restrict(interval.0, interval.1);
                        let off = motion.farthest(&part.points, end_motion.origin(), interval);
                        assert!(off <= part.error, "{round} {off:e} {part:?} {end_motion:?}");
                        worst = worst.max(off / part.error);
                        let scale = motion.way(unit) + end_motion.origin().length();
                        let way = motion.way(ends.1 - knot);
                        let rounding_growth = 1.0 + 128.0 * UNIT_ROUNDOFF * durations;
                        let bound = 1e-14 * scale
                            + 40.0 * UNIT_ROUNDOFF * way * rounding_growth * rounding_growth;
                        let error = part.error;
                        assert!(error <= bound + 1e-200, "{round} {error:e} {bound:e}");
                        assert!(is_met(end_motion, &motion, ends.1, part.error), "{round}");
                    }
                }
            }
        }
        assert!(worst > 0.05, "{worst}");
    }

    /// Returns true if the position at an instant is that of the exact motion.
    fn is_met(end_motion: &Segment, motion: &ExactCubic, time: f64, error: f64) -> bool {
        let place = end_motion.motion_at(time).0;
        let rounding = 2.0 * UNIT_ROUNDOFF * (place.length() + end_motion.origin().length());
        motion.farthest(&[place; 4], DVec3::ZERO, (time, time)) <= error + rounding
    }
}
