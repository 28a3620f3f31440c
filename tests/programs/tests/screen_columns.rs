//! The `screen` example goes by the header of its file: order, case, separator, names, radii, columns of others.

#![allow(
    clippy::unwrap_used,
    reason = "a file or process that fails, fails the test"
)]

#[path = "support/example.rs"]
mod example;

use example::{example, folder, plain};
use std::path::{Path, PathBuf};

/// Two bodies that pass at 2 m, at t = 6.
const HEADER: [&str; 8] = ["body", "t", "px", "py", "pz", "vx", "vy", "vz"];
const PASS: [[&str; 8]; 4] = [
    ["7", "0", "-6", "2", "0", "1", "0", "0"],
    ["7", "12", "6", "2", "0", "1", "0", "0"],
    ["3", "0", "0", "0", "0", "0", "0", "0"],
    ["3", "12", "0", "0", "0", "0", "0", "0"],
];
const FOUND: &str = "a,b,enter,exit,tca,separation,error,clip,resolved\n3,7,4.5,7.5,6,2,,0,\n";

fn screened(path: &Path, options: &[&str]) -> (String, String) {
    let result = example("screen").arg(path).args(options).output().unwrap();
    let said = plain(&result.stderr);
    assert!(result.status.success(), "{said}");
    (String::from_utf8(result.stdout).unwrap(), said)
}

fn file(name: &str, content: &str) -> PathBuf {
    let path = folder(name).join("states.csv");
    std::fs::write(&path, content).unwrap();
    path
}

fn conflicts(name: &str, content: &str, options: &[&str]) -> (String, String) {
    screened(&file(name, content), options)
}

/// The table with its columns in this order.
fn table(order: [usize; 8], separator: &str, rename: impl Fn(&str) -> String) -> String {
    let pick = |row: &[&str; 8]| order.map(|place| row[place].to_owned()).join(separator);
    let header = HEADER.map(rename);
    let header = pick(&header.each_ref().map(|name| &name[..]));
    let rows = PASS.iter().map(pick);
    std::iter::once(header)
        .chain(rows)
        .map(|row| row + "\n")
        .collect()
}

#[test]
fn any_order_case_separator_and_line_end() {
    for order in [
        [0, 1, 2, 3, 4, 5, 6, 7],
        [7, 6, 5, 4, 3, 2, 1, 0],
        [1, 0, 5, 2, 6, 3, 7, 4],
    ] {
        for separator in [",", ";", "\t"] {
            for rename in [str::to_lowercase, str::to_uppercase, |name: &str| {
                format!(" {name} ")
            }] {
                let unix = table(order, separator, rename);
                let dos = format!("\u{feff}{}", unix.replace('\n', "\r\n"));
                for text in [unix, dos] {
                    let found = conflicts("order", &text, &["--margin", "2.5"]);
                    assert_eq!(found, (FOUND.to_owned(), String::new()), "{text}");
                }
            }
        }
    }
}

#[test]
fn other_columns_are_ignored_and_said_so() {
    let text = table([0, 1, 2, 3, 4, 5, 6, 7], ";", str::to_owned);
    let text = text.replace(";t;", ";call sign;t;\"note; remark\";");
    let text = text
        .replace("\n7;", "\n7;KLM, 12;")
        .replace("\n3;", "\n3;;");
    let text = text
        .replace(";0;-6", ";0;x;-6")
        .replace(";12;6", ";12;\"a;b\";6");
    let text = text.replace(";0;0;0;0;0;0;0", ";0;;0;0;0;0;0;0");
    let text = text.replace(";12;0;0;0;0;0;0", ";12;;0;0;0;0;0;0");
    let (found, said) = conflicts("others", &text, &["--margin", "2.5"]);
    assert_eq!(found, FOUND);
    assert_eq!(said, "not used: column \"call sign\", \"note; remark\"\n");
    // The line of statistics stays one of its own.
    let options = ["--margin", "2.5", "--stats", "json"];
    let (_, said) = conflicts("others", &text, &options);
    let last = said.lines().last().unwrap();
    assert!(serde_json::from_str::<serde_json::Value>(last).is_ok());
    assert_eq!(said.lines().count(), 2);
}

/// Names are in the order of their first appearance, numbers in their own; one name makes all labels names.
#[test]
fn names_and_numbers() {
    let named = |first: &str, second: &str| {
        let text = table([0, 1, 2, 3, 4, 5, 6, 7], ",", str::to_owned);
        let text = text.replace("\n7,", &format!("\n{first},"));
        text.replace("\n3,", &format!("\n{second},"))
    };
    for (first, second, shown) in [
        ("7", "3", "3,7"),
        ("007", "3", "3,7"),
        ("18446744073709551615", "3", "3,18446744073709551615"),
        ("zeppelin", "ant", "zeppelin,ant"),
        ("7", "ant", "7,ant"),
        ("007", "-3", "007,-3"),
        ("10", "9.5", "10,9.5"),
        (
            "na\u{ef}ve \u{6570}",
            "it's \\n",
            "na\u{ef}ve \u{6570},it's \\n",
        ),
        (
            "\"Rock, the \"\"old\"\"\"",
            "tug;2",
            "\"Rock, the \"\"old\"\"\",tug;2",
        ),
    ] {
        let (found, said) = conflicts("names", &named(first, second), &["--margin", "2.5"]);
        assert_eq!(found, FOUND.replace("3,7", shown));
        assert_eq!(said, "");
    }
    // What was read as a number before the first name is a name as it is written.
    let labels = ["1", "01", "+1", "10", "1x"];
    let rows = labels.map(|label| format!("{label},0,0,0,0,0,0,0\n{label},1,0,0,0,0,0,0\n"));
    let text = format!("{}\n{}", HEADER.join(","), rows.concat());
    let (found, _) = conflicts("late-name", &text, &[]);
    let pairs = (0..5).flat_map(|a| (a + 1..5).map(move |b| (a, b)));
    let expected: Vec<String> = pairs
        .map(|(a, b)| format!("{},{},0,1,0,0,,3,", labels[a], labels[b]))
        .collect();
    assert_eq!(found.lines().skip(1).collect::<Vec<_>>(), expected);
    // Two spellings of a number are one body; two names are not.
    let text = named("7", "3");
    let spelled = text.replacen("\n7,12", "\n07,12", 1);
    assert_eq!(
        conflicts("spelled", &spelled, &["--margin", "2.5"]).0,
        FOUND
    );
    let path = file("spelled", &spelled.replace("\n3,", "\nant,"));
    let refused = example("screen").arg(&path).output().unwrap();
    let said = plain(&refused.stderr);
    assert!(
        said.contains("row 2, column body: body \"7\" has 1 row"),
        "{said}"
    );
}

