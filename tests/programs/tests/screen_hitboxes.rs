//! The option `--hitboxes` of the `screen` example: clusters, half-spaces, rotations, and one clear
//! line for each kind of bad input.

#![allow(
    clippy::unwrap_used,
    reason = "a file or process that fails, fails the test"
)]

#[path = "support/example.rs"]
mod example;

use example::{example, folder, plain};
use std::process::Output;

/// A ground at rest, a body that flies along it at 2 m, one far above.
const STATES: &str = "body,t,px,py,pz,vx,vy,vz\n\
                      0,0,0,0,0,0,0,0\n0,12,0,0,0,0,0,0\n\
                      3,0,-6,0,2,1,0,0\n3,12,6,0,2,1,0,0\n\
                      7,0,0,0,90,0,0,0\n7,12,0,0,90,0,0,0\n";

fn screen(name: &str, hitboxes: impl AsRef<[u8]>) -> Output {
    let folder = folder(name);
    let (states, file) = (folder.join("states.csv"), folder.join("hitboxes.json"));
    std::fs::write(&states, STATES).unwrap();
    std::fs::write(&file, hitboxes).unwrap();
    let mut screen = example("screen");
    screen
        .arg(&states)
        .arg("--hitboxes")
        .arg(&file)
        .output()
        .unwrap()
}

fn rows(name: &str, hitboxes: &str) -> Vec<String> {
    let output = screen(name, hitboxes);
    let said = plain(&output.stderr);
    assert!(output.status.success(), "{name}: {said}");
    let table = String::from_utf8(output.stdout).unwrap();
    table.lines().skip(1).map(str::to_owned).collect()
}

#[test]
fn half_spaces_and_clusters() {
    let ground = r#"{"body": 0, "half_space": [0, 0, 1]}"#;
    // The lower sphere touches the ground by half a metre.
    let legs = r#"{"bodies": [1, 5], "spheres": [[0, 0, 0, 1], [0, 0, -1.5, 1]]}"#;
    let found = rows("walls", &format!("[{ground}, {legs}]"));
    assert_eq!(found, ["0,3,0,12,0,-0.5,,3,"]);
    // A later entry replaces an earlier one.
    let found = rows(
        "replaced",
        &format!("[{ground}, {legs}, {{\"body\": 3, \"spheres\": [[0,0,0,1]]}}]"),
    );
    assert!(found.is_empty(), "{found:?}");
}

/// Nothing is found, and no margin would change that.
#[test]
fn half_spaces_alone() {
    let walls =
        r#"[{"body": 0, "half_space": [0, 0, 1]}, {"bodies": [1, 9], "half_space": [1, 0, 0]}]"#;
    let said = plain(&screen("walls_alone", walls).stderr);
    assert_eq!(
        said,
        "note: all bodies are half-spaces, which do not meet each other\n"
    );
}

