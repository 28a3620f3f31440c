//! Cubics of turning points, against rotations in arithmetic of 200 bits.

#![allow(clippy::unwrap_used, reason = "a failure fails the test")]

mod exact;
mod terms;

use super::Orientation;
use super::given::GivenRotation;
use super::turning::{Turning, TurningSection};
use crate::accuracy::Accuracy;
use crate::error::{Error, Quantity};
use crate::rounding::exact::vector;
use crate::trajectory::Outside;
use exact::*;
use glam::{DQuat, DVec3};
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};
use std::f64::consts::{PI, TAU};

fn rotation(rng: &mut ChaCha8Rng) -> DQuat {
    let any = [0; 4].map(|_| rng.random_range(-1.0..1.0));
    DQuat::from_array(any).normalize() * (1.0 + rng.random_range(-9e-10..9e-10))
}

/// Returns an orientation of some kind, and a time around which to look at it (s).
fn orientation(rng: &mut ChaCha8Rng, kind: usize) -> (GivenRotation, f64, f64) {
    let time = [0.0, 1.7e9][kind / 3 % 2];
    if kind.is_multiple_of(3) {
        let speed = 10f64.powf(rng.random_range(-9.0..5.0));
        let from = time - rng.random_range(-1.0..1.0) * 10f64.powf(rng.random_range(-3.0..4.0));
        let given = GivenRotation::Spin {
            time: from,
            rotation: rotation(rng),
            angular_velocity: vector(rng, speed),
        };
        return (given, time, 10.0 / speed);
    }
    let length = if time > 0.0 {
        10.0
    } else {
        10f64.powf(rng.random_range(-6.0..6.0))
    };
    let near = [1.0, 1e-3, 1e-9][kind / 6 % 3];
    let first = rotation(rng);
    let mut at = time;
    let knots = (0..rng.random_range(2..6)).map(|_| {
        at += length * rng.random_range(0.05..1.0);
        let turn = DQuat::from_scaled_axis(vector(rng, 1.7 * near));
        let sign = if rng.random_bool(0.5) { 1.0 } else { -1.0 };
        (at, (turn * first).normalize() * sign)
    });
    let knots: Vec<(f64, DQuat)> = knots.collect();
    let outside = [Outside::Absent, Outside::Coast][kind / 18 % 2];
    let given = if kind % 3 == 1 {
        GivenRotation::Slerp { knots, outside }
    } else {
        GivenRotation::NormalizedCubic { knots, outside }
    };
    (given, time, 4.0 * length)
}

/// Points of turning bodies stay within the error of their cubics, of whole sections and of parts, and
/// the rotation at an instant is that of the definition.
#[test]
fn cubics_stay_within_their_error() {
    let mut rng = ChaCha8Rng::seed_from_u64(3);
    let rng = &mut rng;
    let (mut closest, mut unknown, mut count) = (0.0_f64, 0, 0);
    for kind in 0..720 {
        let (given, around, reach) = orientation(rng, kind);
        let turning = match Orientation::of(given.clone()) {
            Ok(orientation) => orientation,
            Err(Error::AntipodalRotations { .. } | Error::RotationVanishes { .. }) => continue,
            Err(error) => unreachable!("{error}"),
        };
        let accuracy = [Accuracy::Exact, Accuracy::Certified][kind % 2];
        let orientation = turning;
        let Some(turning) = orientation.turning() else {
            continue;
        };
        let time = around + reach * rng.random_range(-0.3..1.3);
        let section: TurningSection = turning.section_at(time, accuracy);
        assert!(
            section.start <= time && time < section.end,
            "{section:?} {time}"
        );
        let baked = turning.bake(&section, accuracy);
        let (mut start, mut end) = (
            section.start.max(time - reach),
            section.end.min(time + reach).max(time.next_up()),
        );
        let mut part = baked;
        if kind % 5 == 0 || section.start < start || section.end > end {
            start += rng.random_range(0.0..1.0) * (time - start);
            end -= rng.random_range(0.0..1.0) * (end - time);
            part = baked.part((start, end));
        }
        if part.error() >= 1.0 {
            unknown += 1;
        }
        let far = 10f64.powf(rng.random_range(-3.0..3.0));
        let point = vector(rng, far);
        let (points, error) = (part.way(point), part.error_of(point));
        for step in 0..=4 {
            let s = big(f64::from(step) / 4.0);
            let time = big(start) + &s * (big(end) - big(start));
            let off = off(
                &turned(&exact(&given, &time), point),
                &on_cubic(&points, &s),
            );
            assert!(off <= error, "{kind}: {off} {error} {given:?} {section:?}");
            closest = closest.max(off / error);
            count += 1;
        }
        let here = exact(&given, &big(time));
        let there = orientation.rotation(time) * point;
        let place = turned(&here, point).map(|lane| lane.to_f64().value());
        let off = (DVec3::from_array(place) - there).length();
        if part.error() < 1.0 {
            assert!(off <= 1e-5 * point.length(), "{kind}: {off} {given:?}");
        }
    }
    assert!(closest > 0.9 && closest <= 1.0, "{closest}");
    assert!(unknown < 40 && count > 3_000, "{unknown} {count}");
}

