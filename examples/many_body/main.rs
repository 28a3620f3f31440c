//! Screens a generated scene of many bodies and draws its encounters:
//!
//! ```text
//! cargo run --release --example many_body -- [--scene flocks|drones|satellites|asteroids|swarm]
//!     [--bodies N] [--seed K] [--margin M] [--threads T] [--picture FILE.svg]
//!     [--states FILE.csv[.gz]] [--monitor]
//! ```
//!
//! With `--states` it writes the scene as a table for the example `screen`.

mod picture;
#[path = "../scenes/mod.rs"]
mod scenes;
mod states;
#[path = "../terminal/mod.rs"]
mod terminal;
mod watch;

use clap::{Parser, ValueEnum};
use indicatif::HumanCount;
use nearmiss::{Body, Conflict, Error, Hitbox, Query, Scene, Stats, Trajectory};
use scenes::{Generated, Shape};
use std::error::Error as StdError;
use std::io::{self, Write};
use std::ops::ControlFlow;
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::{Duration, Instant};
use terminal::{Product, Progress, StandardOutput, Threads};

type Failure = Box<dyn StdError + Send + Sync>;

/// Every close encounter of a generated many-body scene.
#[derive(Debug, Parser)]
#[command(name = "many_body")]
struct Arguments {
    /// Kind of scene.
    #[arg(long, value_enum, default_value_t = Kind::Satellites)]
    scene: Kind,
    /// Number of bodies; if not given 6,000 (flocks), 20,000 (drones), 10,000 (satellites), 30,000 (asteroids), 50,000 (swarm).
    #[arg(long, value_parser = terminal::bodies(), allow_negative_numbers = true)]
    bodies: Option<usize>,
    /// The same seed gives the same scene.
    #[arg(long, value_parser = terminal::whole(0..=u64::MAX), default_value = "1", allow_negative_numbers = true)]
    seed: u64,
    /// Separation that counts as an encounter, m; the scene's own if not given.
    #[arg(long, value_parser = terminal::margin, allow_hyphen_values = true)]
    margin: Option<f64>,
    #[command(flatten)]
    threads: Threads,
    /// File for the picture; replaced if it exists.
    #[arg(long, default_value = "many_body.svg")]
    picture: PathBuf,
    /// File for the states of all bodies, as a table for the example screen; packed if the name ends in .gz. A
    /// file that is there is replaced.
    #[arg(long)]
    states: Option<PathBuf>,
    /// Then plays the scene through a monitor and checks its events against the screening.
    #[arg(long)]
    monitor: bool,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum Kind {
    /// Birds in flocks that cross.
    Flocks,
    /// Delivery drones over a city.
    Drones,
    /// Walker constellations in low orbit.
    Satellites,
    /// Rocks of all sizes, and a few fast ones.
    Asteroids,
    /// Smooth random motion: the stress test.
    Swarm,
}

impl Kind {
    fn generate(self, bodies: Option<usize>, seed: u64) -> Generated {
        match self {
            Self::Flocks => scenes::flocks(bodies.unwrap_or(6_000), seed),
            Self::Drones => scenes::drones(bodies.unwrap_or(20_000), seed),
            Self::Satellites => scenes::satellites(bodies.unwrap_or(10_000), seed),
            Self::Asteroids => scenes::asteroids(bodies.unwrap_or(30_000), seed),
            Self::Swarm => scenes::swarm(bodies.unwrap_or(50_000), Shape::Cube, seed),
        }
    }
}

fn main() -> ExitCode {
    let arguments = terminal::parse::<Arguments>();
    let states = arguments.states.as_ref();
    if states.is_some_and(|states| terminal::is_same_file(states, &arguments.picture)) {
        terminal::refuse::<Arguments>("--states and --picture are one file; name two");
    }
    terminal::exit_code(run(&arguments))
}

fn run(arguments: &Arguments) -> Result<(), Failure> {
    let picture = Product::at(&arguments.picture)?;
    let states = arguments.states.as_deref();
    let states = states.map(|path| Ok::<_, String>((path, Product::at(path)?)));
    let states = states.transpose()?;
    let mut out = StandardOutput::new();
    let pool = arguments.threads.pool()?;
    let begin = Instant::now();
    let progress = Progress::new();
    progress.say("making the scene");
    let generated = arguments.scene.generate(arguments.bodies, arguments.seed);
    let margin = arguments.margin.unwrap_or(generated.margin);
    let times = || generated.actors.iter().flat_map(|actor| &actor.states);
    let start = times()
        .map(|state| state.time)
        .fold(f64::INFINITY, f64::min);
    let end = times().map(|state| state.time).fold(start, f64::max);
    let radius = states::common_radius(&generated.actors);
    let mut made = begin.elapsed();
    if let Some((path, product)) = &states {
        progress.say("writing the states");
        product.write(|file| states::write(&generated.actors, path, file))?;
    }
    let begin = Instant::now();
    let scene = build(generated)?;
    made += begin.elapsed();
    progress.begin(format!(
        "screening {} bodies",
        HumanCount(scene.len() as u64)
    ));
    let query = Query::default().with_margin(margin);
    let screening = pool.install(|| {
        scene.screen_with_progress(&query, |share| {
            progress.show(share);
            ControlFlow::Continue(())
        })
    })?;
    progress.finish();
    writeln!(
        out,
        "{:?}: {} bodies, made in {:.2} s; encounters of the splines within {margin} m",
        arguments.scene,
        HumanCount(scene.len() as u64),
        made.as_secs_f64(),
    )?;
    print_funnel(&mut out, &screening.stats)?;
    print_closest(&mut out, &scene, &screening.conflicts)?;
    let name = format!("{:?}", arguments.scene);
    let drawn = picture::draw(&name, &scene, &screening.conflicts, margin)?;
    picture.write(|mut file| file.write_all(drawn.as_bytes()))?;
    let name = terminal::name(&arguments.picture);
    writeln!(out, "\nthe picture is in {name}")?;
    if let Some((path, _)) = states {
        let name = terminal::name(path);
        let radius = radius.map_or(String::new(), |radius| format!(" --radius {radius}"));
        writeln!(
            out,
            "the states are in {name}; to screen them: screen {name}{radius} --margin {margin}"
        )?;
    }
    if arguments.monitor {
        let span = (start, end);
        if !pool.install(|| watch::run(&mut out, scene, span, margin, &screening.conflicts))? {
            return Err("the monitor and the screening disagree".into());
        }
    }
    Ok(())
}

fn build(generated: Generated) -> Result<Scene, Error> {
    let mut scene = Scene::new();
    // Each actor's states are dropped as soon as its trajectory is built.
    for (tag, actor) in (0..).zip(generated.actors) {
        let body = Body::new(Trajectory::from_states(&actor.states)?)
            .with_hitbox(Hitbox::sphere(actor.radius)?)
            .with_tag(tag);
        scene.insert(body)?;
    }
    Ok(scene)
}

fn print_funnel(out: &mut impl Write, stats: &Stats) -> io::Result<()> {
    let all_pairs = stats.bodies * stats.bodies.saturating_sub(1) / 2;
    let in_slices = all_pairs * stats.slices;
    writeln!(out, "\nfunnel")?;
    for (name, count, of) in [
        ("bodies", stats.bodies, None),
        ("segments", stats.segments, None),
        ("pairs of bodies", all_pairs, None),
        ("pairs in time slices", in_slices, None),
        ("candidates (boxes meet)", stats.candidates, Some(in_slices)),
        ("spans to look at", stats.spans, None),
        (
            "survivors, solved exactly",
            stats.survivors,
            Some(stats.spans),
        ),
        ("encounters", stats.conflicts, Some(stats.survivors)),
    ] {
        let share = of.filter(|&of| of > 0).map_or(String::new(), |of| {
            format!("{:>9.4} %", 100.0 * ratio(count, of))
        });
        let count = HumanCount(count).to_string();
        writeln!(out, "  {name:<34}{count:>16}{share}")?;
    }
    let ms = |time: Duration| time.as_secs_f64() * 1e3;
    let total = stats.total_time.as_secs_f64();
    writeln!(
        out,
        "\n{:.0} ms in all (boxes {:.0}, broad phase {:.0}, narrow phase {:.0}, summed over \
         threads): {} bodies a second",
        ms(stats.total_time),
        ms(stats.bounds_time),
        ms(stats.broad_time),
        ms(stats.narrow_time),
        HumanCount(rounded(ratio(stats.bodies, 1) / total.max(1e-9))),
    )
}

fn print_closest(out: &mut impl Write, scene: &Scene, conflicts: &[Conflict]) -> io::Result<()> {
    writeln!(
        out,
        "\nthe closest encounters\n        \
         body      body      time s   separation m   relative speed m/s   lasts s"
    )?;
    for conflict in closest(conflicts, 10) {
        let tag = |id| scene.body(id).map_or(0, |body| body.tag);
        writeln!(
            out,
            "  {:>10}{:>10}{:>12.3}{:>15.4}{:>21.2}{:>10.3}",
            tag(conflict.a),
            tag(conflict.b),
            conflict.closest.time,
            conflict.closest.separation,
            conflict.closest.relative_velocity.length(),
            conflict.exit - conflict.enter,
        )?;
    }
    Ok(())
}

/// The `count` encounters of least separation, closest first.
fn closest(conflicts: &[Conflict], count: usize) -> Vec<&Conflict> {
    let mut sorted: Vec<&Conflict> = conflicts.iter().collect();
    sorted.sort_by(|x, y| {
        let by_separation = x.closest.separation.total_cmp(&y.closest.separation);
        by_separation.then_with(|| x.order(y))
    });
    sorted.truncate(count);
    sorted
}

#[allow(clippy::cast_precision_loss, reason = "shown to a few digits")]
fn ratio(part: u64, whole: u64) -> f64 {
    part as f64 / whole as f64
}

#[allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "shown to a few digits, never negative"
)]
fn rounded(value: f64) -> u64 {
    value.round() as u64
}
