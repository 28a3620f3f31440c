//! The guess of a relative cubic's closest approach: the lowest of a few samples, refined. Not proven.
//!
//! The stages are functions of their own, so that a block of pairs can pass them one after
//! the other: many short dependency chains at once instead of a long one.

mod cubic;
mod refine;

pub use cubic::ControlPoints;
pub(crate) use cubic::{
    CentredCubic, Vector, coordinates, distance, dot, in_f64, largest_coordinate, largest_of,
    local_time, polygon,
};
pub(crate) use refine::{QUICK, THOROUGH, least_point, normalised, refined};

use crate::real::Real;

/// Units of rounding of the deflated coefficients (the derivation is in the documentation of
/// `kernels`).
const TOLERANCE: f32 = 40.0;

/// Squares of the distance above this are large enough for the test whether a pair is at rest.
const STILL: f32 = 1e-10;

/// A squared distance in powers of the centred time, with the effect of its rounding.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LaneSquaredDistance {
    pub(crate) square: [f32; 7],
    /// Threshold of the least deflated coefficient: minus infinity if nothing moves, infinity if
    /// squares may have left the range.
    pub(crate) tolerance: f32,
}

/// A refined guess without its certificate.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RefinedGuess<R> {
    /// Centred local time, -1..=1.
    pub(crate) time: R,
    /// 64 times the squared distance there.
    pub(crate) square: R,
    /// Factor on the tolerance of the certificate: 1, or infinity if the refinement has not settled.
    pub(crate) tolerance_factor: f32,
}

/// First stage: returns the squared distance of a cubic rounded from the type `R`.
#[inline(always)]
pub(crate) fn squared_distance<R: Real>(rough: &CentredCubic<f32>) -> LaneSquaredDistance {
    let square = rough.squared_distance();
    let [c0, c1, c2, c3] = rough.coefficients;
    let (s0, s1, s2, s3) = (dot(c0, c0), dot(c1, c1), dot(c2, c2), dot(c3, c3));
    let size = (4.0 * s0 + 10.0 * s1) + (20.0 * s2 + 34.0 * s3);
    let tolerance = TOLERANCE * f32::ROUNDING * size + f32::UNDERFLOW;
    let is_served = size < R::MAX_SQUARE;
    let tolerance = if is_served { tolerance } else { f32::INFINITY };
    // A pair at rest but for rounding is as near at any time.
    let rounding = R::ROUNDING.to_f32();
    let still = ((s1 + s2 + s3) * (1.0 / (rounding * rounding)) <= s0) & (s0 > STILL) & is_served;
    LaneSquaredDistance {
        square,
        tolerance: if still { -f32::INFINITY } else { tolerance },
    }
}

/// Second stage: returns the lowest of the samples of a squared distance at `0, ±1/4, …, ±1`.
///
/// Each sample carries its place in the last four bits of its value, so that the minimum needs no
/// selections, which are branches in scalar code. Samples that differ by less than 1e-6 of their
/// value are equally good.
#[inline(always)]
pub(crate) fn lowest_sample(square: &[f32; 7]) -> f32 {
    let [a0, a1, a2, a3, a4, a5, a6] = *square;
    let mut samples = [marked(a0, 0); 5];
    let mut i = 1_u8;
    while i <= 4 {
        // Even and odd powers apart serve u and -u at once: the sign of the odd part says which
        // of the two is lower.
        let u = 0.25 * f32::from(i);
        let v = u * u;
        let even = a0 + v * (a2 + v * (a4 + v * a6));
        let odd = a1 + v * (a3 + v * a5);
        let falling = odd.to_bits() >> 31;
        samples[usize::from(i)] = marked(even - u * odd.abs(), 2 * u32::from(i) + falling);
        i += 1;
    }
    let place = least(samples).to_bits() & PLACE;
    let size = 0.25 * narrow_place(place >> 1);
    // The slope falls towards a time above 0, and rises towards one below.
    f32::from_bits(size.to_bits() | (!place << 31))
}

/// Bits in which a sample carries its place.
const PLACE: u32 = 15;

