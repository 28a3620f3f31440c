//! The bodies of a scene as the pipeline sees them: by place, in the order of their ids.

use super::scratch::Pool;
use crate::accuracy::Accuracy;
use crate::bounds::{Extremes, Sketch};
use crate::broad_phase::presence::Presence;
use crate::broad_phase::slices::Traffic;
use crate::broad_phase::{Level, PairFilter};
use crate::error::Error;
use crate::id::BodyId;
use crate::layers::Layers;
use crate::narrow_phase::Party;
use crate::parallel;
use crate::query::Query;
use crate::scene::{Beyond, Body, IgnoredPairs, Occupant, Outline, Scene};
use crate::spans::common_domain;
use crate::trajectory::Outside;
use crate::window::Window;
use std::num::NonZeroU32;
use std::sync::Arc;

/// The bodies of a scene as the pipeline sees them: by place, in the order of their ids.
pub(super) struct LineUp<'a> {
    pub(super) ids: Vec<BodyId>,
    pub(super) occupants: Vec<&'a Occupant>,
    pub(super) presence: Presence,
    /// Those that go on beyond their knots in the window, by ascending place, and how.
    beyond: Vec<(usize, Arc<Beyond>)>,
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

impl<'a> LineUp<'a> {
    pub(super) fn new(scene: &'a Scene, query: &Query) -> Result<Self, Error> {
        let (ids, occupants): (Vec<_>, Vec<_>) = scene.occupants().unzip();
        let beyond = lay_out(&occupants, query.window())?;
        let mut line_up = Self {
            ids,
            occupants,
            presence: Presence::default(),
            beyond,
            window: query.window(),
            margin: query.margin(),
            accuracy: query.accuracy(),
            level: query.level(),
            prescribed: query.slices(),
            most_spans: query.most_spans(),
            pool: scene.pool(),
        };
        // Open ends are closed where no body exists beyond them.
        let (mut start, mut end) = (f64::INFINITY, f64::NEG_INFINITY);
        let mut lives = Vec::with_capacity(scene.len());
        for (occupant, beyond) in line_up.bodies() {
            let (first, last) = outline_over(occupant, beyond).knots;
            start = start.min(first);
            end = end.max(last);
            lives.push((first, last));
        }
        let existence = Window::new(start, end).ok();
        match existence.and_then(|existence| existence.intersection(query.window())) {
            Some(window) => {
                line_up.window = window;
                line_up.presence = Presence::of(lives);
            }
            None => {
                line_up.ids.clear();
                line_up.occupants.clear();
                line_up.beyond.clear();
            }
        }
        Ok(line_up)
    }

    /// Each body, and what it follows over the window if it goes on beyond its knots.
    fn bodies(&self) -> impl Iterator<Item = (&'a Occupant, Option<&Beyond>)> {
        let mut beyond = self.beyond.iter().peekable();
        let occupants = self.occupants.iter().enumerate();
        occupants.map(move |(place, &occupant)| {
            let beyond = beyond.next_if(|(beyond, _)| *beyond == place);
            (occupant, beyond.map(|(_, beyond)| &**beyond))
        })
    }

    pub(super) fn parties(&self) -> Vec<Party<'_>> {
        let bodies = self.bodies();
        bodies
            .map(|(occupant, beyond)| Party {
                // A screening reads them next to the sketches.
                knots: outline_over(occupant, beyond).sketch.knots(),
                ..party_over(occupant, beyond)
            })
            .collect()
    }

    /// The bodies' sketches over the window, by place.
    pub(super) fn sketches(&self) -> impl Iterator<Item = &Sketch> {
        self.bodies()
            .map(|(occupant, beyond)| &outline_over(occupant, beyond).sketch)
    }

    pub(super) fn is_unfiltered(&self, scene: &Scene) -> bool {
        scene.ignored().is_empty()
            && self
                .occupants
                .iter()
                .all(|occupant| occupant.body.layers == Layers::ALL)
    }

    pub(super) fn extremes(&self) -> Extremes {
        let mut extremes = Extremes::NOTHING;
        for (occupant, beyond) in self.bodies() {
            extremes.include(outline_over(occupant, beyond).extremes);
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
            for way in beyond.iter().flat_map(|beyond| &beyond.ways) {
                let time = overlap(window, way.ends);
                let share = time / (way.ends.1 - way.ends.0);
                traffic.path += way.length * share;
                traffic.segments += share;
                traffic.body_time += time;
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
pub(super) struct Admission<'a> {
    layers: Vec<Layers>,
    ids: &'a [BodyId],
    ignored: &'a IgnoredPairs,
}

impl<'a> Admission<'a> {
    pub(super) fn new(scene: &'a Scene, line_up: &'a LineUp<'_>) -> Self {
        let occupants = line_up.occupants.iter();
        Self {
            layers: occupants.map(|occupant| occupant.body.layers).collect(),
            ids: &line_up.ids,
            ignored: scene.ignored(),
        }
    }
}

impl PairFilter for Admission<'_> {
    fn admits(&self, a: u32, b: u32) -> bool {
        let (a, b) = (a as usize, b as usize);
        self.layers[a].admits(self.layers[b])
            && (self.ignored.is_empty() || !self.ignored.contains(self.ids[a], self.ids[b]))
    }
}

/// What bodies do beyond their knots, of those that go on there in a window: by ascending place.
fn lay_out(occupants: &[&Occupant], window: Window) -> Result<Vec<(usize, Arc<Beyond>)>, Error> {
    /// Fewer are laid out on this thread.
    const FEW: usize = 64;
    let goes_on = |occupant: &Occupant| occupant.body.trajectory.outside() != Outside::Absent;
    let places = 0..occupants.len();
    let places: Vec<usize> = places.filter(|&place| goes_on(occupants[place])).collect();
    let lay_out = |(): &mut (), number: usize| {
        let place = places[number];
        let beyond = occupants[place].beyond(window)?;
        Ok(beyond.map(|beyond| (place, beyond)))
    };
    parallel::map(places.len(), FEW, || (), lay_out)
        .into_iter()
        .filter_map(Result::transpose)
        .collect()
}

/// A body as the narrow phase takes it, with what it does beyond its knots.
pub(super) fn party_over<'a>(occupant: &'a Occupant, beyond: Option<&'a Beyond>) -> Party<'a> {
    let Body {
        trajectory, hitbox, ..
    } = &occupant.body;
    let (knots, segments) = match beyond {
        Some(Beyond { pieces, .. }) => (&pieces.knots[..], &pieces.segments[..]),
        None => (trajectory.knots(), trajectory.segments()),
    };
    Party {
        knots,
        segments,
        spheres: hitbox.spheres(),
        bounding: hitbox.bounding(),
    }
}

fn outline_over<'a>(occupant: &'a Occupant, beyond: Option<&'a Beyond>) -> &'a Outline {
    beyond.map_or_else(|| occupant.outline(), |beyond| &beyond.outline)
}

/// The part of the window in which both bodies exist.
pub(super) fn clip_of(a: &Party<'_>, b: &Party<'_>, window: Window) -> Option<(f64, f64)> {
    let (start, end) = common_domain(a.knots, b.knots)?;
    let (start, end) = (start.max(window.start()), end.min(window.end()));
    (start <= end).then_some((start, end))
}
