//! Nodes of a distance's profile over a span, and the crossing of a threshold between two of them.

use super::relative::RelativeCubic;
use crate::rounding::{norm, scale_to_one};

/// An instant of a span, and the distance there.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ProfileNode {
    /// Local parameter, 0 at the start of the span and 1 at its end.
    pub(super) s: f64,
    /// Instant, s.
    pub(super) time: f64,
    /// Centre distance, m.
    pub(super) distance: f64,
}

impl ProfileNode {
    /// Returns the node at the start of a span: [`at`](Self::at) 0.
    pub(super) fn first(cubic: &RelativeCubic) -> Self {
        Self {
            s: 0.0,
            time: cubic.start,
            distance: norm(cubic.points[0]),
        }
    }

    /// Returns the node at the end of a span: [`at`](Self::at) 1.
    pub(super) fn last(cubic: &RelativeCubic) -> Self {
        Self {
            s: 1.0,
            time: cubic.end,
            distance: norm(cubic.points[3]),
        }
    }

    /// Returns the node at a local parameter.
    pub(super) fn at(cubic: &RelativeCubic, s: f64) -> Self {
        Self {
            s,
            time: cubic.time(s),
            distance: cubic.distance(s),
        }
    }
}

/// Returns the instant between two nodes at which the distance is `radius`. The distance must be
/// monotonic between them, `inside` within the radius and `outside` beyond it.
///
/// A node that is inside only by rounding touches: it is the crossing itself.
pub(super) fn crossing(
    cubic: &RelativeCubic,
    radius: f64,
    inside: &ProfileNode,
    outside: &ProfileNode,
) -> f64 {
    /// Bisection alone ends after the 1075 binary digits that an f64 resolves near 0; Newton's
    /// method ends after half a dozen steps.
    const MAX_STEPS: usize = 1100;
    /// Smaller steps of the local parameter may be rounding.
    const ROUNDING: f64 = 1e-10;
    if inside.distance >= radius {
        return inside.time;
    }
    let power = scale_to_one(cubic.size.max(radius));
    let radius = radius * power;
    let tolerance = cubic.tolerance() * power;
    let motion = cubic.power_forms();
    let excess = |s: f64| {
        let (position, rate) = motion.at(s);
        let (h, h1) = (position * power, rate * power);
        (h.length_squared() - radius * radius, 2.0 * h.dot(h1))
    };
    let (mut within, mut beyond) = (inside.s, outside.s);
    let mut s = 0.5 * (within + beyond);
    let mut last_step = f64::INFINITY;
    for _ in 0..MAX_STEPS {
        let (value, slope) = excess(s);
        let step = value / slope;
        if value.abs() <= 0.0 {
            break;
        }
        if value < 0.0 {
            within = s;
        } else {
            beyond = s;
        }
        let (low, high) = (within.min(beyond), within.max(beyond));
        let newton = s - step;
        let bracketed = newton > low && newton < high;
        // Tiny steps that no longer shrink, or that leave the bracket, are rounding: the last one
        // is taken, and ends it. (Near a double root steps only halve: there the distance tells.)
        let is_near = value.abs() <= tolerance * (2.0 * radius + tolerance);
        let stays = step.abs() >= 0.5 * last_step || !bracketed;
        if step.abs() <= ROUNDING && stays && is_near {
            s = newton.max(low).min(high);
            break;
        }
        let next = if bracketed {
            last_step = step.abs();
            newton
        } else {
            last_step = f64::INFINITY;
            0.5 * (low + high)
        };
        if next <= low || next >= high {
            break;
        }
        s = next;
    }
    cubic.time(s)
}
