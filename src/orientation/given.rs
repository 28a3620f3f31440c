//! Orientations as they are given, and the checks on them.

use super::arc::{Arc, MAX_SPEED, angle_within};
use super::piece::{RotationCurve, RotationPiece};
use super::quaternion_cubic::QuaternionCubic;
use crate::count::whole;
use crate::error::{Error, Quantity};
use crate::rounding::{norm, without_negative_zero};
use crate::trajectory::{Outside, check_number, check_times};
use glam::{DQuat, DVec3};

/// An orientation as it was given.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) enum GivenRotation {
    Fixed,
    Spin {
        time: f64,
        rotation: DQuat,
        angular_velocity: DVec3,
    },
    Slerp {
        knots: Vec<(f64, DQuat)>,
        outside: Outside,
    },
    NormalizedCubic {
        knots: Vec<(f64, DQuat)>,
        outside: Outside,
    },
}

impl GivenRotation {
    /// Returns true if both are the same motion as given: spins of no angular velocity hold one rotation at any time.
    pub(super) fn is_same_as(&self, other: &Self) -> bool {
        let held = |given: &Self| match *given {
            Self::Spin {
                rotation,
                angular_velocity: DVec3::ZERO,
                ..
            } => Some(rotation),
            _ => None,
        };
        let is_held = held(self).is_some_and(|rotation| held(other) == Some(rotation));
        is_held || self == other
    }

    /// Sets the rule for the time outside the knots, if there are knots.
    pub(super) fn set_outside(&mut self, rule: Outside) {
        match self {
            Self::Fixed | Self::Spin { .. } => {}
            Self::Slerp { outside, .. } | Self::NormalizedCubic { outside, .. } => *outside = rule,
        }
    }

    /// Returns true if there is one piece for all time.
    pub(super) const fn is_one_piece(&self) -> bool {
        matches!(self, Self::Fixed | Self::Spin { .. })
    }

    /// Returns the pieces for all time, in time order, cut for these tolerances.
    pub(super) fn pieces(&self, tolerances: [f64; 2]) -> Result<Vec<RotationPiece>, Error> {
        match self {
            Self::Fixed => Ok(vec![RotationPiece::forever(
                Arc::held(DQuat::IDENTITY),
                tolerances,
            )]),
            Self::Spin {
                time,
                rotation,
                angular_velocity,
            } => {
                let arc = spin_arc(*time, *rotation, *angular_velocity)?;
                Ok(vec![RotationPiece::forever(arc, tolerances)])
            }
            Self::Slerp {
                knots: given,
                outside,
            } => {
                let knots = checked_knots(given)?;
                let arcs = knots.windows(2).map(|ends| {
                    let [(start, from), (end, to)] = [ends[0], ends[1]];
                    Arc::between((start, end), from, to)
                });
                let arcs: Vec<Arc> = arcs.collect();
                let rates = turning_ends(given, [arcs[0], arcs[arcs.len() - 1]]);
                let turn = arcs.iter().zip(knots.windows(2)).map(|(arc, ends)| {
                    let counts =
                        tolerances.map(|share| part_count(arc.angle / angle_within(share)));
                    RotationPiece::between((ends[0].0, ends[1].0), RotationCurve::Arc(*arc), counts)
                });
                let turn = turn.collect();
                Ok(with_ends(turn, &knots, rates, *outside, tolerances))
            }
            Self::NormalizedCubic {
                knots: given,
                outside,
            } => {
                let knots = checked_knots(given)?;
                let cubics = cubics(&knots);
                let turn = cubics.iter().enumerate().map(|(number, cubic)| {
                    let mut counts = [0; 2];
                    for (count, tolerance) in counts.iter_mut().zip(tolerances) {
                        let found = cubic.parts_within(tolerance);
                        *count = found.ok_or(Error::RotationVanishes { knot: number + 1 })?;
                    }
                    Ok(RotationPiece::between(
                        cubic.ends,
                        RotationCurve::Cubic(Box::new(*cubic)),
                        counts,
                    ))
                });
                let turn = turn.collect::<Result<Vec<RotationPiece>, Error>>()?;
                let last = &cubics[cubics.len() - 1];
                let rates = [rate_at_end(&cubics[0], 0), rate_at_end(last, 1)];
                let rates = turning_ends(given, rates);
                Ok(with_ends(turn, &knots, rates, *outside, tolerances))
            }
        }
    }
}

/// Returns the motion of a spin.
pub(super) fn spin_arc(time: f64, rotation: DQuat, angular_velocity: DVec3) -> Result<Arc, Error> {
    check_number(0, Quantity::Time, time)?;
    let rotation = checked(0, rotation)?;
    let velocity = checked_speed(angular_velocity)?;
    Ok(Arc::spin(without_negative_zero(time), rotation, velocity))
}

/// Returns the rate at the first (0) or last (1) knot of a cubic, as a motion from no rotation at 0 s.
fn rate_at_end(cubic: &QuaternionCubic, end: usize) -> Arc {
    let (start, finish) = cubic.ends;
    Arc {
        duration: finish - start,
        drift: 0.0,
        ..Arc::spin(0.0, DQuat::IDENTITY, cubic.end_velocities()[end])
    }
}

