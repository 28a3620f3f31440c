//! The convex shapes that are drawn, and the spheres fitted to them: ships, drones and asteroids.

use crate::Failure;
use crate::fleet::{Kind, Setting};
use nearmiss::parry3d::math::Vector;
use nearmiss::parry3d::shape::ConvexPolyhedron;
use nearmiss::{AlertLevel, CoverOptions, Hitbox, SphereCover};
use std::sync::LazyLock;

impl Setting {
    /// Something to look at: dense, and of three kinds.
    pub(crate) const SHIPS: Self = Self {
        kinds: &[
            Kind::Ship,
            Kind::Drone,
            Kind::Drone,
            Kind::Ship,
            Kind::Asteroid,
        ],
        hitbox: |kind| Ok(Solid::of(kind)?.hitbox.clone()),
        spacing: 26.0,
        clearance: 12.0,
        headroom: Some(20.0),
        levels: &[
            AlertLevel::at(8.0),
            AlertLevel::at(3.0),
            AlertLevel::at(0.0),
        ],
        warning: 1,
        contact: 2,
    };
}

/// A convex shape around the origin of a body's frame, and spheres that contain it.
pub(crate) struct Solid {
    /// Corners of the triangles, m.
    pub(crate) triangles: Vec<[Vector; 3]>,
    hitbox: Hitbox,
}

impl Solid {
    /// Returns the solid of a kind of body, which is made once.
    pub(crate) fn of(kind: Kind) -> Result<&'static Self, Failure> {
        type Made = Result<Solid, String>;
        static SHIP: LazyLock<Made> = LazyLock::new(|| Solid::around(&delta(), 12));
        static DRONE: LazyLock<Made> = LazyLock::new(|| Solid::around(&ball(0.75, 0.0, 0), 1));
        static ASTEROID: LazyLock<Made> = LazyLock::new(|| Solid::around(&ball(2.5, 0.35, 1), 8));
        let made = match kind {
            Kind::Ship => &SHIP,
            Kind::Sphere | Kind::Drone => &DRONE,
            Kind::Asteroid => &ASTEROID,
        };
        made.as_ref().map_err(|error| error.clone().into())
    }

    /// The convex hull of some points, in at most so many spheres.
    fn around(points: &[Vector], spheres: usize) -> Result<Self, String> {
        let shape = ConvexPolyhedron::from_convex_hull(points);
        let shape = shape.ok_or("a shape of the game has no convex hull")?;
        let cover = SphereCover::fit(&shape, &CoverOptions::new(spheres));
        let cover = cover.map_err(|error| error.to_string())?;
        let (points, triangles) = shape.to_trimesh();
        let corner = |index: u32| points[index as usize];
        Ok(Self {
            triangles: triangles.iter().map(|three| three.map(corner)).collect(),
            hitbox: Hitbox::from(cover),
        })
    }
}

/// A slender delta along x.
fn delta() -> Vec<Vector> {
    vec![
        Vector::new(2.4, 0.0, 0.0),
        Vector::new(-1.8, -0.05, 1.6),
        Vector::new(-1.8, -0.05, -1.6),
        Vector::new(-0.6, 0.55, 0.0),
        Vector::new(-1.9, 0.45, 0.0),
        Vector::new(-0.4, -0.3, 0.0),
        Vector::new(-1.7, -0.3, 0.0),
    ]
}

/// Points of an octahedron halved into finer triangles, at uneven heights if it is rough.
fn ball(radius: f32, rough: f32, halvings: u32) -> Vec<Vector> {
    let axes = [Vector::X, Vector::Z, -Vector::X, -Vector::Z];
    let mut triangles: Vec<[Vector; 3]> = (0..4)
        .flat_map(|k| {
            let (a, b) = (axes[k], axes[(k + 1) % 4]);
            [[Vector::Y, b, a], [-Vector::Y, a, b]]
        })
        .collect();
    for _ in 0..=halvings {
        triangles = triangles
            .into_iter()
            .flat_map(|[a, b, c]| {
                let middle = |x: Vector, y: Vector| (x + y).normalize();
                let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
                [[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]
            })
            .collect();
    }
    let height = |corner: Vector| {
        let waves = (corner.x * 5.1 + 1.0).sin() * (corner.y * 4.3).cos()
            + 0.6 * (corner.z * 7.7 + corner.x * 3.0).sin();
        corner * radius * (1.0 + rough * 0.5 * waves)
    };
    let mut points: Vec<Vector> = triangles.into_iter().flatten().map(height).collect();
    points.sort_by(|a, b| {
        a.to_array()
            .partial_cmp(&b.to_array())
            .unwrap_or(std::cmp::Ordering::Equal)
    });
    points.dedup();
    points
}
