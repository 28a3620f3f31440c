//! Missions of straight legs, and what rules for velocities make of them. The figures are on the page of
//! `Trajectory::from_positions`: `cargo test --test missions -- --nocapture` prints them.

#![allow(
    clippy::unwrap_used,
    reason = "a mission that cannot be built fails the test"
)]

mod support;

use nearmiss::glam::DVec3;
use nearmiss::{Body, Conflict, Error, Hitbox, PositionOptions, Query, Scene, Trajectory};
use rand::RngExt;
use support::rng;

type Waypoints = Vec<(f64, DVec3)>;

/// Deliveries of drones over a city, 4 km on a side: climb, cruise to a door, descend, wait, and back.
fn missions(count: u32) -> Vec<Waypoints> {
    let mut rng = rng(74);
    let depots: Vec<DVec3> = (0..12)
        .map(|_| support::vector(&mut rng, 2_000.0))
        .collect();
    let ground = |place: DVec3| DVec3::new(place.x, place.y, 0.0);
    let mission = |number: u32| {
        let depot = depots[number as usize % depots.len()];
        let pad = ground(depot + support::vector(&mut rng, 50.0));
        let door = ground(support::vector(&mut rng, 2_000.0));
        let height = DVec3::Z * 10.0 * f64::from(rng.random_range(6..11));
        let cruise = rng.random_range(11.0..17.0);
        let mut time = rng.random_range(0.0..900.0);
        let mut waypoints = vec![(time, pad)];
        let mut fly = |to: DVec3, speed: f64| {
            let (_, from) = waypoints[waypoints.len() - 1];
            time += from.distance(to) / speed;
            waypoints.push((time, to));
        };
        fly(pad + height, 4.0);
        fly(door + height, cruise);
        fly(door + 0.05 * height, 3.0);
        // Twenty seconds to set down the parcel, a tenth of a metre lower.
        fly(door + 0.05 * height - 0.1 * DVec3::Z, 0.005);
        fly(door + height, 4.0);
        fly(pad + height, cruise);
        fly(pad, 3.0);
        waypoints
    };
    (0..count).map(mission).collect()
}

fn conflicts(plans: &[Trajectory]) -> Vec<Conflict> {
    let mut scene = Scene::new();
    for plan in plans {
        let body = Body::new(plan.clone()).with_hitbox(Hitbox::sphere(0.5).unwrap());
        scene.insert(body).unwrap();
    }
    let query = Query::default().with_margin(8.0);
    scene.screen(&query).unwrap().conflicts
}

/// A rule's effect on missions.
#[derive(Debug)]
struct Effect {
    /// Median over missions of the largest distance from where the legs are at that time, m.
    median_stray: f64,
    /// Median over all missions and instants of that distance, m.
    usual_stray: f64,
    /// Share of the conflicts of straight legs that are found, at some common time.
    found: f64,
    /// Conflicts that straight legs do not have, for each one that they have.
    false_ones: f64,
}

fn effect(
    missions: &[Waypoints],
    rule: impl Fn(&Waypoints) -> Result<Trajectory, Error>,
) -> Effect {
    let legs = missions
        .iter()
        .map(|mission| Trajectory::from_waypoints(mission));
    let legs: Vec<Trajectory> = legs.map(Result::unwrap).collect();
    let plans: Vec<Trajectory> = missions
        .iter()
        .map(|mission| rule(mission).unwrap())
        .collect();
    let stray = |(legs, plan): (&Trajectory, &Trajectory)| {
        let (start, end) = (legs.domain().start(), legs.domain().end());
        let distance = |step: u32| {
            let time = start + (end - start) * f64::from(step) / 1000.0;
            let places = legs.position(time).zip(plan.position(time));
            places.map_or(0.0, |(a, b)| a.distance(b))
        };
        (0..1000).map(distance).collect::<Vec<f64>>()
    };
    let median = |mut values: Vec<f64>| {
        values.sort_by(f64::total_cmp);
        values[values.len() / 2]
    };
    let strays: Vec<Vec<f64>> = legs.iter().zip(&plans).map(stray).collect();
    let largest = strays
        .iter()
        .map(|of_one| of_one.iter().copied().fold(0.0, f64::max));
    let (true_ones, seen) = (conflicts(&legs), conflicts(&plans));
    let is_in = |one: &Conflict, others: &[Conflict]| {
        others.iter().any(|other| {
            (one.a, one.b) == (other.a, other.b)
                && one.enter <= other.exit
                && other.enter <= one.exit
        })
    };
    let share = |some: &[Conflict], others: &[Conflict]| {
        some.iter().filter(|one| is_in(one, others)).count() as f64 / true_ones.len() as f64
    };
    assert!(true_ones.len() > 300, "{}", true_ones.len());
    Effect {
        median_stray: median(largest.collect()),
        usual_stray: median(strays.concat()),
        found: share(&true_ones, &seen),
        false_ones: seen.len() as f64 / true_ones.len() as f64 - share(&seen, &true_ones),
    }
}

#[test]
fn a_spline_through_waypoints_is_another_mission() {
    let missions = missions(2_000);
    let limited = PositionOptions::new()
        .with_first_velocity(DVec3::ZERO)
        .with_last_velocity(DVec3::ZERO)
        .with_limited_velocities();
    let smooth = effect(&missions, |mission| Trajectory::from_positions(mission));
    let limited = effect(&missions, |mission| {
        Trajectory::from_positions_with(mission, &limited)
    });
    let legs = effect(&missions, |mission| Trajectory::from_waypoints(mission));
    println!("from_positions: {smooth:?}");
    println!("limited, from rest to rest: {limited:?}");
    println!("from_waypoints: {legs:?}");
    assert!(smooth.median_stray > 50.0 && smooth.usual_stray > 20.0 && smooth.found < 0.3);
    assert!(limited.median_stray < smooth.median_stray && limited.found > smooth.found);
    assert!(legs.median_stray < 1e-9);
    assert!(legs.found >= 1.0 && legs.false_ones <= 0.0);
}
