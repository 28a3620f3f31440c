//! Two spheres over one span, their contacts and closest approach.

use super::profile::{DistanceProfile, ProfilePoint};
use super::rejection::certainly_beyond;
use super::relative::RelativeCubic;
use super::{BodyView, contact_radius};
use crate::enclosure::UncertainCubic;
use crate::rounding::CLEARANCE;
use crate::spans::Span;
use glam::DVec3;

/// The closest instant of a pair, with the data to describe it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Approach {
    pub(crate) time: f64,
    /// Distance of the two spheres' surfaces, m.
    pub(crate) separation: f64,
    /// Rounding of a constant distance, m; else 0.
    pub(crate) plateau: f64,
    pub(crate) sphere_a: u32,
    pub(crate) sphere_b: u32,
    pub(crate) span: Span,
}

/// A maximal interval in which a pair is within the margin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Contact {
    pub(crate) enter: f64,
    pub(crate) exit: f64,
    pub(crate) closest: Approach,
}

impl Approach {
    /// Returns an approach at an instant, without plateau.
    pub(super) const fn at(
        time: f64,
        separation: f64,
        (sphere_a, sphere_b): (u32, u32),
        span: Span,
    ) -> Self {
        Self {
            time,
            separation,
            plateau: 0.0,
            sphere_a,
            sphere_b,
            span,
        }
    }

    /// Returns the lower of two approaches; of ties, the earlier one, and at one time the one of the first spheres and the
    /// earlier span. Without plateaus the least of several does not depend on their order.
    pub(crate) fn or_lower(self, other: Self) -> Self {
        let order = self.time.total_cmp(&other.time).then_with(|| {
            let spheres = |one: &Self| (one.sphere_a, one.sphere_b);
            let starts = self.span.start.total_cmp(&other.span.start);
            spheres(&self).cmp(&spheres(&other)).then(starts)
        });
        let (first, second) = if order.is_gt() {
            (other, self)
        } else {
            (self, other)
        };
        let tie = first.plateau.min(second.plateau);
        if second.separation < first.separation - tie {
            second
        } else {
            first
        }
    }

    /// Returns both bodies' positions (m) and the velocity of a relative to b (m/s) from then on.
    pub(crate) fn kinematics(&self, a: &BodyView<'_>, b: &BodyView<'_>) -> (DVec3, DVec3, DVec3) {
        let motion = |view: &BodyView<'_>, cubic: u32| {
            let cubic = cubic as usize;
            let (position, velocity, _) = view.segment(cubic).motion_at(self.time);
            let has_ended = view.knots.at(cubic + 1) <= self.time;
            let next = has_ended.then(|| view.segment_after(cubic)).flatten();
            let from_then_on = next.map(|next| next.motion_at(self.time).1);
            (position, from_then_on.unwrap_or(velocity))
        };
        let (position_a, velocity_a) = motion(a, self.span.cubic_a);
        let (position_b, velocity_b) = motion(b, self.span.cubic_b);
        (position_a, position_b, velocity_a - velocity_b)
    }
}

/// One sphere of each body over one span.
#[derive(Clone, Copy, Debug)]
pub(super) struct SpherePair {
    pub(super) a: u32,
    pub(super) b: u32,
    pub(super) radius_a: f64,
    pub(super) radius_b: f64,
    /// Bound on the distance of turning centres from their cubics that the radii do not contain,
    /// m; 0 if neither body turns. More than 0 where the cubic is not that of the two bodies.
    pub(super) path_error: f64,
    pub(super) cubic: RelativeCubic,
}

impl SpherePair {
    pub(super) fn approach(&self, span: Span, instant: ProfilePoint) -> Approach {
        Approach {
            time: instant.time,
            separation: instant.distance - (self.radius_a + self.radius_b),
            plateau: instant.plateau,
            sphere_a: self.a,
            sphere_b: self.b,
            span,
        }
    }

    /// Returns the centre distance at which the separation is `margin`, m.
    pub(super) fn radius(&self, margin: f64) -> f64 {
        contact_radius(self.radius_a, self.radius_b, margin)
    }

    /// Appends the contacts in a window.
    pub(super) fn contacts(
        &self,
        profile: &DistanceProfile,
        span: Span,
        margin: f64,
        window: (f64, f64),
        found: &mut Vec<Contact>,
    ) {
        let radius = self.radius(margin);
        if radius < 0.0 {
            return;
        }
        profile.intervals_within(&self.cubic, radius, window, |(enter, exit), closest| {
            found.push(Contact {
                enter,
                exit,
                closest: self.approach(span, closest),
            });
        });
    }

    /// Returns the closest approach between two instants of a span.
    pub(super) fn closest(&self, span: Span, (from, to): (f64, f64)) -> Approach {
        let profile = DistanceProfile::of(&self.cubic);
        self.approach(span, profile.closest(&self.cubic, from, to))
    }

    /// Returns an attained separation (m) between two instants of a span, rounding included.
    pub(super) fn reaches(&self, span: Span, times: (f64, f64)) -> f64 {
        let closest = self.closest(span, times);
        closest.separation + self.cubic.tolerance() + self.cubic.blur()
    }

    /// Returns the centres' relative motion as input of certified enclosures.
    pub(super) fn uncertain(&self) -> UncertainCubic {
        self.enclosed(&self.cubic)
    }

    /// Returns a part of the relative motion as input of certified enclosures.
    pub(super) fn enclosed(&self, part: &RelativeCubic) -> UncertainCubic {
        if self.path_error > 0.0 {
            UncertainCubic::finite(part.points, (part.error + self.path_error).next_up())
        } else {
            part.uncertain()
        }
    }

    /// Returns true if cheap tests show that the separation stays above `margin`, which may be infinite, in the span.
    pub(super) fn is_beyond(&self, margin: f64) -> bool {
        let rounding = 2.0 * self.cubic.tolerance() + CLEARANCE * self.cubic.size;
        let radius = self.radius(margin) + self.path_error;
        // Below zero no distance is small enough, whatever the rounding.
        radius < 0.0 || certainly_beyond(&self.cubic.points, radius + rounding)
    }
}

/// Returns the difference of squared distances above which one distance exceeds another one by more
/// than `excess`, where that other one is at most `near`.
///
/// With f and n the distances and e the excess, f > n + e follows from f² - n² > e (2 n + e).
pub(super) fn difference_of_squares(near: f64, excess: f64) -> f64 {
    excess * (2.0 * near + excess)
}