#[inline(always)]
fn marked(value: f32, place: u32) -> f32 {
    f32::from_bits((value.to_bits() & !PLACE) | place)
}

#[allow(clippy::cast_precision_loss, reason = "a place is below 16")]
#[inline(always)]
fn narrow_place(place: u32) -> f32 {
    place as f32
}

/// Third stage: takes a few steps on the slope, kept between the neighbours of the sample.
#[inline(always)]
pub(crate) fn descend(square: &[f32; 7], start: f32, steps: u32) -> f32 {
    let slope = Slope::new(square);
    let (low, high) = neighbours(start);
    let mut u = start;
    let mut step = 0;
    while step < steps {
        let (_, next) = slope.step(u);
        // Also where the step is not a number.
        u = next.min_or_other(high).max_or_other(low);
        step += 1;
    }
    u
}

/// Descends like [`descend`], but on the falling side only, with a bisection where a step leaves the
/// bracket. It is for starts at which the slope bends away from its root.
#[inline(always)]
pub(crate) fn descend_safely(square: &[f32; 7], start: f32, steps: u32) -> f32 {
    let slope = Slope::new(square);
    let (mut low, mut high) = neighbours(start);
    let mut u = start;
    let mut step = 0;
    while step < steps {
        let (value, next) = slope.step(u);
        let rising = value > 0.0;
        high = if rising { u } else { high };
        low = if rising { low } else { u };
        // A minimum at an end of the span is reached by leaving the span.
        let next = next.min_or_other(1.0).max_or_other(-1.0);
        let between = (next >= low) & (next <= high);
        u = if between { next } else { 0.5 * (low + high) };
        step += 1;
    }
    u
}

/// Returns the neighbours of a sample, in the span.
#[inline(always)]
fn neighbours(sample: f32) -> (f32, f32) {
    (
        (sample - 0.25).max_or_other(-1.0),
        (sample + 0.25).min_or_other(1.0),
    )
}

/// The slope of a squared distance and its derivatives, divided by 1, 1, 2 and 6.
#[derive(Clone, Copy, Debug)]
struct Slope {
    value: [f32; 6],
    first: [f32; 5],
    second: [f32; 4],
    third: [f32; 3],
}

impl Slope {
    #[inline(always)]
    fn new(square: &[f32; 7]) -> Self {
        let [_, a1, a2, a3, a4, a5, a6] = *square;
        Self {
            value: [a1, 2.0 * a2, 3.0 * a3, 4.0 * a4, 5.0 * a5, 6.0 * a6],
            first: [2.0 * a2, 6.0 * a3, 12.0 * a4, 20.0 * a5, 30.0 * a6],
            second: [3.0 * a3, 12.0 * a4, 30.0 * a5, 60.0 * a6],
            third: [4.0 * a4, 20.0 * a5, 60.0 * a6],
        }
    }

    /// Returns the slope, and the target of a downhill step as long as one of Householder's method
    /// of order four. One order more than Halley's costs less than another step.
    #[inline(always)]
    fn step(&self, u: f32) -> (f32, f32) {
        let [a0, a1, a2, a3, a4, a5] = self.value;
        let [b0, b1, b2, b3, b4] = self.first;
        let [c0, c1, c2, c3] = self.second;
        let [d0, d1, d2] = self.third;
        let v = u * u;
        let value = (a0 + u * a1) + v * ((a2 + u * a3) + v * (a4 + u * a5));
        let first = (b0 + u * b1) + v * ((b2 + u * b3) + v * b4);
        let second = (c0 + u * c1) + v * (c2 + u * c3);
        let third = (d0 + u * d1) + v * d2;
        let halley = first * first - value * second;
        let below = first * halley - value * (first * second - value * third);
        let step = value * halley / below;
        (value, u - step.abs().copysign(value))
    }
}

/// Fourth stage: takes one Halley step on the scalar product of position and velocity, in the type
/// of the lanes and without the cancellation of the expanded coefficients.
#[inline(always)]
pub(crate) fn settle<R: Real>(cubic: &CentredCubic<R>, u: R) -> RefinedGuess<R> {
    arrive(cubic, u, &halley_step(&cubic.derivatives(u)))
}

