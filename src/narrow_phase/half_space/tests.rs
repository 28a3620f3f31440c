//! Error terms of spheres above a half-space against exact arithmetic, each where it dominates.

#![allow(clippy::unwrap_used, reason = "a failure fails the test")]

use super::*;
use crate::hitbox::{Hitbox, Sphere};
use crate::knots::Knots;
use crate::rounding::exact::{Exact, number};
use crate::shape::BodyShape;
use crate::spans::spans;
use crate::trajectory::{State, Trajectory};
use dashu::rational::RBig;
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};

fn vector(rng: &mut ChaCha8Rng, half: f64) -> DVec3 {
    DVec3::from_array([0; 3].map(|_| half * rng.random_range(-1.0..1.0)))
}

/// A vector of about this length of which little lies along a normal.
fn across(rng: &mut ChaCha8Rng, normal: DVec3, size: f64) -> DVec3 {
    (normal.cross(vector(rng, 1.0)).normalize() + vector(rng, 1e-9)) * size
}

fn at_rest(place: DVec3) -> Trajectory {
    let states = [0.0, 1.0].map(|time| State::new(time, place, DVec3::ZERO));
    Trajectory::from_states(&states).unwrap()
}

fn view<'a>(plan: &'a Trajectory, hitbox: &'a Hitbox) -> BodyView<'a> {
    let shape = BodyShape::new(hitbox, None, 0.0);
    BodyView::of((Knots::of(plan.knots()), plan.segments()), shape)
}

/// The height of a point of the line that stands for a sphere, without rounding.
fn height(pair: &SpherePair, plane_is_first: bool, point: usize) -> RBig {
    let shift = if plane_is_first {
        pair.radius_a
    } else {
        pair.radius_b
    };
    number(pair.cubic.points[point].x) - number(shift)
}

/// Offsets and places along the plane, of which little is left; above and below it.
#[test]
fn lines_are_within_their_error_of_the_heights() {
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    let rng = &mut rng;
    for round in 0..2_000 {
        let [place, offset] = [[0.0, 1.0], [1.0, 0.0], [1.0, 1.0], [1e-9, 1e-310]][round % 4];
        let normal = vector(rng, 1.0).normalize();
        let (body, floor) = (
            across(rng, normal, place),
            across(rng, normal, 1e-3 * place),
        );
        let centre = across(rng, normal, offset);
        let plans = [at_rest(body), at_rest(floor)];
        let spheres = [centre, DVec3::ZERO].map(|offset| Sphere {
            offset,
            radius: 0.1,
        });
        let hitbox = Hitbox::cluster(spheres.to_vec()).unwrap();
        let plane = Hitbox::half_space(normal).unwrap();
        let views = [view(&plans[0], &hitbox), view(&plans[1], &plane)];
        let is_first = round % 8 < 4;
        let (a, b) = if is_first {
            (&views[1], &views[0])
        } else {
            (&views[0], &views[1])
        };
        let span = spans(&a.knots, &b.knots, 0.0, 1.0).next().unwrap();
        let pair = PlanePair::of(a, b, span).unwrap();
        let sphere = SphereAlong {
            number: 0,
            radius: 0.1,
            way: [pair.along(centre); 4],
            rounding: pair.rounding_along(centre),
            baking: 0.0,
        };
        let line = pair.sphere_pair(span, &pair.heights(span), &sphere);
        let exact = Exact::of(body).plus(&Exact::of(centre));
        let exact = exact.minus(&Exact::of(floor));
        for point in 0..4 {
            let found = height(&line, is_first, point);
            let is_within = exact.is_at_height(normal, &found, line.cubic.error);
            assert!(is_within, "{round} {body:?} {centre:?} {normal:?} {line:?}");
        }
    }
}
