//! Which bodies exist when.

use crate::narrow_phase::Party;

/// When each body exists, side by side: most bodies of a long recording exist in few slices.
#[derive(Clone, Debug)]
pub(crate) struct Presence(Vec<(f64, f64)>);

impl Presence {
    pub(crate) fn of(parties: &[Party<'_>]) -> Self {
        let domain = |party: &Party<'_>| match *party.knots {
            [first, .., last] => (first, last),
            // Of less than a cubic: never.
            _ => (f64::INFINITY, f64::NEG_INFINITY),
        };
        Self(parties.iter().map(domain).collect())
    }

    /// Lists the places of those that exist within `from..=to` (s), ascending.
    #[allow(
        clippy::cast_possible_truncation,
        reason = "bodies are counted in 32 bits"
    )]
    pub(crate) fn list(&self, (from, to): (f64, f64), present: &mut Vec<u32>) {
        present.clear();
        present.resize(self.0.len(), 0);
        let mut count = 0;
        for (place, &(first, last)) in self.0.iter().enumerate() {
            // Written in any case, kept if it exists: whether it does cannot be predicted.
            present[count] = place as u32;
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
        let lives: [&[f64]; 5] = [
            &[0.0, 1.0, 2.0],
            &[2.0, 3.0],
            &[],
            &[-1.0, 5.0],
            &[3.5, 4.0],
        ];
        let parties = lives.map(|knots| Party {
            knots,
            ..Party::NONE
        });
        let presence = Presence::of(&parties);
        let mut present = vec![7];
        for (interval, expected) in [
            ((2.0, 3.0), &[0, 1, 3][..]),
            ((2.5, 3.4), &[1, 3]),
            ((4.0, 9.0), &[3, 4]),
            ((3.2, 3.5), &[3, 4]),
            ((6.0, 9.0), &[]),
        ] {
            presence.list(interval, &mut present);
            assert_eq!(present, expected);
        }
    }
}
