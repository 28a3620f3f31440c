//! The exact solver: closest approach and contacts of one pair.
//!
//! The solver works on a body's cubics and spheres, span by span. Within a span it forms the
//! `relative` cubic, applies the `rejection` tests, and finds `stationary` points, unless the `squared_distance` shows that there
//! are none (and the `dips` that it hides), and the `profile` of the distance between them. `contact` joins these
//! across spans and spheres, `certified` with certificates. For two bodies of which one
//! is a cluster or turns, `clusters` selects the pairs of spheres to solve. A `half_space` and a sphere are
//! solved as two spheres on a line. [`kernels`] answers many independent pairs at once.
//!
//! Words: [`internals`](crate::internals).

mod approach;
mod certified;
mod clusters;
mod contact;
mod crossing;
mod dips;
mod half_space;
pub mod kernels;
mod long_arms;
mod profile;
mod rejection;
mod relative;
mod sphere_pair;
mod squared_distance;
mod stationary;

pub(crate) use approach::{approaching, keep_approaching};
pub(crate) use certified::{CertifiedContact, Workspace, certified_approach, certified_contacts};
pub(crate) use clusters::KeptQuestion;
pub(crate) use contact::{SolvedSpan, closest_approach, contacts, contacts_of, may_touch, solve};
pub(crate) use half_space::HeightRange;
pub(crate) use sphere_pair::{Approach, Contact};

use crate::hitbox::{Hitbox, Sphere};
use crate::knots::Knots;
use crate::orientation::Turning;
use crate::rounding::{sum_above, two_sum};
use crate::shape::BodyShape;
use crate::spans::Span;
use crate::trajectory::{Outside, Segment, Trajectory};
use glam::DVec3;
use std::borrow::Cow;

/// References to all of a body that the narrow phase reads.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BodyView<'a> {
    /// Knots k and k + 1 are the ends of cubic k.
    pub(crate) knots: Knots<'a>,
    /// Cubics of the plan.
    pub(crate) segments: &'a [Segment],
    /// The plan, which says how the body goes on, whether or not the knots include its extension; `None` of a body that
    /// has no more than these cubics.
    pub(crate) plan: Option<&'a Trajectory>,
    /// Spheres of the hitbox; a half-space has none.
    pub(crate) spheres: &'a [Sphere],
    /// Sphere that contains all spheres, enlarged by the model error; for a half-space its normal, and an
    /// infinite radius.
    pub(crate) bounding: Sphere,
    /// The hitbox of these spheres; `None` of a sphere that stands in for it.
    pub(crate) hitbox: Option<&'a Hitbox>,
    /// Turning motion of the spheres, if that changes anything.
    pub(crate) turning: Option<&'a Turning>,
    /// [Model error](crate::Body::with_model_error) of the body, m.
    pub(crate) model_error: f64,
}

impl<'a> BodyView<'a> {
    /// Returns the view of a body that follows a plan, with these knots.
    #[inline(always)]
    pub(crate) fn of_plan(knots: Knots<'a>, plan: &'a Trajectory, shape: BodyShape<'a>) -> Self {
        Self {
            plan: Some(plan),
            ..Self::of((knots, plan.cubics()), shape)
        }
    }

    /// Returns the view of a body that has no more than the cubics between these knots.
    #[inline(always)]
    pub(crate) fn of((knots, segments): (Knots<'a>, &'a [Segment]), shape: BodyShape<'a>) -> Self {
        Self {
            knots,
            segments,
            plan: None,
            spheres: shape.spheres(),
            bounding: shape.bounding(),
            hitbox: Some(shape.hitbox()),
            turning: shape.turning(),
            model_error: shape.model_error(),
        }
    }

    /// Returns the sum of both bodies' model errors, rounded up, m.
    #[inline]
    pub(crate) fn model_error_with(&self, other: &Self) -> f64 {
        pair_error(self.model_error, other.model_error)
    }

