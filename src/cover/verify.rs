//! A verdict on given spheres: do they contain a shape?

use super::cells::CellScratch;
use super::error::CoverError;
use super::form::SolidForm;
use super::nearest_point::nearest_on_segment;
use super::read::read;
use super::solid::{Solid, SolidPart};
use super::surface::Surface;
use super::wedge::{Wedge, wedges};
use crate::count::as_f64;
use crate::hitbox::{Hitbox, Sphere};
use glam::DVec3;
use parry3d::shape::Shape;

/// The verdict on spheres that should contain a shape.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Coverage {
    /// Proven: each point of the shape is in a sphere.
    Covered,
    /// The shape has a point that no sphere contains.
    Uncovered {
        /// The point in the shape's frame, m. It is in the shape to 1e-10 of the shape's diameter, and 1e-13 of
        /// its distance from the origin of its frame.
        point: DVec3,
    },
    /// Neither is proven. If the spheres were larger by 1e-6 of the shape's diameter (by 1e-6 m, for
    /// a shape that is a point), they would contain it. There are exceptions:
    ///
    /// - Meshes with gaps, where planes between spheres agree to rounding.
    /// - Spheres much smaller than their neighbours.
    /// - Spheres with too few digits for a verdict, see [`verify_cover`].
    /// - Round shapes, where spheres meet so near to the surface that a million comparisons of a sphere with a piece of
    ///   the shape are not enough. A capsule with spheres on its axis needs none.
    /// - Shapes far from the origin of their frame, which rounding moves by up to 1e-13 of their distance.
    Undecided {
        /// A point in doubt, in the shape's frame, m.
        point: DVec3,
    },
}

/// A verdict may stay undecided within this, in diameters.
const FINEST: f64 = 1e-7;

/// A point that is outside of all balls by less than this may be in one, in the solid's unit.
const CERTAIN: f64 = 1e-9;

/// Balls that are compared with pieces of round forms before no more pieces are halved.
const MAX_TESTS: usize = 1 << 20;

/// As many more for each ball, and for each part.
const MORE_TESTS: usize = 1 << 12;

/// As many for a part if one ball contains it but for rounding: nothing farther out can be found.
const FEW_TESTS: usize = 1 << 14;

/// Spheres this many times larger than the shape have too few digits for a verdict: the planes between larger
/// ones may be off by more than shares are enlarged.
const TOO_LARGE: f64 = 1e3;

/// Returns a verdict on spheres that should contain a shape: a user's own, or another tool's.
///
/// Shapes without interior are asked for their surface.
///
/// A sphere more than a thousand times larger than the shape, whose surface passes the shape's box,
/// has too few digits for a verdict: the answer is then `Undecided`. So it is beside a sphere whose numbers would
/// overflow if the shape were scaled to a size of 1.
///
/// ```
/// use nearmiss::glam::DVec3;
/// use nearmiss::parry3d::shape::Cuboid;
/// use nearmiss::{Coverage, Sphere, verify_cover};
///
/// let cube = Cuboid::new([1.0, 1.0, 1.0].into());
/// let around = |radius| [Sphere { offset: DVec3::ZERO, radius }];
/// assert_eq!(verify_cover(&around(1.7321), &cube)?, Coverage::Covered);
/// let verdict = verify_cover(&around(1.7), &cube)?;
/// assert!(matches!(verdict, Coverage::Uncovered { .. }));
/// # Ok::<(), nearmiss::CoverError>(())
/// ```
///
/// # Errors
///
/// - [`CoverError::UnsupportedShape`], [`CoverError::InvalidShape`].
/// - [`CoverError::Sphere`] if there are no spheres, or one that no hitbox can have.
pub fn verify_cover(spheres: &[Sphere], shape: &dyn Shape) -> Result<Coverage, CoverError> {
    let solid = read(shape)?;
    let spheres = Hitbox::cluster(spheres.to_vec())?;
    let mut balls = Balls::default();
    for sphere in spheres.spheres() {
        balls.add(&solid, sphere);
    }
    let verdict = balls.verdict(&solid, spheres.spheres());
    let place = |point: DVec3| solid.origin + point * solid.unit;
    Ok(match verdict {
        Coverage::Covered => Coverage::Covered,
        Coverage::Uncovered { point } if !balls.vague => Coverage::Uncovered {
            point: place(point),
        },
        Coverage::Uncovered { point } | Coverage::Undecided { point } => Coverage::Undecided {
            point: place(point),
        },
    })
}

