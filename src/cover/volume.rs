//! Volumes of unions, by summing over lines and rays.

use super::solid::{Solid, SolidPart};
use super::surface::{Surface, fan};
use crate::count::as_f64;
use glam::DVec3;
use std::f64::consts::{PI, TAU};

/// Lines each way through a solid.
const LINES: usize = 256;

/// Rays in all balls, about.
const ALL_RAYS: usize = 1 << 17;

/// The golden ratio, less 1.
const GOLDEN: f64 = 0.618_033_988_749_894_8;

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
    // The balls contain the solid: only sums that are rounded can be less.
    (volume > 1e-12 * solid.diameter.powi(3)).then(|| (of_balls(balls) / volume).max(1.0))
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

/// Returns the volume of a union: the sum of the balls' shares, each summed along rays from its ball's centre. A share is
/// what of the ball has the least power with respect to it.
fn of_balls(balls: &[(DVec3, f64)]) -> f64 {
    let rays = (ALL_RAYS / balls.len()).clamp(256, 4_096);
    let of_share = |own: usize| {
        half_spaces_of_share(own, balls).map_or(0.0, |half_spaces| {
            // Shares that are alike have rays at other places.
            let shift = (as_f64(own) * GOLDEN).fract();
            of_share(balls[own].1, &half_spaces, rays, shift)
        })
    };
    (0..balls.len()).map(of_share).sum()
}

/// Returns the volume of what half-spaces leave of a ball around 0. The rays lie on a spiral around the direction to the
/// nearest of their planes, evenly spread: also across a share that is a thin slice.
fn of_share(radius: f64, half_spaces: &[(DVec3, f64)], rays: usize, shift: f64) -> f64 {
    let distance = |&(normal, offset): &(DVec3, f64)| offset / normal.length();
    let nearest = half_spaces
        .iter()
        .min_by(|a, b| distance(a).total_cmp(&distance(b)));
    let axis = nearest.and_then(|(normal, _)| normal.try_normalize());
    let axis = axis.unwrap_or(DVec3::Z);
    let (right, up) = axis.any_orthonormal_pair();
    let count = as_f64(rays);
    let each = (0..rays).map(|number| {
        let place = as_f64(number) + shift;
        let height = 1.0 - 2.0 * place / count;
        let (sin, cos) = (TAU * GOLDEN * place).sin_cos();
        let away = (1.0 - height * height).max(0.0).sqrt();
        let direction = axis * height + (right * cos + up * sin) * away;
        cone_of_ray(direction, radius, half_spaces)
    });
    4.0 * PI / count * each.sum::<f64>()
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

/// Returns the volume, for each unit of the solid angle, of what half-spaces leave around a ray from 0.
fn cone_of_ray(direction: DVec3, length: f64, half_spaces: &[(DVec3, f64)]) -> f64 {
    let (mut low, mut high) = (0.0_f64, length);
    for &(normal, offset) in half_spaces {
        let slope = normal.dot(direction);
        if slope > 0.0 {
            high = high.min(offset / slope);
        } else if slope < 0.0 {
            low = low.max(offset / slope);
        } else if offset < 0.0 {
            return 0.0;
        }
    }
    (high.powi(3) - low.powi(3)).max(0.0) / 3.0
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

#[cfg(test)]
mod tests {
    use super::*;

    /// A lattice of balls in a cube: the whole cube, and caps of the outer ones.
    #[test]
    fn volumes_of_lattices() {
        for count in [3_usize, 8] {
            let place = |number: usize| as_f64(number) / as_f64(count);
            let balls: Vec<(DVec3, f64)> = (0..count.pow(3))
                .map(|number| {
                    let [x, y, z] = [1, count, count * count].map(|step| number / step % count);
                    (
                        DVec3::new(place(x), place(y), place(z)),
                        2.0 / as_f64(count),
                    )
                })
                .collect();
            // The union, on a fine grid of lines.
            let all = DVec3::splat(3.0 / as_f64(count));
            let mut grid = LineGrid::through(-all, DVec3::ONE + all);
            for &(centre, radius) in &balls {
                grid.visit(centre - radius, centre + radius, |at, within| {
                    let square = radius * radius - (at - centre).truncate().length_squared();
                    if square > 0.0 {
                        within.push((centre.z - square.sqrt(), centre.z + square.sqrt()));
                    }
                });
            }
            let ratio = of_balls(&balls) / grid.volume();
            assert!((ratio - 1.0).abs() < 1e-3, "{count}: {ratio}");
        }
    }
}
