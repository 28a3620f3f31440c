//! The certified minimum: split at the guess, bound both sides, branch where that is not enough.

use super::guess::least_point;
use super::normal::{Normal, SLACK, UNIT};
use super::piece::{
    Base, Minorant, Polygon, greater, part, point, reversed, smaller, split, stationary_reach,
};
use super::{DistanceEnclosure, Effort, LeastDistance, ParameterEnclosure, UncertainCubic};

/// Pieces held at once, and splits made, before the search answers with what it has. Random
/// input needs 2 pieces, the worst adversarial input met needed fewer than 100 splits.
const MAX_HEAP: usize = 48;
const MAX_WORK: u32 = 160;

/// Pieces shorter than this cannot be split usefully: their ends are a few roundings apart.
const SHORTEST: f64 = 16.0 * f64::EPSILON;

/// A part of the parameter interval with its lower bound.
#[derive(Clone, Copy, Debug)]
struct Piece {
    start: f64,
    end: f64,
    base: Base,
    minorant: Minorant,
    /// Lower bound of the squared distance.
    lower: f64,
}

impl Piece {
    #[inline]
    fn new(points: &Polygon, start: f64, end: f64, base: Base) -> Self {
        let minorant = Minorant::of(points);
        Self {
            start,
            end,
            base,
            minorant,
            lower: minorant.lower(),
        }
    }

    /// The part from `start` to `end`, around the end with the smaller distance.
    fn between(cubic: &Normal, start: f64, end: f64) -> Self {
        let points = part(&cubic.points, start, end);
        if points[0].length_squared() <= points[3].length_squared() {
            Self::new(&points, start, end, Base::Start)
        } else {
            Self::new(&reversed(points), start, end, Base::End)
        }
    }

    fn base_parameter(&self) -> f64 {
        match self.base {
            Base::Start => self.start,
            Base::End => self.end,
        }
    }

    /// The parameters at which the squared distance can be at most `level`.
    #[inline]
    fn can_reach(&self, level: f64) -> Option<ParameterEnclosure> {
        if self.lower > level {
            return None;
        }
        let reach = self.minorant.reach(level) * (self.end - self.start);
        Some(match self.base {
            Base::Start => ParameterEnclosure {
                first: self.start,
                last: smaller(outward(self.start + reach, 1.0), self.end),
            },
            Base::End => ParameterEnclosure {
                first: greater(outward(self.end - reach, -1.0), self.start),
                last: self.end,
            },
        })
    }
}

/// Moved up (`direction` 1) or down (-1) by more than the rounding of a sum, which does not underflow.
#[inline]
fn outward(s: f64, direction: f64) -> f64 {
    s + direction * (4.0 * UNIT * s.abs())
}

/// The best point met so far.
#[derive(Clone, Copy, Debug)]
struct Best {
    s: f64,
    square: f64,
}

impl Best {
    #[inline]
    fn offer(&mut self, s: f64, square: f64) {
        if square < self.square {
            *self = Self { s, square };
        }
    }
}

pub(super) fn least_distance(given: &UncertainCubic) -> LeastDistance {
    let cubic = Normal::new(&given.points, given.error);
    let s = least_point(&cubic.points);
    let halves = split(&cubic.points, s);
    let best = Best {
        s,
        square: halves.0[0].length_squared(),
    };
    let first = Piece::new(&halves.0, 0.0, s, Base::End);
    let second = Piece::new(&halves.1, s, 1.0, Base::Start);
    let error = cubic.part_error();
    if smaller(first.lower, second.lower) >= target(&cubic, error, best.square) {
        let level = level(error, best.square);
        let found = Found {
            best,
            lower: smaller(first.lower, second.lower),
            hull: union(first.can_reach(level), second.can_reach(level)),
            effort: Effort::Tight,
        };
        found.answer(&cubic, error, &halves)
    } else {
        let found = branch(&cubic, error, best, [first, second]);
        let halves = split(&cubic.points, found.best.s);
        found.answer(&cubic, error, &halves)
    }
}

pub(super) fn distance_at(given: &UncertainCubic, s: f64) -> DistanceEnclosure {
    let cubic = Normal::new(&given.points, given.error);
    let square = point(&cubic.points, s).length_squared();
    enclosure(
        &cubic,
        cubic.part_error(),
        square * (1.0 - 4.0 * UNIT),
        square,
    )
}

