//! The `screen` example as a tool: its output, and one clear line for each kind of bad input.

#![allow(
    clippy::unwrap_used,
    reason = "a file or process that fails, fails the test"
)]

#[path = "support/example.rs"]
mod example;

use example::{example, folder, plain};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Output, Stdio};

const HEADER: &str = "body,t,px,py,pz,vx,vy,vz\n";

/// Two bodies that pass at 2 m, at t = 6. (12 s: a third of it has no rounding, nor has the rest.)
const PASS: &str = "0,0,-6,2,0,1,0,0\n0,12,6,2,0,1,0,0\n\
                    3,0,0,0,0,0,0,0\n3,12,0,0,0,0,0,0\n";

fn screen(name: &str, content: impl AsRef<[u8]>, options: &[&str]) -> (Output, PathBuf) {
    let folder = folder(name);
    let states = folder.join("states.csv");
    std::fs::write(&states, content).unwrap();
    let output = folder.join("out.csv");
    let result = example("screen")
        .arg(&states)
        .arg("--output")
        .arg(&output)
        .args(options)
        .output()
        .unwrap();
    (result, output)
}

/// Runs on bad input: exit 1, one line that holds all of `parts`, no output file.
fn refuses(name: &str, content: impl AsRef<[u8]>, options: &[&str], parts: &[&str]) {
    let said = fails(1, name, content, options, parts);
    assert_eq!(said.lines().count(), 1, "{name}: {said}");
}

/// Runs with a wrong command line: exit 2, a message that holds all of `parts`, no output file.
fn refuses_options(name: &str, options: &[&str], parts: &[&str]) {
    // The file is wrong too: the options come first.
    fails(2, name, "", options, parts);
}

fn fails(
    code: i32,
    name: &str,
    content: impl AsRef<[u8]>,
    options: &[&str],
    parts: &[&str],
) -> String {
    let (result, output) = screen(name, content, options);
    let said = plain(&result.stderr);
    assert_eq!(result.status.code(), Some(code), "{name}: {said}");
    for part in parts {
        assert!(said.contains(part), "{name}: no {part:?} in {said}");
    }
    assert!(!output.exists(), "{name}: an output was left behind");
    assert!(result.stdout.is_empty());
    said
}

#[test]
fn conflicts_as_a_table() {
    let (result, output) = screen(
        "table",
        format!("{HEADER}{PASS}"),
        &["--radius", "0.5", "--margin", "1.5", "--stats", "json"],
    );
    assert!(result.status.success());
    let table = std::fs::read_to_string(&output).unwrap();
    assert_eq!(
        table,
        "a,b,enter,exit,tca,separation,error,clip,resolved\n0,3,4.5,7.5,6,1,,0,\n"
    );
    let stats = String::from_utf8(result.stderr).unwrap();
    assert!(stats.starts_with("{\"bodies\":2,\"segments\":2,"));
    assert!(stats.contains("\"conflicts\":1,"));
}

#[test]
fn enclosures_as_a_table() {
    let (result, output) = screen(
        "certified",
        format!("{HEADER}{PASS}"),
        &[
            "--radius",
            "0.5",
            "--margin",
            "1.5",
            "--accuracy",
            "certified",
        ],
    );
    assert!(result.status.success());
    let mut table = csv::Reader::from_path(&output).unwrap();
    let names: Vec<_> = table.headers().unwrap().iter().map(str::to_owned).collect();
    let rows: Vec<Vec<f64>> = table.deserialize().map(Result::unwrap).collect();
    assert_eq!(
        names.join(","),
        "a,b,enter,exit,tca,separation,error,clip,resolved,\
         enter_lo,enter_hi,exit_lo,exit_hi,tca_lo,tca_hi"
    );
    let [row] = &rows[..] else {
        panic!("{} rows", rows.len());
    };
    assert_eq!(row[..6], [0.0, 3.0, 4.5, 7.5, 6.0, 1.0]);
    // A few roundings of some 10 m.
    assert!(row[6] > 0.0 && row[6] < 1e-13);
    assert_eq!(row[7..9], [0.0, 1.0]);
    for (low, time) in [(9, 4.5), (11, 7.5), (13, 6.0)] {
        assert!(row[low] <= time && time <= row[low + 1]);
    }
}

