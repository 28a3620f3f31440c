//! Memory for the compact trajectories of a scene's bodies.
//!
//! A screening reads all of them, time and again, and they exceed every cache. So they are stored
//! contiguously, in large pages where the system has these.

use crate::bounds::CacheLine;
use bytemuck::{cast_slice, cast_slice_mut};
use memmap2::MmapMut;
use std::fmt;

/// An arena for compact trajectories: each is appended. Freed lines are reused only after all live
/// ones were [copied](Self::take_copy) to another arena.
#[derive(Default)]
pub(crate) struct CubicArena {
    chunks: Vec<Memory>,
    /// Lines of the last chunk that were never used.
    unused: usize,
    /// Lines of all ranges in use.
    live: usize,
    /// Lines that were freed.
    garbage: usize,
}

/// The lines of one compact trajectory.
#[derive(Debug, Default)]
pub(crate) struct ArenaRange {
    chunk: usize,
    first: usize,
    lines: usize,
}

/// A contiguous allocation of lines.
enum Memory {
    Few(Vec<CacheLine>),
    Pages(MmapMut),
}

impl CubicArena {
    /// Smallest chunk, 16 KiB: for a small scene.
    const FEWEST: usize = 1 << 8;
    /// 1 MiB: a chunk for more lines is allocated in large pages.
    const FEW: usize = 1 << 14;
    /// A large page, 2 MiB, on most systems.
    const PAGE: usize = 1 << 15;
    /// Chunks for more live lines than this are not larger, 32 MiB.
    const MANY: usize = 1 << 19;

    /// Allocates a range of lines with arbitrary content. One without lines is nowhere: it outlives all chunks.
    pub(crate) fn take(&mut self, lines: usize) -> ArenaRange {
        if lines == 0 {
            return ArenaRange::default();
        }
        if self.unused < lines || self.chunks.is_empty() {
            // Room for no fewer than are in use, unless these are many.
            let chunk = Memory::with(lines.max(self.live.clamp(Self::FEWEST, Self::MANY)));
            self.unused = chunk.lines().len();
            self.chunks.push(chunk);
        }
        let chunk = self.chunks.len() - 1;
        let first = self.chunks[chunk].lines().len() - self.unused;
        self.unused -= lines;
        self.live += lines;
        ArenaRange {
            chunk,
            first,
            lines,
        }
    }

    /// Allocates a range with a copy of another arena's range.
    pub(crate) fn take_copy(&mut self, other: &Self, range: &ArenaRange) -> ArenaRange {
        let copy = self.take(range.lines);
        self.at_mut(&copy).copy_from_slice(other.at(range));
        copy
    }

    pub(crate) fn give_back(&mut self, range: ArenaRange) {
        self.live -= range.lines;
        self.garbage += range.lines;
        if self.live == 0 {
            *self = Self::default();
        }
    }

    /// Replaces a range by one of `lines` lines, possibly itself.
    pub(crate) fn exchange(&mut self, range: ArenaRange, lines: usize) -> ArenaRange {
        if range.lines == lines {
            return range;
        }
        let other = self.take(lines);
        self.give_back(range);
        other
    }

    pub(crate) fn at(&self, range: &ArenaRange) -> &[CacheLine] {
        if range.lines == 0 {
            return &[];
        }
        &self.chunks[range.chunk].lines()[range.first..][..range.lines]
    }

    pub(crate) fn at_mut(&mut self, range: &ArenaRange) -> &mut [CacheLine] {
        if range.lines == 0 {
            return &mut [];
        }
        &mut self.chunks[range.chunk].lines_mut()[range.first..][..range.lines]
    }

    /// Returns true if more lines were freed than are in use, and more than 1 MiB.
    pub(crate) const fn is_mostly_garbage(&self) -> bool {
        self.garbage > self.live + Self::FEW
    }

    fn lines(&self) -> usize {
        self.chunks.iter().map(|chunk| chunk.lines().len()).sum()
    }
}

impl fmt::Debug for CubicArena {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut arena = formatter.debug_struct("CubicArena");
        arena.field("lines", &self.lines()).finish_non_exhaustive()
    }
}

impl Memory {
    /// Allocates at least this number of lines.
    fn with(lines: usize) -> Self {
        if lines < CubicArena::FEW {
            return Self::Few(vec![CacheLine::BLANK; lines]);
        }
        let lines = lines.next_multiple_of(CubicArena::PAGE);
        match memmap2::MmapOptions::new()
            .len(lines * size_of::<CacheLine>())
            .map_anon()
        {
            Ok(pages) => {
                // Where it is no use it does no harm.
                #[cfg(target_os = "linux")]
                let _ = pages.advise(memmap2::Advice::HugePage);
                Self::Pages(pages)
            }
            // There are systems without.
            Err(_) => Self::Few(vec![CacheLine::BLANK; lines]),
        }
    }

    fn lines(&self) -> &[CacheLine] {
        match self {
            Self::Few(lines) => lines,
            Self::Pages(pages) => cast_slice(pages),
        }
    }

    fn lines_mut(&mut self) -> &mut [CacheLine] {
        match self {
            Self::Few(lines) => lines,
            Self::Pages(pages) => cast_slice_mut(pages),
        }
    }
}

#[cfg(test)]
mod tests;
