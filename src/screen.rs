//! One-shot screening: a window in, all conflicts out.
//!
//! Slices find candidates, cheap tests leave survivors (a pair and a span each), and the exact
//! solver works on whole spans of the survivors, each once. Which slice a survivor came from, and
//! on which thread, is forgotten before the solver sees it: hence the same bits whatever the
//! slicing and the number of threads.

use crate::bounds::{Extremes, Frame, Inflation};
use crate::broad_phase::slices::{Block, Slices, Traffic};
use crate::broad_phase::{
    BroadPhase, BruteForce, Candidate, Everyone, Method, PairFilter, Sweep, Tree,
};
use crate::conflict::{Clip, ClosestApproach, Conflict};
use crate::error::Error;
use crate::id::BodyId;
use crate::layers::Layers;
use crate::narrow_phase::{Approach, Contact, Party, closest_approach, contacts, may_touch};
use crate::parallel;
use crate::query::Query;
use crate::scene::{Body, Occupant, Scene};
use crate::spans::{Span, common_domain, spans, spans_from};
use crate::stats::Stats;
use crate::trajectory::Pieces;
use crate::window::Window;
use std::collections::BTreeSet;
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::Instant;

/// The answer to a [`Query`].
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Screening {
    /// All conflicts, sorted by (enter, a, b).
    pub conflicts: Vec<Conflict>,
    /// The funnel they came through.
    pub stats: Stats,
}

/// A pair's span that cheap tests could not rule out; bodies by their place in the line-up.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Survivor {
    a: u32,
    b: u32,
    span_a: u32,
    span_b: u32,
}

/// The bodies of a scene as the pipeline sees them: by place, in the order of their ids.
struct LineUp<'a> {
    ids: Vec<BodyId>,
    occupants: Vec<&'a Occupant>,
    pieces: Vec<Pieces<'a>>,
    window: Window,
    margin: f64,
}

impl Scene {
    /// All conflicts of the scene within the query's window and margin.
    ///
    /// Runs on the threads of the current rayon pool (feature `parallel`); the result is the same
    /// bits for any number of them.
    ///
    /// # Errors
    ///
    /// [`Error::WindowNotClosed`] if a body exists beyond its knots and the window has no end;
    /// [`Error::InBody`] with [`Error::OutOfRange`] if an extrapolated cubic leaves the range of
    /// numbers within the window.
    pub fn screen(&self, query: &Query) -> Result<Screening, Error> {
        self.screen_with_progress(query, |_| {})
    }

    /// The same as [`screen`](Self::screen); `progress` is told now and then, from any of the
    /// threads, which share of the time slices is done (0 to 1; the last call says 1).
    ///
    /// # Errors
    ///
    /// As [`screen`](Self::screen).
    pub fn screen_with_progress(
        &self,
        query: &Query,
        progress: impl Fn(f64) + Sync,
    ) -> Result<Screening, Error> {
        let begin = Instant::now();
        let line_up = LineUp::new(self, query)?;
        let mut screening = if line_up.is_unfiltered(self) {
            line_up.screen(query.method(), &Everyone, &progress)
        } else {
            line_up.screen(query.method(), &Admission::new(self, &line_up), &progress)
        };
        screening.stats.total_time = begin.elapsed();
        Ok(screening)
    }

    /// The least separation of two bodies within a window, and when; none where they do not exist
    /// at the same time. Layers and ignored pairs play no part.
    ///
    /// # Errors
    ///
    /// [`Error::UnknownBody`], [`Error::SameBody`]; [`Error::WindowNotClosed`] and
    /// [`Error::InBody`] as for [`screen`](Self::screen).
    pub fn closest_approach(
        &self,
        a: BodyId,
        b: BodyId,
        window: Window,
    ) -> Result<Option<ClosestApproach>, Error> {
        // The answer is about a and b as given, whichever id is smaller.
        self.pair(a, b)?;
        let body = |id| self.body(id).ok_or(Error::UnknownBody { id });
        let (body_a, body_b) = (body(a)?, body(b)?);
        let (pieces_a, pieces_b) = (pieces_of(body_a, window)?, pieces_of(body_b, window)?);
        let (party_a, party_b) = (party(body_a, &pieces_a), party(body_b, &pieces_b));
        let Some(clip) = clip_of(&party_a, &party_b, window) else {
            return Ok(None);
        };
        let met = spans(party_a.knots, party_b.knots, clip.0, clip.1);
        Ok(closest_approach(&party_a, &party_b, met, clip)
            .map(|approach| describe(&approach, &party_a, &party_b)))
    }
}

