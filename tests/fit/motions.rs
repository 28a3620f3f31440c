//! Motions with names, and what is asked of their fits.

use nearmiss::glam::DVec3;
use nearmiss::{Fit, State, Trajectory, Window};
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};
use std::f64::consts::TAU;

/// Position and velocity at a time.
pub(crate) type Motion = Box<dyn Fn(f64) -> (DVec3, DVec3)>;

pub(crate) struct Case {
    pub(crate) name: &'static str,
    pub(crate) motion: Motion,
    pub(crate) window: [f64; 2],
    pub(crate) tolerances: [f64; 2],
    /// Bound of the fourth derivative, m/s⁴.
    pub(crate) fourth_derivative: Option<f64>,
}

impl Case {
    pub(crate) fn window(&self) -> Window {
        Window::new(self.window[0], self.window[1]).unwrap()
    }

    /// Returns the motion 1e9 m away along each axis.
    pub(crate) fn far_away(self) -> Self {
        Self {
            motion: far_away(self.motion, 1e9, 0.0),
            ..self
        }
    }

    /// Asserts that the error of a fit holds at random instants; returns the largest deviation in units of it.
    pub(crate) fn assert_error(&self, fit: &Fit, instants: u32, seed: u64) -> f64 {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let mut largest = 0.0_f64;
        for _ in 0..instants {
            let time = rng.random_range(self.window[0]..self.window[1]);
            let position = fit.trajectory.position(time).unwrap();
            let deviation = position.distance((self.motion)(time).0);
            let (name, error) = (self.name, fit.error());
            assert!(
                deviation <= error,
                "{name} at {time}: {deviation} m above {error} m"
            );
            largest = largest.max(deviation / error);
        }
        largest
    }

    /// Returns the fewest knots that stay within a tolerance: each as far from the one before as the deviation seen
    /// at 60 instants allows.
    pub(crate) fn fewest_knots(&self, tolerance: f64) -> usize {
        let state = |time: f64| {
            let (position, velocity) = (self.motion)(time);
            State::new(time, position, velocity)
        };
        let is_within = |from: f64, to: f64| {
            let piece = Trajectory::from_states(&[state(from), state(to)]).unwrap();
            (1..60).all(|number| {
                let time = from + (to - from) * f64::from(number) / 60.0;
                piece.position(time).unwrap().distance(state(time).position) <= tolerance
            })
        };
        let [mut from, end] = self.window;
        let mut knots = 1;
        while from < end {
            let (mut good, mut bad) = (0.0, end - from);
            if is_within(from, end) {
                good = bad;
            }
            while bad - good > 1e-3 * bad {
                let middle = 0.5 * (good + bad);
                if is_within(from, from + middle) {
                    good = middle;
                } else {
                    bad = middle;
                }
            }
            from += good;
            knots += 1;
        }
        knots
    }

    /// Returns the fewest knots with even spacing that stay within a tolerance, if there are fewer than `limit`.
    pub(crate) fn uniform_knots(&self, tolerance: f64, limit: usize) -> Option<usize> {
        (2..limit).find(|&knots| self.is_uniform_within(knots, tolerance))
    }

    fn is_uniform_within(&self, knots: usize, tolerance: f64) -> bool {
        // The window at no fewer than 4096 instants, in an order that finds the bad ones early.
        let shares = (1..(4096 / knots).max(10)).map(|number| (0.618_034 * number as f64).fract());
        let shares: Vec<f64> = std::iter::once(0.5).chain(shares).collect();
        let [start, end] = self.window;
        let time = |number: usize| start + (end - start) * number as f64 / (knots - 1) as f64;
        let state = |time: f64| {
            let (position, velocity) = (self.motion)(time);
            State::new(time, position, velocity)
        };
        let is_within = |number: usize| {
            let ends = [state(time(number)), state(time(number + 1))];
            let piece = Trajectory::from_states(&ends).unwrap();
            shares.iter().all(|share| {
                let time = ends[0].time + share * (ends[1].time - ends[0].time);
                piece.position(time).unwrap().distance(state(time).position) <= tolerance
            })
        };
        // Each piece once, in an order that finds the bad ones early.
        let stride = [7919, 7907, 104_729]
            .into_iter()
            .find(|&stride| !(knots - 1).is_multiple_of(stride));
        (0..knots - 1).all(|number| is_within(number * stride.unwrap() % (knots - 1)))
    }
}

fn circle(radius: f64, period: f64) -> Motion {
    let rate = TAU / period;
    Box::new(move |time| {
        let (sin, cos) = (rate * time).sin_cos();
        let speed = radius * rate;
        (
            DVec3::new(radius * cos, radius * sin, 0.0),
            DVec3::new(-speed * sin, speed * cos, 0.0),
        )
    })
}

