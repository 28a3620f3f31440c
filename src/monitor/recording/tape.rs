//! Writing records, as long as that goes well.

use super::record::{Record, TITLE};
use std::fmt;
use std::io::{self, BufWriter, Write};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Mutex, PoisonError};

/// Where a monitor's recording goes.
pub(in crate::monitor) struct Tape {
    /// Never locked: a writer need not be shared between threads, a monitor may be.
    target: Mutex<BufWriter<Box<dyn Write + Send>>>,
    records: u64,
    /// The first thing that went wrong: nothing is written after it.
    failure: Option<io::Error>,
}

impl Tape {
    pub(super) fn start(target: Box<dyn Write + Send>) -> io::Result<Self> {
        let mut target = BufWriter::new(target);
        target.write_all(TITLE.as_bytes())?;
        Ok(Self {
            target: Mutex::new(target),
            records: 0,
            failure: None,
        })
    }

    /// Writes a record; what goes wrong is kept for [`finish`](Self::finish).
    pub(in crate::monitor) fn write(&mut self, record: &Record) {
        if self.failure.is_some() {
            return;
        }
        // What is recorded has taken effect: somebody else's writer must not keep it from being told.
        let write = || self.target().write_all(record.line()?.as_bytes());
        match catch_unwind(AssertUnwindSafe(write)) {
            Ok(Ok(())) => self.records += 1,
            Ok(Err(error)) => self.failure = Some(error),
            Err(_) => self.failure = Some(io::Error::other("the writer panicked")),
        }
    }

    /// Hands on what is buffered.
    pub(super) fn flush(&mut self) -> io::Result<()> {
        match self.failure.take() {
            Some(error) => Err(error),
            None => self.target().flush(),
        }
    }

    fn target(&mut self) -> &mut impl Write {
        self.target
            .get_mut()
            .unwrap_or_else(PoisonError::into_inner)
    }

    pub(super) const fn is_whole(&self) -> bool {
        self.failure.is_none()
    }

    /// Writes the end; returns how many records came before it.
    pub(super) fn finish(mut self) -> io::Result<u64> {
        let records = self.records;
        self.write(&Record::End { records });
        self.flush()?;
        Ok(records)
    }
}

impl fmt::Debug for Tape {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Tape")
            .field("records", &self.records)
            .field("failure", &self.failure)
            .finish_non_exhaustive()
    }
}
