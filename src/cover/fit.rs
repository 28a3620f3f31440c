//! The search for a cover: from a shape to the best one found.

use super::certificate::{Certified, certify, fine_surfaces, without_needless};
use super::closed_form::closed_form;
use super::descent::{CoverCandidate, DescentScratch, Schedule, Target, descend};
use super::points::Samples;
use super::random::Random;
use super::refine::refined;
use super::search::{deepest, improve, lattices, pool, spread};
use super::solid::{Solid, SolidPart};
use super::surface::Surface;
use crate::parallel;
use glam::DVec3;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicU32, Ordering};

/// Sides of round forms while centres are sought.
const COARSE: u32 = 16;

/// Surfaces of more points than this are stood for by some of them.
const MANY_POINTS: usize = 400;

/// Surfaces of more polygons than this, a cuboid's, are stood for by points: each share costs a step for each polygon.
const MANY_POLYGONS: usize = 6;

/// Points from which centres are chosen.
const POOL: usize = 8_192;

/// Covers that are polished: samples do not tell which one is best then.
const POLISHED: usize = 4;

/// Balls of which single ones are moved; of more there is one descent.
const MANY_BALLS: usize = 256;

/// Points that are moved to ridges.
const RIDGE_POINTS: usize = 1_024;

/// The points that stand for surfaces while centres are sought.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Sampling {
    /// None: the shares of the surfaces themselves are found.
    Exact,
    /// The points of coarse surfaces, and more between them.
    More,
    /// Some of the points of fine surfaces.
    Fewer,
}

impl Sampling {
    /// Points between those of coarse surfaces for each ball, while centres are sought.
    const POINTS_PER_BALL: usize = 24;

    fn of(solid: &Solid, surfaces: &[Surface]) -> Self {
        let points: usize = surfaces.iter().map(|one| one.points.len()).sum();
        let polygons: usize = surfaces.iter().map(|one| one.polygons().count()).sum();
        let is_round = solid.parts.iter().any(SolidPart::is_round);
        // A segment has no triangles for points between its ends.
        let mut all = surfaces.iter().flat_map(Surface::polygons);
        if points > MANY_POINTS {
            Self::Fewer
        } else if polygons > MANY_POLYGONS && !is_round && all.all(|polygon| polygon.len() > 2) {
            Self::More
        } else {
            Self::Exact
        }
    }

    /// Returns the points for the search, and more of them for the last descents.
    fn samples(self, surfaces: &[Surface], count: usize) -> (Samples, Samples) {
        match self {
            Self::Exact => (Samples::default(), Samples::default()),
            // Flat triangles need few, and the surfaces themselves have the last word.
            Self::More => {
                let samples = |most| Samples::new(&refined(surfaces, most), most);
                let many = (Self::POINTS_PER_BALL * count).clamp(500, 1_500);
                (samples(many), samples(4 * many))
            }
            Self::Fewer => (Samples::new(surfaces, 1_000), Samples::new(surfaces, 5_000)),
        }
    }

    /// Returns the number of moves of single balls in a chain.
    const fn rounds(self) -> u32 {
        match self {
            Self::Exact => 25,
            Self::More => 16,
            // The descents after them are longer.
            Self::Fewer => 9,
        }
    }
}

/// A shape with what each fit of it needs.
#[derive(Debug)]
pub(super) struct Fitter<'a> {
    solid: &'a Solid,
    coarse: Vec<Surface>,
    fine: Vec<Surface>,
    sampling: Sampling,
    /// Empty if the coarse surfaces are used themselves.
    samples: Samples,
    /// Samples of more points, for the last descents.
    more_samples: Samples,
    /// Points in the solid, spread evenly, and on the ridges of the depth.
    pool: Vec<DVec3>,
    ridges: Vec<(DVec3, f64)>,
    seed: u64,
    effort: u32,
    /// The cover of as many balls as are searched for by moves of single ones, if it was asked for.
    of_many: OnceLock<Certified>,
}

