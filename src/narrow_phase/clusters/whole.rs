//! Question for the pairs of spheres that matter to contacts as a whole, at some margins.
//!
//! They show the contacts at each of these margins, and the closest approach in each. Where a window cuts a contact at an end
//! of the part, they show the closest approach at that instant, too: bodies that are told a state have a cubic from then on.
//! They do not show the rest of a contact that a window cuts elsewhere: the [nearest](super::nearest) pairs do.

use super::proven::{BoundStep, BoundSteps, MOST_STEPS, ProvenContact, ProvenContacts};
use super::search::Question;
use super::shares::{Shares, WHOLE};
use crate::narrow_phase::profile::DistanceProfile;
use crate::narrow_phase::sphere_pair::SpherePair;
use crate::spans::Span;
use arrayvec::ArrayVec;

/// Largest number of margins. With more, all pairs that are the nearest ones at some time are solved.
pub(super) const MAX_MARGINS: usize = 4;

/// Steps for either end of the part.
const END_STEPS: usize = 2;

const _: () = assert!(MAX_MARGINS * ProvenContacts::MAX_STEPS + END_STEPS <= MOST_STEPS);

/// Share of an interval that is an instant.
const INSTANT: f64 = 1e-12;

const ALL_TIMES: (f64, f64) = (f64::NEG_INFINITY, f64::INFINITY);

/// Question about a span that is solved once and kept.
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

/// Instants at which windows may cut a contact in what is solved of a span.
#[derive(Clone, Copy, Debug)]
pub(in crate::narrow_phase) enum SolvedCuts {
    /// All.
    Any,
    /// Its start, its end, both or none.
    AtEnds([bool; 2]),
}

impl SolvedCuts {
    /// Returns true if a window may cut a contact at an instant (s) in what is solved, an interval (s).
    pub(in crate::narrow_phase) fn has(self, time: f64, (start, end): (f64, f64)) -> bool {
        match self {
            Self::Any => true,
            Self::AtEnds([at_start, at_end]) => {
                let is_within = start < time && time < end;
                !is_within
                    && (at_start || time.total_cmp(&start).is_ne())
                    && (at_end || time.total_cmp(&end).is_ne())
            }
        }
    }
}

/// Asks for the pairs that begin or end a contact at some margin, or are the nearest ones in it; `solve` returns the
/// profile of a pair's distance if that comes within the largest margin.
pub(super) struct WholeContactsQuestion<F> {
    /// Contacts that are proven so far at each margin.
    proven: ArrayVec<ProvenContacts, MAX_MARGINS>,
    margins: ArrayVec<f64, MAX_MARGINS>,
    /// Separations that a pair must reach at the start and at the end of the part to matter there, m; below all numbers if
    /// no window cuts there.
    at_ends: [f64; 2],
    stretch: Shares,
    found: Vec<ProvenContact>,
    solve: F,
}

impl<F> WholeContactsQuestion<F> {
    /// Returns the question about a part of a span, at no more than [`MAX_MARGINS`] margins (m); `cuts` says at which ends
    /// windows cut contacts.
    pub(super) fn new(
        (part, cuts): (Span, [bool; 2]),
        margins: impl Iterator<Item = f64>,
        solve: F,
    ) -> Self {
        let margins: ArrayVec<f64, MAX_MARGINS> = margins.collect();
        let proven = |&margin: &f64| ProvenContacts::new(part, (margin, ALL_TIMES));
        let largest = margins.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        Self {
            proven: margins.iter().map(proven).collect(),
            margins,
            at_ends: cuts.map(|is_cut| if is_cut { largest } else { f64::NEG_INFINITY }),
            stretch: WHOLE,
            found: Vec::new(),
            solve,
        }
    }
}

impl<F: FnMut(&SpherePair) -> Option<DistanceProfile>> Question for WholeContactsQuestion<F> {
    fn restrict(&mut self, stretch: Shares, _: i32) {
        self.stretch = stretch;
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
        let step = |end: f64, bound: f64| BoundStep { end, bound };
        let [at_start, at_end] = self.at_ends;
        let none = f64::NEG_INFINITY;
        if interval.0 <= 0.0 && self.stretch.0 <= 0.0 {
            let first = [step(INSTANT, at_start), step(1.0, none)];
            *steps = larger(steps, &first);
        }
        if interval.1 >= 1.0 && self.stretch.1 >= 1.0 {
            let last = [step(1.0 - INSTANT, none), step(1.0, at_end)];
            *steps = larger(steps, &last);
        }
    }

    fn solve(&mut self, pair: &SpherePair, slack: Option<f64>) {
        let profile = (self.solve)(pair);
        let (Some(profile), Some(slack)) = (profile, slack) else {
            return;
        };
        let radii = pair.radius_a + pair.radius_b;
        for (known, distance) in self.at_ends.iter_mut().zip(profile.at_ends()) {
            *known = known.min(distance - radii + slack);
        }
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
fn larger(some: &[BoundStep], others: &[BoundStep]) -> BoundSteps {
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
