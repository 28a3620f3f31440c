//! Merged knots of two bodies: the maximal intervals in which neither changes its cubic.
//!
//! Spans depend on the two trajectories alone. A window selects spans; it never cuts one.

use crate::count::short;
use crate::knots::Knots;
use std::cmp::Ordering;

/// A merged interval: body a follows its cubic number `a`, body b its number `b`, from `start`
/// to `end` (s), with `start < end` unless the two domains share a single instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Span {
    pub(crate) start: f64,
    pub(crate) end: f64,
    pub(crate) cubic_a: u32,
    pub(crate) cubic_b: u32,
}

/// Two bodies, the smaller number first, and a cubic of each: a span without its times.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct SpanKey {
    pub(crate) a: u32,
    pub(crate) b: u32,
    pub(crate) cubic_a: u32,
    pub(crate) cubic_b: u32,
}

impl SpanKey {
    /// Returns the key of a span of two bodies.
    #[inline]
    pub(crate) const fn of((a, b): (u32, u32), span: Span) -> Self {
        Self {
            a,
            b,
            cubic_a: span.cubic_a,
            cubic_b: span.cubic_b,
        }
    }

    /// Returns the two bodies, each with the number of its cubic.
    pub(crate) const fn cubics(&self) -> [(u32, u32); 2] {
        [(self.a, self.cubic_a), (self.b, self.cubic_b)]
    }

    /// Returns the span, from the knots of both bodies.
    pub(crate) fn span(&self, a: &Knots<'_>, b: &Knots<'_>) -> Span {
        let (i, j) = (self.cubic_a as usize, self.cubic_b as usize);
        Span {
            start: a.at(i).max(b.at(j)),
            end: a.at(i + 1).min(b.at(j + 1)),
            cubic_a: self.cubic_a,
            cubic_b: self.cubic_b,
        }
    }
}

impl Ord for SpanKey {
    /// Orders by bodies, then by cubics; by two numbers instead of four, as lists are sorted often.
    fn cmp(&self, other: &Self) -> Ordering {
        let both = |first: u32, second: u32| u64::from(first) << 32 | u64::from(second);
        let key = |one: &Self| (both(one.a, one.b), both(one.cubic_a, one.cubic_b));
        key(self).cmp(&key(other))
    }
}

impl PartialOrd for SpanKey {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

/// Returns the bodies of a pair in the order of their numbers, each with what belongs to it. The first one is body a: the
/// same order, and so the same bits, everywhere.
pub(crate) fn in_order<K: Ord, T>(one: (K, T), other: (K, T)) -> [(K, T); 2] {
    if one.0 < other.0 {
        [one, other]
    } else {
        [other, one]
    }
}

/// Returns the interval in which both motions exist.
pub(crate) fn common_domain(a: &Knots<'_>, b: &Knots<'_>) -> Option<(f64, f64)> {
    common_part(a.ends(), b.ends())
}

/// Returns the part of an interval (s) in which both motions exist.
pub(crate) fn common_window(
    a: &Knots<'_>,
    b: &Knots<'_>,
    interval: (f64, f64),
) -> Option<(f64, f64)> {
    common_part(common_domain(a, b)?, interval)
}

/// Returns the part that two intervals have in common; it may be a single instant.
pub(crate) fn common_part(one: (f64, f64), other: (f64, f64)) -> Option<(f64, f64)> {
    let (start, end) = (one.0.max(other.0), one.1.min(other.1));
    (start <= end).then_some((start, end))
}

/// Returns the spans of two knot sequences that overlap `from..=to`, in time order.
///
/// A motion with `n + 1` knots has cubics `0..n`. Touching counts as overlap.
pub(crate) fn spans<'k>(a: &'k Knots<'k>, b: &'k Knots<'k>, from: f64, to: f64) -> Spans<'k> {
    let first = |knots: &Knots<'_>| short(knots.count(|knot| knot < from).max(1) - 1);
    spans_from(a, b, (first(a), first(b)), from, to)
}

/// Returns the [`spans`], searched from a cubic of each body that must not be later than the first one that overlaps the
/// interval.
#[inline]
pub(crate) fn spans_from<'k>(
    a: &'k Knots<'k>,
    b: &'k Knots<'k>,
    hints: (u32, u32),
    from: f64,
    to: f64,
) -> Spans<'k> {
    let mut spans = Spans {
        a,
        b,
        i: hints.0 as usize,
        j: hints.1 as usize,
        to,
        single_instant: None,
    };
    match common_domain(a, b) {
        Some((start, end)) if start < end => {
            let from = from.max(start);
            spans.i = skip(a, spans.i, from);
            spans.j = skip(b, spans.j, from);
        }
        shared => {
            // Only a single shared instant gives a span of no duration: every cubic lasts.
            (spans.i, spans.j) = (a.cubics(), b.cubics());
            spans.single_instant = shared
                .filter(|&(instant, _)| from <= instant && instant <= to)
                .map(|(start, end)| Span {
                    start,
                    end,
                    cubic_a: cubic_at(a, start),
                    cubic_b: cubic_at(b, start),
                });
        }
    }
    spans
}

