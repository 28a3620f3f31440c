//! Bodies as a search sees them: under dense numbers.

use crate::bounds::{Cubic, Leg, Pose, Sight, sight};
use crate::knots::Knots;
use crate::narrow_phase::Party;
use crate::simd::prefetch;
use std::slice::from_ref;

/// Bodies under dense numbers: all that a search knows of a scene or a monitor.
pub(crate) trait Bodies: Sync {
    /// Returns a body as the narrow phase takes it; one that never exists if there is none.
    fn party(&self, body: u32) -> Party<'_>;

    /// Returns the knots of a body.
    fn knots(&self, body: u32) -> Knots<'_> {
        self.party(body).knots
    }

    /// Returns what compact cubics tell of two bodies, each on a cubic, over a time (s).
    fn sight(&self, _: [(u32, u32); 2], _: (f64, f64)) -> Sight {
        Sight::Blurred
    }

    /// Fetches what is known of a body into the caches.
    fn fetch(&self, _: u32) {}

    /// Fetches the knots of a body, from those of a cubic on.
    fn fetch_knots(&self, _: (u32, u32)) {}

    /// Fetches a cubic as [`sight`](Self::sight) reads it.
    fn fetch_cubic(&self, _: (u32, u32)) {}

    /// Fetches a segment.
    fn fetch_segment(&self, _: (u32, u32)) {}
}

/// Bodies laid out side by side, by number.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BodyLists<'a, C> {
    pub(crate) parties: &'a [Party<'a>],
    pub(crate) poses: &'a [Pose<'a, C>],
}

impl<C: Cubic + Sync> Bodies for BodyLists<'_, C> {
    #[inline]
    fn party(&self, body: u32) -> Party<'_> {
        self.parties[body as usize]
    }

    /// From the list that boxes are formed of: it lies in the caches.
    #[inline]
    fn knots(&self, body: u32) -> Knots<'_> {
        self.poses[body as usize].knots
    }

    #[inline]
    fn sight(&self, cubics: [(u32, u32); 2], part: (f64, f64)) -> Sight {
        if !C::IS_COMPACT {
            return Sight::Blurred;
        }
        let [a, b] = cubics.map(|(body, cubic)| Leg {
            pose: &self.poses[body as usize],
            cubic: cubic as usize,
        });
        sight(&a, &b, part)
    }

    #[inline]
    fn fetch(&self, body: u32) {
        prefetch(from_ref(&self.poses[body as usize]));
    }

    #[inline]
    fn fetch_knots(&self, (body, first): (u32, u32)) {
        /// Two lines.
        const KNOTS: usize = 16;
        let knots = &self.poses[body as usize].knots;
        knots.prefetch(first as usize, KNOTS);
    }

    #[inline]
    fn fetch_cubic(&self, (body, cubic): (u32, u32)) {
        self.poses[body as usize].fetch(cubic as usize);
    }

    #[inline]
    fn fetch_segment(&self, (body, cubic): (u32, u32)) {
        self.parties[body as usize].prefetch(cubic as usize);
    }
}
