//! Memory for the compact trajectories of a scene's bodies.
//!
//! A screening reads all of them, time and again, and they exceed every cache. So they are stored
//! contiguously, in large pages where the system has these.

use crate::bounds::CacheLine;
use bytemuck::{cast_slice, cast_slice_mut};
use memmap2::MmapMut;
use std::fmt;

/// An arena for compact trajectories: each is appended. Freed cache lines are reused only after all live
/// ones were [copied](Self::take_copy) to another arena.
#[derive(Default)]
pub(crate) struct CubicArena {
    chunks: Vec<Memory>,
    /// Cache lines of the last chunk that were never used.
    unused: usize,
    /// Cache lines of all ranges in use.
    live: usize,
    /// Cache lines that were freed.
    garbage: usize,
}

/// The cache lines of one compact trajectory.
#[derive(Debug, Default)]
pub(crate) struct ArenaRange {
    chunk: usize,
    first: usize,
    cache_lines: usize,
}

/// A contiguous allocation of cache lines.
enum Memory {
    Few(Vec<CacheLine>),
    Pages(MmapMut),
}

impl CubicArena {
    /// Smallest chunk, 16 KiB: for a small scene.
    const FEWEST: usize = 1 << 8;
    /// 1 MiB: a chunk for more cache lines is allocated in large pages.
    const FEW: usize = 1 << 14;
    /// A large page, 2 MiB, on most systems.
    const PAGE: usize = 1 << 15;
    /// Chunks for more live cache lines than this are not larger, 32 MiB.
    const MANY: usize = 1 << 19;

    /// Allocates a range of cache lines with arbitrary content. One without cache lines is nowhere: it outlives all chunks.
    pub(crate) fn take(&mut self, cache_lines: usize) -> ArenaRange {
        if cache_lines == 0 {
            return ArenaRange::default();
        }
        if self.unused < cache_lines || self.chunks.is_empty() {
            // Room for no fewer than are in use, unless these are many.
            let chunk = Memory::with(cache_lines.max(self.live.clamp(Self::FEWEST, Self::MANY)));
            self.unused = chunk.cache_lines().len();
            self.chunks.push(chunk);
        }
        let chunk = self.chunks.len() - 1;
        let first = self.chunks[chunk].cache_lines().len() - self.unused;
        self.unused -= cache_lines;
        self.live += cache_lines;
        ArenaRange {
            chunk,
            first,
            cache_lines,
        }
    }

    /// Allocates a range with a copy of another arena's range.
    pub(crate) fn take_copy(&mut self, other: &Self, range: &ArenaRange) -> ArenaRange {
        let copy = self.take(range.cache_lines);
        self.at_mut(&copy).copy_from_slice(other.at(range));
        copy
    }

    pub(crate) fn give_back(&mut self, range: ArenaRange) {
        self.live -= range.cache_lines;
        self.garbage += range.cache_lines;
        if self.live == 0 {
            *self = Self::default();
        }
    }

    /// Replaces a range by one of `cache_lines` cache lines, possibly itself.
    pub(crate) fn exchange(&mut self, range: ArenaRange, cache_lines: usize) -> ArenaRange {
        if range.cache_lines == cache_lines {
            return range;
        }
        let other = self.take(cache_lines);
        self.give_back(range);
        other
    }

    pub(crate) fn at(&self, range: &ArenaRange) -> &[CacheLine] {
        if range.cache_lines == 0 {
            return &[];
        }
        &self.chunks[range.chunk].cache_lines()[range.first..][..range.cache_lines]
    }

    pub(crate) fn at_mut(&mut self, range: &ArenaRange) -> &mut [CacheLine] {
        if range.cache_lines == 0 {
            return &mut [];
        }
        &mut self.chunks[range.chunk].cache_lines_mut()[range.first..][..range.cache_lines]
    }

    /// Returns true if the freed cache lines exceed those in use by more than 1 MiB.
    pub(crate) const fn is_mostly_garbage(&self) -> bool {
        self.garbage > self.live + Self::FEW
    }

    fn cache_lines(&self) -> usize {
        self.chunks
            .iter()
            .map(|chunk| chunk.cache_lines().len())
            .sum()
    }
}

impl fmt::Debug for CubicArena {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut arena = formatter.debug_struct("CubicArena");
        arena
            .field("cache_lines", &self.cache_lines())
            .finish_non_exhaustive()
    }
}

impl Memory {
    /// Allocates at least this number of cache lines.
    fn with(cache_lines: usize) -> Self {
        if cache_lines < CubicArena::FEW {
            return Self::Few(vec![CacheLine::BLANK; cache_lines]);
        }
        let cache_lines = cache_lines.next_multiple_of(CubicArena::PAGE);
        match memmap2::MmapOptions::new()
            .len(cache_lines * size_of::<CacheLine>())
            .map_anon()
        {
            Ok(pages) => {
                // Where it is no use it does no harm.
                #[cfg(target_os = "linux")]
                let _ = pages.advise(memmap2::Advice::HugePage);
                Self::Pages(pages)
            }
            // There are systems without.
            Err(_) => Self::Few(vec![CacheLine::BLANK; cache_lines]),
        }
    }

    fn cache_lines(&self) -> &[CacheLine] {
        match self {
            Self::Few(cache_lines) => cache_lines,
            Self::Pages(pages) => cast_slice(pages),
        }
    }

    fn cache_lines_mut(&mut self) -> &mut [CacheLine] {
        match self {
            Self::Few(cache_lines) => cache_lines,
            Self::Pages(pages) => cast_slice_mut(pages),
        }
    }
}

#[cfg(test)]
mod tests;
