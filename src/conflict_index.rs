//! Conflicts by body.

use crate::conflict::Conflict;
use crate::id::BodyId;

/// The conflicts of a list, sorted by body: for questions about many bodies.
///
/// [`Screening::conflicts_of`](crate::Screening::conflicts_of) and
/// [`Monitor::conflicts_of`](crate::Monitor::conflicts_of) go through all conflicts for each body. An index sorts them
/// once; then a body costs two binary searches.
///
/// ```
/// use nearmiss::{AlertLevel, Body, ConflictIndex, Monitor, Scene, Trajectory};
///
/// let mut scene = Scene::new();
/// for x in [0.0, 1.0, 2.0] {
///     scene.insert(Body::new(Trajectory::at_rest([x, 0.0, 0.0])?))?;
/// }
/// let mut monitor = Monitor::new(scene, 0.0, 10.0, &[AlertLevel::at(1.5)])?;
/// monitor.advance(0.0, &mut Vec::new())?;
/// let index = ConflictIndex::new(monitor.conflicts(0)?);
/// let counts = monitor.scene().bodies().map(|(id, _)| index.of(id).len());
/// assert_eq!(counts.collect::<Vec<_>>(), [1, 2, 1]);
/// # Ok::<(), nearmiss::Error>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct ConflictIndex<'c> {
    conflicts: &'c [Conflict],
    /// The bodies of each conflict with its place in the list, sorted.
    places: Vec<(BodyId, usize)>,
}

impl<'c> ConflictIndex<'c> {
    /// Sorts the conflicts of a list by body. Takes up to 32 bytes a conflict.
    #[must_use]
    pub fn new(conflicts: &'c [Conflict]) -> Self {
        let bodies = |(place, one): (usize, &Conflict)| [(one.a, place), (one.b, place)];
        let mut places: Vec<_> = conflicts.iter().enumerate().flat_map(bodies).collect();
        places.sort_unstable();
        Self { conflicts, places }
    }

    /// Returns the conflicts of one body, in the order of the list: those of a screening or a monitor soonest first. A
    /// body that is not in the list has none.
    pub fn of(&self, id: BodyId) -> impl ExactSizeIterator<Item = &'c Conflict> + use<'_, 'c> {
        let first = self.places.partition_point(|&(body, _)| body < id);
        let count = self.places[first..].partition_point(|&(body, _)| body == id);
        let places = self.places[first..first + count].iter();
        places.map(|&(_, place)| &self.conflicts[place])
    }
}
