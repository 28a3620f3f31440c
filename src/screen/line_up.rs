//! The bodies of a scene as the pipeline sees them: by place, in the order of their ids.

use super::scratch::Pool;
use crate::accuracy::Accuracy;
use crate::bounds::Extremes;
use crate::broad_phase::PairFilter;
use crate::broad_phase::slices::Traffic;
use crate::error::Error;
use crate::id::BodyId;
use crate::layers::Layers;
use crate::narrow_phase::Party;
use crate::query::Query;
use crate::scene::{Body, Occupant, Scene};
use crate::spans::common_domain;
use crate::trajectory::Pieces;
use crate::window::Window;
use std::collections::BTreeSet;
use std::num::NonZeroU32;

/// The bodies of a scene as the pipeline sees them: by place, in the order of their ids.
pub(super) struct LineUp<'a> {
    pub(super) ids: Vec<BodyId>,
    pub(super) occupants: Vec<&'a Occupant>,
    pub(super) pieces: Vec<Pieces<'a>>,
    pub(super) window: Window,
    pub(super) margin: f64,
    pub(super) accuracy: Accuracy,
    /// How many slices, if that was prescribed.
    pub(super) prescribed: Option<NonZeroU32>,
    pub(super) pool: &'a Pool,
}

impl<'a> LineUp<'a> {
    pub(super) fn new(scene: &'a Scene, query: &Query) -> Result<Self, Error> {
        let count = scene.len();
        let (mut ids, mut occupants) = (Vec::with_capacity(count), Vec::with_capacity(count));
        let mut pieces = Vec::with_capacity(count);
        // Open ends are closed where no body exists beyond them.
        let (mut start, mut end) = (f64::INFINITY, f64::NEG_INFINITY);
        for (id, occupant) in scene.occupants() {
            let body = pieces_of(&occupant.body, query.window())?;
            start = start.min(body.knots.first().copied().unwrap_or(start));
            end = end.max(body.knots.last().copied().unwrap_or(end));
            ids.push(id);
            occupants.push(occupant);
            pieces.push(body);
        }
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
            accuracy: query.accuracy(),
            prescribed: query.slices(),
            pool: scene.pool(),
        })
    }

    pub(super) fn parties(&self) -> Vec<Party<'_>> {
        self.occupants
            .iter()
            .zip(&self.pieces)
            .map(|(occupant, pieces)| party(&occupant.body, pieces))
            .collect()
    }

    pub(super) fn is_unfiltered(&self, scene: &Scene) -> bool {
        scene.ignored_pairs().next().is_none()
            && self
                .occupants
                .iter()
                .all(|occupant| occupant.body.layers == Layers::ALL)
    }

    pub(super) fn extremes(&self, parties: &[Party<'_>]) -> Extremes {
        let mut extremes = Extremes::NOTHING;
        for (occupant, party) in self.occupants.iter().zip(parties) {
            extremes.include(occupant.outline().extremes);
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
                traffic.path += occupant.outline().path * (time / planned);
                #[allow(clippy::cast_precision_loss, reason = "an estimate")]
                let segments = body.trajectory.segments().len() as f64;
                traffic.segments += segments * (time / planned);
            }
            extremes.include(occupant.outline().extremes);
        }
        traffic.world = (extremes.high - extremes.low).to_array();
        traffic
    }
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

pub(super) fn pieces_of(body: &Body, window: Window) -> Result<Pieces<'_>, Error> {
    if !window.is_closed() && body.trajectory.domain() == Window::ALL {
        return Err(Error::WindowNotClosed { body: body.tag });
    }
    body.trajectory
        .pieces(window)
        .map_err(|error| error.in_body(body.tag))
}

pub(super) fn party<'a>(body: &'a Body, pieces: &'a Pieces<'_>) -> Party<'a> {
    Party {
        knots: &pieces.knots,
        segments: &pieces.segments,
        spheres: body.hitbox.spheres(),
        bounding: body.hitbox.bounding(),
    }
}

/// The part of the window in which both bodies exist.
pub(super) fn clip_of(a: &Party<'_>, b: &Party<'_>, window: Window) -> Option<(f64, f64)> {
    let (start, end) = common_domain(a.knots, b.knots)?;
    let (start, end) = (start.max(window.start()), end.min(window.end()));
    (start <= end).then_some((start, end))
}
