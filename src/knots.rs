//! The knots of a motion: those of its plan, and beyond them the cuts of its extension.

use crate::simd::prefetch;
use crate::trajectory::{Extension, Segment, Trajectory};
use glam::DVec3;

/// The knots of a motion (s, increasing), one more than it has cubics; none if it never exists.
///
/// When the motion begins and ends is asked for more often than anything else of it. These two knots
/// lie apart from those at hand, and mostly in no cache: copies of them come with the list.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Knots<'a> {
    /// The plan's own.
    own: &'a [f64],
    ends: (f64, f64),
    /// The plan, if there are others.
    plan: Option<&'a Trajectory>,
    /// Cubics before the plan's first knot.
    before: u32,
    /// Cubics after the plan's last knot.
    after: u32,
}

impl<'a> Knots<'a> {
    pub(crate) const NONE: Self = Self::of(&[]);

    /// Reads the ends.
    pub(crate) const fn of(own: &'a [f64]) -> Self {
        let ends = match own {
            [first, .., last] => (*first, *last),
            [only] => (*only, *only),
            [] => (f64::INFINITY, f64::NEG_INFINITY),
        };
        Self::with_ends(own, ends)
    }

    /// Knots with ends that were [read](Self::ends) before.
    pub(crate) const fn with_ends(own: &'a [f64], ends: (f64, f64)) -> Self {
        Self {
            own,
            ends,
            plan: None,
            before: 0,
            after: 0,
        }
    }

    /// Returns the knots of a plan, as far as it is extended.
    pub(crate) fn over(plan: &'a Trajectory, extension: Option<&Extension>) -> Self {
        Self::of(plan.cuts()).extended(plan, extension)
    }

    /// Returns these knots of a plan with those beyond them.
    pub(crate) fn extended(self, plan: &'a Trajectory, extension: Option<&Extension>) -> Self {
        match extension {
            None => self,
            Some(&Extension {
                before,
                after,
                domain,
            }) => Self {
                ends: domain,
                plan: Some(plan),
                before,
                after,
                ..self
            },
        }
    }

    /// The first and the last one, s; the first is later only if there are none.
    pub(crate) const fn ends(&self) -> (f64, f64) {
        self.ends
    }

    /// Returns the number of cubics between them.
    #[inline(always)]
    pub(crate) fn cubics(&self) -> usize {
        self.before as usize + self.own.len().saturating_sub(1) + self.after as usize
    }

    /// Returns the number of cubics before the plan's own.
    #[inline(always)]
    pub(crate) const fn before(&self) -> usize {
        self.before as usize
    }

    /// Returns true if there are cubics beyond the plan's own.
    #[inline(always)]
    pub(crate) const fn are_extended(&self) -> bool {
        self.plan.is_some()
    }

    /// Returns the plan's own.
    #[inline(always)]
    pub(crate) const fn own(&self) -> &'a [f64] {
        self.own
    }

    /// Returns the knot with a number, s.
    #[inline(always)]
    pub(crate) fn at(&self, number: usize) -> f64 {
        match self.plan {
            None => self.own[number],
            Some(plan) => self.knot_of(plan, number),
        }
    }

    #[inline(never)]
    fn knot_of(&self, plan: &Trajectory, number: usize) -> f64 {
        match number.checked_sub(self.before()) {
            None => plan.cut_before(short(self.before() - number)),
            Some(place) => match self.own.get(place) {
                Some(knot) => *knot,
                None => plan.cut_after(short(place + 1 - self.own.len())),
            },
        }
    }

    /// Returns the knot at which a cubic ends, s; none if there is no such cubic.
    #[inline(always)]
    pub(crate) fn end<const EXTENDED: bool>(&self, cubic: usize) -> Option<f64> {
        if EXTENDED {
            (cubic < self.cubics()).then(|| self.at(cubic + 1))
        } else {
            self.own.get(cubic + 1).copied()
        }
    }

    /// Returns the knot at which a cubic begins, s.
    #[inline(always)]
    pub(crate) fn start<const EXTENDED: bool>(&self, cubic: usize) -> f64 {
        if EXTENDED {
            self.at(cubic)
        } else {
            self.own[cubic]
        }
    }

    /// Returns the cubic with a number, if that is not one of the plan's own.
    #[inline(never)]
    pub(crate) fn segment_beyond(&self, number: usize) -> Option<Segment> {
        let plan = self.plan?;
        match number.checked_sub(self.before()) {
            None => Some(plan.segment_before()),
            Some(place) => (place + 1 >= self.own.len()).then(|| plan.segment_after()),
        }
    }

    /// Returns a place near the knots of a plan without cubics that goes beyond them, m.
    pub(crate) fn origin(&self) -> Option<DVec3> {
        self.plan.map(|plan| plan.segment_after().origin())
    }

    /// Returns how many knots, from the first on, precede an instant; `precedes` holds for none after one for
    /// which it does not.
    pub(crate) fn count(&self, precedes: impl Fn(f64) -> bool) -> usize {
        let (before, after) = (self.before(), self.after as usize);
        let cuts = (0..before).take_while(|&number| precedes(self.at(number)));
        let mut count = cuts.count();
        if count == before {
            count += self.own.partition_point(|&knot| precedes(knot));
            let own = before + self.own.len();
            if count == own {
                let cuts = (own..own + after).take_while(|&knot| precedes(self.at(knot)));
                count += cuts.count();
            }
        }
        count
    }

    /// Fetches some of the plan's own knots into the caches, the first of them that of a cubic.
    #[inline(always)]
    pub(crate) fn prefetch(&self, cubic: usize, count: usize) {
        let first = cubic.saturating_sub(self.before()).min(self.own.len());
        prefetch(&self.own[first..(first + count).min(self.own.len())]);
    }
}

/// There are no more cuts than powers of two.
#[allow(clippy::cast_possible_truncation, reason = "see above")]
fn short(count: usize) -> u32 {
    count as u32
}