impl<'a> LineUp<'a> {
    fn new(scene: &'a Scene, query: &Query) -> Result<Self, Error> {
        let (ids, occupants): (Vec<_>, Vec<_>) = scene.occupants().unzip();
        let pieces = occupants
            .iter()
            .map(|occupant| pieces_of(&occupant.body, query.window()))
            .collect::<Result<Vec<_>, _>>()?;
        // Open ends are closed where no body exists beyond them.
        let first = pieces.iter().filter_map(|body| body.knots.first().copied());
        let last = pieces.iter().filter_map(|body| body.knots.last().copied());
        let start = first.fold(f64::INFINITY, f64::min);
        let end = last.fold(f64::NEG_INFINITY, f64::max);
        let existence = Window::new(start, end).ok();
        let window = existence.and_then(|existence| existence.intersection(query.window()));
        let (ids, occupants, pieces) = match window {
            Some(_) => (ids, occupants, pieces),
            None => (Vec::new(), Vec::new(), Vec::new()),
        };
        Ok(Self {
            ids,
            occupants,
            pieces,
            window: window.unwrap_or(query.window()),
            margin: query.margin(),
        })
    }

    fn parties(&self) -> Vec<Party<'_>> {
        self.occupants
            .iter()
            .zip(&self.pieces)
            .map(|(occupant, pieces)| party(&occupant.body, pieces))
            .collect()
    }

    fn is_unfiltered(&self, scene: &Scene) -> bool {
        scene.ignored_pairs().next().is_none()
            && self
                .occupants
                .iter()
                .all(|occupant| occupant.body.layers == Layers::ALL)
    }

    fn screen<F: PairFilter>(
        &self,
        method: Method,
        filter: &F,
        progress: &(impl Fn(f64) + Sync),
    ) -> Screening {
        let parties = self.parties();
        let mut stats = Stats {
            bodies: parties.len() as u64,
            segments: parties
                .iter()
                .map(|party| party.segments.len() as u64)
                .sum(),
            ..Stats::default()
        };
        let survivors = if parties.len() < 2 {
            Vec::new()
        } else {
            match method {
                Method::BruteForce => {
                    self.survivors::<BruteForce, F>(&parties, filter, progress, &mut stats)
                }
                Method::Tree => self.survivors::<Tree, F>(&parties, filter, progress, &mut stats),
                Method::Sweep => self.survivors::<Sweep, F>(&parties, filter, progress, &mut stats),
            }
        };
        let begin = Instant::now();
        let mut conflicts = self.solve(&parties, &survivors);
        parallel::sort(&mut conflicts, Conflict::order);
        stats.narrow_time += begin.elapsed();
        stats.survivors = survivors.len() as u64;
        stats.conflicts = conflicts.len() as u64;
        Screening { conflicts, stats }
    }

    /// Slices and cheap tests: every span of every pair in which they may touch, each once.
    fn survivors<B: BroadPhase, F: PairFilter>(
        &self,
        parties: &[Party<'_>],
        filter: &F,
        progress: &(impl Fn(f64) + Sync),
        stats: &mut Stats,
    ) -> Vec<Survivor> {
        let inflations: Vec<Inflation> = parties
            .iter()
            .map(|party| Inflation::of(party.spheres, self.margin))
            .collect();
        let largest = inflations.iter().map(Inflation::size).fold(0.0, f64::max);
        let frame = Frame::around(self.extremes(parties), largest);
        let slices = self.slices(largest);
        stats.slices = u64::from(slices.count());
        let blocks = slices.count().div_ceil(Block::SLICES);
        let done_blocks = AtomicU32::new(0);
        let results = parallel::map(blocks, Scratch::<B>::default, |scratch, block| {
            let start = block * Block::SLICES;
            let range = start..(start + Block::SLICES).min(slices.count());
            let found = self.block(
                parties,
                &inflations,
                &frame,
                &slices,
                range,
                filter,
                scratch,
            );
            let done = done_blocks.fetch_add(1, Ordering::Relaxed) + 1;
            progress(f64::from(done) / f64::from(blocks));
            found
        });
        let mut survivors = Vec::new();
        for (found, counted) in results {
            survivors.extend(found);
            *stats += counted;
        }
        let begin = Instant::now();
        parallel::sort(&mut survivors, Survivor::cmp);
        survivors.dedup();
        stats.narrow_time += begin.elapsed();
        survivors
    }

    #[allow(
        clippy::too_many_arguments,
        reason = "one stage's inputs, each of its own kind"
    )]
    fn block<B: BroadPhase, F: PairFilter>(
        &self,
        parties: &[Party<'_>],
        inflations: &[Inflation],
        frame: &Frame,
        slices: &Slices,
        range: std::ops::Range<u32>,
        filter: &F,
        scratch: &mut Scratch<B>,
    ) -> (Vec<Survivor>, Stats) {
        let mut stats = Stats::default();
        let mut survivors = Vec::new();
        let begin = Instant::now();
        let Scratch {
            method,
            block,
            candidates,
        } = scratch;
        block.fill(parties, inflations, frame, slices, range.clone());
        stats.bounds_time += begin.elapsed();
        for (slice, boxes) in range.zip(&block.boxes) {
            let begin = Instant::now();
            candidates.clear();
            method.pairs(boxes, filter, candidates);
            let found = Instant::now();
            let interval = slices.interval(slice);
            for &candidate in &*candidates {
                stats.spans +=
                    self.sift(parties, &block.firsts, candidate, interval, &mut survivors);
            }
            stats.boxes += boxes.len() as u64;
            stats.candidates += candidates.len() as u64;
            stats.broad_time += found - begin;
            stats.narrow_time += found.elapsed();
        }
        (survivors, stats)
    }

    /// The spans of a candidate in a slice that cheap tests cannot rule out; how many were looked
    /// at.
    fn sift(
        &self,
        parties: &[Party<'_>],
        firsts: &[u32],
        candidate: Candidate,
        interval: (f64, f64),
        survivors: &mut Vec<Survivor>,
    ) -> u64 {
        let (a, b) = (
            &parties[candidate.a as usize],
            &parties[candidate.b as usize],
        );
        let mut looked_at = 0;
        let hints = (firsts[candidate.a as usize], firsts[candidate.b as usize]);
        for span in spans_from(a.knots, b.knots, hints, interval.0, interval.1) {
            looked_at += 1;
            if may_touch(a, b, span, self.margin, interval) {
                survivors.push(Survivor {
                    a: candidate.a,
                    b: candidate.b,
                    span_a: span.a,
                    span_b: span.b,
                });
            }
        }
        looked_at
    }

    /// The exact answer for the survivors (sorted), a pair at a time.
    fn solve(&self, parties: &[Party<'_>], survivors: &[Survivor]) -> Vec<Conflict> {
        let pairs: Vec<&[Survivor]> = survivors
            .chunk_by(|x, y| (x.a, x.b) == (y.a, y.b))
            .collect();
        let solved = parallel::map(pairs.len(), Vec::new, |found: &mut Vec<Contact>, pair| {
            let met = pairs[pair];
            let (place_a, place_b) = (met[0].a as usize, met[0].b as usize);
            let (a, b) = (&parties[place_a], &parties[place_b]);
            let Some(clip) = clip_of(a, b, self.window) else {
                return Vec::new();
            };
            let met = met.iter().map(|survivor| survivor.span(a, b));
            found.clear();
            contacts(a, b, met, self.margin, clip, found);
            let ids = (self.ids[place_a], self.ids[place_b]);
            let conflict = |contact: &Contact| conflict(contact, ids, (a, b), clip);
            found.iter().map(conflict).collect()
        });
        solved.into_iter().flatten().collect()
    }

    fn extremes(&self, parties: &[Party<'_>]) -> Extremes {
        let mut extremes = Extremes::NOTHING;
        for (occupant, party) in self.occupants.iter().zip(parties) {
            extremes.include(occupant.outline.extremes);
            // Pieces beyond the knots are not in the outline.
            if party.segments.len() != occupant.body.trajectory.segments().len() {
                for (segment, ends) in party.segments.iter().zip(party.knots.windows(2)) {
                    let reach = segment.reach(ends[0], ends[1]);
                    extremes.include(Extremes::of_segment(segment, reach));
                }
            }
        }
        extremes
    }

    fn slices(&self, reach: f64) -> Slices {
        let (start, end) = (self.window.start(), self.window.end());
        let mut traffic = Traffic {
            body_time: 0.0,
            path: 0.0,
            segments: 0.0,
            world: [0.0; 3],
            reach: 2.0 * reach,
        };
        let mut extremes = Extremes::NOTHING;
        for occupant in &self.occupants {
            let body = &occupant.body;
            let time = body
                .trajectory
                .domain()
                .intersection(self.window)
                .map_or(0.0, |shared| shared.end() - shared.start());
            let knots = body.trajectory.knots();
            let planned = knots.last().unwrap_or(&0.0) - knots.first().unwrap_or(&0.0);
            traffic.body_time += time;
            if planned > 0.0 {
                traffic.path += occupant.outline.path * (time / planned);
                #[allow(clippy::cast_precision_loss, reason = "an estimate")]
                let segments = body.trajectory.segments().len() as f64;
                traffic.segments += segments * (time / planned);
            }
            extremes.include(occupant.outline.extremes);
        }
        traffic.world = (extremes.high - extremes.low).to_array();
        Slices::choose(start, end, &traffic)
    }
}

impl Survivor {
    fn span(&self, a: &Party<'_>, b: &Party<'_>) -> Span {
        let (i, j) = (self.span_a as usize, self.span_b as usize);
        Span {
            start: a.knots[i].max(b.knots[j]),
            end: a.knots[i + 1].min(b.knots[j + 1]),
            a: self.span_a,
            b: self.span_b,
        }
    }
}

/// What one thread reuses from slice to slice.
#[derive(Default)]
struct Scratch<B> {
    method: B,
    block: Block,
    candidates: Vec<Candidate>,
}

/// Layers and ignored pairs, by place in the line-up.
struct Admission {
    layers: Vec<Layers>,
    ignored: BTreeSet<(u32, u32)>,
}

impl Admission {
    fn new(scene: &Scene, line_up: &LineUp<'_>) -> Self {
        let place = |id: BodyId| {
            let place = line_up.ids.binary_search(&id).ok()?;
            u32::try_from(place).ok()
        };
        Self {
            layers: line_up
                .occupants
                .iter()
                .map(|occupant| occupant.body.layers)
                .collect(),
            ignored: scene
                .ignored_pairs()
                .filter_map(|(a, b)| Some((place(a)?, place(b)?)))
                .collect(),
        }
    }
}

impl PairFilter for Admission {
    fn admits(&self, a: u32, b: u32) -> bool {
        self.layers[a as usize].admits(self.layers[b as usize])
            && (self.ignored.is_empty() || !self.ignored.contains(&(a.min(b), a.max(b))))
    }
}

fn pieces_of(body: &Body, window: Window) -> Result<Pieces<'_>, Error> {
    if !window.is_closed() && body.trajectory.domain() == Window::ALL {
        return Err(Error::WindowNotClosed { body: body.tag });
    }
    body.trajectory
        .pieces(window)
        .map_err(|error| error.in_body(body.tag))
}

fn party<'a>(body: &'a Body, pieces: &'a Pieces<'_>) -> Party<'a> {
    Party {
        knots: &pieces.knots,
        segments: &pieces.segments,
        spheres: body.hitbox.spheres(),
        bounding: body.hitbox.bounding(),
    }
}

