//! Enclosures of the least distance: proven bounds, for a given error of the cubic.

use super::cubic::{
    CentredCubic, ControlPoints, Vector, dot, largest_coordinate, largest_of, local_time,
    power_of_two,
};
use super::guess::{descend, lowest_sample, outline, polish, settle};
use super::minorant::{from_nearer, lower_bound, lower_bound_far, lower_bound_near, split};
use super::real::Real;
use super::refine::{QUICK, refined};

/// Units of rounding of a split of the span at any time, and of two halvings after it.
pub(super) const SPLIT: f64 = 9.0;
pub(super) const SPLIT_AND_HALVED: f64 = 15.0;

/// Units of rounding of its size to which an enclosure should be tight, and to which a search for
/// the nearest point goes.
const TIGHT: f64 = 4.0;
const NEAR: f64 = 16.0;

/// The part of a piece that is cut off next to a flat minimum.
const FLAT: f64 = 1.0 / 32.0;

/// The most pieces of a branch and bound; with so many the enclosure is given as wide as it is.
const PIECES: usize = 256;

/// The least distance of a pair, enclosed, and where it was found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Enclosure {
    /// Not more than the least distance, metres; not negative.
    pub low: f64,
    /// Not less than the least distance, metres.
    pub high: f64,
    /// The local time in 0..=1 at which the distance is at most `high`.
    pub time: f64,
}

/// An enclosure from a lower bound for each side of the guess.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bracketed<R> {
    pub(super) low: R,
    pub(super) high: R,
    /// 1 if the enclosure is as tight as the error of the cubic allows, 0 if it is wider, -1 or not
    /// a number if the range has spoilt it.
    pub(super) tight: R,
}

/// Lower bounds of the squared distance on the halves of both sides of a time, from their quarters:
/// those before it from it on, then those after it.
#[inline]
pub(super) fn bounds_of_halves(points: &ControlPoints<f64>, time: f64) -> [f64; 4] {
    let [before, after] = split(*points, time);
    [
        lower_bound_near(before),
        lower_bound_far(before),
        lower_bound_near(after),
        lower_bound_far(after),
    ]
}

/// Whether bounds on the halves of both sides of a time prove that the least distance is there, up
/// to rounding.
#[inline]
pub(super) fn is_nearest_at(
    points: &ControlPoints<f64>,
    time: f64,
    error: f64,
    halves: &[f64; 4],
) -> bool {
    let [near_before, far_before, near_after, far_after] = *halves;
    let low = near_before.or_less(far_before);
    let bound = low.or_less(near_after.or_less(far_after));
    let [before, _] = split(*points, time);
    let best = dot(before[0], before[0]);
    enclose_between(*points, best, bound, error, SPLIT_AND_HALVED).tight > 0.0
}

/// The enclosure between a lower bound of the squared distance and `best`, that at the guess.
///
/// For polygons outside 1e±60 the lower bound may have suffered from the range.
#[inline(always)]
pub(super) fn enclose_between<R: Real>(
    points: ControlPoints<R>,
    best: R,
    bound: R,
    error: R,
    units: f64,
) -> Bracketed<R> {
    let size = size(points);
    let total = total_error(error, size, units);
    let (low, high) = outward(bound, best, total);
    let in_range = is_in_range(size);
    let (zero, one) = (R::from_f64(0.0), R::from_f64(1.0));
    let tight = if is_tight(bound, best, total, size, TIGHT) {
        one
    } else {
        zero
    };
    Bracketed {
        low,
        high,
        // Negative errors, and those that are no numbers, prove nothing.
        tight: if in_range & (error >= zero) {
            tight
        } else {
            -one
        },
    }
}

/// Whether lower bounds of a polygon of that size cannot have suffered from the range.
#[inline(always)]
fn is_in_range<R: Real>(size: R) -> bool {
    (size > R::from_f64(1e-60)) & (size < R::from_f64(1e60))
}

/// The size of the polygon: the largest distance of a control point, rounded up.
#[inline(always)]
fn size<R: Real>(points: ControlPoints<R>) -> R {
    let [p0, p1, p2, p3] = points;
    let squares = [dot(p0, p0), dot(p1, p1), dot(p2, p2), dot(p3, p3)];
    largest_of(squares).sqrt() * up::<R>(4.0)
}

