//! Lifetimes of bodies: the intervals in which they exist.

use crate::count::short;

/// First and last instant of each body, s; most bodies of long recordings exist in few slices.
#[derive(Clone, Debug, Default)]
pub(crate) struct Lifetimes(Vec<(f64, f64)>);

impl Lifetimes {
    pub(crate) const fn of(lives: Vec<(f64, f64)>) -> Self {
        Self(lives)
    }

    pub(crate) fn fill(&mut self, lives: impl Iterator<Item = (f64, f64)>) {
        self.0.clear();
        self.0.extend(lives);
    }

    /// Returns room for those of so many bodies, to be overwritten.
    pub(crate) fn room(&mut self, count: usize) -> &mut [(f64, f64)] {
        self.0.resize(count, (0.0, 0.0));
        &mut self.0
    }

    pub(crate) fn lives(&self) -> &[(f64, f64)] {
        &self.0
    }

    pub(crate) const fn len(&self) -> usize {
        self.0.len()
    }

    pub(crate) fn of_some(&self, places: &[usize]) -> Self {
        Self(places.iter().map(|&place| self.0[place]).collect())
    }

    /// Lists the places of the bodies that exist within `from..=to` (s), ascending.
    pub(crate) fn list(&self, (from, to): (f64, f64), present: &mut Vec<u32>) {
        present.clear();
        present.resize(self.0.len(), 0);
        let mut count = 0;
        for (place, &(first, last)) in self.0.iter().enumerate() {
            // Written in any case, kept if it exists: whether it does cannot be predicted.
            present[count] = short(place);
            count += usize::from(first <= to && last >= from);
        }
        present.truncate(count);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn those_that_exist_are_listed() {
        let lifetimes = Lifetimes::of(vec![
            (0.0, 2.0),
            (2.0, 3.0),
            (f64::INFINITY, f64::NEG_INFINITY),
            (-1.0, 5.0),
            (3.5, 4.0),
        ]);
        let some = lifetimes.of_some(&[1, 4]);
        let mut present = vec![7];
        some.list((3.6, 9.0), &mut present);
        assert_eq!(present, [1]);
        for (interval, expected) in [
            ((2.0, 3.0), &[0, 1, 3][..]),
            ((2.5, 3.4), &[1, 3]),
            ((4.0, 9.0), &[3, 4]),
            ((3.2, 3.5), &[3, 4]),
            ((6.0, 9.0), &[]),
        ] {
            lifetimes.list(interval, &mut present);
            assert_eq!(present, expected);
        }
    }
}
