//! Tables: printed, and as JSON.

use serde_json::{Map, Value, json};
use std::io::{Result, Write};

/// A cell of a table.
#[derive(Clone, Debug)]
pub(crate) enum Cell {
    Text(String),
    Count(u64),
    Number(f64),
    /// The column has no meaning in this row.
    Nothing,
}

impl From<&str> for Cell {
    fn from(text: &str) -> Self {
        Self::Text(text.to_owned())
    }
}

impl From<String> for Cell {
    fn from(text: String) -> Self {
        Self::Text(text)
    }
}

impl From<f64> for Cell {
    fn from(number: f64) -> Self {
        Self::Number(number)
    }
}

impl From<usize> for Cell {
    fn from(count: usize) -> Self {
        Self::Count(count as u64)
    }
}

impl From<u64> for Cell {
    fn from(count: u64) -> Self {
        Self::Count(count)
    }
}

impl<T: Into<Self>> From<Option<T>> for Cell {
    fn from(cell: Option<T>) -> Self {
        cell.map_or(Self::Nothing, Into::into)
    }
}

impl Cell {
    pub(crate) fn number(&self) -> Option<f64> {
        match *self {
            Self::Number(number) => Some(number),
            #[allow(clippy::cast_precision_loss, reason = "drawn")]
            Self::Count(count) => Some(count as f64),
            _ => None,
        }
    }

    fn shown(&self) -> String {
        match self {
            Self::Text(text) => text.clone(),
            Self::Count(count) => count.to_string(),
            Self::Number(number) => shown(*number),
            Self::Nothing => "-".to_owned(),
        }
    }

    fn json(&self) -> Value {
        match self {
            Self::Text(text) => json!(text),
            Self::Count(count) => json!(count),
            // What is not finite has no number in JSON.
            Self::Number(number) => json!(number.is_finite().then_some(*number)),
            Self::Nothing => Value::Null,
        }
    }
}

/// Three significant digits.
fn shown(number: f64) -> String {
    if number == 0.0 || !number.is_finite() {
        return number.to_string();
    }
    let size = number.abs();
    if (1e-3..1e6).contains(&size) {
        let digits = [100.0, 10.0, 1.0].iter().filter(|&&one| size < one).count();
        let more = [0.1, 0.01].iter().filter(|&&one| size < one).count();
        format!("{number:.*}", digits + more)
    } else {
        format!("{number:.1e}")
    }
}

/// Rows under named columns.
#[derive(Clone, Debug)]
pub(crate) struct Table {
    /// Key in the JSON.
    pub(crate) key: &'static str,
    title: String,
    columns: &'static [&'static str],
    pub(crate) rows: Vec<Vec<Cell>>,
    notes: Vec<String>,
}

impl Table {
    pub(crate) fn new(
        key: &'static str,
        title: impl Into<String>,
        columns: &'static [&'static str],
    ) -> Self {
        Self {
            key,
            title: title.into(),
            columns,
            rows: Vec::new(),
            notes: Vec::new(),
        }
    }

    pub(crate) fn row(&mut self, cells: Vec<Cell>) {
        debug_assert_eq!(cells.len(), self.columns.len(), "a cell for each column");
        self.rows.push(cells);
    }

    /// Adds a sentence below the table.
    pub(crate) fn note(&mut self, note: impl Into<String>) {
        self.notes.push(note.into());
    }

    pub(crate) fn print(&self, out: &mut impl Write) -> Result<()> {
        writeln!(out, "\n{}", self.title)?;
        let shown: Vec<Vec<String>> = self
            .rows
            .iter()
            .map(|row| row.iter().map(Cell::shown).collect())
            .collect();
        let width = |column: usize| {
            let cells = shown.iter().map(|row| row[column].chars().count());
            cells.max().unwrap_or(0).max(self.columns[column].len())
        };
        let widths: Vec<usize> = (0..self.columns.len()).map(width).collect();
        let is_text = |column: usize| {
            let texts = |row: &Vec<Cell>| matches!(row[column], Cell::Text(_));
            self.rows.iter().all(texts)
        };
        let mut line = |cells: &mut dyn Iterator<Item = &str>| {
            let padded = cells.enumerate().map(|(column, cell)| {
                let width = widths[column];
                if is_text(column) {
                    format!("{cell:<width$}")
                } else {
                    format!("{cell:>width$}")
                }
            });
            let line = padded.collect::<Vec<_>>().join("  ");
            writeln!(out, "  {}", line.trim_end())
        };
        line(&mut self.columns.iter().copied()).and_then(|()| {
            shown
                .iter()
                .try_for_each(|row| line(&mut row.iter().map(String::as_str)))
        })?;
        self.notes
            .iter()
            .try_for_each(|note| writeln!(out, "  {note}"))
    }

    pub(crate) fn json(&self) -> Value {
        let rows = self.rows.iter().map(|row| {
            let cells = self.columns.iter().zip(row);
            Value::Object(
                cells
                    .map(|(name, cell)| (key(name), cell.json()))
                    .collect::<Map<_, _>>(),
            )
        });
        json!({
            "title": self.title,
            "rows": rows.collect::<Vec<_>>(),
            "notes": self.notes,
        })
    }
}

/// A column's name as a key.
fn key(name: &str) -> String {
    name.replace([' ', '/'], "_")
}
