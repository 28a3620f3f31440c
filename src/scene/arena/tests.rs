//! Allocation, release and copies of ranges, alone and under the bodies of a scene.

use super::{ArenaRange, CubicArena};
use crate::bounds::{CacheLine, CompactTrajectory};
use crate::scene::{Body, Scene};
use crate::trajectory::{State, Trajectory};
use glam::DVec3;
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};

/// No two ranges ever overlap, and memory does not grow without bound.
#[test]
fn ranges_keep_what_is_drawn_on_them() {
    let mut rng = ChaCha8Rng::seed_from_u64(12);
    let mut arena = CubicArena::default();
    // The very first one may be for nothing.
    let nothing = arena.take(0);
    arena.give_back(nothing);
    let mut owners: Vec<Option<(ArenaRange, f64)>> = Vec::new();
    let (mut peak, mut copied) = (0, 0);
    for round in 0..150_000_u32 {
        // More and more of all sizes, then few and small ones, and again.
        let phase = round % 50_000;
        let most = if phase < 30_000 { phase / 30 } else { 100 };
        owners.resize_with(owners.len().max(most as usize + 1), || None);
        let owner = rng.random_range(0..owners.len());
        let cache_lines = if phase < 30_000 && rng.random_bool(0.05) {
            rng.random_range(0..3_000)
        } else {
            rng.random_range(0..60)
        };
        let before = owners[owner].take();
        if let Some((range, mark)) = &before {
            assert!(is_marked(&arena, range, *mark), "{range:?} {mark}");
        }
        let range = match before {
            Some((range, _)) if owner > most as usize || rng.random_bool(0.3) => {
                arena.give_back(range);
                None
            }
            Some((range, _)) => Some(arena.exchange(range, cache_lines)),
            None if owner > most as usize => None,
            None => Some(arena.take(cache_lines)),
        };
        if let Some(range) = range {
            let mark = f64::from(round);
            assert!(arena.at(&range).len() == cache_lines);
            arena.at_mut(&range).fill(bytemuck::cast([mark; 8]));
            owners[owner] = Some((range, mark));
        }
        if arena.is_mostly_garbage() {
            let old = std::mem::take(&mut arena);
            for (range, _) in owners.iter_mut().flatten() {
                *range = arena.take_copy(&old, range);
            }
            copied += 1;
        }
        if round < 50_000 {
            peak = peak.max(arena.cache_lines());
        }
        let held = owners.iter().flatten().map(|(range, _)| range.cache_lines);
        assert!(phase % 1_000 != 0 || arena.live == held.sum::<usize>());
    }
    assert!(copied > 10, "{copied}");
    assert!(
        peak > 2 * CubicArena::FEW,
        "of both kinds of memory: {peak}"
    );
    assert!(
        arena.cache_lines() <= peak / 2,
        "{} {peak}",
        arena.cache_lines()
    );
    for (range, mark) in owners.drain(..).flatten() {
        assert!(is_marked(&arena, &range, mark), "{range:?} {mark}");
        arena.give_back(range);
    }
    assert!(arena.chunks.is_empty() && arena.garbage == 0);
}

/// A scene holds no memory for more bodies than were there at a time.
#[test]
fn bodies_that_are_gone_leave_their_lines() {
    let mut scene = Scene::new();
    let insert = |scene: &mut Scene, plan| scene.insert(Body::new(plan));
    let mut ids: Vec<_> = (0..100)
        .filter_map(|k| insert(&mut scene, straight(1 + k % 40)).ok())
        .collect();
    let before = scene.arena().cache_lines();
    for round in 0..20_000 {
        let place = round % ids.len();
        // Those of a size are as many as before.
        let Some(plan) = scene.body(ids[place]).map(|body| body.trajectory.clone()) else {
            unreachable!("it was not removed")
        };
        let changed = match round % 3 {
            0 => scene.remove(ids[place]).and_then(|_| {
                ids[place] = insert(&mut scene, plan)?;
                Ok(())
            }),
            1 => scene.set_trajectory(ids[place], plan).map(drop),
            // Copied while the scene is being read, and then as it was put in.
            _ => scene
                .swap_trajectory(ids[place], &mut plan.clone())
                .map(|entry| entry.summary().path)
                .and_then(|_| scene.set_trajectory(ids[place], plan).map(drop)),
        };
        assert_eq!(changed, Ok(()));
    }
    let most = 2 * before + 2 * CubicArena::FEW;
    assert!(
        scene.arena().cache_lines() <= most,
        "{} {before}",
        scene.arena().cache_lines()
    );
    for id in ids {
        assert!(scene.remove(id).is_ok());
    }
    assert_eq!(scene.arena().cache_lines(), 0);
}

