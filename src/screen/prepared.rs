//! All bodies of a scene, prepared for one query and indexed densely in id order.

use super::survey::SceneSurvey;
use crate::bounds::{
    BodyCubic, CompactCubic, CubicSource, Frame, HullTest, MovingFrame, Padding, StraightPieces,
    hull_test,
};
use crate::broad_phase::{Groups, PairFilter};
use crate::count::short;
use crate::error::{Error, MAX_MAGNITUDE};
use crate::id::BodyId;
use crate::knots::Knots;
use crate::narrow_phase::BodyView;
use crate::parallel;
use crate::pool::Pool;
use crate::query::Query;
use crate::rounding::exact_interval;
use crate::scene::{Body, CubicArena, PairAdmission, Scene, SceneEntry};
use crate::search::{
    Bodies, BoxedBodies, Limits, Pace, SearchScratch, SlicesToForm, SourcesInPlace,
};
use crate::shape::BodyShape;
use crate::simd::prefetch;
use crate::trajectory::Extension;
use crate::window::Window;
use std::slice::from_ref;

/// Box sources of all bodies, by place.
pub(super) type SourceList<'a> = Vec<CubicSource<'a, CompactCubic>>;

/// All bodies of a scene, prepared for one query and indexed densely ("place") in id order.
pub(super) struct PreparedScene<'a> {
    pub(super) ids: Vec<BodyId>,
    pub(super) entries: Vec<&'a SceneEntry>,
    /// First and last instant of each body, s.
    pub(super) lifetimes: Vec<(f64, f64)>,
    /// The pace of slices.
    pub(super) pace: Pace,
    /// Extensions beyond the knots in the window, by ascending place.
    extensions: Vec<(usize, Extension)>,
    /// Window of the answer.
    pub(super) asked: Window,
    /// The part of it in which any body exists that may be part of a pair of boxes.
    pub(super) window: Window,
    /// The query, with a margin that was checked.
    pub(super) query: Query,
    pub(super) limits: Limits,
    pub(super) pool: &'a Pool<SearchScratch>,
    arena: &'a CubicArena,
    pub(super) frame: MovingFrame,
    /// Places of half-spaces, ascending: they have no boxes.
    pub(super) half_spaces: Vec<u32>,
    pub(super) survey: SceneSurvey,
}

impl<'a> PreparedScene<'a> {
    pub(super) fn new(scene: &'a Scene, query: &Query) -> Result<Self, Error> {
        let margin = checked_margin(query)?;
        // In an empty scene there is nothing to see at any time.
        let nothing = scene.is_empty().then_some(Window::ALL);
        let asked = query.window().or_else(|| scene.planned()).or(nothing);
        let asked = asked.ok_or(Error::NoPlan)?;
        let partners = scene.partners(margin);
        let mut survey = SceneSurvey::of(scene, asked, margin);
        let mut ids = Vec::with_capacity(scene.len());
        let mut entries = Vec::with_capacity(scene.len());
        let mut extensions = Vec::new();
        let mut half_spaces = Vec::new();
        for (place, (id, entry)) in scene.entries().enumerate() {
            let extension = entry.body.extension(asked);
            let extension = extension.map_err(|error| error.with_id(id))?;
            let has_partner = partners.has(&entry.body);
            if entry.body.hitbox.is_half_space() {
                half_spaces.push(short(place));
            }
            survey.include(place, (entry, extension.as_ref()), has_partner);
            ids.push(id);
            entries.push(entry);
            extensions.extend(extension.map(|extension| (place, extension)));
        }
        let frame = survey.complete(scene);
        let mut prepared = Self {
            ids,
            entries,
            lifetimes: Vec::new(),
            pace: Pace::EVEN,
            extensions,
            asked,
            window: asked,
            query: *query,
            limits: Limits::of_spans(query.max_spans()),
            pool: scene.pool(),
            arena: scene.arena(),
            frame,
            half_spaces,
            survey,
        };
        let (start, end) = prepared.survey.all_lifetimes;
        let all_lifetimes = Window::new(start, end).ok();
        match all_lifetimes.and_then(|all_lifetimes| all_lifetimes.intersection(asked)) {
            Some(window) => {
                prepared.window = window;
                let lives = std::mem::take(&mut prepared.survey.lives);
                let body_time = prepared.survey.statistics.body_time;
                prepared.pace = Pace::of(&lives, prepared.searched(), body_time);
                prepared.lifetimes = lives;
            }
            None => {
                prepared.ids.clear();
                prepared.entries.clear();
                prepared.extensions.clear();
                prepared.half_spaces.clear();
                prepared.survey.cubics = 0;
            }
        }
        Ok(prepared)
    }

