//! Choice of the axis to sweep along, and of the number of rows and bins.

use super::quantizer::STEPS;
use crate::count::whole;

/// The grid into which boxes are sorted: rows over two axes, fine bins along the third.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct RowLayout {
    /// The axis swept along.
    pub(super) sweep: usize,
    /// The axes divided into rows.
    pub(super) across: [usize; 2],
    /// Rows on each of these axes.
    pub(super) rows: [u32; 2],
    /// Groups of boxes, each with bins of its own in a row.
    pub(super) groups: u32,
    /// Bins of a group in a row.
    pub(super) bins: u32,
    /// Expected number of comparisons, of one group.
    pub(super) comparisons: f64,
}

impl RowLayout {
    /// Nanoseconds to sort one copy of a box, and to compare it with the 16 that follow, measured
    /// on 10,000 boxes of the benchmarks' swarm. Only their ratio matters.
    const COPY: f64 = 7.0;
    const STEP: f64 = 3.0;
    /// Numbers of rows per axis to try.
    const ROWS: [u32; 19] = [
        1, 2, 3, 4, 5, 6, 8, 11, 16, 22, 32, 45, 64, 90, 128, 181, 256, 362, 512,
    ];

    /// Returns the layout of least expected cost for this number of evenly spread boxes of one group, with these mean
    /// extents on each axis as shares of the grid, 0..=1.
    pub(super) fn choose(count: usize, extents: [f64; 3]) -> Self {
        let count = count as f64;
        let mut best = (f64::INFINITY, 0, [1, 1], 0.0);
        for sweep in 0..3 {
            let [first, second] = across(sweep).map(|axis| extents[axis]);
            for one in Self::ROWS {
                for other in Self::ROWS {
                    // With fewer boxes than this in a row, its steps run half empty.
                    if f64::from(one * other) * 16.0 > count + 16.0 {
                        break;
                    }
                    let copies =
                        (1.0 + first * f64::from(one - 1)) * (1.0 + second * f64::from(other - 1));
                    let row = count * copies / f64::from(one * other);
                    let successors = row * extents[sweep];
                    let cost = copies * (Self::COPY + Self::STEP * (1.0 + successors / 16.0));
                    if cost < best.0 {
                        best = (cost, sweep, [one, other], count * copies * successors);
                    }
                }
            }
        }
        let (_, sweep, rows, comparisons) = best;
        Self {
            sweep,
            across: across(sweep),
            rows,
            groups: 1,
            bins: Self::bins(rows, count, extents[sweep]),
            comparisons,
        }
    }

    /// Returns a number of bins a quarter of a box long, so that few successors of a box start behind
    /// the box's end; at most one cell per box, in each group.
    fn bins(rows: [u32; 2], count: f64, extent: f64) -> u32 {
        let most = (count / f64::from(rows[0] * rows[1])).min(f64::from(STEPS));
        whole((4.0 / extent).clamp(1.0, most.max(1.0)))
    }

    /// Returns the number of cells of a row.
    pub(super) const fn row_cells(&self) -> u32 {
        self.groups * self.bins
    }

    pub(super) const fn cells(&self) -> u32 {
        self.rows[0] * self.rows[1] * self.row_cells()
    }
}

/// Returns the two other axes.
const fn across(sweep: usize) -> [usize; 2] {
    match sweep {
        0 => [1, 2],
        1 => [0, 2],
        _ => [0, 1],
    }
}
