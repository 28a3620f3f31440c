//! Pairs of true motions, and the splines that stand for them.

use super::support::{vector, wander};
use glam::{DQuat, DVec3};
use nearmiss::{Body, FitOptions, Hitbox, Orientation, Sphere, State, Trajectory, Window};
use rand::RngExt;
use rand::rngs::ChaCha8Rng;

/// Two bodies, and the way in which the true motion of the first differs from its plan.
pub(crate) struct World {
    pub(crate) bodies: [Body; 2],
    pub(crate) window: (f64, f64),
    pub(crate) margin: f64,
    /// Instants to look at.
    pub(crate) special: Vec<f64>,
    /// What the oracle may be off by, m.
    pub(crate) rounding: f64,
    truth: Truth,
}

/// The true motion.
enum Truth {
    /// Both bodies fly circles.
    Circles([Circle; 2]),
    /// The first body is nearer to or farther from the other than the splines say, as far as the
    /// model errors allow: by this share of them.
    Aside(Share),
}

/// A share of the model error, over time.
enum Share {
    Always(f64),
    /// A sine with this frequency (rad/s).
    Sine(f64),
    /// Nearer from one instant to another, else farther.
    Between(f64, f64),
}

/// A circular motion with a drift.
pub(crate) struct Circle {
    middle: DVec3,
    drift: DVec3,
    axes: [DVec3; 2],
    speed: f64,
    phase: f64,
}

impl Circle {
    fn any(rng: &mut ChaCha8Rng) -> Self {
        let turn = DQuat::from_scaled_axis(vector(rng, 3.0));
        let radius = rng.random_range(1.0..6.0);
        Self {
            middle: vector(rng, 3.0),
            drift: vector(rng, 0.5),
            axes: [turn * DVec3::X * radius, turn * DVec3::Y * radius],
            speed: rng.random_range(-1.5..1.5),
            phase: rng.random_range(-3.0..3.0),
        }
    }

    fn state(&self, time: f64) -> State {
        let (sine, cosine) = (self.speed * time + self.phase).sin_cos();
        let [x, y] = self.axes;
        State::new(
            time,
            self.middle + self.drift * time + x * cosine + y * sine,
            self.drift + self.speed * (y * cosine - x * sine),
        )
    }

    /// The largest fourth derivative, m/s^4.
    fn fourth_derivative(&self) -> f64 {
        self.axes[0].length() * self.speed.powi(4)
    }

    /// Returns the fit of [`Trajectory::fit_with`], and the error that it proves, m.
    fn fitted_within(&self, end: f64, tolerance: f64) -> (Trajectory, f64) {
        let motion = |time: f64| {
            let state = self.state(time);
            (state.position, state.velocity)
        };
        let bound = self.fourth_derivative() * (1.0 + 1e-9);
        let options = FitOptions::default().with_fourth_derivative(bound);
        let window = Window::new(0.0, end).unwrap();
        let fit = Trajectory::fit_with(motion, window, tolerance, &options).unwrap();
        assert!(fit.is_proven());
        let error = fit.error();
        (fit.trajectory, error)
    }

    /// A cubic Hermite spline with knots this far apart (s), and its proven error: the fourth
    /// derivative times h^4/384, and some rounding.
    fn fitted(&self, end: f64, step: f64) -> (Trajectory, f64) {
        let count = (end / step).ceil();
        let step = end / count;
        let numbers = (0_u32..).map(f64::from);
        let numbers = numbers.take_while(|k| *k <= count);
        let states = numbers.map(|k| self.state(k * step));
        let states: Vec<State> = states.collect();
        let error = self.fourth_derivative() * step.powi(4) / 384.0 * (1.0 + 1e-9) + 1e-12;
        (Trajectory::from_states(&states).unwrap(), error)
    }
}

/// A sphere, or some.
fn hitbox(rng: &mut ChaCha8Rng, kind: u64) -> Hitbox {
    let radius = rng.random_range(0.0..0.6);
    if kind.is_multiple_of(3) {
        let count = rng.random_range(2..6);
        let spheres = (0..count).map(|_| Sphere {
            offset: vector(rng, 1.0),
            radius: rng.random_range(0.0..0.6),
        });
        return Hitbox::cluster(spheres.collect()).unwrap();
    }
    Hitbox::sphere(radius).unwrap()
}

