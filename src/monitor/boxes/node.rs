//! Sixteen boxes side by side.

use parry3d::bounding_volume::Aabb;

/// Boxes in a node.
pub(super) const WIDTH: usize = 16;

/// Low and high corner; an empty box has them the wrong way round, and meets nothing.
pub(super) type Corners = ([f32; 3], [f32; 3]);

pub(super) const EMPTY: Corners = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);

/// A node of the tree: boxes of bodies, or around the nodes below.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub(super) struct BoxNode {
    low: [[f32; WIDTH]; 3],
    high: [[f32; WIDTH]; 3],
}

impl BoxNode {
    pub(super) const EMPTY: Self = Self {
        low: [[f32::INFINITY; WIDTH]; 3],
        high: [[f32::NEG_INFINITY; WIDTH]; 3],
    };

    #[inline(always)]
    pub(super) fn set(&mut self, lane: usize, (low, high): Corners) {
        for axis in 0..3 {
            self.low[axis][lane] = low[axis];
            self.high[axis][lane] = high[axis];
        }
    }

    #[inline(always)]
    pub(super) fn get(&self, lane: usize) -> Corners {
        (
            [0, 1, 2].map(|axis| self.low[axis][lane]),
            [0, 1, 2].map(|axis| self.high[axis][lane]),
        )
    }

    /// Returns the box around all.
    #[inline(always)]
    pub(super) fn around(&self) -> Corners {
        let mut around = EMPTY;
        for axis in 0..3 {
            let (lows, highs) = (&self.low[axis], &self.high[axis]);
            around.0[axis] = reduce(lows, |x, y| if y < x { y } else { x });
            around.1[axis] = reduce(highs, |x, y| if y > x { y } else { x });
        }
        around
    }

    /// Returns a bit for each lane whose box overlaps another (touching counts).
    #[inline(always)]
    pub(super) fn meeting(&self, (low, high): &Corners) -> u32 {
        let mut lanes = 0;
        for lane in 0..WIDTH {
            let meets = (self.low[0][lane] <= high[0])
                & (self.high[0][lane] >= low[0])
                & (self.low[1][lane] <= high[1])
                & (self.high[1][lane] >= low[1])
                & (self.low[2][lane] <= high[2])
                & (self.high[2][lane] >= low[2]);
            lanes |= u32::from(meets) << lane;
        }
        lanes
    }
}

/// Combines halves until one lane is left.
#[inline(always)]
fn reduce(lanes: &[f32; WIDTH], pick: impl Fn(f32, f32) -> f32) -> f32 {
    let mut lanes = *lanes;
    let mut count = WIDTH;
    while count > 1 {
        count /= 2;
        for lane in 0..count {
            lanes[lane] = pick(lanes[lane], lanes[lane + count]);
        }
    }
    lanes[0]
}

#[inline(always)]
pub(super) fn merged((low, high): Corners, (other_low, other_high): Corners) -> Corners {
    (
        [0, 1, 2].map(|axis| low[axis].min(other_low[axis])),
        [0, 1, 2].map(|axis| high[axis].max(other_high[axis])),
    )
}

/// Returns true if one box is inside another and touches none of its sides.
#[inline(always)]
pub(super) fn is_inside((low, high): Corners, (other_low, other_high): Corners) -> bool {
    (0..3).all(|axis| low[axis] > other_low[axis] && high[axis] < other_high[axis])
}

#[inline(always)]
pub(super) fn corners(aabb: &Aabb) -> Corners {
    (aabb.mins.to_array(), aabb.maxs.to_array())
}
