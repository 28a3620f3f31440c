//! Bodies as exact cubics over exact intervals, and the spans of a pair.

use super::dyadic::Dyadic;

/// Time (s), position (m), velocity (m/s), as given.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct State {
    pub(crate) t: f64,
    pub(crate) p: [f64; 3],
    pub(crate) v: [f64; 3],
}

/// `sum of coefficients[i] (t - origin)^i` over `start..end`; origin 0 = absolute time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PolynomialSegment {
    pub(crate) start: f64,
    pub(crate) end: f64,
    pub(crate) origin: f64,
    pub(crate) coefficients: [[f64; 3]; 4],
}

/// What a body does before its first and after its last knot.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Outside {
    Absent,
    Extrapolate,
    Coast,
}

type Vector = [Dyadic; 3];

/// `sum of coefficients[i] ((t - origin) / length)^i`, with `length > 0`.
#[derive(Clone, Debug)]
pub(crate) struct Cubic {
    pub(crate) origin: Dyadic,
    pub(crate) length: Dyadic,
    pub(crate) coefficients: [Vector; 4],
}

/// A motion: `cubics[k]` holds over `knots[k]..=knots[k + 1]`.
#[derive(Clone, Debug)]
pub(crate) struct Body {
    knots: Vec<Dyadic>,
    cubics: Vec<Cubic>,
}

/// An interval in which both bodies stay on one cubic each; `start == end` only where the common
/// domain (or the window) is one instant.
#[derive(Clone, Debug)]
pub(crate) struct Span<'b> {
    pub(crate) start: Dyadic,
    pub(crate) end: Dyadic,
    pub(crate) a: &'b Cubic,
    pub(crate) b: &'b Cubic,
}

fn vector(v: [f64; 3]) -> Vector {
    v.map(Dyadic::from)
}

fn combine(terms: &[(i32, &Vector)]) -> Vector {
    std::array::from_fn(|axis| {
        terms.iter().fold(Dyadic::ZERO, |sum, (factor, term)| {
            &sum + &term[axis].times(*factor)
        })
    })
}

fn scaled(v: &Vector, factor: &Dyadic) -> Vector {
    std::array::from_fn(|axis| &v[axis] * factor)
}

impl Cubic {
    /// Hermite: p0 + s h v0 + s² (3 (p1 - p0) - h (2 v0 + v1)) + s³ (2 (p0 - p1) + h (v0 + v1)).
    fn hermite(first: &State, second: &State) -> Self {
        let origin = Dyadic::from(first.t);
        let length = &Dyadic::from(second.t) - &origin;
        assert!(length.signum() > 0, "times increase");
        let (p0, p1) = (vector(first.p), vector(second.p));
        let (w0, w1) = (
            scaled(&vector(first.v), &length),
            scaled(&vector(second.v), &length),
        );
        let square = combine(&[(3, &p1), (-3, &p0), (-2, &w0), (-1, &w1)]);
        let cube = combine(&[(2, &p0), (-2, &p1), (1, &w0), (1, &w1)]);
        Self {
            origin,
            length,
            coefficients: [p0, w0, square, cube],
        }
    }

    /// The motion with constant velocity that meets this one at `instant`.
    fn tangent(&self, instant: &Dyadic) -> Self {
        let x = instant - &self.origin;
        let s = if x == self.length {
            Dyadic::from(1)
        } else {
            assert!(
                x.is_zero() || self.length == Dyadic::from(1),
                "tangents are taken at a segment's ends, where x / length is exact"
            );
            x
        };
        let [c0, c1, c2, c3] = &self.coefficients;
        let (s2, s3) = (s.squared(), s.cubed());
        let position = combine(&[
            (1, c0),
            (1, &scaled(c1, &s)),
            (1, &scaled(c2, &s2)),
            (1, &scaled(c3, &s3)),
        ]);
        let step = combine(&[(1, c1), (2, &scaled(c2, &s)), (3, &scaled(c3, &s2))]);
        let zero = vector([0.0; 3]);
        Self {
            origin: instant.clone(),
            length: self.length.clone(),
            coefficients: [position, step, zero.clone(), zero],
        }
    }

    /// `length³ * position(start + width u)` as coefficients of u, and the factor `length³`;
    /// without the factor where the part is the whole cubic.
    pub(crate) fn restricted(&self, start: &Dyadic, width: &Dyadic) -> ([Vector; 4], Dyadic) {
        let shift = start - &self.origin;
        if shift.is_zero() && *width == self.length {
            return (self.coefficients.clone(), Dyadic::from(1));
        }
        // Horner's rule in (shift + width u), with one more factor `length` at each level.
        let mut result = vec![self.coefficients[3].clone()];
        let mut power = self.length.clone();
        for coefficient in self.coefficients[..3].iter().rev() {
            let mut next = vec![vector([0.0; 3]); result.len() + 1];
            for (i, c) in result.iter().enumerate() {
                next[i] = combine(&[(1, &next[i]), (1, &scaled(c, &shift))]);
                next[i + 1] = scaled(c, width);
            }
            next[0] = combine(&[(1, &next[0]), (1, &scaled(coefficient, &power))]);
            power = &power * &self.length;
            result = next;
        }
        (result.try_into().unwrap(), self.length.cubed())
    }
}

