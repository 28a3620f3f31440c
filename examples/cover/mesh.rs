//! Triangle meshes from files.

use crate::Failure;
use crate::terminal;
use nearmiss::parry3d::math::Vector;
use nearmiss::parry3d::shape::TriMesh;
use std::fs::File;
use std::io::{BufRead, BufReader, ErrorKind};
use std::path::Path;

/// The byte order mark, with which some programs begin a text in UTF-8.
const BYTE_ORDER_MARK: &[u8] = "\u{feff}".as_bytes();

/// Reads an OBJ or STL file, as its name says.
pub(crate) fn read(path: &Path) -> Result<TriMesh, Failure> {
    let extension = path
        .extension()
        .map(|extension| extension.to_ascii_lowercase());
    let extension = extension
        .as_deref()
        .and_then(|extension| extension.to_str());
    let mesh = match extension {
        Some("obj") => read_obj(path),
        Some("stl") => read_stl(path),
        _ => Err("a mesh is an .obj or an .stl file".into()),
    };
    mesh.map_err(|error| format!("{}: {error}", terminal::name(path)).into())
}

fn read_obj(path: &Path) -> Result<TriMesh, Failure> {
    let options = tobj::LoadOptions {
        triangulate: true,
        ..tobj::LoadOptions::default()
    };
    let mut reader = BufReader::new(File::open(path)?);
    if reader.fill_buf()?.starts_with(BYTE_ORDER_MARK) {
        // It would hide what the first line is.
        reader.consume(BYTE_ORDER_MARK.len());
    }
    // Colours and textures do not matter.
    let no_materials = |_: &Path| Err(tobj::LoadError::GenericFailure);
    let loaded = tobj::load_obj_buf(&mut reader, &options, no_materials);
    let (models, _) = loaded.map_err(|error| format!("not read as OBJ: {error}"))?;
    let (mut points, mut triangles) = (Vec::new(), Vec::new());
    for model in models {
        let first = u32::try_from(points.len())?;
        let (corners, _) = model.mesh.indices.as_chunks::<3>();
        triangles.extend(
            corners
                .iter()
                .map(|corners| corners.map(|corner| first + corner)),
        );
        let (positions, _) = model.mesh.positions.as_chunks::<3>();
        points.extend(positions.iter().map(|&[x, y, z]| Vector::new(x, y, z)));
    }
    build(points, triangles)
}

fn read_stl(path: &Path) -> Result<TriMesh, Failure> {
    let mut reader = BufReader::new(File::open(path)?);
    let loaded = stl_io::read_stl(&mut reader);
    let mesh = loaded.map_err(|error| match error.kind() {
        ErrorKind::UnexpectedEof => "not read as STL: the file ends too early".to_owned(),
        _ => format!("not read as STL: {error}"),
    })?;
    let points = mesh.vertices.iter().map(|vertex| {
        let [x, y, z] = vertex.0;
        Vector::new(x, y, z)
    });
    let mut triangles = Vec::with_capacity(mesh.faces.len());
    for face in &mesh.faces {
        let [a, b, c] = face.vertices;
        triangles.push([u32::try_from(a)?, u32::try_from(b)?, u32::try_from(c)?]);
    }
    build(points.collect(), triangles)
}

fn build(points: Vec<Vector>, triangles: Vec<[u32; 3]>) -> Result<TriMesh, Failure> {
    if triangles.is_empty() {
        return Err("no triangles".into());
    }
    if let Some(point) = points.iter().find(|point| !point.is_finite()) {
        return Err(format!(
            "a corner at {point}: coordinates are finite, and not beyond {:.1e}",
            f32::MAX
        )
        .into());
    }
    let count = points.len();
    let beyond = |corner: &&u32| **corner as usize >= count;
    if let Some(corner) = triangles.iter().flatten().find(beyond) {
        return Err(format!("a triangle with corner {corner} of {count}").into());
    }
    Ok(TriMesh::new(points, triangles)?)
}
