//! Groups of bodies, of which some are never pairs: those are not compared.

/// A table that says which groups of bodies may form pairs. Each body is in one group.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Groups {
    count: u8,
    /// For each group, a bit for each group whose bodies may be pairs with its own; symmetric.
    partners: [u8; Self::MAX],
}

impl Groups {
    /// Largest number of groups.
    pub const MAX: usize = 8;

    /// One group: any two bodies may be a pair.
    pub const ONE: Self = Self {
        count: 1,
        partners: [1; Self::MAX],
    };

    /// Returns `count` groups, at most [`MAX`](Self::MAX). `admits` tells whether a body of one group and a body of
    /// another or the same group may be a pair, in either order. It is asked about numbers below `count`.
    #[must_use]
    pub fn new(count: usize, admits: impl Fn(usize, usize) -> bool) -> Self {
        let mut groups = Self::ONE;
        groups.count = u8::try_from(count.clamp(1, Self::MAX)).unwrap_or(1);
        for (one, partners) in (0..groups.count()).zip(&mut groups.partners) {
            let others = (0..groups.count).filter(|&other| admits(one, usize::from(other)));
            *partners = others.fold(0, |bits, other| bits | 1 << other);
        }
        groups
    }

    /// Returns the number of groups.
    #[must_use]
    #[inline]
    pub const fn count(&self) -> usize {
        self.count as usize
    }

    /// Returns true if bodies of two groups may be pairs.
    #[inline]
    #[must_use]
    pub const fn admits(&self, one: usize, other: usize) -> bool {
        self.partners[one] >> other & 1 != 0
    }
}