/// Returns the first cubic, from `cubic` on, that does not end before `from`.
fn skip(knots: &Knots<'_>, mut cubic: usize, from: f64) -> usize {
    while knots.end(cubic).is_some_and(|end| end < from) {
        cubic += 1;
    }
    cubic
}

/// Iterator over [`spans`].
#[derive(Clone, Debug)]
pub(crate) struct Spans<'k> {
    a: &'k Knots<'k>,
    b: &'k Knots<'k>,
    /// Current cubics.
    i: usize,
    j: usize,
    to: f64,
    single_instant: Option<Span>,
}

impl Iterator for Spans<'_> {
    type Item = Span;

    fn next(&mut self) -> Option<Span> {
        if let Some(single_instant) = self.single_instant.take() {
            return Some(single_instant);
        }
        loop {
            let a_end = self.a.end(self.i)?;
            let b_end = self.b.end(self.j)?;
            let start = self.a.at(self.i);
            let start = start.max(self.b.at(self.j));
            let end = a_end.min(b_end);
            if start > self.to {
                return None;
            }
            let (i, j) = (self.i, self.j);
            // Coincident knots move both on.
            if a_end <= end {
                self.i += 1;
            }
            if b_end <= end {
                self.j += 1;
            }
            if start < end {
                return Some(Span {
                    start,
                    end,
                    cubic_a: short(i),
                    cubic_b: short(j),
                });
            }
        }
    }
}

fn cubic_at(knots: &Knots<'_>, time: f64) -> u32 {
    let after = knots.count(|knot| knot <= time);
    short(after.clamp(1, knots.cubics()) - 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn all(a: &[f64], b: &[f64]) -> Vec<(f64, f64, u32, u32)> {
        windowed(a, b, f64::NEG_INFINITY, f64::INFINITY)
    }

    fn windowed(a: &[f64], b: &[f64], from: f64, to: f64) -> Vec<(f64, f64, u32, u32)> {
        spans(&Knots::of(a), &Knots::of(b), from, to)
            .map(|span| (span.start, span.end, span.cubic_a, span.cubic_b))
            .collect()
    }

    #[test]
    fn knots_of_both_are_merged_within_the_common_domain() {
        // One has knots 0, 2, 4, 6 and the other has knots 1, 3, 5.
        assert_eq!(
            all(&[0.0, 2.0, 4.0, 6.0], &[1.0, 3.0, 5.0]),
            [
                (1.0, 2.0, 0, 0),
                (2.0, 3.0, 1, 0),
                (3.0, 4.0, 1, 1),
                (4.0, 5.0, 2, 1)
            ]
        );
    }

    #[test]
    fn coincident_knots_make_no_empty_span() {
        assert_eq!(
            all(&[0.0, 1.0, 2.0], &[0.0, 1.0, 1.5, 2.0]),
            [(0.0, 1.0, 0, 0), (1.0, 1.5, 1, 1), (1.5, 2.0, 1, 2)]
        );
    }

    #[test]
    fn disjoint_and_touching_domains() {
        assert_eq!(all(&[0.0, 1.0], &[2.0, 3.0]), []);
        assert_eq!(all(&[0.0, 1.0], &[1.0, 3.0]), [(1.0, 1.0, 0, 0)]);
        assert_eq!(all(&[1.0, 3.0], &[0.0, 0.5, 1.0]), [(1.0, 1.0, 0, 1)]);
        assert_eq!(windowed(&[0.0, 1.0], &[1.0, 3.0], 1.5, 2.0), []);
    }

    #[test]
    fn a_window_selects_whole_spans() {
        let (a, b) = ([0.0, 2.0, 4.0], [0.0, 3.0, 4.0]);
        let whole = all(&a, &b);
        assert_eq!(windowed(&a, &b, 2.5, 2.6), whole[1..2]);
        // Touching a knot meets the spans on both sides.
        assert_eq!(windowed(&a, &b, 3.0, 3.0), whole[1..3]);
        assert_eq!(windowed(&a, &b, 4.5, 9.0), []);
        assert_eq!(windowed(&a, &b, -2.0, -1.0), []);
    }
}
