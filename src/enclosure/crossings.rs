//! The certified partition: certainly inside a threshold, certainly outside, undecided.

use super::guess::least_point;
use super::normal::{Normal, SLACK, TINY, UNIT};
use super::piece::{Minorant, Polygon, greater, part, point, reversed, smaller};
use super::{Effort, Side, Stretch, Threshold, UncertainCubic};

/// Up to six crossings make seven certain stretches and six undecided ones between them.
const LARGEST_COUNT: usize = 16;

/// Parts looked at before the rest is left undecided.
const LARGEST_WORK: u32 = 256;

/// Parts shorter than this are a few roundings long.
const SHORTEST: f64 = 16.0 * f64::EPSILON;

/// A partition of 0..=1 into stretches, ascending; neighbours share their end and differ in kind.
#[derive(Clone, Copy, Debug)]
pub struct Stretches {
    stretches: [Stretch; LARGEST_COUNT],
    count: usize,
    effort: Effort,
}

impl Stretches {
    const NONE: Self = Self {
        stretches: [Stretch {
            first: 0.0,
            last: 0.0,
            side: Side::Undecided,
        }; LARGEST_COUNT],
        count: 0,
        effort: Effort::Tight,
    };

    /// The stretches, at least one.
    #[must_use]
    pub fn as_slice(&self) -> &[Stretch] {
        &self.stretches[..self.count]
    }

    /// Whether the search came to its end; where it did not, more is undecided than need be.
    #[must_use]
    pub fn effort(&self) -> Effort {
        self.effort
    }

    fn all(side: Side) -> Self {
        let mut whole = Self::NONE;
        whole.append(1.0, side);
        whole
    }

    /// The stretch from the last end to `last`.
    fn append(&mut self, last: f64, side: Side) {
        let first = match self.as_slice().last() {
            Some(stretch) if stretch.side == side => {
                self.stretches[self.count - 1].last = last;
                return;
            }
            Some(stretch) => stretch.last,
            None => 0.0,
        };
        if last <= first {
            return;
        }
        if self.count == LARGEST_COUNT {
            // Undecided is always true.
            self.effort = Effort::Limited;
            let end = &mut self.stretches[self.count - 1];
            end.last = last;
            end.side = Side::Undecided;
            return;
        }
        self.stretches[self.count] = Stretch { first, last, side };
        self.count += 1;
    }
}

/// Squared thresholds: what is below `inside` is certainly inside, above `outside` certainly
/// outside. Minus infinity where nothing can be inside, or everything must be outside.
#[derive(Clone, Copy, Debug)]
struct Levels {
    inside: f64,
    outside: f64,
}

impl Levels {
    /// For distances wrong by at most `error`.
    fn new(low: f64, high: f64, error: f64) -> Self {
        let (near, far) = (low - error, high + error);
        Self {
            inside: if near > 0.0 {
                near * near * (1.0 - 8.0 * UNIT) - TINY
            } else {
                f64::NEG_INFINITY
            },
            outside: if far >= 0.0 {
                far * far * (1.0 + 8.0 * UNIT) + TINY
            } else {
                f64::NEG_INFINITY
            },
        }
    }

    fn side(&self, low: f64, high: f64) -> Side {
        if high < self.inside {
            Side::Inside
        } else if low > self.outside {
            Side::Outside
        } else {
            Side::Undecided
        }
    }
}

/// The computed cubic and the threshold in its unit.
struct Question {
    cubic: Normal,
    low: f64,
    high: f64,
    /// For the polygon's own cubic, without the rounding of restricting or evaluating it.
    own: Levels,
    /// For points and polygons computed from it.
    computed: Levels,
    /// A few times farther apart: between these nothing is gained by looking closer.
    blurred: Levels,
}

/// How the Bernstein coefficients of a part lie to one level.
///
/// With at most one uncertain coefficient between the certain ones of either side, the number of
/// sign changes is known whatever its sign: none or one, and so is the number of crossings
/// (Descartes' rule in Bernstein form).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Course {
    Below,
    Above,
    /// Crosses once, from below.
    Rising,
    /// Crosses once, from above.
    Falling,
    Unclear,
}

impl Course {
    fn of(coefficients: &[f64; 7], error: f64, level: f64) -> Self {
        let (low, high) = (level - error, level + error);
        let first = coefficients[0];
        let mut course = if first < low {
            Self::Below
        } else if first > high {
            Self::Above
        } else {
            return Self::Unclear;
        };
        let mut is_doubtful = false;
        for &c in &coefficients[1..] {
            course = match course {
                Self::Below if c > high => Self::Rising,
                Self::Above if c < low => Self::Falling,
                Self::Below if c < low && !is_doubtful => continue,
                Self::Above if c > high && !is_doubtful => continue,
                Self::Rising if c > high => continue,
                Self::Falling if c < low => continue,
                // Neither: once, right before the course changes.
                Self::Below | Self::Above if !is_doubtful && low <= c && c <= high => {
                    is_doubtful = true;
                    continue;
                }
                _ => return Self::Unclear,
            };
            is_doubtful = false;
        }
        if is_doubtful { Self::Unclear } else { course }
    }
}

