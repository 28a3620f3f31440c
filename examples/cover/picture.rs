//! A picture of a shape and its cover: three views along the axes.

use crate::Failure;
use nearmiss::SphereCover;
use nearmiss::glam::DVec3;
use nearmiss::parry3d::math::Vector;
use nearmiss::parry3d::shape::{Shape, TypedShape};
use plotters::coord::Shift;
use plotters::prelude::*;

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;

const NIGHT: RGBColor = RGBColor(12, 16, 28);
const INK: RGBColor = RGBColor(222, 228, 240);
const SHAPE: RGBColor = RGBColor(84, 110, 160);
const SPHERE: RGBColor = RGBColor(255, 176, 84);
const VIEW: u32 = 480;
const TITLE: u32 = 60;
/// Sides of round shapes, as drawn.
const SIDES: u32 = 48;

/// Draws the shape and the spheres as the text of an SVG file.
pub(crate) fn draw(shape: &dyn Shape, cover: &SphereCover) -> Result<String, Failure> {
    let size = (3 * VIEW, VIEW + TITLE);
    let mut text = String::new();
    {
        // The last of the areas closes the drawing.
        let root = SVGBackend::with_string(&mut text, size).into_drawing_area();
        root.fill(&NIGHT)?;
        let title = format!(
            "{} spheres, certified to reach out by at most {:.3} % of the diameter",
            cover.spheres().len(),
            cover.overshoot_percent()
        );
        let font = ("sans-serif", 22).into_text_style(&size).color(&INK);
        root.draw(&Text::new(title, (24, 18), font))?;
        let (_, views) = root.split_vertically(TITLE);
        let triangles = triangles(shape);
        let names = [
            "along x: y to the right, z up",
            "along y: x, z",
            "along z: x, y",
        ];
        let axes = [(1, 2), (0, 2), (0, 1)];
        for ((area, axes), name) in views.split_evenly((1, 3)).iter().zip(axes).zip(names) {
            draw_view(area, axes, &triangles, cover)?;
            let font = ("sans-serif", 15).into_text_style(area).color(&INK);
            area.draw(&Text::new(name, (24, 4), font))?;
        }
        root.present()?;
    }
    Ok(text)
}

fn draw_view(
    area: &Area<'_>,
    (right, up): (usize, usize),
    triangles: &[[DVec3; 3]],
    cover: &SphereCover,
) -> Result<(), Failure> {
    let mut low = DVec3::INFINITY;
    let mut high = DVec3::NEG_INFINITY;
    for sphere in cover.spheres() {
        low = low.min(sphere.offset - sphere.radius);
        high = high.max(sphere.offset + sphere.radius);
    }
    let middle = low.midpoint(high);
    // One scale for all views.
    let scale = f64::from(VIEW - 60) / (high - low).max_element().max(1e-30);
    let place = |point: DVec3| {
        let seen = (point - middle) * scale;
        let half = f64::from(VIEW) / 2.0;
        (pixel(half + seen[right]), pixel(half - seen[up]))
    };
    for triangle in triangles {
        area.draw(&Polygon::new(triangle.map(place), SHAPE.filled()))?;
    }
    for sphere in cover.spheres() {
        let at = place(sphere.offset);
        let radius = pixel(sphere.radius * scale);
        area.draw(&Circle::new(at, radius, SPHERE.mix(0.08).filled()))?;
        area.draw(&Circle::new(at, radius, SPHERE.mix(0.8)))?;
    }
    Ok(())
}

fn triangles(shape: &dyn Shape) -> Vec<[DVec3; 3]> {
    let (points, triangles): (Vec<Vector>, Vec<[u32; 3]>) = match shape.as_typed_shape() {
        TypedShape::Cuboid(cuboid) => cuboid.to_trimesh(),
        TypedShape::Capsule(capsule) => capsule.to_trimesh(SIDES, SIDES / 4),
        TypedShape::Cylinder(cylinder) => cylinder.to_trimesh(SIDES),
        TypedShape::TriMesh(mesh) => (mesh.vertices().to_vec(), mesh.indices().to_vec()),
        _ => return Vec::new(),
    };
    let corner = |corner: u32| points[corner as usize].as_dvec3();
    triangles
        .iter()
        .map(|triangle| triangle.map(corner))
        .collect()
}

#[allow(
    clippy::cast_possible_truncation,
    reason = "a place on the page, in pixels"
)]
fn pixel(value: f64) -> i32 {
    value.round() as i32
}