/// The balls that may contain a part of a solid.
#[derive(Debug, Default)]
struct Balls {
    balls: Vec<(DVec3, f64)>,
    /// A sphere was left out that may contain anything.
    vague: bool,
    /// True if one ball contains the box around the solid.
    contain_all: bool,
    /// Roundings of the balls.
    rounding: f64,
}

impl Balls {
    fn add(&mut self, solid: &Solid, sphere: &Sphere) {
        let centre = (sphere.offset - solid.origin) / solid.unit;
        let radius = sphere.radius / solid.unit;
        if !(centre.is_finite() && radius.is_finite()) {
            self.vague = true;
            return;
        }
        let rounding = 8.0 * f64::EPSILON * (crate::rounding::norm(centre) + radius);
        // The box is rounded as the shape's points are.
        let margin = rounding + solid.rounding;
        let nearest = crate::rounding::norm(centre - centre.clamp(solid.low, solid.high));
        let farthest = (centre - solid.low).abs().max((centre - solid.high).abs());
        if crate::rounding::norm(farthest) + margin <= radius {
            self.contain_all = true;
        } else if nearest - margin > radius {
            // It contains nothing.
        } else if radius.max(crate::rounding::norm(centre)) > TOO_LARGE {
            self.vague = true;
        } else {
            self.balls.push((centre, radius));
            self.rounding = self.rounding.max(rounding);
        }
    }

    /// Drops balls that others contain.
    fn drop_contained(&mut self) {
        let all = std::mem::take(&mut self.balls);
        for (number, &(centre, radius)) in all.iter().enumerate() {
            let is_contained = all
                .iter()
                .enumerate()
                .any(|(other, &(outer, outer_radius))| {
                    let reach = outer.distance(centre) + radius;
                    let is_first = reach < outer_radius || other < number;
                    other != number && reach <= outer_radius && is_first
                });
            if !is_contained {
                self.balls.push((centre, radius));
            }
        }
    }

    fn verdict(&mut self, solid: &Solid, spheres: &[Sphere]) -> Coverage {
        if self.contain_all {
            return Coverage::Covered;
        }
        self.drop_contained();
        let mut verdict = Coverage::Covered;
        let mut tests = MAX_TESTS + MORE_TESTS * (self.balls.len() + solid.parts.len());
        for (part, ball) in solid.parts.iter().zip(&solid.balls) {
            // Exact where the centres are one.
            let is_in = |ball: &Sphere| {
                let mut spheres = spheres.iter();
                spheres.any(|own| own.offset == ball.offset && ball.radius <= own.radius)
            };
            if ball.as_ref().is_some_and(is_in) {
                continue;
            }
            let of_part = match part {
                SolidPart::Convex(convex) if part.is_round() => {
                    self.of_round(solid, convex.form(), &mut tests)
                }
                _ => self.of_polyhedron(solid, part),
            };
            match of_part {
                Coverage::Covered => {}
                Coverage::Undecided { .. } => verdict = of_part,
                Coverage::Uncovered { .. } => return of_part,
            }
        }
        verdict
    }

    /// Returns true if a point of the solid is certainly outside of all balls.
    fn are_left_out(&self, solid: &Solid, point: DVec3) -> bool {
        let margin = CERTAIN + solid.rounding + self.rounding;
        let mut balls = self.balls.iter();
        balls.all(|&(centre, radius)| point.distance(centre) > radius + margin)
    }

    fn of_polyhedron(&self, solid: &Solid, part: &SolidPart) -> Coverage {
        // Where a polygon lies in the plane of a cut, to rounding, the cut may pass a gap of a mesh.
        let is_in_part = |point: DVec3| match part {
            SolidPart::Convex(_) => true,
            SolidPart::Mesh(mesh) => {
                let is_near = mesh.nearest(point).distance(point) <= 1e-10 * solid.diameter;
                is_near || mesh.winding(point).abs() >= 0.5
            }
        };
        let spare = solid.rounding + solid.unevenness + self.rounding;
        match farthest_out(&part.surface(4), &self.balls, spare) {
            None => Coverage::Covered,
            Some(point) if self.are_left_out(solid, point) && is_in_part(point) => {
                Coverage::Uncovered { point }
            }
            Some(point) => Coverage::Undecided { point },
        }
    }

