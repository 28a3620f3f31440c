//! Values that a user makes, reads back and prints.

#![allow(
    clippy::unwrap_used,
    clippy::float_cmp,
    reason = "what was set is what is read; a plan that cannot be built fails the test"
)]

mod support;

use nearmiss::glam::{DVec3, Vec3};
use nearmiss::{
    Accuracy, AlertLevel, Body, BodyId, EncounterId, Error, Event, EventKind, FitOptions, Monitor,
    Outside, PositionOptions, Query, RevisionThreshold, Scene, Sphere, State, Stats, Trajectory,
    Window,
};
use std::error::Error as _;

#[test]
fn states_from_what_a_program_has() {
    let state = State::new(1.0, DVec3::new(0.5, 2.0, -3.0), DVec3::X);
    assert_eq!(State::new(1.0, [0.5, 2.0, -3.0], [1.0, 0.0, 0.0]), state);
    assert_eq!(State::new(1.0, (0.5, 2.0, -3.0), (1.0, 0.0, 0.0)), state);
    assert_eq!(State::new(1.0, Vec3::new(0.5, 2.0, -3.0), Vec3::X), state);
    // Each f32 is taken exactly, not by its decimals.
    let tenth = State::new(0.0, Vec3::splat(0.1), Vec3::ZERO);
    assert_eq!(tenth.position, DVec3::splat(f64::from(0.1_f32)));
}

/// The state is what position and velocity are, and there is one where they are.
#[test]
fn a_state_of_a_trajectory() {
    let states = support::wander(&mut support::rng(4), 0.0, 6, 1.5, 20.0, 5.0);
    let plan = Trajectory::from_states(&states).unwrap();
    let last = plan.knots()[plan.knots().len() - 1];
    for outside in [Outside::Absent, Outside::Coast, Outside::Extrapolate] {
        let plan = plan.clone().with_outside(outside);
        for state in &states {
            let found = plan.state(state.time).unwrap();
            assert_eq!((found.time, found.position), (state.time, state.position));
            // A velocity is good to some roundings.
            assert!(found.velocity.distance(state.velocity) < 1e-14);
        }
        for step in -10..40 {
            let time = 0.25 * f64::from(step);
            let state = plan.state(time);
            let exists = outside != Outside::Absent || (0.0..=last).contains(&time);
            assert_eq!(state.is_some(), exists, "{time} {outside:?}");
            assert_eq!(state.map(|it| it.position), plan.position(time));
            assert_eq!(state.map(|it| it.velocity), plan.velocity(time));
            assert!(state.is_none_or(|it| it.time == time));
        }
        for time in [f64::NAN, f64::INFINITY] {
            assert_eq!(plan.state(time), None);
        }
    }
}

/// Tags say whose conflict or event it is, also when the body is gone.
#[test]
fn tags_in_what_is_reported() -> Result<(), Error> {
    let mut scene = Scene::new();
    for ((_, body), tag) in passing()?.bodies().zip([70, 80]) {
        scene.insert(body.clone().with_tag(tag))?;
    }
    let conflict = scene.screen(&Query::default().with_margin(5.0))?.conflicts[0];
    assert_eq!((conflict.tag_a, conflict.tag_b), (70, 80));

    let ids: Vec<BodyId> = scene.bodies().map(|(id, _)| id).collect();
    let mut monitor = Monitor::new(scene, 0.0, 20.0, &[AlertLevel::at(5.0)])?;
    let mut events = Vec::new();
    monitor.advance(7.0, &mut events)?;
    let asked = monitor.what_if(
        ids[1],
        &monitor.scene().body(ids[1]).unwrap().trajectory.clone(),
        0,
    )?;
    assert_eq!((asked[0].tag_a, asked[0].tag_b), (70, 80));
    assert_eq!(monitor.conflicts(0)?[0].tag_b, 80);
    let encounter = *monitor.encounters().next().unwrap();
    let stranger = BodyId::from_bits(ids[1].to_bits() + 1);
    for (id, tag) in [(ids[0], Some(80)), (ids[1], Some(70)), (stranger, None)] {
        assert_eq!(
            (conflict.other_tag(id), encounter.other_tag(id)),
            (tag, tag)
        );
    }
    monitor.remove(ids[1])?;
    monitor.advance(8.0, &mut events)?;
    let tags = |event: &Event| match event.kind {
        EventKind::PlanEnds { body, tag } => (body == ids[1]).then_some((tag, tag)),
        kind => kind.encounter().map(|it| (it.tag_a, it.tag_b)),
    };
    let tags: Vec<_> = events.iter().filter_map(tags).collect();
    // It has begun; its plan ends; it is over, since the body is gone.
    assert_eq!(tags, [(70, 80), (80, 80), (70, 80)]);
    Ok(())
}

