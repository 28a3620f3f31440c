//! A filter of bodies for a list of some of them.

use crate::broad_phase::{Groups, PairFilter};

/// A filter of bodies, asked about their places in a list.
pub(super) struct ByPlace<'a> {
    bodies: &'a [u32],
    filter: &'a dyn PairFilter,
    /// The answer of the filter, which is not asked for each pair then.
    admits_all: bool,
}

impl<'a> ByPlace<'a> {
    pub(super) fn new(bodies: &'a [u32], filter: &'a dyn PairFilter) -> Self {
        Self {
            bodies,
            filter,
            admits_all: filter.admits_all(),
        }
    }
}

impl PairFilter for ByPlace<'_> {
    #[inline]
    fn admits(&self, a: u32, b: u32) -> bool {
        // A body that teleports has several places, all but the first one behind those of all bodies.
        let (a, b) = (self.bodies[a as usize], self.bodies[b as usize]);
        a != b && (self.admits_all || self.filter.admits(a.min(b), a.max(b)))
    }

    #[inline]
    fn groups(&self) -> Groups {
        self.filter.groups()
    }

    #[inline]
    fn group(&self, place: u32) -> u8 {
        self.filter.group(self.bodies[place as usize])
    }

    #[inline]
    fn gives_up(&self) -> bool {
        self.filter.gives_up()
    }
}
