//! Cut instants beyond the knots, computed one after the other.

/// Iterator over the instants `knot + step (2^k - 1)`, k = 1, 2, ..., up to the first that reaches
/// `until`. A step that f64 does not resolve at the knot counts as two units in the last place there: each cut
/// differs from the one before, so that cuts can be counted.
#[derive(Clone, Debug)]
pub(super) struct DoublingCuts {
    knot: f64,
    step: f64,
    until: f64,
    /// k of the last cut returned.
    number: u32,
    last: f64,
}

impl DoublingCuts {
    pub(super) const NONE: Self = Self::of(0.0, 0.0, 0.0);

    pub(super) const fn of(knot: f64, step: f64, until: f64) -> Self {
        Self {
            knot,
            step,
            until,
            number: 0,
            last: knot,
        }
    }

    /// Returns the cuts after cut number k.
    pub(super) fn after(number: u32, knot: f64, step: f64, until: f64) -> Self {
        Self {
            number,
            last: Self::cut(knot, step, number),
            ..Self::of(knot, step, until)
        }
    }

    /// Returns cut number k.
    #[inline]
    pub(super) fn cut(knot: f64, step: f64, number: u32) -> f64 {
        let step = step
            .abs()
            .max(2.0 * f64::EPSILON * knot.abs())
            .copysign(step);
        // The power of two, infinite from 1024 on.
        let factor = f64::from_bits(u64::from(number.min(1024) + 1023) << 52);
        (knot + step * (factor - 1.0)).clamp(-f64::MAX, f64::MAX)
    }

    pub(super) fn but_last(self) -> impl Iterator<Item = f64> + Clone {
        let count = self.clone().count();
        self.take(count.saturating_sub(1))
    }
}

impl Iterator for DoublingCuts {
    type Item = f64;

    fn next(&mut self) -> Option<f64> {
        let Self { step, until, .. } = *self;
        let precedes = |a, b| (step > 0.0 && a < b) || (step < 0.0 && a > b);
        if !precedes(self.last, until) {
            return None;
        }
        self.number += 1;
        self.last = Self::cut(self.knot, step, self.number);
        Some(self.last)
    }
}

#[cfg(test)]
mod tests {
    use super::DoublingCuts;

    fn cuts(knot: f64, step: f64, until: f64) -> Vec<f64> {
        DoublingCuts::of(knot, step, until).collect()
    }

    #[test]
    fn cuts_do_not_depend_on_the_window() {
        let long = cuts(10.0, 2.0, 1e6);
        let short = cuts(10.0, 2.0, 30.0);
        assert_eq!(short, [12.0, 16.0, 24.0, 40.0]);
        assert_eq!(long[..4], short[..]);
        assert_eq!(cuts(-1.0, -1.0, -4.5), [-2.0, -4.0, -8.0]);
    }

    #[test]
    fn all_but_the_last_of_them() {
        let some = DoublingCuts::of(10.0, 2.0, 30.0).but_last();
        assert_eq!(some.collect::<Vec<_>>(), [12.0, 16.0, 24.0]);
        assert_eq!(DoublingCuts::NONE.but_last().count(), 0);
    }

    #[test]
    fn a_step_too_small_to_see_still_gets_there() {
        let cuts = cuts(1.7e9, 1e-9, 1.7e9 + 1.0);
        assert!(cuts.windows(2).all(|pair| pair[0] < pair[1]));
        assert!(cuts.last().is_some_and(|&last| last >= 1.7e9 + 1.0));
    }
}
