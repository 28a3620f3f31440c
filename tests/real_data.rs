//! Real trajectories against their independent oracles: the folder in `NEARMISS_DATA`.
//!
//! Its files may not be copied into the project, so without the variable these tests say that
//! they were skipped.

#![allow(
    clippy::unwrap_used,
    reason = "a file that cannot be read fails the test"
)]

mod support;

use flate2::read::MultiGzDecoder;
use glam::DVec3;
use nearmiss::internals::{Method, QueryInternals};
use nearmiss::{Accuracy, Body, Conflict, Query, Scene, State, Trajectory, Window};
use std::collections::BTreeMap;
use std::fs::File;
use std::path::PathBuf;
use support::{hash, on_threads, sliced};

/// What goes less than this under the threshold may be reported or not, m.
const SHALLOW: f64 = 1e-6;
/// How far separations may be off, m: the oracle itself is good to 2e-9.
const SEPARATION: f64 = 1e-6;

struct OracleInterval {
    enter: f64,
    exit: f64,
    tca: f64,
    distance: f64,
    clip: u8,
}

/// Tolerance of times, s: satellites drift past each other for minutes, their oracle is good to
/// 2e-7 s there.
fn compare(name: &str, intervals: &str, threshold: f64, time_tolerance: f64) {
    let Some(folder) = std::env::var_os("NEARMISS_DATA").map(PathBuf::from) else {
        eprintln!("{name}: skipped, NEARMISS_DATA is not set");
        return;
    };
    let scene = load(&folder.join(format!("{name}.csv.gz")));
    let query = Query::new(Window::ALL).with_margin(threshold);
    let conflicts = scene.screen(&query).unwrap().conflicts;
    let oracle = load_oracle(&folder.join(format!("{intervals}.intervals.csv")));
    let mut found: BTreeMap<(u64, u64), Vec<&Conflict>> = BTreeMap::new();
    for conflict in &conflicts {
        let tags = [conflict.a, conflict.b].map(|id| scene.body(id).unwrap().tag);
        found.entry((tags[0], tags[1])).or_default().push(conflict);
    }
    let (mut matched, mut off) = (0, (0.0, 0.0));
    for (pair, expected) in &oracle {
        let of_pair = found.remove(pair).unwrap_or_default();
        let mut extra = of_pair;
        for interval in expected {
            let place = extra
                .iter()
                .position(|conflict| agrees(conflict, interval, time_tolerance));
            match place {
                Some(place) => {
                    let conflict = extra.remove(place);
                    check(name, *pair, conflict, interval, time_tolerance);
                    include(&mut off, conflict, interval);
                    matched += 1;
                }
                None => assert!(
                    interval.distance > threshold - SHALLOW,
                    "{name}: {pair:?} misses [{}, {}]; has {extra:?}",
                    interval.enter,
                    interval.exit
                ),
            }
        }
        check_extras(name, *pair, &extra, threshold);
    }
    for (pair, extra) in &found {
        check_extras(name, *pair, extra, threshold);
    }
    let (time, separation) = off;
    eprintln!(
        "{name} at {threshold} m: {matched} intervals agree to {time:.1e} s and {separation:.1e} m"
    );
    assert!(matched > 0);
    check_certificates(name, &scene, &query, &conflicts);
    check_ways(name, &scene, &query, &conflicts);
}

/// Other methods, slicings and numbers of threads than the defaults', which gave this answer.
fn check_ways(name: &str, scene: &Scene, query: &Query, answer: &[Conflict]) {
    /// What takes seconds each time is asked once, above.
    const MAX: usize = 5_000;
    const WAYS: [(Method, u32, usize); 7] = [
        (Method::Sweep, 0, 1),
        (Method::Sweep, 7, 2),
        (Method::Sweep, 1_000, 3),
        (Method::Sweep, 100, 4),
        (Method::Tree, 0, 3),
        (Method::Tree, 100, 2),
        (Method::BruteForce, 0, 4),
    ];
    if scene.len() > MAX {
        return;
    }
    for way in WAYS {
        let (method, slices, threads) = way;
        let query = sliced(query.with_method(method), slices);
        let found = on_threads(threads, || scene.screen(&query)).unwrap();
        assert_eq!(hash(&found.conflicts), hash(answer), "{name}: {way:?}");
    }
}

/// Certified answers are the same conflicts, none of them open, narrowly enclosed.
fn check_certificates(name: &str, scene: &Scene, query: &Query, exact: &[Conflict]) {
    let query = query.with_accuracy(Accuracy::Certified);
    let certified = scene.screen(&query).unwrap().conflicts;
    assert_eq!(certified.len(), exact.len(), "{name}");
    check_ways(name, scene, &query, &certified);
    let mut widths = Vec::new();
    for (plain, conflict) in exact.iter().zip(&certified) {
        let proof = conflict.certificate.unwrap();
        assert!(proof.resolved, "{name}: {conflict:?}");
        let off = (plain.closest.separation - conflict.closest.separation).abs();
        assert!(off <= 2.0 * proof.error, "{name}: {plain:?} {conflict:?}");
        // A lower bound of the local scale: what the pair moves in this conflict is left out.
        let origins = [plain.a, plain.b].map(|id| {
            let trajectory = &scene.body(id).unwrap().trajectory;
            let segments = trajectory.segments();
            let time = conflict.closest.time;
            let place = segments.partition_point(|segment| segment.end() < time);
            let segment = segments[place.min(segments.len() - 1)];
            (segment.origin(), segment.extent())
        });
        let scale = origins[0].0.distance(origins[1].0) + origins[0].1 + origins[1].1;
        widths.push(2.0 * proof.error / scale);
    }
    widths.sort_unstable_by(f64::total_cmp);
    let (median, largest) = (widths[widths.len() / 2], widths[widths.len() - 1]);
    eprintln!("{name}: width of the separation {median:.1e} (median), {largest:.1e} (largest)");
    assert!(
        median <= 1e-14 && largest <= 1e-12,
        "{name}: {median} {largest}"
    );
}

