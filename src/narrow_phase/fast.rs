//! Contacts in f32: the one answer that does not come from the exact solver.
//!
//! The relative control points are formed in f64 and rounded, in a power of two that suits each
//! pair; so what is lost is relative to the local scale, not to the world. The batch kernel finds
//! the least distances. Where one is so near the threshold that f32 cannot tell, the exact solver
//! answers; elsewhere a contact's first and last instant are sought in f32, with the threshold raised
//! by more than f32 can be wrong. So the spans in which there is contact are those of the exact
//! solver; a contact is reported early rather than late, and two in one span are reported as one.

use super::contact::{Approach, Contact, join};
use super::kernels::{CubicBatch, Level, closest_approach};
use super::relative::{RelativeMotion, filter_threshold, local_scale};
use super::{Party, contact_radius};
use crate::rounding::normalising_power;
use crate::spans::Span;
use glam::Vec3A;

/// What f32 can be wrong by, relative to the polygon's size and the radius: 2^-17 = 128 roundings.
/// Rounding the points takes 2 of them, cutting them 9, halving them 3 a time, the kernel 16.
const CLEARANCE: f32 = 1.0 / 131_072.0;

/// How much of a span a contact may begin too early or end too late, as a power of two.
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
    /// In that unit: at a lesser distance there is contact, at a larger one there is none.
    thresholds: (f32, f32),
}

/// Pairs of bodies whose contacts are found together.
#[derive(Debug, Default)]
pub(crate) struct FastBatch {
    entries: Vec<Entry>,
    cubics: CubicBatch<f32>,
    times: Vec<f32>,
    distances: Vec<f32>,
    contacts: Vec<Contact>,
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
        let offset = sphere_a.offset - sphere_b.offset;
        for span in spans {
            let times = (span.start.max(clip.0), span.end.min(clip.1));
            if times.0 > times.1 {
                continue;
            }
            let (segment_a, segment_b) =
                (&a.segments[span.a as usize], &b.segments[span.b as usize]);
            let motion = RelativeMotion::between(segment_a, segment_b, times);
            let points = motion.points(offset);
            let largest = points.iter().fold(radius, |largest, point| {
                largest.max(point.abs().max_element())
            });
            let power = normalising_power(largest);
            let points = points.map(|point| (point * power).as_vec3a());
            let size = points
                .iter()
                .map(|point| point.length_squared())
                .fold(0.0, f32::max)
                .sqrt();
            // What f64 can be wrong by. In a formation, whose relative motion is small, that is more
            // than what f32 loses of it.
            let scale = local_scale(segment_a, segment_b, (span.start, span.end), offset);
            let mut blur = filter_threshold(radius, scale) - radius;
            if times != (span.start, span.end) {
                // The exact solver finds an instant, and rounds it to where the window cuts.
                blur += motion.blur();
            }
            let blur = nearest(blur * power);
            let radius = nearest(radius * power);
            let clearance = CLEARANCE * (size + radius) + blur;
            self.cubics.push(points.map(|point| point.to_array()));
            self.entries.push(Entry {
                pair,
                span,
                radii: sphere_a.radius + sphere_b.radius,
                times,
                points,
                power,
                thresholds: (radius - clearance, radius + clearance),
            });
        }
        true
    }

    /// Calls `report` with the number of each pair that has contacts, and these, in the order of
    /// time. `exact` appends the contacts of such a pair in a span as the exact solver has them. Pairs come
    /// in the order in which they were added; all are forgotten then.
    pub(crate) fn solve(
        &mut self,
        level: Level,
        exact: impl Fn(usize, Span, &mut Vec<Contact>),
        mut report: impl FnMut(usize, &[Contact]),
    ) {
        self.times.resize(self.entries.len(), 0.0);
        self.distances.resize(self.entries.len(), 0.0);
        closest_approach(
            level,
            &self.cubics.lanes(),
            &mut self.times,
            &mut self.distances,
        );
        let least = self.times.iter().zip(&self.distances);
        let mut found = self.entries.iter().zip(least).peekable();
        while let Some((entry, (&time, &distance))) = found.next() {
            let (certain, possible) = entry.thresholds;
            if distance < certain {
                self.contacts.push(entry.contact(time, distance));
            } else if distance <= possible {
                exact(entry.pair, entry.span, &mut self.contacts);
            }
            if found
                .peek()
                .is_none_or(|(following, _)| following.pair != entry.pair)
            {
                join(&mut self.contacts, 0);
                if !self.contacts.is_empty() {
                    report(entry.pair, &self.contacts);
                }
                self.contacts.clear();
            }
        }
        self.entries.clear();
        self.cubics.clear();
    }
}

