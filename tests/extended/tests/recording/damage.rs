//! Files that are not what was written.

use super::*;
use std::fmt::Write as _;

/// Length and checksum, and the spaces after them.
const PREFIX: usize = 18;

fn lines(file: &[u8]) -> Vec<&[u8]> {
    file.split_inclusive(|byte| *byte == b'\n').collect()
}

/// The records of a file, without their prefixes.
fn records(file: &[u8]) -> Vec<&str> {
    let text = std::str::from_utf8(file).unwrap();
    text.lines().skip(1).map(|line| &line[PREFIX..]).collect()
}

/// A file of these records, with prefixes as the format has them.
fn file_of(records: &[&str]) -> Vec<u8> {
    let mut file = "nearmiss recording 7\n".to_owned();
    let mut checksum = crc32fast::Hasher::new();
    for json in records {
        checksum.update(json.as_bytes());
        let so_far = checksum.clone().finalize();
        writeln!(file, "{:08x} {so_far:08x} {json}", json.len()).unwrap();
    }
    file.into_bytes()
}

/// A small file, cut at every byte: what is whole is replayed, the rest is told with its place.
#[test]
fn a_cut_is_told() {
    let (file, events) = run(3, 4, 0, 6);
    let lines: Vec<usize> = std::iter::once(0)
        .chain((0..file.len()).filter(|&i| file[i] == b'\n').map(|i| i + 1))
        .collect();
    for length in 0..file.len() {
        let (again, end) = replay(&file[..length]);
        // The line that is cut, or missing.
        let line = lines.iter().rev().find(|&&start| start <= length).unwrap();
        match end.unwrap_err() {
            RecordingError::NotARecording { .. } => assert_eq!(*line, 0, "cut at {length}"),
            RecordingError::Truncated { offset } => assert_eq!(offset, *line as u64),
            other => panic!("cut at {length}: {other}"),
        }
        assert_eq!(text(&again), text(&events[..again.len()]));
    }
}

/// Every byte of a small file, changed: never a panic, never other events than those before it.
#[test]
fn damage_is_told() {
    let (file, events) = run(4, 4, 0, 5);
    let mut line = 0;
    for place in 0..file.len() {
        for flip in [1, 0x80] {
            let mut damaged = file.clone();
            damaged[place] ^= flip;
            let (again, end) = replay(&damaged);
            let offset = match end.unwrap_err() {
                RecordingError::NotARecording { .. } => 0,
                RecordingError::Truncated { offset }
                | RecordingError::Damaged { offset, .. }
                | RecordingError::Refused { offset, .. } => offset,
                RecordingError::Io(error) => panic!("{error}"),
                other => panic!("{other}"),
            };
            assert_eq!(offset, line as u64, "byte {place}");
            assert_eq!(text(&again), text(&events[..again.len()]));
        }
        if file[place] == b'\n' {
            line = place + 1;
        }
    }
}

/// Lines that are whole, but not those that were written there: the first of them is told, and all
/// before it is as it was.
#[test]
fn lines_out_of_order_are_told() {
    let (file, _) = run(6, 4, 0, 6);
    let (other, _) = run(7, 4, 0, 6);
    let (written, foreign) = (lines(&file), lines(&other));
    let check = |changed: &[&[u8]], place: usize, what: &str| {
        let offset = changed[..place].concat().len();
        let (again, end) = replay(&changed.concat());
        let told = match end {
            Ok(()) => panic!("{what}: no error"),
            Err(RecordingError::NotARecording { .. }) => 0,
            Err(RecordingError::Truncated { offset } | RecordingError::Damaged { offset, .. }) => {
                offset
            }
            Err(other) => panic!("{what}: {other}"),
        };
        assert_eq!(told, offset as u64, "{what}");
        let (before, _) = replay(&file[..offset]);
        assert_eq!(text(&again), text(&before), "{what}");
    };
    for place in 0..written.len() {
        let mut changed = written.clone();
        changed.remove(place);
        check(&changed, place, &format!("line {place} is missing"));
        changed.insert(place, written[place]);
        changed.insert(place, written[place]);
        check(&changed, place + 1, &format!("line {place} is doubled"));
        for later in place + 1..written.len() {
            let mut changed = written.clone();
            changed.swap(place, later);
            let what = format!("lines {place} and {later} are swapped");
            check(&changed, place, &what);
        }
        // The beginning of another file is one: that the rest does not belong to it is told with the rest.
        if let (2.., Some(line)) = (place, foreign.get(place)) {
            let mut changed = written.clone();
            changed[place] = line;
            check(&changed, place, &format!("line {place} is of another file"));
        }
    }
}

