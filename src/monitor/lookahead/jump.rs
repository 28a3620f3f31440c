//! Catching up with a clock that has jumped.
//!
//! A lookahead is cut into slices of equal length, and a clock that moves on by a frame needs one more
//! of them now and then. A clock that jumps by hours would need thousands, most of them without news. The
//! time that it passed over is searched once, in chunks that grow as long as they take little work, each
//! in slices that suit the bodies there. Results do not depend on these.

use super::super::bodies::BodyTable;
use super::super::budget::TickWork;
use super::super::prepared::PreparedBodies;
use super::LookaheadSearch;
use crate::broad_phase::PairFilter;
use crate::rounding::earliest_exact;
use crate::search::LimitExceeded;
use crate::stats::Stats;

impl LookaheadSearch {
    /// Boxes and candidates, in all and more for each body: a chunk that takes fewer is followed by one that is twice
    /// as long.
    const LITTLE: (usize, usize) = (1 << 15, 8);

    /// Returns true if the time from one instant to another (s) is searched as a jump.
    pub(super) fn is_jump(&self, (from, to): (f64, f64)) -> bool {
        /// Number of slices below which they are searched one by one.
        const FEW: f64 = 16.0;
        self.jump.is_some() || to - from > FEW * self.grid.length
    }

    /// Searches the time that the clock passed over, in chunks of at least the length of a slice, until the budget is
    /// spent. Returns the instant at which the search had to stop, s; none if it is done.
    ///
    /// # Errors
    ///
    /// If there is too little room for what is found.
    pub(super) fn search_jump(
        &mut self,
        (from, to): (f64, f64),
        work: &mut TickWork<'_>,
    ) -> Result<Option<f64>, LimitExceeded> {
        let length = self.grid.length;
        let table = BodyTable::of(work.admission.scene, &self.monitored, &self.grid);
        let (pool, window) = (&self.search_pool, ((from, to), work.meter.threads()));
        let (bodies, _) = PreparedBodies::in_window(table, self.limits(), pool, window);
        let (admission, meter) = (&work.admission, &mut work.meter);
        let (chunk, slice) = self.jump.get_or_insert((length, length));
        // What has changed since the last call counts from there on, with all instants that are rounded to it.
        let mut at = earliest_exact(from);
        // Not beyond the prescribed end of the known time: bodies may change then, and are searched for from there on.
        let until = meter.until().unwrap_or(f64::INFINITY);
        while at < to {
            if meter.is_spent() || at >= until {
                return Ok(Some(at.max(from)));
            }
            let end = (at + *chunk).min(to.min(until));
            let window = (at, end);
            let (slices, statistics) = bodies.cheapest_slices(window, *slice, admission);
            let (slicing, mut counted) = ((&slices, &statistics), Stats::default());
            let found = (&mut self.survivors, &mut counted);
            bodies.list_spans(slicing, admission, found)?;
            if admission.gives_up() {
                return Ok(Some(at.max(from)));
            }
            let examined = counted.boxes + counted.candidates;
            let examined = usize::try_from(examined).unwrap_or(usize::MAX);
            counted.slices = u64::from(slices.count());
            work.stats += counted;
            meter.count(examined.saturating_add(1));
            at = end;
            *slice = slices.length();
            let little = Self::LITTLE.0 + Self::LITTLE.1 * bodies.len();
            let factor = if examined < little { 2.0 } else { 0.5 };
            *chunk = (factor * *chunk).max(length);
        }
        self.jump = None;
        Ok(None)
    }
}
