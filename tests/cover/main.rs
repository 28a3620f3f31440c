//! Covers: nothing of a shape is left out, and what is said of a cover is true.

#![allow(
    clippy::unwrap_used,
    reason = "a cover that cannot be fitted fails the test"
)]

mod campaign;
mod capsules;
mod cases;
mod far;
mod few;
mod meshes;
mod thin;
mod verdicts;
mod volumes;

use cases::{Case, cases, other_diagonals, rounded_torus, torus};
use nearmiss::glam::DVec3;
use nearmiss::parry3d::math::{Pose, Vector};
use nearmiss::parry3d::shape::{
    Ball, Capsule, Compound, Cuboid, Cylinder, HalfSpace, Segment, Shape, SharedShape, TriMesh,
};
use nearmiss::{CoverError, CoverOptions, Coverage, Extent, Hitbox, SphereCover};
use std::sync::LazyLock;

fn fit(shape: &dyn Shape, count: usize) -> SphereCover {
    SphereCover::fit(shape, &CoverOptions::new(count)).unwrap()
}

/// All cases with a cover each, made once.
fn covers() -> &'static [(Case, SphereCover)] {
    static COVERS: LazyLock<Vec<(Case, SphereCover)>> = LazyLock::new(|| {
        let with_cover = |case: Case| {
            let cover = fit(&*case.shape, 3);
            (case, cover)
        };
        cases().into_iter().map(with_cover).collect()
    });
    &COVERS
}

fn brick() -> Cuboid {
    Cuboid::new(Vector::new(0.5, 1.0, 2.0))
}

#[test]
fn all_points_are_covered() {
    for (case, cover) in covers() {
        assert_eq!(
            cover.verify(&*case.shape).unwrap(),
            Coverage::Covered,
            "{}",
            case.name
        );
        campaign::no_point_is_left_out(case, cover, 20_000);
    }
}

#[test]
fn capsules_have_closed_forms() {
    let capsule = Capsule::new_y(1.0, 0.5);
    for (count, percent) in [(1, 33.3333), (4, 2.8528), (8, 0.6420), (16, 0.1463)] {
        let cover = fit(&capsule, count);
        assert_eq!(cover.spheres().len(), count);
        assert!(
            (cover.overshoot_percent() - percent).abs() < 1e-4,
            "{count}: {cover:?}"
        );
        // 2 E + 2 (K - 1) sqrt(E² + 2 r E) is the length of the segment.
        let overshoot = cover.overshoot();
        let half = (overshoot * (overshoot + 1.0)).sqrt();
        #[allow(clippy::cast_precision_loss, reason = "a small count")]
        let length = 2.0 * overshoot + 2.0 * (count as f64 - 1.0) * half;
        // The spare of the radii, 227 times for 16 spheres.
        assert!((length - 2.0).abs() < 1e-3, "{count}: {length}");
        assert_eq!(cover.verify(&capsule).unwrap(), Coverage::Covered);
    }
}

#[test]
fn a_ball_is_one_sphere() {
    for count in [1, 5] {
        let cover = fit(&Ball::new(0.7), count);
        let [sphere] = cover.spheres() else {
            panic!("{cover:?}");
        };
        assert!(sphere.offset.length() <= 0.0);
        assert!((sphere.radius - f64::from(0.7_f32)).abs() <= 0.0);
        assert!(cover.overshoot() <= 0.0);
        assert!((cover.volume_ratio().unwrap() - 1.0).abs() < 1e-12);
        assert_eq!(cover.verify(&Ball::new(0.7)).unwrap(), Coverage::Covered);
    }
    let point = fit(&Ball::new(0.0), 3);
    assert!(point.spheres()[0].radius <= 0.0 && point.overshoot_percent() <= 0.0);
    assert_eq!(point.volume_ratio(), None);
}

