//! Writing records, as long as that goes well.

use super::record::{Record, TITLE};
use std::fmt;
use std::io::{self, BufWriter, Write};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Mutex, PoisonError};

/// The writer of a monitor's recording.
pub(in crate::monitor) struct RecordWriter {
    /// Never locked: a writer need not be shared between threads, a monitor may be.
    target: Mutex<BufWriter<Guarded>>,
    records: u64,
    /// The checksum of the last record.
    checksum: u32,
    /// The first thing that went wrong: nothing is written after it.
    failure: Option<io::Error>,
}

impl RecordWriter {
    pub(super) fn start(target: Box<dyn Write + Send>) -> io::Result<Self> {
        let mut target = BufWriter::new(Guarded(Some(target)));
        target.write_all(TITLE.as_bytes())?;
        Ok(Self {
            target: Mutex::new(target),
            records: 0,
            checksum: 0,
            failure: None,
        })
    }

    /// Writes a record; what goes wrong is kept for [`finish`](Self::finish).
    pub(in crate::monitor) fn write(&mut self, record: &Record) {
        if self.failure.is_some() {
            return;
        }
        let written = record.line(self.checksum).and_then(|(line, checksum)| {
            self.checksum = checksum;
            self.target().write_all(line.as_bytes())
        });
        match written {
            Ok(()) => self.records += 1,
            Err(error) => self.failure = Some(error),
        }
    }

    /// Hands on what is buffered.
    pub(super) fn flush(&mut self) -> io::Result<()> {
        match self.failure.take() {
            Some(error) => Err(error),
            None => self.target().flush(),
        }
    }

    fn target(&mut self) -> &mut BufWriter<Guarded> {
        self.target
            .get_mut()
            .unwrap_or_else(PoisonError::into_inner)
    }

    pub(super) const fn is_whole(&self) -> bool {
        self.failure.is_none()
    }

    /// Writes the end, and drops the writer; returns how many records came before the end.
    pub(super) fn finish(mut self) -> io::Result<u64> {
        let records = self.records;
        self.write(&Record::End);
        self.flush()?;
        self.target().get_mut().close()?;
        Ok(records)
    }
}

impl fmt::Debug for RecordWriter {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("RecordWriter")
            .field("records", &self.records)
            .field("failure", &self.failure)
            .finish_non_exhaustive()
    }
}

/// A caller's writer, whose panics are errors. It is dropped after one.
struct Guarded(Option<Box<dyn Write + Send>>);

impl Guarded {
    fn call<T>(&mut self, call: impl FnOnce(&mut dyn Write) -> io::Result<T>) -> io::Result<T> {
        let writer = self.0.as_mut().ok_or_else(panicked)?;
        let done = caught(|| call(writer));
        if done.is_err() {
            // It is the first panic that counts.
            let _ = self.close();
        }
        done?
    }

    /// Drops the writer.
    fn close(&mut self) -> io::Result<()> {
        let writer = self.0.take();
        caught(|| drop(writer))
    }
}

impl Write for Guarded {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let count = self.call(|writer| writer.write(bytes))?;
        if count > bytes.len() {
            return Err(io::Error::other("the writer wrote more than it was given"));
        }
        Ok(count)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.call(|writer| writer.flush())
    }
}

impl Drop for Guarded {
    fn drop(&mut self) {
        // There is nobody to tell.
        let _ = self.close();
    }
}

fn caught<T>(call: impl FnOnce() -> T) -> io::Result<T> {
    catch_unwind(AssertUnwindSafe(call)).map_err(|payload| {
        // Dropping it may panic again.
        std::mem::forget(payload);
        panicked()
    })
}

fn panicked() -> io::Error {
    io::Error::other("the writer panicked")
}
