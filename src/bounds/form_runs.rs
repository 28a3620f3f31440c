//! Construction of cubic runs.

use super::builder::BoundsBuilder;
use super::compact_cubic::CompactCubic;
use super::cubic_run::CubicRun;
use super::slice_interval::SliceInterval;
use super::sub_cubic::SubCubic;

impl CubicRun {
    /// Returns the run of four cubics, between five knots.
    fn of_cubics(compact_cubics: &[CompactCubic], knots: &[f64]) -> Self {
        let piece = |number: usize| {
            let ends = (knots[number], knots[number + 1]);
            SubCubic::whole(&compact_cubics[number], ends, 1.0)
        };
        let (head, tail) = (piece(0), piece(Self::SIZE - 1));
        let slice_interval = SliceInterval::new(knots[0], knots[Self::SIZE]);
        let mut builder = BoundsBuilder::between(&head, &tail, &slice_interval);
        for number in 1..Self::SIZE {
            builder.follow_from_start(&piece(number));
        }
        builder.finish_run(tail.points[3])
    }

    /// Returns the run of four runs, each with the same number of cubics between these knots.
    fn of_runs(runs: &[Self], knots: &[f64]) -> Self {
        let [first, last] = [0, Self::SIZE - 1].map(|number| runs[number].unpack(1.0));
        let step = (knots.len() - 1) / Self::SIZE;
        let slice_interval = SliceInterval::new(knots[0], knots[knots.len() - 1]);
        let mut builder = BoundsBuilder::between_runs(&first, &last, &slice_interval);
        for (run, number) in runs.iter().zip(1..) {
            builder.pass(&run.unpack(1.0), knots[number * step]);
        }
        builder.finish_run(last.end)
    }
}

/// Forms all complete runs: of 4 cubics each, then of 16, and so on.
pub(super) fn form_runs(knots: &[f64], compact_cubics: &[CompactCubic], runs: &mut [CubicRun]) {
    let (mut size, mut below, mut start) = (CubicRun::SIZE, 0, 0);
    while compact_cubics.len() >= size {
        let count = compact_cubics.len() / size;
        let (smaller, these) = runs.split_at_mut(start);
        for (number, run) in these[..count].iter_mut().enumerate() {
            let knots = &knots[number * size..=(number + 1) * size];
            let four = number * CubicRun::SIZE..(number + 1) * CubicRun::SIZE;
            *run = if size == CubicRun::SIZE {
                CubicRun::of_cubics(&compact_cubics[four], knots)
            } else {
                CubicRun::of_runs(&smaller[below..][four], knots)
            };
        }
        (below, start, size) = (start, start + count, size * CubicRun::SIZE);
    }
}
