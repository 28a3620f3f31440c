//! Choice of the slice length by a cost model and a sample of the bodies. It uses counts, no clock,
//! so that a scene is always cut alike; answers do not depend on it.
//!
//! Short slices cost boxes; long ones cost candidates, which grow with the cube of a box's size. A
//! sample of the bodies is put through slices of one length at a few times in the window. The
//! candidates found, and the growth of boxes with time, give the cheapest length, which is then
//! tried in turn.

use super::by_place::ByPlace;
use super::form::FormBounds;
use super::lifetimes::list_present;
use super::{Limits, SceneStatistics, SearchScratch, TimeSlices};
use crate::bounds::{BoundingCubic, CubicSource, MovingFrame};
use crate::broad_phase::{CandidateLimit, Method, PairFilter};
use crate::count::short;
use crate::narrow_phase::approaching;
use crate::pool::Pool;
use crate::shape::BodyShape;
use crate::simd::InstructionSet;
use std::ops::Range;

/// Nanoseconds of each kind of work on one thread (the benchmarks' swarm of 10,000 bodies). Only ratios matter.
mod cost {
    /// Passing a slice, and listing a body of those that exist in it.
    pub(super) const SLICE: f64 = 60.0;
    pub(super) const LISTING: f64 = 0.1;
    /// Forming a box and a fat line, cutting a segment for it, and sorting it.
    pub(super) const BOX: f64 = 65.0;
    /// Comparing a box with its neighbours, times this power of its candidates.
    pub(super) const SWEEP: f64 = 25.0;
    pub(super) const SWEEP_POWER: f64 = 0.75;
    /// Testing the fat lines of a candidate.
    pub(super) const CANDIDATE: f64 = 15.0;
    /// Examining a near candidate, and each of its spans: by compact cubics, and by the segments of plans.
    pub(super) const NEAR: [f64; 2] = [120.0, 40.0];
    pub(super) const NEAR_IN_PLACE: [f64; 2] = [575.0, 70.0];
}

/// Largest number of candidates in a trial's slice: with more, slices must be shorter.
const MAX_CANDIDATES: u64 = 1 << 20;

/// Growth of near candidates with the length of a slice, as a power of it, before two lengths were
/// tried: at least proportional, and fat lines become less straight.
const NEAR_GROWTH: f64 = 2.5;

/// Largest growth of a count: that of a volume.
const MAX_GROWTH: f64 = 3.0;

/// Largest change of a trial's length, in quarters of a power of two.
const MAX_QUARTERS: i32 = 8;

/// Change of length, as a factor, below which a trial is good enough.
const SETTLED: Range<f64> = 0.7..1.5;

/// Returns the shape of a body if it turns and has long arms.
type LongArms<'f, 'a> = dyn Fn(u32) -> Option<BodyShape<'a>> + 'f;

/// Counts in slices of one length, for all bodies.
struct Trial {
    bodies: f64,
    /// Boxes, candidates, and near candidates (not ruled out by their fat lines), per slice.
    boxes: f64,
    candidates: f64,
    near: f64,
    /// Shares of the slice in which near candidates may be near, summed.
    shares: f64,
    /// Cubics per box.
    cubics: f64,
    /// Costs of a near candidate and of a span, ns.
    near_costs: [f64; 2],
    /// Mean extent of a box, and its part that does not shrink with the slice (frame's unit).
    extents: [f64; 3],
    least: f64,
    /// True if there were more candidates than were listed.
    is_exceeded: bool,
}

/// Growth of counts with the length of a slice, as powers of it.
struct Growth {
    /// `None`: as the boxes' volume.
    candidates: Option<f64>,
    near: f64,
}

impl Growth {
    const ASSUMED: Self = Self {
        candidates: None,
        near: NEAR_GROWTH,
    };

    /// Returns the growth between two trials, the second with slices `factor` times as long.
    fn between(first: &Trial, second: &Trial, factor: f64) -> Self {
        let power = |one: f64, other: f64| {
            let power = (other / one).ln() / factor.ln();
            // Where nothing was found there is nothing to tell.
            power.is_finite().then(|| power.clamp(0.0, MAX_GROWTH))
        };
        Self {
            candidates: power(first.candidates, second.candidates),
            near: power(first.near, second.near).unwrap_or(NEAR_GROWTH),
        }
    }
}

