//! Every span in which a pair comes within the largest margin, solved once and kept.

use super::bodies::BodyTable;
use super::sorted_slab::{IndexEntry, SortedSlab};
use crate::conflict::Clip;
use crate::narrow_phase::{Approach, Contact, KeptQuestion, SolvedSpan, contacts_of, solve};
use crate::search::LimitExceeded;
use crate::spans::SpanKey;
use std::collections::BTreeMap;

/// Two bodies, the smaller slot first.
pub(super) type SlotPair = (u32, u32);

fn pair_of(key: &SpanKey) -> SlotPair {
    (key.a, key.b)
}

fn contains(interval: (f64, f64), time: f64) -> bool {
    interval.0 <= time && time <= interval.1
}

/// The solved spans of all pairs.
#[derive(Debug)]
pub(super) struct SolvedSpans {
    /// The solution of each span for each two spheres.
    spans: SortedSlab<SpanKey, SolvedSpan>,
    /// Margins at which contacts are read, m, ascending.
    margins: Vec<f64>,
    /// True if spans may be kept that are solved for whole contacts alone.
    has_whole_contacts: bool,
    /// Pairs to which spans were added, or with a body of which all was forgotten, since they were
    /// read. (Not those of which something has passed: that changes nothing
    /// that is still to come, and who reads them sees when.)
    pub(super) changed_pairs: Vec<SlotPair>,
    /// Spans of turning bodies of which only a part is solved, and the end of that part, s.
    partly_solved: BTreeMap<SpanKey, f64>,
}

impl SolvedSpans {
    /// Returns an empty list for contacts at some margins (m, ascending).
    pub(super) fn at(margins: Vec<f64>) -> Self {
        Self {
            spans: SortedSlab::default(),
            margins,
            has_whole_contacts: false,
            changed_pairs: Vec::new(),
            partly_solved: BTreeMap::new(),
        }
    }

    pub(super) const fn has_whole_contacts(&self) -> bool {
        self.has_whole_contacts
    }

    pub(super) fn margins(&self) -> &[f64] {
        &self.margins
    }

    /// Returns the number of solved spans.
    pub(super) fn len(&self) -> usize {
        self.spans.entries().len()
    }

    /// Forgets all that concerns some pairs.
    pub(super) fn forget(&mut self, is_gone: impl Fn(SlotPair) -> bool) {
        let changed = &mut self.changed_pairs;
        self.spans.retain(|entry, _| {
            let is_gone = is_gone(pair_of(&entry.key));
            if is_gone {
                changed.push(pair_of(&entry.key));
            }
            !is_gone
        });
        self.partly_solved.retain(|key, _| !is_gone(pair_of(key)));
    }

    /// Forgets spans that end before `from` (s).
    pub(super) fn forget_before(&mut self, from: f64) {
        self.spans.retain(|entry, _| entry.interval.1 >= from);
        self.has_whole_contacts &= self.len() > 0;
        self.partly_solved.retain(|_, until| *until >= from);
    }

    /// Solves the survivors (sorted, each once) that are not there yet, and keeps those that come
    /// within the largest margin; returns how many were solved. Those of turning bodies are solved in a window from one
    /// instant to another (s). The `cuts` (s) are instants at which windows will probably cut contacts: what lasts then is solved
    /// for any window at once.
    ///
    /// # Errors
    ///
    /// If there were more than `most` in all.
    pub(super) fn add(
        &mut self,
        survivors: &[SpanKey],
        bodies: &BodyTable<'_>,
        (window, cuts): ((f64, f64), &[f64]),
        most: usize,
    ) -> Result<u64, LimitExceeded> {
        let room = most.saturating_sub(self.len());
        let (mut count, mut added) = (0, 0);
        let asked = KeptQuestion {
            margins: &self.margins,
            cuts: Some(cuts),
        };
        for &key in survivors {
            let begun = self.partly_solved.get(&key).copied();
            if begun.is_none() && self.spans.has(&key) {
                continue;
            }
            let after = begun.unwrap_or(f64::NEG_INFINITY);
            if after > window.1 {
                continue;
            }
            let views = [key.a, key.b].map(|slot| bodies.get(slot));
            let [Some(a), Some(b)] = views else {
                continue;
            };
            count += 1;
            let span = key.span(&a.knots, &b.knots);
            let before = added;
            let part = (window, after);
            let solved_until = solve(&a, &b, span, &asked, part, |interval, solved| {
                // A body that turns has as many parts as its turns: one pair alone may fill the memory.
                if added <= room {
                    self.has_whole_contacts |= !solved.may_be_cut_anywhere();
                    self.spans.add(key, interval, solved);
                }
                added += 1;
            });
            if solved_until < f64::INFINITY {
                self.partly_solved.insert(key, solved_until);
            } else if begun.is_some() {
                self.partly_solved.remove(&key);
            }
            if added > before {
                self.changed_pairs.push(pair_of(&key));
            }
            if added > room {
                self.spans.merge_added();
                return Err(LimitExceeded);
            }
        }
        self.spans.merge_added();
        Ok(count)
    }

