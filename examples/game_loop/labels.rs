//! Places for labels on the screen, none over another.

/// A rectangle: its left upper corner and its size, pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Area {
    pub(crate) x: f32,
    pub(crate) y: f32,
    pub(crate) width: f32,
    pub(crate) height: f32,
}

impl Area {
    pub(crate) fn overlaps(&self, other: &Self) -> bool {
        self.x < other.x + other.width
            && other.x < self.x + self.width
            && self.y < other.y + other.height
            && other.y < self.y + self.height
    }

    fn is_within(&self, (width, height): (f32, f32)) -> bool {
        self.x >= 0.0
            && self.y >= 0.0
            && self.x + self.width <= width
            && self.y + self.height <= height
    }
}

/// The areas of a screen that are taken.
#[derive(Debug)]
pub(crate) struct Areas {
    screen: (f32, f32),
    taken: Vec<Area>,
}

impl Areas {
    /// A screen of this width and height, with nothing on it.
    pub(crate) const fn new(screen: (f32, f32)) -> Self {
        Self {
            screen,
            taken: Vec::new(),
        }
    }

    /// Nothing is placed here.
    pub(crate) fn take(&mut self, area: Area) {
        self.taken.push(area);
    }

    /// Finds room for a label of this size beside a point, and takes it. There may be none.
    pub(crate) fn place(
        &mut self,
        (x, y): (f32, f32),
        (width, height): (f32, f32),
    ) -> Option<Area> {
        /// From the point to the label, pixels; the nearest first.
        const GAPS: [f32; 3] = [7.0, 26.0, 50.0];
        GAPS.iter()
            .flat_map(|&gap| {
                let (left, right) = (x - gap - width, x + gap);
                let (above, below) = (y - gap - height, y + gap);
                let (middle, centre) = (y - height / 2.0, x - width / 2.0);
                [
                    (right, above),
                    (right, below),
                    (left, above),
                    (left, below),
                    (right, middle),
                    (left, middle),
                    (centre, above),
                    (centre, below),
                ]
            })
            .map(|(x, y)| Area {
                x,
                y,
                width,
                height,
            })
            .find(|area| {
                area.is_within(self.screen) && self.taken.iter().all(|other| !area.overlaps(other))
            })
            .inspect(|&area| self.taken.push(area))
    }
}
