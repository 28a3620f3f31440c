//! Beads on rods, and next to no motion.

use super::*;

/// Returns a case of two clusters within a second; each body has a place and a velocity at its begin and end.
fn case(
    motions: [[(DVec3, DVec3); 2]; 2],
    clusters: [Vec<(DVec3, f64)>; 2],
    (margin, model_error): (f64, f64),
) -> Case {
    let plan = |[begin, end]: [(DVec3, DVec3); 2]| {
        let states = [
            State::new(0.0, begin.0, begin.1),
            State::new(1.0, end.0, end.1),
        ];
        let plan = Trajectory::from_states(&states);
        Pieces::own(&plan.unwrap_or_else(|_| unreachable!()))
    };
    let hitbox = |spheres: Vec<(DVec3, f64)>| {
        let spheres = spheres.into_iter();
        let spheres = spheres.map(|(offset, radius)| Sphere { offset, radius });
        Hitbox::cluster(spheres.collect()).unwrap_or_else(|_| unreachable!())
    };
    Case {
        bodies: resting(motions.map(plan), clusters.map(hitbox), [model_error; 2]),
        margin,
        window: (0.0, 1.0),
        start: 0.0,
        end: 1.0,
    }
}

/// Many contacts in one span, as of beads on a rod flown along it, and nearly no motion.
#[test]
fn rods_and_next_to_no_motion() {
    let line = |velocity: DVec3| [0.0, 1.0].map(|time| (velocity * time, velocity));
    let beads = (1..=60).map(|bead| (DVec3::X * (4.0 * f64::from(bead)), 0.5));
    let pair = vec![(DVec3::ZERO, 0.75), (DVec3::X * -50.0, 0.75)];
    let other = vec![(DVec3::X, 0.75), (DVec3::X * 51.0, 0.75)];
    let three = vec![(DVec3::ZERO, 0.2), (DVec3::Y * 9.0, 0.2)];
    for (clusters, velocity, contacts_of_all) in [
        ([three.clone(), beads.collect()], DVec3::X * 300.0, 60),
        ([other.clone(), pair.clone()], DVec3::Y * 1e-155, 1),
        (
            [[other, three].concat(), [pair.clone(), pair].concat()],
            DVec3::Y * 1e-155,
            1,
        ),
    ] {
        let case = case([line(velocity), line(DVec3::ZERO)], clusters, (0.0, 0.0));
        assert_eq!(case.contacts(case.window).len(), contacts_of_all);
    }
}

/// A sphere flies out and back: between two others it is nearest to the farther one in the middle, where
/// the ends of its way do not show that.
#[test]
fn nearest_between_the_ends_of_a_way() {
    let others = (0..8).map(|number| DVec3::Y * (50.0 + f64::from(number)));
    let ends = [-10.0, 10.5].map(|x| x * DVec3::X);
    let of_radius_one = |place: DVec3| (place, 1.0);
    let clusters = [
        vec![of_radius_one(DVec3::ZERO)],
        ends.into_iter().chain(others).map(of_radius_one).collect(),
    ];
    let motions = [1.2, 0.0]
        .map(|speed| [0.0, 1.0].map(|time| (DVec3::ZERO, DVec3::X * (speed * (1.0 - 2.0 * time)))));
    let mut case = case(motions, clusters, (8.26, 0.0));
    for _ in 0..2 {
        let found = kept_contacts(&case.kept(&[case.margin], None), case.margin, case.window);
        let times: Vec<(f64, f64)> = found.iter().map(|one| (one.enter, one.exit)).collect();
        assert_eq!(times, [(0.0, 1.0)]);
        // And the other way round.
        case.bodies.reverse();
    }
}

/// With model errors, spheres that are not the nearest ones on the splines may be so in the world.
#[test]
fn what_model_errors_leave_open_is_listed() {
    let others = (0..8).map(|number| DVec3::Z * (50.0 + f64::from(number)));
    let near = [DVec3::new(-6.0, 2.0, 0.0), DVec3::new(6.0, 2.75, 0.0)];
    let of_radius_half = |place: DVec3| (place, 0.5);
    let clusters = [
        vec![of_radius_half(DVec3::ZERO)],
        near.into_iter().chain(others).map(of_radius_half).collect(),
    ];
    let motions = [20.0, 0.0].map(|speed| {
        let velocity = DVec3::X * speed;
        [0.0, 1.0].map(|time| (velocity * (time - 0.5), velocity))
    });
    let case = case(motions, clusters, (0.0, 0.25));
    let [a, b] = &case.views();
    let found = certified_approach(a, b, case.spans().into_iter(), case.window);
    let (_, _, time) = found.unwrap_or_else(|| unreachable!());
    assert!(time.earliest < 0.2 && time.latest > 0.8, "{time:?}");
}
