//! The unit roundoff, and norms that neither overflow nor underflow.
//!
//! # Error terms and their tests
//!
//! The named test fails if the term alone is dropped. `Proof` marks a term that the worst case
//! needs but no test shows; the reason is given below.
//!
//! | term | file | held by |
//! |---|---|---|
//! | points of states, lines, polynomials: error, extent, underflow | `trajectory/segment`, `build` | `segment/tests.rs` |
//! | 2^-100 of what cancels in a polynomial | `trajectory/build` | `segment::tests::points_of_polynomials_that_vanish` |
//! | errors of a line where a polynomial ends: position, velocity | `trajectory/build` | `end_cubic::tests` |
//! | points of legs | `trajectory/segment` | `curves::tests::legs_are_straight` |
//! | points of curves: origin, displacements | `trajectory/curves/bezier` | `curves::tests` |
//! | velocities of end motions of curves | `trajectory/curves` | proof 8 |
//! | errors of both cubics where several become one | `trajectory/simplified` | `simplified::tests::the_errors_of_both_count` |
//! | rounding of their difference | `trajectory/simplified` | proof 9 |
//! | parts: own error, whole (the last point of a line), inside, underflow | `trajectory/segment` | `segment::tests::{points_of_lines, points_of_parts}` |
//! | origins, offsets, local parts, last sum | `narrow_phase/relative` | `relative::tests::sums_are_within_the_error` |
//! | errors of both bodies | `narrow_phase/relative` | `relative::tests::errors_of_both_bodies_add_up` |
//! | 1 + 2^-40 on these: terms of second order | `narrow_phase/relative` | `relative::tests::sums_are_within_the_error_to_second_order` |
//! | heights above a plane: origins, displacements, underflow | `narrow_phase/relative` | `relative::tests::heights_are_within_the_error` |
//! | a sphere's path along a normal | `narrow_phase/half_space` | `half_space::tests::lines_are_within_their_error_of_the_heights` |
//! | the lowest of several spheres: places, radii | `narrow_phase/half_space` | `half_space::tests::no_sphere_is_lower_than_the_lowest_one` |
//! | clearances of both comparisons span by span | `narrow_phase/half_space` | `half_space::tests::what_touches_is_not_ruled_out` |
//! | clearance of the first comparison | `scene/heights` | `tests/half_space` `guards` |
//! | windows of half-spaces | `screen/half_spaces`, `monitor/half_spaces` | `tests/half_space` `guards` |
//! | the end of a lookahead, what a spent budget leaves | `monitor/half_spaces` | proof 11 |
//! | model errors above a plane | `narrow_phase/half_space`, `screen/half_spaces` | `tests/half_space` `together` |
//! | errors of turning centres, in radii and in enclosures | `narrow_phase/clusters` | `tests/half_space` `turning`, `tests/turning` |
//! | interpolation of rotations | `orientation/arc`, `quaternion_cubic` | `orientation::tests::cubics_stay_within_their_error` |
//! | rounding of a spin that grows with time | `orientation/arc` | `orientation::tests::what_rounding_hides_is_unknown` |
//! | of rates beyond knots, also of those rounded to nothing | `orientation/arc`, `given` | `terms::{rounding_of_what_goes_on, rotations_that_differ_by_rounding_go_on}` |
//! | rounding of rotations, of their parts, of points, and of what goes on after knots | `orientation` | `orientation::tests::terms` |
//! | cubics of quaternions that vanish | `orientation/quaternion_cubic` | `terms::cubics_that_vanish_are_unknown` |
//! | the sphere around turning ones: error, rounding, underflow | `orientation/turning` | `terms::enlarged_spheres_are_within_reach` |
//! | twice the error in it | `orientation/turning` | proof 12 |
//! | clearances and errors of turning spheres, the part that ends where a window begins | `narrow_phase/clusters` | `clusters::tests` |
//! | instants of a bounding sphere | `narrow_phase/clusters/sections` | proof 13 |
//! | coefficients of pairs of spheres, and of parts of them | `narrow_phase/clusters/candidates` | `clusters::tests`, `candidates::tests` |
//! | tolerance: error, evaluation | `narrow_phase/relative` | `relative::tests::distances_are_within_the_tolerance` |
//! | instants: step, sum | `narrow_phase/relative` | `relative::tests::instants_are_enclosed` |
//! | clearance of rejections: scale, underflow | `narrow_phase/relative` | `relative::tests::rejections_keep_clear_of_the_tolerance` |
//! | differences of coefficients; tolerance of intervals | `narrow_phase/squared_distance`, `profile` | `squared_distance::tests`, `rejection::tests` |
//! | threshold, radii, half-width | `narrow_phase/certified` | `certified::tests` |
//! | sums with model errors | `shape`, `narrow_phase`, `narrow_phase/certified` | `rounding::tests::sums_are_rounded_up`, `certified::tests` |
//! | clearance of what pairs must reach, wherever it is used | `narrow_phase/clusters/search` | `clusters::tests` |
//! | parts of a window | `narrow_phase/clusters` | `clusters::tests::what_instants_are_rounded_by_rules_nothing_out` |
//! | blurs, pieces between proven contacts, what is reached | `narrow_phase/clusters`, `sphere_pair` | proof 7 |
//! | passing lines: differences, products, range | `narrow_phase/approach` | `approach::tests::grazing_passes*` |
//! | shares of a slice; instants | `narrow_phase/approach` | `approach::tests::{passes_that_touch*, intervals_between_instants*}` |
//! | coefficients of a minorant | `enclosure/minorant` | `minorant::tests` |
//! | rounding of a slope | `enclosure/minorant` | `minorant::exactly::the_slope_is_below_the_exact_one` |
//! | rounding of the leading coefficient: of both terms, and of the difference | `enclosure/minorant` | proof 1 |
//! | a minorant's least value: base, depth | `enclosure/minorant` | `minorant::exactly::the_lower_bound_is_below_the_quadratic` |
//! | the end of its reach: base, root | `enclosure/minorant` | `minorant::exactly::the_quadratic_is_above_a_threshold_beyond_its_reach` |
//! | splits and errors of a cubic, scaling, norms, restored lengths | `enclosure/part`, `scaled` | `scaled::tests`, `tests/extended/tests/enclosure` |
//! | roots and ends of a distance, ends of parameters | `enclosure/minimum` | `minimum::tests` |
//! | Markov's 18, 96 and 192, the error across the displacement, what a range takes away | `enclosure/stationary` | `minorant::exactly::nearest_points_are_within_reach_whatever_the_error` |
//! | rounding of a stationary point's slope | `enclosure/stationary` | `minorant::exactly::nearest_points_are_within_reach_of_a_rounded_slope` |
//! | 1 + 2^-40 on a stationary point | `enclosure/minimum`, `stationary` | proof 2 |
//! | twice the error to a minimiser | `enclosure/minimum` | `tests/extended/tests/enclosure` |
//! | squares of thresholds; underflow of the outer one | `enclosure/thresholds` | `thresholds::tests`; `tests/extended/tests/enclosure` |
//! | own error of a cubic, control points of a part | `enclosure/crossings` | `tests/extended/tests/enclosure` |
//! | squares of a part, crossings, trims | `enclosure/crossings` | proof 3 |
//! | screens, splits of enclosures, conversion to f32, guesses | `kernels` | `tests/extended/tests/kernels.rs` |
//! | error of a span; thresholds in f32 | `kernels/spans`, `real` | `spans::what_is_badly_known_is_never_decided`, `real::tests` |
//! | underflow of a screen | `kernels/screen` | `kernels::exactly::screens_are_rounded_outward` |
//! | squares of a screen's thresholds | `kernels/screen` | proof 4 |
//! | roundings outward of an enclosure | `enclosure/minimum` | `minimum::tests::distances_are_rounded_outward` |
//! | underflow of a conversion, ends of the range of blocks | `kernels/within`, `loops` | proof 5 |
//! | points of a compact trajectory beyond the knots, extent | `bounds/points`, `sub_cubic` | `points::tests` |
//! | own error of a segment, whole or in part | `bounds/points` | `points::tests::what_is_badly_known_is_held` |
//! | splits of a compact trajectory | `bounds/sub_cubic` | `sub_cubic::tests` |
//! | hitbox and margin, underflow | `bounds/placement` | `source::tests` |
//! | line of a run of cubics; its displacement in no time; its sum; sums of a fat line, lengths that vanish | `bounds/builder` | `builder::tests` |
//! | places far from the middle, in boxes and fat lines | `bounds/builder` | `source::tests` |
//! | the displacement of a box that moves: both terms | `bounds/builder` | `builder::tests::places_in_moving_boxes_are_within_their_rounding` |
//! | one of them; the middle of a fat line | `bounds/builder` | proof 6 |
//! | places of a hull test | `bounds/apart` | `apart::tests` |
//! | instants of a screening's edges and of a budget's | `monitor/lookahead`, `screen/mod` | `tests/monitor` `budgets` |
//! | instants of a question, of a jump | `monitor/lookahead/ask`, `jump` | `tests/monitor` `instants` |
//! | values of a motion, remainder by a fourth derivative | `trajectory/fit/motion` | `tests/fit` `proven` |
//! | values of a motion that are seen | `trajectory/fit/motion` | `tests/fit` `estimated` |
//! | remainder of a polynomial, rounding of its coefficients | `trajectory/fit/reduction` | `tests/fit` `polynomials` |
//! | rounding of positions that are returned | `trajectory/segment` | proof 10 |
//!
//! 1. Two of five first-order terms: the errors of the coefficients cover them in all tests, since
//!    no test has all of their 24 roundings at their worst. (Of the first coefficient four of five
//!    are needed; hill climbing reached 4.09.) The depth of lanes has five in eight of its own.
//! 2. Second order: only the bounds' own rounding.
//! 3. Eight roundings of a square where seven are counted, four of a square for three, four of an
//!    end for three. Errors of 9 roundings of the size, which no part reaches, are added to each.
//! 4. Coefficients take 14 of the tolerance's 16 roundings, thresholds two: none to spare in the worst
//!    case, and most of the 14 in all others.
//! 5. Size, total, root and sum are rounded by 3, 2, 3 and 2, and raised by 4, 2^-40 of itself, 4 and one unit: the
//!    others hide one dropped alone. Lengths are scaled to the order of one, where rounding far
//!    exceeds underflow. A cubic scaled back has a size above 1e-285 m, and a normal error.
//! 6. Seven roundings of the displacement are needed where each of the terms has six; seven of a
//!    fat line's place, where the first terms have six. A line that goes on beyond its body's ends takes two more of its
//!    change: five of eight.
//! 7. An instant is rounded to the nearest number. So a solved pair's separation and contact are
//!    off by the motion in one rounding. Another pair of spheres that is nearer by less, or touches
//!    within one rounding outside a contact, may be the one to report. The terms are that motion
//!    and the solver's tolerance; a test would need a tie within, but not exactly at, them.
//! 8. A line with an error takes 20 roundings of its length for its velocity. The term makes the
//!    error positive where nothing else does, so that these count.
//! 9. The difference is largest at a Bézier point only where a cubic ends. Elsewhere the point
//!    exceeds it by far more than three roundings of the lengths that are subtracted.
//! 10. At most 80 roundings of the extent by their count. Two or three in tests, where the error of the control points
//!     covers them.
//!
//! 11. A body is compared up to an instant, and again when the lookahead's end has come there. Reported
//!     instants are off by less than one rounding where the motion began within a day. A test would need
//!     a motion of which an instant takes several roundings, and a contact there.
//! 12. Half of it covers all that is known: interpolation of a circle lies inside it, and cubics of
//!     quaternions have errors within the tolerance, half of the error that is allowed. Where a plan is
//!     left within such a cubic, what is left of that has no proven bound but the allowed one.
//! 13. An instant of a span has three roundings. It would have to be that of a contact in the very rounding
//!     where one part ends and the next one begins, and the walk begins one instant early as well.
//!
//! Squares that meet F of the enclosures need no term against underflow. In the cubic's unit the
//! factor 1 + 2^-40 adds more than 1e-43 to F, and what underflows is below 1e-124.

