//! Refinement of candidates to the spans of a pair that may hold a contact.
//!
//! Tests run in the order of their cost: fat lines, then knots, compact cubics, and segments. Each
//! stage processes a batch of those that the previous stage has left, and prefetches a few entries ahead.
//! The bodies of neighbouring candidates are scattered in memory; without prefetching, waiting
//! would dominate.

use super::Bodies;
use crate::bounds::{FatLine, HullTest};
use crate::broad_phase::Candidate;
use crate::narrow_phase::{approaching, keep_approaching, may_touch};
use crate::simd::prefetch;
use crate::spans::{Span, SpanKey, spans_from};
use crate::window::Window;
use std::slice::from_ref;

/// A slice whose candidates are refined, with its bodies.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RefineContext<'a, B> {
    pub(crate) bodies: &'a B,
    /// Fat lines of the slice, indexed as in its candidates.
    pub(crate) fat_lines: &'a [FatLine],
    pub(crate) interval: (f64, f64),
    pub(crate) window: Window,
    pub(crate) margin: f64,
    /// Beyond this number of spans from one slice, no further batches are examined.
    pub(crate) max_spans: usize,
}

impl<B> RefineContext<'_, B> {
    /// Returns true if a span that may hold a contact goes to the solver without another test.
    ///
    /// Most such spans hold a contact. Where one does not, the solver finds that sooner than
    /// another test. A span that reaches beyond the window is always tested: the solver could take motion beyond the
    /// window for a contact of no duration, and the result would then depend on other bodies.
    fn solves_at_once(&self, span: Span) -> bool {
        span.start >= self.window.start() && span.end <= self.window.end()
    }
}

/// A pair that may be near by its fat lines, in an interval (s). The hints are the number of a cubic of each body:
/// not after its first cubic that overlaps the interval.
#[derive(Clone, Copy, Debug)]
struct NearPair {
    bodies: [u32; 2],
    hints: [u32; 2],
    interval: (f64, f64),
}

/// A span of a near pair, and the interval to examine.
#[derive(Clone, Copy, Debug)]
struct PairSpan {
    a: u32,
    b: u32,
    span: Span,
    interval: (f64, f64),
}

impl PairSpan {
    /// Returns the part of the span to examine, s.
    fn part(&self) -> (f64, f64) {
        let (from, to) = self.interval;
        (self.span.start.max(from), self.span.end.min(to))
    }

    const fn key(&self) -> SpanKey {
        SpanKey::of((self.a, self.b), self.span)
    }
}

/// Refines candidates to spans; owns the batches between its stages.
#[derive(Clone, Debug, Default)]
pub(crate) struct CandidateRefiner {
    candidates: Vec<Candidate>,
    near: Vec<NearPair>,
    spans: Vec<PairSpan>,
}

impl CandidateRefiner {
    /// Candidates in a batch: its lists fit into the second-level cache.
    const BATCH: usize = 1024;
    /// Prefetch distance in entries.
    const AHEAD: usize = 8;
    /// Prefetch distance in candidates: there are many of them, with little work each.
    const AHEAD_OF_CANDIDATES: usize = 4 * Self::AHEAD;

    /// Appends the spans of a slice's candidates that cheap tests cannot rule out; returns the
    /// number of spans examined. `pair` returns the bodies of a candidate, or `None` to skip it; it
    /// is asked only about candidates that may be near.
    pub(crate) fn refine<B: Bodies>(
        &mut self,
        context: &RefineContext<'_, B>,
        candidates: &[Candidate],
        pair: impl Fn(Candidate) -> Option<[u32; 2]>,
        found: &mut Vec<SpanKey>,
    ) -> u64 {
        let mut examined = 0;
        // Of earlier slices.
        let before = found.len();
        for batch in candidates.chunks(Self::BATCH) {
            if found.len() - before > context.max_spans {
                break;
            }
            self.list_near_pairs(context, batch, &pair);
            self.list_spans(context.bodies);
            examined += self.spans.len() as u64;
            self.compare_compact(context, found);
            self.compare(context, found);
        }
        examined
    }

