//! Knots of trajectories: motions that are known exactly, fitted more or less finely.

use super::motions::{Known, drones, game, orbits};
use crate::table::Table;
use crate::timing::repeated;
use crate::{Effort, Failure};
use nearmiss::{
    Accuracy, Body, BodyId, Conflict, Fit, FitOptions, Hitbox, Query, Scene, Trajectory,
};
use std::collections::BTreeMap;

/// Proven error of the fits that the truth is computed from, m.
const REFERENCE: f64 = 1e-5;

/// Bodies that follow fits of the known motions.
struct Fitted {
    scene: Scene,
    /// Mean number of knots of a body.
    knots: f64,
    /// Largest error of a fit, m.
    error: f64,
}

impl Fitted {
    /// Fits all motions by `fit`. The bodies are given the errors if `with_error` is true.
    fn of(
        known: &Known,
        with_error: bool,
        fit: impl Fn(usize) -> Result<Fit, nearmiss::Error>,
    ) -> Result<Self, Failure> {
        let mut scene = Scene::new();
        let (mut knots, mut largest) = (0, 0.0_f64);
        for number in 0..known.motions.len() {
            let fit = fit(number)?;
            knots += fit.knot_count();
            largest = largest.max(fit.error());
            let error = if with_error { fit.error() } else { 0.0 };
            let body = Body::new(fit.trajectory).with_hitbox(Hitbox::sphere(known.radius)?);
            scene.insert(body.with_model_error(error)?)?;
        }
        #[allow(clippy::cast_precision_loss, reason = "a mean")]
        let knots = knots as f64 / known.motions.len() as f64;
        Ok(Self {
            scene,
            knots,
            error: largest,
        })
    }

    /// Fits as a user does who knows the motions by their values alone.
    fn within(known: &Known, tolerance: f64, with_error: bool) -> Result<Self, Failure> {
        Self::of(known, with_error, |number| {
            let motion = &known.motions[number].at;
            Trajectory::fit(motion, known.window, tolerance)
        })
    }

    /// Fits with proven errors: certified answers are then of the motions themselves.
    fn proven(known: &Known) -> Result<Self, Failure> {
        /// Rounding of the motions' values in units of the last place: arguments of sines are rounded, too.
        const ULPS: f64 = 64.0;
        Self::of(known, true, |number| {
            let motion = &known.motions[number];
            let options = FitOptions::default()
                .with_fourth_derivative(motion.fourth_derivative)
                .with_ulps(ULPS);
            Trajectory::fit_with(&motion.at, known.window, REFERENCE, &options)
        })
    }
}

/// Conflicts by pair, in time order.
type ByPair = BTreeMap<(BodyId, BodyId), Vec<Conflict>>;

fn by_pair(conflicts: impl IntoIterator<Item = Conflict>) -> ByPair {
    let mut found = ByPair::new();
    for conflict in conflicts {
        found
            .entry((conflict.a, conflict.b))
            .or_default()
            .push(conflict);
    }
    found
}

/// Certified conflicts of the true motions.
struct Truth {
    /// Conflicts that certainly exist.
    certain: ByPair,
    /// All that may exist.
    possible: ByPair,
}

impl Truth {
    fn of(known: &Known, query: &Query) -> Result<Self, Failure> {
        let query = query.with_accuracy(Accuracy::Certified);
        let conflicts = Fitted::proven(known)?.scene.screen(&query)?.conflicts;
        let is_certain = |one: &Conflict| one.certificate.is_some_and(|it| it.resolved);
        Ok(Self {
            certain: by_pair(conflicts.iter().copied().filter(is_certain)),
            possible: by_pair(conflicts),
        })
    }

    /// Returns the numbers of conflicts that certainly exist, and of those that are undecided.
    fn counts(&self) -> (usize, usize) {
        let count = |conflicts: &ByPair| conflicts.values().map(Vec::len).sum::<usize>();
        let certain = count(&self.certain);
        (certain, count(&self.possible) - certain)
    }
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

/// The largest differences of separation (m) and entry (s) between conflicts and the enclosures of the truth. A conflict
/// that overlaps several, or one with others, is left out: it is not one of them.
fn differences(found: &ByPair, truth: &ByPair) -> (f64, f64) {
    let mut worst = (0.0_f64, 0.0_f64);
    for (pair, own) in found {
        let others = truth.get(pair).map_or(&[][..], |others| others);
        for one in own {
            let Some(other) = only_overlap(one, others) else {
                continue;
            };
            let (Some(proven), Some(_)) = (other.certificate, only_overlap(other, own)) else {
                continue;
            };
            let off = (one.closest.separation - other.closest.separation).abs();
            let (early, late) = (
                proven.enter.earliest - one.enter,
                one.enter - proven.enter.latest,
            );
            worst.0 = worst.0.max(off - proven.error);
            worst.1 = worst.1.max(early).max(late);
        }
    }
    worst
}

/// Returns the conflict of a list that overlaps one, if there is one only.
fn only_overlap<'a>(one: &Conflict, others: &'a [Conflict]) -> Option<&'a Conflict> {
    let overlaps = |other: &&Conflict| one.enter <= other.exit && other.enter <= one.exit;
    let mut found = others.iter().filter(overlaps);
    found.next().filter(|_| found.next().is_none())
}

/// Tolerance of fits against knots, time and wrong answers about the true motion.
pub(super) fn table(effort: &Effort) -> Result<Table, Failure> {
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
    let (mut true_counts, mut all_undecided) = (Vec::new(), 0);
    for known in &worlds {
        let query = Query::new(known.window).with_margin(known.margin);
        let truth = Truth::of(known, &query)?;
        let (certain, undecided) = truth.counts();
        true_counts.push(format!("{certain} of {}", known.name));
        all_undecided += undecided;
        for &tolerance in effort.choose(&[10.0, 1.0, 0.1, 0.01, 0.001][..], &[1.0, 0.01][..]) {
            let fitted = Fitted::within(known, tolerance, false)?;
            let (screening, time) = repeated(runs, || fitted.scene.screen(&query))?;
            let found = by_pair(screening.conflicts);
            let careful = Fitted::within(known, tolerance, true)?;
            let careful = by_pair(careful.scene.screen(&query)?.conflicts);
            let (off, late) = differences(&found, &truth.possible);
            table.row(vec![
                known.name.into(),
                tolerance.into(),
                fitted.error.into(),
                fitted.knots.into(),
                found.values().map(Vec::len).sum::<usize>().into(),
                without_partner(&truth.certain, &found).into(),
                without_partner(&found, &truth.possible).into(),
                without_partner(&truth.certain, &careful).into(),
                off.into(),
                (1e3 * late).into(),
                (1e3 * time).into(),
            ]);
        }
    }
    table.note(format!(
        "missed, false: against certified conflicts of the true motions, from fits with proven errors of {REFERENCE:.0e} m."
    ));
    table.note(format!(
        "The true motions certainly have {}; undecided of all: {all_undecided}.",
        true_counts.join(", ")
    ));
    table.note(
        "off: from the enclosures of the true motions, where one encounter is one. The entry of a grazing encounter \
         moves by far more than the fit's error does.",
    );
    table.note(
        "missed with error: the fit's error is given to the bodies (Body::with_model_error).",
    );
    Ok(table)
}
