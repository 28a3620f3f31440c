//! Low-poly shapes, lit from one side.

#![allow(
    clippy::cast_precision_loss,
    reason = "a handful of vertices; pictures are drawn in f32"
)]

use crate::fleet::Kind;
use macroquad::prelude::{Color, Mat3, Vec3, Vertex, vec2, vec3};

/// Triangles around the origin, by corners.
pub(crate) struct Shape {
    triangles: Vec<[Vec3; 3]>,
    colour: Color,
}

const LIGHT: Vec3 = Vec3::new(0.45, 0.8, 0.4);

impl Shape {
    pub(crate) fn of(kind: Kind) -> Self {
        match kind {
            Kind::Ship => Self {
                triangles: dart(),
                colour: Color::new(0.72, 0.82, 0.95, 1.0),
            },
            Kind::Drone => Self {
                triangles: ball(0.75, 0.0, 0),
                colour: Color::new(0.45, 0.90, 0.75, 1.0),
            },
            Kind::Sphere | Kind::Asteroid => Self {
                triangles: ball(2.5, 0.35, 1),
                colour: Color::new(0.62, 0.54, 0.47, 1.0),
            },
        }
    }

    /// Appends the shape's lit triangles, turned and moved.
    pub(crate) fn place(&self, turn: Mat3, at: Vec3, vertices: &mut Vec<Vertex>) {
        for triangle in &self.triangles {
            let [a, b, c] = triangle.map(|corner| turn * corner);
            let normal = (b - a).cross(c - a).normalize_or_zero();
            let brightness = 0.28 + 0.72 * normal.dot(LIGHT.normalize()).max(0.0);
            let lit = |part: f32| part * brightness;
            let Color { r, g, b: blue, .. } = self.colour;
            let colour = Color::new(lit(r), lit(g), lit(blue), 1.0);
            for corner in [a, b, c] {
                vertices.push(Vertex::new2(corner + at, vec2(0.0, 0.0), colour));
            }
        }
    }
}

/// A slender ship along x with two fins.
fn dart() -> Vec<[Vec3; 3]> {
    let (nose, tail) = (vec3(2.4, 0.0, 0.0), vec3(-1.8, 0.0, 0.0));
    let ring = [
        vec3(-0.6, 0.55, 0.0),
        vec3(-0.6, 0.0, 0.8),
        vec3(-0.6, -0.45, 0.0),
        vec3(-0.6, 0.0, -0.8),
    ];
    let mut triangles = Vec::new();
    for (index, &corner) in ring.iter().enumerate() {
        let next = ring[(index + 1) % 4];
        triangles.push([nose, corner, next]);
        triangles.push([tail, next, corner]);
    }
    for side in [1.0, -1.0] {
        let fin = [
            vec3(-0.4, 0.05, 0.6 * side),
            vec3(-2.1, 0.15, 1.9 * side),
            vec3(-1.5, 0.0, 0.3 * side),
        ];
        triangles.push(fin);
        triangles.push([fin[0], fin[2], fin[1]]);
    }
    triangles
}

/// An octahedron halved into finer triangles, its corners at uneven heights if it is rough.
fn ball(radius: f32, rough: f32, halvings: u32) -> Vec<[Vec3; 3]> {
    let axes = [Vec3::X, Vec3::Z, -Vec3::X, -Vec3::Z];
    let mut triangles: Vec<[Vec3; 3]> = (0..4)
        .flat_map(|k| {
            let (a, b) = (axes[k], axes[(k + 1) % 4]);
            [[Vec3::Y, b, a], [-Vec3::Y, a, b]]
        })
        .collect();
    for _ in 0..=halvings {
        triangles = triangles
            .into_iter()
            .flat_map(|[a, b, c]| {
                let middle = |x: Vec3, y: Vec3| (x + y).normalize();
                let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
                [[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]
            })
            .collect();
    }
    let height = |corner: Vec3| {
        let waves = (corner.x * 5.1 + 1.0).sin() * (corner.y * 4.3).cos()
            + 0.6 * (corner.z * 7.7 + corner.x * 3.0).sin();
        corner * radius * (1.0 + rough * 0.5 * waves)
    };
    for triangle in &mut triangles {
        *triangle = triangle.map(height);
    }
    triangles
}
