//! The certified partition: certainly inside a threshold, certainly outside, undecided.

use super::crossing_estimate::{crossing_estimate, nearest_certain};
use super::minorant::Minorant;
use super::part::{part, point, reversed, squared_distance};
use super::scaled::{SECOND_ORDER, ScaledCubic, TINY};
use super::stretches::Stretches;
use super::thresholds::{SignPattern, SquaredThresholds};
use super::{Threshold, UncertainCubic, Verdict};
use crate::blossom::ControlPolygon;
use crate::guess::least_point;
use crate::real::Real;
use crate::rounding::UNIT_ROUNDOFF;

/// Largest number of parts examined; the rest is left undecided.
const MAX_WORK: u32 = 256;

/// Parts shorter than this are a few roundings long.
const SHORTEST: f64 = 16.0 * f64::EPSILON;

/// A search for the partition: the computed cubic, and the threshold in its unit.
struct PartitionSearch {
    cubic: ScaledCubic,
    low: f64,
    high: f64,
    /// Thresholds for the polygon's own cubic, without the rounding of restriction or evaluation.
    own: SquaredThresholds,
    /// Thresholds for points and polygons computed from it.
    computed: SquaredThresholds,
    /// Thresholds a few errors farther apart: between them a division gains nothing.
    blurred: SquaredThresholds,
    found: Stretches,
    work: u32,
}

/// The sign pattern of a part's Bernstein coefficients against both thresholds.
enum PartPattern {
    Uniform(Verdict),
    /// Crosses each of these thresholds once, outwards.
    Rising(Crossed),
    /// Crosses each of these thresholds once, inwards.
    Falling(Crossed),
    Mixed(Mixed),
}

/// The thresholds that a part crosses; it stays on one side of the other.
#[derive(Clone, Copy)]
struct Crossed {
    inside: bool,
    outside: bool,
}

/// Known facts about a part that must be divided.
struct Mixed {
    /// True where the end is certainly outside.
    starts_outside: bool,
    ends_outside: bool,
    /// Bounds of the squared distance.
    least: f64,
    greatest: f64,
}

impl UncertainCubic {
    /// Returns a partition of 0..=1 by the side of the threshold: certainly inside, certainly
    /// outside, undecided.
    #[must_use]
    pub fn stretches(&self, threshold: Threshold) -> Stretches {
        if threshold.low.is_nan() || threshold.high.is_nan() || threshold.low > threshold.high {
            return Stretches::all(Verdict::Undecided);
        }
        // No distance is negative, however large the error.
        if threshold.high < 0.0 {
            return Stretches::all(Verdict::Outside);
        }
        let cubic = ScaledCubic::new(self);
        let low = cubic.scaled_below(threshold.low);
        let high = cubic.scaled_above(threshold.high);
        // What is compared with `own` has passed `computed` before: the four roundings more cover
        // those of forming the thresholds themselves.
        let error = cubic.part_error() + 4.0 * UNIT_ROUNDOFF * low.abs().max_or_other(high.abs());
        let mut search = PartitionSearch {
            cubic,
            low,
            high,
            own: SquaredThresholds::new(low, high, cubic.error),
            computed: SquaredThresholds::new(low, high, error),
            blurred: SquaredThresholds::new(low, high, 4.0 * error),
            found: Stretches::NONE,
            work: 0,
        };
        if let PartPattern::Uniform(side) = search.pattern(&cubic.points, 0.0) {
            return Stretches::all(side);
        }
        let s = least_point(&cubic.points);
        search.examine(0.0, s, 0);
        search.examine(s, 1.0, 0);
        search.found
    }
}

/// Returns a bound of the error of the Bernstein coefficients of a squared distance: section 2 of the module documentation.
/// `square` is the largest computed square of a control point, `rounding` a bound of each point's error.
#[inline(always)]
fn coefficient_error(square: f64, rounding: f64) -> f64 {
    let size = (square + TINY).sqrt() * (1.0 + 4.0 * UNIT_ROUNDOFF);
    (8.0 * UNIT_ROUNDOFF * square + rounding * (2.0 * size + rounding)) * SECOND_ORDER + TINY
}

