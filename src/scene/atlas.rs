//! Memory for the sketches of a scene's bodies.
//!
//! A screening reads all of them, time and again, and there is more of it than fits into any cache. So
//! they lie next to each other, in large pages where the system has these: looking up where 4 KiB
//! pages are took a tenth to a sixth of the time of a screening.

use crate::bounds::Line;
use bytemuck::{cast_slice, cast_slice_mut};
use memmap2::MmapMut;
use std::collections::BTreeMap;
use std::fmt;

/// Blocks of lines, each for the sketch of one body. What a body leaves behind serves the next one of
/// about its size.
#[derive(Default)]
pub(crate) struct Atlas {
    chunks: Vec<Chunk>,
    /// Lines of the last chunk that were never used.
    rest: usize,
    /// Blocks that are free, by their size.
    free: BTreeMap<usize, Vec<Block>>,
    /// How many blocks are not.
    used: usize,
}

/// Where a sketch is. Whoever has it is the only one, until it is given back.
#[derive(Debug)]
pub(crate) struct Block {
    chunk: usize,
    first: usize,
    lines: usize,
}

/// Memory from the system.
enum Chunk {
    Few(Vec<Line>),
    Pages(MmapMut),
}

impl Atlas {
    /// A block of so many lines at least. What is drawn on it is of no interest.
    pub(crate) fn take(&mut self, lines: usize) -> Block {
        let lines = size_with_room_for(lines);
        self.used += 1;
        if let Some(block) = self.free.get_mut(&lines).and_then(Vec::pop) {
            return block;
        }
        if self.rest < lines {
            let chunk = Chunk::with(lines, self.lines());
            self.rest = chunk.lines().len();
            self.chunks.push(chunk);
        }
        let chunk = self.chunks.len() - 1;
        let first = self.chunks[chunk].lines().len() - self.rest;
        self.rest -= lines;
        Block {
            chunk,
            first,
            lines,
        }
    }

    /// Gives back a block that is no more used.
    pub(crate) fn give_back(&mut self, block: Block) {
        self.used -= 1;
        if self.used == 0 {
            *self = Self::default();
        } else {
            self.free.entry(block.lines).or_default().push(block);
        }
    }

    /// A block of so many lines at least in place of another one: that one, if it has the size.
    pub(crate) fn exchange(&mut self, block: Block, lines: usize) -> Block {
        if block.lines == size_with_room_for(lines) {
            return block;
        }
        let other = self.take(lines);
        self.give_back(block);
        other
    }

    pub(crate) fn at(&self, block: &Block) -> &[Line] {
        &self.chunks[block.chunk].lines()[block.first..][..block.lines]
    }

