//! A monitor on a thread of its own. Its contract is written at [`Live`].

mod handle;
mod report;
mod request;
mod stopped;
mod worker;

pub use handle::{Counts, Handle, Unsent};
pub use report::{LiveOptions, Report, ReportKind};
pub use request::{Request, Ticket};
pub use stopped::{Panicked, Stopped};

use super::Monitor;
use super::interrupt::Interrupt;
use crossbeam_channel::{Receiver, Sender, bounded};
use std::io;
use std::sync::Arc;
use std::thread::JoinHandle;
use worker::Worker;

/// A monitor on its own thread: requests go in, reports come out, and sending never blocks. Dropping it
/// stops the thread.
///
/// # Contract
///
/// - Both queues are bounded. When the one for requests is full, [`Handle::send`] returns
///   [`Unsent::Busy`] with the request handed back: it never blocks and never drops.
/// - Between two clock requests the latest plan for a body wins: a plan that the next one for that body
///   replaces altogether (see [`Request`]) is superseded without being tried. Clock requests merge only where
///   nothing lies between them. Batches are never taken apart, and nothing is merged across them, nor across a
///   question ([`Handle::what_if`], [`Handle::what_if_plans`]), whose answer is about all requests before it. Send
///   plans one by one if they need not take effect together: superseded plans in a batch cost as much as others.
/// - Every request sent is in the end applied, superseded or refused: [`Counts`] adds up. A change that is
///   applied is not reported on its own: it was, once a later request is. A late plan or state is, if it is
///   followed from later on than it says: [`ReportKind::Late`].
/// - Reports come in order, [numbered](Report::sequence) without a gap, and each goes to one reader. A reader that
///   stalls stalls the monitor, not the senders: [`Handle::complete_until`] then stands still.
/// - After [`Live::stop_requests`] all that was sent before is carried out, and then [`Live::reports`] ends. One
///   reader that goes on to that end, on whatever thread, has every report in order: none is left for `shutdown`.
/// - A tick works within [`LiveOptions::budget`] at a time. While no requests wait and not all of the lookahead is known,
///   the thread ticks at the clock as it stands; if that fails, [`ReportKind::Stuck`] says why. So it does after `spawn`,
///   unless the monitor has had its first tick: requests that come later are then seen by another tick, and events and
///   ids of encounters may differ from those of a [`Monitor`] that is given the same requests.
/// - [`Live::shutdown`] returns the monitor, every report that was not read and every request that was not
///   applied. It takes under 100 ms, the step at hand (one budget and one request's work); longer where
///   tens of thousands of pairs stay near each other: these are solved and read first, which the budget
///   [does not count](super::Budget::Time). Twenty thousand pairs of balls take some tenths of a second, ten thousand pairs
///   of turning clusters up to two. `shutdown` reads as well: another reader that goes on meanwhile takes
///   a part of the last reports. Each of the two has its part in order; only the numbers put them together.
/// - The thread shares large batches, and the reading of many encounters, with the threads of the global rayon pool
///   (feature `parallel`). If all of these wait for reports or a shutdown at once, none comes: leave one of them free.
/// - A panic inside the thread comes back as an error, with the
///   monitor as the last whole request left it.
///
/// ```
/// use nearmiss::glam::DVec3;
/// use nearmiss::live::{LiveOptions, ReportKind};
/// use nearmiss::{AlertLevel, Body, Command, Monitor, Scene, Trajectory};
///
/// let monitor = Monitor::new(Scene::new(), 0.0, 10.0, &[AlertLevel::at(2.0)])?;
/// let live = monitor.spawn(LiveOptions::default())?;
/// let game = live.handle();
/// game.send(Command::Insert(Body::new(Trajectory::at_rest(DVec3::ZERO)?)))?;
/// game.advance(0.5)?;
/// while !matches!(live.reports().recv()?.kind, ReportKind::Ticked { now, .. } if now == 0.5) {}
/// // In the end: all that is left, to the last report.
/// live.stop_requests();
/// for report in live.reports() {
///     println!("{report:?}");
/// }
/// let stopped = live.shutdown()?;
/// assert_eq!(stopped.monitor.scene().len(), 1);
/// assert!(stopped.reports.is_empty());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
#[must_use = "the monitor stops when it is dropped"]
pub struct Live {
    handle: Handle,
    reports: Receiver<Report>,
    /// Dropped to stop the thread; a message has it look whether requests were stopped.
    stop: Option<Sender<()>>,
    /// Ends the current tick early.
    interrupt: Arc<Interrupt>,
    thread: Option<JoinHandle<Result<Stopped, Box<Panicked>>>>,
}

