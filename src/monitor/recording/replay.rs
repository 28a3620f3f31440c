//! Replays of recordings.

use super::record::{PREFIX, Record, RecordingError, TITLE};
use crate::error::Error;
use crate::monitor::{Event, Monitor};
use std::io::{BufRead, Read};

/// The replay of a recording, tick by tick: its events are those of the recorded monitor, bit for bit. A
/// tick that ran out of its budget of time stops in the replay where it stopped then, however fast the
/// machine.
///
/// ```
/// use nearmiss::recording::Replay;
/// use nearmiss::{AlertLevel, Monitor, Scene};
/// # #[derive(Clone, Default)]
/// # struct SharedBytes(std::sync::Arc<std::sync::Mutex<Vec<u8>>>);
/// # impl std::io::Write for SharedBytes {
/// #     fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
/// #         self.0.lock().unwrap().write(bytes)
/// #     }
/// #     fn flush(&mut self) -> std::io::Result<()> { Ok(()) }
/// # }
/// # let file = SharedBytes::default();
/// let mut monitor = Monitor::new(Scene::new(), 0.0, 10.0, &[AlertLevel::at(2.0)])?;
/// monitor.start_recording(file.clone())?; // anything that can be written to
/// let mut said = Vec::new();
/// monitor.advance(0.5, &mut said)?;
/// monitor.stop_recording()?;
///
/// # let file = file.0.lock().unwrap().clone();
/// let mut replay = Replay::open(&file[..])?;
/// let mut again = Vec::new();
/// while let Some(now) = replay.tick(&mut again)? {
///     println!("{now} s: {} events so far", again.len());
/// }
/// assert_eq!(said, again);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Format, version 7
///
/// A text file. The first line is `nearmiss recording 7`. Each further line is one record:
///
/// ```text
/// LENGTH CHECKSUM JSON
/// ```
///
/// LENGTH is the number of bytes of JSON. CHECKSUM is the CRC-32 (IEEE 802.3) of the JSON of all records
/// up to this one, one after the other: a line that is missing, doubled or not in its place is an error
/// right there. Both have eight hexadecimal digits. JSON is one object with one key, the kind of record, or
/// the kind as a string where there is no content:
///
/// | kind | content |
/// |---|---|
/// | `begin` | the monitor: scene with its slots, clock, lookahead, levels, encounters; first and only once |
/// | `apply` | commands that were applied together, or one alone |
/// | `track` | the states of a call of [`Monitor::track`](crate::Monitor::track) |
/// | `revision_threshold`, `history`, `max_spans` | settings |
/// | `skip_to` | the time to which the clock was set ahead |
/// | `tick` | the clock, up to when everything was known after it, and the work done in it (as a [budget](crate::Budget::Work) counts it) |
/// | `anew` | a tick failed, and all is looked at anew |
/// | `close` | the monitor was closed |
/// | `end` | nothing follows; a recording without one was cut short |
///
/// Numbers are the shortest digits that read back as the same bits. Segments are sixteen numbers:
/// start, end, origin, the control points 1 to 3 relative to it, extent, error.
#[derive(Debug)]
pub struct Replay<R> {
    source: R,
    /// Beginning of the next line.
    offset: u64,
    /// The checksum of the last record.
    checksum: u32,
    state: ReplayState,
    monitor: Monitor,
}

/// State of a replay.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum ReplayState {
    Open,
    /// State after the monitor was closed: only the end may follow.
    Closed,
    /// State after the end was read.
    Ended,
    /// State after an error.
    Failed,
}

impl<R: BufRead> Replay<R> {
    /// Reads the beginning.
    ///
    /// # Errors
    ///
    /// [`RecordingError`], if the file is no recording, is damaged, or has another version.
    pub fn open(mut source: R) -> Result<Self, RecordingError> {
        let mut title = Vec::new();
        source
            .by_ref()
            .take(TITLE.len() as u64)
            .read_to_end(&mut title)?;
        if title != TITLE.as_bytes() {
            let found = String::from_utf8_lossy(&title).into_owned();
            return Err(RecordingError::NotARecording { found });
        }
        let offset = TITLE.len() as u64;
        let (record, checksum, length) = read(&mut source, offset, 0)?;
        let Record::Begin(snapshot) = record else {
            return Err(damaged(offset, "it does not begin with a monitor"));
        };
        let monitor = Monitor::restore(*snapshot).map_err(|error| match error {
            Error::Snapshot { problem } => damaged(offset, problem),
            error => RecordingError::Refused { offset, error },
        })?;
        Ok(Self {
            source,
            offset: offset + length,
            checksum,
            state: ReplayState::Open,
            monitor,
        })
    }

    /// Returns the monitor after the last replayed tick.
    pub const fn monitor(&self) -> &Monitor {
        &self.monitor
    }

    /// Returns the monitor, to go on with.
    pub fn into_monitor(self) -> Monitor {
        self.monitor
    }

