//! Islands: groups of bodies with empty space between them, as about planets or in fleets. A search looks at each in a frame of
//! its own. What it costs is counted, not timed.

#![allow(
    clippy::unwrap_used,
    reason = "a scene that cannot be built fails the test"
)]

mod support;

use nearmiss::glam::DVec3;
use nearmiss::{
    AlertLevel, Body, BodyId, Conflict, Hitbox, Monitor, Query, Scene, State, Stats, Trajectory,
    Window,
};
use support::{rng, vector};

const ISLANDS: u64 = 5;
const BODIES: u64 = 1_200;
const LOOKAHEAD: f64 = 2.0;
const MARGIN: f64 = 0.1;

/// Returns the bodies of an island, tagged by number: in a cube, at a place (m), most of them with a common velocity (m/s).
fn island(number: u64, (place, velocity): (DVec3, DVec3), is_planned: bool) -> Vec<Body> {
    let mut rng = rng(number);
    (0..BODIES)
        .map(|body| {
            let position = place + vector(&mut rng, 50.0);
            let own = if body % 50 == 0 {
                DVec3::ZERO
            } else {
                velocity
            };
            let velocity = own + vector(&mut rng, 3.0);
            let start = State::new(0.0, position, velocity);
            let plan = if is_planned {
                let end = position + LOOKAHEAD * velocity + vector(&mut rng, 1.0);
                Trajectory::from_states(&[start, State::new(LOOKAHEAD, end, velocity)])
            } else {
                Trajectory::coasting(start)
            };
            Body::new(plan.unwrap())
                .with_hitbox(Hitbox::sphere(0.5).unwrap())
                .with_tag(number * BODIES + body)
        })
        .collect()
}

fn scene(bodies: impl IntoIterator<Item = Body>) -> Scene {
    let mut scene = Scene::new();
    for body in bodies {
        scene.insert(body).unwrap();
    }
    scene
}

fn query() -> Query {
    Query::new(Window::new(0.0, LOOKAHEAD).unwrap()).with_margin(MARGIN)
}

/// Returns what does not depend on the other bodies of a scene, in the order of tags.
fn sorted(conflicts: &[Conflict]) -> Vec<String> {
    let mut conflicts: Vec<_> = conflicts.iter().collect();
    conflicts.sort_by_key(|one| (one.tag_a, one.tag_b));
    let told = |one: &&Conflict| {
        let Conflict {
            tag_a,
            tag_b,
            enter,
            exit,
            closest,
            ..
        } = one;
        format!("{tag_a} {tag_b} {enter:?} {exit:?} {closest:?}")
    };
    conflicts.iter().map(told).collect()
}

/// A scene of islands has the conflicts of a scene for each of them, to the bit, and costs little more.
#[test]
fn islands_cost_what_each_costs_alone() {
    let cost = |stats: &Stats| stats.boxes + stats.candidates + stats.spans;
    for (far, speed) in [(1e5, 2_000.0), (1e8, 1e-9), (1e10, 7_000.0), (1e13, 1.0)] {
        for is_planned in [false, true] {
            let mut places = rng(7);
            let islands: Vec<Vec<Body>> = (0..ISLANDS)
                .map(|number| {
                    let course = (vector(&mut places, far), vector(&mut places, speed));
                    island(number, course, is_planned)
                })
                .collect();
            let (mut alone, mut cost_alone) = (Vec::new(), 0);
            for bodies in &islands {
                let screening = scene(bodies.clone()).screen(&query()).unwrap();
                alone.extend(screening.conflicts);
                cost_alone += cost(&screening.stats);
            }
            let all = scene(islands.into_iter().flatten());
            let screening = all.screen(&query()).unwrap();
            assert!(alone.len() > 30, "{}", alone.len());
            assert_eq!(sorted(&screening.conflicts), sorted(&alone), "{far}");
            let all_cost = cost(&screening.stats);
            assert!(all_cost < 4 * cost_alone, "{all_cost} {cost_alone} {far}");

            let levels = [AlertLevel::at(MARGIN)];
            let mut monitor = Monitor::new(all, 0.0, LOOKAHEAD, &levels).unwrap();
            monitor.advance(0.0, &mut Vec::new()).unwrap();
            assert_eq!(
                sorted(monitor.conflicts(0).unwrap()),
                sorted(&alone),
                "{far}"
            );
            let states = monitor.scene().bodies().map(|(id, body)| {
                let state = body.trajectory.state(0.1).unwrap();
                (id, state)
            });
            let states: Vec<(BodyId, State)> = states.collect();
            for frame in 0..3 {
                let now = 0.1 + 0.01 * f64::from(frame);
                monitor.track(now, states.iter().copied()).unwrap();
                monitor.advance(now, &mut Vec::new()).unwrap();
            }
            let told_cost = cost(monitor.stats());
            assert!(told_cost < 8 * cost_alone, "{told_cost} {cost_alone} {far}");
        }
    }
}
