//! The names of bodies: whole numbers, or any text.

use crate::terminal::quoted;
use nearmiss::{Crowd, Error};
use std::borrow::Cow;
use std::collections::HashMap;
use std::ops::Range;

/// The labels of all bodies of a file. While all are whole numbers from 0 on they are read as numbers; as soon as
/// one is not, all are names, in the order of their first appearance.
#[derive(Debug, Default)]
pub(crate) struct Labels {
    /// None while all labels are numbers.
    names: Vec<String>,
    /// By name.
    places: HashMap<String, usize>,
    /// Numbers that are not written in the usual way, in the order of the rows.
    spellings: Vec<Spelling>,
}

/// A number with a sign or zeros in front, in rows that follow each other.
#[derive(Debug)]
struct Spelling {
    rows: Range<usize>,
    text: String,
}

impl Labels {
    /// Returns the tag of a label: its number, or the place of its name. `tags` are those of all rows before; they
    /// change with the first name. An error says what is wrong with the label.
    pub(crate) fn tag<'t>(
        &mut self,
        label: &[u8],
        mut tags: impl ExactSizeIterator<Item = &'t mut u64> + DoubleEndedIterator,
    ) -> Result<u64, String> {
        let label = label.trim_ascii();
        let place = if self.names.is_empty() {
            if let Some(number) = number(label) {
                if label.len() > 1 && matches!(label[0], b'0' | b'+') {
                    self.note_spelling(label, tags.len());
                }
                return Ok(number);
            }
            let name = check(label)?;
            self.name_all(tags);
            self.place(name)
        } else {
            // Rows of a body are together.
            let previous = tags.next_back().map(|tag| *tag);
            if let Some(previous) = previous
                && self
                    .name(previous)
                    .is_some_and(|name| name.as_bytes() == label)
            {
                return Ok(previous);
            }
            self.place(check(label)?)
        };
        Ok(place as u64)
    }

    fn note_spelling(&mut self, label: &[u8], row: usize) {
        match self.spellings.last_mut() {
            Some(last) if last.rows.end == row && last.text.as_bytes() == label => {
                last.rows.end += 1;
            }
            _ => self.spellings.push(Spelling {
                rows: row..row + 1,
                text: String::from_utf8_lossy(label).into_owned(),
            }),
        }
    }

    /// Takes the numbers of all rows for names, as they are written.
    fn name_all<'t>(&mut self, tags: impl Iterator<Item = &'t mut u64>) {
        let spellings = std::mem::take(&mut self.spellings);
        let mut spellings = spellings.iter().peekable();
        let mut previous = None;
        for (row, tag) in tags.enumerate() {
            while spellings.next_if(|one| one.rows.end <= row).is_some() {}
            let spelling = spellings.peek().filter(|one| one.rows.contains(&row));
            let label = (*tag, spelling.map(|one| &one.text));
            *tag = match previous {
                Some((same, place)) if same == label => place,
                _ => match label {
                    (_, Some(text)) => self.place(text) as u64,
                    (number, None) => self.place(&number.to_string()) as u64,
                },
            };
            previous = Some((label, *tag));
        }
    }

    fn place(&mut self, name: &str) -> usize {
        if let Some(&place) = self.places.get(name) {
            return place;
        }
        let place = self.names.len();
        self.names.push(name.to_owned());
        self.places.insert(name.to_owned(), place);
        place
    }

    /// Returns a body's name, or `None` while all labels are numbers.
    pub(crate) fn name(&self, tag: u64) -> Option<&str> {
        let place = usize::try_from(tag).ok()?;
        self.names.get(place).map(String::as_str)
    }

    /// Returns a body's name as it is told: in quotation marks unless it is a number.
    pub(crate) fn told(&self, tag: u64) -> String {
        self.name(tag)
            .map_or_else(|| tag.to_string(), |name| quoted(name.as_bytes()))
    }

    /// Returns a body's name as a value of a CSV file.
    pub(crate) fn value(&self, tag: u64) -> Cow<'_, str> {
        match self.name(tag) {
            None => tag.to_string().into(),
            Some(name) if name.contains([',', '"']) => {
                format!("\"{}\"", name.replace('"', "\"\"")).into()
            }
            Some(name) => name.into(),
        }
    }

    /// Returns an error of the library with the name of its body, in terms of the options of `screen`.
    pub(crate) fn explain(&self, error: &Error) -> String {
        match error {
            Error::InBody { body, error, .. } => {
                let name = self.told(*body);
                match **error {
                    Error::TooFar { .. } => format!(
                        "body {name}: --window reaches too far beyond its rows: check the window, and rows that are \
                         almost at one time"
                    ),
                    ref error => format!("body {name}: {error}"),
                }
            }
            Error::TooCrowded { crowd, .. } => format!(
                "too many pairs may be in conflict{}: narrow --window, or give a smaller --margin or --radius",
                crowd.map_or(String::new(), |crowd| self.told_crowd(&crowd))
            ),
            error => error.to_string(),
        }
    }

    fn told_crowd(&self, crowd: &Crowd) -> String {
        let (name, others) = (self.told(crowd.tag), crowd.others);
        let plural = if others == 1 { "" } else { "s" };
        format!(
            "; body {name} comes near {others} other{plural}, to most at {:?} s",
            crowd.time
        )
    }
}

fn number(label: &[u8]) -> Option<u64> {
    std::str::from_utf8(label).ok()?.parse().ok()
}

/// A name is text on one line, without what a terminal obeys.
fn check(label: &[u8]) -> Result<&str, String> {
    let Ok(text) = std::str::from_utf8(label) else {
        return Err(format!(
            "{} is no text in UTF-8; save the file in UTF-8",
            quoted(label)
        ));
    };
    if text.is_empty() {
        return Err("empty; give the body a whole number or a name".to_owned());
    }
    let turns = |character| matches!(character, '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
    if text.contains(|character: char| character.is_control() || turns(character)) {
        return Err(format!(
            "{} has characters that do not print; take them out of the name",
            quoted(label)
        ));
    }
    Ok(text)
}
