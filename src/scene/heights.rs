//! Heights of bodies above half-spaces, for a first comparison without cubics.

use super::SceneEntry;
use crate::bounds::DAabb;
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
    /// Returns the half-space of a body between two instants (s), if it is one. `needs_cubics` tells that its plan alone
    /// does not tell where it is then.
    pub(crate) fn of(
        body: u32,
        (entry, needs_cubics): (&SceneEntry, bool),
        interval: (f64, f64),
    ) -> Option<Self> {
        let normal = entry.body.hitbox.normal()?;
        let positions = PositionBox::of((entry, needs_cubics), interval);
        Some(Self {
            body,
            normal,
            model_error: entry.body.model_error(),
            heights: positions.map(|positions| positions.heights(normal)),
        })
    }

    /// Returns true if another body, with these positions, is certainly farther than `margin` (m) above the half-space
    /// between the two instants.
    #[inline]
    pub(crate) fn is_below(&self, body: &PositionBox, margin: f64) -> bool {
        self.heights.as_ref().is_some_and(|ground| {
            // The reach contains the model error of the body, not that of the half-space.
            let reach = body.reach + self.model_error;
            body.heights(self.normal).is_above(ground, reach, margin)
        })
    }
}

/// A box around the positions of a body between two instants.
#[derive(Debug)]
pub(crate) struct PositionBox {
    around: DAabb,
    /// Magnitude of the coordinates, to which their rounding is relative, m.
    size: f64,
    /// Largest distance of a point of the body's spheres from its position, m.
    reach: f64,
}

impl PositionBox {
    /// Returns the box of a body between two instants (s), if it is known without cubics: the body follows straight
    /// motions, or its plan alone.
    #[inline]
    pub(crate) fn of(
        (entry, needs_cubics): (&SceneEntry, bool),
        (from, to): (f64, f64),
    ) -> Option<Self> {
        let plan = &entry.body.trajectory;
        let reach = entry.body.shape().reach();
        let motions = plan.straight_motions();
        if motions.is_empty() {
            if needs_cubics {
                return None;
            }
            let around = entry.summary().around();
            return Some(Self {
                around,
                size: around.low.abs().max(around.high.abs()).element_sum(),
                reach,
            });
        }
        let mut all = Self {
            around: DAabb::NOTHING,
            size: 0.0,
            reach,
        };
        let knots = plan.knots();
        for (number, motion) in motions.iter().enumerate() {
            // The first one goes back, and the last one on, for ever.
            let begin = if number == 0 {
                from
            } else {
                from.max(knots[number])
            };
            let end = knots.get(number + 1).map_or(to, |&knot| to.min(knot));
            if begin > end {
                continue;
            }
            let size = |vector: DVec3| vector.abs().element_sum();
            for displacement in [begin, end].map(|time| motion.displacement_to(time)) {
                let position = motion.origin() + displacement;
                // Of what is not finite nothing is known.
                if !position.is_finite() {
                    return None;
                }
                all.around.include(DAabb::of_point(position));
                all.size = all.size.max(size(motion.origin()) + size(displacement));
            }
        }
        Some(all)
    }

    /// Returns the heights of the box along a normal.
    #[inline]
    fn heights(&self, normal: DVec3) -> HeightRange {
        let (along, across) = (normal.max(DVec3::ZERO), normal.min(DVec3::ZERO));
        let DAabb { low, high } = self.around;
        HeightRange {
            low: low.dot(along) + high.dot(across),
            high: high.dot(along) + low.dot(across),
            size: self.size,
        }
    }
}
