//! Sorting of survivors: found by slice, solved by pair.

use crate::spans::SpanKey;

/// Sorts survivors; owns the buffers.
#[derive(Clone, Debug, Default)]
pub(crate) struct SpanSorter {
    other: Vec<SpanKey>,
    /// Place of the next span of each body.
    places: Vec<usize>,
}

impl SpanSorter {
    /// Number of survivors per body below which comparison is faster.
    const BODIES_EACH: usize = 8;

    /// Sorts survivors of this many bodies and removes duplicates: a span that lasts for several
    /// slices is found in each.
    ///
    /// Distributed by their second body and then by their first, in linear time, survivors are
    /// nearly in order. The spans of a pair come in the order of the slices, where only those of
    /// neighbouring ones overlap.
    pub(crate) fn sort_and_dedup(&mut self, survivors: &mut Vec<SpanKey>, bodies: usize) {
        if survivors.len() < bodies / Self::BODIES_EACH {
            survivors.sort_unstable();
        } else {
            self.deal(survivors, bodies, |survivor| survivor.b as usize);
            self.deal(survivors, bodies, |survivor| survivor.a as usize);
            insert(survivors);
        }
        survivors.dedup();
    }

    /// Sorts by one body of each survivor; stable.
    fn deal(
        &mut self,
        survivors: &mut Vec<SpanKey>,
        bodies: usize,
        body: impl Fn(&SpanKey) -> usize,
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

/// Sorts survivors that were distributed by pair and are nearly in order.
///
/// Spans appended later than others may come in two long sorted parts. A pair with a span that has to move
/// farther than `FAR` is sorted by comparison instead, once. So the steps are at most n log n.
fn insert(survivors: &mut [SpanKey]) {
    /// Places; moving this far costs as much as sorting a few dozen.
    const FAR: usize = 32;
    let mut next = 1;
    while next < survivors.len() {
        let (one, least) = (survivors[next], next.saturating_sub(FAR));
        let mut place = next;
        while place > least && one < survivors[place - 1] {
            survivors[place] = survivors[place - 1];
            place -= 1;
        }
        survivors[place] = one;
        next += 1;
        if place > 0 && one < survivors[place - 1] {
            let is_other = |other: &SpanKey| (other.a, other.b) != (one.a, one.b);
            // Those before it are sorted by pair, and it is of the last one.
            let from = survivors[..place].partition_point(is_other);
            let rest = survivors[next..].iter().position(is_other);
            next = rest.map_or(survivors.len(), |rest| next + rest);
            survivors[from..next].sort_unstable();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::rngs::ChaCha8Rng;
    use rand::{RngExt, SeedableRng};

    fn key((a, b): (u32, u32), (cubic_a, cubic_b): (u32, u32)) -> SpanKey {
        SpanKey {
            a,
            b,
            cubic_a,
            cubic_b,
        }
    }

    /// Equals sorting by comparison: many and few survivors, spans of a pair in any order.
    #[test]
    fn survivors_are_sorted_and_kept_once() {
        let mut rng = ChaCha8Rng::seed_from_u64(6);
        let mut sorter = SpanSorter::default();
        let mut lost = 0;
        for round in 0..600 {
            let bodies: u32 = [2, 20, 300][round % 3];
            let count = rng.random_range(0..400);
            let mut any = |most: u32| rng.random_range(0..most);
            let mut survivors: Vec<SpanKey> = (0..count)
                .map(|_| key((any(bodies), any(bodies)), (any(3), any(3))))
                .collect();
            let mut expected = survivors.clone();
            expected.sort_unstable();
            expected.dedup();
            lost += survivors.len() - expected.len();
            sorter.sort_and_dedup(&mut survivors, bodies as usize);
            assert_eq!(survivors, expected);
        }
        assert!(lost > 1_000, "{lost}");
    }

    /// Two sorted parts of a pair's spans, between those of other pairs. One by one, the second part
    /// would be moved past half of the first: 5 · 10^11 steps, or a quarter of an hour.
    #[test]
    fn two_sorted_parts_of_a_pair_take_no_longer_than_sorting() {
        const LENGTH: u32 = 1_000_000;
        let span = |pair: (u32, u32), number: u32| key(pair, (number, number));
        let even = (0..LENGTH).map(|k| span((1, 2), 2 * k));
        let odd = (0..LENGTH).map(|k| span((1, 2), 2 * k + 1));
        let others = [((0, 1), 7), ((0, 2), 5), ((1, 3), 3), ((2, 3), 1)];
        let others = others.map(|(pair, number)| span(pair, number));
        let mut survivors: Vec<SpanKey> = even.chain(others).chain(odd).collect();
        SpanSorter::default().sort_and_dedup(&mut survivors, 4);
        assert_eq!(survivors.len(), 2 * LENGTH as usize + others.len());
        assert!(survivors.is_sorted());
    }
}
