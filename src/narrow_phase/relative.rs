//! The motion of one body relative to another over a span: differences first, then local.

use crate::accuracy::TimeEnclosure;
use crate::enclosure::{Stretch, Threshold, UncertainCubic, Verdict, part};
use crate::rounding::{CLEARANCE, UNDERFLOW, UNIT_ROUNDOFF, largest_norm, latest_exact, norm};
use crate::trajectory::Segment;
use glam::DVec3;

/// A relative position over `start..end` as a cubic in the local parameter s in 0..=1.
///
/// The control points are differences of local quantities; neither absolute time nor absolute
/// position enters their error.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RelativeCubic {
    pub(crate) start: f64,
    pub(crate) end: f64,
    /// Bézier control points of (position of a) - (position of b), m.
    pub(crate) points: [DVec3; 4],
    /// Bound on |computed - exact| at every instant of the span, for exact evaluation, m.
    pub(crate) error: f64,
    /// Largest norm of a control point, m.
    pub(crate) size: f64,
}

impl RelativeCubic {
    /// Returns the difference of two cubics over an interval, plus `offset` (a's sphere centre
    /// minus b's, in their bodies' frames, m).
    pub(crate) fn between(a: &Segment, b: &Segment, interval: (f64, f64), offset: DVec3) -> Self {
        RelativeMotion::between(a, b, interval).of_spheres(offset)
    }

    /// Returns a bound on the error of the relative position computed at any s, m. Evaluation is
    /// included: 48 roundings of the size (power coefficients 18, Horner 21, norm 3, rest spare).
    /// Distances within this of a threshold count as contact.
    pub(crate) fn tolerance(&self) -> f64 {
        self.error + 48.0 * UNIT_ROUNDOFF * self.size
    }

    /// Returns a bound on the motion between an instant and its rounded value, m; or infinity.
    pub(super) fn blur(&self) -> f64 {
        blur(&self.points, (self.start, self.end))
    }

    /// Returns true if the relative motion is zero, as far as its rounding can tell.
    pub(crate) fn is_constant(&self) -> bool {
        let [p0, p1, p2, p3] = self.points;
        let tolerance = self.tolerance();
        // Most motions are not, by far: a coordinate tells, and no root is needed.
        if (p3 - p0).abs().max_element() > 2.0 * tolerance {
            return false;
        }
        largest_norm(&[p1 - p0, p2 - p0, p3 - p0]) <= tolerance
    }

    /// Returns relative position and its derivative by s (m), formed from the nearer end so that
    /// constant motion stays exactly constant.
    #[inline(always)]
    pub(crate) fn at(&self, s: f64) -> (DVec3, DVec3) {
        self.power_forms().at(s)
    }

    /// Returns the power forms of both ends, which evaluate [`at`](Self::at) for many s.
    #[inline(always)]
    pub(crate) fn power_forms(&self) -> PowerForms {
        let [p0, p1, p2, p3] = self.points;
        PowerForms {
            forth: power_form(p0, p1, p2, p3),
            back: power_form(p3, p2, p1, p0),
        }
    }

    /// Returns the second derivative by s, m.
    pub(crate) fn curvature(&self, s: f64) -> DVec3 {
        let [p0, p1, p2, p3] = self.points;
        6.0 * ((1.0 - s) * ((p2 - p1) - (p1 - p0)) + s * ((p3 - p2) - (p2 - p1)))
    }

    /// Returns the centre distance at s, m.
    pub(crate) fn distance(&self, s: f64) -> f64 {
        norm(self.at(s).0)
    }

    /// Returns the instant of a local parameter; exact at the span's ends.
    pub(crate) fn time(&self, s: f64) -> f64 {
        let time = if s <= 0.5 {
            self.start + s * (self.end - self.start)
        } else {
            self.end - (1.0 - s) * (self.end - self.start)
        };
        time.clamp(self.start, self.end)
    }

    /// Returns the cubic as input of certified enclosures.
    pub(crate) fn uncertain(&self) -> UncertainCubic {
        UncertainCubic::finite(self.points, self.error)
    }

    /// Returns an instant not after the exact one of a local parameter; exact at the span's ends.
    pub(crate) fn earliest(&self, s: f64) -> f64 {
        self.enclosed_time(s, f64::next_down, -1.0)
    }

    /// Returns an instant not before the exact one of a local parameter; exact at the span's ends.
    pub(crate) fn latest(&self, s: f64) -> f64 {
        self.enclosed_time(s, f64::next_up, 1.0)
    }

