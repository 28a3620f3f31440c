//! Mean sizes of a slice's boxes, which tell whether shorter slices have fewer candidates.

use crate::broad_phase::BodyBox;
use crate::count::as_f64;
use glam::{DVec2, DVec3};

/// The arithmetic and the geometric mean of the boxes' sizes in a slice, or their sums over several slices.
///
/// A single box that is large in the shortest slice dominates the arithmetic mean. Many small ones hide in the geometric
/// mean that a few have shrunk.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct BoxSizes {
    /// Extent of a box, summed over the axes.
    extents: DVec2,
    /// Proportional to the candidates of randomly placed bodies.
    pairs: DVec2,
}

impl BoxSizes {
    pub(super) fn of(boxes: &[BodyBox]) -> Self {
        if boxes.is_empty() {
            return Self::default();
        }
        let count = as_f64(boxes.len());
        // Of extent and volume.
        let (mut sum, mut logarithms) = (DVec2::ZERO, DVec2::ZERO);
        for one in boxes {
            let corner = |corner: [f32; 3]| DVec3::from_array(corner.map(f64::from));
            let sides = corner(one.aabb.maxs.to_array()) - corner(one.aabb.mins.to_array());
            // Flat boxes are compared as well.
            let sides = sides.max(DVec3::splat(f64::MIN_POSITIVE.cbrt()));
            let size = DVec2::new(sides.element_sum(), sides.element_product());
            sum += size;
            logarithms += size.map(f64::ln);
        }
        let (arithmetic, geometric) = (sum / count, (logarithms / count).map(f64::exp));
        Self {
            extents: DVec2::new(arithmetic.x, geometric.x),
            pairs: DVec2::new(arithmetic.y, geometric.y) * count * count,
        }
    }

    /// Returns the sums of the sizes in two slices.
    pub(super) fn and(self, other: Self) -> Self {
        Self {
            extents: self.extents + other.extents,
            pairs: self.pairs + other.pairs,
        }
    }

    /// Returns true if the candidates are probably fewer than those of boxes of other sizes, by one of the means.
    pub(super) fn makes_fewer_pairs_than(&self, other: &Self) -> bool {
        self.pairs.cmplt(other.pairs).any()
    }

    /// Returns true if the extents are less than a factor times others, by one of the means.
    pub(super) fn is_below(&self, factor: f64, other: &Self) -> bool {
        self.extents.cmplt(factor * other.extents).any()
    }
}