/// From a lower bound of the computed squared distance, and a computed one that is reached.
fn enclosure(cubic: &Normal, error: f64, lower: f64, reached: f64) -> DistanceEnclosure {
    // One unit of the root is that of the root and of the difference, half of one each.
    let low = greater(lower, 0.0).sqrt().next_down() - error;
    let high = (root_above(reached) + error).next_up();
    DistanceEnclosure {
        low: cubic.restore_below(greater(low, 0.0)),
        high: cubic.restore_above(high),
    }
}

/// Squared distance that lower bounds must reach for the enclosure to be as tight as its error.
#[inline]
fn target(cubic: &Normal, error: f64, best: f64) -> f64 {
    let nearest = best.sqrt();
    let root = nearest - greater(0.25 * error, 8.0 * UNIT * cubic.size);
    // Next to zero the spacing of the parameters alone moves the distance by 6u M.
    if root > 0.0 && nearest > 16.0 * UNIT * cubic.size {
        root * root
    } else {
        f64::NEG_INFINITY
    }
}

/// No minimiser of the exact distance has a computed squared distance above this: the exact one
/// is at most the best point's plus its error, the computed one at most an error more.
#[inline]
fn level(error: f64, best: f64) -> f64 {
    let root = root_above(best) + 2.0 * error;
    root * root * (1.0 + 8.0 * UNIT)
}

/// At least the norm of which this is the computed square.
#[inline]
fn root_above(square: f64) -> f64 {
    // What underflow can hide in a square of three products is below (1e-150)².
    square.sqrt() * (1.0 + 4.0 * UNIT) + 1e-150
}

fn union(
    a: Option<ParameterEnclosure>,
    b: Option<ParameterEnclosure>,
) -> Option<ParameterEnclosure> {
    match (a, b) {
        (Some(a), Some(b)) => Some(ParameterEnclosure {
            first: smaller(a.first, b.first),
            last: greater(a.last, b.last),
        }),
        (one, None) | (None, one) => one,
    }
}

/// What the search found, in the unit of the normalised cubic.
struct Found {
    best: Best,
    lower: f64,
    /// All parameters at which the minimum can be; none only if rounding contradicts itself.
    hull: Option<ParameterEnclosure>,
    effort: Effort,
}

impl Found {
    fn answer(self, cubic: &Normal, error: f64, halves: &(Polygon, Polygon)) -> LeastDistance {
        LeastDistance {
            distance: enclosure(cubic, error, self.lower, self.best.square),
            parameter: self.narrowed(error, halves),
            guess: self.best.s,
            effort: self.effort,
        }
    }

    /// The hull cut down by the slope at the best point, where the distance is convex around it.
    fn narrowed(&self, error: f64, halves: &(Polygon, Polygon)) -> ParameterEnclosure {
        const WIDEST: f64 = 0.125;
        let s = self.best.s;
        let Some(hull) = self.hull else {
            return ParameterEnclosure::WHOLE;
        };
        let (longer, length) = if s > 0.5 {
            (&halves.0, s)
        } else {
            (&halves.1, 1.0 - s)
        };
        let range = greater(s - hull.first, hull.last - s) / length * SLACK;
        if range > WIDEST {
            return hull;
        }
        let reach = stationary_reach(longer, error, range) * length * SLACK;
        ParameterEnclosure {
            first: greater(outward(s - reach, -1.0), hull.first),
            last: smaller(outward(s + reach, 1.0), hull.last),
        }
    }
}

