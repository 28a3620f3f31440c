//! Queries to a scene.

use crate::accuracy::Accuracy;
use crate::broad_phase::{InstructionSet, Method};
use crate::window::Window;
use std::num::NonZeroU32;

/// A question to a scene: when, and how close is too close.
///
/// A query can hold any values: [`Scene::screen`](crate::Scene::screen) checks them.
///
/// ```
/// use nearmiss::glam::DVec3;
/// use nearmiss::{Body, Query, Scene, Trajectory, Window};
///
/// let mut scene = Scene::new();
/// for x in [0.0, 3.0] {
///     scene.insert(Body::new(Trajectory::at_rest(x * DVec3::X)?))?;
/// }
/// let query = Query::new(Window::new(0.0, 60.0)?);
/// assert_eq!(scene.screen(&query)?.conflicts.len(), 0);
/// assert_eq!(scene.screen(&query.with_margin(3.0))?.conflicts.len(), 1);
/// # Ok::<(), nearmiss::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
pub struct Query {
    /// The time asked about; `None` stands for the time that the scene's plans cover.
    window: Option<Window>,
    margin: f64,
    #[cfg_attr(feature = "serde", serde(skip))]
    pub(crate) method: Method,
    accuracy: Accuracy,
    #[cfg_attr(feature = "serde", serde(skip))]
    pub(crate) slices: Option<NonZeroU32>,
    #[cfg_attr(feature = "serde", serde(with = "crate::saved_limit"))]
    max_spans: usize,
    #[cfg_attr(feature = "serde", serde(skip))]
    pub(crate) instructions: InstructionSet,
}

impl Default for Query {
    /// Returns a query for overlaps (margin 0) in the time that the scene's plans cover:
    /// [`Scene::planned`](crate::Scene::planned).
    fn default() -> Self {
        Self {
            window: None,
            margin: 0.0,
            method: Method::default(),
            accuracy: Accuracy::default(),
            slices: None,
            max_spans: Self::MAX_SPANS,
            instructions: InstructionSet::best(),
        }
    }
}

impl Query {
    /// Default limit of spans that may hold a conflict: 2^24. Their conflicts take up to 4 GiB, and
    /// as much again while they are sorted.
    pub const MAX_SPANS: usize = 1 << 24;

    /// Returns a query for conflicts within `window`, with margin 0.
    #[must_use]
    pub fn new(window: Window) -> Self {
        Self {
            window: Some(window),
            ..Self::default()
        }
    }

    /// Returns the query for another window.
    #[must_use]
    pub const fn with_window(mut self, window: Window) -> Self {
        self.window = Some(window);
        self
    }

    /// Returns the query with a margin, m: bodies are in conflict while their separation is at most
    /// this. A negative margin asks for overlaps of at least that depth.
    #[must_use]
    pub const fn with_margin(mut self, margin: f64) -> Self {
        self.margin = margin;
        self
    }

    /// Returns the query with another accuracy.
    #[must_use]
    pub const fn with_accuracy(mut self, accuracy: Accuracy) -> Self {
        self.accuracy = accuracy;
        self
    }

    /// Returns the query with a limit of spans that may hold a conflict. A span counts if cheap
    /// tests cannot rule it out: a common interval of a cubic of one body with a cubic of another.
    /// The limit, but at least 2^22, also applies to pairs whose boxes overlap in a part of a time
    /// slice.
    ///
    /// If all bodies are in one place, all pairs count. The screening then ends with
    /// [`Error::TooCrowded`](crate::Error::TooCrowded) instead of filling the memory.
    ///
    /// Cubics of rotation do not count, nor do the conflicts of a span: two bodies that stay within the margin while one
    /// of them turns a million times have up to a million conflicts in one span.
    #[must_use]
    pub const fn with_max_spans(mut self, limit: usize) -> Self {
        self.max_spans = limit;
        self
    }

    /// Returns the window; `None` stands for [`Scene::planned`](crate::Scene::planned).
    #[must_use]
    pub const fn window(&self) -> Option<Window> {
        self.window
    }

    /// Returns the margin, m.
    #[must_use]
    pub const fn margin(&self) -> f64 {
        self.margin
    }

    /// Returns the limit of spans that may hold a conflict.
    #[must_use]
    pub const fn max_spans(&self) -> usize {
        self.max_spans
    }

    /// Returns the accuracy.
    #[must_use]
    pub const fn accuracy(&self) -> Accuracy {
        self.accuracy
    }
}
