//! States told some times a second instead of a plan: what a monitor then predicts.

use crate::table::Table;
use crate::timing::median;
use crate::world::World;
use crate::{Effort, Failure};
use nearmiss::{Accuracy, AlertLevel, BodyId, EventKind, Monitor, Query};
use std::collections::{BTreeMap, BTreeSet};

/// Time ahead that is looked at, s.
const AHEAD: f64 = 2.0;

/// States told a second against predictions and time.
pub(super) fn table(effort: &Effort) -> Result<Table, Failure> {
    let count = effort.choose(2_000, 300);
    let world = World::swarm(count, 12.0, effort.choose(20.0, 5.0))?;
    let (start, end) = (world.window.start(), world.window.end());
    let mut table = Table::new(
        "told",
        format!(
            "States told some times a second: {count} bodies that coast in between, {} s, {AHEAD} s ahead (one thread)",
            end - start
        ),
        &[
            "told/s",
            "encounters",
            "seen ahead",
            "seen late",
            "missed",
            "false",
            "ahead s p50",
            "ms/told",
        ],
    );
    let query = Query::new(world.window).with_accuracy(Accuracy::Certified);
    let truth = world.scene.screen(&query)?.conflicts;
    let bodies: Vec<_> = world.scene.bodies().collect();
    for &rate in effort.choose(&[1_u32, 2, 5, 10, 30, 60][..], &[1, 10][..]) {
        let mut monitor = Monitor::new(world.scene.clone(), start, AHEAD, &[AlertLevel::at(0.0)])?;
        // Clocks at which pairs were said to meet, now or ahead, with the instants of their entry.
        let mut told: BTreeMap<(BodyId, BodyId), Vec<(f64, f64)>> = BTreeMap::new();
        let mut began = BTreeSet::new();
        let (mut events, mut times) = (Vec::new(), Vec::new());
        let mut tick = 0_u32;
        loop {
            let now = start + f64::from(tick) / f64::from(rate);
            if now > end {
                break;
            }
            let states = bodies
                .iter()
                .filter_map(|(id, body)| Some((*id, body.trajectory.state(now)?)));
            let states: Vec<_> = states.collect();
            let (done, time) = crate::timing::timed(|| {
                monitor.track(now, states)?;
                monitor.advance(now, &mut events)
            });
            done?;
            times.push(time);
            for event in events.drain(..) {
                let (EventKind::Predicted(one) | EventKind::Revised(one) | EventKind::Began(one)) =
                    event.kind
                else {
                    continue;
                };
                let pair = (one.a, one.b);
                told.entry(pair).or_default().push((now, one.enter));
                if matches!(event.kind, EventKind::Began(_)) {
                    began.insert(pair);
                }
            }
            tick += 1;
        }
        // An event is of an encounter if it says when to within a tenth of a second or a step.
        let near = 0.1_f64.max(1.0 / f64::from(rate));
        let (mut ahead, mut late, mut missed) = (0_usize, 0_usize, 0_usize);
        let mut warnings = Vec::new();
        for conflict in &truth {
            let said = told.get(&(conflict.a, conflict.b));
            let fits = |&&(_, enter): &&(f64, f64)| {
                conflict.enter - near <= enter && enter <= conflict.exit + near
            };
            match said.and_then(|said| said.iter().find(fits)) {
                Some((first, _)) if *first < conflict.enter => {
                    ahead += 1;
                    warnings.push(conflict.enter - first);
                }
                Some(_) => late += 1,
                None => missed += 1,
            }
        }
        let pairs: BTreeSet<_> = truth
            .iter()
            .map(|conflict| (conflict.a, conflict.b))
            .collect();
        let wrong = began.difference(&pairs).count();
        table.row(vec![
            u64::from(rate).into(),
            truth.len().into(),
            ahead.into(),
            late.into(),
            missed.into(),
            wrong.into(),
            median(warnings).into(),
            (1e3 * median(times)).into(),
        ]);
    }
    table.note("The bodies curve: a state says where they go until the next one. A plan, told once, finds all of them.");
    table.note("false: pairs said to have met which never did.");
    Ok(table)
}
