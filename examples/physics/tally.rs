//! Predictions and contacts, compared.
//!
//! A body is deflected in a frame if it did not fly there freely from the frame before: another body or a
//! wall changed its velocity or angular velocity, or pushed it.
//!
//! - A contact is free if neither body was deflected in the frame in which it begins: the frame before
//!   already showed both as they fly when they touch, so that the contact could be predicted. It is
//!   predicted if it falls into an encounter of which the monitor had told by then. (Covers of boxes
//!   overlap before the boxes touch, and may do so while these touch twice.)
//! - A prediction is made when the monitor first tells of an encounter ahead. It is deflected once one of
//!   the two bodies is, and made anew then if the encounter still lies ahead. It came true if rapier had
//!   the contact, and failed if the encounter passed without one. It passed between frames if no frame
//!   falls into the encounter: rapier looks for contacts in frames only.

use crate::world::{Contacts, Kind, Motion, instant, time_since_contact};
use nearmiss::{Encounter, EncounterId, Event, EventKind};
use std::collections::BTreeMap;
use std::ops::RangeInclusive;

/// Counts of pairs of one kind.
#[derive(Clone, Debug, Default)]
pub(crate) struct Counts {
    /// Contacts that rapier had.
    pub(crate) contacts: u64,
    /// Free contacts.
    pub(crate) free: u64,
    /// Free contacts that were predicted.
    pub(crate) predicted: u64,
    /// Predictions: the sum of the five below.
    pub(crate) predictions: u64,
    pub(crate) deflected: u64,
    pub(crate) came_true: u64,
    pub(crate) between_frames: u64,
    pub(crate) failed: u64,
    /// Predictions of encounters that are still ahead at the end.
    pub(crate) ahead: u64,
    /// Differences of the predicted instants from those of the contacts, of predictions that came
    /// true, ms.
    pub(crate) errors: Vec<f64>,
    /// Times from prediction to contact, of predictions that came true, s.
    pub(crate) warnings: Vec<f64>,
}

/// Counts of all kinds of pairs.
#[derive(Clone, Debug, Default)]
pub(crate) struct Outcome {
    /// By the number of boxes in the pair: two balls, a ball and a box, two boxes.
    pub(crate) pairs: [Counts; 3],
    /// Contacts with walls.
    pub(crate) walls: u64,
}

/// An encounter that is not over.
#[derive(Clone, Copy, Debug)]
struct Pending {
    /// The frame in which the monitor first told of it.
    told: u32,
    /// The prediction that is still to be judged.
    prediction: Option<Prediction>,
    /// The encounter as last told.
    now: Encounter,
}

#[derive(Clone, Copy, Debug)]
struct Prediction {
    /// The frame in which it was made.
    frame: u32,
    /// The first instant of the contact, s.
    enter: f64,
}

/// Two bodies by number, the smaller number first.
type Pair = [usize; 2];

/// Compares frame by frame.
#[derive(Debug)]
pub(crate) struct Tally {
    outcome: Outcome,
    pending: BTreeMap<(Pair, EncounterId), Pending>,
    states: Vec<Motion>,
    /// The frame in which each body was last deflected; 0 if it never was.
    deflected: Vec<u32>,
}

impl Tally {
    pub(crate) fn new(states: &[Motion]) -> Self {
        Self {
            outcome: Outcome::default(),
            pending: BTreeMap::new(),
            states: states.to_vec(),
            deflected: vec![0; states.len()],
        }
    }

    /// Takes the states of a frame, and the events that the monitor tells of it.
    pub(crate) fn read(&mut self, frame: u32, states: &[Motion], events: &[Event]) {
        let before = self.states.iter().zip(states);
        for (deflected, (before, now)) in self.deflected.iter_mut().zip(before) {
            if before.is_deflected(now) {
                *deflected = frame;
            }
        }
        self.states.copy_from_slice(states);
        let mut over: BTreeMap<Pair, Pending> = BTreeMap::new();
        for event in events {
            let Some(&now) = event.kind.encounter() else {
                continue;
            };
            let Some(pair) = numbers(&now) else {
                continue;
            };
            let key = (pair, now.id);
            match event.kind {
                EventKind::Predicted(_) => {
                    let enter = now.enter;
                    self.counts(pair).predictions += 1;
                    let pending = Pending {
                        told: frame,
                        prediction: Some(Prediction { frame, enter }),
                        now,
                    };
                    self.pending.insert(key, pending);
                }
                EventKind::Began(_) | EventKind::Revised(_) => {
                    // States rounded to f32 jump a little from frame to frame. Where bodies meet right in a
                    // frame, one encounter may end by that, and another begin.
                    let first = Pending {
                        told: frame,
                        prediction: None,
                        now,
                    };
                    let known = || over.remove(&pair).unwrap_or(first);
                    self.pending.entry(key).or_insert_with(known).now = now;
                }
                EventKind::Ended(..) => {
                    let pending = self.pending.remove(&key);
                    let pending = pending.map(|pending| Pending { now, ..pending });
                    let earlier = pending.and_then(|pending| over.insert(pair, pending));
                    earlier.iter().for_each(|earlier| self.judge(pair, earlier));
                }
                EventKind::Withdrawn(_) => {
                    let pending = self.pending.remove(&key);
                    pending.iter().for_each(|pending| self.judge(pair, pending));
                }
                _ => {}
            }
        }
        for (pair, pending) in over {
            self.judge(pair, &pending);
        }
        self.predict_anew(frame);
    }

