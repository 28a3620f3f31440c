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
    pub(super) estimate: SceneEstimate,
}

/// An estimate of the number of slices of a lookahead, by a rule of thumb, from some of the bodies. Two
/// estimates that differ show at little cost that another grid may suit the scene better.
#[derive(Clone, Copy, Debug)]
pub(super) struct SceneEstimate {
    slices: f64,
    /// Mean share of the lookahead in which a body exists, 0 to 1.
    presence: f64,
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
    /// Number of changes of bodies since.
    pub(super) changes: usize,
}

impl GridReview {
    /// Fewer changes are no reason for a comparison.
    const FEW: usize = 64;

    /// Returns the trigger after a comparison of the grid with a scene of so many bodies, at a time (s).
    pub(super) const fn after_comparison(bodies: usize, now: f64) -> Self {
        Self {
            bodies,
            now,
            changes: 0,
        }
    }

    /// Returns true if another comparison is due: many bodies were added, removed or changed, or a lookahead has passed.
    pub(super) fn is_due(&self, bodies: usize, now: f64, lookahead: f64) -> bool {
        let is_about_as_large = bodies <= 2 * self.bodies && self.bodies <= 2 * bodies;
        let is_changed = self.changes >= self.bodies.max(Self::FEW);
        !is_about_as_large || is_changed || now >= self.now + lookahead
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
        /// Height of a flat world, as a share of its longest side.
        const FLAT: f64 = 1e-3;
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
        let bodies = as_f64(scene.len().max(1));
        let presence = (scene.mean_present((from, from + lookahead)) / bodies).min(1.0);
        if count > 1 {
            middle = DAabb::of_middle_half(&mut positions[..count]);
            let sides = 2.0 * (middle.high - middle.low);
            let reach = margin.max(f64::MIN_POSITIVE);
            let least = reach.max(FLAT * sides.max_element());
            let sides = sides.max(DVec3::splat(least)).to_array().map(f64::cbrt);
            let spacing = (sides.iter().product::<f64>() / bodies.cbrt()).max(reach);
            slices = 2.0 * lookahead * telling_speed(&mut speeds[..count]) / spacing;
        }
        Self {
            slices,
            presence,
            middle,
        }
    }
}

