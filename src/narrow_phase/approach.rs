//! Times at which two bodies may be near each other in a slice: the cheapest test of a candidate.

use crate::bounds::FatLine;
use glam::Vec3A;

/// Returns the part of a slice (first and last instant, s) in which two bodies may be within the
/// margin of each other, by their fat lines alone. `None` if they certainly never are.
///
/// The difference of two straight motions is straight, and within the sum of the radii of zero
/// only between the roots of a quadratic. The radii include all rounding of the fat lines. They
/// exceed that of this function a million times: 2^-22 of the coordinates, where f64 rounds 2^-53.
#[inline]
pub(crate) fn approaching(a: &FatLine, b: &FatLine, interval: (f64, f64)) -> Option<(f64, f64)> {
    let passage = Passage::of(a, b);
    (!passage.is_beyond()).then(|| passage.interval(interval))
}

/// Removes the candidates whose fat lines stay apart, extended to all times, and those for which [`approaching`]
/// returns `None`. `lines` returns the two fat lines of a candidate. `fetch` fetches those of later ones, given its
/// place.
///
/// The processor cannot predict which lines are apart. So each test is made of all that are left, without a
/// branch, and the tests of several candidates overlap.
#[inline]
pub(crate) fn keep_approaching<'f, T: Copy>(
    candidates: &mut Vec<T>,
    lines: impl Fn(T) -> [&'f FatLine; 2],
    fetch: impl Fn(usize),
) {
    retain_from(0, candidates, |place, one| {
        fetch(place);
        let [a, b] = lines(one);
        !lines_apart(a, b)
    });
    retain_from(0, candidates, |_, one| {
        let [a, b] = lines(one);
        !Passage::of(a, b).is_beyond()
    });
}

/// Keeps those items of a list from `first` on that pass a test, in order, without a branch: the processor cannot
/// predict which ones do.
#[inline]
pub(super) fn retain_from<T: Copy>(
    first: usize,
    list: &mut Vec<T>,
    passes: impl Fn(usize, T) -> bool,
) {
    let mut kept = first;
    for place in first..list.len() {
        let one = list[place];
        list[kept] = one;
        kept += usize::from(passes(place, one));
    }
    list.truncate(kept);
}

/// The straight motion of one fat line's middle relative to another over a slice.
struct Passage {
    apart: [f64; 3],
    change: [f64; 3],
    /// Square of the distance within which the bodies may be near.
    square_radius: f64,
    /// Square of the change.
    square: f64,
    /// Share of the slice at which the two are nearest, if they moved so for ever.
    nearest: f64,
}

impl Passage {
    #[inline]
    fn of(a: &FatLine, b: &FatLine) -> Self {
        /// Factor on the distance for the rounding of the roots. With radii of 2^-22 of the
        /// coordinates it adds at least 2^-42 of the distance travelled, or 2^10 of its roundings.
        const WIDER: f64 = 1.0 + 1e-6;
        let apart = [0, 1, 2].map(|axis| f64::from(a.start[axis]) - f64::from(b.start[axis]));
        let change = [0, 1, 2].map(|axis| f64::from(a.change[axis]) - f64::from(b.change[axis]));
        let radius = (f64::from(a.radius) + f64::from(b.radius)) * WIDER;
        let square = dot(change, change);
        Self {
            apart,
            change,
            square_radius: radius * radius,
            square,
            nearest: -dot(apart, change) / square,
        }
    }

    /// Returns the squared distance at a share of the slice.
    #[inline]
    fn square_at(&self, share: f64) -> f64 {
        let point = [0, 1, 2].map(|axis| self.apart[axis] + share * self.change[axis]);
        dot(point, point)
    }

    /// Returns true if the two are never near in the slice.
    #[inline]
    fn is_beyond(&self) -> bool {
        // Without motion any instant will do, and what is no number is not beyond.
        let share = if self.nearest > 0.0 {
            self.nearest.min(1.0)
        } else {
            0.0
        };
        self.square_at(share) > self.square_radius
    }

