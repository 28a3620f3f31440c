//! Shares of a shape: each ball answers for the part of the shape in its power cell.

use super::surface::{ClipScratch, OrientedPlane, Surface};
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
    cut_by: Vec<usize>,
    /// Other balls by the distance of the radical plane.
    order: Vec<(f64, usize)>,
}

/// The share of a ball, as far as it is known.
#[derive(Clone, Debug, Default)]
pub(super) struct Share {
    /// Largest distance from the ball's centre, `None` without a share.
    pub(super) reach: Option<f64>,
    /// The balls without which the share would be larger.
    pub(super) cut_by: Vec<usize>,
}

impl CellScratch {
    /// Forms the share of one of the balls of a surface, as if some of the other balls were not there. The share contains
    /// all points of the surface, and of the volume that it bounds, whose power with respect to this ball is the least.
    pub(super) fn form(
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

    /// Returns the share of one of the balls of some surfaces, as if some of the other balls were not there.
    pub(super) fn share(
        &mut self,
        surfaces: &[Surface],
        own: usize,
        balls: &[(DVec3, f64)],
        is_absent: impl Fn(usize) -> bool + Copy,
    ) -> Share {
        let mut share = Share::default();
        for surface in surfaces {
            self.form(surface, own, balls, is_absent);
            if !self.share.points.is_empty() {
                let reach = self.share.farthest(balls[own].0);
                share.reach = Some(share.reach.map_or(reach, |other| other.max(reach)));
            }
            share.cut_by.extend(&self.cut_by);
        }
        share
    }
}

impl Share {
    /// Returns the radius that the ball needs to contain the share, `None` without a share.
    pub(super) fn needed(&self) -> Option<f64> {
        self.reach.map(|reach| reach + 4.0 * OUTWARD)
    }
}