/// Also where no body has need of either.
#[test]
fn two_kinds_of_radii_are_refused() {
    let folder = folder("two-radii");
    let (states, file) = (folder.join("states.csv"), folder.join("hitboxes.json"));
    let rows = "body,t,px,py,pz,vx,vy,vz,radius\n0,0,0,0,0,0,0,0,1\n0,1,0,0,0,0,0,0,1\n";
    std::fs::write(&states, rows).unwrap();
    std::fs::write(&file, r#"[{"body": 0, "spheres": [[0,0,0,0.1]]}]"#).unwrap();
    let mut screen = example("screen");
    let screen = screen.arg(&states).args(["--radius", "5", "--hitboxes"]);
    let output = screen.arg(&file).output().unwrap();
    let said = plain(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(said.contains("has a column radius; leave one of the two out"));
}

#[test]
fn bodies_by_name() {
    let folder = folder("by_name");
    let (states, file) = (folder.join("states.csv"), folder.join("hitboxes.json"));
    let named = STATES
        .replace("\n0,", "\nground,")
        .replace("\n3,", "\nlander,");
    std::fs::write(&states, named).unwrap();
    let hitboxes = r#"[{"body": "ground", "half_space": [0, 0, 1]}, {"body": "lander", "spheres": [[0, 0, 0, 2.5]]}]"#;
    std::fs::write(&file, hitboxes).unwrap();
    let mut screen = example("screen");
    let output = screen
        .arg(&states)
        .arg("--hitboxes")
        .arg(&file)
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", plain(&output.stderr));
    let table = String::from_utf8(output.stdout).unwrap();
    assert_eq!(table.lines().nth(1), Some("ground,lander,0,12,0,-0.5,,3,"));
}

#[test]
fn rotations() {
    // A sphere on a long arm that points up at first, and down after 6 s.
    let half = std::f64::consts::FRAC_1_SQRT_2;
    for kind in ["slerp", "normalized_cubic"] {
        let knots = format!("[[0,0,0,0,1],[3,{half},0,0,{half}],[6,1,0,0,0]]");
        let found = rows(
            kind,
            &format!(
                "[{{\"body\":0,\"half_space\":[0,0,1]}},{{\"body\":3,\"spheres\":[[0,0,2.5,0.5]],\
                 \"orientation\":{{\"kind\":\"{kind}\",\"knots\":{knots}}}}}]"
            ),
        );
        let [row] = &found[..] else {
            panic!("{found:?}")
        };
        let numbers: Vec<&str> = row.split(',').collect();
        let (enter, separation): (f64, f64) =
            (numbers[2].parse().unwrap(), numbers[5].parse().unwrap());
        assert!(enter > 4.0 && enter < 5.5, "{row}");
        assert!((separation + 1.0).abs() < 0.02, "{row}");
    }
}

/// Asserts that a file is refused in one line with these parts.
fn assert_refused(name: &str, content: impl AsRef<[u8]>, parts: &[&str]) {
    let output = screen(name, content);
    let said = plain(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{name}: {said}");
    assert_eq!(said.lines().count(), 1, "{name}: {said}");
    assert!(said.contains("hitboxes.json"), "{name}: {said}");
    for part in parts {
        assert!(said.contains(part), "{name}: no {part:?} in {said}");
    }
    assert!(output.stdout.is_empty(), "{name}");
}

#[test]
fn members_that_are_given_twice_are_refused() {
    let bodies = r#"[{"body": 1, "body": 3, "spheres": [[0, 0, 0, 1]]}]"#;
    assert_refused("twice", bodies, &["\"body\" is given twice at line 1"]);
    let knots = r#"[{"body": 3, "orientation": {"knots": [], "knots": []}}]"#;
    assert_refused("twice_inside", knots, &["\"knots\" is given twice"]);
}

#[test]
fn a_byte_order_mark_changes_nothing() {
    let bodies =
        r#"[{"body": 0, "half_space": [0, 0, 1]}, {"body": 3, "spheres": [[0, 0, -1.5, 1]]}]"#;
    let found = rows("unmarked", bodies);
    assert!(!found.is_empty());
    assert_eq!(rows("marked", &format!("\u{feff}{bodies}")), found);
}

#[test]
fn bad_files_are_refused_in_one_line() {
    let cases = [
        ("no_json", "[", vec!["not JSON"]),
        ("no_list", "{}", vec!["{} is not a list of entries"]),
        ("no_entry", "[7]", vec!["entry 0", "7 is no entry"]),
        (
            "no_body",
            "[{}]",
            vec!["entry 0", "give either body or bodies"],
        ),
        (
            "label",
            r#"[{"body": -1}]"#,
            vec!["entry 0", "-1 is not a body's label"],
        ),
        (
            "range",
            r#"[{"bodies": [5, 2]}]"#,
            vec!["bodies 5 to 2", "swap"],
        ),
        (
            "ends",
            r#"[{"bodies": 5}]"#,
            vec!["5 is not a range", "[first, last]"],
        ),
        (
            "neither",
            r#"[{"body": 3}]"#,
            vec!["body 3", "either spheres or half_space"],
        ),
        (
            "unknown",
            r#"[{"body": 3, "sphere": []}]"#,
            vec!["entry 0, body 3", "sphere", "is unknown", "half_space"],
        ),
        (
            "empty",
            r#"[{"body": 3, "spheres": []}]"#,
            vec!["body 3", "at least one sphere"],
        ),
        (
            "radius",
            r#"[{"body": 3, "spheres": [[0, 0, 0, -2]]}]"#,
            vec!["body 3", "sphere 0", "-2"],
        ),
        (
            "short",
            r#"[{"body": 3, "spheres": [[0, 0, 0]]}]"#,
            vec!["sphere 0", "[0,0,0] is not [x, y, z, radius]"],
        ),
        (
            "text",
            r#"[{"body": 3, "half_space": [0, 0, "1"]}]"#,
            vec!["half_space", "\"1\" is not a number"],
        ),
        (
            "normal",
            r#"[{"body": 3, "half_space": [0, 0, 2]}]"#,
            vec!["body 3", "half_space", "length 2", "unit vector"],
        ),
        (
            "turning",
            r#"[{"body": 3, "half_space": [0, 0, 1], "orientation":
               {"knots": [[0, 0, 0, 0, 1], [1, 1, 0, 0, 0.1]]}}]"#,
            vec!["body 3", "orientation"],
        ),
        (
            "kind",
            r#"[{"body": 3, "spheres": [[0, 0, 1, 1]], "orientation":
               {"kind": "squad", "knots": []}}]"#,
            vec!["body 3", "kind", "squad", "normalized_cubic"],
        ),
        (
            "knots",
            r#"[{"body": 3, "spheres": [[0, 0, 1, 1]], "orientation":
               {"knots": [[0, 0, 0, 0, 1], [0, 0, 0, 0, 1]]}}]"#,
            vec!["body 3", "knot 1", "not later"],
        ),
        (
            "stranger",
            r#"[{"body": 4, "spheres": [[0, 0, 1, 1]]}]"#,
            vec!["entry 0, body 4", "no such body"],
        ),
    ];
    for (name, content, parts) in cases {
        assert_refused(name, content, &parts);
    }
    let mut help = example("screen");
    let help = help.arg("--help").output().unwrap();
    let help = String::from_utf8(help.stdout).unwrap();
    for part in ["half_space", "\"knots\"", "normalized_cubic"] {
        assert!(help.contains(part), "{help}");
    }
}