    /// Returns the instant counted from the nearer end, rounded outward. The summand has three
    /// roundings (difference, product, and the correction's own; 1 - s has none above 1/2), the sum
    /// one.
    fn enclosed_time(&self, s: f64, outward: fn(f64) -> f64, direction: f64) -> f64 {
        if s <= 0.0 {
            return self.start;
        }
        if s >= 1.0 {
            return self.end;
        }
        let duration = self.end - self.start;
        let stretched = |step: f64, direction: f64| step * (1.0 + 4.0 * UNIT_ROUNDOFF * direction);
        let time = if s <= 0.5 {
            self.start + stretched(s * duration, direction)
        } else {
            self.end - stretched((1.0 - s) * duration, -direction)
        };
        outward(time).clamp(self.start, self.end)
    }

    /// Calls `visit` with each interval in which the motion may be within a distance (m), in order of time. `enclosed` is the
    /// motion with its errors.
    pub(super) fn each_time_within(
        &self,
        enclosed: &UncertainCubic,
        distance: f64,
        mut visit: impl FnMut(TimeEnclosure),
    ) {
        let stretches = enclosed.stretches(Threshold {
            low: distance,
            high: distance,
        });
        for &Stretch { first, last, side } in stretches.as_slice() {
            if side != Verdict::Outside {
                visit(TimeEnclosure {
                    earliest: self.earliest(first),
                    latest: self.latest(last),
                });
            }
        }
    }

    /// Returns the part between two instants of the span (s).
    pub(crate) fn part(&self, (start, end): (f64, f64)) -> Self {
        let points = part(&self.points, self.parameter(start), self.parameter(end));
        Self {
            start,
            end,
            points,
            // 9 roundings of the size; three of each parameter, which the motion multiplies by 6
            // at most; and those of second order.
            error: (self.error + 32.0 * UNIT_ROUNDOFF * self.size) * (1.0 + 2f64.powi(-40)),
            size: largest_norm(&points),
        }
    }

    /// Returns the local parameter of an instant of the span.
    pub(crate) fn parameter(&self, time: f64) -> f64 {
        let duration = self.end - self.start;
        if duration > 0.0 {
            ((time - self.start) / duration).clamp(0.0, 1.0)
        } else {
            0.0
        }
    }
}

/// Returns the bound of [`RelativeCubic::blur`].
fn blur(&[p0, p1, p2, p3]: &[DVec3; 4], (start, end): (f64, f64)) -> f64 {
    let speed = 3.0 * largest_norm(&[p1 - p0, p2 - p1, p3 - p2]) / (end - start);
    let latest = start.abs().max(end.abs());
    let blur = speed * (latest_exact(latest) - latest);
    if blur.is_nan() { f64::INFINITY } else { blur }
}

/// A relative cubic in powers of the distance from its nearer end.
pub(crate) struct PowerForms {
    forth: [DVec3; 4],
    back: [DVec3; 4],
}

impl PowerForms {
    /// Returns relative position and its derivative by s (m), as [`RelativeCubic::at`] does.
    #[inline(always)]
    pub(crate) fn at(&self, s: f64) -> (DVec3, DVec3) {
        if s <= 0.5 {
            value_and_rate(&self.forth, s)
        } else {
            let (position, rate) = value_and_rate(&self.back, 1.0 - s);
            (position, -rate)
        }
    }
}

/// Returns the coefficients of powers of the distance from one end, by control points from there on.
#[inline(always)]
fn power_form(p0: DVec3, p1: DVec3, p2: DVec3, p3: DVec3) -> [DVec3; 4] {
    [
        p0,
        3.0 * (p1 - p0),
        3.0 * ((p2 - p1) - (p1 - p0)),
        (p3 - p0) - 3.0 * (p2 - p1),
    ]
}

/// Returns value and derivative of a power form.
#[inline(always)]
fn value_and_rate(&[c0, c1, c2, c3]: &[DVec3; 4], s: f64) -> (DVec3, DVec3) {
    (
        c0 + s * (c1 + s * (c2 + s * c3)),
        c1 + s * (2.0 * c2 + s * (3.0 * c3)),
    )
}

/// The motion of one body relative to another over a span, common to all pairs of their spheres.
#[derive(Clone, Copy, Debug)]
pub(super) struct RelativeMotion {
    start: f64,
    end: f64,
    /// Difference of the cubics' origins, m.
    apart: DVec3,
    /// Differences of the control points, m.
    local: [DVec3; 4],
    /// Error of both cubics' control points, m.
    error: f64,
}

impl RelativeMotion {
    #[inline]
    pub(super) fn between(a: &Segment, b: &Segment, (start, end): (f64, f64)) -> Self {
        let part_a = a.restrict(start, end);
        let part_b = b.restrict(start, end);
        Self {
            start,
            end,
            apart: a.origin() - b.origin(),
            local: [0, 1, 2, 3].map(|j| part_a.points[j] - part_b.points[j]),
            error: part_a.error + part_b.error,
        }
    }

