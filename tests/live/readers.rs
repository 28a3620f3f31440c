//! Reports that are read on a thread of their own, while the monitor is stopped.

use super::*;

/// Their numbers.
fn numbers(reports: &[Report]) -> Vec<u64> {
    reports.iter().map(|report| report.sequence).collect()
}

/// Whoever reads what a shutdown leaves, no report is lost or comes twice, each reader has its part in
/// order, and put together by their numbers they are what one reader would have had.
#[test]
fn two_readers_at_a_shutdown_share_the_reports() {
    let mut both = 0;
    for seed in 0..60 {
        let (monitor, _) = crowd(seed, 60);
        let options = LiveOptions::default().with_reports(64);
        let live = monitor.spawn(options).unwrap();
        let reader = live.reports().clone();
        let reader = std::thread::spawn(move || reader.iter().collect::<Vec<Report>>());
        for tick in 1..=10 {
            let _ = live.handle().advance(f64::from(tick)).unwrap();
        }
        while live.handle().now() < 5.0 {
            std::thread::yield_now();
        }
        let stopped = live.shutdown().unwrap();
        let read = reader.join().unwrap();
        both += usize::from(!read.is_empty() && !stopped.reports.is_empty());
        for part in [&read, &stopped.reports] {
            assert!(numbers(part).is_sorted(), "{seed}");
        }
        let mut all = [read, stopped.reports].concat();
        all.sort_by_key(|report| report.sequence);
        assert!(numbers(&all).into_iter().eq(0..all.len() as u64), "{seed}");
        let mut ledger = Ledger::default();
        ledger.read_all(&all);
        ledger.finish(stopped.monitor);
    }
    assert!(both > 0);
}

/// A reader that goes on to the end has all there is, and nothing is left for the shutdown.
#[test]
fn orders_are_stopped_and_reports_read_to_the_end() {
    // All of a tick at once, or as little as can be: then much is left after the last order.
    for (seed, budget) in (0..20).zip([Duration::MAX, Duration::ZERO].into_iter().cycle()) {
        let (monitor, ids) = crowd(seed, 60);
        let options = LiveOptions::default().with_reports(1).with_budget(budget);
        let live = monitor.spawn(options).unwrap();
        let (handle, reader) = (live.handle(), live.reports().clone());
        let mut rng = rng(seed);
        let _ = handle.advance(0.0).unwrap();
        // From here on it waits for its reader, and the orders wait for it.
        while !live.reports().is_full() {
            std::thread::yield_now();
        }
        for tick in 1..=10 {
            let plan = plan(&mut rng, 0.0, 60.0);
            let _ = handle.send(Command::SetTrajectory(ids[3], plan)).unwrap();
            let _ = handle.advance(f64::from(tick) / 10.0).unwrap();
        }
        live.stop_requests();
        live.stop_requests();
        assert_eq!(
            handle.advance(2.0),
            Err(Unsent::Closed(Request::Clock(2.0)))
        );
        let reader = std::thread::spawn(move || reader.iter().collect::<Vec<Report>>());
        let read = reader.join().unwrap();
        assert!(
            numbers(&read).into_iter().eq(0..read.len() as u64),
            "{seed}"
        );
        // Caught up with the last order before it ends.
        let end = ReportKind::Ticked {
            now: 1.0,
            complete_until: 1.0 + LOOKAHEAD,
        };
        assert_eq!(read.last().map(|report| &report.kind), Some(&end));
        let stopped = live.shutdown().unwrap();
        assert!(stopped.reports.is_empty() && stopped.unapplied.is_empty());
        let counts = stopped.counts;
        assert_eq!((counts.sent, counts.refused), (21, 0));
        assert_eq!(counts.applied + counts.superseded, 21);
        assert!(stopped.monitor.is_caught_up());
        let mut ledger = Ledger::default();
        ledger.read_all(&read);
        ledger.finish(stopped.monitor);
    }
}

/// Also a thread that waits for orders ends; and one that nobody reads is shut down as ever.
#[test]
fn orders_are_stopped_whatever_the_monitor_does() {
    let (monitor, _) = crowd(1, 10);
    let live = monitor.spawn(LiveOptions::default()).unwrap();
    let caught_up = |report: Report| match report.kind {
        ReportKind::Ticked { complete_until, .. } => complete_until >= LOOKAHEAD,
        _ => false,
    };
    while !caught_up(live.reports().recv_timeout(PATIENCE).unwrap()) {}
    // It has nothing to do, and soon sleeps.
    std::thread::sleep(Duration::from_millis(20));
    live.stop_requests();
    // Not even another tick is told.
    assert_eq!(
        live.reports().recv_timeout(PATIENCE),
        Err(RecvTimeoutError::Disconnected)
    );
    drop(live);
    // Nobody reads: what the reader had no room for comes back.
    let (monitor, _) = crowd(2, 60);
    let options = LiveOptions::default().with_reports(1);
    let live = monitor.spawn(options).unwrap();
    for tick in 1..=10 {
        let _ = live.handle().advance(f64::from(tick)).unwrap();
    }
    live.stop_requests();
    while live.reports().is_empty() {
        std::thread::yield_now();
    }
    let begin = Instant::now();
    let stopped = live.shutdown().unwrap();
    assert!(begin.elapsed() < Duration::from_secs(1));
    let reports = stopped.reports;
    assert!(numbers(&reports).into_iter().eq(0..reports.len() as u64));
    let counts = stopped.counts;
    assert_eq!(counts.refused, stopped.unapplied.len() as u64);
    assert_eq!(
        counts.sent,
        counts.applied + counts.superseded + counts.refused
    );
}
