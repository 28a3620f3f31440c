//! A queue of due instants of bodies, soonest first.

use super::time_key::TimeKey;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// An instant for each slot, or none.
///
/// Instants mostly move on, with new plans, before they have come. Then nothing is done: a slot waits
/// in the queue for the soonest instant that it had, and is put off when that has come.
#[derive(Debug, Default)]
pub(super) struct DueQueue {
    /// Instant at which each slot is due, s; infinite if never.
    due: Vec<f64>,
    /// Soonest entry of each slot in the queue, s; infinite if there is none.
    queued: Vec<f64>,
    /// A slot that is due has an entry that is no later.
    queue: BinaryHeap<Reverse<TimeKey<u32>>>,
}

impl DueQueue {
    /// Entries that are not too many, whatever there is.
    const FEW: usize = 1024;

    /// Sets the one instant (s) at which a slot is due; infinity stands for never.
    pub(super) fn set(&mut self, slot: u32, time: f64) {
        let place = slot as usize;
        if self.due.len() <= place {
            self.due.resize(place + 1, f64::INFINITY);
            self.queued.resize(place + 1, f64::INFINITY);
        }
        self.due[place] = time;
        self.enqueue(slot);
    }

    /// Returns true if a slot is due at some time.
    pub(super) fn has(&self, slot: u32) -> bool {
        self.due
            .get(slot as usize)
            .is_some_and(|&due| due < f64::INFINITY)
    }

    /// Removes and returns the slot that is due soonest, if it is due by `time` (s).
    pub(super) fn next(&mut self, time: f64) -> Option<u32> {
        self.next_with_time(time).map(|(slot, _)| slot)
    }

    /// Returns [`next`](Self::next), and when it was due, s.
    pub(super) fn next_with_time(&mut self, time: f64) -> Option<(u32, f64)> {
        while let Some(&Reverse(entry)) = self.queue.peek()
            && entry.time <= time
        {
            self.queue.pop();
            let place = entry.what as usize;
            // Else there was a sooner one, at which it was looked at.
            if entry.time.total_cmp(&self.queued[place]).is_eq() {
                self.queued[place] = f64::INFINITY;
                if self.due[place] <= time {
                    let due = std::mem::replace(&mut self.due[place], f64::INFINITY);
                    return Some((entry.what, due));
                }
                self.enqueue(entry.what);
            }
        }
        None
    }

    /// Enters a slot into the queue, unless an entry of it comes in time.
    fn enqueue(&mut self, slot: u32) {
        let place = slot as usize;
        let time = self.due[place];
        if time < self.queued[place] {
            self.queued[place] = time;
            self.queue.push(Reverse(TimeKey { time, what: slot }));
            // Instants that come ever sooner leave entries behind.
            if self.queue.len() > Self::FEW + 2 * self.due.len() {
                self.queue.clear();
                let queued = (0..).zip(&self.queued);
                let queued = queued.filter(|(_, time)| **time < f64::INFINITY);
                self.queue
                    .extend(queued.map(|(slot, &time)| Reverse(TimeKey { time, what: slot })));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::DueQueue;
    use rand::rngs::ChaCha8Rng;
    use rand::{RngExt, SeedableRng};

    #[test]
    fn equals_a_plain_list_whatever_is_put_off_and_brought_forward() {
        const SLOTS: u32 = 50;
        let mut rng = ChaCha8Rng::seed_from_u64(8);
        let mut calendar = DueQueue::default();
        let mut plain = vec![f64::INFINITY; SLOTS as usize];
        let mut told = 0;
        for round in 0..20_000 {
            let now = 0.5 * f64::from(round);
            for _ in 0..rng.random_range(0..4) {
                let slot = rng.random_range(0..SLOTS);
                let time = match rng.random_range(0..5) {
                    0 => f64::INFINITY,
                    1 => now - 1.0,
                    // Ever sooner, for as long as nobody is told.
                    2 => 1e5 - f64::from(round),
                    _ => (now + rng.random_range(0.0..9.0)).round(),
                };
                calendar.set(slot, time);
                plain[slot as usize] = time;
                assert_eq!(calendar.has(slot), time < f64::INFINITY);
            }
            let mut found = Vec::new();
            while let Some(slot) = calendar.next(now) {
                found.push(slot);
            }
            found.sort_unstable();
            let due = (0..SLOTS).filter(|slot| plain[*slot as usize] <= now);
            assert_eq!(found, due.collect::<Vec<_>>(), "{now}");
            told += found.len();
            for slot in found {
                plain[slot as usize] = f64::INFINITY;
            }
            assert!(calendar.queue.len() <= DueQueue::FEW + 2 * SLOTS as usize);
        }
        assert!(told > 5_000, "{told}");
    }
}