    pub(crate) fn at_mut(&mut self, block: &Block) -> &mut [Line] {
        &mut self.chunks[block.chunk].lines_mut()[block.first..][..block.lines]
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

impl Chunk {
    /// 16 KiB, for a small scene.
    const FEWEST: usize = 1 << 8;
    /// 1 MiB: whoever needs more can spare a page.
    const FEW: usize = 1 << 14;
    /// A large page, 2 MiB, on most systems.
    const PAGE: usize = 1 << 15;
    /// 32 MiB.
    const MANY: usize = 1 << 19;

    /// With room for so many lines, and for no fewer than there `are` in all so far, unless these are
    /// many.
    fn with(lines: usize, are: usize) -> Self {
        let lines = lines.max(are.clamp(Self::FEWEST, Self::MANY));
        if lines < Self::FEW {
            return Self::Few(vec![Line::BLANK; lines]);
        }
        let lines = lines.next_multiple_of(Self::PAGE);
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
mod tests {
    use super::{Atlas, Block, Chunk, size_with_room_for};
    use crate::bounds::Line;
    use crate::scene::{Body, Scene};
    use crate::trajectory::{State, Trajectory};
    use glam::DVec3;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    #[test]
    fn sketches_fill_most_of_their_blocks() {
        assert_eq!(size_with_room_for(0), 1);
        for lines in 1..100_000 {
            let size = size_with_room_for(lines);
            assert!(lines <= size && 7 * size <= 8 * lines, "{lines} {size}");
            assert_eq!(size, size_with_room_for(size));
        }
    }

    /// Whatever is taken and given back, no two blocks overlap; and memory does not grow for ever.
    #[test]
    fn blocks_keep_what_is_drawn_on_them() {
        let mut rng = ChaCha8Rng::seed_from_u64(12);
        let mut atlas = Atlas::default();
        // The very first one may be for nothing.
        let nothing = atlas.take(0);
        atlas.give_back(nothing);
        let mut taken: Vec<(Block, f64)> = Vec::new();
        let mut peak = 0;
        for round in 0..150_000_u32 {
            // More and more of all sizes, then no more than that.
            let most = (round / 20).min(1_000) as usize;
            while taken.len() > most {
                let (block, mark) = taken.swap_remove(rng.random_range(0..taken.len()));
                assert!(is_marked(&atlas, &block, mark), "{block:?} {mark}");
                atlas.give_back(block);
            }
            let lines = if rng.random_bool(0.01) {
                rng.random_range(0..3_000)
            } else {
                rng.random_range(0..60)
            };
            let block = if rng.random_bool(0.5) && !taken.is_empty() {
                let (block, mark) = taken.swap_remove(rng.random_range(0..taken.len()));
                assert!(is_marked(&atlas, &block, mark), "{block:?} {mark}");
                atlas.exchange(block, lines)
            } else {
                atlas.take(lines)
            };
            let mark = f64::from(round);
            assert!(atlas.at(&block).len() >= lines);
            atlas.at_mut(&block).fill(bytemuck::cast([mark; 8]));
            taken.push((block, mark));
            if round == 30_000 {
                peak = atlas.lines();
            }
        }
        assert!(
            atlas
                .chunks
                .iter()
                .any(|chunk| matches!(chunk, Chunk::Pages(_)))
        );
        assert!(atlas.lines() <= 2 * peak, "{} {peak}", atlas.lines());
        for (block, mark) in taken.drain(..) {
            assert!(is_marked(&atlas, &block, mark), "{block:?} {mark}");
            atlas.give_back(block);
        }
        assert!(atlas.chunks.is_empty() && atlas.free.is_empty());
    }

    /// Whatever becomes of its bodies, a scene keeps no memory for more than were there at a time.
    #[test]
    fn bodies_that_are_gone_leave_their_blocks() {
        let straight = |cubics: u32| {
            let states = (0..=cubics)
                .map(|k| State::new(f64::from(k), DVec3::X * f64::from(k), DVec3::X))
                .collect::<Vec<_>>();
            Trajectory::from_states(&states).unwrap_or_else(|error| unreachable!("{error}"))
        };
        let mut scene = Scene::new();
        let insert = |scene: &mut Scene, plan| scene.insert(Body::new(plan));
        let mut ids: Vec<_> = (0..100)
            .filter_map(|k| insert(&mut scene, straight(1 + k % 40)).ok())
            .collect();
        let before = scene.atlas().lines();
        for round in 0..20_000 {
            let place = round % ids.len();
            // Those of a size are as many as before.
            let Some(plan) = scene.body(ids[place]).map(|body| body.trajectory.clone()) else {
                unreachable!("it was not removed")
            };
            let changed = match round % 3 {
                0 => scene.remove(ids[place]).and_then(|_| {
                    ids[place] = insert(&mut scene, plan)?;
                    Ok(())
                }),
                1 => scene.set_trajectory(ids[place], plan).map(drop),
                // Sketched while the scene is being read, and then as it was put in.
                _ => scene
                    .swap_trajectory(ids[place], &mut plan.clone())
                    .map(|occupant| occupant.outline().path)
                    .and_then(|_| scene.set_trajectory(ids[place], plan).map(drop)),
            };
            assert_eq!(changed, Ok(()));
        }
        assert_eq!(scene.atlas().lines(), before);
        for id in ids {
            assert!(scene.remove(id).is_ok());
        }
        assert_eq!(scene.atlas().lines(), 0);
    }

    fn is_marked(atlas: &Atlas, block: &Block, mark: f64) -> bool {
        let knots: &[f64] = bytemuck::cast_slice::<Line, f64>(atlas.at(block));
        knots.iter().all(|knot| knot.to_bits() == mark.to_bits())
    }
}
