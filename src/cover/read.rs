//! Shapes of parry3d, read into forms of f64.

use super::error::CoverError;
use super::form::{Round, SolidForm};
use super::solid::Solid;
use glam::{DQuat, DVec3};
use parry3d::math::Pose;
use parry3d::shape::{ConvexPolyhedron, Shape, TriMesh, TypedShape};

/// Reads a shape, whose numbers count as exact.
pub(super) fn read(shape: &dyn Shape) -> Result<Solid, CoverError> {
    let typed = shape.as_typed_shape();
    let kind = kind(&typed);
    let mut forms = Vec::new();
    if let TypedShape::Compound(compound) = typed {
        for (pose, part) in compound.shapes() {
            let mut form = form(&part.as_typed_shape())?;
            let rotation = rotation(pose).ok_or(CoverError::InvalidShape { kind })?;
            let rounded = form.place(rotation, pose.translation.as_dvec3());
            forms.push((form, rounded));
        }
    } else {
        forms.push((form(&typed)?, 0.0));
    }
    Solid::new(forms).ok_or(CoverError::InvalidShape { kind })
}

/// Returns the form of a shape that is no compound.
fn form(typed: &TypedShape<'_>) -> Result<SolidForm, CoverError> {
    let kind = kind(typed);
    let length = |length: f32| {
        let length = f64::from(length);
        let is_one = length.is_finite() && length >= 0.0;
        is_one
            .then_some(length)
            .ok_or(CoverError::InvalidShape { kind })
    };
    let round = |radius: f32, upper: f32, half_height: f32| {
        Ok::<_, CoverError>(SolidForm::Round(Round {
            middle: DVec3::ZERO,
            axis: DVec3::Y,
            radii: [length(radius)?, length(upper)?],
            half_height: length(half_height)?,
        }))
    };
    Ok(match typed {
        TypedShape::Ball(ball) => SolidForm::Capsule {
            ends: [DVec3::ZERO; 2],
            radius: length(ball.radius)?,
        },
        TypedShape::Cuboid(cuboid) => {
            let half_extents = cuboid.half_extents.to_array();
            for extent in half_extents {
                length(extent)?;
            }
            SolidForm::cuboid(cuboid.half_extents.as_dvec3())
        }
        TypedShape::Capsule(capsule) => SolidForm::Capsule {
            ends: [capsule.segment.a, capsule.segment.b].map(|end| end.as_dvec3()),
            radius: length(capsule.radius)?,
        },
        TypedShape::Cylinder(cylinder) => {
            round(cylinder.radius, cylinder.radius, cylinder.half_height)?
        }
        TypedShape::Cone(cone) => round(cone.radius, 0.0, cone.half_height)?,
        TypedShape::ConvexPolyhedron(hull) => polyhedron(hull),
        TypedShape::TriMesh(mesh) => triangles(mesh),
        _ => return Err(CoverError::UnsupportedShape { kind }),
    })
}

/// Returns the rotation of a pose in f64: its quaternion is taken for its direction.
fn rotation(pose: &Pose) -> Option<DQuat> {
    let rotation = DQuat::from_array(pose.rotation.to_array().map(f64::from));
    let length = rotation.length();
    (length.is_finite() && length > 0.0).then(|| rotation.normalize())
}

fn polyhedron(hull: &ConvexPolyhedron) -> SolidForm {
    let corners = hull.vertices_adj_to_face();
    let polygons = hull.faces().iter().map(|face| {
        let first = face.first_vertex_or_edge as usize;
        let end = first + face.num_vertices_or_edges as usize;
        let corners = corners[first..end].iter();
        corners.map(|&corner| corner as usize).collect()
    });
    SolidForm::Hull {
        points: points(hull.points()),
        polygons: polygons.collect(),
    }
}

fn triangles(mesh: &TriMesh) -> SolidForm {
    let all = points(mesh.vertices());
    let corners = mesh.indices().iter().flatten();
    let mut used: Vec<usize> = corners.map(|&corner| corner as usize).collect();
    used.sort_unstable();
    used.dedup();
    let place = |corner: u32| used.partition_point(|&other| other < corner as usize);
    let triangle = |corners: &[u32; 3]| corners.map(place);
    SolidForm::Mesh {
        triangles: mesh.indices().iter().map(triangle).collect(),
        points: used.iter().map(|&corner| all[corner]).collect(),
    }
}

fn points(points: &[parry3d::math::Vector]) -> Vec<DVec3> {
    points.iter().map(|point| point.as_dvec3()).collect()
}

const fn kind(shape: &TypedShape<'_>) -> &'static str {
    match shape {
        TypedShape::Ball(_) => "ball",
        TypedShape::Cuboid(_) => "cuboid",
        TypedShape::Capsule(_) => "capsule",
        TypedShape::Segment(_) => "segment",
        TypedShape::Triangle(_) => "triangle",
        TypedShape::Voxels(_) => "voxel shape",
        TypedShape::TriMesh(_) => "triangle mesh",
        TypedShape::Polyline(_) => "polyline",
        TypedShape::HalfSpace(_) => "half-space",
        TypedShape::HeightField(_) => "height field",
        TypedShape::Compound(_) => "compound",
        TypedShape::ConvexPolyhedron(_) => "convex polyhedron",
        TypedShape::Cylinder(_) => "cylinder",
        TypedShape::Cone(_) => "cone",
        TypedShape::RoundCuboid(_)
        | TypedShape::RoundTriangle(_)
        | TypedShape::RoundCylinder(_)
        | TypedShape::RoundCone(_)
        | TypedShape::RoundConvexPolyhedron(_) => "rounded shape",
        TypedShape::Custom(_) => "custom shape",
    }
}
