//! Memory for the compact trajectories of a scene's bodies.
//!
//! A screening reads all of them, time and again, and there is more of it than fits into any cache. So
//! they lie next to each other, in large pages where the system has these.

use crate::bounds::Line;
use bytemuck::{cast_slice, cast_slice_mut};
use memmap2::MmapMut;
use std::fmt;

/// Lines for the compact trajectories of bodies: each compact trajectory is put behind the last one, and what is given back is
/// used again when all that is left is [copied](Self::take_copy) to another arena.
#[derive(Default)]
pub(crate) struct CubicArena {
    chunks: Vec<Memory>,
    /// Lines of the last chunk that were never used.
    rest: usize,
    /// Lines of all ranges that were taken, and not given back.
    live: usize,
    /// Lines that were given back.
    garbage: usize,
}

/// The lines of one compact trajectory.
#[derive(Debug)]
pub(crate) struct ArenaRange {
    chunk: usize,
    first: usize,
    lines: usize,
}

/// Lines that lie next to each other.
enum Memory {
    Few(Vec<Line>),
    Pages(MmapMut),
}

impl CubicArena {
    /// 16 KiB, for a small scene.
    const FEWEST: usize = 1 << 8;
    /// 1 MiB: an arena that needs more can spare a page.
    const FEW: usize = 1 << 14;
    /// A large page, 2 MiB, on most systems.
    const PAGE: usize = 1 << 15;
    /// 32 MiB.
    const MANY: usize = 1 << 19;

    /// Takes so many lines. What is on them is of no interest.
    pub(crate) fn take(&mut self, lines: usize) -> ArenaRange {
        if self.rest < lines || self.chunks.is_empty() {
            // Room for no fewer than are in use, unless these are many.
            let chunk = Memory::with(lines.max(self.live.clamp(Self::FEWEST, Self::MANY)));
            self.rest = chunk.lines().len();
            self.chunks.push(chunk);
        }
        let chunk = self.chunks.len() - 1;
        let first = self.chunks[chunk].lines().len() - self.rest;
        self.rest -= lines;
        self.live += lines;
        ArenaRange {
            chunk,
            first,
            lines,
        }
    }

    /// Takes lines with a copy of those of another arena.
    pub(crate) fn take_copy(&mut self, other: &Self, range: &ArenaRange) -> ArenaRange {
        let copy = self.take(range.lines);
        self.at_mut(&copy).copy_from_slice(other.at(range));
        copy
    }

    /// Gives back lines that are no more used.
    pub(crate) fn give_back(&mut self, range: ArenaRange) {
        self.live -= range.lines;
        self.garbage += range.lines;
        if self.live == 0 {
            *self = Self::default();
        }
    }

    /// Takes so many lines in place of others: those, if they are as many.
    pub(crate) fn exchange(&mut self, range: ArenaRange, lines: usize) -> ArenaRange {
        if range.lines == lines {
            return range;
        }
        let other = self.take(lines);
        self.give_back(range);
        other
    }

    pub(crate) fn at(&self, range: &ArenaRange) -> &[Line] {
        &self.chunks[range.chunk].lines()[range.first..][..range.lines]
    }

    pub(crate) fn at_mut(&mut self, range: &ArenaRange) -> &mut [Line] {
        &mut self.chunks[range.chunk].lines_mut()[range.first..][..range.lines]
    }

    /// Returns true if more was given back than is in use, and more than 1 MiB.
    pub(crate) const fn is_mostly_garbage(&self) -> bool {
        self.garbage > self.live + Self::FEW
    }

    /// All there are.
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
    /// Room for so many lines at least.
    fn with(lines: usize) -> Self {
        if lines < CubicArena::FEW {
            return Self::Few(vec![Line::BLANK; lines]);
        }
        let lines = lines.next_multiple_of(CubicArena::PAGE);
        match memmap2::MmapOptions::new()
            .len(lines * size_of::<Line>())
            .map_anon()
        {
            Ok(pages) => {
                // Where it is no use it does no harm.
                #[cfg(target_os = "linux")]
                let _ = pages.advise(memmap2::Advice::HugePage);
                Self::Pages(pages)
            }
            // There are systems without.
            Err(_) => Self::Few(vec![Line::BLANK; lines]),
        }
    }

    fn lines(&self) -> &[Line] {
        match self {
            Self::Few(lines) => lines,
            Self::Pages(pages) => cast_slice(pages),
        }
    }

    fn lines_mut(&mut self) -> &mut [Line] {
        match self {
            Self::Few(lines) => lines,
            Self::Pages(pages) => cast_slice_mut(pages),
        }
    }
}

#[cfg(test)]
mod tests;