#[test]
fn windows_and_outside_rules() {
    let states = format!("{HEADER}{PASS}");
    let margin = ["--margin", "2.5"];
    let rows = |name: &str, options: &[&str]| {
        let (result, output) = screen(name, &states, &[&margin[..], options].concat());
        assert!(result.status.success(), "{:?}", result.stderr);
        let table = std::fs::read_to_string(output).unwrap();
        table.lines().skip(1).map(str::to_owned).collect::<Vec<_>>()
    };
    assert_eq!(rows("window", &["--window=5..7"]), ["0,3,5,7,6,2,,3,"]);
    assert_eq!(
        rows("until", &["--window=..5"]),
        ["0,3,4.5,5,5,2.23606797749979,,2,"]
    );
    assert_eq!(rows("later", &["--window=8.."]).len(), 0);
    let coast = ["--window=-20..30", "--outside", "coast"];
    assert_eq!(rows("coast", &coast), ["0,3,4.5,7.5,6,2,,0,"]);
    for window in ["--window=..", "--window=0..", "--window=..9"] {
        refuses_options(
            "open",
            &["--outside", "extrapolate", window],
            &["--outside extrapolate", "--window=A..B"],
        );
    }
}

#[test]
fn broken_files() {
    let file = |rows: &str| format!("{HEADER}{rows}");
    refuses("empty", "", &[], &["states.csv", "row 1", "empty"]);
    let unclosed = format!("{HEADER}0,0,0,0,0,0,0,0\n\"0,1,0,0,0,0,0,0\n0,2,0,0,0,0,0,0\n");
    refuses("unclosed", &unclosed, &[], &["row 3, column t", "1 value"]);
    refuses("no-rows", HEADER, &[], &["states.csv", "row 2"]);
    refuses(
        "column",
        "body,t,px,py,pz,vx,vy\n0,0,0,0,0,0,0\n",
        &[],
        &["states.csv", "row 1", "column vz", "missing"],
    );
    refuses(
        "text",
        file("0,0,0,0,0,0,0,0\n0,1,0,fast,0,0,0,0\n"),
        &[],
        &["states.csv", "row 3", "column py", "\"fast\""],
    );
    refuses(
        "nan",
        file("0,0,0,0,0,0,0,0\n0,1,0,0,0,0,NaN,0\n"),
        &[],
        &["row 3", "column vy", "NaN"],
    );
    refuses(
        "huge",
        file("0,0,0,0,0,0,0,0\n0,1,1e300,0,0,0,0,0\n"),
        &[],
        &["row 3", "column px", "1e300"],
    );
    refuses(
        "back",
        file("0,0,0,0,0,0,0,0\n0,2,0,0,0,0,0,0\n0,1.5,0,0,0,0,0,0\n"),
        &[],
        &["row 4", "column t", "1.5", "2"],
    );
    refuses(
        "single",
        file("0,0,0,0,0,0,0,0\n1,0,0,0,0,0,0,0\n"),
        &[],
        &["row 2", "column body", "body 0 has 1 row"],
    );
    refuses(
        "apart",
        file(
            "0,0,0,0,0,0,0,0\n0,1,0,0,0,0,0,0\n1,0,0,0,0,0,0,0\n1,1,0,0,0,0,0,0\n0,2,0,0,0,0,0,0\n",
        ),
        &[],
        &["row 6", "column body", "body 0", "together"],
    );
    // In the order of time, bodies in turns.
    refuses(
        "turns",
        file("1,0,0,0,0,0,0,0\n2,0,0,0,0,0,0,0\n1,1,0,0,0,0,0,0\n2,1,0,0,0,0,0,0\n"),
        &[],
        &["row 4", "column body", "body 1", "row 2", "together"],
    );
    refuses(
        "short",
        file("0,0,0,0,0,0,0,0\n0,1,0,0,0\n"),
        &[],
        &["row 3", "column vx", "5 values"],
    );
    refuses(
        "label",
        file(" ,0,0,0,0,0,0,0\n"),
        &[],
        &["row 2, column body: empty", "name"],
    );
}