/// Vectors of other libraries, through the crate `mint`.
#[cfg(feature = "mint")]
#[test]
fn states_from_vectors_of_other_libraries() {
    let position = mint::Vector3::from([0.5, 2.0, -3.0]);
    let velocity = mint::Vector3::from([1.0, 0.0, 0.0]);
    let state = State::new(1.0, DVec3::new(0.5, 2.0, -3.0), DVec3::X);
    assert_eq!(State::new(1.0, position, velocity), state);
    assert_eq!(mint::Vector3::from(state.position), position);
}

#[test]
fn what_a_monitor_was_told() -> Result<(), Error> {
    let levels = [AlertLevel::at(3.0), AlertLevel::at(1.0).with_release(2.0)];
    let mut scene = Scene::new();
    scene.insert(Body::new(Trajectory::at_rest(DVec3::ZERO)?))?;
    let mut monitor = Monitor::new(scene, 5.0, 7.5, &levels)?;
    assert_eq!((monitor.lookahead(), monitor.levels()), (7.5, &levels[..]));
    assert_eq!(monitor.max_spans(), Monitor::MAX_SPANS);
    let revision_threshold = RevisionThreshold::default()
        .with_time(0.25)
        .with_separation(0.5);
    monitor.set_history(3.0)?;
    monitor.set_max_spans(77);
    monitor.set_revision_threshold(revision_threshold)?;
    for tick in 0..3 {
        let told = (monitor.history(), monitor.max_spans());
        assert_eq!(told, (3.0, 77));
        assert_eq!(monitor.revision_threshold(), revision_threshold);
        monitor.advance(6.0 + f64::from(tick), &mut Vec::new())?;
    }
    assert_eq!((monitor.lookahead(), monitor.levels()), (7.5, &levels[..]));
    Ok(())
}

/// One passes the other 3 m off, at 1 m/s: closest at 10 s. Its plan ends at 12 s.
fn passing() -> Result<Scene, Error> {
    let mut scene = Scene::new();
    scene.insert(Body::new(Trajectory::at_rest(DVec3::ZERO)?))?;
    let flown = [0.0, 12.0].map(|t| State::new(t, [t - 10.0, 3.0, 0.0], [1.0, 0.0, 0.0]));
    scene.insert(Body::new(Trajectory::from_states(&flown)?))?;
    Ok(scene)
}

#[test]
fn windows_in_a_line() -> Result<(), Error> {
    let line = |start, end| Window::new(start, end).map(|window| window.to_string());
    assert_eq!(line(0.0, 60.0)?, "0.000..60.000 s");
    assert_eq!(line(f64::NEG_INFINITY, -2.5)?, "..-2.500 s");
    assert_eq!(line(1e-7, f64::INFINITY)?, "1.000e-7.. s");
    assert_eq!(Window::ALL.to_string(), ".. s");
    // No number takes a line of its own.
    assert_eq!(line(-1e300, 1e300)?, "-1.000e300..1.000e300 s");
    assert_eq!(format!("{:.1}", Window::new(0.25, 1.0)?), "0.2..1.0 s");
    Ok(())
}

