//! Bringing survivors into order: they come by slice, and are solved by pair.

use super::sift::Survivor;

/// Sorts survivors; owns what that takes.
#[derive(Clone, Debug, Default)]
pub(super) struct Arranger {
    other: Vec<Survivor>,
    /// Where the next survivor of each body goes.
    places: Vec<usize>,
}

impl Arranger {
    /// Fewer survivors per body than this are compared with each other instead.
    const BODIES_EACH: usize = 8;

    /// Sorts survivors of this many bodies and keeps each once: a span that lasts for several
    /// slices survives in each.
    ///
    /// Dealt out by their second body and then by their first, in as many steps as there are
    /// survivors and bodies, each is nearly in its place: the spans of a pair come in the order of
    /// the slices, where only those of neighbouring ones overlap.
    pub(super) fn tidy(&mut self, survivors: &mut Vec<Survivor>, bodies: usize) {
        if survivors.len() < bodies / Self::BODIES_EACH {
            survivors.sort_unstable();
        } else {
            self.deal(survivors, bodies, |survivor| survivor.b as usize);
            self.deal(survivors, bodies, |survivor| survivor.a as usize);
            insert(survivors);
        }
        survivors.dedup();
    }

    /// Sorts by a body of each survivor; what has the same body stays in its order.
    fn deal(
        &mut self,
        survivors: &mut Vec<Survivor>,
        bodies: usize,
        body: impl Fn(&Survivor) -> usize,
    ) {
        let Some(&any) = survivors.first() else {
            return;
        };
        self.places.clear();
        self.places.resize(bodies, 0);
        for survivor in &*survivors {
            self.places[body(survivor)] += 1;
        }
        let mut next = 0;
        for place in &mut self.places {
            (*place, next) = (next, next + *place);
        }
        self.other.clear();
        self.other.resize(survivors.len(), any);
        for &survivor in &*survivors {
            let place = &mut self.places[body(&survivor)];
            self.other[*place] = survivor;
            *place += 1;
        }
        std::mem::swap(survivors, &mut self.other);
    }
}

/// Sorts what is nearly sorted.
fn insert(survivors: &mut [Survivor]) {
    for next in 1..survivors.len() {
        let mut place = next;
        while place > 0 && survivors[place] < survivors[place - 1] {
            survivors.swap(place, place - 1);
            place -= 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    /// The same as by comparison: many and few survivors, spans of a pair in any order.
    #[test]
    fn survivors_are_sorted_and_kept_once() {
        let mut rng = ChaCha8Rng::seed_from_u64(6);
        let mut arranger = Arranger::default();
        let mut lost = 0;
        for round in 0..600 {
            let bodies: u32 = [2, 20, 300][round % 3];
            let count = rng.random_range(0..400);
            let mut any = |most: u32| rng.random_range(0..most);
            let mut survivors: Vec<Survivor> = (0..count)
                .map(|_| Survivor::new((any(bodies), any(bodies)), (any(3), any(3))))
                .collect();
            let mut expected = survivors.clone();
            expected.sort_unstable();
            expected.dedup();
            lost += survivors.len() - expected.len();
            arranger.tidy(&mut survivors, bodies as usize);
            assert_eq!(survivors, expected);
        }
        assert!(lost > 1_000, "{lost}");
    }
}
