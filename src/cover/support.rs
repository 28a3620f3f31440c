//! The farthest of many points along a direction.

use glam::DVec3;

/// Points in a tree of boxes.
#[derive(Clone, Debug)]
pub(super) struct Support {
    /// In the order of the tree's leaves.
    points: Vec<DVec3>,
    nodes: Vec<SupportNode>,
}

#[derive(Clone, Copy, Debug)]
struct SupportNode {
    low: DVec3,
    high: DVec3,
    /// The points within.
    first: usize,
    end: usize,
    /// The second of two nodes within; the first of them follows the node itself.
    second: usize,
}

const LEAF: usize = 8;

impl Support {
    pub(super) fn new(points: &[DVec3]) -> Self {
        let mut points = points.to_vec();
        let mut nodes = Vec::new();
        build(&mut nodes, &mut points, 0);
        Self { points, nodes }
    }

    /// Returns the largest scalar product of a vector with a point, as it is rounded; minus infinity without points.
    pub(super) fn highest(&self, direction: DVec3) -> f64 {
        // Products and sums are rounded upward or downward together: no point of the box has a larger product.
        let bound = |number: usize| {
            let node = &self.nodes[number];
            let is_up = direction.cmpge(DVec3::ZERO);
            direction.dot(DVec3::select(is_up, node.high, node.low))
        };
        let mut highest = f64::NEG_INFINITY;
        let mut waiting = vec![0];
        while let Some(number) = waiting.pop() {
            let node = &self.nodes[number];
            if bound(number) <= highest {
                continue;
            }
            if node.end - node.first <= LEAF {
                let products = self.points[node.first..node.end]
                    .iter()
                    .map(|point| direction.dot(*point));
                highest = products.fold(highest, f64::max);
                continue;
            }
            let (first, second) = (number + 1, node.second);
            // The one that reaches farther is looked at first.
            if bound(first) >= bound(second) {
                waiting.extend([second, first]);
            } else {
                waiting.extend([first, second]);
            }
        }
        highest
    }
}

/// Adds the node of some points, whose first has this number, and all nodes within.
fn build(nodes: &mut Vec<SupportNode>, points: &mut [DVec3], first: usize) {
    let corners = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    let corners = points.iter().fold(corners, |(low, high), point| {
        (low.min(*point), high.max(*point))
    });
    let (low, high) = corners;
    let own = nodes.len();
    nodes.push(SupportNode {
        low,
        high,
        first,
        end: first + points.len(),
        second: own,
    });
    if points.len() > LEAF {
        let axis = (high - low).max_position();
        let half = points.len() / 2;
        points.select_nth_unstable_by(half, |a, b| a[axis].total_cmp(&b[axis]));
        let (lower, upper) = points.split_at_mut(half);
        build(nodes, lower, first);
        nodes[own].second = nodes.len();
        build(nodes, upper, first + half);
    }
}

#[cfg(test)]
mod tests {
    use super::super::random::Random;
    use super::*;

    #[test]
    fn the_highest_product_is_found_to_the_bit() {
        let mut random = Random::new(7, 0);
        for count in [0, 1, 8, 9, 100, 3_000] {
            let mut point = || random.point(DVec3::NEG_ONE, DVec3::ONE);
            let points: Vec<DVec3> = (0..count).map(|_| point()).collect();
            let support = Support::new(&points);
            for direction in (0..50).map(|_| point()).chain([DVec3::ZERO, -DVec3::Y]) {
                let products = points.iter().map(|point| direction.dot(*point));
                let expected = products.fold(f64::NEG_INFINITY, f64::max);
                let found = support.highest(direction);
                // Of zeros either one.
                let is_same = (found - expected).abs() <= 0.0 || found.total_cmp(&expected).is_eq();
                assert!(is_same, "{count} {direction}");
            }
        }
    }
}
