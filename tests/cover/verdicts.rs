//! Verdicts on spheres, of a cover or not.

use crate::cases::{direction, seeded, torus};
use crate::{brick, covers, fit};
use nearmiss::glam::DVec3;
use nearmiss::parry3d::math::{Pose, Vector};
use nearmiss::parry3d::shape::{
    Ball, Capsule, Compound, Cone, Cuboid, Cylinder, Shape, SharedShape, TriMesh,
};
use nearmiss::{CoverError, Coverage, Error, Sphere, verify_cover};

fn sphere(offset: DVec3, radius: f64) -> Sphere {
    Sphere { offset, radius }
}

fn is_in(point: DVec3, spheres: &[Sphere]) -> bool {
    let mut spheres = spheres.iter();
    spheres.any(|sphere| point.distance(sphere.offset) <= sphere.radius)
}

/// Covers are tight: many a sphere cannot be smaller by 1 %. Samples find no point that the verdict
/// overlooks.
#[test]
fn spheres_that_shrink_uncover_something() {
    for (case, cover) in covers() {
        let mut rejected = 0;
        for shrunk in 0..cover.spheres().len() {
            let mut spheres = cover.spheres().to_vec();
            spheres[shrunk].radius *= 0.99;
            let verdict = verify_cover(&spheres, &*case.shape).unwrap();
            let mut random = seeded(9);
            let left_out = (0..20_000).any(|_| !is_in((case.point)(&mut random), &spheres));
            match verdict {
                Coverage::Covered => assert!(!left_out, "{} {shrunk}", case.name),
                Coverage::Uncovered { point } => {
                    assert!(!is_in(point, &spheres), "{} {shrunk}", case.name);
                    rejected += 1;
                }
                Coverage::Undecided { .. } => panic!("{} {shrunk}: {verdict:?}", case.name),
            }
        }
        assert!(rejected > 0, "{}", case.name);
    }
}

/// A void within spheres that contain the whole surface.
#[test]
fn voids_are_found() {
    let cube = Cuboid::new(Vector::splat(1.0));
    let (points, triangles) = cube.to_trimesh();
    let mesh = TriMesh::new(points, triangles).unwrap();
    let mut spheres = Vec::new();
    for i in -2..=2 {
        for j in -2..=2 {
            let (a, b) = (f64::from(i) * 0.45, f64::from(j) * 0.45);
            for side in [-0.95, 0.95] {
                let centres = [[a, b, side], [a, side, b], [side, a, b]];
                spheres.extend(centres.map(|centre| sphere(DVec3::from_array(centre), 0.4)));
            }
        }
    }
    for shape in [&cube as &dyn Shape, &mesh] {
        let Coverage::Uncovered { point } = verify_cover(&spheres, shape).unwrap() else {
            panic!("the void was not found");
        };
        assert!(
            point.abs().max_element() < 0.6 && !is_in(point, &spheres),
            "{point}"
        );
        let filled: Vec<Sphere> = spheres
            .iter()
            .copied()
            .chain([sphere(DVec3::ZERO, 1.2)])
            .collect();
        assert_eq!(verify_cover(&filled, shape).unwrap(), Coverage::Covered);
    }
    // Without a side there is only the surface.
    let open: Vec<[u32; 3]> = mesh.indices()[1..].to_vec();
    let open = TriMesh::new(mesh.vertices().to_vec(), open).unwrap();
    assert_eq!(verify_cover(&spheres, &open).unwrap(), Coverage::Covered);
}

#[test]
fn tight_spheres() {
    // Exact where the numbers are.
    let ball = Ball::new(0.5);
    let with = |radius: f64| verify_cover(&[sphere(DVec3::ZERO, radius)], &ball).unwrap();
    assert_eq!(with(0.5), Coverage::Covered);
    assert!(matches!(with(0.499), Coverage::Uncovered { .. }));
    let within = 1.0 + 1e-6;
    let just_off = [sphere(DVec3::X * 1e-9, 0.5)];
    let verdict = verify_cover(&just_off, &ball).unwrap();
    assert_ne!(verdict, Coverage::Covered);
    let enough = [sphere(DVec3::X * 1e-9, 0.5 * within)];
    assert_eq!(verify_cover(&enough, &ball).unwrap(), Coverage::Covered);

    // The corners of a box, to rounding.
    let corner = 5.25_f64.sqrt();
    let with = |radius: f64| verify_cover(&[sphere(DVec3::ZERO, radius)], &brick()).unwrap();
    assert!(matches!(
        with(corner),
        Coverage::Covered | Coverage::Undecided { .. }
    ));
    assert_eq!(with(corner + 1e-8), Coverage::Covered);
    let Coverage::Uncovered { point } = with(corner - 1e-6) else {
        panic!("a corner was not found");
    };
    assert!((point.abs() - DVec3::new(0.5, 1.0, 2.0)).length() < 1e-9);
}