    /// Returns the part of the slice in which the two may be near.
    #[inline]
    fn interval(&self, (from, to): (f64, f64)) -> (f64, f64) {
        let nearest = self.nearest;
        // Without motion, or beyond the range of numbers, there is no telling when.
        if !nearest.is_finite() {
            return (from, to);
        }
        // Not below zero but for rounding: the nearest instant of all is no farther.
        let room = (self.square_radius - self.square_at(nearest)).max(0.0);
        let half = (room / self.square).sqrt();
        let (enter, exit) = (nearest - half, nearest + half);
        let instant = |share: f64| from + share * (to - from);
        // Instants are rounded, and between two of them bodies may go a long way.
        let resolution = 4.0 * f64::EPSILON * from.abs().max(to.abs());
        let first = if enter > 0.0 {
            instant(enter) - resolution
        } else {
            from
        };
        let last = if exit < 1.0 {
            instant(exit) + resolution
        } else {
            to
        };
        // Numbers that are not comparable leave the whole slice.
        (from.max(first), to.min(last))
    }
}

#[inline]
fn dot(x: [f64; 3], y: [f64; 3]) -> f64 {
    x[0] * y[0] + x[1] * y[1] + x[2] * y[2]
}

/// Returns true if the lines of two bodies, extended to all times, stay apart.
///
/// The distance of a straight motion from zero is that of its cross product with its change,
/// divided by the change. Rounding (2^-24 each), relative to the product of both lengths: one per
/// difference, one of a product, one of a sum, and three of its square, of which half count; 7 in
/// all. The bound's own are 4 of itself: of that product, where they matter. 16 cover everything.
#[inline]
fn lines_apart(a: &FatLine, b: &FatLine) -> bool {
    const ROUNDING: f32 = 0.5 * f32::EPSILON;
    let difference = |x: [f32; 3], y: [f32; 3]| Vec3A::from_array(x) - Vec3A::from_array(y);
    let (apart, change) = (difference(a.start, b.start), difference(a.change, b.change));
    let radius = (a.radius + b.radius) + apart.abs().element_sum() * (16.0 * ROUNDING);
    let along = change.length_squared();
    let bound = radius * radius * along;
    let square = apart.cross(change).length_squared();
    // Smaller squares have lost digits (that of the radius has not: no radius is below 1e-18). Where those of
    // bodies that meet overflow, so does the bound, and nothing is above it.
    (square > bound) & (along > 1e-30) & (bound > 1e-30)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::rngs::ChaCha8Rng;
    use rand::{RngExt, SeedableRng};

    const SLICE: (f64, f64) = (1_000.0, 1_003.0);

    fn fat_line(rng: &mut ChaCha8Rng, far: f32, fast: f32) -> FatLine {
        let mut vector = |half: f32| [0; 3].map(|_| rng.random_range(-half..half));
        FatLine {
            start: vector(far),
            change: vector(fast),
            radius: rng.random_range(0.0..4.0),
            first: 0,
        }
    }

    fn distance(a: &FatLine, b: &FatLine, share: f64) -> f64 {
        let lane = |axis: usize| {
            f64::from(a.start[axis]) - f64::from(b.start[axis])
                + share * (f64::from(a.change[axis]) - f64::from(b.change[axis]))
        };
        (lane(0).powi(2) + lane(1).powi(2) + lane(2).powi(2)).sqrt()
    }

    /// Every instant within the radii is in the interval, and its ends are close to such instants.
    #[test]
    fn intervals_hold_what_is_near() {
        let mut rng = ChaCha8Rng::seed_from_u64(2);
        let (mut near, mut apart) = (0, 0);
        for round in 0..20_000 {
            // Crossing, far and fast, at rest, and giants at any speed.
            let (far, fast, size) = match round % 4 {
                0 => (8.0, 10.0, 1.0),
                1 => (1e3, 2e3, 1.0),
                2 => (5.0, 1e-30, 1.0),
                _ => (5.0, 10f32.powf(rng.random_range(-30.0..3.0)), 1e6),
            };
            let mut any = || {
                let fat_line = fat_line(&mut rng, far, fast);
                FatLine {
                    start: fat_line.start.map(|lane| lane * size),
                    radius: fat_line.radius * size,
                    ..fat_line
                }
            };
            let (a, b) = (any(), any());
            let radius = f64::from(a.radius) + f64::from(b.radius);
            let found = approaching(&a, &b, SLICE);
            let share_of = |time: f64| (time - SLICE.0) / (SLICE.1 - SLICE.0);
            for step in 0..=100 {
                let share = f64::from(step) / 100.0;
                let time = (SLICE.0 + share * (SLICE.1 - SLICE.0)).min(SLICE.1);
                let inside = found.is_some_and(|(first, last)| first <= time && time <= last);
                assert!(
                    inside || distance(&a, &b, share) > radius,
                    "{a:?} {b:?} {found:?}"
                );
            }
            match found {
                Some((first, last)) => {
                    assert!(SLICE.0 <= first && last <= SLICE.1);
                    near += 1;
                    // A millionth of the radius, and 1e-9 of the way.
                    let slack = 1e-5 * radius + 1e-5;
                    let least = [first, last, 0.5 * (first + last)]
                        .map(|time| distance(&a, &b, share_of(time)))
                        .into_iter()
                        .fold(f64::INFINITY, f64::min);
                    assert!(least <= radius + slack, "{least} {radius}");
                }
                None => apart += 1,
            }
        }
        assert!(near > 2_000 && apart > 2_000, "{near} {apart}");
    }

    /// The test of many candidates at once keeps those that the test of one keeps, in order.
    #[test]
    fn many_are_kept_as_one_by_one() {
        let mut rng = ChaCha8Rng::seed_from_u64(7);
        let mut kept = 0;
        for count in 0..200 {
            let lines: Vec<[FatLine; 2]> = (0..count)
                .map(|_| [fat_line(&mut rng, 8.0, 10.0), fat_line(&mut rng, 8.0, 10.0)])
                .collect();
            let is_kept = |&number: &usize| {
                let [a, b] = &lines[number];
                !lines_apart(a, b) && approaching(a, b, SLICE).is_some()
            };
            let expected: Vec<usize> = (0..count).filter(is_kept).collect();
            let mut numbers: Vec<usize> = (0..count).collect();
            let pair = |number: usize| lines[number].each_ref();
            keep_approaching(&mut numbers, pair, |_| ());
            assert_eq!(numbers, expected);
            kept += expected.len();
        }
        assert!((1_000..19_000).contains(&kept), "{kept}");
    }

    /// Two bodies whose least distance is exactly their radii, seen from a hundred times as far or
    /// farther: in f32 they appear to stay apart about as often as not.
    #[test]
    fn grazing_passes_far_out_are_not_ruled_out() {
        let mut rng = ChaCha8Rng::seed_from_u64(4);
        let mut passes = 0;
        for round in 0..40_000 {
            let out = 10f32.powi(2 + round % 5);
            let mut any = |half: f32| [0; 3].map(|_| rng.random_range(-half..half));
            let (start, change, aside) = (any(out), any(out), any(1.0));
            let back = any(out);
            let one = |start, change| FatLine {
                start,
                change,
                radius: 0.0,
                first: 0,
            };
            // Half way the other is a step aside.
            let other =
                [0, 1, 2].map(|lane| start[lane] + 0.5 * (change[lane] - back[lane]) + aside[lane]);
            let (mut a, mut b) = (one(start, change), one(other, back));
            // As `approaching` has it, in f64: its rounding is far below that of f32.
            let lane = |from: [f32; 3], to: [f32; 3], lane: usize| {
                f64::from(from[lane]) - f64::from(to[lane])
            };
            let apart = glam::DVec3::from_array([0, 1, 2].map(|k| lane(a.start, b.start, k)));
            let change = glam::DVec3::from_array([0, 1, 2].map(|k| lane(a.change, b.change, k)));
            let share = -apart.dot(change) / change.length_squared();
            if !(0.0..=1.0).contains(&share) {
                continue;
            }
            #[allow(clippy::cast_possible_truncation, reason = "rounded up after that")]
            let half = (0.5 * distance(&a, &b, share)) as f32;
            (a.radius, b.radius) = (half.next_up(), half.next_up());
            assert!(!lines_apart(&a, &b), "{a:?} {b:?}");
            assert!(approaching(&a, &b, SLICE).is_some(), "{a:?} {b:?}");
            passes += 1;
        }
        assert!(passes > 10_000, "{passes}");
    }

    /// Places, changes and least distances of all magnitudes.
    #[test]
    fn grazing_passes_at_the_ends_of_the_range_are_not_ruled_out() {
        let mut rng = ChaCha8Rng::seed_from_u64(5);
        let sizes: [[f32; 3]; 5] = [
            [1e-11, 1e-11, 1e-11],
            [1e-9, 1e-9, 1e-15],
            [1e8, 1e-21, 1e8],
            [1e18, 1e18, 1e14],
            [1e14, 1e14, 1e13],
        ];
        for round in 0..50_000 {
            let [out, fast, aside] = sizes[round % 5];
            let mut any = |half: f32| [0; 3].map(|_| half * rng.random_range(-1.0_f32..1.0));
            let (place, change, step) = (any(out), any(fast), any(aside));
            let square = |x: [f32; 3]| x.map(|x| f64::from(x).powi(2)).iter().sum::<f64>();
            // From beside the origin, along the change.
            let along =
                f64::from(rng.random_range(-1.0_f32..1.0)) * f64::from(out) / square(change).sqrt();
            #[allow(clippy::cast_possible_truncation, reason = "any place will do")]
            let start =
                [0, 1, 2].map(|k| (f64::from(step[k]) + along * f64::from(change[k])) as f32);
            let start = if out > aside { start } else { place };
            let [x, y, z] = [[1, 2], [2, 0], [0, 1]].map(|[j, k]: [usize; 2]| {
                f64::from(start[j]) * f64::from(change[k])
                    - f64::from(start[k]) * f64::from(change[j])
            });
            let least = (x * x + y * y + z * z).sqrt() / square(change).sqrt();
            #[allow(clippy::cast_possible_truncation, reason = "rounded up after that")]
            let radius = (least * (1.0 + 1e-15)) as f32;
            let fat_line = |start, change, radius| FatLine {
                start,
                change,
                radius,
                first: 0,
            };
            let moving = fat_line(start, change, radius.next_up().max(1e-18));
            let resting = fat_line([0.0; 3], [0.0; 3], 0.0);
            assert!(!lines_apart(&moving, &resting), "{moving:?} {least:e}");
        }
    }

    /// Two bodies whose distance is exactly their radii at some share of the slice, each starting
    /// at nearly the largest distance that radii allow.
    #[test]
    fn passes_that_touch_are_not_ruled_out() {
        let mut rng = ChaCha8Rng::seed_from_u64(7);
        for round in 0..20_000 {
            let [one, other] = [0; 2].map(|_| rng.random_range(-40_000..40_000_i32));
            // Across (2, 2, 1), which is three long.
            let way = [one + other, -one, -2 * other];
            #[allow(clippy::cast_precision_loss, reason = "below 2^24")]
            let lanes = |lanes: [i32; 3]| lanes.map(|lane| lane as f32);
            let parts = rng.random_range(3..50_u8);
            let part = rng.random_range(1..parts);
            let [x, y, z] = way.map(|lane| i32::from(part) * lane);
            let moving = FatLine {
                start: lanes([2 - x, 2 - y, 1 - z]),
                change: lanes(way.map(|lane| i32::from(parts) * lane)),
                radius: 3.0,
                first: 0,
            };
            let resting = FatLine {
                start: [0.0; 3],
                change: [0.0; 3],
                radius: 0.0,
                first: 0,
            };
            let found = approaching(&moving, &resting, (0.0, f64::from(parts)));
            let time = f64::from(part);
            let holds = |(first, last): (f64, f64)| first <= time && time <= last;
            assert!(found.is_some_and(holds), "{round} {moving:?} {found:?}");
        }
    }

    /// Includes near instants in a slice that is a few instants long and late on the clock.
    #[test]
    fn intervals_between_instants_hold_what_is_near() {
        let mut rng = ChaCha8Rng::seed_from_u64(6);
        let (from, to) = (1e9, 1e9 + 1e-6);
        let mut near = 0;
        for round in 0..5_000 {
            let (a, b) = (fat_line(&mut rng, 8.0, 30.0), fat_line(&mut rng, 8.0, 30.0));
            let radius = f64::from(a.radius) + f64::from(b.radius);
            let found = approaching(&a, &b, (from, to));
            for step in 0..=100 {
                let share = f64::from(step) / 100.0;
                if distance(&a, &b, share) > radius {
                    continue;
                }
                near += 1;
                let time = (to - from) * share;
                let holds = |(first, last): (f64, f64)| first - from <= time && time <= last - from;
                assert!(found.is_some_and(holds), "{round} {share} {found:?}");
            }
        }
        assert!(near > 5_000, "{near}");
    }

    #[test]
    fn what_is_not_known_rules_nothing_out() {
        let mut rng = ChaCha8Rng::seed_from_u64(2);
        let known = fat_line(&mut rng, 10.0, 10.0);
        for radius in [f32::INFINITY, f32::NAN] {
            let unknown = FatLine {
                start: [f32::NAN, f32::INFINITY, 0.0],
                radius,
                ..known
            };
            assert_eq!(approaching(&known, &unknown, SLICE), Some(SLICE));
        }
        // A slice that is a single instant.
        let (apart, instant) = (fat_line(&mut rng, 10.0, 10.0), (5.0, 5.0));
        let close = FatLine {
            radius: 40.0,
            ..apart
        };
        assert_eq!(approaching(&known, &close, instant), Some(instant));
    }
}
