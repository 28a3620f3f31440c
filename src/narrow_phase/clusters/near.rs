//! Lists of the spheres of two bodies that may be near the other body.

use crate::narrow_phase::sphere_pair::farthest;
use glam::DVec3;

/// The spheres of two bodies that may be near the other body in an interval.
#[derive(Debug, Default)]
pub(super) struct NearSpheres {
    pub(super) listed: [Vec<ListedSphere>; 2],
    /// Control points of b's in the unit of lengths.
    pub(super) points_b: Vec<[DVec3; 4]>,
}

/// A sphere that may be near the other body in an interval.
#[derive(Clone, Copy, Debug)]
pub(super) struct ListedSphere {
    pub(super) number: u32,
    /// Reach along a direction, m: see [`SpheresOverPart::find_reaches`](super::part::SpheresOverPart::find_reaches).
    pub(super) reach: f64,
}

impl NearSpheres {
    /// Returns two spheres that reach far towards each other's bodies: probably among the nearest.
    pub(super) fn facing(&self) -> (u32, u32) {
        let [a, b] = &self.listed;
        let toward_b = farthest(a.iter().map(|one| -one.reach)) as usize;
        let toward_a = farthest(b.iter().map(|one| one.reach)) as usize;
        (a[toward_b].number, b[toward_a].number)
    }

    /// Returns the number of pairs.
    pub(super) fn pairs(&self) -> usize {
        self.listed[0].len() * self.listed[1].len()
    }

    /// Removes the spheres that are farther than `bound` (m) from all of the other body's.
    pub(super) fn remove_far(&mut self, bound: f64) {
        let [a, b] = &mut self.listed;
        let nearest = a.iter().map(|one| one.reach).fold(f64::INFINITY, f64::min);
        let farthest = b
            .iter()
            .map(|one| one.reach)
            .fold(f64::NEG_INFINITY, f64::max);
        retain(a, |one| one.reach - farthest <= bound);
        retain(b, |one| nearest - one.reach <= bound);
    }
}

/// Puts one half of a list before the other one, neighbours into the same half, and returns both.
pub(super) fn divide(
    list: &mut [ListedSphere],
    offset: impl Fn(&ListedSphere) -> DVec3,
) -> [&[ListedSphere]; 2] {
    let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for one in &*list {
        let offset = offset(one);
        (low, high) = (low.min(offset), high.max(offset));
    }
    let axis = (high - low).max_position();
    let half = list.len() / 2;
    list.select_nth_unstable_by(half, |x, y| offset(x)[axis].total_cmp(&offset(y)[axis]));
    let (first, second) = list.split_at(half);
    [first, second]
}

/// Keeps the members of a list that a test holds for, without a branch: the processor cannot predict it.
fn retain(list: &mut Vec<ListedSphere>, is_kept: impl Fn(&ListedSphere) -> bool) {
    let mut kept = 0;
    for place in 0..list.len() {
        let one = list[place];
        list[kept] = one;
        kept += usize::from(is_kept(&one));
    }
    list.truncate(kept);
}
