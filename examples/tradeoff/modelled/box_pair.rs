//! Two boxes that move and turn: whether they touch in an interval of time, proven by bounds of their distance.

use glam::{DMat3, DQuat, DVec3};

/// Two boxes of the same size that turn at constant rates.
pub(super) struct BoxPair<F> {
    /// Half sides, m.
    pub(super) half: DVec3,
    /// Position (m) of the second box from the first, and both rotations, at a time (s).
    pub(super) poses: F,
    /// The fastest that their distance can change, m/s.
    pub(super) speed: f64,
}

/// A proven statement about two boxes in an interval: they touch, they do not, or neither is proven.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Touch {
    Certain,
    Never,
    Undecided,
}

impl<F: Fn(f64) -> (DVec3, [DQuat; 2])> BoxPair<F> {
    /// Rounding of a gap, m. An overlap on fifteen axes that is deeper is one of the boxes.
    const ROUNDING: f64 = 1e-8;
    /// Shortest half of an interval that is divided, s.
    const SHORTEST: f64 = 1e-7;

    /// Halves the interval until each part has an overlap in its middle, or a distance too large to vanish.
    pub(super) fn touch(&self, from: f64, to: f64) -> Touch {
        let mut parts = vec![(from, to)];
        let mut touch = Touch::Never;
        while let Some((from, to)) = parts.pop() {
            let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
            let gap = self.gap(middle);
            if gap < -Self::ROUNDING {
                return Touch::Certain;
            }
            if gap > self.speed * half + Self::ROUNDING {
                continue;
            }
            if half < Self::SHORTEST {
                touch = Touch::Undecided;
            } else {
                parts.extend([(from, middle), (middle, to)]);
            }
        }
        touch
    }

    /// Returns the largest gap between the boxes' shadows on the fifteen axes of the separating axis theorem (m). It is
    /// negative if they overlap, and never more than their distance.
    fn gap(&self, time: f64) -> f64 {
        let (between, rotations) = (self.poses)(time);
        let [a, b] = rotations.map(DMat3::from_quat);
        let faces = [a.x_axis, a.y_axis, a.z_axis, b.x_axis, b.y_axis, b.z_axis];
        let (of_a, of_b) = faces.split_at(3);
        let edges = of_a
            .iter()
            .flat_map(|a| of_b.iter().map(move |b| a.cross(*b)));
        // Those of parallel edges are no axes.
        let edges = edges
            .filter(|axis| axis.length() > 1e-9)
            .map(DVec3::normalize);
        let extent = |axes: DMat3, axis: DVec3| (axes.transpose() * axis).abs().dot(self.half);
        let gap = |axis: DVec3| between.dot(axis).abs() - extent(a, axis) - extent(b, axis);
        let gaps = faces.into_iter().chain(edges).map(gap);
        gaps.fold(f64::NEG_INFINITY, f64::max)
    }
}
