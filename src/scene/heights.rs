//! Heights of bodies above half-spaces, for a first comparison without cubics.

use super::SceneEntry;
use crate::narrow_phase::HeightRange;
use glam::DVec3;

/// A half-space, with its heights along its normal between two instants.
#[derive(Debug)]
pub(crate) struct PlaneHeights {
    /// The number by which the half-space is known: its place or its slot.
    pub(crate) body: u32,
    normal: DVec3,
    /// Model error, m.
    model_error: f64,
    /// `None` if they are not known without its cubics.
    heights: Option<HeightRange>,
}

impl PlaneHeights {
    /// Returns the half-space of a body between two instants (s), if it is one. `is_extended` tells that its plan alone
    /// does not tell where it is then.
    pub(crate) fn of(
        body: u32,
        (entry, is_extended): (&SceneEntry, bool),
        interval: (f64, f64),
    ) -> Option<Self> {
        let normal = entry.body.hitbox.normal()?;
        Some(Self {
            body,
            normal,
            model_error: entry.body.model_error(),
            heights: height_range(entry, is_extended, interval, normal),
        })
    }

    /// Returns true if another body is certainly farther than `margin` (m) above the half-space between two instants (s).
    #[inline]
    pub(crate) fn is_below(
        &self,
        (entry, is_extended): (&SceneEntry, bool),
        interval: (f64, f64),
        margin: f64,
    ) -> bool {
        self.heights.as_ref().is_some_and(|ground| {
            let heights = height_range(entry, is_extended, interval, self.normal);
            // The reach contains the model error of the body, not that of the half-space.
            let reach = entry.body.shape().reach() + self.model_error;
            heights.is_some_and(|heights| heights.is_above(ground, reach, margin))
        })
    }
}

/// Returns the heights of a body between two instants (s) along a normal, if they are known without its
/// cubics: it follows straight motions, or its plan alone.
#[inline]
fn height_range(
    entry: &SceneEntry,
    is_extended: bool,
    (from, to): (f64, f64),
    normal: DVec3,
) -> Option<HeightRange> {
    let plan = &entry.body.trajectory;
    let motions = plan.straight_motions();
    if motions.is_empty() {
        if is_extended {
            return None;
        }
        let plan = entry.summary().around();
        let (along, across) = (normal.max(DVec3::ZERO), normal.min(DVec3::ZERO));
        return Some(HeightRange {
            low: plan.low.dot(along) + plan.high.dot(across),
            high: plan.high.dot(along) + plan.low.dot(across),
            size: plan.low.abs().max(plan.high.abs()).element_sum(),
        });
    }
    let mut all = HeightRange {
        low: f64::INFINITY,
        high: f64::NEG_INFINITY,
        size: 0.0,
    };
    let knots = plan.knots();
    for (number, motion) in motions.iter().enumerate() {
        // The first one goes back, and the last one on, for ever.
        let begin = from.max(if number == 0 { from } else { knots[number] });
        let end = to.min(if number + 1 < motions.len() {
            knots[number + 1]
        } else {
            to
        });
        if begin > end {
            continue;
        }
        let size = |vector: DVec3| vector.abs().element_sum();
        for displacement in [begin, end].map(|time| motion.displacement_to(time)) {
            let height = (motion.origin() + displacement).dot(normal);
            // Of what is not finite nothing is known.
            if !height.is_finite() {
                return None;
            }
            all.low = all.low.min(height);
            all.high = all.high.max(height);
            all.size = all.size.max(size(motion.origin()) + size(displacement));
        }
    }
    Some(all)
}
