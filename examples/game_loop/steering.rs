//! Steering clear: bodies with a predicted encounter look for a plan without one.

use crate::fleet::{Fleet, SPEED};
use glam::DVec3;
use nearmiss::{BodyId, BodyPlan, Conflict, Error};
use std::collections::BTreeSet;

/// Plans that a body thinks of before it takes the best of them.
const MAX_IDEAS: u32 = 12;

impl Fleet {
    /// Looks over plans that were made on a whim, and makes new ones for bodies whose present plan
    /// leads into an encounter: each is asked of the monitor before it is flown.
    pub(crate) fn steer(
        &mut self,
        whims: Vec<(BodyId, BodyPlan)>,
    ) -> Result<Vec<(BodyId, BodyPlan)>, Error> {
        let mut busy: BTreeSet<BodyId> = whims.iter().map(|&(id, _)| id).collect();
        let mut plans = Vec::with_capacity(whims.len());
        for (id, whim) in whims {
            if let Some(plan) = self.clear_plan(id, Some(whim))? {
                plans.push((id, plan));
            }
        }
        let now = self.monitor.now();
        let ahead: Vec<(BodyId, BodyId)> = self
            .monitor
            .conflicts(self.setting.warning)?
            .iter()
            .filter(|conflict| conflict.enter > now)
            .map(|conflict| (conflict.a, conflict.b))
            .collect();
        for (a, b) in ahead {
            // One gives way; the other keeps its course.
            if busy.contains(&a) || busy.contains(&b) {
                continue;
            }
            let id = if self.is_floor(a) { b } else { a };
            busy.insert(id);
            if let Some(plan) = self.clear_plan(id, None)? {
                plans.push((id, plan));
            }
        }
        Ok(plans)
    }

    /// The first plan without a predicted encounter, or the one with the least trouble.
    fn clear_plan(
        &mut self,
        id: BodyId,
        first: Option<BodyPlan>,
    ) -> Result<Option<BodyPlan>, Error> {
        let Some(state) = self.state(id) else {
            return Ok(None);
        };
        let now = self.monitor.now();
        let mut best: Option<(f64, BodyPlan)> = None;
        let mut idea = first;
        for attempt in 0..MAX_IDEAS {
            let plan = match idea.take() {
                Some(plan) => plan,
                None => {
                    // The longer nothing is found, the harder the turn.
                    let strength = SPEED * f64::from(attempt + 1) / f64::from(MAX_IDEAS);
                    let push = self.planner().gust(1.0).normalize_or(DVec3::X) * strength;
                    let plan = self.planner().plan_with(state, push)?;
                    self.turned(id, plan)?
                }
            };
            let warnings = self.monitor.what_if(id, &plan, self.setting.warning)?;
            if warnings.is_empty() {
                return Ok(Some(plan));
            }
            let contacts = self.monitor.what_if(id, &plan, self.setting.contact)?;
            let trouble = trouble(&warnings, now) + 1e3 * trouble(&contacts, now);
            if best.as_ref().is_none_or(|(least, _)| trouble < *least) {
                best = Some((trouble, plan));
            }
        }
        Ok(best.map(|(_, plan)| plan))
    }
}

/// Sooner is worse.
fn trouble(conflicts: &[Conflict], now: f64) -> f64 {
    conflicts
        .iter()
        .map(|conflict| 1.0 / (1.0 + (conflict.enter - now).max(0.0)))
        .sum()
}
