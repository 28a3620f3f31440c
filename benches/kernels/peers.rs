//! Other ways to find the closest approach of two cubics, as they are commonly written.

use nearmiss::kernels::ControlPoints;

/// A relative cubic in powers of the centred local time -1..=1, and the slope of half the squared
/// distance: what all these methods start from.
struct Centred {
    coefficients: [[f64; 3]; 4],
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

impl Centred {
    #[inline]
    fn new(points: &ControlPoints<f64>) -> Self {
        let [p0, p1, p2, p3] = *points;
        let mut coefficients = [[0.0; 3]; 4];
        for i in 0..3 {
            let (a, b, c, d) = (p0[i], p1[i], p2[i], p3[i]);
            coefficients[0][i] = 0.125 * (a + d + 3.0 * (b + c));
            coefficients[1][i] = 0.375 * (d - a + c - b);
            coefficients[2][i] = 0.375 * (a + d - b - c);
            coefficients[3][i] = 0.125 * (d - a - 3.0 * (c - b));
        }
        Self { coefficients }
    }

    #[inline]
    fn square(&self, u: f64) -> f64 {
        let [c0, c1, c2, c3] = self.coefficients;
        let x = c0[0] + u * (c1[0] + u * (c2[0] + u * c3[0]));
        let y = c0[1] + u * (c1[1] + u * (c2[1] + u * c3[1]));
        let z = c0[2] + u * (c1[2] + u * (c2[2] + u * c3[2]));
        x * x + y * y + z * z
    }

    /// The coefficients of the derivative of the squared distance.
    #[inline]
    fn slope(&self) -> [f64; 6] {
        let [c0, c1, c2, c3] = self.coefficients;
        [
            2.0 * dot(c0, c1),
            4.0 * dot(c0, c2) + 2.0 * dot(c1, c1),
            6.0 * (dot(c0, c3) + dot(c1, c2)),
            8.0 * dot(c1, c3) + 4.0 * dot(c2, c2),
            10.0 * dot(c2, c3),
            6.0 * dot(c3, c3),
        ]
    }

    /// The nearest of the ends and some stationary points: local time and distance.
    #[inline]
    fn nearest(&self, stationary: &[f64]) -> (f64, f64) {
        let mut best = (-1.0, self.square(-1.0));
        for &u in stationary {
            let square = self.square(u);
            if square < best.1 {
                best = (u, square);
            }
        }
        let square = self.square(1.0);
        if square < best.1 {
            best = (1.0, square);
        }
        (0.5 * (best.0 + 1.0), best.1.sqrt())
    }
}

/// The `polycool` crate's roots of the slope, to a tolerance in local time.
pub(crate) fn polycool(points: &ControlPoints<f64>, tolerance: f64) -> (f64, f64) {
    let cubic = Centred::new(points);
    let slope = polycool::Poly::new(cubic.slope());
    cubic.nearest(&slope.roots_between(-1.0, 1.0, 2.0 * tolerance))
}

/// The eigenvalues of the companion matrix of the slope, by `nalgebra`.
pub(crate) fn companion(points: &ControlPoints<f64>) -> (f64, f64) {
    let cubic = Centred::new(points);
    let slope = cubic.slope();
    let mut matrix = nalgebra::SMatrix::<f64, 5, 5>::zeros();
    for i in 0..5 {
        if i > 0 {
            matrix[(i, i - 1)] = 1.0;
        }
        matrix[(i, 4)] = -slope[i] / slope[5];
    }
    // A leading coefficient of zero has no companion matrix.
    if matrix.iter().any(|x| !x.is_finite()) {
        return cubic.nearest(&[]);
    }
    let eigenvalues = matrix.complex_eigenvalues();
    let mut real = [0.0; 5];
    let mut count = 0;
    for z in &eigenvalues {
        if z.im.abs() < 1e-9 && z.re.abs() < 1.0 {
            real[count] = z.re;
            count += 1;
        }
    }
    cubic.nearest(&real[..count])
}

/// The lowest of 65 samples and four Newton steps on the slope.
pub(crate) fn sampled(points: &ControlPoints<f64>) -> (f64, f64) {
    let cubic = Centred::new(points);
    let mut best = (0, f64::INFINITY);
    for i in 0..=64 {
        let square = cubic.square(f64::from(i) / 32.0 - 1.0);
        if square < best.1 {
            best = (i, square);
        }
    }
    let slope = cubic.slope();
    let mut u = f64::from(best.0) / 32.0 - 1.0;
    let (low, high) = ((u - 1.0 / 32.0).max(-1.0), (u + 1.0 / 32.0).min(1.0));
    for _ in 0..4 {
        let (mut value, mut derivative) = (0.0, 0.0);
        for coefficient in slope.iter().rev() {
            derivative = derivative * u + value;
            value = value * u + coefficient;
        }
        let next = u - value / derivative;
        u = if next.is_nan() {
            u
        } else {
            next.clamp(low, high)
        };
    }
    cubic.nearest(&[u])
}

/// Returns true if the pair comes within a threshold: a root of the squared distance less its square, by
/// the crate's own root finder, unless an end is inside already.
pub(crate) fn within_by_roots(points: &ControlPoints<f64>, threshold: f64) -> bool {
    use nearmiss::internals::polynomial::roots;

    let limit = threshold * threshold;
    let cubic = Centred::new(points);
    if cubic.square(-1.0) <= limit || cubic.square(1.0) <= limit {
        return true;
    }
    let [c0, c1, c2, c3] = cubic.coefficients;
    let difference = [
        dot(c0, c0) - limit,
        2.0 * dot(c0, c1),
        2.0 * dot(c0, c2) + dot(c1, c1),
        2.0 * (dot(c0, c3) + dot(c1, c2)),
        2.0 * dot(c1, c3) + dot(c2, c2),
        2.0 * dot(c2, c3),
        dot(c3, c3),
    ];
    !roots(difference, 1.2e-6).is_empty()
}
