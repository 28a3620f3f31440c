//! Balls that a cover does not need.

use super::cells::{CellScratch, Share};
use super::certificate::{Certified, spare, weighted};
use super::solid::Solid;
use super::surface::Surface;
use crate::parallel;
use glam::DVec3;

/// Balls by which surfaces are divided, and what is known of them.
struct Division<'a> {
    surfaces: &'a [Surface],
    balls: Vec<(DVec3, f64)>,
    /// Upper bounds of the signed distances of the centres.
    heights: Vec<f64>,
    spare: f64,
}

/// Returns a cover without balls that can go: the others reach out no farther than all balls did before. Small balls go
/// first.
pub(super) fn without_needless(
    solid: &Solid,
    surfaces: &[Surface],
    certified: Certified,
) -> Certified {
    let centres: Vec<DVec3> = certified.balls.iter().map(|&(centre, _)| centre).collect();
    let heights = solid.certain_distances(&centres);
    let division = Division {
        surfaces,
        balls: weighted(&centres, &heights, certified.expected),
        heights,
        spare: spare(solid),
    };
    let count = certified.balls.len();
    let mut shares = parallel::map(count, CellScratch::default, |scratch, ball| {
        scratch.share(surfaces, ball, &division.balls, |_| false)
    });
    let limit = certified.overshoot;
    let can_go = parallel::map(count, CellScratch::default, |scratch, ball| {
        let without = |other| other == ball;
        division
            .shares_without(scratch, &shares, ball, without, limit)
            .is_some()
    });
    let mut order: Vec<usize> = (0..count).filter(|&ball| can_go[ball]).collect();
    order.sort_by(|&a, &b| certified.balls[a].1.total_cmp(&certified.balls[b].1));
    let (mut gone, mut left) = (vec![false; count], count);
    let mut scratch = CellScratch::default();
    for ball in order {
        // Nothing remains that the share of the last ball could go to.
        if left == 1 {
            break;
        }
        let without = |other: usize| other == ball || gone[other];
        let found = division.shares_without(&mut scratch, &shares, ball, without, limit);
        for (other, share) in found.iter().flatten() {
            shares[*other] = share.clone();
        }
        if found.is_some() {
            (gone[ball], left) = (true, left - 1);
        }
    }
    let mut kept = Certified {
        balls: Vec::new(),
        overshoot: f64::NEG_INFINITY,
        ..certified
    };
    for ball in (0..count).filter(|&ball| !gone[ball]) {
        if let Some(needed) = shares[ball].needed() {
            let radius = needed + division.spare;
            kept.balls.push((division.balls[ball].0, radius));
            kept.overshoot = kept.overshoot.max(radius + division.heights[ball]);
        }
    }
    if kept.balls.len() < count && kept.overshoot <= limit {
        kept
    } else {
        certified
    }
}

impl Division<'_> {
    /// Returns the shares that are larger without a ball, and without others that have gone; `None` if a ball would
    /// reach out farther than the limit.
    fn shares_without(
        &self,
        scratch: &mut CellScratch,
        shares: &[Share],
        ball: usize,
        is_absent: impl Fn(usize) -> bool + Copy,
        limit: f64,
    ) -> Option<Vec<(usize, Share)>> {
        let is_larger = |&other: &usize| !is_absent(other) && shares[other].cut_by.contains(&ball);
        let larger = (0..shares.len()).filter(is_larger);
        let larger = larger.map(|other| {
            let share = scratch.share(self.surfaces, other, &self.balls, is_absent);
            let reach = |needed: f64| needed + self.spare + self.heights[other];
            let is_within = share.needed().is_none_or(|needed| reach(needed) <= limit);
            is_within.then_some((other, share))
        });
        larger.collect()
    }
}