impl Entry {
    /// From the local time of the least distance, and that distance: less than the threshold.
    fn contact(&self, time: f32, distance: f32) -> Contact {
        let threshold = self.thresholds.1;
        let [p0, p1, p2, p3] = self.points;
        let first = first_within(&self.points, time, threshold);
        let last = first_within(&[p3, p2, p1, p0], 1.0 - time, threshold);
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
        Contact {
            enter: instant(first).min(closest),
            exit: instant(1.0 - last).max(closest),
            closest: Approach::at(
                closest,
                f64::from(distance) / self.power - self.radii,
                (0, 0),
                self.span,
            ),
        }
    }
}

/// The first local time at which the distance can be within the threshold, or up to 2^-[`HALVINGS`]
/// before it; `time` is one at which it is.
fn first_within(points: &[Vec3A; 4], time: f32, threshold: f32) -> f32 {
    if points[0].length_squared() <= level_at(threshold) {
        return 0.0;
    }
    let before = split(points, time).0;
    let first = if falls(&before) {
        crossing(&before, threshold)
    } else {
        first_by_halves(&before, threshold, HALVINGS).unwrap_or(1.0)
    };
    time * first
}

/// Whether the squared distance falls all along, as far as its control heights tell.
fn falls(points: &[Vec3A; 4]) -> bool {
    squared_distance(points)
        .windows(2)
        .all(|heights| heights[1] < heights[0])
}

/// Where the distance, which falls, comes to the threshold: by Newton's steps, kept between what is
/// beyond and what is within; or a little before.
fn crossing(points: &[Vec3A; 4], threshold: f32) -> f32 {
    /// They double the digits, of which there are 16.
    const MOST_STEPS: usize = 24;
    const NEAR: f32 = 1.0 / (1 << (HALVINGS + 2)) as f32;
    let [p0, p1, p2, p3] = *points;
    let (c1, c2, c3) = (
        (p1 - p0) * 3.0,
        ((p2 - p1) - (p1 - p0)) * 3.0,
        (p3 - p0) - (p2 - p1) * 3.0,
    );
    let level = level_at(threshold);
    let (mut beyond, mut within) = (0.0_f32, 1.0_f32);
    let (mut s, mut is_last) = (0.0, false);
    for _ in 0..MOST_STEPS {
        let position = p0 + (c1 + (c2 + c3 * s) * s) * s;
        let rate = c1 + (c2 * 2.0 + c3 * (3.0 * s)) * s;
        let excess = position.length_squared() - level;
        if excess > 0.0 {
            beyond = s;
        } else {
            within = s;
        }
        if within - beyond <= NEAR || is_last && beyond >= s {
            break;
        }
        let newton = s - excess / (2.0 * position.dot(rate));
        let next = if newton > beyond && newton < within {
            newton
        } else {
            0.5 * (beyond + within)
        };
        // A small step comes near the crossing; a little before it, it is asked whether that is so.
        is_last = (next - s).abs() <= NEAR;
        s = if is_last { next - NEAR } else { next };
        if s <= beyond {
            break;
        }
    }
    beyond
}

/// The first local time at which the distance can be within the threshold, or up to 2^-`halvings`
/// before it; none if it never can.
fn first_by_halves(points: &[Vec3A; 4], threshold: f32, halvings: u32) -> Option<f32> {
    let coefficients = squared_distance(points);
    let level = level_of(points, threshold);
    if coefficients.iter().all(|&coefficient| coefficient > level) {
        return None;
    }
    if coefficients[0] <= level_at(threshold) || halvings == 0 {
        return Some(0.0);
    }
    let (first, second) = split(points, 0.5);
    match first_by_halves(&first, threshold, halvings - 1) {
        Some(s) => Some(0.5 * s),
        None => first_by_halves(&second, threshold, halvings - 1).map(|s| 0.5 + 0.5 * s),
    }
}

/// What the squared distance at an instant is compared with. The rounding of the position is in the
/// threshold; that of the squares is relative to them: 3 units, and one of the threshold's.
fn level_at(threshold: f32) -> f32 {
    threshold * threshold * (1.0 + 4.0 * f32::EPSILON)
}

/// What the squared distance's coefficients are compared with. Their rounding is relative to the
/// part at hand: 8 units, twice.
fn level_of(points: &[Vec3A; 4], threshold: f32) -> f32 {
    let size = points
        .iter()
        .map(|point| point.length_squared())
        .fold(0.0, f32::max);
    threshold * threshold + 16.0 * (f32::EPSILON / 2.0) * size
}

/// The parts before and after a local time.
fn split(points: &[Vec3A; 4], s: f32) -> ([Vec3A; 4], [Vec3A; 4]) {
    let between = |a: Vec3A, b: Vec3A| a + (b - a) * s;
    let [p0, p1, p2, p3] = *points;
    let (q0, q1, q2) = (between(p0, p1), between(p1, p2), between(p2, p3));
    let (r0, r1) = (between(q0, q1), between(q1, q2));
    let middle = between(r0, r1);
    ([p0, q0, r0, middle], [middle, r1, q2, p3])
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
