//! The states of a scene as a table, which `screen` reads.

use crate::scenes::Actor;
use crate::terminal::shortest;
use flate2::Compression;
use flate2::write::GzEncoder;
use std::fs::File;
use std::io::{BufWriter, Result, Write};
use std::path::Path;

/// Returns the radius of all bodies, if they have one in common, m.
pub(crate) fn common_radius(actors: &[Actor]) -> Option<f64> {
    let first = actors.first()?.radius;
    let is_common = |actor: &Actor| actor.radius.total_cmp(&first).is_eq();
    actors.iter().all(is_common).then_some(first)
}

/// Writes the states of all bodies, packed with gzip if the name of the file ends in `.gz`.
pub(crate) fn write(actors: &[Actor], path: &Path, file: File) -> Result<()> {
    let is_packed = path
        .extension()
        .is_some_and(|ending| ending.eq_ignore_ascii_case("gz"));
    if is_packed {
        let packer = GzEncoder::new(file, Compression::default());
        let mut target = BufWriter::new(packer);
        write_table(actors, &mut target)?;
        target.into_inner()?.finish().map(drop)
    } else {
        let mut target = BufWriter::new(file);
        write_table(actors, &mut target)?;
        target.flush()
    }
}

/// Bodies of different sizes have a column for their radius.
fn write_table(actors: &[Actor], target: &mut impl Write) -> Result<()> {
    let has_radii = common_radius(actors).is_none();
    let more = if has_radii { ",radius" } else { "" };
    writeln!(target, "body,t,px,py,pz,vx,vy,vz{more}")?;
    for (body, actor) in actors.iter().enumerate() {
        let radius = shortest(actor.radius);
        for state in &actor.states {
            let (p, v) = (state.position, state.velocity);
            write!(target, "{body}")?;
            for value in [state.time, p.x, p.y, p.z, v.x, v.y, v.z] {
                write!(target, ",{}", shortest(value))?;
            }
            if has_radii {
                write!(target, ",{radius}")?;
            }
            writeln!(target)?;
        }
    }
    Ok(())
}
