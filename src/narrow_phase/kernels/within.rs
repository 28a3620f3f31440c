//! Verdicts for many pairs: two Bernstein screens, then an enclosure for the few that are left.

use super::batch::Lanes;
use super::cubic::ControlPoints;
use super::dispatch::{BLOCK, Level, screen_block, screen_block_finely};
use super::enclosure::enclose_for;
use super::pending::Pending;
use super::real::Real;
use super::screen::{Finding, screen_eighths, screen_halves};

/// Whether the bodies of a pair come within a threshold of each other during a span.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Verdict {
    /// At every instant certainly farther apart than the outer threshold.
    Outside,
    /// At some instant certainly nearer than the inner threshold.
    Inside,
    /// Rounding hides which of the two, or it lies between the thresholds: ask the exact solver.
    #[default]
    Undecided,
}

/// The verdict of a screen.
#[inline]
fn verdict<R: Real>(finding: Finding<R>) -> Verdict {
    if finding > R::from_f64(0.0) {
        Verdict::Outside
    } else if finding < R::from_f64(0.0) {
        Verdict::Inside
    } else {
        Verdict::Undecided
    }
}

/// The verdict on one pair.
pub(super) fn within_of<R: Real>(points: &ControlPoints<R>, inner: R, outer: R) -> Verdict {
    let first = verdict(screen_halves(*points, inner, outer));
    if first != Verdict::Undecided {
        return first;
    }
    let second = verdict(screen_eighths(*points, inner, outer));
    if second != Verdict::Undecided {
        return second;
    }
    last_verdict(points, inner, outer)
}

/// The verdict from an enclosure in f64.
fn last_verdict<R: Real>(points: &ControlPoints<R>, inner: R, outer: R) -> Verdict {
    let wide = points.map(|point| point.map(R::to_f64));
    let (inner, outer) = (inner.to_f64(), outer.to_f64());
    let enclosure = enclose_for(&wide, conversion_error::<R>(&wide), inner, outer);
    if enclosure.low > outer {
        Verdict::Outside
    } else if enclosure.high < inner {
        Verdict::Inside
    } else {
        Verdict::Undecided
    }
}

/// How far the points can be from those before they were rounded to the type of the lanes.
fn conversion_error<R: Real>(points: &ControlPoints<f64>) -> f64 {
    let rounding = R::ROUNDING.to_f64();
    if rounding < f64::EPSILON {
        return 0.0;
    }
    // sqrt(3) times the largest coordinate bounds the size of the polygon.
    let largest = points.iter().flatten().fold(0.0_f64, |most, x| most.max(x.abs()));
    1.8 * (rounding * largest + R::UNDERFLOW.to_f64())
}

/// The verdict on each pair, on one thread.
pub(super) fn within<R: Real>(
    level: Level,
    lanes: &Lanes<'_, R>,
    inner: &[R],
    outer: &[R],
    verdicts: &mut [Verdict],
) {
    let mut pending = Pending::<R, 2>::new();
    let mut findings = [R::default(); BLOCK];
    let mut start = 0;
    while start < lanes.len() {
        let end = (start + BLOCK).min(lanes.len());
        let findings = &mut findings[..end - start];
        let block = lanes.range(start, end);
        screen_block(level, &block, &inner[start..end], &outer[start..end], findings);
        for (i, finding) in findings.iter().enumerate() {
            let pair = start + i;
            verdicts[pair] = verdict(*finding);
            if verdicts[pair] == Verdict::Undecided {
                pending.push(pair, lanes, [inner[pair], outer[pair]]);
                if pending.is_full() {
                    screen_again(level, &mut pending, verdicts);
                }
            }
        }
        start = end;
    }
    screen_again(level, &mut pending, verdicts);
}

/// The second screen for the pairs that are pending, and enclosures for those still undecided.
fn screen_again<R: Real>(level: Level, pending: &mut Pending<R, 2>, verdicts: &mut [Verdict]) {
    let mut findings = [R::default(); BLOCK];
    let findings = &mut findings[..pending.len()];
    let lanes = pending.lanes();
    let [inner, outer] = pending.extras();
    screen_block_finely(level, &lanes, inner, outer, findings);
    for (i, finding) in findings.iter().enumerate() {
        let mut found = verdict(*finding);
        if found == Verdict::Undecided {
            found = last_verdict(&lanes.control_points(i), inner[i], outer[i]);
        }
        verdicts[pending.pair(i)] = found;
    }
    pending.clear();
}
