//! Wrong calls of curves, fits, covers, half-spaces, settings and questions, each with the sentence that answers it.
//! The commonest ones are in `wrong_use`.

#![allow(
    clippy::unwrap_used,
    reason = "a scene that cannot be built fails the test"
)]

use nearmiss::glam::{DQuat, DVec3, Quat, Vec3};
use nearmiss::parry3d::shape::{Ball, Cuboid, Segment, TriMesh};
use nearmiss::{
    AlertLevel, Body, BodyId, BodyState, CoverOptions, FitOptions, Hitbox, Keyframe, Monitor,
    Orientation, Outside, PositionOptions, Query, RevisionThreshold, Scene, Sphere, SphereCover,
    State, TimeBase, Trajectory, Window, pair, verify_cover,
};
use std::error::Error;

type Outcome = Result<(), Box<dyn Error>>;
type Attempt = fn() -> Outcome;

/// What an attempt that is not refused returns is of no interest.
fn done<T>(_: T) -> Outcome {
    Ok(())
}

fn state(time: f64, x: f64) -> State {
    State::new(time, x * DVec3::X, DVec3::X)
}

fn flying() -> Trajectory {
    Trajectory::from_states(&[state(0.0, 0.0), state(10.0, 10.0)]).unwrap()
}

fn body() -> Body {
    Body::new(flying()).with_tag(4)
}

fn window(start: f64, end: f64) -> Window {
    Window::new(start, end).unwrap()
}

fn monitor() -> (Monitor, BodyId) {
    let mut scene = Scene::new();
    let id = scene.insert(body()).unwrap();
    (
        Monitor::new(scene, 1.0, 5.0, &[AlertLevel::at(1.0)]).unwrap(),
        id,
    )
}

fn fit(motion: fn(f64) -> (DVec3, DVec3), window: Window, tolerance: f64) -> Outcome {
    done(Trajectory::fit(motion, window, tolerance)?)
}

fn straight(time: f64) -> (DVec3, DVec3) {
    (time * DVec3::X, DVec3::X)
}