use glam::DVec3;

/// Unit roundoff of f64, 2^-53: the largest relative error of one operation.
pub(crate) const UNIT_ROUNDOFF: f64 = f64::EPSILON / 2.0;

/// Largest absolute error of a chain of linear operations by underflow: 2^-1022.
pub(crate) const UNDERFLOW: f64 = f64::MIN_POSITIVE;

/// Clearance of rejections, relative to the pair's local scale: 2^-44 = 512 roundings. A test
/// rejects only pairs that exceed the threshold by this.
///
/// The exact solver reports distances within its own rounding of the threshold as contact: at most
/// 70 roundings of the local scale, with an error as large again. A test's own error is at
/// most 100. 512 covers their sum, so no test rejects a contact that the solver would report.
pub(crate) const CLEARANCE: f64 = 512.0 * UNIT_ROUNDOFF;

/// Clearance of heights above a plane, relative to the coordinates: far more than all rounding, and the error of the
/// normal's length, which is 1 within 1e-9.
pub(crate) const PLANE_CLEARANCE: f64 = 4e-9;

/// Returns the time with -0 replaced by 0: reports are ordered by the bits of times, and of two
/// zeros either may come out as the later one.
#[inline]
pub(crate) const fn without_negative_zero(time: f64) -> f64 {
    time + 0.0
}

