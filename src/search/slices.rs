//! Cutting the window into slices.

use std::ops::Range;

/// A window cut into slices of equal length. Slices never change an answer, only its cost.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct TimeSlices {
    start: f64,
    end: f64,
    count: u32,
}

/// Statistics of a scene on which the choice of a slice length rests.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct SceneStatistics {
    /// Seconds of existence within the window, added up over bodies.
    pub(crate) body_time: f64,
    /// Metres flown in them.
    pub(crate) path: f64,
    /// Segments flown in them.
    pub(crate) segments: f64,
    /// The world's extent on each axis, m.
    pub(crate) world: [f64; 3],
    /// Typical separation that counts, hitboxes and margin: m.
    pub(crate) reach: f64,
}

impl SceneStatistics {
    /// Bodies that exist at a time, on average over a window.
    pub(crate) fn present(&self, (start, end): (f64, f64)) -> f64 {
        if end > start {
            self.body_time / (end - start)
        } else {
            1.0
        }
    }

    /// Cubics that a body goes through in this time (s), on average.
    pub(crate) fn cubics_in(&self, time: f64) -> f64 {
        if self.body_time > 0.0 {
            self.segments * time / self.body_time
        } else {
            0.0
        }
    }
}

impl SceneStatistics {
    /// More slices of a window are not worth it: forming the boxes of one (and going through it,
    /// if it is empty) costs as much as looking at as many spans, and all the spans of all pairs
    /// are the work that slices can save.
    pub(crate) fn most_slices(&self, window: (f64, f64)) -> f64 {
        let present = self.body_time / (window.1 - window.0);
        // No number where the window is an instant.
        (1.0 + self.spans(window) / (1.0 + present)).max(1.0)
    }

    /// All the spans of all pairs, each counted for both of its bodies.
    pub(crate) fn spans(&self, window: (f64, f64)) -> f64 {
        self.body_time / (window.1 - window.0) * self.segments
    }
}

impl TimeSlices {
    /// Boxes about half as long as the bodies' mean spacing: with longer ones candidates grow with
    /// the cube of their size, with shorter ones the boxes themselves are the cost.
    const SPACINGS_PER_SLICE: f64 = 0.5;
    /// A body's box should not hold more segments than this.
    const MAX_SEGMENTS_PER_SLICE: f64 = 32.0;
    /// However fast the traffic, no more boxes than this in all.
    const MAX_BOXES: f64 = 5e7;
    /// Nor slices.
    const MAX_SLICES: f64 = 1e6;

    /// Slices of `start..=end` (s, finite) by the rule above, from counts alone.
    pub(crate) fn choose((start, end): (f64, f64), traffic: &SceneStatistics) -> Self {
        let duration = end - start;
        let present = traffic.present((start, end));
        let speed = traffic.path / traffic.body_time;
        let volume: f64 = traffic
            .world
            .iter()
            .map(|&side| side.max(traffic.reach).max(f64::MIN_POSITIVE))
            .map(f64::cbrt)
            .product();
        let spacing = (volume / present.max(1.0).cbrt()).max(traffic.reach);
        let length = (Self::SPACINGS_PER_SLICE * spacing / speed)
            .min(Self::MAX_SEGMENTS_PER_SLICE * traffic.body_time / traffic.segments)
            .max(traffic.body_time / Self::MAX_BOXES);
        let count = (duration / length).ceil();
        Self::whole(start, end).with_count(count.min(traffic.most_slices((start, end))))
    }

    /// One slice from `start` to `end` (s, finite).
    pub(crate) const fn whole(start: f64, end: f64) -> Self {
        Self {
            start,
            end,
            count: 1,
        }
    }

    /// Returns the window cut into about `count` slices; one where that is no number.
    pub(crate) fn with_count(self, count: f64) -> Self {
        let count = if count >= 1.0 && count.is_finite() {
            whole_number(count.round().min(Self::MAX_SLICES))
        } else {
            1
        };
        Self { count, ..self }
    }

    /// As many slices, or nearly, so that a few threads have about the same number of them.
    pub(crate) const fn shared_evenly(self) -> Self {
        let share = match self.count {
            0..4 => 1,
            4..16 => 2,
            _ => 4,
        };
        Self {
            count: (self.count + share / 2) / share * share,
            ..self
        }
    }

    /// The duration of a slice, s.
    pub(crate) fn length(&self) -> f64 {
        (self.end - self.start) / f64::from(self.count)
    }

    /// The slice at a share of the window, 0..1.
    pub(crate) fn number_at(&self, share: f64) -> u32 {
        whole_number((share * f64::from(self.count)).floor()).min(self.count - 1)
    }

    pub(crate) const fn count(&self) -> u32 {
        self.count
    }

    /// First and last instant of a slice; neighbours share theirs.
    pub(crate) fn interval(&self, slice: u32) -> (f64, f64) {
        (self.cut(slice), self.cut(slice + 1))
    }

    /// Lists the ends of some slices, s: one more than there are slices.
    /// Replaces what `ends` held.
    pub(crate) fn ends(&self, slices: Range<u32>, ends: &mut Vec<f64>) {
        let cuts = slices.start..=slices.end;
        ends.clear();
        ends.extend(cuts.map(|index| self.cut(index)));
    }

    /// When all of them begin and end, s.
    pub(crate) const fn window(&self) -> (f64, f64) {
        (self.start, self.end)
    }

    fn cut(&self, index: u32) -> f64 {
        if index >= self.count {
            self.end
        } else {
            let share = f64::from(index) / f64::from(self.count);
            (self.start + share * (self.end - self.start)).min(self.end)
        }
    }
}

#[allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a whole number up to MAX_SLICES"
)]
fn whole_number(count: f64) -> u32 {
    count as u32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slices_cover_the_window_without_gaps() {
        let traffic = SceneStatistics {
            body_time: 600.0,
            path: 6000.0,
            segments: 100.0,
            world: [100.0; 3],
            reach: 1.0,
        };
        let slices = TimeSlices::choose((5.0, 65.0), &traffic);
        assert!(slices.count() > 10);
        assert!(slices.interval(0).0.to_bits() == 5.0_f64.to_bits());
        assert!(slices.interval(slices.count() - 1).1.to_bits() == 65.0_f64.to_bits());
        for slice in 1..slices.count() {
            assert!(slices.interval(slice - 1).1.to_bits() == slices.interval(slice).0.to_bits());
        }
    }

    #[test]
    fn counts_that_threads_share_evenly_are_nearly_the_same() {
        let shared = |count| {
            TimeSlices::whole(0.0, 1.0)
                .with_count(count)
                .shared_evenly()
        };
        let counts = [1, 2, 3, 5, 7, 9, 11, 14, 1001].map(|count| shared(f64::from(count)).count());
        assert_eq!(counts, [1, 2, 3, 6, 8, 10, 12, 14, 1000]);
    }

    #[test]
    fn degenerate_traffic_gets_one_slice() {
        let nothing_moves = SceneStatistics {
            body_time: 10.0,
            path: 0.0,
            segments: 0.0,
            world: [0.0; 3],
            reach: 0.0,
        };
        assert_eq!(TimeSlices::choose((0.0, 1.0), &nothing_moves).count(), 1);
        assert_eq!(TimeSlices::choose((2.0, 2.0), &nothing_moves).count(), 1);
    }
}
