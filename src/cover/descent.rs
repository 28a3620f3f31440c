//! Moving centres until the overshoot is locally least.

use super::cells::{CellScratch, Share};
use super::nearest::Nearest;
use super::points::{Points, Samples};
use super::random::Random;
use super::solid::Solid;
use super::surface::Surface;
use crate::count::as_f64;
use glam::DVec3;

/// Temperatures below the overshoot at which the weight of a point is nothing.
const NO_WEIGHT: f64 = 30.0;

/// Share of the overshoot from which on a point is among the worst.
const NEARLY: f64 = 0.95;

/// A point that a ball must contain.
#[derive(Clone, Copy, Debug)]
struct Demand {
    ball: usize,
    point: DVec3,
    distance: f64,
}

/// A set of centres, and the overshoot that they lead to.
#[derive(Clone, Debug)]
pub(super) struct CoverCandidate {
    pub(super) centres: Vec<DVec3>,
    pub(super) overshoot: f64,
}

/// The points on which an overshoot is measured.
#[derive(Clone, Debug)]
pub(super) enum Target<'a> {
    /// Surfaces, exactly: the corners of the balls' shares are found.
    Surfaces(&'a [Surface]),
    /// Points of them, and where shares meet between.
    Samples(&'a Samples),
}

/// The steps of a descent: their number and lengths.
#[derive(Clone, Copy, Debug)]
pub(super) struct Schedule {
    pub(super) steps: u32,
    /// First and last step, as a share of the first overshoot.
    pub(super) first: f64,
    pub(super) last: f64,
    /// Temperature of the soft maximum, in steps.
    pub(super) temperature: f64,
}

/// Buffers of descents.
#[derive(Clone, Debug, Default)]
pub(super) struct DescentScratch {
    cell: CellScratch,
    balls: Vec<(DVec3, f64)>,
    heights: Vec<(f64, DVec3)>,
    demands: Vec<Demand>,
    motions: Vec<Moments>,
    bounds: Vec<f64>,
    nearest: Nearest,
    meetings: Points,
    nearest_to_meetings: Nearest,
}

#[derive(Clone, Copy, Debug, Default)]
struct Moments {
    gradient: DVec3,
    mean: DVec3,
    square: f64,
}

/// Returns the best centres on the way down from some centres.
pub(super) fn descend(
    solid: &Solid,
    target: &Target<'_>,
    mut centres: Vec<DVec3>,
    schedule: &Schedule,
    scratch: &mut DescentScratch,
) -> CoverCandidate {
    scratch.motions.clear();
    scratch.motions.resize(centres.len(), Moments::default());
    let mut expected = f64::NAN;
    let mut best = CoverCandidate {
        centres: centres.clone(),
        overshoot: f64::INFINITY,
    };
    let mut unit = 0.0;
    for step in 0..schedule.steps {
        let progress = f64::from(step) / f64::from(schedule.steps.max(2) - 1);
        let share = schedule.first * (schedule.last / schedule.first).powf(progress);
        // What lies deeper has no weight.
        let depth = (NO_WEIGHT + 1.0) * share * best.overshoot * schedule.temperature;
        let overshoot = scratch.measure(solid, target, &centres, expected, depth);
        if overshoot < best.overshoot {
            best.overshoot = overshoot;
            best.centres.clone_from(&centres);
        }
        if expected.is_nan() {
            unit = (scratch.spacing(overshoot) * overshoot).max(0.0).sqrt();
        }
        expected = overshoot;
        let length = share * unit;
        scratch.find_gradient(
            &centres,
            overshoot,
            share * best.overshoot * schedule.temperature,
        );
        let steps = step + 1;
        for (centre, motion) in centres.iter_mut().zip(&mut scratch.motions) {
            *centre -= motion.advance(steps) * length;
        }
    }
    best
}

impl Moments {
    const MEAN: f64 = 0.8;
    const SQUARE: f64 = 0.95;

    /// Returns the direction to go up, of length about 1 if the gradients agree.
    ///
    /// D. Kingma and J. Ba: Adam, a method for stochastic optimization (2015).
    fn advance(&mut self, steps: u32) -> DVec3 {
        let steps = steps.min(1_000).cast_signed();
        self.mean = self.mean * Self::MEAN + self.gradient * (1.0 - Self::MEAN);
        let square = self.gradient.length_squared();
        self.square = self.square * Self::SQUARE + square * (1.0 - Self::SQUARE);
        let mean = self.mean / (1.0 - Self::MEAN.powi(steps));
        let square = self.square / (1.0 - Self::SQUARE.powi(steps));
        mean / (square.sqrt() + 1e-9)
    }
}

impl DescentScratch {
    /// Finds the points that each ball must contain, and returns the overshoot. `expected` is about
    /// the overshoot, NaN if nothing is known. Points that are neither among the worst nor within
    /// `depth` of the overshoot may be left out.
    pub(super) fn measure(
        &mut self,
        solid: &Solid,
        target: &Target<'_>,
        centres: &[DVec3],
        expected: f64,
        depth: f64,
    ) -> f64 {
        self.place_balls(solid, target, centres, expected);
        self.demands.clear();
        match target {
            Target::Surfaces(surfaces) => {
                self.share_surfaces(surfaces);
                let overshoots = self.demands.iter().map(|demand| self.overshoot(demand));
                overshoots.fold(0.0, f64::max)
            }
            Target::Samples(samples) => self.share_samples(samples, depth),
        }
    }

    fn place_balls(
        &mut self,
        solid: &Solid,
        target: &Target<'_>,
        centres: &[DVec3],
        expected: f64,
    ) {
        let expected = if expected.is_nan() {
            solid.diameter
        } else {
            expected
        };
        self.heights.clear();
        let height = |&centre: &DVec3| match target {
            Target::Samples(samples) if samples.tell_depths => {
                samples.signed_distance(centre, &mut self.bounds)
            }
            Target::Samples(_) | Target::Surfaces(_) => solid.signed_distance(centre),
        };
        self.heights.extend(centres.iter().map(height));
        self.balls.clear();
        for (&centre, &(height, _)) in centres.iter().zip(&self.heights) {
            self.balls.push((centre, (expected - height).max(0.0)));
        }
    }

    /// Returns the overshoot without each of the balls, as if the others stayed. `expected` is about the
    /// overshoot with all.
    pub(super) fn losses(
        &mut self,
        solid: &Solid,
        target: &Target<'_>,
        centres: &[DVec3],
        expected: f64,
    ) -> Vec<f64> {
        self.place_balls(solid, target, centres, expected);
        match target {
            Target::Surfaces(surfaces) => self.losses_of_surfaces(surfaces),
            Target::Samples(samples) => {
                self.nearest
                    .find_two(&samples.points, &self.balls, &self.heights);
                self.nearest.losses(self.balls.len())
            }
        }
    }

    fn losses_of_surfaces(&mut self, surfaces: &[Surface]) -> Vec<f64> {
        let (cell, balls) = (&mut self.cell, &self.balls[..]);
        let mut losses = vec![0.0_f64; balls.len()];
        // One by one: a share is found again on the surfaces alone where it is larger.
        for surface in surfaces.chunks(1) {
            let each = (0..balls.len()).map(|ball| cell.share(surface, ball, balls, |_| false));
            let shares: Vec<Share> = each.collect();
            for (lost, loss) in losses.iter_mut().enumerate() {
                for (ball, share) in shares.iter().enumerate().filter(|(ball, _)| *ball != lost) {
                    let reach = if share.cut_by.contains(&lost) {
                        cell.share(surface, ball, balls, |other| other == lost)
                            .reach
                    } else {
                        share.reach
                    };
                    if let Some(reach) = reach {
                        *loss = loss.max(reach + self.heights[ball].0);
                    }
                }
            }
        }
        losses
    }

    /// Returns one of the points that reach out nearly farthest, and the centre of its ball.
    pub(super) fn one_of_the_worst(
        &self,
        centres: &[DVec3],
        random: &mut Random,
    ) -> Option<(DVec3, DVec3)> {
        let overshoots = self.demands.iter().map(|demand| self.overshoot(demand));
        let enough = NEARLY * overshoots.fold(0.0, f64::max);
        let worst = self
            .demands
            .iter()
            .filter(|demand| self.overshoot(demand) >= enough);
        let worst: Vec<&Demand> = worst.collect();
        let one = (!worst.is_empty()).then(|| worst[random.below(worst.len())])?;
        Some((one.point, centres[one.ball]))
    }

    /// Returns a third of the mean radius that gives an overshoot.
    fn spacing(&self, overshoot: f64) -> f64 {
        let radii = self.heights.iter().map(|(height, _)| overshoot - height);
        radii.sum::<f64>() / (3.0 * as_f64(self.heights.len()))
    }

    fn overshoot(&self, demand: &Demand) -> f64 {
        demand.distance + self.heights[demand.ball].0
    }

    fn share_surfaces(&mut self, surfaces: &[Surface]) {
        for ball in 0..self.balls.len() {
            for surface in surfaces {
                self.cell.form(surface, ball, &self.balls, |_| false);
                let centre = self.balls[ball].0;
                let demands = self.cell.share.points.iter().map(|&point| Demand {
                    ball,
                    point,
                    distance: point.distance(centre),
                });
                self.demands.extend(demands);
            }
        }
    }

    fn share_samples(&mut self, samples: &Samples, depth: f64) -> f64 {
        let (balls, heights) = (&self.balls, &self.heights);
        self.nearest.find(&samples.points, balls, heights);
        samples.find_meetings(&self.nearest.balls, balls, &mut self.meetings);
        self.nearest_to_meetings
            .find(&self.meetings, balls, heights);
        let found = [
            (&samples.points, &self.nearest),
            (&self.meetings, &self.nearest_to_meetings),
        ];
        let most = found.map(|(_, nearest)| nearest.most());
        let most = most[0].max(most[1]);
        let least = (most - depth).min(NEARLY * most);
        for (points, nearest) in found {
            for number in nearest.at_least(least) {
                let (ball, point) = (nearest.balls[number], points.at(number));
                self.demands.push(Demand {
                    ball,
                    point,
                    distance: point.distance(balls[ball].0),
                });
            }
        }
        most
    }

    /// Finds the gradient of the soft maximum of all overshoots.
    fn find_gradient(&mut self, centres: &[DVec3], overshoot: f64, temperature: f64) {
        for motion in &mut self.motions {
            motion.gradient = DVec3::ZERO;
        }
        let mut total = 0.0;
        for demand in &self.demands {
            let (height, slope) = self.heights[demand.ball];
            let below = overshoot - (demand.distance + height);
            if below > NO_WEIGHT * temperature {
                continue;
            }
            let weight = (-below / temperature).exp();
            total += weight;
            let away = (centres[demand.ball] - demand.point) / demand.distance.max(1e-12);
            self.motions[demand.ball].gradient += (away + slope) * weight;
        }
        for motion in &mut self.motions {
            motion.gradient /= f64::max(total, f64::MIN_POSITIVE);
        }
    }
}
