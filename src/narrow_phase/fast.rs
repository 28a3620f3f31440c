//! Contacts in f32: the one answer that does not come from the exact solver.
//!
//! The relative control points are formed in f64 and rounded, in a power of two that suits each
//! pair; so what is lost is relative to the local scale, not to the world. The batch kernel finds
//! the least distances, and Bernstein coefficients of the squared distance the first and the last
//! instant within the threshold. That threshold is raised by more than f32 can be wrong, and what
//! cannot be told is within: a contact is reported early rather than late, and two contacts in one
//! span are reported as one.

use super::contact::{Approach, Contact, join};
use super::kernels::{CubicBatch, Level, closest_approach};
use super::relative::{RelativeCubic, RelativeMotion};
use super::{Party, contact_radius};
use crate::rounding::normalising_power;
use crate::spans::Span;
use glam::Vec3A;

/// What the threshold is raised by for f32, relative to the polygon's size and the radius: 2^-17 = 128
/// roundings of f32. Rounding the points takes 2 of them, halving them 3 a time, the kernel 16.
const CLEARANCE: f32 = 1.0 / 131_072.0;

/// How often a span is halved in search of its first and last instant within the threshold.
const HALVINGS: u32 = 16;

/// Two spheres over the part of a span that is asked about.
#[derive(Clone, Copy, Debug)]
struct Entry {
    pair: usize,
    span: Span,
    radii: f64,
    times: (f64, f64),
    points: [Vec3A; 4],
    /// Lengths times this are near one.
    power: f64,
    /// Raised, in that unit.
    threshold: f32,
}

/// Pairs of bodies whose contacts are found together.
#[derive(Debug, Default)]
pub(crate) struct FastBatch {
    entries: Vec<Entry>,
    cubics: CubicBatch<f32>,
    times: Vec<f32>,
    distances: Vec<f32>,
}

impl FastBatch {
    /// Adds the spans of a pair of bodies, which has a number of the caller's, if each is one sphere;
    /// says whether it was added. (Of clusters few pairs of spheres matter, and which ones shows only
    /// one after the other.)
    pub(crate) fn push(
        &mut self,
        pair: usize,
        (a, b): (&Party<'_>, &Party<'_>),
        spans: impl Iterator<Item = Span>,
        margin: f64,
        clip: (f64, f64),
    ) -> bool {
        let ([sphere_a], [sphere_b]) = (a.spheres, b.spheres) else {
            return false;
        };
        let radius = contact_radius(sphere_a.radius, sphere_b.radius, margin);
        if radius < 0.0 {
            return true;
        }
        for span in spans {
            let times = (span.start.max(clip.0), span.end.min(clip.1));
            if times.0 > times.1 {
                continue;
            }
            let (segment_a, segment_b) =
                (&a.segments[span.a as usize], &b.segments[span.b as usize]);
            let offset = sphere_a.offset - sphere_b.offset;
            let whole =
                RelativeCubic::between(segment_a, segment_b, (span.start, span.end), offset);
            let points = if times == (span.start, span.end) {
                whole.points
            } else {
                RelativeMotion::between(segment_a, segment_b, times).points(offset)
            };
            // What the exact solver counts as contact. In a formation, whose relative motion is small, that
            // is more than what f32 loses of it.
            let radius = radius + whole.tolerance();
            let largest = points.iter().fold(radius, |largest, point| {
                largest.max(point.abs().max_element())
            });
            let power = normalising_power(largest);
            let points = points.map(|point| (point * power).as_vec3a());
            let size = points
                .iter()
                .map(|point| point.length())
                .fold(0.0, f32::max);
            let radius = nearest(radius * power);
            self.cubics.push(points.map(|point| point.to_array()));
            self.entries.push(Entry {
                pair,
                span,
                radii: sphere_a.radius + sphere_b.radius,
                times,
                points,
                power,
                threshold: radius + CLEARANCE * (size + radius),
            });
        }
        true
    }