/// Two spheres nearly at one place: each end of a rod is farthest out of another one, and in doubt is
/// the end that is out of both.
#[test]
fn spheres_nearly_at_one_place() {
    let rod = Cuboid::new(Vector::new(0.5, 1e-7, 1e-7));
    let gaps = [1.2e-6, 1.5e-6, 1.9e-6];
    for (gap, scale) in gaps.iter().flat_map(|gap| [(gap, 1.0), (gap, 0.1)]) {
        let gap = gap * scale;
        let left = DVec3::X * (-gap / 2.0 - 1e-8 * scale);
        let spheres = [
            sphere(left, 0.5 - gap / 2.0 + 1e-7 * scale),
            sphere(
                left + DVec3::X * 0.99e-6 * scale,
                0.5 - gap / 2.0 - 0.88e-6 * scale,
            ),
        ];
        let verdict = verify_cover(&spheres, &rod).unwrap();
        let Coverage::Uncovered { point } = verdict else {
            panic!("{gap}: {verdict:?}");
        };
        assert!(point.x > 0.499 && !is_in(point, &spheres), "{gap}: {point}");
    }
}

/// Two spheres that are needed both, as near to each other as may be told apart: nothing is in doubt.
#[test]
fn spheres_near_each_other_cover() {
    let rod = Cuboid::new(Vector::new(0.5, 1e-7, 1e-7));
    for apart in [2e-7, 5e-7, 9e-7, 1e-5] {
        // Each reaches the end on its side, and not the other end.
        let radius = 0.5 - apart / 4.0;
        let spheres = [-0.5, 0.5].map(|side| sphere(DVec3::X * apart * side, radius));
        assert_eq!(verify_cover(&spheres, &rod).unwrap(), Coverage::Covered);
    }
}

/// Circles where neighbours touch the surface of a capsule: nothing to spare anywhere on them.
#[test]
fn tight_circles() {
    let capsule = Capsule::new_y(1.0, 0.5);
    let mut spheres = fit(&capsule, 5).spheres().to_vec();
    for sphere in &mut spheres {
        sphere.radius -= 2e-6;
    }
    assert!(matches!(
        verify_cover(&spheres, &capsule).unwrap(),
        Coverage::Uncovered { .. }
    ));
}

#[test]
fn spheres_of_all_kinds() {
    let far = sphere(DVec3::splat(1e300), 1.0);
    let around = sphere(DVec3::new(1e6, 0.0, 0.0), 2e6);
    let dull = sphere(DVec3::new(1e9, 0.0, 0.0), 1e9);
    let large = sphere(DVec3::X * 2e4, 2e4);
    let inner = sphere(DVec3::ZERO, 0.5);
    let verdict = |spheres: &[Sphere]| verify_cover(spheres, &brick()).unwrap();
    assert!(matches!(verdict(&[far, inner]), Coverage::Uncovered { .. }));
    assert_eq!(verdict(&[far, around, inner]), Coverage::Covered);
    // Its surface passes the box, where its digits do not say on which side.
    for outer in [dull, large] {
        let verdict = verdict(&[outer, inner]);
        assert!(matches!(verdict, Coverage::Undecided { .. }), "{outer:?}");
    }
    // Spheres around one centre, one twice.
    let whole = sphere(DVec3::ZERO, 2.3);
    assert_eq!(verdict(&[inner, whole, whole, inner]), Coverage::Covered);
    assert!(matches!(
        verify_cover(&[], &brick()),
        Err(CoverError::Sphere(Error::EmptyCluster))
    ));
    assert!(matches!(
        verify_cover(&[sphere(DVec3::ZERO, f64::NAN)], &brick()),
        Err(CoverError::Sphere(Error::Radius { .. }))
    ));
    // A cover of another shape.
    let cover = fit(&brick(), 2);
    assert!(matches!(
        cover.verify(&torus(24, 12)).unwrap(),
        Coverage::Uncovered { .. }
    ));
}

/// A point is in a sphere, or not, or it is on its surface to rounding. The sphere of radius 0 at the point contains it.
#[test]
fn shapes_that_are_points() {
    let corners = vec![Vector::ZERO; 3];
    for point in [
        &Ball::new(0.0) as &dyn Shape,
        &Cylinder::new(0.0, 0.0),
        &Cone::new(0.0, 0.0),
        &Capsule::new_y(0.0, 0.0),
        &TriMesh::new(corners, vec![[0, 1, 2]]).unwrap(),
        &Cuboid::new(Vector::ZERO),
    ] {
        let verdict = |radius: f64| verify_cover(&[sphere(DVec3::X, radius)], point).unwrap();
        assert!(!matches!(verdict(1.0), Coverage::Uncovered { .. }));
        assert_eq!(verdict(1.0 + 1e-6), Coverage::Covered);
        let left_out = Coverage::Uncovered { point: DVec3::ZERO };
        assert_eq!(verdict(1.0 - 1e-6), left_out);
        for count in [1, 2, 5, 9] {
            let cover = fit(point, count);
            assert_eq!(cover.spheres(), [sphere(DVec3::ZERO, 0.0)], "{count}");
            let verdict = cover.verify(point).unwrap();
            assert_eq!(verdict, Coverage::Covered, "{count}");
        }
    }
}

