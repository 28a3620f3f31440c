//! Surfaces of polygons, and what is left of them on one side of a plane.

use glam::DVec3;

/// A plane and its inner side, `normal . x <= offset`.
#[derive(Clone, Copy, Debug)]
pub(super) struct OrientedPlane {
    /// The direction outward; its length is 1 to rounding.
    pub(super) normal: DVec3,
    pub(super) offset: f64,
}

impl OrientedPlane {
    /// Returns the distance by which a point lies outside; negative inside.
    pub(super) fn height(&self, point: DVec3) -> f64 {
        self.normal.dot(point) - self.offset
    }
}

/// Oriented polygons. If the surface is closed, each edge is passed once in either direction.
///
/// Polygons in one plane that a cut made together are one face: pieces of a whole, and holes in it.
#[derive(Clone, Debug, Default)]
pub(super) struct Surface {
    pub(super) points: Vec<DVec3>,
    /// The points of all polygons, by number, one polygon after another.
    corners: Vec<usize>,
    /// The end of each polygon in the list of corners.
    ends: Vec<usize>,
    /// True for each polygon that begins a face.
    begins_face: Vec<bool>,
    /// A closed surface bounds a volume, and stays closed when it is clipped.
    closed: bool,
}

/// Buffers of [`Surface::clip`].
#[derive(Clone, Debug, Default)]
pub(super) struct ClipScratch {
    heights: Vec<f64>,
    /// New number of each point that stays.
    numbers: Vec<usize>,
    /// Edges that cross the plane, each once: the point inside and the one outside.
    crossings: Vec<(usize, usize)>,
    /// Edges of the polygons that close the cut: first and last point.
    cut: Vec<(usize, usize)>,
    /// The face being kept: the number of corners and of polygons before it, and its crossings; an
    /// exit is marked with true.
    before_face: (usize, usize),
    face_crossings: Vec<(usize, bool)>,
    result: Surface,
}

impl Surface {
    pub(super) fn new(points: Vec<DVec3>, closed: bool) -> Self {
        Self {
            points,
            closed,
            ..Self::default()
        }
    }

    pub(super) const fn is_closed(&self) -> bool {
        self.closed
    }

    pub(super) fn push_polygon(&mut self, corners: impl IntoIterator<Item = usize>) {
        self.corners.extend(corners);
        self.end_polygon(true);
    }

    fn end_polygon(&mut self, begins_face: bool) {
        self.ends.push(self.corners.len());
        self.begins_face.push(begins_face);
    }

    pub(super) fn polygons(&self) -> impl Iterator<Item = &[usize]> {
        let starts = std::iter::once(0).chain(self.ends.iter().copied());
        starts
            .zip(&self.ends)
            .map(|(start, &end)| &self.corners[start..end])
    }

    /// Replaces this surface by a copy of another one, in the memory that it has.
    pub(super) fn copy_from(&mut self, other: &Self) {
        self.points.clone_from(&other.points);
        self.corners.clone_from(&other.corners);
        self.ends.clone_from(&other.ends);
        self.begins_face.clone_from(&other.begins_face);
        self.closed = other.closed;
    }

    fn clear(&mut self, closed: bool) {
        self.points.clear();
        self.corners.clear();
        self.ends.clear();
        self.begins_face.clear();
        self.closed = closed;
    }

    /// Returns the largest distance of the points from a place, 0 without points.
    pub(super) fn farthest(&self, from: DVec3) -> f64 {
        let squares = self.points.iter().map(|&at| at.distance_squared(from));
        squares.fold(0.0, f64::max).sqrt()
    }

    /// Returns a normal for each point: of the polygons around the point, weighted by area.
    pub(super) fn normals(&self) -> Vec<DVec3> {
        let mut normals = vec![DVec3::ZERO; self.points.len()];
        for polygon in self.polygons() {
            let areas = fan(polygon).map(|corners| {
                let [a, b, c] = corners.map(|corner| self.points[corner]);
                (b - a).cross(c - a)
            });
            let area: DVec3 = areas.sum();
            for &corner in polygon {
                normals[corner] += area;
            }
        }
        let outward = if self.volume() < 0.0 { -1.0 } else { 1.0 };
        let unit = |normal: DVec3| normal.normalize_or_zero() * outward;
        normals.into_iter().map(unit).collect()
    }

