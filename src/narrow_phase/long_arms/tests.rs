//! Bodies that the solver finds within a margin are never apart, and most others are.

#![allow(clippy::unwrap_used, reason = "a failure fails the test")]

use super::super::contact::{closest_approach, may_touch};
use super::*;
use crate::hitbox::{Hitbox, Sphere};
use crate::knots::Knots;
use crate::orientation::Orientation;
use crate::rounding::exact::vector;
use crate::rounding::exact_interval;
use crate::shape::BodyShape;
use crate::spans::spans;
use crate::trajectory::{Outside, Pieces, State, Trajectory};
use glam::DQuat;
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};

/// Time from the first knot to that at which some bodies jump to another rotation, s.
const JUMP: f64 = 0.25;

struct TestBody {
    plan: Pieces,
    hitbox: Hitbox,
    orientation: Orientation,
    model_error: f64,
}

impl TestBody {
    fn view(&self) -> BodyView<'_> {
        let Pieces { knots, segments } = &self.plan;
        let shape = BodyShape::new(&self.hitbox, self.orientation.turning(), self.model_error);
        BodyView::of((Knots::of(knots), segments), shape)
    }
}

/// Returns a rod, a plate, a hinged door, or a sphere aside of the position.
fn hitbox(rng: &mut ChaCha8Rng, kind: usize, size: f64) -> Hitbox {
    let aside = [0.0, 1.0, 4.0][kind / 4 % 3] * vector(rng, size);
    let extents = [
        DVec3::new(1.0, 0.0, 0.0),
        DVec3::new(0.5, 1.0, 0.02),
        DVec3::new(0.02, 0.1, 1.0),
        DVec3::new(0.3, 0.3, 0.3),
    ][kind % 4];
    let tilt = DQuat::from_scaled_axis(vector(rng, [0.0, 2.0][kind / 3 % 2]));
    let count = if kind.is_multiple_of(5) { 1 } else { 12 };
    let spheres = (0..count).map(|number: u16| Sphere {
        offset: aside + tilt * (vector(rng, size) * extents),
        radius: [0.05, 0.05, 0.2][usize::from(number) % 3] * size,
    });
    Hitbox::cluster(spheres.collect()).unwrap()
}

fn orientation(rng: &mut ChaCha8Rng, kind: usize, first: f64) -> Orientation {
    let any = |rng: &mut ChaCha8Rng| DQuat::from_scaled_axis(vector(rng, 2.0));
    let speed = [0.05, 1.0, 8.0][kind / 2 % 3];
    let spin = |rng: &mut ChaCha8Rng, time: f64| {
        let rotation = any(rng);
        Orientation::spin(time, rotation, vector(rng, speed)).unwrap()
    };
    let turn = match kind % 6 {
        0 => Orientation::FIXED,
        1 => {
            let knots = [0.0, 0.3, 0.45, 0.9].map(|time| (first + time, any(rng)));
            let turn = Orientation::slerp(&knots).unwrap();
            turn.with_outside([Outside::Absent, Outside::Coast][kind / 6 % 2])
        }
        // It jumps.
        2 => {
            let next = spin(rng, first);
            spin(rng, first).spliced(first + JUMP, &next).unwrap()
        }
        3 => {
            let knots = [0.0, 0.5, 0.9].map(|time| (first + time, any(rng)));
            Orientation::normalized_cubic(&knots).unwrap()
        }
        _ => spin(rng, first + [0.0, 0.7, -1e3][kind % 3]),
    };
    match [None, Some(0.05), Some(1e-7)][kind / 6 % 3] {
        Some(tolerance) => turn.with_tolerance(tolerance).unwrap(),
        None => turn,
    }
}

fn mover(rng: &mut ChaCha8Rng, kind: usize, first: f64) -> TestBody {
    let size = [1.0, 1e-6, 1e6][kind / 7 % 3];
    let states = [0.0, 0.4, 1.0]
        .map(|time| State::new(first + time, vector(rng, 2.0 * size), vector(rng, size)));
    TestBody {
        plan: Pieces::own(&Trajectory::from_states(&states).unwrap()),
        hitbox: hitbox(rng, kind, size),
        orientation: orientation(rng, kind / 2, first),
        model_error: [0.0, 0.0, 0.1][kind % 3] * size,
    }
}

/// The solver's own distance is the sharpest test: in any interval around the closest approach, at a margin that is the
/// separation there, to the bit. Far below that, most bodies are told apart.
#[test]
fn what_the_solver_finds_within_a_margin_is_not_apart() {
    let mut rng = ChaCha8Rng::seed_from_u64(21);
    let (mut told, mut asked) = (0, 0);
    for round in 0..6_000_usize {
        // Some jump at 0.
        let first = [0.0, -JUMP, 1e9][round % 3];
        let kind = rng.random_range(0..1_000);
        // Of one size.
        let kinds = [kind, rng.random_range(0..50) * 21 + kind % 21];
        let bodies = kinds.map(|kind| mover(&mut rng, kind, first));
        let [a, b] = &bodies.each_ref().map(TestBody::view);
        if !a.has_long_arms() && !b.has_long_arms() {
            continue;
        }
        for span in spans(&a.knots, &b.knots, first, first + 1.0) {
            let whole = (span.start, span.end);
            let nearest = closest_approach(a, b, [span].into_iter(), whole).unwrap();
            let (time, separation) = (nearest.time, nearest.separation);
            let [before, after] = [time - whole.0, whole.1 - time];
            let around = (
                time - before * rng.random_range(0.0..1.0),
                time + after * rng.random_range(0.0..1.0),
            );
            let mut intervals = [whole, around, (time, time), (time, whole.1)].map(exact_interval);
            if first <= 0.0 {
                // A rotation may end there, and another one begin.
                intervals[3] = (time, whole.1);
            }
            for interval in intervals {
                let margin = (separation - a.model_error_with(b)).next_up();
                let is_near = may_touch(a, b, span, margin, interval);
                assert!(is_near, "{round} {kinds:?} {interval:?}");
            }
            let jump = first + JUMP;
            if whole.0 <= jump && jump <= whole.1 {
                for interval in [(whole.0, jump), (jump, jump), (jump, whole.1)] {
                    let nearest = closest_approach(a, b, [span].into_iter(), interval).unwrap();
                    let margin = (nearest.separation - a.model_error_with(b)).next_up();
                    let interval = exact_interval(interval);
                    let is_near = may_touch(a, b, span, margin, interval);
                    assert!(is_near, "{round} {kinds:?} {interval:?}");
                }
            }
            let margin = 0.5 * separation;
            let ball = [a, b].map(|view| BodyView {
                hitbox: None,
                ..*view
            });
            if separation > 0.0 && may_touch(&ball[0], &ball[1], span, margin, whole) {
                asked += 1;
                told += u32::from(!may_touch(a, b, span, margin, whole));
            }
        }
    }
    assert!(5 * told > asked && asked > 1_000, "{told} of {asked}");
}
