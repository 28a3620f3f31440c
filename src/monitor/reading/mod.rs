//! What pairs have at one alert level, whatever the window, and which of it lies in one.

mod conflicts;
mod plains;

pub(super) use conflicts::Conflicts;
pub(super) use plains::Plains;

/// Two bodies, the smaller slot first.
pub(super) type Slots = (u32, u32);

/// Where a value is: its place among those that are kept whatever the window, or its number among
/// those that were read again, since they are at an edge of it.
#[derive(Clone, Copy, Debug)]
enum Origin {
    Always(usize),
    AtEdge(usize),
}

/// Where a window ends, twice: what lies between the ends of `within` is within the window, what
/// does not meet `around` is beyond it, and the rest is at its edge.
#[derive(Clone, Copy, Debug)]
pub(super) struct Edges {
    pub(super) within: (f64, f64),
    pub(super) around: (f64, f64),
}

/// How a contact lies to a window.
#[derive(PartialEq)]
enum Place {
    Within,
    Beyond,
    AtEdge,
}

impl Edges {
    fn place(&self, (start, end): (f64, f64)) -> Place {
        if start > self.within.0 && end < self.within.1 {
            Place::Within
        } else if end < self.around.0 || start > self.around.1 {
            Place::Beyond
        } else {
            Place::AtEdge
        }
    }
}
