//! Events of a monitor, and the encounters they are about.

use crate::conflict::{ClosestApproach, other_of, write_interval};
use crate::id::{BodyId, TaggedBody};
use crate::readable::Readable;
use std::cmp::Ordering;
use std::fmt;

/// The name of one encounter of one monitor. No id is used twice, but for those that a [restored](crate::Monitor::restore)
/// monitor gives again.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct EncounterId(pub(super) u64);

impl EncounterId {
    /// Returns the id as a number; [`from_bits`](Self::from_bits) returns the same id again.
    /// Numbers are in the order of the ids. They are valid for their own monitor and its replays.
    #[must_use]
    pub const fn to_bits(self) -> u64 {
        self.0
    }

    /// Returns the id whose [`to_bits`](Self::to_bits) is this number. Every number belongs to one
    /// id.
    #[must_use]
    pub const fn from_bits(bits: u64) -> Self {
        Self(bits)
    }
}

impl fmt::Display for EncounterId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "encounter {}", self.0)
    }
}

/// A conflict followed over time by a monitor, at one alert level. A pair may have several. Model errors
/// count as for [`AlertLevel`](crate::AlertLevel).
///
/// An encounter includes its past: when it began, and how close the bodies came. Each tick matches
/// a pair's known encounters with those that the current plans predict, in time order, by overlap.
/// An encounter that has begun matches only one that was under way at the previous clock. A known
/// encounter without a match is withdrawn, or ended if it had begun. A predicted one without a
/// match gets a new id.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
#[doc(alias = "conjunction")]
pub struct Encounter {
    /// Id, the same from the first event to the last.
    pub id: EncounterId,
    /// The body with the smaller id.
    pub a: BodyId,
    /// The body with the larger id.
    pub b: BodyId,
    /// The tag of body a.
    pub tag_a: u64,
    /// The tag of body b.
    pub tag_b: u64,
    /// Number of the alert level: its index in the list given to
    /// [`Monitor::new`](crate::Monitor::new).
    pub level: usize,
    /// First instant within the level's margin, s. If the bodies were within the margin when first
    /// examined: the instant up to which the tick before reported (its clock, unless a budget ran out), or the
    /// clock of [`Monitor::new`](crate::Monitor::new) or [`Monitor::skip_to`](crate::Monitor::skip_to).
    pub enter: f64,
    /// Last instant within the level's release margin, s; while `open`, the end of the examined
    /// time. (If a budget has left less of it than an earlier tick examined, the end of what that one did.)
    pub exit: f64,
    /// True while the end is unknown: it lies beyond the time that the monitor has examined.
    pub open: bool,
    /// Least separation over the past and the planned part, as far as the monitor has looked. While
    /// the encounter is `open`, the bodies may come nearer later. A [`Revised`](EventKind::Revised)
    /// reports the nearest point when the lookahead reaches it. Before that, once a lookahead, it reports the nearest
    /// point so far. Its
    /// [`model_error`](ClosestApproach::model_error) is that of the bodies as they are now, also where the nearest
    /// point has passed; under a budget, once the monitor has [caught up](crate::Monitor::is_caught_up).
    pub closest: ClosestApproach,
}

impl Encounter {
    /// Returns the body that this one meets; `None` if the encounter is of two other bodies.
    #[must_use]
    pub fn other(&self, id: BodyId) -> Option<BodyId> {
        let bodies = (self.a, self.b);
        other_of(bodies, id, bodies)
    }

    /// Returns the [tag](crate::Body::tag) of the body that this one meets; `None` if the encounter is of two other bodies.
    #[must_use]
    pub fn other_tag(&self, id: BodyId) -> Option<u64> {
        other_of((self.a, self.b), id, (self.tag_a, self.tag_b))
    }

    /// Returns true if a monitor with so many levels can have it: for an encounter from a file.
    pub(super) fn could_be(&self, levels: usize) -> bool {
        let is_interval =
            self.enter.is_finite() && self.exit.is_finite() && self.enter <= self.exit;
        self.a < self.b && self.level < levels && is_interval && self.closest.is_finite()
    }
}

impl fmt::Display for Encounter {
    /// Formats one line: id, level, bodies, interval, closest approach. `{:.6}` sets the decimals.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (a, b) = (
            TaggedBody(self.a, self.tag_a),
            TaggedBody(self.b, self.tag_b),
        );
        write!(f, "{}, level {}: {a} and {b} ", self.id, self.level)?;
        write_interval(f, (self.enter, self.exit), &self.closest)?;
        f.write_str(if self.open { " so far" } else { "" })
    }
}

/// The reason why an encounter that had begun is over.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum EndReason {
    /// The bodies are apart again.
    Separated,
    /// One of the trajectories ended.
    TrajectoryEnded,
    /// A change ended it: of a body's plan, orientation, hitbox, layers or model error; or the pair is now ignored. A
    /// body that leaves by a plan of `replan` or `track` that begins elsewhere, or by a rotation of `orient` or `track`, is
    /// [`Separated`](Self::Separated) at that instant. (At the clock of the last tick only if no later plan comes before the
    /// next tick: what was left there is forgotten.)
    PlanChanged,
    /// One of the bodies was removed.
    BodyRemoved,
    /// The clock was set ahead, by [`Monitor::skip_to`](crate::Monitor::skip_to).
    ClockSet,
    /// The monitor was closed.
    MonitorClosed,
}

