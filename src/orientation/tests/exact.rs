//! Rotations in arithmetic of 200 bits.

use crate::orientation::given::GivenRotation;
use crate::trajectory::Outside;
use dashu::float::FBig;
use dashu::float::round::mode::HalfEven;
use glam::{DQuat, DVec3};

pub(super) type Big = FBig<HalfEven>;

pub(super) fn big(x: f64) -> Big {
    Big::try_from(x).unwrap().with_precision(200).value()
}

/// A quaternion x, y, z, w.
pub(super) type BigQuaternion = [Big; 4];

pub(super) fn product(p: &BigQuaternion, q: &BigQuaternion) -> BigQuaternion {
    let [x, y, z, w] = p;
    let [a, b, c, d] = q;
    [
        w * a + x * d + y * c - z * b,
        w * b - x * c + y * d + z * a,
        w * c + x * b - y * a + z * d,
        w * d - x * a - y * b - z * c,
    ]
}

pub(super) fn dot(p: &BigQuaternion, q: &BigQuaternion) -> Big {
    p.iter()
        .zip(q)
        .map(|(x, y)| x * y)
        .fold(big(0.0), |sum, x| sum + x)
}

pub(super) fn scaled(p: &BigQuaternion, factor: &Big) -> BigQuaternion {
    p.each_ref().map(|x| x * factor)
}

pub(super) fn sum(p: &BigQuaternion, q: &BigQuaternion) -> BigQuaternion {
    [0, 1, 2, 3].map(|lane| &p[lane] + &q[lane])
}

pub(super) fn conjugate([x, y, z, w]: &BigQuaternion) -> BigQuaternion {
    [-x, -y, -z, w.clone()]
}

pub(super) fn unit(q: &BigQuaternion) -> BigQuaternion {
    scaled(q, &(big(1.0) / dot(q, q).sqrt()))
}

pub(super) fn as_given(q: DQuat) -> BigQuaternion {
    unit(&q.to_array().map(big))
}

/// Returns the rotation of a spin after some time.
fn spun(velocity: [Big; 3], time: &Big) -> BigQuaternion {
    let speed = length(&velocity);
    let half = &speed * time / big(2.0);
    about(velocity, &speed, &half)
}

/// Returns the rotation about a vector by an angle in proportion to it.
pub(super) fn about(vector: [Big; 3], length: &Big, half: &Big) -> BigQuaternion {
    if *length == big(0.0) {
        return [0.0, 0.0, 0.0, 1.0].map(big);
    }
    let (sine, cosine) = half.sin_cos();
    let [x, y, z] = vector.map(|lane| lane * &sine / length);
    [x, y, z, cosine]
}

/// Returns the turn of an arc between two unit quaternions: its vector part's direction and length,
/// and half its angle.
pub(super) fn arc(from: &BigQuaternion, to: &BigQuaternion) -> ([Big; 3], Big, Big) {
    let [x, y, z, w] = product(to, &conjugate(from));
    let axis = [x, y, z];
    let length = length(&axis);
    let half = length.atan2(&w);
    (axis, length, half)
}

pub(super) fn knots(knots: &[(f64, DQuat)]) -> Vec<(Big, BigQuaternion)> {
    let mut found: Vec<(Big, BigQuaternion)> = Vec::new();
    for &(time, rotation) in knots {
        let mut rotation = as_given(rotation);
        if let Some((_, before)) = found.last()
            && dot(before, &rotation) < big(0.0)
        {
            rotation = rotation.map(|lane| -lane);
        }
        found.push((big(time), rotation));
    }
    found
}

fn knots_until(knots: &[(Big, BigQuaternion)], time: &Big) -> usize {
    knots.partition_point(|(knot, _)| knot <= time)
}

