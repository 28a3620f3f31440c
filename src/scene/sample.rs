//! A sample of a scene's bodies, and their common velocity.

use super::{Scene, SceneEntry};
use crate::count::as_f64;
use glam::DVec3;

impl Scene {
    pub(crate) const SAMPLE: usize = 64;

    /// Returns some of the bodies that may be part of a pair within a time (s): all if they are
    /// few, else those in slots spread over all.
    pub(crate) fn sample(&self, (from, to): (f64, f64)) -> impl Iterator<Item = &SceneEntry> {
        let (count, partners) = (self.slots.len(), self.partners(0.0));
        let some = (0..count.min(Self::SAMPLE)).filter_map(move |number| {
            // Not in equal strides: no order in which bodies are put in hides some kinds of them.
            let slot = if count <= Self::SAMPLE {
                number
            } else {
                number * count / Self::SAMPLE + number % (count / Self::SAMPLE)
            };
            self.slots[slot].entry.as_ref()
        });
        some.filter(move |entry| {
            let domain = entry.body.trajectory.domain();
            partners.has(&entry.body) && domain.start() <= to && domain.end() >= from
        })
    }

    /// Returns the mean number of cubics that a body has in a list of its plan within a time (s), told by some of the bodies.
    pub(crate) fn cubics_of_a_plan(&self, (from, to): (f64, f64)) -> f64 {
        let (mut cubics, mut count) = (0.0, 0.0);
        for entry in self.sample((from, to)) {
            let plan = &entry.body.trajectory;
            if let [first, .., last] = *plan.piece_knots() {
                let within = (to.min(last) - from.max(first)).max(0.0);
                let listed = as_f64(plan.cubics().len());
                // A part of one takes as long as one.
                let least = if within > 0.0 { listed.min(1.0) } else { 0.0 };
                cubics += (listed * (within / (last - first))).max(least);
            }
            count += 1.0;
        }
        cubics / f64::max(count, 1.0)
    }

    /// Returns the mean number of bodies that exist at an instant of a time (s), told by some of the bodies: of those that
    /// may be part of a pair.
    pub(crate) fn mean_present(&self, (from, to): (f64, f64)) -> f64 {
        let shares = self.sample((from, to)).map(|entry| {
            let domain = entry.body.trajectory.domain();
            (to.min(domain.end()) - from.max(domain.start())) / (to - from)
        });
        let slots = self.slots.len();
        let sampled = slots.clamp(1, Self::SAMPLE);
        shares.sum::<f64>() * (as_f64(slots) / as_f64(sampled))
    }

    /// Returns the common velocity (m/s) of most bodies within a time (s): the median of their mean
    /// velocities. Zero if speeds relative to it are hardly smaller.
    pub(crate) fn common_velocity(&self, window: (f64, f64)) -> DVec3 {
        /// Largest ratio of the sum of speeds relative to the median to that of all speeds. Boxes
        /// cost somewhat more to form in a moving frame.
        const LESS: f64 = 0.75;
        let velocities = self
            .sample(window)
            .filter_map(|one| mean_velocity(one, window));
        let velocities: Vec<DVec3> = velocities.collect();
        let mut sorted = velocities.clone();
        let mut median = DVec3::ZERO;
        for axis in 0..3 {
            sorted.sort_unstable_by(|v, w| v[axis].total_cmp(&w[axis]));
            median[axis] = sorted.get(sorted.len() / 2).map_or(0.0, |v| v[axis]);
        }
        let speeds =
            |frame: DVec3| -> f64 { velocities.iter().map(|&v| (v - frame).length()).sum() };
        if speeds(median) < LESS * speeds(DVec3::ZERO) {
            median
        } else {
            DVec3::ZERO
        }
    }
}

/// Returns the mean velocity of a body in the part of a time in which it exists, or `None` if that
/// part is infinite or an instant.
fn mean_velocity(entry: &SceneEntry, (from, to): (f64, f64)) -> Option<DVec3> {
    let plan = &entry.body.trajectory;
    let domain = plan.domain();
    let (from, to) = (from.max(domain.start()), to.min(domain.end()));
    let displacement = plan.position(to)? - plan.position(from)?;
    let velocity = displacement / (to - from);
    velocity.is_finite().then_some(velocity)
}
