//! Writing conflicts as CSV, and the funnel as JSON.

use nearmiss::{BodyId, Conflict, Scene, Stats};
use std::fs::File;
use std::io::{BufWriter, ErrorKind, Write};
use std::path::Path;
use std::time::Duration;

const HEADER: &str = "a,b,enter,exit,tca,separation,error,clip,resolved";

/// A reader that has seen enough (`| head`) is no error.
pub(crate) fn to_standard_output(scene: &Scene, conflicts: &[Conflict]) -> Result<(), String> {
    match write(std::io::stdout().lock(), scene, conflicts) {
        Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(()),
        result => result.map_err(|error| format!("standard output: {error}")),
    }
}

/// A file that could not be written whole is removed.
pub(crate) fn to_file(path: &Path, scene: &Scene, conflicts: &[Conflict]) -> Result<(), String> {
    let explain = |error: std::io::Error| format!("{}: {error}", path.display());
    let file = File::create(path).map_err(explain)?;
    write(file, scene, conflicts).map_err(|error| {
        let message = explain(error);
        match std::fs::remove_file(path) {
            Ok(()) => message,
            Err(left) => format!("{message}; an incomplete file is left: {left}"),
        }
    })
}

fn write(target: impl Write, scene: &Scene, conflicts: &[Conflict]) -> std::io::Result<()> {
    let mut out = BufWriter::new(target);
    let label = |id: BodyId| scene.body(id).map_or(0, |body| body.tag);
    writeln!(out, "{HEADER}")?;
    for conflict in conflicts {
        // The error and whether it is resolved are said only where the accuracy certifies.
        writeln!(
            out,
            "{},{},{},{},{},{},,{},",
            label(conflict.a),
            label(conflict.b),
            shortest(conflict.enter),
            shortest(conflict.exit),
            shortest(conflict.closest.time),
            shortest(conflict.closest.separation),
            conflict.clip.bits(),
        )?;
    }
    out.flush()
}

/// The shortest digits that read back as the same number; an exponent where that is shorter.
fn shortest(value: f64) -> String {
    let plain = value == 0.0 || (1e-5..1e16).contains(&value.abs());
    if plain {
        format!("{value}")
    } else {
        format!("{value:e}")
    }
}

/// The funnel and the stage times on one line.
pub(crate) fn stats_line(stats: &Stats, threads: usize) -> String {
    let ms = |time: Duration| time.as_secs_f64() * 1e3;
    format!(
        "{{\"bodies\":{},\"segments\":{},\"candidates\":{},\"survivors\":{},\"conflicts\":{},\
         \"bounds_ms\":{:.3},\"broad_ms\":{:.3},\"narrow_ms\":{:.3},\"screen_ms\":{:.3},\
         \"threads\":{threads}}}",
        stats.bodies,
        stats.segments,
        stats.candidates,
        stats.survivors,
        stats.conflicts,
        ms(stats.bounds_time),
        ms(stats.broad_time),
        ms(stats.narrow_time),
        ms(stats.total_time),
    )
}
