//! Boxes and fat lines of all bodies in a few slices.

use crate::bounds::{
    BoundingCubic, BoundsBuilder, CubicRun, CubicSource, FatLine, MovingFrame, SliceInterval,
    SubCubic,
};
use crate::broad_phase::BodyBox;
use crate::knots::Knots;
use crate::simd::Task;
use parry3d::bounding_volume::Aabb;

/// The bounds of one slice: a box and a fat line for each body that exists in it.
#[derive(Clone, Debug, Default)]
pub(crate) struct SliceBounds {
    /// The `body` of a box is its place in these lists.
    pub(crate) boxes: Vec<BodyBox>,
    pub(crate) fat_lines: Vec<FatLine>,
    /// Bodies by place, ascending.
    pub(crate) bodies: Vec<u32>,
}

impl SliceBounds {
    #[inline(always)]
    pub(super) fn push(&mut self, body: u32, (fat_line, aabb): (FatLine, Aabb)) {
        let place = short(self.bodies.len());
        self.boxes.push(BodyBox { aabb, body: place });
        self.fat_lines.push(fat_line);
        self.bodies.push(body);
    }
}

/// A few consecutive slices.
///
/// Bodies are walked one by one, each through all slices at once: its segments are read once.
#[derive(Clone, Debug, Default)]
pub(crate) struct SliceBlock {
    pub(crate) slices: Vec<SliceBounds>,
    /// Each body's first cubic in the block, then its last one, where the next search begins.
    pieces: Vec<u32>,
}

impl SliceBlock {
    /// Largest number of slices in a block: each list may be as long as the longest.
    pub(crate) const SLICES: usize = 32;

    /// Empties the first slices, and makes room for so many boxes in each.
    pub(super) fn clear(&mut self, count: usize, room: usize) {
        if self.slices.len() < count {
            self.slices.resize_with(count, SliceBounds::default);
        }
        for slice in &mut self.slices[..count] {
            slice.boxes.clear();
            slice.fat_lines.clear();
            slice.bodies.clear();
            // At once: growing step by step would touch twice the memory.
            slice.boxes.reserve(room);
            slice.fat_lines.reserve(room);
            slice.bodies.reserve(room);
        }
    }
}

/// Forms the boxes and fat lines of some slices (at most [`SliceBlock::SLICES`]).
pub(crate) struct FormBounds<'a, C> {
    pub(crate) block: &'a mut SliceBlock,
    pub(crate) frame: &'a MovingFrame,
    pub(crate) sources: &'a [CubicSource<'a, C>],
    /// Places of bodies, ascending: includes each body that exists in one of the slices.
    pub(crate) present: &'a [u32],
    /// Ends of the slices, s: one more than there are slices.
    pub(crate) ends: &'a [f64],
}

impl<C: BoundingCubic> Task for FormBounds<'_, C> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let frame = self.frame;
        if frame.moves() {
            self.form(|from, to| frame.period(from, to));
        } else {
            self.form(SliceInterval::new);
        }
    }
}

impl<'a, C: BoundingCubic> FormBounds<'a, C> {
    /// Prefetch distance in bodies. Their segments are most of the data, and scattered; without
    /// prefetching, half of the time is waiting.
    const AHEAD: usize = 4;

    #[inline(always)]
    fn form<const MOVES: bool>(mut self, period: impl Fn(f64, f64) -> SliceInterval<MOVES>) {
        let Self { ends, present, .. } = self;
        let count = ends.len() - 1;
        self.block.clear(count, present.len());
        let periods = &periods_of(ends, period)[..count];
        self.block.pieces.resize(self.sources.len(), 0);
        for number in 0..Self::AHEAD {
            self.look_up(number, periods);
        }
        for (number, &place) in present.iter().enumerate() {
            self.prefetch_knots(number + 2 * Self::AHEAD);
            let ahead = self.look_up(number + Self::AHEAD, periods);
            let body = place as usize;
            let source = &self.sources[body];
            let SliceBlock { slices, pieces } = &mut *self.block;
            let first = || pieces[body] as usize;
            let put = |slice: usize, bounds| slices[slice].push(place, bounds);
            if let Some(last) = walk(source, periods, (ahead, first), put) {
                pieces[body] = short(last);
            }
        }
    }

    /// Prefetches the knots of a body, given its number among those present.
    #[inline(always)]
    fn prefetch_knots(&self, number: usize) {
        if let Some(&place) = self.present.get(number) {
            let first = self.block.pieces[place as usize] as usize;
            self.sources[place as usize].knots.prefetch(first, 8);
        }
    }

