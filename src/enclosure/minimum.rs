//! The certified minimum: split at the guess, bound both sides, branch if needed.

use super::minorant::Minorant;
use super::part::{part, point, split};
use super::reach::{NARROW, farthest_reached, may_attain, minorant_between, outward};
use super::scaled::{SECOND_ORDER, ScaledCubic, TINY};
use super::stationary::stationary_reach;
use super::{DistanceEnclosure, Effort, LeastDistance, ParameterEnclosure, UncertainCubic};
use crate::guess::least_point;
use crate::real::Real;
use crate::rounding::UNIT_ROUNDOFF;

/// Largest number of parts held at once; then the search answers with the bounds it has. Random
/// input needs 2, the worst adversarial input found fewer than 100.
const MAX_PARTS: usize = 256;

impl UncertainCubic {
    /// Returns the least distance from the origin, of an exact motion that is a cubic.
    #[must_use]
    pub fn least_distance(&self) -> LeastDistance {
        let cubic = ScaledCubic::new(self);
        let (search, least) = searched(&cubic);
        let narrowed = search.narrowed(least.parameter);
        let parameter = if narrowed.last - narrowed.first > NARROW {
            search.narrowed(search.trimmed(narrowed))
        } else {
            narrowed
        };
        LeastDistance { parameter, ..least }
    }

    /// Returns the least distance from the origin, of any motion within the error.
    #[must_use]
    pub fn least_distance_of_any_motion(&self) -> LeastDistance {
        let cubic = ScaledCubic::new(self);
        let (search, least) = searched(&cubic);
        LeastDistance {
            parameter: search.trimmed(least.parameter),
            ..least
        }
    }

    /// Returns the least distance, and a parameter at which it is attained; faster if that is
    /// `guess`.
    pub(crate) fn nearest(&self, guess: Option<f64>) -> (DistanceEnclosure, f64) {
        let cubic = ScaledCubic::new(self);
        let guess = guess.unwrap_or_else(|| least_point(&cubic.points));
        let (mut search, minorants) = BranchAndBound::new(&cubic, guess);
        if !search.is_tight() {
            search.branch(search.sides(&minorants));
        }
        (search.distance(), search.best)
    }

    /// Returns a parameter at which the least distance is attained, up to rounding: probably `guess`.
    /// `lowers` bounds the squared distance on the halves of both sides of that, in their order; valid
    /// within 1e-50..1e50.
    pub(crate) fn least_parameter(&self, guess: f64, lowers: [f64; 4]) -> f64 {
        let cubic = ScaledCubic::new(self);
        let mut search = BranchAndBound {
            cubic: &cubic,
            error: cubic.part_error(),
            best: guess,
            square: point(&cubic.points, guess).length_squared(),
            lower: f64::NEG_INFINITY,
        };
        let ends = [0.0, 0.5 * guess, guess, 0.5 * (guess + 1.0), 1.0];
        let lowers = lowers.map(|square| cubic.scaled_square(square));
        search.branch(parts_between(&ends, &lowers));
        search.best
    }
}

/// Returns a search for the least distance at its end, and the result with the parameters that its
/// quadratics leave.
#[inline]
fn searched(cubic: &ScaledCubic) -> (BranchAndBound<'_>, LeastDistance) {
    let (mut search, minorants) = BranchAndBound::new(cubic, least_point(&cubic.points));
    let (hull, effort) = if search.is_tight() {
        (search.hull(&minorants), Effort::Tight)
    } else {
        let (parts, effort) = search.branch(search.sides(&minorants));
        (search.hull_of(&parts), effort)
    };
    let least = LeastDistance {
        distance: search.distance(),
        parameter: hull.unwrap_or(ParameterEnclosure::WHOLE),
        guess: search.best,
        effort,
    };
    (search, least)
}

/// Returns the enclosure from a lower bound of the computed squared distance, and an attained one;
/// both are of a cubic with an error of at most `error`.
#[inline(always)]
pub(crate) fn enclosure(lower: f64, reached: f64, error: f64) -> DistanceEnclosure {
    // One unit of the root is that of the root and of the difference, half of one each. The number before one
    // above zero has the bits before its own; there is none before zero, and that NaN is dropped by the
    // choice of the larger one.
    let root = lower.max_or_other(0.0).sqrt();
    let low = f64::from_bits(root.to_bits().wrapping_sub(1)) - error;
    DistanceEnclosure {
        low: low.max_or_other(0.0),
        high: (root_above(reached) + error).next_up(),
    }
}

/// Returns the squared distance that lower bounds must reach for the enclosure to be as tight as
/// the error of a cubic of that size.
#[inline(always)]
pub(crate) fn target(size: f64, error: f64, best: f64) -> f64 {
    let nearest = best.sqrt();
    let root = nearest - (0.25 * error).max_or_other(8.0 * UNIT_ROUNDOFF * size);
    // Next to zero the spacing of the parameters alone moves the distance by 6u M.
    if (root > 0.0) & (nearest > 16.0 * UNIT_ROUNDOFF * size) {
        root * root
    } else {
        f64::NEG_INFINITY
    }
}