    /// Replays up to the end of the next tick, and appends its events. Returns its time (s), or `None` at the
    /// end of the recording, with the events of closing if the monitor was closed.
    ///
    /// # Errors
    ///
    /// [`RecordingError`], with the place. Everything before that place has been replayed. Nothing after it
    /// can be.
    pub fn tick(&mut self, events: &mut Vec<Event>) -> Result<Option<f64>, RecordingError> {
        let done = self.go_on(events);
        if done.is_err() {
            self.state = ReplayState::Failed;
        }
        done
    }

    fn go_on(&mut self, events: &mut Vec<Event>) -> Result<Option<f64>, RecordingError> {
        loop {
            let offset = self.offset;
            match self.state {
                ReplayState::Open | ReplayState::Closed => {}
                ReplayState::Ended => return Ok(None),
                ReplayState::Failed => {
                    return Err(damaged(offset, "it could not be read up to here"));
                }
            }
            let (record, checksum, length) = read(&mut self.source, offset, self.checksum)?;
            if let Record::End = record {
                if !self.source.fill_buf()?.is_empty() {
                    return Err(damaged(offset + length, "something follows its end"));
                }
                self.state = ReplayState::Ended;
                continue;
            }
            if self.state == ReplayState::Closed {
                return Err(damaged(offset, "it goes on after the monitor was closed"));
            }
            self.offset += length;
            self.checksum = checksum;
            let done = self.repeat(record, offset, events)?;
            if let Some(now) = done {
                return Ok(Some(now));
            }
        }
    }

    /// Applies a record; returns the time of a tick.
    fn repeat(
        &mut self,
        record: Record,
        offset: u64,
        events: &mut Vec<Event>,
    ) -> Result<Option<f64>, RecordingError> {
        let monitor = &mut self.monitor;
        let refused = |error| RecordingError::Refused { offset, error };
        match record {
            Record::Begin(_) | Record::End => {
                return Err(damaged(offset, "it begins or ends twice"));
            }
            Record::Track(now, states) => monitor.track(now, states).map_err(refused)?,
            Record::Apply(commands) => drop(monitor.apply(commands).map_err(refused)?),
            Record::RevisionThreshold(threshold) => {
                monitor.set_revision_threshold(threshold).map_err(refused)?
            }
            Record::History(history) => monitor.set_history(history).map_err(refused)?,
            Record::MaxSpans(limit) => monitor.set_max_spans(limit),
            Record::SkipTo(now) => monitor.skip_to(now).map_err(refused)?,
            Record::Tick { now, known, .. } => {
                monitor.advance_to(now, known, events).map_err(refused)?;
                return Ok(Some(now));
            }
            Record::Anew => monitor.forget_search().map_err(refused)?,
            Record::Close => {
                monitor.end_all(events);
                self.state = ReplayState::Closed;
            }
        }
        Ok(None)
    }
}

/// Reads the line that begins at `offset`, after a record with the checksum `before`. Returns the record, its
/// checksum and the length of the line in bytes.
fn read(
    source: &mut impl BufRead,
    offset: u64,
    before: u32,
) -> Result<(Record, u32, u64), RecordingError> {
    let mut prefix = Vec::new();
    let wanted = PREFIX as u64;
    source.by_ref().take(wanted).read_to_end(&mut prefix)?;
    if prefix.len() < PREFIX {
        return Err(RecordingError::Truncated { offset });
    }
    let (length, checksum) = numbers(&prefix)
        .ok_or_else(|| damaged(offset, "it does not begin with a length and a checksum"))?;
    let mut line = Vec::new();
    let wanted = u64::from(length) + 1;
    source.by_ref().take(wanted).read_to_end(&mut line)?;
    if (line.len() as u64) < wanted {
        return Err(RecordingError::Truncated { offset });
    }
    if line.pop() != Some(b'\n') {
        return Err(damaged(offset, "its length is wrong"));
    }
    let record = Record::parse(&line, checksum, before);
    let record = record.map_err(|problem| RecordingError::Damaged { offset, problem })?;
    Ok((record, checksum, PREFIX as u64 + wanted))
}

/// Returns length and checksum: eight hexadecimal digits and a space, twice.
fn numbers(prefix: &[u8]) -> Option<(u32, u32)> {
    let text = std::str::from_utf8(prefix).ok()?;
    let number = |digits: &str| {
        let plain = |digit: u8| digit.is_ascii_digit() || (b'a'..=b'f').contains(&digit);
        digits
            .bytes()
            .all(plain)
            .then(|| u32::from_str_radix(digits, 16).ok())?
    };
    let spaces = text.get(8..9)? == " " && text.get(17..18)? == " ";
    spaces.then_some((number(text.get(..8)?)?, number(text.get(9..17)?)?))
}

fn damaged(offset: u64, problem: &str) -> RecordingError {
    RecordingError::Damaged {
        offset,
        problem: problem.to_owned(),
    }
}
