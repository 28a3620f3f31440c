//! Islands: groups of bodies that empty space separates in a slice.

use super::form::SliceBounds;
use crate::bounds::MovingFrame;
use crate::broad_phase::BodyBox;
use crate::count::{as_f64, short, whole};
use glam::{DVec3, Vec3};

/// Two or more boxes that are separated from all others by a gap on some axis.
#[derive(Debug)]
pub(super) struct Island {
    /// Places in the [bounds](SliceBounds) of the slice, ascending.
    places: Vec<u32>,
}

impl SliceBounds {
    /// Returns the islands that the boxes make, or `None` if one of them has all bodies. Pairs of bodies that may be near each
    /// other are in one island.
    pub(super) fn islands(&self) -> Option<Vec<Island>> {
        /// Axes without a gap, one after another, of an island that is not divided.
        const AXES: usize = 3;
        let all = self.each_body().len();
        let places: Vec<u32> = (0..short(self.boxes.len())).collect();
        let (mut islands, mut groups) = (Vec::new(), vec![(places, 0, 0)]);
        while let Some((places, axis, tried)) = groups.pop() {
            let next = (axis + 1) % AXES;
            match split(&self.boxes, &places, axis) {
                Some(parts) => {
                    let parts = parts.into_iter().filter(|part| part.len() > 1);
                    groups.extend(parts.map(|part| (part, next, 0)));
                }
                None if tried + 1 < AXES => groups.push((places, next, tried + 1)),
                None => islands.push(Island { places }),
            }
        }
        let is_smaller = |island: &Island| island.bodies(self).len() < all;
        islands.iter().all(is_smaller).then_some(islands)
    }
}

impl Island {
    /// Returns the bodies, each once, ascending.
    pub(super) fn bodies(&self, bounds: &SliceBounds) -> Vec<u32> {
        let places = self.places.iter();
        let mut bodies: Vec<u32> = places.map(|&place| bounds.bodies[place as usize]).collect();
        // A body may have another place, behind those of all.
        bodies.sort_unstable();
        bodies.dedup();
        bodies
    }

    /// Returns a frame amid the island that goes along with most of its bodies in an interval (s). It has the unit of the
    /// `frame` of the bounds.
    pub(super) fn frame(
        &self,
        bounds: &SliceBounds,
        interval: (f64, f64),
        frame: &MovingFrame,
    ) -> MovingFrame {
        let (low, high) = hull(&bounds.boxes, &self.places);
        let change = |place: &u32| bounds.fat_lines[*place as usize].change;
        let mut changes: Vec<_> = self.places.iter().map(change).collect();
        let half = changes.len() / 2;
        let median = [0, 1, 2].map(|axis| {
            let order = |x: &[f32; 3], y: &[f32; 3]| x[axis].total_cmp(&y[axis]);
            let (_, median, _) = changes.select_nth_unstable_by(half, order);
            f64::from(median[axis])
        });
        let middle = 0.5 * low.as_dvec3() + 0.5 * high.as_dvec3();
        frame.placed_at(middle, DVec3::from_array(median), interval)
    }
}

/// Returns the smallest and the largest coordinates of the boxes at some places.
fn hull(boxes: &[BodyBox], places: &[u32]) -> (Vec3, Vec3) {
    let nothing = (Vec3::INFINITY, Vec3::NEG_INFINITY);
    places.iter().fold(nothing, |(low, high), &place| {
        let aabb = &boxes[place as usize].aabb;
        let (mins, maxs) = (aabb.mins.to_array(), aabb.maxs.to_array());
        (low.min(mins.into()), high.max(maxs.into()))
    })
}

/// Returns the places of boxes in groups that gaps on an axis separate, or `None` if there is no gap. Narrow gaps do not
/// count.
fn split(boxes: &[BodyBox], places: &[u32], axis: usize) -> Option<Vec<Vec<u32>>> {
    /// Cells of equal width between the extremes. A gap counts if it holds a cell.
    const CELLS: usize = 256;
    let (low, high) = hull(boxes, places);
    let (low, high) = (f64::from(low[axis]), f64::from(high[axis]));
    let per_length = as_f64(CELLS) / (high - low);
    if !per_length.is_finite() {
        return None;
    }
    // It never decreases: boxes that overlap have a cell in common, whatever its rounding.
    let cell = |coordinate: f32| {
        let number = whole((f64::from(coordinate) - low) * per_length);
        (number as usize).min(CELLS - 1)
    };
    let cells = |place: u32| {
        let aabb = &boxes[place as usize].aabb;
        let ends = [aabb.mins, aabb.maxs];
        ends.map(|corner| cell(corner.to_array()[axis]))
    };
    // How many more boxes are in a cell than in the one before.
    let mut changes = [0_i64; CELLS + 1];
    for [first, last] in places.iter().map(|&place| cells(place)) {
        changes[first] += 1;
        changes[last + 1] -= 1;
    }
    let (mut groups, mut count, mut group_of) = (0, 0, [0; CELLS]);
    for (group, change) in group_of.iter_mut().zip(changes) {
        groups += usize::from(count == 0 && change > 0);
        count += change;
        *group = groups;
    }
    if groups < 2 {
        return None;
    }
    let mut parts = vec![Vec::new(); groups];
    for &place in places {
        let [first, _] = cells(place);
        parts[group_of[first] - 1].push(place);
    }
    Some(parts)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bounds::FatLine;
    use parry3d::bounding_volume::{Aabb, BoundingVolume};
    use rand::rngs::ChaCha8Rng;
    use rand::{RngExt, SeedableRng};

    /// Boxes that overlap are in one island, and groups with wide gaps between them are in several.
    #[test]
    fn overlapping_boxes_are_in_one_island() {
        let mut divided = 0;
        for seed in 0..200 {
            let mut rng = ChaCha8Rng::seed_from_u64(seed);
            let mut vector =
                |half: f32| [0; 3].map(|_| rng.random_range(-half..=half) * f32::from(half > 0.0));
            let groups: Vec<_> = (0..1 + seed % 7).map(|_| vector(100.0)).collect();
            let size = [0.0, 1.0, 10.0, 200.0][groups.len() % 4];
            let mut bounds = SliceBounds::default();
            for body in 0..60 {
                let (group, own) = (groups[body as usize % groups.len()], vector(5.0));
                let half = vector(size).map(f32::abs);
                let corner =
                    |sign: f32| Vec3::from(group) + Vec3::from(own) + sign * Vec3::from(half);
                let aabb = Aabb::new(corner(-1.0), corner(1.0));
                bounds.push(body, (FatLine::default(), aabb));
            }
            let Some(islands) = bounds.islands() else {
                continue;
            };
            divided += 1;
            let island_of = |place: u32| islands.iter().position(|one| one.places.contains(&place));
            for a in 0..60 {
                for b in 0..a {
                    let [box_a, box_b] = [a, b].map(|place| &bounds.boxes[place as usize].aabb);
                    if box_a.intersects(box_b) {
                        assert!(
                            island_of(a).is_some() && island_of(a) == island_of(b),
                            "{seed}"
                        );
                    }
                }
            }
        }
        assert!(divided > 80, "{divided}");
    }
}