    /// Returns the relative control points of two spheres' centres; `offset` is a's centre minus
    /// b's in their bodies' frames, m.
    #[inline]
    pub(super) fn points(&self, offset: DVec3) -> [DVec3; 4] {
        let apart = self.apart + offset;
        self.local.map(|local| apart + local)
    }

    /// Returns the bound of [`RelativeCubic::blur`].
    pub(super) fn blur(&self) -> f64 {
        blur(&self.local, (self.start, self.end))
    }

    /// Returns the relative cubic of two spheres' centres, with its error; `offset` as in
    /// [`points`](Self::points).
    pub(super) fn of_spheres(&self, offset: DVec3) -> RelativeCubic {
        // The centre of a lone sphere is its body's position.
        let aside = if offset == DVec3::ZERO {
            0.0
        } else {
            norm(offset)
        };
        // One rounding each of the origins' difference, of the offset's (and the sum with it), of
        // the local difference and of the last sum. Second-order terms are covered by the 2^-40. Sums do
        // not underflow, and what does in the bound is in both parts' errors.
        let spread = largest_norm(&self.local);
        let apart = norm(self.apart + offset);
        self.cubic(self.points(offset), 2.0 * apart + 2.0 * aside + spread)
    }

    /// Returns the relative cubic of two points of the bodies, with its error. `offsets` are the
    /// control points of a's point minus those of b's, each relative to its body's position, m. Their own
    /// error is not included.
    pub(super) fn along(&self, offsets: &[DVec3; 4]) -> RelativeCubic {
        let points = [0, 1, 2, 3].map(|k| (self.apart + self.local[k]) + offsets[k]);
        let spread = largest_norm(&self.local);
        // As `of_spheres`; the sum of apart and local is rounded as well.
        let sizes = 2.0 * norm(self.apart) + 2.0 * spread + 2.0 * largest_norm(offsets);
        self.cubic(points, sizes)
    }

    /// Returns a relative cubic with its error: a rounding of `sizes` (m), and one of its own size.
    #[inline(always)]
    fn cubic(&self, points: [DVec3; 4], sizes: f64) -> RelativeCubic {
        let size = largest_norm(&points);
        let error = (self.error + UNIT_ROUNDOFF * (sizes + size)) * (1.0 + 2f64.powi(-40));
        RelativeCubic {
            start: self.start,
            end: self.end,
            points,
            error,
            size,
        }
    }
}

/// Heights of one body's position above a plane that moves with the other, over a span: the control
/// points of a cubic.
#[derive(Clone, Copy, Debug)]
pub(super) struct HeightCubic {
    pub(super) points: [f64; 4],
    /// Bound on |computed - exact|, m.
    pub(super) error: f64,
}

impl RelativeMotion {
    /// Returns the heights of body a above a plane through body b, along `normal`, a vector whose
    /// length is 1 within 1e-9. `inverse_length` is the inverse of that length, good to 4 roundings.
    pub(super) fn heights(&self, normal: DVec3, inverse_length: f64) -> HeightCubic {
        let apart = self.apart.dot(normal);
        let points = self
            .local
            .map(|local| (apart + local.dot(normal)) * inverse_length);
        // Only what lies along the normal counts: of a plane along two axes, one coordinate.
        let size = |vector: DVec3| vector.abs().dot(normal.abs());
        let largest = self.local.into_iter().map(size).fold(0.0, f64::max);
        // One rounding of each difference, three of each product with the normal, one of the sum;
        // five of the inverse_length and of the product with it.
        let rounding = 16.0 * UNIT_ROUNDOFF * (size(self.apart) + largest) + 8.0 * UNDERFLOW;
        HeightCubic {
            points,
            error: (self.error + rounding) * (1.0 + 1e-8),
        }
    }
}

/// Returns a bound on the size to which all rounding of a pair over a span is relative: origin
/// difference, extents of both cubics over it, offsets (m).
pub(crate) fn local_scale(
    a: &Segment,
    b: &Segment,
    (start, end): (f64, f64),
    offset: DVec3,
) -> f64 {
    (a.origin() - b.origin()).abs().element_sum()
        + offset.abs().element_sum()
        + a.rounding_scale(start, end)
        + b.rounding_scale(start, end)
}

/// Returns the distance below which a test must not reject a pair, for the threshold `radius` (m).
pub(crate) fn rejection_threshold(radius: f64, scale: f64) -> f64 {
    // Twice the solver's tolerance, in which each body has one.
    radius + CLEARANCE * scale + 8.0 * UNDERFLOW
}

#[cfg(test)]
mod tests;
