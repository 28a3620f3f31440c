//! Snapshots of a monitor, and monitors from snapshots.

use super::encounters::{EncounterTracker, Saved};
use super::snapshot::Snapshot;
use super::{EndReason, EventKind, Monitor, check_revision_threshold, check_setting};
use crate::error::Error;
use crate::rounding::without_negative_zero;

/// Largest number of encounters of a snapshot: later ones can be counted.
const MAX_ENCOUNTERS: u64 = 1 << 62;

impl Monitor {
    /// Returns all that is needed to go back to the monitor as it is now, as a game does that rolls back.
    ///
    /// The snapshot holds a copy of the scene, and nothing that can be worked out from it. A recording under way
    /// is no part of it.
    ///
    /// ```
    /// use nearmiss::{AlertLevel, Monitor, Scene};
    ///
    /// let mut monitor = Monitor::new(Scene::new(), 0.0, 10.0, &[AlertLevel::at(2.0)])?;
    /// let mut events = Vec::new();
    /// monitor.advance(1.0, &mut events)?;
    /// let snapshot = monitor.snapshot();
    /// monitor.advance(5.0, &mut events)?;
    /// monitor = Monitor::restore(snapshot)?;
    /// assert_eq!(monitor.now(), 1.0);
    /// # Ok::<(), nearmiss::Error>(())
    /// ```
    #[must_use]
    pub fn snapshot(&self) -> Snapshot {
        let mut pending_events = self.pending_events.clone();
        let encounters = self.encounters.iter().map(|tracker| {
            let (mut left, is_gone) = (tracker.clone(), |slot| self.removed.has(slot));
            let reason = EndReason::BodyRemoved;
            left.end(self.reported, reason, is_gone, &mut pending_events);
            left.save()
        });
        let encounters = encounters.collect();
        Snapshot {
            scene: self.scene.clone(),
            now: self.now,
            reported: self.reported,
            lookahead: self.lookahead,
            levels: self.levels.clone(),
            revision_threshold: self.revision_threshold,
            history: self.history,
            max_spans: self.search.max_spans,
            next_id: self.next_id,
            encounters,
            pending_events,
            end_reported: (0..)
                .take(self.scene.slots())
                .map(|slot| self.plan_ends.at(slot) == f64::INFINITY)
                .collect(),
            has_reported_all: self.has_reported_all(),
            since_unknown: self.search.since_unknown,
        }
    }

