//! Certified answers of whole scenes against exact arithmetic.
//!
//! Each question is two trajectories from states, a margin and a window, in families that are
//! hard in one way each (`cases`); each answer is checked exactly (`check`). The short campaign is
//! part of the tests. The long one goes on by seeds, 1,200 questions each, and prints its table:
//!
//! ```text
//! NEARMISS_SEEDS=0..9100 cargo test --release --test oracle -- --ignored --nocapture long
//! ```

#![allow(clippy::unwrap_used, reason = "a panic in the oracle is a failed test")]

mod cases;
mod check;
#[path = "../oracle_support/mod.rs"]
mod oracle_support;
#[path = "../../../support/mod.rs"]
mod support;
mod together;
mod told;

use cases::{Case, FAMILIES};
use check::{Truth, Wrong};
use indicatif::{ProgressBar, ProgressStyle};
use rand::SeedableRng;
use rand::rngs::ChaCha8Rng;
use std::fmt;
use std::time::{Duration, Instant};

/// What a campaign found in one family.
#[derive(Clone, Default)]
struct Tally {
    questions: u64,
    isolated: u64,
    conflicts: u64,
    unresolved: u64,
    false_negatives: u64,
    false_positives: u64,
    violations: u64,
    time: Duration,
    /// Widths of the least separation relative to the local scale, as exponents of two, counted
    /// in quarters from 2^-60 on.
    widths: Vec<u64>,
    largest: f64,
}

/// All families, `questions` of each; every `every`-th answer is checked thoroughly.
fn campaign(seed: u64, questions: u32, every: u32, tallies: &mut [Tally]) {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    for (family, tally) in FAMILIES.into_iter().zip(tallies) {
        for number in 0..questions {
            let case = Case::draw(&mut rng, family);
            let scene = case.scene();
            let query = case.query();
            let start = Instant::now();
            let conflicts = scene.screen(&query).unwrap().conflicts;
            tally.time += start.elapsed();
            let truth = Truth::of(&case);
            let mut wrong = truth.wrong(&conflicts);
            if wrong.is_none() && number % every == 0 {
                tally.isolated += 1;
                wrong = truth.wrong_thoroughly(&conflicts);
            }
            tally.count(&case, &conflicts);
            let Some(wrong) = wrong else { continue };
            eprintln!("seed {seed} {family:?} {number}: {wrong:?}\n  {case:?}\n  {conflicts:?}");
            match wrong {
                Wrong::FalseNegative => tally.false_negatives += 1,
                Wrong::FalsePositive => tally.false_positives += 1,
                Wrong::Violation(_) => tally.violations += 1,
            }
        }
    }
}

impl Tally {
    const WIDTHS: usize = 240;

    fn count(&mut self, case: &Case, conflicts: &[nearmiss::Conflict]) {
        self.questions += 1;
        self.widths.resize(Self::WIDTHS, 0);
        let scale = case.scale();
        for conflict in conflicts {
            let proof = conflict.certificate.unwrap();
            self.conflicts += 1;
            self.unresolved += u64::from(!proof.resolved);
            let width = 2.0 * proof.error / scale;
            self.largest = self.largest.max(width);
            #[allow(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "clamped to the table"
            )]
            let place = (4.0 * (width.log2() + 60.0)).clamp(0.0, 239.0) as usize;
            self.widths[place] += 1;
        }
    }

    fn add(&mut self, other: &Self) {
        self.questions += other.questions;
        self.isolated += other.isolated;
        self.conflicts += other.conflicts;
        self.unresolved += other.unresolved;
        self.false_negatives += other.false_negatives;
        self.false_positives += other.false_positives;
        self.violations += other.violations;
        self.time += other.time;
        self.largest = self.largest.max(other.largest);
        self.widths.resize(Self::WIDTHS, 0);
        for (sum, count) in self.widths.iter_mut().zip(&other.widths) {
            *sum += count;
        }
    }

    /// An upper bound of the width that a share of the conflicts does not exceed.
    fn width(&self, share: f64) -> f64 {
        let total: u64 = self.widths.iter().sum();
        let mut seen = 0;
        for (place, count) in (1_u32..).zip(&self.widths) {
            seen += count;
            #[allow(clippy::cast_precision_loss, reason = "a share of counts")]
            if seen as f64 >= share * total as f64 {
                return (f64::from(place) / 4.0 - 60.0).exp2();
            }
        }
        0.0
    }

    fn is_sound(&self) -> bool {
        self.false_negatives + self.false_positives + self.violations == 0
    }
}

impl fmt::Display for Tally {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{} | {} | {} | {} | {} | {} | {} | {:.1e} | {:.1e} | {:.1e} | {:.1}",
            self.questions,
            self.isolated,
            self.conflicts,
            self.unresolved,
            self.false_negatives,
            self.false_positives,
            self.violations,
            self.width(0.5),
            self.width(0.999),
            self.largest,
            self.time.as_secs_f64() * 1e6 / self.questions.max(1) as f64,
        )
    }
}

fn print(tallies: &[Tally]) {
    println!(
        "| family | questions | isolated | conflicts | unresolved | false negatives | false \
         positives | violations | width/L median | 99.9 % | max | µs |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|---|---|");
    let mut all = Tally::default();
    for (family, tally) in FAMILIES.iter().zip(tallies) {
        println!("| {family:?} | {tally} |");
        all.add(tally);
    }
    println!("| all | {all} |");
}

#[test]
fn certificates_hold() {
    let mut tallies = vec![Tally::default(); FAMILIES.len()];
    for seed in 0..6 {
        campaign(seed, 200, 10, &mut tallies);
    }
    print(&tallies);
    assert!(tallies.iter().all(Tally::is_sound));
    assert!(tallies.iter().all(|tally| tally.conflicts > 100));
    // Touches are decided by rounding alone; a margin beside them is not.
    let unresolved: u64 = tallies.iter().map(|tally| tally.unresolved).sum();
    let conflicts: u64 = tallies.iter().map(|tally| tally.conflicts).sum();
    assert!(unresolved > 0 && unresolved < conflicts / 2);
}

#[test]
#[ignore = "long: see the head of this file"]
fn long_campaign() {
    let range = std::env::var("NEARMISS_SEEDS").unwrap_or_else(|_| "0..10".into());
    let (from, to) = range.split_once("..").unwrap();
    let (from, to): (u64, u64) = (from.parse().unwrap(), to.parse().unwrap());
    let bar = ProgressBar::new(to - from).with_style(
        ProgressStyle::with_template("{bar:40} {pos}/{len} seeds, {eta} left, {msg}").unwrap(),
    );
    let mut tallies = vec![Tally::default(); FAMILIES.len()];
    for seed in from..to {
        // Other seeds than the short campaign's.
        campaign(1_000_000 + seed, 100, 50, &mut tallies);
        let wrong = tallies.iter().filter(|tally| !tally.is_sound()).count();
        bar.set_message(format!("{wrong} families with errors"));
        bar.inc(1);
    }
    bar.finish();
    println!("seeds {range}");
    print(&tallies);
    assert!(tallies.iter().all(Tally::is_sound));
}