fn agrees(conflict: &Conflict, interval: &OracleInterval, tolerance: f64) -> bool {
    (conflict.enter - interval.enter).abs() <= tolerance
        && (conflict.exit - interval.exit).abs() <= tolerance
}

fn check(
    name: &str,
    pair: (u64, u64),
    conflict: &Conflict,
    interval: &OracleInterval,
    tolerance: f64,
) {
    let closest = &conflict.closest;
    assert!(
        (closest.separation - interval.distance).abs() <= SEPARATION,
        "{name}: {pair:?} separation {} against {}",
        closest.separation,
        interval.distance
    );
    // Bit 4 of the oracle's clip: the distance is constant, any instant is the closest.
    assert!(
        interval.clip & 4 != 0 || (closest.time - interval.tca).abs() <= tolerance,
        "{name}: {pair:?} closest at {} against {}",
        closest.time,
        interval.tca
    );
    assert_eq!(conflict.clip.bits(), interval.clip & 3, "{name}: {pair:?}");
}

/// Includes how far a conflict is off in the largest differences of an instant (s) and a separation (m).
fn include((time, separation): &mut (f64, f64), conflict: &Conflict, interval: &OracleInterval) {
    let closest = &conflict.closest;
    let ends = [
        conflict.enter - interval.enter,
        conflict.exit - interval.exit,
    ];
    // Of a constant distance any instant is the closest.
    let tca = (interval.clip & 4 == 0).then_some(closest.time - interval.tca);
    for difference in ends.into_iter().chain(tca) {
        *time = time.max(difference.abs());
    }
    *separation = separation.max((closest.separation - interval.distance).abs());
}

/// The oracle's condition is open, the crate's closed: a common domain of one instant, and what
/// only just touches, are the crate's own.
fn check_extras(name: &str, pair: (u64, u64), extra: &[&Conflict], threshold: f64) {
    for conflict in extra {
        let an_instant = conflict.enter.to_bits() == conflict.exit.to_bits();
        assert!(
            an_instant || conflict.closest.separation > threshold - SHALLOW,
            "{name}: {pair:?} has an interval too many: {conflict:?}"
        );
    }
}

fn load(path: &PathBuf) -> Scene {
    let mut reader = csv::Reader::from_reader(MultiGzDecoder::new(File::open(path).unwrap()));
    let rows = reader
        .deserialize::<(u64, f64, f64, f64, f64, f64, f64, f64)>()
        .map(|row| {
            let (body, t, px, py, pz, vx, vy, vz) = row.unwrap();
            let position = DVec3::new(px, py, pz);
            (body, State::new(t, position, DVec3::new(vx, vy, vz)))
        });
    let mut scene = Scene::new();
    for (tag, trajectory) in Trajectory::group_rows(rows).unwrap() {
        scene.insert(Body::new(trajectory).with_tag(tag)).unwrap();
    }
    scene
}

fn load_oracle(path: &PathBuf) -> BTreeMap<(u64, u64), Vec<OracleInterval>> {
    let mut oracle: BTreeMap<_, Vec<_>> = BTreeMap::new();
    let mut reader = csv::Reader::from_path(path).unwrap();
    for row in reader.deserialize::<(u64, u64, f64, f64, f64, f64, u8)>() {
        let (i, j, enter, exit, tca, distance, clip) = row.unwrap();
        oracle.entry((i, j)).or_default().push(OracleInterval {
            enter,
            exit,
            tca,
            distance,
            clip,
        });
    }
    oracle
}

#[test]
fn game() {
    compare("game-a", "game-a", 1.5, 1e-6);
}

#[test]
fn crowd() {
    compare("crowd-a", "crowd-a", 0.4, 1e-6);
}

#[test]
fn campus() {
    compare("campus-a", "campus-a", 0.6, 1e-6);
}

#[test]
fn pedestrians() {
    compare("peds-a", "peds-a", 0.5, 1e-6);
}

#[test]
fn aircraft() {
    compare("aircraft-a", "aircraft-a", 1852.0, 1e-6);
}

#[test]
fn aircraft_at_five_miles() {
    compare("aircraft-a", "aircraft-a-D9260", 9260.0, 1e-6);
}

#[test]
fn satellites() {
    compare("sat-small-a", "sat-small-a", 5000.0, 1e-4);
}

#[test]
fn the_low_orbit_catalogue() {
    compare("sat-large-a", "sat-large-a", 5000.0, 1e-4);
}