/// The sections between two instants.
fn sections(
    orientation: &Orientation,
    (from, to): (f64, f64),
    accuracy: Accuracy,
) -> Vec<TurningSection> {
    let turning = orientation.turning().unwrap();
    let mut found = vec![turning.section_at(from, accuracy)];
    while found[found.len() - 1].end < to {
        let next = turning.section_at(found[found.len() - 1].end, accuracy);
        assert!(next.start <= found[found.len() - 1].end && next.end > next.start);
        found.push(next);
    }
    found
}

#[test]
fn cubics_per_revolution() {
    let spin = |tolerance: f64| {
        let spin = Orientation::spin(0.0, DQuat::IDENTITY, TAU * DVec3::Z).unwrap();
        spin.with_tolerance(tolerance).unwrap()
    };
    for (tolerance, count) in [(1e-2, 5), (1e-3, 8), (1e-4, 15), (1e-6, 45)] {
        let found = sections(&spin(tolerance), (0.0, 1.0 - 1e-9), Accuracy::Exact);
        assert_eq!(found.len(), count);
    }
    let spin = Orientation::spin(0.3, DQuat::IDENTITY, TAU * DVec3::Z).unwrap();
    for (accuracy, count) in [(Accuracy::Exact, 8), (Accuracy::Certified, 45)] {
        assert_eq!(sections(&spin, (0.3, 1.3 - 1e-9), accuracy).len(), count);
    }
    // A revolution in thirds.
    let third = |number: f64| (number, DQuat::from_rotation_z(number * TAU / 3.0));
    let slerp = Orientation::slerp(&[0.0, 1.0, 2.0, 3.0].map(third)).unwrap();
    assert!(sections(&slerp, (0.0, 3.0 - 1e-9), Accuracy::Exact).len() <= 9);
    let half = |number: f64| (number, DQuat::from_rotation_z(number * PI * (1.0 - 1e-6)));
    let slerp = Orientation::slerp(&[0.0, 1.0, 2.0].map(half)).unwrap();
    assert_eq!(
        sections(&slerp, (0.0, 2.0 - 1e-9), Accuracy::Exact).len(),
        8
    );
}

/// Most bodies that turn at the same rate, to rounding, are cut at the same instants.
#[test]
fn rates_that_differ_by_rounding_have_the_same_cuts() {
    let mut rng = ChaCha8Rng::seed_from_u64(12);
    for accuracy in [Accuracy::Exact, Accuracy::Certified] {
        let ends = (0..100).map(|_| {
            let axis = vector(&mut rng, 1.0).normalize();
            let spin = Orientation::spin(0.0, rotation(&mut rng), axis * TAU).unwrap();
            let sections = sections(&spin, (0.0, 3.0), accuracy);
            sections
                .iter()
                .map(|section| section.end.to_bits())
                .collect::<Vec<u64>>()
        });
        let mut ends: Vec<Vec<u64>> = ends.collect();
        ends.sort();
        ends.dedup();
        assert_eq!(ends.len(), 1, "{accuracy:?}");
    }
}

#[test]
fn cuts_do_not_depend_on_where_the_walk_begins() {
    let mut rng = ChaCha8Rng::seed_from_u64(5);
    for kind in 0..60 {
        let (given, around, reach) = orientation(&mut rng, kind);
        let Ok(orientation) = Orientation::of(given) else {
            continue;
        };
        let over = (around, around + reach.min(1e3));
        let all = sections(&orientation, over, Accuracy::Exact);
        let turning = orientation.turning().unwrap();
        for section in all.iter().take(200) {
            for time in [section.start.max(around - reach), section.end.next_down()] {
                let found = turning.section_at(time, Accuracy::Exact);
                assert!(
                    found.start.to_bits() == section.start.to_bits(),
                    "{kind} {section:?} {found:?}"
                );
                assert!(found.end.to_bits() == section.end.to_bits(), "{kind}");
            }
        }
    }
}