    /// Returns the volume that a closed surface bounds.
    pub(super) fn volume(&self) -> f64 {
        let of_polygon = |polygon: &[usize]| -> f64 {
            let volumes = fan(polygon).map(|corners| {
                let [a, b, c] = corners.map(|corner| self.points[corner]);
                a.dot(b.cross(c))
            });
            volumes.sum()
        };
        self.polygons().map(of_polygon).sum::<f64>() / 6.0
    }

    /// Removes what lies outside a half-space. A closed surface is closed again along the plane.
    /// Returns true if anything was removed.
    pub(super) fn clip(&mut self, plane: &OrientedPlane, scratch: &mut ClipScratch) -> bool {
        let heights = &mut scratch.heights;
        heights.clear();
        heights.extend(self.points.iter().map(|&point| plane.height(point)));
        let highest = heights.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        if highest <= 0.0 {
            return false;
        }
        scratch.result.clear(self.closed);
        self.keep_points(scratch);
        self.cross_edges(scratch);
        self.keep_polygons(scratch);
        if self.closed {
            join(&mut scratch.cut, &mut scratch.result);
        }
        std::mem::swap(self, &mut scratch.result);
        true
    }

    fn keep_points(&self, scratch: &mut ClipScratch) {
        scratch.numbers.clear();
        for (&point, &height) in self.points.iter().zip(&scratch.heights) {
            scratch.numbers.push(scratch.result.points.len());
            if height <= 0.0 {
                scratch.result.points.push(point);
            }
        }
    }

    /// Makes one point for each edge that crosses the plane, whichever polygons share the edge.
    fn cross_edges(&self, scratch: &mut ClipScratch) {
        let heights = &scratch.heights;
        scratch.crossings.clear();
        for polygon in self.polygons() {
            for (from, to) in edges(polygon) {
                match (heights[from] <= 0.0, heights[to] <= 0.0) {
                    (true, false) => scratch.crossings.push((from, to)),
                    (false, true) => scratch.crossings.push((to, from)),
                    _ => {}
                }
            }
        }
        scratch.crossings.sort_unstable();
        scratch.crossings.dedup();
        for &(inside, outside) in &scratch.crossings {
            let share = heights[inside] / (heights[inside] - heights[outside]);
            let point = self.points[inside].lerp(self.points[outside], share);
            scratch.result.points.push(point);
        }
    }

    fn keep_polygons(&self, scratch: &mut ClipScratch) {
        scratch.cut.clear();
        scratch.end_face();
        for (polygon, &begins_face) in self.polygons().zip(&self.begins_face) {
            if begins_face {
                scratch.end_face();
            }
            scratch.keep_polygon(polygon);
        }
        scratch.end_face();
    }
}

impl ClipScratch {
    /// Keeps a polygon's part inside. Each exit is joined to the next entrance of the polygon.
    fn keep_polygon(&mut self, polygon: &[usize]) {
        let Self {
            heights,
            numbers,
            crossings,
            result,
            ..
        } = self;
        let first_new = result.points.len() - crossings.len();
        let before = result.corners.len();
        for (from, to) in edges(polygon) {
            let inside = heights[from] <= 0.0;
            if inside {
                result.corners.push(numbers[from]);
            }
            if inside == (heights[to] <= 0.0) {
                continue;
            }
            let edge = if inside { (from, to) } else { (to, from) };
            let at = first_new + crossings.partition_point(|&other| other < edge);
            result.corners.push(at);
            self.face_crossings.push((at, inside));
        }
        if result.corners.len() > before {
            result.end_polygon(result.ends.len() == self.before_face.1);
        }
    }

