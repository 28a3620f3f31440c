//! How the end cubics go on beyond their knots: coefficients around the knot, each good to its own
//! rounding.
//!
//! With T the duration between two states, e = v T - (p1 - p0) at either of them, and s the time since a
//! knot in units of T, the cubic through both is
//!
//! ```text
//! p0 + v0 T s - (2 e0 + e1) s² + (e0 + e1) s³      around the first knot,
//! p1 + v1 T s + (e0 + 2 e1) s² + (e0 + e1) s³      around the second one.
//! ```
//!
//! Position and velocity are the user's numbers. So what goes on is as good as the coefficients of s²
//! and s³. Between straight states e vanishes: taken from rounded control points it would be a rounding
//! of the way between them, times s³.
//!
//! Products and differences of two f64 are sums of two, exactly; a sum of two such pairs is wrong by
//! 3 u² of itself (u = 2^-53; Joldes, Muller, Popescu, "Tight and rigorous error bounds for basic
//! building blocks of double-word arithmetic", 2017). T = T' + T'', the second at most u T. So
//! e = (v T' - (p1 - p0)) + v T'' is wrong by 7 u² |e| + 4 u³ |v T| at most. As e0 and e1 follow from
//! both coefficients b and c, these are wrong by
//!
//! - their own rounding, and that of the powers of the unit: 7 u |b|, 10 u |c|;
//! - 40 u² (|b| + |c|) + 16 u³ (|a| + 2 |b| + 3 |c|), with a the coefficient of s.
//!
//! The second line, times s² and s³, is less than u (|a| s + |b| s² + |c| s³) (1 + 64 u s)² from s = 1
//! on; before that the error of the first piece holds it. Of a polynomial all coefficients are formed
//! exactly, and rounded once. With the 12 roundings of what is computed from them, 32 roundings of each
//! term hold all; 32 of the first piece's extent are added throughout. What underflows is below 2^-1022,
//! times s³.

use super::State;
use super::double_double::{DoubleDouble, Expansion};
use glam::DVec3;

/// Quadratic and cubic coefficient of the cubic through two states around the first one, and around the
/// second one, in units of the duration between them.
pub(super) fn of_states(first: &State, second: &State) -> [[DVec3; 2]; 2] {
    let duration = DoubleDouble::difference(second.time, first.time);
    let mut bends = [[DVec3::ZERO; 2]; 2];
    for axis in 0..3 {
        let back = DoubleDouble::difference(first.position[axis], second.position[axis]);
        let [leave, arrive] = [first, second].map(|state| {
            let [way, rest] = duration
                .parts()
                .map(|part| DoubleDouble::product(state.velocity[axis], part));
            (way + back) + rest
        });
        let sum = leave + arrive;
        bends[0][0][axis] = -(sum + leave).rounded();
        bends[1][0][axis] = (sum + arrive).rounded();
        bends[0][1][axis] = sum.rounded();
        bends[1][1][axis] = bends[0][1][axis];
    }
    bends
}

/// Position, velocity, and the coefficients of time squared and cubed of `a t³ + b t² + c t + d` around
/// an instant t, given as a sum; and how far the position was rounded at most, m.
pub(super) fn of_polynomial(polynomial: &[DVec3; 4], time: DoubleDouble) -> ([DVec3; 4], f64) {
    let mut around = [DVec3::ZERO; 4];
    let mut lost = DVec3::ZERO;
    for axis in 0..3 {
        let mut sums = polynomial.map(|coefficient| Expansion::from(coefficient[axis]));
        // Horner's rule, one coefficient less each time: what is left of each pass is one of the shifted.
        for last in (1..4).rev() {
            for power in 1..=last {
                sums[power] = sums[power].clone() + sums[power - 1].times(time);
            }
        }
        for (power, sum) in sums.iter().enumerate() {
            around[3 - power][axis] = sum.rounded();
        }
        lost[axis] = (sums[3].clone() + Expansion::from(-around[0][axis])).rounded();
    }
    (
        around,
        lost.abs().element_sum() * (1.0 + f64::EPSILON * 4.0),
    )
}
