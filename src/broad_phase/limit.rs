//! A limit on candidates, which bounds memory.

use super::{Groups, PairFilter};
use std::sync::atomic::{AtomicU64, Ordering};

/// A filter that counts the pairs it admits, and gives up beyond a limit.
pub(crate) struct CandidateLimit<'f, F> {
    filter: &'f F,
    most: u64,
    /// Counted by all threads that share a sweep.
    admitted: AtomicU64,
}

impl<'f, F: PairFilter> CandidateLimit<'f, F> {
    /// Returns a filter that admits up to `most` pairs.
    pub(crate) const fn new(filter: &'f F, most: u64) -> Self {
        Self {
            filter,
            most,
            admitted: AtomicU64::new(0),
        }
    }

    /// Returns true if more pairs were admitted than there is room for.
    #[inline]
    pub(crate) fn is_exceeded(&self) -> bool {
        self.admitted.load(Ordering::Relaxed) > self.most
    }
}

impl<F: PairFilter> PairFilter for CandidateLimit<'_, F> {
    #[inline]
    fn admits(&self, a: u32, b: u32) -> bool {
        if !self.filter.admits(a, b) {
            return false;
        }
        // One more than there is room for tells that it was needed.
        self.admitted.fetch_add(1, Ordering::Relaxed) < self.most
    }

    #[inline]
    fn groups(&self) -> Groups {
        self.filter.groups()
    }

    #[inline]
    fn group(&self, body: u32) -> u8 {
        self.filter.group(body)
    }

    #[inline]
    fn gives_up(&self) -> bool {
        self.is_exceeded() || self.filter.gives_up()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::broad_phase::Everyone;

    #[test]
    fn gives_up_when_one_more_is_wanted_than_there_is_room_for() {
        let room = CandidateLimit::new(&Everyone, 2);
        assert!(room.admits(0, 1) && room.admits(0, 2));
        assert!(!room.gives_up(), "full, but enough");
        assert!(!room.admits(1, 2));
        assert!(room.gives_up());
    }
}
