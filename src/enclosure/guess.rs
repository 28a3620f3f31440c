//! A guess where the distance is least. Never trusted: what follows certifies or corrects it.

use super::piece::Polygon;
use glam::DVec3;

/// The parameter in 0..=1 at which the distance seems least.
///
/// Nine samples of the degree-6 polynomial in the centred parameter v = 2s - 1, Newton steps on
/// its derivative between the neighbouring samples, and one on h·h' in vector form, which keeps
/// its digits where the distance is small against the control points.
#[inline]
pub(super) fn least_point(points: &Polygon) -> f64 {
    let cubic = Centred::of(points);
    let square = cubic.squared();
    let mut v = square.best_sample();
    let (mut low, mut high) = (v - 0.25, v + 0.25);
    let (mut slope, mut bend) = square.slope_and_bend(v);
    if v >= 1.0 && slope <= 0.0 {
        return 1.0;
    }
    if v <= -1.0 && slope >= 0.0 {
        return 0.0;
    }
    for _ in 0..2 {
        if slope > 0.0 {
            high = v;
        } else {
            low = v;
        }
        let step = v - slope / bend;
        // Also where the step is NaN.
        v = if bend > 0.0 && low <= step && step <= high {
            step
        } else {
            0.5 * (low + high)
        };
        (slope, bend) = square.slope_and_bend(v);
    }
    let s = 0.5 * (1.0 + cubic.polished(v));
    s.clamp(0.0, 1.0)
}

/// `c0 + c1 v + c2 v² + c3 v³`.
struct Centred([DVec3; 4]);

impl Centred {
    #[inline]
    fn of(points: &Polygon) -> Self {
        let [h0, h1, h2, h3] = *points;
        let (outer, inner) = (h0 + h3, h1 + h2);
        let (outer_step, inner_step) = (h3 - h0, h2 - h1);
        Self([
            (outer + inner * 3.0) * 0.125,
            (outer_step + inner_step) * 0.375,
            (outer - inner) * 0.375,
            (outer_step - inner_step * 3.0) * 0.125,
        ])
    }

    #[inline]
    fn squared(&self) -> Sextic {
        let [c0, c1, c2, c3] = self.0;
        Sextic([
            c0.dot(c0),
            2.0 * c0.dot(c1),
            2.0 * c0.dot(c2) + c1.dot(c1),
            2.0 * (c0.dot(c3) + c1.dot(c2)),
            2.0 * c1.dot(c3) + c2.dot(c2),
            2.0 * c2.dot(c3),
            c3.dot(c3),
        ])
    }

    /// Newton steps on h·h' = 0, as long as they are short but not yet lost in rounding.
    #[inline]
    fn polished(&self, mut v: f64) -> f64 {
        const SHORT: f64 = 0.0625;
        const LOST: f64 = 1e-8;
        let [c0, c1, c2, c3] = self.0;
        for _ in 0..4 {
            let position = c0 + (c1 + (c2 + c3 * v) * v) * v;
            let first = c1 + (c2 * 2.0 + c3 * (3.0 * v)) * v;
            let second = (c2 + c3 * (3.0 * v)) * 2.0;
            let step = position.dot(first) / (first.dot(first) + position.dot(second));
            if step.abs() < SHORT {
                v -= step;
            }
            // The next step would be of the order of this one's square. Also where it is NaN.
            if !(LOST..SHORT).contains(&step.abs()) {
                break;
            }
        }
        v
    }
}

/// The squared distance as a polynomial in v.
struct Sextic([f64; 7]);

impl Sextic {
    /// The best of v = 0, ±1/4, ±1/2, ±3/4, ±1.
    #[inline]
    fn best_sample(&self) -> f64 {
        let [a0, a1, a2, a3, a4, a5, a6] = self.0;
        let mut best = (a0, 0.0);
        for v in [0.25, 0.5, 0.75, 1.0] {
            let w = v * v;
            let even = a0 + w * (a2 + w * (a4 + w * a6));
            let odd = v * (a1 + w * (a3 + w * a5));
            // Of v and -v the better one has the value even - |odd|.
            let value = even - odd.abs();
            if value < best.0 {
                best = (value, if odd > 0.0 { -v } else { v });
            }
        }
        best.1
    }

    #[inline]
    fn slope_and_bend(&self, v: f64) -> (f64, f64) {
        let [_, a1, a2, a3, a4, a5, a6] = self.0;
        let (b2, b3, b4, b5, b6) = (2.0 * a2, 3.0 * a3, 4.0 * a4, 5.0 * a5, 6.0 * a6);
        (
            a1 + v * (b2 + v * (b3 + v * (b4 + v * (b5 + v * b6)))),
            b2 + v * (2.0 * b3 + v * (3.0 * b4 + v * (4.0 * b5 + v * 5.0 * b6))),
        )
    }
}
