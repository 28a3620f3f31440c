//! Thin and flat shapes, in any direction.

use crate::cases::directions;
use crate::fit;
use nearmiss::glam::DVec3;
use nearmiss::parry3d::math::{Pose, Rotation, Vector};
use nearmiss::parry3d::shape::{Ball, Compound, Cone, SharedShape};

/// A shape turned in a compound of its own.
fn turned(shape: SharedShape) -> Compound {
    let rotation = Rotation::from_xyzw(0.1, 0.2, 0.3, 0.9).normalize();
    Compound::new(vec![(Pose::from_parts(Vector::ZERO, rotation), shape)])
}

/// Returns the distance of a point from a disc of radius 1 across the y-axis.
fn distance_from_disc(point: DVec3) -> f64 {
    let beyond = (point.x.hypot(point.z) - 1.0).max(0.0);
    beyond.hypot(point.y)
}

/// A flat cone is a disc of its lower radius.
#[test]
fn overshoots_of_flat_cones_are_bounds() {
    for half_height in [0.0_f32, 1e-30, 1e-16, 1e-12, 1e-7] {
        for count in [1, 6, 9] {
            let cover = fit(&Cone::new(half_height, 1.0), count);
            let mut farthest = 0.0_f64;
            for sphere in cover.spheres() {
                for direction in directions(20_000) {
                    let point = sphere.offset + direction * sphere.radius;
                    farthest = farthest.max(distance_from_disc(point));
                }
            }
            // The cone is within its height of the disc.
            let bound = cover.overshoot() + 2.0 * f64::from(half_height);
            assert!(
                farthest <= bound,
                "{half_height} {count}: {farthest} {bound}"
            );
        }
    }
}

/// A direction does not matter: the centres find the way to a form that is turned.
#[test]
fn thin_shapes_that_are_turned_have_good_covers() {
    for (shape, count, most) in [
        (SharedShape::cylinder(0.0, 1.0), 1, 1.001),
        (SharedShape::cylinder(0.0, 1.0), 9, 0.42),
        (SharedShape::cone(0.0, 1.0), 9, 0.42),
        (SharedShape::cylinder(1.0, 0.0), 9, 0.12),
        (SharedShape::cuboid(1e-3, 1.0, 1e-3), 9, 0.12),
        (SharedShape::cuboid(1e-6, 1.0, 1e-6), 9, 0.2),
        (SharedShape::cuboid(1.0, 1e-6, 1.0), 9, 0.47),
    ] {
        let cover = fit(&turned(shape), count);
        assert!(cover.overshoot() <= most, "{count} {most}: {cover:?}");
    }
}

/// More parts than a search has points, all of them at one place.
#[test]
fn a_thousand_points_at_one_place_have_a_cover() {
    let point = (Pose::IDENTITY, SharedShape::new(Ball::new(0.0)));
    let cover = fit(&Compound::new(vec![point; 1_001]), 4);
    assert_eq!(cover.spheres().len(), 1);
    assert!(cover.overshoot() <= 0.0);
}
