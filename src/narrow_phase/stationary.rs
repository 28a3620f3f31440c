//! Stationary points of the distance of two bodies within a span.
//!
//! The squared distance of two cubics is a polynomial of degree 6; its stationary points are the
//! roots of a polynomial of degree 5, found by Yuksel's recursion. The roots are then polished on
//! h · h' of the relative position vector h itself: the expanded coefficients lose half the digits
//! where the distance is small.

use super::relative::RelativeCubic;
use crate::polynomial::{Polynomial, Roots};
use crate::rounding::normalising_power;
use glam::DVec3;

/// Largest number of stationary points inside a span.
pub(crate) const MAX_STATIONARY: usize = 5;

/// Local parameters of the stationary points inside a span, increasing.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct StationaryPoints {
    points: [f64; MAX_STATIONARY],
    count: usize,
}

impl StationaryPoints {
    pub(crate) fn as_slice(&self) -> &[f64] {
        &self.points[..self.count]
    }

    fn push(&mut self, s: f64) {
        let distinct = self.count == 0 || s > self.points[self.count - 1];
        if distinct && self.count < MAX_STATIONARY && s > 0.0 && s < 1.0 {
            self.points[self.count] = s;
            self.count += 1;
        }
    }
}

/// Returns the stationary points of the distance inside the span, each minimum polished.
pub(crate) fn stationary_points(cubic: &RelativeCubic) -> StationaryPoints {
    let mut found = StationaryPoints::default();
    let derivative = squared_distance(cubic).derivative();
    if let Roots::At(roots) = derivative.roots_in(-1.0, 1.0, 0.0) {
        let roots = &roots[..];
        for (k, &u) in roots.iter().enumerate() {
            // Polishing never passes a neighbour: the order of minima and maxima stays.
            let low = found.as_slice().last().copied().unwrap_or(0.0);
            let high = roots.get(k + 1).map_or(1.0, |next| 0.5 + 0.5 * next);
            found.push(polish(cubic, 0.5 + 0.5 * u, (low, high)));
        }
    }
    found
}

/// Returns the squared distance over u = 2 s - 1 in -1..=1, up to a power of two.
///
/// Around the middle of the span the power coefficients stay within a small multiple of the
/// squared size; around an end they would grow 30 times larger, and their rounding with them.
fn squared_distance(cubic: &RelativeCubic) -> Polynomial<7> {
    let power = normalising_power(cubic.size);
    let [p0, p1, p2, p3] = cubic.points.map(|point| point * power);
    let (outer, inner) = (p0 + p3, 3.0 * (p1 + p2));
    let (outer_step, inner_step) = (p3 - p0, 3.0 * (p2 - p1));
    let c: [DVec3; 4] = [
        (outer + inner) * 0.125,
        (3.0 * outer_step + inner_step) * 0.125,
        (3.0 * outer - inner) * 0.125,
        (outer_step - inner_step) * 0.125,
    ];
    Polynomial::new([
        c[0].dot(c[0]),
        2.0 * c[0].dot(c[1]),
        2.0 * c[0].dot(c[2]) + c[1].dot(c[1]),
        2.0 * (c[0].dot(c[3]) + c[1].dot(c[2])),
        2.0 * c[1].dot(c[3]) + c[2].dot(c[2]),
        2.0 * c[2].dot(c[3]),
        c[3].dot(c[3]),
    ])
}

/// Moves a stationary point of the rounded polynomial onto the minimum of the distance itself.
///
/// Newton on h · h', accepted only while the distance shrinks. At a multiple root (docking) each
/// step only halves the error, hence the number of steps. Maxima are not moved: no answer depends
/// on their exact place.
fn polish(cubic: &RelativeCubic, start: f64, (low, high): (f64, f64)) -> f64 {
    const MAX_STEPS: usize = 60;
    let power = normalising_power(cubic.size);
    let mut s = start.max(low).min(high);
    let motion = cubic.power_forms();
    let (mut position, mut rate) = motion.at(s);
    let mut distance = (position * power).length_squared();
    for _ in 0..MAX_STEPS {
        let (h, h1, h2) = (position * power, rate * power, cubic.curvature(s) * power);
        let slope = h.dot(h1);
        let slope_change = h1.length_squared() + h.dot(h2);
        if slope_change <= 0.0 || slope_change.is_nan() {
            break;
        }
        let next = (s - slope / slope_change).max(low).min(high);
        let (next_position, next_rate) = motion.at(next);
        let next_distance = (next_position * power).length_squared();
        if next_distance.is_nan() || next_distance >= distance {
            break;
        }
        (s, position, rate, distance) = (next, next_position, next_rate, next_distance);
    }
    s
}