/// Labels that no body has, numbers that are none, and other text than UTF-8.
#[test]
fn values_are_told_as_they_are_written() {
    let cases = [
        (
            "quoted",
            r#"[{"body": "3", "spheres": [[0, 0, 1, 1]]}]"#,
            vec!["entry 0, body \"3\"", "are numbers: write 3 without quotes"],
        ),
        (
            "named",
            r#"[{"body": "sun", "spheres": [[0, 0, 1, 1]]}]"#,
            vec!["entry 0, body \"sun\"", "are numbers: give one of them"],
        ),
        (
            "large",
            r#"[{"body": 0.5}, {"body": 18446744073709551617}]"#,
            vec![
                "entry 0",
                "0.5 is not a body's label, a whole number from 0 to 18446744073709551615",
            ],
        ),
        (
            "larger",
            r#"[{"body": 18446744073709551617, "spheres": [[0, 0, 1, 1]]}]"#,
            vec!["entry 0: 18446744073709551617 is not a body's label"],
        ),
        (
            "huge",
            r#"[{"body": 3, "spheres": [[0, 0, 1, 1]]}, {"body": 7, "spheres": [[0, 0, 1e999, 1]]}]"#,
            vec!["hitboxes.json: entry 1: number out of range at line 1 column"],
        ),
    ];
    for (name, content, parts) in cases {
        assert_refused(name, content, &parts);
    }
    let latin = b"[\n{\"body\": \"K\xf6ln\"}]";
    let parts = ["line 2: byte 0xf6 is no text in UTF-8; save the file in UTF-8"];
    assert_refused("latin", latin, &parts);
}
