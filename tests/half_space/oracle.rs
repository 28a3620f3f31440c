//! Exact heights of spheres above a half-space, in rational numbers.

use dashu::base::SquareRoot;
use dashu::integer::{IBig, UBig};
use dashu::rational::RBig;
use nearmiss::glam::DVec3;
use nearmiss::{Body, Segment, Trajectory};

/// Binary digits of roots and crossings.
const DIGITS: usize = 160;

pub(crate) fn exact(number: f64) -> RBig {
    RBig::try_from(number).unwrap()
}

fn rounded(number: &RBig) -> f64 {
    number.to_f64().value()
}

/// The root of a number that is not negative, good to 2^-[`DIGITS`].
fn root(number: &RBig) -> RBig {
    let shifted = (number * RBig::from(IBig::ONE << (2 * DIGITS))).round();
    let whole = UBig::try_from(shifted).unwrap();
    RBig::from_parts(IBig::from(whole.sqrt()), UBig::ONE << DIGITS)
}

/// A maximal time in which a body is within the margin, and its least separation, all good to
/// far more than f64.
#[derive(Clone, Debug)]
pub(crate) struct Truth {
    pub(crate) enter: RBig,
    pub(crate) exit: RBig,
    pub(crate) separation: RBig,
    /// The least separation is so close to the margin that an interval may be a touch.
    pub(crate) is_touch: bool,
}

/// A cubic over a span: value of the separation, times one.
struct Cubic {
    start: RBig,
    end: RBig,
    /// Powers of the share of the span.
    powers: [RBig; 4],
}

impl Cubic {
    fn at(&self, share: &RBig) -> RBig {
        let [c0, c1, c2, c3] = &self.powers;
        c0 + share * (c1 + share * (c2 + share * c3))
    }

    fn time(&self, share: &RBig) -> RBig {
        &self.start + share * (&self.end - &self.start)
    }

    /// The shares at which the value turns, and both ends.
    fn nodes(&self) -> Vec<RBig> {
        let [_, c1, c2, c3] = &self.powers;
        let (zero, one) = (RBig::ZERO, RBig::ONE);
        let mut nodes = vec![zero.clone()];
        // 3 c3 s² + 2 c2 s + c1
        let (a, half_b) = (RBig::from(3) * c3, c2.clone());
        let mut roots = Vec::new();
        if a == zero {
            if half_b != zero {
                roots.push(-c1 / (RBig::from(2) * half_b));
            }
        } else {
            let under = &half_b * &half_b - &a * c1;
            if under > zero {
                let root = root(&under);
                roots.push((-&half_b - &root) / &a);
                roots.push((-&half_b + &root) / &a);
            }
        }
        roots.sort();
        nodes.extend(roots.into_iter().filter(|at| *at > zero && *at < one));
        nodes.push(one);
        nodes
    }
}

/// Coordinates along a vector of the control points between two states: exact.
fn points(plan: &Trajectory, segment: &Segment, normal: DVec3) -> [RBig; 4] {
    let along = |vector: DVec3| {
        let products = [0, 1, 2].map(|axis| exact(vector[axis]) * exact(normal[axis]));
        products.into_iter().fold(RBig::ZERO, |sum, one| sum + one)
    };
    let third = (exact(segment.end()) - exact(segment.start())) / RBig::from(3);
    let [(p, v), (q, w)] = [segment.start(), segment.end()].map(|knot| {
        let (place, velocity) = (plan.position(knot), plan.velocity(knot));
        (along(place.unwrap()), along(velocity.unwrap()))
    });
    [p.clone(), p + v * &third, &q - w * &third, q]
}

/// The cubic between two instants in powers of the share, from control points over a segment.
fn between(points: &[RBig; 4], segment: &Segment, start: &RBig, end: &RBig) -> [RBig; 4] {
    let [p0, p1, p2, p3] = points;
    let three = RBig::from(3);
    let powers = [
        p0.clone(),
        &three * (p1 - p0),
        &three * (p2 - p1 - p1 + p0),
        p3 - &three * p2 + &three * p1 - p0,
    ];
    let (from, to) = (exact(segment.start()), exact(segment.end()));
    let share = |time: &RBig| (time - &from) / (&to - &from);
    let (base, step) = (share(start), share(end) - share(start));
    // Taylor expansion around the base.
    let [c0, c1, c2, c3] = &powers;
    let (b, two) = (&base, RBig::from(2));
    let d0 = c0 + b * (c1 + b * (c2 + b * c3));
    let d1 = c1 + b * (&two * c2 + b * (&three * c3));
    let d2 = c2 + b * &three * c3;
    [
        d0,
        d1 * &step,
        d2 * &step * &step,
        c3 * &step * &step * &step,
    ]
}

