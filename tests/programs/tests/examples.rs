//! The examples `many_body`, `game_loop`, `cover` and `physics` as programs: what they refuse, and how.

#![allow(
    clippy::unwrap_used,
    reason = "a file or process that fails, fails the test"
)]

#[path = "support/example.rs"]
mod example;

use example::{example, folder, plain};
use std::path::Path;
use std::process::{Command, Output};

fn many_body(picture: &Path, options: &[&str]) -> Command {
    let mut command = example("many_body");
    command
        .args(["--scene", "swarm", "--bodies", "50", "--picture"])
        .arg(picture)
        .args(options);
    command
}

fn game_loop(options: &[&str]) -> Command {
    let mut command = example("game_loop");
    command
        .args(["--headless", "--bodies", "20", "--seconds", "0.5"])
        .args(options);
    command
}

/// Ends with this code and a message that holds all of `parts`, before anything was done.
fn refuses(code: i32, command: &mut Command, parts: &[&str]) {
    let Output {
        status,
        stdout,
        stderr,
    } = command.output().unwrap();
    let said = plain(&stderr);
    assert_eq!(status.code(), Some(code), "{parts:?}: {said}");
    assert!(stdout.is_empty(), "{parts:?}");
    for part in parts {
        assert!(said.contains(part), "no {part:?} in {said}");
    }
}

#[test]
fn options_out_of_range() {
    let picture = folder("ranges").join("picture.svg");
    for threads in ["-1", "1025", "99999999", "99999999999999999999"] {
        let options = ["--threads", threads];
        refuses(2, &mut many_body(&picture, &options), &options);
        refuses(2, &mut game_loop(&options), &options);
        refuses(2, example("physics").args(options), &options);
    }
    for bodies in ["-1", "0", "18446744073709551615"] {
        let options = ["--bodies", bodies];
        refuses(2, example("many_body").args(options), &options);
        refuses(2, example("game_loop").args(options), &options);
        refuses(2, example("physics").args(options), &options);
    }
    for options in [
        ["--frames", "0"],
        ["--frames", "1e3"],
        ["--boxes", "-1"],
        ["--boxes", "1000001"],
        ["--seed", "-1"],
    ] {
        refuses(2, example("physics").args(options), &options);
    }
    for margin in ["nan", "1e301", "wide"] {
        let options = ["--margin", margin];
        refuses(2, &mut many_body(&picture, &options), &["--margin"]);
    }
    for options in [
        ["--replan", "-0.1"],
        ["--replan", "1.5"],
        ["--replan", "NaN"],
    ] {
        refuses(2, &mut game_loop(&options), &[options[0], "0..=1"]);
    }
    for seconds in ["-1", "0", "1e9", "inf"] {
        let mut command = example("game_loop");
        command.args(["--headless", "--seconds", seconds]);
        refuses(2, &mut command, &["--seconds", "0.01..=1000000"]);
    }
    assert!(!picture.exists());
}

#[test]
fn covers_that_cannot_be() {
    let folder = folder("covers");
    let picture = folder.join("cover.svg");
    let cover = |options: &[&str]| {
        let mut command = example("cover");
        command.args(options).arg("--picture").arg(&picture);
        command
    };
    for (options, part) in [
        (&["box", "1", "2", "-4", "--spheres", "4"][..], "<Z>"),
        (&["box", "1", "2", "--spheres", "4"], "<Z>"),
        (&["capsule", "nan", "2", "--spheres", "4"], "<RADIUS>"),
        (&["cylinder", "1", "2", "--spheres", "0"], "1..=4096"),
        (&["cylinder", "1", "2"], "--spheres"),
        (&["sphere", "1", "--spheres", "4"], "sphere"),
    ] {
        refuses(2, &mut cover(options), &[part]);
    }
    let file = |name: &str, text: &str| {
        let path = folder.join(name);
        std::fs::write(&path, text).unwrap();
        path
    };
    // A header, and 5 triangles that are not there.
    let cut_off = format!("{}\x05\0\0\0", " ".repeat(80));
    for (path, part) in [
        (folder.join("none.obj"), "none.obj"),
        (folder.join("mesh.ply"), ".stl"),
        (file("empty.obj", ""), "no triangles"),
        (
            file("nan.obj", "v 0 0 nan\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"),
            "nan.obj",
        ),
        (
            file("beyond.obj", "v 0 0 0\nv 1 0 0\nf 1 2 3\n"),
            "beyond.obj: not read as OBJ: face vertex index out of bounds",
        ),
        (
            file("huge.obj", "v 0 0 1e300\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"),
            "huge.obj: a corner at [0, 0, inf]: coordinates are finite, and not beyond 3.4e38",
        ),
        (
            file("bad.stl", "solid x\n facet\n"),
            "bad.stl: not read as STL: ",
        ),
        (
            file("cut.stl", &cut_off),
            "cut.stl: not read as STL: the file ends too early",
        ),
    ] {
        let path = path.to_str().unwrap();
        let mut command = cover(&["mesh", path, "--spheres", "2"]);
        refuses(1, &mut command, &["error: ", part]);
    }
    assert!(!picture.exists());
    // Some programs begin a text with a byte order mark.
    let corner = "\u{feff}v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n";
    let corner = file("corner.obj", corner);
    let options = ["mesh", corner.to_str().unwrap(), "--spheres", "2", "--json"];
    let said = cover(&options).output().unwrap();
    assert!(said.status.success() && picture.exists());
    let said = plain(&said.stdout);
    let line: serde_json::Value = serde_json::from_str(said.lines().last().unwrap()).unwrap();
    assert_eq!(line["spheres"].as_array().unwrap().len(), 2);
    // One of two balls holds two of the corners on the axes: no two do better than 44.4 %.
    assert!((44.0..45.0).contains(&line["overshoot_percent"].as_f64().unwrap()));
    assert!(line["volume_ratio"].as_f64().unwrap() > 1.0);
    assert!(line["seconds"].as_f64().unwrap() > 0.0);
}