impl Trial {
    /// Returns the expected cost of `1 / factor` slices that are `factor` times as long.
    fn cost(&self, factor: f64, growth: &Growth) -> f64 {
        let grown: f64 = match growth.candidates {
            Some(power) => factor.powf(power),
            None => self.volume(factor) / self.volume(1.0),
        };
        let candidates = self.candidates * grown;
        let per_box =
            cost::BOX + cost::SWEEP * (candidates / self.boxes.max(1.0)).powf(cost::SWEEP_POWER);
        let more = factor.powf(growth.near);
        // Each span ends with a cubic of one of the two bodies.
        let spans = self.near + 2.0 * self.cubics * factor * self.shares;
        let [of_near, of_span] = self.near_costs;
        let near = (of_near * self.near + of_span * spans) * more;
        let slice = cost::SLICE + cost::LISTING * self.bodies;
        (slice + self.boxes * per_box + candidates * cost::CANDIDATE + near) / factor
    }

    /// Returns the cost of all slices of this length.
    fn cost_of_all(&self, slices: &TimeSlices<'_>) -> f64 {
        self.cost(1.0, &Growth::ASSUMED) * f64::from(slices.count())
    }

    /// Returns true if there is room for the candidates of a slice: it need not be divided.
    fn fits(&self, limits: Limits) -> bool {
        !self.is_exceeded && self.candidates < limits.candidates as f64
    }

    /// Returns true if comparisons dominate. If boxes are so long that nearly all overlap, slices
    /// some times shorter show no gain yet; only far shorter ones do.
    fn is_crowded(&self) -> bool {
        const MAX: f64 = 8.0;
        self.candidates * cost::CANDIDATE > MAX * self.boxes * cost::BOX
    }

    /// Returns true if boxes have so many candidates that those of whole groups may overlap.
    fn has_many_candidates(&self) -> bool {
        const MANY: f64 = 4.0;
        self.candidates > MANY * self.boxes
    }

    /// Returns the volume of a mean box in a slice `factor` times as long.
    fn volume(&self, factor: f64) -> f64 {
        self.extents
            .iter()
            .map(|&extent| (extent - self.least).max(0.0) * factor + self.least)
            // Of a length however small: flat boxes are compared as well.
            .map(|extent| extent.max(f64::MIN_POSITIVE.sqrt()))
            .product()
    }

    /// Returns the cheapest factor within the range in which one trial can be trusted.
    fn best_factor(&self, growth: &Growth) -> f64 {
        let quarters = -MAX_QUARTERS..=MAX_QUARTERS;
        let costs = quarters.map(|quarter| {
            let factor = 2_f64.powf(f64::from(quarter) / 4.0);
            (self.cost(factor, growth), factor)
        });
        let cheapest = costs.min_by(|one, other| one.0.total_cmp(&other.0));
        cheapest.map_or(1.0, |(_, factor)| factor)
    }
}

/// Returns the cost and the slices of a far longer length that is cheaper than `slices` are at `least`, if there is one.
/// Where boxes are so long that those of all bodies of a group overlap, there are as many candidates in longer slices,
/// and so fewer in all.
fn cheaper_longer<'p>(
    limits: Limits,
    (mut slices, mut least): (TimeSlices<'p>, f64),
    attempt: impl Fn(TimeSlices<'p>) -> Trial,
) -> Option<(f64, TimeSlices<'p>)> {
    /// Change of length from one trial to the next, as a factor.
    const LONGER: f64 = 8.0;
    let mut cheapest = None;
    while slices.count() > 1 {
        slices = slices.with_count(f64::from(slices.count()) / LONGER);
        let trial = attempt(slices);
        let cost = trial.cost_of_all(&slices);
        if cost >= least || !trial.fits(limits) {
            break;
        }
        least = cost;
        cheapest = Some((least, slices));
    }
    cheapest
}

/// Bodies, of which a sample is put through slices.
pub(crate) struct SliceTrials<'a> {
    /// First and last instant of each body, s.
    pub(crate) lifetimes: &'a [(f64, f64)],
    pub(crate) frame: &'a MovingFrame,
    pub(crate) limits: Limits,
    pub(crate) instructions: InstructionSet,
    pub(crate) pool: &'a Pool<SearchScratch>,
    /// True if near candidates are examined by the segments of plans, not by compact cubics.
    pub(crate) is_in_place: bool,
}

