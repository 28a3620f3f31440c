//! Shapes, with points of them.

use nearmiss::SphereCover;
use nearmiss::glam::{DQuat, DVec3};
use nearmiss::parry3d::math::{Pose, Vector};
use nearmiss::parry3d::shape::{
    Ball, Capsule, Compound, Cone, ConvexPolyhedron, Cuboid, Cylinder, Shape, SharedShape, TriMesh,
};
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};

pub(crate) struct Case {
    pub(crate) name: &'static str,
    pub(crate) shape: Box<dyn Shape>,
    /// Returns a point in the shape; often on its surface, its edges, its corners.
    pub(crate) point: Box<dyn Fn(&mut ChaCha8Rng) -> DVec3 + Send + Sync>,
}

pub(crate) fn seeded(seed: u64) -> ChaCha8Rng {
    ChaCha8Rng::seed_from_u64(seed)
}

pub(crate) fn directions(count: u32) -> impl Iterator<Item = DVec3> {
    let mut random = seeded(5);
    (0..count).map(move |_| direction(&mut random))
}

pub(crate) fn direction(random: &mut ChaCha8Rng) -> DVec3 {
    loop {
        let point = DVec3::from_array(std::array::from_fn(|_| random.random_range(-1.0..1.0)));
        if (0.01..1.0).contains(&point.length_squared()) {
            return point.normalize();
        }
    }
}

/// A number of -1..=1, each end in a third of all cases.
fn share(random: &mut ChaCha8Rng) -> f64 {
    random.random_range(-3.0_f64..3.0).clamp(-1.0, 1.0)
}

fn in_ball(random: &mut ChaCha8Rng) -> DVec3 {
    // Rounding must not put it outside.
    direction(random) * share(random) * (1.0 - 1e-15)
}

fn in_disc(random: &mut ChaCha8Rng) -> DVec3 {
    let (sin, cos) = random.random_range(0.0..std::f64::consts::TAU).sin_cos();
    DVec3::new(cos, 0.0, sin) * share(random) * (1.0 - 1e-15)
}

/// A mean of some points, of few of them more often than of many.
fn mean(points: &[DVec3], random: &mut ChaCha8Rng) -> DVec3 {
    let count = random.random_range(1..=4);
    let (mut sum, mut total) = (DVec3::ZERO, 0.0);
    for _ in 0..count {
        let weight = random.random_range(0.001..1.0);
        sum += points[random.random_range(0..points.len())] * weight;
        total += weight;
    }
    sum / total
}

fn case(
    name: &'static str,
    shape: impl Shape,
    point: impl Fn(&mut ChaCha8Rng) -> DVec3 + Send + Sync + 'static,
) -> Case {
    Case {
        name,
        shape: Box::new(shape),
        point: Box::new(point),
    }
}

fn in_box(half: DVec3) -> impl Fn(&mut ChaCha8Rng) -> DVec3 + Send + Sync {
    move |random| half * DVec3::from_array(std::array::from_fn(|_| share(random)))
}

fn in_capsule(half: f64, radius: f64) -> impl Fn(&mut ChaCha8Rng) -> DVec3 + Send + Sync {
    move |random| DVec3::Y * half * share(random) + in_ball(random) * radius
}

/// A torus around z of radii 1 and 0.3.
pub(crate) fn torus(around: u32, across: u32) -> TriMesh {
    let angle = |step: u32, of: u32| std::f32::consts::TAU * step as f32 / of as f32;
    torus_of(around, across, |i, j| {
        let (a, b) = (angle(i, around), angle(j, across));
        let away = 1.0 + 0.3 * b.cos();
        Vector::new(away * a.cos(), away * a.sin(), 0.3 * b.sin())
    })
}

/// The torus whose corners are rounded once, from f64.
pub(crate) fn rounded_torus(around: u32, across: u32) -> TriMesh {
    let angle = |step: u32, of: u32| std::f64::consts::TAU * f64::from(step) / f64::from(of);
    torus_of(around, across, |i, j| {
        let (a, b) = (angle(i, around), angle(j, across));
        let away = 1.0 + 0.3 * b.cos();
        DVec3::new(away * a.cos(), away * a.sin(), 0.3 * b.sin()).as_vec3()
    })
}

fn torus_of(around: u32, across: u32, point: impl Fn(u32, u32) -> Vector) -> TriMesh {
    let (mut points, mut triangles) = (Vec::new(), Vec::new());
    for i in 0..around {
        for j in 0..across {
            points.push(point(i, j));
            let at = |i: u32, j: u32| (i % around) * across + j % across;
            let (first, next) = (at(i, j), at(i + 1, j));
            let (second, far) = (at(i, j + 1), at(i + 1, j + 1));
            triangles.extend([[first, next, far], [first, far, second]]);
        }
    }
    TriMesh::new(points, triangles).unwrap()
}

/// The torus whose quadrangles are cut along the other diagonal.
pub(crate) fn other_diagonals(torus: &TriMesh) -> TriMesh {
    let quadrangles = torus.indices().chunks(2);
    let cut = quadrangles.flat_map(|two| {
        let ([first, next, far], [_, _, second]) = (two[0], two[1]);
        [[first, next, second], [next, far, second]]
    });
    TriMesh::new(torus.vertices().to_vec(), cut.collect()).unwrap()
}

