//! Reading a file of states; every complaint names file, row, column and value.
//!
//! Rows are counted as lines of the file: the header is row 1.

use flate2::read::MultiGzDecoder;
use glam::DVec3;
use nearmiss::{Error, Quantity, State, Trajectory};
use std::collections::HashMap;
use std::fs::File;
use std::io::Read;
use std::path::Path;

const COLUMNS: [&str; 8] = ["body", "t", "px", "py", "pz", "vx", "vy", "vz"];

/// The bodies of a file in the order of its rows, by label.
pub(crate) fn trajectories(path: &Path) -> Result<Vec<(u64, Trajectory)>, String> {
    let table = Table::read(path)?;
    let mut bodies = Vec::new();
    let mut seen: HashMap<u64, u64> = HashMap::new();
    let mut rest = table.rows.as_slice();
    while let Some(first) = rest.first() {
        let count = rest.iter().take_while(|row| row.body == first.body).count();
        let (rows, following) = rest.split_at(count);
        if let Some(before) = seen.insert(first.body, first.line) {
            return Err(format!(
                "{}: row {}, column body: body {} has rows from row {before} on, and others \
                 since; a body's rows must be together",
                table.name, first.line, first.body
            ));
        }
        let states: Vec<State> = rows.iter().map(|row| row.state).collect();
        let trajectory =
            Trajectory::from_states(&states).map_err(|error| table.complain(rows, &error))?;
        bodies.push((first.body, trajectory));
        rest = following;
    }
    if bodies.is_empty() {
        return Err(format!("{}: row 2: no states after the header", table.name));
    }
    Ok(bodies)
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
    fn read(path: &Path) -> Result<Self, String> {
        let name = path.display().to_string();
        let file = File::open(path).map_err(|error| format!("{name}: {error}"))?;
        let packed = path.extension().is_some_and(|extension| extension == "gz");
        let reader: Box<dyn Read> = if packed {
            Box::new(MultiGzDecoder::new(std::io::BufReader::new(file)))
        } else {
            Box::new(file)
        };
        let mut reader = csv::ReaderBuilder::new()
            .flexible(true)
            .trim(csv::Trim::All)
            .from_reader(reader);
        let header = reader
            .headers()
            .map_err(|error| format!("{name}: row 1: {error}"))?;
        let header: Vec<String> = header.iter().map(str::to_owned).collect();
        check_header(&name, &header)?;
        let mut rows = Vec::new();
        let mut record = csv::StringRecord::new();
        loop {
            let line = reader.position().line();
            match reader.read_record(&mut record) {
                Ok(false) => break,
                Ok(true) => {
                    let line = record.position().map_or(line, csv::Position::line);
                    rows.push(parse(&name, line, &record)?);
                }
                Err(error) => return Err(format!("{name}: row {line}: {error}")),
            }
        }
        Ok(Self { name, rows })
    }

    /// A trajectory's error in the terms of the file.
    fn complain(&self, rows: &[Row], error: &Error) -> String {
        let place = |knot: usize, column: &str| {
            let line = rows.get(knot).map_or(0, |row| row.line);
            format!("{}: row {line}, column {column}", self.name)
        };
        let body = rows.first().map_or(0, |row| row.body);
        match *error {
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
            } => format!(
                "{}: {value:e} is out of range (1e300)",
                place(knot, column(quantity))
            ),
            _ => format!("{}: {error}", place(0, "body")),
        }
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

fn check_header(name: &str, header: &[String]) -> Result<(), String> {
    if header.iter().all(String::is_empty) {
        return Err(format!(
            "{name}: row 1: the file is empty; expected the header {}",
            COLUMNS.join(",")
        ));
    }
    if let Some(missing) = COLUMNS
        .iter()
        .find(|&&column| !header.iter().any(|found| found == column))
    {
        return Err(format!(
            "{name}: row 1, column {missing}: missing; expected {}, found {}",
            COLUMNS.join(","),
            header.join(",")
        ));
    }
    if header != COLUMNS {
        return Err(format!(
            "{name}: row 1: expected the header {}, found {}",
            COLUMNS.join(","),
            header.join(",")
        ));
    }
    Ok(())
}

fn parse(name: &str, line: u64, record: &csv::StringRecord) -> Result<Row, String> {
    if record.len() != COLUMNS.len() {
        let column = COLUMNS.get(record.len()).unwrap_or(&"vz");
        let last = record.get(record.len().saturating_sub(1)).unwrap_or("");
        return Err(format!(
            "{name}: row {line}, column {column}: the row has {} values, not {}; the last is \
             \"{last}\"",
            record.len(),
            COLUMNS.len()
        ));
    }
    let body = record[0].parse::<u64>().map_err(|_| {
        format!(
            "{name}: row {line}, column body: \"{}\" is not a whole number",
            &record[0]
        )
    })?;
    let mut numbers = [0.0; 7];
    for (index, number) in numbers.iter_mut().enumerate() {
        let text = &record[index + 1];
        let parsed = text.parse::<f64>().ok().filter(|value| value.is_finite());
        *number = parsed.ok_or_else(|| {
            format!(
                "{name}: row {line}, column {}: \"{text}\" is not a finite number",
                COLUMNS[index + 1]
            )
        })?;
    }
    let [t, px, py, pz, vx, vy, vz] = numbers;
    Ok(Row {
        line,
        body,
        state: State::new(t, DVec3::new(px, py, pz), DVec3::new(vx, vy, vz)),
    })
}