    /// Replaces the content of a list by the box sources of all bodies, by place, in a common frame.
    pub(super) fn list_sources<'p>(&'p self, sources: &mut SourceList<'p>) {
        /// Fewer are prepared on this thread.
        const FEW: usize = 4096;
        parallel::map_into(self.entries.len(), FEW, sources, |place| {
            self.source(place, &self.frame)
        });
    }

    /// Returns true if views and sources are made in place, not listed: most bodies follow straight motions.
    pub(super) fn is_in_place(&self) -> bool {
        /// If one body in so many has a plan, lists of views and sources are read faster.
        const ONE_IN: usize = 8;
        ONE_IN * self.survey.not_straight < self.entries.len()
    }

    /// Returns the box sources of the bodies at some places.
    pub(super) fn sources(&self, places: &[usize]) -> Vec<CubicSource<'_, CompactCubic>> {
        let source = |&place| self.source(place, &self.frame);
        places.iter().map(source).collect()
    }

    #[inline]
    pub(super) fn extension(&self, place: usize) -> Option<&Extension> {
        // All bodies have one, or few have.
        if let Some((other, extension)) = self.extensions.get(place)
            && *other == place
        {
            return Some(extension);
        }
        let of_place = |(other, _): &(usize, Extension)| other.cmp(&place);
        let extension = self.extensions.binary_search_by(of_place);
        extension.ok().map(|number| &self.extensions[number].1)
    }

    /// Returns the source of the boxes of the body at a place, in a frame.
    #[inline(always)]
    fn source(&self, place: usize, frame: &Frame) -> CubicSource<'_, CompactCubic> {
        let (entry, extension) = (self.entries[place], self.extension(place));
        let padding = Padding::of(entry.body.shape(), self.query.margin(), frame);
        let plan = &entry.body.trajectory;
        if !plan.straight_motions().is_empty() {
            return CubicSource::straight(Knots::over(plan, extension), &padding, frame);
        }
        self.source_of_plan(entry, extension, (&padding, frame))
    }

    #[inline(never)]
    fn source_of_plan(
        &self,
        entry: &'a SceneEntry,
        extension: Option<&Extension>,
        (padding, frame): (&Padding, &Frame),
    ) -> CubicSource<'_, CompactCubic> {
        let compact_view = entry.compact_view(self.arena);
        // A screening reads knots next to the compact trajectories.
        let knots = compact_view
            .knots
            .extended(&entry.body.trajectory, extension);
        CubicSource::compact(knots, &compact_view, padding, frame)
    }

    /// Returns the shape of the body at a place, if it turns and has long arms.
    #[inline]
    pub(super) fn long_arms(&self, place: u32) -> Option<BodyShape<'_>> {
        let shape = self
            .survey
            .have_long_arms
            .then(|| self.entries[place as usize].body.shape());
        shape.filter(BodyShape::has_long_arms)
    }

    /// Returns the interval asked about (s), with what is reported in it by rounding.
    pub(super) fn searched(&self) -> (f64, f64) {
        exact_interval(self.window.ends())
    }
}

/// Bodies by place, each looked at where it lies.
#[derive(Clone, Copy)]
pub(super) struct BodiesInPlace<'a>(pub(super) &'a PreparedScene<'a>);

impl Bodies for BodiesInPlace<'_> {
    fn have_long_arms(&self) -> bool {
        self.0.survey.have_long_arms
    }

    fn long_arms(&self, body: u32) -> Option<BodyShape<'_>> {
        self.0.long_arms(body)
    }

    #[inline]
    fn view(&self, body: u32) -> BodyView<'_> {
        let place = body as usize;
        let body = &self.0.entries[place].body;
        let knots = Knots::over(&body.trajectory, self.0.extension(place));
        view_of(body, knots)
    }

    #[inline]
    fn fetch(&self, body: u32) {
        prefetch(from_ref(self.0.entries[body as usize]));
    }
}

impl SourcesInPlace for BodiesInPlace<'_> {
    type Cubic = CompactCubic;

    #[inline(always)]
    fn straight(&self, body: u32, from: f64, frame: &Frame) -> Option<StraightPieces<'_>> {
        let place = body as usize;
        let (body, extension) = (&self.0.entries[place].body, self.0.extension(place));
        let before = extension.map_or(0, |extension| extension.before as usize);
        let padding = Padding::of(body.shape(), self.0.query.margin(), frame);
        StraightPieces::over(&body.trajectory, before, from, (&padding, frame))
    }

    #[inline(always)]
    fn source(&self, body: u32, frame: &Frame) -> CubicSource<'_, CompactCubic> {
        self.0.source(body as usize, frame)
    }
}

