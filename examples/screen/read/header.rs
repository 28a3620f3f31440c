//! The header of a file of states: its separator, and where the columns are.

use crate::terminal::quoted;
use csv::ByteRecord;

/// Columns that every file has, in the order in which values are read.
pub(crate) const COLUMNS: [&str; 8] = ["body", "t", "px", "py", "pz", "vx", "vy", "vz"];
/// Column that a file may have.
const RADIUS: &str = "radius";
/// Of several that are as frequent the first is taken.
const SEPARATORS: [u8; 3] = [b',', b';', b'\t'];

/// Returns the separator of a file that begins with these bytes: the most frequent one of its first line.
pub(crate) fn separator(start: &[u8]) -> u8 {
    let is_filled = |line: &&[u8]| !line.trim_ascii().is_empty();
    let mut lines = start.split(|&byte| byte == b'\n');
    let line = lines.find(is_filled).unwrap_or_default();
    // What is in quotation marks separates nothing.
    let outside = || line.split(|&byte| byte == b'"').step_by(2).flatten();
    let count = |separator: u8| outside().filter(|&&byte| byte == separator).count();
    let mut best = SEPARATORS[0];
    for separator in SEPARATORS {
        if count(separator) > count(best) {
            best = separator;
        }
    }
    best
}

/// Places of the columns within a row.
#[derive(Debug)]
pub(crate) struct Header {
    found: ByteRecord,
    /// Of each of `COLUMNS`.
    places: [usize; 8],
    radius: Option<usize>,
}

impl Header {
    /// Reads a header. An error begins with the place in the file: row and column.
    pub(crate) fn read(found: ByteRecord, line: u64) -> Result<Self, String> {
        let expected = COLUMNS.join(",");
        if found.iter().all(|name| name.trim_ascii().is_empty()) {
            return Err(format!(
                "row {line}: the file is empty; expected the header {expected}"
            ));
        }
        if is_utf_16(&found) {
            return Err(format!(
                "row {line}: the file is in UTF-16; save it in UTF-8"
            ));
        }
        if let Some(place) = spanning(&found) {
            let column = (place + 1).to_string();
            return Err(open_quotation(line, &column, &found[place]));
        }
        let whole = || shown(&found.iter().collect::<Vec<_>>().join(&b',')[..]);
        let mut places = [0; 8];
        let mut missing = Vec::new();
        for (column, place) in COLUMNS.iter().zip(&mut places) {
            match find(&found, column, line)? {
                Some(index) => *place = index,
                None => missing.push(*column),
            }
        }
        match missing[..] {
            _ if has_lines(&found) => return Err(bare_return(line)),
            _ if is_for_a_spreadsheet(&found) => {
                return Err(format!(
                    "row {line}: a line that begins with \"sep=\" is for spreadsheets; delete it"
                ));
            }
            [] => {}
            [_, ..]
                if found.len() == 1
                    && found[0].split(|&byte| byte == b' ').count() >= COLUMNS.len() =>
            {
                return Err(format!(
                    "row {line}: columns are separated by spaces; use commas, semicolons or tabs"
                ));
            }
            [_, ..] if missing.len() == COLUMNS.len() => {
                return Err(format!(
                    "row {line}: no header; expected the columns {expected} in any order, found {}",
                    whole()
                ));
            }
            _ => {
                let plural = if missing.len() > 1 { "s" } else { "" };
                return Err(format!(
                    "row {line}, column{plural} {}: missing; expected the columns {expected} in any \
                     order, found {}",
                    missing.join(", "),
                    whole()
                ));
            }
        }
        let radius = find(&found, RADIUS, line)?;
        Ok(Self {
            found,
            places,
            radius,
        })
    }

    /// Returns the number of values in each row.
    pub(crate) fn len(&self) -> usize {
        self.found.len()
    }

