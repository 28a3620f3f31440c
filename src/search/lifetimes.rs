//! Lifetimes of bodies: the intervals in which they exist.

use crate::count::short;

/// Lists the numbers of the bodies that exist within `from..=to` (s), ascending, given the first and last instant of each,
/// s; bodies are numbered from `number` on. Most bodies of long recordings exist in few slices.
pub(crate) fn list_present(
    lifetimes: impl ExactSizeIterator<Item = (f64, f64)>,
    number: usize,
    (from, to): (f64, f64),
    present: &mut Vec<u32>,
) {
    present.clear();
    present.resize(lifetimes.len(), 0);
    let mut count = 0;
    for (place, (first, last)) in lifetimes.enumerate() {
        // Written in any case, kept if it exists: whether it does cannot be predicted.
        present[count] = short(number + place);
        count += usize::from(first <= to && last >= from);
    }
    present.truncate(count);
}

#[cfg(test)]
mod tests {
    use super::list_present;

    #[test]
    fn those_that_exist_are_listed() {
        let lifetimes = [
            (0.0, 2.0),
            (2.0, 3.0),
            (f64::INFINITY, f64::NEG_INFINITY),
            (-1.0, 5.0),
            (3.5, 4.0),
        ];
        let mut present = vec![7];
        for (interval, expected) in [
            ((2.0, 3.0), &[0, 1, 3][..]),
            ((2.5, 3.4), &[1, 3]),
            ((4.0, 9.0), &[3, 4]),
            ((3.2, 3.5), &[3, 4]),
            ((6.0, 9.0), &[]),
        ] {
            list_present(lifetimes.iter().copied(), 0, interval, &mut present);
            assert_eq!(present, expected);
        }
    }
}