/// Returns the rounded sum of two numbers and its rounding error (Knuth).
#[inline]
pub(crate) fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let shadow = sum - a;
    (sum, (a - (sum - shadow)) + (b - shadow))
}

/// Returns the sum of two numbers, rounded up.
pub(crate) fn sum_above(a: f64, b: f64) -> f64 {
    let (sum, lost) = two_sum(a, b);
    if lost > 0.0 { sum.next_up() } else { sum }
}

/// Returns the power of two that scales `magnitude` into [1, 2).
///
/// Zero, subnormal and the largest magnitudes are scaled as far as one exact factor can.
#[inline]
pub(crate) fn scale_to_one(magnitude: f64) -> f64 {
    const EXPONENT_MASK: u64 = 0x7ff;
    let exponent = (magnitude.to_bits() >> 52) & EXPONENT_MASK;
    match exponent {
        // Zero and subnormal: the largest power of two whose inverse is still normal.
        0 => f64::from_bits(0x7fd_u64 << 52),
        // From 2^1023 on: the smallest normal power brings it as near as one factor can.
        0x7fe | 0x7ff => f64::MIN_POSITIVE,
        normal => f64::from_bits((0x7fe - normal) << 52),
    }
}

/// Returns the Euclidean norm, correct to a few roundings for all magnitudes.
#[inline]
pub(crate) fn norm(vector: DVec3) -> f64 {
    let square = vector.length_squared();
    if is_ordinary(square) {
        square.sqrt()
    } else {
        norm_of_any_size(vector)
    }
}

