//! Where a monitor measures from, and how it cuts time into slices: as suits its scene.

use super::can_tell_apart;
use crate::bounds::Frame;
use crate::error::Error;
use crate::query::Query;
use crate::scene::Scene;
use crate::window::Window;

/// See the module. What is found does not depend on it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Grid {
    pub(super) frame: Frame,
    /// Where slices begin to be counted, s.
    pub(super) origin: f64,
    /// How long they are, s.
    pub(super) length: f64,
    /// How many of them make up the lookahead.
    pub(super) ahead: f64,
    /// For how many bodies that was chosen.
    bodies: usize,
}

impl Grid {
    /// Slices that a lookahead is cut into, at least and at most. The boxes of more slices are tighter,
    /// and each changed plan is compared in every one of them. (Where a screening would take two or
    /// three, three were measured 10 to 15 % cheaper than four.)
    pub(super) const FEWEST: f64 = 3.0;
    const MOST: f64 = 256.0;
    /// Boxes in all of them together: some 130 bytes each.
    const MOST_BOXES: f64 = 2e6;
    /// A screening forms a box and compares it for a tenth of what it costs to do that when a plan
    /// changes: a monitor takes this share of the slices that a screening would.
    const SHARE: f64 = 0.5;

    /// For a scene and pairs within `margin` (m), for a `lookahead` from `origin` (s) on a clock that shows
    /// `now` (s).
    ///
    /// # Errors
    ///
    /// [`Error::InBody`] if an extrapolated plan leaves the range of numbers.
    #[allow(clippy::cast_precision_loss, reason = "a number of bodies")]
    pub(super) fn for_scene(
        scene: &Scene,
        margin: f64,
        (origin, lookahead): (f64, f64),
        now: f64,
    ) -> Result<Self, Error> {
        let query = Query::new(Window::new(origin, origin + lookahead)?).with_margin(margin)?;
        let cheapest = f64::from(scene.cheapest_slices(&query)?);
        let most = (Self::MOST_BOXES / scene.len().max(1) as f64).min(Self::MOST);
        // Whole: else part of the next one would be due with the first tick.
        let ahead = (Self::SHARE * cheapest).min(most).round();
        let ahead = ahead.max(Self::FEWEST);
        let grid = Self {
            frame: Frame::around(scene.extremes(), margin.abs()),
            origin,
            length: lookahead / ahead,
            ahead,
            bodies: scene.len(),
        };
        Ok(if grid.has_room(now) {
            grid
        } else {
            Self {
                length: lookahead / Self::FEWEST,
                ahead: Self::FEWEST,
                ..grid
            }
        })
    }

    /// Whether it still suits a scene in which all bodies have changed: another one is not worth choosing.
    pub(super) fn suits(&self, scene: &Scene, margin: f64) -> bool {
        let (bodies, before) = (scene.len(), self.bodies);
        let is_about_as_large = bodies <= 2 * before && before <= 2 * bodies;
        is_about_as_large && self.frame.suits(scene.sampled_extremes(), margin.abs())
    }

    /// Whether it would have far too many boxes for a scene: one that has grown.
    #[allow(clippy::cast_precision_loss, reason = "a number of bodies")]
    pub(super) fn is_too_fine(&self, scene: &Scene) -> bool {
        self.ahead > Self::FEWEST && self.ahead * scene.len() as f64 > 2.0 * Self::MOST_BOXES
    }

    /// Whether its slices can be told apart on a clock that shows `now` (s), with bits to spare; the
    /// fewest there can be need none.
    pub(super) fn has_room(&self, now: f64) -> bool {
        self.ahead <= Self::FEWEST || can_tell_apart(now, self.length / 1024.0)
    }
}
