//! Memory for the sketches of a scene's bodies.
//!
//! A screening reads all of them, time and again, and there is more of it than fits into any cache. So
//! they lie next to each other, in large pages where the system has these: looking up where 4 KiB
//! pages are took a tenth to a sixth of the time of a screening.
//!
//! What bodies leave behind serves others of about their size; when it gets more than what is in use, all
//! that is in use moves to new memory, and the old one goes back to the system. Not at once, which
//! would hold up a monitor's tick: a change moves a few times as much as it takes or gives back itself.

mod chunk;
#[cfg(test)]
mod tests;

use crate::bounds::Line;
use chunk::Chunk;
use std::collections::BTreeMap;
use std::fmt;

/// Blocks of lines, each for the sketch of one body, its owner.
///
/// Whoever [takes](Self::take) blocks and gives them back is to [move](Self::move_out) those that are
/// [to be moved](Self::next_to_move) afterwards.
#[derive(Default)]
pub(crate) struct Atlas {
    chunks: Vec<Chunk>,
    /// The chunk that blocks are cut from.
    open: usize,
    /// Lines of it that were never used.
    rest: usize,
    /// Blocks that are free, by their size.
    free: BTreeMap<usize, Vec<Block>>,
    /// Lines of those.
    idle: usize,
    /// Lines of all that are not free.
    used: usize,
    /// Where the next block that is to be moved is looked for, while there are chunks to leave.
    leaving: Option<Place>,
    /// Lines that are to be moved before the next change.
    due: usize,
}

/// Where a sketch is. Whoever has it is the only one, until it is given back.
#[derive(Debug)]
pub(crate) struct Block {
    place: Place,
    first: usize,
    lines: usize,
}

/// A block of a chunk, by numbers.
#[derive(Clone, Copy, Debug)]
struct Place {
    chunk: usize,
    block: usize,
}

impl Atlas {
    /// 1 MiB: so much may lie idle in a scene however small.
    const SPARE: usize = Chunk::FEW;

    /// Lines that are moved for each one that is taken or given back. Then no more than a quarter of
    /// what is in use is given back until all is moved.
    const PACE: usize = 4;

    /// A block of so many lines at least. What is drawn on it is of no interest.
    pub(crate) fn take(&mut self, lines: usize, owner: u32) -> Block {
        let lines = size_with_room_for(lines);
        self.used += lines;
        self.owe(lines);
        self.place(lines, owner)
    }

    /// Gives back a block that is no more used.
    pub(crate) fn give_back(&mut self, block: Block) {
        self.used -= block.lines;
        if self.used == 0 {
            *self = Self::default();
            return;
        }
        self.owe(block.lines);
        self.leave(block);
        if self.leaving.is_none() && self.idle > self.used + Self::SPARE {
            self.leave_all();
        }
    }

    /// A block of so many lines at least in place of another one: that one, if it has the size.
    pub(crate) fn exchange(&mut self, block: Block, lines: usize, owner: u32) -> Block {
        if block.lines == size_with_room_for(lines) {
            return block;
        }
        let other = self.take(lines, owner);
        self.give_back(block);
        other
    }

    pub(crate) fn at(&self, block: &Block) -> &[Line] {
        &self.chunks[block.place.chunk].lines()[block.first..][..block.lines]
    }

    pub(crate) fn at_mut(&mut self, block: &Block) -> &mut [Line] {
        &mut self.chunks[block.place.chunk].lines_mut()[block.first..][..block.lines]
    }

    /// Nothing is moved for the changes so far.
    pub(crate) const fn put_off_moves(&mut self) {
        self.due = 0;
    }

    /// Who has the next block that is to be moved now; none when it is enough for this time.
    pub(crate) fn next_to_move(&mut self) -> Option<u32> {
        while self.due > 0 {
            let place = self.leaving.as_mut()?;
            let Some(chunk) = self.chunks.get_mut(place.chunk) else {
                (self.leaving, self.due) = (None, 0);
                return None;
            };
            if chunk.is_left {
                let mut ahead = chunk.owners[place.block..].iter();
                let owner = ahead.find_map(|owner| *owner);
                place.block = chunk.owners.len() - ahead.len();
                if owner.is_some() {
                    return owner;
                }
                *chunk = Chunk::gone();
            }
            *place = Place {
                chunk: place.chunk + 1,
                block: 0,
            };
        }
        None
    }

    /// Moves an owner's block, with what is drawn on it, out of a chunk that is to be left.
    pub(crate) fn move_out(&mut self, block: &mut Block, owner: u32) {
        let other = self.place(block.lines, owner);
        // Another one: nothing is put into a chunk that is to be left.
        let mut to = std::mem::replace(&mut self.chunks[other.place.chunk], Chunk::gone());
        to.lines_mut()[other.first..][..block.lines].copy_from_slice(self.at(block));
        self.chunks[other.place.chunk] = to;
        self.due = self.due.saturating_sub(block.lines);
        self.leave(std::mem::replace(block, other));
    }

    /// A block of a size that there are blocks of.
    fn place(&mut self, lines: usize, owner: u32) -> Block {
        if let Some(block) = self.free.get_mut(&lines).and_then(Vec::pop) {
            self.idle -= lines;
            self.chunks[block.place.chunk].owners[block.place.block] = Some(owner);
            return block;
        }
        if self.rest < lines {
            self.open(Chunk::with(lines, self.used));
        }
        let chunk = &mut self.chunks[self.open];
        let place = Place {
            chunk: self.open,
            block: chunk.owners.len(),
        };
        chunk.owners.push(Some(owner));
        let first = chunk.lines().len() - self.rest;
        self.rest -= lines;
        Block {
            place,
            first,
            lines,
        }
    }

    /// Goes on with another chunk.
    fn open(&mut self, chunk: Chunk) {
        self.rest = chunk.lines().len();
        if let Some(place) = self.chunks.iter().position(Chunk::is_gone) {
            self.open = place;
            self.chunks[place] = chunk;
        } else {
            self.open = self.chunks.len();
            self.chunks.push(chunk);
        }
    }

    /// Makes a block free, if there is to be anything where it is.
    fn leave(&mut self, block: Block) {
        let chunk = &mut self.chunks[block.place.chunk];
        chunk.owners[block.place.block] = None;
        if !chunk.is_left {
            self.idle += block.lines;
            self.free.entry(block.lines).or_default().push(block);
        }
    }

    /// Begins to leave all chunks there are.
    fn leave_all(&mut self) {
        for chunk in &mut self.chunks {
            chunk.is_left = true;
        }
        self.free.clear();
        (self.idle, self.rest) = (0, 0);
        self.leaving = Some(Place { chunk: 0, block: 0 });
    }

    /// Lines were taken or given back: some are to be moved for it.
    const fn owe(&mut self, lines: usize) {
        if self.leaving.is_some() {
            self.due += Self::PACE * lines;
        }
    }

    /// All there are.
    fn lines(&self) -> usize {
        self.chunks.iter().map(|chunk| chunk.lines().len()).sum()
    }
}

impl fmt::Debug for Atlas {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut atlas = formatter.debug_struct("Atlas");
        atlas.field("lines", &self.lines()).finish_non_exhaustive()
    }
}

/// Sizes of blocks are so far apart that a sketch fills seven eighths of one at least; none is empty.
const fn size_with_room_for(lines: usize) -> usize {
    const EIGHTHS: u32 = 3;
    if lines == 0 {
        return 1;
    }
    if lines <= 1 << EIGHTHS {
        return lines;
    }
    let step = 1 << (lines.ilog2() - EIGHTHS);
    lines.next_multiple_of(step)
}
