//! The bodies of a scene as the pipeline sees them: by place, in the order of their ids.

use super::survey::Survey;
use crate::accuracy::Accuracy;
use crate::bounds::{Frame, Inflation, MovingFrame, Pose, Stroke};
use crate::broad_phase::{InstructionSet, PairFilter};
use crate::error::{Error, MAX_MAGNITUDE};
use crate::id::BodyId;
use crate::knots::Knots;
use crate::layers::Layers;
use crate::narrow_phase::Party;
use crate::parallel;
use crate::pool::Pool;
use crate::query::Query;
use crate::scene::{Atlas, Beyond, Body, IgnoredPairs, Occupant, Scene, can_reach, radius};
use crate::search::{Limits, Presence, Scratch, Traffic};
use crate::spans::common_domain;
use crate::window::Window;
use std::num::NonZeroU32;
use std::sync::Arc;

/// Each body as the narrow phase takes it, and how it lies in a frame; by place.
pub(super) type Lists<'a> = (Vec<Party<'a>>, Vec<Pose<'a, Stroke>>);

/// The bodies of a scene as the pipeline sees them: by place, in the order of their ids.
pub(super) struct LineUp<'a> {
    pub(super) ids: Vec<BodyId>,
    pub(super) occupants: Vec<&'a Occupant>,
    pub(super) presence: Presence,
    /// Those that go on beyond their knots in the window, by ascending place, and how.
    beyond: Vec<(usize, Arc<Beyond>)>,
    /// The window of the answer.
    pub(super) asked: Window,
    /// The same, but open ends are closed where no body exists beyond them.
    pub(super) window: Window,
    pub(super) margin: f64,
    pub(super) accuracy: Accuracy,
    pub(super) instructions: InstructionSet,
    /// How many slices, if that was prescribed.
    pub(super) prescribed: Option<NonZeroU32>,
    pub(super) limits: Limits,
    pub(super) pool: &'a Pool<Scratch>,
    atlas: &'a Atlas,
    pub(super) frame: MovingFrame,
    survey: Survey,
}

impl<'a> LineUp<'a> {
    pub(super) fn new(scene: &'a Scene, query: &Query) -> Result<Self, Error> {
        let margin = query.margin();
        if margin.is_nan() || margin.abs() > MAX_MAGNITUDE {
            return Err(Error::Margin { margin });
        }
        // In an empty scene there is nothing to see at any time.
        let nothing = scene.is_empty().then_some(Window::ALL);
        let asked = query.window().or_else(|| scene.planned()).or(nothing);
        let asked = asked.ok_or(Error::NoPlan)?;
        let partners = scene.partners(margin);
        let mut survey = Survey::of(scene.len(), asked, margin);
        let mut ids = Vec::with_capacity(scene.len());
        let mut occupants = Vec::with_capacity(scene.len());
        let mut going_on = Vec::new();
        for (place, (id, occupant)) in scene.occupants().enumerate() {
            ids.push(id);
            occupants.push(occupant);
            if occupant.body.trajectory.goes_beyond() {
                going_on.push(place);
            } else {
                survey.include(place, (occupant, None), partners.has(&occupant.body));
            }
        }
        let beyond = lay_out(&occupants, &going_on, asked)?;
        let mut laid_out = beyond.iter().peekable();
        for place in going_on {
            let beyond = laid_out.next_if(|(beyond, _)| *beyond == place);
            let occupant: &Occupant = occupants[place];
            let beyond = beyond.map(|(_, beyond)| &**beyond);
            survey.include(place, (occupant, beyond), partners.has(&occupant.body));
        }
        let frame = survey.frame(scene);
        let mut line_up = Self {
            ids,
            occupants,
            presence: Presence::default(),
            beyond,
            asked,
            window: asked,
            margin,
            accuracy: query.accuracy(),
            instructions: query.instruction_set(),
            prescribed: query.slices(),
            limits: Limits::of_spans(query.max_spans()),
            pool: scene.pool(),
            atlas: scene.atlas(),
            frame,
            survey,
        };
        let (start, end) = line_up.survey.existence;
        let existence = Window::new(start, end).ok();
        match existence.and_then(|existence| existence.intersection(asked)) {
            Some(window) => {
                line_up.window = window;
                line_up.presence = Presence::of(std::mem::take(&mut line_up.survey.lives));
            }
            None => {
                line_up.ids.clear();
                line_up.occupants.clear();
                line_up.beyond.clear();
            }
        }
        Ok(line_up)
    }

