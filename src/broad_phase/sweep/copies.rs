//! Copies of a box in the rows that it reaches.

use super::layout::RowLayout;
use super::quantizer::{QuantizedBox, axis_part};

/// The box of a record, and whether the box starts in the record's row.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct RecordSource(pub(super) u32);

impl RecordSource {
    /// Set where the box starts in an earlier row on the first or second axis of rows.
    const EARLIER: [u32; 2] = [1 << 31, 1 << 30];

    /// Returns the source of a copy in a row so far behind the first one of the box, on each axis of rows.
    #[inline(always)]
    pub(super) const fn of_copy(number: u32, [outer, inner]: [u32; 2]) -> Self {
        let outer = if outer > 0 { Self::EARLIER[0] } else { 0 };
        let inner = if inner > 0 { Self::EARLIER[1] } else { 0 };
        Self(number | outer | inner)
    }

    #[inline(always)]
    pub(super) fn number(self) -> usize {
        (self.0 & !(Self::EARLIER[0] | Self::EARLIER[1])) as usize
    }

    /// Returns true if a pair of boxes is reported in the row of these two records: the one in
    /// which their intersection starts. On either axis of rows, the box that starts later must
    /// start there. Both boxes have a copy in that row, and the condition holds in no other.
    #[inline(always)]
    pub(super) fn reports_with(self, other: Self) -> bool {
        (self.0 & other.0) >> 30 == 0
    }
}

/// Returns the number of rows that a box reaches on each axis of rows.
#[inline(always)]
pub(super) fn rows_of(packed: &QuantizedBox, layout: &RowLayout) -> [u32; 2] {
    let [first, second] = layout.across;
    let rows = layout.rows;
    [
        axis_part(packed.high[first], rows[0]) - axis_part(packed.low[first], rows[0]) + 1,
        axis_part(packed.high[second], rows[1]) - axis_part(packed.low[second], rows[1]) + 1,
    ]
}

/// Returns the cell for the copy of a box in a row so far behind its first one, on each axis of rows.
#[inline(always)]
pub(super) fn cell_of_copy(
    packed: &QuantizedBox,
    [outer, inner]: [u32; 2],
    layout: &RowLayout,
) -> usize {
    (packed.cell + (outer * layout.rows[1] + inner) * layout.row_cells()) as usize
}