impl<'a> Fitter<'a> {
    /// Prepares fits of a solid by at most `count` balls.
    pub(super) fn new(solid: &'a Solid, count: usize, seed: u64, effort: u32) -> Self {
        let coarse = solid.surfaces(COARSE);
        let sampling = Sampling::of(solid, &coarse);
        let (mut samples, mut more_samples) = sampling.samples(&coarse, count);
        let is_mesh = |part: &SolidPart| matches!(part, SolidPart::Mesh(_));
        // Depths in a few convex parts are soon found. The nearest point may be of another part, within the solid.
        let tell_depths = sampling == Sampling::Fewer || solid.parts.iter().any(is_mesh);
        (samples.tell_depths, more_samples.tell_depths) = (tell_depths, tell_depths);
        let pool = pool(solid, POOL, &mut Random::new(seed, u64::MAX));
        let signed_distance = |at: DVec3, scratch: &mut Vec<f64>| {
            if samples.tell_depths && !samples.is_empty() {
                samples.signed_distance(at, scratch)
            } else {
                solid.signed_distance(at)
            }
        };
        let ridges = deepest(&pool[..pool.len().min(RIDGE_POINTS)], &signed_distance);
        Self {
            solid,
            pool,
            ridges,
            fine: fine_surfaces(solid),
            coarse,
            sampling,
            samples,
            more_samples,
            seed,
            effort: effort.max(1),
            of_many: OnceLock::new(),
        }
    }

    /// Returns the number of chains, and of moves of single balls in each. They depend on the
    /// number of balls, on the effort, and on the size of the shape's surfaces.
    fn chains_and_rounds(&self, count: usize) -> (u32, u32) {
        let chains = match count {
            ..=8 => 4,
            9..=24 => 6,
            25..=48 => 4,
            49..=96 => 3,
            _ => 1,
        };
        let points: usize = self.coarse.iter().map(|one| one.points.len()).sum();
        let chains = if points > 64 {
            u32::div_ceil(2 * chains, 3)
        } else {
            chains
        };
        let chains = if count == 1 { 2 } else { chains } * self.effort;
        let rounds = if !(2..=MANY_BALLS).contains(&count) {
            0
        } else {
            self.sampling.rounds()
        };
        (chains, rounds)
    }

    /// Returns the best cover found with at most `count` balls: none reaches out farther than the cover of one ball, and
    /// of more than 256 balls than that of 256. `progress` gets the share done, below 1, on any thread.
    pub(super) fn fit(&self, count: usize, progress: &(dyn Fn(f64) + Sync)) -> Certified {
        if let Some(certified) = closed_form(self.solid, count) {
            return certified;
        }
        let mut best = if count > MANY_BALLS {
            let of_many = self.of_many.get_or_init(|| {
                let first_half = |share: f64| progress(share / 2.0);
                self.search(MANY_BALLS, &first_half)
            });
            let second_half = |share: f64| progress(f64::midpoint(share, 1.0));
            better(of_many.clone(), self.search(count, &second_half))
        } else {
            self.search(count, progress)
        };
        // One ball is as large as half the diameter, and no point is deeper than the thinnest box.
        let size = self.solid.high - self.solid.low;
        let least_of_one = (self.solid.diameter - size.min_element()) / 2.0;
        if count > 1 && best.overshoot > least_of_one {
            best = better(self.search(1, &|_| {}), best);
        }
        without_needless(self.solid, &self.fine, best)
    }

    /// Returns the best of several covers of about `count` balls.
    fn search(&self, count: usize, progress: &(dyn Fn(f64) + Sync)) -> Certified {
        let (chains, rounds) = self.chains_and_rounds(count);
        let done = AtomicU32::new(0);
        let steps = f64::from(chains * (rounds + 1) + 2);
        let step = || progress(f64::from(done.fetch_add(1, Ordering::Relaxed) + 1) / steps);
        let chains = chains as usize;
        let mut found = parallel::map(chains, DescentScratch::default, |scratch, chain| {
            self.chain(count, chain, rounds, scratch, &step)
        });
        // Of equal ones the first: a stable sort.
        found.sort_by(|a, b| a.overshoot.total_cmp(&b.overshoot));
        found.truncate(POLISHED);
        let polished = parallel::map(found.len(), DescentScratch::default, |scratch, place| {
            self.polish(found[place].clone(), scratch)
        });
        let best = polished.into_iter().reduce(better);
        best.unwrap_or_else(|| self.certify(&found[0]))
    }