/// Lines that say the same, as ticks of a clock that stands still do, are told apart by their place.
#[test]
fn a_line_that_is_repeated_is_told() {
    let mut monitor = Monitor::new(Scene::new(), 0.0, 1.0, &[AlertLevel::at(1.0)]).unwrap();
    let file = Memory::default();
    monitor.start_recording(file.clone()).unwrap();
    for _ in 0..4 {
        monitor.advance(1.0, &mut Vec::new()).unwrap();
    }
    monitor.stop_recording().unwrap();
    let file = file.bytes();
    let said = records(&file);
    assert_eq!(said[2], said[3]);
    let mut changed = lines(&file);
    changed.remove(3);
    let offset = changed[..3].concat().len() as u64;
    let (_, end) = replay(&changed.concat());
    assert!(matches!(end, Err(RecordingError::Damaged { offset: at, .. }) if at == offset));
    replay(&file).1.unwrap();
}

/// The format is what is said of it; that of older versions is refused by its name.
#[test]
fn the_format_is_as_it_is_said() {
    let (file, _) = run(8, 4, 0, 5);
    let written = records(&file);
    assert!(file_of(&written) == file);
    let older = [b"nearmiss recording 1\n", &file[21..]].concat();
    let refused = Replay::open(&older[..]).map(drop).unwrap_err();
    assert!(refused.to_string().contains("\"nearmiss recording 1"));
    let title = file.split(|&byte| byte == b'\n').next().unwrap();
    let title = str::from_utf8(title).unwrap();
    let version = title.strip_prefix("nearmiss recording ").unwrap();
    let docs = include_str!("../../../../src/monitor/recording/replay.rs");
    for said in [format!("Format, version {version}\n"), format!("`{title}`")] {
        assert!(docs.contains(&said), "{said}");
    }
    // Right by its checksum, but no recording.
    let twice = file_of(&[&written[..1], &written[..]].concat());
    assert!(matches!(
        replay(&twice).1,
        Err(RecordingError::Damaged { .. })
    ));
}

/// A recording that goes on after its end, or after the monitor was closed; and one that is read on after
/// something was wrong.
#[test]
fn what_follows_an_end_is_told() {
    let memory = Memory::default();
    let mut rng = rng(9);
    let mut monitor = monitor(&mut rng, 6, 5.0);
    monitor.start_recording(memory.clone()).unwrap();
    live_on(&mut monitor, &mut rng, &mut Vec::new());
    monitor.close(&mut Vec::new());
    let whole = memory.bytes();
    replay(&whole).1.unwrap();
    let twice = [&whole[..], &whole[..]].concat();
    assert!(matches!(
        replay(&twice).1,
        Err(RecordingError::Damaged { offset, .. }) if offset == whole.len() as u64
    ));
    let written = records(&whole);
    let [rest @ .., tick, close, end] = &written[..] else {
        unreachable!("there are more records")
    };
    let after = file_of(&[rest, &[*tick, *close, *tick, *end]].concat());
    let mut opened = Replay::open(&after[..]).unwrap();
    let mut events = Vec::new();
    while let Ok(now) = opened.tick(&mut events) {
        assert!(now.is_some());
    }
    let told = events.len();
    assert!(matches!(
        opened.tick(&mut events),
        Err(RecordingError::Damaged { .. })
    ));
    assert_eq!(events.len(), told);
}

/// A beginning that no monitor writes, though its checksum is right.
#[test]
fn contradictions_are_refused() {
    let (file, _) = run_with(5.0, 3, 12, 40, 20);
    let mut written = records(&file);
    let begin: serde_json::Value = serde_json::from_str(written.remove(0)).unwrap();
    let open = |begin: &serde_json::Value| {
        let file = file_of(&[&[&begin.to_string()[..]], &written[..]].concat());
        Replay::open(&file[..]).map(drop)
    };
    open(&begin).unwrap();
    for (field, value) in [
        ("next_id", serde_json::json!(u64::MAX)),
        ("next_id", serde_json::json!(0)),
        ("history", serde_json::json!(-1.0)),
        ("end_reported", serde_json::json!([])),
        (
            "revision_threshold",
            serde_json::json!({"time": -1.0, "separation": 0.0}),
        ),
    ] {
        let mut broken = begin.clone();
        let place = &mut broken["begin"][field];
        assert!(!place.is_null(), "{field} in {begin}");
        *place = value;
        assert!(open(&broken).is_err(), "{field}");
    }
    // Encounters that no monitor of this scene can have had.
    let saved = &begin["begin"]["encounters"][0][0];
    let begun = saved["begun"].as_bool().unwrap();
    for (place, value) in [
        ("/encounter/level", serde_json::json!(7)),
        ("/encounter/id", serde_json::json!(u64::MAX)),
        ("/encounter/a", saved["encounter"]["b"].clone()),
        ("/encounter/exit", serde_json::json!(-1e9)),
        ("/begun", serde_json::json!(!begun)),
    ] {
        let mut broken = begin.clone();
        let place_of_it = broken["begin"]["encounters"][0][0].pointer_mut(place);
        *place_of_it.unwrap() = value;
        assert!(open(&broken).is_err(), "{place} of {saved}");
    }
}
