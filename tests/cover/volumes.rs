//! Volumes of covers over those of their shapes.

use crate::{brick, fit};
use nearmiss::parry3d::math::{Pose, Vector};
use nearmiss::parry3d::shape::{Capsule, Compound, Cuboid, SharedShape, TriMesh};
use std::f64::consts::PI;

#[test]
fn volumes_compare() {
    let cover = fit(&brick(), 1);
    let expected = 4.0 / 3.0 * PI * 5.25_f64.powf(1.5) / 8.0;
    assert!((cover.volume_ratio().unwrap() - expected).abs() < 1e-6);
    // Two boxes that overlap by half: 1.5 times the volume of one.
    let half = |x: f32| (Pose::translation(x, 0.0, 0.0), SharedShape::new(brick()));
    let compound = Compound::new(vec![half(0.0), half(0.5)]);
    let cover = fit(&compound, 1);
    let ratio = cover.volume_ratio().unwrap();
    let radius = cover.spheres()[0].radius;
    let expected = 4.0 / 3.0 * PI * radius.powi(3) / 12.0;
    assert!((ratio / expected - 1.0).abs() < 0.01, "{ratio}, {expected}");
}

/// Two cubes of width 2 in one mesh, the second one moved, and turned inside out.
fn two_cubes(shift: f32, inside_out: bool) -> TriMesh {
    let (mut points, mut triangles) = Cuboid::new(Vector::ONE).to_trimesh();
    for number in 0..8 {
        points.push(points[number] + Vector::X * shift);
    }
    for number in 0..12 {
        let [a, b, c] = triangles[number].map(|corner| corner + 8);
        triangles.push(if inside_out { [a, c, b] } else { [a, b, c] });
    }
    TriMesh::new(points, triangles).unwrap()
}

/// The interior is where the surface winds around, however often and whichever way.
#[test]
fn volumes_of_meshes_that_overlap() {
    for (shift, inside_out, volume) in [
        (0.0, false, 8.0),
        (1.0, false, 12.0),
        (1.0, true, 8.0),
        (3.0, false, 16.0),
        (3.0, true, 16.0),
    ] {
        let cover = fit(&two_cubes(shift, inside_out), 1);
        let expected = 4.0 / 3.0 * PI * cover.spheres()[0].radius.powi(3) / volume;
        let ratio = cover.volume_ratio().unwrap_or(0.0);
        assert!(
            (ratio / expected - 1.0).abs() < 0.01,
            "{shift} {inside_out}: {ratio}, {expected}"
        );
    }
    assert_eq!(fit(&two_cubes(0.0, true), 1).volume_ratio(), None);
}

/// Thin covers across the diagonal of their box.
#[test]
fn volumes_of_thin_covers() {
    for (radius, count) in [(0.02_f32, 16), (0.01, 64), (0.001, 256)] {
        let capsule = Capsule::new(Vector::ZERO, Vector::new(1.0, 0.5, 0.3), radius);
        let cover = fit(&capsule, count);
        let spheres = cover.spheres();
        let (first, last) = (spheres[0], spheres[count - 1]);
        // Equal spheres in a row: each has two halves, cut where neighbours meet.
        #[allow(clippy::cast_precision_loss, reason = "a small count")]
        let gaps = (count - 1) as f64;
        let half = first.offset.distance(last.offset) / gaps / 2.0;
        let round = first.radius;
        let up_to = |height: f64| PI * (round * round * height - height.powi(3) / 3.0);
        let union = 2.0 * up_to(round) + 2.0 * gaps * up_to(half.min(round));
        let radius = f64::from(radius);
        let length = (capsule.segment.b - capsule.segment.a).as_dvec3().length();
        let expected = union / (PI * radius * radius * (length + 4.0 / 3.0 * radius));
        let ratio = cover.volume_ratio().unwrap();
        assert!(
            (ratio / expected - 1.0).abs() < 1e-3,
            "{radius} {count}: {ratio}, {expected}"
        );
    }
}

/// The shares of many spheres are much thinner than the spheres.
#[test]
fn volumes_of_many_spheres() {
    let capsule = Capsule::new_y(10.0, 1.0);
    for (count, expected) in [(100, 1.006_86), (200, 1.001_71), (1_000, 1.000_076)] {
        let ratio = fit(&capsule, count).volume_ratio().unwrap();
        assert!((ratio - expected).abs() < 3e-4, "{count}: {ratio}");
    }
}
