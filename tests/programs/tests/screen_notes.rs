//! The notes of `screen` on input that is accepted, and probably not meant.

#![allow(
    clippy::unwrap_used,
    reason = "a file or process that fails, fails the test"
)]

#[path = "support/example.rs"]
mod example;

use example::{example, folder, plain};

const HEADER: &str = "body,t,px,py,pz,vx,vy,vz\n";

/// Neither a radius nor a margin: nothing is found, and somebody has to say why.
#[test]
fn points_without_a_margin() {
    let folder = folder("wrong-points");
    let states =
        format!("{HEADER}0,0,0,0,0,0,0,0\n0,9,0,0,0,0,0,0\n1,0,1,0,0,0,0,0\n1,9,1,0,0,0,0,0\n");
    std::fs::write(folder.join("states.csv"), states).unwrap();
    let note = "note: nothing is found, since the bodies are points and the margin is 0 m: give --radius or a larger \
                --margin\n";
    for (option, expected) in [
        ("--margin=0", note),
        ("--margin=1", ""),
        (
            "--radius=0.1",
            "note: no two bodies come within 0 m of each other: a larger --margin finds near misses\n",
        ),
    ] {
        let mut command = example("screen");
        let result = command
            .args(["states.csv", option])
            .current_dir(&folder)
            .output();
        let result = result.unwrap();
        assert!(result.status.success());
        assert_eq!(plain(&result.stderr), expected);
    }
}

/// Bodies that miss each other: a table without rows does not say so by itself.
#[test]
fn no_two_bodies_come_near() {
    let folder = folder("wrong-far");
    let states =
        format!("{HEADER}0,0,0,0,0,0,0,0\n0,9,0,0,0,0,0,0\n1,0,9,0,0,0,0,0\n1,9,9,0,0,0,0,0\n");
    std::fs::write(folder.join("states.csv"), states).unwrap();
    for (options, expected) in [
        (
            ["--margin=2", "--radius=0"],
            "note: no two bodies come within 2 m of each other\n",
        ),
        (
            ["--margin=0", "--radius=1"],
            "note: no two bodies come within 0 m of each other: a larger --margin finds near misses\n",
        ),
        (
            ["--margin=-1e300", "--radius=1"],
            "note: no two bodies come within -1e300 m of each other: a larger --margin finds near misses\n",
        ),
        (
            ["--window=3..", "--radius=1"],
            "note: no two bodies come within 0 m of each other in the window 3.000.. s: a larger --margin finds near \
             misses\n",
        ),
        (
            ["--window=..3", "--margin=0"],
            "note: nothing is found in the window ..3.000 s, since the bodies are points and the margin is 0 m: give \
             --radius or a larger --margin\n",
        ),
    ] {
        let mut command = example("screen");
        let command = command.arg("states.csv").args(options);
        let result = command.current_dir(&folder).output().unwrap();
        assert!(result.status.success());
        assert_eq!(plain(&result.stderr), expected);
    }
}

/// A window in another count of time than the file's: nothing is found, and somebody has to say why.
#[test]
fn a_window_in_which_no_body_exists() {
    let folder = folder("wrong-window");
    let states =
        format!("{HEADER}0,0,0,0,0,0,0,0\n0,9,0,0,0,0,0,0\n1,0,9,0,0,0,0,0\n1,9,9,0,0,0,0,0\n");
    std::fs::write(folder.join("states.csv"), states).unwrap();
    for (window, expected) in [
        (
            "--window=100..200",
            "note: the window is 100.000..200.000 s, and no body exists then; the states cover 0.000..9.000 s\n",
        ),
        (
            "--window=9..200",
            "note: no two bodies come within 1 m of each other in the window 9.000..200.000 s\n",
        ),
    ] {
        let mut command = example("screen");
        let arguments = ["states.csv", window, "--margin=1"];
        let result = command.args(arguments).current_dir(&folder).output();
        let result = result.unwrap();
        assert!(result.status.success());
        assert_eq!(plain(&result.stderr), expected);
    }
}

/// Files that are not wrong, but probably not as they are meant: somebody has to say so.
#[test]
fn files_that_are_probably_not_meant() {
    let folder = folder("wrong-meant");
    // Time in ms, positions in km, velocities that are made up of zeros, and all as it should be.
    let two = |duration: f64, unit: f64, speed: f64| {
        let rows = (0..2).flat_map(|body| {
            let row = move |time: f64, x: f64| format!("{body},{time},{x},{body},0,{speed},0,0\n");
            [row(0.0, 0.0), row(duration, 30.0 * unit)]
        });
        rows.collect::<String>()
    };
    for (rows, expected) in [
        (two(3.0, 1.0, 10.0), ""),
        (
            two(3.0, 1.0, 0.0),
            "note: bodies go elsewhere from their first row to the second, but all velocities in these rows are 0: \
             bodies stop in each row\n",
        ),
        (
            two(3000.0, 1.0, 10.0),
            "note: from their first row to the second, bodies go 0.001 times as far as their velocities say: check \
             the units, m, s and m/s\n",
        ),
        (
            two(3.0, 1e-3, 10.0),
            "note: from their first row to the second, bodies go 0.001 times as far as their velocities say: check \
             the units, m, s and m/s\n",
        ),
        (
            "ant,0,0,0,0,1,0,0\nant,1,1,0,0,1,0,0\n".to_owned(),
            "note: there is one body, and no other one that it could meet\n",
        ),
    ] {
        std::fs::write(folder.join("states.csv"), format!("{HEADER}{rows}")).unwrap();
        let mut command = example("screen");
        let command = command.args(["states.csv", "--margin=1"]);
        let result = command.current_dir(&folder).output().unwrap();
        assert!(result.status.success());
        assert_eq!(plain(&result.stderr), expected, "{rows}");
    }
}