/// The error of the cubic after splits: some units of its size more, rounded up.
#[inline(always)]
fn total_error<R: Real>(error: R, size: R, units: f64) -> R {
    (error + R::from_f64(units) * R::ROUNDING * size) * up::<R>(8.0)
}

/// One and some units of rounding.
#[inline(always)]
fn up<R: Real>(units: f64) -> R {
    R::from_f64(1.0) + R::from_f64(units) * R::ROUNDING
}

/// The enclosure from bounds of the squared distance.
#[inline(always)]
fn outward<R: Real>(bound: R, best: R, total: R) -> (R, R) {
    let zero = R::from_f64(0.0);
    let down = R::from_f64(1.0) - R::from_f64(4.0) * R::ROUNDING;
    let low = (bound.or_more(zero).sqrt() * down - total) * down;
    let high = (best.sqrt() * up::<R>(4.0) + total) * up::<R>(4.0);
    (low.or_more(zero), high)
}

/// Whether a lower bound is so near to the best value that the error of the cubic dominates, or
/// some units of rounding of its size do.
#[inline(always)]
fn is_tight<R: Real>(bound: R, best: R, total: R, size: R, units: f64) -> bool {
    let rounding = R::from_f64(units) * R::ROUNDING * size;
    let reach = best.sqrt() - (R::from_f64(0.25) * total).or_more(rounding);
    (reach <= R::from_f64(0.0)) | (bound >= reach * reach)
}

/// A piece of the branch and bound.
#[derive(Clone, Copy)]
struct Piece {
    low: f64,
    high: f64,
    /// A lower bound of the squared distance on it.
    bound: f64,
    halve: bool,
}

/// When a branch and bound may stop.
#[derive(Clone, Copy)]
enum Goal {
    /// When the enclosure is as tight as the error of the cubic.
    Tight,
    /// When no point is nearer by more than rounding.
    Near,
    /// When it is also on one side of both thresholds (inner, outer).
    Decided(f64, f64),
}

/// The enclosure of one pair, by branch and bound.
///
/// `error` bounds the distance between the true relative position and that of the polygon, at
/// every instant, metres. If it is infinite the answer is everything from 0 on.
pub(super) fn enclose(points: &ControlPoints<f64>, error: f64) -> Enclosure {
    search(points, error, Start::Whole, Goal::Tight)
}

/// The same for a pair whose nearest point is probably near a time.
pub(super) fn enclose_near(points: &ControlPoints<f64>, error: f64, time: f64) -> Enclosure {
    let (time, _) = refined(points, time, QUICK);
    search(points, error, Start::Time(time), Goal::Tight)
}

/// The time of the nearest point of one pair, up to rounding. It is probably `time`; `halves` are
/// the bounds on the halves of both sides of that.
pub(super) fn nearest_from(
    points: &ControlPoints<f64>,
    time: f64,
    halves: &[f64; 4],
    error: f64,
) -> f64 {
    let start = if is_in_range(size(*points)) {
        Start::Halves(time, *halves)
    } else {
        Start::Time(time)
    };
    search(points, error, start, Goal::Near).time
}

/// An enclosure of one pair that is good enough to tell whether it is below `inner` or above
/// `outer`, if rounding allows.
pub(super) fn enclose_for(
    points: &ControlPoints<f64>,
    error: f64,
    inner: f64,
    outer: f64,
) -> Enclosure {
    search(points, error, Start::Whole, Goal::Decided(inner, outer))
}

/// What a branch and bound starts from.
#[derive(Clone, Copy)]
enum Start {
    /// The whole span.
    Whole,
    /// Both sides of a time.
    Time(f64),
    /// The halves of both sides of a time, with their bounds as by [`bounds_of_halves`].
    Halves(f64, [f64; 4]),
}