    /// Returns the monitor of which a snapshot was taken; give a clone of one to go back to again.
    ///
    /// Given the same inputs, the new monitor reports the same events from then on, if its ticks have no
    /// [budget](Self::advance_within).
    /// Near [`max_spans`](Self::max_spans) one of the two may end with [`Error::TooCrowded`] where the other one does not,
    /// since a snapshot holds no spans that were found before.
    ///
    /// The new monitor has no recording under way.
    ///
    /// Ids of bodies and encounters that were given after the snapshot are given again, to others. Forget what you have noted
    /// under them; [`encounters`](Self::encounters) lists those under way.
    ///
    /// This call or the next tick looks at all bodies, like the first tick of a new monitor; that tick may come less far within
    /// a budget. If many bodies changed in each tick, it takes as long as these; else several times as long as a
    /// [screening](crate::Scene::screen) of the lookahead.
    ///
    /// This call does if another tick at the same time would have changed nothing: then the monitor knows what the other one
    /// knew. Else it knows nothing before its next tick: [`complete_until`](Self::complete_until) is the instant up to which
    /// events were reported, there are no [`conflicts`](Self::conflicts), and [`what_if`](Self::what_if) returns
    /// [`Error::NothingKnown`].
    ///
    /// # Errors
    ///
    /// A snapshot from [`snapshot`](Self::snapshot) has no errors. Exception: [`Error::TooCrowded`] if the
    /// [limit](Self::set_max_spans) was lowered, and it knows twice as many spans as the larger of that limit and
    /// [`MAX_SPANS`](Self::MAX_SPANS).
    /// For one that was read from a file: [`Error::Snapshot`] if it contradicts itself, and the errors of [`new`](Self::new),
    /// [`advance`](Self::advance) and the setters.
    pub fn restore(snapshot: Snapshot) -> Result<Self, Error> {
        let Snapshot {
            scene,
            now,
            reported,
            lookahead,
            levels,
            ..
        } = snapshot;
        let mut monitor = Self::new(scene, reported, lookahead, &levels)?;
        monitor.check_clock(now)?;
        let contradiction = |problem| Err(Error::Snapshot { problem });
        if snapshot.has_reported_all && reported < now {
            return contradiction("its events do not reach up to its clock");
        }
        let lengths = [snapshot.encounters.len(), snapshot.end_reported.len()];
        if lengths != [levels.len(), monitor.scene.slots()] {
            return contradiction("its lists do not fit its scene");
        }
        let could_be =
            |(level, saved): (usize, &Saved)| saved.could_be(level, reported, monitor.scene());
        if !snapshot.encounters.iter().enumerate().all(could_be) {
            return contradiction("its encounters cannot be");
        }
        let mut ids = Vec::new();
        for event in &snapshot.pending_events {
            match event.kind {
                EventKind::Ended(it, _) | EventKind::Withdrawn(it) => {
                    if !(event.time.is_finite() && it.could_be(levels.len())) {
                        return contradiction("its encounters cannot be");
                    }
                    ids.push(it.id.0);
                }
                _ => return contradiction("what waits to be reported is no end"),
            }
        }
        ids.extend(snapshot.encounters.iter().flat_map(Saved::ids));
        ids.sort_unstable();
        let next_id = snapshot.next_id;
        let are_new = ids.last().is_none_or(|last| *last < next_id);
        if !are_new || ids.windows(2).any(|ids| ids[0] == ids[1]) || next_id > MAX_ENCOUNTERS {
            return contradiction("its encounters are not told apart");
        }
        check_revision_threshold(snapshot.revision_threshold)?;
        check_setting("history", snapshot.history)?;
        monitor.now = without_negative_zero(now);
        monitor.search.since_unknown = snapshot.since_unknown;
        if snapshot.has_reported_all {
            // All of it has been reported, and there was room for it. Searched anew, it may have some more spans; and the limit
            // may have been lowered since.
            monitor.set_max_spans(snapshot.max_spans.max(Self::MAX_SPANS).saturating_mul(2));
            monitor.advance(now, &mut Vec::new())?;
            // The other monitor did not make this tick.
            monitor.search.since_unknown = snapshot.since_unknown;
        }
        monitor.revision_threshold = snapshot.revision_threshold;
        monitor.history = snapshot.history;
        monitor.set_max_spans(snapshot.max_spans);
        monitor.next_id = next_id;
        for (number, saved) in snapshot.encounters.into_iter().enumerate() {
            monitor.encounters[number] = EncounterTracker::restored(number, saved);
        }
        monitor.pending_events = snapshot.pending_events;
        for (slot, _) in (0..)
            .zip(snapshot.end_reported)
            .filter(|(_, was_reported)| *was_reported)
        {
            monitor.plan_ends.set(slot, f64::INFINITY);
        }
        Ok(monitor)
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a failure fails the test")]

    use super::*;
    use crate::monitor::AlertLevel;
    use crate::scene::{Body, Scene};
    use crate::trajectory::Trajectory;

    /// The snapshot of a monitor of bodies 10 m apart, watched at 1 m, that has caught up at 0 s.
    fn snapshot(count: u32) -> Snapshot {
        let mut scene = Scene::new();
        for place in 0..count {
            let plan = Trajectory::at_rest([10.0 * f64::from(place), 0.0, 0.0]).unwrap();
            scene.insert(Body::new(plan)).unwrap();
        }
        let mut monitor = Monitor::new(scene, 0.0, 1.0, &[AlertLevel::at(1.0)]).unwrap();
        monitor.advance(0.0, &mut Vec::new()).unwrap();
        monitor.snapshot()
    }

    /// A file in which a margin was changed takes no more memory than there is room for: the 12 million pairs would take
    /// some 40 GB.
    #[test]
    fn a_crowd_in_a_file_is_refused() {
        let mut changed = snapshot(5_000);
        assert!(changed.has_reported_all);
        changed.levels[0] = AlertLevel::at(1e9);
        changed.max_spans = 1;
        let refused = Monitor::restore(changed).map(drop);
        let limit = 2 * Monitor::MAX_SPANS;
        assert!(matches!(refused, Err(Error::TooCrowded { limit: found, .. }) if found == limit));
        // The limit may have been lowered since.
        let mut lowered = snapshot(3);
        lowered.levels[0] = AlertLevel::at(1e9);
        lowered.max_spans = 1;
        let restored = Monitor::restore(lowered).unwrap();
        assert_eq!(restored.conflicts(0).unwrap().len(), 3);
        assert_eq!(restored.max_spans(), 1);
    }

    /// A monitor that has reported all has reported up to its clock. Otherwise encounters that begin in between would begin too
    /// late, or never.
    #[test]
    fn a_clock_that_was_changed_is_refused() {
        let mut changed = snapshot(2);
        changed.now = 0.5;
        let refused = Monitor::restore(changed).map(drop);
        assert!(matches!(refused, Err(Error::Snapshot { .. })));
    }
}