#[rustfmt::skip]
const CURVES: &[(Attempt, &str)] = &[
    (|| done(Trajectory::from_waypoints(&[(0.0, DVec3::ZERO)])?),
     "a trajectory needs at least two states or waypoints, not 1 (Trajectory::coasting takes one)"),
    (|| done(Trajectory::from_waypoints(&[(0.0, DVec3::ZERO), (5.0, DVec3::X), (5.0, DVec3::Y)])?),
     "knot 2: time 5.0 s is not later than the knot before it, 5.0 s: sort by time, and keep one knot for each instant (of a B-spline at most four)"),
    (|| done(Trajectory::from_waypoints(&[(0.0, DVec3::ZERO), (1.0, DVec3::new(0.0, f64::NAN, 0.0))])?),
     "knot 1: position y is NaN, not a finite number"),
    (|| done(Trajectory::from_positions_with(&[(0.0, DVec3::ZERO), (1.0, DVec3::X)],
                                             &PositionOptions::new().with_first_velocity(DVec3::NAN))?),
     "knot 0: velocity x is NaN, not a finite number"),
    (|| done(Trajectory::from_bezier(&[0.0, 1.0], &[[DVec3::ZERO; 4]; 0])?), "2 knots need 1 segments, not 0"),
    (|| done(Trajectory::from_bezier(&[0.0, -1.0], &[[DVec3::ZERO; 4]])?),
     "knot 1: time -1.0 s is not later than the knot before it, 0.0 s: sort by time, and keep one knot for each instant (of a B-spline at most four)"),
    (|| done(Trajectory::from_b_spline(&[0.0, 1.0, 2.0], &[DVec3::ZERO; 4])?),
     "a cubic B-spline of 4 control points needs 8 knots, not 3"),
    (|| done(Trajectory::from_uniform_b_spline(0.0, 1.0, &[DVec3::ZERO; 3])?),
     "a cubic B-spline needs at least four control points, not 3"),
    (|| done(Trajectory::from_uniform_b_spline(0.0, 0.0, &[DVec3::ZERO; 4])?),
     "knot 1: time 0.0 s is not later than the knot before it, 0.0 s: sort by time, and keep one knot for each instant (of a B-spline at most four)"),
    (|| {
        let frame = |time, tangent| Keyframe::new(time, tangent, DVec3::X, DVec3::X);
        done(Trajectory::from_keyframes(&[frame(0.0, DVec3::X), frame(1.0, DVec3::NAN)])?)
    }, "knot 1: velocity x is NaN, not a finite number"),
    (|| done(Trajectory::from_coefficients(&[0.0, 1.0, 2.0], &[[DVec3::ZERO; 4]], TimeBase::Absolute)?),
     "3 knots need 2 segments, not 1"),
    (|| done(Trajectory::from_positions(&[(0.0, DVec3::ZERO)])?),
     "a trajectory needs at least two states or waypoints, not 1 (Trajectory::coasting takes one)"),
    (|| done(Trajectory::from_bezier(&[0.0, 1.0, 2.0], &[[DVec3::ZERO; 4], [DVec3::X; 4]])?),
     "knot 1: the curve before it ends 1.0 m from where the curve after it begins: give both the same point"),
    (|| done(Trajectory::coasting(State::new(0.0, DVec3::ZERO, 1e301 * DVec3::X))?),
     "knot 0: velocity x reaches 1e301, beyond ±1e300: check the units"),
    (|| done(Trajectory::group_rows([(1, state(0.0, 0.0)), (2, state(0.0, 0.0)), (1, state(1.0, 0.0))])?),
     "body 1: row 2: the body appeared before, and others since: sort the rows by body, then by time"),
    (|| done(Trajectory::group_rows([(1, state(0.0, 0.0)), (1, state(1.0, 0.0)), (8, state(0.0, 0.0))])?),
     "body 8: a trajectory needs at least two states or waypoints, not 1 (Trajectory::coasting takes one)"),
    (|| done(flying().simplified(0.0)?), "tolerance 0.0 m is not a positive number up to 1e300"),
    (|| done(flying().spliced(20.0, &flying())?),
     "the plan so far does not exist at 20.0 s: it is from 0.0 s to 10.0 s; set the trajectory as a whole instead \
      (set_trajectory)"),
    (|| done(flying().spliced(1e301, &flying())?), "a plan or an orientation cannot change at 1e301 s: give a time within ±1e300"),
    (|| done(flying().spliced(f64::NAN, &flying())?), "a plan or an orientation cannot change at NaN s: give a time within ±1e300"),
    (|| fit(|t| (t.sin() * DVec3::X, 60.0 * t.cos() * DVec3::X), window(0.0, 9.0), 0.01),
     "the motion at 0.3521844789475136 s: velocity x is 56.317285143914546 m/s, but the position changes by \
      0.9386214190645441 m/s: give the derivative of the position, or a larger tolerance"),
    (|| done(Trajectory::fit_polynomials::<8>(&[], &[], TimeBase::SegmentLocal, 0.1)?),
     "a trajectory needs at least two states or waypoints, not 0 (Trajectory::coasting takes one)"),
    (|| fit(straight, window(0.0, 1.0), 0.0), "tolerance 0.0 m is not a positive number up to 1e300"),
    (|| fit(straight, window(0.0, 1.0), -0.01), "tolerance -0.01 m is not a positive number up to 1e300"),
    (|| fit(|t| (t.ln() * DVec3::X, DVec3::X / t), window(0.0, 9.0), 0.1),
     "the motion at 0.0 s: position x is -inf, not a number within ±1e300"),
    (|| fit(straight, window(1.0, 1.0), 0.1),
     "a motion cannot be fitted over 1.0..1.0 s: give a window with two different, finite ends"),
    (|| fit(straight, Window::ALL, 0.1),
     "a motion cannot be fitted over -inf..inf s: give a window with two different, finite ends"),
    (|| fit(|t| ((t - 5.0).sqrt() * DVec3::X, DVec3::X), window(0.0, 9.0), 0.1),
     "the motion at 0.0 s: position x is NaN, not a number within ±1e300"),
    (|| fit(|t| (if t < 5.0 { DVec3::ZERO } else { DVec3::X }, DVec3::ZERO), window(0.0, 8.0), 0.1),
     "from 4.999999999999999 s on no cubic follows the motion within 0.1 m, only within 1.2467885679966522 m: the \
      tolerance is below the rounding, or the position jumps"),
    (|| done(Trajectory::fit_with(straight, window(0.0, 9.0), 0.1, &FitOptions::default().with_fourth_derivative(-1.0))?),
     "fit: the bound of the fourth derivative is -1.0, not a finite number of at least 0"),
];