/// A rotation that goes on beyond its knots faster than a spin may be told is one section, and unknown. It would have millions
/// of sections a second.
#[test]
fn what_goes_on_too_fast_is_one_cell() {
    let turn = |duration: f64| {
        [
            (0.0, DQuat::IDENTITY),
            (duration, DQuat::from_rotation_z(2.0)),
        ]
    };
    for build in [Orientation::slerp, Orientation::normalized_cubic] {
        for duration in [1e-9, 1e-300] {
            let orientation = build(&turn(duration)).unwrap();
            let orientation = orientation.with_outside(Outside::Coast);
            let turning = orientation.turning().unwrap();
            for accuracy in [Accuracy::Exact, Accuracy::Certified] {
                let section = turning.section_at(5.0, accuracy);
                assert!(
                    section.start <= duration && section.end == f64::INFINITY,
                    "{section:?}"
                );
                assert!(turning.bake(&section, accuracy).error() >= 1.0);
                let section = turning.section_at(-5.0, accuracy);
                assert!(
                    section.start == f64::NEG_INFINITY && section.end >= 0.0,
                    "{section:?}"
                );
            }
        }
        let slow = build(&turn(1e-5)).unwrap().with_outside(Outside::Coast);
        let section = slow.turning().unwrap().section_at(5.0, Accuracy::Exact);
        assert!(section.end - section.start < 1e-5);
    }
}

#[test]
fn bad_orientations_are_named() {
    let still = DQuat::IDENTITY;
    let spin = |rotation, velocity: DVec3| Orientation::spin(0.0, rotation, velocity);
    assert!(matches!(
        spin(still * 1.1, DVec3::X),
        Err(Error::RotationLength { knot: 0, length }) if (length - 1.1).abs() < 1e-12
    ));
    assert!(spin(still * (1.0 + 9e-10), DVec3::X).is_ok());
    assert!(matches!(
        spin(still, DVec3::Y * 1e7),
        Err(Error::AngularSpeed { speed }) if speed > 9e6
    ));
    assert!(matches!(
        Orientation::spin(f64::INFINITY, still, DVec3::X),
        Err(Error::NotFinite {
            knot: 0,
            quantity: Quantity::Time,
            ..
        })
    ));
    let half = DQuat::from_xyzw(1.0, 0.0, 0.0, 0.0);
    for build in [Orientation::slerp, Orientation::normalized_cubic] {
        assert!(matches!(
            build(&[(0.0, still)]),
            Err(Error::TooFewRotations { count: 1 })
        ));
        assert!(matches!(
            build(&[(0.0, still), (1.0, half)]),
            Err(Error::AntipodalRotations { knot: 1 })
        ));
        assert!(matches!(
            build(&[(0.0, still), (0.0, still)]),
            Err(Error::TimeNotIncreasing { knot: 1, .. })
        ));
        let bad = DQuat::from_xyzw(0.0, f64::NAN, 0.0, 1.0);
        assert!(matches!(
            build(&[(0.0, still), (1.0, bad)]),
            Err(Error::NotFinite {
                knot: 1,
                quantity: Quantity::Rotation(1),
                ..
            })
        ));
        // Of two signs, the same rotation.
        assert!(build(&[(0.0, still), (1.0, -still)]).is_ok());
    }
    let fixed = Orientation::FIXED;
    assert!(matches!(
        fixed.with_tolerance(0.2),
        Err(Error::Tolerance { .. })
    ));
}

/// Far from its origin, or too fast for the clock, a rotation is not known, and said so.
#[test]
fn what_rounding_hides_is_unknown() {
    let spin = Orientation::spin(0.0, DQuat::IDENTITY, 1e6 * DVec3::Z).unwrap();
    let turning = spin.turning().unwrap();
    for time in [1e3, 1e12, -1e300] {
        let section = turning.section_at(time, Accuracy::Certified);
        let baked = turning.bake(&section, Accuracy::Certified);
        assert!(
            baked.error() >= 1.0 && baked.error() < 1.01,
            "{time} {section:?}"
        );
        assert!(section.start <= time && time < section.end);
    }
    let section = turning.section_at(1.0, Accuracy::Certified);
    assert!(turning.bake(&section, Accuracy::Certified).error() < 2e-6);
}

