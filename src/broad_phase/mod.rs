//! Pairs of bodies that may be in contact in one time slice: boxes in, candidate pairs out.
//!
//! Three methods share one contract, [`BroadPhase`], and find the same pairs. [`Sweep`] is the
//! default. [`Tree`], parry's bounding volume hierarchy, is the reference for speed, [`BruteForce`]
//! for correctness. The crate cuts the window into slices and forms the boxes.

mod brute_force;
mod groups;
mod limit;
mod sweep;
mod tree;

use parry3d::bounding_volume::{Aabb, BoundingVolume};

pub use crate::simd::InstructionSet;
pub use brute_force::BruteForce;
pub use groups::Groups;
pub(crate) use limit::CandidateLimit;
pub use sweep::Sweep;
pub use tree::Tree;

/// A broad-phase method. All methods find the same pairs, at different speed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Method {
    /// Compares every box with every other: quadratic, the reference.
    BruteForce,
    /// A parry3d bounding volume hierarchy, built for each slice.
    Tree,
    /// The packed sweep.
    #[default]
    Sweep,
}

impl Method {
    /// All methods.
    pub const EVERY: [Self; 3] = [Self::BruteForce, Self::Tree, Self::Sweep];
}

/// A body's box in one slice: contains its hitbox, enlarged by half the margin, at each instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyBox {
    /// Corners, rounded outward. The origin lies near most bodies, and may move in the slice with their
    /// common velocity. The unit is the metre, or a power of two of metres. Corners are finite, the
    /// low one nowhere above the high one. The box may be flat, or as large as `f32` allows.
    pub aabb: Aabb,
    /// The box's place among those of the slice, or the body's slot in a monitor.
    pub body: u32,
}

impl BodyBox {
    /// Returns true if two boxes overlap; touching boxes do.
    #[must_use]
    #[inline]
    pub fn meets(&self, other: &Self) -> bool {
        self.aabb.intersects(&other.aabb)
    }
}

/// Two bodies whose boxes overlap in a slice.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Candidate {
    /// The body with the lower index.
    pub a: u32,
    /// The body with the higher index.
    pub b: u32,
}

impl Candidate {
    /// Returns the pair of two different bodies, in either order.
    #[must_use]
    #[inline]
    pub fn new(one: u32, other: u32) -> Self {
        debug_assert!(one != other, "a body is no candidate with itself");
        Self {
            a: one.min(other),
            b: one.max(other),
        }
    }
}

/// A filter of pairs. It is asked before a candidate is emitted, only for boxes that overlap.
pub trait PairFilter: Sync {
    /// Returns true if the pair of bodies `a < b` is wanted; the same answer each time.
    fn admits(&self, a: u32, b: u32) -> bool;

    /// Returns true if every pair is wanted: then none need be asked about.
    fn admits_all(&self) -> bool {
        false
    }

    /// Returns which groups of bodies may form pairs. Bodies of other groups are admitted in no pair: they need not be
    /// compared.
    #[inline]
    fn groups(&self) -> Groups {
        Groups::ONE
    }

    /// Returns the group of a body, less than the number of [groups](Self::groups).
    #[inline]
    fn group(&self, _: u32) -> u8 {
        0
    }

    /// Returns true once no further pair is wanted: there are too many, or nobody waits for the answer any more.
    /// Searches ask now and then, and end early, incomplete.
    fn gives_up(&self) -> bool {
        false
    }
}

/// The filter that admits every pair.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Everyone;

impl PairFilter for Everyone {
    fn admits(&self, _: u32, _: u32) -> bool {
        true
    }

    fn admits_all(&self) -> bool {
        true
    }
}

/// A method that finds all pairs of overlapping boxes. A value owns its buffers.
pub trait BroadPhase: Default + Send {
    /// Appends every admitted pair of bodies whose boxes overlap, each once and no other; fewer if
    /// the filter gives up.
    ///
    /// The order is unspecified, but depends on `boxes` and the groups of their bodies alone.
    fn pairs(
        &mut self,
        boxes: &[BodyBox],
        filter: &dyn PairFilter,
        candidates: &mut Vec<Candidate>,
    );
}

/// The methods with their buffers, for whoever takes one by name.
#[derive(Debug, Default)]
pub(crate) struct Methods {
    brute_force: BruteForce,
    tree: Tree,
    sweep: Sweep,
}

impl Methods {
    /// Appends the pairs that a method finds, as [`BroadPhase::pairs`] does.
    pub(crate) fn pairs(
        &mut self,
        (method, instructions): (Method, InstructionSet),
        boxes: &[BodyBox],
        filter: &dyn PairFilter,
        candidates: &mut Vec<Candidate>,
    ) {
        match method {
            Method::BruteForce => self.brute_force.pairs(boxes, filter, candidates),
            Method::Tree => self.tree.pairs(boxes, filter, candidates),
            Method::Sweep => self
                .sweep
                .set_instruction_set(instructions)
                .pairs(boxes, filter, candidates),
        }
    }
}

/// Appends the pair if the filter admits it.
#[inline]
fn emit(one: u32, other: u32, filter: &dyn PairFilter, candidates: &mut Vec<Candidate>) {
    let pair = Candidate::new(one, other);
    if filter.admits(pair.a, pair.b) {
        candidates.push(pair);
    }
}
