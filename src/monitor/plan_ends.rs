//! Ends of plans: each is reported once, when the lookahead reaches it.

use super::Monitor;
use super::event::{Event, EventKind};
use crate::id::BodyId;
use crate::trajectory::{Outside, Trajectory};

impl Monitor {
    /// Schedules the report of a new plan's end.
    pub(super) fn watch_plan_end(&mut self, id: BodyId) {
        let body = self.scene.body(id);
        let end = body.and_then(|body| plan_end(&body.trajectory));
        self.plan_ends.set(id.slot, end.unwrap_or(f64::INFINITY));
    }

    /// Schedules the reports of all plans' ends.
    pub(super) fn watch_plan_ends(&mut self) {
        for (id, body) in self.scene.bodies() {
            if let Some(end) = plan_end(&body.trajectory) {
                self.plan_ends.set(id.slot, end);
            }
        }
    }

    /// Reports each plan that ends within the lookahead, once.
    pub(super) fn report_plan_ends(&mut self, end: f64, events: &mut Vec<Event>) {
        let scene = &self.scene;
        self.plan_ends.take(end, |slot, _| {
            let Some((id, entry)) = scene.in_slot(slot) else {
                return;
            };
            events.extend(plan_end(&entry.body.trajectory).map(|time| Event {
                time,
                kind: EventKind::PlanEnds {
                    body: id,
                    tag: entry.body.tag,
                },
            }));
        });
    }
}

/// Returns the end of a plan without a rule beyond it, s.
fn plan_end(trajectory: &Trajectory) -> Option<f64> {
    let last = trajectory.knots().last().copied();
    last.filter(|_| trajectory.outside_after() == Outside::Absent)
}