/// Asserts that each of many points of a segment is in a sphere.
pub(crate) fn no_segment_is_left_out([from, to]: [DVec3; 2], cover: &SphereCover) {
    for step in 0..=1_000 {
        let point = from.lerp(to, f64::from(step) / 1_000.0);
        let mut spheres = cover.spheres().iter();
        assert!(
            spheres.any(|sphere| point.distance(sphere.offset) <= sphere.radius),
            "{point} of {cover:?}"
        );
    }
}

fn points_of(mesh: &TriMesh) -> Vec<DVec3> {
    mesh.vertices()
        .iter()
        .map(|point| point.as_dvec3())
        .collect()
}

fn weights(random: &mut ChaCha8Rng) -> [f64; 3] {
    let (a, b) = ((share(random) + 1.0) / 2.0, (share(random) + 1.0) / 2.0);
    [a, (1.0 - a) * b, (1.0 - a) * (1.0 - b)]
}

/// On a triangle of a torus, or on the way from there to the middle of the tube.
fn in_torus(mesh: &TriMesh) -> impl Fn(&mut ChaCha8Rng) -> DVec3 + Send + Sync + 'static {
    let (points, triangles) = (points_of(mesh), mesh.indices().to_vec());
    move |random| {
        let corners = triangles[random.random_range(0..triangles.len())];
        let weights = weights(random);
        let inward = (share(random) + 1.0) / 2.0;
        let each = corners.iter().zip(weights).map(|(&corner, weight)| {
            let point = points[corner as usize];
            let middle = DVec3::new(point.x, point.y, 0.0).normalize();
            point.lerp(middle, inward * 0.999) * weight
        });
        each.sum()
    }
}

pub(crate) fn cases() -> Vec<Case> {
    let half = DVec3::new(0.5, 1.0, 2.0);
    let brick = Cuboid::new(half.as_vec3());
    let torus_mesh = torus(24, 12);
    let mut random = seeded(1);
    let cloud: Vec<Vector> = (0..30).map(|_| direction(&mut random).as_vec3()).collect();
    let rock = ConvexPolyhedron::from_convex_hull(&cloud).unwrap();
    let rock_points: Vec<DVec3> = rock.points().iter().map(|point| point.as_dvec3()).collect();
    let sheet = sheet();
    let (sheet_points, sheet_triangles) = (points_of(&sheet), sheet.indices().to_vec());
    vec![
        case("box", brick, in_box(half)),
        case(
            "flat box",
            Cuboid::new(Vector::new(1.0, 0.0, 2.0)),
            in_box(DVec3::new(1.0, 0.0, 2.0)),
        ),
        case("capsule", Capsule::new_y(1.0, 0.5), in_capsule(1.0, 0.5)),
        case("cylinder", Cylinder::new(1.0, 0.5), |random| {
            DVec3::Y * share(random) + in_disc(random) * 0.5
        }),
        case("cone", Cone::new(1.0, 0.5), |random| {
            let up = share(random);
            DVec3::Y * up + in_disc(random) * (0.25 * (1.0 - up))
        }),
        case("ball", Ball::new(0.5), |random| in_ball(random) * 0.5),
        case("rock", rock, move |random| mean(&rock_points, random)),
        compound(),
        case("torus", torus_mesh.clone(), in_torus(&torus_mesh)),
        case("sheet", sheet, move |random| {
            let corners = sheet_triangles[random.random_range(0..sheet_triangles.len())];
            let each = corners.iter().zip(weights(random));
            each.map(|(&corner, weight)| sheet_points[corner as usize] * weight)
                .sum()
        }),
    ]
}

/// A torus of 96 x 48 quadrangles.
pub(crate) fn fine_torus() -> Case {
    let mesh = torus(96, 48);
    case("fine torus", mesh.clone(), in_torus(&mesh))
}

/// A wavy sheet, open at its edges.
fn sheet() -> TriMesh {
    let (mut points, mut triangles) = (Vec::new(), Vec::new());
    for i in 0..6_u32 {
        for j in 0..6_u32 {
            let (x, y) = (i as f32 / 5.0, j as f32 / 5.0);
            points.push(Vector::new(x, y, 0.2 * (5.0 * x).sin()));
            if i < 5 && j < 5 {
                let first = 6 * i + j;
                triangles.extend([[first, first + 6, first + 7], [first, first + 7, first + 1]]);
            }
        }
    }
    TriMesh::new(points, triangles).unwrap()
}

/// A drone: a turned box, an arm and a ball.
fn compound() -> Case {
    let turned = Pose::new(Vector::new(0.3, 0.1, -0.2), Vector::new(0.4, -0.7, 0.2));
    let parts = vec![
        (
            turned,
            SharedShape::new(Cuboid::new(Vector::new(0.5, 0.2, 0.3))),
        ),
        (Pose::IDENTITY, SharedShape::new(Capsule::new_y(1.0, 0.1))),
        (
            Pose::translation(0.0, 1.0, 0.0),
            SharedShape::new(Ball::new(0.25)),
        ),
    ];
    let rotation = DQuat::from_array(turned.rotation.to_array().map(f64::from)).normalize();
    let translation = turned.translation.as_dvec3();
    let half = Vector::new(0.5, 0.2, 0.3).as_dvec3();
    let (in_box, in_arm) = (in_box(half), in_capsule(1.0, f64::from(0.1_f32)));
    case(
        "compound",
        Compound::new(parts),
        move |random| match random.random_range(0..3) {
            0 => rotation * in_box(random) + translation,
            1 => in_arm(random),
            _ => DVec3::Y + in_ball(random) * 0.25,
        },
    )
}
