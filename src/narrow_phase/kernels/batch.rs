//! Relative cubics of many pairs, coordinate by coordinate.

use crate::guess::ControlPoints;
use crate::real::Real;

/// A view of the relative cubics of many pairs in structure-of-arrays form.
///
/// Twelve slices of one length: the x, y and z coordinates of the four Bezier control points.
#[derive(Clone, Copy, Debug)]
pub struct Lanes<'a, R> {
    /// `coordinates[axis][point][pair]`.
    pub(super) coordinates: [[&'a [R]; 4]; 3],
}

impl<'a, R: Real> Lanes<'a, R> {
    /// Returns a view of twelve slices, `[[x0, x1, x2, x3], [y0, …], [z0, …]]`, or `None` if their
    /// lengths differ.
    #[must_use]
    pub fn new(coordinates: [[&'a [R]; 4]; 3]) -> Option<Self> {
        let length = coordinates[0][0].len();
        let even = coordinates
            .iter()
            .flatten()
            .all(|slice| slice.len() == length);
        even.then_some(Self { coordinates })
    }

    /// Returns the number of pairs.
    #[inline]
    #[must_use]
    pub fn len(&self) -> usize {
        self.coordinates[0][0].len()
    }

    /// Returns true if there is no pair.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Returns the control points of one pair.
    ///
    /// # Panics
    ///
    /// If `pair` is not less than the number of pairs.
    #[inline(always)]
    #[must_use]
    pub fn control_points(&self, pair: usize) -> ControlPoints<R> {
        let [x, y, z] = self.coordinates;
        [
            [x[0][pair], y[0][pair], z[0][pair]],
            [x[1][pair], y[1][pair], z[1][pair]],
            [x[2][pair], y[2][pair], z[2][pair]],
            [x[3][pair], y[3][pair], z[3][pair]],
        ]
    }

    #[inline(always)]
    pub(super) fn first(&self, count: usize) -> Self {
        self.range(0, count)
    }

    /// Returns the pairs from `start` up to `end`.
    ///
    /// Written out, since the array methods that take closures are not inlined here, and cost as
    /// much as the verdicts on a block.
    #[inline(always)]
    pub(super) fn range(&self, start: usize, end: usize) -> Self {
        let [x, y, z] = self.coordinates;
        Self {
            coordinates: [
                [
                    &x[0][start..end],
                    &x[1][start..end],
                    &x[2][start..end],
                    &x[3][start..end],
                ],
                [
                    &y[0][start..end],
                    &y[1][start..end],
                    &y[2][start..end],
                    &y[3][start..end],
                ],
                [
                    &z[0][start..end],
                    &z[1][start..end],
                    &z[2][start..end],
                    &z[3][start..end],
                ],
            ],
        }
    }
}

/// The relative cubics of many pairs, owned and growing; reuse one to avoid allocation.
///
/// ```
/// use nearmiss::kernels::{CubicBatch, InstructionSet, closest_approach};
///
/// let mut batch = CubicBatch::<f32>::new();
/// batch.extend([1.0, 2.0].map(|y| [[-6.0, y, 0.0], [-2.0, y, 0.0], [2.0, y, 0.0], [6.0, y, 0.0]]));
/// let (mut times, mut distances) = ([0.0; 2], [0.0; 2]);
/// closest_approach(InstructionSet::best(), &batch.lanes(), &mut times, &mut distances);
/// assert_eq!(distances, [1.0, 2.0]);
/// batch.clear(); // for the next pairs
/// assert!(batch.lanes().is_empty());
/// ```
#[derive(Clone, Debug, Default)]
pub struct CubicBatch<R> {
    coordinates: [[Vec<R>; 4]; 3],
}

impl<R: Real> CubicBatch<R> {
    /// Returns an empty batch.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Appends a pair.
    #[inline]
    pub fn push(&mut self, points: ControlPoints<R>) {
        for (axis, column) in self.coordinates.iter_mut().enumerate() {
            for (slot, point) in column.iter_mut().zip(&points) {
                slot.push(point[axis]);
            }
        }
    }

    /// Removes all pairs and keeps the memory.
    pub fn clear(&mut self) {
        for slot in self.coordinates.iter_mut().flatten() {
            slot.clear();
        }
    }

    /// Returns a view of the pairs for the kernels.
    #[must_use]
    pub fn lanes(&self) -> Lanes<'_, R> {
        Lanes {
            coordinates: self
                .coordinates
                .each_ref()
                .map(|axis| axis.each_ref().map(Vec::as_slice)),
        }
    }
}

impl<R: Real> Extend<ControlPoints<R>> for CubicBatch<R> {
    fn extend<T: IntoIterator<Item = ControlPoints<R>>>(&mut self, pairs: T) {
        for points in pairs {
            self.push(points);
        }
    }
}
