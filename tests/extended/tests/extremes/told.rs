//! Straight motions: bodies that are told where they are, at an instant far from the one that is asked about.

use super::check::Truth;
use super::oracle_support::{Body as ExactMotion, PolynomialSegment};
use super::{Row, is_narrow, vector};
use glam::DVec3;
use nearmiss::{
    Accuracy, AlertLevel, Body, BodyId, Conflict, Monitor, Query, Scene, State, Trajectory, Window,
};
use rand::SeedableRng;
use rand::rngs::ChaCha8Rng;

/// s. The bodies meet in the middle.
const END: f64 = 4.0;

fn window() -> Window {
    Window::new(0.0, END).unwrap()
}

/// The motion through a state, exactly.
fn exactly(state: &State) -> ExactMotion {
    let [position, velocity] = [state.position, state.velocity].map(|vector| vector.to_array());
    ExactMotion::from_polynomials(&[PolynomialSegment {
        start: 0.0,
        end: END,
        origin: state.time,
        coefficients: [position, velocity, [0.0; 3], [0.0; 3]],
    }])
}

/// Positions, and the ways from the states' times to those that are asked about, m.
fn scale(states: &[State; 2]) -> f64 {
    let reach = states.map(|state| {
        let time = state.time.abs() + END;
        state.position.length() + state.velocity.length() * time
    });
    reach.iter().sum()
}

/// Two bodies at rest far from everything, before anything is told.
fn unknown() -> (Scene, [BodyId; 2]) {
    let mut scene = Scene::new();
    let ids = [1e5, -1e5].map(|x| {
        let body = Body::new(Trajectory::at_rest(x * DVec3::Z).unwrap());
        scene.insert(body).unwrap()
    });
    (scene, ids)
}

/// Finds the answers about two states that are told one after the other, in a call for each list.
struct Told {
    scene: Scene,
    ids: [BodyId; 2],
    calls: Vec<[State; 2]>,
}

impl Told {
    fn new(calls: Vec<[State; 2]>) -> Self {
        let (mut scene, ids) = unknown();
        for states in &calls {
            scene.update(ids.into_iter().zip(*states)).unwrap();
        }
        Self { scene, ids, calls }
    }

    fn screened(&self, margin: f64, accuracy: Accuracy) -> Vec<Conflict> {
        let query = Query::new(window()).with_margin(margin);
        let query = query.with_accuracy(accuracy);
        self.scene.screen(&query).unwrap().conflicts
    }

    /// Finds the answers of a monitor that is told the same at the beginning of the window.
    fn foreseen(&self, margin: f64) -> Vec<Conflict> {
        let levels = [AlertLevel::at(margin)];
        let mut monitor = Monitor::new(unknown().0, 0.0, END, &levels).unwrap();
        for states in &self.calls {
            let told = self.ids.into_iter().zip(*states);
            monitor.track(0.0, told).unwrap();
        }
        monitor.advance(0.0, &mut Vec::new()).unwrap();
        monitor.conflicts(0).unwrap().to_vec()
    }

    /// Asks for a tenth more than the least distance, and for just that.
    fn ask(&self, row: &mut Row) {
        let [a, b] = self.ids;
        let least = self.scene.closest_approach(a, b, window()).unwrap();
        let least = least.unwrap().separation;
        let states = self.calls.last().unwrap();
        for margin in [1.1 * least, least] {
            let truth = Truth::between(states.each_ref().map(exactly), margin, (0.0, END));
            let truth = (&truth, scale(states));
            let case = format!("{states:?} {margin}");
            let certified = self.screened(margin, Accuracy::Certified);
            assert!(!certified.is_empty(), "{case}");
            row.check(
                &certified,
                &self.screened(margin, Accuracy::Exact),
                truth,
                &case,
            );
            // Of what is certain; the numbers of the row are those of the screening.
            Row::default().check(&certified, &self.foreseen(margin), truth, &case);
        }
    }
}

/// States of bodies that are within some metres of each other in the middle of the window, told for another time (s).
fn meeting(rng: &mut ChaCha8Rng, time: f64, speed: f64, place: DVec3) -> [State; 2] {
    [(); 2].map(|()| {
        let velocity = vector(rng, speed);
        let way = velocity * (time - END / 2.0);
        State::new(time, place + vector(rng, 1.0) + way, velocity)
    })
}

/// A row of random pairs.
fn random(name: &str, seed: u64, mut calls: impl FnMut(&mut ChaCha8Rng, usize) -> Vec<[State; 2]>) {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut row = Row::default();
    for number in 0..20 {
        Told::new(calls(&mut rng, number)).ask(&mut row);
    }
    row.print(name);
    is_narrow(&row);
}

#[test]
fn long_ago_and_far_ahead() {
    random("1e9 s", 21, |rng, number| {
        let time = [-1e9, 1e9][number % 2];
        vec![meeting(rng, time, 3.0, DVec3::ZERO)]
    });
}

#[test]
fn far_away() {
    random("1e9 m", 22, |rng, number| {
        let place = DVec3::new(1e9, -1e9, 5e8);
        vec![meeting(rng, [-1.0, 0.0, 9.0][number % 3], 3.0, place)]
    });
}

#[test]
fn just_before_and_after() {
    random("1e-9 s", 23, |rng, number| {
        vec![meeting(rng, [-1e-9, 1e-9][number % 2], 3.0, DVec3::ZERO)]
    });
}

/// One of them, or both.
#[test]
fn at_rest() {
    random("resting", 24, |rng, number| {
        let mut states = meeting(rng, [-1e9, 0.0, 1e9][number % 3], 3.0, DVec3::ZERO);
        for state in &mut states[..1 + number % 2] {
            *state = State::new(state.time, vector(rng, 1.0), DVec3::ZERO);
        }
        vec![states]
    });
}

/// The last word counts, also if it is the first one, or about an earlier time.
#[test]
fn told_twice() {
    random("told twice", 25, |rng, number| {
        let first = meeting(rng, [0.0, 1e9][number % 2], 3.0, 50.0 * DVec3::X);
        let second = meeting(rng, [0.0, -7.0, -1e9, 1e-9][number % 4], 3.0, DVec3::ZERO);
        match number % 3 {
            0 => vec![first, second],
            1 => vec![second, first, second],
            _ => vec![second, second],
        }
    });
}