    /// Returns cubic number `number`.
    #[inline(always)]
    pub(crate) fn segment(&self, number: usize) -> Cow<'a, Segment> {
        if !self.knots.has_unlisted_cubics() {
            return Cow::Borrowed(&self.segments[number]);
        }
        match self.knots.segment_beyond(number) {
            Some(segment) => Cow::Owned(segment),
            None => Cow::Borrowed(&self.segments[number - self.knots.before()]),
        }
    }

    /// Returns the cubic that the body follows after a cubic of these knots, whether or not the knots include the plan's
    /// extension; `None` if it ends there, or goes on as before.
    pub(crate) fn segment_after(&self, number: usize) -> Option<Cow<'a, Segment>> {
        if self.knots.is_own(number + 1) {
            return Some(self.segment(number + 1));
        }
        let is_after = number + 1 >= self.knots.before();
        let goes_on = |plan: &&Trajectory| plan.outside_after() != Outside::Absent;
        let plan = self.plan.filter(goes_on).filter(|_| is_after)?;
        Some(Cow::Owned(plan.segment_after()))
    }

    /// Returns the cubics that two bodies follow in a span.
    #[inline(always)]
    pub(crate) fn segments_in(&self, other: &Self, span: Span) -> [Cow<'a, Segment>; 2] {
        if self.knots.has_unlisted_cubics() || other.knots.has_unlisted_cubics() {
            return self.segments_formed_in(other, span);
        }
        let (a, b) = (span.cubic_a as usize, span.cubic_b as usize);
        [
            Cow::Borrowed(&self.segments[a]),
            Cow::Borrowed(&other.segments[b]),
        ]
    }

    #[inline(never)]
    fn segments_formed_in(&self, other: &Self, span: Span) -> [Cow<'a, Segment>; 2] {
        [
            self.segment(span.cubic_a as usize),
            other.segment(span.cubic_b as usize),
        ]
    }

    /// Returns true if the body turns, and a box that turns with it tells more of where its spheres are than the bounding
    /// sphere does.
    #[inline]
    pub(crate) fn has_long_arms(&self) -> bool {
        self.turning.is_some() && self.hitbox.is_some_and(Hitbox::has_long_arms)
    }

    /// Returns true if the hitbox is a half-space.
    pub(crate) const fn is_half_space(&self) -> bool {
        self.bounding.radius.is_infinite()
    }
}

impl BodyView<'_> {
    /// The view of a body that never exists.
    pub(crate) const NONE: Self = Self {
        knots: Knots::NONE,
        segments: &[],
        plan: None,
        spheres: &[],
        bounding: Sphere {
            offset: DVec3::ZERO,
            radius: 0.0,
        },
        hitbox: None,
        turning: None,
        model_error: 0.0,
    };
}

/// Returns the sum of two bodies' model errors, rounded up, m.
#[inline]
pub(crate) fn pair_error(a: f64, b: f64) -> f64 {
    if a + b > 0.0 { sum_above(a, b) } else { 0.0 }
}

/// Returns the margin plus the sum of two bodies' model errors, rounded up, m: the largest separation of the
/// splines at which the bodies may be within the margin.
#[inline]
pub(crate) fn widened(margin: f64, model_error: f64) -> f64 {
    if model_error > 0.0 {
        sum_above(margin, model_error)
    } else {
        margin
    }
}

/// Returns the centre distance (m) at which two spheres have the separation `margin`: within one unit
/// in the last place of the exact sum of the three numbers. If negative, no distance is small enough.
pub(crate) fn contact_radius(a: f64, b: f64, margin: f64) -> f64 {
    let (radii, lost_radii) = two_sum(a, b);
    let (sum, lost_sum) = two_sum(radii, margin);
    sum + (lost_radii + lost_sum)
}

#[cfg(test)]
mod tests {
    use super::contact_radius;

    #[test]
    fn the_radius_is_the_rounded_exact_sum() {
        assert!(contact_radius(1.0, 1e-20, -1.0).to_bits() == 1e-20_f64.to_bits());
        assert!(contact_radius(0.1, 0.2, -(0.1 + 0.2)) < 0.0);
        assert!(contact_radius(0.5, 0.5, -1.0).abs() <= 0.0);
    }
}
