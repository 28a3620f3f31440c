//! Mean sizes of a slice's boxes, which tell whether shorter slices have fewer candidates.

use crate::broad_phase::BodyBox;
use crate::count::as_f64;
use glam::DVec3;

/// A mean of the boxes' sizes.
#[derive(Clone, Copy, Debug, Default)]
struct MeanSize {
    /// Extent of a box, summed over the axes.
    extent: f64,
    /// Proportional to the candidates of randomly placed bodies.
    pairs: f64,
}

/// Two means of the boxes' sizes in a slice, or their sums over several slices.
///
/// A single box that is large in the shortest slice dominates the arithmetic mean. Many small ones hide in the geometric
/// mean that a few have shrunk.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct BoxSizes {
    arithmetic: MeanSize,
    geometric: MeanSize,
}

impl BoxSizes {
    pub(super) fn of(boxes: &[BodyBox]) -> Self {
        if boxes.is_empty() {
            return Self::default();
        }
        let count = as_f64(boxes.len());
        let (mut sum, mut logarithms) = ((0.0, 0.0), (0.0, 0.0));
        for one in boxes {
            let corner = |corner: [f32; 3]| DVec3::from_array(corner.map(f64::from));
            let sides = corner(one.aabb.maxs.to_array()) - corner(one.aabb.mins.to_array());
            // Flat boxes are compared as well.
            let sides = sides.max(DVec3::splat(f64::MIN_POSITIVE.cbrt()));
            let (extent, volume) = (sides.element_sum(), sides.element_product());
            sum = (sum.0 + extent, sum.1 + volume);
            logarithms = (logarithms.0 + extent.ln(), logarithms.1 + volume.ln());
        }
        let size = |extent: f64, volume: f64| MeanSize {
            extent,
            pairs: volume * count * count,
        };
        Self {
            arithmetic: size(sum.0 / count, sum.1 / count),
            geometric: size((logarithms.0 / count).exp(), (logarithms.1 / count).exp()),
        }
    }

    /// Returns the sums of both.
    pub(super) fn and(self, other: Self) -> Self {
        let sum = |one: MeanSize, other: MeanSize| MeanSize {
            extent: one.extent + other.extent,
            pairs: one.pairs + other.pairs,
        };
        Self {
            arithmetic: sum(self.arithmetic, other.arithmetic),
            geometric: sum(self.geometric, other.geometric),
        }
    }

    /// Returns true if the candidates are probably fewer than those of boxes of other sizes.
    pub(super) fn makes_fewer_pairs_than(&self, other: &Self) -> bool {
        self.arithmetic.pairs < other.arithmetic.pairs
            || self.geometric.pairs < other.geometric.pairs
    }

    /// Returns true if the extents are less than a factor times others.
    pub(super) fn is_below(&self, factor: f64, other: &Self) -> bool {
        self.arithmetic.extent < factor * other.arithmetic.extent
            || self.geometric.extent < factor * other.geometric.extent
    }
}