/// Returns the rates at the first and last knot, without one where the two rotations given there are one. Others may
/// be equal when they are normalised, and still differ.
fn turning_ends(given: &[(f64, DQuat)], [before, after]: [Arc; 2]) -> [Option<Arc>; 2] {
    let turns = |first: usize| {
        let [one, other] = [given[first].1, given[first + 1].1];
        one != other && one != -other
    };
    [
        turns(0).then_some(before),
        turns(given.len() - 2).then_some(after),
    ]
}

/// Adds what comes before and after the knots: the rotation there is held, or goes on at the rate
/// of the first and last piece, if there is one.
fn with_ends(
    turn: Vec<RotationPiece>,
    knots: &[(f64, DQuat)],
    rates: [Option<Arc>; 2],
    outside: Outside,
    tolerances: [f64; 2],
) -> Vec<RotationPiece> {
    let (first, last) = (knots[0], knots[knots.len() - 1]);
    let end = |(time, rotation): (f64, DQuat), rate: Option<Arc>| {
        let arc = match (outside, rate) {
            (Outside::Extrapolate | Outside::Coast, Some(rate)) => rate.going_on(time, rotation),
            _ => Arc::held(rotation),
        };
        RotationPiece::forever(arc, tolerances)
    };
    let (mut before, mut after) = (end(first, rates[0]), end(last, rates[1]));
    (before.end, after.start) = (first.0, last.0);
    let mut pieces = Vec::with_capacity(turn.len() + 2);
    pieces.push(before);
    pieces.extend(turn);
    pieces.push(after);
    pieces
}

/// Rounds a number of parts up; at least one.
fn part_count(share: f64) -> u32 {
    whole(share.ceil().max(1.0))
}

/// Returns the unit quaternion of a given rotation.
fn checked(knot: usize, rotation: DQuat) -> Result<DQuat, Error> {
    /// Largest difference of a quaternion's length from 1.
    const OFF: f64 = 1e-9;
    check_finite(knot, Quantity::Rotation, &rotation.to_array())?;
    let length = rotation.length();
    // Also of one that overflows.
    if (length - 1.0).abs() <= OFF {
        Ok(rotation * (1.0 / length))
    } else {
        Err(Error::RotationLength { knot, length })
    }
}

/// Checks that the components of a quantity are finite.
fn check_finite(
    knot: usize,
    quantity: fn(usize) -> Quantity,
    components: &[f64],
) -> Result<(), Error> {
    match components.iter().position(|value| !value.is_finite()) {
        None => Ok(()),
        Some(axis) => Err(Error::NotFinite {
            knot,
            quantity: quantity(axis),
            value: components[axis],
        }),
    }
}

fn checked_speed(velocity: DVec3) -> Result<DVec3, Error> {
    check_finite(0, Quantity::AngularVelocity, &velocity.to_array())?;
    let speed = norm(velocity);
    if speed <= MAX_SPEED {
        Ok(velocity)
    } else {
        Err(Error::AngularSpeed { speed })
    }
}

/// Returns unit quaternions of continuous sign.
fn checked_knots(knots: &[(f64, DQuat)]) -> Result<Vec<(f64, DQuat)>, Error> {
    /// Least cosine of half the angle between neighbours: the way to half a turn is not known.
    const LEAST: f64 = 1e-9;
    if knots.len() < 2 {
        return Err(Error::TooFewRotations { count: knots.len() });
    }
    check_times(knots.iter().map(|&(time, _)| time))?;
    let mut found: Vec<(f64, DQuat)> = Vec::with_capacity(knots.len());
    for (knot, &(time, rotation)) in knots.iter().enumerate() {
        let mut rotation = checked(knot, rotation)?;
        let time = without_negative_zero(time);
        if let Some(&(previous, before)) = found.last() {
            if time - previous < f64::MIN_POSITIVE {
                // Its inverse has no number.
                return Err(Error::OutOfRange {
                    knot,
                    quantity: Quantity::AngularSpeed,
                    value: f64::INFINITY,
                });
            }
            let cosine = before.dot(rotation);
            if cosine.abs() <= LEAST {
                return Err(Error::AntipodalRotations { knot });
            }
            if cosine < 0.0 {
                rotation = -rotation;
            }
        }
        found.push((time, rotation));
    }
    Ok(found)
}

/// Returns the cubics through unit quaternions: at a knot the slope is that from the knot before to
/// the knot after.
fn cubics(knots: &[(f64, DQuat)]) -> Vec<QuaternionCubic> {
    let slope = |knot: usize| {
        let (before, after) = (knot.saturating_sub(1), (knot + 1).min(knots.len() - 1));
        (
            knots[after].1 - knots[before].1,
            knots[after].0 - knots[before].0,
        )
    };
    let cubic = |(number, ends): (usize, &[(f64, DQuat)])| {
        let [(start, from), (end, to)] = [ends[0], ends[1]];
        let third = |(way, time): (DQuat, f64)| way * ((end - start) / time / 3.0);
        QuaternionCubic {
            ends: (start, end),
            points: [
                from,
                from + third(slope(number)),
                to - third(slope(number + 1)),
                to,
            ],
        }
    };
    knots.windows(2).enumerate().map(cubic).collect()
}