/// Of the contacts that the engine has, each is predicted that no deflection makes unpredictable.
#[test]
fn contacts_of_physics_are_predicted() {
    let result = example("physics")
        .args(["--frames", "120", "--bodies", "600", "--boxes", "60"])
        .args(["--seed", "7", "--threads", "2", "--json"])
        .output()
        .unwrap();
    let (said, refused) = (plain(&result.stdout), plain(&result.stderr));
    assert!(result.status.success() && refused.is_empty(), "{refused}");
    let line: serde_json::Value = serde_json::from_str(said.lines().last().unwrap()).unwrap();
    for (field, value) in [("frames", 120), ("bodies", 600), ("boxes", 60), ("seed", 7)] {
        assert_eq!(line[field], value, "{field}");
    }
    let positive = |of: &serde_json::Value, field: &str| of[field].as_f64().unwrap() > 0.0;
    for of in ["physics", "nearmiss"] {
        for field in [format!("{of}_ms_p50"), format!("{of}_ms_p99")] {
            assert!(positive(&line, &field), "{field}");
        }
    }
    assert!(positive(&line, "overshoot_m") && positive(&line, "overshoot_percent"));
    assert!(positive(&line, "wall_contacts"));
    for (name, least) in [("ball_ball", 100), ("ball_box", 20), ("box_box", 1)] {
        let pair = &line["pairs"][name];
        let count = |field: &str| pair[field].as_u64().unwrap();
        let sum = |fields: &[&str]| fields.iter().map(|field| count(field)).sum::<u64>();
        assert!(count("free") >= least, "{pair}");
        assert!(count("free") <= count("contacts"), "{pair}");
        assert_eq!(count("unpredicted"), 0, "{pair}");
        assert_eq!(count("predicted"), count("free"), "{pair}");
        let judged = ["deflected", "came_true", "between_frames", "failed"];
        assert_eq!(
            count("predictions"),
            sum(&judged) + count("ahead"),
            "{pair}"
        );
        assert!(positive(pair, "error_ms_p50") && positive(pair, "error_ms_p99"));
        assert!(positive(pair, "warning_s_p50"));
    }
    // A ball is the sphere that the monitor has for it: no prediction fails, and instants differ by
    // f32 rounding alone.
    let balls = &line["pairs"]["ball_ball"];
    assert_eq!(balls["failed"], 0, "{balls}");
    assert_eq!(balls["came_true"], balls["free"], "{balls}");
    assert!(balls["error_ms_p50"].as_f64().unwrap() < 0.1, "{balls}");
}

#[test]
fn pictures_that_cannot_be() {
    let folder = folder("pictures");
    let nowhere = folder.join("no-such-folder").join("picture.svg");
    let parts = ["error: ", "no-such-folder"];
    refuses(1, &mut many_body(&nowhere, &[]), &parts);
    let states = ["--states", nowhere.to_str().unwrap()];
    let picture = folder.join("picture.svg");
    refuses(1, &mut many_body(&picture, &states), &parts);
    let states = ["--states", picture.to_str().unwrap()];
    refuses(2, &mut many_body(&picture, &states), &["--picture"]);
    assert!(!picture.exists());
    let picture = folder.join("picture.png");
    let screenshot = ["--screenshot", picture.to_str().unwrap()];
    refuses(
        2,
        &mut game_loop(&screenshot),
        &["--headless", "--screenshot"],
    );
    let mut window = example("game_loop");
    refuses(2, window.args(["--screenshot", "picture.txt"]), &[".png"]);
    let mut window = example("game_loop");
    window
        .arg("--screenshot")
        .arg(nowhere.with_extension("png"));
    refuses(1, &mut window, &parts);
    assert!(!picture.exists());
}