/// Second part of the fourth stage: returns the target of a Halley step, and the factor on the certificate's
/// tolerance.
#[inline(always)]
pub(crate) fn arrive<R: Real>(
    cubic: &CentredCubic<R>,
    u: R,
    found: &HalleyStep<R>,
) -> RefinedGuess<R> {
    let (zero, one) = (R::from_f64(0.0), R::from_f64(1.0));
    let HalleyStep { slope, step, error } = *found;
    // Not above 0 at an end with the slope inward, where there is nothing to settle.
    let inside = (one - u.abs()).max_or_other(slope * u);
    let time = downhill(u, slope, step);
    let square = cubic.square(time);
    // Not above 0 where the step is short and accurate; one that is cut off at an end counts in
    // full. The least of both, or `inside` if the step is not a number.
    let off = (error - R::from_f64(4.0) * R::ROUNDING).max_or_other(step.abs() - R::SETTLED);
    let settled = off.min_or_other(inside) <= zero;
    RefinedGuess {
        time,
        square,
        tolerance_factor: if settled { 1.0 } else { f32::INFINITY },
    }
}

/// Returns a time after one more step in the type of the lanes, without a tolerance factor: for a guess that
/// `f32` cannot bring near enough.
#[inline(always)]
pub(crate) fn polish<R: Real>(cubic: &CentredCubic<R>, u: R) -> R {
    let HalleyStep { slope, step, .. } = halley_step(&cubic.derivatives(u));
    downhill(u, slope, step)
}

/// Returns the target of a step that never leads uphill, so that it stays at an end with the slope
/// inward. No step if it is NaN, as for a pair at rest.
#[inline(always)]
fn downhill<R: Real>(u: R, slope: R, step: R) -> R {
    let (zero, one) = (R::from_f64(0.0), R::from_f64(1.0));
    let length = step.abs().max_or_other(zero);
    (u - length.with_sign_of(slope))
        .min_or_other(one)
        .max_or_other(-one)
}

/// A step of Halley's method towards a stationary point of the distance.
#[derive(Clone, Copy, Debug)]
pub(crate) struct HalleyStep<R> {
    /// Half the slope of the squared distance.
    pub(crate) slope: R,
    /// Centred time to subtract.
    pub(crate) step: R,
    /// An estimate of the error after the step, from the curvature of the slope: of third order
    /// at a simple root, of the order of the step itself at a multiple one.
    pub(crate) error: R,
}

/// Returns the step from position, velocity, half the acceleration and a sixth of the jerk.
#[inline(always)]
pub(crate) fn halley_step<R: Real>(derivatives: &[Vector<R>; 4]) -> HalleyStep<R> {
    let [slope, first, second] = slopes(derivatives);
    let inverse = R::from_f64(1.0) / (first * first - slope * second);
    let step = slope * first * inverse;
    let ratio = slope * second * inverse;
    HalleyStep {
        slope,
        step,
        error: step.abs() * (ratio * ratio),
    }
}

/// Returns the step of Schroeder's method, which is as fast at a multiple root as at a simple one.
#[inline(always)]
pub(crate) fn long_step<R: Real>(derivatives: &[Vector<R>; 4]) -> R {
    let [slope, first, second] = slopes(derivatives);
    slope * first / (first * first - R::from_f64(2.0) * (slope * second))
}

/// Returns half the slope of the squared distance, its derivative, and half the second one.
#[inline(always)]
fn slopes<R: Real>([position, velocity, quadratic, cubic]: &[Vector<R>; 4]) -> [R; 3] {
    let (two, three) = (R::from_f64(2.0), R::from_f64(3.0));
    [
        dot(*position, *velocity),
        dot(*velocity, *velocity) + two * dot(*position, *quadratic),
        three * (dot(*velocity, *quadratic) + dot(*position, *cubic)),
    ]
}

#[inline(always)]
fn least(k: [f32; 5]) -> f32 {
    (k[0].min_or_other(k[1]))
        .min_or_other(k[2].min_or_other(k[3]))
        .min_or_other(k[4])
}