/// Returns an ellipse around the Earth, with its lowest point at 0 s.
fn kepler(axis: f64, eccentricity: f64) -> Motion {
    let rate = (3.986e14_f64 / axis.powi(3)).sqrt();
    let minor = axis * (1.0 - eccentricity * eccentricity).sqrt();
    Box::new(move |time| {
        let mean = rate * time;
        let turns = (mean / TAU).round() * TAU;
        let mean = mean - turns;
        let mut anomaly = mean + eccentricity * mean.sin();
        for _ in 0..20 {
            let (sin, cos) = anomaly.sin_cos();
            anomaly -= (anomaly - eccentricity * sin - mean) / (1.0 - eccentricity * cos);
        }
        let (sin, cos) = anomaly.sin_cos();
        let speed = rate / (1.0 - eccentricity * cos);
        (
            DVec3::new(axis * (cos - eccentricity), minor * sin, 0.0),
            DVec3::new(-axis * sin, minor * cos, 0.0) * speed,
        )
    })
}

/// Returns an oscillation whose frequency grows.
pub(crate) fn chirp(rate: f64) -> Motion {
    Box::new(move |time| {
        let (sin, cos) = (rate * time * time).sin_cos();
        let phase_rate = 2.0 * rate * time;
        (
            DVec3::new(sin, 2.0 * cos, time),
            DVec3::new(cos, -2.0 * sin, 0.0) * phase_rate + DVec3::Z,
        )
    })
}

/// Returns a motion with constant accelerations between irregular instants.
fn bang_bang() -> Motion {
    let mut rng = ChaCha8Rng::seed_from_u64(7);
    let mut states = vec![State::default()];
    let mut accelerations = Vec::new();
    for _ in 0..40 {
        let acceleration = DVec3::from_array([0; 3].map(|_| rng.random_range(-3.0..3.0)));
        let duration: f64 = rng.random_range(0.3..2.5);
        let last = *states.last().unwrap();
        accelerations.push(acceleration);
        states.push(State::new(
            last.time + duration,
            last.position + duration * (last.velocity + 0.5 * duration * acceleration),
            last.velocity + duration * acceleration,
        ));
    }
    accelerations.push(DVec3::ZERO);
    Box::new(move |time| {
        let last = states.partition_point(|state| state.time <= time).max(1) - 1;
        let (state, acceleration) = (states[last], accelerations[last]);
        let since = time - state.time;
        (
            state.position + since * (state.velocity + 0.5 * since * acceleration),
            state.velocity + since * acceleration,
        )
    })
}

/// Returns oscillations that turn into others at whole multiples of 10 s, with a jump in acceleration.
fn oscillations_with_jumps() -> Motion {
    Box::new(|time| {
        let part = (time / 10.0).floor();
        let since = time - 10.0 * part;
        let rate = TAU / 10.0 * (1.0 + part.rem_euclid(3.0));
        // Position 0 and the same velocity at both ends of each part.
        let (sin, cos) = (rate * since).sin_cos();
        let height = 5.0 * (1.0 - cos);
        (
            DVec3::new(2.0 * time, height, 0.0),
            DVec3::new(2.0, 5.0 * rate * sin, 0.0),
        )
    })
}

/// Returns straight legs, with a jump in velocity between them.
fn legs() -> Motion {
    let corners = [0.0, 3.1, -1.7, 4.9, 4.2, 0.3, 2.8].map(|y| DVec3::new(0.0, y, 2.0 * y));
    Box::new(move |time| {
        let leg = (time / 7.3).floor().clamp(0.0, 5.0);
        let first = (0..6)
            .find(|&leg_number| leg <= f64::from(leg_number))
            .unwrap_or(5);
        let first = usize::try_from(first).unwrap();
        let velocity = (corners[first + 1] - corners[first]) / 7.3;
        (corners[first] + (time - 7.3 * leg) * velocity, velocity)
    })
}

/// Returns a polynomial of degree 7 from rest to rest in 8 s, with no acceleration and no jerk at its ends.
fn minimum_snap() -> Motion {
    Box::new(|time| {
        let s = time / 8.0;
        let way = s.powi(4) * (35.0 - s * (84.0 - s * (70.0 - 20.0 * s)));
        let rate = 140.0 * (s * (1.0 - s)).powi(3) / 8.0;
        let to = DVec3::new(30.0, -12.0, 5.0);
        (to * way, to * rate)
    })
}

