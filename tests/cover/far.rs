//! Places so far away, or spheres so large, that rounding hides a shape's size.

use nearmiss::glam::DVec3;
use nearmiss::parry3d::math::{Pose, Rotation, Vector};
use nearmiss::parry3d::shape::{Ball, Capsule, Compound, Cuboid, Shape, SharedShape};
use nearmiss::{Coverage, Sphere, verify_cover};

fn verdict(shape: &dyn Shape, offset: DVec3, radius: f64) -> Coverage {
    verify_cover(&[Sphere { offset, radius }], shape).unwrap()
}

/// A cube of a half width around (x, x, x).
fn cube(x: f32, half: f32) -> Compound {
    let cube = SharedShape::new(Cuboid::new(Vector::splat(half)));
    Compound::new(vec![(Pose::translation(x, x, x), cube)])
}

/// The box around a shape is rounded as the shape's place is.
#[test]
fn boxes_far_away_are_rounded() {
    let far = |x: f32| DVec3::splat(f64::from(x));
    let ball = Capsule::new(Vector::splat(1e15), Vector::splat(1e15), 0.05);
    let undecided = |verdict: Coverage| matches!(verdict, Coverage::Undecided { .. });
    let of_ball = verdict(&ball, far(1e15), 0.001);
    assert!(undecided(of_ball), "{of_ball:?}");
    let of_cube = verdict(&cube(1e15, 0.05), far(1e15), 0.0);
    assert!(undecided(of_cube), "{of_cube:?}");
    // A radius of 0.0017511033922 m is needed.
    let of_small = verdict(&cube(1e7, 0.001_011), far(1e7), 0.001_751_101_779_1);
    assert!(undecided(of_small), "{of_small:?}");
    // Beside it: rounding does not hide a millimetre.
    let beside = verdict(&cube(1e7, 0.001_011), far(1e7) + 0.01, 0.002);
    assert!(matches!(beside, Coverage::Uncovered { .. }), "{beside:?}");
    assert_eq!(
        verdict(&cube(1e7, 0.001_011), far(1e7), 0.001_76),
        Coverage::Covered
    );
}

/// No corner of a cube is left out because its place is rounded.
#[test]
fn corners_far_away_are_rounded() {
    let place = Vector::splat(1e7);
    let turn = Rotation::from_axis_angle(Vector::new(0.3, 0.4, 0.86), 0.7);
    for step in 0..20_u8 {
        let half = 0.001 + 1e-7 * f32::from(step);
        let cube = SharedShape::new(Cuboid::new(Vector::splat(half)));
        let shape = Compound::new(vec![(Pose::from_parts(place, turn), cube)]);
        // The axis is not of length 1, nor is the quaternion: it is read as a direction.
        let enough = 3_f64.sqrt() * f64::from(half) * (1.0 + 1e-9);
        let verdict = verdict(&shape, place.as_dvec3(), enough);
        let is_right = matches!(verdict, Coverage::Covered | Coverage::Undecided { .. });
        assert!(is_right, "{half}: {verdict:?}");
    }
}

/// A ball that its place rounds to the left, and a sphere around it that is rounded to the right.
#[test]
fn spheres_beside_rounded_boxes() {
    let ulp = 2_f64.powi(-19);
    #[allow(
        clippy::cast_possible_truncation,
        reason = "any number near it will do"
    )]
    let end = Vector::X * (0.49 * ulp) as f32;
    let ball = SharedShape::new(Capsule::new(end, end, 1e-9));
    let shape = Compound::new(vec![(Pose::translation(1e10, 0.0, 0.0), ball)]);
    let verdict = verdict(&shape, DVec3::X * (1e10 + ulp), 0.52 * ulp);
    let is_right = matches!(verdict, Coverage::Covered | Coverage::Undecided { .. });
    assert!(is_right, "{verdict:?}");
}

/// Spheres whose numbers overflow in the unit of a small shape.
#[test]
fn spheres_beyond_all_numbers() {
    for (radius, offset, reach) in [
        (1e-9, 1e300, 9.9e299),
        (1e-20, 1e290, 9e289),
        (1e-40, 1e270, 1e269),
    ] {
        let verdict = verdict(&Ball::new(radius), DVec3::X * offset, reach);
        let is_right = matches!(
            verdict,
            Coverage::Uncovered { .. } | Coverage::Undecided { .. }
        );
        assert!(is_right, "{radius}: {verdict:?}");
    }
    // One that contains the shape.
    let around = verdict(&Ball::new(1e-9), DVec3::X * 9e299, 9.9e299);
    let is_right = matches!(around, Coverage::Covered | Coverage::Undecided { .. });
    assert!(is_right, "{around:?}");
}
