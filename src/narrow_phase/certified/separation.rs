//! Enclosures of the least separation of one or several pairs of spheres.

use super::super::relative::RelativeCubic;
use super::super::sphere_pair::{Approach, SpherePair};
use super::super::{BodyView, two_sum};
use crate::accuracy::TimeEnclosure;
use crate::spans::Span;

/// An interval `low..=high` (m) that contains the least separation, attained within `time` only.
#[derive(Clone, Copy, Debug)]
pub(super) struct SeparationEnclosure {
    pub(super) low: f64,
    pub(super) high: f64,
    pub(super) time: TimeEnclosure,
    /// A pair of spheres that comes within `high`: its span, spheres and instants (`own`).
    pub(super) span: Span,
    pub(super) spheres: (u32, u32),
    pub(super) own: TimeEnclosure,
}

/// Encloses the least separation of two spheres over `start..=end`, within their span.
pub(super) fn least_separation(
    (a, b): (&BodyView<'_>, &BodyView<'_>),
    span: Span,
    pair: &SpherePair,
    is_whole: bool,
    (start, end): (f64, f64),
) -> SeparationEnclosure {
    let cubic = if is_whole {
        pair.cubic
    } else if pair.baking > 0.0 {
        pair.cubic.part((start, end))
    } else {
        let [segment_a, segment_b] = &a.segments_in(b, span);
        RelativeCubic::between(
            segment_a,
            segment_b,
            (start, end),
            a.spheres[pair.a as usize].offset - b.spheres[pair.b as usize].offset,
        )
    };
    let least = pair.enclosed(&cubic).least_distance();
    let radii = (pair.radius_a, pair.radius_b);
    let time = TimeEnclosure {
        earliest: cubic.earliest(least.parameter.first),
        latest: cubic.latest(least.parameter.last),
    };
    SeparationEnclosure {
        low: minus_radii(least.distance.low, radii, f64::next_down),
        high: minus_radii(least.distance.high, radii, f64::next_up),
        time,
        span,
        spheres: (pair.a, pair.b),
        own: time,
    }
}

/// Returns a distance minus two radii, rounded outward.
pub(super) fn minus_radii(distance: f64, (a, b): (f64, f64), outward: fn(f64) -> f64) -> f64 {
    let (radii, lost) = two_sum(a, b);
    let (separation, rest) = two_sum(distance, -radii);
    let exact = rest.abs() <= 0.0 && lost.abs() <= 0.0;
    if exact {
        separation
    } else {
        outward(separation + (rest - lost))
    }
}

impl SeparationEnclosure {
    /// Returns the least of several. Its time is the hull of all that can be the least.
    pub(super) fn of_all(found: &[Self]) -> Option<Self> {
        let low = found.iter().map(|least| least.low).reduce(f64::min)?;
        let lowest = found.iter().min_by(|x, y| x.high.total_cmp(&y.high))?;
        let high = lowest.high;
        let possible = found.iter().filter(|least| least.low <= high);
        let time = possible
            .map(|least| least.time)
            .reduce(TimeEnclosure::hull)?;
        Some(Self {
            low,
            time,
            ..*lowest
        })
    }

    /// Returns an approach moved into the enclosure, and the half-width around its separation.
    pub(super) fn settle(&self, mut approach: Approach) -> (Approach, f64) {
        let (time, span) = (self.time.nearest(approach.time), approach.span);
        if span.start <= time && time <= span.end {
            approach.time = time;
        } else {
            // It was another cubic's.
            let time = self.own.nearest(time);
            approach = Approach::at(time, approach.separation, self.spheres, self.span);
        }
        approach.separation = approach.separation.max(self.low).min(self.high);
        let (below, above) = (
            approach.separation - self.low,
            self.high - approach.separation,
        );
        let error = below.max(above);
        (approach, if error > 0.0 { error.next_up() } else { 0.0 })
    }
}
