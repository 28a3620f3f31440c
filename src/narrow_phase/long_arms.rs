//! A test of bodies that turn and are thin or lie aside of their position: the ball that bounds such a body is mostly empty.
//!
//! Two bodies are apart in a short step of time if their [turning boxes](TurningBox) are so along one direction: that between
//! the nearest points of the boxes' longest axes, in the middle of the step.

use super::BodyView;
use super::relative::rejection_threshold;
use crate::blossom::restrict_to;
use crate::orientation::SteadyTurn;
use crate::rounding::{earliest_exact, latest_exact, norm};
use crate::turning_box::TurningBox;
use glam::{DMat3, DVec3};

/// Largest number of steps that are examined.
const MOST_STEPS: u32 = 12;
/// Largest angle in an interval, rad.
const MOST_ANGLE: f64 = 6.0;
/// Angle of a step from its middle on, of which halves tell little more, rad.
const NARROW: f64 = 0.12;

/// A step of time, s.
#[derive(Clone, Copy)]
struct Step {
    middle: f64,
    /// Bound on the distance of all instants from the middle, s.
    after: f64,
}

impl Step {
    fn between(from: f64, to: f64) -> Self {
        let middle = from + 0.5 * (to - from);
        let after = (middle - earliest_exact(from)).max(latest_exact(to) - middle);
        Self {
            middle,
            after: after * (1.0 + 1e-12),
        }
    }
}

/// Returns the box of a body; around the sphere that stands in for its hitbox, if there is one.
#[inline(always)]
fn box_of(view: &BodyView<'_>, turn: Option<&SteadyTurn<'_>>, step: Step) -> TurningBox {
    let Some(hitbox) = view.hitbox else {
        return TurningBox::resting((view.bounding.offset, DVec3::ZERO), view.bounding.radius);
    };
    TurningBox::of(hitbox, view.model_error, turn, (step.middle, step.after))
}

impl TurningBox {
    /// Returns the ends of the longest axis from the centre on.
    fn longest(&self) -> DVec3 {
        let DMat3 {
            x_axis,
            y_axis,
            z_axis,
        } = self.axes;
        let longer = |one: DVec3, other: DVec3| {
            if other.length_squared() > one.length_squared() {
                other
            } else {
                one
            }
        };
        longer(longer(x_axis, y_axis), z_axis)
    }

    /// Returns how far the box reaches along a direction from its centre, at some times from the middle of the step on (s).
    fn reaches(&self, direction: DVec3, times: [f64; 4]) -> [f64; 4] {
        let along = self.axes.transpose() * direction;
        let change = self.axes.transpose() * direction.cross(self.angular_velocity);
        times.map(|time| (along + change * time).abs().element_sum())
    }
}

/// Returns true if bodies certainly stay farther apart than a margin (m) in an interval (s). `points` are the control
/// points of their relative position, and `scale` is the magnitude to which all rounding is relative, m.
pub(super) fn are_apart(
    views: [&BodyView<'_>; 2],
    (points, ends): (&[DVec3; 4], (f64, f64)),
    (margin, scale): (f64, f64),
) -> bool {
    if !(ends.1 - ends.0).is_finite() {
        return false;
    }
    let (mut from, mut longest) = (ends.0, f64::INFINITY);
    // A rotation that ends with another one's beginning counts at that instant as well, and so does the other one.
    let mut begin = earliest_exact(ends.0).next_down();
    let end = latest_exact(ends.1).next_up();
    for _ in 0..MOST_STEPS {
        let mut to = ends.1.min(from + longest);
        let until = if to < ends.1 { latest_exact(to) } else { end };
        let mut turns = [None; 2];
        let (mut fastest, mut known_until) = (0.0_f64, end);
        for (turn, view) in turns.iter_mut().zip(views) {
            if let Some(turning) = view.turning {
                let Some(steady) = turning.steady_from(begin, until) else {
                    return false;
                };
                fastest = fastest.max(steady.speed);
                known_until = known_until.min(steady.until);
                to = to.min(steady.until.max(from));
                *turn = Some(steady);
            }
        }
        if fastest * (to - from) > MOST_ANGLE {
            return false;
        }
        to = to.min(from + 2.0 * TurningBox::WIDE / fastest);
        let step = Step::between(from, to);
        let boxes = [
            box_of(views[0], turns[0].as_ref(), step),
            box_of(views[1], turns[1].as_ref(), step),
        ];
        let points = if (from, to) == ends {
            *points
        } else if ends.0 < ends.1 {
            restrict_to(points, ends, (from, to))
        } else {
            [points[0]; 4]
        };
        let times = [from - step.middle, to - step.middle];
        if are_apart_along(&boxes, &points, times, (margin, scale)) {
            if to >= ends.1 && known_until >= end {
                return true;
            }
            // A rotation may end in what rounds to the end.
            begin = if to < ends.1 { to } else { known_until };
            from = to;
        } else if fastest * step.after > NARROW {
            longest = 0.5 * (to - from);
        } else {
            return false;
        }
    }
    false
}

/// Returns true if two boxes stay farther apart than a margin (m) along a direction.
fn are_apart_along(
    [a, b]: &[TurningBox; 2],
    points: &[DVec3; 4],
    [first, last]: [f64; 2],
    (margin, scale): (f64, f64),
) -> bool {
    let [p0, p1, p2, p3] = *points;
    let middle = ((p0 + p3) + 3.0 * (p1 + p2)) * 0.125;
    let apart = between_segments(middle + (a.centre - b.centre), a.longest(), b.longest());
    let length = norm(apart);
    let radius = (a.radius + b.radius) + margin;
    let threshold = rejection_threshold(radius, scale + radius.abs());
    if length <= threshold.max(f64::MIN_POSITIVE) {
        return false;
    }
    let direction = apart / length;
    let times = [
        first,
        (2.0 * first + last) / 3.0,
        (first + 2.0 * last) / 3.0,
        last,
    ];
    let (reach_a, reach_b) = (a.reaches(direction, times), b.reaches(direction, times));
    let centre = (a.centre - b.centre).dot(direction);
    let rate = (a.rate - b.rate).dot(direction);
    (0..4).all(|k| {
        let height = points[k].dot(direction) + (centre + rate * times[k]);
        height - (reach_a[k] + reach_b[k]) > threshold
    })
}

/// Returns the vector between the nearest points of two segments, from b's to a's. `apart` is that from the middle of b's
/// to that of a's, and the others are vectors from the middle to an end.
fn between_segments(apart: DVec3, a: DVec3, b: DVec3) -> DVec3 {
    let (aa, bb, ab) = (a.length_squared(), b.length_squared(), a.dot(b));
    let (da, db) = (apart.dot(a), apart.dot(b));
    // The least of |apart + x a - y b|² in -1..=1.
    let share = |value: f64, square: f64| {
        if square > 0.0 {
            (value / square).clamp(-1.0, 1.0)
        } else {
            0.0
        }
    };
    let room = aa * bb - ab * ab;
    let x = share(
        ab * db - da * bb,
        if room > 1e-12 * aa * bb { room } else { 0.0 },
    );
    let y = share(db + x * ab, bb);
    let x = share(y * ab - da, aa);
    apart + x * a - y * b
}

#[cfg(test)]
mod tests;
