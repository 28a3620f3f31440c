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

/// Returns the volume of a union: the sum of the balls' shares, each summed along lines through a box around it.
/// A share is what of the ball has the least power with respect to it. So thin rows of balls, and rows of thin shares,
/// need no more lines.
fn of_balls(balls: &[(DVec3, f64)]) -> f64 {
    if let [(_, radius)] = balls {
        return 4.0 / 3.0 * PI * radius.powi(3);
    }
    let lines = (ALL_LINES / balls.len()).clamp(256, 16_384);
    let of_share = |own: usize| {
        half_spaces_of_share(own, balls).map_or(0.0, |half_spaces| {
            // Shares that are alike have lines at other places.
            let shift = (as_f64(own) * GOLDEN).fract();
            of_share(balls[own].1, &half_spaces, lines, shift)
        })
    };
    (0..balls.len()).map(of_share).sum()
}

/// Returns the volume of what half-spaces leave of a ball around 0. The lines lie along the plane that cuts most of it.
fn of_share(radius: f64, half_spaces: &[(DVec3, f64)], lines: usize, shift: f64) -> f64 {
    let planes = half_spaces.iter().map(|&(normal, offset)| {
        let length = normal.length();
        (normal / length, offset / length)
    });
    let planes: Vec<(DVec3, f64)> = planes.collect();
    let nearest = planes.iter().min_by(|a, b| a.1.total_cmp(&b.1));
    let Some(across) = nearest.and_then(|(normal, _)| normal.try_normalize()) else {
        return 4.0 / 3.0 * PI * radius.powi(3);
    };
    let (beside, up) = across.any_orthonormal_pair();
    let reach = |direction: DVec3| {
        let each = planes
            .iter()
            .map(|plane| reach_of_segment(radius, *plane, direction));
        each.fold(radius, f64::min)
    };
    let low = DVec2::new(-reach(-across), -reach(-beside));
    let size = (DVec2::new(reach(across), reach(beside)) - low).max(DVec2::ZERO);
    let turned: Vec<(DVec3, f64)> = planes
        .iter()
        .map(|&(normal, offset)| {
            let [x, y, z] = [across, beside, up].map(|axis| normal.dot(axis));
            (DVec3::new(x, y, z), offset)
        })
        .collect();
    let count = as_f64(lines);
    let each = (0..lines).map(|number| {
        // A lattice of the golden ratio: evenly spread along either side of the box, however thin.
        let number = as_f64(number);
        let place = DVec2::new((number * GOLDEN + shift).fract(), (number + 0.5) / count);
        let place = low + size * place;
        let square = radius * radius - place.length_squared();
        within(place, square.max(0.0).sqrt(), &turned)
    });
    each.sum::<f64>() * size.x * size.y / count
}

/// Returns how far a ball around 0, cut by a half-space (unit normal, offset), reaches along a unit vector.
fn reach_of_segment(radius: f64, (normal, offset): (DVec3, f64), direction: DVec3) -> f64 {
    let cos = normal.dot(direction);
    if radius * cos <= offset {
        return radius;
    }
    // Along the circle in which the plane cuts the ball.
    let rim = (radius - offset) * (radius + offset);
    offset * cos + (rim * (1.0 - cos * cos)).max(0.0).sqrt()
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
