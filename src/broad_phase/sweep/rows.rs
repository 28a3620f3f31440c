//! Counting sort of boxes into rows, and by bins within a row.

use super::copies::{RecordSource, cell_of_copy, rows_of};
use super::layout::RowLayout;
use super::quantizer::{QuantizedBox, Quantizer, axis_part};
use super::sample::scattered;
use crate::broad_phase::{BodyBox, Groups};
use crate::count::short;
use crate::simd::Task;
use std::cmp::Ordering;

/// Records compared in one step.
pub(super) const STEP: usize = 16;

/// Largest number of further copies per box, which bounds memory.
const MAX_COPIES: u64 = 4;

/// Copies of boxes in the order of rows and bins, one array per face.
///
/// A box is copied into every row that it reaches. Each array ends with spare room for a step.
#[derive(Clone, Debug, Default)]
pub(super) struct SortedRows {
    packed: Vec<QuantizedBox>,
    /// The boxes that reach more than one row.
    spanning: Vec<u32>,
    /// End of the records of each cell.
    pub(super) cell_ends: Vec<u32>,
    /// Box of each record.
    pub(super) source: Vec<RecordSource>,
    /// For each record, the end of the records that start no later than it ends, if there is one group.
    successor_ends: Vec<u32>,
    /// If there are several groups: the successors of each record in each group that it may form pairs with.
    grouped: Vec<Successors>,
    /// True if there are several groups.
    pub(super) are_grouped: bool,
    pub(super) low: [Vec<u16>; 3],
    pub(super) high: [Vec<u16>; 3],
}

/// Records that a record is compared with.
#[derive(Clone, Copy, Debug)]
pub(super) struct Successors {
    pub(super) record: u32,
    pub(super) first: u32,
    pub(super) end: u32,
}

impl SortedRows {
    /// Returns the number of lists of successors: one for each record, or for each of its groups of partners.
    pub(super) const fn lists(&self) -> usize {
        if self.are_grouped {
            self.grouped.len()
        } else {
            self.successor_ends.len()
        }
    }

    /// Returns a list of successors. `GROUPED` says whether the boxes are of several groups.
    #[inline(always)]
    pub(super) fn list<const GROUPED: bool>(&self, number: usize) -> Successors {
        if GROUPED {
            return self.grouped[number];
        }
        let record = short(number);
        Successors {
            record,
            first: record + 1,
            end: self.successor_ends[number],
        }
    }

    /// Compares the boxes of a few records with some of their successors; returns the share of comparisons
    /// that find an overlap, 0..=1.
    pub(super) fn hit_rate(&self, boxes: &[BodyBox]) -> f64 {
        const RECORDS: usize = 16;
        const OTHERS: usize = 64;
        let (mut tested, mut met) = (0_u64, 0_u64);
        for number in scattered(RECORDS, self.lists()) {
            let Successors { record, first, end } = if self.are_grouped {
                self.list::<true>(number)
            } else {
                self.list::<false>(number)
            };
            let one = &boxes[self.source[record as usize].number()];
            let rest = (end - first) as usize;
            for other in scattered(OTHERS.min(rest), rest) {
                let other = self.source[first as usize + other].number();
                tested += 1;
                met += u64::from(one.meets(&boxes[other]));
            }
        }
        met as f64 / tested.max(1) as f64
    }
}

/// Sorts boxes into rows; returns the number of comparisons of a sweep over them.
pub(super) struct SortIntoRows<'a> {
    pub(super) boxes: &'a [BodyBox],
    pub(super) groups: Groups,
    /// The group of each box, if there are several.
    pub(super) group_of: &'a [u8],
    pub(super) quantizer: &'a Quantizer,
    pub(super) layout: RowLayout,
    pub(super) rows: &'a mut SortedRows,
}

impl Task for SortIntoRows<'_> {
    type Output = u64;

    #[inline(always)]
    fn run(self) -> u64 {
        if self.layout.groups > 1 {
            self.sort::<true>()
        } else {
            self.sort::<false>()
        }
    }
}

impl SortIntoRows<'_> {
    #[inline(always)]
    fn sort<const GROUPED: bool>(self) -> u64 {
        let Self {
            boxes,
            groups,
            group_of,
            quantizer,
            mut layout,
            rows,
        } = self;
        pack::<GROUPED>(boxes, group_of, quantizer, &layout, rows);
        if further_copies(&layout, rows) > MAX_COPIES * boxes.len() as u64 {
            // Sizes that the layout did not foresee. One row takes no copies.
            layout.rows = [1, 1];
            pack::<GROUPED>(boxes, group_of, quantizer, &layout, rows);
        }
        count(&layout, rows);
        let copies = starts_from_counts(&mut rows.cell_ends);
        scatter(&layout, rows, copies);
        rows.are_grouped = GROUPED;
        unfold::<GROUPED>(&layout, groups, rows)
    }
}

