//! Serialised trajectories: the exact internal numbers, checked on reading.

use super::build::{check_number, check_times, check_vector};
use super::{Outside, Segment, StraightMotion, Trajectory};
use crate::error::{Error, Quantity};
use crate::rounding::{UNDERFLOW, largest_norm, without_negative_zero};
use bytemuck::cast_slice;
use glam::DVec3;
use serde::{Deserialize, Serialize};

/// The serialised fields of a trajectory.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Numbers {
    knots: Vec<f64>,
    segments: Vec<[f64; 16]>,
    /// Motions before and after the knots.
    ends: [[f64; 16]; 2],
    /// Rules before and after the knots.
    outside: [Outside; 2],
}

impl From<Trajectory> for Numbers {
    fn from(trajectory: Trajectory) -> Self {
        Self {
            knots: trajectory.knots().to_vec(),
            segments: trajectory.segments().iter().map(Segment::numbers).collect(),
            ends: trajectory.end_motions().map(|end| end.numbers()),
            outside: [trajectory.outside_before(), trajectory.outside_after()],
        }
    }
}

impl TryFrom<Numbers> for Trajectory {
    type Error = Error;

    fn try_from(numbers: Numbers) -> Result<Self, Error> {
        let Numbers {
            mut knots,
            segments,
            ends,
            outside,
        } = numbers;
        let Some(last) = knots.len().checked_sub(1) else {
            return Err(Error::TooFewStates { count: 0 });
        };
        if last == 0 && outside[1] == Outside::Absent {
            // It would exist at a single instant, or end where nothing but its end is known.
            return Err(Error::TooFewStates { count: 1 });
        }
        if segments.len() != last {
            return Err(Error::SegmentCount {
                knots: knots.len(),
                segments: segments.len(),
            });
        }
        for time in &mut knots {
            *time = without_negative_zero(*time);
        }
        check_times(knots.iter().copied())?;
        let segment = |(knot, numbers): (usize, [f64; 16])| {
            check_number(knot, Quantity::Time, numbers[0])?;
            check_number(knot, Quantity::Time, numbers[1])?;
            Segment::from_numbers(numbers, knot)
        };
        let [before, after] = ends;
        let segments = (1..).zip(segments).map(segment);
        let segments = segments.collect::<Result<Vec<_>, _>>()?;
        // Where a knot lies at an end of the range of times, the motion from there goes on beyond that.
        let ends = [
            // The first cubic of a plan that has lost its beginning.
            if before[15] > 0.0 {
                Segment::from_numbers(before, 0)?
            } else {
                Segment::going_on(before, 0)?
            },
            Segment::going_on(after, last)?,
        ];
        for (knot, (segment, ends)) in (1..).zip(segments.iter().zip(knots.windows(2))) {
            // A piece may be any part of its cubic, also one beyond it.
            if ends[0] < segment.start() || ends[1] > segment.end() {
                segment.check_followable((ends[0], ends[1]), knot)?;
            }
        }
        let is_line = last == 0
            && outside == [Outside::Coast; 2]
            && ends[0] == ends[1]
            && ends[0].start().total_cmp(&knots[0]).is_eq();
        if let Some(motion) = StraightMotion::of(&ends[0]).filter(|_| is_line) {
            return Ok(Self::of_straight(motion));
        }
        Ok(Self::of_cubics(&knots, &segments, &ends, outside))
    }
}

impl Segment {
    fn numbers(&self) -> [f64; 16] {
        let ([a, b, c], error) = self.parts();
        let mut numbers = [0.0; 16];
        numbers[..2].copy_from_slice(&[self.start(), self.end()]);
        numbers[2..14].copy_from_slice(cast_slice(&[self.origin(), a, b, c]));
        numbers[14..].copy_from_slice(&[self.extent(), error]);
        numbers
    }

