//! A slab: a list in which values keep their places. A sorted list of short entries tells the places. A search reads
//! the entries, and only entries move when values come or go.

use std::ops::Range;

/// The key, interval and place of a value, which are known without reading the value.
#[derive(Clone, Copy, Debug)]
pub(super) struct IndexEntry<K> {
    pub(super) key: K,
    /// Interval, s.
    pub(super) interval: (f64, f64),
    /// Place of the value, for [`SortedSlab::at`].
    pub(super) place: usize,
}

/// A slab of large values with a sorted index.
#[derive(Clone, Debug)]
pub(super) struct SortedSlab<K, V> {
    /// Sorted by key.
    entries: Vec<IndexEntry<K>>,
    /// Entries added since they were last [merged](SortedSlab::merge_added).
    added: Vec<IndexEntry<K>>,
    merged: Vec<IndexEntry<K>>,
    values: Vec<V>,
    /// Places of values that nobody needs.
    free: Vec<usize>,
}

impl<K, V> Default for SortedSlab<K, V> {
    fn default() -> Self {
        Self {
            entries: Vec::new(),
            added: Vec::new(),
            merged: Vec::new(),
            values: Vec::new(),
            free: Vec::new(),
        }
    }
}

impl<K: Copy + Ord, V> SortedSlab<K, V> {
    /// Returns the entries in the order of their keys; those of one key as they were added.
    pub(super) fn entries(&self) -> &[IndexEntry<K>] {
        &self.entries
    }

    pub(super) fn has(&self, key: &K) -> bool {
        let found = self.entries.binary_search_by(|entry| entry.key.cmp(key));
        found.is_ok()
    }

    /// Returns the numbers of the values with a key, counted in the order of keys.
    pub(super) fn of(&self, key: &K) -> Range<usize> {
        let first = self.entries.partition_point(|entry| entry.key < *key);
        let rest = &self.entries[first..];
        let count = rest.iter().take_while(|entry| entry.key == *key).count();
        first..first + count
    }

    /// Returns a value by its number.
    pub(super) fn nth(&self, number: usize) -> &V {
        &self.values[self.entries[number].place]
    }

    /// Returns all values in the order of their keys.
    pub(super) fn values(&self) -> impl Iterator<Item = &V> {
        self.entries.iter().map(|entry| &self.values[entry.place])
    }

    /// Returns all values in any order, and perhaps some that were dropped.
    pub(super) fn values_mut(&mut self) -> &mut [V] {
        &mut self.values
    }

    /// Returns the value of the entry with this place.
    pub(super) fn at(&self, place: usize) -> &V {
        &self.values[place]
    }

    /// Drops the values for which `keeps`, asked in order, returns false.
    pub(super) fn retain(&mut self, mut keeps: impl FnMut(&IndexEntry<K>, &V) -> bool) {
        let Self {
            entries,
            values,
            free,
            ..
        } = self;
        entries.retain(|entry| {
            let is_kept = keeps(entry, &values[entry.place]);
            if !is_kept {
                free.push(entry.place);
            }
            is_kept
        });
    }

    /// Adds a value. It is among the entries after the next [merge](Self::merge_added): until then, keys
    /// come in ascending order, or each once.
    pub(super) fn add(&mut self, key: K, interval: (f64, f64), value: V) {
        let place = if let Some(place) = self.free.pop() {
            self.values[place] = value;
            place
        } else {
            self.values.push(value);
            self.values.len() - 1
        };
        self.added.push(IndexEntry {
            key,
            interval,
            place,
        });
    }

    /// Sorts the added values into the entries.
    pub(super) fn merge_added(&mut self) {
        if self.added.is_empty() {
            return;
        }
        if !self.added.is_sorted_by_key(|entry| entry.key) {
            self.added.sort_unstable_by_key(|entry| entry.key);
        }
        self.merged.clear();
        let mut rest = &self.entries[..];
        for new in self.added.drain(..) {
            let before = rest.partition_point(|entry| entry.key <= new.key);
            self.merged.extend_from_slice(&rest[..before]);
            self.merged.push(new);
            rest = &rest[before..];
        }
        self.merged.extend_from_slice(rest);
        std::mem::swap(&mut self.entries, &mut self.merged);
    }
}

#[cfg(test)]
mod tests {
    use super::SortedSlab;
    use rand::rngs::ChaCha8Rng;
    use rand::{RngExt, SeedableRng};

    #[test]
    fn equals_a_plain_sorted_list_whatever_comes_and_goes() {
        let mut rng = ChaCha8Rng::seed_from_u64(4);
        let (mut kept, mut plain) = (SortedSlab::default(), Vec::<(u32, u32)>::new());
        let mut most = 0;
        for value in 0..2000 {
            let gone: u32 = rng.random_range(0..8);
            kept.retain(|entry, _| entry.key % 8 != gone);
            plain.retain(|(key, _)| key % 8 != gone);
            let mut keys: Vec<u32> = (0..5).map(|_| rng.random_range(0..100)).collect();
            keys.sort_unstable();
            for key in keys {
                kept.add(key, (0.0, 0.0), value);
                plain.push((key, value));
            }
            kept.merge_added();
            plain.sort_by_key(|(key, _)| *key);
            let entries = kept.entries().iter();
            let found: Vec<_> = entries.map(|one| (one.key, *kept.at(one.place))).collect();
            assert_eq!(found, plain);
            for key in 0..100 {
                assert_eq!(kept.has(&key), plain.iter().any(|one| one.0 == key));
            }
            most = most.max(plain.len());
        }
        assert_eq!(kept.values.len(), most, "places are used again");
    }
}
