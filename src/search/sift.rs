//! From candidates to survivors: which spans of a pair may hold a contact.
//!
//! Tests in the order of their cost: courses, then knots, sketches, and segments. Each stage goes
//! through a batch of what the one before left, and what it reads is fetched a few entries ahead:
//! the bodies of neighbouring candidates lie anywhere in memory, and waiting for them would be most
//! of the time.

use crate::bounds::{Leg, Pose, Sight, Stroke, sight};
use crate::broad_phase::Candidate;
use crate::broad_phase::fill::Slice;
use crate::narrow_phase::{Party, approaching, may_touch};
use crate::simd::prefetch;
use crate::spans::{Span, SpanKey, each_span};
use crate::window::Window;
use std::slice::from_ref;

/// What is asked of the candidates of a slice.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Question<'a> {
    pub(crate) parties: &'a [Party<'a>],
    pub(crate) poses: &'a [Pose<'a, Stroke>],
    pub(crate) slice: &'a Slice,
    /// The slice's, s.
    pub(crate) interval: (f64, f64),
    pub(crate) window: Window,
    pub(crate) margin: f64,
    /// With more spans from one slice it is too crowded: no further ones are looked at.
    pub(crate) max_spans: usize,
}

impl Question<'_> {
    /// Whether a span that may hold a contact is solved without another test.
    ///
    /// Few of them hold none, and the solver sees that at once; a proof of it takes longer. One that the
    /// window cuts is always asked about: what is beyond there, the solver could take for a contact of
    /// no duration, and then it would matter what else is in the scene.
    fn solves_at_once(&self, span: Span) -> bool {
        span.start >= self.window.start() && span.end <= self.window.end()
    }
}

/// A pair that may be near from its courses: when, and a cubic of each body that is not later.
#[derive(Clone, Copy, Debug)]
struct Near {
    a: u32,
    b: u32,
    interval: (f64, f64),
    hints: (u32, u32),
}

/// A span of such a pair, and the part of it to look at.
#[derive(Clone, Copy, Debug)]
struct Piece {
    a: u32,
    b: u32,
    span: Span,
    interval: (f64, f64),
}

impl Piece {
    /// When it is looked at, s.
    fn part(&self) -> (f64, f64) {
        let (from, to) = self.interval;
        (self.span.start.max(from), self.span.end.min(to))
    }

    const fn survivor(&self) -> SpanKey {
        let Self { a, b, span, .. } = *self;
        SpanKey {
            a,
            b,
            cubic_a: span.a,
            cubic_b: span.b,
        }
    }
}

/// Sifts candidates; owns the batches between its stages.
#[derive(Clone, Debug, Default)]
pub(crate) struct Sieve {
    near: Vec<Near>,
    pieces: Vec<Piece>,
}

impl Sieve {
    /// Candidates in a batch: its lists stay in the second-level cache.
    const BATCH: usize = 1024;
    /// Entries that are fetched ahead of the one at hand.
    const AHEAD: usize = 8;
    /// Knots that are fetched: two lines.
    const KNOTS: usize = 16;
    /// Candidates: there are many of them, and little is done with each.
    const AHEAD_OF_CANDIDATES: usize = 4 * Self::AHEAD;

    /// Looks at each span of the candidates of a slice; gives how many there are. Those that cheap
    /// tests cannot rule out are appended.
    pub(crate) fn sift(
        &mut self,
        question: &Question<'_>,
        candidates: &[Candidate],
        survivors: &mut Vec<SpanKey>,
    ) -> u64 {
        let mut looked_at = 0;
        // Of earlier slices.
        let before = survivors.len();
        for batch in candidates.chunks(Self::BATCH) {
            if survivors.len() - before > question.max_spans {
                break;
            }
            self.judge(question, batch);
            self.cut(question.poses);
            looked_at += self.pieces.len() as u64;
            self.sketch(question, survivors);
            self.refine(question, survivors);
        }
        looked_at
    }

