//! A part of a turning motion, and the cuts between which it is a cubic.

use super::arc::{Arc, MAX_SPEED, parts_of_revolution};
use super::baked::BakedRotation;
use super::quaternion_cubic::{QuaternionCubic, equal_cut};
use crate::accuracy::Accuracy;
use crate::count::whole;
use crate::rounding::{earliest_exact, latest_exact};
use glam::DQuat;
use std::f64::consts::TAU;

/// A rotation between two instants.
#[derive(Clone, Debug)]
pub(super) struct RotationPiece {
    /// First and last instant, s; the first and last piece have no beginning and end.
    pub(super) start: f64,
    pub(super) end: f64,
    motion: RotationCurve,
    cuts: Cuts,
}

/// The motion of a piece.
#[derive(Clone, Debug)]
pub(super) enum RotationCurve {
    Arc(Arc),
    Cubic(Box<QuaternionCubic>),
}

/// The instants at which one cubic ends and the next one begins. Each has two sets, for
/// [`Accuracy::Exact`] and for [`Accuracy::Certified`].
#[derive(Clone, Copy, Debug)]
enum Cuts {
    /// None: the rotation is held.
    None,
    /// Equal parts between two instants (s), that many.
    Equal((f64, f64), [u32; 2]),
    /// Parts of equal duration (s) from an instant (s) on, in both directions of time; of duration 0 if the rotation is
    /// unknown.
    Steps(f64, [f64; 2]),
}

/// Returns the number of an accuracy's set of cuts.
pub(super) const fn set_of(accuracy: Accuracy) -> usize {
    match accuracy {
        Accuracy::Exact => 0,
        Accuracy::Certified => 1,
    }
}

impl RotationPiece {
    /// Returns a motion for all time.
    pub(super) fn forever(arc: Arc, tolerances: [f64; 2]) -> Self {
        // Shorter steps do as well: of endless ones no multiple is a number.
        let revolution = (TAU / arc.angle * arc.duration).min(1e307);
        let cuts = if arc.is_held() {
            Cuts::None
        } else {
            // What goes on beyond knots may be faster than what can be told. It is unknown: a window of a second would
            // have millions of cuts.
            let is_known = arc.angle <= MAX_SPEED * arc.duration;
            let steps = tolerances.map(|tolerance| {
                // Rates that differ by rounding have the same cuts. Of a slow rotation a part of a revolution would end
                // when rounding has long hidden it: then nothing would be known from its beginning on.
                let share = short_of(revolution / parts_of_revolution(tolerance));
                share.min(arc.known_for(tolerance))
            });
            Cuts::Steps(arc.time, if is_known { steps } else { [0.0; 2] })
        };
        Self {
            start: f64::NEG_INFINITY,
            end: f64::INFINITY,
            motion: RotationCurve::Arc(arc),
            cuts,
        }
    }

    /// Returns a motion between two instants (s), in that many equal parts.
    pub(super) fn between(ends: (f64, f64), motion: RotationCurve, counts: [u32; 2]) -> Self {
        let is_held = matches!(&motion, RotationCurve::Arc(arc) if arc.is_held());
        Self {
            start: ends.0,
            end: ends.1,
            motion,
            cuts: if is_held {
                Cuts::None
            } else {
                Cuts::Equal(ends, counts)
            },
        }
    }

    /// Returns the rotation at an instant (s).
    pub(super) fn at(&self, time: f64) -> DQuat {
        match &self.motion {
            RotationCurve::Arc(arc) => arc.at(time),
            RotationCurve::Cubic(cubic) => cubic.at(time),
        }
    }

