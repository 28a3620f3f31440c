//! A key ordered by time.

use std::cmp::Ordering;

/// A value at an instant (s), ordered by time, then by value.
#[derive(Clone, Copy, Debug)]
pub(super) struct TimeKey<K> {
    pub(super) time: f64,
    pub(super) what: K,
}

impl<K: Ord> Ord for TimeKey<K> {
    fn cmp(&self, other: &Self) -> Ordering {
        let order = self.time.total_cmp(&other.time);
        order.then_with(|| self.what.cmp(&other.what))
    }
}

impl<K: Ord> PartialOrd for TimeKey<K> {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl<K: Ord> PartialEq for TimeKey<K> {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl<K: Ord> Eq for TimeKey<K> {}