/// Returns the largest norm of some vectors, with the bits of [`norm`], but only one root in all.
#[inline]
pub(crate) fn largest_norm(vectors: &[DVec3]) -> f64 {
    let mut largest = 0.0_f64;
    for vector in vectors {
        largest = largest.max(vector.length_squared());
    }
    if is_ordinary(largest) {
        largest.sqrt()
    } else {
        vectors.iter().copied().map(norm).fold(0.0, f64::max)
    }
}

/// Returns true if a squared norm is far from the ends of the range of f64.
#[inline]
fn is_ordinary(square: f64) -> bool {
    (1e-280..1e280).contains(&square)
}

#[cold]
fn norm_of_any_size(vector: DVec3) -> f64 {
    let largest = vector.abs().max_element();
    let power = scale_to_one(largest);
    (vector * power).length() / power
}

/// Returns the earliest exact instant (s) that may be reported as `time`, by rounding.
#[inline]
pub(crate) fn earliest_exact(time: f64) -> f64 {
    time - INSTANT * time.abs()
}

/// Returns the latest exact instant (s) that may be reported as `time`.
#[inline]
pub(crate) fn latest_exact(time: f64) -> f64 {
    time + INSTANT * time.abs()
}

/// Returns the last instant (s) of which all is known, if all exact instants before `time` are: others may be reported as
/// `time`.
pub(crate) fn last_known(time: f64) -> f64 {
    earliest_exact(time).next_down()
}