#[test]
fn overshoots_are_within_their_bounds() {
    // The lattice of 1 x 2 x 4 cubes: no eight balls do better.
    let lattice = 100.0 * (0.75_f64.sqrt() - 0.5) / 21.0_f64.sqrt();
    assert!((fit(&brick(), 8).overshoot_percent() - lattice).abs() < 1e-6);
    assert!(fit(&brick(), 16).overshoot_percent() <= 6.9);
    assert!(fit(&Cylinder::new(1.0, 0.5), 16).overshoot_percent() <= 6.0);
}

#[test]
fn overshoots_of_many_spheres_are_within_their_bounds() {
    assert!(fit(&brick(), 32).overshoot_percent() <= 5.2);
    assert!(fit(&brick(), 64).overshoot_percent() <= 4.0);
}

/// The bound of a torus does not depend on how its corners are rounded, its quadrangles are cut, or on the seed.
#[test]
fn overshoots_of_tori_are_within_their_bound() {
    let (given, rounded) = (torus(96, 48), rounded_torus(96, 48));
    for (mesh, seed) in [
        (&given, 0),
        (&other_diagonals(&given), 1),
        (&rounded, 0),
        (&other_diagonals(&rounded), 0),
    ] {
        let options = CoverOptions::new(16).with_seed(seed);
        let cover = SphereCover::fit(mesh, &options).unwrap();
        let percent = cover.overshoot_percent();
        assert!(percent <= 2.99, "{seed}: {percent}");
    }
}

/// No point of a sphere is farther from the shape than the overshoot.
#[test]
fn the_overshoot_is_a_bound() {
    let cover = fit(&brick(), 3);
    let half = DVec3::new(0.5, 1.0, 2.0);
    let mut farthest = 0.0_f64;
    for sphere in cover.spheres() {
        for direction in cases::directions(2_000) {
            let point = sphere.offset + direction * sphere.radius;
            farthest = farthest.max(point.distance(point.clamp(-half, half)));
        }
    }
    assert!(farthest <= cover.overshoot());
    assert!(farthest > 0.9 * cover.overshoot(), "{farthest}");
    // The same in percent, of the diagonal.
    let percent = 100.0 * cover.overshoot() / 21.0_f64.sqrt();
    assert!((cover.overshoot_percent() - percent).abs() < 1e-9);
}

#[test]
fn as_few_spheres_as_reach_a_target() {
    let options = CoverOptions::new(64).with_target_overshoot(0.01);
    let capsule = Capsule::new_y(1.0, 0.5);
    let cover = SphereCover::fit(&capsule, &options).unwrap();
    assert!(cover.overshoot() <= 0.01);
    let one_less = fit(&capsule, cover.spheres().len() - 1);
    assert!(one_less.overshoot() > 0.01);
    let refused = SphereCover::fit(&capsule, &CoverOptions::new(4).with_target_overshoot(0.01));
    assert!(
        matches!(refused, Err(CoverError::TargetMissed { spheres: 4, target, .. }) if target <= 0.01)
    );
}

#[test]
fn open_meshes_are_covered_as_surfaces() {
    let of_sheet = |(case, _): &&(Case, SphereCover)| case.name == "sheet";
    let (_, cover) = covers().iter().find(of_sheet).unwrap();
    assert_eq!(
        (cover.extent(), cover.volume_ratio()),
        (Extent::Surface, None)
    );
    assert_eq!(fit(&brick(), 1).extent(), Extent::Volume);
    // A closed surface without consistent orientation does not say where its interior is.
    let torus = torus(12, 6);
    let mut triangles = torus.indices().to_vec();
    triangles[7].swap(0, 1);
    let confused = TriMesh::new(torus.vertices().to_vec(), triangles).unwrap();
    assert_eq!(fit(&confused, 2).extent(), Extent::Surface);
    // One that is seen from inside does.
    let inward = torus.indices().iter().map(|&[a, b, c]| [a, c, b]).collect();
    let inward = TriMesh::new(torus.vertices().to_vec(), inward).unwrap();
    assert_eq!(fit(&inward, 2).extent(), Extent::Volume);
}