    /// Each body as the narrow phase takes it, and how it lies in a frame that serves all of them; by
    /// place.
    pub(super) fn parties(&self) -> Lists<'_> {
        /// Fewer are gone through on this thread.
        const FEW: usize = 4096;
        let frame = self.frame;
        let count = self.occupants.len();
        let (mut parties, mut poses) = (Vec::with_capacity(count), Vec::with_capacity(count));
        let lists = (&mut parties, &mut poses);
        parallel::map_both(count, FEW, lists, |place| self.party(place, &frame));
        (parties, poses)
    }

    /// How the bodies in some places lie in that frame.
    pub(super) fn poses(&self, places: &[usize]) -> Vec<Pose<'_, Stroke>> {
        let frame = self.frame;
        let pose = |&place: &usize| self.party(place, &frame).1;
        places.iter().map(pose).collect()
    }

    /// The body in a place as the narrow phase takes it, and how it lies in a frame.
    #[inline]
    fn party(&self, place: usize, frame: &Frame) -> (Party<'_>, Pose<'_, Stroke>) {
        let (occupant, beyond) = self.body(place);
        let drawing = beyond.map_or_else(|| occupant.drawing(self.atlas), Beyond::drawing);
        // A screening reads knots next to the sketches.
        let party = party_over(occupant, beyond, drawing.knots);
        let inflation = Inflation::of(party.spheres, party.bounding, self.margin, frame);
        let pose = Pose::sketched(&drawing, &inflation, frame);
        (party, pose)
    }

    /// The body in a place, and what it follows over the window if it goes on beyond its knots.
    fn body(&self, place: usize) -> (&'a Occupant, Option<&Beyond>) {
        let beyond = self
            .beyond
            .binary_search_by_key(&place, |(place, _)| *place);
        let beyond = beyond.ok().map(|number| &*self.beyond[number].1);
        (self.occupants[place], beyond)
    }

    /// How much moves in the window, from what is known of each body as a whole.
    pub(super) fn traffic(&self) -> Traffic {
        self.survey.traffic()
    }
}

/// Layers and ignored pairs, by place in the line-up.
pub(super) struct Admission<'a> {
    layers: Vec<Layers>,
    /// Where the margin is negative: some pairs cannot be within it.
    radii: Vec<f64>,
    margin: f64,
    ids: &'a [BodyId],
    ignored: &'a IgnoredPairs,
}

impl<'a> Admission<'a> {
    pub(super) fn new(scene: &'a Scene, line_up: &'a LineUp<'_>) -> Self {
        let bodies = || line_up.occupants.iter().map(|occupant| &occupant.body);
        let is_negative = line_up.margin < 0.0;
        let radii = bodies()
            .filter(|_| is_negative)
            .map(|body| radius(&body.hitbox));
        Self {
            layers: bodies().map(|body| body.layers).collect(),
            radii: radii.collect(),
            margin: line_up.margin,
            ids: &line_up.ids,
            ignored: scene.ignored(),
        }
    }
}

impl PairFilter for Admission<'_> {
    fn admits(&self, a: u32, b: u32) -> bool {
        let (a, b) = (a as usize, b as usize);
        self.layers[a].admits(self.layers[b])
            && (self.radii.is_empty() || can_reach(self.radii[a], self.radii[b], self.margin))
            && (self.ignored.is_empty() || !self.ignored.contains(self.ids[a], self.ids[b]))
    }
}

/// What bodies at some places do beyond their knots, of those that go on there in a window: by
/// ascending place.
fn lay_out(
    occupants: &[&Occupant],
    places: &[usize],
    window: Window,
) -> Result<Vec<(usize, Arc<Beyond>)>, Error> {
    /// Fewer are laid out on this thread.
    const FEW: usize = 64;
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

/// A body as the narrow phase takes it, of which nothing is sketched if it was not before.
pub(super) fn lone_party<'a>(occupant: &'a Occupant, beyond: Option<&'a Beyond>) -> Party<'a> {
    let knots = match beyond {
        Some(Beyond { pieces, .. }) => &pieces.knots,
        None => occupant.body.trajectory.knots(),
    };
    party_over(occupant, beyond, Knots::of(knots))
}

/// A body as the narrow phase takes it, with what it does beyond its knots.
fn party_over<'a>(
    occupant: &'a Occupant,
    beyond: Option<&'a Beyond>,
    knots: Knots<'a>,
) -> Party<'a> {
    let Body {
        trajectory, hitbox, ..
    } = &occupant.body;
    let segments = match beyond {
        Some(Beyond { pieces, .. }) => &pieces.segments,
        None => trajectory.segments(),
    };
    Party {
        knots,
        segments,
        spheres: hitbox.spheres(),
        bounding: hitbox.bounding(),
    }
}

/// The part of the window in which both bodies exist.
pub(super) fn clip_of(a: &Party<'_>, b: &Party<'_>, window: Window) -> Option<(f64, f64)> {
    let (start, end) = common_domain(&a.knots, &b.knots)?;
    let (start, end) = (start.max(window.start()), end.min(window.end()));
    (start <= end).then_some((start, end))
}
