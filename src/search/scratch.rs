//! Buffers that one screening leaves to the next.

use super::{CandidateRefiner, SliceBlock, SpanSorter};
use crate::bounds::{CompactCubic, CubicSource};
use crate::broad_phase::{Candidate, Methods};
use crate::spans::SpanKey;

/// Buffers that one thread reuses from slice to slice.
///
/// A box, its fat line and its body take 64 bytes, in each slice of a block. The sweep's own lists
/// take 40 to 130 bytes a box of one slice.
#[derive(Debug, Default)]
pub(crate) struct SearchScratch {
    /// Memory of the box sources of a screening's bodies: see [`recycled`].
    pub(crate) sources: Vec<CubicSource<'static, CompactCubic>>,
    /// First and last instant of each of a monitor's bodies, s.
    pub(crate) lifetimes: Vec<(f64, f64)>,
    pub(crate) methods: Methods,
    /// Numbers of the bodies that exist in the block.
    pub(crate) present: Vec<u32>,
    pub(crate) block: SliceBlock,
    /// A tried slice of a sample of the bodies. (In the block its shorter lists would have to be filled again.)
    pub(crate) tried: SliceBlock,
    pub(crate) candidates: Vec<Candidate>,
    /// Ends of the slices of a block, s.
    pub(crate) ends: Vec<f64>,
    pub(crate) refiner: CandidateRefiner,
    pub(crate) found: Vec<SpanKey>,
    pub(crate) sorter: SpanSorter,
}

/// Returns an empty list in the memory of one whose values have another lifetime.
pub(crate) fn recycled<T, U>(mut list: Vec<T>) -> Vec<U> {
    list.clear();
    list.into_iter().filter_map(|_| None).collect()
}

#[cfg(target_pointer_width = "64")]
#[cfg(test)]
mod tests {
    use crate::bounds::{CompactCubic, CubicRun, CubicSource, FatLine};
    use crate::broad_phase::{BodyBox, Candidate};
    use crate::scene::SceneEntry;
    use crate::spans::SpanKey;
    use crate::trajectory::Segment;

    /// The parts of the figures in the docs of `Scene`; `tests/memory.rs` counts the sums. Shorter pointers take less.
    #[test]
    fn sizes_are_as_documented() {
        assert_eq!(size_of::<Segment>(), 128);
        assert_eq!(size_of::<CompactCubic>(), 64);
        assert_eq!(size_of::<SceneEntry>(), 184);
        assert_eq!(size_of::<CubicRun>(), 64);
        let line = size_of::<CubicSource<'_, CompactCubic>>() + size_of::<(f64, f64)>();
        assert_eq!(line, 192);
        let boxed = size_of::<BodyBox>() + size_of::<FatLine>() + size_of::<u32>();
        assert_eq!(boxed, 64);
        assert_eq!(size_of::<Candidate>(), 8);
        assert_eq!(size_of::<SpanKey>(), 16);
    }
}
