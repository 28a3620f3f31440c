//! Facts proven by the pairs of spheres solved so far, and tests whether other pairs still matter.

use super::{ClusterPair, ProvenContact, SpherePairBound};
use crate::hitbox::Sphere;
use crate::narrow_phase::sphere_pair::farthest;
use crate::rounding::{earliest_exact, latest_exact, norm};
use glam::DVec3;

/// The facts proven so far about two bodies.
pub(super) struct ProvenIntervals<'a> {
    clusters: &'a ClusterPair<'a>,
    part: (f64, f64),
    margin: f64,
    /// Bound on the rounding of separations, m.
    slack: f64,
    /// Direction to examine while nothing is proven.
    toward: Option<DVec3>,
    /// Intervals in which the bodies are within the margin, in time order.
    stretches: Vec<ProvenInterval>,
    /// Separation below which a pair may be nearer than those solved, m.
    near: f64,
    /// Intervals in which the bodies may be apart.
    gaps: Vec<UnprovenInterval>,
    /// True if there are too many gaps: then all pairs are solved.
    is_scattered: bool,
}

#[derive(Clone, Copy, Debug)]
struct ProvenInterval {
    contact: ProvenContact,
    /// Offsets of the spheres in contact at its beginning and its end.
    first: DVec3,
    last: DVec3,
}

/// An interval in which no pair of spheres was proven to be within the margin.
struct UnprovenInterval {
    /// Control points of the relative motion.
    points: [DVec3; 4],
    /// Directions in which the bodies may be apart: those of the contacts before and after.
    directions: Vec<SeparatingDirection>,
}

#[derive(Clone, Copy, Debug)]
struct SeparatingDirection {
    unit: DVec3,
    /// Least projection of a control point on it, m.
    least: f64,
    /// True if the spheres that reach farthest in it have been solved.
    is_asked: bool,
}

impl SeparatingDirection {
    fn new(points: &[DVec3; 4], toward: DVec3) -> Self {
        // No number where spheres touch at their centres: then it tells nothing.
        let length = norm(toward);
        let unit = if length >= f64::MIN_POSITIVE {
            toward / length
        } else {
            DVec3::NAN
        };
        let along = points.map(|point| point.dot(unit));
        let smaller = |x: f64, y: f64| if y > x { x } else { y };
        Self {
            unit,
            least: along.into_iter().fold(f64::INFINITY, smaller),
            is_asked: false,
        }
    }
}

impl<'a> ProvenIntervals<'a> {
    const MAX_GAPS: usize = 8;

    pub(super) fn new(
        clusters: &'a ClusterPair<'a>,
        part: (f64, f64),
        margin: f64,
        slack: f64,
    ) -> Self {
        Self {
            clusters,
            part,
            margin,
            slack,
            toward: None,
            stretches: Vec::new(),
            near: f64::NEG_INFINITY,
            gaps: Vec::new(),
            is_scattered: false,
        }
    }

    /// Sets the direction to examine while nothing is proven.
    pub(super) fn look(&mut self, toward: DVec3) {
        if self.stretches.is_empty() {
            self.toward = Some(toward);
            self.find_gaps();
        }
    }

    /// Returns true if further pairs can prove more, so that not all pairs are solved.
    pub(super) const fn can_learn(&self) -> bool {
        !self.is_scattered
    }

    /// Adds the contacts of a pair of spheres with this offset.
    pub(super) fn learn(&mut self, contacts: &[ProvenContact], offset: DVec3) {
        let mut is_longer = false;
        for &contact in contacts {
            let mut stretches = self.stretches.iter_mut();
            let holding = stretches.find(|stretch| {
                stretch.contact.enter <= contact.enter && contact.exit <= stretch.contact.exit
            });
            if let Some(stretch) = holding {
                let separation = &mut stretch.contact.separation;
                *separation = separation.min(contact.separation);
            } else {
                is_longer = true;
                self.stretches.push(ProvenInterval {
                    contact,
                    first: offset,
                    last: offset,
                });
            }
        }
        if is_longer {
            self.join();
            self.is_scattered |= self.stretches.len() >= Self::MAX_GAPS;
            if !self.is_scattered {
                self.find_gaps();
            }
        }
        // Each stretch has a least separation of its own. A pair must be farther than the largest of these to
        // matter in none.
        let separations = self.stretches.iter().map(|one| one.contact.separation);
        let nearest = separations.fold(f64::NEG_INFINITY, f64::max);
        self.near = nearest + self.slack;
    }