pub(crate) fn world(rng: &mut ChaCha8Rng, seed: u64) -> World {
    let end = 12.0;
    let share = |rng: &mut ChaCha8Rng| match rng.random_range(0..4) {
        0 => Share::Always(-1.0),
        1 => Share::Always(1.0),
        2 => Share::Sine(rng.random_range(0.1..20.0)),
        _ => {
            let from = rng.random_range(0.0..end);
            Share::Between(from, from + 10f64.powf(rng.random_range(-3.0..1.0)))
        }
    };
    let (plans, truth) = if seed.is_multiple_of(2) {
        let circles = [Circle::any(rng), Circle::any(rng)];
        let plans = if seed.is_multiple_of(4) {
            let tolerance = 10f64.powf(rng.random_range(-6.0..0.0));
            [0, 1].map(|k: usize| circles[k].fitted_within(end, tolerance))
        } else {
            let step = rng.random_range(0.1..1.5);
            [0, 1].map(|k: usize| circles[k].fitted(end, step))
        };
        (plans, Truth::Circles(circles))
    } else {
        let sizes = [0.0, 10f64.powf(rng.random_range(-6.0..0.0))];
        let plans = [0, 1].map(|k: usize| {
            let states = wander(rng, -1.0, 8, 2.0, 6.0, 3.0);
            let error = sizes[usize::from(k == 1 || seed % 4 == 1)] * rng.random_range(0.5..1.0);
            (Trajectory::from_states(&states).unwrap(), error)
        });
        (plans, Truth::Aside(share(rng)))
    };
    let special = match &truth {
        Truth::Aside(Share::Between(from, to)) => vec![*from, 0.5 * (from + to), *to],
        _ => Vec::new(),
    };
    let mut number = 0;
    let bodies = plans.map(|(plan, error)| {
        number += 1;
        let body = Body::new(plan).with_hitbox(hitbox(rng, seed / 2 + number));
        let body = body.with_model_error(error).unwrap();
        if (seed / 8 + number).is_multiple_of(3) {
            let rotation = DQuat::from_scaled_axis(vector(rng, 3.0));
            let spin = Orientation::spin(0.0, rotation, vector(rng, 1.0)).unwrap();
            return body.with_orientation(spin);
        }
        body
    });
    let start = bodies.iter().map(|body| body.trajectory.knots()[0]);
    let last = bodies
        .iter()
        .map(|body| *body.trajectory.knots().last().unwrap());
    let whole = (start.fold(0.0, f64::max), last.fold(end, f64::min));
    let window = if seed.is_multiple_of(5) {
        (
            whole.0 + rng.random_range(0.0..2.0),
            whole.1 - rng.random_range(0.0..2.0),
        )
    } else {
        whole
    };
    let mut world = World {
        // The tolerance of orientations is 1e-9 of the reach and above.
        rounding: if bodies.iter().any(|body| !body.orientation.is_fixed()) {
            1e-3
        } else {
            1e-9
        },
        bodies,
        window,
        margin: rng.random_range(-0.5..3.0),
        special,
        truth,
    };
    if seed % 3 == 1 {
        // Next to what is certain, or possible.
        let nearest = world.nearest();
        let share = [-1.0, 1.0, 0.0, rng.random_range(-1.0..1.0)][rng.random_range(0..4)];
        world.margin = nearest + share * world.error();
    }
    world
}

impl World {
    /// Sum of the model errors, m.
    pub(crate) fn error(&self) -> f64 {
        self.bodies.iter().map(Body::model_error).sum()
    }

    /// Least separation of the splines, m.
    fn nearest(&self) -> f64 {
        let [a, b] = &self.bodies;
        let window = Window::new(self.window.0, self.window.1).unwrap();
        let found = nearmiss::pair::closest_approach(a, b, window).unwrap();
        found.map_or(0.0, |found| found.separation)
    }

    /// The true separation at an instant within the window, m.
    pub(crate) fn separation(&self, time: f64) -> f64 {
        let [a, b] = &self.bodies;
        let apart = match &self.truth {
            Truth::Circles([one, other]) => one.state(time).position - other.state(time).position,
            Truth::Aside(_) => {
                let place = |body: &Body| body.trajectory.position(time).unwrap();
                place(a) - place(b)
            }
        };
        let centres = |body: &Body| -> Vec<(DVec3, f64)> {
            let rotation = body.orientation.rotation(time);
            let spheres = body.hitbox.spheres().iter();
            spheres
                .map(|sphere| (rotation * sphere.offset, sphere.radius))
                .collect()
        };
        let (ours, theirs) = (centres(a), centres(b));
        let pairs = ours
            .iter()
            .flat_map(|one| theirs.iter().map(move |other| (one, other)));
        let offsets = pairs.map(|(one, other)| (one.0 - other.0, one.1 + other.1));
        let nearest = |apart: DVec3| {
            let all = offsets.clone().map(move |(offset, radii)| {
                let between = apart + offset;
                (between.length() - radii, between)
            });
            all.min_by(|x, y| x.0.total_cmp(&y.0)).unwrap()
        };
        let (separation, between) = nearest(apart);
        match &self.truth {
            Truth::Circles(_) => separation,
            Truth::Aside(share) => {
                let share = match share {
                    Share::Always(share) => *share,
                    Share::Sine(frequency) => (frequency * time).sin(),
                    Share::Between(from, to) if *from <= time && time <= *to => -1.0,
                    Share::Between(..) => 1.0,
                };
                // Not through the other centre.
                let way = (share * self.error()).max(-between.length());
                nearest(apart + between.normalize_or_zero() * way).0
            }
        }
    }

    /// The instant (s) and the separation (m) at the lowest of many samples of an interval, and of ever more around it.
    pub(crate) fn lowest(&self, (from, to): (f64, f64)) -> (f64, f64) {
        let (mut low, mut high, mut lowest) = (from, to, (from, f64::INFINITY));
        for _ in 0..4 {
            let at = |k: u8| low + (high - low) * f64::from(k) / 24.0;
            let all = (0..=24).map(|k| (self.separation(at(k)), k));
            let (found, k) = all.min_by(|x, y| x.0.total_cmp(&y.0)).unwrap();
            if found < lowest.1 {
                lowest = (at(k), found);
            }
            (low, high) = (at(k.saturating_sub(1)), at((k + 1).min(24)));
        }
        lowest
    }
}
