//! A branch and bound in time for the pairs of spheres that matter to a question.
//!
//! The pairs that are probably the nearest ones are solved first. What they prove bounds what others have to reach. An
//! interval with many pairs is halved: in a short time, distances of spheres along one direction tell most pairs apart.
//! Each pair is solved over the whole part.

use super::candidates::{SphereCandidate, remove_behind};
use super::near::NearSpheres;
use super::part::{Interval, Motion, PartScratch, SpheresOverPart};
use super::proven::{Piece, Pieces, ProvenContact, ProvenContacts};
use crate::narrow_phase::sphere_pair::SpherePair;
use crate::rounding::normalising_power;

/// What is asked about two bodies over a part of a span.
pub(super) trait Question {
    /// Appends the pieces of an interval (shares of the part) to an empty list, with what the pairs solved so far leave to
    /// be reached.
    fn list_pieces(&self, interval: (f64, f64), pieces: &mut Pieces);
    /// Solves a pair of spheres.
    fn solve(&mut self, pair: &SpherePair);
}

/// Asks for the pairs that may come nearer than `reached`, m; `solve` returns its new value.
pub(super) struct ClosestQuestion<F> {
    pub(super) reached: f64,
    pub(super) solve: F,
}

impl<F: FnMut(&SpherePair) -> f64> Question for ClosestQuestion<F> {
    fn list_pieces(&self, _: (f64, f64), pieces: &mut Pieces) {
        let bound = self.reached;
        pieces.push(Piece { end: 1.0, bound });
    }

    fn solve(&mut self, pair: &SpherePair) {
        self.reached = self.reached.min((self.solve)(pair));
    }
}

/// Asks for the pairs that begin or end a contact, or are the nearest ones in it; `solve` lists a pair's contacts.
pub(super) struct ContactsQuestion<'a, F> {
    pub(super) proven: ProvenContacts,
    pub(super) found: &'a mut Vec<ProvenContact>,
    pub(super) solve: F,
}

impl<F: FnMut(&SpherePair, &mut Vec<ProvenContact>)> Question for ContactsQuestion<'_, F> {
    fn list_pieces(&self, interval: (f64, f64), pieces: &mut Pieces) {
        self.proven.list_pieces(interval, pieces);
    }

    fn solve(&mut self, pair: &SpherePair) {
        self.found.clear();
        (self.solve)(pair, self.found);
        self.proven.learn(self.found);
    }
}

impl SpheresOverPart<'_> {
    /// Solves the pairs of spheres that may matter to a question, each once.
    pub(super) fn search(&self, question: &mut impl Question, scratch: &mut PartScratch) {
        let PartScratch {
            near,
            candidates,
            solved,
            ..
        } = scratch;
        solved.clear();
        let [first, deeper @ ..] = near;
        self.list_all(first);
        let mut search = Search {
            part: self,
            question,
            pieces: Pieces::new(),
            slack: self.slack(),
            candidates,
            solved,
        };
        search.search_over(&self.whole, f64::INFINITY, (first, deeper));
    }
}

/// A search in progress.
struct Search<'s, 'a, Q> {
    part: &'s SpheresOverPart<'a>,
    question: &'s mut Q,
    /// Pieces of the interval at hand.
    pieces: Pieces,
    /// Difference of separations below which it is not certain which pair of spheres is nearer, m.
    slack: f64,
    candidates: &'s mut Vec<SphereCandidate>,
    /// Pairs of spheres that are solved.
    solved: &'s mut Vec<(Motion, (u32, u32))>,
}

impl<Q: Question> Search<'_, '_, Q> {
    /// Largest number of candidates that are not compared with each other.
    const FEW: usize = 4;

    /// Solves the listed pairs that may matter in an interval, where some two spheres are never farther apart than
    /// `most`, m.
    fn search_over(
        &mut self,
        interval: &Interval,
        mut most: f64,
        (near, deeper): (&mut NearSpheres, &mut [NearSpheres]),
    ) {
        let part = self.part;
        if self.bound(interval) == f64::NEG_INFINITY || near.pairs() == 0 {
            return;
        }
        part.find_reaches(interval, near);
        let facing = near.facing();
        if self.bound(interval) == f64::INFINITY {
            self.solve_once(facing);
        }
        near.remove_far(part.threshold(self.bound(interval).min(most)));
        if near.pairs() > SpheresOverPart::MANY
            && let [next, deeper @ ..] = deeper
        {
            self.solve_once(facing);
            let (farthest, way) = part.most_and_way(interval, facing);
            // Pairs that are always farther are not the nearest ones.
            most = most.min(farthest + self.slack);
            near.remove_far(part.threshold(self.bound(interval).min(most)));
            if way > SpheresOverPart::LONG && interval.is_divisible() {
                for half in interval.nearer_first() {
                    next.listed.clone_from(&near.listed);
                    self.search_over(&half, most, (next, deeper));
                }
                return;
            }
            if near.pairs() > SpheresOverPart::CROWDED {
                part.each_half(near, next, |half| {
                    self.search_over(interval, most, (half, deeper));
                });
                return;
            }
        }
        let within = self.bound(interval).min(most);
        self.candidates.clear();
        part.each_candidate(interval, (within, part.threshold(within)), near, |one| {
            self.candidates.push(one);
        });
        self.solve_candidates(interval);
    }

    fn solve_candidates(&mut self, interval: &Interval) {
        let part = self.part;
        let power = normalising_power(part.scale);
        if self.candidates.len() > Self::FEW {
            remove_behind(self.candidates, 0, self.slack * power);
        }
        let nearest = self.candidates.iter().enumerate();
        let nearest = nearest.min_by(|(_, x), (_, y)| x.least().total_cmp(&y.least()));
        if let Some((first, _)) = nearest {
            self.candidates.swap(0, first);
        }
        let within = |bound: f64| (part.threshold(bound) + part.error) * power;
        let mut bound = self.bound(interval);
        for place in 0..self.candidates.len() {
            let candidate = &self.candidates[place];
            if candidate.least() <= within(bound)
                && candidate.comes_within(&self.pieces, within)
                && self.solve_once(candidate.spheres)
            {
                bound = self.bound(interval);
            }
        }
    }

    /// Lists the pieces of an interval, and returns the largest of their bounds, m.
    fn bound(&mut self, interval: &Interval) -> f64 {
        self.pieces.clear();
        self.question.list_pieces(interval.ends, &mut self.pieces);
        let bounds = self.pieces.iter().map(|piece| piece.bound);
        bounds.fold(f64::NEG_INFINITY, f64::max)
    }

    /// Solves two spheres, unless they or first ones with the same motion are solved. Returns true if it did. Of ties, the
    /// first spheres are reported.
    fn solve_once(&mut self, spheres: (u32, u32)) -> bool {
        let motion = self.part.motion_of(spheres);
        let mut solved = self.solved.iter();
        let is_new = !solved.any(|&(other, first)| other == motion && first <= spheres);
        if is_new {
            self.solved.push((motion, spheres));
            self.question.solve(&self.part.pair(spheres));
        }
        is_new
    }
}
