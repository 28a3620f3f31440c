//! What pairs of spheres have shown of their bodies, and which others may matter still.

use super::{Candidate, Clusters, Shown};
use crate::hitbox::Sphere;
use crate::rounding::norm;
use glam::DVec3;

/// What pairs of spheres have shown of their bodies so far.
pub(super) struct Known<'a> {
    clusters: &'a Clusters<'a>,
    part: (f64, f64),
    margin: f64,
    slack: f64,
    /// In which direction to look while nothing is known.
    toward: DVec3,
    /// When the bodies are within the margin, in the order of time.
    stretches: Vec<Stretch>,
    /// What comes nearer than this may be nearer than what is known, m.
    near: f64,
    /// When they may be apart.
    gaps: Vec<Gap>,
    /// Whether in one of these not all pairs are known to be apart.
    is_open: bool,
    /// Which gap and direction was asked about last.
    asked: (usize, usize),
}

#[derive(Clone, Copy, Debug)]
struct Stretch {
    shown: Shown,
    /// Offsets of the spheres that begin and end it.
    first: DVec3,
    last: DVec3,
}

/// A time in which no pair of spheres was shown to be within the margin.
struct Gap {
    /// Control points of the relative motion.
    points: [DVec3; 4],
    /// In which bodies may be apart: those in which they touch before and after.
    directions: Vec<Direction>,
}

#[derive(Clone, Copy, Debug)]
struct Direction {
    unit: DVec3,
    /// No control point is less far in it, m.
    least: f64,
    state: State,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum State {
    /// Not asked yet.
    Open,
    /// All pairs of spheres are apart in it.
    Clear,
    /// Some are not.
    Mixed,
}

impl Direction {
    fn new(points: &[DVec3; 4], toward: DVec3) -> Self {
        // No number where spheres touch at their centres: then it tells nothing.
        let unit = toward / norm(toward);
        let along = points.map(|point| point.dot(unit));
        Self {
            unit,
            least: along.into_iter().fold(f64::INFINITY, f64::min),
            state: State::Open,
        }
    }
}

impl<'a> Known<'a> {
    pub(super) fn new(
        clusters: &'a Clusters<'a>,
        part: (f64, f64),
        margin: f64,
        (toward, slack): (DVec3, f64),
    ) -> Self {
        let mut known = Self {
            clusters,
            part,
            margin,
            slack,
            toward,
            stretches: Vec::new(),
            near: f64::NEG_INFINITY,
            gaps: Vec::new(),
            is_open: true,
            asked: (0, 0),
        };
        known.find_gaps();
        known
    }

    /// Takes in what a pair of spheres with this offset shows.
    pub(super) fn learn(&mut self, shown: &[Shown], offset: DVec3) {
        let mut is_longer = false;
        for &shown in shown {
            let mut stretches = self.stretches.iter_mut();
            let holding = stretches.find(|stretch| {
                stretch.shown.enter <= shown.enter && shown.exit <= stretch.shown.exit
            });
            if let Some(stretch) = holding {
                let separation = &mut stretch.shown.separation;
                *separation = separation.min(shown.separation);
            } else {
                is_longer = true;
                self.stretches.push(Stretch {
                    shown,
                    first: offset,
                    last: offset,
                });
            }
        }
        if is_longer {
            self.join();
            self.find_gaps();
        }
        // The nearest of each stretch matters, not that of all of them.
        let separations = self.stretches.iter().map(|one| one.shown.separation);
        let nearest = separations.fold(f64::NEG_INFINITY, f64::max);
        self.near = nearest + self.slack;
    }

    fn join(&mut self) {
        let stretches = &mut self.stretches;
        stretches.sort_by(|x, y| x.shown.enter.total_cmp(&y.shown.enter));
        stretches.dedup_by(|next, before| {
            let meets = next.shown.enter <= before.shown.exit;
            if meets {
                if next.shown.exit > before.shown.exit {
                    before.shown.exit = next.shown.exit;
                    before.last = next.last;
                }
                let separation = before.shown.separation.min(next.shown.separation);
                before.shown.separation = separation;
            }
            meets
        });
    }

