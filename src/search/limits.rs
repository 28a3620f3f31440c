//! Limits on the finds of a search, which bound its memory and its time.

use crate::bounds::FatLine;

/// The limits of one search.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Limits {
    /// Largest number of candidates at a time. A slice with more is divided.
    pub(crate) candidates: u64,
    /// Largest number of spans that cheap tests cannot rule out, each counted once.
    pub(crate) spans: usize,
}

/// The error of a search that found more than a [limit](Limits) allows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct LimitExceeded;

impl Limits {
    /// Default limit of candidates (32 MiB), raised to that of spans if that is higher.
    const CANDIDATES: u64 = 1 << 22;

    /// Returns the limits of a search with this limit of spans.
    pub(crate) const fn of_spans(spans: usize) -> Self {
        Self {
            candidates: if spans as u64 > Self::CANDIDATES {
                spans as u64
            } else {
                Self::CANDIDATES
            },
            spans,
        }
    }

    /// Returns the largest number of candidates of a slice before it is divided. More candidates per box cost more than the
    /// boxes of two halves, if those have few. If boxes are [coarse](are_coarse), far fewer cost more than those of islands.
    pub(crate) fn candidates_of_slice(&self, bodies: usize, is_coarse: bool) -> u64 {
        const CANDIDATES_PER_BOX: u64 = 32;
        const CANDIDATES_PER_COARSE_BOX: u64 = 2;
        /// Slices with fewer candidates are never divided, unless their boxes are coarse.
        const FEW: u64 = 1 << 16;
        let (most, bodies) = (self.candidates, bodies as u64);
        if is_coarse {
            (CANDIDATES_PER_COARSE_BOX * bodies).min(most)
        } else {
            (CANDIDATES_PER_BOX * bodies).clamp(FEW.min(most), most)
        }
    }

    /// Checks a number of spans.
    ///
    /// # Errors
    ///
    /// [`LimitExceeded`].
    pub(crate) const fn check(&self, spans: usize) -> Result<(), LimitExceeded> {
        if spans > self.spans {
            Err(LimitExceeded)
        } else {
            Ok(())
        }
    }
}

/// Returns true if f32 rounding makes up most of the bounds of half the bodies, told by a sample of the fat lines: the frame's
/// origin is far from them.
pub(crate) fn are_coarse(lines: &[FatLine]) -> bool {
    const SAMPLED: usize = 32;
    let sample = lines.iter().step_by(lines.len().div_ceil(SAMPLED).max(1));
    let (all, coarse) = (sample.len(), sample.filter(|line| line.is_coarse()).count());
    all > 0 && 2 * coarse >= all
}
