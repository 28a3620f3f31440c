//! The example `tradeoff` with a file of states.

#![cfg(all(feature = "parallel", feature = "live"))]
#![allow(clippy::unwrap_used, reason = "a failure fails the test")]

#[path = "support/example.rs"]
mod example;

use example::{example, folder, plain};
use serde_json::Value;
use std::fs::read_to_string;
use std::path::Path;
use std::process::Output;

const FILE: &str = "states.csv";

/// Two bodies that pass each other 3 m apart within `seconds`.
fn passing(seconds: f64, radii: Option<[f64; 2]>) -> String {
    let mut file = "body,t,px,py,pz,vx,vy,vz,colour".to_owned();
    file.push_str(if radii.is_some() { ",radius\n" } else { "\n" });
    for (body, height) in [(0, 0.0), (1, 3.0)] {
        for (t, x) in [(0.0, -20.0), (seconds, 20.0)] {
            let (side, speed) = (f64::from(1 - 2 * body), 40.0 / seconds);
            let (x, v) = (side * x, side * speed);
            let radius = radii.map_or(String::new(), |radii| {
                let own = radii[usize::from(body == 1)];
                format!(",{own}")
            });
            file.push_str(&format!("{body},{t},{x},{height},0,{v},0,0,red{radius}\n"));
        }
    }
    file
}

fn stepped(folder: &Path, file: &str, options: &[&str]) -> Output {
    std::fs::write(folder.join(FILE), file).unwrap();
    let mut command = example("tradeoff");
    command.args(["--quick", "--only", "stepped", "--states", FILE]);
    command.args(options).current_dir(folder).output().unwrap()
}

/// The rows of a table in `out.json`.
fn written(folder: &Path, table: &str) -> Vec<Value> {
    let written = read_to_string(folder.join("out.json")).unwrap();
    let written: Value = serde_json::from_str(&written).unwrap();
    written["tables"][table]["rows"].as_array().unwrap().clone()
}

/// The numbers of a column.
fn column(rows: &[Value], name: &str) -> Vec<u64> {
    rows.iter().map(|row| row[name].as_u64().unwrap()).collect()
}

/// The rows of one table of a part, of generated bodies.
fn generated(folder: &Path, part: &str, table: &str, options: &[&str]) -> Vec<Value> {
    let mut command = example("tradeoff");
    command.args(["--quick", "--only", part, "--json", "out.json"]);
    let done = command.args(options).current_dir(folder).output().unwrap();
    assert!(done.status.success(), "{}", plain(&done.stderr));
    written(folder, table)
}

/// The encounters of each row of the table.
fn encounters(folder: &Path, file: &str, options: &[&str]) -> Vec<u64> {
    let json = [options, &["--json", "out.json"]].concat();
    let Output { status, stderr, .. } = stepped(folder, file, &json);
    let said = plain(&stderr);
    assert!(status.success(), "{said}");
    assert_eq!(said, "not used: column \"colour\"\n");
    column(&written(folder, "stepped"), "encounters")
}

/// The file's radius counts, or that of the command line, or half a metre.
#[test]
fn radii() {
    let folder = folder("tradeoff-radii");
    let (none, two) = (passing(10.0, None), passing(10.0, Some([2.0; 2])));
    let found = encounters(&folder, &none, &[]);
    assert!(
        found.len() > 2 && found.iter().all(|&found| found == 0),
        "{found:?}"
    );
    let different = [0.25, 2.5].map(|other| passing(10.0, Some([0.625, other])));
    for (file, options, count) in [
        (&two, &[][..], 1),
        (&none, &["--radius", "2"], 1),
        (&different[0], &[], 0),
        (&different[1], &[], 1),
        (&different[1], &["--margin", "-0.25"], 0),
    ] {
        let found = encounters(&folder, file, options);
        assert!(
            found.len() > 2 && found.iter().all(|&found| found == count),
            "{found:?}"
        );
        // Frames see it as well: 60 a second.
        let rows = written(&folder, "stepped");
        assert!(column(&rows, "missed").iter().all(|&missed| missed == 0));
        assert!(column(&rows, "false").iter().all(|&wrong| wrong == 0));
    }
}

/// Nothing is missed where there is nothing to find: that says nothing of a rate.
#[test]
fn no_rate_is_told_without_encounters() {
    let folder = folder("tradeoff-none");
    for (radius, is_told) in [("0.5", false), ("2", true)] {
        let done = stepped(&folder, &passing(10.0, None), &["--radius", radius]);
        let said = plain(&done.stdout);
        assert_eq!(said.contains("misses nothing from"), is_told, "{said}");
    }
}