impl PartitionSearch {
    /// Returns the pattern of the squared distance over a part whose control points have an error
    /// of at most `rounding`.
    #[inline]
    fn pattern(&self, points: &ControlPolygon, rounding: f64) -> PartPattern {
        let coefficients = squared_distance(points);
        let (s0, s3) = (coefficients[0], coefficients[6]);
        let inner = points[1]
            .length_squared()
            .max_or_other(points[2].length_squared());
        let square = s0.max_or_other(s3).max_or_other(inner);
        let error = coefficient_error(square, rounding);
        let (mut least, mut greatest) = (f64::INFINITY, f64::NEG_INFINITY);
        for c in coefficients {
            least = least.min_or_other(c);
            greatest = greatest.max_or_other(c);
        }
        let (least, greatest) = (least - error, greatest + error);
        if least > self.own.outside {
            return PartPattern::Uniform(Verdict::Outside);
        }
        if greatest < self.own.inside {
            return PartPattern::Uniform(Verdict::Inside);
        }
        let inside = SignPattern::of(&coefficients, error, self.own.inside);
        let outside = SignPattern::of(&coefficients, error, self.own.outside);
        match (inside, outside) {
            (SignPattern::Above, SignPattern::Below) => PartPattern::Uniform(Verdict::Undecided),
            (SignPattern::Rising | SignPattern::Above, SignPattern::Rising)
            | (SignPattern::Rising, SignPattern::Below) => PartPattern::Rising(Crossed {
                inside: inside == SignPattern::Rising,
                outside: outside == SignPattern::Rising,
            }),
            (SignPattern::Falling | SignPattern::Above, SignPattern::Falling)
            | (SignPattern::Falling, SignPattern::Below) => PartPattern::Falling(Crossed {
                inside: inside == SignPattern::Falling,
                outside: outside == SignPattern::Falling,
            }),
            _ => PartPattern::Mixed(Mixed {
                starts_outside: s0 - error > self.own.outside,
                ends_outside: s3 - error > self.own.outside,
                least,
                greatest,
            }),
        }
    }

    /// Returns true if the part stays so near the threshold that dividing it gains nothing.
    fn is_undecidable(&self, mixed: &Mixed) -> bool {
        let leaves = mixed.least < self.blurred.inside || mixed.greatest > self.blurred.outside;
        !leaves
    }

    /// Returns the last parameter that is certainly inside and the first that is certainly outside.
    /// For a threshold that is not crossed: that end of the part.
    ///
    /// `points` is counted from the inner end at `origin`; the outer end is at `target`.
    fn crossing(
        &self,
        points: &ControlPolygon,
        (origin, target): (f64, f64),
        crossed: Crossed,
    ) -> (f64, f64) {
        let at = |x: f64| origin + x * (target - origin);
        let resolution =
            4.0 * UNIT_ROUNDOFF * origin.max_or_other(target) / (target - origin).abs();
        let square_at = |s: f64| point(&self.cubic.points, s).length_squared();
        let error = self.cubic.part_error();

        let (mut last_inside, mut first_outside) = (origin, target);
        let mut guess = None;
        if crossed.inside {
            let (x, rate) = crossing_estimate(points, self.low - error, None);
            let step = resolution + 12.0 * UNIT_ROUNDOFF * self.low / rate;
            let is_certain =
                |s: f64| square_at(s) * (1.0 + 4.0 * UNIT_ROUNDOFF) < self.computed.inside;
            last_inside =
                nearest_certain(step, x, |step| at(x - step), is_certain).unwrap_or(origin);
            guess = Some(x + (self.high - self.low + 2.0 * error) / rate);
        }
        if crossed.outside {
            let (x, rate) = crossing_estimate(points, self.high + error, guess);
            let step = resolution + 12.0 * UNIT_ROUNDOFF * self.high / rate;
            let is_certain =
                |s: f64| square_at(s) * (1.0 - 4.0 * UNIT_ROUNDOFF) > self.computed.outside;
            first_outside =
                nearest_certain(step, 1.0 - x, |step| at(x + step), is_certain).unwrap_or(target);
        }
        (last_inside, first_outside)
    }

    /// Appends the stretches of `start..end`, from left to right.
    fn examine(&mut self, start: f64, end: f64, depth: u32) {
        self.work += 1;
        if self.work > MAX_WORK {
            self.found.give_up();
            self.found.append(end, Verdict::Undecided);
            return;
        }
        let points = part(&self.cubic.points, start, end);
        match self.pattern(&points, 9.0 * UNIT_ROUNDOFF * self.cubic.size) {
            PartPattern::Uniform(side) => self.found.append(end, side),
            PartPattern::Rising(crossed) => {
                let (inside, outside) = self.crossing(&points, (start, end), crossed);
                self.found.append(inside, Verdict::Inside);
                self.found.append(outside, Verdict::Undecided);
                self.found.append(end, Verdict::Outside);
            }
            PartPattern::Falling(crossed) => {
                let points = reversed(points);
                let (inside, outside) = self.crossing(&points, (end, start), crossed);
                self.found.append(outside, Verdict::Outside);
                self.found.append(inside, Verdict::Undecided);
                self.found.append(end, Verdict::Inside);
            }
            PartPattern::Mixed(mixed) => {
                if end - start < SHORTEST || self.is_undecidable(&mixed) {
                    self.found.append(end, Verdict::Undecided);
                } else {
                    self.divide(start, end, &points, &mixed, depth);
                }
            }
        }
    }