fn search(points: &ControlPoints<f64>, error: f64, start: Start, goal: Goal) -> Enclosure {
    let largest = largest_coordinate(points);
    if !(largest.is_finite() && error.is_finite() && error >= 0.0) {
        return Enclosure {
            low: 0.0,
            high: f64::INFINITY,
            time: 0.0,
        };
    }
    if largest < 1e-285 {
        // 2 > sqrt(3): the whole polygon is that near.
        let high = (2.0 * largest + error) * up::<f64>(8.0) + f64::MIN_POSITIVE;
        return Enclosure {
            low: 0.0,
            high,
            time: 0.0,
        };
    }
    // Exact scaling by a power of two to the order of 1; underflow there is far below rounding.
    let unit = power_of_two(largest);
    let scaled = points.map(|point| point.map(|x| x / unit));
    // An error that underflows is bounded by the smallest number.
    let scaled_error = (error / unit).max(f64::MIN_POSITIVE);
    let goal = match goal {
        Goal::Decided(inner, outer) => Goal::Decided(inner / unit, outer / unit),
        Goal::Tight | Goal::Near => goal,
    };
    let units = match start {
        Start::Halves(..) => SPLIT_AND_HALVED,
        Start::Whole | Start::Time(_) => SPLIT,
    };
    let mut search = Search::new(scaled, scaled_error, units);
    match start {
        Start::Halves(time, halves) => {
            search.start_from_halves(time, halves.map(|bound| bound / unit / unit));
        }
        Start::Time(time) if time > 0.0 && time < 1.0 => search.split(0, time),
        _ => search.pieces[0].bound = lower_bound(from_nearer(scaled)),
    }
    search.run(goal);
    let (low, high) = outward(search.least_bound(), search.best, search.total);
    Enclosure {
        // Exact but where it is subnormal.
        low: (low * unit - f64::MIN_POSITIVE).max(0.0),
        high: high * unit + f64::MIN_POSITIVE,
        time: search.time,
    }
}

/// The state of a branch and bound over a polygon of size about 1.
struct Search {
    points: ControlPoints<f64>,
    size: f64,
    total: f64,
    /// The least squared distance found, and when.
    best: f64,
    time: f64,
    pieces: Vec<Piece>,
}

impl Search {
    fn new(points: ControlPoints<f64>, error: f64, units: f64) -> Self {
        let size = size(points);
        let mut pieces = Vec::with_capacity(16);
        pieces.push(Piece {
            low: 0.0,
            high: 1.0,
            bound: 0.0,
            halve: false,
        });
        let mut search = Self {
            points,
            size,
            total: total_error(error, size, units),
            best: f64::INFINITY,
            time: 0.0,
            pieces,
        };
        search.note(0.0, points[0]);
        search.note(1.0, points[3]);
        search
    }

    /// Replaces the whole span by the halves of both sides of a time.
    fn start_from_halves(&mut self, time: f64, bounds: [f64; 4]) {
        let (before, after) = (0.5 * time, 0.5 * (time + 1.0));
        let ends = [(before, time), (0.0, before), (time, after), (after, 1.0)];
        self.pieces.clear();
        for ((low, high), bound) in ends.into_iter().zip(bounds) {
            self.pieces.push(Piece {
                low,
                high,
                bound,
                halve: false,
            });
        }
        let [before, _] = split(self.points, time);
        self.note(time, before[0]);
    }

    /// Remembers the nearest point seen.
    fn note(&mut self, time: f64, position: Vector<f64>) {
        let square = dot(position, position);
        if square < self.best {
            (self.best, self.time) = (square, time);
        }
    }

    fn least_bound(&self) -> f64 {
        self.pieces
            .iter()
            .fold(f64::INFINITY, |least, piece| least.min(piece.bound))
    }

    /// Splits the piece with the least bound, at its guessed minimum and at its middle in turn,
    /// until the goal is reached or nothing can be split.
    fn run(&mut self, goal: Goal) {
        loop {
            let mut worst = 0;
            for (i, piece) in self.pieces.iter().enumerate() {
                if piece.bound < self.pieces[worst].bound {
                    worst = i;
                }
            }
            let piece = self.pieces[worst];
            if self.is_reached(goal, piece.bound) || self.pieces.len() == PIECES {
                return;
            }
            let cut = self.cut(&piece);
            if cut <= piece.low || cut >= piece.high {
                // Too short to split: the bound stands as it is.
                return;
            }
            self.split(worst, cut);
        }
    }

