//! Threshold of reported changes of an encounter.

/// Largest change of an encounter that is not reported, measured from its first event or its last
/// [`Revised`](crate::EventKind::Revised).
///
/// Two changes of an encounter are reported whatever the threshold, also an infinite one:
///
/// - Its end comes into the examined time: it was `open` in its last event.
/// - Its nearest point comes into the examined time: in its last event the bodies still came nearer at an open end.
///
/// The default keeps back changes by rounding: where a distance hardly changes, or as the clock passes an instant
/// that was computed. States told in f32 change predictions by more, in each tick: choose some hundredths there. A
/// closest approach at another time is reported if the separation at the time reported before exceeds the new least
/// separation by more than the threshold. With 0 every change is reported. Exception: the nearest point of an open
/// encounter changes each tick while it lies at the end of the known time. It is reported once a lookahead at most.
///
/// Any values can be held: [`Monitor::set_revision_threshold`](crate::Monitor::set_revision_threshold) refuses NaN and
/// numbers below 0.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct RevisionThreshold {
    /// Change of enter, exit and the time of closest approach, s; 1e-9 by default.
    #[cfg_attr(feature = "serde", serde(with = "crate::json_number"))]
    pub time: f64,
    /// Change of the least separation, or of the sum of both model errors, m; 1e-9 by default.
    #[cfg_attr(feature = "serde", serde(with = "crate::json_number"))]
    pub separation: f64,
}

impl Default for RevisionThreshold {
    /// Returns 1e-9 s and 1e-9 m.
    fn default() -> Self {
        Self {
            time: 1e-9,
            separation: 1e-9,
        }
    }
}

impl RevisionThreshold {
    /// Returns the threshold with another [`time`](Self::time), s.
    #[must_use]
    pub const fn with_time(mut self, time: f64) -> Self {
        self.time = time;
        self
    }

    /// Returns the threshold with another [`separation`](Self::separation), m.
    #[must_use]
    pub const fn with_separation(mut self, separation: f64) -> Self {
        self.separation = separation;
        self
    }
}
