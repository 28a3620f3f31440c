//! Search for the pairs of spheres that are the nearest ones at some time.
//!
//! All the time another pair may be nearer by more than the solver's rounding: such pairs are left out. What
//! remains suffices for contacts within any margin, and for the closest approach, in any window.

use super::candidates::{HALVINGS, SphereCandidate, find_nearest, remove_behind};
use super::near::{NearSpheres, Way};
use super::part::{Interval, PartScratch, SpheresOverPart};
use crate::narrow_phase::sphere_pair::SpherePair;

impl SpheresOverPart<'_> {
    /// Number of candidates from which on those that are always farther than others are removed before more are listed.
    /// Less in tests.
    const FULL: usize = if cfg!(test) { 8 } else { 1 << 16 };

    /// Calls `visit` with each pair of spheres that may come within `margin` and be the nearest one
    /// then, in the order of their numbers.
    pub(super) fn each_within(
        &self,
        margin: f64,
        scratch: &mut PartScratch,
        mut visit: impl FnMut(&SpherePair),
    ) {
        self.find_nearest(margin, scratch);
        for &spheres in &scratch.nearest {
            visit(&self.pair(spheres));
        }
    }

    /// Lists the pairs of spheres that may come within `margin` (m) and be the nearest ones then, sorted, each once.
    fn find_nearest(&self, margin: f64, scratch: &mut PartScratch) {
        let PartScratch {
            near,
            candidates,
            nearest,
            seen_motions,
            ..
        } = scratch;
        nearest.clear();
        let [first, deeper @ ..] = near;
        self.list_all(first);
        let lists = (candidates, &mut *nearest);
        self.find_nearest_over(&self.whole, margin, (first, deeper), lists);
        nearest.sort_unstable();
        nearest.dedup();
        if nearest.len() > 1 && !self.whole.turns() {
            seen_motions.clear();
            nearest.retain(|&spheres| seen_motions.insert(self.motion_key(spheres)));
        }
    }

    /// Appends the pairs of listed spheres that may come within `margin` (m) in an interval and be the nearest ones
    /// then, some several times.
    fn find_nearest_over(
        &self,
        interval: &Interval,
        margin: f64,
        (near, deeper): (&mut NearSpheres, &mut [NearSpheres]),
        (candidates, nearest): (&mut Vec<SphereCandidate>, &mut Vec<(u32, u32)>),
    ) {
        self.find_reaches(interval, near);
        near.remove_far(self.threshold(margin));
        if near.pairs() == 0 {
            return;
        }
        let slack = self.slack();
        let mut within = margin;
        if near.pairs() > Self::MANY {
            let facing = near.facing();
            let way = self.relative_way(interval, facing);
            let is_halved = way.length > Self::LONG && interval.is_divisible();
            let most = if is_halved {
                way.most
            } else {
                self.least_of_some(interval, near, facing.1, Way::separation_kept)
            };
            // Pairs that are always farther are not the nearest ones.
            within = within.min(most + slack);
            near.remove_far(self.threshold(within));
            if is_halved
                && near.pairs() > Self::MANY
                && let [next, deeper @ ..] = deeper
            {
                for number in [0, 1] {
                    next.listed.clone_from(&near.listed);
                    let lists = (&mut *candidates, &mut *nearest);
                    self.find_nearest_over(&interval.half(number), margin, (next, deeper), lists);
                }
                return;
            }
        }
        let bound = self.threshold(within);
        let slack = slack * self.power;
        candidates.clear();
        let mut room = Self::FULL;
        let mut list = |candidate| {
            if candidates.len() == room {
                remove_behind(candidates, 0, slack);
                room = Self::FULL.max(2 * candidates.len());
            }
            candidates.push(candidate);
        };
        self.each_candidate_in_halves(interval, (within, bound), (near, deeper), &mut list);
        find_nearest(candidates, 0, slack, HALVINGS, nearest);
    }

    /// Calls `visit` with candidates as [`each_candidate`](Self::each_candidate) does. If they are many, reaches in
    /// directions of their own tell apart those of halves.
    fn each_candidate_in_halves(
        &self,
        interval: &Interval,
        (margin, bound): (f64, f64),
        (near, deeper): (&mut NearSpheres, &mut [NearSpheres]),
        visit: &mut impl FnMut(SphereCandidate),
    ) {
        let [next, deeper @ ..] = deeper else {
            return self.each_candidate(interval, (margin, bound), near, visit);
        };
        if near.pairs() <= Self::CROWDED {
            return self.each_candidate(interval, (margin, bound), near, visit);
        }
        self.each_half(near, next, |half| {
            self.find_reaches(interval, half);
            half.remove_far(bound);
            self.each_candidate_in_halves(interval, (margin, bound), (half, deeper), visit);
        });
    }
}
