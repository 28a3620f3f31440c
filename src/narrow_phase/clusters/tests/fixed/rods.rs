//! Beads on rods, and next to no motion.

use super::*;

/// Many contacts in one span, as of beads on a rod flown along it, and nearly no motion.
#[test]
fn rods_and_next_to_no_motion() {
    let hitbox = |spheres: Vec<(DVec3, f64)>| {
        let spheres = spheres.into_iter();
        let spheres = spheres.map(|(offset, radius)| Sphere { offset, radius });
        Hitbox::cluster(spheres.collect()).unwrap_or_else(|_| unreachable!())
    };
    let line = |velocity: DVec3| {
        let states = [0.0, 1.0].map(|time| State::new(time, velocity * time, velocity));
        Trajectory::from_states(&states).unwrap_or_else(|_| unreachable!())
    };
    let beads = (1..=60).map(|bead| (DVec3::X * (4.0 * f64::from(bead)), 0.5));
    let pair = vec![(DVec3::ZERO, 0.75), (DVec3::X * -50.0, 0.75)];
    let other = vec![(DVec3::X, 0.75), (DVec3::X * 51.0, 0.75)];
    let three = vec![(DVec3::ZERO, 0.2), (DVec3::Y * 9.0, 0.2)];
    for (hitboxes, velocity, contacts_of_all) in [
        ([three.clone(), beads.collect()], DVec3::X * 300.0, 60),
        ([other.clone(), pair.clone()], DVec3::Y * 1e-155, 1),
        (
            [[other, three].concat(), [pair.clone(), pair].concat()],
            DVec3::Y * 1e-155,
            1,
        ),
    ] {
        let case = Case {
            plans: [line(velocity), line(DVec3::ZERO)].map(|plan| Pieces::own(&plan)),
            hitboxes: hitboxes.map(hitbox),
            margin: 0.0,
            model_errors: [0.0; 2],
            window: (0.0, 1.0),
            start: 0.0,
            end: 1.0,
        };
        let [a, b] = &case.views();
        let mut found = Vec::new();
        contacts(a, b, case.spans().into_iter(), 0.0, case.window, &mut found);
        assert_eq!(found.len(), contacts_of_all);
    }
}

/// A sphere flies out and back: between two others it is nearest to the farther one in the middle, where
/// the ends of its way do not show that.
#[test]
fn nearest_between_the_ends_of_a_way() {
    let cluster = |places: Vec<DVec3>| {
        let radius = 1.0;
        let spheres = places.into_iter().map(|offset| Sphere { offset, radius });
        Hitbox::cluster(spheres.collect()).unwrap_or_else(|_| unreachable!())
    };
    let others = (0..8).map(|number| DVec3::Y * (50.0 + f64::from(number)));
    let ends = [-10.0, 10.5].map(|x| x * DVec3::X);
    let hitboxes = [
        cluster(vec![DVec3::ZERO]),
        cluster(ends.into_iter().chain(others).collect()),
    ];
    let plans = [1.2, 0.0].map(|speed| {
        let states = [0.0, 1.0].map(|time| {
            let velocity = DVec3::X * (speed * (1.0 - 2.0 * time));
            State::new(time, DVec3::ZERO, velocity)
        });
        let plan = Trajectory::from_states(&states);
        Pieces::own(&plan.unwrap_or_else(|_| unreachable!()))
    });
    let case = Case {
        plans,
        hitboxes,
        margin: 8.26,
        model_errors: [0.0; 2],
        window: (0.0, 1.0),
        start: 0.0,
        end: 1.0,
    };
    let [a, b] = &case.views();
    for (a, b) in [(a, b), (b, a)] {
        let (mut kept, mut found) = (Vec::new(), Vec::new());
        for span in case.spans() {
            let whole = ((f64::MIN, f64::MAX), f64::NEG_INFINITY);
            solve(a, b, span, case.margin, whole, |_, solved| {
                kept.push(solved)
            });
        }
        contacts_of(kept.iter(), case.margin, case.window, &mut found);
        let times: Vec<(f64, f64)> = found.iter().map(|one| (one.enter, one.exit)).collect();
        assert_eq!(times, [(0.0, 1.0)]);
    }
}

/// With model errors, spheres that are not the nearest ones on the splines may be so in the world.
#[test]
fn what_model_errors_leave_open_is_listed() {
    let cluster = |places: Vec<DVec3>| {
        let radius = 0.5;
        let spheres = places.into_iter().map(|offset| Sphere { offset, radius });
        Hitbox::cluster(spheres.collect()).unwrap_or_else(|_| unreachable!())
    };
    let others = (0..8).map(|number| DVec3::Z * (50.0 + f64::from(number)));
    let near = [DVec3::new(-6.0, 2.0, 0.0), DVec3::new(6.0, 2.75, 0.0)];
    let plans = [20.0, 0.0].map(|speed| {
        let states = [0.0, 1.0].map(|time| {
            let velocity = DVec3::X * speed;
            State::new(time, velocity * (time - 0.5), velocity)
        });
        let plan = Trajectory::from_states(&states);
        Pieces::own(&plan.unwrap_or_else(|_| unreachable!()))
    });
    let case = Case {
        plans,
        hitboxes: [
            cluster(vec![DVec3::ZERO]),
            cluster(near.into_iter().chain(others).collect()),
        ],
        margin: 0.0,
        model_errors: [0.25; 2],
        window: (0.0, 1.0),
        start: 0.0,
        end: 1.0,
    };
    let [a, b] = &case.views();
    let found = certified_approach(a, b, case.spans().into_iter(), case.window);
    let (_, _, time) = found.unwrap_or_else(|| unreachable!());
    assert!(time.earliest < 0.2 && time.latest > 0.8, "{time:?}");
}