    /// Finds the first cubic of a body, given its number among those present. Prefetches the runs
    /// of cubics that the body will use. If it will use few runs, returns its cubics for
    /// prefetching during another body's walk.
    #[inline(always)]
    fn look_up<const MOVES: bool>(
        &mut self,
        number: usize,
        periods: &[SliceInterval<MOVES>],
    ) -> Ahead<'a, C> {
        let &place = self.present.get(number)?;
        let source = &self.sources[place as usize];
        let piece = &mut self.block.pieces[place as usize];
        let first = cubic_before(&source.knots, periods[0].from, *piece);
        *piece = short(first);
        if !goes_in_runs(source, periods) {
            return Some((source, first.wrapping_sub(source.knots.before())));
        }
        if exists(source, periods) {
            fetch_route(source, periods, first);
        }
        None
    }
}

/// Returns the intervals of some slices, given their ends (s): the first ones of an array.
#[inline(always)]
pub(super) fn periods_of<const MOVES: bool>(
    ends: &[f64],
    period: impl Fn(f64, f64) -> SliceInterval<MOVES>,
) -> [SliceInterval<MOVES>; SliceBlock::SLICES] {
    let mut periods = [period(0.0, 0.0); SliceBlock::SLICES];
    for (place, ends) in periods.iter_mut().zip(ends.windows(2)) {
        *place = period(ends[0], ends[1]);
    }
    periods
}

/// Calls `put` with each slice in which a body exists, by number, and the bounds there. Returns the body's last cubic
/// there, or `None` if it was not looked for. `first` returns the first one.
#[inline(always)]
pub(super) fn walk<'a, C: BoundingCubic, const MOVES: bool>(
    source: &'a CubicSource<'a, C>,
    periods: &'a [SliceInterval<MOVES>],
    (ahead, first): (Ahead<'a, C>, impl FnOnce() -> usize),
    mut put: impl FnMut(usize, (FatLine, Aabb)),
) -> Option<usize> {
    if !exists(source, periods) {
        return None;
    }
    if let Some(pieces) = source.straight_over(ends_of(periods)) {
        for (slice, period) in periods.iter().enumerate() {
            let (bounds, first) = pieces.bounds(period);
            put(slice, bounds.finish(&source.placement, short(first)));
        }
        return None;
    }
    let first = first();
    Some(if source.knots.are_extended() {
        BodyWalk::<_, _, true>::new(source, periods, ahead, first).through_extended(&mut put)
    } else {
        BodyWalk::<_, _, false>::new(source, periods, ahead, first).through(&mut put)
    })
}

/// Returns the beginning and end of a block, s.
#[inline(always)]
fn ends_of<const MOVES: bool>(periods: &[SliceInterval<MOVES>]) -> (f64, f64) {
    (periods[0].from, periods[periods.len() - 1].to)
}

/// Returns true if a body exists in a block.
#[inline(always)]
fn exists<C, const MOVES: bool>(
    source: &CubicSource<'_, C>,
    periods: &[SliceInterval<MOVES>],
) -> bool {
    let (first, last) = source.knots.ends();
    let (from, to) = ends_of(periods);
    first <= to && last >= from
}

/// Returns true if a body usually passes so many cubics in a slice that they form runs.
#[inline(always)]
fn goes_in_runs<C: BoundingCubic, const MOVES: bool>(
    source: &CubicSource<'_, C>,
    periods: &[SliceInterval<MOVES>],
) -> bool {
    let (first, last) = source.knots.ends();
    let (from, to) = ends_of(periods);
    #[allow(clippy::cast_precision_loss, reason = "an estimate")]
    let [cubics, runs] =
        [source.knots.cubics(), 2 * CubicRun::SIZE * periods.len()].map(|count| count as f64);
    source.is_in_runs() && cubics * (to - from) > runs * (last - first)
}

/// Prefetches the data of a walk through the slices, from a cubic on.
#[inline(always)]
fn fetch_route<C: BoundingCubic, const MOVES: bool>(
    source: &CubicSource<'_, C>,
    periods: &[SliceInterval<MOVES>],
    mut number: usize,
) {
    source.fetch(number);
    for period in periods {
        let end = cubic_at::<false>(&source.knots, period.to, number);
        let mut next = number + 1;
        while next < end {
            next = source.fetch_first(next, end);
        }
        source.fetch(end);
        number = end;
    }
}

/// Returns the last cubic that begins before `time` (or the first), searched from a guess.
#[inline(always)]
pub(super) fn cubic_before(knots: &Knots<'_>, time: f64, guess: u32) -> usize {
    /// Linear steps before the search halves the rest.
    const STEPS: usize = 8;
    let guess = guess as usize;
    if knots.are_extended() {
        return knots.count(|knot| knot < time).max(1) - 1;
    }
    let knots = knots.own();
    let known = guess < knots.len() && knots[guess] < time;
    let mut piece = if known { guess } else { 0 };
    for _ in 0..STEPS {
        if piece + 1 >= knots.len() || knots[piece + 1] >= time {
            return piece;
        }
        piece += 1;
    }
    piece + knots[piece + 1..].partition_point(|&knot| knot < time)
}

