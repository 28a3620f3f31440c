//! Knots of trajectories: motions that are known exactly, fitted more or less finely.

use crate::scenes::{generator, normal_vector, uniform_vector};
use crate::table::Table;
use crate::timing::repeated;
use crate::{Effort, Failure};
use glam::DVec3;
use nearmiss::{Body, BodyId, Conflict, Hitbox, Query, Scene, Trajectory, Window};
use rand::RngExt;
use std::collections::BTreeMap;

/// A motion: position (m) and velocity (m/s) at a time (s).
type Motion = Box<dyn Fn(f64) -> (DVec3, DVec3)>;

/// Bodies whose true motion is known.
struct Known {
    name: &'static str,
    motions: Vec<Motion>,
    radius: f64,
    margin: f64,
    window: Window,
}

/// Circular orbits 7,000 km from the centre, in shells 100 m apart.
fn orbits(count: usize) -> Result<Known, Failure> {
    /// m³/s².
    const MU: f64 = 3.986_004_418e14;
    let mut rng = generator(5);
    let motions = (0..count).map(|_| {
        let radius = 7.0e6 + 100.0 * f64::from(rng.random_range(0..8_u32));
        let rate = (MU / radius.powi(3)).sqrt();
        let x = normal_vector(&mut rng, 1.0).normalize();
        let y = x.cross(normal_vector(&mut rng, 1.0)).normalize();
        let motion = move |time: f64| {
            let (sin, cos) = (rate * time).sin_cos();
            (
                radius * (cos * x + sin * y),
                radius * rate * (cos * y - sin * x),
            )
        };
        Box::new(motion) as Motion
    });
    Ok(Known {
        name: "orbits",
        motions: motions.collect(),
        radius: 1.0,
        margin: 2_000.0,
        window: Window::new(0.0, 6_000.0)?,
    })
}

/// Drones between points, at rest at each of them: the motion of least snap.
fn drones(count: usize) -> Result<Known, Failure> {
    /// Time of a hop, s, and hops.
    const HOP: f64 = 12.0;
    const HOPS: u32 = 5;
    let mut rng = generator(6);
    let motions = (0..count).map(|_| {
        let mut place = uniform_vector(&mut rng, 150.0);
        let mut places = vec![place];
        for _ in 0..HOPS {
            place += uniform_vector(&mut rng, 60.0);
            places.push(place);
        }
        let motion = move |time: f64| {
            let hop = (time / HOP).floor().clamp(0.0, f64::from(HOPS - 1));
            let s = (time / HOP - hop).clamp(0.0, 1.0);
            let along = s.powi(4) * (35.0 + s * (-84.0 + s * (70.0 - 20.0 * s)));
            let rate = 140.0 * (s * (1.0 - s)).powi(3) / HOP;
            #[allow(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "a few hops"
            )]
            let from = hop as usize;
            let way = places[from + 1] - places[from];
            (places[from] + along * way, rate * way)
        };
        Box::new(motion) as Motion
    });
    Ok(Known {
        name: "drones",
        motions: motions.collect(),
        radius: 0.5,
        margin: 4.0,
        window: Window::new(0.0, HOP * f64::from(HOPS))?,
    })
}

/// Things in a game that swing around a place.
fn game(count: usize) -> Result<Known, Failure> {
    let mut rng = generator(7);
    let motions = (0..count).map(|_| {
        let place = uniform_vector(&mut rng, 60.0);
        let swings: [(DVec3, f64, f64); 3] = std::array::from_fn(|_| {
            let rate = rng.random_range(0.3..2.0);
            (
                normal_vector(&mut rng, 4.0 / rate),
                rate,
                rng.random_range(0.0..6.0),
            )
        });
        let motion = move |time: f64| {
            swings
                .iter()
                .fold((place, DVec3::ZERO), |(at, speed), &(way, rate, phase)| {
                    let (sin, cos) = (rate * time + phase).sin_cos();
                    (at + sin * way, speed + rate * cos * way)
                })
        };
        Box::new(motion) as Motion
    });
    Ok(Known {
        name: "game",
        motions: motions.collect(),
        radius: 0.5,
        margin: 0.0,
        window: Window::new(0.0, 20.0)?,
    })
}

