//! Cutting the window into slices, and one box for each body in each of them.

use super::BodyBox;
use crate::bounds::{Frame, Hull, Inflation};
use crate::narrow_phase::Party;

/// A window cut into slices of equal length. Slices never change an answer, only its cost.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Slices {
    start: f64,
    end: f64,
    count: u32,
}

/// What the choice of a slice length rests on.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Traffic {
    /// Seconds of existence within the window, added up over bodies.
    pub(crate) body_time: f64,
    /// Metres flown in them.
    pub(crate) path: f64,
    /// Segments flown in them.
    pub(crate) segments: f64,
    /// The world's extent on each axis, m.
    pub(crate) world: [f64; 3],
    /// Typical separation that counts, hitboxes and margin: m.
    pub(crate) reach: f64,
}

impl Slices {
    /// Boxes about half as long as the bodies' mean spacing: with longer ones candidates grow with
    /// the cube of their size, with shorter ones the boxes themselves are the cost.
    const SPACINGS_PER_SLICE: f64 = 0.5;
    /// A body's box should not hold more segments than this.
    const MOST_SEGMENTS_PER_SLICE: f64 = 16.0;
    /// However fast the traffic, no more boxes than this in all.
    const MOST_BOXES: f64 = 5e7;

    /// Slices of `start..=end` (s, finite) by the rule above, from counts alone.
    pub(crate) fn choose(start: f64, end: f64, traffic: &Traffic) -> Self {
        let duration = end - start;
        let present = traffic.body_time / duration;
        let speed = traffic.path / traffic.body_time;
        let volume: f64 = traffic
            .world
            .iter()
            .map(|&side| side.max(traffic.reach).max(f64::MIN_POSITIVE))
            .map(f64::cbrt)
            .product();
        let spacing = (volume / present.max(1.0).cbrt()).max(traffic.reach);
        let length = (Self::SPACINGS_PER_SLICE * spacing / speed)
            .min(Self::MOST_SEGMENTS_PER_SLICE * traffic.body_time / traffic.segments)
            .max(traffic.body_time / Self::MOST_BOXES);
        let count = (duration / length).ceil();
        Self {
            start,
            end,
            count: if count >= 1.0 && count.is_finite() {
                whole(count.min(Self::MOST_BOXES))
            } else {
                1
            },
        }
    }

    pub(crate) const fn count(&self) -> u32 {
        self.count
    }

    /// First and last instant of a slice; neighbours share theirs.
    pub(crate) fn interval(&self, slice: u32) -> (f64, f64) {
        (self.cut(slice), self.cut(slice + 1))
    }

    fn cut(&self, index: u32) -> f64 {
        if index >= self.count {
            self.end
        } else {
            let share = f64::from(index) / f64::from(self.count);
            (self.start + share * (self.end - self.start)).min(self.end)
        }
    }
}

/// Appends the boxes of all bodies in one slice (s); bodies that do not exist in it have none.
pub(crate) fn boxes_in_slice(
    parties: &[Party<'_>],
    inflations: &[Inflation],
    frame: &Frame,
    (from, to): (f64, f64),
    boxes: &mut Vec<BodyBox>,
) {
    for (body, (party, inflation)) in (0_u32..).zip(parties.iter().zip(inflations)) {
        let knots = party.knots;
        let (Some(&first), Some(&last)) = (knots.first(), knots.last()) else {
            continue;
        };
        if first > to || last < from {
            continue;
        }
        let mut hull = Hull::EMPTY;
        let begin = knots.partition_point(|&knot| knot < from).max(1) - 1;
        let pieces = knots[begin..].windows(2).zip(&party.segments[begin..]);
        for (ends, segment) in pieces {
            if ends[0] > to {
                break;
            }
            hull.include(segment, (ends[0].max(from), ends[1].min(to)), frame);
        }
        boxes.push(BodyBox {
            aabb: hull.inflated(inflation, frame),
            body,
        });
    }
}

#[allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a whole number between 1 and MOST_BOXES"
)]
fn whole(count: f64) -> u32 {
    count as u32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slices_cover_the_window_without_gaps() {
        let traffic = Traffic {
            body_time: 600.0,
            path: 6000.0,
            segments: 100.0,
            world: [100.0; 3],
            reach: 1.0,
        };
        let slices = Slices::choose(5.0, 65.0, &traffic);
        assert!(slices.count() > 10);
        assert!(slices.interval(0).0.to_bits() == 5.0_f64.to_bits());
        assert!(slices.interval(slices.count() - 1).1.to_bits() == 65.0_f64.to_bits());
        for slice in 1..slices.count() {
            assert!(slices.interval(slice - 1).1.to_bits() == slices.interval(slice).0.to_bits());
        }
    }

    #[test]
    fn degenerate_traffic_gets_one_slice() {
        let nothing_moves = Traffic {
            body_time: 10.0,
            path: 0.0,
            segments: 0.0,
            world: [0.0; 3],
            reach: 0.0,
        };
        assert_eq!(Slices::choose(0.0, 1.0, &nothing_moves).count(), 1);
        assert_eq!(Slices::choose(2.0, 2.0, &nothing_moves).count(), 1);
    }
}
