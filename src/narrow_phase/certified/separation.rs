//! Enclosures of the least separation of one or several pairs of spheres.

use super::super::relative::RelativeCubic;
use super::super::sphere_pair::{Approach, SpherePair};
use super::super::{BodyView, widened};
use crate::accuracy::TimeEnclosure;
use crate::rounding::two_sum;
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

/// A search for the least separation of two bodies in the world, sphere pair by sphere pair.
#[derive(Debug)]
pub(super) struct LeastSeparationSearch {
    /// The bodies' model error, m.
    error: f64,
    /// Upper bound of the least separation in the world, m.
    reached: f64,
    found: Vec<SeparationEnclosure>,
    /// The spheres of each and their motion, if there is a model error.
    motions: Vec<(SpherePair, RelativeCubic)>,
}

impl LeastSeparationSearch {
    /// Length of a span, in lengths of the part in which the least separation is, from which on that part is looked at by
    /// itself as well: its coordinates are so much smaller that its rounding may be less.
    const LONG: f64 = 4.0;

    pub(super) const fn new(error: f64) -> Self {
        Self {
            error,
            reached: f64::INFINITY,
            found: Vec::new(),
            motions: Vec::new(),
        }
    }

    /// Returns the separation (m) beyond which spheres on splines are certainly not the nearest in
    /// the world.
    pub(super) fn near(&self) -> f64 {
        widened(self.reached, self.error)
    }

    /// Adds two spheres over `start..=end`, within their span.
    pub(super) fn add(
        &mut self,
        views: (&BodyView<'_>, &BodyView<'_>),
        span: Span,
        pair: &SpherePair,
        is_whole: bool,
        times: (f64, f64),
    ) {
        let (mut least, cubic) = least_separation(views, span, pair, is_whole, times);
        if is_whole && span.end - span.start > Self::LONG * (times.1 - times.0) {
            let (part, _) = least_separation(views, span, pair, false, times);
            least = least.intersection(part);
        }
        if self.error > 0.0 {
            least.low = (least.low - self.error).next_down();
            least.high = (least.high + self.error).next_up();
            self.motions.push((*pair, cubic));
        }
        self.reached = self.reached.min(least.high);
        self.found.push(least);
    }

    /// Returns the least of all; `None` if there were none.
    pub(super) fn least(mut self) -> Option<SeparationEnclosure> {
        let near = self.near();
        for (least, (pair, cubic)) in self.found.iter_mut().zip(&self.motions) {
            // The smallest known interval with all instants at which the spheres on splines are near.
            let (enclosed, mut hull) = (pair.enclosed(cubic), None);
            cubic.each_time_within(&enclosed, pair.radius(near).next_up(), |time| {
                hull = Some(hull.map_or(time, |hull: TimeEnclosure| hull.hull(time)));
            });
            least.time = hull.unwrap_or(least.time);
        }
        SeparationEnclosure::of_all(&self.found)
    }
}

/// Encloses the least separation of two spheres on splines over `start..=end`, within their span;
/// returns their motion as well.
fn least_separation(
    (a, b): (&BodyView<'_>, &BodyView<'_>),
    span: Span,
    pair: &SpherePair,
    is_whole: bool,
    (start, end): (f64, f64),
) -> (SeparationEnclosure, RelativeCubic) {
    let cubic = if is_whole {
        pair.cubic
    } else if pair.path_error > 0.0 {
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
    let enclosed = pair.enclosed(&cubic);
    let least = if pair.path_error > 0.0 {
        // The way of a turning centre is no cubic.
        enclosed.least_distance_of_any_motion()
    } else {
        enclosed.least_distance()
    };
    let radii = (pair.radius_a, pair.radius_b);
    let time = TimeEnclosure {
        earliest: cubic.earliest(least.parameter.first),
        latest: cubic.latest(least.parameter.last),
    };
    let least = SeparationEnclosure {
        low: minus_radii(least.distance.low, radii, f64::next_down),
        high: minus_radii(least.distance.high, radii, f64::next_up),
        time,
        span,
        spheres: (pair.a, pair.b),
        own: time,
    };
    (least, cubic)
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
    fn of_all(found: &[Self]) -> Option<Self> {
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

    /// Returns what two enclosures of one least separation leave.
    fn intersection(self, other: Self) -> Self {
        let TimeEnclosure { earliest, latest } = other.time;
        Self {
            low: self.low.max(other.low),
            high: self.high.min(other.high),
            ..self.within(earliest, latest)
        }
    }

    /// Returns the enclosure with instants between two alone, between which the least is attained.
    pub(super) fn within(self, start: f64, end: f64) -> Self {
        Self {
            time: self.time.within(start, end),
            own: self.own.within(start, end),
            ..self
        }
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
