//! A branch and bound in time for the pairs of spheres that matter to a question.
//!
//! The pairs that are probably the nearest ones are solved first. What they prove bounds what others have to reach. An
//! interval with many pairs is halved: in a short time, distances of spheres along one direction tell most pairs apart.
//! Each pair is solved over the whole part.

use super::candidates::{HALVINGS, SphereCandidate, find_nearest, remove_behind};
use super::near::NearSpheres;
use super::part::{CandidateBuffers, Interval, MotionKey, PartScratch, SpheresOverPart};
use super::proven::{BoundStep, BoundSteps, ProvenContact, ProvenContacts};
use super::shares::{FEWEST_HALVINGS, Shares, WHOLE};
use crate::narrow_phase::sphere_pair::SpherePair;
use crate::narrow_phase::widened;
use std::collections::BTreeMap;

/// A question about two bodies over a part of a span.
pub(super) trait Question {
    /// Returns true if all pairs matter that are the nearest ones at some time. Where they are few they are compared with
    /// each other before any is solved.
    fn is_of_all_times(&self) -> bool {
        false
    }

    /// Restricts the question to a stretch of the part, which is halved so many times. No pair matters outside of the
    /// stretch.
    fn restrict(&mut self, _stretch: Shares, _halvings: i32) {}

    /// Appends the steps of an interval (shares of the stretch) to an empty list, with what the pairs solved so far leave
    /// to be reached.
    fn list_bounds(&self, interval: (f64, f64), steps: &mut BoundSteps);

    /// Solves a pair of spheres. `slack` is the difference of separations below which it is not certain which pair is nearer,
    /// m; `None` if what the pair tells of others is not needed.
    fn solve(&mut self, pair: &SpherePair, slack: Option<f64>);

    /// Notes that two spheres come as near as this at some time of the part, m. Returns false if that tells nothing.
    fn note_upper_bound(&mut self, _separation: f64) -> bool {
        false
    }
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
    fn list_bounds(&self, _: (f64, f64), steps: &mut BoundSteps) {
        let bound = self.reached;
        steps.push(BoundStep { end: 1.0, bound });
    }

    fn solve(&mut self, pair: &SpherePair, _: Option<f64>) {
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
    fn restrict(&mut self, stretch: Shares, _: i32) {
        self.proven.restrict(stretch);
    }

    fn list_bounds(&self, interval: (f64, f64), steps: &mut BoundSteps) {
        self.proven.list_bounds(interval, steps);
    }

    fn solve(&mut self, pair: &SpherePair, slack: Option<f64>) {
        self.found.clear();
        (self.solve)(pair, self.found);
        if let Some(slack) = slack {
            self.proven.learn(self.found, slack);
        }
    }
}

impl SpheresOverPart<'_> {
    /// Solves the pairs of spheres that may matter to a question, each once.
    pub(super) fn search(&self, question: &mut dyn Question, scratch: &mut PartScratch) {
        let PartScratch {
            near,
            buffers,
            solved,
        } = scratch;
        solved.clear();
        let [first, deeper @ ..] = near;
        self.list_all(first);
        let mut search = Search {
            part: self,
            question,
            steps: BoundSteps::new(),
            slack: None,
            buffers,
            solved,
            is_divided: false,
            is_restricted: false,
            halvings: FEWEST_HALVINGS,
        };
        search.search_over(&self.whole, f64::INFINITY, (first, deeper));
    }
}

/// A search in progress.
struct Search<'s, 'a> {
    part: &'s SpheresOverPart<'a>,
    question: &'s mut dyn Question,
    /// Steps of the interval at hand.
    steps: BoundSteps,
    /// Difference of separations below which it is not certain which pair of spheres is nearer, m. `None` if that was not
    /// needed yet.
    slack: Option<f64>,
    buffers: &'s mut CandidateBuffers,
    /// Motions that are solved, and the first spheres of which they are.
    solved: &'s mut BTreeMap<MotionKey, (u32, u32)>,
    /// True if the spheres or the part are halved.
    is_divided: bool,
    /// True if the stretch to be searched is known.
    is_restricted: bool,
    /// Number of times that the stretch is halved.
    halvings: i32,
}

