//! Covers of shapes whose numbers are any bits of f32, or ordinary.

use super::run;
use nearmiss::parry3d::math::{Pose, Vector};
use nearmiss::parry3d::shape::{
    Ball, Capsule, Compound, Cone, ConvexPolyhedron, Cuboid, Cylinder, Segment, SharedShape,
    TriMesh,
};
use nearmiss::{CoverOptions, Coverage, SphereCover};
use proptest::collection::vec;
use proptest::prelude::{BoxedStrategy, Strategy, any, prop_oneof};

fn number() -> BoxedStrategy<f32> {
    prop_oneof![
        8 => -3.0..3.0_f32,
        2 => proptest::sample::select(vec![0.0, 1.0, f32::MIN_POSITIVE, 1e-45, 1e-6, 1e6, f32::MAX]),
        1 => any::<u32>().prop_map(f32::from_bits),
    ]
    .boxed()
}

/// Lengths of either sign, where parry3d does not look at them.
fn length() -> impl Strategy<Value = f32> {
    prop_oneof![9 => number().prop_map(f32::abs), 1 => number()]
}

fn vector() -> impl Strategy<Value = Vector> {
    [number(), number(), number()].prop_map(Vector::from_array)
}

fn near() -> impl Strategy<Value = Vector> {
    [-3.0..3.0_f32, -3.0..3.0, -3.0..3.0].prop_map(Vector::from_array)
}

/// Shapes that a compound may have as parts.
fn part() -> BoxedStrategy<Option<SharedShape>> {
    let of_length = || number().prop_map(f32::abs);
    let cuboid = [length(), length(), length()];
    prop_oneof![
        length().prop_map(|radius| Some(SharedShape::new(Ball::new(radius)))),
        cuboid.prop_map(|half| Some(SharedShape::new(Cuboid::new(Vector::from_array(half))))),
        (vector(), vector(), length())
            .prop_map(|(a, b, radius)| Some(SharedShape::new(Capsule::new(a, b, radius)))),
        (of_length(), of_length())
            .prop_map(|(height, radius)| Some(SharedShape::new(Cylinder::new(height, radius)))),
        (length(), length())
            .prop_map(|(height, radius)| Some(SharedShape::new(Cone::new(height, radius)))),
        vec(near(), 4..12).prop_map(|points| {
            let hull = ConvexPolyhedron::from_convex_hull(&points)?;
            Some(SharedShape::new(hull))
        }),
        // Has no cover.
        (vector(), vector()).prop_map(|(a, b)| Some(SharedShape::new(Segment::new(a, b)))),
    ]
    .boxed()
}

/// Triangles between a few points, closed or not.
fn mesh() -> impl Strategy<Value = Option<SharedShape>> {
    let points = prop_oneof![vec(vector(), 3..7), vec(near(), 3..7)];
    let corners = (points, vec([0..7_u32, 0..7, 0..7], 1..9), any::<bool>());
    corners.prop_map(|(points, mut triangles, is_closed)| {
        let count = u32::try_from(points.len()).unwrap();
        for corner in triangles.iter_mut().flatten() {
            *corner %= count;
        }
        if is_closed && count >= 4 {
            triangles = vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]];
        }
        let mesh = TriMesh::new(points, triangles).ok()?;
        Some(SharedShape::new(mesh))
    })
}

fn shape() -> impl Strategy<Value = Option<SharedShape>> {
    let placed = (near(), near(), part());
    let compound = vec(placed, 1..4).prop_map(|parts| {
        let parts = parts.into_iter();
        let parts = parts.map(|(place, turn, part)| Some((Pose::new(place, turn), part?)));
        let parts: Option<Vec<(Pose, SharedShape)>> = parts.collect();
        Some(SharedShape::new(Compound::new(parts?)))
    });
    prop_oneof![6 => part(), 1 => mesh(), 2 => compound]
}

/// A fitted cover is proven, also by the verdict on its spheres.
#[test]
fn covers() {
    let question = (shape(), 1..4_usize, 0..9_u64);
    run(40, 0.4, question, |(shape, count, seed)| {
        let Some(shape) = shape else { return false };
        let options = CoverOptions::new(count).with_seed(seed);
        let Ok(cover) = SphereCover::fit(&*shape, &options) else {
            return false;
        };
        assert!((1..=count).contains(&cover.spheres().len()), "{cover:?}");
        for sphere in cover.spheres() {
            let is_one = sphere.offset.is_finite() && sphere.radius.is_finite();
            assert!(is_one && sphere.radius >= 0.0, "{cover:?}");
        }
        let bounds = [
            cover.overshoot(),
            cover.diameter(),
            cover.overshoot_percent(),
        ];
        for bound in bounds.into_iter().chain(cover.volume_ratio()) {
            assert!(bound.is_finite() && bound >= 0.0, "{cover:?}");
        }
        let verdict = cover.verify(&*shape).unwrap();
        assert_eq!(verdict, Coverage::Covered, "{cover:?}");
        true
    });
}