/// Orientations follow each other; what is known of one before is as if all were made anew.
#[test]
fn kept_pieces_are_those_made_anew() {
    let mut rng = ChaCha8Rng::seed_from_u64(77);
    let cubics: [Orientation; 3] = [(); 3].map(|()| {
        let knots: Vec<(f64, DQuat)> = (0..6)
            .map(|number| (f64::from(number), rotation(&mut rng)))
            .collect();
        Orientation::normalized_cubic(&knots).unwrap()
    });
    let mut kept = 0;
    for _ in 0..200 {
        let mut now = rng.random_range(-1.0..2.0);
        let mut one = cubics[rng.random_range(0..3)].clone();
        for _ in 0..6 {
            now += rng.random_range(0.0..1.0);
            let next = if rng.random_bool(0.5) {
                cubics[rng.random_range(0..3)].clone()
            } else {
                Orientation::spin(now, rotation(&mut rng), vector(&mut rng, 3.0)).unwrap()
            };
            let next = if rng.random_bool(0.1) {
                next.with_tolerance(0.01).unwrap()
            } else {
                next
            };
            let since = now - rng.random_range(0.0..2.0);
            one = one.followed_by(&next, now, since).unwrap();
            let turning = one.turning().unwrap();
            let anew = Turning::of(turning.parts.clone(), turning.tolerance).unwrap();
            assert_eq!(
                format!("{:?}", turning.pieces),
                format!("{:?}", anew.pieces),
                "{:?}",
                turning.parts
            );
            kept += turning
                .parts
                .iter()
                .filter(|part| !part.given.is_one_piece())
                .count();
        }
    }
    assert!(kept > 500, "{kept}");
}

/// At no time there is some rotation, whatever the orientation.
#[test]
fn rotations_at_nan_are_rotations() {
    let mut rng = ChaCha8Rng::seed_from_u64(21);
    for kind in 0..36 {
        let given = orientation(&mut rng, kind).0;
        let rotation = Orientation::of(given).unwrap().rotation(f64::NAN);
        assert!((rotation.length() - 1.0).abs() < 1e-15, "{rotation}");
    }
}

/// All cubics that stand in for a rotation are known where bounds follow it. Far from time 0, cuts are rounded, and some of these
/// cubics last longer than others.
#[test]
fn where_a_turn_is_steady_all_its_cubics_are_known() {
    let mut rng = ChaCha8Rng::seed_from_u64(77);
    let (mut steady_turns, mut others) = (0, 0);
    for round in 0..20_000 {
        let far = 10_f64.powf(rng.random_range(2.0..11.0));
        let turn = if round % 2 == 0 {
            let speed = 10_f64.powf(rng.random_range(2.0..5.0));
            let velocity = vector(&mut rng, speed);
            let start = [0.0, far, 1.7e9][round / 2 % 3];
            Orientation::spin(start, rotation(&mut rng), velocity).unwrap()
        } else {
            let ulp = far.next_up() - far;
            let lasts = ulp * 10_f64.powf(rng.random_range(0.6..4.0)).round();
            let knots = [0.0, 1.0, 2.0].map(|step| (far + step * lasts, rotation(&mut rng)));
            Orientation::slerp(&knots).unwrap()
        };
        let tolerance = [None, Some(10_f64.powf(rng.random_range(-9.0..-1.0)))][round / 4 % 2];
        let Ok(turn) = turn.with_tolerance(tolerance.unwrap_or(1e-3)) else {
            continue;
        };
        let Some(turning) = turn.turning() else {
            continue;
        };
        let until = far + 1e-4 * far.min(1.0);
        let Some(steady) = turning.steady_from(far, until) else {
            others += 1;
            continue;
        };
        steady_turns += 1;
        for accuracy in [Accuracy::Exact, Accuracy::Certified] {
            let mut time = far;
            for _ in 0..200 {
                let section = turning.section_at(time, accuracy);
                let error = turning.bake(&section, accuracy).error();
                assert!(
                    3.0 * error <= steady.error * (1.0 + 1e-12),
                    "{round} {time} {error}"
                );
                time = section.end;
                if time > steady.until {
                    break;
                }
            }
        }
    }
    assert!(
        steady_turns > 4_000 && others > 100,
        "{steady_turns} {others}"
    );
}
