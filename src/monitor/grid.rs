//! The grid of a monitor: the frame of its boxes, and its slices of time. Both are chosen for its scene.

use crate::bounds::{DAabb, Frame, MovingFrame, Padding};
use crate::count::{as_f64, whole};
use crate::error::{Error, MAX_MAGNITUDE};
use crate::query::Query;
use crate::scene::Scene;
use crate::shape::BodyShape;
use crate::window::Window;
use glam::DVec3;

/// A frame and slices of time. Results do not depend on it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Grid {
    pub(super) frame: MovingFrame,
    /// Largest margin of the pairs that are searched for, m.
    pub(super) margin: f64,
    /// Beginning of slice 0, s.
    pub(super) origin: f64,
    /// Length of a slice, s.
    pub(super) length: f64,
    /// Length of the slices in which all bodies are searched from nothing, s.
    pub(super) search_length: f64,
    /// Number of slices that make up the lookahead.
    pub(super) slice_count: f64,
    /// Estimate of the scene when the grid was chosen.
    estimate: SceneEstimate,
}

/// An estimate of the number of slices of a lookahead, by a rule of thumb, from some of the bodies. Two
/// estimates that differ show at little cost that another grid may suit the scene better.
#[derive(Clone, Copy, Debug)]
pub(super) struct SceneEstimate {
    slices: f64,
    /// The middle half of the bodies on each axis (m): a few that stray make no difference.
    middle: DAabb,
}

/// The last comparison of a grid with its scene, and the changes since.
#[derive(Debug)]
pub(super) struct GridReview {
    /// Number of bodies then.
    bodies: usize,
    /// The clock then, s.
    now: f64,
    /// Number of changes of bodies since, and the number from which on another comparison is due.
    pub(super) changes: usize,
    enough: usize,
}

impl GridReview {
    /// Fewer changes are no reason for a comparison.
    const FEW: usize = 64;

    /// Returns the trigger after a comparison of the grid with a scene of so many bodies, at a time (s).
    pub(super) fn after_comparison(bodies: usize, now: f64) -> Self {
        Self {
            bodies,
            now,
            changes: 0,
            enough: bodies.max(Self::FEW),
        }
    }

    /// Notes that a comparison was costly and kept the grid: the next one comes later.
    pub(super) const fn was_in_vain(&mut self) {
        self.enough = self.enough.saturating_mul(64);
    }

    /// Returns true if another comparison is due: many bodies were added, removed or changed, or a lookahead has passed.
    pub(super) fn is_due(&self, bodies: usize, now: f64, lookahead: f64) -> bool {
        let is_about_as_large = bodies <= 2 * self.bodies && self.bodies <= 2 * bodies;
        !is_about_as_large || self.changes >= self.enough || now >= self.now + lookahead
    }
}

impl SceneEstimate {
    /// Returns the estimate for a scene's bodies within a lookahead from an instant on (s), for pairs
    /// within `margin` (m) in boxes that move with a velocity (m/s).
    pub(super) fn of(
        scene: &Scene,
        margin: f64,
        (from, lookahead): (f64, f64),
        velocity: DVec3,
    ) -> Self {
        let mut speeds = [0.0; Scene::SAMPLE];
        let mut positions = [DVec3::ZERO; Scene::SAMPLE];
        let mut count = 0;
        for entry in scene.sample((from, from + lookahead)) {
            let plan = &entry.body.trajectory;
            let (first, last) = (plan.domain().start(), plan.domain().end());
            let [early, late] =
                [from, from + 0.5 * lookahead].map(|time| time.max(first).min(last));
            let (Some(position), Some(v), Some(w)) = (
                plan.position(early),
                plan.velocity(early),
                plan.velocity(late),
            ) else {
                continue;
            };
            speeds[count] = (v - velocity).length().max((w - velocity).length());
            positions[count] = position;
            count += 1;
        }
        let (mut slices, mut middle) = (0.0, DAabb::NOTHING);
        if count > 1 {
            let reach = margin.max(f64::MIN_POSITIVE);
            let mut spacing = 1.0;
            middle = DAabb::of_middle_half(&mut positions[..count]);
            for extent in (middle.high - middle.low).to_array() {
                spacing *= (2.0 * extent).max(reach).cbrt();
            }
            speeds[..count].sort_unstable_by(f64::total_cmp);
            let spacing = (spacing / as_f64(scene.len()).cbrt()).max(reach);
            slices = 2.0 * lookahead * speeds[count / 2] / spacing;
        }
        Self { slices, middle }
    }
}

impl Grid {
    /// Returns the number of slices that are about as long as those of a search from nothing; at least 1.
    pub(super) fn slices_to_search(&self) -> usize {
        whole((self.search_length / self.length).round().max(1.0)) as usize
    }