/// Returns the last cubic that begins by `time`, from one that begins before it. Slices are closed:
/// a cubic that begins at the slice's end counts with its first point.
#[inline(always)]
fn cubic_at<const EXTENDED: bool>(knots: &Knots<'_>, time: f64, number: usize) -> usize {
    /// Knots passed at once.
    const STEP: usize = 4;
    if EXTENDED {
        let later = (number + 1..knots.cubics()).take_while(|&next| knots.at(next) <= time);
        return number + later.count();
    }
    let knots = knots.own();
    let mut rest = &knots[number + 1..knots.len() - 1];
    while let Some((step, further)) = rest.split_first_chunk::<STEP>()
        && step[STEP - 1] <= time
    {
        rest = further;
    }
    let passed = rest.iter().take_while(|&&knot| knot <= time).count();
    knots.len() - 2 - rest.len() + passed
}

/// The walk of one body through the slices of a block.
struct BodyWalk<'a, C, const MOVES: bool, const EXTENDED: bool> {
    source: &'a CubicSource<'a, C>,
    periods: &'a [SliceInterval<MOVES>],
    ahead: Ahead<'a, C>,
    begin: usize,
}

/// A later body and the first of its plan's cubics to prefetch: one for each of this body's.
/// None: nothing to prefetch.
pub(super) type Ahead<'a, C> = Option<(&'a CubicSource<'a, C>, usize)>;

impl<'a, C: BoundingCubic, const MOVES: bool, const EXTENDED: bool>
    BodyWalk<'a, C, MOVES, EXTENDED>
{
    #[inline(always)]
    const fn new(
        source: &'a CubicSource<'a, C>,
        periods: &'a [SliceInterval<MOVES>],
        ahead: Ahead<'a, C>,
        begin: usize,
    ) -> Self {
        Self {
            source,
            periods,
            ahead,
            begin,
        }
    }

    #[inline(always)]
    fn piece(&self, number: usize) -> SubCubic {
        if let Some((later, first)) = self.ahead {
            if number == self.begin {
                later.fetch(first);
            }
            // One more: it may go through more cubics than this one.
            later.fetch(first.wrapping_add(number - self.begin + 1));
        }
        self.source.piece::<EXTENDED>(number)
    }

    /// Adds the cubics from `next` to before `end` to a builder.
    #[inline(always)]
    fn follow_whole(&self, builder: &mut BoundsBuilder<MOVES>, mut next: usize, end: usize) {
        while next < end {
            if let Some(after) = self.source.pass::<MOVES, EXTENDED>(builder, (next, end)) {
                next = after;
            } else {
                builder.follow_from_start(&self.piece(next));
                next += 1;
            }
        }
    }

    #[inline(never)]
    fn through_extended(&self, put: &mut impl FnMut(usize, (FatLine, Aabb))) -> usize {
        self.through(put)
    }

    /// Calls `put` with each slice in which the body exists, and the bounds there; returns its last cubic.
    #[inline(always)]
    fn through(&self, put: &mut impl FnMut(usize, (FatLine, Aabb))) -> usize {
        let Self {
            source,
            periods,
            begin: mut number,
            ..
        } = *self;
        let knots = &source.knots;
        let (first, last) = knots.ends();
        let mut rest = self.piece(number);
        if knots.at(number) < periods[0].from {
            rest = rest.split(periods[0].from).1;
        }
        for (slice, period) in periods.iter().enumerate() {
            if first > period.to || last < period.from {
                continue;
            }
            let begin = number;
            number = cubic_at::<EXTENDED>(knots, period.to, number);
            let builder = if number == begin {
                let (piece, after) = rest.split(period.to.min(rest.end()));
                rest = after;
                if piece.fills(period) {
                    BoundsBuilder::alone(&piece, period)
                } else {
                    BoundsBuilder::between(&piece, &piece, period)
                }
            } else {
                let head = rest;
                let whole = self.piece(number);
                let (tail, after) = whole.split(period.to.min(whole.end()));
                rest = after;
                let mut builder = BoundsBuilder::between(&head, &tail, period);
                self.follow_whole(&mut builder, begin + 1, number);
                builder.follow_from_start(&tail);
                builder
            };
            put(slice, builder.finish(&source.placement, short(begin)));
        }
        number
    }
}

