//! The whole world turned: positions, velocities, orientations, normals. The conflicts are the same, but for
//! rounding.

use super::{rotation, vector};
use nearmiss::glam::{DQuat, DVec3};
use nearmiss::{
    Accuracy, Body, BodyId, Conflict, Hitbox, Orientation, Outside, Query, Scene, Sphere, State,
    Trajectory, Window,
};
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};

const MARGIN: f64 = 0.3;

/// A way to turn, with its numbers.
#[derive(Clone, Debug)]
enum Turn {
    Fixed,
    Spin(f64, DQuat, DVec3),
    Slerp(Vec<(f64, DQuat)>),
    NormalizedCubic(Vec<(f64, DQuat)>),
}

/// The space that a body takes.
#[derive(Clone, Debug)]
enum Extent {
    Spheres(Vec<Sphere>),
    Floor(DVec3),
}

/// A body by its numbers.
#[derive(Clone, Debug)]
struct Numbers {
    states: Vec<State>,
    turn: Turn,
    extent: Extent,
    outside: Outside,
}

impl Numbers {
    fn new(rng: &mut ChaCha8Rng, number: usize) -> Self {
        let drift = vector(rng, 4.0);
        let states = [-5.0, -1.0, 2.0, 6.0].map(|time| {
            let place = drift * (0.2 * time) + vector(rng, 3.0);
            State::new(5.0 + time, place, drift * 0.2 + vector(rng, 1.0))
        });
        let knots = |rng: &mut ChaCha8Rng| -> Vec<(f64, DQuat)> {
            let times = [-1.0, 1.5, 3.0, 7.0, 9.5];
            times.map(|time| (time, rotation(rng))).to_vec()
        };
        let turn = match number % 4 {
            0 => Turn::Fixed,
            1 => Turn::Spin(1.0, rotation(rng), vector(rng, 6.0)),
            2 => Turn::Slerp(knots(rng)),
            _ => Turn::NormalizedCubic(knots(rng)),
        };
        let spheres = (0..rng.random_range(1..7)).map(|_| Sphere {
            offset: vector(rng, 1.5),
            radius: rng.random_range(0.0..0.5),
        });
        Self {
            states: states.to_vec(),
            turn,
            extent: Extent::Spheres(spheres.collect()),
            outside: [Outside::Absent, Outside::Coast][rng.random_range(0..2)],
        }
    }

    /// A half-space that rests or moves.
    fn floor(rng: &mut ChaCha8Rng, moves: bool) -> Self {
        let normal = vector(rng, 1.0).normalize();
        let place = -4.0 * normal + vector(rng, 0.5);
        let velocity = if moves { vector(rng, 0.3) } else { DVec3::ZERO };
        let state = |time: f64| State::new(time, place + time * velocity, velocity);
        Self {
            states: vec![state(0.0), state(10.0)],
            turn: Turn::Fixed,
            extent: Extent::Floor(normal),
            outside: Outside::Coast,
        }
    }

    fn turned(&self, by: DQuat) -> Body {
        let states: Vec<State> = self
            .states
            .iter()
            .map(|state| State::new(state.time, by * state.position, by * state.velocity))
            .collect();
        let plan = Trajectory::from_states(&states)
            .unwrap()
            .with_outside(self.outside);
        let after = |rotation: DQuat| (by * rotation).normalize();
        let knots = |knots: &[(f64, DQuat)]| -> Vec<(f64, DQuat)> {
            let each = knots.iter().map(|&(time, one)| (time, after(one)));
            each.collect()
        };
        let orientation = match &self.turn {
            Turn::Fixed => Ok(Orientation::FIXED),
            Turn::Spin(time, rotation, velocity) => {
                Orientation::spin(*time, after(*rotation), by * *velocity)
            }
            Turn::Slerp(of) => Orientation::slerp(&knots(of)),
            Turn::NormalizedCubic(of) => Orientation::normalized_cubic(&knots(of)),
        };
        let orientation = orientation.unwrap().with_outside(self.outside);
        let hitbox = match &self.extent {
            Extent::Floor(normal) => Hitbox::half_space((by * *normal).normalize()),
            Extent::Spheres(spheres) => {
                let in_world = spheres.iter().map(|sphere| Sphere {
                    // The axes of a body that turns are turned by its orientation.
                    offset: match self.turn {
                        Turn::Fixed => by * sphere.offset,
                        _ => sphere.offset,
                    },
                    ..*sphere
                });
                Hitbox::cluster(in_world.collect())
            }
        };
        Body::new(plan)
            .with_hitbox(hitbox.unwrap())
            .with_orientation(orientation)
    }
}

