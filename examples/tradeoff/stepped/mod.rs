//! A scene stepped by a frame loop: what it finds at which rate, and the time it takes.

mod physics;
mod sensors;
mod steppers;

use crate::table::{Cell, Table};
use crate::timing::{median, repeated, timed};
use crate::world::World;
use crate::{Effort, Failure};
use glam::DVec3;
use nearmiss::{Accuracy, AlertLevel, BodyId, EventKind, Monitor, Query, Trajectory};
use sensors::Sensors;
use std::collections::{BTreeMap, BTreeSet};
use steppers::{Overlaps, ShapeCasts, SweptSpheres};

/// Frames a second.
const RATES: [u32; 8] = [5, 10, 20, 30, 60, 120, 240, 480];
const FEW_RATES: [u32; 2] = [10, 60];

/// Ticks a second of the monitor: one of the rates, which is left out as they are.
const MONITORED: u32 = 60;

/// Largest product of bodies and frames of one rate: some seconds.
const MAX_STEPS: f64 = 1e8;

/// A contact of two bodies seen in a frame.
#[derive(Clone, Copy, Debug)]
struct Contact {
    a: usize,
    b: usize,
    /// Instant of the frame, or within the step that ends there, s.
    time: f64,
    /// Separation, m, where it is known.
    separation: Option<f64>,
}

/// A frame: where all bodies are, and where they were a step before.
struct Frame<'a> {
    time: f64,
    /// Since the frame before, s; 0 at the first one, and shorter at the last one.
    step: f64,
    before: &'a [DVec3],
    now: &'a [DVec3],
    /// The middle of the scene, m, in all frames: f32 is finest there.
    middle: DVec3,
}

/// A way to find contacts frame by frame.
trait Stepper {
    /// Adds the contacts of a frame, or of the step that ends with it.
    fn look(&mut self, frame: &Frame<'_>, found: &mut Vec<Contact>);
}

/// An encounter as it truly is.
struct Encounter {
    enter: f64,
    exit: f64,
    separation: f64,
}

impl Encounter {
    /// The time between the encounter and an instant, s; 0 within it.
    fn apart(&self, time: f64) -> f64 {
        (self.enter - time).max(time - self.exit).max(0.0)
    }
}

/// All encounters by pair of places.
type Truth = BTreeMap<(usize, usize), Vec<Encounter>>;

/// The finds of a way to look at a scene.
#[derive(Default)]
struct Score {
    encounters: usize,
    missed: usize,
    /// Contacts of pairs that are not in an encounter at that time.
    wrong: usize,
    /// Of the first contact seen against the entry, s.
    late: Vec<f64>,
    /// Of the least separation seen, m.
    off: Vec<f64>,
}

impl Score {
    /// Compares contacts with the truth; `step` (s) is the time that a frame may be late. A contact is of the
    /// nearest encounter of its pair, and of no other one.
    fn of(truth: &Truth, found: &[Contact], step: f64) -> Self {
        // Contacts by pair and number of the encounter, and pairs with a contact outside all.
        let mut seen: BTreeMap<((usize, usize), usize), Vec<Contact>> = BTreeMap::new();
        let mut wrong = BTreeSet::new();
        for &contact in found {
            let pair = (contact.a.min(contact.b), contact.a.max(contact.b));
            let encounters = truth.get(&pair).into_iter().flatten();
            let apart = encounters.map(|one| one.apart(contact.time));
            match apart
                .enumerate()
                .min_by(|one, other| one.1.total_cmp(&other.1))
            {
                Some((number, apart)) if apart <= step => {
                    seen.entry((pair, number)).or_default().push(contact);
                }
                // One wrong contact a pair: it may last many frames.
                _ => {
                    wrong.insert(pair);
                }
            }
        }
        let mut score = Self {
            wrong: wrong.len(),
            ..Self::default()
        };
        for (&pair, encounters) in truth {
            for (number, one) in encounters.iter().enumerate() {
                score.encounters += 1;
                let Some(contacts) = seen.get(&(pair, number)) else {
                    score.missed += 1;
                    continue;
                };
                score.late.push((contacts[0].time - one.enter).abs());
                let separations = contacts.iter().filter_map(|contact| contact.separation);
                if let Some(least) = separations.reduce(f64::min) {
                    score.off.push((least - one.separation).abs());
                }
            }
        }
        score
    }