    /// Cuts off the part that the minorant shows to be outside, or divides.
    fn divide(&mut self, start: f64, end: f64, points: &ControlPolygon, mixed: &Mixed, depth: u32) {
        let is_falling = points[3].length_squared() < points[0].length_squared();
        let inner = if is_falling {
            reversed(*points)
        } else {
            *points
        };
        match (mixed.starts_outside, mixed.ends_outside) {
            (true, true) => {
                if Minorant::of(&inner).lower() > self.computed.outside {
                    self.found.append(end, Verdict::Outside);
                    return;
                }
            }
            (false, false) => {}
            _ => {
                if self.trim((start, end), (&inner, is_falling), mixed.least, depth) {
                    return;
                }
            }
        }
        let s = start + dividing_fraction(points, depth) * (end - start);
        self.examine(start, s, depth + 1);
        self.examine(s, end, depth + 1);
    }

    /// Appends a part of which only one end is certainly outside, if the minorant shows what to cut off at that end; returns
    /// false where halving is as good. The polygon is counted from the other end.
    fn trim(
        &mut self,
        (start, end): (f64, f64),
        (points, is_falling): (&ControlPolygon, bool),
        least: f64,
        depth: u32,
    ) -> bool {
        /// Fractions of the part beyond which halving is as good.
        const WORTHWHILE: f64 = 0.375;
        const SETTLED: f64 = 0.875;
        let reach = Minorant::of(points).parameter_bound(self.computed.outside);
        let is_touch = || {
            // All of the part is next to the outer threshold or beyond, and so is what is cut off.
            let touching = (self.high - 4.0 * self.cubic.part_error()).max_or_other(0.0);
            reach < SETTLED
                && least >= touching * touching
                && point(points, reach).length_squared() <= self.blurred.outside
        };
        let is_examined = reach < WORTHWHILE;
        if !is_examined && !is_touch() {
            return false;
        }
        // Twice as far, where outside is certain by a margin: then the next step settles it.
        let fraction = if is_examined { 2.0 * reach } else { reach };
        let (way, rounding) = (fraction * (end - start), 4.0 * UNIT_ROUNDOFF * end);
        let (from, to) = if is_falling {
            ((end - way - rounding).max_or_other(start), end)
        } else {
            (start, (start + way + rounding).min_or_other(end))
        };
        if is_falling {
            self.found.append(from, Verdict::Outside);
        }
        if is_examined {
            self.examine(from, to, depth + 1);
        } else {
            self.found.append(to, Verdict::Undecided);
        }
        if !is_falling {
            self.found.append(end, Verdict::Outside);
        }
        true
    }
}

/// Returns, in turns, the middle, and the place of the apparent minimum if not next to an end.
fn dividing_fraction(points: &ControlPolygon, depth: u32) -> f64 {
    const NEAR_END: f64 = 1.0 / 64.0;
    if depth % 2 == 1 {
        let x = least_point(points);
        if NEAR_END < x && x < 1.0 - NEAR_END {
            return x;
        }
    }
    0.5
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rounding::exact::{number, vector};
    use dashu::rational::RBig;
    use rand::SeedableRng;
    use rand::rngs::ChaCha8Rng;

    /// Returns the exact Bernstein coefficients of the squared distance.
    fn exact_coefficients(points: &ControlPolygon) -> [RBig; 7] {
        let exact = points.map(|point| point.to_array().map(number));
        let dot = |i: usize, j: usize| {
            let products = exact[i].iter().zip(&exact[j]).map(|(x, y)| x * y);
            products.fold(RBig::ZERO, |sum, product| sum + product)
        };
        let [two, three, five, nine, ten] = [2.0, 3.0, 5.0, 9.0, 10.0].map(number);
        [
            dot(0, 0),
            dot(0, 1),
            (&two * dot(0, 2) + &three * dot(1, 1)) / &five,
            (dot(0, 3) + &nine * dot(1, 2)) / &ten,
            (&two * dot(1, 3) + &three * dot(2, 2)) / &five,
            dot(2, 3),
            dot(3, 3),
        ]
    }

    /// Points are moved by all of their error, outwards, where that changes coefficients most. The bound is not far above
    /// the largest error.
    #[test]
    fn coefficients_are_within_their_error() {
        let mut rng = ChaCha8Rng::seed_from_u64(7);
        let mut largest = [0.0_f64; 3];
        for round in 0..3_000 {
            let given: ControlPolygon = [(); 4].map(|()| vector(&mut rng, 1.0));
            let rounding = [0.0, 1e-15, 1e-3][round % 3];
            let moved = given.map(|point| point + rounding * point.normalize());
            let distances = (0..4).map(|place| (moved[place] - given[place]).length());
            let rounding = distances.fold(rounding, f64::max) * (1.0 + 1e-12);
            let squares = moved.map(|point| point.length_squared());
            let error = coefficient_error(squares.into_iter().fold(0.0, f64::max), rounding);
            for (computed, exact) in squared_distance(&moved)
                .into_iter()
                .zip(exact_coefficients(&given))
            {
                let difference = (number(computed) - exact).to_f64().value().abs();
                assert!(difference <= error, "{given:?} {rounding:e}");
                largest[round % 3] = largest[round % 3].max(difference / error);
            }
        }
        assert!(largest.iter().all(|&share| share > 0.2), "{largest:?}");
    }
}
