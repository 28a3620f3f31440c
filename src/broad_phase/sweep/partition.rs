//! Division of boxes among parts of space.

use std::ops::Range;

use super::region::Region;
use crate::broad_phase::BodyBox;

/// Boxes divided among the parts between planes, with a copy for each part that a box reaches.
#[derive(Clone, Debug, Default)]
pub(super) struct Partition {
    /// Axis that the planes cross.
    pub(super) axis: usize,
    /// Positions of the planes, ascending and different.
    pub(super) planes: Vec<f32>,
    pub(super) boxes: Vec<BodyBox>,
    /// Ends of the boxes of each part.
    ends: Vec<usize>,
    /// Range of the parts that each box reaches.
    parts_of_boxes: Vec<Range<usize>>,
}

impl Partition {
    /// Divides boxes at the planes, and subtracts the copies from `copies_left`.
    ///
    /// Returns `false`, with the boxes undivided, if that would hardly help or not enough copies
    /// are left: if a part keeps nearly all boxes, or too many boxes reach into several parts.
    pub(super) fn divide(&mut self, boxes: &[BodyBox], copies_left: &mut usize) -> bool {
        let Self {
            axis,
            planes,
            ends,
            parts_of_boxes,
            ..
        } = self;
        // A part includes its low plane, but not its high one.
        let part_of = |coordinate| planes.partition_point(|&plane| plane <= coordinate);
        let parts_of = |one: &BodyBox| {
            let [low, high] = [one.aabb.mins, one.aabb.maxs].map(|corner| part_of(corner[*axis]));
            low..high + 1
        };
        parts_of_boxes.clear();
        parts_of_boxes.extend(boxes.iter().map(parts_of));
        ends.clear();
        ends.resize(planes.len() + 1, 0);
        for parts in parts_of_boxes.iter() {
            for part in parts.clone() {
                ends[part] += 1;
            }
        }
        let largest = ends.iter().copied().max().unwrap_or(0);
        let total: usize = ends.iter().sum();
        if largest > boxes.len() / 8 * 7 || total > boxes.len() / 2 * 3 || total > *copies_left {
            return false;
        }
        let Some(&filler) = boxes.first() else {
            return false;
        };
        *copies_left -= total;
        self.boxes.clear();
        self.boxes.resize(total, filler);
        let mut sum = 0;
        for end in ends.iter_mut() {
            sum += std::mem::replace(end, sum);
        }
        for (one, parts) in boxes.iter().zip(parts_of_boxes) {
            for part in parts.clone() {
                self.boxes[ends[part]] = *one;
                ends[part] += 1;
            }
        }
        true
    }

    /// Returns the boxes of each part in order, and the part's region within the given one.
    pub(super) fn iter(&self, region: Region) -> impl Iterator<Item = (&[BodyBox], Region)> {
        let planes = &self.planes;
        (0..self.ends.len()).map(move |part| {
            let start = part.checked_sub(1).map_or(0, |before| self.ends[before]);
            let low = part
                .checked_sub(1)
                .map_or(f32::NEG_INFINITY, |before| planes[before]);
            let high = planes.get(part).copied().unwrap_or(f32::INFINITY);
            let region = region.between(self.axis, low, high);
            (&self.boxes[start..self.ends[part]], region)
        })
    }
}

#[cfg(test)]
mod tests {
    use parry3d::bounding_volume::Aabb;
    use parry3d::math::Vector;

    use super::*;

    fn boxes() -> Vec<BodyBox> {
        // Unit cubes at 0, 2, 4 ... 38 and one box along them all.
        (0..20_u8)
            .map(|i| {
                let low = Vector::new(0.0, 2.0 * f32::from(i), 0.0);
                BodyBox {
                    aabb: Aabb::new(low, low + 1.0),
                    body: u32::from(i),
                }
            })
            .chain([BodyBox {
                aabb: Aabb::new(Vector::ZERO, Vector::splat(100.0)),
                body: 20,
            }])
            .collect()
    }

    fn divided(planes: &[f32]) -> Option<Vec<usize>> {
        let mut parts = Partition {
            axis: 1,
            ..Partition::default()
        };
        parts.planes.extend(planes);
        parts.divide(&boxes(), &mut 100).then(|| {
            let lengths = parts.iter(Region::EVERYWHERE).map(|(part, _)| part.len());
            lengths.collect()
        })
    }

    #[test]
    fn boxes_go_to_every_part_they_reach() {
        // The box that ends at 21 touches the plane, so it has a copy on both sides of it.
        assert_eq!(divided(&[21.0]), Some(vec![12, 11]));
        assert_eq!(divided(&[21.5]), Some(vec![12, 10]));
        assert_eq!(divided(&[10.0, 20.0]), Some(vec![6, 6, 11]));
    }

    #[test]
    fn what_does_not_help_is_refused() {
        assert_eq!(divided(&[3.5]), None, "a part with nearly all boxes");
        let everywhere: Vec<f32> = (0..16_u8).map(|i| 2.5 * f32::from(i)).collect();
        assert_eq!(divided(&everywhere), None, "too many copies");
        let mut parts = Partition {
            axis: 1,
            ..Partition::default()
        };
        parts.planes.push(21.5);
        assert!(
            !parts.divide(&boxes(), &mut 21),
            "more copies than are left"
        );
        assert!(parts.divide(&boxes(), &mut 22));
    }

    #[test]
    fn regions_of_parts_share_planes_and_nothing_else() {
        let mut parts = Partition::default();
        parts.planes.push(21.0);
        parts.axis = 1;
        assert!(parts.divide(&boxes(), &mut 100));
        let regions: Vec<Region> = parts
            .iter(Region::EVERYWHERE)
            .map(|(_, region)| region)
            .collect();
        let boxes = boxes();
        for one in &boxes {
            for other in &boxes {
                let owners = regions.iter().filter(|region| region.owns(one, other));
                assert_eq!(owners.count(), 1);
            }
        }
    }
}
