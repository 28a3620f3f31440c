//! A branch and bound in time for the pairs of spheres that matter to a question.
//!
//! The pairs that are probably the nearest ones are solved first. What they prove bounds what others have to reach. An
//! interval with many pairs is halved: in a short time, distances of spheres along one direction tell most pairs apart.
//! Each pair is solved over the whole part.

use super::candidates::{SphereCandidate, remove_behind};
use super::near::{NearSpheres, Way};
use super::part::{Interval, MotionKey, PartScratch, SpheresOverPart};
use super::proven::{BoundedPiece, Pieces, ProvenContact, ProvenContacts};
use crate::narrow_phase::sphere_pair::SpherePair;
use crate::narrow_phase::widened;

/// A question about two bodies over a part of a span.
pub(super) trait Question {
    /// Appends the pieces of an interval (shares of the part) to an empty list, with what the pairs solved so far leave to
    /// be reached.
    fn list_pieces(&self, interval: (f64, f64), pieces: &mut Pieces);
    /// Solves a pair of spheres.
    fn solve(&mut self, pair: &SpherePair);
    /// Notes that two spheres come as near as this at some time of the part, m. Returns false if that tells nothing.
    fn note_upper_bound(&mut self, separation: f64) -> bool;
}

/// Asks for the pairs that may come nearer than `reached`, m; `solve` returns its new value.
pub(super) struct ClosestQuestion<F> {
    pub(super) reached: f64,
    /// True if the window contains the part.
    pub(super) is_whole: bool,
    /// Sum of the bodies' model errors, m.
    pub(super) model_error: f64,
    pub(super) solve: F,
}

impl<F: FnMut(&SpherePair) -> f64> Question for ClosestQuestion<F> {
    fn list_pieces(&self, _: (f64, f64), pieces: &mut Pieces) {
        let bound = self.reached;
        pieces.push(BoundedPiece { end: 1.0, bound });
    }

    fn solve(&mut self, pair: &SpherePair) {
        self.reached = self.reached.min((self.solve)(pair));
    }

    fn note_upper_bound(&mut self, separation: f64) -> bool {
        if self.is_whole {
            // The error counts twice: the nearest spheres may be farther apart by it, and others nearer by it.
            let reached = widened(widened(separation, self.model_error), self.model_error);
            self.reached = self.reached.min(reached);
        }
        self.is_whole
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

    fn note_upper_bound(&mut self, _: f64) -> bool {
        false
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
    solved: &'s mut Vec<(MotionKey, (u32, u32))>,
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
            let least = part.least_of_some(interval, near, facing.1, Way::separation_reached);
            if !self.question.note_upper_bound(least + self.slack) {
                self.solve_if_near(interval, &part.candidate(interval, facing));
            }
        }
        near.remove_far(part.threshold(self.bound(interval).min(most)));
        if near.pairs() > SpheresOverPart::MANY
            && let [next, deeper @ ..] = deeper
        {
            let way = part.relative_way(interval, facing);
            let mut is_crowded = near.pairs() > SpheresOverPart::CROWDED;
            let is_long = way.bend > SpheresOverPart::BENT
                || is_crowded && way.length > SpheresOverPart::LONG;
            let is_halved = is_long && interval.is_divisible();
            if is_halved || is_crowded {
                self.solve_if_near(interval, &part.candidate(interval, facing));
                // Pairs that are always farther are not the nearest ones.
                most = most.min(way.most + self.slack);
                near.remove_far(part.threshold(self.bound(interval).min(most)));
                is_crowded = near.pairs() > SpheresOverPart::CROWDED;
            }
            if is_halved {
                for number in interval.nearer_first() {
                    next.listed.clone_from(&near.listed);
                    self.search_over(&interval.half(number), most, (next, deeper));
                }
                return;
            }
            if is_crowded {
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
        let power = part.power;
        if self.candidates.len() > Self::FEW {
            remove_behind(self.candidates, 0, self.slack * power);
        }
        let nearest = self.candidates.iter().enumerate();
        let nearest = nearest.min_by(|(_, x), (_, y)| x.least().total_cmp(&y.least()));
        if let Some((first, _)) = nearest {
            self.candidates.swap(0, first);
        }
        for place in 0..self.candidates.len() {
            let candidate = self.candidates[place];
            self.solve_if_near(interval, &candidate);
        }
    }

    /// Solves a pair of spheres if it may matter in an interval.
    fn solve_if_near(&mut self, interval: &Interval, candidate: &SphereCandidate) {
        let part = self.part;
        let power = part.power;
        let within = |bound: f64| (part.threshold(bound) + part.error) * power;
        if candidate.least() <= within(self.bound(interval))
            && candidate.comes_within(&self.pieces, within)
        {
            self.solve_once(candidate.spheres);
        }
    }

    /// Lists the pieces of an interval, and returns the largest of their bounds, m.
    fn bound(&mut self, interval: &Interval) -> f64 {
        self.pieces.clear();
        self.question.list_pieces(interval.ends, &mut self.pieces);
        let bounds = self.pieces.iter().map(|piece| piece.bound);
        bounds.fold(f64::NEG_INFINITY, f64::max)
    }

    /// Solves two spheres, unless they or first ones with the same motion are solved. Of ties, the first spheres are
    /// reported.
    fn solve_once(&mut self, spheres: (u32, u32)) {
        let motion = self.part.motion_key(spheres);
        let mut solved = self.solved.iter();
        if !solved.any(|&(other, first)| other == motion && first <= spheres) {
            self.solved.push((motion, spheres));
            self.question.solve(&self.part.pair(spheres));
        }
    }
}
