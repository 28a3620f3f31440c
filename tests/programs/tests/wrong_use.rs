//! Wrong uses, each with the one sentence that answers it: of files of states, of the examples' options, of the library.

#![allow(
    clippy::unwrap_used,
    reason = "a file or process that fails, fails the test"
)]

#[path = "support/example.rs"]
mod example;

use example::{example, folder, plain};
use nearmiss::glam::{DQuat, DVec3};
use nearmiss::parry3d::math::Vector;
use nearmiss::parry3d::shape::{Ball, HalfSpace};
use nearmiss::{
    AlertLevel, Body, BodyId, CoverOptions, Hitbox, Monitor, Orientation, Outside, Query, Scene,
    Sphere, SphereCover, State, Trajectory, Window,
};
use std::error::Error;
use std::path::Path;

const HEADER: &str = "body,t,px,py,pz,vx,vy,vz\n";

/// Runs an example that refuses what it is given, before any output; returns the first line that it says.
fn refusal(name: &str, arguments: &[&str], folder: &Path) -> (Option<i32>, String) {
    let mut command = example(name);
    let result = command
        .args(arguments)
        .current_dir(folder)
        .output()
        .unwrap();
    assert!(result.stdout.is_empty(), "{arguments:?}");
    let said = plain(&result.stderr);
    let first = said.lines().next().unwrap_or_default();
    (result.status.code(), first.to_owned())
}

