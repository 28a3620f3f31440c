//! Memory that one screening leaves to the next.

use super::arrange::Arranger;
use super::sift::Sieve;
use crate::broad_phase::fill::Block;
use crate::broad_phase::{BruteForce, Candidate, Sweep, Tree};
use std::fmt;
use std::sync::{Mutex, PoisonError};

/// What one thread reuses from slice to slice.
///
/// A box, its course and its body take 64 bytes, in each slice of a block; the sweep's own lists 40
/// to 130 a box of one slice.
#[derive(Debug, Default)]
pub(super) struct Scratch {
    pub(super) brute_force: BruteForce,
    pub(super) tree: Tree,
    pub(super) sweep: Sweep,
    /// Places of the bodies that exist in the block.
    pub(super) present: Vec<u32>,
    pub(super) block: Block,
    pub(super) candidates: Vec<Candidate>,
    /// How many of them each slice has.
    pub(super) counts: Vec<usize>,
    pub(super) sieve: Sieve,
    pub(super) arranger: Arranger,
}

/// Scratch that is not in use, kept by a scene: first use of fresh memory costs as much as forming
/// the boxes that are written to it.
#[derive(Default)]
pub(crate) struct Pool {
    spare: Mutex<Vec<Scratch>>,
}

impl Pool {
    /// Scratch from the pool, to which it returns when dropped.
    pub(super) fn take(&self) -> Borrowed<'_> {
        let spare = self.spare.lock().unwrap_or_else(PoisonError::into_inner);
        let scratch = { spare }.pop().unwrap_or_default();
        Borrowed {
            scratch,
            pool: self,
        }
    }
}

impl Clone for Pool {
    /// An empty one: what it holds is of no interest.
    fn clone(&self) -> Self {
        Self::default()
    }
}

impl fmt::Debug for Pool {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.debug_struct("Pool").finish_non_exhaustive()
    }
}

/// See [`Pool::take`].
pub(super) struct Borrowed<'a> {
    pub(super) scratch: Scratch,
    pool: &'a Pool,
}

impl Drop for Borrowed<'_> {
    fn drop(&mut self) {
        let scratch = std::mem::take(&mut self.scratch);
        let spare = self.pool.spare.lock();
        spare.unwrap_or_else(PoisonError::into_inner).push(scratch);
    }
}

#[cfg(test)]
mod tests {
    use crate::bounds::{Bundle, Course, Pose, Stroke};
    use crate::broad_phase::{BodyBox, Candidate};
    use crate::narrow_phase::Party;
    use crate::scene::Occupant;
    use crate::screen::sift::Survivor;
    use crate::trajectory::Segment;

    /// The parts of the figures of the documentation of `Scene`, whose sums are counted in `tests/memory.rs`.
    #[test]
    fn sizes_are_as_documented() {
        assert_eq!(size_of::<Segment>(), 128);
        assert_eq!(size_of::<Stroke>(), 64);
        // Its motion beyond its knots lies with its segments.
        assert_eq!(size_of::<Occupant>() + 2 * size_of::<Segment>(), 592);
        assert_eq!(size_of::<Bundle>(), 64);
        let line = size_of::<Party<'_>>() + size_of::<Pose<'_, Stroke>>();
        let line = line + size_of::<(f64, f64)>();
        assert_eq!(line, 272);
        let boxed = size_of::<BodyBox>() + size_of::<Course>() + size_of::<u32>();
        assert_eq!(boxed, 64);
        assert_eq!(size_of::<Candidate>(), 8);
        assert_eq!(size_of::<Survivor>(), 16);
    }
}