    fn join(&mut self) {
        let stretches = &mut self.stretches;
        stretches.sort_by(|x, y| x.contact.enter.total_cmp(&y.contact.enter));
        stretches.dedup_by(|next, before| {
            let meets = next.contact.enter <= before.contact.exit;
            if meets {
                if next.contact.exit > before.contact.exit {
                    before.contact.exit = next.contact.exit;
                    before.last = next.last;
                }
                let separation = before.contact.separation.min(next.contact.separation);
                before.contact.separation = separation;
            }
            meets
        });
    }

    fn find_gaps(&mut self) {
        self.gaps.clear();
        let (mut from, mut before) = (self.part.0, None);
        for stretch in &self.stretches {
            if stretch.contact.enter > from {
                let ends = (before, Some(stretch.first));
                let gap = self.gap((from, stretch.contact.enter), ends);
                self.gaps.push(gap);
            }
            (from, before) = (stretch.contact.exit, Some(stretch.last));
        }
        if self.part.1 > from || self.stretches.is_empty() {
            let gap = self.gap((from, self.part.1), (before, None));
            self.gaps.push(gap);
        }
    }

    /// Returns the gap between two contacts with these offsets, or an end of the part.
    fn gap(
        &self,
        (from, to): (f64, f64),
        (before, after): (Option<DVec3>, Option<DVec3>),
    ) -> UnprovenInterval {
        // Instants are rounded: what begins at one of these may have begun in the gap.
        let interval = (
            earliest_exact(from).max(self.part.0),
            latest_exact(to).min(self.part.1),
        );
        let points = self.clusters.points_between(interval);
        let before = before.map(|offset| points[0] + offset);
        let after = after.map(|offset| points[3] + offset);
        let neither = before.is_none() && after.is_none();
        let towards = [before, after, self.toward.filter(|_| neither)];
        let directions = towards.into_iter().flatten();
        UnprovenInterval {
            directions: directions
                .map(|toward| SeparatingDirection::new(&points, toward))
                .collect(),
            points,
        }
    }

    /// Returns the two spheres that reach farthest in a direction not yet asked about.
    pub(super) fn support(&mut self) -> Option<(u32, u32)> {
        let ClusterPair { a, b, .. } = self.clusters;
        let mut directions = self.gaps.iter_mut().flat_map(|gap| &mut gap.directions);
        let direction = directions.find(|direction| !direction.is_asked)?;
        direction.is_asked = true;
        let along = |sphere: &Sphere| sphere.offset.dot(direction.unit);
        let support_a = farthest(a.spheres.iter().map(|one| one.radius - along(one)));
        let support_b = farthest(b.spheres.iter().map(|one| one.radius + along(one)));
        Some((support_a, support_b))
    }

    /// Returns true if a pair may be within the margin in a gap, or nearer than the pairs solved.
    pub(super) fn may_matter(&self, candidate: &SpherePairBound) -> bool {
        if self.is_scattered {
            return true;
        }
        let clusters = self.clusters;
        let offset = clusters.offset(candidate);
        let is_beyond = |points: &[DVec3; 4], margin: f64| {
            let points = points.map(|point| point + offset);
            clusters.is_beyond(&points, candidate, margin)
        };
        let points = clusters.motion.points(DVec3::ZERO);
        if candidate.low <= self.near && !is_beyond(&points, self.near) {
            return true;
        }
        let (a, b) = clusters.spheres(candidate);
        let bound = self.margin + self.slack + (a.radius + b.radius);
        self.gaps.iter().any(|gap| {
            let is_apart = |direction: &SeparatingDirection| {
                direction.least + offset.dot(direction.unit) > bound
            };
            !gap.directions.iter().any(is_apart) && !is_beyond(&gap.points, self.margin)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A direction without a number proves nothing.
    #[test]
    fn no_direction_tells_nothing() {
        let points = [DVec3::splat(3.0); 4];
        assert!(SeparatingDirection::new(&points, DVec3::ONE).least > 5.0);
        for toward in [
            DVec3::ZERO,
            DVec3::splat(5e-324),
            DVec3::new(1e-310, -1e-310, 0.0),
        ] {
            assert!(
                SeparatingDirection::new(&points, toward).least.is_nan(),
                "{toward}"
            );
        }
    }
}
