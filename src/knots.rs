//! A motion's knots, and its ends beside them.

use std::ops::Deref;

/// The knots of a motion (s, increasing), one more than it has cubics; none if it never exists.
///
/// When the motion begins and ends is asked for more often than anything else of it. These two knots
/// lie apart from those at hand, and mostly in no cache: copies of them come with the list.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Knots<'a> {
    all: &'a [f64],
    ends: (f64, f64),
}

impl<'a> Knots<'a> {
    pub(crate) const NONE: Self = Self::of(&[]);

    /// Reads the ends.
    pub(crate) const fn of(all: &'a [f64]) -> Self {
        let ends = match all {
            [first, .., last] => (*first, *last),
            [only] => (*only, *only),
            [] => (f64::INFINITY, f64::NEG_INFINITY),
        };
        Self { all, ends }
    }

    /// The same with ends that were [read](Self::ends) before.
    pub(crate) const fn with_ends(all: &'a [f64], ends: (f64, f64)) -> Self {
        Self { all, ends }
    }

    /// The first and the last one, s; the first is later only if there are none.
    pub(crate) const fn ends(&self) -> (f64, f64) {
        self.ends
    }
}

impl Deref for Knots<'_> {
    type Target = [f64];

    fn deref(&self) -> &[f64] {
        self.all
    }
}