    fn row(
        self,
        method: &str,
        rate: Cell,
        (total, frames): (f64, Option<f64>),
        unit: f64,
    ) -> Vec<Cell> {
        let worst = |values: &[f64]| values.iter().copied().reduce(f64::max);
        vec![
            method.into(),
            rate,
            self.encounters.into(),
            self.missed.into(),
            self.wrong.into(),
            Cell::from((!self.late.is_empty()).then(|| 1e3 * median(self.late.clone()))),
            Cell::from(worst(&self.late).map(|late| 1e3 * late)),
            Cell::from(worst(&self.off)),
            (1e3 * total).into(),
            frames.map(|frames| 1e3 * total / frames).into(),
            (total / unit).into(),
        ]
    }
}

/// Places of bodies by their id.
fn places(world: &World) -> BTreeMap<BodyId, usize> {
    let ids = world.scene.bodies().map(|(id, _)| id);
    ids.zip(0..).collect()
}

/// The encounters by a certified screening.
fn truth(world: &World) -> Result<Truth, Failure> {
    let places = places(world);
    let query = Query::new(world.window)
        .with_margin(world.margin)
        .with_accuracy(Accuracy::Certified);
    let mut truth = Truth::new();
    for conflict in world.scene.screen(&query)?.conflicts {
        let pair = (places[&conflict.a], places[&conflict.b]);
        truth
            .entry((pair.0.min(pair.1), pair.0.max(pair.1)))
            .or_default()
            .push(Encounter {
                enter: conflict.enter,
                exit: conflict.exit,
                separation: conflict.closest.separation,
            });
    }
    Ok(truth)
}

/// Returns the middle of the box around all knots, m.
fn middle(plans: &[&Trajectory]) -> DVec3 {
    let knots = plans.iter().flat_map(|plan| {
        let positions = plan.knots().iter().map(|&time| plan.position(time));
        positions.flatten()
    });
    let (low, high) = knots.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), at| {
        (low.min(at), high.max(at))
    });
    0.5 * low + 0.5 * high
}

/// Lets a stepper look at all frames. Returns its contacts, the time it took, s, and the frames.
fn step(world: &World, rate: u32, stepper: &mut dyn Stepper) -> (Vec<Contact>, f64, f64) {
    let plans = world.plans();
    let middle = middle(&plans);
    let (start, end) = (world.window.start(), world.window.end());
    let (mut before, mut now) = (Vec::new(), Vec::new());
    let (mut found, mut total, mut frames) = (Vec::new(), 0.0, 0.0);
    let mut last = start;
    loop {
        // The window need not last a whole number of frames.
        let time = (start + frames / f64::from(rate)).min(end);
        std::mem::swap(&mut before, &mut now);
        now.clear();
        // A body that is not there is where nobody is.
        now.extend(
            plans
                .iter()
                .map(|plan| plan.position(time).unwrap_or(DVec3::NAN)),
        );
        if before.is_empty() {
            before.clone_from(&now);
        }
        let frame = Frame {
            time,
            step: time - last,
            before: &before,
            now: &now,
            middle,
        };
        total += timed(|| stepper.look(&frame, &mut found)).1;
        frames += 1.0;
        last = time;
        if time >= end {
            return (found, total, frames);
        }
    }
}

/// A monitor that looks ahead, tick by tick: what it predicts, and the time of all its ticks, s.
fn monitored(world: &World, rate: u32) -> Result<(Vec<Contact>, f64, f64), Failure> {
    /// Lookahead, s.
    const AHEAD: f64 = 2.0;
    let places = places(world);
    let (start, end) = (world.window.start(), world.window.end());
    let mut monitor = Monitor::new(
        world.scene.clone(),
        start,
        AHEAD,
        &[AlertLevel::at(world.margin)],
    )?;
    let (mut events, mut found) = (Vec::new(), Vec::new());
    let (mut total, mut ticks) = (0.0, 0.0);
    loop {
        let now = start + ticks / f64::from(rate);
        if now > end {
            return Ok((found, total, ticks));
        }
        events.clear();
        let (done, time) = timed(|| monitor.advance(now, &mut events));
        done?;
        total += time;
        ticks += 1.0;
        for event in &events {
            let (EventKind::Predicted(one) | EventKind::Revised(one) | EventKind::Began(one)) =
                &event.kind
            else {
                continue;
            };
            // What is beyond the window is not asked about.
            if one.enter <= end && !one.open {
                found.push(Contact {
                    a: places[&one.a],
                    b: places[&one.b],
                    time: one.enter,
                    // The truth knows the bodies within the window alone; later they may be closer.
                    separation: (one.exit <= end).then_some(one.closest.separation),
                });
            }
        }
    }
}