/// Best first: the piece with the smallest lower bound is divided, alternately where its distance
/// seems least and in the middle, until all bounds reach the target or the work is used up. The
/// bounds are valid at any time.
#[cold]
#[inline(never)]
fn branch(cubic: &Normal, error: f64, mut best: Best, halves: [Piece; 2]) -> Found {
    let mut pieces = [halves[0]; MAX_HEAP];
    pieces[1] = halves[1];
    let mut count = 2;
    let mut effort = Effort::Limited;
    for work in 0..MAX_WORK {
        let least = least_index(&pieces[..count]);
        let piece = pieces[least];
        if piece.lower >= target(cubic, error, best.square) {
            effort = Effort::Tight;
            break;
        }
        if count == MAX_HEAP || piece.end - piece.start < SHORTEST {
            break;
        }
        let s = dividing_point(cubic, &piece, work);
        let parts = [
            Piece::between(cubic, piece.start, s),
            Piece::between(cubic, s, piece.end),
        ];
        for part in &parts {
            best.offer(part.base_parameter(), part.minorant.base);
        }
        pieces[least] = parts[0];
        pieces[count] = parts[1];
        count += 1;
        // What is certainly above the minimum holds no minimiser either.
        let level = level(error, best.square);
        let mut kept = 0;
        for i in 0..count {
            if pieces[i].lower <= level {
                pieces[kept] = pieces[i];
                kept += 1;
            }
        }
        count = kept;
    }
    let level = level(error, best.square);
    let pieces = &pieces[..count];
    Found {
        best,
        lower: pieces[least_index(pieces)].lower,
        hull: pieces
            .iter()
            .fold(None, |hull, piece| union(hull, piece.can_reach(level))),
        effort,
    }
}

fn least_index(pieces: &[Piece]) -> usize {
    let mut least = 0;
    for (i, piece) in pieces.iter().enumerate() {
        if piece.lower < pieces[least].lower {
            least = i;
        }
    }
    least
}

/// In turns: the middle, which serves most input; where the distance seems least, which separates
/// minima; and next to the base, which serves flat minima, where bounds grow with the fourth or
/// sixth power of the distance from it.
fn dividing_point(cubic: &Normal, piece: &Piece, turn: u32) -> f64 {
    const NEAR_END: f64 = 1.0 / 64.0;
    const NEAR_BASE: f64 = 1.0 / 8.0;
    let width = piece.end - piece.start;
    let x = match turn % 3 {
        1 => least_point(&part(&cubic.points, piece.start, piece.end)),
        2 => match piece.base {
            Base::Start => NEAR_BASE,
            Base::End => 1.0 - NEAR_BASE,
        },
        _ => 0.5,
    };
    let is_useful = NEAR_END < x && x < 1.0 - NEAR_END;
    piece.start + if is_useful { x } else { 0.5 } * width
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rounding::exact::number;
    use glam::DVec3;
    use rand::rngs::ChaCha8Rng;
    use rand::{RngExt, SeedableRng};

    /// Whichever of the root and the error is larger, and next to powers of two.
    #[test]
    fn distances_are_rounded_outward() {
        let mut random = ChaCha8Rng::seed_from_u64(1);
        let cubic = Normal::new(&[DVec3::ONE; 4], 0.0);
        for round in 0..20_000 {
            let square = [random.random_range(0.5..2.0), 1.0, 4.0][round % 3];
            let square = [square, f64::next_down(square), square][round / 3 % 3];
            let error = 10f64.powf(random.random_range(-17.0..1.0));
            let found = enclosure(&cubic, error, square, square);
            let low = number(found.low) + number(error);
            assert!(
                found.low <= 0.0 || &low * &low <= number(square),
                "{square} {error}"
            );
            // The computed square may be too small by three roundings.
            let high = number(found.high) - number(error);
            let square_above = number(square) * (number(1.0) + number(3.0 * UNIT));
            assert!(&high * &high >= square_above, "{square} {error}");
        }
    }

    /// Sums and differences of parameters, also next to zero.
    #[test]
    fn parameters_are_rounded_outward() {
        let mut random = ChaCha8Rng::seed_from_u64(3);
        for round in 0..10_000 {
            let size = [1.0, 1e-3, 1e-300, 5e-324][round % 4];
            let (s, way): (f64, f64) = (random.random(), size * random.random_range(0.5..1.0));
            let exact = number(s) + number(way);
            assert!(number(outward(s + way, 1.0)) >= exact, "{s} {way}");
            let exact = number(s) - number(way);
            assert!(number(outward(s - way, -1.0)) <= exact, "{s} {way}");
        }
    }

    /// Also of squares that underflow.
    #[test]
    fn roots_are_rounded_up() {
        let mut random = ChaCha8Rng::seed_from_u64(2);
        for _ in 0..5_000 {
            let x = 10f64.powf(random.random_range(-170.0..2.0));
            assert!(root_above(x * x) >= x, "{x}");
        }
    }
}
