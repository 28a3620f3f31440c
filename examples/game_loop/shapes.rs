//! The drawn shapes, lit from one side.

use crate::Failure;
use crate::fleet::Kind;
use crate::solids::Solid;
use macroquad::prelude::{Color, Mat3, Vec3, Vertex, vec2, vec3};

/// Triangles around the origin, by corners.
pub(crate) struct Shape {
    triangles: Vec<[Vec3; 3]>,
    colour: Color,
}

const LIGHT: Vec3 = Vec3::new(0.45, 0.8, 0.4);

impl Shape {
    pub(crate) fn of(kind: Kind) -> Result<Self, Failure> {
        let colour = match kind {
            Kind::Ship => Color::new(0.72, 0.82, 0.95, 1.0),
            Kind::Sphere | Kind::Drone => Color::new(0.45, 0.90, 0.75, 1.0),
            Kind::Asteroid => Color::new(0.62, 0.54, 0.47, 1.0),
        };
        let solid = Solid::of(kind)?.triangles.iter();
        Ok(Self {
            triangles: solid
                .map(|three| three.map(|p| vec3(p.x, p.y, p.z)))
                .collect(),
            colour,
        })
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
