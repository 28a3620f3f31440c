//! Reading the outlook: the conflicts that are reported, and the plain encounters that feed the
//! state machine.

use super::Monitor;
use super::encounters::{Plain, Tick};
use super::outlook::{Group, Outlook};
use crate::broad_phase::Sweep;
use crate::conflict::{ClosestApproach, Conflict};
use crate::narrow_phase::Contact;
use crate::scene::Scene;
use crate::screen::conflict;

impl Monitor {
    /// The conflicts of a level from now to the end of what is known.
    pub(super) fn read_conflicts(&mut self, level: usize, window: (f64, f64)) {
        let margin = self.levels[level].margin;
        let conflicts = &mut self.conflicts[level];
        conflicts.clear();
        if window.1 < window.0 {
            return;
        }
        let (outlook, scene, contacts) = (&self.outlook, &self.scene, &mut self.contacts);
        outlook.each_pair(window, |pair, clip, group| {
            group.contacts(margin, clip, contacts);
            for contact in &*contacts {
                conflicts.extend(report(outlook, scene, pair, clip, contact));
            }
        });
        conflicts.sort_unstable_by(Conflict::order);
    }

    /// The plain encounters of a level from the last tick's clock to the end of what is known.
    pub(super) fn read_plain(&mut self, level: usize, tick: &Tick) {
        let alert = self.levels[level];
        self.plain.clear();
        let Self {
            outlook,
            scene,
            contacts,
            released,
            passed,
            plain,
            ..
        } = self;
        outlook.each_pair((tick.before, tick.known), |pair, clip, group| {
            group.contacts(alert.margin, clip, contacts);
            if alert.release > alert.margin {
                group.contacts(alert.release, clip, released);
            } else {
                released.clone_from(contacts);
            }
            let ends = outlook.domain(pair).map_or(tick.known, |(_, end)| end);
            for hold in &*released {
                let within = contacts
                    .iter()
                    .filter(|contact| contact.enter >= hold.enter && contact.exit <= hold.exit);
                let first = within.clone().next();
                let closest = report(outlook, scene, pair, clip, hold);
                let Some(closest) = closest else { continue };
                plain.push(Plain {
                    a: closest.a,
                    b: closest.b,
                    enter: first.map(|contact| contact.enter),
                    start: hold.enter,
                    exit: hold.exit,
                    open: hold.exit >= tick.known && ends > tick.known,
                    with_trajectory: hold.exit >= ends,
                    closest: closest.closest,
                    passed: passed_closest(
                        (outlook, scene),
                        pair,
                        group,
                        alert.release,
                        (hold.enter, hold.exit.min(tick.told)),
                        passed,
                    ),
                });
            }
        });
    }
}

fn report(
    outlook: &Outlook<Sweep>,
    scene: &Scene,
    (a, b): (u32, u32),
    clip: (f64, f64),
    contact: &Contact,
) -> Option<Conflict> {
    let ids = (scene.in_slot(a)?.0, scene.in_slot(b)?.0);
    let parties = (outlook.flight(a)?.party(), outlook.flight(b)?.party());
    Some(conflict(contact, ids, (&parties.0, &parties.1), clip))
}

/// The closest approach over the part of an encounter that the clock has passed.
fn passed_closest(
    (outlook, scene): (&Outlook<Sweep>, &Scene),
    pair: (u32, u32),
    group: &Group<'_>,
    margin: f64,
    part: (f64, f64),
    scratch: &mut Vec<Contact>,
) -> Option<ClosestApproach> {
    if part.0 > part.1 {
        return None;
    }
    group.contacts(margin, part, scratch);
    let conflicts = scratch
        .iter()
        .filter_map(|contact| report(outlook, scene, pair, part, contact));
    conflicts
        .map(|conflict| conflict.closest)
        .reduce(|x, y| if y.separation < x.separation { y } else { x })
}
