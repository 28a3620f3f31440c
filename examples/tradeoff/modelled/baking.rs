//! The tolerance of turning bodies: how finely the ways of their spheres are cut into cubics.

use super::spheres::Boxes;
use crate::table::Table;
use crate::timing::repeated;
use crate::{Effort, Failure};
use glam::DVec3;
use nearmiss::{Accuracy, CoverOptions, Hitbox, Query, Scene, SphereCover, Window};
use parry3d::shape::Cuboid;

/// The boxes with another tolerance, m.
fn with_tolerance(scene: &Scene, tolerance: f64) -> Result<Scene, Failure> {
    let mut changed = Scene::new();
    for (_, body) in scene.bodies() {
        let mut body = body.clone();
        body.orientation = body.orientation.with_tolerance(tolerance)?;
        changed.insert(body)?;
    }
    Ok(changed)
}

/// Tolerance against time and encounters that are only within it.
#[allow(clippy::cast_possible_truncation, reason = "parry's shapes are f32")]
pub(super) fn table(effort: &Effort) -> Result<Table, Failure> {
    let count = effort.choose(2_000, 300);
    let runs = effort.choose(5, 1);
    let mut table = Table::new(
        "baking",
        format!(
            "Tolerance of turning bodies: {count} boxes of 16 spheres, 20 s, contact (one thread)"
        ),
        &[
            "tolerance m",
            "encounters",
            "certified",
            "unresolved",
            "ms",
            "certified ms",
        ],
    );
    let shape = Cuboid::new(DVec3::new(0.5, 1.0, 2.0).as_vec3());
    let cover = SphereCover::fit(&shape, &CoverOptions::new(effort.choose(16, 8)))?;
    let base = Boxes::new(count, &Hitbox::from(cover))?.scene;
    let query = Query::new(Window::new(0.0, 20.0)?);
    let certified = query.with_accuracy(Accuracy::Certified);
    for &tolerance in effort.choose(&[1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6][..], &[1e-2, 1e-4][..]) {
        let scene = with_tolerance(&base, tolerance)?;
        let (found, time) = repeated(runs, || scene.screen(&query))?;
        let (proven, certified_time) = repeated(runs, || scene.screen(&certified))?;
        let (found, proven) = (found.conflicts.len(), proven.conflicts);
        let resolved = |one: &&nearmiss::Conflict| one.certificate.is_some_and(|it| it.resolved);
        let unresolved = proven.len() - proven.iter().filter(resolved).count();
        table.row(vec![
            tolerance.into(),
            found.into(),
            proven.len().into(),
            unresolved.into(),
            (1e3 * time).into(),
            (1e3 * certified_time).into(),
        ]);
    }
    table.note("tolerance m: of a sphere whose centre is 1 m from the body's position.");
    table.note("certified: of the splines, which are all that is known of these bodies.");
    table.note("unresolved: the tolerance does not let it be told whether the spheres touch.");
    Ok(table)
}