impl fmt::Display for EndReason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Separated => "separated",
            Self::TrajectoryEnded => "trajectory ended",
            Self::PlanChanged => "plan changed",
            Self::BodyRemoved => "body removed",
            Self::ClockSet => "clock set",
            Self::MonitorClosed => "monitor closed",
        })
    }
}

/// The kind of an event, with the encounter or the body that it is about.
///
/// Events of one encounter (one [`Encounter::id`]) come in this order:
///
/// | after | may come |
/// |---|---|
/// | nothing yet | `Predicted` if it lies ahead; `Began` if the clock has reached it when it is first seen |
/// | `Predicted`, or a `Revised` before it began | `Revised`, `Withdrawn`, `Began` |
/// | `Began`, or a `Revised` after that | `Revised`, `Ended` |
/// | `Withdrawn` or `Ended` | nothing |
///
/// When the clock jumps past an encounter, one tick reports both `Began` and `Ended`.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum EventKind {
    /// A new encounter lies ahead. If it reaches beyond the lookahead it is `open`, and `closest`
    /// covers only the examined time. The nearest point is reported once it is in sight. While the
    /// bodies still come nearer at the end of the examined time, the separation reached by then is
    /// reported once a lookahead. [`Monitor::encounters`](crate::Monitor::encounters) gives it at
    /// each tick.
    Predicted(Encounter),
    /// The encounter changed by more than the [revision threshold](crate::RevisionThreshold) since its
    /// first event or its last `Revised`: its enter or exit, its closest approach, or the model error of its bodies. If it
    /// began in the same tick, `Began` comes first and has the same numbers: both differ from those of the event before.
    Revised(Encounter),
    /// The encounter had not begun, and is no longer predicted: a plan, a body or the pair changed, a body was removed, the
    /// clock was [set](crate::Monitor::skip_to), or the monitor was closed.
    Withdrawn(Encounter),
    /// The encounter has begun.
    Began(Encounter),
    /// The encounter is over. Every encounter that began has exactly one of these.
    Ended(Encounter, EndReason),
    /// A body's plan, and with it the body, ends within the lookahead or has ended. The event comes once
    /// for each plan, as soon as its end is in sight: at once for plans no longer than the lookahead. To
    /// avoid it, plan further ahead or let bodies continue ([`Outside::Coast`](crate::Outside::Coast)).
    PlanEnds {
        /// The body.
        body: BodyId,
        /// The body's tag.
        tag: u64,
    },
}

/// An event with its time.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Event {
    /// Time, s: the enter of what began, the exit of what ended, or the end of the plan that ends.
    /// Otherwise the monitor's clock; for withdrawals by a removal, by
    /// [`Monitor::skip_to`](crate::Monitor::skip_to) or by [`Monitor::close`](crate::Monitor::close), the
    /// instant up to which the tick before reported events: its clock, unless its budget ran out.
    pub time: f64,
    /// Kind, with the encounter or the body.
    pub kind: EventKind,
}

impl EventKind {
    /// Returns the encounter that the event is about, if any.
    #[must_use]
    pub const fn encounter(&self) -> Option<&Encounter> {
        self.parts().2
    }

    /// Returns the place of the kind in the order of reports, its name, and the encounter.
    const fn parts(&self) -> (u8, &'static str, Option<&Encounter>) {
        match self {
            Self::Predicted(encounter) => (0, "predicted", Some(encounter)),
            Self::Withdrawn(encounter) => (1, "withdrawn", Some(encounter)),
            Self::Began(encounter) => (2, "began", Some(encounter)),
            Self::Revised(encounter) => (3, "revised", Some(encounter)),
            Self::Ended(encounter, _) => (4, "ended", Some(encounter)),
            Self::PlanEnds { .. } => (5, "plan ends", None),
        }
    }
}

impl Event {
    /// Compares two events in the order of reports: time, kind, a, b, level, encounter.
    #[must_use]
    pub fn order(&self, other: &Self) -> Ordering {
        let place = |event: &Self| match event.kind {
            EventKind::PlanEnds { body, .. } => Some((body, body, 0, EncounterId(0))),
            _ => {
                let encounter = event.kind.encounter();
                encounter.map(|one| (one.a, one.b, one.level, one.id))
            }
        };
        self.time
            .total_cmp(&other.time)
            .then_with(|| self.kind.parts().0.cmp(&other.kind.parts().0))
            .then_with(|| place(self).cmp(&place(other)))
    }
}

impl fmt::Display for EventKind {
    /// Formats one line: the kind, and the encounter. `{:.6}` sets the decimals.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (_, name, encounter) = self.parts();
        match self {
            &Self::PlanEnds { body, tag } => {
                write!(f, "the plan of {} ends", TaggedBody(body, tag))?;
            }
            Self::Ended(_, reason) => write!(f, "{name} ({reason}): ")?,
            _ => write!(f, "{name}: ")?,
        }
        encounter.map_or(Ok(()), |encounter| encounter.fmt(f))
    }
}

impl fmt::Display for Event {
    /// Formats one line: time, kind, and the encounter. `{:.6}` sets the decimals.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let decimals = f.precision().unwrap_or(3);
        write!(f, "at {:.decimals$} s ", Readable(self.time))?;
        self.kind.fmt(f)
    }
}
