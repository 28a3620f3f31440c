//! Spheres for each body: tumbling boxes, covered by more or fewer.

use crate::scenes::{generator, normal_vector, uniform_vector};
use crate::table::Table;
use crate::timing::repeated;
use crate::{Effort, Failure};
use glam::{DQuat, DVec3};
use nearmiss::{
    Body, Conflict, CoverOptions, Hitbox, Orientation, Query, Scene, Sphere, SphereCover, State,
    Trajectory, Window,
};
use parry3d::math::Pose;
use parry3d::query::intersection_test;
use parry3d::shape::Cuboid;

/// Half sides of the boxes, m.
const HALF: DVec3 = DVec3::new(0.5, 1.0, 2.0);
/// Time that is looked at, s.
const DURATION: f64 = 20.0;
/// Instants a second at which two boxes are tested for an overlap.
const RATE: f64 = 500.0;

/// Boxes that fly straight and turn, one in 12³ m³.
pub(super) fn boxes(count: usize, hitbox: &Hitbox) -> Result<Scene, Failure> {
    let mut rng = generator(3);
    #[allow(clippy::cast_precision_loss, reason = "a size")]
    let half = 6.0 * (count as f64).cbrt();
    let mut scene = Scene::new();
    for _ in 0..count {
        let state = State::new(
            0.0,
            uniform_vector(&mut rng, half),
            normal_vector(&mut rng, 5.0),
        );
        let spin = normal_vector(&mut rng, 1.0);
        let start = DQuat::from_scaled_axis(normal_vector(&mut rng, 1.0));
        let body = Body::new(Trajectory::coasting(state)?)
            .with_hitbox(hitbox.clone())
            .with_orientation(Orientation::spin(0.0, start, spin)?);
        scene.insert(body)?;
    }
    Ok(scene)
}

/// Returns true if the boxes of a conflict overlap at some instant of it.
fn boxes_touch(scene: &Scene, conflict: &Conflict, shape: &Cuboid) -> bool {
    let (Some(a), Some(b)) = (scene.body(conflict.a), scene.body(conflict.b)) else {
        return false;
    };
    let pose = |body: &Body, time: f64| {
        let position = body.trajectory.position(time).unwrap_or(DVec3::NAN);
        Pose::from_parts(
            position.as_vec3(),
            body.orientation.rotation(time).as_quat(),
        )
    };
    let steps = ((conflict.exit - conflict.enter) * RATE).ceil();
    let mut step = 0.0;
    while step <= steps {
        let time = conflict.enter + (conflict.exit - conflict.enter) * (step / steps.max(1.0));
        let overlap = intersection_test(&pose(a, time), shape, &pose(b, time), shape);
        if overlap.is_ok_and(|overlap| overlap.intersecting) {
            return true;
        }
        step += 1.0;
    }
    false
}

/// Spheres against false encounters and time.
#[allow(clippy::cast_possible_truncation, reason = "parry's shapes are f32")]
pub(super) fn table(effort: &Effort) -> Result<Table, Failure> {
    let count = effort.choose(2_000, 300);
    let runs = effort.choose(5, 1);
    let mut table = Table::new(
        "spheres",
        format!(
            "Spheres for each body: {count} tumbling boxes of 1 x 2 x 4 m, {DURATION} s, contact (one thread)"
        ),
        &[
            "spheres",
            "overshoot m",
            "encounters",
            "boxes touch",
            "false",
            "ms",
        ],
    );
    let shape = Cuboid::new(HALF.as_vec3());
    let query = Query::new(Window::new(0.0, DURATION)?);
    for spheres in effort.choose(&[1, 4, 8, 16, 32, 64][..], &[1, 8][..]) {
        let (hitbox, overshoot) = if *spheres == 1 {
            let around = Sphere {
                offset: DVec3::ZERO,
                radius: HALF.length(),
            };
            (
                Hitbox::cluster(vec![around])?,
                HALF.length() - HALF.min_element(),
            )
        } else {
            let cover = SphereCover::fit(&shape, &CoverOptions::new(*spheres))?;
            let overshoot = cover.overshoot();
            (Hitbox::from(cover), overshoot)
        };
        let scene = boxes(count, &hitbox)?;
        let (screening, time) = repeated(runs, || scene.screen(&query))?;
        let conflicts = screening.conflicts;
        let touching = conflicts
            .iter()
            .filter(|conflict| boxes_touch(&scene, conflict, &shape))
            .count();
        table.row(vec![
            (*spheres).into(),
            overshoot.into(),
            conflicts.len().into(),
            touching.into(),
            (conflicts.len() - touching).into(),
            (1e3 * time).into(),
        ]);
    }
    table.note(format!(
        "boxes touch: encounters in which the boxes overlap at one of {RATE} instants a second."
    ));
    table.note(
        "Covers contain the box: none is missed. Fewer spheres join encounters that are several.",
    );
    Ok(table)
}
