//! The second try: the guess against its rival.
//!
//! Most guesses without a certificate have a rival: another minimum that is nearly as low, or
//! lower. It is near the minimum of the deflated squared distance: of `q`, or at an end of the span
//! of `(u + 1) q` plus the slope there. If that is negative, the rival is the better guess. The
//! other one of the two serves the proof: the span is cut there, where the Bernstein coefficients
//! are close to the values, and then into quarters of both parts.
//!
//! The value at the rival predicts the outcome. Within the tolerance of the proof, the two minima are
//! equally low, or the minimum is flat, and there is no proof. Above it, and if the first guess had
//! settled, that guess stays and only the proof is repeated.

use super::certificate::{Deflated, Guess};
use crate::blossom::divide;
use crate::guess::{
    CentredCubic, ControlPoints, LaneSquaredDistance, RefinedGuess, descend_safely, polish, settle,
    squared_distance,
};
use crate::real::Real;

/// Ratio of this proof's tolerance to that of the first (derivation in `kernels`).
const AGAIN: f32 = 4.0;

/// Steps of refinement in the second try.
pub(super) const STEPS: u32 = 3;

/// A guess and the rival against which it is proven.
#[derive(Clone, Copy, Debug)]
pub(super) struct MinimumChoice {
    /// Centred time near the better minimum.
    pub(super) start: f32,
    /// Centred time near the other minimum.
    pub(super) rival: f32,
    /// Factor on the tolerance of the first guess's proof if that guess stays: 1, or infinity if there
    /// will be no proof. 0 if the guess is to be made again.
    pub(super) stays: f32,
}

/// Guesses again where that can help, and certifies against the other minimum.
#[inline(always)]
pub(super) fn guess_against_rival<R: Real>(points: ControlPoints<R>, first: Guess<R>) -> Guess<R> {
    let cubic = CentredCubic::new(points);
    let squared_distance = squared_distance::<R>(&cubic.rough());
    let choice = choose_minimum(
        &squared_distance,
        first.settled.time.to_f32(),
        first.settled.tolerance_factor,
    );
    if choice.stays > 1.0 {
        return first;
    }
    let settled = if choice.stays > 0.0 {
        first.settled
    } else {
        again(&cubic, &squared_distance, choice.start)
    };
    let time = settled.time.to_f32();
    Guess {
        settled,
        certificate: certify_against(
            &squared_distance,
            time,
            choice.rival,
            settled.tolerance_factor,
        ),
    }
}

/// Returns the guess near a time, with more steps than the first.
#[inline(always)]
fn again<R: Real>(
    cubic: &CentredCubic<R>,
    squared_distance: &LaneSquaredDistance,
    start: f32,
) -> RefinedGuess<R> {
    let rough = descend_safely(&squared_distance.square, start, STEPS);
    settle(cubic, polish(cubic, R::from_f64(f64::from(rough))))
}

/// First stage: chooses the minimum that is the better guess, and tells whether it is the first
/// guess. `tolerance_factor` is that of the first guess.
#[inline(always)]
pub(super) fn choose_minimum(
    squared_distance: &LaneSquaredDistance,
    first: f32,
    tolerance_factor: f32,
) -> MinimumChoice {
    let remainder = DeflatedRemainder::new(squared_distance, first);
    let least = remainder.least_point(remainder.lowest_sample());
    let rival = remainder.deflated.sign * least;
    let value = remainder.value(least);
    let beaten = value < 0.0;
    let again = beaten | (tolerance_factor > 1.0);
    let decided = value.abs() > AGAIN * squared_distance.tolerance;
    let stays = if again { 0.0 } else { 1.0 };
    MinimumChoice {
        start: if beaten { rival } else { first },
        rival: if beaten { first } else { rival },
        stays: if decided { stays } else { f32::INFINITY },
    }
}

/// Last stage: returns a positive number if no point is certainly lower than the guess at `u`; only
/// points around `rival` could be.
#[inline(always)]
pub(super) fn certify_against(
    squared_distance: &LaneSquaredDistance,
    u: f32,
    rival: f32,
    tolerance_factor: f32,
) -> f32 {
    let remainder = DeflatedRemainder::new(squared_distance, u);
    let rival = remainder.deflated.sign * rival;
    let [low, high] = divide(
        remainder.bernstein(),
        0.5 * (remainder.least_point(rival) + 1.0),
    );
    least_of_quarters(low).min_or_other(least_of_quarters(high))
        - AGAIN * squared_distance.tolerance * tolerance_factor
}