/// Returns the interval of all exact instants (s) that may be reported from one instant to another.
#[inline]
pub(crate) fn exact_interval((from, to): (f64, f64)) -> (f64, f64) {
    (earliest_exact(from), latest_exact(to))
}

/// Relative rounding of a reported instant: half a unit of its last place, and some spare. The
/// error of the solver's local parameter is one of distance, which [`CLEARANCE`] covers.
const INSTANT: f64 = 8.0 * UNIT_ROUNDOFF;

/// Returns a key that sorts numbers as [`f64::total_cmp`] does.
pub(crate) const fn total_order(number: f64) -> i64 {
    let bits = number.to_bits().cast_signed();
    // The order of negative numbers is reversed.
    bits ^ ((bits >> 63) & i64::MAX)
}

#[cfg(test)]
pub(crate) mod exact;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_largest_norm_is_one_of_them() {
        let vectors = [DVec3::new(3.0, 0.1, -4.0), DVec3::splat(-2.7), DVec3::ZERO];
        for scale in [5e-324, 1e-200, 1e-140, 1.0, 1e140, 1e200] {
            let vectors = vectors.map(|vector| vector * scale);
            for some in [&vectors[..], &vectors[1..], &vectors[2..], &[]] {
                let expected = some.iter().copied().map(norm).fold(0.0, f64::max);
                assert!(largest_norm(some).to_bits() == expected.to_bits());
            }
        }
    }

    #[test]
    fn norms_at_both_ends_of_the_range() {
        for scale in [f64::MIN_POSITIVE, 1e-200, 1.0, 1e200, 1e300] {
            let expected = 5.0 * scale;
            let found = norm(DVec3::new(3.0, 0.0, -4.0) * scale);
            assert!((found / expected - 1.0).abs() < 1e-15, "{scale}: {found}");
        }
        assert!(norm(DVec3::ZERO).to_bits() == 0);
        // A subnormal is served too; its own precision is that of its few bits.
        assert!(norm(DVec3::new(0.0, 5e-324, 0.0)) > 0.0);
    }

    #[test]
    fn sums_are_rounded_up() {
        let tiny = 1e-20;
        assert!(sum_above(1.0, tiny) > 1.0 && sum_above(tiny, 1.0) > 1.0);
        for (a, b, sum) in [(1.0, -tiny, 1.0), (0.5, 0.25, 0.75), (0.1, 0.2, 0.1 + 0.2)] {
            assert!(sum_above(a, b).to_bits() == f64::to_bits(sum), "{a} {b}");
        }
    }

    #[test]
    fn normalising_brings_into_one_to_two() {
        for magnitude in [1e-300, 0.3, 1.0, 1.999, 2.0, 1e9, 1e300] {
            let scaled = magnitude * scale_to_one(magnitude);
            assert!((1.0..2.0).contains(&scaled), "{magnitude}: {scaled}");
        }
    }
}
