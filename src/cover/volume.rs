//! Volumes of unions, by summing over parallel lines.

use super::solid::{Solid, SolidPart};
use super::surface::{Surface, fan};
use crate::count::as_f64;
use glam::{DVec2, DVec3};
use std::f64::consts::PI;

/// Lines each way through a solid.
const LINES: usize = 256;

/// Lines through all balls, about.
const ALL_LINES: usize = 1 << 18;

const GOLDEN_ANGLE: f64 = 2.399_963_229_728_653;

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
    let volume = solid.is_volume().then(|| of_solid(solid))?;
    (volume > 1e-12 * solid.diameter.powi(3)).then(|| of_balls(balls) / volume)
}

fn of_solid(solid: &Solid) -> f64 {
    let mut lines = LineGrid::through(solid.low, solid.high);
    if let [part] = &solid.parts[..] {
        if let SolidPart::Convex(convex) = part
            && let Some(volume) = convex.form().volume()
        {
            return volume;
        }
        let surface = part.surface(4);
        if lines.add_surface(&surface) {
            return surface.volume().abs();
        }
    } else {
        for surface in solid.surfaces(64) {
            lines.add_surface(&surface);
        }
    }
    lines.volume()
}

/// Returns the volume of a union: the sum of the balls' shares, each summed along lines through its ball.
/// A share is what of the ball has the least power with respect to it. So thin rows of balls need no more lines.
fn of_balls(balls: &[(DVec3, f64)]) -> f64 {
    if let [(_, radius)] = balls {
        return 4.0 / 3.0 * PI * radius.powi(3);
    }
    let lines = (ALL_LINES / balls.len()).clamp(256, 16_384);
    let count = as_f64(lines);
    // Rings of one area, by the golden angle: nothing repeats along a plane.
    let line = |number: usize| {
        let number = as_f64(number);
        let square = (number + 0.5) / count;
        let place = DVec2::from_angle(GOLDEN_ANGLE * number) * square.sqrt();
        (place, (1.0 - square).sqrt())
    };
    let lines: Vec<(DVec2, f64)> = (0..lines).map(line).collect();
    let of_share = |own: usize| {
        let radius = balls[own].1;
        let Some(half_spaces) = half_spaces_of_share(own, balls) else {
            return 0.0;
        };
        let turn = DVec2::from_angle(as_f64(own));
        let each = lines.iter().map(|&(place, half)| {
            let place = place.rotate(turn) * radius;
            within(place, half * radius, &half_spaces)
        });
        each.sum::<f64>() * PI * radius * radius / count
    };
    (0..balls.len()).map(of_share).sum()
}

/// Returns the half-spaces `normal . x <= offset` around a ball's centre that cut its share, `None` if the share is
/// empty. Of equal balls the first has it.
fn half_spaces_of_share(own: usize, balls: &[(DVec3, f64)]) -> Option<Vec<(DVec3, f64)>> {
    let (centre, radius) = balls[own];
    let mut half_spaces = Vec::new();
    for (number, &(other, other_radius)) in balls.iter().enumerate() {
        let normal = other - centre;
        let squares = (radius - other_radius) * (radius + other_radius);
        let offset = f64::midpoint(normal.length_squared(), squares);
        let reach = normal.length() * radius;
        let is_first = offset > -reach || (offset >= -reach && own <= number);
        if !is_first {
            return None;
        }
        if offset < reach {
            half_spaces.push((normal, offset));
        }
    }
    Some(half_spaces)
}

/// Returns the length of a line along z that is within half-spaces, up to a height and down to its
/// opposite.
fn within(place: DVec2, height: f64, half_spaces: &[(DVec3, f64)]) -> f64 {
    let (mut low, mut high) = (-height, height);
    for &(normal, offset) in half_spaces {
        let rest = offset - normal.truncate().dot(place);
        if normal.z > 0.0 {
            high = high.min(rest / normal.z);
        } else if normal.z < 0.0 {
            low = low.max(rest / normal.z);
        } else if rest < 0.0 {
            return 0.0;
        }
    }
    (high - low).max(0.0)
}

impl LineGrid {
    fn through(low: DVec3, high: DVec3) -> Self {
        Self {
            low,
            step: (high - low) / as_f64(LINES),
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
        let number = |place: f64| place.clamp(0.0, as_f64(LINES)) as usize;
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

    /// Adds what a closed surface winds around. Returns true if it winds around all of that once, in one direction.
    fn add_surface(&mut self, surface: &Surface) -> bool {
        let mut crossings = Self::through(self.low, self.low + self.step * as_f64(LINES));
        for corners in surface.polygons().flat_map(fan) {
            crossings.add_crossings(corners.map(|corner| surface.points[corner]));
        }
        let (mut least, mut most) = (0.0_f64, 0.0_f64);
        for (within, mut crossed) in self.within.iter_mut().zip(crossings.within) {
            crossed.sort_by(|a, b| a.0.total_cmp(&b.0));
            let (mut winding, mut start) = (0.0, 0.0);
            for (height, sign) in crossed {
                if winding == 0.0 {
                    start = height;
                }
                winding += sign;
                (least, most) = (least.min(winding), most.max(winding));
                if winding == 0.0 {
                    within.push((start, height));
                }
            }
        }
        most - least <= 1.0
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