fn conflicts(world: &[Numbers], by: DQuat, accuracy: Accuracy) -> Vec<Conflict> {
    let mut scene = Scene::new();
    for numbers in world {
        scene.insert(numbers.turned(by)).unwrap();
    }
    let query = Query::new(Window::new(0.0, 10.0).unwrap())
        .with_margin(MARGIN)
        .with_accuracy(accuracy);
    let mut found = scene.screen(&query).unwrap().conflicts;
    found.sort_by(|x, y| {
        (x.a, x.b)
            .cmp(&(y.a, y.b))
            .then(x.enter.total_cmp(&y.enter))
    });
    found
}

/// Largest difference of separations, m: rounding, or what stands in for a turning point's way. The error of a
/// normalised cubic is bounded along the axes of the world, and so depends on where they are.
fn tolerance(world: &[Numbers], conflict: &Conflict, accuracy: Accuracy) -> f64 {
    /// Largest distance of a sphere's centre from its body's position, m.
    const ARM: f64 = 2.6;
    let is_cubic = |id: BodyId| {
        let turn = &world[id.slot() as usize].turn;
        matches!(turn, Turn::NormalizedCubic(_))
    };
    let of_baking = match accuracy {
        Accuracy::Exact => 2.0 * 1e-3 * ARM,
        _ => 2.0 * 1e-6 * ARM,
    };
    let cubics = [conflict.a, conflict.b]
        .into_iter()
        .filter(|&id| is_cubic(id));
    cubics.map(|_| of_baking).sum::<f64>() + 1e-11
}

/// Each conflict that is deeper than the tolerance has one of the other world, at the same time.
fn are_found(world: &[Numbers], these: &[Conflict], others: &[Conflict], accuracy: Accuracy) {
    for one in these {
        let off = tolerance(world, one, accuracy);
        if one.closest.separation > MARGIN - off {
            continue;
        }
        let is_same = |other: &&Conflict| {
            let apart = one.closest.separation - other.closest.separation;
            (one.a, one.b) == (other.a, other.b)
                && apart.abs() <= off
                && one.enter <= other.exit
                && other.enter <= one.exit
        };
        let other = others.iter().find(is_same);
        let Some(other) = other else {
            panic!("{accuracy:?} {one:?} {others:?}");
        };
        if off < 1e-10 {
            let times = [(one.enter, other.enter), (one.exit, other.exit)];
            for (x, y) in times {
                // Grazing contacts begin and end where the separation hardly changes.
                assert!((x - y).abs() < 1e-6, "{one:?} {other:?}");
            }
            let resolved = [one, other].map(|one| one.certificate.map(|it| it.resolved));
            assert_eq!(resolved[0], resolved[1], "{one:?} {other:?}");
        }
    }
}

/// Bodies that turn in each way and those that do not, above floors and each other.
#[test]
fn conflicts_turn_with_the_world() {
    let (mut between, mut with_floors) = (0, 0);
    for seed in 0..6 {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let mut world: Vec<Numbers> = (0..16).map(|n| Numbers::new(&mut rng, n)).collect();
        world.extend([false, true].map(|moves| Numbers::floor(&mut rng, moves)));
        let turns = [rotation(&mut rng), rotation(&mut rng)];
        for accuracy in [Accuracy::Exact, Accuracy::Certified] {
            let expected = conflicts(&world, DQuat::IDENTITY, accuracy);
            let is_floor = |one: &&Conflict| one.b.slot() >= 16;
            with_floors += expected.iter().filter(is_floor).count();
            between += expected.len();
            for by in turns {
                let found = conflicts(&world, by, accuracy);
                are_found(&world, &expected, &found, accuracy);
                are_found(&world, &found, &expected, accuracy);
            }
        }
    }
    assert!(
        between > 300 && with_floors > 100,
        "{between} {with_floors}"
    );
}
