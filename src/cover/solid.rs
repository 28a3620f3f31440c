//! A shape as the cover sees it: parts in a unit of their own size.

use super::convex::Convex;
use super::form::SolidForm;
use super::mesh::Mesh;
use super::surface::Surface;
use crate::hitbox::Sphere;
use crate::parallel;
use glam::DVec3;

/// The parts of a shape, moved and scaled to the order of one.
#[derive(Clone, Debug)]
pub(super) struct Solid {
    pub(super) parts: Vec<SolidPart>,
    /// The point that became 0.
    pub(super) origin: DVec3,
    /// Power of two by which all lengths were divided.
    pub(super) unit: f64,
    /// Largest distance of two points, rounded down. In this unit, as all lengths.
    pub(super) diameter: f64,
    /// Corners of a box around all parts.
    pub(super) low: DVec3,
    pub(super) high: DVec3,
    /// Parts that are balls, as they were given; `None` for others, and if a number was rounded.
    pub(super) balls: Vec<Option<Sphere>>,
    /// True if no number was rounded when the parts were placed.
    pub(super) is_exact: bool,
    /// Bound of the error of surfaces and bounds: roundings of the corners.
    pub(super) rounding: f64,
    /// No point of a hull is farther from what its polygons bound, rounding apart.
    pub(super) unevenness: f64,
}

#[derive(Clone, Debug)]
pub(super) enum SolidPart {
    Convex(Convex),
    Mesh(Mesh),
}

impl SolidPart {
    pub(super) fn is_volume(&self) -> bool {
        match self {
            Self::Convex(_) => true,
            Self::Mesh(mesh) => mesh.is_closed(),
        }
    }

    /// Returns a surface that contains the part; a round one has `around` sides.
    pub(super) fn surface(&self, around: u32) -> Surface {
        match self {
            Self::Convex(convex) => convex.polyhedron(around),
            Self::Mesh(mesh) => mesh.surface(),
        }
    }

    pub(super) const fn is_round(&self) -> bool {
        match self {
            Self::Convex(convex) => !matches!(convex.form(), SolidForm::Hull { .. }),
            Self::Mesh(_) => false,
        }
    }

    /// Returns true if the signed distance is not positive. No mesh is asked how far its surface is.
    fn contains(&self, at: DVec3) -> bool {
        match self {
            Self::Convex(convex) => convex.contains(at),
            Self::Mesh(mesh) => mesh.is_closed() && mesh.crossings(at) != 0 || mesh.has(at),
        }
    }

    /// Returns an upper bound of the signed distance, and about its gradient. Far from edges of
    /// a mesh seen from above it is the distance.
    pub(super) fn signed_distance(&self, at: DVec3) -> (f64, DVec3) {
        match self {
            Self::Convex(convex) => convex.signed_distance(at),
            Self::Mesh(mesh) => {
                let way = at - mesh.nearest(at);
                let inside = mesh.is_closed() && mesh.crossings(at) != 0;
                let sign = if inside { -1.0 } else { 1.0 };
                (sign * way.length(), sign * way.normalize_or_zero())
            }
        }
    }
}

impl Solid {
    /// Takes forms, each with a bound of the sums that were rounded when it was placed. Returns `None` if they have no
    /// points, or points that are not finite.
    pub(super) fn new(placed: Vec<(SolidForm, f64)>) -> Option<Self> {
        let reach = placed.iter().map(|&(_, reach)| reach).fold(0.0, f64::max);
        let balls = placed.iter().map(ball).collect();
        let mut forms: Vec<SolidForm> = placed.into_iter().map(|(form, _)| form).collect();
        let join = |a: (DVec3, DVec3), b: (DVec3, DVec3)| (a.0.min(b.0), a.1.max(b.1));
        let (low, high) = forms.iter().map(SolidForm::corners).reduce(join)?;
        // Corners are the least and largest of numbers: no NaN is among them.
        let points = || forms.iter().flat_map(SolidForm::extremes);
        if !(low.is_finite() && high.is_finite()) || points().any(|(point, _)| point.is_nan()) {
            return None;
        }
        let origin = low.midpoint(high);
        let extent = (high - low).max_element();
        // A point has no size; the smallest f32 are scaled as far as needed.
        let unit = if extent > 0.0 {
            extent.log2().floor().exp2()
        } else {
            1.0
        };
        let far = low.abs().max(high.abs()).max_element().max(reach) / unit;
        for form in &mut forms {
            form.normalise(origin, unit);
        }
        let diameter = diameter(&forms);
        let parts: Vec<SolidPart> = forms.into_iter().map(part).collect();
        let uneven = parts.iter().map(|part| match part {
            SolidPart::Convex(convex) => convex.unevenness,
            SolidPart::Mesh(_) => 0.0,
        });
        Some(Self {
            rounding: 64.0 * f64::EPSILON * (1.0 + far),
            unevenness: uneven.fold(0.0, f64::max),
            parts,
            balls,
            is_exact: reach <= 0.0,
            origin,
            unit,
            diameter,
            low: (low - origin) / unit,
            high: (high - origin) / unit,
        })
    }

    pub(super) fn is_volume(&self) -> bool {
        self.parts.iter().all(SolidPart::is_volume)
    }

    /// Returns surfaces that contain the parts. Round ones have `around` sides.
    pub(super) fn surfaces(&self, around: u32) -> Vec<Surface> {
        self.parts.iter().map(|part| part.surface(around)).collect()
    }