/// The polynomial of degree 5 that has to be positive over the span, in powers and as deflated.
#[derive(Clone, Copy, Debug)]
struct DeflatedRemainder {
    powers: [f32; 6],
    deflated: Deflated,
}

impl DeflatedRemainder {
    #[inline(always)]
    fn new(squared_distance: &LaneSquaredDistance, u: f32) -> Self {
        let deflated = Deflated::new(&squared_distance.square, u, squared_distance.tolerance);
        let [q0, q1, q2, q3, q4] = deflated.quartic;
        let inward = deflated.inward;
        let at_end = inward > 0.0;
        // At the low end of the span (u + 1) q + inward, else q.
        let powers = [
            if at_end { q0 + inward } else { q0 },
            if at_end { q1 + q0 } else { q1 },
            if at_end { q2 + q1 } else { q2 },
            if at_end { q3 + q2 } else { q3 },
            if at_end { q4 + q3 } else { q4 },
            if at_end { q4 } else { 0.0 },
        ];
        Self { powers, deflated }
    }

    #[inline(always)]
    fn value(&self, u: f32) -> f32 {
        let [t0, t1, t2, t3, t4, t5] = self.powers;
        let v = u * u;
        (t0 + u * t1) + v * ((t2 + u * t3) + v * (t4 + u * t5))
    }

    /// Returns the lowest of the samples at `0, ±1/4, …, ±1`.
    #[inline(always)]
    fn lowest_sample(&self) -> f32 {
        let [t0, t1, t2, t3, t4, t5] = self.powers;
        let mut best = t0;
        let mut time = 0.0;
        let mut i = 1;
        while i <= 4 {
            let u = 0.25 * i as f32;
            let v = u * u;
            let even = t0 + v * (t2 + v * t4);
            let odd = u * (t1 + v * (t3 + v * t5));
            time = if even - odd < best { -u } else { time };
            best = (even - odd).min_or_other(best);
            time = if even + odd < best { u } else { time };
            best = (even + odd).min_or_other(best);
            i += 1;
        }
        time
    }

    /// Returns the result of two Newton steps towards a minimum.
    #[inline(always)]
    fn least_point(&self, start: f32) -> f32 {
        let [_, t1, t2, t3, t4, t5] = self.powers;
        let mut u = start;
        let mut step = 0;
        while step < 2 {
            let v = u * u;
            let slope = (t1 + u * (2.0 * t2)) + v * ((3.0 * t3 + u * (4.0 * t4)) + v * (5.0 * t5));
            let slope_change = (2.0 * t2 + u * (6.0 * t3)) + v * (12.0 * t4 + u * (20.0 * t5));
            let next = (u - slope / slope_change)
                .min_or_other(1.0)
                .max_or_other(-1.0);
            u = if slope_change > 0.0 { next } else { u };
            step += 1;
        }
        u
    }

    /// Returns the Bernstein coefficients over the span.
    #[inline(always)]
    fn bernstein(&self) -> [f32; 6] {
        let [q0, q1, q2, q3, q4] = self.deflated.quartic;
        let inward = self.deflated.inward;
        let (s, t) = (q0 + q4, q1 + q3);
        let k = [
            (s + q2) - t,
            (q0 - q4) - 0.5 * (q1 - q3),
            s - (1.0 / 3.0) * q2,
            (q0 - q4) + 0.5 * (q1 - q3),
            (s + q2) + t,
        ];
        let at_end = inward > 0.0;
        let mut b = [if at_end { inward } else { k[0] }; 6];
        let mut i = 1;
        while i < 6 {
            let part = 0.2 * i as f32;
            let other = if i < 5 { (1.0 - part) * k[i] } else { 0.0 };
            // As a quintic; or twice the local time times the quartic, and the slope.
            b[i] = if at_end {
                2.0 * part * k[i - 1] + inward
            } else {
                part * k[i - 1] + other
            };
            i += 1;
        }
        b
    }
}

/// Returns the least coefficient on the four quarters of a piece.
#[inline(always)]
fn least_of_quarters(k: [f32; 6]) -> f32 {
    let [low, high] = divide(k, 0.5);
    let ([a, b], [c, d]) = (divide(low, 0.5), divide(high, 0.5));
    (least(a).min_or_other(least(b))).min_or_other(least(c).min_or_other(least(d)))
}

#[inline(always)]
fn least(k: [f32; 6]) -> f32 {
    (k[0].min_or_other(k[1]))
        .min_or_other(k[2].min_or_other(k[3]))
        .min_or_other(k[4].min_or_other(k[5]))
}
