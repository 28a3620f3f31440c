//! One random case: a computed cubic, its error, and the exact cubic taken for the truth; and what
//! can be wrong with a claim about it.

use crate::oracle_support::{
    Body, Dyadic, Family, Polygon, SquaredDistance, is_at_most, least_sign, minimum, never_below,
    polygon, reaches, squared_distances,
};
use dashu::rational::RBig;
use nearmiss::glam::DVec3;
use nearmiss::internals::enclosure::{
    DistanceEnclosure, LeastDistance, ParameterEnclosure, Stretch, Threshold, UncertainCubic,
    Verdict,
};
use rand::{Rng, RngExt};

pub(crate) struct Case {
    pub(crate) cubic: UncertainCubic,
    pub(crate) points: Polygon,
    pub(crate) error: f64,
    pub(crate) truth: SquaredDistance,
}

impl Case {
    pub(crate) fn draw(random: &mut impl Rng, family: Family) -> Self {
        let points = polygon(random, family);
        let size = largest(&points);
        let relative = [0.0, 0.0, 1e-16, 1e-15, 1e-12, 1e-6, 1e-2][random.random_range(0..7)];
        let error = size * relative;
        // Each control point off by nearly all of the error: 1e-6 less, because the components
        // are rounded, and a few of the smallest numbers, because they are rounded to those.
        let length = 0.999_999 * (error - 2e-323).max(0.0);
        let disturbance = [(); 4].map(|()| {
            let direction: [f64; 3] = std::array::from_fn(|_| random.random_range(-1.0..1.0));
            let norm = direction.iter().map(|x| x * x).sum::<f64>().sqrt();
            direction.map(|x| -length * (x / norm))
        });
        Self::new(points, error, disturbance)
    }

    /// The exact cubic is the computed one minus the disturbance.
    pub(crate) fn new(points: Polygon, error: f64, disturbance: Polygon) -> Self {
        let body = Body::from_control_points(points);
        let other = Body::from_control_points(disturbance);
        Self {
            cubic: UncertainCubic::new(points.map(DVec3::from_array), error).unwrap(),
            points,
            error,
            truth: squared_distances(&body, &other, None).remove(0),
        }
    }

    /// A threshold to be hard on: the least distance within a few roundings, one that is crossed,
    /// zero, or negative; exact or an enclosure.
    pub(crate) fn threshold(&self, random: &mut impl Rng) -> Threshold {
        let DistanceEnclosure { low, high } = self.cubic.least_distance().distance;
        let size = largest(&self.points);
        let radius = match random.random_range(0..8) {
            0 => low,
            1 => high,
            2 => high * (1.0 + 1e-9),
            3 => high * (1.0 + 1e-5),
            4 => self.points[0][0].abs(),
            5 => 0.0,
            6 => size * random.random_range(-0.1..1.0),
            _ => high + (size - high).max(0.0) * random.random_range(0.0..1.0),
        };
        let spread = [0.0, 1e-16, 1e-10, 0.1][random.random_range(0..4)] * f64::abs(radius);
        Threshold {
            low: radius - spread,
            high: radius + spread,
        }
    }

    /// The length to which widths are compared: the error of the input, and 9 roundings of the
    /// largest control point.
    pub(crate) fn inherent_error(&self) -> f64 {
        self.error + 9.0 * (f64::EPSILON / 2.0) * largest_norm(&self.points)
    }
}

fn largest(points: &Polygon) -> f64 {
    points
        .iter()
        .flatten()
        .fold(0.0, |size: f64, x| size.max(x.abs()))
}

/// Whatever their size; `hypot` neither over- nor underflows.
pub(crate) fn largest_norm(points: &Polygon) -> f64 {
    let norm = |p: &[f64; 3]| p[0].hypot(p[1]).hypot(p[2]);
    points.iter().map(norm).fold(0.0, f64::max)
}

/// What is wrong with a least distance, if anything; looking for its instants takes the longest.
pub(crate) fn least_violation(
    case: &Case,
    claim: &LeastDistance,
    with_instants: bool,
) -> Option<String> {
    let DistanceEnclosure { low, high } = claim.distance;
    let ParameterEnclosure { first, last } = claim.parameter;
    let guess = claim.guess;
    if !(0.0 <= low && low <= high && high.is_finite()) {
        return Some("not an interval of distances".into());
    }
    if !(0.0 <= first && first <= guess && guess <= last && last <= 1.0) {
        return Some("not an interval of parameters around the guess".into());
    }
    if !never_below(&case.truth, &low.into()) {
        return Some("nearer than the lower end".into());
    }
    let is_reached =
        is_at_most(&case.truth, &guess.into(), &high.into()) || reaches(&case.truth, &high.into());
    if !is_reached {
        return Some("nowhere as near as the upper end".into());
    }
    if with_instants {
        let exact = |x: f64| Dyadic::from(x).to_rational();
        let least = minimum(std::slice::from_ref(&case.truth), 100).unwrap();
        let (first, last) = (exact(first), exact(last));
        let is_outside = |low: &RBig, high: &RBig| *low > last || *high < first;
        for stretch in &least.instants {
            if is_outside(&stretch.first.low, &stretch.first.high)
                || is_outside(&stretch.last.low, &stretch.last.high)
            {
                return Some(format!("least outside the parameters, at {stretch:?}"));
            }
        }
    }
    None
}

/// What is wrong with a partition, if anything.
pub(crate) fn partition_violation(
    case: &Case,
    threshold: Threshold,
    found: &[Stretch],
) -> Option<String> {
    let (Some(begin), Some(end)) = (found.first(), found.last()) else {
        return Some("empty".into());
    };
    if begin.first.abs() > 0.0 || end.last.to_bits() != 1_f64.to_bits() {
        return Some("does not cover the interval".into());
    }
    for pair in found.windows(2) {
        if pair[0].last.to_bits() != pair[1].first.to_bits() || pair[0].side == pair[1].side {
            return Some("gap or repetition".into());
        }
    }
    let square = |x: f64| Dyadic::from(x).squared().to_rational();
    for stretch in found {
        let start = Dyadic::from(stretch.first);
        let width = &Dyadic::from(stretch.last) - &start;
        if width.signum() <= 0 {
            return Some(format!("{stretch:?} is empty"));
        }
        let excess = |level: f64| case.truth.minus(&square(level)).over(&start, &width);
        let holds = match stretch.side {
            Verdict::Inside => {
                threshold.low > 0.0 && least_sign(&excess(threshold.low).negated()) > 0
            }
            Verdict::Outside => threshold.high < 0.0 || least_sign(&excess(threshold.high)) > 0,
            Verdict::Undecided => true,
        };
        if !holds {
            return Some(format!("{stretch:?} is wrong"));
        }
    }
    None
}

/// How far from the threshold the distance is where an undecided stretch ends, in units of the
/// inherent error and 32 roundings of the threshold.
pub(crate) fn looseness(case: &Case, threshold: Threshold, found: &[Stretch]) -> f64 {
    let unit = case.inherent_error() + 16.0 * f64::EPSILON * threshold.high.abs();
    let mut worst = 0.0_f64;
    for stretch in found.iter().filter(|s| s.side == Verdict::Undecided) {
        for s in [stretch.first, stretch.last] {
            let distance = case.truth.at(&s.into()).to_f64_fast().sqrt();
            let gap = (threshold.low - distance).max(distance - threshold.high);
            worst = worst.max(gap / unit);
        }
    }
    worst
}
