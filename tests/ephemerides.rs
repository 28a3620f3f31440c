//! The worth of cubics between states of satellites: real ephemerides from the folder in `NEARMISS_DATA`. The figures
//! are in the guide: `cargo test --test ephemerides -- --nocapture` prints them.
//!
//! The files may not be copied into the project, so without the variable these tests say that they were skipped.

#![allow(
    clippy::unwrap_used,
    reason = "a file that cannot be read fails the test"
)]

use flate2::read::MultiGzDecoder;
use nearmiss::glam::DVec3;
use nearmiss::{Body, Query, Scene, State, Trajectory};
use std::fs::File;
use std::path::PathBuf;

/// Returns the folder, or `None` if there is none.
fn folder() -> Option<PathBuf> {
    let folder = std::env::var_os("NEARMISS_DATA").map(PathBuf::from);
    if folder.is_none() {
        eprintln!("ephemerides: skipped, NEARMISS_DATA is not set");
    }
    folder
}

/// Returns the states of each body.
fn load(folder: &std::path::Path) -> Vec<Vec<State>> {
    let file = File::open(folder.join("sat-small-a.csv.gz")).unwrap();
    let mut reader = csv::Reader::from_reader(MultiGzDecoder::new(file));
    let mut bodies: Vec<Vec<State>> = Vec::new();
    for row in reader.deserialize::<(usize, f64, f64, f64, f64, f64, f64, f64)>() {
        let (body, t, px, py, pz, vx, vy, vz) = row.unwrap();
        if bodies.len() == body {
            bodies.push(Vec::new());
        }
        let position = DVec3::new(px, py, pz);
        bodies[body].push(State::new(t, position, DVec3::new(vx, vy, vz)));
    }
    bodies
}

/// Returns the state at a time of the polynomial of degree 7 that agrees with four states in position and velocity
/// (Newton's divided differences).
fn state_at(four: &[State], time: f64) -> State {
    let knots: Vec<f64> = four.iter().flat_map(|state| [state.time; 2]).collect();
    let mut column: Vec<DVec3> = four.iter().flat_map(|state| [state.position; 2]).collect();
    let mut coefficients = vec![column[0]];
    for order in 1..8 {
        column = (0..8 - order)
            .map(|place| {
                let duration = knots[place + order] - knots[place];
                if duration > 0.0 {
                    (column[place + 1] - column[place]) / duration
                } else {
                    four[place / 2].velocity
                }
            })
            .collect();
        coefficients.push(column[0]);
    }
    let (mut position, mut velocity) = (coefficients[7], DVec3::ZERO);
    for order in (0..7).rev() {
        let since = time - knots[order];
        velocity = velocity * since + position;
        position = position * since + coefficients[order];
    }
    State::new(time, position, velocity)
}

fn median_and_largest(mut values: Vec<f64>) -> (f64, f64) {
    values.sort_by(f64::total_cmp);
    (values[values.len() / 2], values[values.len() - 1])
}

/// The reference is a polynomial of degree 7 through states up to 300 s apart. It is checked against states that it
/// was not given, twice as far apart: there it is 256 times worse.
#[test]
fn cubics_between_states_of_satellites() {
    let Some(folder) = folder() else { return };
    let bodies = load(&folder);
    let mut left_out = Vec::new();
    for states in &bodies {
        for place in 3..states.len() - 3 {
            let four = [place - 3, place - 1, place + 1, place + 3].map(|place| states[place]);
            let state = states[place];
            left_out.push(
                state_at(&four, state.time)
                    .position
                    .distance(state.position),
            );
        }
    }
    let (median, largest) = median_and_largest(left_out);
    println!(
        "the reference, with states twice as far apart: median {median:.2} m, largest {largest:.2} m"
    );
    assert!(largest / 256.0 < 0.02);
    let limits = [(30.0, 0.06), (60.0, 0.5), (120.0, 8.0), (240.0, 120.0)];
    for (step, limit) in limits {
        let worst_of = |states: &Vec<State>| {
            let at = |time: f64| {
                let place = states.partition_point(|state| state.time <= time);
                let first = place.saturating_sub(2).min(states.len() - 4);
                state_at(&states[first..first + 4], time)
            };
            let mut worst = 0.0_f64;
            let mut time = 300.0;
            while time + step < 6_900.0 {
                let piece = Trajectory::from_states(&[at(time), at(time + step)]).unwrap();
                for share in [0.3, 0.5, 0.7] {
                    let truth = at(time + share * step);
                    let place = piece.position(truth.time).unwrap();
                    worst = worst.max(place.distance(truth.position));
                }
                time += step;
            }
            worst
        };
        let (median, largest) = median_and_largest(bodies.iter().map(worst_of).collect());
        println!(
            "states every {step} s: off by {median:.3} m (median satellite), {largest:.3} m (worst)"
        );
        assert!(largest < limit && median > limit / 4.0);
    }
}

/// Closest approaches of the spline, with states every 43 to 298 s, against those of the propagator that made them.
#[test]
fn encounters_of_the_spline_and_of_the_propagator() {
    let Some(folder) = folder() else { return };
    let mut scene = Scene::new();
    for (tag, states) in (0..).zip(load(&folder)) {
        let plan = Trajectory::from_states(&states).unwrap();
        scene.insert(Body::new(plan).with_tag(tag)).unwrap();
    }
    let query = Query::default().with_margin(5_500.0);
    let conflicts = scene.screen(&query).unwrap().conflicts;
    let mut reader = csv::Reader::from_path(folder.join("sat-small-a.sgp4truth.csv")).unwrap();
    let (mut truths, mut times, mut separations) = (0, Vec::new(), Vec::new());
    for row in reader.deserialize::<(u64, u64, f64, f64)>() {
        let (i, j, tca, distance) = row.unwrap();
        truths += 1;
        let found = conflicts
            .iter()
            .find(|one| (one.tag_a, one.tag_b) == (i, j) && (one.closest.time - tca).abs() < 1.0);
        if let Some(one) = found {
            times.push((one.closest.time - tca).abs());
            separations.push((one.closest.separation - distance).abs());
        }
    }
    let matched = times.len();
    let ((time, latest), (metres, worst)) =
        (median_and_largest(times), median_and_largest(separations));
    println!("{matched} of {truths} closest approaches of the propagator within 1 s");
    println!("off by {metres:.1} m (median), {worst:.0} m (worst); {time:.1e} s, {latest:.1e} s");
    assert!(matched * 10 > truths * 9);
    assert!(worst < 400.0);
}