/// Files that cannot be screened: content (after the header, if it begins with `+`), and what is said after the name.
#[rustfmt::skip]
const FILES: &[(&str, &str)] = &[
    ("", "row 1: the file is empty; expected the header body,t,px,py,pz,vx,vy,vz"),
    ("+", "row 2: no states after the header"),
    ("0,0,0,0,0,0,0,0\n0,1,0,0,0,0,0,0\n",
     "row 1: no header; expected the columns body,t,px,py,pz,vx,vy,vz in any order, found \"0,0,0,0,0,0,0,0\""),
    ("body,t,px,py,pz\n0,0,0,0,0\n",
     "row 1, columns vx, vy, vz: missing; expected the columns body,t,px,py,pz,vx,vy,vz in any order, found \
      \"body,t,px,py,pz\""),
    ("id;t;px;py;pz;vx;vy;vz\n",
     "row 1, column body: missing; expected the columns body,t,px,py,pz,vx,vy,vz in any order, found \
      \"id,t,px,py,pz,vx,vy,vz\""),
    ("body,t,px,py,pz,vx,vy,vz,PX\n", "row 1, column px: there are two of this name; keep one"),
    ("body;t;px;py;pz;vx;vy;vz\nant;0;0,5;0;0;0;0;0\n",
     "row 2, column px: \"0,5\" has a decimal comma; write \"0.5\""),
    ("+0,0,0,5,0,0,0,0,0\n",
     "row 2, column vz: the row has 9 values, not 8 as the header; the last is \"0\"; write decimal points, and \
      names with commas in quotation marks"),
    ("+0,0,0,0,0,0,0,0\n0,1,0\n",
     "row 3, column py: the row has 3 values, not 8 as the header; the last is \"0\""),
    ("+0,0,0,0,0,0,0,0\n0,1,0;0;0;0;0;0\n",
     "row 3, column py: the row has 3 values, not 8 as the header; the last is \"0;0;0;0;0;0\"; separate its values as \
      those of the header"),
    ("+0,0,0,0,0,0,0,0\n0,1,0,fast,0,0,0,0\n", "row 3, column py: \"fast\" is not a finite number"),
    ("+0,0,0,0,0,\"0,0,0\n1,1,1,1,1,1,1,1\n",
     "row 2, column vy: the row has 6 values, not 8 as the header; the last is \"0,0,0\\n1,1,1,1,1,1,1,1\\n\\n\"; close \
      its quotation mark"),
    ("+0,0,0,0,0,0,0,\"0\n1,1,1,1,1,1,1,1\n",
     "row 2, column vz: \"0\\n1,1,1,1,1,1,1,1\\n\\n\" spans rows: close its quotation mark"),
    ("+0,0,0,0,0,\"0\n1\",0\n",
     "row 2, column vz: the row has 7 values, not 8 as the header; the last is \"0\"; close the quotation mark of the \
      value that spans rows"),
    ("body,t,px,py,pz,vx,vy,vz,note\n1,0,0,0,0,1,0,0,\n1,10,10,0,0,1,0,0,\"open\n2,0,10,0,0,-1,0,0,\n",
     "row 3, column \"note\": \"open\\n2,0,10,0,0,-1,0,0,\\n\\n\" spans rows: close its quotation mark"),
    ("note;body;t;px;py;pz;vx;vy;vz\r\n;1;0;0;0;0;1;0;0\r\n\"a\r\n;2;0;0;0;0;1;0;0\r\nb\";1;9;9;0;0;1;0;0\r\n",
     "row 3, column \"note\": \"a\\r\\n;2;0;0;0;0;1;0;0\\r\\nb\" spans rows: close its quotation mark"),
    ("body,t,px,py,pz,vx,vy,vz,radius\n1,0,0,0,0,1,0,0,\"1\n",
     "row 2, column radius: \"1\\n\\n\" spans rows: close its quotation mark"),
    ("body,t,px,py,pz,vx,vy,vz,\"note\n1,0,0,0,0,1,0,0,\n",
     "row 1, column 9: \"note\\n1,0,0,0,0,1,0,0,\\n\\n\" spans rows: close its quotation mark"),
    ("body,t,px,py,pz,vx,vy,\"vz\r\n1,0,0,0,0,1,0,0\r\n",
     "row 1, column 8: \"vz\\r\\n1,0,0,0,0,1,0,0\\r\\n\\n\" spans rows: close its quotation mark"),
    ("body,t,px,py,pz,vx,vy,vz,radius\n1,0,0,0,0,1,0,0\n",
     "row 2, column radius: the row has 8 values, not 9 as the header; the last is \"0\""),
    ("+0,0,0,0,0,,0,0\n", "row 2, column vx: the cell is empty"),
    ("+0,0,0,0,inf,0,0,0\n", "row 2, column pz: \"inf\" is not a finite number"),
    ("+0,2026-01-01T00:00:00Z,0,0,0,0,0,0\n",
     "row 2, column t: \"2026-01-01T00:00:00Z\" is not a finite number: write seconds, counted from an epoch near \
      your data"),
    ("+0,0,0,0,0,0,0,0\n0,1,1e301,0,0,0,0,0\n",
     "row 3, column px: 1e301 is out of range (1e300); check the units, m, s and m/s"),
    ("+,0,0,0,0,0,0,0\n", "row 2, column body: empty; give the body a whole number or a name"),
    ("+a\tb,0,0,0,0,0,0,0\n",
     "row 2, column body: \"a\\tb\" has characters that do not print; take them out of the name"),
    ("+ant,0,0,0,0,0,0,0\n", "row 2, column body: body \"ant\" has 1 row, and needs at least two"),
    ("+0,0,0,0,0,0,0,0\n0,2,0,0,0,0,0,0\n0,2,0,0,0,0,0,0\n",
     "row 4, column t: 2 is not later than 2, the row before of body 0; sort its rows by t, and keep one row for \
      each instant"),
    ("+a,0,0,0,0,0,0,0\nb,0,0,0,0,0,0,0\na,1,0,0,0,0,0,0\nb,1,0,0,0,0,0,0\n",
     "row 4, column body: body \"a\" has rows from row 2 on, and others since; a body's rows must be together: sort \
      the file by body, then by t"),
    ("body t px py pz vx vy vz\n0 0 0 0 0 0 0 0\n",
     "row 1: columns are separated by spaces; use commas, semicolons or tabs"),
    ("body,t,px,py,pz,vx,vy,vz\r0,0,0,0,0,0,0,0\r0,1,0,0,0,0,0,0\r",
     "row 1: lines end with a bare carriage return; save the file with the line ends LF or CRLF"),
    ("+0,0,0,0,0,0,0,0\r0,1,0,0,0,0,0,0\r",
     "row 2: lines end with a bare carriage return; save the file with the line ends LF or CRLF"),
    ("PK\u{3}\u{4}states.xml", "row 1: the file is packed (a zip, or a spreadsheet); save it as CSV in UTF-8"),
    ("radius,body,t,px,py,pz,vx,vy,vz\n-1,a,0,0,0,0,0,0,0\n",
     "row 2, column radius: \"-1\" is not a number from 0 to 1e300; give metres"),
    ("radius,body,t,px,py,pz,vx,vy,vz\n1,a,0,0,0,0,0,0,0\n2,a,1,0,0,0,0,0,0\n",
     "row 3, column radius: 2 is not 1, the radius of body \"a\" in row 2; a body has one radius"),
    ("body;t;px;py;pz;vx;vy;vz;radius\r\na;0;0;0;0;0;0;0;0,5\r\n",
     "row 2, column radius: \"0,5\" has a decimal comma; write \"0.5\""),
    ("body;t;px;py;pz;vx;vy;vz\r\na;0;0;0;0;0;0;0,5\r\n",
     "row 2, column vz: \"0,5\" has a decimal comma; write \"0.5\""),
    ("+0,0,0,0,0,0,0,fast\r\n", "row 2, column vz: \"fast\" is not a finite number"),
    ("body,t,px,py,pz\r\n0,0,0,0,0\r\n",
     "row 1, columns vx, vy, vz: missing; expected the columns body,t,px,py,pz,vx,vy,vz in any order, found \
      \"body,t,px,py,pz\""),
    ("sep=;\nbody;t;px;py;pz;vx;vy;vz\na;0;0;0;0;0;0;0\n",
     "row 1: a line that begins with \"sep=\" is for spreadsheets; delete it"),
];