impl SliceTrials<'_> {
    /// Returns the window in slices of the length of least expected cost, searched from the given
    /// length, for the pairs that a filter admits. `sources` returns those of the bodies at some places.
    pub(crate) fn cheapest<'s, 'p, C: BoundingCubic + 'p>(
        &self,
        mut slices: TimeSlices<'s>,
        (statistics, filter): (&SceneStatistics, &dyn PairFilter),
        sources: &dyn Fn(&[usize]) -> Vec<CubicSource<'p, C>>,
        long_arms: &LongArms<'_, 'p>,
    ) -> TimeSlices<'s> {
        /// Fewer bodies are not worth a trial, unless they have more boxes than `FEW_IN_ALL`.
        const FEW: usize = 64;
        const FEW_IN_ALL: f64 = 4096.0;
        /// Each trial changes the length at most fourfold, or by `SHORTER` in a crowd.
        const MAX_TRIALS: usize = 6;
        const SHORTER: f64 = 8.0;
        let window = slices.effective_window();
        let bodies = self.lifetimes.len();
        if bodies == 0 {
            return slices;
        }
        let present = statistics.present(window);
        let sample = sample(bodies, present, slices.count());
        // Where everybody is near everybody all the time slices save nothing.
        let spans = statistics.spans(window);
        let boxes = present * f64::from(slices.count());
        let most_near = 0.5 * present * boxes;
        if sample.len() < FEW && boxes <= FEW_IN_ALL && most_near <= spans {
            return slices;
        }
        let sampled = sources(&sample);
        let lifetimes: Vec<_> = sample.iter().map(|&place| self.lifetimes[place]).collect();
        let whole = bodies as f64 / sample.len() as f64;
        let places: Vec<u32> = sample.iter().map(|&place| short(place)).collect();
        let filter = &ByPlace::new(&places, filter);
        let of_sampled = |number: u32| long_arms(places[number as usize]);
        let attempt = |slices: TimeSlices<'s>| {
            let cubics = 1.0 + statistics.cubics_in(slices.length());
            self.trial(
                &lifetimes,
                (&sampled, filter, &of_sampled),
                &slices,
                whole,
                cubics,
            )
        };
        let mut last: Option<(Trial, f64)> = None;
        // The cheapest crowded slices, and those that are far longer than the first ones and cheaper.
        let (mut crowded, mut longer): (Option<(f64, TimeSlices<'s>)>, _) = (None, None);
        let mut expected = f64::INFINITY;
        for number in 0..MAX_TRIALS {
            let trial = attempt(slices);
            let cost = trial.cost_of_all(&slices);
            let useful = statistics.most_slices(window);
            let count = f64::from(slices.count());
            // Somewhat shorter slices may show no gain, or may not be tried.
            if number == 0 && (trial.has_many_candidates() || count + 1.0 > useful) {
                longer = cheaper_longer(self.limits, (slices, cost), attempt);
            }
            expected = cost;
            let most = useful.min(spans / trial.near);
            let least = crowded.map_or(f64::INFINITY, |(cost, _)| cost);
            if trial.is_crowded() && last.is_none() {
                if cost < least {
                    crowded = Some((cost, slices));
                }
                let next = slices.with_count((SHORTER * count).min(most));
                if next.count() > slices.count() {
                    slices = next;
                    continue;
                }
            }
            if let Some((_, before)) = crowded.filter(|_| cost > least) {
                (slices, expected) = (before, least);
                break;
            }
            let growth = last.as_ref().map_or(Growth::ASSUMED, |(last, factor)| {
                Growth::between(last, &trial, *factor)
            });
            let mut factor = trial.best_factor(&growth);
            // Back again: somewhere in between.
            let turned = last.is_some_and(|(_, last)| (factor - 1.0) * (last - 1.0) < 0.0);
            if turned {
                factor = factor.sqrt();
            }
            let next = slices.with_count((count / factor).min(most));
            let settled = turned || SETTLED.contains(&factor) || next.count() == slices.count();
            expected = count * trial.cost(count / f64::from(next.count()), &growth);
            slices = next;
            if settled {
                break;
            }
            last = Some((trial, factor));
        }
        let longer = longer.filter(|&(cost, _)| cost < expected);
        let slices = longer.map_or(slices, |(_, slices)| slices);
        slices.shared_evenly()
    }

    /// Returns the counts in a few slices of one length, scaled from the sample to all bodies.
    fn trial<'l, C: BoundingCubic>(
        &self,
        lifetimes: &[(f64, f64)],
        (sources, filter, long_arms): (&[CubicSource<'_, C>], &ByPlace<'_>, &LongArms<'_, 'l>),
        slices: &TimeSlices<'_>,
        whole: f64,
        cubics: f64,
    ) -> Trial {
        const TRIED_SLICES: u32 = 3;
        let tried_slices = TRIED_SLICES.min(slices.count());
        let mut scratch = self.pool.take();
        let SearchScratch {
            present,
            tried,
            methods,
            candidates,
            ends,
            ..
        } = &mut *scratch;
        let (mut boxes, mut found, mut near, mut shares) = (0.0, 0.0, 0.0, 0.0);
        let (mut extents, mut is_exceeded) = ([0.0; 3], false);
        for number in 0..tried_slices {
            let share = (f64::from(number) + 0.5) / f64::from(tried_slices);
            let first = slices.number_at(share);
            let lives = lifetimes.iter().copied();
            list_present(lives, 0, slices.interval(first), present);
            slices.ends(first..first + 1, ends);
            self.instructions.run(FormBounds {
                block: &mut *tried,
                frame: self.frame,
                sources,
                present: &*present,
                ends: &*ends,
            });
            tried.slices[0].tighten(slices.interval(first), self.frame, long_arms);
            let slice = &tried.slices[0];
            candidates.clear();
            let room = CandidateLimit::new(filter, MAX_CANDIDATES);
            let method = (Method::Sweep, self.instructions);
            methods.pairs(method, &slice.boxes, &room, candidates);
            is_exceeded |= room.is_exceeded();
            let interval = slices.interval(first);
            for pair in &*candidates {
                let (a, b) = (pair.a as usize, pair.b as usize);
                if let Some((from, to)) =
                    approaching(&slice.fat_lines[a], &slice.fat_lines[b], interval)
                {
                    near += 1.0;
                    // An instant is near for all of it.
                    shares += ((to - from) / (interval.1 - interval.0)).min(1.0);
                }
            }
            boxes += slice.boxes.len() as f64;
            found += candidates.len() as f64;
            for one in &slice.boxes {
                for (axis, extent) in extents.iter_mut().enumerate() {
                    *extent += f64::from(one.aabb.maxs[axis]) - f64::from(one.aabb.mins[axis]);
                }
            }
        }
        let reach: f64 = sources.iter().map(|source| source.placement.reach()).sum();
        let tried_slices = f64::from(tried_slices);
        Trial {
            bodies: sources.len() as f64 * whole,
            boxes: boxes * whole / tried_slices,
            candidates: found * whole * whole / tried_slices,
            near: near * whole * whole / tried_slices,
            shares: shares * whole * whole / tried_slices,
            cubics,
            near_costs: if self.is_in_place {
                cost::NEAR_IN_PLACE
            } else {
                cost::NEAR
            },
            extents: extents.map(|extent| extent / boxes.max(1.0)),
            least: 2.0 * reach / sources.len() as f64,
            is_exceeded,
        }
    }
}

