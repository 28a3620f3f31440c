//! The global minimum of the squared distance, with all instants at which it is reached.

use super::algebraic::compare;
use super::distance::SquaredDistance;
use super::dyadic::Dyadic;
use super::roots::{Root, isolate};
use dashu::integer::IBig;
use dashu::rational::RBig;
use std::cmp::Ordering;

/// A closed interval that contains the exact number; a single point where that is dyadic or zero.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Enclosure {
    pub(crate) low: RBig,
    pub(crate) high: RBig,
}

/// A maximal stretch of minimisers: first and last instant (the same, save on a plateau), s.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Stretch {
    pub(crate) first: Enclosure,
    pub(crate) last: Enclosure,
}

/// The least squared distance (m²) and where it is reached, in the order of time.
#[derive(Clone, Debug)]
pub(crate) struct Minimum {
    pub(crate) squared: Enclosure,
    pub(crate) instants: Vec<Stretch>,
}

/// Where a minimum can be: a point known exactly, a whole span of constant distance, or a root of
/// the derivative.
#[derive(Clone, Debug)]
pub(crate) enum Place {
    At(Dyadic),
    Everywhere,
    Critical(Root),
}

#[derive(Clone, Debug)]
pub(crate) struct Candidate<'d> {
    pub(crate) distance: &'d SquaredDistance,
    pub(crate) place: Place,
}

impl Enclosure {
    pub(crate) fn exact(value: RBig) -> Self {
        Self {
            low: value.clone(),
            high: value,
        }
    }

    pub(crate) fn is_exact(&self) -> bool {
        self.low == self.high
    }

    pub(crate) fn contains(&self, value: &RBig) -> bool {
        self.low <= *value && *value <= self.high
    }

    pub(crate) fn width(&self) -> RBig {
        &self.high - &self.low
    }

    pub(crate) fn overlaps(&self, other: &Self) -> bool {
        self.low <= other.high && other.low <= self.high
    }

    /// The instant of a root over a span.
    pub(crate) fn of_root(distance: &SquaredDistance, root: &Root) -> Self {
        Self {
            low: distance.time(&root.low()).to_rational(),
            high: distance.time(&root.high()).to_rational(),
        }
    }
}

impl<'d> Candidate<'d> {
    pub(crate) fn at(distance: &'d SquaredDistance, u: i32) -> Self {
        Self {
            distance,
            place: Place::At(Dyadic::from(u)),
        }
    }

    /// The ends of a span and the stationary points between them, in the order of time.
    pub(crate) fn all(distance: &'d SquaredDistance) -> Vec<Self> {
        if distance.polynomial.degree() == 0 {
            return vec![Self {
                distance,
                place: Place::Everywhere,
            }];
        }
        let mut candidates = vec![Self::at(distance, 0)];
        candidates.extend(Self::critical(distance));
        candidates.push(Self::at(distance, 1));
        candidates
    }

    /// The stationary points in the open span.
    pub(crate) fn critical(distance: &'d SquaredDistance) -> Vec<Self> {
        isolate(&distance.polynomial.derivative())
            .into_iter()
            .filter(|root| !root.is_exact() || (root.low().signum() > 0 && root.level() > 0))
            .map(|root| Self {
                distance,
                place: Place::Critical(root),
            })
            .collect()
    }

    fn is_exact(&self) -> bool {
        match &self.place {
            Place::At(_) | Place::Everywhere => true,
            Place::Critical(root) => root.is_exact(),
        }
    }

    /// The squared distance here; the width falls with the square of the root's.
    pub(crate) fn squared(&self) -> Enclosure {
        let root = match &self.place {
            Place::At(u) => return Enclosure::exact(self.distance.at(u)),
            Place::Everywhere => return Enclosure::exact(self.distance.at(&Dyadic::ZERO)),
            Place::Critical(root) => root,
        };
        if root.is_exact() {
            return Enclosure::exact(self.distance.at(&root.low()));
        }
        // The derivative vanishes at the root, so by Taylor the value in the middle of the
        // enclosure, 2^-(level + 1) from the root at most, is wrong by max|d''| 2^-(2 level + 3).
        let middle = (&root.low() + &root.high()).times_power_of_two(-1);
        let second = self.distance.polynomial.derivative().derivative();
        let largest = second.coefficients().iter().fold(IBig::ZERO, |sum, c| {
            sum + IBig::from(dashu::base::UnsignedAbs::unsigned_abs(c))
        });
        let digits = isize::try_from(2 * root.level() + 3).unwrap();
        let error = Dyadic::new(largest, -digits).to_rational() * self.distance.unit();
        let value = self.distance.at(&middle);
        Enclosure {
            low: (&value - &error).max(RBig::ZERO),
            high: value + error,
        }
    }

