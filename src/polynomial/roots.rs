//! Results of a root search.

use std::fmt;
use std::ops::Deref;

/// The largest number of roots a search reports: searches stop at degree 6.
pub(super) const CAPACITY: usize = 6;

/// The real roots of a polynomial in an interval or on the whole line.
///
/// ```
/// use nearmiss::internals::polynomial::{Polynomial, Roots};
///
/// let parabola = Polynomial::new([-1.0, 0.0, 4.0]);
/// match parabola.roots_in(-1.0, 1.0, 0.0) {
///     Roots::Everywhere => unreachable!("a parabola is not zero everywhere"),
///     Roots::At(roots) => assert_eq!(&roots[..], &[-0.5, 0.5]),
/// }
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Roots {
    /// Every coefficient is exactly zero: each point of the interval is a root.
    Everywhere,
    /// Isolated roots, sorted, each once; empty where there is none.
    At(RootList),
}

impl Roots {
    /// Returns true if the polynomial is zero everywhere.
    #[must_use]
    pub fn is_everywhere(&self) -> bool {
        matches!(self, Self::Everywhere)
    }

    /// Returns the isolated roots, or `None` if the polynomial is zero everywhere.
    #[must_use]
    pub fn isolated(&self) -> Option<&[f64]> {
        match self {
            Self::Everywhere => None,
            Self::At(roots) => Some(roots),
        }
    }
}

/// Up to six numbers in increasing order, without allocation; dereferences to a slice.
#[derive(Clone, Copy, Default)]
pub struct RootList {
    values: [f64; CAPACITY],
    count: usize,
}

impl fmt::Debug for RootList {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_list().entries(self.iter()).finish()
    }
}

impl RootList {
    /// Appends a root that is not smaller than the previous ones.
    #[inline]
    pub(super) fn push(&mut self, root: f64) {
        debug_assert!(
            self.last().is_none_or(|&last| last <= root),
            "roots come sorted"
        );
        debug_assert!(self.count < CAPACITY, "no more roots than the degree");
        if let Some(free) = self.values.get_mut(self.count) {
            *free = root;
            self.count += 1;
        }
    }
}

impl Deref for RootList {
    type Target = [f64];

    #[inline]
    fn deref(&self) -> &[f64] {
        &self.values[..self.count]
    }
}

impl<'a> IntoIterator for &'a RootList {
    type Item = &'a f64;
    type IntoIter = std::slice::Iter<'a, f64>;

    fn into_iter(self) -> Self::IntoIter {
        self.iter()
    }
}

impl PartialEq for RootList {
    fn eq(&self, other: &Self) -> bool {
        **self == **other
    }
}
