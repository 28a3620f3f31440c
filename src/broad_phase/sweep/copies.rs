//! Copies of a box in the rows that it reaches.

use super::layout::RowLayout;
use super::quantizer::{QuantizedBox, axis_part};

/// The box of a record, and whether the box starts in the record's row.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct RecordSource(pub(super) u32);

impl RecordSource {
    /// Set where the box starts in an earlier row on the first or second axis of rows.
    const EARLIER: [u32; 2] = [1 << 31, 1 << 30];

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

/// Returns the number of rows, besides the first, that a box reaches on each axis of rows.
#[inline(always)]
pub(super) fn extra_rows(packed: &QuantizedBox, layout: &RowLayout) -> [u32; 2] {
    let [first, second] = layout.across;
    let rows = layout.rows;
    [
        axis_part(packed.high[first], rows[0]) - axis_part(packed.low[first], rows[0]),
        axis_part(packed.high[second], rows[1]) - axis_part(packed.low[second], rows[1]),
    ]
}

/// Iterator over the cells that get a copy of a box, without that of its low corner.
pub(super) struct ExtraCells {
    /// The last cell returned, the first of its line of rows, the first of all.
    cell: usize,
    line: usize,
    first: usize,
    lines: u32,
    /// Cells left in the line, and cells of a line besides the first.
    left: u32,
    span: u32,
    /// Distance between cells, and between lines.
    stride: usize,
    line_stride: usize,
}

impl ExtraCells {
    #[inline(always)]
    pub(super) fn of(packed: &QuantizedBox, layout: &RowLayout) -> Self {
        let cell = packed.cell as usize;
        let [lines, span] = extra_rows(packed, layout);
        Self {
            cell,
            line: cell,
            first: cell,
            lines,
            left: span,
            span,
            stride: layout.row_cells() as usize,
            line_stride: (layout.rows[1] * layout.row_cells()) as usize,
        }
    }

    #[inline(always)]
    pub(super) fn next(&mut self) -> Option<usize> {
        if self.left > 0 {
            self.left -= 1;
            self.cell += self.stride;
        } else if self.lines > 0 {
            self.lines -= 1;
            self.left = self.span;
            self.line += self.line_stride;
            self.cell = self.line;
        } else {
            return None;
        }
        Some(self.cell)
    }

    /// Returns the marks of the copy in the last cell returned.
    #[inline(always)]
    pub(super) fn earlier(&self) -> u32 {
        let outer = if self.line == self.first {
            0
        } else {
            RecordSource::EARLIER[0]
        };
        let inner = if self.cell == self.line {
            0
        } else {
            RecordSource::EARLIER[1]
        };
        outer | inner
    }
}
