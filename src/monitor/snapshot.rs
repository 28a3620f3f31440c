//! A monitor as it was at one time, to go back to.

use super::alert_level::AlertLevel;
use super::encounters::Saved;
use super::event::Event;
use super::revision_threshold::RevisionThreshold;
use crate::scene::Scene;

/// A [`Monitor`](crate::Monitor) as it was when [`Monitor::snapshot`](crate::Monitor::snapshot) was called: its
/// scene, clock, levels, settings and encounters. With the feature `serde` it can be written to a file.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct Snapshot {
    pub(super) scene: Scene,
    pub(super) now: f64,
    pub(super) reported: f64,
    pub(super) lookahead: f64,
    pub(super) levels: Vec<AlertLevel>,
    pub(super) revision_threshold: RevisionThreshold,
    #[cfg_attr(feature = "serde", serde(with = "crate::json_number"))]
    pub(super) history: f64,
    #[cfg_attr(feature = "serde", serde(with = "crate::saved_limit"))]
    pub(super) max_spans: usize,
    pub(super) next_id: u64,
    /// Encounters by level.
    pub(super) encounters: Vec<Saved>,
    pub(super) pending_events: Vec<Event>,
    /// By slot: false only if the plan has an end that is still to be reported.
    pub(super) end_reported: Vec<bool>,
    /// True if another tick at the same time would change nothing.
    pub(super) has_reported_all: bool,
    /// Ticks since most was unknown, of which idle ones count less; none if it never was.
    pub(super) since_unknown: Option<f64>,
}
