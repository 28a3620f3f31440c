//! Division of the window into slices.

use super::pace::Pace;
use crate::count::whole;
use std::ops::Range;

/// A window divided into slices at a [pace](Pace). Answers do not depend on the slices, only the cost does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct TimeSlices<'p> {
    start: f64,
    end: f64,
    count: u32,
    pace: &'p Pace,
}

/// Scene statistics for the choice of a slice length.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct SceneStatistics {
    /// Lifetimes within the window, s, summed over bodies.
    pub(crate) body_time: f64,
    /// Estimate of the distance travelled in them, m.
    pub(crate) path: f64,
    /// Segments followed in them.
    pub(crate) segments: f64,
    /// Extent of the world on each axis, m.
    pub(crate) world: [f64; 3],
    /// The margin, at least 0, m.
    pub(crate) margin: f64,
}

impl SceneStatistics {
    /// Adds the part within a window (s) of a motion between two instants (s), with its path (m) and its number of
    /// segments.
    #[inline]
    pub(crate) fn add(
        &mut self,
        (from, to): (f64, f64),
        (start, end): (f64, f64),
        (path, segments): (f64, u32),
    ) {
        let time = (to.min(end) - from.max(start)).max(0.0);
        self.body_time += time;
        let duration = to - from;
        if duration > 0.0 {
            let share = time / duration;
            self.path += path * share;
            self.segments += f64::from(segments) * share;
        }
    }

    /// Returns the mean number of bodies that exist at a time in a window.
    pub(crate) fn present(&self, (start, end): (f64, f64)) -> f64 {
        if end > start {
            self.body_time / (end - start)
        } else {
            1.0
        }
    }

    /// Returns the mean number of cubics that a body passes in this time (s).
    pub(crate) fn cubics_in(&self, time: f64) -> f64 {
        if self.body_time > 0.0 {
            self.segments * time / self.body_time
        } else {
            0.0
        }
    }

    /// Returns the largest useful number of slices. Forming the boxes of one slice, or passing an
    /// empty one, costs as much as examining as many spans. Slices save at most the work for all
    /// the spans of all pairs.
    pub(crate) fn most_slices(&self, window: (f64, f64)) -> f64 {
        let present = self.body_time / (window.1 - window.0);
        // No number where the window is an instant.
        (1.0 + self.spans(window) / (1.0 + present)).max(1.0)
    }

    /// Returns the number of all spans of all pairs, each counted for both of its bodies.
    pub(crate) fn spans(&self, window: (f64, f64)) -> f64 {
        self.body_time / (window.1 - window.0) * self.segments
    }
}

/// Returns the mean spacing of so many bodies in a world with these sides, m. A side shorter than that does not count: bodies
/// on a plane, or in a thin layer, have no third dimension to be apart in.
fn mean_spacing(mut sides: [f64; 3], count: f64) -> f64 {
    sides.sort_unstable_by(f64::total_cmp);
    let [shortest, middle, longest] = sides;
    let in_space = (shortest.cbrt() * middle.cbrt()) * (longest.cbrt() / count.cbrt());
    if in_space < shortest {
        return in_space;
    }
    let on_plane = middle.sqrt() * (longest.sqrt() / count.sqrt());
    if on_plane < middle {
        on_plane
    } else {
        longest / count
    }
}

impl<'p> TimeSlices<'p> {
    /// Length of boxes in mean spacings of the bodies. With longer boxes, candidates grow with the
    /// cube of their size (on a plane the square); with shorter ones, the boxes themselves dominate.
    const SPACINGS_PER_SLICE: f64 = 0.5;
    /// Largest number of segments in a body's box.
    const MAX_SEGMENTS_PER_SLICE: f64 = 32.0;
    /// Largest number of boxes in all.
    const MAX_BOXES: f64 = 5e7;
    /// Largest number of slices.
    const MAX_SLICES: f64 = 1e6;