/// A scene of fits, with the mean number of knots and the largest error, m.
fn fitted(known: &Known, tolerance: f64, with_error: bool) -> Result<(Scene, f64, f64), Failure> {
    let mut scene = Scene::new();
    let (mut knots, mut largest) = (0, 0.0_f64);
    for motion in &known.motions {
        let fit = Trajectory::fit(motion, known.window, tolerance)?;
        knots += fit.knot_count();
        largest = largest.max(fit.error());
        let error = if with_error { fit.error() } else { 0.0 };
        let body = Body::new(fit.trajectory).with_hitbox(Hitbox::sphere(known.radius)?);
        scene.insert(body.with_model_error(error)?)?;
    }
    #[allow(clippy::cast_precision_loss, reason = "a mean")]
    let mean = knots as f64 / known.motions.len() as f64;
    Ok((scene, mean, largest))
}

/// Conflicts by pair, in time order.
type ByPair = BTreeMap<(BodyId, BodyId), Vec<Conflict>>;

fn by_pair(conflicts: Vec<Conflict>) -> ByPair {
    let mut found = ByPair::new();
    for conflict in conflicts {
        found
            .entry((conflict.a, conflict.b))
            .or_default()
            .push(conflict);
    }
    found
}

/// Counts the conflicts of `these` that overlap none of `those`.
fn without_partner(these: &ByPair, those: &ByPair) -> usize {
    let none = Vec::new();
    let lonely = |(pair, own): (&(BodyId, BodyId), &Vec<Conflict>)| {
        let others = those.get(pair).unwrap_or(&none);
        let overlap = |one: &&Conflict| {
            !others
                .iter()
                .any(|other| one.enter <= other.exit && other.enter <= one.exit)
        };
        own.iter().filter(overlap).count()
    };
    these.iter().map(lonely).sum()
}

/// The largest differences of separation (m) and entry (s) of conflicts that overlap one of the truth.
fn differences(found: &ByPair, truth: &ByPair) -> (f64, f64) {
    let mut worst = (0.0_f64, 0.0_f64);
    for (pair, own) in found {
        for one in own {
            let overlaps = |other: &&Conflict| one.enter <= other.exit && other.enter <= one.exit;
            let partner = truth
                .get(pair)
                .and_then(|others| others.iter().find(overlaps));
            if let Some(other) = partner {
                let off = (one.closest.separation - other.closest.separation).abs();
                worst.0 = worst.0.max(off);
                worst.1 = worst.1.max((one.enter - other.enter).abs());
            }
        }
    }
    worst
}

/// Tolerance of fits against knots, time and wrong answers about the true motion.
pub(super) fn table(effort: &Effort) -> Result<Table, Failure> {
    /// Of the fits that stand for the truth, m.
    const TRUE: f64 = 1e-5;
    let runs = effort.choose(5, 1);
    let worlds = [
        orbits(effort.choose(1_000, 60))?,
        drones(effort.choose(1_000, 60))?,
        game(effort.choose(1_000, 100))?,
    ];
    let mut table = Table::new(
        "knots",
        "Knots: fits of known motions (one thread)",
        &[
            "motion",
            "tolerance m",
            "error m",
            "knots/body",
            "encounters",
            "missed",
            "false",
            "missed with error",
            "separation off m",
            "entry off ms",
            "ms",
        ],
    );
    let mut true_counts = Vec::new();
    for known in &worlds {
        let query = Query::new(known.window).with_margin(known.margin);
        let (scene, ..) = fitted(known, TRUE, false)?;
        let truth = by_pair(scene.screen(&query)?.conflicts);
        let true_count: usize = truth.values().map(Vec::len).sum();
        true_counts.push(format!("{true_count} of {}", known.name));
        for &tolerance in effort.choose(&[10.0, 1.0, 0.1, 0.01, 0.001][..], &[1.0, 0.01][..]) {
            let (scene, knots, error) = fitted(known, tolerance, false)?;
            let (screening, time) = repeated(runs, || scene.screen(&query))?;
            let found = by_pair(screening.conflicts);
            let (scene, ..) = fitted(known, tolerance, true)?;
            let careful = by_pair(scene.screen(&query)?.conflicts);
            let (off, late) = differences(&found, &truth);
            table.row(vec![
                known.name.into(),
                tolerance.into(),
                error.into(),
                knots.into(),
                found.values().map(Vec::len).sum::<usize>().into(),
                without_partner(&truth, &found).into(),
                without_partner(&found, &truth).into(),
                without_partner(&truth, &careful).into(),
                off.into(),
                (1e3 * late).into(),
                (1e3 * time).into(),
            ]);
        }
    }
    table.note(format!(
        "encounters: those reported. The truth, fits within {TRUE:.0e} m, has {}.",
        true_counts.join(", ")
    ));
    table.note(
        "missed with error: the fit's error is given to the bodies (Body::with_model_error).",
    );
    Ok(table)
}
