//! Trees of boxes around points or triangles.

use glam::DVec3;

/// Items of some points each, in a tree of boxes.
#[derive(Clone, Debug)]
pub(super) struct PointTree<const N: usize> {
    pub(super) points: Vec<DVec3>,
    /// Items in the order of the tree's leaves, as numbers of their points.
    pub(super) items: Vec<[usize; N]>,
    nodes: Vec<PointNode>,
}

#[derive(Clone, Copy, Debug)]
struct PointNode {
    low: DVec3,
    high: DVec3,
    /// The items within.
    first: usize,
    end: usize,
    /// The node after all nodes within this one. The first of these follows the node itself.
    after: usize,
}

impl PointNode {
    /// Largest number of items of a node that is not divided.
    const LEAF: usize = 4;

    const fn is_leaf(&self) -> bool {
        self.end - self.first <= Self::LEAF
    }
}

impl<const N: usize> PointTree<N> {
    pub(super) fn new(points: Vec<DVec3>, mut items: Vec<[usize; N]>) -> Self {
        let mut nodes = Vec::new();
        build(&points, &mut items, 0, &mut nodes);
        Self {
            points,
            items,
            nodes,
        }
    }

    pub(super) fn points_of(&self, item: &[usize; N]) -> [DVec3; N] {
        item.map(|point| self.points[point])
    }

    /// Returns the least number that a function gives of the items; it gets the least one so far. `bound` gives a number that
    /// no item in a box falls below: boxes that cannot have less are left out. Returns `most` if no number is less.
    pub(super) fn least(
        &self,
        most: f64,
        bound: impl Fn(DVec3, DVec3) -> f64,
        mut of_item: impl FnMut([DVec3; N], f64) -> f64,
    ) -> f64 {
        let mut least = most;
        let bound = |number: usize| bound(self.nodes[number].low, self.nodes[number].high);
        let mut waiting = vec![0];
        while let Some(number) = waiting.pop() {
            // Also where it is not a number: in a box around nothing.
            let may_be_less = bound(number) < least;
            if !may_be_less {
                continue;
            }
            let node = &self.nodes[number];
            if node.is_leaf() {
                for item in &self.items[node.first..node.end] {
                    least = least.min(of_item(self.points_of(item), least));
                }
                continue;
            }
            let first = number + 1;
            let second = self.nodes[first].after;
            // The one that may have less is looked at first.
            if bound(first) <= bound(second) {
                waiting.extend([second, first]);
            } else {
                waiting.extend([first, second]);
            }
        }
        least
    }

    /// Calls `visit` with the items in boxes that pass a test, and in boxes beside these.
    pub(super) fn each_in(
        &self,
        passes: impl Fn(DVec3, DVec3) -> bool,
        mut visit: impl FnMut([DVec3; N]),
    ) {
        let mut number = 0;
        while let Some(node) = self.nodes.get(number) {
            if !passes(node.low, node.high) {
                number = node.after;
                continue;
            }
            if node.is_leaf() {
                let items = self.items[node.first..node.end].iter();
                items.for_each(|item| visit(self.points_of(item)));
            }
            number += 1;
        }
    }
}

impl PointTree<1> {
    pub(super) fn of_points(points: Vec<DVec3>) -> Self {
        let items = (0..points.len()).map(|point| [point]).collect();
        Self::new(points, items)
    }

    /// Returns the largest scalar product of a vector with a point, as it is rounded; minus infinity without points.
    pub(super) fn highest(&self, direction: DVec3) -> f64 {
        let is_up = direction.cmpge(DVec3::ZERO);
        // Products and sums are rounded upward or downward together: no point of the box has a larger product.
        let bound = |low, high| -direction.dot(DVec3::select(is_up, high, low));
        -self.least(f64::INFINITY, bound, |[point], _| -direction.dot(point))
    }
}

/// Adds the node of some items, whose first has this number, and all nodes within.
fn build<const N: usize>(
    points: &[DVec3],
    items: &mut [[usize; N]],
    first: usize,
    nodes: &mut Vec<PointNode>,
) {
    let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for &point in items.iter().flatten() {
        (low, high) = (low.min(points[point]), high.max(points[point]));
    }
    let own = nodes.len();
    let node = PointNode {
        low,
        high,
        first,
        end: first + items.len(),
        after: own + 1,
    };
    nodes.push(node);
    if !node.is_leaf() {
        let axis = (high - low).max_position();
        let place =
            |item: &[usize; N]| -> f64 { item.iter().map(|&point| points[point][axis]).sum() };
        let half = items.len() / 2;
        items.select_nth_unstable_by(half, |a, b| {
            place(a).total_cmp(&place(b)).then_with(|| a.cmp(b))
        });
        let (lower, upper) = items.split_at_mut(half);
        build(points, lower, first, nodes);
        build(points, upper, first + half, nodes);
    }
    nodes[own].after = nodes.len();
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
            let tree = PointTree::of_points(points.clone());
            for direction in (0..50).map(|_| point()).chain([DVec3::ZERO, -DVec3::Y]) {
                let products = points.iter().map(|point| direction.dot(*point));
                let expected = products.fold(f64::NEG_INFINITY, f64::max);
                let found = tree.highest(direction);
                // Of zeros either one.
                let is_same = (found - expected).abs() <= 0.0 || found.total_cmp(&expected).is_eq();
                assert!(is_same, "{count} {direction}");
            }
        }
    }
}
