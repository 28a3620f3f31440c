//! The library's errors in the terms of a file: row, column and value.

use super::Row;
use super::header::COLUMNS;
use super::labels::Labels;
use nearmiss::{Error, Quantity};

/// Explains why the rows make no trajectories. It begins with the place in the file.
pub(super) fn explain(error: &Error, rows: &[Row], labels: &Labels) -> String {
    let Error::InBody { body, error, .. } = error else {
        return error.to_string();
    };
    let name = labels.told(*body);
    let first = rows.iter().position(|row| row.body == *body);
    let first = first.unwrap_or(0);
    let line = |row: usize| rows.get(row).map_or(0, |row| row.line);
    let place = |knot: usize, column: &str| format!("row {}, column {column}", line(first + knot));
    match **error {
        Error::RowsApart { row } => format!(
            "row {}, column body: body {name} has rows from row {} on, and others since; a body's rows \
             must be together: sort the file by body, then by t",
            line(row),
            line(first)
        ),
        Error::TooFewStates { count } => format!(
            "{}: body {name} has {count} row, and needs at least two",
            place(0, "body")
        ),
        Error::TimeNotIncreasing {
            knot,
            previous,
            time,
        } => format!(
            "{}: {time} is not later than {previous}, the row before of body {name}; sort its rows by t, \
             and keep one row for each instant",
            place(knot, "t")
        ),
        Error::NotFinite {
            knot,
            quantity,
            value,
        } => format!(
            "{}: {value} is not a finite number",
            place(knot, column(quantity))
        ),
        Error::OutOfRange {
            knot,
            quantity,
            value,
        } => {
            let column = place(knot, column(quantity));
            if matches!(
                quantity,
                Quantity::Distance | Quantity::Speed | Quantity::Acceleration
            ) {
                format!(
                    "{column}: {quantity} would be {value:e}, out of range (1e300); check the units, m, s and m/s"
                )
            } else {
                format!(
                    "{column}: {value:e} is out of range (1e300); check the units, m, s and m/s"
                )
            }
        }
        _ => format!("{}: body {name}: {error}", place(0, "body")),
    }
}

fn column(quantity: Quantity) -> &'static str {
    match quantity {
        Quantity::Time => "t",
        Quantity::Position(axis) => COLUMNS[2 + axis],
        Quantity::Velocity(axis) => COLUMNS[5 + axis],
        _ => "px to vz",
    }
}
