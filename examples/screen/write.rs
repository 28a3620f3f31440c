//! Writing conflicts as CSV, and the funnel as JSON.

use crate::read::Labels;
use crate::terminal::shortest;
use nearmiss::{Accuracy, BodyId, Conflict, Scene, Stats};
use std::io::{BufWriter, ErrorKind, Write};
use std::time::Duration;

const HEADER: &str = "a,b,enter,exit,tca,separation,error,clip,resolved";
const ENCLOSURES: &str = "enter_lo,enter_hi,exit_lo,exit_hi,tca_lo,tca_hi";

/// The output: a row for each conflict, with the labels of the file.
pub(crate) struct Table<'a> {
    pub(crate) labels: &'a Labels,
    pub(crate) scene: &'a Scene,
    pub(crate) conflicts: &'a [Conflict],
    pub(crate) accuracy: Accuracy,
}

/// A reader that has seen enough (`| head`) is no error.
pub(crate) fn to_standard_output(table: &Table<'_>) -> Result<(), String> {
    match table.write(std::io::stdout().lock()) {
        Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(()),
        result => result.map_err(|error| format!("standard output: {error}")),
    }
}

impl Table<'_> {
    pub(crate) fn write(&self, target: impl Write) -> std::io::Result<()> {
        let mut out = BufWriter::new(target);
        match self.accuracy {
            Accuracy::Certified => writeln!(out, "{HEADER},{ENCLOSURES}")?,
            _ => writeln!(out, "{HEADER}")?,
        }
        let tag = |id: BodyId| self.scene.body(id).map_or(0, |body| body.tag);
        let label = |id| self.labels.value(tag(id));
        for conflict in self.conflicts {
            let (error, resolved) = match conflict.certificate {
                Some(proof) => (shortest(proof.error), u8::from(proof.resolved).to_string()),
                None => Default::default(),
            };
            write!(
                out,
                "{},{},{},{},{},{},{error},{},{resolved}",
                label(conflict.a),
                label(conflict.b),
                shortest(conflict.enter),
                shortest(conflict.exit),
                shortest(conflict.closest.time),
                shortest(conflict.closest.separation),
                conflict.clip.bits(),
            )?;
            if let Some(proof) = conflict.certificate {
                for times in [proof.enter, proof.exit, proof.closest] {
                    let (low, high) = (shortest(times.earliest), shortest(times.latest));
                    write!(out, ",{low},{high}")?;
                }
            }
            writeln!(out)?;
        }
        out.flush()
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