/// Converts boxes to grid coordinates, with the cells of their low corners.
#[inline(always)]
fn pack<const GROUPED: bool>(
    boxes: &[BodyBox],
    group_of: &[u8],
    quantizer: &Quantizer,
    layout: &RowLayout,
    rows: &mut SortedRows,
) {
    let SortedRows {
        packed, spanning, ..
    } = rows;
    packed.resize(boxes.len(), QuantizedBox::default());
    spanning.resize(boxes.len(), 0);
    let [first, second] = layout.across;
    let mut parts = [0; 8];
    for lane in [0, 3] {
        parts[layout.sweep + lane] = layout.bins;
        parts[first + lane] = layout.rows[0];
        parts[second + lane] = layout.rows[1];
    }
    let mut spanning_count = 0;
    // Loops instead of iterators with closures: a closure that is not inlined is compiled without
    // the set's instructions.
    for ((number, one), packed) in (0..).zip(boxes).zip(packed.iter_mut()) {
        let quantized = quantizer.quantized(&one.aabb);
        let mut place = [0; 8];
        for lane in 0..8 {
            place[lane] = axis_part(quantized[lane], parts[lane]);
        }
        let (outer, inner) = (place[first], place[second]);
        let mut group_row = outer * layout.rows[1] + inner;
        if GROUPED {
            group_row = group_row * layout.groups + u32::from(group_of[number as usize]);
        }
        *packed = QuantizedBox {
            low: [quantized[0], quantized[1], quantized[2]],
            high: [quantized[3], quantized[4], quantized[5]],
            cell: group_row * layout.bins + place[layout.sweep],
        };
        // Written in any case, kept where it spans rows: whether it does cannot be predicted.
        spanning[spanning_count] = number;
        let extra_rows = (place[first + 3] - outer) | (place[second + 3] - inner);
        spanning_count += usize::from(extra_rows != 0);
    }
    spanning.truncate(spanning_count);
}

/// Returns the number of copies besides those in the cells of low corners.
#[inline(always)]
fn further_copies(layout: &RowLayout, rows: &SortedRows) -> u64 {
    let mut copies = 0;
    for &number in &rows.spanning {
        let [outer_rows, inner_rows] = rows_of(&rows.packed[number as usize], layout);
        copies += u64::from(outer_rows * inner_rows - 1);
    }
    copies
}

/// Counts the copies of each cell.
#[inline(always)]
fn count(layout: &RowLayout, rows: &mut SortedRows) {
    let SortedRows {
        packed,
        spanning,
        cell_ends,
        ..
    } = rows;
    cell_ends.clear();
    cell_ends.resize(layout.cells() as usize, 0);
    for packed in packed.iter() {
        cell_ends[packed.cell as usize] += 1;
    }
    for &number in spanning.iter() {
        let packed = &packed[number as usize];
        let [outer_rows, inner_rows] = rows_of(packed, layout);
        for outer in 0..outer_rows {
            // The first copy of all is counted.
            for inner in u32::from(outer == 0)..inner_rows {
                cell_ends[cell_of_copy(packed, [outer, inner], layout)] += 1;
            }
        }
    }
}

/// Turns counts into the start positions of cells; returns the total.
#[inline(always)]
fn starts_from_counts(cells: &mut [u32]) -> usize {
    let mut sum = 0;
    for cell in cells {
        sum += std::mem::replace(cell, sum);
    }
    sum as usize
}

/// Writes every copy to its place; the starts of cells become their ends.
#[inline(always)]
fn scatter(layout: &RowLayout, rows: &mut SortedRows, count: usize) {
    let SortedRows {
        packed,
        spanning,
        cell_ends,
        source,
        ..
    } = rows;
    source.resize(count + STEP, RecordSource(0));
    for (number, packed) in (0..).zip(packed.iter()) {
        let place = &mut cell_ends[packed.cell as usize];
        source[*place as usize] = RecordSource(number);
        *place += 1;
    }
    for &number in spanning.iter() {
        let packed = &packed[number as usize];
        let [outer_rows, inner_rows] = rows_of(packed, layout);
        for outer in 0..outer_rows {
            for inner in u32::from(outer == 0)..inner_rows {
                let place = &mut cell_ends[cell_of_copy(packed, [outer, inner], layout)];
                source[*place as usize] = RecordSource::of_copy(number, [outer, inner]);
                *place += 1;
            }
        }
    }
}

