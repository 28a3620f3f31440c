//! The partition of the parameter interval by a threshold.

use super::{Effort, Side, Stretch};
use std::fmt;

/// Up to six crossings make seven certain stretches and six undecided ones between them.
const MAX_COUNT: usize = 16;

/// A partition of 0..=1 into stretches, ascending; neighbours share their end and differ in kind.
#[derive(Clone, Copy)]
pub struct Stretches {
    stretches: [Stretch; MAX_COUNT],
    count: usize,
    effort: Effort,
}

impl fmt::Debug for Stretches {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Stretches")
            .field("stretches", &self.as_slice())
            .field("effort", &self.effort)
            .finish()
    }
}

impl Stretches {
    pub(super) const NONE: Self = Self {
        stretches: [Stretch {
            first: 0.0,
            last: 0.0,
            side: Side::Undecided,
        }; MAX_COUNT],
        count: 0,
        effort: Effort::Tight,
    };

    /// Returns the stretches, at least one.
    #[must_use]
    pub fn as_slice(&self) -> &[Stretch] {
        &self.stretches[..self.count]
    }

    /// Returns the way the search ended; if limited, more is undecided than necessary.
    #[must_use]
    pub fn effort(&self) -> Effort {
        self.effort
    }

    pub(super) fn all(side: Side) -> Self {
        let mut whole = Self::NONE;
        whole.append(1.0, side);
        whole
    }

    /// Records that the rest is undecided because of the work limit.
    pub(super) fn give_up(&mut self) {
        self.effort = Effort::Limited;
    }

    /// Appends the stretch from the last end to `last`.
    pub(super) fn append(&mut self, last: f64, side: Side) {
        let first = match self.as_slice().last() {
            Some(stretch) if stretch.side == side => {
                self.stretches[self.count - 1].last = last;
                return;
            }
            Some(stretch) => stretch.last,
            None => 0.0,
        };
        if last <= first {
            return;
        }
        if self.count == MAX_COUNT {
            // Undecided is always true.
            self.effort = Effort::Limited;
            let end = &mut self.stretches[self.count - 1];
            end.last = last;
            end.side = Side::Undecided;
            return;
        }
        self.stretches[self.count] = Stretch { first, last, side };
        self.count += 1;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_does_not_fit_is_undecided() {
        let mut found = Stretches::NONE;
        for i in 1..=40 {
            let side = [Side::Inside, Side::Outside][i % 2];
            found.append(f64::from(u8::try_from(i).unwrap_or(0)) / 40.0, side);
        }
        let stretches = found.as_slice();
        assert_eq!(stretches.len(), MAX_COUNT);
        assert_eq!(found.effort(), Effort::Limited);
        let last = stretches[MAX_COUNT - 1];
        assert_eq!(last.side, Side::Undecided);
        assert!(last.last >= 1.0);
    }
}