/// Standard input may come from the file that is to be written.
#[cfg(unix)]
#[test]
fn the_file_of_standard_input_is_not_overwritten() {
    let folder = folder("tradeoff-input");
    let path = folder.join(FILE);
    std::fs::write(&path, passing(10.0, None)).unwrap();
    let mut command = example("tradeoff");
    command.args([
        "--quick", "--only", "stepped", "--states", "-", "--json", FILE,
    ]);
    let command = command.stdin(std::fs::File::open(&path).unwrap());
    let done = command.current_dir(&folder).output().unwrap();
    let said = plain(&done.stderr);
    assert_eq!(done.status.code(), Some(2), "{said}");
    assert!(
        said.contains("--json states.csv is the file of states itself"),
        "{said}"
    );
    assert_eq!(read_to_string(path).unwrap(), passing(10.0, None));
}

/// The picture of a scene without encounters: all are found, and the scale begins near by.
#[test]
fn a_picture_without_encounters() {
    let folder = folder("tradeoff-picture");
    let done = stepped(
        &folder,
        &passing(10.0, None),
        &["--pictures", "drawn/pictures"],
    );
    assert!(done.status.success(), "{}", plain(&done.stderr));
    let drawn = read_to_string(folder.join("drawn/pictures/tradeoff-stepped.svg")).unwrap();
    let labels: Vec<&str> = drawn
        .lines()
        .filter(|line| !line.starts_with('<'))
        .collect();
    assert!(
        labels.contains(&"100") && !labels.contains(&"20"),
        "{labels:?}"
    );
}

/// At a thousand million seconds there are too many ticks for a monitor as well.
#[test]
fn a_file_of_many_years() {
    let folder = folder("tradeoff-years");
    let found = encounters(&folder, &passing(2e9, None), &["--radius", "2"]);
    assert_eq!(found, [1]);
}

#[test]
fn what_is_refused() {
    let folder = folder("tradeoff-refused");
    let pictures = folder.join("pictures");
    std::fs::create_dir(&pictures).unwrap();
    let link = pictures.join("tradeoff-pair.svg");
    #[cfg(unix)]
    std::os::unix::fs::symlink(Path::new("..").join(FILE), link).unwrap();
    let (two, large) = (Some([2.0; 2]), Some([2e9; 2]));
    for (radii, options, code, said) in [
        (
            two,
            &["--radius", "2"][..],
            1,
            "--radius: states.csv has a column radius; leave one of the two out",
        ),
        (
            Some([2.0, 0.5]),
            &["--margin", "-2"],
            1,
            "--margin: a radius of 0.5 m and half of -2e0 m are not within 0 and 1e9 m",
        ),
        (
            large,
            &[],
            1,
            "states.csv: column radius: 2000000000 is above 1e9 m",
        ),
        (
            None,
            &["--margin", "2e9"],
            1,
            "--margin: a radius of 0.5 m and half of 2e9 m are not within 0 and 1e9 m",
        ),
        (
            None,
            &["--json", "./states.csv"],
            2,
            "--json ./states.csv is the file of states itself",
        ),
        (
            None,
            &[
                "--pictures",
                "pictures",
                "--json",
                "pictures/tradeoff-stepped.svg",
            ],
            2,
            "--json pictures/tradeoff-stepped.svg is a picture as well",
        ),
        #[cfg(unix)]
        (
            None,
            &["--pictures", "pictures"],
            2,
            "--pictures: pictures/tradeoff-pair.svg is the file of states itself",
        ),
    ] {
        let file = passing(10.0, radii);
        let Output {
            status,
            stdout,
            stderr,
        } = stepped(&folder, &file, options);
        let error = plain(&stderr);
        let error = error.lines().find(|line| line.starts_with("error"));
        assert_eq!(error, Some(&format!("error: {said}")[..]));
        assert!(status.code() == Some(code) && stdout.is_empty(), "{said}");
        assert_eq!(read_to_string(folder.join(FILE)).unwrap(), file);
    }
}