    /// Returns true if a pair has a span that contains an instant (s), and that is not solved for windows that cut a contact
    /// there.
    pub(super) fn is_incomplete(&self, pair: SlotPair, time: f64) -> bool {
        self.has_whole_contacts
            && self
                .of(pair)
                .any(|entry| contains(entry.interval, time) && !self.may_be_cut(entry, time))
    }

    /// Returns true if a window may cut a contact at an instant (s) in what is solved of a span.
    fn may_be_cut(&self, entry: &IndexEntry<SpanKey>, time: f64) -> bool {
        self.spans.at(entry.place).may_be_cut(time, entry.interval)
    }

    /// Solves the spans of some pairs (sorted) that contain an instant (s) anew, for any window.
    ///
    /// # Errors
    ///
    /// If there are more than `most` in all then.
    pub(super) fn complete(
        &mut self,
        pairs: &[SlotPair],
        (time, most): (f64, usize),
        bodies: &BodyTable<'_>,
    ) -> Result<(), LimitExceeded> {
        let mut keys = Vec::new();
        self.spans.retain(|entry, _| {
            let pair = pair_of(&entry.key);
            let is_kept = !contains(entry.interval, time) || pairs.binary_search(&pair).is_err();
            if !is_kept && keys.last() != Some(&entry.key) {
                keys.push(entry.key);
            }
            is_kept
        });
        for key in keys {
            solve_at(key, time, bodies, &self.margins, |interval, solved| {
                self.spans.add(key, interval, solved);
            });
            self.changed_pairs.push(pair_of(&key));
        }
        self.spans.merge_added();
        if self.len() > most {
            return Err(LimitExceeded);
        }
        Ok(())
    }

    /// Keeps those changed pairs that have a [plateau](Self::has_plateau); returns true if there are any.
    pub(super) fn keep_changed_plateaus(&mut self) -> bool {
        let mut changed = std::mem::take(&mut self.changed_pairs);
        changed.retain(|pair| self.has_plateau(*pair));
        self.changed_pairs = changed;
        !self.changed_pairs.is_empty()
    }

    /// Sorts the pairs that have changed, each once.
    pub(super) fn sort_changed_pairs(&mut self) {
        self.changed_pairs.sort_unstable();
        self.changed_pairs.dedup();
    }

    fn of(&self, pair: SlotPair) -> impl Iterator<Item = &IndexEntry<SpanKey>> {
        let entries = self.spans.entries();
        let first = entries.partition_point(|entry| pair_of(&entry.key) < pair);
        let of_pair = move |entry: &&IndexEntry<SpanKey>| pair_of(&entry.key) == pair;
        entries[first..].iter().take_while(of_pair)
    }

    /// Finds all contacts of a pair within `margin` in `window`, in the order of time; replaces the content of
    /// `found`.
    pub(super) fn contacts(
        &self,
        pair: SlotPair,
        margin: f64,
        window: (f64, f64),
        found: &mut Vec<Contact>,
    ) {
        found.clear();
        let solved = self.of(pair).map(|entry| self.spans.at(entry.place));
        contacts_of(solved, margin, window, found);
    }

    /// Returns true if the distance of two spheres of a pair is constant over one of its spans.
    pub(super) fn has_plateau(&self, pair: SlotPair) -> bool {
        let mut solved = self.of(pair).map(|entry| self.spans.at(entry.place));
        solved.any(SolvedSpan::is_plateau)
    }

    /// Returns the closest approach of a pair without [plateaus](Self::has_plateau) in a part of a contact (s); `clip` says
    /// which ends of the part are not those of the contact.
    pub(super) fn closest(&self, pair: SlotPair, part: (f64, f64), clip: Clip) -> Option<Approach> {
        let overlaps =
            |entry: &&IndexEntry<SpanKey>| entry.interval.0 <= part.1 && part.0 <= entry.interval.1;
        let solved = self.of(pair).filter(overlaps);
        let approaches = solved.map(|entry| self.spans.at(entry.place).closest(part, clip));
        approaches.reduce(Approach::or_lower)
    }

    /// Returns how near two bodies are at an instant (s), if a kept span contains it.
    pub(super) fn closest_at(
        &self,
        pair: SlotPair,
        time: f64,
        bodies: &BodyTable<'_>,
    ) -> Option<Approach> {
        let at = (time, time);
        let kept = self.closest(pair, at, Clip::default());
        let cut = self
            .of(pair)
            .filter(|entry| contains(entry.interval, time) && !self.may_be_cut(entry, time));
        let mut keys: Vec<SpanKey> = cut.map(|entry| entry.key).collect();
        keys.dedup();
        let mut approaches = Vec::from_iter(kept);
        for key in keys {
            solve_at(key, time, bodies, &self.margins, |_, solved| {
                approaches.push(solved.closest(at, Clip::default()));
            });
        }
        approaches.into_iter().reduce(Approach::or_lower)
    }
}

