//! The bodies of a search, by number.

use super::form_slices::{SlicesToForm, SourcesInPlace};
use crate::bounds::HullTest;
use crate::knots::Knots;
use crate::narrow_phase::BodyView;
use crate::shape::BodyShape;

/// Access to bodies by number (dense in a screening; slots in a monitor, some without a body): all that a search knows of
/// a scene or a monitor.
pub(crate) trait Bodies: Sync {
    /// Returns the view of a body; one that never exists if there is none.
    fn view(&self, body: u32) -> BodyView<'_>;

    fn knots(&self, body: u32) -> Knots<'_> {
        self.view(body).knots
    }

    /// Returns the [hull test](crate::bounds::hull_test) of two bodies, each on one cubic, over an interval (s).
    fn hull_test(&self, _: [(u32, u32); 2], _: (f64, f64)) -> HullTest {
        HullTest::Undecided
    }

    /// Returns true if some bodies may [have long arms](BodyShape::has_long_arms), and turn.
    fn have_long_arms(&self) -> bool;

    /// Returns the shape of a body that turns and has long arms.
    fn long_arms(&self, body: u32) -> Option<BodyShape<'_>>;

    /// Prefetches the record of a body.
    fn fetch(&self, _: u32) {}

    /// Prefetches the data of its view.
    fn fetch_view(&self, body: u32) {
        self.fetch(body);
    }

    /// Prefetches the knots of a body, from those of a cubic on.
    fn fetch_knots(&self, _: (u32, u32)) {}

    /// Prefetches a cubic for the [hull test](Self::hull_test).
    fn fetch_cubic(&self, _: (u32, u32)) {}

    fn fetch_segment(&self, _: (u32, u32)) {}
}

/// Bodies of which boxes can be formed.
pub(crate) trait BoxedBodies: Bodies {
    /// True if several threads can share the bodies of a few slices.
    const ARE_SHARED: bool;

    /// Forms the boxes and fat lines of some bodies in a few slices.
    fn form(&self, slices: SlicesToForm<'_>);
}

impl<B: Bodies + SourcesInPlace> BoxedBodies for B {
    const ARE_SHARED: bool = true;

    fn form(&self, slices: SlicesToForm<'_>) {
        slices.form_in_place(self);
    }
}
