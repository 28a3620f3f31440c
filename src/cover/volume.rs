//! Volumes of unions, by summing over parallel lines.

use super::solid::{Solid, SolidPart};
use super::surface::Surface;
use glam::DVec3;

/// Lines each way.
const LINES: usize = 256;

/// The lines through a box, upward.
struct LineGrid {
    low: DVec3,
    step: DVec3,
    /// The parts of each line that are within: start and end.
    within: Vec<Vec<(f64, f64)>>,
}

/// Returns the volume of the union of some balls over that of a solid, `None` if the solid has no
/// volume.
pub(super) fn ratio(solid: &Solid, balls: &[(DVec3, f64)]) -> Option<f64> {
    let volume = of_solid(solid);
    (solid.is_volume() && volume > 1e-12 * solid.diameter.powi(3)).then(|| of_balls(balls) / volume)
}

fn of_solid(solid: &Solid) -> f64 {
    if let [part] = &solid.parts[..] {
        let formula = match part {
            SolidPart::Convex(convex) => convex.form().volume(),
            SolidPart::Mesh(_) => None,
        };
        return formula.unwrap_or_else(|| part.surface(4).volume().abs());
    }
    let mut lines = LineGrid::through(solid.low, solid.high);
    for surface in solid.surfaces(64) {
        lines.add_surface(&surface);
    }
    lines.volume()
}

fn of_balls(balls: &[(DVec3, f64)]) -> f64 {
    if let [(_, radius)] = balls {
        return 4.0 / 3.0 * std::f64::consts::PI * radius.powi(3);
    }
    let low = balls.iter().map(|&(centre, radius)| centre - radius);
    let high = balls.iter().map(|&(centre, radius)| centre + radius);
    let mut lines = LineGrid::through(
        low.fold(DVec3::INFINITY, DVec3::min),
        high.fold(DVec3::NEG_INFINITY, DVec3::max),
    );
    for &(centre, radius) in balls {
        lines.visit(centre - radius, centre + radius, |at, within| {
            let square = radius * radius - (at - centre).truncate().length_squared();
            if square > 0.0 {
                within.push((centre.z - square.sqrt(), centre.z + square.sqrt()));
            }
        });
    }
    lines.volume()
}

impl LineGrid {
    #[allow(clippy::cast_precision_loss, reason = "a small count")]
    fn through(low: DVec3, high: DVec3) -> Self {
        Self {
            low,
            step: (high - low) / LINES as f64,
            within: vec![Vec::new(); LINES * LINES],
        }
    }

    /// Visits the lines that pass through a box.
    #[allow(
        clippy::cast_precision_loss,
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "numbers of lines, kept in range"
    )]
    fn visit(
        &mut self,
        low: DVec3,
        high: DVec3,
        mut tell: impl FnMut(DVec3, &mut Vec<(f64, f64)>),
    ) {
        let number = |place: f64| place.clamp(0.0, LINES as f64) as usize;
        let first = ((low - self.low) / self.step - 0.5).ceil();
        let after = ((high - self.low) / self.step - 0.5).floor() + 1.0;
        for row in number(first.y)..number(after.y) {
            for column in number(first.x)..number(after.x) {
                let place = DVec3::new(column as f64 + 0.5, row as f64 + 0.5, 0.0);
                tell(
                    self.low + self.step * place,
                    &mut self.within[row * LINES + column],
                );
            }
        }
    }

    /// Adds what a closed surface bounds.
    fn add_surface(&mut self, surface: &Surface) {
        let mut crossings = Self::through(self.low, self.low + self.step * LINES as f64);
        for polygon in surface.polygons() {
            let first = surface.points[polygon[0]];
            for pair in polygon[1..].windows(2) {
                let (a, b) = (surface.points[pair[0]], surface.points[pair[1]]);
                crossings.add_crossings([first, a, b]);
            }
        }
        for (within, mut crossed) in self.within.iter_mut().zip(crossings.within) {
            crossed.sort_by(|a, b| a.0.total_cmp(&b.0));
            let (mut winding, mut start) = (0.0, 0.0);
            for (height, sign) in crossed {
                if winding == 0.0 {
                    start = height;
                }
                winding += sign;
                if winding == 0.0 {
                    within.push((start, height));
                }
            }
        }
    }

    /// Notes where lines cross a triangle, 1 upward and -1 downward.
    fn add_crossings(&mut self, corners: [DVec3; 3]) {
        let [a, b, c] = corners;
        let normal = (b - a).cross(c - a);
        let sign = normal.z.signum();
        if normal.z.abs() <= 0.0 {
            return;
        }
        let low = a.min(b).min(c);
        let high = a.max(b).max(c);
        self.visit(low, high, |at, within| {
            let is_left = |from: DVec3, to: DVec3| {
                let (p, q) = (from - at, to - at);
                // One edge has one value, whichever way it is passed.
                if (p.x, p.y) < (q.x, q.y) {
                    p.x * q.y >= p.y * q.x
                } else {
                    q.x * p.y < q.y * p.x
                }
            };
            let sides = [is_left(a, b), is_left(b, c), is_left(c, a)];
            if sides.iter().all(|&side| side == (sign > 0.0)) {
                let from = (at - a).truncate();
                let height = a.z - from.dot(normal.truncate()) / normal.z;
                within.push((height, sign));
            }
        });
    }

    fn volume(mut self) -> f64 {
        let mut total = 0.0;
        for within in &mut self.within {
            within.sort_by(|a, b| a.0.total_cmp(&b.0));
            let mut reached = f64::NEG_INFINITY;
            for &(start, end) in within.iter() {
                total += (end - start.max(reached)).max(0.0);
                reached = reached.max(end);
            }
        }
        total * self.step.x * self.step.y
    }
}