/// Returns the largest computed squared distance of a minimiser of the exact distance. The exact
/// one is at most the best point's plus its error, the computed one at most one error more.
#[inline]
fn largest_square(error: f64, best: f64) -> f64 {
    let root = root_above(best) + 2.0 * error;
    root * root * (1.0 + 8.0 * UNIT_ROUNDOFF)
}

/// Returns an upper bound of the norm of which this is the computed square.
#[inline(always)]
fn root_above(square: f64) -> f64 {
    // What underflow can hide in a square of three products is below TINY².
    square.sqrt() * (1.0 + 4.0 * UNIT_ROUNDOFF) + TINY
}

/// A search for the least distance, in the unit of the scaled cubic.
struct BranchAndBound<'c> {
    cubic: &'c ScaledCubic,
    /// Bound on the error of parts.
    error: f64,
    /// Parameter of the best point found so far, and the squared distance there.
    best: f64,
    square: f64,
    /// Lower bound of the squared distance.
    lower: f64,
}

impl<'c> BranchAndBound<'c> {
    /// Returns a search from a guess on, and the minorants before and after that.
    #[inline]
    fn new(cubic: &'c ScaledCubic, guess: f64) -> (Self, [Minorant; 2]) {
        let [before, after] = split(&cubic.points, guess);
        let minorants = [Minorant::of(&before), Minorant::of(&after)];
        let [before, after] = &minorants;
        let search = Self {
            cubic,
            error: cubic.part_error(),
            best: guess,
            square: before.base,
            lower: before.lower().min_or_other(after.lower()),
        };
        (search, minorants)
    }

    #[inline]
    fn is_tight(&self) -> bool {
        self.lower >= target(self.cubic.size, self.error, self.square)
    }

    fn distance(&self) -> DistanceEnclosure {
        self.cubic
            .restore(enclosure(self.lower, self.square, self.error))
    }

    /// Returns an interval of all parameters at which the minimum can be, from both sides of the
    /// guess; `None` only if rounding contradicts itself.
    fn hull(&self, [before, after]: &[Minorant; 2]) -> Option<ParameterEnclosure> {
        let bound = largest_square(self.error, self.square);
        let sides = [(before, 0.0), (after, 1.0)];
        let reached = sides.map(|(minorant, tip)| may_attain(minorant, bound, self.best, tip));
        let reached = reached.into_iter().flatten();
        reached.reduce(ParameterEnclosure::hull)
    }

    /// Returns the hull without what a few divisions show to be above the minimum, on either side
    /// of the best point. The search itself divides no more than the distance needs.
    fn trimmed(&self, hull: ParameterEnclosure) -> ParameterEnclosure {
        let bound = largest_square(self.error, self.square);
        let [first, last] = [hull.first, hull.last]
            .map(|tip| farthest_reached(&self.cubic.points, bound, self.best, tip));
        ParameterEnclosure {
            first: first.max_or_other(hull.first),
            last: last.min_or_other(hull.last),
        }
    }

    /// Returns the hull, narrowed by the slope at the best point if the distance is convex there.
    fn narrowed(&self, hull: ParameterEnclosure) -> ParameterEnclosure {
        const WIDEST: f64 = 0.125;
        let s = self.best;
        let [before, after] = split(&self.cubic.points, s);
        let (longer, length) = if s > 0.5 {
            (before, s)
        } else {
            (after, 1.0 - s)
        };
        let range = (s - hull.first).max_or_other(hull.last - s) / length * SECOND_ORDER;
        if range > WIDEST {
            return hull;
        }
        let reach = stationary_reach(&longer, self.error, range) * length * SECOND_ORDER;
        ParameterEnclosure {
            first: outward(s - reach, -1.0).max_or_other(hull.first),
            last: outward(s + reach, 1.0).min_or_other(hull.last),
        }
    }

    /// Returns the parts before and after the guess.
    fn sides(&self, minorants: &[Minorant; 2]) -> Vec<BoundedPart> {
        let lowers = minorants.each_ref().map(Minorant::lower);
        parts_between(&[0.0, self.best, 1.0], &lowers)
    }

