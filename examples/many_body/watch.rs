//! The scene played through a monitor, its events compared with the one-shot screening.

use crate::{Failure, ratio, rounded};
use indicatif::{HumanCount, ProgressBar, ProgressStyle};
use nearmiss::{AlertLevel, BodyId, Conflict, Event, EventKind, Monitor, Scene, Stats};
use std::io::{self, Write};
use std::time::Instant;

/// Ticks that the whole scene is cut into.
const TICKS: u32 = 600;
/// The monitor looks this many ticks ahead.
const TICKS_AHEAD: f64 = 30.0;

/// The compared parts of a conflict: pair, enter, exit and least separation, to the bit.
type Met = (BodyId, BodyId, [u64; 3]);

/// Counts of a run.
#[derive(Debug, Default)]
struct Told {
    predicted: u64,
    revised: u64,
    withdrawn: u64,
    began: u64,
    plan_ends: u64,
    met: Vec<Met>,
}

impl Told {
    fn read(&mut self, events: &[Event]) {
        for event in events {
            match event.kind {
                EventKind::Predicted(_) => self.predicted += 1,
                EventKind::Revised(_) => self.revised += 1,
                EventKind::Withdrawn(_) => self.withdrawn += 1,
                EventKind::Began(_) => self.began += 1,
                EventKind::Ended(met, _) => {
                    let numbers = [met.enter, met.exit, met.closest.separation];
                    self.met.push((met.a, met.b, numbers.map(f64::to_bits)));
                }
                EventKind::PlanEnds { .. } => self.plan_ends += 1,
                _ => {}
            }
        }
    }
}

/// Plays the scene from `start` to `end` (s) and prints what the monitor did. Says whether the
/// encounters that ended are the `conflicts` of the one-shot screening, to the bit.
pub(crate) fn run(
    out: &mut (impl Write + Send),
    scene: Scene,
    (start, end): (f64, f64),
    margin: f64,
    conflicts: &[Conflict],
) -> Result<bool, Failure> {
    let step = (end - start) / f64::from(TICKS);
    let mut monitor = Monitor::new(scene, start, step * TICKS_AHEAD, &[AlertLevel::at(margin)])?;
    let style = ProgressStyle::with_template("monitor {wide_bar} {pos}/{len} ticks {msg}");
    let bar = ProgressBar::new(u64::from(TICKS))
        .with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
    let (mut told, mut events) = (Told::default(), Vec::new());
    let (mut times, mut funnel) = (Vec::new(), Stats::default());
    // One tick past the end: what lasts up to the end is over only then.
    for tick in 0..=TICKS + 1 {
        events.clear();
        let begin = Instant::now();
        monitor.advance(start + step * f64::from(tick), &mut events)?;
        times.push(begin.elapsed().as_secs_f64() * 1e3);
        told.read(&events);
        let stats = monitor.stats();
        funnel.boxes += stats.boxes;
        funnel.candidates += stats.candidates;
        funnel.spans += stats.spans;
        funnel.survivors += stats.survivors;
        bar.set_message(format!("{} began, {} ended", told.began, told.met.len()));
        bar.set_position(u64::from(tick));
    }
    bar.finish_and_clear();
    print(out, &told, &mut times, &funnel)?;
    Ok(same(out, told.met, conflicts)?)
}

fn same(out: &mut impl Write, mut met: Vec<Met>, conflicts: &[Conflict]) -> io::Result<bool> {
    let mut expected: Vec<Met> = conflicts
        .iter()
        .map(|one| {
            let numbers = [one.enter, one.exit, one.closest.separation];
            (one.a, one.b, numbers.map(f64::to_bits))
        })
        .collect();
    met.sort_unstable();
    expected.sort_unstable();
    let same = met == expected;
    writeln!(
        out,
        "  check: {} encounters ended, {} conflicts screened at once: {}",
        HumanCount(met.len() as u64),
        HumanCount(expected.len() as u64),
        if same { "the same bits" } else { "THEY DIFFER" },
    )?;
    Ok(same)
}

fn print(out: &mut impl Write, told: &Told, times: &mut [f64], funnel: &Stats) -> io::Result<()> {
    times.sort_unstable_by(f64::total_cmp);
    let last = ratio(times.len() as u64 - 1, 1);
    let at = |share: f64| times[usize::try_from(rounded(last * share)).unwrap_or(0)];
    writeln!(out, "\nmonitor")?;
    for (name, count) in [
        ("ticks", times.len() as u64),
        ("predicted", told.predicted),
        ("revised", told.revised),
        ("withdrawn", told.withdrawn),
        ("began", told.began),
        ("ended", told.met.len() as u64),
        ("plans that end", told.plan_ends),
        ("boxes", funnel.boxes),
        ("candidates (boxes meet)", funnel.candidates),
        ("spans to look at", funnel.spans),
        ("survivors, solved exactly", funnel.survivors),
    ] {
        writeln!(out, "  {name:<34}{:>16}", HumanCount(count).to_string())?;
    }
    writeln!(
        out,
        "  tick: p50 {:.3} ms, p99 {:.3} ms, longest {:.3} ms",
        at(0.5),
        at(0.99),
        at(1.0)
    )
}