/// Nothing that a terminal obeys comes out of what was given.
#[test]
fn names_are_escaped() {
    let hostile = "a\u{1b}[2Jb\u{9b}2Jc";
    let nowhere = folder("escaped").join(hostile).join("picture.png");
    let shown = r"a\u{1b}[2Jb\u{9b}2Jc";
    refuses(1, &mut many_body(&nowhere, &[]), &[shown]);
    let mut window = example("game_loop");
    refuses(1, window.arg("--screenshot").arg(&nowhere), &[shown]);
    for (name, option) in [("many_body", "--scene"), ("game_loop", "--avoid")] {
        for option in [option, hostile] {
            let mut command = example(name);
            refuses(2, command.args([option, hostile]), &[r"\u{9b}2J"]);
        }
    }
    let picture = folder("drawn").join(hostile);
    let drawn = many_body(&picture, &[]).output().unwrap();
    assert!(drawn.status.success() && picture.exists());
    assert!(plain(&drawn.stdout).contains(shown));
}

/// The window's fleet: contacts take place, with the floor as well, and each was predicted. Bodies that avoid them have none.
#[test]
fn ships_are_predicted() {
    let run = |options: &[&str]| {
        let mut command = example("game_loop");
        let options = ["--headless", "--seconds", "6", "--seed", "2"]
            .iter()
            .chain(options);
        let result = command.args(options).output().unwrap();
        assert!(result.status.success(), "{}", plain(&result.stderr));
        let line: serde_json::Value = serde_json::from_slice(&result.stdout).unwrap();
        line
    };
    let careless = run(&["--ships", "--bodies", "300", "--avoid", "off"]);
    assert!(careless["collisions"].as_u64().unwrap() > 3, "{careless}");
    assert!(careless["grounded"].as_u64().unwrap() > 0, "{careless}");
    assert_eq!(careless["unpredicted"], 0, "{careless}");
    assert_eq!(careless["lost"], 0, "{careless}");
    let careful = run(&["--ships", "--avoid", "on"]);
    assert_eq!(careful["collisions"], 0, "{careful}");
    assert_eq!(careful["grounded"], 0, "{careful}");
    assert_eq!(careful["unpredicted"], 0, "{careful}");
    // The yardstick is what it was, and has other bodies.
    let spheres = run(&["--bodies", "300"]);
    assert!(spheres.get("unpredicted").is_none(), "{spheres}");
    refuses(2, example("game_loop").arg("--ships"), &["--headless"]);
    let help = example("game_loop").arg("--help").output().unwrap();
    let help = plain(&help.stdout);
    let help = help.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(
        help.contains("not those of the window unless --ships"),
        "{help}"
    );
}

/// Whoever runs these tests alone tests what is written now.
#[test]
fn examples_are_built_of_their_sources() {
    for name in ["screen", "many_body", "game_loop", "physics"] {
        let written = |path: &Path| path.metadata().unwrap().modified().unwrap();
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples");
        let sources = written(&folder.join(name).join("main.rs"));
        let built = written(Path::new(example(name).get_program()));
        assert!(built >= sources, "{name} is older than its sources");
    }
}

#[test]
fn a_crowd_is_explained() {
    let picture = folder("crowd").join("picture.svg");
    // So many bodies that it is found out at once.
    let Output { status, stderr, .. } = example("many_body")
        .args(["--scene", "asteroids", "--bodies", "30000"])
        .args(["--margin", "1e12", "--threads", "2", "--picture"])
        .arg(&picture)
        .output()
        .unwrap();
    let said = String::from_utf8(stderr).unwrap();
    assert_eq!(status.code(), Some(1), "{said}");
    assert!(said.starts_with("error: too many pairs"), "{said}");
    assert!(!picture.exists());
}

/// One who has seen enough does not end the work: the picture is drawn, the exit code is 0.
#[test]
fn nobody_reads_what_is_said() {
    let picture = folder("unread").join("picture.svg");
    for mut command in [many_body(&picture, &["--monitor"]), game_loop(&[])] {
        let (reader, writer) = std::io::pipe().unwrap();
        drop(reader);
        let result = command.stdout(writer).output().unwrap();
        let said = String::from_utf8(result.stderr).unwrap();
        assert_eq!(result.status.code(), Some(0), "{said}");
        assert!(said.is_empty(), "{said}");
    }
    let drawn = std::fs::read_to_string(&picture).unwrap();
    assert!(drawn.starts_with("<svg") && drawn.trim_end().ends_with("</svg>"));
}

#[test]
fn what_is_said() {
    let picture = folder("said").join("picture.svg");
    let result = many_body(&picture, &["--threads", "0"]).output().unwrap();
    let said = String::from_utf8(result.stdout).unwrap();
    assert!(said.contains(picture.to_str().unwrap()), "{said}");
    // How well splines describe the world is not known to any of them.
    assert!(said.contains("of the splines"), "{said}");
    let result = example("screen").arg("--help").output().unwrap();
    let said = plain(&result.stdout);
    let certified = said.split("certified").nth(1).unwrap();
    assert!(certified.contains("of the spline"), "{said}");
    let result = game_loop(&["--threads", "1024"]).output().unwrap();
    let said = String::from_utf8(result.stdout).unwrap();
    assert!(said.starts_with("{\"ticks\":30,"), "{said}");
}
