//! Bodies whose motion is known exactly, with a bound of its fourth derivative.

use crate::Failure;
use crate::scenes::{generator, normal_vector, uniform_vector};
use glam::DVec3;
use nearmiss::Window;
use rand::RngExt;

/// Position (m) and velocity (m/s) at a time (s).
type State = (DVec3, DVec3);

/// A motion with three continuous derivatives.
pub(super) struct Motion {
    pub(super) at: Box<dyn Fn(f64) -> State>,
    /// Bound of the fourth derivative, m/s⁴.
    pub(super) fourth_derivative: f64,
}

impl Motion {
    fn new(fourth_derivative: f64, at: impl Fn(f64) -> State + 'static) -> Self {
        let at = Box::new(at);
        Self {
            at,
            fourth_derivative,
        }
    }
}

/// Bodies whose true motion is known.
pub(super) struct Known {
    pub(super) name: &'static str,
    pub(super) motions: Vec<Motion>,
    pub(super) radius: f64,
    pub(super) margin: f64,
    pub(super) window: Window,
}

/// Circular orbits 7,000 km from the centre, in shells 100 m apart.
pub(super) fn orbits(count: usize) -> Result<Known, Failure> {
    /// m³/s².
    const MU: f64 = 3.986_004_418e14;
    let mut rng = generator(5);
    let motions = (0..count).map(|_| {
        let radius = 7.0e6 + 100.0 * f64::from(rng.random_range(0..8_u32));
        let rate = (MU / radius.powi(3)).sqrt();
        let x = normal_vector(&mut rng, 1.0).normalize();
        let y = x.cross(normal_vector(&mut rng, 1.0)).normalize();
        Motion::new(1.001 * radius * rate.powi(4), move |time: f64| {
            let (sin, cos) = (rate * time).sin_cos();
            (
                radius * (cos * x + sin * y),
                radius * rate * (cos * y - sin * x),
            )
        })
    });
    Ok(Known {
        name: "orbits",
        motions: motions.collect(),
        radius: 1.0,
        margin: 2_000.0,
        window: Window::new(0.0, 6_000.0)?,
    })
}

/// Drones between points, at rest at each of them: the motion of least snap.
pub(super) fn drones(count: usize) -> Result<Known, Failure> {
    /// Time of a hop, s, and hops.
    const HOP: f64 = 12.0;
    const HOPS: u32 = 5;
    /// Largest fourth derivative of a hop's share of the way, in hops: at its ends.
    const FOURTH_DERIVATIVE: f64 = 840.0;
    let mut rng = generator(6);
    let motions = (0..count).map(|_| {
        let mut place = uniform_vector(&mut rng, 150.0);
        let mut places = vec![place];
        for _ in 0..HOPS {
            place += uniform_vector(&mut rng, 60.0);
            places.push(place);
        }
        let ways = places.windows(2).map(|ends| ends[0].distance(ends[1]));
        let longest = ways.fold(0.0, f64::max);
        let bound = 1.001 * FOURTH_DERIVATIVE * longest / HOP.powi(4);
        Motion::new(bound, move |time: f64| {
            let hop = (time / HOP).floor().clamp(0.0, f64::from(HOPS - 1));
            let s = (time / HOP - hop).clamp(0.0, 1.0);
            let along = s.powi(4) * (35.0 + s * (-84.0 + s * (70.0 - 20.0 * s)));
            let rate = 140.0 * (s * (1.0 - s)).powi(3) / HOP;
            #[allow(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "a few hops"
            )]
            let from = hop as usize;
            let way = places[from + 1] - places[from];
            (places[from] + along * way, rate * way)
        })
    });
    Ok(Known {
        name: "drones",
        motions: motions.collect(),
        radius: 0.5,
        margin: 4.0,
        window: Window::new(0.0, HOP * f64::from(HOPS))?,
    })
}

/// Things in a game that swing around a place.
pub(super) fn game(count: usize) -> Result<Known, Failure> {
    let mut rng = generator(7);
    let motions = (0..count).map(|_| {
        let place = uniform_vector(&mut rng, 60.0);
        let swings: [(DVec3, f64, f64); 3] = std::array::from_fn(|_| {
            let rate = rng.random_range(0.3..2.0);
            (
                normal_vector(&mut rng, 4.0 / rate),
                rate,
                rng.random_range(0.0..6.0),
            )
        });
        let bounds = swings.map(|(way, rate, _)| way.length() * rate.powi(4));
        Motion::new(1.001 * bounds.iter().sum::<f64>(), move |time: f64| {
            swings
                .iter()
                .fold((place, DVec3::ZERO), |(at, speed), &(way, rate, phase)| {
                    let (sin, cos) = (rate * time + phase).sin_cos();
                    (at + sin * way, speed + rate * cos * way)
                })
        })
    });
    Ok(Known {
        name: "game",
        motions: motions.collect(),
        radius: 0.5,
        margin: 0.0,
        window: Window::new(0.0, 20.0)?,
    })
}
