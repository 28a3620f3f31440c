//! Segments of two bodies over spans, gathered into the form of the kernels.

use glam::DVec3;

use super::Verdict;
use super::batch::{CubicBatch, Lanes};
use super::within::within;
use crate::narrow_phase::relative::RelativeCubic;
use crate::real::Real;
use crate::simd::InstructionSet;
use crate::trajectory::Segment;

/// Pairs of segments over spans, each with a threshold: which of them come within it?
///
/// The relative motion is formed in `f64`, differences first, and then rounded to the type of the
/// lanes; what forming it rounds is kept with each pair. So a certain verdict holds for the exact
/// motion of the segments as they are given, in `f32` too, wherever the bodies are and whenever.
/// `f32` takes half the memory and time, and leaves more pairs undecided: those within some 1e-6 of
/// the polygon's size of the threshold.
///
/// ```
/// use nearmiss::glam::DVec3;
/// use nearmiss::kernels::{InstructionSet, SpanBatch, Verdict};
/// use nearmiss::{State, Trajectory};
///
/// // Two bodies on straight lines, 3 m apart when they pass each other after one second.
/// let line = |from: DVec3, velocity: DVec3| {
///     let states = [0.0, 2.0].map(|t| State::new(t, from + t * velocity, velocity));
///     Trajectory::from_states(&states)
/// };
/// let a = line(DVec3::new(-5.0, 3.0, 0.0), DVec3::new(5.0, 0.0, 0.0))?;
/// let b = line(DVec3::ZERO, DVec3::ZERO)?;
///
/// let mut batch = SpanBatch::<f32>::new();
/// for threshold in [2.9, 3.1] {
///     batch.push(&a.segments()[0], &b.segments()[0], (0.0, 2.0), DVec3::ZERO, threshold);
/// }
/// let mut verdicts = [Verdict::Undecided; 2];
/// batch.verdicts(InstructionSet::best(), &mut verdicts);
/// assert_eq!(verdicts, [Verdict::Outside, Verdict::Inside]);
/// # Ok::<(), nearmiss::Error>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct SpanBatch<R> {
    cubics: CubicBatch<R>,
    inner: Vec<R>,
    outer: Vec<R>,
}

impl<R: Real> SpanBatch<R> {
    /// Returns an empty batch.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Appends a pair: body `a` on one segment, `b` on another, from the first to the second time
    /// of `span` (s). Outside their knots the cubics continue. If span or threshold is NaN the
    /// verdict is undecided.
    ///
    /// `offset` (m) is added to the position of `a` relative to `b`: the difference of the spheres'
    /// centres in their bodies' frames. `threshold` (m) is the distance asked about; nothing comes
    /// within a negative one, whatever the span.
    #[inline]
    pub fn push(
        &mut self,
        a: &Segment,
        b: &Segment,
        span: (f64, f64),
        offset: DVec3,
        threshold: f64,
    ) {
        let cubic = RelativeCubic::between(a, b, span, offset);
        let [p0, p1, p2, p3] = cubic.points;
        let narrow = |p: DVec3| [R::from_f64(p.x), R::from_f64(p.y), R::from_f64(p.z)];
        self.cubics
            .push([narrow(p0), narrow(p1), narrow(p2), narrow(p3)]);
        // Rounded away from each other: the difference here, the conversion there.
        self.inner
            .push(R::not_above((threshold - cubic.error).next_down()));
        self.outer
            .push(-R::not_above(-(threshold + cubic.error).next_up()));
    }

    /// Returns the number of pairs.
    #[must_use]
    pub fn len(&self) -> usize {
        self.inner.len()
    }

    /// Returns true if there is no pair.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.inner.is_empty()
    }

    /// Removes all pairs and keeps the memory.
    pub fn clear(&mut self) {
        self.cubics.clear();
        self.inner.clear();
        self.outer.clear();
    }

    /// Returns the relative cubics, for the other kernels.
    #[must_use]
    pub fn lanes(&self) -> Lanes<'_, R> {
        self.cubics.lanes()
    }

    /// Decides each pair, on the caller's thread.
    ///
    /// # Panics
    ///
    /// If there is not one verdict for each pair.
    pub fn verdicts(&self, instructions: InstructionSet, verdicts: &mut [Verdict]) {
        assert_eq!(self.len(), verdicts.len(), "one verdict for each pair");
        within(
            instructions,
            &self.lanes(),
            &self.inner,
            &self.outer,
            verdicts,
        );
    }
}
