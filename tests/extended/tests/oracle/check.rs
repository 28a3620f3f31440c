//! What can be wrong with an answer, found exactly.
//!
//! The quick checks are signs of `distance² - level²` over the intervals that a certificate names,
//! each an integer polynomial over exactly that interval. The thorough check isolates all roots.

use crate::cases::Case;
use crate::oracle_support::{
    Body, Outside, SquaredDistance, State as ExactState, contacts, least_sign, squared_distances,
};
use dashu::rational::RBig;
use nearmiss::{Certificate, Conflict, TimeEnclosure};

/// Both motions as given, the margin as given, and where both exist within the window.
pub(crate) struct Truth {
    bodies: [Body; 2],
    margin: f64,
    pub(crate) range: Option<(f64, f64)>,
}

/// What is wrong.
#[derive(Debug, PartialEq, Eq)]
pub(crate) enum Wrong {
    /// Within the margin where nothing is reported.
    FalseNegative,
    /// Reported as certain, and not there.
    FalsePositive,
    /// A number or an instant is outside its enclosure, or the enclosure is none.
    Violation(&'static str),
}

pub(crate) fn exact(value: f64) -> RBig {
    crate::oracle_support::Dyadic::from(value).to_rational()
}

impl Truth {
    pub(crate) fn of(case: &Case) -> Self {
        let body = |states: &Vec<nearmiss::State>| {
            let states: Vec<ExactState> = states
                .iter()
                .map(|state| ExactState {
                    t: state.time,
                    p: state.position.to_array(),
                    v: state.velocity.to_array(),
                })
                .collect();
            Body::from_states(&states)
        };
        let ends = |states: &Vec<nearmiss::State>| (states[0].time, states[states.len() - 1].time);
        let (a, b) = (ends(&case.states[0]), ends(&case.states[1]));
        let window = case.window.unwrap_or((f64::MIN, f64::MAX));
        let (mut from, mut to) = (a.0.max(b.0).max(window.0), a.1.min(b.1).min(window.1));
        let outside = match case.outside {
            nearmiss::Outside::Absent => Outside::Absent,
            nearmiss::Outside::Extrapolate => Outside::Extrapolate,
            nearmiss::Outside::Coast => Outside::Coast,
            other => panic!("no exact motion of {other:?}"),
        };
        if outside != Outside::Absent {
            (from, to) = window;
        }
        let bodies = case.states.each_ref().map(body);
        let bodies = bodies.map(|body| body.extended(outside, from, to));
        Self::between(bodies, case.margin, (from, to))
    }

    /// Returns the pair of two known motions, from one instant (s) to another.
    pub(crate) fn between(bodies: [Body; 2], margin: f64, (from, to): (f64, f64)) -> Self {
        Self {
            bodies,
            margin,
            range: (from <= to).then_some((from, to)),
        }
    }

    pub(crate) fn over(&self, from: f64, to: f64) -> Vec<SquaredDistance> {
        squared_distances(&self.bodies[0], &self.bodies[1], Some((from, to)))
    }

    /// The least sign of `distance - level` over an interval, where the level is not negative.
    pub(crate) fn least_sign(&self, (from, to): (f64, f64), level: &RBig) -> i32 {
        if *level < RBig::ZERO {
            return 1;
        }
        let square = level * level;
        let spans = self.over(from, to);
        let signs = spans.iter().map(|span| least_sign(&span.minus(&square)));
        signs.min().unwrap_or(1)
    }

    /// The largest sign of `distance - level` over an interval.
    pub(crate) fn largest_sign(&self, (from, to): (f64, f64), level: &RBig) -> i32 {
        if *level < RBig::ZERO {
            return 1;
        }
        let square = level * level;
        let spans = self.over(from, to);
        let signs = spans
            .iter()
            .map(|span| -least_sign(&span.minus(&square).negated()));
        signs.max().unwrap_or(-1)
    }

    /// Whether the pair is within the margin in the open interval, or at an end that is open to
    /// the outside.
    fn is_near(&self, from: f64, to: f64, (is_first, is_last): (bool, bool)) -> bool {
        let margin = exact(self.margin);
        match self.least_sign((from, to), &margin) {
            1 => false,
            -1 => true,
            // Touches: the ends belong to the neighbouring conflicts.
            _ => contacts(&self.over(from, to), &margin, 80)
                .iter()
                .any(|contact| {
                    let (from, to) = (exact(from), exact(to));
                    (contact.exit.low > from || is_first) && (contact.enter.high < to || is_last)
                }),
        }
    }

