//! Seeded families of relative cubics, as Bezier control points, from easy to cruel.

use rand::{Rng, RngExt};

pub(crate) type Polygon = [[f64; 3]; 4];

/// What is special about a family.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Family {
    /// All control points of one size.
    Random,
    /// Passes the origin at a distance 1e-12 to 1e-1 of its own size.
    FlyBy,
    /// Passes through the origin, up to the rounding of the control points.
    Crossing,
    /// Comes to rest at the origin, or next to it: distance and velocity vanish together.
    Docking,
    /// The relative position has a triple root, up to an offset of 1e-18 to 1.
    Triple,
    /// Two components with different double roots: several near-equal minima.
    ManyMinima,
    /// Runs around the origin at nearly the same distance.
    Around,
    /// The relative position is constant, exactly or up to a few roundings.
    Parallel,
    /// On one line through, or beside, the origin.
    Line,
    /// Least at one end of the interval.
    AtTheEnd,
    /// The control points lie next to each other, far from the origin: a tiny span.
    Tiny,
    /// Every component has a size of its own, 1e-20 to 1e20.
    Mixed,
    /// Coefficients of the highest orders vanish, exactly or nearly.
    LowDegree,
    /// All zero, or all but one point.
    Zeros,
}

pub(crate) const FAMILIES: [Family; 14] = [
    Family::Random,
    Family::FlyBy,
    Family::Crossing,
    Family::Docking,
    Family::Triple,
    Family::ManyMinima,
    Family::Around,
    Family::Parallel,
    Family::Line,
    Family::AtTheEnd,
    Family::Tiny,
    Family::Mixed,
    Family::LowDegree,
    Family::Zeros,
];

/// Exponents of two for the size of a case: 1, 1e±150, 1e±290 and subnormal numbers.
const SIZES: [i32; 8] = [0, 0, 0, 3, -500, 500, -965, 960];
const SUBNORMAL: i32 = -1060;

pub(crate) fn polygon(random: &mut impl Rng, family: Family) -> Polygon {
    let plain = plain(random, family);
    let power = match random.random_range(0..40) {
        0 => SUBNORMAL,
        // 1e20 times 2^960 is out of range.
        1..8 if family != Family::Mixed => SIZES[random.random_range(0..SIZES.len())],
        _ => 0,
    };
    plain.map(|point| point.map(|x| times_power_of_two(x, power)))
}

/// In two steps, so that the factor is always a normal number.
fn times_power_of_two(x: f64, power: i32) -> f64 {
    x * 2f64.powi(power / 2) * 2f64.powi(power - power / 2)
}

fn plain(random: &mut impl Rng, family: Family) -> Polygon {
    match family {
        Family::Random => [(); 4].map(|()| vector(random, 1.0)),
        Family::FlyBy => {
            let miss = log_uniform(random, 1e-12, 1e-1);
            let mut coefficients = [(); 4].map(|()| vector(random, 1.0));
            coefficients[0] = vector(random, miss);
            around(random, coefficients)
        }
        Family::Crossing => {
            let mut coefficients = [(); 4].map(|()| vector(random, 1.0));
            coefficients[0] = [0.0; 3];
            around(random, coefficients)
        }
        Family::Docking => {
            let mut coefficients = [(); 4].map(|()| vector(random, 1.0));
            coefficients[0] = offset(random);
            coefficients[1] = if random.random_range(0..2) == 0 {
                [0.0; 3]
            } else {
                offset(random)
            };
            around(random, coefficients)
        }
        Family::Triple => {
            let cube = vector(random, 1.0);
            let coefficients = [offset(random), [0.0; 3], offset(random), cube];
            around(random, coefficients)
        }
        Family::ManyMinima => many_minima(random),
        Family::Around => circle(random),
        Family::Parallel => {
            let point = vector(random, 1.0);
            let ulps = random.random_range(0..3);
            let noise = f64::from(ulps) * f64::EPSILON;
            [(); 4].map(|()| point.map(|x| x * (1.0 + noise * random.random_range(-1.0..1.0))))
        }
        Family::Line => {
            let (direction, beside) = (vector(random, 1.0), offset(random));
            [(); 4].map(|()| {
                let x: f64 = random.random_range(-1.0..1.0);
                std::array::from_fn(|i| direction[i] * x + beside[i])
            })
        }
        Family::AtTheEnd => {
            let mut points = [(); 4].map(|()| vector(random, 1.0).map(f64::abs));
            let end = if random.random_range(0..2) == 0 { 0 } else { 3 };
            let near = log_uniform(random, 1e-12, 1.0);
            points[end] = points[end].map(|x| x * near);
            points
        }
        Family::Tiny => {
            let (point, spread) = (vector(random, 1.0), log_uniform(random, 1e-17, 1e-5));
            [(); 4].map(|()| {
                let step = vector(random, spread);
                std::array::from_fn(|i| point[i] + step[i])
            })
        }
        Family::Mixed => [(); 4].map(|()| {
            std::array::from_fn(|_| {
                let size = log_uniform(random, 1e-20, 1e20);
                random.random_range(-1.0..1.0) * size
            })
        }),
        Family::LowDegree => {
            let mut coefficients = [(); 4].map(|()| vector(random, 1.0));
            for coefficient in coefficients.iter_mut().skip(random.random_range(1..4)) {
                let factor = [0.0, 1e-17, 1e-9][random.random_range(0..3)];
                *coefficient = coefficient.map(|x| x * factor);
            }
            bezier(coefficients)
        }
        Family::Zeros => {
            let mut points = [[0.0; 3]; 4];
            let one: usize = random.random_range(0..8);
            if let Some(point) = points.get_mut(one) {
                *point = vector(random, 1.0);
            }
            points
        }
    }
}