fn straight(cubics: u32) -> Trajectory {
    let states = (0..=cubics)
        .map(|k| State::new(f64::from(k), DVec3::X * f64::from(k), DVec3::X))
        .collect::<Vec<_>>();
    Trajectory::from_states(&states).unwrap_or_else(|error| unreachable!("{error}"))
}

/// All plans get longer, and shorter, and bodies are removed: memory follows the data.
#[test]
fn memory_goes_back_when_all_plans_change() {
    const BODIES: usize = 300;
    let mut scene = Scene::new();
    let mut ids = Vec::new();
    let mut cubics = vec![20; BODIES];
    for &count in &cubics {
        ids.extend(scene.insert(Body::new(straight(count))));
    }
    let (grow, shrink) = (21..=98, (20..98).rev());
    let mixed = |body: usize| [4, 300, 17, 90, 1][body % 5];
    let up_and_down = grow.clone().chain(shrink).chain([500, 4]).chain(grow);
    let rounds = up_and_down
        .map(Some)
        .chain([None, Some(500), None, Some(1)]);
    let mut most = 0.0_f64;
    for (number, round) in rounds.enumerate() {
        for body in 0..BODIES {
            cubics[body] = round.unwrap_or(mixed(body));
            // Some as a monitor does it: the compact trajectory is left for later.
            let mut plan = straight(cubics[body]);
            if body % 50 == 7 {
                assert!(scene.swap_trajectory(ids[body], &mut plan).is_ok());
            } else {
                assert!(scene.set_trajectory(ids[body], plan).is_ok());
            }
            if body % 25 == 0 {
                most = most.max(excess(&scene));
            }
        }
        // It takes longer than all the rest.
        if number % 20 == 0 {
            is_drawn_right(&scene);
        }
    }
    for (body, id) in ids.iter().enumerate() {
        let plan = straight(mixed(body) + 100);
        assert!(scene.set_trajectory(*id, plan).is_ok());
    }
    // All but a few here and there.
    for (body, id) in ids.iter().enumerate() {
        if body % 100 != 50 {
            assert!(scene.remove(*id).is_ok());
            most = most.max(excess(&scene));
        }
    }
    is_drawn_right(&scene);
    assert!(most <= 5.0, "{most}");
}

/// Returns the ratio of held cache lines to the bodies' need, without the garbage and the two partly used
/// large pages that any scene may hold.
fn excess(scene: &Scene) -> f64 {
    let cache_lines = |body: &Body| {
        let plan = &body.trajectory;
        CompactTrajectory::cache_lines(plan.knots().len(), plan.segments().len())
    };
    let needed: usize = scene.bodies().map(|(_, body)| cache_lines(body)).sum();
    let held = scene
        .arena()
        .cache_lines()
        .saturating_sub(5 * CubicArena::FEW);
    let [held, needed] =
        [held, needed].map(|cache_lines| u32::try_from(cache_lines).map_or(f64::NAN, f64::from));
    held / needed
}

/// Asserts that each body's compact trajectory is that of its plan.
fn is_drawn_right(scene: &Scene) {
    for (_, entry) in scene.entries() {
        let plan = &entry.body.trajectory;
        let (compact, cache_lines) = CompactTrajectory::of(plan.knots(), plan.segments());
        let [there, afresh] = [entry.compact_view(scene.arena()), compact.on(&cache_lines)];
        assert_eq!(format!("{there:?}"), format!("{afresh:?}"));
    }
}

fn is_marked(arena: &CubicArena, range: &ArenaRange, mark: f64) -> bool {
    let knots: &[f64] = bytemuck::cast_slice::<CacheLine, f64>(arena.at(range));
    knots.iter().all(|knot| knot.to_bits() == mark.to_bits())
}