/// Bodies by place, with their box sources in a list.
#[derive(Clone, Copy)]
pub(super) struct ListedBodies<'a> {
    pub(super) prepared: &'a PreparedScene<'a>,
    pub(super) sources: &'a [CubicSource<'a, CompactCubic>],
}

impl Bodies for ListedBodies<'_> {
    fn have_long_arms(&self) -> bool {
        self.prepared.survey.have_long_arms
    }

    fn long_arms(&self, body: u32) -> Option<BodyShape<'_>> {
        self.prepared.long_arms(body)
    }

    #[inline]
    fn view(&self, body: u32) -> BodyView<'_> {
        let place = body as usize;
        view_of(
            &self.prepared.entries[place].body,
            self.sources[place].knots,
        )
    }

    /// Reads the list that boxes are formed from: it is cached.
    #[inline]
    fn knots(&self, body: u32) -> Knots<'_> {
        self.sources[body as usize].knots
    }

    #[inline]
    fn hull_test(&self, cubics: [(u32, u32); 2], part: (f64, f64)) -> HullTest {
        let [a, b] = cubics.map(|(body, cubic)| BodyCubic {
            source: &self.sources[body as usize],
            cubic: cubic as usize,
        });
        hull_test(&a, &b, part)
    }

    #[inline]
    fn fetch(&self, body: u32) {
        prefetch(from_ref(&self.sources[body as usize]));
    }

    #[inline]
    fn fetch_view(&self, body: u32) {
        prefetch(from_ref(self.prepared.entries[body as usize]));
    }

    #[inline]
    fn fetch_knots(&self, (body, first): (u32, u32)) {
        /// Two cache lines.
        const KNOTS: usize = 16;
        let knots = &self.sources[body as usize].knots;
        knots.prefetch(first as usize, KNOTS);
    }

    #[inline]
    fn fetch_cubic(&self, (body, cubic): (u32, u32)) {
        let source = &self.sources[body as usize];
        source.fetch((cubic as usize).wrapping_sub(source.knots.before()));
    }

    #[inline]
    fn fetch_segment(&self, (body, cubic): (u32, u32)) {
        let plan = &self.prepared.entries[body as usize].body.trajectory;
        let before = self.sources[body as usize].knots.before();
        if let Some(segment) = plan.cubics().get((cubic as usize).wrapping_sub(before)) {
            prefetch(from_ref(segment));
        }
    }
}

impl BoxedBodies for ListedBodies<'_> {
    const ARE_SHARED: bool = false;

    fn form(&self, slices: SlicesToForm<'_>) {
        if *slices.frame == self.prepared.frame {
            slices.form_listed(self.sources);
        } else {
            slices.form_in_place(&BodiesInPlace(self.prepared));
        }
    }
}

/// The filter of pairs of places, by that of their slots.
pub(super) struct PlaceAdmission<'a> {
    pub(super) pairs: PairAdmission<'a>,
    pub(super) ids: &'a [BodyId],
}

impl PairFilter for PlaceAdmission<'_> {
    fn admits(&self, a: u32, b: u32) -> bool {
        let [a, b] = [a, b].map(|place| self.ids[place as usize].slot);
        self.pairs.admits(a, b)
    }

    fn admits_all(&self) -> bool {
        self.pairs.admits_all()
    }

    fn groups(&self) -> Groups {
        self.pairs.groups()
    }

    fn group(&self, place: u32) -> u8 {
        self.pairs.group(self.ids[place as usize].slot)
    }

    fn gives_up(&self) -> bool {
        self.pairs.gives_up()
    }
}

/// Returns the margin of a query (m), if it is one.
///
/// # Errors
///
/// [`Error::Margin`].
pub(super) fn checked_margin(query: &Query) -> Result<f64, Error> {
    let margin = query.margin();
    if margin.is_nan() || margin.abs() > MAX_MAGNITUDE {
        return Err(Error::Margin { margin });
    }
    Ok(margin)
}

/// Returns the view of a body over a window, without computing its summary.
///
/// # Errors
///
/// See [`Body::extension`] and [`Body::check_turning`].
pub(super) fn lone_view(body: &Body, window: Window) -> Result<BodyView<'_>, Error> {
    Body::check_turning(&body.hitbox, &body.orientation, body.tag)?;
    let extension = body.extension(window)?;
    let knots = Knots::over(&body.trajectory, extension.as_ref());
    Ok(view_of(body, knots))
}

#[inline(always)]
fn view_of<'a>(body: &'a Body, knots: Knots<'a>) -> BodyView<'a> {
    BodyView::of_plan(knots, &body.trajectory, body.shape())
}