    fn find_gaps(&mut self) {
        self.is_open = true;
        self.gaps.clear();
        let (mut from, mut before) = (self.part.0, None);
        for stretch in &self.stretches {
            if stretch.shown.enter > from {
                let ends = (before, Some(stretch.first));
                let gap = self.gap((from, stretch.shown.enter), ends);
                self.gaps.push(gap);
            }
            (from, before) = (stretch.shown.exit, Some(stretch.last));
        }
        if self.part.1 > from || self.stretches.is_empty() {
            let gap = self.gap((from, self.part.1), (before, None));
            self.gaps.push(gap);
        }
    }

    /// A gap between two touching pairs of spheres with these offsets, or the ends of the part.
    fn gap(&self, interval: (f64, f64), (before, after): (Option<DVec3>, Option<DVec3>)) -> Gap {
        let points = self.clusters.points_between(interval);
        let before = before.map(|offset| points[0] + offset);
        let after = after.map(|offset| points[3] + offset);
        let neither = before.is_none() && after.is_none();
        let towards = [before, after, neither.then_some(self.toward)];
        let directions = towards.into_iter().flatten();
        Gap {
            directions: directions
                .map(|toward| Direction::new(&points, toward))
                .collect(),
            points,
        }
    }

    /// The two spheres that reach farthest in a direction in which the bodies may be apart, if they
    /// are not; none if all directions have been asked about.
    pub(super) fn support(&mut self) -> Option<(u32, u32)> {
        let Clusters { a, b, .. } = self.clusters;
        let bound = self.margin + self.slack;
        for (number, gap) in self.gaps.iter_mut().enumerate() {
            for (place, direction) in gap.directions.iter_mut().enumerate() {
                if direction.state != State::Open {
                    continue;
                }
                let unit = direction.unit;
                let reach_a = |sphere: &Sphere| -sphere.offset.dot(unit) + sphere.radius;
                let reach_b = |sphere: &Sphere| sphere.offset.dot(unit) + sphere.radius;
                let (support_a, reach_a) = farthest(a.spheres, reach_a);
                let (support_b, reach_b) = farthest(b.spheres, reach_b);
                if direction.least - reach_a - reach_b > bound {
                    direction.state = State::Clear;
                } else {
                    self.asked = (number, place);
                    return Some((support_a, support_b));
                }
            }
        }
        self.is_open = !self.gaps.iter().all(Gap::is_clear);
        None
    }

    /// Has the direction that was asked about last not be asked about again.
    pub(super) fn pass_over(&mut self) {
        let (gap, place) = self.asked;
        self.gaps[gap].directions[place].state = State::Mixed;
    }

    /// Whether a pair of spheres may be within the margin when nothing was shown to be, or nearer
    /// than what was.
    pub(super) fn may_matter(&self, candidate: &Candidate) -> bool {
        if candidate.low > self.near && !self.is_open {
            return false;
        }
        let clusters = self.clusters;
        let offset = clusters.offset(candidate);
        let is_beyond = |points: &[DVec3; 4], margin: f64| {
            let points = points.map(|point| point + offset);
            clusters.is_beyond(&points, candidate, margin)
        };
        let near = self.near - self.slack;
        if candidate.low <= self.near && !is_beyond(&clusters.motion.points(DVec3::ZERO), near) {
            return true;
        }
        let (a, b) = clusters.spheres(candidate);
        let bound = self.margin + self.slack + (a.radius + b.radius);
        self.gaps.iter().any(|gap| {
            let is_apart = |direction: &Direction| {
                direction.state == State::Clear
                    || direction.least + offset.dot(direction.unit) > bound
            };
            !gap.directions.iter().any(is_apart) && !is_beyond(&gap.points, self.margin)
        })
    }
}

impl Gap {
    fn is_clear(&self) -> bool {
        let mut directions = self.directions.iter();
        directions.any(|direction| direction.state == State::Clear)
    }
}

/// The sphere for which this is largest, and that.
fn farthest(spheres: &[Sphere], reach: impl Fn(&Sphere) -> f64) -> (u32, f64) {
    let reaches = (0..).zip(spheres.iter().map(reach));
    let farther = |x: (u32, f64), y: (u32, f64)| if y.1 > x.1 { y } else { x };
    reaches.reduce(farther).unwrap_or((0, f64::NEG_INFINITY))
}
