//! The closed time interval of a query.

use crate::error::Error;
use crate::readable::Readable;
use crate::rounding::without_negative_zero;
use std::fmt;

/// A closed interval of time, s. It may be a single instant, or open-ended (infinite).
///
/// A window clips results; it never changes them. Exceptions:
///
/// - A closest approach at the window's end may differ by rounding.
/// - A touch is reported at an instant that is rounded. A window that begins or ends at the exact instant may miss it by
///   that rounding.
/// - With [`Accuracy::Certified`](crate::Accuracy::Certified), facts that cannot be decided at the
///   window's ends are reported as unresolved, and the enclosures of a conflict that the window cuts may differ.
///
/// At a knot where its plan jumps, a body is at both positions, also at a window's end. That is not
/// so for pairs in which the other body's plan also begins, ends or jumps at that instant. Where an orientation jumps, a
/// body has both rotations, but for the last instant of a plan: there it has the one before.
///
/// ```
/// use nearmiss::Window;
///
/// let hour = Window::new(0.0, 3600.0)?;
/// let late = Window::new(1800.0, f64::INFINITY)?;
/// assert_eq!(hour.intersection(late), Some(Window::new(1800.0, 3600.0)?));
/// assert!(late.contains(1e9) && !late.is_closed());
/// # Ok::<(), nearmiss::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "Ends", into = "Ends"))]
pub struct Window {
    start: f64,
    end: f64,
}

impl Window {
    /// All of time: refused with [`Error::WindowNotClosed`] for bodies that exist beyond their
    /// knots ([`Outside`](crate::Outside), [at rest](crate::Trajectory::at_rest)).
    pub const ALL: Self = Self {
        start: f64::NEG_INFINITY,
        end: f64::INFINITY,
    };

    /// Returns the window from `start` to `end`, both included (s; may be infinite; -0 becomes 0).
    ///
    /// # Errors
    ///
    /// [`Error::Window`] if the start is later than the end, either is NaN, or no finite instant
    /// lies between them.
    pub fn new(start: f64, end: f64) -> Result<Self, Error> {
        let holds_an_instant = start <= end && start < f64::INFINITY && end > f64::NEG_INFINITY;
        if holds_an_instant {
            Ok(Self {
                start: without_negative_zero(start),
                end: without_negative_zero(end),
            })
        } else {
            Err(Error::Window { start, end })
        }
    }

    /// Returns the first instant, s (or minus infinity).
    #[must_use]
    pub const fn start(self) -> f64 {
        self.start
    }

    /// Returns the last instant, s (or infinity).
    #[must_use]
    pub const fn end(self) -> f64 {
        self.end
    }

    /// Returns the time between both ends, s; infinite unless the window [is closed](Self::is_closed).
    #[must_use]
    pub fn duration(self) -> f64 {
        self.end - self.start
    }

    /// Returns both ends, s.
    pub(crate) const fn ends(self) -> (f64, f64) {
        (self.start, self.end)
    }

    /// Returns true if both ends are finite.
    #[must_use]
    pub fn is_closed(self) -> bool {
        self.start.is_finite() && self.end.is_finite()
    }

    /// Returns true if the window contains `time`.
    #[must_use]
    pub fn contains(self, time: f64) -> bool {
        self.start <= time && time <= self.end
    }

    /// Returns the intersection of two windows, or `None` if they do not even touch.
    #[must_use]
    pub fn intersection(self, other: Self) -> Option<Self> {
        let start = self.start.max(other.start);
        let end = self.end.min(other.end);
        (start <= end).then_some(Self { start, end })
    }
}

impl fmt::Display for Window {
    /// Writes `0.000..60.000 s`, without an open end. A precision (`{:.6}`) sets the decimals.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let decimals = f.precision().unwrap_or(3);
        for (end, before) in [(self.start, ""), (self.end, "..")] {
            f.write_str(before)?;
            if end.is_finite() {
                write!(f, "{:.decimals$}", Readable(end))?;
            }
        }
        f.write_str(" s")
    }
}

impl Default for Window {
    /// Returns [`Window::ALL`].
    fn default() -> Self {
        Self::ALL
    }
}

/// A serialised window. An open end is `None`, since not every format has infinities.
#[cfg(feature = "serde")]
#[derive(serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct Ends {
    start: Option<f64>,
    end: Option<f64>,
}

#[cfg(feature = "serde")]
impl From<Window> for Ends {
    fn from(window: Window) -> Self {
        let [start, end] =
            [window.start, window.end].map(|end| Some(end).filter(|end| end.is_finite()));
        Self { start, end }
    }
}

#[cfg(feature = "serde")]
impl TryFrom<Ends> for Window {
    type Error = Error;

    fn try_from(ends: Ends) -> Result<Self, Error> {
        let all = Self::ALL;
        Self::new(ends.start.unwrap_or(all.start), ends.end.unwrap_or(all.end))
    }
}