#[test]
fn one_radius_a_body() {
    let text = table([0, 1, 2, 3, 4, 5, 6, 7], ",", str::to_owned);
    let mut radii = ["Radius", "0.25", "0.250", "0.5", "5e-1"].into_iter();
    let text: String = text
        .lines()
        .map(|line| format!("{},{line}\n", radii.next().unwrap()))
        .collect();
    let (found, said) = conflicts("radius", &text, &["--margin", "1.75"]);
    assert_eq!(found, FOUND.replace(",6,2,", ",6,1.25,"));
    assert_eq!(said, "");
    let path = file("radius", &text.replace("0.250,", "0.26,"));
    let refused = example("screen").arg(&path).output().unwrap();
    let said = plain(&refused.stderr);
    assert!(
        said.ends_with(
            "row 3, column radius: 0.26 is not 0.25, the radius of body 7 in row 2; a body has one radius\n"
        ),
        "{said}"
    );
}

/// The sample that the documentation points to: names, radii, and a few conflicts of all kinds.
#[test]
fn the_sample() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/sample.csv");
    let (found, said) = screened(&path, &["--margin", "5"]);
    assert_eq!(said, "");
    let rows: Vec<Vec<&str>> = found
        .lines()
        .skip(1)
        .map(|line| line.split(',').collect())
        .collect();
    let pairs: Vec<(&str, &str)> = rows.iter().map(|row| (row[0], row[1])).collect();
    assert_eq!(
        pairs,
        [
            ("survey-1", "survey-2"),
            ("survey-1", "survey-2"),
            ("sailboat", "tug"),
            ("courier-1", "courier-2"),
            ("courier-3", "courier-4"),
            ("ferry", "crane"),
            ("survey-1", "survey-2"),
        ]
    );
    let separation = |row: usize| rows[row][5].parse::<f64>().unwrap();
    // Two collide, one of them by far, and one stays near until its plan ends.
    assert!((-9.0..-8.0).contains(&separation(2)) && (-2.0..-1.9).contains(&separation(5)));
    assert_eq!((rows[4][3], rows[4][7]), ("110", "2"));
    let (certified, _) = screened(&path, &["--margin", "5", "--accuracy", "certified"]);
    let resolved = certified
        .lines()
        .skip(1)
        .all(|line| line.split(',').nth(8) == Some("1"));
    assert!(resolved && certified.lines().count() == 8, "{certified}");
}

/// The states that `many_body` writes are the scene that it screens.
#[test]
fn a_scene_comes_back() {
    let folder = folder("scene");
    for (scene, bodies, options) in [
        (
            "satellites",
            "700",
            &["--radius", "5", "--margin", "50000"][..],
        ),
        ("asteroids", "800", &["--margin", "200"]),
    ] {
        let mut tables = Vec::new();
        for name in ["states.csv", "states.csv.GZ"] {
            let path = folder.join(name);
            let made = example("many_body")
                .args(["--scene", scene, "--bodies", bodies, "--margin"])
                .arg(options.last().unwrap())
                .arg("--states")
                .arg(&path)
                .arg("--picture")
                .arg(folder.join("picture.svg"))
                .output()
                .unwrap();
            assert!(made.status.success(), "{}", plain(&made.stderr));
            let said = plain(&made.stdout);
            // The command that it names, and how many it found.
            let command = said.lines().last().unwrap();
            let expected = format!("screen {} {}", path.display(), options.join(" "));
            assert!(command.ends_with(&expected), "{command}");
            let count = said
                .lines()
                .find(|line| line.contains("  encounters "))
                .unwrap();
            let count = count.split_whitespace().nth(1).unwrap().replace(',', "");
            let (found, _) = screened(&path, options);
            assert_eq!(found.lines().count(), 1 + count.parse::<usize>().unwrap());
            assert!(found.lines().count() > 10, "{scene}: {found}");
            tables.push((found, std::fs::read(&path).unwrap()));
        }
        let header = String::from_utf8_lossy(&tables[0].1[..40]).into_owned();
        let radius = if scene == "asteroids" { ",radius" } else { "" };
        assert!(
            header.starts_with(&format!("{}{radius}\n", HEADER.join(","))),
            "{header}"
        );
        assert_eq!(tables[0].0, tables[1].0);
        assert_eq!(tables[1].1[..2], [0x1f, 0x8b]);
    }
}
