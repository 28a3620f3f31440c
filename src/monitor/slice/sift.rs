//! From a slice's candidates to spans that may hold a contact, in the order of what a test costs.

use super::state::{Near, Scratch, Slice};
use crate::broad_phase::PairFilter;
use crate::monitor::bodies::Bodies;
use crate::narrow_phase::{Party, approaching, may_touch};
use crate::simd::prefetch;
use crate::spans::{SpanKey, each_span};
use std::ops::Range;
use std::slice::from_ref;

impl Slice {
    /// Candidates looked at together.
    const BATCH: usize = 16;

    /// How many candidates ahead courses are fetched.
    const AHEAD: usize = 8;

    /// Knots that are fetched: few bodies have left more than these behind.
    const KNOTS: usize = 40;

    /// Keeps the spans of some more candidates that cheap tests cannot rule out. Bodies that have
    /// changed since are compared anew.
    pub(super) fn sift<F: PairFilter>(
        &mut self,
        bodies: &Bodies<'_>,
        filter: &F,
        scratch: &mut Scratch,
    ) -> usize {
        let Scratch { near, pieces, .. } = scratch;
        let first = self.sifted;
        self.sifted = self.candidates.len().min(first + Self::STEP);
        self.judge(first..self.sifted, near);
        for batch in near.chunks(Self::BATCH) {
            // What each loop reads lies anywhere in memory, and was fetched by the one before.
            let mut pairs = [[Party::NONE; 2]; Self::BATCH];
            for (pair, near) in pairs.iter_mut().zip(batch) {
                let slots = [near.pair.a, near.pair.b];
                if !filter.admits(slots[0], slots[1]) {
                    continue;
                }
                *pair = slots.map(|slot| bodies.party(slot).unwrap_or(Party::NONE));
                for party in &*pair {
                    party.knots.prefetch(0, Self::KNOTS);
                }
            }
            pieces.clear();
            for (number, ([a, b], near)) in pairs.iter().zip(batch).enumerate() {
                each_span((&a.knots, &b.knots), near.hints, near.interval, |span| {
                    a.prefetch(span.a as usize);
                    b.prefetch(span.b as usize);
                    pieces.push((number, span));
                });
            }
            self.stats.spans += pieces.len() as u64;
            for &(number, span) in &*pieces {
                let ([a, b], near) = (&pairs[number], &batch[number]);
                if may_touch(a, b, span, bodies.margin, near.interval) {
                    self.survivors.push(SpanKey {
                        a: near.pair.a,
                        b: near.pair.b,
                        cubic_a: span.a,
                        cubic_b: span.b,
                    });
                }
            }
        }
        self.sifted - first
    }

    /// Lists which of some candidates may be near each other from their courses.
    fn judge(&self, some: Range<usize>, near: &mut Vec<Near>) {
        near.clear();
        let candidates = &self.candidates[some];
        let is_changed = |slot: u32| self.is_changed.get(slot as usize) == Some(&true);
        for (number, &pair) in candidates.iter().enumerate() {
            if let Some(later) = candidates.get(number + Self::AHEAD) {
                prefetch(from_ref(&self.courses[later.a as usize]));
                prefetch(from_ref(&self.courses[later.b as usize]));
            }
            let (a, b) = (
                &self.courses[pair.a as usize],
                &self.courses[pair.b as usize],
            );
            let Some(interval) = approaching(a, b, self.interval) else {
                continue;
            };
            if !is_changed(pair.a) && !is_changed(pair.b) {
                near.push(Near {
                    pair,
                    interval,
                    hints: (a.first, b.first),
                });
            }
        }
    }
}