    /// The quick checks of a whole answer.
    pub(crate) fn wrong(&self, conflicts: &[Conflict]) -> Option<Wrong> {
        let Some((from, to)) = self.range else {
            return (!conflicts.is_empty()).then_some(Wrong::FalsePositive);
        };
        let mut clear_from = from;
        for (index, conflict) in conflicts.iter().enumerate() {
            let proof = conflict.certificate.as_ref().unwrap();
            if let Some(what) = disordered(conflict, proof, (from, to)) {
                return Some(Wrong::Violation(what));
            }
            let (begin, end) = (proof.enter.earliest, proof.exit.latest);
            if begin < clear_from {
                return Some(Wrong::Violation("conflicts overlap"));
            }
            if begin > clear_from && self.is_near(clear_from, begin, (index == 0, false)) {
                return Some(Wrong::FalseNegative);
            }
            clear_from = end;
            if let Some(wrong) = self.wrong_conflict(conflict, proof) {
                return Some(wrong);
            }
        }
        let is_open = conflicts.is_empty();
        if (clear_from < to || is_open) && self.is_near(clear_from, to, (is_open, true)) {
            return Some(Wrong::FalseNegative);
        }
        None
    }

    fn wrong_conflict(&self, conflict: &Conflict, proof: &Certificate) -> Option<Wrong> {
        let margin = exact(self.margin);
        let all = (proof.enter.earliest, proof.exit.latest);
        if proof.resolved {
            let core = (proof.enter.latest, proof.exit.earliest);
            let is_there = if core.0 <= core.1 {
                self.largest_sign(core, &margin) <= 0
            } else {
                self.least_sign(all, &margin) <= 0
            };
            if !is_there {
                return Some(Wrong::FalsePositive);
            }
        }
        let separation = exact(conflict.closest.separation);
        let (low, high) = (
            &separation - exact(proof.error),
            &separation + exact(proof.error),
        );
        if low > RBig::ZERO && self.least_sign(all, &low) < 0 {
            return Some(Wrong::Violation("nearer than the lower end"));
        }
        let closest = (proof.closest.earliest, proof.closest.latest);
        if self.least_sign(closest, &high) > 0 {
            return Some(Wrong::Violation("not as near as the upper end in time"));
        }
        None
    }

    /// The thorough check: every true contact is within a reported one, with its minimum.
    pub(crate) fn wrong_thoroughly(&self, conflicts: &[Conflict]) -> Option<Wrong> {
        let (from, to) = self.range?;
        let found = contacts(&self.over(from, to), &exact(self.margin), 80);
        for conflict in conflicts {
            let proof = conflict.certificate.as_ref().unwrap();
            let (begin, end) = (exact(proof.enter.earliest), exact(proof.exit.latest));
            let own: Vec<_> = found
                .iter()
                .filter(|contact| contact.enter.high >= begin && contact.exit.low <= end)
                .collect();
            // What is resolved is there; within its enclosures it has one begin and one end.
            let (Some(first), Some(last)) = (own.first(), own.last()) else {
                if proof.resolved {
                    return Some(Wrong::FalsePositive);
                }
                continue;
            };
            let holds = |times: TimeEnclosure, low: &RBig, high: &RBig| {
                exact(times.earliest) <= *high && *low <= exact(times.latest)
            };
            if !holds(proof.enter, &first.enter.low, &first.enter.high) {
                return Some(Wrong::Violation("enter"));
            }
            if !holds(proof.exit, &last.exit.low, &last.exit.high) {
                return Some(Wrong::Violation("exit"));
            }
            let least = own
                .iter()
                .min_by(|x, y| x.minimum.squared.low.cmp(&y.minimum.squared.low));
            let Some(least) = least else { continue };
            for stretch in &least.minimum.instants {
                if !holds(proof.closest, &stretch.first.low, &stretch.first.high) {
                    return Some(Wrong::Violation("closest approach in time"));
                }
            }
        }
        let is_within = |contact: &crate::oracle_support::Contact| {
            conflicts.iter().any(|conflict| {
                let proof = conflict.certificate.as_ref().unwrap();
                exact(proof.enter.earliest) <= contact.enter.high
                    && contact.exit.low <= exact(proof.exit.latest)
            })
        };
        (!found.iter().all(is_within)).then_some(Wrong::FalseNegative)
    }
}

/// What is out of order in a conflict's numbers.
fn disordered(conflict: &Conflict, proof: &Certificate, range: (f64, f64)) -> Option<&'static str> {
    let holds = |times: TimeEnclosure, time: f64| {
        times.earliest <= time
            && time <= times.latest
            && times.earliest >= range.0
            && times.latest <= range.1
    };
    if !holds(proof.enter, conflict.enter) {
        return Some("enter is outside its enclosure");
    }
    if !holds(proof.exit, conflict.exit) {
        return Some("exit is outside its enclosure");
    }
    if !holds(proof.closest, conflict.closest.time) {
        return Some("the closest approach is outside its enclosure");
    }
    if proof.closest.earliest < proof.enter.earliest || proof.closest.latest > proof.exit.latest {
        return Some("the enclosure of the closest approach leaves the conflict");
    }
    if conflict.enter > conflict.exit || !(proof.error >= 0.0 && proof.error.is_finite()) {
        return Some("no interval, or no error");
    }
    None
}
