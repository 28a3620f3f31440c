//! Instruction sets: choosing one at run time, and compiling the loops for each.
#![allow(
    unsafe_code,
    reason = "calling a function compiled for an instruction set is unsafe; each call is guarded by the detection of that set"
)]

use std::sync::OnceLock;

use super::batch::Lanes;
use super::cubic::ControlPoints;
use super::guess::Guess;
use super::loops::{self, Block, Bounds};
use super::real::Real;
use super::screen::Verdict;

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

/// Compiles a loop of `loops.rs` for each instruction set, under the same name.
///
/// The loop is inlined into functions that may use the set, where the compiler makes vectors of
/// its lanes. The outputs are separate parameters: only so does the compiler know that they do not
/// overlap the inputs.
macro_rules! for_each_level {
    (
        $(#[$documentation:meta])*
        $name:ident<$R:ident>($($argument:ident: $type:ty),* $(,)?) $(-> $output:ty)?
    ) => {
        $(#[$documentation])*
        pub(super) fn $name<$R: Real >(level: Level, $($argument: $type),*) $(-> $output)? {
            #[cfg(target_arch = "x86_64")]
            #[target_feature(enable = "avx2")]
            fn avx2<$R: Real >($($argument: $type),*) $(-> $output)? {
                loops::$name::<$R>($($argument),*)
            }

            #[cfg(target_arch = "x86_64")]
            #[target_feature(enable = "avx512f,avx512dq,avx512bw,avx512vl")]
            fn avx512<$R: Real >($($argument: $type),*) $(-> $output)? {
                loops::$name::<$R>($($argument),*)
            }

            match level.0 {
                Set::Portable => loops::$name::<$R>($($argument),*),
                #[cfg(target_arch = "x86_64")]
                // SAFETY: a `Level` of this set is only made where the processor has AVX2.
                Set::Avx2 => unsafe { avx2::<$R>($($argument),*) },
                #[cfg(target_arch = "x86_64")]
                // SAFETY: a `Level` of this set is only made where the processor has AVX-512 F,
                // DQ, BW and VL.
                Set::Avx512 => unsafe { avx512::<$R>($($argument),*) },
            }
        }
    };
}

for_each_level! {
    /// Guesses the closest approach of one pair.
    guess_pair<R>(points: &ControlPoints<R>) -> Guess<R>
}

for_each_level! {
    /// Guesses the closest approach of each pair of a block.
    guess_block<R>(
        block: &mut Block<R>,
        lanes: &Lanes<'_, R>,
        times: &mut [R],
        distances: &mut [R],
        certificates: &mut [f32],
    )
}

for_each_level! {
    /// Guesses again, from first guesses in local time, and proves against the rival.
    guess_block_again<R>(
        block: &mut Block<R>,
        lanes: &Lanes<'_, R>,
        guesses: &[R],
        times: &mut [R],
        distances: &mut [R],
        certificates: &mut [f32],
    )
}

for_each_level! {
    /// Encloses the least distance of each pair of a block, from one split at the guess.
    enclose_block<R>(
        block: &mut Block<R>,
        lanes: &Lanes<'_, R>,
        errors: &[R],
        bounds: &mut Bounds<R>,
    )
}

for_each_level! {
    /// Encloses the least distance of each pair of a block, from a split at given times and
    /// quarters of both sides.
    enclose_block_finely<R>(
        lanes: &Lanes<'_, R>,
        errors: &[R],
        times: &[R],
        bounds: &mut Bounds<R>,
    )
}

for_each_level! {
    /// Screens each pair of a block on the halves of its span.
    screen_block<R>(lanes: &Lanes<'_, R>, inner: &[R], outer: &[R], verdicts: &mut [Verdict])
}

for_each_level! {
    /// Screens each pair of a block on the eighths of its span.
    screen_block_finely<R>(lanes: &Lanes<'_, R>, inner: &[R], outer: &[R], verdicts: &mut [Verdict])
}
