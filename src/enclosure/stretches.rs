//! The partition of the parameter interval by a threshold.

use super::{Effort, Stretch, Verdict};
use arrayvec::ArrayVec;

/// Up to six crossings make seven certain stretches and six undecided ones between them.
const MAX_COUNT: usize = 16;

/// A partition of 0..=1 into stretches, ascending; neighbours share their end and differ in kind.
#[derive(Clone, Debug)]
pub struct Stretches {
    stretches: ArrayVec<Stretch, MAX_COUNT>,
    effort: Effort,
}

impl Stretches {
    pub(super) const NONE: Self = Self {
        stretches: ArrayVec::new_const(),
        effort: Effort::Tight,
    };

    /// Returns the stretches, at least one.
    #[must_use]
    pub fn as_slice(&self) -> &[Stretch] {
        &self.stretches
    }

    /// Returns the way the search ended; if limited, more is undecided than necessary.
    #[must_use]
    pub fn effort(&self) -> Effort {
        self.effort
    }

    pub(super) fn all(side: Verdict) -> Self {
        let mut whole = Self::NONE;
        whole.append(1.0, side);
        whole
    }

    /// Records that the rest is undecided because of the work limit.
    pub(super) fn give_up(&mut self) {
        self.effort = Effort::Limited;
    }

    /// Appends the stretch from the last end to `last`.
    pub(super) fn append(&mut self, last: f64, side: Verdict) {
        let is_full = self.stretches.is_full();
        let first = match self.stretches.last_mut() {
            Some(stretch) if stretch.side == side => {
                stretch.last = last;
                return;
            }
            Some(stretch) if is_full && last > stretch.last => {
                // Undecided is always true.
                self.effort = Effort::Limited;
                stretch.last = last;
                stretch.side = Verdict::Undecided;
                return;
            }
            Some(stretch) => stretch.last,
            None => 0.0,
        };
        if last > first {
            self.stretches.push(Stretch { first, last, side });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_does_not_fit_is_undecided() {
        let mut found = Stretches::NONE;
        for i in 1..=40 {
            let side = [Verdict::Inside, Verdict::Outside][i % 2];
            found.append(f64::from(u8::try_from(i).unwrap_or(0)) / 40.0, side);
        }
        let stretches = found.as_slice();
        assert_eq!(stretches.len(), MAX_COUNT);
        assert_eq!(found.effort(), Effort::Limited);
        let last = stretches[MAX_COUNT - 1];
        assert_eq!(last.side, Verdict::Undecided);
        assert!(last.last >= 1.0);
    }
}