#[test]
fn conflicts_and_stats_in_a_line() -> Result<(), Error> {
    let screening = passing()?.screen(&Query::default().with_margin(5.0))?;
    let conflict = screening.conflicts[0];
    assert_eq!(
        conflict.to_string(),
        "body 0v0 and body 1v0 from 6.000 s to 12.000 s, closest 3.000 m at 10.000 s, cut off at exit"
    );
    assert!(format!("{conflict:.1}").contains("closest 3.0 m at 10.0 s"));
    let certified = Query::default().with_accuracy(Accuracy::Certified);
    let certified = passing()?.screen(&certified.with_margin(5.0))?.conflicts[0].to_string();
    let parts = certified.split_once("closest 3.000 m at 10.000 s, ±");
    assert!(
        parts.is_some_and(|(_, error)| error.ends_with(" m of the splines, cut off at exit")),
        "{certified}"
    );
    let mut tagged = conflict;
    tagged.tag_a = 7;
    assert!(
        tagged
            .to_string()
            .starts_with("body 0v0 (tag 7) and body 1v0 from")
    );
    let line = screening.stats.to_string();
    assert!(line.starts_with("2 bodies, 0 changed, "), "{line}");
    assert!(
        line.contains(" 1 conflict, bounds ") && !line.contains('\n'),
        "{line}"
    );
    let none = "0 bodies, 0 changed, 0 segments, 0 slices, 0 boxes, 0 candidates, 0 spans, \
                0 survivors, 0 conflicts, bounds 0.0ns, broad phase 0.0ns, narrow phase 0.0ns, \
                total 0.0ns";
    assert_eq!(Stats::default().to_string(), none);
    Ok(())
}

#[test]
fn events_in_a_line() -> Result<(), Error> {
    let mut monitor = Monitor::new(passing()?, 0.0, 10.5, &[AlertLevel::at(5.0)])?;
    let mut events = Vec::new();
    for now in [0.0, 2.0, 7.0, 13.0] {
        monitor.advance(now, &mut events)?;
    }
    let lines: Vec<String> = events.iter().map(ToString::to_string).collect();
    let pair = "encounter 0, level 0: body 0v0 and body 1v0 from 6.000 s to";
    let closest = "closest 3.000 m at 10.000 s";
    assert_eq!(
        lines,
        [
            format!("at 0.000 s predicted: {pair} 10.500 s, {closest} so far"),
            format!("at 2.000 s revised: {pair} 12.000 s, {closest}"),
            "at 12.000 s the plan of body 1v0 ends".to_owned(),
            format!("at 6.000 s began: {pair} 12.000 s, {closest}"),
            format!("at 12.000 s ended (trajectory ended): {pair} 12.000 s, {closest}"),
        ]
    );
    assert!(format!("{:.0}", events[0]).ends_with("closest 3 m at 10 s so far"));
    Ok(())
}

#[test]
fn options_that_are_read_back() {
    let rule = PositionOptions::new();
    assert_eq!((rule.first_velocity(), rule.last_velocity()), (None, None));
    assert!(!rule.has_limited_velocities());
    let rule = rule.with_first_velocity([1.0, 2.0, 3.0]);
    let rule = rule.with_last_velocity(Vec3::X).with_limited_velocities();
    assert_eq!(rule.first_velocity(), Some(DVec3::new(1.0, 2.0, 3.0)));
    assert_eq!(rule.last_velocity(), Some(DVec3::X));
    assert!(rule.has_limited_velocities());

    let window = Window::new(2.0, 3.0).unwrap();
    let fit = FitOptions::default();
    assert_eq!((fit.ulps(), fit.max_knots()), (4.0, 1_000_000));
    assert_eq!(fit.fourth_derivative(window), None);
    let fit = fit.with_ulps(1.5).with_max_knots(9);
    assert_eq!((fit.ulps(), fit.max_knots()), (1.5, 9));
    let constant = fit.with_fourth_derivative(7.0);
    assert_eq!(constant.fourth_derivative(window), Some(7.0));
    let bound = |window: Window| window.start() + window.end();
    let by_window = fit.with_fourth_derivative_over(&bound);
    assert_eq!(by_window.fourth_derivative(window), Some(5.0));
}

#[test]
fn ids_as_numbers() -> Result<(), Error> {
    let mut scene = passing()?;
    let (first, _) = scene.bodies().next().unwrap();
    let body = scene.remove(first)?;
    let again = scene.insert(body)?;
    assert_eq!((first.to_bits(), again.to_bits()), (0, 1 << 32));
    for bits in [0, 1, u64::MAX, 0x0123_4567_89ab_cdef] {
        let id = BodyId::from_bits(bits);
        assert_eq!(id.to_bits(), bits);
        let halves = (u64::from(id.generation()), u64::from(id.slot()));
        assert_eq!(halves, (bits >> 32, bits & 0xffff_ffff));
        assert_eq!(EncounterId::from_bits(bits).to_bits(), bits);
    }
    // The number of a body that is gone, or never was, names none.
    for gone in [first.to_bits(), 77] {
        assert!(scene.body(BodyId::from_bits(gone)).is_none());
    }
    assert!(scene.body(BodyId::from_bits(again.to_bits())).is_some());
    Ok(())
}

