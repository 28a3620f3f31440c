//! One relative cubic, and vectors of three numbers.

use crate::blossom::ControlPolygon;
use crate::real::Real;
use glam::DVec3;

pub(crate) type Vector<R> = [R; 3];

/// The motion of one body relative to another over a span: four Bezier control points, metres.
///
/// At the local time `s` in 0..=1 the relative position is
/// `(1-s)³ p0 + 3 s (1-s)² p1 + 3 s² (1-s) p2 + s³ p3`.
pub type ControlPoints<R> = [[R; 3]; 4];

#[inline(always)]
fn add<R: Real>(a: Vector<R>, b: Vector<R>) -> Vector<R> {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

#[inline(always)]
fn subtract<R: Real>(a: Vector<R>, b: Vector<R>) -> Vector<R> {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

#[inline(always)]
fn scale<R: Real>(factor: R, a: Vector<R>) -> Vector<R> {
    [factor * a[0], factor * a[1], factor * a[2]]
}

#[inline(always)]
pub(crate) fn dot<R: Real>(a: Vector<R>, b: Vector<R>) -> R {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline(always)]
fn rough<R: Real>(a: Vector<R>) -> Vector<f32> {
    [a[0].to_f32(), a[1].to_f32(), a[2].to_f32()]
}

/// A relative cubic in powers of the centred time `u = 2 s - 1` in -1..=1, times eight.
///
/// The factor saves the divisions; distances are divided by eight at the end. Around the middle
/// the coefficients are as small as they get. For control points within M of the origin, their norms
/// are at most M, 3/2 M, 3/2 M and M, without the factor: 5 M in sum.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CentredCubic<R> {
    pub(crate) coefficients: [Vector<R>; 4],
}

impl<R: Real> CentredCubic<R> {
    #[inline(always)]
    pub(crate) fn new(points: ControlPoints<R>) -> Self {
        let three = R::from_f64(3.0);
        let [p0, p1, p2, p3] = points;
        let outer_sum = add(p0, p3);
        let outer_difference = subtract(p3, p0);
        let inner_sum = add(p1, p2);
        let inner_difference = subtract(p2, p1);
        Self {
            coefficients: [
                add(outer_sum, scale(three, inner_sum)),
                scale(three, add(outer_difference, inner_difference)),
                scale(three, subtract(outer_sum, inner_sum)),
                subtract(outer_difference, scale(three, inner_difference)),
            ],
        }
    }

    /// Returns the cubic rounded to `f32`.
    #[inline(always)]
    pub(crate) fn rough(&self) -> CentredCubic<f32> {
        let [c0, c1, c2, c3] = self.coefficients;
        CentredCubic {
            coefficients: [rough(c0), rough(c1), rough(c2), rough(c3)],
        }
    }

    /// Returns the position at `u`, times eight.
    #[inline(always)]
    pub(crate) fn position(&self, u: R) -> Vector<R> {
        let [c0, c1, c2, c3] = self.coefficients;
        add(c0, scale(u, add(c1, scale(u, add(c2, scale(u, c3))))))
    }

    /// Returns the squared distance at `u`, times 64.
    #[inline(always)]
    pub(crate) fn square(&self, u: R) -> R {
        let position = self.position(u);
        dot(position, position)
    }

    /// Returns position, velocity, half the second and a sixth of the third derivative at `u`, all
    /// times eight, by repeated division by `u - u*`.
    #[inline(always)]
    pub(crate) fn derivatives(&self, u: R) -> [Vector<R>; 4] {
        let [c0, c1, c2, c3] = self.coefficients;
        let p2 = add(c2, scale(u, c3));
        let p1 = add(c1, scale(u, p2));
        let p0 = add(c0, scale(u, p1));
        let v2 = add(p2, scale(u, c3));
        let v1 = add(p1, scale(u, v2));
        let b2 = add(v2, scale(u, c3));
        [p0, v1, b2, c3]
    }

    /// Returns the coefficients of the squared distance in powers of `u`, times 64.
    #[inline(always)]
    pub(crate) fn squared_distance(&self) -> [R; 7] {
        let [c0, c1, c2, c3] = self.coefficients;
        let two = R::from_f64(2.0);
        [
            dot(c0, c0),
            two * dot(c0, c1),
            two * dot(c0, c2) + dot(c1, c1),
            two * (dot(c0, c3) + dot(c1, c2)),
            two * dot(c1, c3) + dot(c2, c2),
            two * dot(c2, c3),
            dot(c3, c3),
        ]
    }
}

/// Converts control points for the enclosures.
#[inline(always)]
pub(crate) fn polygon([p0, p1, p2, p3]: &ControlPoints<f64>) -> ControlPolygon {
    [
        DVec3::from_array(*p0),
        DVec3::from_array(*p1),
        DVec3::from_array(*p2),
        DVec3::from_array(*p3),
    ]
}

/// Converts control points for the kernels.
#[inline(always)]
pub(crate) fn coordinates([p0, p1, p2, p3]: &ControlPolygon) -> ControlPoints<f64> {
    [p0.to_array(), p1.to_array(), p2.to_array(), p3.to_array()]
}

#[inline]
pub(crate) fn in_f64<R: Real>([p0, p1, p2, p3]: &ControlPoints<R>) -> ControlPoints<f64> {
    let wide = |p: &Vector<R>| [p[0].to_f64(), p[1].to_f64(), p[2].to_f64()];
    [wide(p0), wide(p1), wide(p2), wide(p3)]
}

/// Returns the largest of four squares, or NaN if one of them is NaN or their sum overflows.
#[inline(always)]
pub(crate) fn largest_of<R: Real>([a, b, c, d]: [R; 4]) -> R {
    // What is no number is lost where the larger one of two is taken, but not in a product.
    let sum = (a + b) + (c + d);
    (a.max_or_other(b)).max_or_other(c.max_or_other(d)) + R::from_f64(0.0) * sum
}

#[inline]
pub(crate) fn largest_coordinate(points: &ControlPoints<f64>) -> f64 {
    let mut largest = 0.0;
    for coordinate in points.iter().flatten() {
        let size = coordinate.abs();
        // Also what is no number, and then nothing else.
        largest = if size > largest || size.is_nan() {
            size
        } else {
            largest
        };
    }
    largest
}

/// Returns the local time 0..=1 of a centred time -1..=1.
#[inline(always)]
pub(crate) fn local_time<R: Real>(centred: R) -> R {
    R::from_f64(0.5) * (centred + R::from_f64(1.0))
}

/// Returns the distance from 64 times its square.
#[inline(always)]
pub(crate) fn distance<R: Real>(square: R) -> R {
    R::from_f64(0.125) * square.sqrt()
}