/// What the Bernstein coefficients of a part say.
enum Pattern {
    Uniform(Side),
    /// Leaves the inside, or reaches the outside, or both, each once.
    Rising {
        from_inside: bool,
        to_outside: bool,
    },
    /// Leaves the outside, or reaches the inside, or both, each once.
    Falling {
        from_outside: bool,
        to_inside: bool,
    },
    Mixed(Mixed),
}

/// What is known about a part that must be divided.
struct Mixed {
    start: Side,
    end: Side,
    /// The squared distance stays within `least..=greatest`.
    least: f64,
    greatest: f64,
}

/// What to do with a part of which only the outer end is certainly outside; fractions from the
/// inner end, beyond which all is outside.
enum Cut {
    None,
    /// Look closer at what is before.
    Examine(f64),
    /// What is before is undecided for good.
    Undecided(f64),
}

pub(super) fn stretches(given: &UncertainCubic, threshold: Threshold) -> Stretches {
    let cubic = Normal::new(&given.points, given.error);
    let low = cubic.bring_below(threshold.low);
    let high = cubic.bring_above(threshold.high);
    let question = Question {
        cubic,
        low,
        high,
        own: Levels::new(low, high, cubic.error),
        computed: Levels::new(low, high, cubic.part_error()),
        blurred: Levels::new(low, high, 4.0 * cubic.part_error()),
    };
    if let Pattern::Uniform(side) = question.pattern(&cubic.points, 0.0) {
        return Stretches::all(side);
    }
    let mut search = Search {
        question,
        found: Stretches::NONE,
        work: 0,
    };
    let s = least_point(&cubic.points);
    search.examine(0.0, s, 0);
    search.examine(s, 1.0, 0);
    search.found
}

impl Question {
    /// Reads the Bernstein coefficients of the squared distance over a part whose control points
    /// are wrong by at most `rounding`.
    #[inline]
    fn pattern(&self, points: &Polygon, rounding: f64) -> Pattern {
        let [h0, h1, h2, h3] = *points;
        let (s0, s1, s2, s3) = (h0.dot(h0), h1.dot(h1), h2.dot(h2), h3.dot(h3));
        let coefficients = [
            s0,
            h0.dot(h1),
            (2.0 * h0.dot(h2) + 3.0 * s1) * 0.2,
            (h0.dot(h3) + 9.0 * h1.dot(h2)) * 0.1,
            (2.0 * h1.dot(h3) + 3.0 * s2) * 0.2,
            h2.dot(h3),
            s3,
        ];
        let square = greater(greater(s0, s3), greater(s1, s2));
        // 8u M² for the coefficients (section "Squares"), 2 M e + e² for control points wrong by e.
        let size = (square + TINY).sqrt() * (1.0 + 4.0 * UNIT);
        let error = (8.0 * UNIT * square + rounding * (2.0 * size + rounding)) * SLACK + TINY;
        let (mut least, mut greatest) = (f64::INFINITY, f64::NEG_INFINITY);
        for c in coefficients {
            least = smaller(least, c);
            greatest = greater(greatest, c);
        }
        let (least, greatest) = (least - error, greatest + error);
        if least > self.own.outside {
            return Pattern::Uniform(Side::Outside);
        }
        if greatest < self.own.inside {
            return Pattern::Uniform(Side::Inside);
        }
        let inside = Course::of(&coefficients, error, self.own.inside);
        let outside = Course::of(&coefficients, error, self.own.outside);
        match (inside, outside) {
            (Course::Above, Course::Below) => Pattern::Uniform(Side::Undecided),
            (Course::Rising | Course::Above, Course::Rising) | (Course::Rising, Course::Below) => {
                Pattern::Rising {
                    from_inside: inside == Course::Rising,
                    to_outside: outside == Course::Rising,
                }
            }
            (Course::Falling | Course::Above, Course::Falling)
            | (Course::Falling, Course::Below) => Pattern::Falling {
                from_outside: outside == Course::Falling,
                to_inside: inside == Course::Falling,
            },
            _ => Pattern::Mixed(Mixed {
                start: self.own.side(s0 - error, s0 + error),
                end: self.own.side(s3 - error, s3 + error),
                least,
                greatest,
            }),
        }
    }

