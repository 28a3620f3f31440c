//! Instruction sets: choosing one at run time, and compiling a task for each.
#![allow(
    unsafe_code,
    reason = "calling a function compiled for an instruction set is unsafe; each call is guarded by the detection of that set"
)]

use std::sync::OnceLock;

/// An instruction set that tasks are compiled for. AVX-512 was measured no faster than AVX2.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
enum Set {
    Portable,
    #[cfg(target_arch = "x86_64")]
    Avx2,
}

/// An instruction set that this processor has.
///
/// A value of this type is the proof that the processor has the set: it is only made by asking
/// the processor. All levels give the same pairs in the same order; a level only changes the speed.
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
            if is_x86_feature_detected!("avx2")
                && is_x86_feature_detected!("bmi1")
                && is_x86_feature_detected!("bmi2")
            {
                levels.push(Self(Set::Avx2));
            }
        }
        levels
    }

    /// A short name: `portable` or `avx2`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self.0 {
            Set::Portable => "portable",
            #[cfg(target_arch = "x86_64")]
            Set::Avx2 => "avx2",
        }
    }

    /// Runs a task as compiled for this level.
    pub(super) fn run<T: Task>(self, task: T) -> T::Output {
        match self.0 {
            Set::Portable => task.run(),
            #[cfg(target_arch = "x86_64")]
            // SAFETY: a `Level` of this set is only made where the processor has AVX2, BMI1 and
            // BMI2.
            Set::Avx2 => unsafe { run_avx2(task) },
        }
    }
}

/// A piece of work to be compiled once for each level.
///
/// `run` and what it calls in its loops are `#[inline(always)]`: only so are they compiled with
/// the level's instructions. They hold no operation whose result differs between levels.
pub(super) trait Task {
    type Output;

    fn run(self) -> Self::Output;
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,bmi1,bmi2")]
fn run_avx2<T: Task>(task: T) -> T::Output {
    task.run()
}