/// Solves a span, or those parts of it that contain an instant (s), for any window.
fn solve_at(
    key: SpanKey,
    time: f64,
    bodies: &BodyTable<'_>,
    margins: &[f64],
    mut visit: impl FnMut((f64, f64), SolvedSpan),
) {
    let (Some(a), Some(b)) = (bodies.get(key.a), bodies.get(key.b)) else {
        return;
    };
    let asked = KeptQuestion {
        margins,
        cuts: None,
    };
    let part = ((time, time), f64::NEG_INFINITY);
    solve(
        &a,
        &b,
        key.span(&a.knots, &b.knots),
        &asked,
        part,
        |interval, solved| {
            // A part that ends a rounding before counts as met.
            if contains(interval, time) {
                visit(interval, solved);
            }
        },
    );
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a failure fails the test")]

    use super::*;
    use crate::hitbox::{Hitbox, Sphere};
    use crate::monitor::{AlertLevel, Monitor};
    use crate::orientation::Orientation;
    use crate::rounding::exact::vector;
    use crate::scene::{Body, Scene};
    use crate::trajectory::{State, Trajectory};
    use glam::{DQuat, DVec3};
    use rand::SeedableRng;
    use rand::rngs::ChaCha8Rng;

    /// One span of a body that turns on the ground for an hour has thousands of parts.
    #[test]
    fn a_pair_that_turns_takes_no_more_than_the_room() {
        const ROOM: usize = 10;
        const LOOKAHEAD: f64 = 3_600.0;
        let rest = Body::new(Trajectory::at_rest(DVec3::ZERO).unwrap());
        let ground = Hitbox::half_space(DVec3::Z).unwrap();
        let spheres = [-1.0, 1.0].map(|x| Sphere::new([x, 0.0, 0.0], 0.5));
        let spin = Orientation::spin(0.0, DQuat::IDENTITY, 10.0 * DVec3::Y).unwrap();
        let wheel = rest.clone().with_orientation(spin);
        let wheel = wheel.with_hitbox(Hitbox::cluster(spheres.to_vec()).unwrap());
        let mut scene = Scene::new();
        scene.insert(rest.with_hitbox(ground)).unwrap();
        scene.insert(wheel).unwrap();
        let levels = [AlertLevel::at(0.0)];
        let mut monitor = Monitor::new(scene, 0.0, LOOKAHEAD, &levels).unwrap();
        monitor.advance(0.0, &mut Vec::new()).unwrap();
        let search = &monitor.search;
        assert!(search.solved.len() > 100 * ROOM);
        let span = [search.solved.spans.entries()[0].key];
        let bodies = BodyTable::of(&monitor.scene, &search.monitored, &search.grid);
        let mut solved = SolvedSpans::at(AlertLevel::margins(&levels));
        let refused = solved.add(&span, &bodies, ((0.0, LOOKAHEAD), &[]), ROOM);
        assert!(refused.is_err());
        assert_eq!(solved.len(), ROOM + 1);
    }

    /// At an instant within a contact ahead, all pairs of spheres count: whether the span is solved for that or not.
    #[test]
    fn how_near_bodies_are_at_an_instant_does_not_depend_on_what_is_kept() {
        let (mut incomplete, mut farther) = (0, 0);
        for seed in 0..40 {
            let mut rng = ChaCha8Rng::seed_from_u64(seed);
            let mut scene = Scene::new();
            for side in [-1.0, 1.0] {
                let spheres = (0..12).map(|_| Sphere::new(vector(&mut rng, 2.0), 0.2));
                let hitbox = Hitbox::cluster(spheres.collect()).unwrap();
                let state = State::new(0.0, 9.0 * side * DVec3::X, -side * DVec3::X);
                let body = Body::new(Trajectory::coasting(state).unwrap());
                let spin = Orientation::spin(0.0, DQuat::IDENTITY, vector(&mut rng, 0.3)).unwrap();
                let turning = body.clone().with_orientation(spin);
                let body = if seed % 2 == 0 { body } else { turning };
                scene.insert(body.with_hitbox(hitbox)).unwrap();
            }
            let levels = [AlertLevel::at(0.5)];
            let mut monitor = Monitor::new(scene, 0.0, 20.0, &levels).unwrap();
            monitor.advance(0.0, &mut Vec::new()).unwrap();
            let search = &mut monitor.search;
            let bodies = BodyTable::of(&monitor.scene, &search.monitored, &search.grid);
            for step in 0..20 {
                let time = 8.0 + 0.1 * f64::from(step);
                let (pair, solved) = ((0, 1), &mut search.solved);
                let was_incomplete = solved.is_incomplete(pair, time);
                let kept = solved.closest(pair, (time, time), Clip::default());
                let found = solved.closest_at(pair, time, &bodies);
                solved
                    .complete(&[pair], (time, usize::MAX), &bodies)
                    .unwrap();
                assert!(!solved.is_incomplete(pair, time));
                let expected = solved.closest(pair, (time, time), Clip::default());
                assert_eq!(found, expected, "{seed} {time}");
                incomplete += usize::from(was_incomplete);
                farther += usize::from(kept != expected);
            }
        }
        assert!(incomplete > 50 && farther > 5, "{incomplete} {farther}");
    }
}
