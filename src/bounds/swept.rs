//! Closer bounds of bodies that turn and have long arms.
//!
//! The bounds of a body that turns hold for the ball around its position that its spheres never leave. Here they are brought
//! closer to where the spheres are in a slice, by [turning boxes](TurningBox) in short steps of it.

use super::fat_line::FatLine;
use super::frame::Frame;
use super::{ROUNDING, nearest};
use crate::orientation::SteadyTurn;
use crate::rounding::{earliest_exact, latest_exact, norm};
use crate::shape::BodyShape;
use crate::turning_box::TurningBox;
use glam::DVec3;
use parry3d::bounding_volume::Aabb;

/// Largest number of steps in a slice.
const MOST_STEPS: usize = 4;

/// Bounds of the spheres of a body in a step, relative to its position, m.
struct SweptSpheres {
    low: DVec3,
    high: DVec3,
    /// Centre of a sphere around all of them in the middle of the step, m, and its velocity, m/s.
    centre: DVec3,
    rate: DVec3,
    /// Radius of that sphere in the whole step, m.
    radius: f64,
    middle: f64,
}

impl SweptSpheres {
    fn of(shape: BodyShape<'_>, turn: &SteadyTurn<'_>, (from, to): (f64, f64)) -> Self {
        let hitbox = shape.hitbox();
        let middle = from + 0.5 * (to - from);
        let after = (middle - from).max(to - middle) * (1.0 + 1e-12);
        let (error, bounding) = (shape.model_error(), hitbox.bounding());
        let TurningBox {
            centre,
            rate,
            axes,
            angular_velocity,
            radius,
        } = TurningBox::of(hitbox, error, Some(turn), (middle, after));
        let reach = [axes.x_axis, axes.y_axis, axes.z_axis]
            .map(|axis| axis.abs() + angular_velocity.cross(axis).abs() * after);
        // Far more than all rounding.
        let rounding = 1e-9 * shape.reach();
        let reach = reach.into_iter().sum::<DVec3>() + rate.abs() * after + (radius + rounding);
        // The centre bends, and may be farther from the position than that of any sphere.
        let bend = norm(bounding.offset) * turn.bend(after);
        Self {
            low: centre - reach,
            high: centre + reach,
            centre,
            rate,
            radius: bounding.radius + bend + hitbox.arm() * turn.error + error + rounding,
            middle,
        }
    }
}

/// Brings the bounds of a body in a slice (s) closer, if its spheres are far from most of the ball that bounds them.
pub(crate) fn tighten(
    shape: BodyShape<'_>,
    (from, to): (f64, f64),
    frame: &Frame,
    (line, aabb): (&mut FatLine, &mut Aabb),
) {
    let Some(turning) = shape.turning() else {
        return;
    };
    if line.radius.is_infinite() {
        // The frame does not serve the body: its box has no bounds.
        return;
    }
    // At an instant at which one rotation ends and another one begins both count.
    let (mut begin, end) = (earliest_exact(from).next_down(), latest_exact(to).next_up());
    let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for step in 0..MOST_STEPS {
        let Some(turn) = turning.steady_from(begin, end) else {
            return;
        };
        let until = turn
            .until
            .min(begin + 2.0 * TurningBox::WIDE / turn.speed)
            .min(end);
        let swept = SweptSpheres::of(shape, &turn, (begin, until));
        if !(swept.low.is_finite() && swept.high.is_finite()) {
            return;
        }
        (low, high) = (low.min(swept.low), high.max(swept.high));
        if until >= end {
            bring_closer(shape, (low, high), frame.power, aabb);
            if step == 0 {
                follow(shape, &swept, (from, to), frame.power, line);
            }
            return;
        }
        begin = until;
    }
}

/// Moves the sides of a box from those of the ball to those of `low..=high` (m), if these lie inside.
fn bring_closer(shape: BodyShape<'_>, (low, high): (DVec3, DVec3), power: f64, aabb: &mut Aabb) {
    let (ball_low, ball_high) = shape.corners();
    for axis in 0..3 {
        let lower = nearest((low[axis] - ball_low[axis]) * power);
        if lower > 0.0 {
            let raised = aabb.mins[axis] + lower;
            aabb.mins[axis] = raised - (raised.abs() + lower) * (4.0 * ROUNDING);
        }
        let upper = nearest((ball_high[axis] - high[axis]) * power);
        if upper > 0.0 {
            let lowered = aabb.maxs[axis] - upper;
            aabb.maxs[axis] = lowered + (lowered.abs() + upper) * (4.0 * ROUNDING);
        }
    }
}