/// Command lines that are refused: example, arguments, exit code, and what is said.
#[rustfmt::skip]
const COMMANDS: &[(&str, &[&str], i32, &str)] = &[
    ("screen", &[], 2, "error: the following required arguments were not provided:"),
    ("screen", &["none.csv"], 1, "error: none.csv: No such file or directory (os error 2)"),
    ("screen", &["."], 1, "error: .: Is a directory (os error 21)"),
    ("screen", &["utf16.csv"], 1, "error: utf16.csv: row 1: the file is in UTF-16; save it in UTF-8"),
    ("screen", &["unmarked.csv"], 1, "error: unmarked.csv: row 1: the file is in UTF-16; save it in UTF-8"),
    ("screen", &["cut.csv.gz"], 1, 
     "error: cut.csv.gz: the gzip data are broken or cut off (incomplete deflate stream); pack the file again"),
    ("screen", &["radii.csv", "--radius", "2"], 1,
     "error: --radius: radii.csv has a column radius; leave one of the two out"),
    ("screen", &["none.csv", "--radius", "2,5"], 2,
     "error: invalid value '2,5' for '--radius <RADIUS>': not a number; write it like 2.5 or 1e3"),
    ("screen", &["none.csv", "--radius", "-1"], 2,
     "error: invalid value '-1' for '--radius <RADIUS>': -1.0 m is not a number from 0 to 1e300"),
    ("screen", &["none.csv", "--margin", "wide"], 2,
     "error: invalid value 'wide' for '--margin <MARGIN>': not a number; write it like 2.5 or 1e3"),
    ("screen", &["none.csv", "--margin", "nan"], 2,
     "error: invalid value 'nan' for '--margin <MARGIN>': margin NaN m is not a number within ±1e300"),
    ("screen", &["none.csv", "--window", "5"], 2,
     "error: invalid value '5' for '--window <WINDOW>': expected A..B, A.. or ..B (seconds)"),
    ("screen", &["none.csv", "--window", "5..1"], 2,
     "error: invalid value '5..1' for '--window <WINDOW>': window 5.0..1.0 s: no instant lies between them; name the \
      earlier time first"),
    ("screen", &["none.csv", "--window", "now..9"], 2,
     "error: invalid value 'now..9' for '--window <WINDOW>': \"now\" is not a time in seconds; write it like 2.5 or \
      1e3"),
    ("screen", &["none.csv", "--window", "0...5"], 2,
     "error: invalid value '0...5' for '--window <WINDOW>': a dot too many: write A..B, and a fraction with a digit \
      before its point, like 0.5"),
    ("screen", &["radii.csv", "--outside", "coast", "--window=-1e110..0"], 1,
     "error: body 0: --window reaches too far beyond its rows: check the window, and rows that are almost at one time"),
    ("screen", &["none.csv", "--outside", "coast"], 2,
     "error: --outside coast needs a window that is closed on both sides: --window=A..B"),
    ("screen", &["none.csv", "--accuracy", "fast"], 2,
     "error: invalid value 'fast' for '--accuracy <ACCURACY>': fast is not offered any more: exact takes the same \
      time"),
    ("screen", &["radii.csv", "--output", "radii.csv"], 2,
     "error: --output radii.csv is the file of states itself"),
    ("screen", &["radii.csv", "--hitboxes", "hitboxes.json", "--output", "./hitboxes.json"], 2,
     "error: --output ./hitboxes.json is the file of hitboxes itself"),
    ("screen", &["radii.csv", "--output", "none/out.csv"], 1,
     "error: none/out.csv: No such file or directory (os error 2)"),
    ("screen", &["radii.csv", "--threads", "-1"], 2,
     "error: invalid value '-1' for '--threads <THREADS>': -1 is not in 0..=1024"),
    ("screen", &["radii.csv", "--threads", "all"], 2,
     "error: invalid value 'all' for '--threads <THREADS>': not a whole number; write it like 12"),
    ("cover", &["box", "1", "2", "4", "--spheres", "8.5"], 2,
     "error: invalid value '8.5' for '--spheres <SPHERES>': not a whole number; write it like 12"),
    ("cover", &["box", "1", "2", "4", "--spheres", "0"], 2,
     "error: invalid value '0' for '--spheres <SPHERES>': 0 is not in 1..=4096"),
    ("physics", &["--frames", "0"], 2,
     "error: invalid value '0' for '--frames <FRAMES>': 0 is not in 1..=1000000"),
    ("physics", &["--bodies", "1000001"], 2,
     "error: invalid value '1000001' for '--bodies <BODIES>': 1000001 is not in 1..=1000000"),
    ("many_body", &["--bodies", "0"], 2,
     "error: invalid value '0' for '--bodies <BODIES>': 0 is not in 1..=100000000"),
    ("many_body", &["--states", "none/states.csv"], 1,
     "error: none/states.csv: No such file or directory (os error 2)"),
    ("many_body", &["--states", "one.svg", "--picture", "one.svg"], 2,
     "error: --states and --picture are one file; name two"),
    ("many_body", &["--states", "./one.svg", "--picture", "one.svg"], 2,
     "error: --states and --picture are one file; name two"),
    ("cover", &["mesh", "hitboxes.json", "--spheres", "1", "--picture", "./hitboxes.json"], 2,
     "error: --picture ./hitboxes.json is the file of the mesh itself"),
    ("game_loop", &["--headless", "--replan", "50"], 2,
     "error: invalid value '50' for '--replan <REPLAN>': 50 is not in 0..=1"),
    ("game_loop", &["--screenshot", "picture.jpg"], 2,
     "error: invalid value 'picture.jpg' for '--screenshot <SCREENSHOT>': the name of a picture ends in .png"),
    ("game_loop", &["--ships"], 2,
     "error: --ships is for --headless: the window shows them anyway"),
];

