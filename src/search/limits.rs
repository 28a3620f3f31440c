//! Room for what a search finds: more than that is refused, instead of filling the memory.

/// Room for candidates and spans of one search.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Limits {
    /// Candidates at a time. A slice with more of them is divided.
    pub(crate) candidates: u64,
    /// Spans that cheap tests cannot rule out, each counted once.
    pub(crate) spans: usize,
}

/// A search found more than it has room for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct LimitExceeded;

impl Limits {
    /// 32 MiB of candidates, unless there is room for more spans.
    const CANDIDATES: u64 = 1 << 22;

    /// Returns the limits of a search with room for so many spans.
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

    /// Returns the largest number of candidates that a slice of so many bodies may have before it is
    /// divided: more candidates a box cost more than the boxes of two halves, if those have few.
    pub(crate) fn candidates_of_slice(&self, bodies: usize) -> u64 {
        const CANDIDATES_PER_BOX: u64 = 32;
        /// Fewer are not worth a division.
        const FEW: u64 = 1 << 16;
        let most = self.candidates;
        (CANDIDATES_PER_BOX * bodies as u64).clamp(FEW.min(most), most)
    }

    /// Checks a number of spans.
    ///
    /// # Errors
    ///
    /// If there are more than there is room for.
    pub(crate) const fn check(&self, spans: usize) -> Result<(), LimitExceeded> {
        if spans > self.spans {
            Err(LimitExceeded)
        } else {
            Ok(())
        }
    }
}
