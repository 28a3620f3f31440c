//! Instruction sets: run-time selection, and compilation of work for each set.
//!
//! The work is plain loops over lanes, which the compiler vectorises. No operation is fused or
//! reordered, so every set gives the same bits.
#![allow(
    unsafe_code,
    reason = "calling a function compiled for an instruction set is unsafe; each call is guarded by the detection of that set"
)]

use std::slice::from_ref;
use std::sync::OnceLock;

/// An instruction set for which work is compiled.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(crate) enum Set {
    Portable,
    #[cfg(target_arch = "x86_64")]
    Avx2,
    #[cfg(target_arch = "x86_64")]
    Avx512,
}

/// An instruction set that this processor has.
///
/// A value of this type is the proof that the processor has the set: it is only made by asking
/// the processor. All sets give identical bits, because every operation is correctly rounded and
/// none is fused; the choice only changes the speed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct InstructionSet(Set);

impl InstructionSet {
    /// The set that every processor of the target has; the compiler may still vectorise.
    pub const PORTABLE: Self = Self(Set::Portable);

    /// Returns the fastest set of this processor, determined once.
    ///
    /// The environment variable `NEARMISS_INSTRUCTIONS` can name a slower one of [`available`](Self::available), to compare
    /// them. Other names are ignored.
    #[must_use]
    pub fn best() -> Self {
        static BEST: OnceLock<InstructionSet> = OnceLock::new();
        *BEST.get_or_init(|| {
            let available = Self::available();
            let name = std::env::var("NEARMISS_INSTRUCTIONS").unwrap_or_default();
            let named = available.iter().find(|set| set.name() == name);
            *named.or(available.last()).unwrap_or(&Self::PORTABLE)
        })
    }

    /// Returns the sets of this processor, from the slowest to the fastest.
    #[must_use]
    pub fn available() -> Vec<Self> {
        #[cfg(target_arch = "x86_64")]
        if is_x86_feature_detected!("avx2")
            && is_x86_feature_detected!("bmi1")
            && is_x86_feature_detected!("bmi2")
        {
            let narrow = vec![Self::PORTABLE, Self(Set::Avx2)];
            // The compiler takes AVX-512 F to imply F16C and FMA.
            let has_wide = is_x86_feature_detected!("f16c")
                && is_x86_feature_detected!("fma")
                && is_x86_feature_detected!("avx512f")
                && is_x86_feature_detected!("avx512dq")
                && is_x86_feature_detected!("avx512bw")
                && is_x86_feature_detected!("avx512vl");
            let wide = has_wide.then_some(Self(Set::Avx512));
            return narrow.into_iter().chain(wide).collect();
        }
        vec![Self::PORTABLE]
    }

    /// Returns a short name: `portable`, `avx2` or `avx512`.
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

    pub(crate) const fn set(self) -> Set {
        self.0
    }

    /// Runs a task compiled for this set, with AVX2 in place of AVX-512 (measured no faster).
    pub(crate) fn run<T: Task>(self, task: T) -> T::Output {
        match self.0 {
            Set::Portable => task.run(),
            #[cfg(target_arch = "x86_64")]
            // SAFETY: an `InstructionSet` of these sets is only made where the processor has AVX2, BMI1 and
            // BMI2.
            Set::Avx2 | Set::Avx512 => unsafe { run_avx2(task) },
        }
    }
}

/// A piece of work to be compiled once for each set.
///
/// `run` and what it calls in its loops are `#[inline(always)]`: only so are they compiled with
/// the instructions of the set. They hold no operation whose result differs between sets.
pub(crate) trait Task {
    type Output;

    fn run(self) -> Self::Output;
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,bmi1,bmi2")]
// A task within a task has all registers for itself.
#[inline(never)]
fn run_avx2<T: Task>(task: T) -> T::Output {
    task.run()
}

/// Prefetches `values`, one instruction per 64-byte cache line: for data read about a microsecond
/// later in an unpredictable order.
#[inline(always)]
pub(crate) fn prefetch<T>(values: &[T]) {
    const LINE: usize = 64;
    let first = values.as_ptr().cast::<i8>();
    let size = size_of_val(values);
    // Values that begin within a line may end in one more than they would fill. It is fetched in any case:
    // their number of lines is known then, and no branch is mispredicted.
    let more = usize::from(align_of::<T>() < LINE);
    for line in 0..size.div_ceil(LINE) + more {
        let place = (line * LINE).min(size.saturating_sub(1));
        prefetch_line(first.wrapping_add(place));
    }
}

/// Prefetches the cache line in which a value begins.
#[inline(always)]
pub(crate) fn prefetch_first<T>(value: &T) {
    prefetch_line(from_ref(value).as_ptr().cast());
}

/// Prefetches the cache line of an address.
#[inline(always)]
fn prefetch_line(address: *const i8) {
    #[cfg(target_arch = "x86_64")]
    {
        use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
        // SAFETY: a prefetch reads nothing that a program can see, whatever the address.
        unsafe { _mm_prefetch::<_MM_HINT_T0>(address) };
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = address;
}

/// Compiles a function with a loop for each instruction set; the set becomes its first parameter.
///
/// The loop is inlined into functions that may use the set, where the compiler vectorises it. The
/// outputs are separate parameters, so that the compiler knows that they do not overlap the inputs;
/// a [`Task`] cannot express that.
macro_rules! for_each_instruction_set {
    (
        $(#[$documentation:meta])*
        fn $name:ident $(<$R:ident: $bound:ident>)? ($($argument:ident: $type:ty),* $(,)?) $(-> $output:ty)?
        $body:block
    ) => {
        $(#[$documentation])*
        #[allow(
            unsafe_code,
            reason = "an `InstructionSet` of a set is only made where the processor has the set"
        )]
        pub(super) fn $name $(<$R: $bound>)? (instructions: InstructionSet, $($argument: $type),*) $(-> $output)? {
            #[inline(always)]
            fn portable $(<$R: $bound>)? ($($argument: $type),*) $(-> $output)? $body

            #[cfg(target_arch = "x86_64")]
            #[target_feature(enable = "avx2")]
            fn avx2 $(<$R: $bound>)? ($($argument: $type),*) $(-> $output)? {
                portable($($argument),*)
            }

            #[cfg(target_arch = "x86_64")]
            #[target_feature(enable = "avx512f,avx512dq,avx512bw,avx512vl")]
            fn avx512 $(<$R: $bound>)? ($($argument: $type),*) $(-> $output)? {
                portable($($argument),*)
            }

            match instructions.set() {
                $crate::simd::Set::Portable => portable($($argument),*),
                #[cfg(target_arch = "x86_64")]
                // SAFETY: an `InstructionSet` of this set is only made where the processor has AVX2.
                $crate::simd::Set::Avx2 => unsafe { avx2($($argument),*) },
                #[cfg(target_arch = "x86_64")]
                // SAFETY: an `InstructionSet` of this set is only made where the processor has AVX-512 F,
                // DQ, BW and VL.
                $crate::simd::Set::Avx512 => unsafe { avx512($($argument),*) },
            }
        }
    };
}

pub(crate) use for_each_instruction_set;