    /// Slices that a lookahead is cut into, at least and at most. The boxes of more slices are tighter,
    /// and each changed plan is compared in every one of them. (Where a screening would take two or
    /// three, three were measured 10 to 15 % cheaper than four.)
    pub(super) const FEWEST: f64 = 3.0;
    const MAX: f64 = 2048.0;
    /// Largest number of boxes in all slices together: some 130 bytes each.
    const MAX_BOXES: f64 = 2e6;
    /// A screening forms a box and compares it for a tenth of what it costs to do that when a plan
    /// changes: a monitor takes this share of the slices that a screening would.
    const SHARE: f64 = 0.5;

    /// Returns the grid for a scene and pairs within `margin` (m), for a `lookahead` from `origin` (s) on a
    /// clock that shows `now` (s).
    ///
    /// # Errors
    ///
    /// [`Error::InBody`] if an extrapolated plan leaves the range of numbers.
    pub(super) fn for_scene(
        scene: &Scene,
        margin: f64,
        (origin, lookahead): (f64, f64),
        now: f64,
    ) -> Result<Self, Error> {
        let query = Query::new(Window::new(origin, origin + lookahead)?).with_margin(margin);
        let cheapest = f64::from(scene.cheapest_slices(&query)?);
        // A whole number: else part of the next slice would be due at the first tick.
        let slice_count = Self::number(cheapest, scene.len()).round();
        let velocity = scene.common_velocity((origin, origin + lookahead));
        let estimate = SceneEstimate::of(scene, margin, (origin, lookahead), velocity);
        let grid = Self {
            frame: Frame::amid(scene.extremes(), estimate.middle, margin.abs()).moving(velocity),
            margin,
            origin,
            length: lookahead / slice_count,
            search_length: lookahead / cheapest,
            slice_count,
            estimate,
        };
        Ok(if grid.has_room(now) {
            grid
        } else {
            Self {
                length: lookahead / Self::FEWEST,
                slice_count: Self::FEWEST,
                ..grid
            }
        })
    }

    /// Returns the number of slices for a scene of which a screening would take so many.
    fn number(slices: f64, bodies: usize) -> f64 {
        let most = (Self::MAX_BOXES / as_f64(bodies.max(1))).min(Self::MAX);
        (Self::SHARE * slices).min(most).max(Self::FEWEST)
    }

    /// Returns the padding of the boxes of bodies of a shape.
    pub(super) fn padding(&self, shape: BodyShape<'_>) -> Padding {
        Padding::of(shape, self.margin, &self.frame)
    }

    /// Returns the beginning of a slice, s.
    #[allow(
        clippy::cast_precision_loss,
        reason = "a slice's number is far below 2^53"
    )]
    pub(super) fn start(&self, slice: i64) -> f64 {
        self.origin + self.length * slice as f64
    }

    /// Returns true if the grid still suits a scene, given an estimate of the scene as it is now.
    pub(super) fn suits(&self, scene: &Scene, estimate: &SceneEstimate) -> bool {
        /// Times more slices, or fewer, that a tick hardly notices.
        const FEW: f64 = 3.0;
        let [before, now] =
            [&self.estimate, estimate].map(|estimate| Self::number(estimate.slices, scene.len()));
        let is_alike = now <= FEW * before && before <= FEW * now;
        let frame = Frame::around(self.estimate.middle, self.margin.abs());
        is_alike && frame.suits(estimate.middle, estimate.middle, self.margin.abs())
    }

    /// Returns true if the grid serves a scene about as well as another grid that was chosen for it.
    pub(super) fn serves(&self, scene: &Scene, other: &Self) -> bool {
        let is_alike = self.slice_count <= 1.5 * other.slice_count
            && other.slice_count <= 1.5 * self.slice_count;
        let most = other.estimate.middle;
        is_alike && self.frame.suits(scene.extremes(), most, self.margin.abs())
    }

    /// Notes that the grid suits the scene as it is now, too.
    pub(super) const fn confirm(&mut self, other: &Self) {
        self.estimate = other.estimate;
    }

    /// Returns true if the grid has far too many boxes for a scene, which has grown.
    pub(super) fn is_too_fine(&self, scene: &Scene) -> bool {
        self.slice_count > Self::FEWEST
            && self.slice_count * as_f64(scene.len()) > 2.0 * Self::MAX_BOXES
    }

    /// Returns true if f64 resolves at least 4,096 instants in a slice on a clock that shows `now` (s). A grid
    /// with the fewest slices always passes: there is no coarser one.
    pub(super) fn has_room(&self, now: f64) -> bool {
        self.slice_count <= Self::FEWEST || can_tell_apart(now, self.length / 1024.0)
    }
}

/// Returns true if the clock of a monitor with this lookahead (s) can show `time` (s).
pub(super) fn can_show(time: f64, lookahead: f64) -> bool {
    time.abs() <= MAX_MAGNITUDE && can_tell_apart(time, lookahead / Grid::FEWEST)
}

/// Returns true if f64 resolves slices of this length (s) on a clock that shows `time` (s).
pub(super) fn can_tell_apart(time: f64, length: f64) -> bool {
    length > 4.0 * f64::EPSILON * time.abs()
}