/// Converts a count of bodies or segments to 32 bits; a longer list does not fit into memory.
#[inline(always)]
#[allow(clippy::cast_possible_truncation, reason = "see above")]
pub(crate) fn short(count: usize) -> u32 {
    count as u32
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bounds::{CompactTrajectory, DAabb, Frame, Padding};
    use crate::hitbox::Hitbox;
    use crate::knots::Knots;
    use crate::search::TimeSlices;
    use crate::simd::InstructionSet;
    use crate::trajectory::{State, Trajectory};
    use glam::DVec3;
    use rand::rngs::ChaCha8Rng;
    use rand::{RngExt, SeedableRng};

    /// Every box and fat line contains its body in its slice, and is not much larger.
    #[test]
    fn boxes_contain_their_bodies() {
        let mut rng = ChaCha8Rng::seed_from_u64(9);
        let mut tightest = f64::INFINITY;
        let still = Frame::around(DAabb::NOTHING, 0.0);
        let slices = TimeSlices::whole(-1.0, 12.0).with_count(19.0);
        let hitbox = Hitbox::POINT;
        let padding = Padding::of(&hitbox, 0.0, &still);
        for seed in 0..200 {
            let far = if seed % 2 == 0 { 10.0 } else { 1e6 };
            // Boxes stay, or move with some of the bodies' velocity, or faster.
            let common = match seed % 3 {
                0 => 0.0,
                1 => 20.0,
                _ => 300.0,
            };
            let mut vector =
                |half: f64| DVec3::from_array([0; 3].map(|_| rng.random_range(-half..half)));
            let base = vector(far);
            let common = vector(20.0).normalize() * common;
            let frame = still.moving(common);
            // Knots on cuts (0.684...), off cuts, and many in one slice.
            let gap = if seed % 3 == 0 {
                13.0 / 19.0
            } else {
                0.3 + f64::from(seed) * 0.01
            };
            // Some so many that slices hold runs of cubics of runs of cubics.
            let (gap, count) = if seed % 4 == 1 {
                (gap / 25.0, 225)
            } else {
                (gap, 9)
            };
            let states: Vec<State> = (0..count)
                .map(|k| {
                    let time = -1.0 + gap * f64::from(k);
                    State::new(time, base + vector(5.0), vector(20.0))
                })
                .collect();
            let Ok(trajectory) = Trajectory::from_states(&states) else {
                unreachable!("the states are in order")
            };
            let (compact, lines) = CompactTrajectory::of(trajectory.knots(), trajectory.segments());
            let source = CubicSource::compact(
                Knots::of(trajectory.knots()),
                &compact.on(&lines),
                &padding,
                &frame,
            );
            let mut block = SliceBlock::default();
            let mut ends = Vec::new();
            for first in (0..slices.count()).step_by(8) {
                let range = first..(first + 8).min(slices.count());
                slices.ends(range.clone(), &mut ends);
                InstructionSet::best().run(FormBounds {
                    block: &mut block,
                    frame: &frame,
                    sources: &[source],
                    present: &[0],
                    ends: &ends,
                });
                for (slice, found) in range.zip(&block.slices) {
                    let boxes = &found.boxes;
                    let (from, to) = slices.interval(slice);
                    let mut sampled = DAabb::NOTHING;
                    for step in 0..=50 {
                        let share = f64::from(step) / 50.0;
                        let time = (from + (to - from) * share).min(to);
                        if let Some(position) = trajectory.position(time) {
                            let fat_line = &found.fat_lines[0];
                            let [start, change] = [fat_line.start, fat_line.change]
                                .map(|lanes| DVec3::from_array(lanes.map(f64::from)));
                            let deviation = (position - (start + share * change)).length();
                            assert!(
                                deviation <= f64::from(fat_line.slack),
                                "{deviation} {fat_line:?}"
                            );
                            tightest = tightest.min(f64::from(fat_line.slack) - deviation);
                            let position = position - common * (time - from);
                            sampled.include(DAabb {
                                low: position,
                                high: position,
                            });
                        }
                    }
                    assert_eq!(boxes.is_empty(), sampled.low.x > sampled.high.x);
                    for found in boxes {
                        let low = DVec3::from_array(found.aabb.mins.to_array().map(f64::from));
                        let high = DVec3::from_array(found.aabb.maxs.to_array().map(f64::from));
                        assert!(low.cmplt(sampled.low).all() && high.cmpgt(sampled.high).all());
                        // The hull of a cubic's Bézier points reaches a bit beyond it.
                        let way = common.abs().max_element() * (to - from);
                        assert!((high - low).max_element() < 120.0 + way);
                    }
                }
            }
        }
        // The slack is that of the farthest control point, and seldom far from what is needed.
        assert!(tightest < 0.05, "{tightest}");
    }
}
