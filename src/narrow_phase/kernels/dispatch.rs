//! Instruction sets: choosing one at run time, and compiling the kernels for each.
#![allow(
    unsafe_code,
    reason = "calling a function compiled for an instruction set is unsafe; each call is guarded by the detection of that set"
)]

use std::sync::OnceLock;

use super::batch::Lanes;
use super::cubic::{CentredCubic, ControlPoints};
use super::enclosure::{SPLIT, SPLIT_AND_HALVED, enclose_between};
use super::guess::{descend, least_of_deflated, lowest_sample, settle};
use super::minorant::{lower_bound, lower_bound_far, lower_bound_near, split};
use super::real::Real;
use super::screen::{screen_eighths, screen_halves};

/// The number of pairs a kernel works on between two looks at what failed.
pub(super) const BLOCK: usize = 128;

/// An instruction set the kernels are compiled for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
enum Set {
    Portable,
    #[cfg(target_arch = "x86_64")]
    Avx2,
    #[cfg(target_arch = "x86_64")]
    Avx512,
}

/// An instruction set that this processor has.
///
/// A value of this type is the proof that the processor has the set: it is only made by asking
/// the processor. All levels give identical bits, because every operation in the kernels is
/// correctly rounded and none is fused; a level only changes the speed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Level(Set);

impl Level {
    /// What every processor of the target has; the compiler may still use vectors of its own.
    pub const PORTABLE: Self = Self(Set::Portable);

    /// The fastest level of this processor; asked once.
    #[must_use]
    pub fn best() -> Self {
        static BEST: OnceLock<Level> = OnceLock::new();
        *BEST.get_or_init(|| Self::available().pop().unwrap_or(Self::PORTABLE))
    }

    /// The levels of this processor, from the slowest to the fastest.
    #[must_use]
    pub fn available() -> Vec<Self> {
        let mut levels = vec![Self::PORTABLE];
        #[cfg(target_arch = "x86_64")]
        {
            if is_x86_feature_detected!("avx2") {
                levels.push(Self(Set::Avx2));
                if is_x86_feature_detected!("avx512f")
                    && is_x86_feature_detected!("avx512dq")
                    && is_x86_feature_detected!("avx512bw")
                    && is_x86_feature_detected!("avx512vl")
                {
                    levels.push(Self(Set::Avx512));
                }
            }
        }
        levels
    }

    /// A short name: `portable`, `avx2` or `avx512`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self.0 {
            Set::Portable => "portable",
            #[cfg(target_arch = "x86_64")]
            Set::Avx2 => "avx2",
            #[cfg(target_arch = "x86_64")]
            Set::Avx512 => "avx512",
        }
    }
}

