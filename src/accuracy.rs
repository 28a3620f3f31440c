//! The knob between speed and proof, and what a proof says.

/// How much an answer promises.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Accuracy {
    /// f64, good to a few roundings of the local scale, not certified. What comes within the
    /// worst case of that rounding of the margin is reported, so a touch is never lost.
    #[default]
    Exact,
    /// Every conflict carries a [`Certificate`]: enclosures of its separation and of its times,
    /// proven against the exact real-arithmetic motion through the given numbers. What is
    /// certainly outside is not reported; what f64 cannot decide is, marked as unresolved.
    Certified,
}

/// The exact instant lies in `earliest..=latest` (s).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TimeEnclosure {
    /// Not before this, s.
    pub earliest: f64,
    /// Not after this, s.
    pub latest: f64,
}

/// What is proven of a conflict, as worst cases over all rounding on the way.
///
/// The truth is the motion in real arithmetic through the `f64` states (or of the `f64`
/// polynomials) given, with the exact sum of radii and margin. The proof is in
/// [`enclosure`](crate::enclosure).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Certificate {
    /// The least separation within the conflict lies in `closest.separation ± error` (m).
    pub error: f64,
    /// Whether this is certainly one conflict. If not, either the pair comes so near the margin
    /// that f64 cannot tell whether it is reached, or so near it in between that f64 cannot tell
    /// whether these are several conflicts.
    pub resolved: bool,
    /// When it begins.
    pub enter: TimeEnclosure,
    /// When it ends.
    pub exit: TimeEnclosure,
    /// When the separation is least; all such instants where there are several.
    pub closest: TimeEnclosure,
}

impl TimeEnclosure {
    /// The instant within the enclosure that is nearest to `time`.
    pub(crate) fn nearest(self, time: f64) -> f64 {
        time.max(self.earliest).min(self.latest)
    }

    /// The smallest enclosure of both.
    pub(crate) fn hull(self, other: Self) -> Self {
        Self {
            earliest: self.earliest.min(other.earliest),
            latest: self.latest.max(other.latest),
        }
    }
}
