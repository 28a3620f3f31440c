//! Selection of the pairs of spheres that matter, for two clusters over a span.
//!
//! All pairs share one relative motion, each with an offset of its own. Most near pairs neither
//! begin nor end a contact, nor are they ever the nearest ones, and need not be solved:
//! - Chords of the motion give a lower bound of each pair's separation.
//! - A solved pair proves times within the margin, and a separation. Another pair matters only if
//!   it may be within the margin at another time, or be nearer.
//! - Before and after a contact the bodies are apart in the direction of the contact, which
//!   excludes most pairs. The two spheres that reach farthest in it (as in GJK's support mapping)
//!   are solved first, since they probably touch earlier, or later.
//!
//! A monitor does not know window and margin yet. It needs all pairs that are the nearest ones at some time, and finds them
//! as for bodies that turn.
//!
//! Each test excludes a pair only if that is certain, by more than the solver's rounding. So the
//! reported values have the same bits as if every pair was solved.

mod chords;
mod groups;
mod proven_intervals;
mod sphere_pairs;
#[cfg(test)]
mod tests;

use super::sphere_pair::SpherePair;
use crate::count::short;
use chords::PiecewiseLinearBound;
use groups::SphereGroups;
use proven_intervals::ProvenIntervals;
use sphere_pairs::SpherePairBound;
pub(super) use sphere_pairs::{ClusterPair, ProvenContact};
use std::collections::HashMap;

impl ClusterPair<'_> {
    /// Largest number of pairs of spheres of which all are solved: nothing else would be faster.
    const FEW: usize = 9;

    /// Solves the pairs of spheres that matter for contacts within `margin` in `clip`. If asked to,
    /// `solve` returns the contacts of each.
    pub(super) fn each_for_contacts(
        &self,
        margin: f64,
        clip: (f64, f64),
        mut solve: impl FnMut(&SpherePair, Option<&mut Vec<ProvenContact>>),
    ) {
        let part = self.part(clip);
        if part.0 > part.1 {
            return;
        }
        if self.are_few() {
            return self.each_within(margin, |pair| solve(pair, None));
        }
        let mut proven_contacts = Vec::new();
        let chords = PiecewiseLinearBound::of(self, part, margin);
        let mut proven = ProvenIntervals::new(self, part, margin, chords.slack);
        let mut solved = SolvedOffsets::default();
        let mut solve = |candidate: &SpherePairBound,
                         proven: &mut ProvenIntervals<'_>,
                         solved: &mut SolvedOffsets| {
            solved.add(self, candidate);
            let pair = self.pair(candidate);
            if !self.is_beyond(&pair.cubic.points, candidate, margin) {
                proven_contacts.clear();
                solve(&pair, proven.can_learn().then_some(&mut proven_contacts));
                proven.learn(&proven_contacts, self.offset(candidate));
            }
        };
        let margin = self.reached(&chords, margin);
        let groups = SphereGroups::of(self, &chords, margin);
        let (mut listed, mut candidates) = (0, Vec::new());
        while listed < self.a.spheres.len() {
            groups.list((self, &chords), margin, &mut listed, &mut candidates);
            let mut next = nearest(&candidates);
            if let Some(nearest) = next {
                proven.look(chords.nearest_point(self.offset(nearest)));
            }
            let mut others = candidates.iter();
            while let Some(candidate) = next {
                solve(candidate, &mut proven, &mut solved);
                while let Some(support) = proven.support() {
                    let found = candidates.iter().find(|one| (one.a, one.b) == support);
                    if let Some(candidate) = found.filter(|one| !solved.holds(self, one)) {
                        solve(candidate, &mut proven, &mut solved);
                    }
                }
                next = others.find(|other| proven.may_matter(other) && !solved.holds(self, other));
            }
        }
    }

    /// Solves the pairs of spheres that may come nearer in `clip` than `least_so_far` (m); `solve`
    /// returns the new value of `least_so_far`.
    pub(super) fn each_for_nearest(
        &self,
        clip: (f64, f64),
        mut least_so_far: f64,
        mut solve: impl FnMut(&SpherePair) -> f64,
    ) {
        let chords = PiecewiseLinearBound::of(self, self.part(clip), 0.0);
        let mut solved = SolvedOffsets::default();
        let within = self.reached(&chords, least_so_far.min(chords.least_of_some(self)));
        let groups = SphereGroups::of(self, &chords, within);
        let (mut listed, mut candidates) = (0, Vec::new());
        while listed < self.a.spheres.len() {
            groups.list((self, &chords), within, &mut listed, &mut candidates);
            for candidate in nearest(&candidates).into_iter().chain(&candidates) {
                let near = least_so_far + chords.slack;
                if candidate.low > near || solved.holds(self, candidate) {
                    continue;
                }
                let pair = self.pair(candidate);
                let points = &pair.cubic.points;
                if near < f64::INFINITY && self.is_beyond(points, candidate, near) {
                    continue;
                }
                least_so_far = solve(&pair);
                solved.add(self, candidate);
            }
        }
    }

    /// Returns a margin, or less if pairs of spheres are the nearest ones of their bodies only within that.
    ///
    /// With a large model error all pairs are within the margin, and hardly any contact is certain.
    fn reached(&self, chords: &PiecewiseLinearBound, margin: f64) -> f64 {
        if self.a.model_error_with(self.b) > 0.0 {
            margin.min(chords.most(self))
        } else {
            margin
        }
    }

    fn are_few(&self) -> bool {
        self.a.spheres.len() * self.b.spheres.len() <= Self::FEW
    }

    fn each_within(&self, margin: f64, mut solve: impl FnMut(&SpherePair)) {
        for a in 0..self.a.spheres.len() {
            for b in 0..self.b.spheres.len() {
                let candidate = SpherePairBound {
                    a: short(a),
                    b: short(b),
                    low: f64::NEG_INFINITY,
                };
                let pair = self.pair(&candidate);
                if !self.is_beyond(&pair.cubic.points, &candidate, margin) {
                    solve(&pair);
                }
            }
        }
    }
}

/// The motions of the pairs of spheres that were solved.
#[derive(Default)]
struct SolvedOffsets(HashMap<OffsetKey, (u32, u32)>);

/// Offset and radii of two spheres, as bits.
type OffsetKey = ([u64; 3], [u64; 2]);

impl SolvedOffsets {
    fn motion(clusters: &ClusterPair<'_>, candidate: &SpherePairBound) -> OffsetKey {
        let (a, b) = clusters.spheres(candidate);
        // Of two zeros, one.
        let offset = (clusters.offset(candidate) + 0.0).to_array();
        (
            offset.map(f64::to_bits),
            [a.radius, b.radius].map(f64::to_bits),
        )
    }

    fn add(&mut self, clusters: &ClusterPair<'_>, candidate: &SpherePairBound) {
        let numbers = (candidate.a, candidate.b);
        let first = self.0.entry(Self::motion(clusters, candidate));
        let first = first.or_insert(numbers);
        *first = numbers.min(*first);
    }

    /// Returns true if a pair was solved, or moves exactly as a solved pair with smaller numbers,
    /// which is reported in a tie.
    fn holds(&self, clusters: &ClusterPair<'_>, candidate: &SpherePairBound) -> bool {
        let first = self.0.get(&Self::motion(clusters, candidate));
        first.is_some_and(|&first| first <= (candidate.a, candidate.b))
    }
}

fn nearest(candidates: &[SpherePairBound]) -> Option<&SpherePairBound> {
    candidates.iter().min_by(|x, y| x.low.total_cmp(&y.low))
}
