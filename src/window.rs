//! The closed time interval a question is about.

use crate::error::Error;
use crate::readable::Readable;
use crate::rounding::one_zero;
use std::fmt;

/// A closed interval of time, s. May be a single instant; may be open-ended (infinite).
///
/// It only clips: what is reported of a window is what is reported of all of time, cut off at its ends
/// (the closest approach too: where the window ends right at it, it may differ by rounding; with
/// [`Accuracy::Certified`](crate::Accuracy::Certified), what cannot be told right at its ends is reported as
/// unresolved, and the proven error of a separation may be another one). A plan that jumps at a knot is in both places at that instant, also where a window begins or
/// ends there: for bodies that follow one cubic through it, not for those whose own plan begins, ends or jumps
/// at that very instant as well.
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
    /// All of time. Where a body goes on beyond its knots ([`Outside`](crate::Outside)), or is
    /// [at rest](crate::Trajectory::at_rest), this is refused with [`Error::WindowNotClosed`].
    pub const ALL: Self = Self {
        start: f64::NEG_INFINITY,
        end: f64::INFINITY,
    };

    /// The window from `start` to `end`, both included (s; infinities mean open-ended; -0 is taken as
    /// 0).
    ///
    /// # Errors
    ///
    /// [`Error::Window`] if the start is later than the end, either is NaN, or no finite instant
    /// lies between them.
    pub fn new(start: f64, end: f64) -> Result<Self, Error> {
        let holds_an_instant = start <= end && start < f64::INFINITY && end > f64::NEG_INFINITY;
        if holds_an_instant {
            Ok(Self {
                start: one_zero(start),
                end: one_zero(end),
            })
        } else {
            Err(Error::Window { start, end })
        }
    }

    /// First instant, s (or minus infinity).
    #[must_use]
    pub const fn start(self) -> f64 {
        self.start
    }

    /// Last instant, s (or infinity).
    #[must_use]
    pub const fn end(self) -> f64 {
        self.end
    }

    /// Whether both ends are finite.
    #[must_use]
    pub fn is_closed(self) -> bool {
        self.start.is_finite() && self.end.is_finite()
    }

    /// Whether `time` lies in it.
    #[must_use]
    pub fn contains(self, time: f64) -> bool {
        self.start <= time && time <= self.end
    }

    /// What two windows share; none if they do not even touch.
    #[must_use]
    pub fn intersection(self, other: Self) -> Option<Self> {
        let start = self.start.max(other.start);
        let end = self.end.min(other.end);
        (start <= end).then_some(Self { start, end })
    }
}

impl fmt::Display for Window {
    /// `0.000..60.000 s`; an open end is left out. With a precision (`{:.6}`), so many decimals.
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
    /// [`Window::ALL`].
    fn default() -> Self {
        Self::ALL
    }
}

/// A window in files: an open end is none, as not each format has infinities.
#[cfg(feature = "serde")]
#[derive(serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct Ends {
    /// s.
    start: Option<f64>,
    /// s.
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
