//! The price of a capability for a scene in which one single body uses it.

use crate::prices::{MARGIN, Use, scene};
use crate::table::Table;
use crate::timing::{median, timed};
use crate::{Effort, Failure};
use nearmiss::{Query, Scene};
use std::hint::black_box;

/// Scenes that are compared: the one body, and what it uses. The last one shows the error of this measurement.
const SCENES: [(&str, Use); 5] = [
    ("layers", Use::Layers),
    ("a cluster", Use::Cluster),
    ("a cluster that turns", Use::Turning),
    ("a model error", Use::ModelError),
    ("nothing (the same scene again)", Use::Nothing),
];

/// Times of one screening of each scene, s: of the scene without, then those of `SCENES`.
type Turn = [f64; SCENES.len() + 1];

/// Screens all scenes once, beginning with the one that has this number. Each is then as often the first as the last.
fn turn(scenes: &[Scene], begin: usize) -> Turn {
    let query = Query::default().with_margin(MARGIN);
    let mut times = Turn::default();
    for step in 0..times.len() {
        let place = (begin + step) % times.len();
        times[place] = timed(|| drop(black_box(scenes[place].screen(&query)))).1;
    }
    times
}

/// Returns the median of some values, and an interval that contains the median of all possible ones in 95 of 100 cases.
fn median_within(mut values: Vec<f64>) -> (f64, [f64; 2]) {
    values.sort_by(f64::total_cmp);
    #[allow(
        clippy::cast_precision_loss,
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a rank of a few dozen"
    )]
    let reach = (0.98 * (values.len() as f64).sqrt()).ceil() as usize;
    let middle = values.len() / 2;
    let (low, high) = (middle.saturating_sub(reach), middle + reach);
    let ends = [values[low], values[high.min(values.len() - 1)]];
    (median(values), ends)
}

/// Cost of the body, as a share of the screening of a scene without it.
pub(crate) fn table(effort: &Effort, progress: &dyn Fn(f64)) -> Result<Table, Failure> {
    let count = effort.choose(10_000, 1_000);
    // Where a scene lies in memory changes its time by a percent: scenes are made again and again.
    let (rounds, turns) = effort.choose((15, 5), (5, 2));
    let mut kinds = vec![Use::Nothing];
    kinds.extend(SCENES.map(|(_, uses)| uses));
    let mut all: Vec<Vec<Turn>> = Vec::new();
    for round in 0..rounds {
        // Each kind of scene is as often the first to be made as the last.
        let mut scenes = (0..kinds.len())
            .map(|step| {
                let place = (round + step) % kinds.len();
                Ok((place, scene(count, kinds[place], false)?))
            })
            .collect::<Result<Vec<(usize, Scene)>, Failure>>()?;
        scenes.sort_by_key(|&(place, _)| place);
        let scenes: Vec<Scene> = scenes.into_iter().map(|(_, scene)| scene).collect();
        // Once before: a first screening takes memory.
        turn(&scenes, 0);
        all.push(
            (0..turns)
                .map(|number| turn(&scenes, round + number))
                .collect(),
        );
        #[allow(clippy::cast_precision_loss, reason = "shown")]
        progress(f64::from(u32::try_from(round + 1)?) / rounds as f64);
    }
    let mut table = Table::new(
        "existence",
        format!("One body of {count} with: what the others pay for it (one thread)"),
        &["one body with", "ms", "percent more", "from", "to"],
    );
    for (place, (name, _)) in (1..).zip(SCENES) {
        // Turns of one round share its scenes, and do not count for themselves.
        let more = all.iter().map(|round: &Vec<Turn>| {
            let ratios = round.iter().map(|times| times[place] / times[0]);
            100.0 * (median(ratios.collect()) - 1.0)
        });
        let (more, [from, to]) = median_within(more.collect());
        let time = median(all.iter().flatten().map(|times| times[place]).collect());
        table.row(vec![
            name.into(),
            (1e3 * time).into(),
            more.into(),
            from.into(),
            to.into(),
        ]);
    }
    table.note(format!(
        "{rounds} rounds of {turns} turns, each round with new scenes. percent more: the median of the rounds' medians, \
         within from and to in 95 of 100 cases."
    ));
    table.note("Levels, certified answers, threads and recordings are asked for by a call: without it, none of their code runs.");
    table.note("The last line is no cost: it shows how far off this measurement may be.");
    Ok(table)
}
