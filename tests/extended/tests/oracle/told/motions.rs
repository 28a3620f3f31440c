//! Motions that are told by states, in the crate's types and exactly.

use crate::oracle_support::State as ExactState;
use crate::oracle_support::{Body as ExactMotion, Outside as ExactOutside, PolynomialSegment};
use crate::support::{vector, wander};
use glam::DVec3;
use nearmiss::{Outside, State, Trajectory};
use rand::RngExt;
use rand::rngs::ChaCha8Rng;

/// Seconds before and after now that exact motions reach. Nothing is asked beyond.
pub(crate) const REACH: f64 = 64.0;

/// The motion of one body, and the length that its rounding is in proportion to.
#[derive(Clone, Debug)]
pub(crate) struct Motion {
    pub(crate) exact: ExactMotion,
    /// The largest of the ways gone from a state to any instant asked about, and of positions, m.
    pub(crate) scale: f64,
    /// m/s.
    pub(crate) speed: f64,
}

impl Motion {
    /// A straight motion through a state, about now (s).
    pub(crate) fn through(state: &State, now: f64) -> Self {
        let whole = line(state, (now - REACH, now + REACH));
        Self {
            exact: ExactMotion::from_polynomials(&[whole]),
            scale: 0.0,
            speed: 0.0,
        }
        .with_scale(state, now)
    }

    /// A spline that goes on as it is told.
    pub(crate) fn spline(states: &[State], outside: Outside, now: f64) -> Self {
        let exact_states: Vec<ExactState> = states.iter().map(exact_state).collect();
        let outside = match outside {
            Outside::Extrapolate => ExactOutside::Extrapolate,
            _ => ExactOutside::Coast,
        };
        let exact = ExactMotion::from_states(&exact_states);
        let mut motion = Self {
            exact: exact.extended(outside, now - REACH, now + REACH),
            scale: 0.0,
            speed: 0.0,
        };
        for state in states {
            motion = motion.with_scale(state, now);
        }
        // A cubic that goes on grows with the third power of the time.
        if outside == ExactOutside::Extrapolate {
            motion.scale *= REACH.powi(3);
            motion.speed *= REACH.powi(2);
        }
        motion
    }

    /// This motion until an instant (s), and the straight one through a state from then on.
    pub(crate) fn then(self, from: f64, state: &State, now: f64) -> Self {
        let next = line(state, (from, now + REACH));
        Self {
            exact: self.exact.followed_by(from, &next),
            ..self
        }
        .with_scale(state, now)
    }

    fn with_scale(mut self, state: &State, now: f64) -> Self {
        let speed = state.velocity.length();
        let way = speed * ((now - state.time).abs() + REACH);
        self.scale = self.scale.max(way + state.position.length());
        self.speed = self.speed.max(speed);
        self
    }
}

fn exact_state(state: &State) -> ExactState {
    ExactState {
        t: state.time,
        p: state.position.to_array(),
        v: state.velocity.to_array(),
    }
}

fn line(state: &State, (start, end): (f64, f64)) -> PolynomialSegment {
    let [position, velocity] = [state.position, state.velocity].map(|vector| vector.to_array());
    PolynomialSegment {
        start,
        end,
        origin: state.time,
        coefficients: [position, velocity, [0.0; 3], [0.0; 3]],
    }
}

/// A straight motion that is at a place at an instant, up to rounding, told for some other instant: 1e9 s before or
/// after, 1e-9 s, as an engine or a network does, or by one that rests.
pub(crate) fn told(rng: &mut ChaCha8Rng, time: f64, place: DVec3) -> State {
    let velocity = match rng.random_range(0..12) {
        0..3 => DVec3::ZERO,
        3 => vector(rng, 1e-9),
        4 => vector(rng, 1e4),
        5 => vector(rng, 3.0).round(),
        _ => vector(rng, 3.0),
    };
    let told = match rng.random_range(0..11) {
        0 => time - 1e9,
        1 => time + 1e9,
        2 => time - 1e-9,
        3 => time + 1e-9,
        4 => time + rng.random_range(0.0..9.0),
        5 => 0.0,
        6 => time - 1e12,
        7 | 8 => time - rng.random_range(0.0..0.3),
        _ => time,
    };
    State::new(told, place + velocity * (told - time), velocity)
}

/// States of two bodies that come near each other at an instant (s), and where they are then or so, m.
pub(crate) fn meet(rng: &mut ChaCha8Rng, time: f64, place: DVec3) -> [(State, DVec3); 2] {
    let [a, b] = [(); 2].map(|()| place + vector(rng, 1.0));
    match rng.random_range(0..8) {
        0 | 1 => beside(rng, time, place.round()).map(|state| (state, place)),
        2 => {
            let state = told(rng, time, a);
            let position = state.position + (b - a).round();
            [state, State { position, ..state }].map(|state| (state, a))
        }
        _ => [a, b].map(|at| (told(rng, time, at), at)),
    }
}

/// Two that fly beside each other, exactly 1, 2 or 3 m apart all the time, told for instants of long ago. There each
/// way gone is rounded on its own, and the ways are far longer than all that is left of them.
fn beside(rng: &mut ChaCha8Rng, time: f64, place: DVec3) -> [State; 2] {
    let age = [1e9, 1e12][rng.random_range(0..2)];
    let velocity = vector(rng, 9.0).round();
    let apart = f64::from(rng.random_range(1..4)) * DVec3::AXES[rng.random_range(0..3)];
    let told = [0.0, f64::from(rng.random_range(0..1_000))].map(|later| time.round() - age + later);
    // All of these are whole numbers.
    let [first, second] = told.map(|told| place + velocity * (told - time.round()));
    [
        State::new(told[0], first, velocity),
        State::new(told[1], second + apart, velocity),
    ]
}

/// States of a spline that is at a place at an instant or so, some of them long past, and how it goes on.
pub(crate) fn spline(rng: &mut ChaCha8Rng, time: f64, place: DVec3) -> (Vec<State>, Outside) {
    let age = [2.0, 2.0, 4.0, 1e3][rng.random_range(0..4)];
    let mut states = wander(rng, time - age, 4, 1.0, 2.0, 1.0);
    // Nothing but coasting keeps near a place for long.
    let is_near = age < 9.0;
    let outside = if is_near && rng.random_bool(0.4) {
        Outside::Extrapolate
    } else {
        Outside::Coast
    };
    let at = Trajectory::from_states(&states).unwrap();
    let at = at.with_outside(outside).position(time).unwrap();
    for state in &mut states {
        state.position += place - at;
    }
    (states, outside)
}

/// The trajectory of these states.
pub(crate) fn trajectory((states, outside): &(Vec<State>, Outside)) -> Trajectory {
    let plan = Trajectory::from_states(states).unwrap();
    plan.with_outside(*outside)
}