/// Writes the faces of all records to their arrays, and their successors; returns the number of comparisons.
#[inline(always)]
fn unfold<const GROUPED: bool>(layout: &RowLayout, groups: Groups, rows: &mut SortedRows) -> u64 {
    let SortedRows {
        packed,
        cell_ends,
        source,
        successor_ends,
        grouped,
        low,
        high,
        ..
    } = rows;
    let count = source.len() - STEP;
    grouped.clear();
    successor_ends.resize(count, 0);
    for face in low.iter_mut().chain(high.iter_mut()) {
        face.resize(count + STEP, 0);
    }
    let [low_x, low_y, low_z] = low;
    let [high_x, high_y, high_z] = high;
    let (low_x, low_y, low_z) = (
        &mut low_x[..count],
        &mut low_y[..count],
        &mut low_z[..count],
    );
    let (high_x, high_y, high_z) = (
        &mut high_x[..count],
        &mut high_y[..count],
        &mut high_z[..count],
    );
    let (source, successor_ends) = (&source[..count], &mut successor_ends[..count]);
    let mut comparisons = 0;
    let mut start = 0;
    let bins = layout.bins as usize;
    for (group_row, row_ends) in cell_ends.chunks_exact(bins).enumerate() {
        let end = row_ends[row_ends.len() - 1] as usize;
        for k in start..end {
            let one = &packed[source[k].number()];
            [low_x[k], low_y[k], low_z[k]] = one.low;
            [high_x[k], high_y[k], high_z[k]] = one.high;
            let last_bin = axis_part(one.high[layout.sweep], layout.bins) as usize;
            if !GROUPED {
                let successor_end = row_ends[last_bin];
                successor_ends[k] = successor_end;
                comparisons += u64::from(successor_end) - k as u64;
                continue;
            }
            let first_bin = axis_part(one.low[layout.sweep], layout.bins) as usize;
            let own = group_row % groups.count();
            for other in (0..groups.count()).filter(|&other| groups.admits(own, other)) {
                let cell = (group_row - own + other) * bins + first_bin;
                // Of two records that start in one bin, that of the lower group is compared with the other one.
                let first = match other.cmp(&own) {
                    Ordering::Less => cell_ends[cell],
                    Ordering::Equal => short(k + 1),
                    Ordering::Greater => cell.checked_sub(1).map_or(0, |before| cell_ends[before]),
                };
                let end = cell_ends[cell - first_bin + last_bin];
                if first < end {
                    comparisons += u64::from(end - first);
                    let record = short(k);
                    grouped.push(Successors { record, first, end });
                }
            }
        }
        start = end;
    }
    comparisons
}

#[cfg(test)]
mod tests {
    use parry3d::bounding_volume::Aabb;
    use parry3d::math::Vector;

    use super::*;
    use crate::simd::InstructionSet;

    const LAYOUT: RowLayout = RowLayout {
        sweep: 1,
        across: [0, 2],
        rows: [4, 8],
        groups: 1,
        comparisons: 0.0,
        bins: 16,
    };

    /// Returns cubes along the diagonal of a world of 0..64 m, one per metre.
    fn sorted(side: f32) -> (SortedRows, u64) {
        let boxes: Vec<BodyBox> = (0..64_u8)
            .map(|i| BodyBox {
                aabb: Aabb::new(
                    Vector::splat(f32::from(i) + 0.25),
                    Vector::splat(f32::from(i) + 0.25 + side),
                ),
                body: u32::from(i),
            })
            .collect();
        let mut rows = SortedRows::default();
        let comparisons = InstructionSet::best().run(SortIntoRows {
            boxes: &boxes,
            groups: Groups::ONE,
            group_of: &[],
            quantizer: &Quantizer::new([(0.0, 64.0); 3]),
            layout: LAYOUT,
            rows: &mut rows,
        });
        (rows, comparisons)
    }

    #[test]
    fn every_row_that_a_box_reaches_gets_a_copy() {
        let (rows, _) = sorted(0.5);
        assert_eq!(rows.successor_ends.len(), 64, "no box crosses a row's end");
        // Rows end each 16 m and each 8 m: four boxes reach over both ends, four over one.
        let (rows, _) = sorted(1.0);
        let copies = 64 + 3 * 3 + 4;
        assert_eq!(rows.successor_ends.len(), copies);
        let first_copies = rows.source[..copies].iter().filter(|source| source.0 < 64);
        assert_eq!(first_copies.count(), 64);
    }

    #[test]
    fn successors_are_what_starts_before_the_end() {
        // Bins are 4 m long, rows 8 m and more: each box has as successors those of its own bin and
        // of its row's next bin, as far as its end reaches: at most 8 others.
        let (rows, comparisons) = sorted(3.5);
        assert_eq!(rows.low[0].len(), rows.successor_ends.len() + STEP);
        for (record, &end) in rows.successor_ends.iter().enumerate() {
            let others = end as usize - record - 1;
            assert!(others < 8, "{others}");
        }
        assert!(comparisons > 64 && comparisons < 8 * 128, "{comparisons}");
    }

    #[test]
    fn too_many_copies_are_avoided() {
        // Boxes that reach over half of the world would have 6 to 15 copies each.
        let (rows, comparisons) = sorted(40.0);
        assert_eq!(rows.successor_ends.len(), 64);
        assert_eq!(rows.cell_ends.len(), 16, "one row of bins");
        // Each with nearly all that follow.
        assert!(comparisons > 64 * 63 / 4, "{comparisons}");
    }
}