#[test]
fn what_cannot_be_covered_is_refused() {
    let refused = |shape: &dyn Shape| SphereCover::fit(shape, &CoverOptions::default());
    let floor = HalfSpace::new(Vector::Y);
    let unsupported = |kind| Err(CoverError::UnsupportedShape { kind });
    assert_eq!(refused(&floor), unsupported("half-space"));
    let segment = Segment::new(Vector::ZERO, Vector::Y);
    assert_eq!(refused(&segment), unsupported("segment"));
    let compound = Compound::new(vec![(Pose::IDENTITY, SharedShape::new(segment))]);
    assert_eq!(refused(&compound), unsupported("segment"));
    let invalid = |kind| Err(CoverError::InvalidShape { kind });
    assert_eq!(refused(&Ball::new(f32::NAN)), invalid("ball"));
    assert_eq!(
        refused(&Cuboid::new(Vector::new(1.0, -1.0, 1.0))),
        invalid("cuboid")
    );
    assert_eq!(
        refused(&Capsule::new_y(f32::INFINITY, 1.0)),
        invalid("capsule")
    );

    let with = |options: CoverOptions| SphereCover::fit(&brick(), &options);
    for count in [0, CoverOptions::MAX_SPHERES + 1] {
        assert_eq!(
            with(CoverOptions::new(count)),
            Err(CoverError::SphereCount { count })
        );
    }
    for target in [-1.0, f64::NAN, f64::INFINITY] {
        let refused = with(CoverOptions::new(2).with_target_overshoot(target));
        assert!(
            matches!(refused, Err(CoverError::Target { .. })),
            "{refused:?}"
        );
    }
    let cover = fit(&brick(), 1);
    for factor in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(
            cover.scaled(factor),
            Err(CoverError::Scale { .. })
        ));
    }
    assert!(matches!(cover.scaled(1e305), Err(CoverError::Sphere(_))));
}

#[test]
fn scaled_covers_contain_scaled_shapes() {
    let cover = fit(&brick(), 2);
    let doubled = cover.scaled(2.0).unwrap();
    let large = Cuboid::new(Vector::new(1.0, 2.0, 4.0));
    assert_eq!(doubled.verify(&large).unwrap(), Coverage::Covered);
    assert!((doubled.overshoot_percent() - cover.overshoot_percent()).abs() < 1e-9);
    assert_eq!(doubled.volume_ratio(), cover.volume_ratio());
    let hitbox = Hitbox::from(&doubled);
    assert_eq!(hitbox.spheres(), doubled.spheres());
    assert_eq!(hitbox, Hitbox::from(doubled));
}

/// The centre of a scaled sphere is rounded, too.
#[test]
fn bounds_of_scaled_covers_are_bounds() {
    for step in 1..200_u8 {
        let place = Pose::translation(3.3 + f32::from(step), 0.7, -0.1);
        let radius = 0.01;
        let ball = Compound::new(vec![(place, SharedShape::new(Ball::new(radius)))]);
        let cover = fit(&ball, 1);
        let factor = 1.0 + f64::from(step) / 700.0;
        let scaled = cover.scaled(factor).unwrap();
        let (before, after) = (cover.spheres()[0], scaled.spheres()[0]);
        // Differences of a product and a number near it, rounded once.
        let moved = DVec3::from_array(std::array::from_fn(|axis| {
            before.offset[axis].mul_add(factor, -after.offset[axis])
        }));
        let grown = -f64::from(radius).mul_add(factor, -after.radius);
        let beyond = moved.length() + grown;
        assert!(
            beyond <= scaled.overshoot(),
            "{step}: {beyond:e} {scaled:?}"
        );
    }
}