    /// Whether the squared distance vanishes here exactly: a common root with the derivative.
    fn is_zero(&self) -> bool {
        let polynomial = &self.distance.polynomial;
        match &self.place {
            Place::Critical(root) if !root.is_exact() => {
                root.is_root_of(&polynomial.gcd(&polynomial.derivative()))
            }
            _ => self.squared().low.is_zero(),
        }
    }

    pub(crate) fn refine_to(&mut self, level: usize) {
        if let Place::Critical(root) = &mut self.place {
            root.refine_to(level);
        }
    }

    fn instants(&self) -> Stretch {
        let distance = self.distance;
        match &self.place {
            Place::At(u) => {
                let instant = Enclosure::exact(distance.time(u).to_rational());
                Stretch {
                    first: instant.clone(),
                    last: instant,
                }
            }
            Place::Everywhere => Stretch {
                first: Enclosure::exact(distance.start.to_rational()),
                last: Enclosure::exact(distance.end.to_rational()),
            },
            Place::Critical(root) => {
                let instant = Enclosure::of_root(distance, root);
                Stretch {
                    first: instant.clone(),
                    last: instant,
                }
            }
        }
    }
}

/// The minimum over all spans (in the order of time); none without spans.
///
/// Time enclosures are at most `2^-bits` of their span wide, the squared distance's at most
/// `2^-2 bits` of the largest second derivative by the local parameter.
pub(crate) fn minimum(distances: &[SquaredDistance], bits: usize) -> Option<Minimum> {
    let candidates = distances.iter().flat_map(Candidate::all).collect();
    least(candidates, bits)
}

/// The least of the candidates, given in the order of time.
pub(crate) fn least(mut candidates: Vec<Candidate<'_>>, bits: usize) -> Option<Minimum> {
    for level in [16, 64, 256] {
        if candidates.len() <= 1 {
            break;
        }
        for candidate in &mut candidates {
            candidate.refine_to(level);
        }
        let values: Vec<Enclosure> = candidates.iter().map(Candidate::squared).collect();
        let best = values.iter().map(|value| &value.high).min()?.clone();
        let mut keep = values.iter().map(|value| value.low <= best);
        candidates.retain(|_| keep.next().unwrap());
        // Exact values that survive are all equal.
        if candidates.iter().all(Candidate::is_exact) {
            break;
        }
    }
    if !candidates.iter().all(Candidate::is_exact) {
        candidates = least_exactly(candidates);
    }
    for candidate in &mut candidates {
        candidate.refine_to(bits);
    }
    // All enclose the same number.
    let mut squared = candidates.first()?.squared();
    for candidate in &candidates[1..] {
        let other = candidate.squared();
        squared.low = squared.low.max(other.low);
        squared.high = squared.high.min(other.high);
    }
    if squared.low.is_zero() && !squared.is_exact() && candidates[0].is_zero() {
        squared = Enclosure::exact(RBig::ZERO);
    }
    let mut instants: Vec<Stretch> = Vec::new();
    for candidate in &candidates {
        let next = candidate.instants();
        match instants.last_mut() {
            // The same knot from both sides, or a plateau that goes on.
            Some(last) if last.last.is_exact() && last.last == next.first => {
                last.last = next.last;
            }
            _ => instants.push(next),
        }
    }
    Some(Minimum { squared, instants })
}

fn least_exactly(candidates: Vec<Candidate<'_>>) -> Vec<Candidate<'_>> {
    let mut kept: Vec<Candidate<'_>> = Vec::new();
    for candidate in candidates {
        match kept.first().map(|best| compare(best, &candidate)) {
            None | Some(Ordering::Equal) => kept.push(candidate),
            Some(Ordering::Less) => {}
            Some(Ordering::Greater) => kept = vec![candidate],
        }
    }
    kept
}
