//! The records of a recording, each a line.

use crate::error::Error;
use crate::id::BodyId;
use crate::monitor::{Command, RevisionThreshold, Snapshot};
use crate::scene::BodyState;
use serde::{Deserialize, Serialize};
use std::{fmt, io};

/// The first line; the number is the version of the format.
pub(super) const TITLE: &str = "nearmiss recording 7\n";

/// Length and checksum, and the spaces after them.
pub(super) const PREFIX: usize = 18;

/// One change of a monitor, or the beginning or the end of a recording.
#[derive(Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub(in crate::monitor) enum Record {
    /// The monitor at the beginning. Boxed: the others are small.
    Begin(Box<Snapshot>),
    Apply(Vec<Command>),
    Track(f64, Vec<(BodyId, BodyState)>),
    RevisionThreshold(RevisionThreshold),
    /// Time, s.
    History(#[serde(with = "crate::json_number")] f64),
    MaxSpans(#[serde(with = "crate::saved_limit")] usize),
    SkipTo(f64),
    Tick {
        now: f64,
        known: f64,
        work: u64,
    },
    /// A tick failed, after which all is looked at anew.
    Anew,
    Close,
    End,
}

/// The reason why a recording cannot be replayed, or not to its end. Offsets are in bytes from the beginning
/// of the file, to the line that is at fault.
#[derive(thiserror::Error)]
#[non_exhaustive]
pub enum RecordingError {
    /// The beginning is not that of a recording of the version that is read.
    #[error("not a recording of the version that is read, {:?}: it begins with {found:?}", TITLE.trim_end())]
    NotARecording {
        /// First line, as far as it is text.
        found: String,
    },
    /// The recording ends before its end record.
    #[error("byte {offset}: the recording was cut short")]
    Truncated {
        /// Beginning of the line that is cut or missing.
        offset: u64,
    },
    /// A line is not what was written there: its length, its checksum or what it says is wrong.
    #[error("byte {offset}: the recording is damaged: {problem}")]
    Damaged {
        /// Beginning of the line.
        offset: u64,
        /// Description of the damage.
        problem: String,
    },
    /// A record was refused by the monitor.
    #[error("byte {offset}: {error}")]
    Refused {
        /// Beginning of the line.
        offset: u64,
        /// Error of the monitor.
        #[source]
        error: Error,
    },
    /// The file cannot be read.
    #[error(transparent)]
    Io(#[from] io::Error),
}

/// A program that unwraps an error, or returns one from `main`, prints this: the sentence of `Display`.
impl fmt::Debug for RecordingError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, f)
    }
}

impl Record {
    /// Returns the line, with its prefix and its end, and its checksum; `before` is that of the record before.
    pub(super) fn line(&self, before: u32) -> io::Result<(String, u32)> {
        let json = serde_json::to_string(self)?;
        let length = u32::try_from(json.len());
        let length = length.map_err(|_| io::Error::other("a record of 4 GiB or more"))?;
        let checksum = checksum(before, json.as_bytes());
        let line = format!("{length:08x} {checksum:08x} {json}\n");
        Ok((line, checksum))
    }

    /// Returns the record in the body of a line, if its checksum is that of this place.
    pub(super) fn parse(json: &[u8], expected: u32, before: u32) -> Result<Self, String> {
        if checksum(before, json) != expected {
            return Err("its checksum is not that of this record in this place".to_owned());
        }
        serde_json::from_slice(json).map_err(|error| error.to_string())
    }
}

/// Returns the CRC-32 of all records up to this one, from that of all before it.
fn checksum(before: u32, json: &[u8]) -> u32 {
    let mut hasher = crc32fast::Hasher::new_with_initial(before);
    hasher.update(json);
    hasher.finalize()
}