/// Returns the cubic mean of some speeds (m/s; at least one), as the volumes of boxes grow with the cube of the way: a share
/// of bodies that moves among others at rest tells. The fastest sixteenth counts with the speed of the next one, so that a few
/// that are far faster make no difference.
fn telling_speed(speeds: &mut [f64]) -> f64 {
    speeds.sort_unstable_by(f64::total_cmp);
    let count = speeds.len();
    let most = speeds[(count - count.div_ceil(16)).saturating_sub(1)];
    if most <= 0.0 {
        return 0.0;
    }
    let cubes = speeds.iter().map(|speed| (speed / most).min(1.0).powi(3));
    most * (cubes.sum::<f64>() / as_f64(count)).cbrt()
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
    /// Memory of all slices together, bytes; in a slice, that of a body, and that of a box.
    const MAX_MEMORY: f64 = 260e6;
    const BODY: f64 = 37.0;
    const BOX: f64 = 93.0;
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
        // A whole number of slices: else part of the next slice would be due at the first tick.
        let velocity = scene.common_velocity((origin, origin + lookahead));
        let estimate = SceneEstimate::of(scene, margin, (origin, lookahead), velocity);
        let slice_count = Self::number(cheapest, scene.len(), &estimate).round();
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

    /// Returns the number of slices for so many bodies, of which a screening would take so many.
    fn number(slices: f64, bodies: usize, estimate: &SceneEstimate) -> f64 {
        let most = (Self::MAX_MEMORY / Self::memory(bodies.max(1), estimate)).min(Self::MAX);
        (Self::SHARE * slices).min(most).max(Self::FEWEST)
    }

    /// Returns the memory of a slice with so many bodies, bytes.
    fn memory(bodies: usize, estimate: &SceneEstimate) -> f64 {
        as_f64(bodies) * (Self::BODY + estimate.presence * Self::BOX)
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
            [&self.estimate, estimate].map(|one| Self::number(one.slices, scene.len(), one));
        let is_alike = now <= FEW * before && before <= FEW * now;
        let frame = Frame::around(self.estimate.middle, self.margin.abs());
        is_alike
            && !self.is_too_fine(scene, estimate)
            && frame.suits(estimate.middle, estimate.middle, self.margin.abs())
    }

    /// Returns true if the grid serves a scene about as well as another grid that was chosen for it.
    pub(super) fn serves(&self, scene: &Scene, other: &Self) -> bool {
        let is_alike = self.slice_count <= 1.5 * other.slice_count
            && other.slice_count <= 1.5 * self.slice_count;
        let most = other.estimate.middle;
        is_alike && self.frame.suits(scene.extremes(), most, self.margin.abs())
    }

    /// Notes that the grid suits the scene as it is now, too. Searches from nothing have no slices that would have to be
    /// formed anew: theirs become as long as those of the other grid.
    pub(super) const fn confirm(&mut self, other: &Self) {
        self.estimate = other.estimate;
        self.search_length = other.search_length;
    }

    /// Returns true if the slices of a scene take far too much memory, by an estimate: it has grown, or its bodies exist
    /// for longer.
    pub(super) fn is_too_fine(&self, scene: &Scene, estimate: &SceneEstimate) -> bool {
        self.slice_count > Self::FEWEST
            && self.slice_count * Self::memory(scene.len(), estimate) > 2.0 * Self::MAX_MEMORY
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

#[cfg(test)]
mod tests {
    use super::{Grid, telling_speed};
    use crate::count::as_f64;
    use crate::error::Error;
    use crate::query::Query;
    use crate::scene::{Body, Scene};
    use crate::trajectory::{State, Trajectory};
    use crate::window::Window;
    use glam::DVec3;
    use rand::rngs::ChaCha8Rng;
    use rand::{RngExt, SeedableRng};

    /// A tenth that moves tells, and one in a sample that is far faster does not.
    #[test]
    fn speeds_of_some_tell_and_those_of_few_do_not() {
        let of = |rest: usize, moving: usize, fast: usize| {
            let speeds = [(0.0, rest), (20.0, moving), (1e8, fast)];
            let speeds = speeds.map(|(speed, count)| vec![speed; count]);
            telling_speed(&mut speeds.concat())
        };
        let within = |speed: f64, least: f64, most: f64| (least..=most).contains(&speed);
        assert!(within(of(0, 64, 0), 19.9, 20.1));
        assert!(within(of(45, 19, 0), 10.0, 20.0));
        assert!(within(of(58, 6, 0), 5.0, 20.0));
        for count in [4, 16, 17, 64] {
            let speed = of(0, count - 1, 1);
            assert!(within(speed, 19.9, 20.1), "{count} {speed}");
            assert!(of(count - 1, 0, 1) <= 0.0, "{count}");
        }
        assert!(within(of(0, 0, 64), 0.99e8, 1.01e8));
        // Of one or two the slower one.
        assert!(of(1, 0, 0) <= 0.0 && within(of(0, 1, 1), 19.9, 20.1));
    }

    /// Bodies take memory in the slices in which they exist: many that exist for a short time do not make slices long.
    #[test]
    fn slices_are_as_many_as_bodies_that_exist_at_a_time_need() -> Result<(), Error> {
        const BODIES: usize = 40_000;
        let mut rng = ChaCha8Rng::seed_from_u64(5);
        let lookahead = 2_000.0;
        let scene_of = |life: f64, rng: &mut ChaCha8Rng| {
            let mut scene = Scene::new();
            for _ in 0..BODIES {
                let start = rng.random_range(0.0..lookahead - life);
                let mut point = |size: f64| {
                    let [x, y, z] = [0; 3].map(|_| rng.random_range(-size..size));
                    DVec3::new(x, y, z)
                };
                let (position, velocity) = (point(1_000.0), point(200.0));
                let states =
                    [0.0, life].map(|t| State::new(start + t, position + t * velocity, velocity));
                scene.insert(Body::new(Trajectory::from_states(&states)?))?;
            }
            Ok::<_, Error>(scene)
        };
        let most = |scene: &Scene| {
            let grid = Grid::for_scene(scene, 5.0, (0.0, lookahead), 0.0)?;
            let most = Grid::number(1e9, BODIES, &grid.estimate);
            Ok::<_, Error>((grid, most))
        };
        let of_all = Grid::MAX_MEMORY / (as_f64(BODIES) * (Grid::BODY + Grid::BOX));
        let short = scene_of(lookahead / 10.0, &mut rng)?;
        let (grid, most_of_short) = most(&short)?;
        assert!(most_of_short > 2.0 * of_all, "{most_of_short} {of_all}");
        let query = Query::new(Window::new(0.0, lookahead)?).with_margin(5.0);
        let wanted = Grid::SHARE * f64::from(short.cheapest_slices(&query)?);
        let count = grid.slice_count;
        assert!(
            count > 1.2 * of_all && (count - wanted).abs() <= 0.5,
            "{count} {wanted}"
        );
        let (_, most_of_long) = most(&scene_of(0.9 * lookahead, &mut rng)?)?;
        assert!(most_of_long < 1.1 * of_all, "{most_of_long} {of_all}");
        Ok(())
    }
}