/// Compiles the loop of a kernel for each instruction set.
///
/// The outputs are separate parameters: only so does the compiler know that they do not overlap
/// the inputs, without which it does not vectorise.
macro_rules! for_each_level {
    (
        $(#[$documentation:meta])*
        $name:ident<$R:ident $(, const $N:ident: usize)*>($($argument:ident: $type:ty),* $(,)?) $body:block
    ) => {
        $(#[$documentation])*
        pub(super) fn $name<$R: Real $(, const $N: usize)*>(level: Level, $($argument: $type),*) {
            #[inline(always)]
            fn portable<$R: Real $(, const $N: usize)*>($($argument: $type),*) $body

            #[cfg(target_arch = "x86_64")]
            #[target_feature(enable = "avx2")]
            fn avx2<$R: Real $(, const $N: usize)*>($($argument: $type),*) {
                portable::<$R $(, $N)*>($($argument),*);
            }

            #[cfg(target_arch = "x86_64")]
            #[target_feature(enable = "avx512f,avx512dq,avx512bw,avx512vl")]
            fn avx512<$R: Real $(, const $N: usize)*>($($argument: $type),*) {
                portable::<$R $(, $N)*>($($argument),*);
            }

            match level.0 {
                Set::Portable => portable::<$R $(, $N)*>($($argument),*),
                #[cfg(target_arch = "x86_64")]
                // SAFETY: a `Level` of this set is only made where the processor has AVX2.
                Set::Avx2 => unsafe { avx2::<$R $(, $N)*>($($argument),*) },
                #[cfg(target_arch = "x86_64")]
                // SAFETY: a `Level` of this set is only made where the processor has AVX-512 F,
                // DQ, BW and VL.
                Set::Avx512 => unsafe { avx512::<$R $(, $N)*>($($argument),*) },
            }
        }
    };
}

/// The control points of one pair of a block.
#[inline(always)]
fn gather<R: Real>(lanes: &Lanes<'_, R>, i: usize) -> ControlPoints<R> {
    let [x, y, z] = lanes.coordinates;
    [
        [x[0][i], y[0][i], z[0][i]],
        [x[1][i], y[1][i], z[1][i]],
        [x[2][i], y[2][i], z[2][i]],
        [x[3][i], y[3][i], z[3][i]],
    ]
}

/// What the stages hand on, pair by pair; aligned so that no vector straddles two cache lines.
#[repr(align(64))]
#[derive(Debug)]
pub(super) struct Block<R> {
    cubics: [[[R; BLOCK]; 3]; 4],
    squares: [[R; BLOCK]; 7],
    rough: [R; BLOCK],
}

impl<R: Real> Block<R> {
    pub(super) fn new() -> Self {
        Self {
            cubics: [[[R::default(); BLOCK]; 3]; 4],
            squares: [[R::default(); BLOCK]; 7],
            rough: [R::default(); BLOCK],
        }
    }

    #[inline(always)]
    fn set(&mut self, i: usize, cubic: &CentredCubic<R>, square: &[R; 7]) {
        let mut k = 0;
        while k < 4 {
            self.cubics[k][0][i] = cubic.coefficients[k][0];
            self.cubics[k][1][i] = cubic.coefficients[k][1];
            self.cubics[k][2][i] = cubic.coefficients[k][2];
            k += 1;
        }
        let mut k = 0;
        while k < 7 {
            self.squares[k][i] = square[k];
            k += 1;
        }
    }

    #[inline(always)]
    fn cubic(&self, i: usize) -> CentredCubic<R> {
        let [c0, c1, c2, c3] = &self.cubics;
        CentredCubic {
            coefficients: [
                [c0[0][i], c0[1][i], c0[2][i]],
                [c1[0][i], c1[1][i], c1[2][i]],
                [c2[0][i], c2[1][i], c2[2][i]],
                [c3[0][i], c3[1][i], c3[2][i]],
            ],
        }
    }

    #[inline(always)]
    fn square(&self, i: usize) -> [R; 7] {
        let [a0, a1, a2, a3, a4, a5, a6] = &self.squares;
        [a0[i], a1[i], a2[i], a3[i], a4[i], a5[i], a6[i]]
    }
}

for_each_level! {
    /// Guesses the closest approach of each pair of a block.
    guess_block<R, const HALF: usize, const PIECES: usize>(
        block: &mut Block<R>,
        lanes: &Lanes<'_, R>,
        times: &mut [R],
        distances: &mut [R],
        certificates: &mut [R],
    ) {
        let count = times.len().min(BLOCK);
        let times = &mut times[..count];
        let lanes = lanes.first(count);
        let (distances, certificates) = (&mut distances[..count], &mut certificates[..count]);
        for i in 0..count {
            let cubic = CentredCubic::new(gather(&lanes, i));
            let square = cubic.squared_distance();
            block.set(i, &cubic, &square);
        }
        for i in 0..count {
            block.rough[i] = lowest_sample::<R, HALF>(&block.square(i));
        }
        for i in 0..count {
            block.rough[i] = descend::<R, HALF>(&block.square(i), block.rough[i]);
        }
        for i in 0..count {
            let found = settle(&block.cubic(i), &block.square(i), block.rough[i]);
            block.rough[i] = found.time;
            times[i] = R::from_f64(0.5) * (found.time + R::from_f64(1.0));
            distances[i] = R::from_f64(0.125) * found.square.sqrt();
            certificates[i] = found.margin;
        }
        for i in 0..count {
            let least = least_of_deflated::<R, PIECES>(&block.square(i), block.rough[i]);
            certificates[i] = least - certificates[i];
        }
    }
}

for_each_level! {
    /// Encloses the least distance of each pair of a block, as far as one split at the guess does.
    enclose_block<R>(
        block: &mut Block<R>,
        lanes: &Lanes<'_, R>,
        errors: &[R],
        times: &mut [R],
        lows: &mut [R],
        highs: &mut [R],
        tight: &mut [R],
    ) {
        let count = times.len().min(BLOCK);
        let times = &mut times[..count];
        let lanes = lanes.first(count);
        let errors = &errors[..count];
        let (lows, highs, tight) = (&mut lows[..count], &mut highs[..count], &mut tight[..count]);
        for i in 0..count {
            let cubic = CentredCubic::new(gather(&lanes, i));
            block.set(i, &cubic, &cubic.squared_distance());
        }
        for i in 0..count {
            block.rough[i] = lowest_sample::<R, 4>(&block.square(i));
        }
        for i in 0..count {
            block.rough[i] = descend::<R, 4>(&block.square(i), block.rough[i]);
        }
        for i in 0..count {
            let found = settle(&block.cubic(i), &block.square(i), block.rough[i]);
            times[i] = R::from_f64(0.5) * (found.time + R::from_f64(1.0));
        }
        for i in 0..count {
            let [before, _] = split(gather(&lanes, i), times[i]);
            lows[i] = lower_bound(before);
        }
        for i in 0..count {
            let [_, after] = split(gather(&lanes, i), times[i]);
            highs[i] = lower_bound(after);
        }
        for i in 0..count {
            let points = gather(&lanes, i);
            let [before, _] = split(points, times[i]);
            let bound = lows[i].or_less(highs[i]);
            let found = enclose_between(points, before[0], bound, errors[i], SPLIT);
            (lows[i], highs[i], tight[i]) = (found.low, found.high, found.tight);
        }
    }
}

for_each_level! {
    /// Encloses the least distance of each pair of a block, with the span split at given times and
    /// both sides in quarters.
    enclose_block_finely<R>(
        lanes: &Lanes<'_, R>,
        errors: &[R],
        times: &[R],
        lows: &mut [R],
        highs: &mut [R],
        tight: &mut [R],
    ) {
        let count = times.len();
        let lanes = lanes.first(count);
        let errors = &errors[..count];
        let (lows, highs, tight) = (&mut lows[..count], &mut highs[..count], &mut tight[..count]);
        for i in 0..count {
            let [before, _] = split(gather(&lanes, i), times[i]);
            lows[i] = lower_bound_near(before);
        }
        for i in 0..count {
            let [before, _] = split(gather(&lanes, i), times[i]);
            lows[i] = lows[i].or_less(lower_bound_far(before));
        }
        for i in 0..count {
            let [_, after] = split(gather(&lanes, i), times[i]);
            highs[i] = lower_bound_near(after);
        }
        for i in 0..count {
            let [_, after] = split(gather(&lanes, i), times[i]);
            highs[i] = highs[i].or_less(lower_bound_far(after));
        }
        for i in 0..count {
            let points = gather(&lanes, i);
            let [before, _] = split(points, times[i]);
            let bound = lows[i].or_less(highs[i]);
            let found = enclose_between(points, before[0], bound, errors[i], SPLIT_AND_HALVED);
            (lows[i], highs[i], tight[i]) = (found.low, found.high, found.tight);
        }
    }
}

for_each_level! {
    /// Screens each pair of a block on the halves of its span.
    screen_block<R>(
        lanes: &Lanes<'_, R>,
        inner: &[R],
        outer: &[R],
        findings: &mut [R],
    ) {
        let count = findings.len();
        let lanes = lanes.first(count);
        let (inner, outer) = (&inner[..count], &outer[..count]);
        for i in 0..count {
            findings[i] = screen_halves(gather(&lanes, i), inner[i], outer[i]);
        }
    }
}

for_each_level! {
    /// Screens each pair of a block on the eighths of its span.
    screen_block_finely<R>(
        lanes: &Lanes<'_, R>,
        inner: &[R],
        outer: &[R],
        findings: &mut [R],
    ) {
        let count = findings.len();
        let lanes = lanes.first(count);
        let (inner, outer) = (&inner[..count], &outer[..count]);
        for i in 0..count {
            findings[i] = screen_eighths(gather(&lanes, i), inner[i], outer[i]);
        }
    }
}