/// An error that wraps one says which.
#[test]
fn sources_of_errors() {
    let inner = Error::Clock { time: 1.0 };
    assert!(inner.source().is_none());
    let outer = inner.clone().in_body(7);
    let source = outer.source().map(ToString::to_string);
    assert_eq!(source, Some(inner.to_string()));
    assert!(
        outer
            .source()
            .is_some_and(|source| source.source().is_none())
    );
}

#[test]
fn the_two_bodies_of_a_conflict() -> Result<(), Error> {
    let mut scene = passing()?;
    let third = scene.insert(Trajectory::at_rest([500.0, 0.0, 0.0])?.into())?;
    let ids: Vec<BodyId> = scene.bodies().map(|(id, _)| id).collect();
    let query = Query::default().with_margin(5.0);
    let window = Window::new(0.0, 8.0)?;
    let whole = scene.screen(&query)?;
    let early = scene.screen(&query.with_window(window))?;
    assert_eq!((early.window, window.duration()), (window, 8.0));
    assert_eq!((&whole).into_iter().count(), 1);
    let conflict = early.conflicts[0];
    assert_eq!((conflict.enter, conflict.duration()), (6.0, 2.0));
    let others = [ids[0], ids[1], third].map(|id| conflict.other(id));
    assert_eq!(others, [Some(ids[1]), Some(ids[0]), None]);

    let mut monitor = Monitor::new(scene, 0.0, 20.0, &[AlertLevel::at(5.0)])?;
    monitor.advance(0.0, &mut Vec::new())?;
    let encounter = *monitor.encounters().next().unwrap();
    let others = [ids[0], ids[1], third].map(|id| encounter.other(id));
    assert_eq!(others, [Some(ids[1]), Some(ids[0]), None]);
    Ok(())
}

/// Positions can be vectors, arrays or tuples, as those of states.
#[test]
fn positions_of_any_kind() -> Result<(), Error> {
    let corner = DVec3::new(3.0, 4.0, 0.0);
    let vectors = [(0.0, DVec3::ZERO), (5.0, corner), (6.0, corner)];
    let arrays = vectors.map(|(time, position)| (time, position.to_array()));
    let tuples = vectors.map(|(time, DVec3 { x, y, z })| (time, (x, y, z)));
    let legs = Trajectory::from_waypoints(&vectors)?;
    assert_eq!(Trajectory::from_waypoints(&arrays)?, legs);
    assert_eq!(Trajectory::from_waypoints(&tuples)?, legs);
    let curve = Trajectory::from_positions(&vectors)?;
    assert_eq!(Trajectory::from_positions(&arrays)?, curve);
    let points = [DVec3::ZERO, DVec3::X, corner, DVec3::Y];
    let plain = points.map(|point| point.to_array());
    let [one, other] = [
        Trajectory::from_bezier(&[0.0, 1.0], &[points])?,
        Trajectory::from_bezier(&[0.0, 1.0], &[plain])?,
    ];
    assert_eq!(one, other);
    let [one, other] = [
        Trajectory::from_uniform_b_spline(0.0, 1.0, &points)?,
        Trajectory::from_uniform_b_spline(0.0, 1.0, &plain)?,
    ];
    assert_eq!(one, other);
    assert_eq!(
        Sphere::new([1.0, 0.0, 0.0], 2.0),
        Sphere {
            offset: DVec3::X,
            radius: 2.0
        }
    );
    Ok(())
}

#[test]
fn a_long_plan_has_a_short_debug_text() -> Result<(), Error> {
    let positions: Vec<(f64, [f64; 3])> = (0..500)
        .map(|time| (f64::from(time), [f64::from(time), 0.0, 0.0]))
        .collect();
    let plan = Trajectory::from_positions(&positions)?;
    let text = format!("{plan:?}");
    assert_eq!(
        text,
        "Trajectory { knots: 500, first: Some(0.0), last: Some(499.0), before: Absent, after: Absent, .. }"
    );
    Ok(())
}
