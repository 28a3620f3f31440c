//! The pace of slices: where more bodies exist, slices are shorter.

/// Instants of a window by the share of the time of all bodies that has passed by then.
///
/// Slices of equal shares are short where many bodies exist, and long where few do: in a day with two sorties of minutes,
/// nearly all slices are in these. An even pace lets all slices be equally long.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Pace {
    /// Shares and instants (s), both ascending; none if the pace is even.
    points: Vec<(f64, f64)>,
    /// The duration of the window if, all the time, as many bodies existed as a body usually exists with, s: shorter than
    /// the window where bodies crowd into some of it. Not used if the pace is even.
    effective_duration: f64,
}

impl Pace {
    pub(crate) const EVEN: Self = Self {
        points: Vec::new(),
        effective_duration: 0.0,
    };

    /// Returns the pace for bodies with these lifetimes (first and last instant, s) in a window (s, finite), told by some
    /// of them; an even one unless bodies exist far more densely in some of its time.
    pub(crate) fn of(lives: &[(f64, f64)], (start, end): (f64, f64), body_time: f64) -> Self {
        /// Fewer bodies are searched at once.
        const FEW: usize = 64;
        /// Bodies that tell the pace, at most about twice as many.
        const SAMPLED: usize = 512;
        /// A body usually exists with so many times as many others as the mean over the window.
        const DENSE: f64 = 4.0;
        let duration = end - start;
        // The number of bodies at an instant is at most that of all.
        let most = lives.len() as f64 * duration;
        if lives.len() < FEW || !most.is_finite() || DENSE * body_time > most {
            return Self::EVEN;
        }
        let stride = (lives.len() / SAMPLED).max(1);
        let mut changes = Vec::with_capacity(2 * lives.len().div_ceil(stride));
        for &(first, last) in lives.iter().step_by(stride) {
            let (first, last) = (first.max(start), last.min(end));
            if first < last {
                changes.extend([(first, 1.0), (last, -1.0)]);
            }
        }
        changes.sort_unstable_by(|x, y| x.0.total_cmp(&y.0));
        // The time of all sampled bodies so far, and the same with each counted as often as bodies exist.
        let (mut points, mut passed, mut squared) = (vec![(0.0, start)], 0.0, 0.0);
        let (mut present, mut before) = (0.0, start);
        for (time, change) in changes {
            let gone: f64 = time - before;
            passed += present * gone;
            squared += present * present * gone;
            (present, before) = (present + change, time);
            points.push((passed, time));
        }
        points.push((passed, end));
        let effective_duration = passed * passed / squared;
        // No number where none of them exists for a time.
        let is_uneven = effective_duration * DENSE < duration;
        if !is_uneven {
            return Self::EVEN;
        }
        for (share, _) in &mut points {
            *share /= passed;
        }
        Self {
            points,
            effective_duration,
        }
    }

    /// Returns the duration of a window of this pace (s), without the time in which few bodies exist.
    pub(super) fn effective_duration(&self, duration: f64) -> f64 {
        if self.points.is_empty() {
            duration
        } else {
            self.effective_duration
        }
    }

    /// Returns the instant of a window (s) at a share of its slices.
    pub(super) fn at(&self, share: f64, (start, end): (f64, f64)) -> f64 {
        let linear = |share: f64, (from, to): (f64, f64)| (from + share * (to - from)).min(to);
        let next = self.points.partition_point(|point| point.0 <= share);
        let points = next.checked_sub(1).map(|last| &self.points[last..]);
        match points {
            Some([(low, from), (high, to), ..]) => {
                linear((share - low) / (high - low), (*from, *to))
            }
            Some(_) => end,
            None => linear(share, (start, end)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::search::TimeSlices;

    #[test]
    fn slices_are_short_where_many_bodies_exist() {
        // One at rest all day, and sorties of 600 s at its beginning and 20,000 s later.
        let mut lives = vec![(0.0, 86_400.0)];
        for number in 0..1_000 {
            let begin = f64::from(number % 2) * 20_000.0;
            lives.push((begin, begin + 600.0));
        }
        let (window, body_time) = ((0.0, 86_400.0), 1_000.0 * 600.0 + 86_400.0);
        let pace = Pace::of(&lives, window, body_time);
        assert!(
            (1_200.0..2_000.0).contains(&pace.effective_duration(86_400.0)),
            "{pace:?}"
        );
        let slices = TimeSlices::whole(window.0, window.1)
            .with_pace(&pace)
            .with_count(100.0);
        let mut ends = Vec::new();
        slices.ends(0..100, &mut ends);
        assert_eq!((ends[0], ends[100]), window);
        assert!(ends.is_sorted());
        let within = |from: f64| {
            ends.iter()
                .filter(|end| (from..from + 600.0).contains(*end))
                .count()
        };
        assert!(
            [0.0, 20_000.0].into_iter().all(|begin| within(begin) > 30),
            "{ends:?}"
        );
        // None of those that tell the pace exists at the beginning, nor at the end.
        let later = lives[1..]
            .iter()
            .map(|life| (life.0 + 500.0, life.1 + 500.0));
        let pace = Pace::of(&later.collect::<Vec<_>>(), window, body_time);
        for count in [1.0, 7.0, 100.0] {
            let slices = TimeSlices::whole(window.0, window.1)
                .with_pace(&pace)
                .with_count(count);
            slices.ends(0..slices.count(), &mut ends);
            assert_eq!(
                (ends.first(), ends.last()),
                (Some(&window.0), Some(&window.1))
            );
            assert!(ends.is_sorted());
        }
        // Bodies that exist all the time, or one after another, are no reason.
        let apart = |number: u32| (f64::from(number) * 60.0, f64::from(number) * 60.0 + 50.0);
        for lives in [vec![window; 1_000], (0..1_440).map(apart).collect()] {
            let body_time = lives.iter().map(|life: &(f64, f64)| life.1 - life.0).sum();
            assert_eq!(Pace::of(&lives, window, body_time), Pace::EVEN);
        }
    }
}
