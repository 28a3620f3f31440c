//! `Scene::update`, then a screening.

use super::answers::{Row, tolerance, wrong};
use super::motions::{Motion, meet, spline, told, trajectory};
use super::{Asked, Far, epoch};
use crate::check::Truth;
use crate::support::{rng, sliced};
use glam::DVec3;
use nearmiss::internals::{Method, QueryInternals};
use nearmiss::{Accuracy, Body, BodyId, Conflict, Query, Scene, State, Trajectory, Window};
use rand::RngExt;
use rand::rngs::ChaCha8Rng;

/// Pairs that are made to meet; all pairs are asked about.
const PAIRS: usize = 6;

/// Bodies of a scene, with what they do exactly.
struct World {
    scene: Scene,
    bodies: Vec<(BodyId, Motion)>,
}

impl World {
    /// Most of the bodies are told where they are; the others have splines, or rest.
    fn new(rng: &mut ChaCha8Rng, now: f64) -> Self {
        let far = Far::any(rng);
        let mut scene = Scene::new();
        let mut bodies = Vec::new();
        let mut states = Vec::new();
        for _ in 0..PAIRS {
            let time = now + rng.random_range(0.0..2.0);
            let meeting = far.place(rng);
            for (state, at) in meet(rng, time, meeting) {
                let plan = spline(rng, time, at);
                let id = scene.insert(Body::new(trajectory(&plan))).unwrap();
                let motion = match rng.random_range(0..8) {
                    0 => Motion::spline(&plan.0, plan.1, now),
                    1 => {
                        scene
                            .set_trajectory(id, Trajectory::at_rest(at).unwrap())
                            .unwrap();
                        Motion::through(&State::new(0.0, at, DVec3::ZERO), now)
                    }
                    _ => {
                        if rng.random_bool(0.3) {
                            // Told before, in the same call or in one before.
                            let before = told(rng, time, at);
                            match rng.random_bool(0.5) {
                                true => states.push((id, before)),
                                false => scene.update([(id, before)]).unwrap(),
                            }
                        }
                        states.push((id, state));
                        Motion::through(&state, now)
                    }
                };
                bodies.push((id, motion));
            }
        }
        scene.update(states.iter().copied()).unwrap();
        if rng.random_bool(0.3) {
            // Bit for bit what they do.
            scene.update(states.iter().rev().take(1).copied()).unwrap();
        }
        Self { scene, bodies }
    }

    fn found(&self, query: &Query) -> Vec<Conflict> {
        self.scene.screen(query).unwrap().conflicts
    }
}

/// The distance of bodies that fly beside each other; or one that the bodies of a pair come to, but for 1e-9, 1e-12,
/// a rounding or nothing; or any.
fn margin(rng: &mut ChaCha8Rng, world: &World, window: Window) -> f64 {
    let pair = 2 * rng.random_range(0..PAIRS);
    let [a, b] = [pair, pair + 1].map(|place| world.bodies[place].0);
    let least = world.scene.closest_approach(a, b, window).unwrap();
    let near = least.map_or(1.0, |least| least.separation);
    if rng.random_bool(0.4) {
        return f64::from(rng.random_range(1..4));
    }
    let little = [0.0, 1e-12, 1e-9, f64::EPSILON, 0.1][rng.random_range(0..5)];
    if rng.random_bool(0.6) && near < 10.0 {
        near * (1.0 + [-1.0, 1.0][rng.random_range(0..2)] * little)
    } else {
        rng.random_range(0.0..3.0)
    }
}

/// Asks one world, certified and not.
pub(crate) fn world(seed: u64, asked: &mut Asked) {
    let mut rng = rng(seed);
    let now = epoch(&mut rng);
    let world = World::new(&mut rng, now);
    let (from, to) = match rng.random_range(0..4) {
        0 => (now - 0.5, now + rng.random_range(0.5..9.0)),
        _ => (now, now + 2.0),
    };
    let window = Window::new(from, to).unwrap();
    let margin = margin(&mut rng, &world, window);
    // So few bodies are compared with each other; here boxes have their say as well.
    let method = [Method::Sweep, Method::Tree, Method::BruteForce][rng.random_range(0..3)];
    let query = Query::new(window).with_margin(margin).with_method(method);
    let query = sliced(query, rng.random_range(0..9));
    let certified = world.found(&query.with_accuracy(Accuracy::Certified));
    let rounded = world.found(&query);
    for (place, (a, first)) in world.bodies.iter().enumerate() {
        for (b, second) in &world.bodies[place + 1..] {
            let of_pair = |rows: &[Conflict]| -> Vec<Conflict> {
                let is_own = |row: &&Conflict| (row.a, row.b) == (*a, *b);
                rows.iter().filter(is_own).copied().collect()
            };
            let exact = [first, second].map(|motion| motion.exact.clone());
            let truth = Truth::between(exact, margin, (from, to));
            let found = of_pair(&certified);
            let told =
                || format!("seed {seed} {a:?} {b:?} {margin} {found:?} {first:?} {second:?}");
            assert_eq!(truth.wrong(&found), None, "{}", told());
            if !found.is_empty() {
                assert_eq!(truth.wrong_thoroughly(&found), None, "{}", told());
            }
            let rows: Vec<Row> = of_pair(&rounded).iter().map(Row::of).collect();
            let tolerance = tolerance(first, second, to);
            let mistake = wrong(&truth, margin, tolerance, &rows);
            assert_eq!(mistake, None, "tolerance {tolerance}, {rows:?}, {}", told());
            asked.pairs += 1;
            asked.conflicts += found.len();
            let proofs = found.iter().filter_map(|row| row.certificate);
            asked.unresolved += proofs.filter(|proof| !proof.resolved).count();
        }
    }
}