/// Returns different places below `count`, spread evenly but not periodically, so that no order of
/// the bodies hides some of them. If `present` bodies exist at a time, they are enough for a dozen
/// pairs to overlap in the slices tried. A dozen scatters, so more places are taken if many bodies
/// go through many `slices`, at a few hundredths of the remaining cost.
#[allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "between 1 and count"
)]
fn sample(count: usize, present: f64, slices: u32) -> Vec<usize> {
    /// Factor on the root of the number of bodies, for which a dozen pairs overlap.
    const ENOUGH: f64 = 6.0;
    /// Shares of all bodies: per slice of the window, and at most.
    const AFFORDABLE: f64 = 0.008;
    const MAX: f64 = 1.0 / 12.0;
    let affordable = (AFFORDABLE * f64::from(slices)).min(MAX);
    let enough = ENOUGH / present.max(1.0).sqrt();
    let size = (count as f64 * enough.max(affordable)) as usize;
    let size = size.clamp(1, count);
    let stride = count / size;
    (0..size)
        .map(|k| {
            // Multiples of the golden ratio.
            let fraction = u64::from((k as u32).wrapping_mul(0x9E37_79B9));
            // The product needs more than the 32 bits of a count on some machines.
            (k as u64 * count as u64 / size as u64 + ((fraction * stride as u64) >> 32)) as usize
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// So many bodies that a count times a count has more than 32 bits.
    #[test]
    fn samples_are_spread_over_all_bodies() {
        for count in [1, 100, 10_000, 400_000] {
            let places = sample(count, 1e3, 100);
            let stride = count / places.len();
            assert!(places.windows(2).all(|pair| pair[0] < pair[1]), "{count}");
            assert!(places[0] < stride && places[places.len() - 1] < count);
            assert!(places[places.len() - 1] + 2 * stride >= count, "{count}");
        }
    }
}
