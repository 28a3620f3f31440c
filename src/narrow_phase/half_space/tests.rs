//! Error terms of spheres above a half-space against exact arithmetic, each where it dominates.

#![allow(clippy::unwrap_used, reason = "a failure fails the test")]

use super::*;
use crate::hitbox::{Hitbox, Sphere};
use crate::knots::Knots;
use crate::rounding::exact::{Exact, number, vector};
use crate::shape::BodyShape;
use crate::spans::spans;
use crate::trajectory::{State, Trajectory};
use dashu::rational::RBig;
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};

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
            path_error: 0.0,
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

/// Spheres of which rounding hides the lowest one, by their places and by their radii: the line is
/// within its error of each.
#[test]
fn no_sphere_is_lower_than_the_lowest_one() {
    let mut rng = ChaCha8Rng::seed_from_u64(2);
    let rng = &mut rng;
    let mut hidden = 0;
    for round in 0..1_000 {
        let (normal, spheres) = if round % 2 == 0 {
            let normal = vector(rng, 1.0).normalize();
            let far = across(rng, normal, 1.0);
            // What is left of it along the normal is rounding.
            let far = far - normal * far.dot(normal);
            (normal, [(DVec3::ZERO, 0.0), (far, 0.0)])
        } else {
            let low = DVec3::new(0.0, 0.0, -rng.random_range(0.0..1e-13));
            (DVec3::Z, [(DVec3::ZERO, 1e3), (low, 1e3)])
        };
        let plans = [at_rest(DVec3::ZERO), at_rest(DVec3::ZERO)];
        let all = spheres.map(|(offset, radius)| Sphere { offset, radius });
        let hitbox = Hitbox::cluster(all.to_vec()).unwrap();
        let plane = Hitbox::half_space(normal).unwrap();
        let views = [view(&plans[0], &hitbox), view(&plans[1], &plane)];
        let [a, b] = &views;
        let span = spans(&a.knots, &b.knots, 0.0, 1.0).next().unwrap();
        let line = lone_pair(a, b, span).unwrap();
        let found = height(&line, false, 0) - number(line.radius_a);
        for (number_of, (offset, radius)) in (0..).zip(spheres) {
            let most = number(radius) + &found - number(line.cubic.error);
            let is_lower = number_of != line.a
                && Exact::of(offset).is_not_above(normal, &(number(radius) + &found));
            hidden += usize::from(is_lower);
            // At most there: not lower by more than the error.
            let opposite = Exact::of(-offset);
            assert!(opposite.is_not_above(normal, &-most), "{round} {line:?}");
        }
    }
    assert!(hidden > 200, "{hidden}");
}

/// Bodies at rest that touch as far as exact arithmetic can tell: far along the plane, and with a
/// normal as long as is accepted.
#[test]
fn what_touches_is_not_ruled_out() {
    const RADIUS: f64 = 0.1;
    let mut rng = ChaCha8Rng::seed_from_u64(3);
    let rng = &mut rng;
    for round in 0..400 {
        let unit = vector(rng, 1.0).normalize();
        let normal = unit * [1.0, 1.0 + 0.9e-9][round / 2 % 2];
        let place = unit * [1e-3, 1e3][round % 2] + across(rng, unit, [1e6, 0.0][round % 2]);
        let plans = [at_rest(place), at_rest(DVec3::ZERO)];
        let hitbox = Hitbox::sphere(RADIUS).unwrap();
        let plane = Hitbox::half_space(normal).unwrap();
        let views = [view(&plans[0], &hitbox), view(&plans[1], &plane)];
        let [a, b] = &views;
        let span = spans(&a.knots, &b.knots, 0.0, 1.0).next().unwrap();
        let touches = |margin: f64| {
            let most = number(RADIUS) + number(margin);
            Exact::of(place).is_not_above(normal, &most)
        };
        let mut margin = place.dot(unit) - RADIUS;
        let (mut low, mut high) = (margin - 1e-8, margin + 1e-8);
        assert!(touches(high) && !touches(low));
        while low.next_up() < high {
            margin = 0.5 * (low + high);
            *(if touches(margin) { &mut high } else { &mut low }) = margin;
        }
        let whole = (0.0, 1.0);
        assert!(
            may_touch_plane(a, b, span, high, whole),
            "{round} {place} {normal}"
        );
        assert!(may_touch_plane(b, a, span, high, whole), "{round}");
    }
}