/// Measures the finds of a frame loop at each rate, and the time it takes.
pub(crate) fn table(
    world: &World,
    effort: &Effort,
    progress: &dyn Fn(f64),
) -> Result<Table, Failure> {
    let rates = effort.choose(&RATES[..], &FEW_RATES[..]);
    let truth = truth(world)?;
    let seconds = world.window.end() - world.window.start();
    #[allow(clippy::cast_precision_loss, reason = "an estimate")]
    let bodies = world.scene.len() as f64;
    let fits = |rate: u32| bodies * seconds * f64::from(rate) <= MAX_STEPS;
    let count = rates.iter().take_while(|rate| fits(**rate)).count();
    let (rates, left_out) = rates.split_at(count);
    let mut table = Table::new(
        "stepped",
        format!(
            "A scene stepped: {} bodies, {seconds} s, contact within {} m (one thread)",
            world.scene.len(),
            world.margin
        ),
        &[
            "method",
            "Hz",
            "encounters",
            "missed",
            "false",
            "late ms p50",
            "late ms max",
            "separation off m",
            "ms",
            "ms/frame",
            "times nearmiss",
        ],
    );
    let query = Query::new(world.window).with_margin(world.margin);
    let runs = effort.choose(9, 3);
    let (screening, unit) = repeated(runs, || world.scene.screen(&query))?;
    let places = places(world);
    let found: Vec<Contact> = screening
        .conflicts
        .iter()
        .map(|conflict| Contact {
            a: places[&conflict.a],
            b: places[&conflict.b],
            time: conflict.enter,
            separation: Some(conflict.closest.separation),
        })
        .collect();
    let score = Score::of(&truth, &found, 1e-9);
    table.row(score.row("nearmiss, screened once", Cell::Nothing, (unit, None), unit));
    if fits(MONITORED) {
        let (found, total, ticks) = monitored(world, MONITORED)?;
        let score = Score::of(&truth, &found, 1e-9);
        table.row(score.row(
            "nearmiss, monitor 2 s ahead",
            rate_cell(MONITORED),
            (total, Some(ticks)),
            unit,
        ));
    }
    let mut complete: BTreeMap<&str, Option<u32>> = BTreeMap::new();
    let all = rates.len() * 4;
    for (number, &rate) in rates.iter().enumerate() {
        let radii = || -> Vec<f64> {
            let own = world.radii.iter();
            own.map(|radius| radius + 0.5 * world.margin).collect()
        };
        let mut steppers: [(&str, Box<dyn Stepper>); 4] = [
            ("overlap at instants", Box::new(Overlaps::new(radii()))),
            ("swept spheres", Box::new(SweptSpheres::new(radii()))),
            (
                "parry cast_shapes_nonlinear",
                Box::new(ShapeCasts::new(radii())),
            ),
            ("rapier sensors", Box::new(Sensors::new(radii()))),
        ];
        for (which, (name, stepper)) in steppers.iter_mut().enumerate() {
            let (mut found, total, frames) = step(world, rate, stepper.as_mut());
            // Its balls contain half of the margin each.
            for contact in &mut found {
                contact.separation = contact.separation.map(|distance| distance + world.margin);
            }
            let score = Score::of(&truth, &found, 1.0 / f64::from(rate));
            let first = complete.entry(name).or_default();
            if score.missed == 0 && first.is_none() {
                *first = Some(rate);
            }
            table.row(score.row(name, rate_cell(rate), (total, Some(frames)), unit));
            #[allow(clippy::cast_precision_loss, reason = "shown")]
            progress((4 * number + which + 1) as f64 / all as f64);
        }
    }
    if truth.is_empty() {
        // Nothing is missed where there is nothing to find.
        complete.clear();
    }
    add_notes(&mut table, complete, (rates, left_out));
    Ok(table)
}

fn rate_cell(rate: u32) -> Cell {
    Cell::Count(u64::from(rate))
}

/// Says at which rate each stepper misses nothing, and what was measured.
fn add_notes(
    table: &mut Table,
    complete: BTreeMap<&str, Option<u32>>,
    (rates, left_out): (&[u32], &[u32]),
) {
    let highest = rates.last().copied().unwrap_or(0);
    for (name, rate) in complete {
        table.note(match rate {
            Some(rate) => format!("{name}: misses nothing from {rate} Hz on"),
            None => format!("{name}: misses encounters at every rate up to {highest} Hz"),
        });
    }
    table
        .note("late: the first contact seen, or the entry predicted, against the certified entry.");
    table.note("The first three sort boxes along x, and keep the order from frame to frame.");
    table.note("The steppers are given all positions; what it costs to evaluate them is left out.");
    if let Some(rate) = left_out.first() {
        table.note(format!(
            "From {rate} Hz on there are more than {MAX_STEPS:.0e} steps of bodies: left out."
        ));
    }
}