    /// Returns the verdict on a round part. Tests of balls on pieces are taken from those that remain.
    fn of_round(&self, solid: &Solid, form: &SolidForm, remaining: &mut usize) -> Coverage {
        let spare = solid.rounding + self.rounding;
        if self.balls.iter().any(|ball| contains(ball, form, spare)) {
            return Coverage::Covered;
        }
        if let SolidForm::Capsule { ends, radius } = form
            && self.contain_along_axis(*ends, *radius, 4.0 * spare)
        {
            return Coverage::Covered;
        }
        // Smaller pieces would not help against rounding.
        let finest = (FINEST * solid.diameter).max(spare);
        let is_nearly_in = |ball| contains(ball, form, -finest);
        let mut allowed = if self.balls.iter().any(is_nearly_in) {
            FEW_TESTS.min(*remaining)
        } else {
            *remaining
        };
        let mut undecided = None;
        let mut pieces: Vec<(Wedge, Vec<usize>)> = wedges(form)
            .into_iter()
            .map(|piece| (piece, (0..self.balls.len()).collect()))
            .collect();
        while !pieces.is_empty() {
            let mut next = Vec::new();
            for (piece, balls) in pieces {
                let surface = piece.polyhedron();
                let balls = self.relevant(&surface, &balls);
                let few: Vec<_> = balls.iter().map(|&ball| self.balls[ball]).collect();
                // The first pieces are examined in any case.
                allowed = allowed.saturating_sub(few.len());
                *remaining = remaining.saturating_sub(few.len());
                let Some(point) = farthest_out(&surface, &few, spare) else {
                    continue;
                };
                let point = into(form, point);
                if self.are_left_out(solid, point) {
                    return Coverage::Uncovered { point };
                }
                // A point's pieces are points.
                if piece.slack() <= finest || allowed == 0 {
                    undecided.get_or_insert(point);
                } else {
                    next.extend(piece.halves().map(|half| (half, balls.clone())));
                }
            }
            pieces = next;
        }
        undecided.map_or(Coverage::Covered, |point| Coverage::Undecided { point })
    }

    /// Returns true if the balls contain a capsule for this reason: each end of the axis, with the capsule's radius
    /// around it, is in one ball, and each point between is the middle of a disc across the axis, of the same
    /// radius, that is in one ball. Where balls meet just outside of the capsule, all along circles, pieces would
    /// have to be as small as the distance.
    ///
    /// A ball of radius R, whose centre is beside the axis, contains one on the axis of the radius R less the
    /// distance. Discs of radius r are in that one up to sqrt(R² - r²) along the axis.
    fn contain_along_axis(&self, ends: [DVec3; 2], radius: f64, spare: f64) -> bool {
        let way = ends[1] - ends[0];
        let (length, axis) = (way.length(), way.normalize_or_zero());
        let on_axis = self.balls.iter().filter_map(|&(centre, own)| {
            let from_end = centre - ends[0];
            let along = from_end.dot(axis);
            let beside = from_end.distance(axis * along);
            let excess = own - beside - radius - spare;
            (excess >= 0.0).then_some((along, excess))
        });
        let on_axis: Vec<(f64, f64)> = on_axis.collect();
        let is_in_one = |end: f64| {
            let mut balls = on_axis.iter();
            balls.any(|&(along, excess)| (end - along).abs() + spare <= excess)
        };
        let reach = |&(along, excess): &(f64, f64)| {
            let reach = (excess * (excess + 2.0 * radius)).sqrt() - spare;
            (along - reach, along + reach)
        };
        let mut discs: Vec<(f64, f64)> = on_axis.iter().map(reach).collect();
        discs.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut reached = 0.0;
        for (from, to) in discs {
            if from <= reached {
                reached = to.max(reached);
            }
        }
        is_in_one(0.0) && is_in_one(length) && reached >= length
    }

    /// Returns those of some balls that may have the least power somewhere in a polyhedron.
    fn relevant(&self, surface: &Surface, among: &[usize]) -> Vec<usize> {
        let middle = surface.points.iter().sum::<DVec3>() / as_f64(surface.points.len());
        let reach = surface.farthest(middle);
        let power = |ball: usize| {
            let (centre, radius) = self.balls[ball];
            middle.distance_squared(centre) - radius * radius
        };
        let least = among
            .iter()
            .copied()
            .min_by(|&a, &b| power(a).total_cmp(&power(b)));
        let Some(least) = least else {
            return Vec::new();
        };
        let may_be_least = |&ball: &usize| {
            let apart = self.balls[ball].0.distance(self.balls[least].0);
            let (own, other) = (power(ball), power(least));
            own - other <= 2.0 * apart * reach + 1e-12 * (1.0 + own.abs() + other.abs())
        };
        among.iter().copied().filter(may_be_least).collect()
    }
}