    /// Returns the values of a row in the order of `COLUMNS`.
    pub(crate) fn values<'r>(&self, row: &'r ByteRecord) -> [&'r [u8]; 8] {
        self.places.map(|place| row.get(place).unwrap_or_default())
    }

    /// Returns the radius of a row, if the file has them.
    pub(crate) fn radius<'r>(&self, row: &'r ByteRecord) -> Option<&'r [u8]> {
        self.radius.map(|place| row.get(place).unwrap_or_default())
    }

    /// Returns the name of the column at this place, or of the last one.
    pub(crate) fn column(&self, place: usize) -> String {
        let place = place.min(self.found.len() - 1);
        match self.places.iter().position(|&known| known == place) {
            Some(index) => COLUMNS[index].to_owned(),
            None if self.radius == Some(place) => RADIUS.to_owned(),
            None => shown(&self.found[place]),
        }
    }

    /// Returns the names of the columns that nothing is read from.
    pub(crate) fn unused(&self) -> Vec<String> {
        let is_unused = |place: &usize| !self.places.contains(place) && self.radius != Some(*place);
        (0..self.found.len())
            .filter(is_unused)
            .map(|place| quoted(self.found[place].trim_ascii()))
            .collect()
    }
}

/// Finds a column by its name, upper or lower case; two of one name are an error.
fn find(found: &ByteRecord, column: &str, line: u64) -> Result<Option<usize>, String> {
    let is_it = |name: &[u8]| name.trim_ascii().eq_ignore_ascii_case(column.as_bytes());
    let mut places = (0..found.len()).filter(|&place| is_it(&found[place]));
    let first = places.next();
    match places.next() {
        None => Ok(first),
        Some(_) => Err(format!(
            "row {line}, column {column}: there are two of this name; keep one"
        )),
    }
}

/// Returns the place of the first value that goes on in the next line: its quotation mark is closed there or never.
pub(super) fn spanning(values: &ByteRecord) -> Option<usize> {
    let spans = |value: &[u8]| value.contains(&b'\n');
    values.iter().position(spans)
}

/// Returns the complaint about such a value.
pub(super) fn open_quotation(line: u64, column: &str, value: &[u8]) -> String {
    let shown = shown(value);
    format!("row {line}, column {column}: {shown} spans rows: close its quotation mark")
}

/// Returns the values that have a carriage return inside: the end of a line, without the line feed that ends a row.
pub(super) fn bare_returns(values: &ByteRecord) -> impl Iterator<Item = &[u8]> {
    let values = values.iter().map(<[u8]>::trim_ascii);
    values.filter(|value| value.contains(&b'\r'))
}

/// Returns true if a header goes on over several lines: a line ends after the name of a column, or many do.
fn has_lines(found: &ByteRecord) -> bool {
    let is_name = |value: &[u8]| {
        let mut lines = value.split(|&byte| byte == b'\r');
        let name = lines.next().unwrap_or_default().trim_ascii();
        let mut names = COLUMNS.iter().chain([&RADIUS]);
        names.any(|column| name.eq_ignore_ascii_case(column.as_bytes()))
    };
    bare_returns(found).count() > 1 || bare_returns(found).any(is_name)
}

/// Returns the complaint about such a row.
pub(super) fn bare_return(line: u64) -> String {
    format!(
        "row {line}: lines end with a bare carriage return; save the file with the line ends LF or CRLF"
    )
}

/// Returns true if a line tells a spreadsheet the separator.
fn is_for_a_spreadsheet(found: &ByteRecord) -> bool {
    let start = found.get(0).unwrap_or_default().trim_ascii_start();
    let start = start.get(..4).unwrap_or_default();
    start.eq_ignore_ascii_case(b"sep=")
}

/// Returns a value for a message, without what is left of the end of its row.
pub(super) fn shown(value: &[u8]) -> String {
    quoted(value.strip_suffix(b"\r").unwrap_or(value))
}

fn is_utf_16(found: &ByteRecord) -> bool {
    let start = found.get(0).unwrap_or_default();
    // With a byte order mark, or with a zero in each letter.
    matches!(
        start,
        [0xff, 0xfe, ..] | [0xfe, 0xff, ..] | [0, 1..=255, ..] | [1..=255, 0, ..]
    )
}
