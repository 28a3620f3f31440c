//! The search made anew from the scene, on the same grid or on another one.

use super::Monitor;
use super::grid::{Grid, GridReview, SceneEstimate};
use super::lookahead::LookaheadSearch;
use super::read::LevelCaches;
use crate::error::Error;

impl Monitor {
    /// Adds all bodies of the scene to a search without bodies.
    pub(super) fn prepare_all_bodies(&mut self) -> Result<(), Error> {
        let context = self.change_context()?;
        let bodies = self.scene.bodies();
        let prepared = bodies.map(|(id, body)| {
            let monitored = context.monitored_body_of(body);
            Ok((id, monitored.map_err(|error| error.with_id(id))?))
        });
        for (id, monitored) in prepared.collect::<Result<Vec<_>, Error>>()? {
            self.search.set(id.slot, Some(monitored));
        }
        self.search.find_partners(&self.scene, None);
        Ok(())
    }

    /// Drops all state derived from the scene, and starts again with this search, which knows nothing.
    pub(super) fn renew(&mut self, renewed: LookaheadSearch) -> Result<(), Error> {
        let before = std::mem::replace(&mut self.search, renewed);
        if let Err(error) = self.prepare_all_bodies() {
            self.search = before;
            return Err(error);
        }
        self.readings = LevelCaches::of_levels(self.levels.len());
        Ok(())
    }

    /// Drops all state derived from the scene, and keeps the grid.
    pub(super) fn forget_search(&mut self) -> Result<(), Error> {
        self.renew(self.search.emptied(self.search.grid))
    }

    /// Chooses another grid, and rebuilds the search on it, if the current one is unusable: the
    /// scene has outgrown it, or `now` (s) is too large to tell its slices apart. A grid that no longer
    /// suits the scene is replaced, too, if the tick may wait for the rebuild: it has no budget and does
    /// not lag.
    pub(super) fn choose_grid(&mut self, now: f64, may_wait: bool) -> Result<(), Error> {
        let lookahead = (self.reported, self.lookahead);
        let grid = &self.search.grid;
        let margin = grid.margin;
        let can_stay = grid.has_room(now) && !grid.is_too_fine(&self.scene, &grid.estimate);
        if can_stay {
            let bodies = self.scene.len();
            if !(may_wait && self.grid_review.is_due(bodies, now, self.lookahead)) {
                return Ok(());
            }
            self.grid_review = GridReview::after_comparison(bodies, now);
            let velocity = grid.frame.velocity();
            let estimate = SceneEstimate::of(&self.scene, margin, lookahead, velocity);
            if grid.suits(&self.scene, &estimate) {
                return Ok(());
            }
        }
        let other = Grid::for_scene(&self.scene, margin, lookahead, now)?;
        if can_stay && self.search.grid.serves(&self.scene, &other) {
            self.search.grid.confirm(&other);
            return Ok(());
        }
        self.renew(self.search.anew(other))
    }
}
