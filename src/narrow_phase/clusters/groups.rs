//! Groups of neighbouring spheres: the lower level of a tree of two levels.

use super::chords::PiecewiseLinearBound;
use super::{ClusterPair, SpherePairBound};
use crate::count::short;
use crate::hitbox::Sphere;
use glam::DVec3;
use std::ops::Range;

/// Spheres of body b that may come within a margin of body a, in groups.
pub(super) struct SphereGroups<'a> {
    /// Sphere around each group, and the end of its spheres in the list.
    groups: Vec<(Sphere, usize)>,
    spheres: Vec<(u32, &'a Sphere)>,
}

impl<'a> SphereGroups<'a> {
    /// Largest number of spheres for which groups do not pay.
    const FEW: usize = 32;
    /// Largest number of spheres in a group.
    const SIZE: usize = 8;
    /// Number of pairs from which on a list is full, after all pairs of a sphere of a. Tests have several
    /// lists.
    const FULL: usize = if cfg!(test) { 1 << 6 } else { 1 << 16 };

    /// Returns the groups of a pair's body b.
    pub(super) fn of(
        clusters: &ClusterPair<'a>,
        chords: &PiecewiseLinearBound,
        margin: f64,
    ) -> Self {
        let (sphere_a, bound) = (clusters.a.bounding, margin + chords.slack);
        let near = (0..).zip(clusters.b.spheres).filter(|(_, sphere)| {
            let offset = sphere_a.offset - sphere.offset;
            chords
                .low(offset, sphere_a.radius + sphere.radius, bound)
                .is_some()
        });
        let mut spheres: Vec<(u32, &Sphere)> = near.collect();
        let mut groups = Vec::new();
        if spheres.len() <= Self::FEW {
            groups.push((clusters.b.bounding, spheres.len()));
        } else {
            let count = spheres.len();
            divide(&mut spheres, 0..count, &mut groups);
        }
        Self { groups, spheres }
    }

    /// Lists the pairs that may come within `margin`, in the order of a's spheres, from number `next` of
    /// these on. Ends before the last one when the list is [full](Self::FULL); sets `next` to
    /// the first one that is left. Replaces the content of `found`.
    pub(super) fn list(
        &self,
        (clusters, chords): (&ClusterPair<'_>, &PiecewiseLinearBound),
        margin: f64,
        next: &mut usize,
        found: &mut Vec<SpherePairBound>,
    ) {
        let bound = margin + chords.slack;
        let is_near = |one: &Sphere, other: &Sphere| {
            let offset = one.offset - other.offset;
            chords
                .low(offset, one.radius + other.radius, bound)
                .is_some()
        };
        found.clear();
        while *next < clusters.a.spheres.len() && found.len() < Self::FULL {
            let (a, sphere_a) = (short(*next), &clusters.a.spheres[*next]);
            *next += 1;
            if !is_near(sphere_a, &clusters.b.bounding) {
                continue;
            }
            let mut start = 0;
            for (group, end) in &self.groups {
                let spheres = &self.spheres[start..*end];
                start = *end;
                if self.groups.len() > 1 && !is_near(sphere_a, group) {
                    continue;
                }
                for &(b, sphere_b) in spheres {
                    let radii = sphere_a.radius + sphere_b.radius;
                    let low = chords.low(sphere_a.offset - sphere_b.offset, radii, bound);
                    if let Some(low) = low {
                        found.push(SpherePairBound { a, b, low });
                    }
                }
            }
        }
    }
}

/// Divides a part of a list of spheres into groups, and puts neighbours into the same group.
fn divide(all: &mut [(u32, &Sphere)], part: Range<usize>, groups: &mut Vec<(Sphere, usize)>) {
    let spheres = &mut all[part.clone()];
    let offsets = || spheres.iter().map(|(_, sphere)| sphere.offset);
    let low = offsets().fold(DVec3::INFINITY, DVec3::min);
    let high = offsets().fold(DVec3::NEG_INFINITY, DVec3::max);
    if spheres.len() <= SphereGroups::SIZE {
        let offset = 0.5 * low + 0.5 * high;
        let reach = |(_, sphere): &(u32, &Sphere)| offset.distance(sphere.offset) + sphere.radius;
        let radius = spheres.iter().map(reach).fold(0.0, f64::max);
        groups.push((Sphere { offset, radius }, part.end));
        return;
    }
    let (sides, half) = ((high - low).to_array(), spheres.len() / 2);
    let axis = usize::from(sides[1] > sides[0]);
    let axis = if sides[2] > sides[axis] { 2 } else { axis };
    spheres.select_nth_unstable_by(half, |(_, x), (_, y)| {
        x.offset[axis].total_cmp(&y.offset[axis])
    });
    let middle = part.start + half;
    divide(all, part.start..middle, groups);
    divide(all, middle..part.end, groups);
}