fn tetrahedron(corner: Vec3) -> Result<TriMesh, Box<dyn Error>> {
    let faces = vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]];
    Ok(TriMesh::new(
        vec![corner, Vec3::X, Vec3::Y, Vec3::Z],
        faces,
    )?)
}

#[rustfmt::skip]
const BODIES: &[(Attempt, &str)] = &[
    (|| done(Hitbox::half_space(DVec3::ZERO)?),
     "the normal of the half-space has the length 0.0, not 1: give a unit vector, normalised in f64"),
    (|| done(Hitbox::sphere(f64::NAN)?), "sphere 0: radius NaN m is not a number from 0 to 1e300"),
    (|| done(Hitbox::half_space(DVec3::new(1.0, 1.0, 0.0))?),
     "the normal of the half-space has the length 1.4142135623730951, not 1: give a unit vector, normalised in f64"),
    (|| done(Orientation::slerp(&[(0.0, DQuat::from_xyzw(0.0, 0.0, 90.0, 0.0)), (1.0, DQuat::IDENTITY)])?),
     "knot 0: the quaternion of the rotation has the length 90.0, not 1: normalise it in f64"),
    (|| done(Orientation::spin(0.0, DQuat::IDENTITY, f64::NAN * DVec3::Y)?),
     "knot 0: angular velocity x is NaN, not a finite number"),
    (|| done(Hitbox::half_space(Vec3::new(0.6, 0.8, 0.0))?),
     "the normal of the half-space has the length 1.000000023841858, not 1: give a unit vector, normalised in f64"),
    (|| {
        let spin = Orientation::spin(0.0, DQuat::IDENTITY, DVec3::Y)?;
        done(Scene::new().insert(body().with_hitbox(Hitbox::half_space(DVec3::X)?).with_orientation(spin))?)
    }, "body 4: a half-space cannot turn: leave its orientation fixed, or give the body spheres"),
    (|| done(body().with_model_error(-1.0)?), "body 4: model error -1.0 m is not a number from 0 to 1e300"),
    (|| done(SphereCover::fit(&tetrahedron(Vec3::NAN)?, &CoverOptions::new(4))?),
     "the triangle mesh has no points, or a number that is not finite, or a negative length"),
    (|| done(SphereCover::fit(&Cuboid::new([-1.0, 1.0, 1.0].into()), &CoverOptions::new(4))?),
     "the cuboid has no points, or a number that is not finite, or a negative length"),
    (|| done(SphereCover::fit(&Ball::new(1.0), &CoverOptions::new(9).with_target_overshoot(-1.0))?),
     "a target overshoot of -1.0 m is not a finite number of at least 0"),
    (|| done(SphereCover::fit(&Cuboid::new(Vec3::ONE), &CoverOptions::new(3).with_target_overshoot(1e-9))?),
     "no cover found reaches out by at most 1e-9 m: the best one, of 1 sphere, by 0.7320508140502842 m; allow more \
      spheres or a larger target"),
    (|| done(SphereCover::fit(&Segment::new(Vec3::ZERO, Vec3::X), &CoverOptions::new(3))?),
     "a segment cannot be covered with spheres: give a solid, a compound of solids, or a triangle mesh"),
    (|| done(verify_cover(&[], &Ball::new(1.0))?), "a cluster needs at least one sphere"),
    (|| done(Hitbox::cluster(vec![Sphere { offset: DVec3::ZERO, radius: -0.1 }])?),
     "sphere 0: radius -0.1 m is not a number from 0 to 1e300"),
    (|| done(Orientation::slerp(&[(1.0, DQuat::IDENTITY), (0.0, DQuat::IDENTITY)])?),
     "knot 1: time 0.0 s is not later than the knot before it, 1.0 s: sort by time, and keep one knot for each instant (of a B-spline at most four)"),
    (|| done(Orientation::spin(0.0, DQuat::IDENTITY, DVec3::Z)?.with_tolerance(0.0)?),
     "tolerance 0.0 is not a number within 1e-9..=0.1"),
];