    /// Calls `report` with the number of each pair that has contacts, and these, in the order of
    /// time. Pairs come in the order in which they were added; all are forgotten then.
    pub(crate) fn solve(&mut self, level: Level, mut report: impl FnMut(usize, &[Contact])) {
        self.times.resize(self.entries.len(), 0.0);
        self.distances.resize(self.entries.len(), 0.0);
        closest_approach(
            level,
            &self.cubics.lanes(),
            &mut self.times,
            &mut self.distances,
        );
        let mut contacts = Vec::new();
        let mut found = self
            .entries
            .iter()
            .zip(self.times.iter().zip(&self.distances));
        let mut next = found.next();
        while let Some((entry, (&time, &distance))) = next {
            contacts.extend(entry.contact(time, distance));
            next = found.next();
            if next.is_none_or(|(following, _)| following.pair != entry.pair) {
                join(&mut contacts, 0);
                if !contacts.is_empty() {
                    report(entry.pair, &contacts);
                }
                contacts.clear();
            }
        }
        self.entries.clear();
        self.cubics.clear();
    }
}

impl Entry {
    /// From the local time of the least distance, and that distance.
    fn contact(&self, time: f32, distance: f32) -> Option<Contact> {
        if distance > self.threshold {
            return None;
        }
        let [p0, p1, p2, p3] = self.points;
        let first = first_within(&self.points, self.threshold, HALVINGS);
        let last = first_within(&[p3, p2, p1, p0], self.threshold, HALVINGS);
        let instant = |s: f32| {
            // From the nearer end, so that contacts of neighbouring spans meet.
            let (start, end) = self.times;
            let s = f64::from(s);
            if s <= 0.5 {
                start + s * (end - start)
            } else {
                end - (1.0 - s) * (end - start)
            }
        };
        let closest = instant(time);
        Some(Contact {
            enter: first.map_or(closest, instant).min(closest),
            exit: last.map_or(closest, |s| instant(1.0 - s)).max(closest),
            closest: Approach::at(
                closest,
                f64::from(distance) / self.power - self.radii,
                (0, 0),
                self.span,
            ),
        })
    }
}

/// The first local time at which the distance can be within the threshold, or up to 2^-`halvings`
/// before it; none if it never can.
fn first_within(points: &[Vec3A; 4], threshold: f32, halvings: u32) -> Option<f32> {
    let coefficients = squared_distance(points);
    let size = points
        .iter()
        .map(|point| point.length_squared())
        .fold(0.0, f32::max);
    // The rounding of the coefficients is relative to the part at hand: 8 units, twice.
    let level = threshold * threshold + 16.0 * (f32::EPSILON / 2.0) * size;
    if coefficients.iter().all(|&coefficient| coefficient > level) {
        return None;
    }
    if coefficients[0] <= level || halvings == 0 {
        return Some(0.0);
    }
    let (first, second) = halved(points);
    match first_within(&first, threshold, halvings - 1) {
        Some(s) => Some(0.5 * s),
        None => first_within(&second, threshold, halvings - 1).map(|s| 0.5 + 0.5 * s),
    }
}

fn halved(points: &[Vec3A; 4]) -> ([Vec3A; 4], [Vec3A; 4]) {
    let middle = |a: Vec3A, b: Vec3A| (a + b) * 0.5;
    let [p0, p1, p2, p3] = *points;
    let (q0, q1, q2) = (middle(p0, p1), middle(p1, p2), middle(p2, p3));
    let (r0, r1) = (middle(q0, q1), middle(q1, q2));
    let centre = middle(r0, r1);
    ([p0, q0, r0, centre], [centre, r1, q2, p3])
}

/// Bernstein coefficients of the squared distance, degree 6.
fn squared_distance(points: &[Vec3A; 4]) -> [f32; 7] {
    let [a, b, c, d] = *points;
    [
        a.dot(a),
        a.dot(b),
        (2.0 * a.dot(c) + 3.0 * b.dot(b)) * 0.2,
        (a.dot(d) + 9.0 * b.dot(c)) * 0.1,
        (2.0 * b.dot(d) + 3.0 * c.dot(c)) * 0.2,
        c.dot(d),
        d.dot(d),
    ]
}

#[allow(
    clippy::cast_possible_truncation,
    reason = "f32 is what was asked for; the clearance covers it"
)]
fn nearest(value: f64) -> f32 {
    value as f32
}
