//! Recordings of a monitor's inputs, from which a replay gives its events again. See
//! [`Monitor::start_recording`] for the content, and [`Replay`] for the format.

mod record;
mod replay;
mod writer;

pub(in crate::monitor) use record::Record;
pub use record::RecordingError;
pub use replay::Replay;
pub(in crate::monitor) use writer::RecordWriter;

use super::Monitor;
use std::io::{self, Write};

impl Monitor {
    /// Writes down everything from now on, in the format that [`Replay`] reads. (Feature `recording`.) A recording under
    /// way is given up: [stop](Self::stop_recording) it first, or its replay ends with an error.
    ///
    /// First comes the monitor as it is, then everything that changes it, as it is applied (a live
    /// monitor's requests after they were coalesced), and for each tick how far it came. A told state takes about
    /// 190 bytes, one with a spin 360.
    ///
    /// # Errors
    ///
    /// The error of writing the beginning. Later errors are returned by
    /// [`stop_recording`](Self::stop_recording), and do not disturb the monitor.
    ///
    /// A writer that panics, in `write`, in `flush` or when it is dropped, is one that fails: no call of the
    /// monitor panics for it. The writer is dropped at once.
    pub fn start_recording(&mut self, target: impl Write + Send + 'static) -> io::Result<()> {
        self.recorder = None;
        let mut recorder = RecordWriter::start(Box::new(target))?;
        recorder.write(&Record::Begin(Box::new(self.snapshot())));
        recorder.flush()?;
        self.recorder = Some(recorder);
        Ok(())
    }

    /// Ends the recording and drops its writer; returns how many records it has, or `None` if there is none: a
    /// [restored](Self::restore) monitor has none, whatever the one that it continues had.
    ///
    /// # Errors
    ///
    /// The first error of writing the recording. The records before it are good.
    pub fn stop_recording(&mut self) -> io::Result<Option<u64>> {
        self.recorder.take().map(RecordWriter::finish).transpose()
    }

    /// Writes a record, if a recording is under way.
    pub(in crate::monitor) fn write_down(&mut self, record: impl FnOnce() -> Record) {
        if let Some(recorder) = &mut self.recorder {
            recorder.write(&record());
        }
    }

    /// Returns true if a recording is under way and has met no error.
    #[must_use]
    pub fn is_recording(&self) -> bool {
        self.recorder.as_ref().is_some_and(RecordWriter::is_whole)
    }
}