    fn certify(&self, candidate: &CoverCandidate) -> Certified {
        certify(
            self.solid,
            &self.fine,
            &candidate.centres,
            candidate.overshoot,
        )
    }

    fn target(&self) -> Target<'_> {
        if self.samples.is_empty() {
            Target::Surfaces(&self.coarse)
        } else {
            Target::Samples(&self.samples)
        }
    }

    /// Descends from one start, then from each of several changes of the best centres.
    fn chain(
        &self,
        count: usize,
        chain: usize,
        rounds: u32,
        scratch: &mut DescentScratch,
        step: &impl Fn(),
    ) -> CoverCandidate {
        const FIRST: Schedule = Schedule {
            steps: 300,
            first: 0.1,
            last: 0.003,
            temperature: 1.0,
        };
        const NEXT: Schedule = Schedule {
            steps: 200,
            first: 0.06,
            last: 0.002,
            temperature: 0.4,
        };
        let mut random = Random::new(self.seed, chain as u64);
        let target = self.target();
        let mut best = None;
        // The first chain begins with the best lattice.
        if chain == 0 {
            for centres in lattices(self.solid, count) {
                let overshoot = scratch.measure(self.solid, &target, &centres, f64::NAN, 0.0);
                let is_better = |best: &CoverCandidate| overshoot < best.overshoot;
                if best.as_ref().is_none_or(is_better) {
                    best = Some(CoverCandidate { centres, overshoot });
                }
            }
        }
        let centres = match &best {
            Some(best) => best.centres.clone(),
            None => spread(&self.pool, count, &mut random),
        };
        let found = descend(self.solid, &target, centres, &FIRST, scratch);
        let mut best = match best {
            Some(best) if best.overshoot <= found.overshoot => best,
            _ => found,
        };
        // A lattice may have fewer points than there are balls.
        while best.centres.len() < count {
            best.centres.push(self.pool[random.below(self.pool.len())]);
        }
        step();
        for _ in 0..rounds {
            improve(
                self.solid,
                &target,
                &self.ridges,
                &mut best,
                &NEXT,
                &mut random,
                scratch,
            );
            step();
        }
        best
    }

    /// Descends in small steps, on what a proof demands.
    fn polish(&self, mut best: CoverCandidate, scratch: &mut DescentScratch) -> Certified {
        const LAST: Schedule = Schedule {
            steps: 400,
            first: 0.03,
            last: 1e-4,
            temperature: 0.4,
        };
        /// Few samples leave the balls farther from where they should be.
        const AFTER_SAMPLES: Schedule = Schedule {
            steps: 500,
            first: 0.1,
            ..LAST
        };
        /// After few points, on the surfaces themselves: each step costs much.
        const EXACT: Schedule = Schedule {
            first: 0.06,
            ..LAST
        };
        let certified = self.certify(&best);
        let finer = self.solid.surfaces(3 * COARSE);
        let (target, schedule) = if self.samples.is_empty() {
            (Target::Surfaces(&finer), &LAST)
        } else {
            (Target::Samples(&self.more_samples), &AFTER_SAMPLES)
        };
        best = descend(self.solid, &target, best.centres, schedule, scratch);
        let polished = better(certified, self.certify(&best));
        if self.sampling != Sampling::More {
            return polished;
        }
        let centres = polished.balls.iter().map(|&(centre, _)| centre).collect();
        let target = Target::Surfaces(&self.coarse);
        let exact = descend(self.solid, &target, centres, &EXACT, scratch);
        better(polished, self.certify(&exact))
    }
}

/// Returns the cover that reaches out less, the first of equal ones.
fn better(one: Certified, other: Certified) -> Certified {
    if other.overshoot < one.overshoot {
        other
    } else {
        one
    }
}
