//! Random points of shapes, of which covers must leave none out.

use crate::cases::{Case, cases, fine_torus, seeded, torus};
use crate::fit;
use nearmiss::{CoverOptions, Coverage, SphereCover};

/// A point at a corner is off by its own rounding.
const ROUNDING: f64 = 1e-14;

pub(crate) fn no_point_is_left_out(case: &Case, cover: &SphereCover, count: u32) {
    let mut random = seeded(7);
    for _ in 0..count {
        let point = (case.point)(&mut random);
        let is_in =
            |sphere: &nearmiss::Sphere| point.distance(sphere.offset) <= sphere.radius + ROUNDING;
        assert!(
            cover.spheres().iter().any(is_in),
            "{}: {point} of {cover:?}",
            case.name
        );
    }
}

/// The number of points: 1e7, or as many as the variable says.
fn points() -> u32 {
    match std::env::var("NEARMISS_POINTS") {
        Ok(text) => text.parse().unwrap(),
        Err(_) => 10_000_000,
    }
}

/// Ten million points of each shape, number of spheres and seed: also of the sheet, which is open, and of a torus
/// as fine as those that games have.
#[test]
#[ignore = "takes many minutes"]
fn ten_million_points() {
    let points = points();
    for case in cases().into_iter().chain([fine_torus()]) {
        for count in [1, 4, 16, 64] {
            for seed in 0..2 {
                let options = CoverOptions::new(count).with_seed(seed);
                let cover = SphereCover::fit(&*case.shape, &options).unwrap();
                let verdict = cover.verify(&*case.shape).unwrap();
                assert_eq!(verdict, Coverage::Covered, "{} {count} {seed}", case.name);
                no_point_is_left_out(&case, &cover, points);
                println!(
                    "{} {count} {seed}: {:.4} %",
                    case.name,
                    cover.overshoot_percent()
                );
            }
        }
    }
}

/// A large mesh, whose centres are sought on fewer points.
#[test]
fn large_meshes() {
    let shape = torus(48, 24);
    let cover = fit(&shape, 3);
    assert_eq!(cover.verify(&shape).unwrap(), Coverage::Covered);
    assert!(cover.overshoot_percent() < 40.0);
}
