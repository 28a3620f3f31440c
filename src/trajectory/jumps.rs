//! Where a motion is in two places at one instant.

use super::{Outside, Segment, Trajectory};
use crate::rounding::{CLEARANCE, UNIT_ROUNDOFF};
use glam::DVec3;
use std::iter::once;

impl Trajectory {
    /// The knots at which the position jumps, s, ascending: a splice or coefficients may leave it so.
    /// The first and the last one are among them where what carries the body beyond begins
    /// elsewhere.
    pub(crate) fn jumps(&self) -> impl Iterator<Item = f64> {
        let left = once(self.before()).chain(&*self.segments);
        let right = self.segments.iter().chain(once(self.after()));
        let joints = self.knots.iter().zip(left.zip(right));
        let jumps = |(&knot, (left, right))| (!meet(left, right, knot)).then_some(knot);
        let ends = usize::from(self.outside == Outside::Absent);
        let inner = joints.skip(ends).take(self.knots.len() - 2 * ends);
        inner.filter_map(jumps)
    }
}

/// Whether two cubics are in the same place at an instant, as far as rounding can tell.
fn meet(left: &Segment, right: &Segment, time: f64) -> bool {
    let (x, y) = (place(left, time), place(right, time));
    let scale = left.rounding_scale(time, time) + right.rounding_scale(time, time);
    let size = x.abs().max(y.abs()).max_element();
    (x - y).abs().max_element() <= 4.0 * UNIT_ROUNDOFF * size + CLEARANCE * scale
}

/// Where a cubic is, m: mostly at one of its own ends.
fn place(segment: &Segment, time: f64) -> DVec3 {
    if time.to_bits() == segment.end().to_bits() {
        segment.origin() + segment.control()[3]
    } else {
        segment.motion_at(time).0
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Outside, State, Trajectory};
    use glam::DVec3;

    fn line(start: f64, end: f64, from: DVec3, velocity: DVec3) -> Trajectory {
        let last = from + velocity * (end - start);
        let states = [
            State::new(start, from, velocity),
            State::new(0.3 * start + 0.7 * end, from.lerp(last, 0.7), velocity),
            State::new(end, last, velocity),
        ];
        Trajectory::from_states(&states).unwrap_or_else(|error| unreachable!("{error}"))
    }

    #[test]
    fn jumps_are_where_plans_do_not_meet() {
        const NONE: [f64; 0] = [];
        let far = DVec3::new(1.1e9, -0.3, 7e5);
        let (slow, fast) = (DVec3::new(0.1, 0.7, 0.3), DVec3::new(0.0, -900.0, 1e3));
        let (from, at) = (1.7e9, 1.7e9 + 11.3);
        let flown = line(from, from + 20.0, far, slow);
        let meeting = line(at, at + 7.0, flown.position(at).unwrap_or_default(), fast);
        let apart = line(at, at + 7.0, far, fast);
        let jumps = |plan: &Trajectory, outside| -> Vec<f64> {
            plan.clone().with_outside(outside).jumps().collect()
        };
        for outside in [Outside::Absent, Outside::Coast, Outside::Extrapolate] {
            for plan in [&flown, &meeting, &apart] {
                assert_eq!(jumps(plan, outside), NONE);
            }
            let coasting = flown.clone().with_outside(Outside::Coast);
            for flown in [&flown, &coasting] {
                let spliced = |plan: &Trajectory| {
                    let spliced = flown.spliced(at, plan);
                    spliced.unwrap_or_else(|error| unreachable!("{error}"))
                };
                assert_eq!(jumps(&spliced(&meeting), outside), NONE);
                assert_eq!(jumps(&spliced(&apart), outside), [at]);
            }
        }
        // Nothing is left of the plan before but what carried the body before it began, nor of the
        // other one but what carries it after.
        let coasts = |plan: &Trajectory| plan.clone().with_outside(Outside::Coast);
        let later = line(at + 1.0, at + 2.0, far, slow);
        let earlier = line(from, at - 1.0, far, fast);
        for (flown, plan) in [(&later, &apart), (&flown, &earlier), (&later, &earlier)] {
            let spliced = coasts(flown).spliced(at, &coasts(plan));
            let spliced = spliced.unwrap_or_else(|error| unreachable!("{error}"));
            assert_eq!(jumps(&spliced, Outside::Coast), [at], "{spliced:?}");
        }
        let resting = Trajectory::at_rest(far).unwrap_or_else(|error| unreachable!("{error}"));
        assert_eq!(jumps(&resting, Outside::Coast), NONE);
    }
}