#[test]
fn progress_ends_with_one() {
    let told = std::sync::Mutex::new(Vec::new());
    let tell = |share: f64| told.lock().unwrap().push(share);
    let options = CoverOptions::new(3);
    SphereCover::fit_with_progress(&brick(), &options, tell).unwrap();
    let told = told.into_inner().unwrap();
    let (last, before) = told.split_last().unwrap();
    assert!(*last >= 1.0 && !before.is_empty());
    assert!(
        before.iter().all(|share| (0.0..1.0).contains(share)),
        "{told:?}"
    );
}

#[cfg(feature = "parallel")]
#[test]
fn any_number_of_threads_leads_to_the_same_bits() {
    for shape in [&brick() as &dyn Shape, &torus(24, 18)] {
        let options = CoverOptions::new(3).with_seed(3);
        let on = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
            pool.unwrap()
                .install(|| SphereCover::fit(shape, &options).unwrap())
        };
        let first = on(1);
        for threads in [2, 3] {
            assert_eq!(on(threads), first);
        }
    }
}

#[test]
fn efforts_have_a_bound() {
    let with = |shape: &dyn Shape, effort: u32| {
        SphereCover::fit(shape, &CoverOptions::new(1).with_effort(effort))
    };
    assert_eq!(with(&brick(), 0), with(&brick(), 1));
    let most = CoverOptions::MAX_EFFORT;
    assert!(with(&Capsule::new_y(1.0, 0.5), most).is_ok());
    for effort in [most + 1, 1 << 30, u32::MAX] {
        let refused = Err(CoverError::Effort { effort });
        assert_eq!(with(&brick(), effort), refused);
    }
}

/// The lattice of a box has no seed; a search has.
#[test]
fn seeds_lead_to_other_covers() {
    let options = CoverOptions::new(3);
    let with = |seed: u64| SphereCover::fit(&torus(12, 6), &options.with_seed(seed)).unwrap();
    assert_eq!(with(1), with(1));
    assert_ne!(with(1).spheres(), with(2).spheres());
}

#[cfg(feature = "serde")]
#[test]
fn covers_are_saved() {
    let cover = fit(&brick(), 3);
    let text = serde_json::to_string(&cover).unwrap();
    let read: SphereCover = serde_json::from_str(&text).unwrap();
    assert_eq!(read, cover);
    let options = CoverOptions::new(9).with_effort(2);
    let text = serde_json::to_string(&options).unwrap();
    assert_eq!(
        serde_json::from_str::<CoverOptions>(&text).unwrap(),
        options
    );
    let broken = serde_json::to_string(&cover)
        .unwrap()
        .replacen("\"radius\":", "\"radius\":-", 1);
    assert!(serde_json::from_str::<SphereCover>(&broken).is_err());
}

/// Each number of a saved cover is checked.
#[cfg(feature = "serde")]
#[test]
fn broken_covers_are_not_read() {
    let cover = fit(&brick(), 2);
    let good = serde_json::to_value(&cover).unwrap();
    let read = |value| serde_json::from_value::<SphereCover>(value);
    assert_eq!(read(good.clone()).unwrap(), cover);
    for field in ["overshoot", "diameter", "volume_ratio"] {
        for bad in [-1.0, 2.0 * f64::MAX] {
            let mut broken = good.clone();
            broken[field] = serde_json::Value::from(bad);
            // Infinity is null, which is no number, but no volume either.
            let allowed = field == "volume_ratio" && broken[field].is_null();
            assert_eq!(read(broken.clone()).is_ok(), allowed, "{broken}");
        }
    }
    // What could not be read is not made either.
    for field in ["overshoot", "diameter"] {
        let mut large = good.clone();
        large[field] = serde_json::Value::from(1e308);
        let scaled = read(large).unwrap().scaled(10.0);
        assert!(
            matches!(scaled, Err(CoverError::Saved { .. })),
            "{scaled:?}"
        );
    }
    for spheres in [
        serde_json::json!([]),
        serde_json::json!({"half_space": [0.0, 0.0, 1.0]}),
    ] {
        let mut broken = good.clone();
        broken["spheres"] = spheres;
        assert!(read(broken.clone()).is_err(), "{broken}");
    }
}