    /// Divides the part with the smallest lower bound (best first) until all bounds reach the
    /// target or the work limit. The bounds are valid at any time.
    #[cold]
    #[inline(never)]
    fn branch(&mut self, mut parts: Vec<BoundedPart>) -> (Vec<BoundedPart>, Effort) {
        let points = &self.cubic.points;
        loop {
            let least = least_index(&parts);
            let divided = parts[least];
            let BoundedPart { start, end, .. } = divided;
            self.lower = divided.lower;
            if self.is_tight() {
                return (parts, Effort::Tight);
            }
            let s = dividing_point(self.cubic, &divided, self.best);
            if parts.len() == MAX_PARTS || s <= start || s >= end {
                return (parts, Effort::Limited);
            }
            // Both before either is looked at: their chains of operations overlap.
            let (before, first, _) = minorant_between(points, start, s);
            let (after, second, _) = minorant_between(points, s, end);
            let (lower_before, lower_after) = (before.lower(), after.lower());
            for (base, square) in [(first, before.base), (second, after.base)] {
                if square < self.square {
                    (self.best, self.square) = (base, square);
                }
            }
            let is_split_at_minimum = !divided.is_split_at_minimum;
            let part = |start, end, lower| BoundedPart {
                start,
                end,
                lower,
                is_split_at_minimum,
            };
            parts[least] = part(start, s, lower_before);
            parts.push(part(s, end, lower_after));
        }
    }

    /// Returns an interval of all parameters at which the minimum can be, from the remaining parts.
    fn hull_of(&self, parts: &[BoundedPart]) -> Option<ParameterEnclosure> {
        let bound = largest_square(self.error, self.square);
        let possible = parts.iter().filter(|part| part.lower <= bound);
        let reached = possible.filter_map(|part| {
            let (minorant, base, tip) = minorant_between(&self.cubic.points, part.start, part.end);
            may_attain(&minorant, bound, base, tip)
        });
        reached.reduce(ParameterEnclosure::hull)
    }
}

/// A part of 0..=1 with a lower bound of the squared distance on it.
#[derive(Clone, Copy, Debug)]
struct BoundedPart {
    start: f64,
    end: f64,
    lower: f64,
    /// True if it comes from a split at an apparent minimum.
    is_split_at_minimum: bool,
}

/// Returns parts with a lower bound each, with room for more; their ends follow one another.
fn parts_between(ends: &[f64], lowers: &[f64]) -> Vec<BoundedPart> {
    let mut parts = Vec::with_capacity(16);
    parts.extend(
        ends.windows(2)
            .zip(lowers)
            .map(|(ends, &lower)| BoundedPart {
                start: ends[0],
                end: ends[1],
                lower,
                is_split_at_minimum: false,
            }),
    );
    parts
}

fn least_index(parts: &[BoundedPart]) -> usize {
    let mut least = 0;
    for (i, part) in parts.iter().enumerate() {
        if part.lower < parts[least].lower {
            least = i;
        }
    }
    least
}

/// Returns the place to divide a part, in turns: at the apparent minimum, which separates minima,
/// and in the middle or next to the best point. The latter serves flat minima, where bounds grow
/// with the fourth or sixth power of the distance. There the best point moves a little with each cut, so
/// that it may lie next to the end instead of at it.
fn dividing_point(cubic: &ScaledCubic, divided: &BoundedPart, best: f64) -> f64 {
    const NEAR_BEST: f64 = 1.0 / 32.0;
    let BoundedPart { start, end, .. } = *divided;
    let width = end - start;
    if !divided.is_split_at_minimum {
        let s = start + least_point(&part(&cubic.points, start, end)) * width;
        // Not at an end.
        if start < s && s < end {
            return s;
        }
    }
    let step = NEAR_BEST * width;
    if (best - start).abs() <= step {
        start + step
    } else if (best - end).abs() <= step {
        end - step
    } else {
        0.5 * (start + end)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rounding::exact::number;
    use rand::rngs::ChaCha8Rng;
    use rand::{RngExt, SeedableRng};

    /// The root is larger or the error is, also next to powers of two.
    #[test]
    fn distances_are_rounded_outward() {
        let mut random = ChaCha8Rng::seed_from_u64(1);
        for round in 0..20_000 {
            let square = [random.random_range(0.5..2.0), 1.0, 4.0][round % 3];
            let square = [square, f64::next_down(square), square][round / 3 % 3];
            let error = 10f64.powf(random.random_range(-17.0..1.0));
            let found = enclosure(square, square, error);
            let low = number(found.low) + number(error);
            assert!(
                found.low <= 0.0 || &low * &low <= number(square),
                "{square} {error}"
            );
            // The computed square may be too small by three roundings.
            let high = number(found.high) - number(error);
            let square_above = number(square) * (number(1.0) + number(3.0 * UNIT_ROUNDOFF));
            assert!(&high * &high >= square_above, "{square} {error}");
        }
    }

    /// Includes squares that underflow.
    #[test]
    fn roots_are_rounded_up() {
        let mut random = ChaCha8Rng::seed_from_u64(2);
        for _ in 0..5_000 {
            let x = 10f64.powf(random.random_range(-170.0..2.0));
            assert!(root_above(x * x) >= x, "{x}");
        }
    }
}
