//! Cubic polynomials of quaternions, normalised.
//!
//! With q the polynomial, N = q c q* is of degree 6 and D = |q|² as well, and the way of a point c
//! is N / D. A cubic H differs from it by at most the largest Bernstein coefficient of D H - N, of
//! degree 9, over the smallest one of D. Both are linear in c: matrices stand for all points.

use super::baked::BakedRotation;
use crate::blossom::restrict_to;
use crate::count::whole;
use glam::{DMat3, DQuat, DVec3};

/// A cubic of quaternions between two knots, in Bézier form.
#[derive(Clone, Copy, Debug)]
pub(super) struct QuaternionCubic {
    /// First and last instant, s.
    pub(super) ends: (f64, f64),
    pub(super) points: [DQuat; 4],
}

impl QuaternionCubic {
    /// Returns the rotation at an instant (s).
    pub(super) fn at(&self, time: f64) -> DQuat {
        let [point, ..] = restrict_to(&self.points, self.ends, (time, time));
        point * (1.0 / point.length())
    }

    /// Returns the angular velocity at the first or last knot, rad per duration.
    pub(super) fn end_velocities(&self) -> [DVec3; 2] {
        let [q0, q1, q2, q3] = self.points;
        let velocity = |rate: DQuat, at: DQuat| {
            let turn = rate * at.conjugate();
            DVec3::new(turn.x, turn.y, turn.z) * (2.0 / at.length_squared())
        };
        [velocity((q1 - q0) * 3.0, q0), velocity((q3 - q2) * 3.0, q3)]
    }

    /// Returns the cubic between two instants (s).
    pub(super) fn bake(&self, ends: (f64, f64)) -> BakedRotation {
        let points = restrict_to(&self.points, self.ends, ends);
        let (squares, turned) = products(&points);
        let (first, last) = (
            turned[0] * (1.0 / squares[0]),
            turned[6] * (1.0 / squares[6]),
        );
        // A third of the derivative of N / D at either end.
        let slope = |matrix: DMat3, turned: [DMat3; 2], squares: [f64; 2]| {
            ((turned[1] - turned[0]) - matrix * (squares[1] - squares[0])) * (2.0 / squares[0])
        };
        let leave = slope(first, [turned[0], turned[1]], [squares[0], squares[1]]);
        let arrive = slope(last, [turned[6], turned[5]], [squares[6], squares[5]]);
        let points = [first, first + leave, last + arrive, last];
        let least = squares.iter().copied().fold(f64::INFINITY, f64::min);
        let error = largest_difference(&points, &squares, &turned);
        // Rounding of the coefficients, whose terms stay below 20: 200 roundings. Four times over, for the
        // control points' and for the bounds' own.
        let error = (error + 16.0 * BakedRotation::ROUNDING) / least;
        if least > MIN_SQUARE && error < 1.0 {
            BakedRotation::new(ends, points, error)
        } else {
            BakedRotation::unknown(ends)
        }
    }

    /// Returns the number of equal parts in which the error is at most `tolerance`, or `None` if
    /// they are too many.
    pub(super) fn parts_within(&self, tolerance: f64) -> Option<u32> {
        /// The error falls with the fourth power of the number.
        const MAX_PARTS: u32 = 4096;
        let mut count = 1;
        while count <= MAX_PARTS {
            let error = self.largest_error(count);
            if error <= tolerance || self.is_cut_finely(count) {
                // Where no instants divide it, the rotation is unknown, as that of an arc.
                return Some(count);
            }
            let factor = (error / tolerance).sqrt().sqrt();
            // At most three quarters of what the power says: it holds for short parts alone.
            let next = f64::from(count) * factor.clamp(1.0, 4.0) * 0.75;
            // Near the tolerance the power says too little: each count is tried on all its parts.
            count = whole(next).max(count + 1 + count / 8);
        }
        None
    }

    /// Returns true if there are no instants for parts half as long.
    fn is_cut_finely(&self, count: u32) -> bool {
        let (start, end) = self.ends;
        let step = f64::EPSILON * start.abs().max(end.abs());
        (end - start) / f64::from(count) < 4.0 * step
    }

