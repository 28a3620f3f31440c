//! What a monitor tells: encounters and what happens to them.

use crate::conflict::{ClosestApproach, write_course};
use crate::id::BodyId;
use crate::readable::Readable;
use std::cmp::Ordering;
use std::fmt;

/// Names one encounter of one monitor; never used twice.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct EncounterId(pub(super) u64);

impl EncounterId {
    /// Returns the id as one number. [`from_bits`](Self::from_bits) returns the same id again. Like the id, the
    /// number is of use with its own monitor, and a replay of that; the numbers are in the order of the ids.
    #[must_use]
    pub const fn to_bits(self) -> u64 {
        self.0
    }

    /// Returns the id whose [`to_bits`](Self::to_bits) is this number. Each number is that of one id.
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

/// A conflict as the monitor follows it over time, at one alert level. A pair may have several.
///
/// It remembers what has passed: when it began, and how close it came. At each tick the encounters
/// of a pair are matched with what the plans lead into now, by overlap in time and in order; one that has begun
/// only with what is under way at the clock of the tick before. What
/// finds no match is withdrawn, or ended if it had begun; what is new has a new id.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Encounter {
    /// Stays the same from the first event to the last.
    pub id: EncounterId,
    /// The body with the smaller id.
    pub a: BodyId,
    /// The body with the larger id.
    pub b: BodyId,
    /// The tag of body a.
    pub tag_a: u64,
    /// The tag of body b.
    pub tag_b: u64,
    /// Which alert level: its place, from 0, in the list that [`Monitor::new`](crate::Monitor::new)
    /// was given.
    pub level: usize,
    /// First instant within the level's margin, s; of bodies that are within it already when they
    /// are first looked at, the clock of the tick before, or that of
    /// [`Monitor::new`](crate::Monitor::new).
    pub enter: f64,
    /// Last instant within the level's release margin, s; the end of what is known while `open`.
    pub exit: f64,
    /// The end is not known yet: it lies beyond what the monitor has looked at.
    pub open: bool,
    /// The least separation, over what has passed since it began and what is planned, as far as the
    /// monitor has looked: while the encounter is `open` the bodies may come nearer later. How near, a
    /// [`Revised`](EventKind::Revised) tells once that is in sight, and until then once a lookahead.
    pub closest: ClosestApproach,
}

impl fmt::Display for Encounter {
    /// One line: id, level, bodies, the interval, and the closest approach. With a precision (`{:.6}`), so many
    /// decimals.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{}, level {}: {} and {} ",
            self.id, self.level, self.a, self.b
        )?;
        write_course(f, (self.enter, self.exit), &self.closest)?;
        f.write_str(if self.open { " so far" } else { "" })
    }
}

/// Why an encounter that had begun is over.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum EndReason {
    /// The bodies are apart again.
    Separated,
    /// One of the trajectories ended.
    TrajectoryEnded,
    /// A changed plan, hitbox or layer ended it, or that the pair is ignored.
    PlanChanged,
    /// One of the bodies was removed.
    BodyRemoved,
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
            Self::MonitorClosed => "monitor closed",
        })
    }
}

/// What happened.
///
/// The events of one encounter (the same [`Encounter::id`]), in the order in which they are told:
///
/// | after | may come |
/// |---|---|
/// | nothing yet | `Predicted` if it lies ahead; `Began` if the clock has reached it when it is first seen |
/// | `Predicted`, or a `Revised` before it began | `Revised`, `Withdrawn`, `Began` |
/// | `Began`, or a `Revised` after that | `Revised`, `Ended` |
/// | `Withdrawn` or `Ended` | nothing |
///
/// A clock that jumps tells what lay in between all the same: `Began` and `Ended` at one tick.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum EventKind {
    /// A new encounter lies ahead. One that reaches beyond the lookahead is `open`: how near the bodies
    /// come is then only known so far. Its nearest point is told once it is in sight; while they still
    /// come nearer at the end of what is known, how near by then is told once a lookahead
    /// ([`Monitor::encounters`](crate::Monitor::encounters) says it at each tick).
    Predicted(Encounter),
    /// Its numbers differ from those last sent by more than the least change.
    Revised(Encounter),
    /// It will not take place. Only before it began.
    Withdrawn(Encounter),
    /// It has begun.
    Began(Encounter),
    /// It is over. Every encounter that began has exactly one of these.
    Ended(Encounter, EndReason),
    /// A body's plan ends within the lookahead (or ended before it), and the body with it. Told once for each
    /// plan, as soon as its end is in sight, and not again when it comes: with plans no longer than the
    /// lookahead at once. Plan further ahead, or let bodies go on
    /// ([`Outside::Coast`](crate::Outside::Coast)).
    PlanEnds {
        /// The body.
        body: BodyId,
        /// Its tag.
        tag: u64,
    },
}

/// Something that happened, and when.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Event {
    /// s: the enter of what began, the exit of what ended, the end of the plan that ends; else the
    /// monitor's clock (of what a removal withdraws, that of the tick before it).
    pub time: f64,
    /// What.
    pub kind: EventKind,
}

impl EventKind {
    /// The encounter it speaks of, if any.
    #[must_use]
    pub const fn encounter(&self) -> Option<&Encounter> {
        match self {
            Self::Predicted(encounter)
            | Self::Revised(encounter)
            | Self::Withdrawn(encounter)
            | Self::Began(encounter)
            | Self::Ended(encounter, _) => Some(encounter),
            Self::PlanEnds { .. } => None,
        }
    }

    fn rank(&self) -> u8 {
        match self {
            Self::Predicted(_) => 0,
            Self::Revised(_) => 1,
            Self::Withdrawn(_) => 2,
            Self::Began(_) => 3,
            Self::Ended(..) => 4,
            Self::PlanEnds { .. } => 5,
        }
    }
}

impl Event {
    /// The order in which events are told: by time, kind, a, b, level, encounter.
    #[must_use]
    pub fn order(&self, other: &Self) -> Ordering {
        let place = |event: &Self| match event.kind {
            EventKind::PlanEnds { body, .. } => (body, body, 0, EncounterId(0)),
            _ => event.kind.encounter().map_or(
                (
                    BodyId {
                        slot: 0,
                        generation: 0,
                    },
                    BodyId {
                        slot: 0,
                        generation: 0,
                    },
                    0,
                    EncounterId(0),
                ),
                |encounter| (encounter.a, encounter.b, encounter.level, encounter.id),
            ),
        };
        self.time
            .total_cmp(&other.time)
            .then_with(|| self.kind.rank().cmp(&other.kind.rank()))
            .then_with(|| place(self).cmp(&place(other)))
    }
}

impl fmt::Display for EventKind {
    /// One line: what happened, and the encounter. With a precision (`{:.6}`), so many decimals.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (what, encounter) = match self {
            Self::Predicted(encounter) => ("predicted", encounter),
            Self::Revised(encounter) => ("revised", encounter),
            Self::Withdrawn(encounter) => ("withdrawn", encounter),
            Self::Began(encounter) => ("began", encounter),
            Self::Ended(encounter, reason) => {
                write!(f, "ended ({reason}): ")?;
                return encounter.fmt(f);
            }
            Self::PlanEnds { body, .. } => return write!(f, "the plan of {body} ends"),
        };
        write!(f, "{what}: ")?;
        encounter.fmt(f)
    }
}

impl fmt::Display for Event {
    /// One line: when, what happened, and the encounter. With a precision (`{:.6}`), so many decimals.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let decimals = f.precision().unwrap_or(3);
        write!(f, "at {:.decimals$} s ", Readable(self.time))?;
        self.kind.fmt(f)
    }
}