type Attempt = fn() -> Result<(), Box<dyn Error>>;

/// What an attempt that is not refused returns is of no interest.
fn done<T>(_: T) -> Result<(), Box<dyn Error>> {
    Ok(())
}

fn state(time: f64, x: f64) -> State {
    State::new(time, x * DVec3::X, DVec3::X)
}

fn flying() -> Trajectory {
    Trajectory::from_states(&[state(0.0, 0.0), state(10.0, 10.0)]).unwrap()
}

fn pair() -> (Scene, BodyId, BodyId) {
    let mut scene = Scene::new();
    let a = scene.insert(Body::new(flying()).with_tag(4)).unwrap();
    let b = scene.insert(Body::new(flying()).with_tag(9)).unwrap();
    (scene, a, b)
}

fn monitor() -> (Monitor, BodyId) {
    let (scene, a, _) = pair();
    let monitor = Monitor::new(scene, 1.0, 5.0, &[AlertLevel::at(1.0)]).unwrap();
    (monitor, a)
}

/// Calls of the library that are refused, and the sentence of the error: `Display` and `Debug` say the same.
#[rustfmt::skip]
const CALLS: &[(Attempt, &str)] = &[
    (|| done(Trajectory::from_states(&[state(0.0, 0.0)])?),
     "a trajectory needs at least two states or waypoints, not 1 (Trajectory::coasting takes one)"),
    (|| done(Trajectory::from_states(&[state(0.0, 0.0), state(f64::NAN, 1.0)])?),
     "knot 1: time is NaN, not a finite number"),
    (|| done(Trajectory::from_states(&[state(2.0, 0.0), state(2.0, 1.0)])?),
     "knot 1: time 2.0 s is not later than the knot before it, 2.0 s: sort by time, and keep one knot for each instant (of a B-spline at most four)"),
    (|| done(Trajectory::from_states(&[state(0.0, 0.0), state(1.0, 1e301)])?),
     "knot 1: position x reaches 1e301, beyond ±1e300: check the units"),
    (|| done(Trajectory::at_rest(f64::INFINITY * DVec3::X)?),
     "knot 0: position x is inf, not a finite number"),
    (|| done(Hitbox::sphere(-1.0)?),
     "sphere 0: radius -1.0 m is not a number from 0 to 1e300"),
    (|| done(Hitbox::cluster(Vec::new())?), "a cluster needs at least one sphere"),
    (|| done(Hitbox::cluster(vec![Sphere { offset: f64::NAN * DVec3::X, radius: 1.0 }])?),
     "sphere 0: offset component NaN m is not a number within ±1e300"),
    (|| done(Orientation::slerp(&[(0.0, DQuat::IDENTITY)])?),
     "an orientation between knots needs at least two rotations, not 1"),
    (|| done(Orientation::spin(0.0, DQuat::from_xyzw(0.0, 0.0, 0.0, 2.0), DVec3::Z)?),
     "knot 0: the quaternion of the rotation has the length 2.0, not 1: normalise it in f64"),
    (|| done(Orientation::slerp(&[(0.0, DQuat::IDENTITY), (1.0, DQuat::from_xyzw(1.0, 0.0, 0.0, 0.0))])?),
     "knot 1: half a turn from the knot before, either way: give a knot in between"),
    (|| done(Orientation::spin(0.0, DQuat::IDENTITY, 1e7 * DVec3::Z)?),
     "angular speed 1e7 rad/s is above 1e6 rad/s"),
    (|| done(SphereCover::fit(&Ball::new(1.0), &CoverOptions::new(0))?),
     "0 spheres: not a number from 1 to 4096"),
    (|| done(SphereCover::fit(&HalfSpace::new(Vector::Y), &CoverOptions::new(4))?),
     "a half-space cannot be covered with spheres: give a solid, a compound of solids, or a triangle mesh"),
    (|| done(Window::new(2.0, 1.0)?), "window 2.0..1.0 s: no instant lies between them; name the earlier time first"),
    (|| done(pair().0.screen(&Query::default().with_margin(f64::NAN))?),
     "margin NaN m is not a number within ±1e300"),
    (|| {
        let mut scene = Scene::new();
        scene.insert(Body::new(Trajectory::at_rest(DVec3::ZERO)?))?;
        done(scene.screen(&Query::default())?)
    }, "no body has a plan that says which time to look at: name a window, with Query::new"),
    (|| {
        let (mut scene, ..) = pair();
        scene.insert(Body::new(flying().with_outside(Outside::Coast)).with_tag(7))?;
        done(scene.screen(&Query::new(Window::new(0.0, f64::INFINITY)?))?)
    }, "body 2v0 (tag 7) exists beyond its knots: close the window on both sides, with Window::new"),
    (|| {
        let (mut scene, a, _) = pair();
        scene.remove(a)?;
        done(scene.remove(a)?)
    }, "body 0v0 is not in the scene: it was removed, or the id is of another scene"),
    (|| {
        let (mut scene, a, _) = pair();
        done(scene.ignore_pair(a, a)?)
    }, "body 0v0 cannot be paired with itself: name two bodies"),
    (|| done(Monitor::new(pair().0, 0.0, 5.0, &[])?), 
     "a monitor needs at least one alert level: give it AlertLevel::at(margin)"),
    (|| done(Monitor::new(pair().0, 0.0, 0.0, &[AlertLevel::at(1.0)])?),
     "0.0 s is not a usable lookahead: give a positive number up to 1e300; if it is lost in the rounding of the clock, \
      count time from an epoch near your data"),
    (|| done(Monitor::new(pair().0, 0.0, 5.0, &[AlertLevel::at(2.0).with_release(1.0)])?),
     "alert level 0: margin 2.0 m, release 1.0 m: an encounter begins at the margin and ends beyond the release, so give \
      a release of at least the margin, both within ±1e300"),
    (|| done(monitor().0.advance(0.0, &mut Vec::new())?),
     "the clock cannot go back from 1.0 s to 0.0 s: give a later time, or restore a snapshot"),
    (|| done(monitor().0.conflicts(3)?),
     "there is no alert level 3: levels count from 0, in the order given to Monitor::new"),
    (|| {
        let (mut monitor, a) = monitor();
        let late = Trajectory::from_states(&[state(20.0, 0.0), state(30.0, 1.0)])?;
        done(monitor.replan(a, 2.0, late)?)
    }, "body 0v0 (tag 4): the new plan does not go on from 2.0 s: it is from 20.0 s to 30.0 s; give one that begins by then \
        and ends later"),
];

