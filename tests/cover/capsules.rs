//! Capsules against spheres near their axes.

use crate::cases::{direction, seeded};
use crate::fit;
use nearmiss::glam::DVec3;
use nearmiss::parry3d::math::Vector;
use nearmiss::parry3d::shape::Capsule;
use nearmiss::{Coverage, Sphere, verify_cover};
use rand::RngExt;

/// Neighbours meet just outside of a plump capsule, all along circles.
#[test]
fn plump_capsules_are_verified() {
    for (half, radius, count) in [
        (0.001, 1.0, 2),
        (0.1, 1.0, 16),
        (0.25, 0.5, 32),
        (0.001, 1.0, 64),
        (0.5, 0.25, 512),
    ] {
        let capsule = Capsule::new_y(half, radius);
        let cover = fit(&capsule, count);
        let verdict = cover.verify(&capsule).unwrap();
        assert_eq!(verdict, Coverage::Covered, "{half} {radius} {count}");
    }
    let slanted = Capsule::new(
        Vector::new(0.1, 0.2, -3.0),
        Vector::new(0.4, 0.3, -2.8),
        0.7,
    );
    let cover = fit(&slanted, 24);
    assert_eq!(cover.verify(&slanted).unwrap(), Coverage::Covered);
    // Beside the axis they are too small.
    let beside = cover.spheres().iter().map(|sphere| Sphere {
        offset: sphere.offset + 1e-3 * DVec3::Y,
        ..*sphere
    });
    let verdict = verify_cover(&beside.collect::<Vec<_>>(), &slanted).unwrap();
    assert!(matches!(verdict, Coverage::Uncovered { .. }), "{verdict:?}");
}

/// Random spheres on the axis and beside it: those that are said to cover a capsule leave no point out.
#[test]
fn spheres_near_the_axis() {
    let mut random = seeded(3);
    let mut covered = 0;
    for trial in 0..400 {
        let radius: f32 = random.random_range(0.2..2.0);
        let ends = [Vector::new(0.0, -1.0, 0.5), Vector::new(0.3, 1.0, 0.2)];
        let capsule = Capsule::new(ends[0], ends[1], radius);
        let ends = ends.map(|end| end.as_dvec3());
        let beside: f64 = if trial % 2 == 0 { 0.0 } else { 0.1 };
        let spheres: Vec<Sphere> = (0..random.random_range(2..6))
            .map(|_| {
                let along = ends[0].lerp(ends[1], random.random_range(-0.1..1.1));
                Sphere {
                    offset: along + direction(&mut random) * beside,
                    radius: f64::from(radius) * random.random_range(1.0..1.6),
                }
            })
            .collect();
        let verdict = verify_cover(&spheres, &capsule).unwrap();
        let is_in = |point: DVec3| {
            let mut spheres = spheres.iter();
            spheres.any(|sphere| point.distance(sphere.offset) <= sphere.radius)
        };
        match verdict {
            Coverage::Covered => covered += 1,
            Coverage::Uncovered { point } => {
                assert!(!is_in(point), "{trial}: {point}");
                continue;
            }
            Coverage::Undecided { .. } => continue,
        }
        let inside = f64::from(radius) * (1.0 - 1e-15);
        for _ in 0..2_000 {
            let share = random.random_range(-0.5_f64..1.5).clamp(0.0, 1.0);
            let point = ends[0].lerp(ends[1], share) + direction(&mut random) * inside;
            assert!(is_in(point), "{trial}: {point}");
        }
    }
    assert!((50..350).contains(&covered), "{covered}");
}