/// The part of the window in which both bodies exist.
fn clip_of(a: &Party<'_>, b: &Party<'_>, window: Window) -> Option<(f64, f64)> {
    let (start, end) = common_domain(a.knots, b.knots)?;
    let (start, end) = (start.max(window.start()), end.min(window.end()));
    (start <= end).then_some((start, end))
}

/// A contact as it is reported.
pub(crate) fn conflict(
    contact: &Contact,
    (a, b): (BodyId, BodyId),
    (party_a, party_b): (&Party<'_>, &Party<'_>),
    clip: (f64, f64),
) -> Conflict {
    Conflict {
        a,
        b,
        enter: contact.enter,
        exit: contact.exit,
        closest: describe(&contact.closest, party_a, party_b),
        clip: Clip {
            at_enter: contact.enter <= clip.0,
            at_exit: contact.exit >= clip.1,
        },
    }
}

fn describe(approach: &Approach, a: &Party<'_>, b: &Party<'_>) -> ClosestApproach {
    let (position_a, position_b, relative_velocity) = approach.kinematics(a, b);
    ClosestApproach {
        time: approach.time,
        separation: approach.separation,
        position_a,
        position_b,
        relative_velocity,
        sphere_a: approach.sphere_a,
        sphere_b: approach.sphere_b,
    }
}