    /// The candidates that may be near from their courses.
    fn judge(&mut self, question: &Question<'_>, batch: &[Candidate]) {
        let Question {
            slice, interval, ..
        } = *question;
        self.near.clear();
        for (i, candidate) in batch.iter().enumerate() {
            if let Some(later) = batch.get(i + Self::AHEAD_OF_CANDIDATES) {
                prefetch(from_ref(&slice.courses[later.a as usize]));
                prefetch(from_ref(&slice.courses[later.b as usize]));
            }
            let (a, b) = (candidate.a as usize, candidate.b as usize);
            let (course_a, course_b) = (&slice.courses[a], &slice.courses[b]);
            if let Some(interval) = approaching(course_a, course_b, interval) {
                self.near.push(Near {
                    a: slice.bodies[a],
                    b: slice.bodies[b],
                    interval,
                    hints: (course_a.first, course_b.first),
                });
            }
        }
    }

    /// Their spans.
    fn cut(&mut self, poses: &[Pose<'_, Stroke>]) {
        self.pieces.clear();
        for (i, near) in self.near.iter().enumerate() {
            if let Some(later) = self.near.get(i + 2 * Self::AHEAD) {
                prefetch(from_ref(&poses[later.a as usize]));
                prefetch(from_ref(&poses[later.b as usize]));
            }
            if let Some(later) = self.near.get(i + Self::AHEAD) {
                let (a, b) = (&poses[later.a as usize], &poses[later.b as usize]);
                a.knots.prefetch(later.hints.0 as usize, Self::KNOTS);
                b.knots.prefetch(later.hints.1 as usize, Self::KNOTS);
            }
            let (a, b) = (&poses[near.a as usize], &poses[near.b as usize]);
            each_span((&a.knots, &b.knots), near.hints, near.interval, |span| {
                self.pieces.push(Piece {
                    a: near.a,
                    b: near.b,
                    span,
                    interval: near.interval,
                });
            });
        }
    }

    /// Those that their sketches do not show to be apart: the ones that are solved at once are appended
    /// to the survivors, the ones that are asked about first stay.
    fn sketch(&mut self, question: &Question<'_>, survivors: &mut Vec<SpanKey>) {
        let poses = question.poses;
        let leg = |body: u32, cubic: u32| Leg {
            pose: &poses[body as usize],
            cubic: cubic as usize,
        };
        let mut kept = 0;
        for number in 0..self.pieces.len() {
            if let Some(Piece { a, b, span, .. }) = self.pieces.get(number + Self::AHEAD) {
                poses[*a as usize].fetch(span.a as usize);
                poses[*b as usize].fetch(span.b as usize);
            }
            let piece = self.pieces[number];
            let Piece { a, b, span, .. } = piece;
            match sight(&leg(a, span.a), &leg(b, span.b), piece.part()) {
                Sight::Apart => {}
                Sight::Near if question.solves_at_once(span) => survivors.push(piece.survivor()),
                Sight::Near | Sight::Blurred => {
                    self.pieces[kept] = piece;
                    kept += 1;
                }
            }
        }
        self.pieces.truncate(kept);
    }

    /// Those that their segments do not show to be apart either.
    fn refine(&self, question: &Question<'_>, survivors: &mut Vec<SpanKey>) {
        let (parties, margin) = (question.parties, question.margin);
        for (i, piece) in self.pieces.iter().enumerate() {
            if let Some(later) = self.pieces.get(i + Self::AHEAD) {
                parties[later.a as usize].prefetch(later.span.a as usize);
                parties[later.b as usize].prefetch(later.span.b as usize);
            }
            let (a, b) = (&parties[piece.a as usize], &parties[piece.b as usize]);
            if may_touch(a, b, piece.span, margin, piece.interval) {
                survivors.push(piece.survivor());
            }
        }
    }
}