fn vector(random: &mut impl Rng, size: f64) -> [f64; 3] {
    std::array::from_fn(|_| random.random_range(-1.0..1.0) * size)
}

fn log_uniform(random: &mut impl Rng, low: f64, high: f64) -> f64 {
    let exponent: f64 = random.random_range(low.log2()..high.log2());
    exponent.exp2()
}

/// Zero, or a vector of size 1e-18 to 1.
fn offset(random: &mut impl Rng) -> [f64; 3] {
    if random.random_range(0..3) == 0 {
        [0.0; 3]
    } else {
        let size = log_uniform(random, 1e-18, 1.0);
        vector(random, size)
    }
}

/// Control points of c0 + c1 (s - a) + c2 (s - a)² + c3 (s - a)³, for a random a: dyadic half of
/// the time, so that roots and minima at a are met exactly.
fn around(random: &mut impl Rng, coefficients: Polygon) -> Polygon {
    let a = match random.random_range(0..8) {
        0 => 0.0,
        1 => 1.0,
        2..5 => f64::from(random.random_range(0..64)) / 64.0,
        _ => random.random_range(0.0..1.0),
    };
    let [c0, c1, c2, c3] = coefficients;
    bezier([0, 1, 2, 3].map(|order| {
        std::array::from_fn(|i| match order {
            0 => c0[i] - a * (c1[i] - a * (c2[i] - a * c3[i])),
            1 => c1[i] - a * (2.0 * c2[i] - 3.0 * a * c3[i]),
            2 => c2[i] - 3.0 * a * c3[i],
            _ => c3[i],
        })
    }))
}

/// Control points of a cubic in power form.
fn bezier([c0, c1, c2, c3]: Polygon) -> Polygon {
    let mut points = [c0; 4];
    for i in 0..3 {
        points[1][i] = c0[i] + c1[i] / 3.0;
        points[2][i] = c0[i] + (2.0 * c1[i] + c2[i]) / 3.0;
        points[3][i] = c0[i] + c1[i] + c2[i] + c3[i];
    }
    points
}

/// Each component is a cubic with three roots in 0..1, those of the components near each other.
fn many_minima(random: &mut impl Rng) -> Polygon {
    let roots = [(); 3].map(|()| random.random_range(0.0..1.0));
    let spread = log_uniform(random, 1e-12, 0.1);
    let mut coefficients = [[0.0; 3]; 4];
    for axis in [0, 1, 2] {
        let scale = random.random_range(-1.0..1.0);
        let [p, q, r]: [f64; 3] = roots.map(|x| x + spread * random.random_range(-1.0..1.0));
        let component = [-p * q * r, p * q + q * r + r * p, -(p + q + r), 1.0];
        for (coefficient, x) in coefficients.iter_mut().zip(component) {
            coefficient[axis] = scale * x;
        }
    }
    bezier(coefficients)
}

/// A quarter of a circle as well as a cubic can, slightly disturbed: six near-equal extrema.
fn circle(random: &mut impl Rng) -> Polygon {
    let kappa = 0.551_784_777_9;
    let noise = log_uniform(random, 1e-17, 1e-3);
    let points = [
        [1.0, 0.0, 0.0],
        [1.0, kappa, 0.0],
        [kappa, 1.0, 0.0],
        [0.0, 1.0, 0.0],
    ];
    points.map(|point| point.map(|x| x + noise * random.random_range(-1.0..1.0)))
}
