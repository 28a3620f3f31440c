//! temporary
pub(crate) mod slices;
use parry3d::bounding_volume::{Aabb, BoundingVolume};
/// t
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, Hash)]
pub enum Method {
    /// t
    #[default]
    BruteForce,
}
#[derive(Clone, Copy, Debug)]
pub struct BodyBox {
    pub aabb: Aabb,
    pub body: u32,
}
#[derive(Clone, Copy, Debug)]
pub struct Candidate {
    pub a: u32,
    pub b: u32,
}
pub trait PairFilter: Sync {
    fn admits(&self, a: u32, b: u32) -> bool;
}
pub trait BroadPhase: Default + Send {
    fn pairs<F: PairFilter>(
        &mut self,
        boxes: &[BodyBox],
        filter: &F,
        candidates: &mut Vec<Candidate>,
    );
}
pub struct Everyone;
impl PairFilter for Everyone {
    fn admits(&self, _: u32, _: u32) -> bool {
        true
    }
}
#[derive(Default)]
pub struct BruteForce;
impl BroadPhase for BruteForce {
    fn pairs<F: PairFilter>(
        &mut self,
        boxes: &[BodyBox],
        filter: &F,
        candidates: &mut Vec<Candidate>,
    ) {
        for (i, x) in boxes.iter().enumerate() {
            for y in &boxes[i + 1..] {
                if x.aabb.intersects(&y.aabb) && filter.admits(x.body, y.body) {
                    candidates.push(Candidate {
                        a: x.body,
                        b: y.body,
                    });
                }
            }
        }
    }
}
