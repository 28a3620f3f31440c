//! Due instants of bodies.

/// The instant at which the body in each slot is due for some work; none for slots that are never due.
#[derive(Debug, Default)]
pub(super) struct DueTimes {
    /// Instant at which each slot is due, s; infinite if never.
    due: Vec<f64>,
    /// Instant before which no slot of a block is due, by block, s.
    soonest: Vec<f64>,
}

impl DueTimes {
    /// Slots in a block.
    const BLOCK: usize = 64;

    /// Sets the instant (s) at which a slot is due; never, if that is infinite.
    pub(super) fn set(&mut self, slot: u32, time: f64) {
        let place = slot as usize;
        if self.due.len() <= place {
            self.due.resize(place + 1, f64::INFINITY);
            let blocks = self.due.len().div_ceil(Self::BLOCK);
            self.soonest.resize(blocks, f64::INFINITY);
        }
        self.due[place] = time;
        let soonest = &mut self.soonest[place / Self::BLOCK];
        *soonest = soonest.min(time);
    }

    /// Returns the instant at which a slot is due, s; infinite if never.
    pub(super) fn at(&self, slot: u32) -> f64 {
        let due = self.due.get(slot as usize).copied();
        due.unwrap_or(f64::INFINITY)
    }

    /// Takes out the slots that are due by `time` (s): calls `visit` with each, in the order of slots, and
    /// the instant at which it was due (s).
    pub(super) fn take(&mut self, time: f64, mut visit: impl FnMut(u32, f64)) {
        let blocks = self.due.chunks_mut(Self::BLOCK).zip(&mut self.soonest);
        for ((block, soonest), first) in blocks.zip((0_u32..).step_by(Self::BLOCK)) {
            if *soonest > time {
                continue;
            }
            *soonest = f64::INFINITY;
            for (slot, due) in (first..).zip(block) {
                if *due <= time {
                    visit(slot, std::mem::replace(due, f64::INFINITY));
                } else {
                    *soonest = soonest.min(*due);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::DueTimes;
    use rand::rngs::ChaCha8Rng;
    use rand::{RngExt, SeedableRng};

    #[test]
    fn equals_a_plain_list_whatever_is_put_off_and_brought_forward() {
        const SLOTS: u32 = 150;
        let mut rng = ChaCha8Rng::seed_from_u64(8);
        let mut times = DueTimes::default();
        let mut plain = vec![f64::INFINITY; SLOTS as usize];
        let mut announced = 0;
        for round in 0..20_000 {
            let now = 0.5 * f64::from(round);
            for _ in 0..rng.random_range(0..4) {
                let slot = rng.random_range(0..SLOTS);
                let time = match rng.random_range(0..5) {
                    0 => f64::INFINITY,
                    1 => now - 1.0,
                    // Ever sooner, for as long as nobody asks.
                    2 => 1e5 - f64::from(round),
                    _ => (now + rng.random_range(0.0..9.0)).round(),
                };
                times.set(slot, time);
                plain[slot as usize] = time;
                assert_eq!(times.at(slot).to_bits(), time.to_bits());
            }
            let mut found = Vec::new();
            times.take(now, |slot, due| found.push((slot, due.to_bits())));
            let due = (0_u32..).zip(&mut plain).filter(|(_, due)| **due <= now);
            let due =
                due.map(|(slot, due)| (slot, std::mem::replace(due, f64::INFINITY).to_bits()));
            assert_eq!(found, due.collect::<Vec<_>>(), "{now}");
            announced += found.len();
        }
        assert!(announced > 5_000, "{announced}");
    }
}
