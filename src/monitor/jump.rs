//! Catching up with a clock that has jumped.
//!
//! A lookahead is cut into slices of equal length, and a clock that moves on by a frame needs one more
//! of them now and then. A clock that jumps by hours would need thousands, most of them without news. The
//! time that it passed over is searched once, in chunks that grow as long as they take little work, each
//! in slices that suit the bodies there. Results do not depend on these.

use super::budget::TickWork;
use super::prepared::PreparedBodies;
use crate::broad_phase::PairFilter;
use crate::rounding::earliest_exact;
use crate::search::LimitExceeded;
use crate::spans::SpanKey;
use crate::stats::Stats;

/// A search over the time between the existing slices and the clock, as far as it has come.
#[derive(Debug)]
pub(super) struct JumpSearch {
    /// Instant up to which all is searched, s.
    at: f64,
    /// Lengths of the next chunk of the jump and of its slices, s.
    chunk: f64,
    slice: f64,
}

impl JumpSearch {
    /// Number of slices below which they are searched one by one.
    const FEW: f64 = 16.0;

    /// Boxes and candidates, in all and more for each body: a chunk that takes fewer is followed by one that is twice
    /// as long.
    const LITTLE: (usize, usize) = (1 << 15, 8);

    /// Returns true if it is far from one instant to another (s) in slices of `length` s.
    pub(super) fn is_far((from, to): (f64, f64), length: f64) -> bool {
        to - from > Self::FEW * length
    }

    /// Returns the search from an instant (s) on, in slices of `length` s at first.
    pub(super) fn begin(from: f64, length: f64) -> Self {
        Self {
            at: earliest_exact(from),
            chunk: length,
            slice: length,
        }
    }

    /// Searches on up to `to` (s) until the budget is spent, in chunks of at least `length` s. Appends the spans found,
    /// and adds the work. Nothing before `from` (s) is asked about. Returns the instant at which the search had to stop, s;
    /// none if it is done.
    ///
    /// # Errors
    ///
    /// If there is too little room for what is found.
    pub(super) fn go_on(
        &mut self,
        (from, to, length): (f64, f64, f64),
        bodies: &PreparedBodies<'_>,
        work: &mut TickWork<'_>,
        found: &mut Vec<SpanKey>,
    ) -> Result<Option<f64>, LimitExceeded> {
        let (admission, meter) = (&work.admission, &mut work.meter);
        // What has changed since the last call counts from there on, with all instants that are rounded to it.
        self.at = self.at.min(earliest_exact(from));
        // Not beyond the prescribed end of the known time: bodies may change then, and are searched for from there on.
        let until = meter.until().unwrap_or(f64::INFINITY);
        while self.at < to {
            if meter.is_spent() || self.at >= until {
                return Ok(Some(self.at.max(from)));
            }
            let end = (self.at + self.chunk).min(to.min(until));
            let window = (self.at, end);
            let (slices, statistics) = bodies.cheapest_slices(window, self.slice, admission);
            let (slicing, mut counted) = ((&slices, &statistics), Stats::default());
            bodies.list_spans(slicing, admission, (&mut *found, &mut counted))?;
            if admission.gives_up() {
                return Ok(Some(self.at.max(from)));
            }
            let examined = counted.boxes + counted.candidates;
            let examined = usize::try_from(examined).unwrap_or(usize::MAX);
            counted.slices = u64::from(slices.count());
            work.stats += counted;
            meter.count(examined.saturating_add(1));
            self.at = end;
            self.slice = slices.length();
            let little = Self::LITTLE.0 + Self::LITTLE.1 * bodies.len();
            let factor = if examined < little { 2.0 } else { 0.5 };
            self.chunk = (factor * self.chunk).max(length);
        }
        Ok(None)
    }
}