    /// Returns slices of a window (s, finite) at a pace by the rule above, from counts alone.
    pub(crate) fn choose(window: (f64, f64), pace: &'p Pace, statistics: &SceneStatistics) -> Self {
        let whole = Self::whole(window.0, window.1).with_pace(pace);
        let (start, end) = whole.effective_window();
        let duration = end - start;
        let present = statistics.present((start, end));
        let speed = statistics.path / statistics.body_time;
        let sides = statistics.world.map(|side| side.max(statistics.margin));
        let spacing = mean_spacing(sides, present.max(1.0)).max(statistics.margin);
        let length = (Self::SPACINGS_PER_SLICE * spacing / speed)
            .min(Self::MAX_SEGMENTS_PER_SLICE * statistics.body_time / statistics.segments)
            .max(statistics.body_time / Self::MAX_BOXES);
        let count = (duration / length).ceil();
        whole.with_count(count.min(statistics.most_slices((start, end))))
    }

    /// Returns one slice from `start` to `end` (s, finite).
    pub(crate) const fn whole(start: f64, end: f64) -> Self {
        static EVEN: Pace = Pace::EVEN;
        Self {
            start,
            end,
            count: 1,
            pace: &EVEN,
        }
    }

    /// Returns the slices at another pace.
    pub(crate) const fn with_pace(self, pace: &'p Pace) -> Self {
        Self { pace, ..self }
    }

    /// Returns the window in about `count` slices; in one if that is NaN or infinite.
    pub(crate) fn with_count(self, count: f64) -> Self {
        let count = if count >= 1.0 && count.is_finite() {
            whole(count.round().min(Self::MAX_SLICES))
        } else {
            1
        };
        Self { count, ..self }
    }

    /// Returns about as many slices, so that a few threads have nearly the same number each.
    pub(crate) const fn shared_evenly(self) -> Self {
        let multiple = match self.count {
            0..4 => 1,
            4..16 => 2,
            _ => 4,
        };
        Self {
            count: (self.count + multiple / 2) / multiple * multiple,
            ..self
        }
    }

    /// Returns the duration of a slice, s: of those in which most bodies exist.
    pub(crate) fn length(&self) -> f64 {
        let (start, end) = self.effective_window();
        (end - start) / f64::from(self.count)
    }

    /// Returns the number of the slice at a share of the window, 0..1.
    pub(crate) fn number_at(&self, share: f64) -> u32 {
        whole(share * f64::from(self.count)).min(self.count - 1)
    }

    pub(crate) const fn count(&self) -> u32 {
        self.count
    }

    /// Returns the first and last instant of a slice; neighbours share theirs.
    pub(crate) fn interval(&self, slice: u32) -> (f64, f64) {
        (self.boundary(slice), self.boundary(slice + 1))
    }

    /// Replaces the content of `ends` by the ends of some slices, s: one more than slices.
    pub(crate) fn ends(&self, slices: Range<u32>, ends: &mut Vec<f64>) {
        let boundaries = slices.start..=slices.end;
        ends.clear();
        ends.extend(boundaries.map(|index| self.boundary(index)));
    }

    /// Returns a window (s) for statistics, shorter than the whole where bodies crowd into some of its time: see
    /// [`Pace`].
    pub(crate) fn effective_window(&self) -> (f64, f64) {
        let duration = self.pace.effective_duration(self.end - self.start);
        (self.start, self.start + duration)
    }

    fn boundary(&self, index: u32) -> f64 {
        // All of the window is searched, whatever some of the bodies tell of the time in which most exist.
        if index == 0 {
            self.start
        } else if index >= self.count {
            self.end
        } else {
            let share = f64::from(index) / f64::from(self.count);
            self.pace.at(share, (self.start, self.end))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slices_cover_the_window_without_gaps() {
        let statistics = SceneStatistics {
            body_time: 600.0,
            path: 6000.0,
            segments: 100.0,
            world: [100.0; 3],
            margin: 1.0,
        };
        let pace = Pace::EVEN;
        let slices = TimeSlices::choose((5.0, 65.0), &pace, &statistics);
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
            margin: 0.0,
        };
        for window in [(0.0, 1.0), (2.0, 2.0)] {
            let pace = Pace::EVEN;
            assert_eq!(TimeSlices::choose(window, &pace, &nothing_moves).count(), 1);
        }
    }
}