    /// Takes the contacts that begin in the frame that was read.
    pub(crate) fn compare(&mut self, frame: u32, contacts: &Contacts) {
        self.outcome.walls += contacts.walls;
        for &pair in &contacts.pairs {
            self.counts(pair).contacts += 1;
            if pair.iter().any(|&body| self.deflected[body] == frame) {
                continue;
            }
            let known = self.pending.range_mut(keys_of(pair));
            let known = known.map(|(_, pending)| pending);
            let is_under_way =
                |known: &&mut Pending| known.told < frame && known.now.enter <= instant(frame);
            let known: Vec<_> = known.filter(is_under_way).collect();
            let is_predicted = !known.is_empty();
            let judged = known.into_iter().filter(|known| known.prediction.is_some());
            let first = judged.min_by(|x, y| x.now.enter.total_cmp(&y.now.enter));
            let came_true = first.and_then(|first| first.prediction.take());
            let [a, b] = pair.map(|body| self.states[body]);
            let counts = self.counts(pair);
            counts.free += 1;
            counts.predicted += u64::from(is_predicted);
            if let Some(prediction) = came_true {
                let contact = instant(frame) - time_since_contact(&a, &b);
                counts.came_true += 1;
                counts.errors.push((prediction.enter - contact).abs() * 1e3);
                counts.warnings.push(contact - instant(prediction.frame));
            }
        }
    }

    /// Returns the counts.
    pub(crate) fn finish(mut self) -> Outcome {
        for ((pair, _), pending) in std::mem::take(&mut self.pending) {
            self.counts(pair).ahead += u64::from(pending.prediction.is_some());
        }
        self.outcome
    }

    /// Judges the prediction of an encounter that is over, if no contact did.
    fn judge(&mut self, pair: Pair, over: &Pending) {
        let Some(prediction) = over.prediction else {
            return;
        };
        let after = |&body: &usize| self.deflected[body] > prediction.frame;
        let is_deflected = pair.iter().any(after);
        let counts = self.counts(pair);
        if is_deflected {
            counts.deflected += 1;
        } else if holds_a_frame(over.now.enter, over.now.exit) {
            counts.failed += 1;
        } else {
            counts.between_frames += 1;
        }
    }

    /// Makes predictions anew of which a body was deflected in this frame.
    fn predict_anew(&mut self, frame: u32) {
        let mut pending = std::mem::take(&mut self.pending);
        for (&(pair, _), pending) in &mut pending {
            let is_deflected = pair.iter().any(|&body| self.deflected[body] == frame);
            let Some(old) = pending.prediction else {
                continue;
            };
            if is_deflected && old.frame < frame {
                let enter = pending.now.enter;
                let lies_ahead = enter > instant(frame);
                pending.prediction = lies_ahead.then_some(Prediction { frame, enter });
                let counts = self.counts(pair);
                counts.deflected += 1;
                counts.predictions += u64::from(lies_ahead);
            }
        }
        self.pending = pending;
    }

    fn counts(&mut self, pair: Pair) -> &mut Counts {
        let is_box = |&&body: &&usize| self.states[body].kind == Kind::Box;
        let boxes = pair.iter().filter(is_box).count();
        &mut self.outcome.pairs[boxes]
    }
}

/// Returns the numbers of both bodies, which are their tags.
fn numbers(encounter: &Encounter) -> Option<Pair> {
    let a = usize::try_from(encounter.tag_a).ok()?;
    let b = usize::try_from(encounter.tag_b).ok()?;
    Some([a.min(b), a.max(b)])
}

/// Returns true if a frame falls into an interval (s), not right at its end: an encounter that ends in a
/// frame ends because the states of that frame are apart.
fn holds_a_frame(enter: f64, exit: f64) -> bool {
    (enter / instant(1)).ceil() * instant(1) < exit
}

/// Returns the keys of all encounters of a pair.
fn keys_of(pair: Pair) -> RangeInclusive<(Pair, EncounterId)> {
    (pair, EncounterId::from_bits(0))..=(pair, EncounterId::from_bits(u64::MAX))
}
