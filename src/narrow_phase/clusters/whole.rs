//! Question for the pairs of spheres that matter to contacts as a whole, at some margins.
//!
//! What they show are the contacts at each of these margins, and the closest approach in each. They do not show what a
//! window leaves of a contact that it cuts: the [nearest](super::nearest) pairs do.

use super::proven::{BoundStep, BoundSteps, MOST_STEPS, ProvenContact, ProvenContacts};
use super::search::Question;
use super::shares::Shares;
use crate::narrow_phase::profile::DistanceProfile;
use crate::narrow_phase::sphere_pair::SpherePair;
use crate::spans::Span;
use arrayvec::ArrayVec;

/// Largest number of margins. With more, all pairs that are the nearest ones at some time are solved.
pub(super) const MAX_MARGINS: usize = 4;

const _: () = assert!(MAX_MARGINS * ProvenContacts::MAX_STEPS <= MOST_STEPS);

const ALL_TIMES: (f64, f64) = (f64::NEG_INFINITY, f64::INFINITY);

/// What is asked of a span that is solved once and kept.
#[derive(Clone, Copy, Debug)]
pub(crate) struct KeptQuestion<'m> {
    /// Margins of the contacts, m, the largest one last: at least one.
    pub(crate) margins: &'m [f64],
    /// Instants at which windows cut contacts, s. `None` if any window may.
    pub(crate) cuts: Option<&'m [f64]>,
}

impl KeptQuestion<'_> {
    pub(in crate::narrow_phase) fn largest_margin(&self) -> f64 {
        self.margins.last().copied().unwrap_or(f64::NEG_INFINITY)
    }
}

/// Asks for the pairs that begin or end a contact at some margin, or are the nearest ones in it; `solve` returns the
/// profile of a pair's distance if that comes within the largest margin.
pub(super) struct WholeContactsQuestion<F> {
    /// What is proven so far at each margin.
    proven: ArrayVec<ProvenContacts, MAX_MARGINS>,
    margins: ArrayVec<f64, MAX_MARGINS>,
    found: Vec<ProvenContact>,
    solve: F,
}

impl<F> WholeContactsQuestion<F> {
    /// Returns the question about a part of a span, at no more than [`MAX_MARGINS`] margins (m).
    pub(super) fn new(part: Span, margins: impl Iterator<Item = f64>, solve: F) -> Self {
        let margins: ArrayVec<f64, MAX_MARGINS> = margins.collect();
        let proven = margins.iter();
        Self {
            proven: proven
                .map(|&margin| ProvenContacts::new(part, (margin, ALL_TIMES)))
                .collect(),
            margins,
            found: Vec::new(),
            solve,
        }
    }
}

impl<F: FnMut(&SpherePair) -> Option<DistanceProfile>> Question for WholeContactsQuestion<F> {
    fn restrict(&mut self, stretch: Shares, _: i32) {
        for proven in &mut self.proven {
            proven.restrict(stretch);
        }
    }

    fn list_bounds(&self, interval: (f64, f64), steps: &mut BoundSteps) {
        for proven in &self.proven {
            if steps.is_empty() {
                proven.list_bounds(interval, steps);
            } else {
                let mut others = BoundSteps::new();
                proven.list_bounds(interval, &mut others);
                *steps = larger(steps, &others);
            }
        }
    }

    fn solve(&mut self, pair: &SpherePair, slack: Option<f64>) {
        let profile = (self.solve)(pair);
        let (Some(profile), Some(slack)) = (profile, slack) else {
            return;
        };
        let radii = pair.radius_a + pair.radius_b;
        for (proven, &margin) in self.proven.iter_mut().zip(&self.margins) {
            let radius = pair.radius(margin);
            if radius < 0.0 {
                continue;
            }
            self.found.clear();
            profile.intervals_within(&pair.cubic, radius, ALL_TIMES, |(enter, exit), closest| {
                self.found.push(ProvenContact {
                    enter,
                    exit,
                    separation: closest.distance - radii,
                });
            });
            proven.learn(&self.found, slack);
        }
    }
}

/// Returns the steps of one interval with the larger bound of both.
fn larger(some: &BoundSteps, others: &BoundSteps) -> BoundSteps {
    let mut larger = BoundSteps::new();
    let (mut some, mut others) = (some.iter().peekable(), others.iter().peekable());
    while let (Some(&&one), Some(&&other)) = (some.peek(), others.peek()) {
        let step = BoundStep {
            end: one.end.min(other.end),
            bound: one.bound.max(other.bound),
        };
        some.next_if(|one| one.end <= step.end);
        others.next_if(|other| other.end <= step.end);
        match larger.last_mut() {
            Some(last) if last.bound.total_cmp(&step.bound).is_eq() => last.end = step.end,
            _ => larger.push(step),
        }
    }
    larger
}