/// Lets a fat line go along with the sphere around a body's spheres, if it is closer then.
fn follow(
    shape: BodyShape<'_>,
    swept: &SweptSpheres,
    (from, to): (f64, f64),
    power: f64,
    line: &mut FatLine,
) {
    let closer = nearest((shape.reach() - swept.radius) * power);
    let start = (swept.centre + swept.rate * (from - swept.middle)) * power;
    let change = swept.rate * ((to - from) * power);
    let size = nearest(start.abs().element_sum() + change.abs().element_sum());
    let mut other = *line;
    // Of what is added as of the line itself; then of the sums.
    let mut rounding = 16.0 * size;
    for axis in 0..3 {
        other.start[axis] += nearest(start[axis]);
        other.change[axis] += nearest(change[axis]);
        rounding += 4.0 * (other.start[axis].abs() + other.change[axis].abs());
    }
    other.radius = (line.radius - closer + rounding * ROUNDING) * (1.0 + 8.0 * ROUNDING);
    if other.radius < line.radius {
        *line = other;
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a failure fails the test")]

    use super::*;
    use crate::hitbox::{Hitbox, Sphere};
    use crate::orientation::Orientation;
    use crate::rounding::exact::vector;
    use glam::DQuat;
    use parry3d::math::Vector;
    use rand::rngs::ChaCha8Rng;
    use rand::{RngExt, SeedableRng};

    /// Returns a thin cluster, some aside of the position, some a single sphere.
    fn hitbox(rng: &mut ChaCha8Rng, round: usize) -> Hitbox {
        let aside = [0.0, 1.0, 4.0][round % 3] * vector(rng, 1.0);
        let extents = [DVec3::X, DVec3::new(0.5, 1.0, 0.02)][round / 3 % 2];
        if round.is_multiple_of(11) {
            // The centre of the box around them is farther from the position than all of them.
            let (long, short) = ((2.0_f64 / 3.0).sqrt(), (1.0_f64 / 6.0).sqrt());
            let offsets = [
                [long, short, short],
                [short, long, short],
                [short, short, long],
                [short; 3],
            ];
            return Hitbox::cluster(offsets.map(|offset| Sphere::new(offset, 0.05)).to_vec())
                .unwrap();
        }
        let count = if round.is_multiple_of(7) { 1 } else { 9 };
        let spheres = (0..count).map(|number: usize| Sphere {
            offset: aside + vector(rng, 1.0) * extents,
            radius: [0.05, 0.05, 0.2][number % 3],
        });
        Hitbox::cluster(spheres.collect()).unwrap()
    }

    fn orientation(rng: &mut ChaCha8Rng, round: usize) -> Orientation {
        let mut spin = |speed: f64| {
            let rotation = DQuat::from_scaled_axis(vector(rng, 2.0));
            let velocity = vector(rng, speed);
            let across = DVec3::new(speed, -speed, 0.0) * 0.5;
            let velocity = if round.is_multiple_of(11) {
                across
            } else {
                velocity
            };
            Orientation::spin(0.3, rotation, velocity).unwrap()
        };
        let speed = [0.05, 0.5, 2.0][round / 2 % 3];
        let turn = if round.is_multiple_of(4) {
            let jump = spin(speed);
            spin(speed).spliced(0.5, &jump).unwrap()
        } else {
            spin(speed)
        };
        match [None, Some(1e-8), Some(0.05)][round / 5 % 3] {
            Some(tolerance) => turn.with_tolerance(tolerance).unwrap(),
            None => turn,
        }
    }

    /// All spheres, enlarged by the errors of their centres, are in the bounds at all times; and most bounds are closer.
    #[test]
    fn spheres_are_within_closer_bounds() {
        let mut rng = ChaCha8Rng::seed_from_u64(9);
        let [mut closer, mut followed, mut all] = [0; 3];
        for round in 0..2_000 {
            let (hitbox, turn) = (hitbox(&mut rng, round), orientation(&mut rng, round));
            let model_error = [0.0, 0.1][round % 2];
            let shape = BodyShape::new(&hitbox, turn.turning(), model_error);
            if !shape.has_long_arms() {
                continue;
            }
            all += 1;
            let from = rng.random_range(0.0..0.8);
            let to = from + rng.random_range(0.0..1.0);
            let reach = nearest(shape.reach()).next_up();
            let ball = FatLine {
                start: [0.0; 3],
                change: [0.0; 3],
                radius: reach,
                first: 0,
            };
            let around = Aabb::new(Vector::splat(-reach), Vector::splat(reach));
            let (mut line, mut aabb) = (ball, around);
            tighten(
                shape,
                (from, to),
                &Frame::OF_NOTHING,
                (&mut line, &mut aabb),
            );
            closer += u32::from(aabb.volume() < 0.5 * around.volume());
            followed += u32::from(line.radius < 0.9 * reach);
            let tolerance = turn.tolerance().unwrap_or(1e-3);
            for step in 0..=40 {
                let share = f64::from(step) / 40.0;
                let time = (from + share * (to - from)).min(to);
                let lane = |axis: usize| {
                    f64::from(line.start[axis]) + share * f64::from(line.change[axis])
                };
                let middle = DVec3::new(lane(0), lane(1), lane(2));
                for sphere in hitbox.spheres() {
                    let centre = turn.rotation(time) * sphere.offset;
                    // The cubic is off, and the radius is enlarged.
                    let error = 2.0 * tolerance * sphere.offset.length() + model_error;
                    let radius = sphere.radius + error * (1.0 - 1e-6);
                    assert!(
                        centre.distance(middle) + radius <= f64::from(line.radius),
                        "{round} {time}"
                    );
                    for axis in 0..3 {
                        let (low, high) = (centre[axis] - radius, centre[axis] + radius);
                        assert!(low >= f64::from(aabb.mins[axis]), "{round} {time}");
                        assert!(high <= f64::from(aabb.maxs[axis]), "{round} {time}");
                    }
                }
            }
        }
        assert!(
            2 * closer > all && 4 * followed > all && all > 1_000,
            "{closer} {followed} {all}"
        );
    }
}