#[rustfmt::skip]
const QUESTIONS: &[(Attempt, &str)] = &[
    (|| done(Scene::new().screen(&Query::default().with_margin(f64::INFINITY))?),
     "margin inf m is not a number within ±1e300"),
    (|| {
        let mut scene = Scene::new();
        scene.insert(body())?;
        scene.insert(body())?;
        done(scene.screen(&Query::default().with_max_spans(0))?)
    }, "too many pairs may be in conflict (with room for 0 of their spans; body 0v0 (tag 4) comes near 1 other, to most \
        at 0.0 s): narrow the window (the lookahead) or the margin, leave pairs out (layers, ignored pairs), or raise the limit (max_spans); \
        in a monitor, each two spheres and each turn of clusters have spans of their own, and skip_to goes on"),
    (|| {
        let rests = Body::new(Trajectory::at_rest(DVec3::ZERO)?);
        done(Scene::new().conflicts_with(&rests, &Query::default())?)
    }, "no body has a plan that says which time to look at: name a window, with Query::new"),
    (|| {
        let coasts = Body::new(flying().with_outside(Outside::Coast)).with_tag(3);
        done(pair::closest_approach(&coasts, &coasts, Window::ALL)?)
    }, "body 3 exists beyond its knots: close the window on both sides, with Window::new"),
    (|| {
        let mut scene = Scene::new();
        let id = scene.insert(body())?;
        done(scene.closest_approach(id, id, Window::ALL)?)
    }, "body 0v0 cannot be paired with itself: name two bodies"),
    (|| {
        let mut scene = Scene::new();
        scene.insert(Body::new(Trajectory::coasting(state(0.0, 0.0))?))?;
        done(scene.screen(&Query::new(Window::ALL))?)
    }, "body 0v0 exists beyond its knots: close the window on both sides, with Window::new"),
    (|| done(Window::new(f64::NAN, 1.0)?),
     "window NaN..1.0 s: no instant lies between them; name the earlier time first"),
];

