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
    use crate::trajectory::exact_cubic::{assert_ends, between_states, of_polynomial};
    use crate::trajectory::{State, TimeBase, Trajectory};
    use glam::DVec3;
    use rand::rngs::ChaCha8Rng;
    use rand::{RngExt, SeedableRng};

    /// States or polynomials near a straight line: still, slow or fast, near or far, soon or late. The last polynomial may
    /// nearly rest where it ends.
    #[test]
    fn what_goes_on_is_as_good_as_its_way() {
        let mut rng = ChaCha8Rng::seed_from_u64(23);
        let (mut worst, mut largest) = (0.0_f64, 0.0_f64);
        for round in 0..300 {
            let mut power = |from: f64, to: f64| 10_f64.powf(rng.random_range(from..to));
            let (size, duration, bend) = (power(-3.0, 4.0), power(-3.0, 3.0), power(-20.0, 0.0));
            let far = [0.0, size, 1e3 * size, 1e7][rng.random_range(0..4)];
            let begin = [0.0, 0.3 * duration, 3.7, -1e5, 1.7e9][rng.random_range(0..5)];
            let knots = [0.0, 1.0, 2.6].map(|k| begin + k * duration);
            let bend = [0.0, bend][usize::from(rng.random_bool(0.8))];
            let speed = [size / duration, 0.0][usize::from(rng.random_bool(0.2))];
            let durations = 10_f64.powf(rng.random_range(-1.0..16.0));
            // Often nothing on some axes.
            let mut vector = |half: f64| {
                let one = |_| half * rng.random_range(-1.0..1.0) * f64::from(rng.random_bool(0.8));
                DVec3::from_array([0; 3].map(one))
            };
            let (place, velocity, bend) = (vector(far), vector(speed), bend * speed);
            let (plan, cubics) = if round % 3 == 0 {
                let [a, b, c] = knots.map(|time| {
                    let way = velocity * (time - begin);
                    State::new(time, place + way, velocity + vector(bend))
                });
                let cubics = [between_states(&a, &b), between_states(&b, &c)];
                (Trajectory::from_states(&[a, b, c]), cubics)
            } else {
                let mut polynomials = [0; 2].map(|_| {
                    let [b, a] = [duration, duration * duration].map(|unit| vector(bend) / unit);
                    [a, b, velocity, place]
                });
                let (base, shifts) = match round % 3 {
                    1 => (TimeBase::Absolute, [knots[0], knots[1]]),
                    _ => (TimeBase::SegmentLocal, [0.0; 2]),
                };
                if round % 2 == 0 {
                    let end = shifts[1] + (knots[2] - knots[1]);
                    let [a, b, c, _] = &mut polynomials[1];
                    *c = -(*a * 3.0 * end + *b * 2.0) * end;
                }
                let cubics = [0, 1]
                    .map(|k| of_polynomial(&polynomials[k], shifts[k], [knots[k], knots[k + 1]]));
                (
                    Trajectory::from_coefficients(&knots, &polynomials, base),
                    cubics,
                )
            };
            let plan = plan.unwrap_or_else(|error| unreachable!("{error}"));
            let (needed, share) = assert_ends(&plan, &cubics[0], &cubics[1], durations);
            worst = worst.max(needed);
            largest = largest.max(share);
        }
        assert!(worst > 0.05 && largest <= 1.0, "{worst} {largest}");
    }

    /// Where a polynomial ends, its velocity may need one bit more than there is, and its position none.
    #[test]
    fn velocities_at_the_ends_are_rounded() {
        let mut rng = ChaCha8Rng::seed_from_u64(6);
        for _ in 0..300 {
            // With differences of whole units in the last place.
            let mut vector =
                |from: f64, to: f64| DVec3::from_array([0; 3].map(|_| rng.random_range(from..to)));
            let (quadratic, linear) = (vector(1.85, 1.9) - DVec3::ONE, vector(1.0, 1.1));
            let polynomial = [DVec3::ZERO, quadratic, linear, DVec3::ZERO];
            let knots = [0.0, 1.0];
            let base = TimeBase::SegmentLocal;
            let plan = Trajectory::from_coefficients(&knots, &[polynomial], base);
            let plan = plan.unwrap_or_else(|error| unreachable!("{error}"));
            let cubic = of_polynomial(&polynomial, 0.0, knots);
            assert_ends(&plan, &cubic, &cubic, 1.0);
        }
    }
}