    /// Whether all that a part reaches is so near the threshold that dividing it is of no use.
    fn is_undecidable(&self, mixed: &Mixed) -> bool {
        self.blurred.side(mixed.least, mixed.least) != Side::Inside
            && self.blurred.side(mixed.greatest, mixed.greatest) != Side::Outside
    }

    /// Where to cut a part, counted from the end that is not outside.
    fn cut(&self, points: &Polygon, least: f64) -> Cut {
        /// Beyond these, halving is as good.
        const WORTHWHILE: f64 = 0.375;
        const SETTLED: f64 = 0.875;
        let reach = Minorant::of(points).reach(self.computed.outside);
        if reach < WORTHWHILE {
            // Twice as far, where outside is certain by a margin: then the next look settles it.
            return Cut::Examine(2.0 * reach);
        }
        // A touch: all of the part is next to the outer level or beyond, and so is the cut.
        let touching = greater(self.high - 4.0 * self.cubic.part_error(), 0.0);
        let is_next = |x: f64| point(points, x).length_squared() <= self.blurred.outside;
        if reach < SETTLED && least >= touching * touching && is_next(reach) {
            Cut::Undecided(reach)
        } else {
            Cut::None
        }
    }

    /// The certain ends of a crossing: last parameter inside and first one outside, each if asked
    /// for.
    ///
    /// `points` is counted from the inner end at `origin`; the outer end is at `target`.
    fn crossing(
        &self,
        points: &Polygon,
        (origin, target): (f64, f64),
        (is_inside, is_outside): (bool, bool),
    ) -> (f64, f64) {
        let at = |x: f64| origin + x * (target - origin);
        let resolution = 4.0 * UNIT * greater(origin, target) / (target - origin).abs();
        let square_at = |s: f64| point(&self.cubic.points, s).length_squared();
        let error = self.cubic.part_error();

        let (mut last_inside, mut first_outside) = (origin, target);
        let mut guess = None;
        if is_inside {
            let (x, rate) = meeting_point(points, self.low - error, None);
            let step = resolution + 12.0 * UNIT * self.low / rate;
            let is_certain =
                |s: f64| square_at(s) * (1.0 + 4.0 * UNIT) + TINY < self.computed.inside;
            last_inside =
                nearest_certain(step, x, |step| at(x - step), is_certain).unwrap_or(origin);
            guess = Some(x + (self.high - self.low + 2.0 * error) / rate);
        }
        if is_outside {
            let (x, rate) = meeting_point(points, self.high + error, guess);
            let step = resolution + 12.0 * UNIT * self.high / rate;
            let is_certain =
                |s: f64| square_at(s) * (1.0 - 4.0 * UNIT) - TINY > self.computed.outside;
            first_outside =
                nearest_certain(step, 1.0 - x, |step| at(x + step), is_certain).unwrap_or(target);
        }
        (last_inside, first_outside)
    }
}

/// Where the distance seems to be `radius`, from 0 at the inner end to 1 at the outer end, and its
/// rate there: bracketed Newton, not trusted by what follows.
fn meeting_point(points: &Polygon, radius: f64, guess: Option<f64>) -> (f64, f64) {
    const STEPS: u32 = 40;
    const SHORT: f64 = 1e-10;
    let k0 = points[0];
    let (d1, d2, d3) = (points[1] - k0, points[2] - k0, points[3] - k0);
    let (linear, square, cube) = (d1 * 3.0, (d2 - d1 * 2.0) * 3.0, d3 - (d2 - d1) * 3.0);
    let motion = |x: f64| {
        (
            k0 + (linear + (square + cube * x) * x) * x,
            linear + (square * 2.0 + cube * (3.0 * x)) * x,
        )
    };
    let level = radius * radius;
    let (start, end) = (k0.length_squared(), points[3].length_squared());
    let (mut low, mut high) = (0.0, 1.0);
    // Next to a minimum the squared distance grows with the square of the time.
    let first = guess.unwrap_or_else(|| ((level - start) / (end - start)).sqrt());
    let mut x = if 0.0 < first && first < 1.0 {
        first
    } else {
        0.5
    };
    let mut rate = 0.0;
    for _ in 0..STEPS {
        let (position, velocity) = motion(x);
        let square = position.length_squared();
        let slope = position.dot(velocity);
        rate = slope.abs() / (square.sqrt() + TINY);
        let excess = square - level;
        if excess < 0.0 {
            low = x;
        } else {
            high = x;
        }
        let newton = x - 0.5 * excess / slope;
        let next = if low <= newton && newton <= high {
            newton
        } else {
            0.5 * (low + high)
        };
        let step = (next - x).abs();
        x = next;
        // What is left is of the order of this step's square.
        if step <= SHORT * x {
            break;
        }
    }
    (x, rate)
}

