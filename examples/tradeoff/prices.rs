//! A price list: what each capability costs the scene that uses it.

use crate::scenes::{Shape, generator, normal_vector, swarm};
use crate::table::Table;
use crate::timing::{in_turns, median, timed};
use crate::{Effort, Failure};
use glam::{DQuat, DVec3};
use nearmiss::live::{LiveOptions, ReportKind};
use nearmiss::{
    Accuracy, AlertLevel, Body, Hitbox, Layers, Monitor, Orientation, Query, Scene, Sphere, State,
    Trajectory,
};
use rand::RngExt;
use rand::rngs::ChaCha8Rng;
use std::f64::consts::TAU;
use std::hint::black_box;

/// Separation that counts, m.
pub(crate) const MARGIN: f64 = 5.0;
/// Reach of each body, m.
const REACH: f64 = 2.0;
/// Frames a second, and frames that a monitor goes on for in a turn.
const RATE: f64 = 60.0;
const FRAMES: u32 = 30;

/// A capability that a body may use.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Use {
    Nothing,
    /// One of four layers, whose members do not meet each other.
    Layers,
    /// Eight spheres instead of one.
    Cluster,
    /// Eight spheres that turn once in 12 s.
    Turning,
    /// The plan is within a decimetre of the world.
    ModelError,
}

fn direction(rng: &mut ChaCha8Rng) -> DVec3 {
    normal_vector(rng, 1.0).normalize()
}

fn body(rng: &mut ChaCha8Rng, number: usize, states: &[State], uses: Use) -> Result<Body, Failure> {
    let body = Body::new(Trajectory::from_states(states)?);
    let ball = Hitbox::sphere(REACH)?;
    let cluster = |rng: &mut ChaCha8Rng| {
        let sphere = |_| {
            let radius = REACH * rng.random_range(0.15..0.35);
            Sphere {
                offset: direction(rng) * (REACH - radius),
                radius,
            }
        };
        Hitbox::cluster((0..8).map(sphere).collect())
    };
    Ok(match uses {
        Use::Nothing => body.with_hitbox(ball),
        Use::Layers => body
            .with_hitbox(ball)
            .with_layers(Layers::new(1 << (number % 4), !(1 << (number % 4)))),
        Use::Cluster => body.with_hitbox(cluster(rng)?),
        Use::ModelError => body.with_hitbox(ball).with_model_error(0.1)?,
        Use::Turning => {
            let hitbox = cluster(rng)?;
            let spin = Orientation::spin(0.0, DQuat::IDENTITY, direction(rng) * (TAU / 12.0))?;
            body.with_hitbox(hitbox).with_orientation(spin)
        }
    })
}

/// A swarm, all bodies of which use something, or only one.
pub(crate) fn scene(count: usize, uses: Use, all: bool) -> Result<Scene, Failure> {
    let mut rng = generator(2);
    let mut scene = Scene::new();
    for (number, actor) in swarm(count, Shape::Cube, 1).actors.into_iter().enumerate() {
        let own = if all || number == count / 2 {
            uses
        } else {
            Use::Nothing
        };
        scene.insert(body(&mut rng, number, &actor.states, own)?)?;
    }
    Ok(scene)
}

/// Screenings: each capability used by all.
fn screenings(effort: &Effort, table: &mut Table, progress: &dyn Fn(f64)) -> Result<(), Failure> {
    let count = effort.choose(10_000, 1_000);
    let turns = effort.choose(15, 3);
    let query = Query::default().with_margin(MARGIN);
    let certified = query.with_accuracy(Accuracy::Certified);
    let runs = [
        ("balls", Use::Nothing, &query),
        ("+ layers", Use::Layers, &query),
        ("+ clusters of 8 spheres", Use::Cluster, &query),
        ("+ clusters that turn", Use::Turning, &query),
        ("+ model errors", Use::ModelError, &query),
        ("+ certified", Use::Nothing, &certified),
    ];
    let scenes = runs.iter().map(|&(_, uses, _)| scene(count, uses, true));
    let scenes = scenes.collect::<Result<Vec<Scene>, Failure>>()?;
    progress(0.2);
    let mut works: Vec<_> = scenes
        .iter()
        .zip(&runs)
        .map(|(scene, (.., query))| move || drop(black_box(scene.screen(query))))
        .collect();
    // Once before: a first screening takes memory.
    works.iter_mut().for_each(|work| work());
    let times = in_turns(turns, &mut works);
    for ((name, ..), (time, ratio)) in runs.iter().zip(times) {
        table.row(vec![
            "screening".into(),
            (*name).into(),
            (1e3 * time).into(),
            ratio.into(),
        ]);
    }
    Ok(())
}

