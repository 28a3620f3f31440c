//! The bodies of a scene as the pipeline sees them: by place, in the order of their ids.

use super::scratch::Pool;
use crate::accuracy::Accuracy;
use crate::bounds::{Extremes, Sketch};
use crate::broad_phase::presence::Presence;
use crate::broad_phase::slices::Traffic;
use crate::broad_phase::{Level, PairFilter};
use crate::error::Error;
use crate::hitbox::Hitbox;
use crate::id::BodyId;
use crate::layers::Layers;
use crate::narrow_phase::Party;
use crate::query::Query;
use crate::scene::{Body, Occupant, Scene};
use crate::spans::common_domain;
use crate::trajectory::{Outside, Pieces, Segment};
use crate::window::Window;
use std::collections::BTreeSet;
use std::num::NonZeroU32;

/// The bodies of a scene as the pipeline sees them: by place, in the order of their ids.
pub(super) struct LineUp<'a> {
    pub(super) ids: Vec<BodyId>,
    pub(super) occupants: Vec<&'a Occupant>,
    pub(super) presence: Presence,
    /// Those that go on beyond their knots in the window, by ascending place.
    beyond: Vec<Beyond>,
    pub(super) window: Window,
    pub(super) margin: f64,
    pub(super) accuracy: Accuracy,
    pub(super) level: Level,
    /// How many slices, if that was prescribed.
    pub(super) prescribed: Option<NonZeroU32>,
    /// Room for survivors.
    pub(super) most_spans: usize,
    pub(super) pool: &'a Pool,
}

/// A body that goes on beyond its knots: what it follows over the window.
struct Beyond {
    place: usize,
    pieces: Pieces<'static>,
    sketch: Sketch,
}

impl<'a> LineUp<'a> {
    pub(super) fn new(scene: &'a Scene, query: &Query) -> Result<Self, Error> {
        let count = scene.len();
        let (mut ids, mut occupants) = (Vec::with_capacity(count), Vec::with_capacity(count));
        let (mut lives, mut beyond) = (Vec::with_capacity(count), Vec::new());
        // Open ends are closed where no body exists beyond them.
        let (mut start, mut end) = (f64::INFINITY, f64::NEG_INFINITY);
        for (place, (id, occupant)) in scene.occupants().enumerate() {
            let (mut first, mut last) = occupant.outline().knots;
            if let Some(pieces) = pieces_beyond(&occupant.body, query.window())? {
                first = pieces.knots.first().copied().unwrap_or(first);
                last = pieces.knots.last().copied().unwrap_or(last);
                beyond.push(Beyond {
                    place,
                    sketch: Sketch::of(&pieces.knots, &pieces.segments),
                    pieces,
                });
            }
            start = start.min(first);
            end = end.max(last);
            lives.push((first, last));
            ids.push(id);
            occupants.push(occupant);
        }
        let existence = Window::new(start, end).ok();
        let window = existence.and_then(|existence| existence.intersection(query.window()));
        if window.is_none() {
            ids.clear();
            occupants.clear();
            beyond.clear();
            lives.clear();
        }
        Ok(Self {
            ids,
            occupants,
            presence: Presence::of(lives),
            beyond,
            window: window.unwrap_or(query.window()),
            margin: query.margin(),
            accuracy: query.accuracy(),
            level: query.level(),
            prescribed: query.slices(),
            most_spans: query.most_spans(),
            pool: scene.pool(),
        })
    }

    /// Each body, and what it follows over the window if it goes on beyond its knots.
    fn bodies(&self) -> impl Iterator<Item = (&'a Occupant, Option<&Beyond>)> {
        let mut beyond = self.beyond.iter().peekable();
        let occupants = self.occupants.iter().enumerate();
        occupants.map(move |(place, &occupant)| {
            (occupant, beyond.next_if(|beyond| beyond.place == place))
        })
    }