impl Search<'_, '_> {
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
        let mut bound = self.bound(interval);
        if bound == f64::NEG_INFINITY || near.pairs() == 0 {
            return;
        }
        part.find_supports(interval, near);
        let facing = near.facing();
        if bound == f64::INFINITY {
            let reached = part.least_reached(interval, near, facing.1) + self.slack();
            if !self.question.note_upper_bound(reached) {
                self.solve_if_near(interval, &part.candidate(interval, facing));
            }
            bound = self.bound(interval);
        }
        if !self.is_restricted && near.pairs() > SpheresOverPart::MANY {
            self.is_restricted = true;
            let square_reach = interval.square_reach();
            let Some(stretch) = part.stretch_within(bound, square_reach) else {
                return;
            };
            if stretch != WHOLE {
                let interval = interval.stretch(stretch);
                self.halvings = part.halvings(interval.square_reach());
                self.question.restrict(stretch, self.halvings);
                return self.search_over(&interval, most, (near, deeper));
            }
            self.halvings = part.halvings(square_reach);
            if self.halvings > FEWEST_HALVINGS {
                self.question.restrict(stretch, self.halvings);
            }
        }
        // Pairs with a larger support are not the nearest ones.
        let mut behind = f64::INFINITY;
        let is_crowded = self.is_divided || near.pairs() > SpheresOverPart::CROWDED;
        if is_crowded && !interval.turns() {
            behind = part.support_behind(interval, near) + self.slack();
        }
        near.remove_far(part.threshold(bound.min(most).min(behind)));
        if near.pairs() > SpheresOverPart::MANY
            && let [next, deeper @ ..] = deeper
        {
            let path = part.relative_path(interval, facing);
            let mut is_crowded = near.pairs() > SpheresOverPart::CROWDED;
            let is_long = path.bend > SpheresOverPart::BENT
                || is_crowded && path.length > SpheresOverPart::LONG;
            let is_halved = is_long && interval.is_divisible(self.halvings);
            if is_halved || is_crowded {
                self.is_divided = true;
                self.solve_if_near(interval, &part.candidate(interval, facing));
                // Pairs that are always farther are not the nearest ones.
                most = most.min(path.most + self.slack());
                bound = self.bound(interval);
                near.remove_far(part.threshold(bound.min(most)));
                is_crowded = near.pairs() > SpheresOverPart::CROWDED;
            }
            if is_halved {
                for number in [0, 1] {
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
        let most = bound.min(most);
        let support = part.threshold(most.min(behind));
        part.list_candidates(interval, (most, support), near, self.buffers);
        self.solve_candidates(interval);
    }

    fn solve_candidates(&mut self, interval: &Interval) {
        if self.buffers.candidates.is_empty() {
            return;
        }
        let slack = self.slack() * self.part.power;
        let CandidateBuffers {
            candidates,
            nearest,
            ..
        } = &mut *self.buffers;
        if self.question.is_of_all_times() && !self.is_divided {
            // Pairs that go along together are told apart by each other, before any is solved.
            nearest.clear();
            find_nearest(candidates, 0, slack, HALVINGS, nearest);
            for place in 0..nearest.len() {
                self.solve_once(self.buffers.nearest[place], None);
            }
            return;
        }
        if candidates.len() > Self::FEW {
            remove_behind(candidates, 0, slack);
        }
        candidates.sort_unstable_by(|x, y| x.least().total_cmp(&y.least()));
        for place in 0..candidates.len() {
            let candidate = self.buffers.candidates[place];
            self.solve_if_near(interval, &candidate);
        }
    }

    /// Solves a pair of spheres if it may matter in an interval.
    fn solve_if_near(&mut self, interval: &Interval, candidate: &SphereCandidate) {
        let part = self.part;
        let power = part.power;
        let within = |bound: f64| (part.threshold(bound) + part.error) * power;
        if candidate.least() <= within(self.bound(interval))
            && candidate.comes_within(&self.steps, within)
        {
            let slack = self.slack();
            self.solve_once(candidate.spheres, Some(slack));
        }
    }

    fn slack(&mut self) -> f64 {
        *self.slack.get_or_insert_with(|| self.part.slack())
    }

    /// Lists the steps of an interval, and returns the largest of their bounds, m.
    fn bound(&mut self, interval: &Interval) -> f64 {
        self.steps.clear();
        self.question.list_bounds(interval.ends, &mut self.steps);
        let bounds = self.steps.iter().map(|step| step.bound);
        bounds.fold(f64::NEG_INFINITY, f64::max)
    }

    /// Solves two spheres, unless they or first ones with the same motion are solved. Of ties, the first spheres are
    /// reported.
    fn solve_once(&mut self, spheres: (u32, u32), slack: Option<f64>) {
        let motion = self.part.motion_key(spheres);
        if self
            .solved
            .get(&motion)
            .is_none_or(|first| spheres < *first)
        {
            self.solved.insert(motion, spheres);
            self.question.solve(&self.part.pair(spheres), slack);
        }
    }
}
