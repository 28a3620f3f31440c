//! Conversion of table rows to trajectories.

use super::{State, Trajectory};
use crate::error::Error;
use std::collections::HashSet;

impl Trajectory {
    /// Builds one trajectory per body from `(body, state)` rows, as in the files that the `screen`
    /// example reads. Rows of a body must be together and in time order.
    ///
    /// The result is in the order of the rows.
    ///
    /// ```
    /// use nearmiss::glam::DVec3;
    /// use nearmiss::{State, Trajectory};
    ///
    /// let row = |body, time, x| (body, State::new(time, x * DVec3::X, DVec3::X));
    /// let rows = [row(7, 0.0, 0.0), row(7, 1.0, 1.0), row(3, 0.0, 5.0), row(3, 2.0, 7.0)];
    /// let bodies = Trajectory::group_rows(rows)?;
    /// assert_eq!((bodies[0].0, bodies[0].1.knots()), (7, &[0.0, 1.0][..]));
    /// assert_eq!((bodies[1].0, bodies[1].1.knots()), (3, &[0.0, 2.0][..]));
    /// # Ok::<(), nearmiss::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`Error::InBody`] with the body and, within, [`Error::RowsApart`] or the error of
    /// [`Trajectory::from_states`]. A body with a single row that comes again later, as in a table
    /// in time order, gives `RowsApart`, not `TooFewStates`.
    pub fn group_rows(
        rows: impl IntoIterator<Item = (u64, State)>,
    ) -> Result<Vec<(u64, Trajectory)>, Error> {
        let mut bodies = Vec::new();
        let mut seen = HashSet::new();
        let mut states: Vec<State> = Vec::new();
        let mut current: Option<u64> = None;
        let mut rows = rows.into_iter().enumerate();
        while let Some((row, (body, state))) = rows.next() {
            if current != Some(body) {
                if !seen.insert(body) {
                    return Err(Error::RowsApart { row }.in_body(body));
                }
                if let Some(previous) = current.replace(body) {
                    if states.len() < 2
                        && let Some((row, _)) = rows.find(|&(_, (later, _))| later == previous)
                    {
                        return Err(Error::RowsApart { row }.in_body(previous));
                    }
                    bodies.push(finish(previous, &mut states)?);
                }
            }
            states.push(state);
        }
        if let Some(last) = current {
            bodies.push(finish(last, &mut states)?);
        }
        Ok(bodies)
    }
}

fn finish(body: u64, states: &mut Vec<State>) -> Result<(u64, Trajectory), Error> {
    let trajectory = Trajectory::from_states(states).map_err(|error| error.in_body(body))?;
    states.clear();
    Ok((body, trajectory))
}
