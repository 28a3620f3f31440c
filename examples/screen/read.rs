//! Reading a file of states; every complaint names file, row, column and value.
//!
//! Rows are counted as lines of the file, which end with `\n` or `\r\n`: the header is row 1, and empty ones
//! count.

use crate::terminal::{self, quoted};
use csv::ByteRecord;
use flate2::read::MultiGzDecoder;
use glam::DVec3;
use nearmiss::{Error, Quantity, State, Trajectory};
use std::fs::File;
use std::io::{BufReader, Cursor, Read};
use std::path::Path;
use std::str::FromStr;

const COLUMNS: [&str; 8] = ["body", "t", "px", "py", "pz", "vx", "vy", "vz"];

/// The bodies of a file in the order of its rows, by label. The file `-` is standard input.
pub(crate) fn trajectories(path: &Path) -> Result<Vec<(u64, Trajectory)>, String> {
    let table = if path == Path::new("-") {
        Table::read("standard input", std::io::stdin().lock())
    } else {
        let name = terminal::name(path);
        let file = File::open(path).map_err(|error| format!("{name}: {error}"))?;
        Table::read(&name, file)
    }?;
    if table.rows.is_empty() {
        return Err(format!("{}: row 2: no states after the header", table.name));
    }
    Trajectory::group_rows(table.rows.iter().map(|row| (row.body, row.state)))
        .map_err(|error| table.complain(&error))
}

struct Row {
    line: u64,
    body: u64,
    state: State,
}

struct Table {
    name: String,
    rows: Vec<Row>,
}

impl Table {
    fn read(name: &str, source: impl Read) -> Result<Self, String> {
        let source = text(source).map_err(|error| format!("{name}: {error}"))?;
        // Of `\r\n` the first is trimmed: the reader would take it for a row's end, and count the
        // second with the next row.
        let mut reader = csv::ReaderBuilder::new()
            .has_headers(false)
            .flexible(true)
            .trim(csv::Trim::All)
            .terminator(csv::Terminator::Any(b'\n'))
            .from_reader(source);
        let mut record = ByteRecord::new();
        next_row(name, &mut reader, &mut record)?;
        check_header(name, &record)?;
        let mut rows = Vec::new();
        while let Some(line) = next_row(name, &mut reader, &mut record)? {
            rows.push(parse(name, line, &record)?);
        }
        Ok(Self {
            name: name.to_owned(),
            rows,
        })
    }

    /// A trajectory's error in the terms of the file.
    fn complain(&self, error: &Error) -> String {
        let Error::InBody { body, error } = error else {
            return format!("{}: {error}", self.name);
        };
        let first = self.rows.iter().position(|row| row.body == *body);
        let first = first.unwrap_or(0);
        let line = |row: usize| self.rows.get(row).map_or(0, |row| row.line);
        let place = |knot: usize, column: &str| {
            let line = line(first + knot);
            format!("{}: row {line}, column {column}", self.name)
        };
        match **error {
            Error::RowsApart { row } => format!(
                "{}: row {}, column body: body {body} has rows from row {} on, and others since; \
                 a body's rows must be together",
                self.name,
                line(row),
                line(first)
            ),
            Error::TooFewStates { count } => format!(
                "{}: body {body} has {count} row, and needs at least two",
                place(0, "body")
            ),
            Error::TimeNotIncreasing {
                knot,
                previous,
                time,
            } => format!(
                "{}: {time} is not later than {previous}, the row before of body {body}",
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
                    format!("{column}: {quantity} would be {value:e}, out of range (1e300)")
                } else {
                    format!("{column}: {value:e} is out of range (1e300)")
                }
            }
            _ => format!("{}: {error}", place(0, "body")),
        }
    }
}

/// Reads the next row that is not empty; gives its number, none at the end.
fn next_row(
    name: &str,
    reader: &mut csv::Reader<impl Read>,
    record: &mut ByteRecord,
) -> Result<Option<u64>, String> {
    loop {
        let found = reader.read_byte_record(record);
        // Behind the line end of the row, and of empty ones before it.
        let line = reader.position().line() - 1;
        match found {
            Ok(true) if record.len() == 1 && is_text(&record[0], "") => {}
            Ok(found) => return Ok(found.then_some(line)),
            Err(error) => return Err(format!("{name}: row {line}: {error}")),
        }
    }
}