    /// Returns an upper bound of the signed distance, and about its gradient.
    pub(super) fn signed_distance(&self, at: DVec3) -> (f64, DVec3) {
        let distances = self.parts.iter().map(|part| part.signed_distance(at));
        let nearer = |a: (f64, DVec3), b: (f64, DVec3)| if b.0 < a.0 { b } else { a };
        distances
            .reduce(nearer)
            .unwrap_or((f64::INFINITY, DVec3::ZERO))
    }

    /// Returns true if [`signed_distance`](Self::signed_distance) is not positive.
    pub(super) fn contains(&self, at: DVec3) -> bool {
        self.parts.iter().any(|part| part.contains(at))
    }

    /// Returns, for each place, an upper bound of the signed distance that holds without exception.
    pub(super) fn certain_distances(&self, places: &[DVec3]) -> Vec<f64> {
        // Nearer to the surface the side may be wrong. At this distance the angle of a sliver that passes the
        // place is off by 0.0002. A wrong side takes 2 pi: 30,000 such slivers.
        const NO_SIDE: f64 = 1e-5;
        let one = |(): &mut (), place: usize| {
            let at = places[place];
            let distances = self.parts.iter().map(|part| match part {
                SolidPart::Mesh(mesh) => {
                    let depth = mesh.clear_distance(at);
                    if depth > NO_SIDE && mesh.winding(at).abs() >= 0.5 {
                        -depth
                    } else {
                        mesh.nearest(at).distance(at)
                    }
                }
                SolidPart::Convex(convex) => convex.signed_distance(at).0,
            });
            distances.fold(f64::INFINITY, f64::min) + self.rounding
        };
        parallel::map(places.len(), || (), one)
    }
}

/// Returns the ball that a form is, maybe of radius 0, if nothing was rounded.
fn ball((form, rounded): &(SolidForm, f64)) -> Option<Sphere> {
    match form {
        _ if *rounded > 0.0 => None,
        SolidForm::Capsule { ends, radius } => (ends[0] == ends[1]).then_some(Sphere {
            offset: ends[0],
            radius: *radius,
        }),
        // Others are balls if they are points.
        SolidForm::Round(_) | SolidForm::Hull { .. } | SolidForm::Mesh { .. } => {
            let (low, high) = form.corners();
            (low == high).then_some(Sphere {
                offset: low,
                radius: 0.0,
            })
        }
    }
}

fn part(form: SolidForm) -> SolidPart {
    match form {
        SolidForm::Mesh { points, triangles } => SolidPart::Mesh(Mesh::new(points, triangles)),
        convex => {
            let convex = Convex::new(convex);
            // Planes of faces do not bound a depth where there is none, nor a distance.
            match convex.flat_triangles() {
                Some((points, triangles)) => SolidPart::Mesh(Mesh::new(points, triangles)),
                None => SolidPart::Convex(convex),
            }
        }
    }
}

/// Returns the largest distance of two points, or somewhat less.
fn diameter(forms: &[SolidForm]) -> f64 {
    const DIRECTIONS: i32 = 512;
    let single = forms
        .iter()
        .filter_map(SolidForm::diameter)
        .fold(0.0, f64::max);
    if let [form] = forms
        && let Some(diameter) = form.diameter()
    {
        return diameter;
    }
    let points: Vec<(DVec3, f64)> = forms.iter().flat_map(SolidForm::extremes).collect();
    let apart = |a: &(DVec3, f64), b: &(DVec3, f64)| a.0.distance(b.0) + a.1 + b.1;
    let farthest = |from: &(DVec3, f64)| {
        let distances = points.iter().map(|point| apart(from, point));
        distances.fold(0.0, f64::max)
    };
    if points.len() <= 1_024 {
        return points.iter().map(farthest).fold(single, f64::max);
    }
    // Directions all around, by the golden angle.
    let outermost = (0..DIRECTIONS).filter_map(|number| {
        let height = (2.0 * f64::from(number) + 1.0) / f64::from(DIRECTIONS) - 1.0;
        let (sin, cos) = (2.399_963_229_728_653 * f64::from(number)).sin_cos();
        let away = (1.0 - height * height).sqrt();
        let direction = DVec3::new(away * cos, away * sin, height);
        let reach = |point: &&(DVec3, f64)| point.0.dot(direction) + point.1;
        points.iter().max_by(|a, b| reach(a).total_cmp(&reach(b)))
    });
    outermost.map(farthest).fold(single, f64::max)
}

#[cfg(test)]
mod tests {
    use super::super::random::Random;
    use super::*;

    /// Places in needles of four triangles and near them, where neither the nearest point of a triangle nor the
    /// side of the surface is easy to tell.
    #[test]
    fn distances_from_needles_are_certain() {
        let mut random = Random::new(1, 0);
        for trial in 0..3_000 {
            let width = 10_f64.powf(-9.0 + 4.0 * random.unit());
            let size = DVec3::new(1.0, width, width);
            let points = (0..4).map(|_| random.point(-size, size)).collect();
            let triangles = vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]];
            let form = SolidForm::Mesh { points, triangles };
            let Some(solid) = Solid::new(vec![(form, 0.0)]) else {
                unreachable!()
            };
            let reach = DVec3::new(1.1, 1.5 * width, 1.5 * width);
            let places: Vec<DVec3> = (0..20).map(|_| random.point(-reach, reach)).collect();
            let local: Vec<DVec3> = places
                .iter()
                .map(|&place| (place - solid.origin) / solid.unit)
                .collect();
            let distances = solid.certain_distances(&local);
            for (place, distance) in places.into_iter().zip(distances) {
                // The needle is in a box, which is farther away.
                let of_box = (place.abs() - size).max_element();
                let distance = distance * solid.unit;
                assert!(
                    distance >= of_box,
                    "{trial} {width:e}: {place} {distance:e} {of_box:e}"
                );
            }
        }
    }
}
