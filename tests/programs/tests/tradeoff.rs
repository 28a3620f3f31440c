//! The example `tradeoff` as a program: its tables, their columns, and what is ours in them.

#![cfg(all(feature = "parallel", feature = "live", feature = "recording"))]
#![allow(
    clippy::unwrap_used,
    reason = "a file or process that fails, fails the test"
)]

#[path = "support/example.rs"]
mod example;

use example::{example, folder, plain};
use serde_json::Value;

/// Tables of `tradeoff` by key, with columns that they have.
const TABLES: [(&str, &[&str]); 8] = [
    (
        "pair",
        &[
            "pairs",
            "method",
            "ns",
            "times_polycool",
            "worst_error_size",
            "wrong_minima",
        ],
    ),
    (
        "stepped",
        &[
            "method",
            "Hz",
            "encounters",
            "missed",
            "false",
            "late_ms_p50",
            "late_ms_max",
            "separation_off_m",
            "ms",
            "ms_frame",
            "times_nearmiss",
        ],
    ),
    (
        "knots",
        &[
            "motion",
            "tolerance_m",
            "error_m",
            "knots_body",
            "encounters",
            "missed",
            "missed_with_error",
            "false",
            "entry_off_ms",
            "separation_off_m",
            "ms",
        ],
    ),
    (
        "told",
        &[
            "told_s",
            "encounters",
            "seen_ahead",
            "seen_late",
            "ahead_s_p50",
            "missed",
            "false",
            "ms_told",
        ],
    ),
    (
        "spheres",
        &[
            "spheres",
            "overshoot_m",
            "encounters",
            "boxes_touch",
            "false",
            "ms",
        ],
    ),
    (
        "baking",
        &[
            "tolerance_m",
            "encounters",
            "certified",
            "unresolved",
            "ms",
            "certified_ms",
        ],
    ),
    ("prices", &["work", "with", "ms", "times_the_first"]),
    (
        "existence",
        &["one_body_with", "ms", "percent_more", "from", "to"],
    ),
];

/// The tables of `tradeoff` have their rows and columns, and what is ours is right.
#[test]
fn the_tradeoff_in_short() {
    let folder = folder("tradeoff");
    let (json, pictures) = (folder.join("tradeoff.json"), folder.join("pictures"));
    std::fs::create_dir_all(&pictures).unwrap();
    let mut command = example("tradeoff");
    command.arg("--quick").arg("--json").arg(&json);
    command.arg("--pictures").arg(&pictures);
    let done = command.output().unwrap();
    assert!(done.status.success(), "{}", plain(&done.stderr));
    let text = std::fs::read_to_string(&json).unwrap();
    let found: Value = serde_json::from_str(&text).unwrap();
    assert_eq!(found["quick"], true);
    for (key, columns) in TABLES {
        let rows = found["tables"][key]["rows"].as_array().unwrap();
        assert!(!rows.is_empty(), "{key}");
        for row in rows {
            for column in columns {
                assert!(row.get(column).is_some(), "{key}: {column} in {row}");
            }
            assert_eq!(
                row.as_object().unwrap().len(),
                columns.len(),
                "{key}: {row}"
            );
        }
    }
    let rows = |key: &str, column: &str, part: &str| {
        let all = found["tables"][key]["rows"].as_array().unwrap();
        let own = all
            .iter()
            .filter(|row| row[column].as_str().is_some_and(|text| text.contains(part)));
        own.cloned().collect::<Vec<Value>>()
    };
    let solved = rows("pair", "method", "nearmiss");
    assert_eq!(solved.len(), 12);
    assert!(
        solved.iter().all(|row| row["wrong_minima"] == 0),
        "{solved:?}"
    );
    let screened = rows("stepped", "method", "nearmiss");
    let is_right = |row: &Value| row["missed"] == 0 && row["false"] == 0 && row["encounters"] != 0;
    assert!(
        screened.len() == 2 && screened.iter().all(is_right),
        "{screened:?}"
    );
    let knots = found["tables"]["knots"]["rows"].as_array().unwrap();
    assert!(
        knots.iter().all(|row| row["missed_with_error"] == 0),
        "{knots:?}"
    );
    // Whether the boxes touch is proven for each encounter of their spheres.
    let spheres = found["tables"]["spheres"]["rows"].as_array().unwrap();
    assert!(spheres.iter().all(|row| {
        let [touch, never, all] =
            ["boxes_touch", "false", "encounters"].map(|column| row[column].as_u64());
        touch.zip(never).map(|(touch, never)| touch + never) == all
    }));
    let baked = found["tables"]["baking"]["rows"].as_array().unwrap();
    assert!(
        baked
            .iter()
            .all(|row| row["encounters"].as_u64() >= row["certified"].as_u64())
    );
    for picture in ["tradeoff-pair.svg", "tradeoff-stepped.svg"] {
        let drawn = std::fs::read_to_string(pictures.join(picture)).unwrap();
        assert!(
            drawn.contains("nearmiss") && drawn.ends_with("</svg>\n"),
            "{picture}"
        );
    }
}