/// The text of a file: unpacked, without a byte order mark, and with a line end after each line.
fn text<'a>(source: impl Read + 'a) -> std::io::Result<impl Read + 'a> {
    /// What is packed with gzip says so, whatever its name; no text begins so.
    const GZIP: &[u8] = &[0x1f, 0x8b];
    /// Some programs put it before the text.
    const BYTE_ORDER_MARK: &[u8] = "\u{feff}".as_bytes();
    let (is_packed, whole) = begins_with(source, GZIP)?;
    let text: Box<dyn Read + 'a> = if is_packed {
        Box::new(MultiGzDecoder::new(BufReader::new(GZIP.chain(whole))))
    } else {
        Box::new(whole)
    };
    let (_, rest) = begins_with(text, BYTE_ORDER_MARK)?;
    Ok(rest.chain(&b"\n"[..]))
}

/// Whether a source begins with some bytes, and what comes after them; all of it if it does not.
fn begins_with<'a>(
    mut source: impl Read + 'a,
    bytes: &[u8],
) -> std::io::Result<(bool, impl Read + 'a)> {
    let mut start = Vec::new();
    source
        .by_ref()
        .take(bytes.len() as u64)
        .read_to_end(&mut start)?;
    let begins = start == bytes;
    if begins {
        start.clear();
    }
    Ok((begins, Cursor::new(start).chain(source)))
}

fn column(quantity: Quantity) -> &'static str {
    match quantity {
        Quantity::Time => "t",
        Quantity::Position(axis) => COLUMNS[2 + axis],
        Quantity::Velocity(axis) => COLUMNS[5 + axis],
        _ => "px to vz",
    }
}

fn check_header(name: &str, header: &ByteRecord) -> Result<(), String> {
    if header.iter().all(|found| is_text(found, "")) {
        return Err(format!(
            "{name}: row 1: the file is empty; expected the header {}",
            COLUMNS.join(",")
        ));
    }
    let found = || quoted(&header.iter().collect::<Vec<_>>().join(&b',')[..]);
    let is_missing = |column: &&&str| !header.iter().any(|found| is_text(found, column));
    if let Some(missing) = COLUMNS.iter().find(is_missing) {
        return Err(format!(
            "{name}: row 1, column {missing}: missing; expected {}, found {}",
            COLUMNS.join(","),
            found()
        ));
    }
    let is_right = |(found, column): (&[u8], &&str)| is_text(found, column);
    if header.len() != COLUMNS.len() || !header.iter().zip(&COLUMNS).all(is_right) {
        return Err(format!(
            "{name}: row 1: expected the header {}, found {}",
            COLUMNS.join(","),
            found()
        ));
    }
    Ok(())
}

fn parse(name: &str, line: u64, record: &ByteRecord) -> Result<Row, String> {
    if record.len() != COLUMNS.len() {
        let column = COLUMNS.get(record.len()).unwrap_or(&"vz");
        let last = record.iter().next_back().unwrap_or_default();
        return Err(format!(
            "{name}: row {line}, column {column}: the row has {} values, not {}; the last is {}",
            record.len(),
            COLUMNS.len(),
            quoted(last)
        ));
    }
    let body = number(&record[0]).ok_or_else(|| {
        let value = quoted(&record[0]);
        format!("{name}: row {line}, column body: {value} is not a whole number from 0 on")
    })?;
    let mut numbers = [0.0; 7];
    for (index, place) in numbers.iter_mut().enumerate() {
        let value = &record[index + 1];
        let finite = number(value).filter(|value: &f64| value.is_finite());
        *place = finite.ok_or_else(|| {
            let (column, value) = (COLUMNS[index + 1], quoted(value));
            format!("{name}: row {line}, column {column}: {value} is not a finite number")
        })?;
    }
    let [t, px, py, pz, vx, vy, vz] = numbers;
    Ok(Row {
        line,
        body,
        state: State::new(t, DVec3::new(px, py, pz), DVec3::new(vx, vy, vz)),
    })
}

/// Compares a value with a text, but for spaces around it.
fn is_text(value: &[u8], text: &str) -> bool {
    std::str::from_utf8(value).is_ok_and(|value| value.trim() == text)
}

/// Reads a value as a number, but for spaces around it.
fn number<T: FromStr>(value: &[u8]) -> Option<T> {
    std::str::from_utf8(value).ok()?.trim().parse().ok()
}
