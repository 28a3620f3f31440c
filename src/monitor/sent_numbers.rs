//! The numbers of an encounter that were reported, and whether a change of them is reported.

use super::event::Encounter;
use super::tick_context::TickContext;
use crate::narrow_phase::Approach;

/// The numbers of an encounter that its first event or its last revision gave: the next revision is measured from
/// them. (`Began` gives numbers as well, but counts only where it [knows less](Self::know_no_more_than): a change that is kept
/// back before it is not lost.)
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct SentNumbers {
    enter: f64,
    exit: f64,
    open: bool,
    closest_time: f64,
    separation: f64,
    model_error: f64,
}

impl SentNumbers {
    pub(super) const fn of(encounter: &Encounter) -> Self {
        Self {
            enter: encounter.enter,
            exit: encounter.exit,
            open: encounter.open,
            closest_time: encounter.closest.time,
            separation: encounter.closest.separation,
            model_error: encounter.closest.model_error,
        }
    }

    /// Takes over what an encounter does not know any more as it begins, an exit or a nearest point: it is reported once it is
    /// known again.
    pub(super) fn know_no_more_than(&mut self, begun: &Encounter) {
        let begun = Self::of(begun);
        self.open |= begun.open;
        if !begun.knows_closest() {
            (self.exit, self.closest_time) = (begun.exit, begun.closest_time);
            self.separation = begun.separation;
        }
    }

    pub(super) fn are_finite(&self) -> bool {
        let Self {
            enter,
            exit,
            open: _,
            closest_time,
            separation,
            model_error,
        } = *self;
        let numbers = [enter, exit, closest_time, separation, model_error];
        numbers.into_iter().all(f64::is_finite)
    }

    /// Returns false if the bodies may still have been closing in, at an open end.
    fn knows_closest(&self) -> bool {
        !(self.open && self.closest_time >= self.exit)
    }
}

/// Returns true if the numbers differ by more than the revision threshold, as far as both are known. A change
/// beyond the end of the examined time, which moves, is no revision.
pub(super) fn differs(encounter: &Encounter, sent: &SentNumbers, tick: &TickContext<'_>) -> bool {
    let new = &SentNumbers::of(encounter);
    let threshold = &tick.revision_threshold;
    let moved = |x: f64, y: f64| (x - y).abs() > threshold.time;
    let exit = match (new.open, sent.open) {
        (false, false) => moved(new.exit, sent.exit),
        (true, true) => false,
        // A budget may have hidden an exit that was known.
        (true, false) => new.exit > sent.exit + threshold.time,
        (false, true) => true,
    };
    let model_error = (new.model_error - sent.model_error).abs() > threshold.separation;
    moved(new.enter, sent.enter) || exit || model_error || closest_differs(encounter, sent, tick)
}

fn closest_differs(encounter: &Encounter, sent: &SentNumbers, tick: &TickContext<'_>) -> bool {
    let new = &SentNumbers::of(encounter);
    let threshold = &tick.revision_threshold;
    let is_lower = new.separation < sent.separation - threshold.separation;
    if !sent.knows_closest() {
        // While they close in it is reported once a lookahead at most.
        let is_later = new.closest_time >= sent.closest_time + tick.lookahead;
        return new.knows_closest() || is_later && is_lower;
    }
    // The nearest point that was reported lies beyond the examined time, since a budget ran out.
    let hidden = new.open && sent.closest_time > new.exit;
    if hidden {
        return new.knows_closest() && is_lower;
    }
    // Where a distance stays the same, or is as small again, the instant of the least one is a matter of rounding.
    let is_still_closest = || {
        let slots = (encounter.a.slot, encounter.b.slot);
        let time = sent.closest_time;
        let nearest = new.separation + threshold.separation;
        // A constant distance is reported at its first instant, whatever the rounding.
        let is_near = |there: Approach| there.plateau == 0.0 && there.separation <= nearest;
        let there = || tick.solved.closest_at(slots, time, &tick.bodies);
        threshold.separation > 0.0 && (time <= tick.before || there().is_some_and(is_near))
    };
    let is_moved = (new.closest_time - sent.closest_time).abs() > threshold.time;
    (new.separation - sent.separation).abs() > threshold.separation
        || (is_moved || !new.knows_closest()) && !is_still_closest()
}
