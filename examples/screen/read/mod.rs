//! Reading a file of states; every complaint names file, row, column and value.
//!
//! Rows are counted as lines of the file, which end with `\n` or `\r\n`: the header is row 1, and empty ones
//! count. A value is on one line: quotation marks around several rows are an error, which has the number of the first.

mod complain;
mod header;
mod labels;
mod packing;

pub(crate) use labels::Labels;

use crate::terminal::{self, quoted};
use csv::ByteRecord;
use glam::DVec3;
use header::{COLUMNS, Header};
use nearmiss::{MAX_MAGNITUDE, State, Trajectory};
use std::fs::File;
use std::io::{Cursor, Read};
use std::path::Path;
use std::str::FromStr;

/// The bodies of a file, in the order of their labels.
pub(crate) struct Bodies {
    pub(crate) labels: Labels,
    pub(crate) bodies: Vec<FileBody>,
    /// Names of columns that are not used.
    pub(crate) unused: Vec<String>,
}

/// A body as a file tells it.
pub(crate) struct FileBody {
    pub(crate) tag: u64,
    pub(crate) trajectory: Trajectory,
    /// m, if the file has radii.
    pub(crate) radius: Option<f64>,
}

/// Reads the bodies of a file. The file `-` is standard input.
pub(crate) fn bodies(path: &Path) -> Result<Bodies, String> {
    if path == Path::new("-") {
        return Table::read(std::io::stdin().lock())
            .and_then(Table::into_bodies)
            .map_err(|error| format!("standard input: {error}"));
    }
    let file = File::open(path).map_err(|error| error.to_string());
    file.and_then(Table::read)
        .and_then(Table::into_bodies)
        .map_err(|error| format!("{}: {error}", terminal::name(path)))
}

struct Row {
    line: u64,
    /// Tag of its label.
    body: u64,
    state: State,
}

/// A file that was read. Its errors begin with the place in the file.
struct Table {
    header: Header,
    labels: Labels,
    rows: Vec<Row>,
    /// One for each row (m), or none at all.
    radii: Vec<f64>,
}

impl Table {
    fn read(source: impl Read) -> Result<Self, String> {
        /// A header is not longer.
        const START: u64 = 1 << 16;
        let mut source = packing::text(source).map_err(|error| error.to_string())?;
        let mut start = Vec::new();
        let read = source.by_ref().take(START).read_to_end(&mut start);
        read.map_err(|error| error.to_string())?;
        let separator = header::separator(&start);
        // Rows end at `\n` alone, and values are trimmed: the reader would take the `\r` of `\r\n` for a row's
        // end, and count the `\n` with the next row.
        let mut reader = csv::ReaderBuilder::new()
            .has_headers(false)
            .flexible(true)
            .delimiter(separator)
            .terminator(csv::Terminator::Any(b'\n'))
            .from_reader(Cursor::new(start).chain(source));
        let mut record = ByteRecord::new();
        let line = next_row(&mut reader, &mut record)?.unwrap_or(1);
        let mut table = Self {
            header: Header::read(record.clone(), line)?,
            labels: Labels::default(),
            rows: Vec::new(),
            radii: Vec::new(),
        };
        while let Some(line) = next_row(&mut reader, &mut record)? {
            table.add(line, &record, separator)?;
        }
        if table.rows.is_empty() {
            return Err(format!("row {}: no states after the header", line + 1));
        }
        Ok(table)
    }

    fn add(&mut self, line: u64, record: &ByteRecord, separator: u8) -> Result<(), String> {
        if record.len() != self.header.len() {
            let has_lines = header::bare_returns(record).next().is_some();
            if has_lines && record.len() > self.header.len() {
                return Err(header::bare_return(line));
            }
            return Err(self.wrong_count(line, record, separator));
        }
        if let Some(place) = header::spanning(record) {
            let column = self.header.column(place);
            return Err(header::open_quotation(line, &column, &record[place]));
        }
        let values = self.header.values(record);
        let tags = self.rows.iter_mut().map(|row| &mut row.body);
        let tag = self.labels.tag(values[0], tags);
        let body = tag.map_err(|problem| format!("row {line}, column body: {problem}"))?;
        let mut numbers = [0.0; 7];
        for (index, number) in numbers.iter_mut().enumerate() {
            *number = finite(values[index + 1]).ok_or_else(|| {
                let column = COLUMNS[index + 1];
                let problem = not_a_number(values[index + 1], column);
                format!("row {line}, column {column}: {problem}")
            })?;
        }
        if let Some(value) = self.header.radius(record) {
            let radius = finite(value).filter(|radius| (0.0..=MAX_MAGNITUDE).contains(radius));
            self.radii.push(radius.ok_or_else(|| {
                let problem = decimal_comma(value).unwrap_or_else(|| {
                    let value = header::shown(value);
                    format!("{value} is not a number from 0 to 1e300; give metres")
                });
                format!("row {line}, column radius: {problem}")
            })?);
        }
        let [t, px, py, pz, vx, vy, vz] = numbers;
        self.rows.push(Row {
            line,
            body,
            state: State::new(t, DVec3::new(px, py, pz), DVec3::new(vx, vy, vz)),
        });
        Ok(())
    }

