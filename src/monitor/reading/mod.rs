//! Caches of one alert level: conflicts and planned encounters of all pairs whatever the window, and a list
//! of those in a window.

mod conflicts;
mod encounters;

pub(super) use conflicts::ConflictCache;
pub(super) use encounters::EncounterCache;

/// An inner and an outer window: a contact between the ends of `within` is within the window, one
/// that does not overlap `around` is beyond it, and any other is at its edge.
#[derive(Clone, Copy, Debug)]
pub(super) struct WindowEdges {
    pub(super) within: (f64, f64),
    pub(super) around: (f64, f64),
}

/// The side of a contact relative to a window.
#[derive(PartialEq)]
enum WindowSide {
    Within,
    Beyond,
    AtEdge,
}

impl WindowEdges {
    fn side_of(&self, (start, end): (f64, f64)) -> WindowSide {
        if start > self.within.0 && end < self.within.1 {
            WindowSide::Within
        } else if end < self.around.0 || start > self.around.1 {
            WindowSide::Beyond
        } else {
            WindowSide::AtEdge
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{ConflictCache, EncounterCache, WindowEdges};
    use crate::conflict::{Clip, ClosestApproach, Conflict};
    use crate::id::BodyId;
    use crate::monitor::encounters::PlannedEncounter;
    use crate::monitor::solved_conflict::SolvedConflict;
    use glam::DVec3;

    const CLOSEST: ClosestApproach = ClosestApproach {
        time: 0.0,
        separation: 0.0,
        position_a: DVec3::ZERO,
        position_b: DVec3::ZERO,
        relative_velocity: DVec3::ZERO,
        sphere_a: 0,
        sphere_b: 0,
        model_error: 0.0,
    };

    fn ids((a, b): (u32, u32)) -> (BodyId, BodyId) {
        let id = |slot| BodyId {
            slot,
            generation: 0,
        };
        (id(a), id(b))
    }

    fn conflict(slots: (u32, u32), (enter, exit): (f64, f64)) -> Conflict {
        let (a, b) = ids(slots);
        Conflict {
            a,
            b,
            tag_a: 0,
            tag_b: 0,
            enter,
            exit,
            closest: CLOSEST,
            clip: Clip {
                at_enter: false,
                at_exit: false,
            },
            certificate: None,
        }
    }

    fn solved(slots: (u32, u32), interval: (f64, f64)) -> SolvedConflict {
        SolvedConflict {
            conflict: conflict(slots, interval),
            plateau: 0.0,
            has_plateau: false,
            rests_from: f64::INFINITY,
        }
    }

    fn planned(slots: (u32, u32), (start, exit): (f64, f64)) -> PlannedEncounter {
        PlannedEncounter {
            solved: solved(slots, (start, exit)),
            enter: Some(start),
            open: false,
            passed: None,
        }
    }

    /// Else a monitor would never forget encounters of bodies whose plans do not change.
    #[test]
    fn what_has_ended_is_dropped() {
        let (mut conflicts, mut cache) = (ConflictCache::default(), EncounterCache::default());
        for number in 0..10 {
            let (slots, start) = ((0, number + 1), f64::from(number));
            conflicts.add(slots, solved(slots, (start, start + 0.5)));
            cache.add(slots, planned(slots, (start, start + 0.5)));
        }
        conflicts.merge_added();
        cache.merge_added();
        let all = (f64::NEG_INFINITY, f64::INFINITY);
        let edges = WindowEdges {
            within: all,
            around: all,
        };
        conflicts.drop_changed(&[(0, 9)], 5.2);
        cache.drop_changed(&[(0, 9)], 5.2);
        let left = [6, 7, 8, 10].map(|other| (0, other));
        let mut listed = Vec::new();
        conflicts.list(all, |_, _| None, &mut listed);
        let found = listed.iter().map(|one| one.b.slot);
        assert_eq!(found.collect::<Vec<_>>(), left.map(|(_, other)| other));
        cache.list(edges, &[], |_, _| None);
        let found = cache.listed().filter_map(|(slots, mut planned)| {
            planned.next().map(|planned| {
                assert_eq!(planned.solved.conflict.b.slot, slots.1);
                slots
            })
        });
        assert_eq!(found.collect::<Vec<_>>(), left);
        // The others are looked at once more: something may have been reported of them.
        assert_eq!(cache.listed().count(), 10);
    }

    /// A monitor that never gets anywhere, since its budget is too small for the plans that change,
    /// does not fill the memory: it looks at all pairs once it does.
    #[test]
    fn changes_that_nobody_lists_do_not_add_up() {
        let mut cache = EncounterCache::default();
        let edges = WindowEdges {
            within: (0.0, 1.0),
            around: (0.0, 1.0),
        };
        cache.list(edges, &[], |_, _| None);
        assert!(!cache.lists_all());
        for round in 0..2_000 {
            let slots = (round, round + 1);
            cache.drop_changed(&[(round.max(1) - 1, round), slots], 0.0);
            cache.add(slots, planned(slots, (0.25, 0.5)));
            cache.merge_added();
        }
        assert!(cache.lists_all());
        cache.list(edges, &[(7, 8)], |_, _| None);
        let listed = cache
            .listed()
            .map(|(slots, planned)| (slots, planned.count()));
        assert!(listed.eq([((7, 8), 0), ((1_999, 2_000), 1)]));
        assert!(!cache.lists_all());
    }

    /// Pairs of which nothing has changed are not looked at again.
    #[test]
    fn only_what_may_have_changed_is_listed() {
        let mut cache = EncounterCache::default();
        for number in 0..10 {
            let (slots, start) = ((0, number + 1), f64::from(number));
            cache.add(slots, planned(slots, (start, start + 0.5)));
        }
        cache.merge_added();
        let listed = |cache: &mut EncounterCache, now: f64, known: f64, wait: &[(u32, u32)]| {
            let edges = WindowEdges {
                within: (now, known),
                around: (now - 0.1, known),
            };
            let mut read = Vec::new();
            cache.list(edges, wait, |slots, _| {
                read.push(slots.1);
                None
            });
            let all: Vec<_> = cache.listed().map(|(slots, _)| slots.1).collect();
            (all, read)
        };
        let all: Vec<u32> = (1..=10).collect();
        assert_eq!(listed(&mut cache, 0.9, 4.2, &[]), (all.clone(), vec![5]));
        assert_eq!(listed(&mut cache, 0.9, 4.3, &[]), (vec![5], vec![5]));
        // The clock comes to one; another one lies ahead now with all of it.
        assert_eq!(listed(&mut cache, 1.1, 4.8, &[]), (vec![2, 5], vec![2]));
        assert_eq!(
            listed(&mut cache, 1.2, 4.9, &[(0, 7)]),
            (vec![2, 7], vec![2])
        );
        cache.list_all();
        assert_eq!(listed(&mut cache, 1.2, 4.9, &[]), (all, vec![2]));
    }
}
