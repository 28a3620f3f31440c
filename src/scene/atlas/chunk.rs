//! Memory from the system, and whose blocks of it are whose.

use crate::bounds::Line;
use bytemuck::{cast_slice, cast_slice_mut};
use memmap2::MmapMut;

/// Lines, cut into blocks from the first one on.
pub(super) struct Chunk {
    memory: Memory,
    /// Of each block that was cut, in the order of their lines, the body that has it.
    pub(super) owners: Vec<Option<u32>>,
    /// Whether nothing more is put here, and what is here is to be moved.
    pub(super) is_left: bool,
}

enum Memory {
    Few(Vec<Line>),
    Pages(MmapMut),
}

impl Chunk {
    /// 16 KiB, for a small scene.
    const FEWEST: usize = 1 << 8;
    /// 1 MiB: whoever needs more can spare a page.
    pub(super) const FEW: usize = 1 << 14;
    /// A large page, 2 MiB, on most systems.
    const PAGE: usize = 1 << 15;
    /// 32 MiB.
    pub(super) const MANY: usize = 1 << 19;

    /// With room for so many lines, and for no fewer than are `used` in all, unless these are many.
    pub(super) fn with(lines: usize, used: usize) -> Self {
        let lines = lines.max(used.clamp(Self::FEWEST, Self::MANY));
        Self::holding(Memory::with(lines))
    }

    /// In place of one that was given back to the system.
    pub(super) const fn gone() -> Self {
        Self::holding(Memory::Few(Vec::new()))
    }

    const fn holding(memory: Memory) -> Self {
        Self {
            memory,
            owners: Vec::new(),
            is_left: false,
        }
    }

    pub(super) fn is_gone(&self) -> bool {
        self.lines().is_empty()
    }

    pub(super) fn lines(&self) -> &[Line] {
        match &self.memory {
            Memory::Few(lines) => lines,
            Memory::Pages(pages) => cast_slice(pages),
        }
    }

    pub(super) fn lines_mut(&mut self) -> &mut [Line] {
        match &mut self.memory {
            Memory::Few(lines) => lines,
            Memory::Pages(pages) => cast_slice_mut(pages),
        }
    }
}

impl Memory {
    /// Room for so many lines at least.
    fn with(lines: usize) -> Self {
        if lines < Chunk::FEW {
            return Self::Few(vec![Line::BLANK; lines]);
        }
        let lines = lines.next_multiple_of(Chunk::PAGE);
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
}