/// What a terminal would obey, and what is no text, is told as it is spelled.
#[test]
fn values_are_escaped() {
    const ROW: &str = "0,0,0,0,0,0,0,0\n";
    let rows = |bytes: &[u8]| [HEADER.as_bytes(), ROW.as_bytes(), bytes].concat();
    for (value, shown) in [
        (&b"\x1b[31mred"[..], r#""\u{1b}[31mred""#),
        (b"\x1b]0;title\x07", r#""\u{1b}]0;title\u{7}""#),
        (b"1\r2", r#""1\r2""#),
        (b"a\x00b\x08c\x7f", r#""a\0b\u{8}c\u{7f}""#),
        // One that a terminal takes for `ESC [`, one that turns the order of what follows.
        ("\u{9b}2J".as_bytes(), r#""\u{9b}2J""#),
        ("\u{202e}evil".as_bytes(), r#""\u{202e}evil""#),
        (b"\xff\xfe1", r#""\xff\xfe1""#),
        (b"\xc3", r#""\xc3""#),
        ("na\u{ef}ve \u{6570}".as_bytes(), "\"na\u{ef}ve \u{6570}\""),
        (b"it's \\n", r#""it's \n""#),
    ] {
        let row = [b"0,1,0,", value, b",0,0,0,0\n"].concat();
        let parts = ["states.csv: row 3, column py: ", shown];
        refuses("value", rows(&row), &[], &parts);
        // A body of this name has one row: what does not print is no name, and the rest is told so.
        let label = [HEADER.as_bytes(), value, b",1,0,0,0,0,0,0\n"].concat();
        refuses("label", label, &[], &["row 2, column body: ", shown]);
        let short = [b"0,1,0,", value, b"\n"].concat();
        let parts = ["row 3, column pz: ", "4 values", shown];
        refuses("short", rows(&short), &[], &parts);
        let inside = &shown[1..shown.len() - 1];
        let missing = [b"body,t,px,py,pz,vx,vy,", value, b"\n"].concat();
        let parts = ["row 1, column vz: missing", "found \"body,t,px", inside];
        refuses("header", missing, &[], &parts);
        // A column that is not used.
        let header = &HEADER.as_bytes()[..HEADER.len() - 1];
        let rows = "0,0,0,0,0,0,0,0,0\n0,1,0,0,0,0,0,0,0\n".as_bytes();
        let more = [header, b",", value, b"\n", rows].concat();
        let (result, _) = screen("header", more, &[]);
        assert!(result.status.success());
        let said = plain(&result.stderr);
        assert!(
            said.contains(&format!("not used: column {shown}")),
            "{said}"
        );
    }
}

/// Of a long value its beginning and its length.
#[test]
fn long_values_are_shortened() {
    let long = "7\u{ef}".repeat(100_000);
    for (content, part) in [
        (format!("{HEADER}0,0,{long},0,0,0,0,0\n"), "(300000 bytes)"),
        (format!("{HEADER}{long},0,0,0,0,0,0,0\n"), "(300000 bytes)"),
        (format!("{HEADER}0,{long}\n"), "(300000 bytes)"),
        (format!("{long}\n"), "(300000 bytes)"),
        (
            format!("{HEADER}{}", [&long[..]; 9].join(",")),
            "(300000 bytes)",
        ),
        (format!("body,{long}\n"), "(300005 bytes)"),
        (
            HEADER
                .replace("body", "id")
                .replace('\n', &format!(",{long}\n")),
            "(300023 bytes)",
        ),
    ] {
        let said = fails(1, "long", content, &[], &["row ", "\u{ef}", part]);
        assert!(said.len() < 400, "{said}");
        assert!(
            !said.contains("\\x"),
            "a character is not cut apart: {said}"
        );
    }
}

/// Names of files, and what else is on a command line.
#[cfg(unix)]
#[test]
fn names_are_escaped() {
    use std::ffi::OsStr;
    use std::os::unix::ffi::OsStrExt;
    let folder = folder("names");
    let run = |arguments: &[&OsStr]| {
        let result = example("screen").args(arguments).output().unwrap();
        (result.status.code(), plain(&result.stderr))
    };
    let hostile = OsStr::from_bytes(b"a\x1b[2Jb\nc\xffd\x07");
    let shown = r"a\u{1b}[2Jb\nc\xffd\u{7}";
    let (path, option) = (folder.join(hostile), OsStr::new("--output"));
    // Not there, and broken.
    for content in [None, Some("broken")] {
        if let Some(content) = content {
            std::fs::write(&path, content).unwrap();
        }
        let (code, said) = run(&[path.as_os_str()]);
        assert_eq!(code, Some(1));
        assert!(said.contains(shown) && said.lines().count() == 1, "{said}");
    }
    // No place for the output: in a folder that is not there, in the place of one, in that of the states.
    let nowhere = path.join("out.csv");
    let (code, said) = run(&[path.as_os_str(), option, nowhere.as_os_str()]);
    assert_eq!(code, Some(1));
    assert!(said.contains(shown) && said.lines().count() == 1, "{said}");
    let (code, said) = run(&[path.as_os_str(), option, path.as_os_str()]);
    assert_eq!(code, Some(2));
    assert!(said.contains(shown), "{said}");
    std::fs::remove_file(&path).unwrap();
    std::fs::create_dir(&path).unwrap();
    let (code, said) = run(&[OsStr::new("absent.csv"), option, path.as_os_str()]);
    assert_eq!(code, Some(1));
    assert!(said.contains(shown) && said.lines().count() == 1, "{said}");
    for options in [
        "--window=1..\u{1b}[2J\u{9b}2J",
        "--radius=\u{1b}[2J\u{9b}2J",
        "--outside=\u{1b}[2J\u{9b}2J",
        "--\u{1b}[2J\u{9b}2J",
    ] {
        let (code, said) = run(&[OsStr::new("absent.csv"), OsStr::new(options)]);
        assert_eq!(code, Some(2));
        assert!(said.contains(r"\u{9b}2J"), "{said}");
    }
}

/// Line ends of either kind, empty lines, a byte order mark, no line end at the end: the rows are the
/// same, and have the same numbers but for the empty ones.
#[test]
fn files_of_all_kinds_of_editors() {
    let unix = format!("{HEADER}{PASS}3,x,0,0,0,0,0,0");
    let empty_lines = format!(
        "{}3,x,0,0,0,0,0,0",
        format!("{HEADER}{PASS}").replace('\n', "\n\n")
    );
    for (name, text, row) in [
        ("unix", unix.clone(), "row 6"),
        ("dos", unix.replace('\n', "\r\n"), "row 6"),
        ("mark", format!("\u{feff}{unix}"), "row 6"),
        ("gaps", empty_lines.clone(), "row 11"),
        ("dos-gaps", empty_lines.replace('\n', "\r\n"), "row 11"),
        ("late", format!("\n\n{unix}"), "row 8"),
        (
            "dos-late",
            format!("\n\n{unix}").replace('\n', "\r\n"),
            "row 8",
        ),
    ] {
        refuses(name, &text, &[], &[row, "column t", "\"x\""]);
        let whole = text.replace("3,x,0,0,0,0,0,0", "");
        let (result, output) = screen(name, &whole, &["--margin", "2.5"]);
        assert!(result.status.success(), "{name}: {:?}", result.stderr);
        let table = std::fs::read_to_string(output).unwrap();
        assert_eq!(
            table.lines().skip(1).collect::<Vec<_>>(),
            ["0,3,4.5,7.5,6,2,,0,"]
        );
    }
}

#[test]
fn bad_options() {
    refuses_options("radius", &["--radius", "-1"], &["--radius", "-1.0 m"]);
    refuses_options("margin", &["--margin", "NaN"], &["--margin", "NaN m"]);
    refuses_options("accuracy", &["--accuracy", "perfect"], &["perfect"]);
    refuses_options(
        "accuracy",
        &["--accuracy", "fast"],
        &["--accuracy", "fast is not offered", "exact"],
    );
    refuses_options("window", &["--window=5..1"], &["--window", "5..1"]);
    refuses_options("radius", &["--radius", "-1e-3"], &["-0.001 m"]);
    refuses_options("margin", &["--margin", "-inf"], &["-inf m"]);
    for threads in ["-1", "1025", "99999999", "99999999999999999999"] {
        let parts = ["--threads", threads];
        refuses_options("threads", &parts, &parts);
    }
    refuses_options("threads", &["--threads", "1025"], &["0..=1024"]);
    let absent = example("screen").arg("no-such-file.csv").output().unwrap();
    assert_eq!(absent.status.code(), Some(1));
}

#[test]
fn packed_or_not_and_standard_input() {
    let states = format!("{HEADER}{PASS}");
    let mut packer = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::default());
    packer.write_all(states.as_bytes()).unwrap();
    let packed = packer.finish().unwrap();
    let folder = folder("packed");
    let conflicts = |input: &Path, sent: &[u8]| {
        let mut child = example("screen")
            .arg(input)
            .args(["--margin", "2"])
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        child.stdin.take().unwrap().write_all(sent).unwrap();
        let result = child.wait_with_output().unwrap();
        assert!(result.status.success(), "{}", input.display());
        String::from_utf8(result.stdout).unwrap()
    };
    let plain = conflicts(Path::new("-"), states.as_bytes());
    assert_eq!(plain.lines().count(), 2);
    assert_eq!(conflicts(Path::new("-"), &packed), plain);
    for name in ["STATES.CSV.GZ", "states.csv.gz", "states.csv"] {
        let input = folder.join(name);
        for content in [states.as_bytes(), &packed] {
            std::fs::write(&input, content).unwrap();
            assert_eq!(conflicts(&input, &[]), plain, "{name}");
        }
    }
}

/// A file that is packed in another way is told by its first bytes, whatever its name.
#[test]
fn other_packings_are_named() {
    let gzip = |content: &[u8]| {
        let mut packer = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::default());
        packer.write_all(content).unwrap();
        packer.finish().unwrap()
    };
    let states = format!("{HEADER}{PASS}");
    let twice = gzip(&gzip(states.as_bytes()));
    for (content, name) in [
        (&b"\xfd7zXZ\0\0\x04\xe6\xd6\xb4F"[..], "xz"),
        (b"BZh91AY&SY\x8a\x12\n\"", "bzip2"),
        (b"BZh9\x17rE8P\x90\0\0\0\0", "bzip2"),
        (b"\x28\xb5\x2f\xfd\x04\x58\xc1\x02", "zstd"),
        (b"\x04\x22\x4d\x18\x64\x40\xa7", "lz4"),
        (b"7z\xbc\xaf\x27\x1c\0\x04", "7z"),
        (&twice, "gzip more than once"),
    ] {
        let said = format!(
            "states.csv: row 1: the file is packed with {name}; unpack it, or pack it with gzip once\n"
        );
        refuses("packing", content, &[], &[&said]);
    }
    refuses(
        "packing",
        gzip(b"PK\x03\x04"),
        &[],
        &["row 1: the file is packed (a zip"],
    );
    // A column of another's file.
    let named = format!("{HEADER}{PASS}")
        .replace("body", "BZh9,body")
        .replace('\n', "\n,");
    let (result, _) = screen("packing", named.strip_suffix(',').unwrap(), &[]);
    assert!(result.status.success(), "{}", plain(&result.stderr));
}

/// The body is named as the file names it, and the advice is what the tool has.
#[test]
fn a_crowd_is_explained() {
    let mut states = format!("{HEADER}far,0,1e6,0,0,0,0,0\nfar,1,1e6,0,0,0,0,0\n");
    for ship in 0..8_000 {
        states += &format!("ship-{ship},0,0,0,0,0,0,0\nship-{ship},1,0,0,0,0,0,0\n");
    }
    let parts = [
        "too many pairs may be in conflict; body \"ship-",
        "\" comes near 7999 others, to most at 0.0 s: narrow --window, or give a smaller --margin or --radius\n",
    ];
    refuses("crowd", states, &["--radius", "1"], &parts);
}
