//! A sample of a scene's bodies, and what most of them have in common.

use super::{Scene, SceneEntry};
use glam::DVec3;

impl Scene {
    /// As many bodies as tell what most are like.
    pub(crate) const SAMPLE: usize = 64;

    /// Some of the bodies that may be part of a pair within a time (s): of all where there are few, else of
    /// those in slots scattered over all.
    pub(crate) fn sample(&self, (from, to): (f64, f64)) -> impl Iterator<Item = &SceneEntry> {
        let count = self.slots.len();
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
            self.partners(0.0).has(&entry.body) && domain.start() <= to && domain.end() >= from
        })
    }

    /// Returns the velocity (m/s) that most bodies have in common within a time (s): the median of their
    /// mean velocities; none where their speeds relative to it are hardly less.
    pub(crate) fn common_velocity(&self, window: (f64, f64)) -> DVec3 {
        /// Sum of the speeds relative to the median, next to that of all speeds. In a frame that moves, the
        /// same boxes cost some more to form.
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

/// The mean velocity of a body in the part of a time in which it exists; none where that has no end or is
/// an instant.
fn mean_velocity(entry: &SceneEntry, (from, to): (f64, f64)) -> Option<DVec3> {
    let plan = &entry.body.trajectory;
    let domain = plan.domain();
    let (from, to) = (from.max(domain.start()), to.min(domain.end()));
    let way = plan.position(to)? - plan.position(from)?;
    let velocity = way / (to - from);
    velocity.is_finite().then_some(velocity)
}
