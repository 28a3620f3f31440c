//! Shares of a shape: each ball answers for the part of the shape in its power cell.

use super::surface::{ClipScratch, OrientedPlane, Surface};
use crate::parallel;
use glam::DVec3;

/// Distance by which the half-spaces of cells are moved outward, in units of the order of the shape.
/// The proof in the room's documentation says why.
const OUTWARD: f64 = 1e-11;

/// Balls whose centres are nearer than this answer for the whole share of both.
const ONE_PLACE: f64 = 1e-7;

/// Buffers for one cell.
#[derive(Clone, Debug, Default)]
pub(super) struct CellScratch {
    /// The part of the surface that lies in the cell.
    pub(super) share: Surface,
    clip: ClipScratch,
    /// The balls whose radical planes cut the share.
    pub(super) cut_by: Vec<usize>,
    /// Other balls by the distance of the radical plane.
    order: Vec<(f64, usize)>,
}

impl CellScratch {
    /// Forms the share of one of the balls of a surface. The share contains all points of the surface,
    /// and of the volume that it bounds, whose power with respect to this ball is the least.
    pub(super) fn form(&mut self, surface: &Surface, own: usize, balls: &[(DVec3, f64)]) {
        self.form_without(surface, own, balls, |_| false);
    }

    /// Forms the share as if some of the other balls were not there.
    pub(super) fn form_without(
        &mut self,
        surface: &Surface,
        own: usize,
        balls: &[(DVec3, f64)],
        is_absent: impl Fn(usize) -> bool,
    ) {
        self.share.copy_from(surface);
        self.cut_by.clear();
        let (centre, radius) = balls[own];
        self.order.clear();
        for (number, &(other, other_radius)) in balls.iter().enumerate() {
            let apart = other.distance(centre);
            if number == own || apart < ONE_PLACE || is_absent(number) {
                continue;
            }
            let squares = (radius - other_radius) * (radius + other_radius);
            let plane = (apart + squares / apart) / 2.0 + OUTWARD + 1e-14 / apart;
            self.order.push((plane, number));
        }
        self.order
            .sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let mut reach = self.share.farthest(centre);
        for &(plane, other) in &self.order {
            if plane > reach || self.share.points.is_empty() {
                break;
            }
            let normal = (balls[other].0 - centre).normalize();
            let plane = OrientedPlane {
                normal,
                offset: normal.dot(centre) + plane,
            };
            if self.share.clip(&plane, &mut self.clip) {
                reach = self.share.farthest(centre);
                self.cut_by.push(other);
            }
        }
    }

    /// Returns the radius that a ball needs to contain its share of a surface, `None` without a share, as if some of the
    /// other balls were not there.
    pub(super) fn needed(
        &mut self,
        surface: &Surface,
        own: usize,
        balls: &[(DVec3, f64)],
        is_absent: impl Fn(usize) -> bool,
    ) -> Option<f64> {
        self.form_without(surface, own, balls, is_absent);
        let has_share = !self.share.points.is_empty();
        has_share.then(|| self.share.farthest(balls[own].0) + 4.0 * OUTWARD)
    }
}

/// Returns the radius that each ball needs to contain its share of some surfaces, `None` without a
/// share.
pub(super) fn needed_radii(surfaces: &[Surface], balls: &[(DVec3, f64)]) -> Vec<Option<f64>> {
    let one = |scratch: &mut CellScratch, own: usize| {
        let mut needed: Option<f64> = None;
        for surface in surfaces {
            let of_surface = scratch.needed(surface, own, balls, |_| false);
            needed = larger(needed, of_surface);
        }
        needed
    };
    parallel::map(balls.len(), CellScratch::default, one)
}

/// Returns the larger one of two radii, if there is one.
pub(super) fn larger(one: Option<f64>, other: Option<f64>) -> Option<f64> {
    one.into_iter().chain(other).reduce(f64::max)
}
