//! A world modelled more or less finely: what that costs, and which answers it changes.

mod baking;
mod box_pair;
mod knots;
mod motions;
mod spheres;
mod told;

use crate::table::Table;
use crate::{Effort, Failure};

/// All tables of models.
pub(crate) fn tables(effort: &Effort, progress: &dyn Fn(f64)) -> Result<Vec<Table>, Failure> {
    let mut tables = Vec::new();
    for (number, table) in [knots::table, told::table, spheres::table, baking::table]
        .into_iter()
        .enumerate()
    {
        tables.push(table(effort)?);
        #[allow(clippy::cast_precision_loss, reason = "shown")]
        progress((number + 1) as f64 / 4.0);
    }
    Ok(tables)
}
