//! The generators of the examples' scenes are what their descriptions say.

#[path = "../examples/scenes/mod.rs"]
mod scenes;

use glam::DVec3;
use scenes::{Generated, Shape};

const SWARM: usize = 400;

fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0.0), |(sum, count), value| (sum + value, count + 1.0));
    sum / count
}

/// All bits of all states, in order.
fn fingerprint(generated: &Generated) -> u64 {
    let numbers = generated.actors.iter().flat_map(|actor| {
        actor.states.iter().flat_map(|state| {
            let [px, py, pz] = state.position.to_array();
            let [vx, vy, vz] = state.velocity.to_array();
            [state.time, px, py, pz, vx, vy, vz, actor.radius]
        })
    });
    // FNV-1a over the words.
    numbers.fold(0xcbf2_9ce4_8422_2325, |hash, number| {
        (hash ^ number.to_bits()).wrapping_mul(0x100_0000_01b3)
    })
}

fn every_scene(seed: u64) -> Vec<(&'static str, Generated)> {
    vec![
        ("cube", scenes::swarm(SWARM, Shape::Cube, seed)),
        ("clusters", scenes::swarm(SWARM, Shape::Clusters, seed)),
        ("flat", scenes::swarm(SWARM, Shape::Flat, seed)),
        ("fast few", scenes::swarm(SWARM, Shape::FastFew, seed)),
        ("satellites", scenes::satellites(300, seed)),
        ("flocks", scenes::flocks(300, seed)),
        ("drones", scenes::drones(300, seed)),
        ("asteroids", scenes::asteroids(300, seed)),
    ]
}

#[test]
fn the_seed_decides() {
    for ((name, one), ((_, same), (_, other))) in every_scene(5)
        .iter()
        .zip(every_scene(5).iter().zip(&every_scene(6)))
    {
        assert_eq!(fingerprint(one), fingerprint(same), "{name}");
        assert_ne!(fingerprint(one), fingerprint(other), "{name}");
        // Once one number served two axes, and every line was diagonal.
        for actor in &one.actors {
            let p = actor.states[actor.states.len() / 2].position;
            let distinct = p.x.to_bits() != p.y.to_bits() && p.y.to_bits() != p.z.to_bits();
            assert!(distinct, "{name}: {p}");
        }
    }
}

#[test]
fn as_many_bodies_as_asked_for() {
    for (name, generated) in every_scene(1) {
        let asked = match name {
            "cube" | "clusters" | "flat" | "fast few" => SWARM,
            _ => 300,
        };
        assert_eq!(generated.actors.len(), asked, "{name}");
    }
    assert_eq!(scenes::satellites(7, 1).actors.len(), 7);
    assert_eq!(scenes::flocks(61, 1).actors.len(), 61);
}

#[test]
fn velocities_agree_with_positions() {
    for (name, generated) in every_scene(2) {
        // Chord velocity against the mean of the velocities at its ends: equal for parabolas, off
        // by a share that the curvature explains for orbits, waves and stops.
        let tolerance = match name {
            "satellites" => 0.02,
            "flocks" => 0.3,
            "drones" => 0.75,
            _ => 0.01,
        };
        let off = mean(generated.actors.iter().flat_map(|actor| {
            actor.states.windows(2).map(|pair| {
                let chord = (pair[1].position - pair[0].position) / (pair[1].time - pair[0].time);
                let average = (pair[0].velocity + pair[1].velocity) / 2.0;
                (chord - average).length() / (chord.length() + average.length() + 1e-9)
            })
        }));
        assert!(off < tolerance, "{name}: {off}");
    }
}

#[test]
fn the_swarm_is_the_one_described() {
    let swarm = scenes::swarm(SWARM, Shape::Cube, 3);
    let side = 65.6 * 400_f64.cbrt();
    let speeds = swarm
        .actors
        .iter()
        .flat_map(|a| a.states.iter().map(|s| s.velocity.length()));
    // Root mean square 10 m/s: mean 10 sqrt(8 / 3π) = 9.21; 400 bodies know it to a few percent.
    assert!((mean(speeds) - 9.21).abs() < 0.4);
    for actor in &swarm.actors {
        assert_eq!(actor.states.len(), 33);
        assert!(actor.states[0].time.abs() < 1e-12);
        assert!((actor.states[32].time - 60.0).abs() < 1e-9);
        assert!(actor.states[0].position.abs().max_element() <= side / 2.0);
        for pair in actor.states.windows(2) {
            // Gaps 0.4..1.6, scaled to fill 60 s: the mean of 32 is within a third of 1.
            let gap = (pair[1].time - pair[0].time) * 32.0 / 60.0;
            assert!((0.3..2.4).contains(&gap), "{gap}");
        }
    }
    let first = swarm.actors.iter().map(|a| a.states[0].position);
    let centre: DVec3 = first.sum::<DVec3>() / 400.0;
    assert!(centre.length() < 0.1 * side);
}

#[test]
fn satellites_stay_in_their_shells() {
    for actor in scenes::satellites(300, 4).actors {
        for state in actor.states {
            let altitude = state.position.length() - 6.378_137e6;
            assert!((530e3..580e3).contains(&altitude), "{altitude}");
            // Circular speed there is 7.59 km/s.
            assert!((state.velocity.length() - 7_590.0).abs() < 30.0);
        }
    }
}
