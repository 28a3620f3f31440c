//! Spheres for each body: tumbling boxes, covered by more or fewer.

use super::box_pair::{BoxPair, Touch};
use crate::scenes::{generator, normal_vector, uniform_vector};
use crate::table::Table;
use crate::timing::repeated;
use crate::{Effort, Failure};
use glam::{DQuat, DVec3};
use nearmiss::{
    Body, Conflict, CoverOptions, Hitbox, Orientation, Query, Scene, Sphere, SphereCover, State,
    Trajectory, Window,
};
use parry3d::shape::Cuboid;

/// Half sides of the boxes, m.
const HALF: DVec3 = DVec3::new(0.5, 1.0, 2.0);
/// Time that is looked at, s.
const DURATION: f64 = 20.0;

/// Boxes that fly straight and turn, one in 12³ m³.
pub(super) struct Boxes {
    pub(super) scene: Scene,
    /// Rates at which they turn, rad/s; a body's tag is its place.
    spins: Vec<f64>,
}

impl Boxes {
    pub(super) fn new(count: usize, hitbox: &Hitbox) -> Result<Self, Failure> {
        let mut rng = generator(3);
        #[allow(clippy::cast_precision_loss, reason = "a size")]
        let half = 6.0 * (count as f64).cbrt();
        let (mut scene, mut spins) = (Scene::new(), Vec::new());
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
                .with_orientation(Orientation::spin(0.0, start, spin)?)
                .with_tag(spins.len() as u64);
            scene.insert(body)?;
            spins.push(spin.length());
        }
        Ok(Self { scene, spins })
    }

    /// Returns what is proven of the boxes themselves in a conflict of their spheres.
    fn touch(&self, conflict: &Conflict) -> Touch {
        let bodies = [conflict.a, conflict.b].map(|id| self.scene.body(id));
        let [Some(a), Some(b)] = bodies else {
            return Touch::Undecided;
        };
        let state = |body: &Body, time| body.trajectory.state(time).unwrap_or_default();
        let poses = |time: f64| {
            let [from, to] = [a, b].map(|body| state(body, time).position);
            (
                to - from,
                [a, b].map(|body| body.orientation.rotation(time)),
            )
        };
        let [own, other] = [a, b].map(|body| state(body, conflict.enter).velocity);
        #[allow(clippy::cast_possible_truncation, reason = "a place")]
        let [spin, other_spin] = [a, b].map(|body| self.spins[body.tag as usize]);
        let pair = BoxPair {
            half: HALF,
            poses,
            speed: (other - own).length() + (spin + other_spin) * HALF.length(),
        };
        pair.touch(conflict.enter, conflict.exit)
    }
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
    let mut undecided = 0;
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
        let boxes = Boxes::new(count, &hitbox)?;
        let (screening, time) = repeated(runs, || boxes.scene.screen(&query))?;
        let conflicts = screening.conflicts;
        let proven: Vec<Touch> = conflicts.iter().map(|one| boxes.touch(one)).collect();
        let number = |touch: Touch| proven.iter().filter(|one| **one == touch).count();
        undecided += number(Touch::Undecided);
        table.row(vec![
            (*spheres).into(),
            overshoot.into(),
            conflicts.len().into(),
            number(Touch::Certain).into(),
            number(Touch::Never).into(),
            (1e3 * time).into(),
        ]);
    }
    table.note(format!(
        "boxes touch, false: proven by bounds of the boxes' distance; undecided of all: {undecided}."
    ));
    table.note(
        "Covers contain the box: none is missed. Fewer spheres join encounters that are several.",
    );
    Ok(table)
}