    /// Returns the rotation at a constant rate that the piece is, if cubics that meet an interval (s) have at most these errors.
    #[inline]
    pub(super) fn known_arc(&self, ends: (f64, f64), largest: [f64; 2]) -> Option<&Arc> {
        let RotationCurve::Arc(arc) = &self.motion else {
            return None;
        };
        let farthest = |times: [f64; 4]| {
            times
                .into_iter()
                .fold(0.0, |far: f64, time| far.max(time.abs()))
        };
        let (durations, far) = match self.cuts {
            Cuts::None => return Some(arc),
            Cuts::Equal((start, end), counts) => {
                let durations = counts.map(|count| (end - start) / f64::from(count));
                (durations, farthest([ends.0, ends.1, start, end]))
            }
            Cuts::Steps(origin, steps) => {
                let far = farthest([ends.0, ends.1, ends.0 - origin, ends.1 - origin]);
                // Nothing is known beyond twice that.
                if steps.iter().any(|step| far >= 0.5 * FAR * step) {
                    return None;
                }
                (steps, far.max(origin.abs()))
            }
        };
        // Cuts are rounded: a part may be longer by a few roundings of the time.
        let longer = latest_exact(far) - earliest_exact(far);
        let mut known = durations.into_iter().zip(largest);
        let is_known =
            known.all(|(duration, largest)| arc.is_known(ends, duration + longer, largest));
        is_known.then_some(arc)
    }

    /// Returns the cuts around an instant (s) of the piece, and true if the rotation is known
    /// between them.
    pub(super) fn around(&self, time: f64, set: usize) -> (f64, f64, bool) {
        let (start, end, is_known) = match &self.cuts {
            Cuts::None => (self.start, self.end, true),
            Cuts::Equal(ends, counts) => {
                let (start, end) = equal_part(*ends, counts[set], time);
                (start, end, true)
            }
            Cuts::Steps(origin, steps) => step_around(*origin, steps[set], time),
        };
        (start.max(self.start), end.min(self.end), is_known)
    }

    /// Returns the cubic between two neighbouring cuts (s).
    pub(super) fn bake(&self, ends: (f64, f64), largest: f64) -> BakedRotation {
        match &self.motion {
            RotationCurve::Arc(arc) => arc.bake(ends, largest),
            RotationCurve::Cubic(cubic) => {
                let baked = cubic.bake(ends);
                if baked.error() <= largest {
                    baked
                } else {
                    BakedRotation::unknown(ends)
                }
            }
        }
    }
}

/// Returns the nearest number of 40 binary digits.
const fn short_of(value: f64) -> f64 {
    /// Digits of a longer number that are left out.
    const REST: u32 = f64::MANTISSA_DIGITS - 40;
    let bits = value.to_bits() + (1 << (REST - 1));
    f64::from_bits(bits >> REST << REST)
}

/// Returns the one of some equal parts of an interval that holds an instant, as the first one that
/// ends after it.
fn equal_part(ends: (f64, f64), count: u32, time: f64) -> (f64, f64) {
    let (start, end) = ends;
    let share = (time - start) / (end - start) * f64::from(count);
    let mut number = whole(share).min(count - 1);
    while number > 0 && equal_cut(ends, number, count) > time {
        number -= 1;
    }
    while number + 1 < count && equal_cut(ends, number + 1, count) <= time {
        number += 1;
    }
    (
        equal_cut(ends, number, count),
        equal_cut(ends, number + 1, count),
    )
}

/// Steps from the origin of time, and from that of the cuts, that still have two bits.
const FAR: f64 = (1_u64 << 50) as f64;

/// Returns the cuts of equal steps around an instant, and true if f64 can tell them apart there.
fn step_around(origin: f64, step: f64, time: f64) -> (f64, f64, bool) {
    let reach = FAR * step;
    let (first, last) = ((origin - reach).max(-reach), (origin + reach).min(reach));
    if first >= last {
        return (f64::NEG_INFINITY, f64::INFINITY, false);
    }
    if time < first {
        return (f64::NEG_INFINITY, first, false);
    }
    if time >= last {
        return (last, f64::INFINITY, false);
    }
    let cut = |number: f64| (origin + number * step).clamp(first, last);
    let mut number = ((time - origin) / step).floor();
    while cut(number) > time {
        number -= 1.0;
    }
    while cut(number + 1.0) <= time {
        number += 1.0;
    }
    (cut(number), cut(number + 1.0), true)
}