#[test]
fn files() {
    let folder = folder("wrong-files");
    let mut wrong = Vec::new();
    for (content, sentence) in FILES {
        let content = match content.strip_prefix('+') {
            Some(rows) => format!("{HEADER}{rows}"),
            None => (*content).to_owned(),
        };
        std::fs::write(folder.join("states.csv"), &content).unwrap();
        let (code, said) = refusal("screen", &["states.csv"], &folder);
        if (code, &said) != (Some(1), &format!("error: states.csv: {sentence}")) {
            wrong.push(format!(
                "{content:?}\n  expected {sentence}\n  found    {said}"
            ));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn command_lines() {
    let folder = folder("wrong-commands");
    let radii = format!("radius,{HEADER}1,0,0,0,0,0,0,0,0\n1,0,1,0,0,0,0,0,0\n");
    std::fs::write(folder.join("radii.csv"), radii).unwrap();
    std::fs::write(folder.join("hitboxes.json"), "[]").unwrap();
    let utf_16 = HEADER.encode_utf16().flat_map(u16::to_le_bytes);
    let marked: Vec<u8> = [0xff, 0xfe].into_iter().chain(utf_16).collect();
    std::fs::write(folder.join("utf16.csv"), &marked).unwrap();
    std::fs::write(folder.join("unmarked.csv"), &marked[2..]).unwrap();
    let gzip_header = [0x1f, 0x8b, 8, 0, 0, 0, 0, 0, 0, 3];
    std::fs::write(folder.join("cut.csv.gz"), gzip_header).unwrap();
    let mut wrong = Vec::new();
    for (name, arguments, code, sentence) in COMMANDS {
        let (found, said) = refusal(name, arguments, &folder);
        if (found, &said[..]) != (Some(*code), sentence) {
            wrong.push(format!(
                "{name} {arguments:?}\n  expected {sentence}\n  found    {said}"
            ));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert_eq!(std::fs::read_dir(&folder).unwrap().count(), 5);
}

/// An option that does not exist is not the name of a file: there is a hint only where another option has nearly its name.
#[test]
fn options_that_do_not_exist() {
    for (option, hint) in [
        ("--distance", ""),
        ("--margn", "  tip: a similar argument exists: '--margin'"),
    ] {
        let result = example("screen").args(["states.csv", option]).output();
        let said = plain(&result.unwrap().stderr);
        let hints = said.lines().filter(|line| line.contains("tip"));
        assert_eq!(hints.collect::<String>(), hint, "{said}");
    }
}

#[test]
fn calls() {
    let mut wrong = Vec::new();
    for (attempt, sentence) in CALLS {
        let (said, unwrapped) = attempt().map_or_else(
            |error| (error.to_string(), format!("{error:?}")),
            |()| ("nothing".to_owned(), "nothing".to_owned()),
        );
        assert_eq!(unwrapped, said);
        if said != *sentence {
            wrong.push(format!("expected {sentence}\nfound    {said}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
