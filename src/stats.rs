//! Counts and times of each stage of the funnel.

use std::fmt;
use std::ops::AddAssign;
use std::time::Duration;

/// The funnel of one screening, or of one tick of a monitor.
///
/// Counts depend on the scene and the query. Another number of threads may change a few of many
/// thousand candidates and spans: threads divide motions in other places and round their boxes
/// differently.
///
/// Stage times add up over threads; `total_time` is wall time. In a monitor's tick they are the
/// smaller part of it: taking over plans, and following encounters, have no stage of their own.
#[derive(Clone, Copy, Debug, Default)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Stats {
    /// Bodies in the scene.
    pub bodies: u64,
    /// Changes since a monitor's last tick: inserted and removed bodies, and changes of plans, orientations,
    /// hitboxes, layers and model errors. A batch counts one for each body.
    pub changed: u64,
    /// Cubic segments, pieces beyond the knots included. (Not counted in a monitor's tick.)
    pub segments: u64,
    /// Time slices of the window; in a monitor's tick, the slices completed.
    pub slices: u64,
    /// Boxes formed: one for each body in each slice in which it exists.
    pub boxes: u64,
    /// Pairs in a slice that the broad phase could not rule out.
    pub candidates: u64,
    /// Spans of candidates examined by the cheap tests of the narrow phase.
    pub spans: u64,
    /// Spans that reach the exact solver (each once).
    pub survivors: u64,
    /// Conflicts reported.
    pub conflicts: u64,
    /// Time for forming boxes. (In a monitor's tick mostly part of `broad_time`.)
    pub bounds_time: Duration,
    /// Time for finding candidates.
    pub broad_time: Duration,
    /// Time for filtering and solving.
    pub narrow_time: Duration,
    /// Total wall time.
    pub total_time: Duration,
}

impl AddAssign for Stats {
    fn add_assign(&mut self, other: Self) {
        self.bodies += other.bodies;
        self.changed += other.changed;
        self.segments += other.segments;
        self.slices += other.slices;
        self.boxes += other.boxes;
        self.candidates += other.candidates;
        self.spans += other.spans;
        self.survivors += other.survivors;
        self.conflicts += other.conflicts;
        self.bounds_time += other.bounds_time;
        self.broad_time += other.broad_time;
        self.narrow_time += other.narrow_time;
        self.total_time += other.total_time;
    }
}

impl fmt::Display for Stats {
    /// Writes one line: the funnel from bodies to conflicts, and the times.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let counts = [
            (self.bodies, "body", "bodies"),
            (self.changed, "changed", "changed"),
            (self.segments, "segment", "segments"),
            (self.slices, "slice", "slices"),
            (self.boxes, "box", "boxes"),
            (self.candidates, "candidate", "candidates"),
            (self.spans, "span", "spans"),
            (self.survivors, "survivor", "survivors"),
            (self.conflicts, "conflict", "conflicts"),
        ];
        for (count, one, many) in counts {
            let what = if count == 1 { one } else { many };
            write!(f, "{count} {what}, ")?;
        }
        write!(
            f,
            "bounds {:.1?}, broad phase {:.1?}, narrow phase {:.1?}, total {:.1?}",
            self.bounds_time, self.broad_time, self.narrow_time, self.total_time
        )
    }
}