    /// Notes where the face is cut, and begins the next one.
    fn end_face(&mut self) {
        match self.face_crossings[..] {
            [] => {}
            [one, other] => self.cut.push(cut_edge(one, other)),
            _ => self.cut_face_along_line(),
        }
        self.face_crossings.clear();
        self.before_face = (self.result.corners.len(), self.result.ends.len());
    }

    /// Joins the exits of a face to entrances as they follow each other along the cut, not along the
    /// polygons: edges of the cut then lie within the face.
    ///
    /// An exit and an entrance between which the face lies are neighbours along the line, or
    /// such pairs are between them, or (where the face covers itself) others of their kinds.
    fn cut_face_along_line(&mut self) {
        let Self {
            crossings,
            cut,
            before_face,
            face_crossings,
            result,
            ..
        } = self;
        let points = &result.points;
        let ends = face_crossings.iter().map(|&(at, _)| points[at]);
        let low = ends.clone().fold(DVec3::INFINITY, DVec3::min);
        let high = ends.fold(DVec3::NEG_INFINITY, DVec3::max);
        let axis = (high - low).max_position();
        let place = |&(at, is_exit): &(usize, bool)| (points[at][axis], at, is_exit);
        face_crossings.sort_unstable_by(|a, b| {
            let (a, b) = (place(a), place(b));
            a.0.total_cmp(&b.0).then((a.1, a.2).cmp(&(b.1, b.2)))
        });
        // An exit joined to an entrance is an edge of two new points; no other is.
        let first_new = points.len() - crossings.len();
        let of_face = result.polygons().skip(before_face.1).flat_map(edges);
        let kept = of_face.filter(|&(from, to)| from < first_new || to < first_new);
        let mut kept: Vec<(usize, usize)> = kept.collect();
        let mut open: Vec<(usize, bool)> = Vec::new();
        for &crossing in face_crossings.iter() {
            match open.pop() {
                Some(other) if other.1 != crossing.1 => {
                    let edge = cut_edge(other, crossing);
                    kept.push((edge.1, edge.0));
                    cut.push(edge);
                }
                other => open.extend(other.into_iter().chain([crossing])),
            }
        }
        result.corners.truncate(before_face.0);
        result.ends.truncate(before_face.1);
        result.begins_face.truncate(before_face.1);
        join(&mut kept, result);
    }
}

/// Returns the edge of the cut from an entrance to an exit.
const fn cut_edge(one: (usize, bool), other: (usize, bool)) -> (usize, usize) {
    if one.1 {
        (other.0, one.0)
    } else {
        (one.0, other.0)
    }
}

/// Joins edges to the polygons of a face.
fn join(edges: &mut Vec<(usize, usize)>, result: &mut Surface) {
    let before = result.ends.len();
    edges.sort_unstable();
    while let Some((first, mut last)) = edges.pop() {
        result.corners.push(first);
        while last != first {
            let next = edges.partition_point(|&(start, _)| start < last);
            if edges.get(next).is_none_or(|&(start, _)| start != last) {
                break;
            }
            result.corners.push(last);
            last = edges.remove(next).1;
        }
        result.end_polygon(result.ends.len() == before);
    }
}

/// Returns true if there are polygons, and each edge is passed as often one way as the other.
pub(super) fn is_closed<'a>(polygons: impl Iterator<Item = &'a [usize]>) -> bool {
    let mut passed: Vec<_> = polygons.flat_map(edges).collect();
    let mut back: Vec<_> = passed.iter().map(|&(from, to)| (to, from)).collect();
    passed.sort_unstable();
    back.sort_unstable();
    !passed.is_empty() && passed == back
}

/// Returns the triangles of a polygon that share its first corner.
pub(super) fn fan(polygon: &[usize]) -> impl Iterator<Item = [usize; 3]> {
    let pairs = polygon[1..].windows(2);
    pairs.map(|pair| [polygon[0], pair[0], pair[1]])
}

fn edges(polygon: &[usize]) -> impl Iterator<Item = (usize, usize)> {
    let next = polygon.iter().skip(1).chain(polygon.first());
    polygon.iter().copied().zip(next.copied())
}
