//! All maximal closed intervals with distance <= D.

use super::distance::SquaredDistance;
use super::dyadic::Dyadic;
use super::minimum::{Candidate, Enclosure, Minimum, Place, Stretch, least};
use super::roots::{Root, separate, sign_pattern};
use dashu::rational::RBig;
use std::cmp::Ordering;

/// A maximal closed interval with distance <= D.
#[derive(Clone, Debug)]
pub(crate) struct Contact {
    /// First and last instant, s.
    pub(crate) enter: Enclosure,
    pub(crate) exit: Enclosure,
    /// Bit 1: the common domain or window begins inside or exactly at D; bit 2: it ends so.
    pub(crate) clip: u8,
    /// The least squared distance within.
    pub(crate) minimum: Minimum,
}

/// One end of a stretch within a span: an end of the span, or a root of `distance² - D²`.
#[derive(Clone, Debug)]
enum End {
    Start,
    Root(Root),
    Finish,
}

/// A maximal stretch with `distance <= D` within one span.
#[derive(Clone, Debug)]
struct Part<'d> {
    distance: &'d SquaredDistance,
    from: End,
    to: End,
    kind: Kind,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    /// A single instant at D exactly.
    Touch,
    /// At D exactly all over the span.
    Resting,
    /// Nearer than D somewhere.
    Inside,
}

/// The contacts over spans in the order of time, with D >= 0 (none for D < 0).
///
/// Enclosures of the ends are at most `2^-bits` of their span wide.
pub(crate) fn contacts(distances: &[SquaredDistance], d: &RBig, bits: usize) -> Vec<Contact> {
    if *d < RBig::ZERO {
        return Vec::new();
    }
    let level = d * d;
    let mut chains: Vec<Vec<Part<'_>>> = Vec::new();
    let mut is_open = false;
    for distance in distances {
        let parts = parts(distance, &level);
        let reaches_end = parts
            .last()
            .is_some_and(|part| matches!(part.to, End::Finish));
        for part in parts {
            match chains.last_mut() {
                Some(chain) if is_open && matches!(part.from, End::Start) => chain.push(part),
                _ => chains.push(vec![part]),
            }
            is_open = false;
        }
        is_open = reaches_end;
    }
    let (Some(first), Some(last)) = (distances.first(), distances.last()) else {
        return Vec::new();
    };
    let (begin, end) = (first.start.to_rational(), last.end.to_rational());
    chains
        .iter()
        .map(|chain| {
            let enter = instant(&chain[0], &chain[0].from, bits);
            let last = chain.last().unwrap();
            let exit = instant(last, &last.to, bits);
            let begins = u8::from(enter == Enclosure::exact(begin.clone()));
            let ends = u8::from(exit == Enclosure::exact(end.clone()));
            Contact {
                clip: begins + 2 * ends,
                minimum: minimum_within(chain, &level, &enter, &exit, bits),
                enter,
                exit,
            }
        })
        .collect()
}

fn instant(part: &Part<'_>, end: &End, bits: usize) -> Enclosure {
    match end {
        End::Start => Enclosure::exact(part.distance.start.to_rational()),
        End::Finish => Enclosure::exact(part.distance.end.to_rational()),
        End::Root(root) => {
            let mut root = root.clone();
            root.refine_to(bits);
            Enclosure::of_root(part.distance, &root)
        }
    }
}

/// The stretches of one span, in the order of time.
fn parts<'d>(distance: &'d SquaredDistance, level: &RBig) -> Vec<Part<'d>> {
    let excess = distance.minus(level);
    let part = |from: End, to: End, kind: Kind| Part {
        distance,
        from,
        to,
        kind,
    };
    if excess.is_zero() {
        return vec![part(End::Start, End::Finish, Kind::Resting)];
    }
    let (roots, signs) = sign_pattern(&excess);
    let mut parts = Vec::new();
    let mut open = (signs[0] < 0).then_some(End::Start);
    for (root, beside) in roots.iter().zip(signs.windows(2)) {
        let end = named(root);
        match (open.take(), beside[1] < 0) {
            // Inside on both sides: the root is a touch from within.
            (Some(from), true) => open = Some(from),
            (Some(from), false) => parts.push(part(from, end, Kind::Inside)),
            (None, true) => open = Some(end),
            (None, false) => parts.push(part(end.clone(), end, Kind::Touch)),
        }
    }
    if let Some(from) = open {
        parts.push(part(from, End::Finish, Kind::Inside));
    }
    parts
}

/// A root on an end of the span is that end.
fn named(root: &Root) -> End {
    if root.is_exact() && root.low().is_zero() {
        End::Start
    } else if root.is_exact() && root.low() == Dyadic::from(1) {
        End::Finish
    } else {
        End::Root(root.clone())
    }
}

fn minimum_within(
    chain: &[Part<'_>],
    level: &RBig,
    enter: &Enclosure,
    exit: &Enclosure,
    bits: usize,
) -> Minimum {
    if chain.iter().all(|part| part.kind != Kind::Inside) {
        return Minimum {
            squared: Enclosure::exact(level.clone()),
            instants: vec![Stretch {
                first: enter.clone(),
                last: exit.clone(),
            }],
        };
    }
    let candidates = chain
        .iter()
        .filter(|part| part.kind == Kind::Inside)
        .flat_map(|part| part.candidates(level))
        .collect();
    least(candidates, bits).unwrap()
}

impl<'d> Part<'d> {
    /// The places within where the minimum can be, all nearer than D, in the order of time.
    fn candidates(&self, level: &RBig) -> Vec<Candidate<'d>> {
        let distance = self.distance;
        if distance.polynomial.degree() == 0 {
            return vec![Candidate {
                distance,
                place: Place::Everywhere,
            }];
        }
        let mut candidates = Vec::new();
        if matches!(self.from, End::Start) && distance.at(&Dyadic::ZERO) < *level {
            candidates.push(Candidate::at(distance, 0));
        }
        let excess = distance.minus(level);
        let common = excess.gcd(&distance.polynomial.derivative());
        candidates.extend(
            Candidate::critical(distance)
                .into_iter()
                .filter(|candidate| {
                    let Place::Critical(root) = &candidate.place else {
                        return false;
                    };
                    // At D exactly is not nearer than D; what is nearer is inside this part or another.
                    !root.is_root_of(&common) && self.contains(root)
                }),
        );
        if matches!(self.to, End::Finish) && distance.at(&Dyadic::from(1)) < *level {
            candidates.push(Candidate::at(distance, 1));
        }
        candidates
    }

    /// Whether a point of the open span, not a root of `distance² - D²`, lies within.
    fn contains(&self, point: &Root) -> bool {
        let is_after_start = match &self.from {
            End::Root(root) => separate(&mut root.clone(), &mut point.clone()) == Ordering::Less,
            _ => true,
        };
        let is_before_end = match &self.to {
            End::Root(root) => separate(&mut point.clone(), &mut root.clone()) == Ordering::Less,
            _ => true,
        };
        is_after_start && is_before_end
    }
}
