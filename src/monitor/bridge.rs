//! Catching up with a clock that has jumped: long slices, one at a time.
//!
//! A lookahead is cut into slices of equal length, and a clock that moves on by a frame needs one more
//! of them now and then. One that jumps by hours would need thousands, most of them about nothing
//! new. What it passed over is looked at once, so no slice of it is kept, and each is as long as
//! measured work makes it: where bodies rest, or there are none, slices grow until they reach the
//! other side. What is found does not depend on it.

use super::bodies::Bodies;
use super::budget::Meter;
use super::finds::{Crowded, put_in_order};
use super::slice::{Limits, Scratch, Slice};
use crate::broad_phase::PairFilter;
use crate::rounding::seen_from;
use crate::spans::SpanKey;
use crate::stats::Stats;

/// See the module.
#[derive(Debug, Default)]
pub(super) struct Bridge {
    /// Up to where it was built, s, and the slice that goes on from there; none if there is nothing to
    /// bridge.
    head: Option<Head>,
    /// Memory for the next one.
    spare: Slice,
    scratch: Scratch,
}

/// Where a bridge is being built.
#[derive(Debug)]
struct Head {
    at: f64,
    slice: Slice,
    /// The slice was begun, in an earlier tick maybe.
    is_begun: bool,
    stride: Stride,
}

/// Where what is found, and what it took, are added.
type Found<'o> = (&'o mut Vec<SpanKey>, &'o mut Stats);

impl Bridge {
    /// With fewer slices left to look at, there is no need of a bridge.
    const FEW: f64 = 16.0;

    /// Whether it is far from one instant to another (s) in slices of `length` s, or a bridge was begun.
    pub(super) fn is_needed(&self, (from, to): (f64, f64), length: f64) -> bool {
        self.head.is_some() || to - from > Self::FEW * length
    }

    /// Goes on from `from` to `to` (s) as far as the meter lets, in slices of at least `length` s. Returns
    /// where it had to stop, none if it is across.
    ///
    /// # Errors
    ///
    /// If there is too little room for what is found.
    pub(super) fn cross<F: PairFilter>(
        &mut self,
        (from, to, length): (f64, f64, f64),
        (bodies, filter): (&Bodies<'_>, &F),
        limits: Limits,
        meter: &mut Meter,
        mut found: Found<'_>,
    ) -> Result<Option<f64>, Crowded> {
        let spare = &mut self.spare;
        let head = self.head.get_or_insert_with(|| Head {
            at: seen_from(from),
            slice: std::mem::take(spare),
            is_begun: false,
            stride: Stride::of(length),
        });
        while head.at < to {
            let scratch = &mut self.scratch;
            if !head.go_on(to, (bodies, filter), limits, scratch, meter, &mut found)? {
                return Ok(Some(head.at.max(from)));
            }
        }
        if let Some(head) = self.head.take() {
            self.spare = head.slice;
        }
        Ok(None)
    }

    /// Notes that bodies have changed.
    pub(super) fn note(&mut self, slots: &[u32]) {
        if let Some(head) = self.head.as_mut().filter(|head| head.is_begun) {
            head.slice.note(slots);
        }
    }
}

impl Head {
    /// Begins the next slice, unless it was begun.
    fn begin(&mut self, to: f64) {
        if !self.is_begun {
            let end = (self.at + self.stride.length).min(to);
            self.slice.begin(0, (self.at, end));
            self.slice.need();
            self.is_begun = true;
        }
    }

    /// Looks at the slice at hand; whether there is something to go on with.
    fn go_on<F: PairFilter>(
        &mut self,
        to: f64,
        (bodies, filter): (&Bodies<'_>, &F),
        limits: Limits,
        scratch: &mut Scratch,
        meter: &mut Meter,
        (survivors, stats): &mut Found<'_>,
    ) -> Result<bool, Crowded> {
        let until = meter.until().unwrap_or(f64::INFINITY);
        if meter.is_spent() || self.at >= until {
            return Ok(false);
        }
        // Not beyond what is known after this tick: what changes then is looked for from there on.
        self.begin(to.min(until));
        let strict = self.stride.limits(limits, bodies.flights.len());
        let before = meter.done();
        self.slice
            .refresh(bodies, filter, None, strict, scratch, |work| {
                meter.count(work);
                !meter.is_spent()
            });
        let crowded = self.slice.check_room();
        self.stride.work += meter.done() - before;
        **stats += std::mem::take(&mut self.slice.stats);
        survivors.append(&mut self.slice.survivors);
        if survivors.len() > limits.survivors.saturating_mul(2) {
            // A span is found in each slice that it is in.
            put_in_order(survivors);
            if survivors.len() > limits.survivors {
                return Err(Crowded);
            }
        }
        if crowded.is_err() {
            self.stride.shorten()?;
        } else if self.slice.is_fresh(bodies) {
            self.at = self.slice.end();
            self.stride.adapt();
        } else {
            return Ok(false);
        }
        self.is_begun = false;
        Ok(true)
    }
}

/// How long a slice is to be: as long as a longer one means less work for the same time.
#[derive(Debug)]
struct Stride {
    length: f64,
    least: f64,
    /// Work on the slice at hand so far.
    work: u64,
    /// Work per second of the slice before.
    rate: f64,
    /// Slices until a longer one is tried, and how many there were the last time.
    wait: u32,
    patience: u32,
}

impl Stride {
    const FACTOR: f64 = 4.0;
    /// Slices of the least length between trials, at most.
    const MAX_PATIENCE: u32 = 64;

    const fn of(least: f64) -> Self {
        Self {
            length: least,
            least,
            work: 0,
            rate: f64::INFINITY,
            wait: 0,
            patience: 1,
        }
    }

    /// More candidates mean that a slice is too long. The shortest ones hold what there is room for.
    fn limits(&self, limits: Limits, bodies: usize) -> Limits {
        const FEW: u64 = 1 << 16;
        const PER_BODY: u64 = 64;
        if self.length > self.least {
            let candidates = limits.candidates.min(FEW + PER_BODY * bodies as u64);
            Limits {
                candidates,
                ..limits
            }
        } else {
            limits
        }
    }

    /// After a slice is done.
    #[allow(clippy::cast_precision_loss, reason = "a rate")]
    fn adapt(&mut self) {
        let rate = self.work as f64 / self.length;
        let is_dearer = rate > self.rate;
        (self.rate, self.work) = (rate, 0);
        if is_dearer && self.length > self.least {
            self.shrink();
        } else if self.wait > 0 {
            self.wait -= 1;
        } else {
            self.length *= Self::FACTOR;
        }
    }

    /// After one that was given up.
    fn shorten(&mut self) -> Result<(), Crowded> {
        if self.length <= self.least {
            return Err(Crowded);
        }
        self.work = 0;
        self.rate = f64::INFINITY;
        self.shrink();
        Ok(())
    }

    fn shrink(&mut self) {
        self.length = (self.length / Self::FACTOR).max(self.least);
        self.patience = (2 * self.patience).min(Self::MAX_PATIENCE);
        self.wait = self.patience;
    }
}