    /// Rebuilds an end motion: straight, with the coefficients of a cubic.
    fn going_on(mut numbers: [f64; 16], knot: usize) -> Result<Self, Error> {
        let higher = [vector(&numbers, 8), vector(&numbers, 11)];
        for coefficient in higher {
            check_vector(knot, Quantity::Position, coefficient)?;
        }
        numbers[8..14].fill(0.0);
        let line = Self::from_numbers(numbers, knot)?;
        // As Bézier points they would be bounded by the extent.
        if !line.is_power_form() {
            return Err(Error::Contradiction { knot });
        }
        Ok(line.with_coefficients(higher))
    }

    /// Rebuilds a segment after checking its numbers; `knot` is the number of its end knot.
    fn from_numbers(numbers: [f64; 16], knot: usize) -> Result<Self, Error> {
        let [start, end, .., extent, error] = numbers;
        for time in [start, end] {
            if !time.is_finite() {
                return Err(Error::NotFinite {
                    knot,
                    quantity: Quantity::Time,
                    value: time,
                });
            }
        }
        for (place, value) in numbers[2..].iter().enumerate() {
            check_number(knot, Quantity::Position(place % 3), *value)?;
        }
        if end <= start {
            return Err(Error::TimeNotIncreasing {
                knot,
                previous: start,
                time: end,
            });
        }
        let segment = Self::from_parts(
            (start, end),
            vector(&numbers, 2),
            [5, 8, 11].map(|place| vector(&numbers, place)),
            (extent, error),
            knot,
        )?;
        // The extent must bound the control points. Of subnormal ones the last digit is rounded, whatever it is worth.
        let farthest = largest_norm(&segment.control_points());
        if farthest.is_nan() || extent + UNDERFLOW < farthest * (1.0 - 8.0 * f64::EPSILON) {
            return Err(Error::Contradiction { knot });
        }
        Ok(segment)
    }
}

/// Returns the vector that begins at a place.
fn vector(numbers: &[f64; 16], place: usize) -> DVec3 {
    DVec3::from_slice(&numbers[place..])
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a failure fails the test")]

    use super::*;
    use crate::trajectory::State;

    /// Numbers at either end of the range, between which a cubic exists.
    #[test]
    fn plans_that_can_be_built_can_be_read() {
        let far = [-3e299, 2.7e299].map(|x| x * DVec3::X);
        let fast = 1.2e297 * DVec3::X;
        let mut plans = vec![[State::new(0.0, far[0], fast), State::new(1e3, far[1], fast)]];
        // A sum of two lengths that are rounded downward, and the length of the sum, which is rounded upward.
        let tiny = DVec3::new(1.0, 1.0, 0.0) * f64::from_bits(1);
        plans.push([
            State::new(0.0, DVec3::ZERO, DVec3::ZERO),
            State::new(3.0, tiny, -tiny),
        ]);
        for states in plans {
            let plan = Trajectory::from_states(&states).unwrap();
            let text = serde_json::to_string(&plan).unwrap();
            let read = serde_json::from_str::<Trajectory>(&text);
            assert_eq!(read.unwrap(), plan, "{text}");
        }
    }

    /// A motion that is spliced with itself at its knot stays a single motion, as it is when it is read.
    #[test]
    fn a_splice_at_the_knot_of_a_motion_is_read_as_it_was() {
        let position = [
            -199_374_119.812_385_62,
            -565_798_128.670_067,
            522_552_002.408_144_4,
        ];
        let velocity = [0.180_663_796_547_265_33, 0.001_665_788, 0.097_750_3];
        let state = State::new(-3.449_527_605_992_784_6, position, velocity);
        let motion = Trajectory::coasting(state).unwrap();
        let spliced = motion.spliced(state.time, &motion).unwrap();
        assert!(motion.straight().is_some() && spliced.straight().is_some());
    }

    #[test]
    fn a_single_knot_is_no_end() {
        let still = Trajectory::at_rest(DVec3::ZERO).unwrap();
        let mut numbers = Numbers::from(still);
        numbers.outside[1] = Outside::Absent;
        let read = Trajectory::try_from(numbers);
        assert_eq!(read, Err(Error::TooFewStates { count: 1 }));
    }
}
