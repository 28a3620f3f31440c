//! Which pairs of bodies may meet in a slice of time.
//!
//! One contract, [`BroadPhase`]: the boxes of one slice in, pairs out. Every method gives at least
//! the pairs whose boxes meet; [`BruteForce`] gives exactly those and is what the others are
//! checked against. [`slices`] cuts the window and forms the boxes.

mod brute_force;
pub(crate) mod slices;
mod tree;

pub(crate) use brute_force::BruteForce;
pub(crate) use tree::Tree;

use parry3d::bounding_volume::Aabb;

/// How candidates are found. The answer is the same; the time is not.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Method {
    /// Every box against every other: quadratic, the reference.
    BruteForce,
    /// A parry3d bounding volume hierarchy, built for each slice.
    #[default]
    Tree,
}

impl Method {
    /// All methods.
    pub const EVERY: [Self; 2] = [Self::BruteForce, Self::Tree];
}

/// The box of one body in one slice, rounded outward. `body` is its place in the line-up.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BodyBox {
    pub(crate) aabb: Aabb,
    pub(crate) body: u32,
}

/// Two bodies whose boxes meet in a slice, by their places in the line-up, `a < b`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Candidate {
    pub(crate) a: u32,
    pub(crate) b: u32,
}

impl Candidate {
    /// The pair in its order.
    pub(crate) fn of(x: u32, y: u32) -> Self {
        Self {
            a: x.min(y),
            b: x.max(y),
        }
    }
}

/// Which pairs are wanted: layers and ignored pairs.
pub(crate) trait PairFilter: Sync {
    /// Whether this pair is screened; asked before a candidate is emitted.
    fn admits(&self, a: u32, b: u32) -> bool;
}

/// Admits every pair, at no cost.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Everyone;

impl PairFilter for Everyone {
    fn admits(&self, _: u32, _: u32) -> bool {
        true
    }
}

/// A way to find all pairs of boxes that meet. Holds scratch that is reused from slice to slice.
pub(crate) trait BroadPhase: Default + Send {
    /// Appends each admitted pair whose boxes meet (touching counts), once, in an order that
    /// depends on the boxes alone. More pairs than that are allowed, fewer are not.
    fn pairs<F: PairFilter>(
        &mut self,
        boxes: &[BodyBox],
        filter: &F,
        candidates: &mut Vec<Candidate>,
    );
}
