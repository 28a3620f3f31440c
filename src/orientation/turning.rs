//! Turning motions: pieces in time order, and the cubics that stand in for them.

use super::baked::BakedRotation;
use super::given::GivenRotation;
use super::piece::{RotationPiece, set_of};
use crate::accuracy::Accuracy;
use crate::error::Error;
use crate::trajectory::Outside;
use glam::DQuat;
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

impl PartialEq for Turning {
    fn eq(&self, other: &Self) -> bool {
        self.parts == other.parts && self.tolerance == other.tolerance
    }
}

impl Turning {
    /// Tolerances that can be set: what rounding, and a cubic, allow.
    const TOLERANCES: RangeInclusive<f64> = 1e-9..=0.1;

    /// Returns the motion of these parts. Cuts of cubics that known motions have are not searched for again.
    pub(super) fn of(
        parts: Vec<OrientationPart>,
        tolerance: Option<f64>,
        known: &[&Self],
    ) -> Result<Self, Error> {
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
            let start = part.from.unwrap_or(f64::NEG_INFINITY);
            let next = turning.parts.get(number + 1).and_then(|next| next.from);
            let end = next.unwrap_or(f64::INFINITY);
            let known = known.iter().filter(|one| one.tolerance == tolerance);
            let kept = known
                .filter(|_| part.given.has_searched_cuts())
                .find_map(|one| one.pieces_within(&part.given, (start, end)));
            let pieces = kept.map_or_else(|| part.given.pieces(tolerances), Ok)?;
            for mut piece in pieces {
                piece.start = piece.start.max(start);
                piece.end = piece.end.min(end);
                if piece.start < piece.end {
                    turning.pieces.push(piece);
                }
            }
        }
        Ok(turning)
    }

    /// Returns the pieces of a rotation as given, if it is followed at least between two instants (s).
    fn pieces_within(
        &self,
        given: &GivenRotation,
        (start, end): (f64, f64),
    ) -> Option<Vec<RotationPiece>> {
        let followed = |number: usize| {
            let part = self.parts.get(number).filter(|part| part.given == *given);
            part.and_then(|_| {
                Self::followed_within(&self.parts, number, f64::INFINITY, f64::NEG_INFINITY)
            })
        };
        let mut intervals = (0..self.parts.len()).filter_map(followed);
        let (from, to) = intervals.find(|&(from, to)| from <= start && end <= to)?;
        let own = self
            .pieces
            .iter()
            .filter(|piece| from <= piece.start && piece.end <= to);
        Some(own.cloned().collect())
    }

    /// Returns the motion with another rule for the time outside the knots.
    pub(super) fn with_outside(&self, outside: Outside) -> Result<Self, Error> {
        let mut parts = self.parts.clone();
        for part in &mut parts {
            part.given.set_outside(outside);
        }
        Self::of(parts, self.tolerance, &[])
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

    /// Returns when a part is followed (s) if the motion is left at `until` (s); `None` if it never is, or only before
    /// `since` (s).
    pub(super) fn followed_within(
        parts: &[OrientationPart],
        number: usize,
        until: f64,
        since: f64,
    ) -> Option<(f64, f64)> {
        let next = parts.get(number + 1).and_then(|next| next.from);
        let end = next.unwrap_or(f64::INFINITY).min(until);
        let start = parts[number].from.unwrap_or(f64::NEG_INFINITY);
        (start < end && end >= since).then_some((start, end))
    }

    /// Returns the parts of a motion that is left at `until` (s) for another one, without those that
    /// end before `since` (s).
    pub(super) fn parts_until(
        parts: &[OrientationPart],
        until: f64,
        since: f64,
    ) -> Vec<OrientationPart> {
        let mut kept: Vec<OrientationPart> = Vec::new();
        for (number, part) in parts.iter().enumerate() {
            if Self::followed_within(parts, number, until, since).is_some() {
                kept.push(part.clone());
            }
        }
        if let Some(first) = kept.first_mut() {
            first.from = None;
        }
        kept
    }
}