/// A capsule whose ends its place rounds to one: it reaches farther than its radius.
#[test]
fn places_far_away_are_rounded() {
    let far = Pose::translation(1e10, 0.0, 0.0);
    let capsule = Capsule::new_x(1e-7, 1e-3);
    let shape = Compound::new(vec![(far, SharedShape::new(capsule))]);
    let reach = f64::from(1e-3_f32) + f64::from(1e-7_f32);
    let is_enough = |spheres: &[Sphere]| {
        let middle = DVec3::X * f64::from(1e10_f32);
        let mut spheres = spheres.iter();
        spheres.any(|sphere| sphere.offset.distance(middle) + reach <= sphere.radius)
    };
    for count in [1, 3] {
        let cover = fit(&shape, count);
        assert!(is_enough(cover.spheres()), "{cover:?}");
        assert_eq!(cover.verify(&shape).unwrap(), Coverage::Covered);
    }
    let too_small = [sphere(
        DVec3::X * f64::from(1e10_f32),
        f64::from(1e-3_f32) + 0.5e-7,
    )];
    let verdict = verify_cover(&too_small, &shape).unwrap();
    assert_ne!(verdict, Coverage::Covered);
}

/// A ball that is turned far from its origin, and moved back: the sums are rounded, though the result is small.
#[test]
fn places_that_cancel_are_rounded() {
    let far = Vector::new(1e10, 0.0, 0.0);
    let back = Pose::new(
        Vector::new(0.0, -1e10, 0.0),
        Vector::new(0.0, 0.0, 1.570_796_4),
    );
    let ball = SharedShape::new(Capsule::new(far, far, 1.0));
    let shape = Compound::new(vec![(back, ball)]);
    let cover = fit(&shape, 1);
    let [sphere] = cover.spheres() else {
        panic!("{cover:?}");
    };
    assert!(sphere.offset.length() < 1e4, "{cover:?}");
    assert!(sphere.radius > 1.0 + 1e10 * f64::EPSILON, "{cover:?}");
    assert_eq!(cover.verify(&shape).unwrap(), Coverage::Covered);
}

/// The balls of a compound are covered by themselves: nothing is rounded.
#[test]
fn balls_of_a_compound_cover_it() {
    let places = [(0.1, 0.3), (2.7, 1.1), (-3.3, 0.7)];
    let ball = |(x, radius): (f32, f32)| {
        let place = Pose::translation(x, 3.0 * x, -x);
        (place, SharedShape::new(Ball::new(radius)))
    };
    let compound = Compound::new(places.map(ball).to_vec());
    let own = |(x, radius): (f32, f32)| {
        let offset = Vector::new(x, 3.0 * x, -x).as_dvec3();
        sphere(offset, f64::from(radius))
    };
    let spheres = places.map(own);
    assert_eq!(
        verify_cover(&spheres, &compound).unwrap(),
        Coverage::Covered
    );
}

/// Spheres that reach as far as a round shape but for rounding, everywhere: nothing is proven, soon.
#[test]
fn shapes_that_are_nearly_the_spheres() {
    let ball = Ball::new(1.0);
    let mut random = seeded(4);
    let mut near = |count: usize, apart: f64, radius: f64| -> Vec<Sphere> {
        let all = 0..count;
        all.map(|_| sphere(direction(&mut random) * apart, radius))
            .collect()
    };
    let many = near(32, 1e-4, 1.0 - 1e-9);
    let one = near(1, 1e-12, 1.0);
    let few = near(7, 1e-8, 1.0 - 1e-9);
    for spheres in [many, one, few] {
        let verdict = verify_cover(&spheres, &ball).unwrap();
        assert!(matches!(verdict, Coverage::Undecided { .. }), "{verdict:?}");
    }
    let places: Vec<f32> = (0..40_u8).map(|number| 3.0 * f32::from(number)).collect();
    let parts = places.iter().map(|&x| {
        let place = Pose::translation(x, 0.0, 0.0);
        (place, SharedShape::new(ball))
    });
    let compound = Compound::new(parts.collect());
    let spheres: Vec<Sphere> = places
        .iter()
        .map(|&x| sphere(DVec3::new(f64::from(x), 1e-12, 0.0), 1.0))
        .collect();
    let verdict = verify_cover(&spheres, &compound).unwrap();
    assert!(matches!(verdict, Coverage::Undecided { .. }), "{verdict:?}");
}