impl Monitor {
    /// Moves the monitor to a thread of its own, under the contract written at [`Live`].
    ///
    /// # Errors
    ///
    /// An error of the system if it gives no thread; `InvalidInput` if a queue is to hold nothing, or more than
    /// [`LiveOptions::MAX`].
    pub fn spawn(mut self, options: LiveOptions) -> io::Result<Live> {
        for (what, room) in [("requests", options.requests), ("reports", options.reports)] {
            if !(1..=LiveOptions::MAX).contains(&room) {
                let problem = format!("{room} {what} cannot wait: 1 to {} can", LiveOptions::MAX);
                return Err(io::Error::new(io::ErrorKind::InvalidInput, problem));
            }
        }
        let (requests_in, requests) = bounded(options.requests);
        let (reports_in, reports) = bounded(options.reports);
        let (stop, stopped) = bounded(1);
        let handle = Handle::new(requests_in, self.now(), self.complete_until());
        let interrupt = Arc::new(Interrupt::default());
        self.interrupt = Some(Arc::clone(&interrupt));
        let worker = Worker::new(
            self,
            (requests, reports_in, stopped),
            Arc::clone(handle.shared()),
            options,
        );
        let thread = std::thread::Builder::new()
            .name("nearmiss".to_owned())
            .spawn(move || worker.run())?;
        Ok(Live {
            handle,
            reports,
            stop: Some(stop),
            interrupt,
            thread: Some(thread),
        })
    }
}

impl Live {
    /// Returns a handle to send requests with; cheap to clone, usable from any thread.
    #[must_use]
    pub fn handle(&self) -> Handle {
        self.handle.clone()
    }

    /// Returns the queue of reports, also for a `select!`. Its clones share the reports: each goes to one. The
    /// queue ends when the thread has ended and all is read: after [`stop_requests`](Self::stop_requests), say.
    #[must_use]
    pub const fn reports(&self) -> &Receiver<Report> {
        &self.reports
    }

    /// Takes no more requests, and returns at once: what is sent from now on comes back as [`Unsent::Closed`].
    ///
    /// All requests sent before are carried out, and the last tick is caught up with. Then the thread ends, and
    /// [`reports`](Self::reports) with its last report.
    pub fn stop_requests(&self) {
        self.handle.shared().close();
        if let Some(stop) = &self.stop {
            // If there is no room, a message is waiting already.
            let _ = stop.try_send(());
        }
    }

    /// Stops the thread at once, and returns all that it leaves.
    ///
    /// # Errors
    ///
    /// [`Panicked`], if the thread did.
    pub fn shutdown(mut self) -> Result<Stopped, Box<Panicked>> {
        let mut outcome = self.join();
        let (reports, counts) = match &mut outcome {
            Ok(stopped) => (&mut stopped.reports, &mut stopped.counts),
            Err(panicked) => (&mut panicked.reports, &mut panicked.counts),
        };
        // Those that have left the thread come first.
        reports.splice(..0, self.reports.try_iter());
        *counts = self.handle.counts();
        outcome
    }

    fn join(&mut self) -> Result<Stopped, Box<Panicked>> {
        self.interrupt.request();
        self.stop = None;
        match self.thread.take().map(JoinHandle::join) {
            Some(Ok(outcome)) => outcome,
            // The worker catches its own panics; this is one while it was cleaning up.
            Some(Err(payload)) => Err(Panicked::lost(worker::message_of(payload.as_ref()))),
            None => Err(Panicked::lost("it was joined before".to_owned())),
        }
    }
}

impl Drop for Live {
    fn drop(&mut self) {
        if self.thread.is_some() {
            drop(self.join());
        }
    }
}

#[cfg(test)]
mod tests;
