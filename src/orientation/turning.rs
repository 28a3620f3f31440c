//! Turning motions: pieces in time order, and the cubics that stand in for them.

use super::arc::Arc;
use super::baked::BakedRotation;
use super::given::GivenRotation;
use super::piece::{RotationPiece, set_of};
use super::quaternion_cubic::matrix;
use crate::accuracy::Accuracy;
use crate::error::Error;
use crate::trajectory::Outside;
use glam::{DMat3, DQuat, DVec3};
use std::ops::RangeInclusive;

/// A turning motion.
#[derive(Clone, Debug)]
pub(crate) struct Turning {
    /// Orientations as given, in time order; each is followed until the next one begins.
    pub(super) parts: Vec<OrientationPart>,
    /// Largest error of the cubics, relative to a point's distance, if set.
    pub(super) tolerance: Option<f64>,
    pub(super) pieces: Vec<RotationPiece>,
}

/// An orientation and the time from which on it is followed.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct OrientationPart {
    /// First instant, s; none for the first one.
    pub(super) from: Option<f64>,
    pub(super) given: GivenRotation,
}

/// An interval between neighbouring cuts of a turning motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct TurningSection {
    piece: usize,
    /// First and last instant, s; may be infinite.
    pub(crate) start: f64,
    pub(crate) end: f64,
    is_known: bool,
}

/// A rotation at a constant rate in an interval, and how far the cubics that stand in for it are from it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SteadyTurn<'a> {
    arc: &'a Arc,
    /// Last instant, s.
    pub(crate) until: f64,
    /// Angular speed, rad/s.
    pub(crate) speed: f64,
    /// Bound on the distance between a point on any of the cubics, enlarged by the error of its centre, and that point as
    /// [`matrix`](Self::matrix) turns it; relative to the point's distance from the body's position.
    pub(crate) error: f64,
}

impl SteadyTurn<'_> {
    /// Returns the rotation at an instant (s) of the interval.
    #[inline]
    pub(crate) fn matrix(&self, time: f64) -> DMat3 {
        matrix(self.arc.at(time))
    }

    /// Returns how far a point may be from its linear motion in so long a time (s), relative to its distance from the body's
    /// position.
    #[inline]
    pub(crate) fn bend(&self, time: f64) -> f64 {
        let angle = self.speed * time;
        0.5 * angle * angle
    }

    /// Returns the angular velocity, rad/s.
    #[inline]
    pub(crate) fn velocity(&self) -> DVec3 {
        self.arc.axis * self.speed
    }
}

impl PartialEq for Turning {
    fn eq(&self, other: &Self) -> bool {
        self.parts == other.parts && self.tolerance == other.tolerance
    }
}

impl Turning {
    /// Tolerances that can be set: what rounding, and a cubic, allow.
    const TOLERANCES: RangeInclusive<f64> = 1e-9..=0.1;

    /// Returns the motion of a body that does not turn.
    pub(super) fn fixed() -> Self {
        let piece = RotationPiece::forever(Arc::held(DQuat::IDENTITY), [0.0; 2]);
        Self {
            parts: vec![OrientationPart {
                from: None,
                given: GivenRotation::Fixed,
            }],
            tolerance: None,
            pieces: vec![piece],
        }
    }

    /// Returns the motion of these parts.
    pub(super) fn of(parts: Vec<OrientationPart>, tolerance: Option<f64>) -> Result<Self, Error> {
        if let Some(value) = tolerance.filter(|value| !Self::TOLERANCES.contains(value)) {
            return Err(Error::Tolerance { value });
        }
        let mut turning = Self {
            parts,
            tolerance,
            pieces: Vec::new(),
        };
        let tolerances = turning.tolerances();
        for (number, part) in turning.parts.iter().enumerate() {
            let (start, end) = turning.interval(number);
            for mut piece in part.given.pieces(tolerances)? {
                piece.start = piece.start.max(start);
                piece.end = piece.end.min(end);
                if piece.start < piece.end {
                    turning.pieces.push(piece);
                }
            }
        }
        Ok(turning)
    }

    /// Returns the motion cut for another tolerance.
    pub(super) fn with_tolerance(self, tolerance: Option<f64>) -> Result<Self, Error> {
        if self.tolerance == tolerance {
            return Ok(self);
        }
        Self::of(self.parts, tolerance)
    }

    /// Returns the motion with another rule for the time outside the knots.
    pub(super) fn with_outside(&self, outside: Outside) -> Result<Self, Error> {
        let mut parts = self.parts.clone();
        for part in &mut parts {
            part.given.set_outside(outside);
        }
        Self::of(parts, self.tolerance)
    }

    /// Returns the tolerances of both sets of cuts.
    pub(super) fn tolerances(&self) -> [f64; 2] {
        [Accuracy::Exact, Accuracy::Certified].map(|one| self.tolerance(one))
    }

    /// Returns the largest error of the cubics, relative to a point's distance from the body's
    /// position.
    fn tolerance(&self, accuracy: Accuracy) -> f64 {
        const OF_EXACT: f64 = 1e-3;
        const OF_CERTIFIED: f64 = 1e-6;
        self.tolerance.unwrap_or(match accuracy {
            Accuracy::Exact => OF_EXACT,
            Accuracy::Certified => OF_CERTIFIED,
        })
    }

    /// Returns a bound on the distance from the body's position to the farthest point of a sphere
    /// whose radius is enlarged by the error of its centre, at any accuracy: for spheres within
    /// `reach` (m), with centres within `arm` (m).
    pub(crate) fn reach(&self, reach: f64, arm: f64) -> f64 {
        Self::reach_with(self.tolerance(Accuracy::Exact), reach, arm)
    }

