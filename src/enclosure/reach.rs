//! Parameters at which a cubic can come as near as a bound, from quadratics below its parts.

use super::ParameterEnclosure;
use super::minorant::Minorant;
use super::part::{from_nearer, part, point};
use crate::blossom::ControlPolygon;
use crate::guess::least_point;
use crate::real::Real;
use crate::rounding::UNIT_ROUNDOFF;
use arrayvec::ArrayVec;

/// Length below which an enclosure of parameters needs no divisions.
pub(super) const NARROW: f64 = 1.0 / (1 << 20) as f64;

/// Returns the minorant of the part between `a` and `b` around the end with the smaller distance,
/// then that end and the other one.
#[inline(always)]
pub(super) fn minorant_between(points: &ControlPolygon, a: f64, b: f64) -> (Minorant, f64, f64) {
    let (part, is_reversed) = from_nearer(&part(points, a, b));
    // Without a branch, which nobody could predict.
    let (base, tip) = if is_reversed { (b, a) } else { (a, b) };
    (Minorant::of(&part), base, tip)
}

/// Returns the parameters between `base` and `tip` at which the squared distance can be at most
/// `bound`, with the minorant of that part around `base`.
#[inline]
pub(super) fn may_attain(
    minorant: &Minorant,
    bound: f64,
    base: f64,
    tip: f64,
) -> Option<ParameterEnclosure> {
    if minorant.lower() > bound {
        return None;
    }
    let farthest = parameter_reach(minorant, bound, base, tip);
    Some(ParameterEnclosure {
        first: base.min_or_other(farthest),
        last: base.max_or_other(farthest),
    })
}

/// Returns the parameter, between `base` and `tip`, beyond which the squared distance is certainly
/// above `bound`.
#[inline]
fn parameter_reach(minorant: &Minorant, bound: f64, base: f64, tip: f64) -> f64 {
    let reach = minorant.parameter_bound(bound) * (tip - base);
    if reach < 0.0 {
        outward(base + reach, -1.0).max_or_other(tip)
    } else {
        outward(base + reach, 1.0).min_or_other(tip)
    }
}

/// Returns a parameter between `best` and `tip` beyond which the squared distance is certainly
/// above `bound`. At `best` it is not.
///
/// The outermost part is dropped if it is above the bound, and else divided. This goes on until
/// some point within the bound is at least half as far from `best`, or until a limit of work. Parts
/// farther inside are not looked at: only the farthest parameter counts.
pub(super) fn farthest_reached(points: &ControlPolygon, bound: f64, best: f64, tip: f64) -> f64 {
    const STEPS: usize = 32;
    let is_narrow = |outer: f64| (outer - best).abs() <= NARROW;
    if is_narrow(tip) || point(points, tip).length_squared() <= bound {
        return tip;
    }
    let mut outer = tip;
    // Inner ends of the parts left, the outermost last.
    let mut ends = ArrayVec::<f64, { STEPS + 2 }>::new();
    ends.extend([best, 0.5 * (best + tip)]);
    for _ in 0..STEPS {
        let Some(&inner) = ends.last() else { break };
        let (polygon, is_from_outer) = from_nearer(&part(points, inner, outer));
        let minorant = Minorant::of(&polygon);
        if minorant.lower() > bound {
            outer = inner;
            ends.pop();
            continue;
        }
        let is_attained = minorant.base <= bound;
        let is_known = if is_from_outer {
            is_attained
        } else {
            outer = parameter_reach(&minorant, bound, inner, outer);
            is_attained && (outer - inner).abs() <= (inner - best).abs()
        };
        if is_known || is_narrow(outer) {
            break;
        }
        ends.push(dividing_point(points, ends.len(), inner, outer));
    }
    outer
}

/// Returns the place to divide the outermost of `parts` parts: by depth in turns the middle, and the
/// apparent minimum, which may be another one within the bound.
fn dividing_point(points: &ControlPolygon, parts: usize, inner: f64, outer: f64) -> f64 {
    if parts.is_multiple_of(2) {
        let s = inner + least_point(&part(points, inner, outer)) * (outer - inner);
        // Not at an end.
        if inner.min_or_other(outer) < s && s < inner.max_or_other(outer) {
            return s;
        }
    }
    0.5 * (inner + outer)
}

/// Returns `s` moved up (`direction` 1) or down (-1) by more than a sum's rounding.
#[inline]
pub(super) fn outward(s: f64, direction: f64) -> f64 {
    s + direction * (4.0 * UNIT_ROUNDOFF * s.abs())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rounding::exact::number;
    use rand::rngs::ChaCha8Rng;
    use rand::{RngExt, SeedableRng};

    /// Sums and differences of parameters, also next to zero.
    #[test]
    fn parameters_are_rounded_outward() {
        let mut random = ChaCha8Rng::seed_from_u64(3);
        for round in 0..10_000 {
            let size = [1.0, 1e-3, 1e-300, 5e-324][round % 4];
            let (s, way): (f64, f64) = (random.random(), size * random.random_range(0.5..1.0));
            let exact = number(s) + number(way);
            assert!(number(outward(s + way, 1.0)) >= exact, "{s} {way}");
            let exact = number(s) - number(way);
            assert!(number(outward(s - way, -1.0)) <= exact, "{s} {way}");
        }
    }
}