impl Body {
    pub(crate) fn from_states(states: &[State]) -> Self {
        Self {
            knots: states.iter().map(|state| Dyadic::from(state.t)).collect(),
            cubics: states
                .windows(2)
                .map(|pair| Cubic::hermite(&pair[0], &pair[1]))
                .collect(),
        }
    }

    /// Segments in the order of time, without gaps.
    pub(crate) fn from_polynomials(segments: &[PolynomialSegment]) -> Self {
        let first = segments.first().unwrap();
        let ends = segments.iter().map(|segment| segment.end);
        Self {
            knots: std::iter::once(first.start)
                .chain(ends)
                .map(Dyadic::from)
                .collect(),
            cubics: segments
                .iter()
                .map(|segment| Cubic {
                    origin: Dyadic::from(segment.origin),
                    length: Dyadic::from(1),
                    coefficients: segment.coefficients.map(vector),
                })
                .collect(),
        }
    }

    /// One cubic over [0, 1] with the Bezier control points given.
    pub(crate) fn from_control_points(points: [[f64; 3]; 4]) -> Self {
        let [p0, p1, p2, p3] = points.map(vector);
        let linear = combine(&[(3, &p1), (-3, &p0)]);
        let square = combine(&[(3, &p0), (-6, &p1), (3, &p2)]);
        let cube = combine(&[(-1, &p0), (3, &p1), (-3, &p2), (1, &p3)]);
        Self {
            knots: vec![Dyadic::ZERO, Dyadic::from(1)],
            cubics: vec![Cubic {
                origin: Dyadic::ZERO,
                length: Dyadic::from(1),
                coefficients: [p0, linear, square, cube],
            }],
        }
    }

    pub(crate) fn at_rest(position: [f64; 3], start: f64, end: f64) -> Self {
        Self::from_polynomials(&[PolynomialSegment {
            start,
            end,
            origin: 0.0,
            coefficients: [position, [0.0; 3], [0.0; 3], [0.0; 3]],
        }])
    }

    /// This motion until an instant, and a polynomial from then on.
    pub(crate) fn followed_by(mut self, from: f64, next: &PolynomialSegment) -> Self {
        let [from, end] = [from, next.end].map(Dyadic::from);
        let kept = self.knots.partition_point(|knot| *knot < from);
        self.knots.truncate(kept);
        self.cubics.truncate(kept);
        self.knots.extend([from, end]);
        self.cubics.extend(Self::from_polynomials(&[*next]).cubics);
        self
    }

    /// The same motion of a point fixed in the body's frame, which does not turn.
    pub(crate) fn offset(mut self, offset: [f64; 3]) -> Self {
        let offset = vector(offset);
        for cubic in &mut self.cubics {
            cubic.coefficients[0] = combine(&[(1, &cubic.coefficients[0]), (1, &offset)]);
        }
        self
    }

    /// The motion over its knots and, unless absent there, over all of `from..=to`.
    pub(crate) fn extended(mut self, outside: Outside, from: f64, to: f64) -> Self {
        let (from, to) = (Dyadic::from(from), Dyadic::from(to));
        let carry = |cubic: &Cubic, knot: &Dyadic| match outside {
            Outside::Coast => cubic.tangent(knot),
            Outside::Absent | Outside::Extrapolate => cubic.clone(),
        };
        if outside == Outside::Absent {
            return self;
        }
        if from < self.knots[0] {
            self.cubics
                .insert(0, carry(&self.cubics[0], &self.knots[0]));
            self.knots.insert(0, from);
        }
        let last = self.knots.last().unwrap().clone();
        if to > last {
            self.cubics.push(carry(self.cubics.last().unwrap(), &last));
            self.knots.push(to);
        }
        self
    }
}

/// The spans of the part of the common domain that lies in `window`, in the order of time.
pub(crate) fn spans<'b>(a: &'b Body, b: &'b Body, window: Option<(f64, f64)>) -> Vec<Span<'b>> {
    let mut start = a.knots[0].clone().max(b.knots[0].clone());
    let last = |body: &Body| body.knots.last().unwrap().clone();
    let mut end = last(a).min(last(b));
    if let Some((from, to)) = window {
        start = start.max(Dyadic::from(from));
        end = end.min(Dyadic::from(to));
    }
    if start > end {
        return Vec::new();
    }
    // The cubic that holds right after an instant, at the last knot the one before it.
    let holds = |body: &'b Body, instant: &Dyadic| {
        let after = body.knots.partition_point(|knot| knot <= instant);
        &body.cubics[after.clamp(1, body.cubics.len()) - 1]
    };
    if start == end {
        let (a, b) = (holds(a, &start), holds(b, &start));
        return vec![Span { start, end, a, b }];
    }
    let mut cuts: Vec<Dyadic> = a
        .knots
        .iter()
        .chain(&b.knots)
        .filter(|knot| start < **knot && **knot < end)
        .cloned()
        .collect();
    cuts.push(start);
    cuts.push(end);
    cuts.sort();
    cuts.dedup();
    cuts.windows(2)
        .map(|ends| Span {
            start: ends[0].clone(),
            end: ends[1].clone(),
            a: holds(a, &ends[0]),
            b: holds(b, &ends[0]),
        })
        .collect()
}