/// Before anything is measured or printed.
#[test]
fn a_file_that_is_not_there_is_told_first() {
    let folder = folder("tradeoff-absent");
    for (options, code, said) in [
        (&["--states", "absent.csv"][..], 1, "absent.csv: "),
        (
            &["--states", "absent.csv", "--only", "pair"],
            2,
            "--states and --bodies are of the scene that is stepped, which --only leaves out",
        ),
    ] {
        let mut tradeoff = example("tradeoff");
        let output = tradeoff.arg("--quick").args(options).current_dir(&folder);
        let Output {
            status,
            stdout,
            stderr,
        } = output.output().unwrap();
        assert!(plain(&stderr).contains(said), "{}", plain(&stderr));
        assert!(status.code() == Some(code) && stdout.is_empty(), "{said}");
    }
}

/// Also encounters that begin between two states, and of which a monitor first says that they have begun.
#[test]
fn told_encounters_are_seen() {
    let folder = folder("tradeoff-told");
    let rows = generated(&folder, "modelled", "told", &[]);
    let (late, missed) = (column(&rows, "seen_late"), column(&rows, "missed"));
    assert!(late[0] > 0 && missed[1] == 0, "{rows:?}");
}

/// The rows of the table of a file.
fn stepped_rows(folder: &Path, file: &str) -> Vec<Value> {
    let Output { status, stderr, .. } = stepped(folder, file, &["--json", "out.json"]);
    assert!(status.success(), "{}", plain(&stderr));
    written(folder, "stepped")
}

/// The window ends between two frames, and an encounter begins there.
#[test]
fn the_last_frame_is_looked_at() {
    let folder = folder("tradeoff-end");
    let file = "body,t,px,py,pz,vx,vy,vz\n0,0,0,0,0,0,0,0\n0,9.999,0,0,0,0,0,0\n\
                1,0,100.985,0,0,-10,0,0\n1,9.999,0.995,0,0,-10,0,0\n";
    let rows = stepped_rows(&folder, file);
    assert!(
        column(&rows, "encounters").iter().all(|&all| all == 1),
        "{rows:?}"
    );
    assert!(
        column(&rows, "missed").iter().all(|&missed| missed == 0),
        "{rows:?}"
    );
}

/// Two encounters 40 ms apart: a frame every 100 ms sees one of them.
#[test]
fn a_contact_is_of_one_encounter() {
    let folder = folder("tradeoff-two");
    let mut file = "body,t,px,py,pz,vx,vy,vz\n0,0,0,0,0,0,0,0\n0,2,0,0,0,0,0,0\n".to_owned();
    for (t, x) in [
        (0.0, 3.0),
        (0.9, 1.5),
        (1.0, 0.9),
        (1.03, 1.1),
        (1.06, 0.95),
        (1.09, 1.2),
        (2.0, 3.0),
    ] {
        file.push_str(&format!("1,{t},{x},0,0,0,0,0\n"));
    }
    let rows = stepped_rows(&folder, &file);
    assert!(
        column(&rows, "encounters").iter().all(|&all| all == 2),
        "{rows:?}"
    );
    let ours = &rows[..2];
    assert_eq!(column(ours, "missed"), [0; 2]);
    let at = |rate: u64| rows[2..].iter().filter(move |row| row["Hz"] == rate);
    for (rate, missed) in [(10, 1), (60, 0)] {
        let seen: Vec<Value> = at(rate).cloned().collect();
        assert_eq!(column(&seen, "missed"), [missed; 4], "{rows:?}");
    }
}

/// A monitor looks beyond the window, where two bodies come closer still.
#[test]
fn separations_beyond_the_window_are_not_compared() {
    let folder = folder("tradeoff-cut");
    let rows = generated(&folder, "stepped", "stepped", &["--bodies", "500"]);
    let monitor = &rows[1];
    assert_eq!(monitor["method"], "nearmiss, monitor 2 s ahead");
    let off = monitor["separation_off_m"].as_f64().unwrap();
    assert!(off < 1e-9, "{monitor}");
}

/// 1e8 m away, where f32 knows every eighth metre.
#[test]
fn steppers_in_f32_see_what_is_far_away() {
    let folder = folder("tradeoff-far");
    let file = "body,t,px,py,pz,vx,vy,vz\n0,0,99999980,0,0,4,0,0\n0,10,100000020,0,0,4,0,0\n\
                1,0,100000020,0.7,0,-4,0,0\n1,10,99999980,0.7,0,-4,0,0\n";
    let rows = stepped_rows(&folder, file);
    assert!(
        column(&rows, "encounters").iter().all(|&all| all == 1),
        "{rows:?}"
    );
    for name in ["missed", "false"] {
        assert!(
            column(&rows, name).iter().all(|&count| count == 0),
            "{rows:?}"
        );
    }
}