    pub(super) fn parties(&self) -> Vec<Party<'_>> {
        let bodies = self.bodies().map(|(occupant, beyond)| {
            let Body {
                trajectory, hitbox, ..
            } = &occupant.body;
            match beyond {
                Some(Beyond { pieces, sketch, .. }) => {
                    party(hitbox, sketch.knots(), &pieces.segments)
                }
                None => {
                    let sketch = &occupant.outline().sketch;
                    party(hitbox, sketch.knots(), trajectory.segments())
                }
            }
        });
        bodies.collect()
    }

    /// The bodies' sketches over the window, by place.
    pub(super) fn sketches(&self) -> impl Iterator<Item = &Sketch> {
        self.bodies().map(|(occupant, beyond)| {
            beyond.map_or(&occupant.outline().sketch, |beyond| &beyond.sketch)
        })
    }

    pub(super) fn is_unfiltered(&self, scene: &Scene) -> bool {
        scene.ignored_pairs().next().is_none()
            && self
                .occupants
                .iter()
                .all(|occupant| occupant.body.layers == Layers::ALL)
    }

    pub(super) fn extremes(&self) -> Extremes {
        let mut extremes = Extremes::NOTHING;
        for occupant in &self.occupants {
            extremes.include(occupant.outline().extremes);
        }
        // Pieces beyond the knots are not in the outlines.
        for Beyond { pieces, .. } in &self.beyond {
            for (segment, ends) in pieces.segments.iter().zip(pieces.knots.windows(2)) {
                let reach = segment.reach(ends[0], ends[1]);
                extremes.include(Extremes::of_segment(segment, reach));
            }
        }
        extremes
    }

    /// How much moves in the window, from what is known of each body as a whole.
    pub(super) fn traffic(&self) -> Traffic {
        let mut traffic = Traffic {
            body_time: 0.0,
            path: 0.0,
            segments: 0.0,
            world: [0.0; 3],
            reach: self.margin.max(0.0),
        };
        let mut extremes = Extremes::NOTHING;
        let window = (self.window.start(), self.window.end());
        for (occupant, beyond) in self.bodies() {
            let outline = occupant.outline();
            extremes.include(outline.extremes);
            if let Some(Beyond { pieces, .. }) = beyond {
                for (segment, ends) in pieces.segments.iter().zip(pieces.knots.windows(2)) {
                    let share = overlap(window, (ends[0], ends[1])) / (ends[1] - ends[0]);
                    let [from, to] = [ends[0], ends[1]].map(|knot| segment.motion_at(knot).0);
                    traffic.path += from.distance(to) * share;
                    traffic.segments += share;
                }
                traffic.body_time += window.1 - window.0;
                continue;
            }
            let (first, last) = outline.knots;
            let time = overlap(window, (first, last));
            traffic.body_time += time;
            let planned = last - first;
            if planned > 0.0 {
                traffic.path += outline.path * (time / planned);
                #[allow(clippy::cast_precision_loss, reason = "an estimate")]
                let segments = occupant.body.trajectory.segments().len() as f64;
                traffic.segments += segments * (time / planned);
            }
        }
        traffic.world = (extremes.high - extremes.low).to_array();
        traffic
    }
}

/// How much of an interval lies within another one, s.
fn overlap((start, end): (f64, f64), (from, to): (f64, f64)) -> f64 {
    (to.min(end) - from.max(start)).max(0.0)
}

/// Layers and ignored pairs, by place in the line-up.
pub(super) struct Admission {
    layers: Vec<Layers>,
    ignored: BTreeSet<(u32, u32)>,
}

impl Admission {
    pub(super) fn new(scene: &Scene, line_up: &LineUp<'_>) -> Self {
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

/// A body that goes on beyond its knots can only be screened within a window that has an end.
fn check_end(body: &Body, window: Window) -> Result<(), Error> {
    if !window.is_closed() && body.trajectory.outside() != Outside::Absent {
        return Err(Error::WindowNotClosed { body: body.tag });
    }
    Ok(())
}

/// What a body follows over the window.
pub(super) fn pieces_of(body: &Body, window: Window) -> Result<Pieces<'_>, Error> {
    check_end(body, window)?;
    let pieces = body.trajectory.pieces(window);
    pieces.map_err(|error| error.in_body(body.tag))
}

/// The same; none if the window stays within the body's own knots.
fn pieces_beyond(body: &Body, window: Window) -> Result<Option<Pieces<'static>>, Error> {
    check_end(body, window)?;
    let pieces = body.trajectory.pieces_beyond(window);
    pieces.map_err(|error| error.in_body(body.tag))
}

pub(super) fn party<'a>(
    hitbox: &'a Hitbox,
    knots: &'a [f64],
    segments: &'a [Segment],
) -> Party<'a> {
    Party {
        knots,
        segments,
        spheres: hitbox.spheres(),
        bounding: hitbox.bounding(),
    }
}

/// The part of the window in which both bodies exist.
pub(super) fn clip_of(a: &Party<'_>, b: &Party<'_>, window: Window) -> Option<(f64, f64)> {
    let (start, end) = common_domain(a.knots, b.knots)?;
    let (start, end) = (start.max(window.start()), end.min(window.end()));
    (start <= end).then_some((start, end))
}