    fn is_reached(&self, goal: Goal, bound: f64) -> bool {
        let units = match goal {
            Goal::Near => NEAR,
            Goal::Tight | Goal::Decided(..) => TIGHT,
        };
        if let Goal::Decided(inner, outer) = goal {
            let (low, high) = outward(bound, self.best, self.total);
            if low > outer || high < inner {
                return true;
            }
        }
        is_tight(bound, self.best, self.total, self.size, units)
    }

    /// Where to split a piece: at its middle, or near its minimum.
    #[allow(
        clippy::float_cmp,
        reason = "whether an end is the very time that was noted"
    )]
    fn cut(&self, piece: &Piece) -> f64 {
        if !piece.halve {
            let [polygon, _] = sub_polygons(&self.points, piece.low, piece.high, piece.high);
            let cubic = CentredCubic::new(polygon);
            let square = outline::<f64>(cubic.rough().coefficients).square;
            let rough = descend(&square, lowest_sample(&square), f64::STEPS);
            let time = settle(&cubic, polish(&cubic, f64::from(rough))).time;
            let cut = piece.low + (piece.high - piece.low) * local_time(time);
            // A minimum at an end, or one that is not a number, gives no cut.
            if cut > piece.low && cut < piece.high {
                return cut;
            }
        }
        // Next to the nearest point a piece is not tight because the minimum is flat there. All
        // but a small part is, since away from it the position does not turn back.
        let part = FLAT * (piece.high - piece.low);
        if piece.low == self.time {
            piece.low + part
        } else if piece.high == self.time {
            piece.high - part
        } else {
            0.5 * (piece.low + piece.high)
        }
    }

    /// Replaces a piece by its two parts.
    fn split(&mut self, index: usize, cut: f64) {
        let Piece {
            low, high, halve, ..
        } = self.pieces[index];
        let [before, after] = sub_polygons(&self.points, low, cut, high);
        self.note(cut, after[0]);
        let part = |low, high, polygon| Piece {
            low,
            high,
            bound: lower_bound(from_nearer(polygon)),
            halve: !halve,
        };
        self.pieces[index] = part(low, cut, before);
        self.pieces.push(part(cut, high, after));
    }
}

/// The polygons of two parts of the span that meet at `cut`, each point straight from the root
/// polygon: 9 units of rounding of its size, however often the span was cut.
fn sub_polygons(
    points: &ControlPoints<f64>,
    low: f64,
    cut: f64,
    high: f64,
) -> [ControlPoints<f64>; 2] {
    let (l, c, h) = (leg(low, points), leg(cut, points), leg(high, points));
    let (ll, lc) = (shorter(low, &l), shorter(cut, &l));
    let (cc, ch) = (shorter(cut, &c), shorter(high, &c));
    let hh = shorter(high, &h);
    let middle = point(cut, &cc);
    [
        [point(low, &ll), point(cut, &ll), point(cut, &lc), middle],
        [middle, point(cut, &ch), point(cut, &hh), point(high, &hh)],
    ]
}

/// The first level of a blossom.
#[inline(always)]
fn leg(x: f64, points: &ControlPoints<f64>) -> [Vector<f64>; 3] {
    let [p0, p1, p2, p3] = *points;
    [between(x, p0, p1), between(x, p1, p2), between(x, p2, p3)]
}

/// The second level of a blossom.
#[inline(always)]
fn shorter(x: f64, [a, b, c]: &[Vector<f64>; 3]) -> [Vector<f64>; 2] {
    [between(x, *a, *b), between(x, *b, *c)]
}

/// The last level of a blossom.
#[inline(always)]
fn point(x: f64, [a, b]: &[Vector<f64>; 2]) -> Vector<f64> {
    between(x, *a, *b)
}

#[inline(always)]
fn between(x: f64, a: Vector<f64>, b: Vector<f64>) -> Vector<f64> {
    let y = 1.0 - x;
    [
        y * a[0] + x * b[0],
        y * a[1] + x * b[1],
        y * a[2] + x * b[2],
    ]
}