    fn wrong_count(&self, line: u64, record: &ByteRecord, separator: u8) -> String {
        let (found, expected) = (record.len(), self.header.len());
        let last = record.iter().next_back().unwrap_or_default();
        let column = self.header.column(found);
        let advice = match separator {
            _ if last.contains(&b'\n') => "; close its quotation mark",
            _ if header::spanning(record).is_some() => {
                "; close the quotation mark of the value that spans rows"
            }
            b',' if found > expected => {
                "; write decimal points, and names with commas in quotation marks"
            }
            _ if last.iter().any(|byte| b",;\t".contains(byte)) => {
                "; separate its values as those of the header"
            }
            _ => "",
        };
        let last = header::shown(last);
        format!(
            "row {line}, column {column}: the row has {found} values, not {expected} as the header; the last \
             is {last}{advice}"
        )
    }

    fn into_bodies(self) -> Result<Bodies, String> {
        let labels = self.labels;
        let rows = self.rows.iter();
        let grouped = Trajectory::group_rows(rows.map(|row| (row.body, row.state)));
        let grouped = grouped.map_err(|error| complain::explain(&error, &self.rows, &labels))?;
        let radii = radii(&self.rows, &self.radii, &labels)?;
        let mut bodies: Vec<FileBody> = grouped
            .into_iter()
            .enumerate()
            .map(|(place, (tag, trajectory))| FileBody {
                tag,
                trajectory,
                radius: radii.get(place).copied(),
            })
            .collect();
        bodies.sort_by_key(|body| body.tag);
        Ok(Bodies {
            labels,
            bodies,
            unused: self.header.unused(),
        })
    }
}

/// Returns the radius of each body in the order of the rows; bodies have one each. `radii` has one for each row,
/// or none at all.
fn radii(rows: &[Row], radii: &[f64], labels: &Labels) -> Result<Vec<f64>, String> {
    let mut of_bodies: Vec<f64> = Vec::new();
    let mut first: Option<&Row> = None;
    for (row, &radius) in rows.iter().zip(radii) {
        match (first, of_bodies.last()) {
            (Some(first), Some(&before)) if first.body == row.body =>
            {
                #[allow(clippy::float_cmp, reason = "the same number was read")]
                if radius != before {
                    return Err(format!(
                        "row {}, column radius: {radius} is not {before}, the radius of body {} in row {}; \
                         a body has one radius",
                        row.line,
                        labels.told(row.body),
                        first.line
                    ));
                }
            }
            _ => {
                first = Some(row);
                of_bodies.push(radius);
            }
        }
    }
    Ok(of_bodies)
}

/// Reads the next row that is not empty; gives its number, none at the end.
fn next_row(
    reader: &mut csv::Reader<impl Read>,
    record: &mut ByteRecord,
) -> Result<Option<u64>, String> {
    loop {
        let found = reader.read_byte_record(record);
        // Behind the line end of the row, and of empty ones before it.
        let line = reader.position().line() - 1;
        match found {
            Ok(true) if record.len() == 1 && record[0].trim_ascii().is_empty() => {}
            Ok(false) => return Ok(None),
            Ok(true) => {
                let ends = record.as_slice().iter().filter(|&&byte| byte == b'\n');
                let first = line.saturating_sub(ends.count() as u64);
                // A row with open quotation marks has no line end. (The reader takes empty ones before it for its own.)
                let own = record.position().map_or(0, csv::Position::line);
                return Ok(Some(first.max(own)));
            }
            Err(error) => return Err(format!("row {line}: {error}")),
        }
    }
}

fn not_a_number(value: &[u8], column: &str) -> String {
    if value.trim_ascii().is_empty() {
        return "the cell is empty".to_owned();
    }
    decimal_comma(value).unwrap_or_else(|| {
        let shown = header::shown(value);
        let advice = if column == "t" {
            ": write seconds, counted from an epoch near your data"
        } else {
            ""
        };
        format!("{shown} is not a finite number{advice}")
    })
}

/// Returns the complaint about a number with a decimal comma.
fn decimal_comma(value: &[u8]) -> Option<String> {
    let pointed = value.iter();
    let pointed: Vec<u8> = pointed
        .map(|&byte| if byte == b',' { b'.' } else { byte })
        .collect();
    let is_comma = value.contains(&b',') && finite(&pointed).is_some();
    is_comma.then(|| {
        let (shown, right) = (header::shown(value), quoted(pointed.trim_ascii()));
        format!("{shown} has a decimal comma; write {right}")
    })
}

fn finite(value: &[u8]) -> Option<f64> {
    number(value).filter(|value: &f64| value.is_finite())
}

/// Reads a value as a number, but for spaces around it.
fn number<T: FromStr>(value: &[u8]) -> Option<T> {
    std::str::from_utf8(value).ok()?.trim().parse().ok()
}
