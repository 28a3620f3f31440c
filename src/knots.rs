//! The knots of a motion, including the cuts of its extension.

use crate::count::short;
use crate::simd::prefetch;
use crate::trajectory::{Extension, Segment, StraightMotion, Trajectory};
use glam::DVec3;

/// The knots of a motion (s, increasing), one more than its cubics; none if it never exists.
///
/// The first and last knot are read most often, and mostly lie in no cache, so they are copied.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Knots<'a> {
    /// The plan's knots, or the cuts of a motion that has no list of them.
    own: &'a [f64],
    ends: (f64, f64),
    /// The motion, if not all of its cubics are in the list of a plan: they follow from it.
    plan: Option<&'a Trajectory>,
    /// Cubics before the plan's first knot.
    before: u32,
    /// Cubics after the plan's last knot.
    after: u32,
}

impl<'a> Knots<'a> {
    pub(crate) const NONE: Self = Self::of(&[]);

    /// Returns the knots of a list, after reading its ends.
    pub(crate) const fn of(own: &'a [f64]) -> Self {
        let ends = match own {
            [first, .., last] => (*first, *last),
            [only] => (*only, *only),
            [] => (f64::INFINITY, f64::NEG_INFINITY),
        };
        Self::with_ends(own, ends)
    }

    /// Returns the knots of a list whose ends were [read](Self::ends) before.
    pub(crate) const fn with_ends(own: &'a [f64], ends: (f64, f64)) -> Self {
        Self {
            own,
            ends,
            plan: None,
            before: 0,
            after: 0,
        }
    }

    /// Returns the knots of a motion with those of its extension.
    pub(crate) fn over(plan: &'a Trajectory, extension: Option<&Extension>) -> Self {
        Self::of(plan.piece_knots()).extended(plan, extension)
    }

    /// Returns these knots of a motion with those of its extension.
    pub(crate) fn extended(mut self, plan: &'a Trajectory, extension: Option<&Extension>) -> Self {
        // Straight motions are no list of cubics.
        if extension.is_some() || !plan.straight_motions().is_empty() {
            self.plan = Some(plan);
        }
        if let Some(extension) = extension {
            (self.before, self.after) = (extension.before, extension.after);
            self.ends = extension.domain;
        }
        self
    }

    /// Returns the first and the last knot, s; the first is later only if there are none.
    pub(crate) const fn ends(&self) -> (f64, f64) {
        self.ends
    }

    #[inline(always)]
    pub(crate) fn cubics(&self) -> usize {
        self.before as usize + self.own.len().saturating_sub(1) + self.after as usize
    }

    /// Returns the number of cubics before the plan's own.
    #[inline(always)]
    pub(crate) const fn before(&self) -> usize {
        self.before as usize
    }

    /// Returns true if cubic number `number` is one of the plan's own, not of its extension.
    pub(crate) const fn is_own(&self, number: usize) -> bool {
        self.before() <= number && number + 1 < self.before() + self.own.len()
    }

    /// Returns true if not all cubics are in the list of a plan: beyond it, or of a straight motion.
    #[inline(always)]
    pub(crate) const fn has_unlisted_cubics(&self) -> bool {
        self.plan.is_some()
    }

    /// Returns the plan's knots.
    #[inline(always)]
    pub(crate) const fn own(&self) -> &'a [f64] {
        self.own
    }

    /// Returns knot number `number`, s.
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

    /// Returns the end of a cubic (s), if there is one of this number.
    #[inline(always)]
    pub(crate) fn end(&self, cubic: usize) -> Option<f64> {
        (cubic < self.cubics()).then(|| self.at(cubic + 1))
    }

    /// Returns cubic number `number`, or `None` if it is one of the plan's own.
    #[inline(never)]
    pub(crate) fn segment_beyond(&self, number: usize) -> Option<Segment> {
        let plan = self.plan?;
        match number.checked_sub(self.before()) {
            None => Some(plan.segment_before()),
            Some(place) if place + 1 >= self.own.len() => Some(plan.segment_after()),
            Some(place) => plan
                .straight_motions()
                .get(place)
                .map(StraightMotion::segment),
        }
    }

    /// Returns the motion, if not all of its cubics are in the list of a plan.
    #[inline(always)]
    pub(crate) const fn plan(&self) -> Option<&'a Trajectory> {
        self.plan
    }

    /// Returns the straight motions between the [own](Self::own) knots; none of a plan.
    #[inline(always)]
    pub(crate) fn straight_motions(&self) -> &'a [StraightMotion] {
        self.plan.map_or(&[], Trajectory::straight_motions)
    }

    /// Returns the origin of an extension's cubics, m, or `None` if all cubics are listed.
    pub(crate) fn origin(&self) -> Option<DVec3> {
        self.plan.map(|plan| plan.segment_after().origin())
    }

    /// Returns the number of knots before the first one for which `precedes` fails.
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

    /// Prefetches `count` of the plan's knots, from that of a cubic on.
    #[inline(always)]
    pub(crate) fn prefetch(&self, cubic: usize, count: usize) {
        let first = cubic.saturating_sub(self.before()).min(self.own.len());
        prefetch(&self.own[first..(first + count).min(self.own.len())]);
    }
}