/// A short step below `room` that leads to where the test holds; `step` is the length expected.
///
/// Doubled until it is long enough. Where the expectation is coarse (next to a turning point, where
/// there is hardly any closing speed) it is not trusted to be needed.
fn nearest_certain(
    mut step: f64,
    room: f64,
    at: impl Fn(f64) -> f64,
    is_certain: impl Fn(f64) -> bool,
) -> Option<f64> {
    const COARSE: f64 = 1e-10;
    // Also where it is infinite or NaN.
    step = if step < COARSE { step } else { COARSE };
    while step < room {
        let s = at(step);
        if is_certain(s) {
            return Some(s);
        }
        step *= 2.0;
    }
    None
}

struct Search {
    question: Question,
    found: Stretches,
    work: u32,
}

impl Search {
    /// Appends what can be said about `start..end`, from left to right.
    fn examine(&mut self, start: f64, end: f64, turn: u32) {
        self.work += 1;
        if self.work > LARGEST_WORK {
            self.found.effort = Effort::Limited;
        }
        if self.work > LARGEST_WORK {
            self.found.append(end, Side::Undecided);
            return;
        }
        let cubic = &self.question.cubic;
        let points = part(&cubic.points, start, end);
        match self.question.pattern(&points, 9.0 * UNIT * cubic.size) {
            Pattern::Uniform(side) => self.found.append(end, side),
            Pattern::Rising {
                from_inside,
                to_outside,
            } => {
                let wanted = (from_inside, to_outside);
                let (inside, outside) = self.question.crossing(&points, (start, end), wanted);
                self.found.append(inside, Side::Inside);
                self.found.append(outside, Side::Undecided);
                self.found.append(end, Side::Outside);
            }
            Pattern::Falling {
                from_outside,
                to_inside,
            } => {
                let wanted = (to_inside, from_outside);
                let points = reversed(points);
                let (inside, outside) = self.question.crossing(&points, (end, start), wanted);
                self.found.append(outside, Side::Outside);
                self.found.append(inside, Side::Undecided);
                self.found.append(end, Side::Inside);
            }
            Pattern::Mixed(mixed) => {
                if end - start < SHORTEST || self.question.is_undecidable(&mixed) {
                    self.found.append(end, Side::Undecided);
                } else {
                    self.divide(start, end, &points, &mixed, turn);
                }
            }
        }
    }

    /// Cuts off what the quadratic below the squared distance shows to be outside, or divides.
    fn divide(&mut self, start: f64, end: f64, points: &Polygon, mixed: &Mixed, turn: u32) {
        let width = end - start;
        let question = &self.question;
        match (mixed.start == Side::Outside, mixed.end == Side::Outside) {
            (false, true) => match question.cut(points, mixed.least) {
                Cut::None => {}
                Cut::Examine(x) => {
                    let cut = smaller(start + x * width + 4.0 * UNIT * end, end);
                    self.examine(start, cut, turn + 1);
                    self.found.append(end, Side::Outside);
                    return;
                }
                Cut::Undecided(x) => {
                    let cut = smaller(start + x * width + 4.0 * UNIT * end, end);
                    self.found.append(cut, Side::Undecided);
                    self.found.append(end, Side::Outside);
                    return;
                }
            },
            (true, false) => match question.cut(&reversed(*points), mixed.least) {
                Cut::None => {}
                Cut::Examine(x) => {
                    let cut = greater(end - x * width - 4.0 * UNIT * end, start);
                    self.found.append(cut, Side::Outside);
                    self.examine(cut, end, turn + 1);
                    return;
                }
                Cut::Undecided(x) => {
                    let cut = greater(end - x * width - 4.0 * UNIT * end, start);
                    self.found.append(cut, Side::Outside);
                    self.found.append(end, Side::Undecided);
                    return;
                }
            },
            (true, true) => {
                let is_falling = points[3].length_squared() < points[0].length_squared();
                let nearer = if is_falling {
                    reversed(*points)
                } else {
                    *points
                };
                if Minorant::of(&nearer).lower() > question.computed.outside {
                    self.found.append(end, Side::Outside);
                    return;
                }
            }
            (false, false) => {}
        }
        let s = start + dividing_fraction(points, turn) * width;
        self.examine(start, s, turn + 1);
        self.examine(s, end, turn + 1);
    }
}

/// In turns the middle and where the distance seems least, unless that is next to an end.
fn dividing_fraction(points: &Polygon, turn: u32) -> f64 {
    const NEAR_END: f64 = 1.0 / 64.0;
    if turn % 2 == 1 {
        let x = least_point(points);
        if NEAR_END < x && x < 1.0 - NEAR_END {
            return x;
        }
    }
    0.5
}
