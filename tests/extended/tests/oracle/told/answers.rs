//! Answers that are not certified against the exact motions: within a few roundings.

use super::motions::Motion;
use crate::check::{Truth, exact};
use crate::oracle_support::Dyadic;
use dashu::rational::RBig;
use nearmiss::{Conflict, Encounter};

/// The parts of a conflict, or of an encounter, that are checked.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Row {
    pub(crate) enter: f64,
    pub(crate) exit: f64,
    /// Instant (s) and separation (m), if they are those of this part.
    pub(crate) closest: Option<(f64, f64)>,
}

impl Row {
    pub(crate) fn of(conflict: &Conflict) -> Self {
        let closest = &conflict.closest;
        Self {
            enter: conflict.enter,
            exit: conflict.exit,
            closest: Some((closest.time, closest.separation)),
        }
    }

    /// The part of an encounter that lies ahead of a clock, in the time that is examined (s). One that is open is
    /// not told of again while its end is out of sight.
    pub(crate) fn ahead(encounter: &Encounter, (clock, until): (f64, f64)) -> Self {
        let closest = &encounter.closest;
        let is_whole = encounter.enter > clock && !encounter.open;
        Self {
            enter: encounter.enter.max(clock),
            exit: if encounter.open {
                until
            } else {
                encounter.exit
            },
            closest: is_whole.then_some((closest.time, closest.separation)),
        }
    }
}

/// Returns the largest error of two bodies' distance, m: 2000 roundings of the ways gone, and of instants.
pub(crate) fn tolerance(a: &Motion, b: &Motion, latest: f64) -> f64 {
    const ROUNDINGS: f64 = 2_000.0 / (1_u64 << 53) as f64;
    let instants = (a.speed + b.speed) * latest.abs().max(1.0);
    ROUNDINGS * (a.scale + b.scale + instants) + f64::MIN_POSITIVE
}

/// Returns the first fault of rows, which are in the order of time.
pub(crate) fn wrong(truth: &Truth, margin: f64, tolerance: f64, rows: &[Row]) -> Option<String> {
    let (from, to) = truth.range?;
    let level = |off: f64| exact(margin) + exact(off);
    let mut clear_from = from;
    for row in rows {
        if !(clear_from <= row.enter && row.enter <= row.exit && row.exit <= to) {
            return Some(format!("out of order: {row:?}"));
        }
        if clear_from < row.enter
            && truth.least_sign((clear_from, row.enter), &level(-tolerance)) < 0
        {
            return Some(format!("nearer before {row:?}"));
        }
        clear_from = row.exit;
        let is_there = truth.largest_sign((row.enter, row.exit), &level(tolerance)) <= 0
            || row.exit <= row.enter && is_near_before(truth, row.exit, &level(tolerance));
        if !is_there {
            return Some(format!("not there: {row:?}"));
        }
        let Some((time, separation)) = row.closest else {
            continue;
        };
        let [low, high] = [-tolerance, tolerance].map(|off| exact(separation) + exact(off));
        let is_least = truth.least_sign((row.enter, row.exit), &low) >= 0;
        let is_reached =
            truth.least_sign((time, time), &high) <= 0 || is_near_before(truth, time, &high);
        if !(is_least && is_reached && (row.enter..=row.exit).contains(&time)) {
            return Some(format!("not the least: {row:?}"));
        }
    }
    let is_missed = (clear_from < to || rows.is_empty())
        && truth.least_sign((clear_from, to), &level(-tolerance)) < 0;
    is_missed.then(|| format!("nearer after {clear_from}"))
}

/// Returns true if the bodies are that near at an instant as they come to it: there one of them may be told to be
/// elsewhere.
fn is_near_before(truth: &Truth, time: f64, level: &RBig) -> bool {
    let before = truth.over(time - 1.0, time);
    let last = before.last().map(|span| span.at(&Dyadic::from(1)));
    *level >= RBig::ZERO && last.is_some_and(|square| square <= level * level)
}