    /// Lists the candidates that may be near by their fat lines.
    fn list_near_pairs<B>(
        &mut self,
        context: &RefineContext<'_, B>,
        batch: &[Candidate],
        pair: impl Fn(Candidate) -> Option<[u32; 2]>,
    ) {
        let RefineContext {
            fat_lines,
            interval,
            ..
        } = *context;
        let line = |place: u32| &fat_lines[place as usize];
        self.candidates.clear();
        self.candidates.extend_from_slice(batch);
        keep_approaching(
            &mut self.candidates,
            |candidate| [line(candidate.a), line(candidate.b)],
            |place| {
                if let Some(later) = batch.get(place + Self::AHEAD_OF_CANDIDATES) {
                    prefetch(from_ref(line(later.a)));
                    prefetch(from_ref(line(later.b)));
                }
            },
        );
        self.near.clear();
        for &candidate in &self.candidates {
            let (a, b) = (line(candidate.a), line(candidate.b));
            if let Some(interval) = approaching(a, b, interval)
                && let Some(mut bodies) = pair(candidate)
            {
                let mut hints = [a.first, b.first];
                // A body that teleports has another place, behind those of all bodies.
                if bodies[0] > bodies[1] {
                    bodies.reverse();
                    hints.reverse();
                }
                self.near.push(NearPair {
                    bodies,
                    hints,
                    interval,
                });
            }
        }
    }

    fn list_spans(&mut self, bodies: &impl Bodies) {
        self.spans.clear();
        for (i, near) in self.near.iter().enumerate() {
            if let Some(later) = self.near.get(i + 2 * Self::AHEAD) {
                later.bodies.into_iter().for_each(|body| bodies.fetch(body));
            }
            if let Some(later) = self.near.get(i + Self::AHEAD) {
                for cubic in later.bodies.into_iter().zip(later.hints) {
                    bodies.fetch_knots(cubic);
                }
            }
            let [a, b] = near.bodies;
            let (knots_a, knots_b) = (bodies.knots(a), bodies.knots(b));
            let (hints, interval) = (near.hints.into(), near.interval);
            let (from, to) = interval;
            for span in spans_from(&knots_a, &knots_b, hints, from, to) {
                self.spans.push(PairSpan {
                    a,
                    b,
                    span,
                    interval,
                });
            }
        }
    }

    /// Removes the spans that compact cubics show to be apart. Those that need no other test are
    /// appended to `found`, the others stay.
    fn compare_compact<B: Bodies>(
        &mut self,
        context: &RefineContext<'_, B>,
        found: &mut Vec<SpanKey>,
    ) {
        let bodies = context.bodies;
        let mut kept = 0;
        for number in 0..self.spans.len() {
            if let Some(later) = self.spans.get(number + Self::AHEAD) {
                for cubic in later.key().cubics() {
                    bodies.fetch_cubic(cubic);
                }
            }
            let one = self.spans[number];
            match bodies.hull_test(one.key().cubics(), one.part()) {
                HullTest::Apart => {}
                HullTest::Near if context.solves_at_once(one.span) => found.push(one.key()),
                HullTest::Near | HullTest::Undecided => {
                    self.spans[kept] = one;
                    kept += 1;
                }
            }
        }
        self.spans.truncate(kept);
    }

    /// Appends the spans that their segments do not show to be apart either.
    fn compare<B: Bodies>(&self, context: &RefineContext<'_, B>, found: &mut Vec<SpanKey>) {
        let bodies = context.bodies;
        for (i, one) in self.spans.iter().enumerate() {
            if let Some(later) = self.spans.get(i + Self::AHEAD) {
                for cubic in later.key().cubics() {
                    bodies.fetch_segment(cubic);
                }
            }
            let (a, b) = (bodies.view(one.a), bodies.view(one.b));
            if may_touch(&a, &b, one.span, context.margin, one.interval) {
                found.push(one.key());
            }
        }
    }
}
