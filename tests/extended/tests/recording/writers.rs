//! Writers that fail, or panic.

use super::*;
use std::panic::{AssertUnwindSafe, catch_unwind, panic_any};
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};

/// Where a writer goes wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Fault {
    Write,
    Flush,
    Drop,
    /// It says that it wrote more than it was given.
    TooMuch,
}

/// A panic that panics again when it is dropped.
struct Again;

impl Drop for Again {
    fn drop(&mut self) {
        panic!("broken on purpose, again");
    }
}

/// A writer that panics, in a call of one kind and whenever it is dropped after that, once it is told to.
struct Broken {
    fault: Fault,
    is_on: Arc<AtomicBool>,
    has_panicked: bool,
    /// Calls after the first panic.
    late_calls: Arc<AtomicU32>,
}

impl Broken {
    fn new(fault: Fault) -> (Self, Arc<AtomicBool>, Arc<AtomicU32>) {
        let (is_on, late_calls) = (Arc::default(), Arc::default());
        let broken = Self {
            fault,
            is_on: Arc::clone(&is_on),
            has_panicked: false,
            late_calls: Arc::clone(&late_calls),
        };
        (broken, is_on, late_calls)
    }

    fn call(&mut self, kind: Fault) {
        if self.has_panicked {
            self.late_calls.fetch_add(1, Ordering::Relaxed);
        }
        if self.fault == kind && self.is_on.load(Ordering::Relaxed) {
            self.has_panicked = true;
            panic_any(Again);
        }
    }
}

impl Write for Broken {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.call(Fault::Write);
        let excess = self.fault == Fault::TooMuch && self.is_on.load(Ordering::Relaxed);
        Ok(bytes.len() + usize::from(excess))
    }

    fn flush(&mut self) -> io::Result<()> {
        self.call(Fault::Flush);
        Ok(())
    }
}

impl Drop for Broken {
    fn drop(&mut self) {
        if self.has_panicked {
            panic!("broken on purpose, when dropped");
        }
        self.call(Fault::Drop);
    }
}

const FAULTS: [Fault; 4] = [Fault::Write, Fault::Flush, Fault::Drop, Fault::TooMuch];

/// Whatever a writer does when it is begun, ended, left or dropped with, it stays with the recording.
#[test]
fn a_broken_writer_never_reaches_the_caller() {
    for fault in FAULTS {
        let mut rng = rng(13);
        let mut monitor = monitor(&mut rng, 6, 5.0);
        let begin = |monitor: &mut Monitor| {
            let (broken, is_on, late_calls) = Broken::new(fault);
            monitor.start_recording(broken).unwrap();
            is_on.store(true, Ordering::Relaxed);
            late_calls
        };
        // Broken from the beginning.
        let (broken, is_on, late_calls) = Broken::new(fault);
        is_on.store(true, Ordering::Relaxed);
        let begun = monitor.start_recording(broken);
        assert_eq!(begun.is_err(), fault != Fault::Drop, "{fault:?}");
        assert_eq!(monitor.is_recording(), fault == Fault::Drop);
        // Given up for another one.
        let later = [late_calls, begin(&mut monitor)];
        monitor.start_recording(Memory::default()).unwrap();
        assert!(monitor.is_recording());
        // Ended.
        let ended = begin(&mut monitor);
        live_on(&mut monitor, &mut rng, &mut Vec::new());
        let error = monitor.stop_recording().unwrap_err().to_string();
        assert!(error.starts_with("the writer "), "{fault:?}: {error}");
        assert!(!monitor.is_recording());
        // Closed: the scene and the last events come out.
        let scene = monitor.scene().clone();
        let closed = begin(&mut monitor);
        let mut events = Vec::new();
        monitor.advance(monitor.now(), &mut Vec::new()).unwrap();
        let expected = monitor.encounters().count();
        let left = monitor.close(&mut events);
        assert!(left.bodies().eq(scene.bodies()));
        assert_eq!(events.len(), expected);
        for calls in later.iter().chain([&ended, &closed]) {
            assert_eq!(calls.load(Ordering::Relaxed), 0, "{fault:?}");
        }
    }
}

/// A monitor that is dropped takes its writer with it, also while a panic is under way.
#[test]
fn a_broken_writer_is_dropped_with_its_monitor() {
    for fault in FAULTS {
        for panics in [false, true] {
            let mut monitor = monitor(&mut rng(14), 6, 5.0);
            let (broken, is_on, _) = Broken::new(fault);
            monitor.start_recording(broken).unwrap();
            monitor.advance(0.1, &mut Vec::new()).unwrap();
            is_on.store(true, Ordering::Relaxed);
            let end = catch_unwind(AssertUnwindSafe(move || {
                let _monitor = monitor;
                if panics {
                    panic_any("the caller's own");
                }
            }));
            let told = end.map_err(|payload| payload.downcast_ref() == Some(&"the caller's own"));
            assert_eq!(told, if panics { Err(true) } else { Ok(()) }, "{fault:?}");
        }
    }
}

#[cfg(feature = "live")]
#[test]
fn a_broken_writer_does_not_stop_a_live_monitor() {
    use nearmiss::live::LiveOptions;
    for fault in FAULTS {
        for is_dropped in [false, true] {
            let mut monitor = monitor(&mut rng(15), 6, 5.0);
            let (broken, is_on, _) = Broken::new(fault);
            monitor.start_recording(broken).unwrap();
            let live = monitor.spawn(LiveOptions::default()).unwrap();
            is_on.store(true, Ordering::Relaxed);
            live.handle().advance(0.5).unwrap();
            if is_dropped {
                drop(live);
            } else {
                let mut monitor = live.shutdown().unwrap().monitor;
                assert!(monitor.stop_recording().is_err(), "{fault:?}");
            }
        }
    }
}

#[test]
fn a_file_that_fails_disturbs_nothing() {
    struct Full(usize);
    impl Write for Full {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            self.0 = self
                .0
                .checked_sub(bytes.len())
                .ok_or(io::ErrorKind::StorageFull)?;
            Ok(bytes.len())
        }

        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }
    let mut rng = rng(9);
    let mut monitor = monitor(&mut rng, 6, 5.0);
    assert!(monitor.start_recording(Full(100)).is_err());
    monitor.start_recording(Full(200_000)).unwrap();
    while monitor.is_recording() {
        live_on(&mut monitor, &mut rng, &mut Vec::new());
    }
    live_on(&mut monitor, &mut rng, &mut Vec::new());
    let error = monitor.stop_recording().unwrap_err();
    assert_eq!(error.kind(), io::ErrorKind::StorageFull);
}

/// What is recorded takes effect, and is told, though the recording cannot go on.
#[test]
fn a_writer_that_panics_disturbs_nothing() {
    struct Late(usize);
    impl Write for Late {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            self.0 += bytes.len();
            assert!(self.0 < 200_000, "broken on purpose");
            Ok(bytes.len())
        }

        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }
    let (mut rngs, mut said) = ([rng(9), rng(9)], [Vec::new(), Vec::new()]);
    let mut recorded = monitor(&mut rngs[0], 6, 5.0);
    let mut plain = monitor(&mut rngs[1], 6, 5.0);
    recorded.start_recording(Late(0)).unwrap();
    while recorded.is_recording() {
        live_on(&mut recorded, &mut rngs[0], &mut said[0]);
        live_on(&mut plain, &mut rngs[1], &mut said[1]);
    }
    assert_eq!(text(&said[0]), text(&said[1]));
    let error = recorded.stop_recording().unwrap_err();
    assert_eq!(error.to_string(), "the writer panicked");
}
