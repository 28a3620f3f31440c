//! Bundles of a motion's cubics, under construction.

use super::bundle::Bundle;
use super::period::Period;
use super::piece::Piece;
use super::stroke::Stroke;
use super::trace::Trace;

impl Bundle {
    /// Of four cubics, between five knots.
    fn of_cubics(strokes: &[Stroke], knots: &[f64]) -> Self {
        let piece = |number: usize| {
            let ends = (knots[number], knots[number + 1]);
            Piece::whole(&strokes[number], ends, 1.0)
        };
        let (head, tail) = (piece(0), piece(Self::SIZE - 1));
        let period = Period::new(knots[0], knots[Self::SIZE]);
        let mut trace = Trace::between(&head, &tail, &period);
        for number in 1..Self::SIZE {
            trace.follow_from_start(&piece(number));
        }
        trace.sum_up(tail.points[3])
    }

    /// Of four bundles, with as many cubics each between these knots.
    fn of_bundles(bundles: &[Self], knots: &[f64]) -> Self {
        let [first, last] = [0, Self::SIZE - 1].map(|number| bundles[number].unpack(1.0));
        let step = (knots.len() - 1) / Self::SIZE;
        let period = Period::new(knots[0], knots[knots.len() - 1]);
        let mut trace = Trace::between_bundles(&first, &last, &period);
        for (bundle, number) in bundles.iter().zip(1..) {
            trace.pass(&bundle.unpack(1.0), knots[number * step]);
        }
        trace.sum_up(last.end)
    }
}

/// Draws all complete bundles of some cubics: those of 4 cubics, then those of 16, and so on.
pub(super) fn bundle_up(knots: &[f64], strokes: &[Stroke], bundles: &mut [Bundle]) {
    let (mut span, mut below, mut level) = (Bundle::SIZE, 0, 0);
    while strokes.len() >= span {
        let count = strokes.len() / span;
        let (smaller, these) = bundles.split_at_mut(level);
        for (number, bundle) in these[..count].iter_mut().enumerate() {
            let knots = &knots[number * span..=(number + 1) * span];
            let four = number * Bundle::SIZE..(number + 1) * Bundle::SIZE;
            *bundle = if span == Bundle::SIZE {
                Bundle::of_cubics(&strokes[four], knots)
            } else {
                Bundle::of_bundles(&smaller[below..][four], knots)
            };
        }
        (below, level, span) = (level, level + count, span * Bundle::SIZE);
    }
}
