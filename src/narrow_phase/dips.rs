//! Minima of the distance that are lost in the rounding of the squared distance.
//!
//! The roots of the derivative of the squared distance are as good as its coefficients: to a
//! rounding of the squared size of the span. If the bodies are a thousand times nearer than that
//! size and hardly separate, as after a launch or before docking, whole minima are smaller than
//! this. So a span is halved towards such places, and each part is solved relative to its own size,
//! until only rounding is left.

use super::crossing::ProfileNode;
use super::relative::RelativeCubic;
use super::squared_distance::is_monotonic;
use super::stationary::{MAX_STATIONARY, stationary_points};
use crate::enclosure::part;
use crate::rounding::largest_norm;
use arrayvec::ArrayVec;

/// Share of the size of a part: beyond this distance the squared distance shows all minima.
const NEAR: f64 = 1.0 / 256.0;

/// Returns true if minima of a span may be lost, given the least distance at the nodes found (m).
pub(super) fn may_be_hidden(cubic: &RelativeCubic, least: f64) -> bool {
    least <= NEAR * cubic.size && !is_swift(cubic)
}

/// Returns true if the relative motion has one main direction, with a good part of the size: it
/// then passes its nearest point once, and quickly.
fn is_swift(cubic: &RelativeCubic) -> bool {
    let [p0, p1, p2, p3] = cubic.points;
    let displacement = p3 - p0;
    let enough = NEAR * cubic.size * displacement.length();
    [p1 - p0, p2 - p1, p3 - p2]
        .into_iter()
        .all(|step| step.dot(displacement) > enough)
}

/// The local extrema of the distance, in order, and both ends of the span.
pub(super) struct DistanceExtrema(ArrayVec<ProfileNode, { 2 * Self::MAX }>);

impl DistanceExtrema {
    /// Largest number of extrema of a span, ends included.
    const MAX: usize = MAX_STATIONARY + 2;

    /// Returns the extrema of a whole span.
    #[cold]
    pub(super) fn of(cubic: &RelativeCubic) -> Self {
        let mut extrema = Self(ArrayVec::new());
        extrema.push(cubic, 0.0);
        extrema.search(cubic, (0.0, 1.0), 0);
        // The end is one whatever came before.
        extrema.push(cubic, 1.0);
        extrema.reduce(Self::MAX);
        extrema
    }

    pub(super) fn as_slice(&self) -> &[ProfileNode] {
        &self.0
    }

    /// Appends the extrema inside a part of the span, and its end; its start is already there.
    fn search(&mut self, cubic: &RelativeCubic, (from, to): (f64, f64), halvings: u32) {
        /// A part of a cubic shrinks at least as often as its size does.
        const MAX_HALVINGS: u32 = 60;
        let part = part_of(cubic, (from, to));
        let is_rounding = part.size <= cubic.tolerance() || halvings == MAX_HALVINGS;
        if !is_rounding && !is_monotonic(&part) {
            let found = stationary_points(&part);
            let inside = found.iter().map(|s| from + s * (to - from));
            let all = inside.clone().chain([from, to]);
            let least = all.map(|s| cubic.distance(s)).fold(f64::INFINITY, f64::min);
            if may_be_hidden(&part, least) {
                let middle = 0.5 * (from + to);
                self.search(cubic, (from, middle), halvings + 1);
                self.search(cubic, (middle, to), halvings + 1);
                return;
            }
            inside.for_each(|s| self.push(cubic, s));
        }
        if to < 1.0 {
            self.push(cubic, to);
        }
    }

    /// Appends an extremum; replaces the previous one if the distance goes on the same way.
    fn push(&mut self, cubic: &RelativeCubic, s: f64) {
        let new = ProfileNode::at(cubic, s);
        if let [.., before, last] = self.as_slice() {
            let (rose, rises) = (
                last.distance >= before.distance,
                new.distance >= last.distance,
            );
            if rose == rises {
                self.0.pop();
            }
        }
        if self.0.is_full() {
            self.reduce(Self::MAX);
        }
        self.0.push(new);
    }

    /// Removes extrema in pairs with the least change of distance between them: more than a span
    /// can have come from rounding.
    fn reduce(&mut self, most: usize) {
        while self.0.len() > most {
            let changes = self.0[1..self.0.len() - 1].windows(2);
            let changes = changes.map(|ends| (ends[1].distance - ends[0].distance).abs());
            let least = changes.enumerate().min_by(|x, y| x.1.total_cmp(&y.1));
            let Some((number, _)) = least else { return };
            self.0.drain(number + 1..number + 3);
        }
    }
}

/// Returns the part of a span between two local parameters, by its blossom: its points are as good
/// as those of the whole.
fn part_of(cubic: &RelativeCubic, (from, to): (f64, f64)) -> RelativeCubic {
    let points = part(&cubic.points, from, to);
    RelativeCubic {
        points,
        size: largest_norm(&points),
        ..*cubic
    }
}

#[cfg(test)]
mod tests {
    use super::{DistanceExtrema, ProfileNode};

    /// Surplus extrema go where the distance changes least, except for the ends.
    #[test]
    fn rounding_is_dropped_first() {
        let distances = [
            9.0,
            2.0,
            7.0,
            7.0 - 1e-9,
            8.0,
            1.0,
            6.0,
            3.0,
            3.0 + 1e-12,
            0.0,
            5.0,
        ];
        let nodes = (0_u8..).zip(distances).map(|(s, distance)| ProfileNode {
            s: f64::from(s),
            time: 0.0,
            distance,
        });
        let mut extrema = DistanceExtrema(nodes.collect());
        extrema.reduce(DistanceExtrema::MAX);
        let left: Vec<f64> = extrema.as_slice().iter().map(|node| node.s).collect();
        assert_eq!(left, [0.0, 1.0, 4.0, 5.0, 6.0, 9.0, 10.0]);
    }
}