/// All maximal times in which some sphere of `body`, which does not turn, is within `margin` of
/// the half-space of `plane`, both inside their knots.
pub(crate) fn truths(body: &Body, plane: &Body, normal: DVec3, margin: f64) -> Vec<Truth> {
    let squares = normal.to_array().map(|x| exact(x) * exact(x));
    let length = root(&squares.into_iter().fold(RBig::ZERO, |sum, one| sum + one));
    let lowest = body.hitbox.spheres().iter().map(|sphere| {
        let offset = [0, 1, 2].map(|axis| exact(sphere.offset[axis]) * exact(normal[axis]));
        let along = offset.into_iter().fold(RBig::ZERO, |sum, one| sum + one);
        along / &length - exact(sphere.radius)
    });
    let lowest = lowest.min().unwrap();
    let margin = exact(margin);
    // A touch that is no nearer than this is one of f64 as well.
    let close = RBig::from_parts(IBig::ONE, UBig::ONE << 40_usize);
    let mut found: Vec<Truth> = Vec::new();
    for one in body.trajectory.segments() {
        for other in plane.trajectory.segments() {
            let start = one.start().max(other.start());
            let end = one.end().min(other.end());
            if start >= end {
                continue;
            }
            let (start, end) = (exact(start), exact(end));
            let high = between(&points(&body.trajectory, one, normal), one, &start, &end);
            let low = between(
                &points(&plane.trajectory, other, normal),
                other,
                &start,
                &end,
            );
            let mut powers = [0, 1, 2, 3].map(|k| (&high[k] - &low[k]) / &length);
            powers[0] += &lowest;
            let cubic = Cubic { start, end, powers };
            within(&cubic, &margin, &mut found);
        }
    }
    found.sort_by(|x, y| x.enter.cmp(&y.enter));
    let mut joined: Vec<Truth> = Vec::new();
    for next in found {
        match joined.last_mut() {
            Some(last) if next.enter <= last.exit => {
                last.exit = last.exit.clone().max(next.exit);
                last.separation = last.separation.clone().min(next.separation);
            }
            _ => joined.push(next),
        }
    }
    for truth in &mut joined {
        truth.is_touch = &margin - &truth.separation <= close;
    }
    joined
}

/// Adds the times of a span in which a cubic is at most `margin`.
fn within(cubic: &Cubic, margin: &RBig, found: &mut Vec<Truth>) {
    let nodes = cubic.nodes();
    for ends in nodes.windows(2) {
        let values = [cubic.at(&ends[0]), cubic.at(&ends[1])];
        let inside = values.each_ref().map(|value| value <= margin);
        if inside == [false; 2] {
            continue;
        }
        let mut bounds = [ends[0].clone(), ends[1].clone()];
        if inside[0] != inside[1] {
            // The value is monotonic between nodes.
            let (mut within, mut beyond) = if inside[0] {
                (ends[0].clone(), ends[1].clone())
            } else {
                (ends[1].clone(), ends[0].clone())
            };
            for _ in 0..110 {
                let middle = (&within + &beyond) / RBig::from(2);
                if cubic.at(&middle) <= *margin {
                    within = middle;
                } else {
                    beyond = middle;
                }
            }
            bounds[usize::from(inside[0])] = within;
        }
        found.push(Truth {
            enter: cubic.time(&bounds[0]),
            exit: cubic.time(&bounds[1]),
            separation: values[0].clone().min(values[1].clone()),
            is_touch: false,
        });
    }
}

/// How far a number is from an exact one.
pub(crate) fn off(number: f64, truth: &RBig) -> f64 {
    rounded(&(exact(number) - truth)).abs()
}