/// Returns `None` if each ball contains its share of a closed surface, with some spare; else a point of a share that
/// is out of its ball, the one that is farthest out of all balls.
fn farthest_out(surface: &Surface, balls: &[(DVec3, f64)], spare: f64) -> Option<DVec3> {
    // Shares are rounded outward by less.
    const SHARES: f64 = 5e-11;
    let &first = surface.points.first()?;
    let contains_all =
        |&(centre, radius): &(DVec3, f64)| surface.farthest(centre) + spare + SHARES <= radius;
    if balls.iter().any(contains_all) {
        return None;
    }
    if balls.is_empty() {
        return Some(first);
    }
    let mut scratch = CellScratch::default();
    let out = |point: DVec3| {
        let each = balls
            .iter()
            .map(|&(centre, radius)| point.distance(centre) - radius);
        each.fold(f64::INFINITY, f64::min)
    };
    let mut worst = (f64::NEG_INFINITY, None);
    for (own, &(centre, radius)) in balls.iter().enumerate() {
        scratch.form(surface, own, balls, |_| false);
        for &point in &scratch.share.points {
            if point.distance(centre) + spare + SHARES > radius {
                let out = out(point);
                if out > worst.0 {
                    worst = (out, Some(point));
                }
            }
        }
    }
    worst.1
}

/// Returns true if a ball certainly contains a whole round form.
fn contains(&(centre, radius): &(DVec3, f64), form: &SolidForm, spare: f64) -> bool {
    let beyond = match form {
        SolidForm::Hull { .. } | SolidForm::Mesh { .. } => return false,
        SolidForm::Capsule { ends, radius: own } => {
            ends.map(|end| end.distance(centre))
                .into_iter()
                .fold(0.0, f64::max)
                + own
        }
        SolidForm::Round(round) => {
            let (along, _, away) = round.split(centre);
            let farthest = |(height, own): (f64, f64)| (away + own).hypot((along - height).abs());
            let [lower, upper] = round.ends().map(farthest);
            lower.max(upper)
        }
    };
    beyond * (1.0 + 1e-14) + spare <= radius
}

/// Returns a point of a round form near a point.
fn into(form: &SolidForm, point: DVec3) -> DVec3 {
    // Rounding must not put it outside.
    const INSIDE: f64 = 1.0 - 1e-14;
    match form {
        SolidForm::Hull { .. } | SolidForm::Mesh { .. } => point,
        SolidForm::Capsule { ends, radius } => {
            let nearest = nearest_on_segment(*ends, point);
            nearest + (point - nearest).clamp_length_max(radius * INSIDE)
        }
        SolidForm::Round(round) => {
            let half_height = round.half_height * INSIDE;
            let (along, out, away) = round.split(point);
            let along = along.clamp(-half_height, half_height);
            let share = (along + round.half_height) / (2.0 * round.half_height);
            let [lower, upper] = round.radii;
            let radius = lower + (upper - lower) * if share > 0.0 { share } else { 0.0 };
            let out = out * away.min(radius.max(0.0) * INSIDE);
            round.middle + round.axis * along + out
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A ball nearly contains the form: few tests are made.
    #[test]
    fn tests_of_balls_on_pieces_are_few() {
        let form = SolidForm::Capsule {
            ends: [DVec3::ZERO; 2],
            radius: 1.0,
        };
        let solid = Solid::new(vec![(form.clone(), 0.0)]).unwrap_or_else(|| unreachable!());
        let around = |count: usize, apart: f64| Balls {
            balls: (0..count)
                .map(|number| {
                    let (sin, cos) = (as_f64(number) * 2.4).sin_cos();
                    (DVec3::new(sin, cos, 0.0) * apart, 1.0 - 5e-10)
                })
                .collect(),
            ..Balls::default()
        };
        for balls in [around(1, 1e-12), around(7, 1e-10)] {
            let mut remaining = MAX_TESTS;
            let verdict = balls.of_round(&solid, &form, &mut remaining);
            assert!(matches!(verdict, Coverage::Undecided { .. }), "{verdict:?}");
            // The pieces that are there when no more may be halved are examined.
            let made = MAX_TESTS - remaining;
            assert!(made > 1_000 && made < 4 * FEW_TESTS, "{made}");
            let mut none = 0;
            let verdict = balls.of_round(&solid, &form, &mut none);
            assert!(matches!(verdict, Coverage::Undecided { .. }), "{verdict:?}");
        }
    }
}