/// Returns the exact rotation at an instant, not normalised.
pub(super) fn exact(given: &GivenRotation, time: &Big) -> BigQuaternion {
    match given {
        GivenRotation::Fixed => [0.0, 0.0, 0.0, 1.0].map(big),
        GivenRotation::Spin {
            time: at,
            rotation,
            angular_velocity,
        } => {
            let velocity = angular_velocity.to_array().map(big);
            product(&spun(velocity, &(time - big(*at))), &as_given(*rotation))
        }
        GivenRotation::Slerp {
            knots: own,
            outside,
        } => {
            let knots = knots(own);
            let number = knots_until(&knots, time).clamp(1, knots.len() - 1);
            let ((start, from), (end, to)) = (&knots[number - 1], &knots[number]);
            let mut share = (time - start) / (end - start);
            if *outside == Outside::Absent {
                share = share.max(big(0.0)).min(big(1.0));
            }
            let (axis, length, half) = arc(from, to);
            product(&about(axis, &length, &(half * share)), from)
        }
        GivenRotation::NormalizedCubic {
            knots: own,
            outside,
        } => {
            let knots = knots(own);
            let last = knots.len() - 1;
            let after = knots_until(&knots, time);
            let number = after.clamp(1, last);
            let slope = |knot: usize| {
                let (before, after) = (knot.saturating_sub(1), (knot + 1).min(last));
                let way = sum(&knots[after].1, &scaled(&knots[before].1, &big(-1.0)));
                scaled(&way, &(big(1.0) / (&knots[after].0 - &knots[before].0)))
            };
            if after == 0 || after > last {
                let end = if after == 0 { 0 } else { last };
                let (at, rotation) = &knots[end];
                if *outside == Outside::Absent {
                    return rotation.clone();
                }
                let [x, y, z, _] = product(&slope(end), &conjugate(rotation));
                let velocity = [x, y, z].map(|lane| lane * big(2.0));
                return product(&spun(velocity, &(time - at)), rotation);
            }
            let ((start, from), (end, to)) = (&knots[number - 1], &knots[number]);
            let duration = end - start;
            let s = (time - start) / &duration;
            let third = &duration / big(3.0);
            let leave = sum(from, &scaled(&slope(number - 1), &third));
            let arrive = sum(to, &scaled(&slope(number), &-third));
            let points = [from, &leave, &arrive, to].into_iter();
            let terms = points.zip(weights(&s));
            let terms = terms.map(|(point, weight)| scaled(point, &weight));
            terms.reduce(|p, q| sum(&p, &q)).unwrap()
        }
    }
}

/// Returns the point of a body turned by a quaternion of any length.
pub(super) fn turned(q: &BigQuaternion, point: DVec3) -> [Big; 3] {
    let q = unit(q);
    let [x, y, z] = point.to_array().map(big);
    let [x, y, z, _] = product(&product(&q, &[x, y, z, big(0.0)]), &conjugate(&q));
    [x, y, z]
}

/// Returns the weights of a cubic's control points.
fn weights(s: &Big) -> [Big; 4] {
    let r = big(1.0) - s;
    [
        &r * &r * &r,
        big(3.0) * &r * &r * s,
        big(3.0) * &r * s * s,
        s * s * s,
    ]
}

/// Returns the length of a vector.
pub(super) fn length(vector: &[Big; 3]) -> Big {
    let [x, y, z] = vector;
    (x * x + y * y + z * z).sqrt()
}

/// Returns the distance of two points, rounded.
pub(super) fn off(place: &[Big; 3], other: &[Big; 3]) -> f64 {
    let apart = [0, 1, 2].map(|axis| &place[axis] - &other[axis]);
    length(&apart).to_f64().value()
}

/// Returns the point of a cubic.
pub(super) fn on_cubic(points: &[DVec3; 4], s: &Big) -> [Big; 3] {
    let weights = weights(s);
    [0, 1, 2].map(|axis| {
        let lanes = points.iter().zip(&weights);
        lanes
            .map(|(point, weight)| big(point[axis]) * weight)
            .fold(big(0.0), |sum, x| sum + x)
    })
}