#[rustfmt::skip]
const MONITORS: &[(Attempt, &str)] = &[
    (|| done(Monitor::new(Scene::new(), f64::NAN, 5.0, &[AlertLevel::at(1.0)])?),
     "the clock cannot show NaN s: not within ±1e300, or too far from 0 for the lookahead"),
    (|| done(Monitor::new(Scene::new(), 0.0, f64::INFINITY, &[AlertLevel::at(1.0)])?),
     "inf s is not a usable lookahead: give a positive number up to 1e300; if it is lost in the rounding of the clock, \
      count time from an epoch near your data"),
    // Nanoseconds since 1970.
    (|| done(Monitor::new(Scene::new(), 1.79e18, 2.0, &[AlertLevel::at(1.0)])?),
     "2.0 s is not a usable lookahead: give a positive number up to 1e300; if it is lost in the rounding of the clock, \
      count time from an epoch near your data"),
    // A release that is counted from the margin.
    (|| done(Monitor::new(Scene::new(), 0.0, 2.0, &[AlertLevel::at(20.0).with_release(1.0)])?),
     "alert level 0: margin 20.0 m, release 1.0 m: an encounter begins at the margin and ends beyond the release, so give \
      a release of at least the margin, both within ±1e300"),
    (|| {
        let mut scene = Scene::new();
        let ids = [body(), body(), body()].map(|one| scene.insert(one).unwrap());
        done(monitor().0.replan(ids[2], 2.0, flying())?)
    }, "body 2v0 is not in the scene: it was removed, or the id is of another scene"),
    (|| {
        let (mut monitor, id) = monitor();
        monitor.advance(11.0, &mut Vec::new())?;
        done(monitor.track(12.0, [(id, state(12.0, 0.0))])?)
    }, "body 0v0 (tag 4): the plan so far does not exist at 12.0 s: it is from 0.0 s to 10.0 s; set the trajectory as a \
        whole instead (set_trajectory)"),
    (|| {
        let (mut monitor, id) = monitor();
        monitor.advance(11.0, &mut Vec::new())?;
        done(monitor.replan(id, 12.0, Trajectory::from_states(&[state(12.0, 0.0), state(20.0, 9.0)])?)?)
    }, "body 0v0 (tag 4): the plan so far does not exist at 12.0 s: it is from 0.0 s to 10.0 s; set the trajectory as a \
        whole instead (set_trajectory)"),
    (|| done(monitor().0.advance(f64::INFINITY, &mut Vec::new())?),
     "the clock cannot show inf s: not within ±1e300, or too far from 0 for the lookahead"),
    (|| done(monitor().0.track(f64::NAN, [] as [(BodyId, State); 0])?),
     "the clock cannot show NaN s: not within ±1e300, or too far from 0 for the lookahead"),
    (|| {
        let (mut monitor, id) = monitor();
        done(monitor.replan(id, f64::NAN, flying())?)
    }, "body 0v0 (tag 4): a plan or an orientation cannot change at NaN s: give a time within ±1e300"),
    (|| {
        let (mut monitor, id) = monitor();
        done(monitor.orient(id, f64::INFINITY, Orientation::FIXED)?)
    }, "body 0v0 (tag 4): a plan or an orientation cannot change at inf s: give a time within ±1e300"),
    (|| {
        let (mut monitor, id) = monitor();
        done(monitor.track(1.0, [(id, state(1.0, f64::NAN))])?)
    }, "body 0v0 (tag 4): knot 0: position x is NaN, not a finite number"),
    (|| {
        let (mut monitor, id) = monitor();
        let rotation = Quat::from_xyzw(0.5, 0.5, 0.5, 0.5001).as_dquat();
        done(monitor.track(1.0, [(id, BodyState::from(state(1.0, 0.0)).with_spin(rotation, DVec3::Z))])?)
    }, "body 0v0 (tag 4): knot 0: the quaternion of the rotation has the length 1.0000500120480236, not 1: normalise it in f64"),
    (|| {
        let (mut monitor, id) = monitor();
        monitor.remove(id)?;
        done(monitor.track(1.0, [(id, state(1.0, 0.0))])?)
    }, "body 0v0 is not in the scene: it was removed, or the id is of another scene"),
    (|| {
        let (mut monitor, id) = monitor();
        let late = Trajectory::from_states(&[state(12.0, 0.0), state(13.0, 0.0)])?;
        done(monitor.extend(id, late)?)
    }, "body 0v0 (tag 4): the new plan does not go on from 10.0 s: it is from 12.0 s to 13.0 s; give one that begins by then \
        and ends later"),
    (|| {
        let (monitor, id) = monitor();
        done(monitor.what_if(id, &flying(), 0)?)
    }, "the monitor knows nothing of the time ahead: its clock shows 1.0 s, and all is known up to 1.0 s; advance it first, \
        until complete_until is after the clock"),
    (|| {
        let (monitor, id) = monitor();
        done(monitor.what_if(id, &flying(), 5)?)
    }, "there is no alert level 5: levels count from 0, in the order given to Monitor::new"),
    (|| done(monitor().0.set_history(-1.0)?), "history: -1.0 is not a number of at least 0"),
    (|| {
        let threshold = RevisionThreshold::default().with_time(-1.0).with_separation(0.0);
        done(monitor().0.set_revision_threshold(threshold)?)
    }, "revision threshold, time: -1.0 is not a number of at least 0"),
    (|| {
        let threshold = RevisionThreshold::default().with_time(0.0).with_separation(f64::NAN);
        done(monitor().0.set_revision_threshold(threshold)?)
    }, "revision threshold, separation: NaN is not a number of at least 0"),
];

#[test]
fn each_is_answered_by_one_sentence() {
    let mut wrong = Vec::new();
    let all = [CURVES, BODIES, QUESTIONS, MONITORS].concat();
    for (attempt, sentence) in &all {
        let said = attempt().map_or_else(|error| error.to_string(), |()| "nothing".to_owned());
        if said != *sentence {
            wrong.push(format!("expected {sentence}\nfound    {said}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert!(all.len() >= 40, "{}", all.len());
}
