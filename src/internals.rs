//! Parts of the crate for its own tests and benchmarks. They may change or go with any version.

use crate::query::Query;
use std::num::NonZeroU32;

pub use crate::broad_phase::Method;
pub use crate::simd::InstructionSet;

pub mod broad_phase {
    //! Boxes in, candidate pairs out.
    pub use crate::broad_phase::{
        BodyBox, BroadPhase, BruteForce, Candidate, Everyone, InstructionSet, Method, PairFilter,
        Sweep, Tree,
    };
}

pub mod enclosure {
    //! Certified enclosures of one cubic.
    pub use crate::enclosure::{
        DistanceEnclosure, Effort, LeastDistance, OutOfRange, ParameterEnclosure, Side, Stretch,
        Stretches, Threshold, UncertainCubic,
    };
}

pub mod polynomial {
    //! Roots of polynomials.
    pub use crate::polynomial::{Bernstein, Polynomial, RootList, Roots, quadratic};
}

/// Query settings that change the time of an answer, never the answer.
pub trait QueryInternals: Sized {
    /// Returns the query with another broad-phase method.
    #[must_use]
    fn with_method(self, method: Method) -> Self;

    /// Returns the query with this number of slices of the window, at most a million, instead of
    /// the cheapest number. The answer does not depend on it if there is room for the candidates of
    /// a slice (2^26, or [`max_spans`](Query::max_spans) if that is more).
    #[must_use]
    fn with_slices(self, slices: NonZeroU32) -> Self;

    /// Returns the query with another instruction set, instead of the best of this processor.
    #[must_use]
    fn with_instruction_set(self, instructions: InstructionSet) -> Self;
}

impl QueryInternals for Query {
    fn with_method(mut self, method: Method) -> Self {
        self.method = method;
        self
    }

    fn with_slices(mut self, slices: NonZeroU32) -> Self {
        self.slices = Some(slices);
        self
    }

    fn with_instruction_set(mut self, instructions: InstructionSet) -> Self {
        self.instructions = instructions;
        self
    }
}