    /// Returns a bound of the [reach](Self::reach) that holds for all orientations, m.
    pub(crate) fn reach_at_most(reach: f64, arm: f64) -> f64 {
        Self::reach_with(*Self::TOLERANCES.end(), reach, arm)
    }

    fn reach_with(tolerance: f64, reach: f64, arm: f64) -> f64 {
        // Twice: the centre may be off by the error, and the radius is enlarged by it. The cubic of an unknown
        // rotation leaves the centre at the body's position.
        let error = 2.0 * Self::largest_error(tolerance);
        (reach + error * arm) * (1.0 + 1e-12) + f64::MIN_POSITIVE
    }

    /// Returns the error beyond which a rotation counts as unknown: rounding cannot double it.
    fn largest_error(tolerance: f64) -> f64 {
        2.0 * tolerance
    }

    /// Returns the rotation at an instant (s).
    pub(super) fn at(&self, time: f64) -> DQuat {
        let piece = &self.pieces[self.piece_at(time)];
        let rotation = piece.at(time);
        rotation * (1.0 / rotation.length())
    }

    /// Returns the rotation at a constant rate from an instant (s) on, until another one (s) if it goes on so long. `None` if
    /// the rate changes, or if nothing may be known of the rotation.
    #[inline]
    pub(crate) fn steady_from(&self, from: f64, until: f64) -> Option<SteadyTurn<'_>> {
        let piece = &self.pieces[self.piece_at(from)];
        let until = until.min(piece.end);
        let largest = self.tolerances().map(Self::largest_error);
        let arc = piece.known_arc((from, until), largest)?;
        Some(SteadyTurn {
            arc,
            until,
            speed: arc.speed(),
            // Of the cubic, of the radius, and of the rotation's own rounding, which is part of either.
            error: 3.0 * largest[0].max(largest[1]),
        })
    }

    fn piece_at(&self, time: f64) -> usize {
        let after = self.pieces.partition_point(|piece| piece.start <= time);
        after.saturating_sub(1)
    }

    /// Returns the section that holds an instant (s): the one that begins there, if one does.
    #[inline]
    pub(crate) fn section_at(&self, time: f64, accuracy: Accuracy) -> TurningSection {
        let number = self.piece_at(time);
        let (start, end, is_known) = self.pieces[number].around(time, set_of(accuracy));
        TurningSection {
            piece: number,
            start,
            end,
            is_known,
        }
    }

    /// Returns the cubic of a section.
    pub(crate) fn bake(&self, section: &TurningSection, accuracy: Accuracy) -> BakedRotation {
        let ends = (section.start, section.end);
        if !section.is_known {
            return BakedRotation::unknown(ends);
        }
        let largest = Self::largest_error(self.tolerance(accuracy));
        self.pieces[section.piece].bake(ends, largest)
    }

    /// Returns when a part is followed (s).
    fn interval(&self, number: usize) -> (f64, f64) {
        let next = self.parts.get(number + 1).and_then(|next| next.from);
        let start = self.parts[number].from.unwrap_or(f64::NEG_INFINITY);
        (start, next.unwrap_or(f64::INFINITY))
    }

    /// Returns true if the motion goes on from an instant (s) as a rotation that is given.
    pub(super) fn goes_on_as(&self, given: &GivenRotation, from: f64) -> bool {
        let last = self.parts.last();
        last.is_some_and(|last| {
            last.given.is_same_as(given) && last.from.is_none_or(|begin| begin <= from)
        })
    }

    /// Drops the parts that are followed from `until` (s) on alone, and those that end before `since` (s). The first
    /// one that stays is followed from the beginning of time.
    pub(super) fn keep(&mut self, until: f64, since: f64) -> Result<(), Error> {
        // They are in time order: some at the beginning go, and some at the end.
        let is_kept = |&number: &usize| {
            let (start, end) = self.interval(number);
            start < end.min(until) && end.min(until) >= since
        };
        let count = self.parts.len();
        let first = (0..count).find(is_kept).unwrap_or(count);
        let kept = (first..count).take_while(is_kept).count();
        self.parts.truncate(first + kept);
        self.parts.drain(..first);
        let begin = match self.parts.first_mut() {
            Some(part) => part.from.take().unwrap_or(f64::NEG_INFINITY),
            None => f64::INFINITY,
        };
        if begin.is_finite() && !self.parts[0].given.is_one_piece() {
            // Some pieces may lie before.
            self.pieces = Self::of(self.parts.clone(), self.tolerance)?.pieces;
        } else {
            self.pieces.retain(|piece| piece.start >= begin);
            if let Some(piece) = self.pieces.first_mut() {
                piece.start = f64::NEG_INFINITY;
            }
        }
        self.end_at(until);
        Ok(())
    }

    fn end_at(&mut self, until: f64) {
        self.pieces.retain_mut(|piece| {
            piece.end = piece.end.min(until);
            piece.start < piece.end
        });
    }

    /// Appends a motion that is followed from an instant (s) on, or from the beginning of time if there is no other.
    pub(super) fn append(&mut self, mut next: Self, from: f64) {
        self.end_at(from);
        let from = (!self.parts.is_empty()).then_some(from);
        next.parts[0].from = from;
        self.parts.append(&mut next.parts);
        let begin = from.unwrap_or(f64::NEG_INFINITY);
        let pieces = next.pieces.into_iter().filter(|piece| piece.end > begin);
        self.pieces.extend(pieces.map(|mut piece| {
            piece.start = piece.start.max(begin);
            piece
        }));
    }
}