    fn largest_error(&self, count: u32) -> f64 {
        let errors = (0..count).map(|number| {
            let cut = |number: u32| equal_cut(self.ends, number, count);
            self.bake((cut(number), cut(number + 1))).error()
        });
        errors.fold(0.0, f64::max)
    }
}

/// Returns the end of the first `number` of `count` equal parts of an interval.
pub(super) fn equal_cut((start, end): (f64, f64), number: u32, count: u32) -> f64 {
    if number == 0 {
        start
    } else if number >= count {
        end
    } else {
        (start + (end - start) * (f64::from(number) / f64::from(count))).clamp(start, end)
    }
}

/// Smallest squared length of a quaternion that is normalised.
const MIN_SQUARE: f64 = 1e-3;

/// Binomial coefficients of the degrees 3, 6 and 9.
const CHOOSE_3: [f64; 4] = [1.0, 3.0, 3.0, 1.0];
const CHOOSE_6: [f64; 7] = [1.0, 6.0, 15.0, 20.0, 15.0, 6.0, 1.0];
const CHOOSE_9: [f64; 10] = [1.0, 9.0, 36.0, 84.0, 126.0, 126.0, 84.0, 36.0, 9.0, 1.0];

/// Returns the Bernstein coefficients of |q|² and of the matrix of q c q*, of degree 6.
fn products(points: &[DQuat; 4]) -> ([f64; 7], [DMat3; 7]) {
    let (mut squares, mut turned) = ([0.0; 7], [DMat3::ZERO; 7]);
    for (i, &p) in points.iter().enumerate() {
        for (j, &q) in points.iter().enumerate() {
            let weight = CHOOSE_3[i] * CHOOSE_3[j] / CHOOSE_6[i + j];
            squares[i + j] += p.dot(q) * weight;
            turned[i + j] += symmetric_product(p, q) * weight;
        }
    }
    (squares, turned)
}

/// Returns the matrix of a unit quaternion.
pub(super) fn matrix(rotation: DQuat) -> DMat3 {
    symmetric_product(rotation, rotation)
}

/// Returns the symmetric bilinear form of two quaternions that is the matrix of q c q* for equal
/// ones.
fn symmetric_product(p: DQuat, q: DQuat) -> DMat3 {
    let (ww, xx, yy, zz) = (p.w * q.w, p.x * q.x, p.y * q.y, p.z * q.z);
    let (xy, xz, yz) = (
        p.x * q.y + p.y * q.x,
        p.x * q.z + p.z * q.x,
        p.y * q.z + p.z * q.y,
    );
    let (wx, wy, wz) = (
        p.w * q.x + p.x * q.w,
        p.w * q.y + p.y * q.w,
        p.w * q.z + p.z * q.w,
    );
    DMat3::from_cols(
        DVec3::new((ww + xx) - (yy + zz), xy + wz, xz - wy),
        DVec3::new(xy - wz, (ww + yy) - (xx + zz), yz + wx),
        DVec3::new(xz + wy, yz - wx, (ww + zz) - (xx + yy)),
    )
}

/// Returns the largest norm of a Bernstein coefficient of D H - N, of degree 9, to rounding.
fn largest_difference(points: &[DMat3; 4], squares: &[f64; 7], turned: &[DMat3; 7]) -> f64 {
    let mut coefficients = [DMat3::ZERO; 10];
    for i in 0..7 {
        for j in 0..4 {
            let weight = CHOOSE_6[i] * CHOOSE_3[j] / CHOOSE_9[i + j];
            coefficients[i + j] += (points[j] * squares[i] - turned[i]) * weight;
        }
    }
    let norms = coefficients.iter().map(norm_bound);
    norms.fold(0.0, f64::max)
}

/// Returns an upper bound, to rounding, of the factor by which a matrix lengthens a vector: the root of
/// its largest sum of a column's and of a row's magnitudes, or that of all squares.
fn norm_bound(matrix: &DMat3) -> f64 {
    let [a, b, c] = [matrix.x_axis, matrix.y_axis, matrix.z_axis];
    let column = |v: DVec3| v.abs().element_sum();
    let columns = column(a).max(column(b)).max(column(c));
    let rows = (a.abs() + b.abs() + c.abs()).max_element();
    let squares = a.length_squared() + b.length_squared() + c.length_squared();
    (columns * rows).min(squares).sqrt()
}