/// Returns a body at rest, but for twelve seconds of one hour.
fn short_excursion() -> Motion {
    Box::new(|time| {
        let s = ((time - 1234.5) / 12.0).clamp(0.0, 1.0);
        let bump = (s * (1.0 - s)).powi(4) * 256.0;
        let rate = 1024.0 * (s * (1.0 - s)).powi(3) * (1.0 - 2.0 * s) / 12.0;
        (DVec3::new(1e5, 50.0 * bump, 0.0), DVec3::Y * (50.0 * rate))
    })
}

/// Returns the polar plane of a motion moved far away, in space and in time.
fn far_away(motion: Motion, place: f64, since: f64) -> Motion {
    Box::new(move |time| {
        let (position, velocity) = motion(time - since);
        (position + DVec3::splat(place), velocity)
    })
}

pub(crate) fn all() -> Vec<Case> {
    let case = |name, motion, window, tolerances| Case {
        name,
        motion,
        window,
        tolerances,
        fourth_derivative: None,
    };
    let mut cases = vec![
        case("circle", circle(100.0, 40.0), [0.0, 120.0], [1.0, 1e-4]),
        case(
            "low orbit",
            circle(7e6, 5800.0),
            [0.0, 11_600.0],
            [1.0, 1e-3],
        ),
        case(
            "ellipse",
            kepler(2.4e7, 0.7),
            [0.0, 74_000.0],
            [100.0, 1e-2],
        ),
        case("chirp", chirp(0.2), [0.0, 25.0], [1e-2, 1e-5]),
        case("bang-bang", bang_bang(), [0.0, 40.0], [0.05, 1e-4]),
        case(
            "jumps",
            oscillations_with_jumps(),
            [0.0, 95.0],
            [0.05, 1e-4],
        ),
        case("legs", legs(), [0.0, 43.8], [0.1, 1e-4]),
        case("minimum snap", minimum_snap(), [0.0, 8.0], [0.1, 1e-5]),
        case("excursion", short_excursion(), [0.0, 3600.0], [0.1, 1e-3]),
        case(
            "far circle",
            far_away(circle(3.0, 7.0), 1e9, 1.7e9),
            [1.7e9, 1.7e9 + 30.0],
            [0.01, 1e-5],
        ),
    ];
    let bounds = [
        ("circle", 100.0 * (TAU / 40.0_f64).powi(4)),
        ("low orbit", 7e6 * (TAU / 5800.0_f64).powi(4)),
        ("far circle", 3.0 * (TAU / 7.0_f64).powi(4)),
        ("chirp", chirp_bound(0.2, 25.0)),
        // 30 m, 12 m and 5 m times 840 (1 - 10 s + ...), at the ends.
        ("minimum snap", 1069_f64.sqrt() * 840.0 / 4096.0),
    ];
    for case in &mut cases {
        let bound = bounds.iter().find(|(name, _)| *name == case.name);
        case.fourth_derivative = bound.map(|(_, bound)| bound * (1.0 + 1e-12));
    }
    cases
}

/// Returns a path that comes straight, bends by a right angle at 0 s within some `sharpness` seconds, and goes straight
/// on at about 14 m/s.
pub(crate) fn bend(sharpness: f64) -> Motion {
    Box::new(move |time| {
        let root = time.hypot(sharpness);
        (
            DVec3::new(10.0 * root, 10.0 * time, 0.0),
            DVec3::new(10.0 * time / root, 10.0, 0.0),
        )
    })
}

/// Returns the largest fourth derivative of a [`bend`] in a window (m/s⁴).
pub(crate) fn bend_bound(sharpness: f64, window: Window) -> f64 {
    let square = sharpness * sharpness;
    let at = |time: f64| {
        let root = time.hypot(sharpness);
        10.0 * square * (12.0 * time * time - 3.0 * square).abs() / root.powi(7)
    };
    // The fifth derivative is zero there.
    let turn = 0.75_f64.sqrt() * sharpness;
    let inside = [0.0, turn, -turn]
        .into_iter()
        .filter(|&t| window.contains(t));
    let times = inside.chain([window.start(), window.end()]);
    times.map(at).fold(0.0, f64::max) * (1.0 + 1e-12)
}

/// Returns a bound of the fourth derivative of (sin k t², 2 cos k t², t) up to a time.
pub(crate) fn chirp_bound(k: f64, time: f64) -> f64 {
    let along = 16.0 * k.powi(4) * time.powi(4) + 12.0 * k * k;
    let across = 48.0 * k.powi(3) * time * time;
    5_f64.sqrt() * along.hypot(across)
}