/// Some frames of a monitor. Returns the time they took, s, without that of the monitor's end.
type Life = fn(Monitor) -> Result<f64, Failure>;

/// Goes on for some frames after the first tick.
fn live_through(mut monitor: Monitor) -> Result<f64, Failure> {
    let mut events = Vec::new();
    let frames = || -> Result<(), Failure> {
        for frame in 1..=FRAMES {
            events.clear();
            monitor.advance(f64::from(frame) / RATE, &mut events)?;
            black_box(&events);
        }
        Ok(())
    };
    let (done, time) = timed(frames);
    done.map(|()| time)
}

/// Goes on for some frames on a thread of its own: each frame is sent, and its report awaited. The time leaves out
/// the thread's beginning and end.
fn live_apart(monitor: Monitor) -> Result<f64, Failure> {
    let live = monitor.spawn(LiveOptions::default())?;
    let game = live.handle();
    let frames = || -> Result<(), Failure> {
        for frame in 1..=FRAMES {
            let time = f64::from(frame) / RATE;
            game.advance(time)
                .map_err(|_| "the monitor's thread takes no requests")?;
            let is_this =
                |kind: &ReportKind| matches!(kind, ReportKind::Ticked { now, .. } if *now >= time);
            while !is_this(&live.reports().recv()?.kind) {}
        }
        Ok(())
    };
    let (done, time) = timed(frames);
    live.shutdown()
        .map_err(|_| "the monitor's thread panicked")?;
    done.map(|()| time)
}

/// Begins a recording; what it writes down at first is no part of a tick.
#[cfg(feature = "recording")]
fn recorded(mut monitor: Monitor) -> Result<Monitor, Failure> {
    monitor.start_recording(std::io::sink())?;
    Ok(monitor)
}

/// Names of the monitors that are compared.
const MONITORS: &[&str] = &[
    "a tick, one level",
    "+ a second level",
    "+ a thread of its own",
    #[cfg(feature = "recording")]
    "+ recording",
];

/// Monitors: levels, a thread of its own, a recording.
fn monitors(effort: &Effort, table: &mut Table, progress: &dyn Fn(f64)) -> Result<(), Failure> {
    let count = effort.choose(10_000, 1_000);
    let turns = effort.choose(9, 3);
    let scene = scene(count, Use::Nothing, true)?;
    let monitor = |levels: &[AlertLevel]| -> Result<Monitor, Failure> {
        let mut monitor = Monitor::new(scene.clone(), 0.0, 10.0, levels)?;
        // The first tick looks at all that is ahead; it is left out.
        monitor.advance(0.0, &mut Vec::new())?;
        Ok(monitor)
    };
    let one = [AlertLevel::at(MARGIN)];
    let two = [AlertLevel::at(MARGIN), AlertLevel::at(0.0)];
    let mut times = vec![Vec::new(); MONITORS.len()];
    for turn in 0..turns {
        let lives: [(Monitor, Life); MONITORS.len()] = [
            (monitor(&one)?, live_through),
            (monitor(&two)?, live_through),
            (monitor(&one)?, live_apart),
            #[cfg(feature = "recording")]
            (recorded(monitor(&one)?)?, live_through),
        ];
        for ((monitor, life), times) in lives.into_iter().zip(&mut times) {
            times.push(life(monitor)? / f64::from(FRAMES));
        }
        #[allow(clippy::cast_precision_loss, reason = "shown")]
        progress(0.4 + 0.6 * (turn + 1) as f64 / turns as f64);
    }
    let ratio = |own: &[f64]| {
        let ratios = own.iter().zip(&times[0]).map(|(own, first)| own / first);
        median(ratios.collect())
    };
    for (name, own) in MONITORS.iter().zip(&times) {
        let time = median(own.clone());
        table.row(vec![
            "monitor".into(),
            (*name).into(),
            (1e3 * time).into(),
            ratio(own).into(),
        ]);
    }
    Ok(())
}

/// The price list.
pub(crate) fn table(effort: &Effort, progress: &dyn Fn(f64)) -> Result<Table, Failure> {
    let count = effort.choose(10_000, 1_000);
    let mut table = Table::new(
        "prices",
        format!("A price list: {count} bodies of the swarm, {MARGIN} m, one thread"),
        &["work", "with", "ms", "times the first"],
    );
    screenings(effort, &mut table, progress)?;
    monitors(effort, &mut table, progress)?;
    table.note("screening: a minute of plans. A tick: 1/60 s, 10 s ahead, no plan changes.");
    table.note("certified: of the splines.");
    #[cfg(not(feature = "recording"))]
    table.note("With --features recording there is a row for recordings.");
    Ok(table)
}
