//! `screen --accuracy certified` on files against exact arithmetic: passes that graze the margin,
//! gaps, dockings, and all else that the campaign asks, through text and back.

#![allow(
    clippy::unwrap_used,
    dead_code,
    reason = "a file or process that fails, fails the test; the modules are those of the campaign"
)]

#[path = "oracle/cases.rs"]
mod cases;
#[path = "oracle/check.rs"]
mod check;
#[path = "../../programs/tests/support/example.rs"]
mod example;
mod oracle_support;

use cases::{Case, FAMILIES};
use check::Truth;
use example::example;
use glam::DVec3;
use nearmiss::{
    Accuracy, Body, BodyId, Clip, Conflict, Outside, Query, Scene, TimeEnclosure, Trajectory,
    Window,
};
use rand::SeedableRng;
use rand::rngs::ChaCha8Rng;
use std::fmt::Write;
use std::path::Path;

fn write_states(case: &Case, path: &Path) {
    let mut text = "body,t,px,py,pz,vx,vy,vz\n".to_owned();
    for (body, states) in case.states.iter().enumerate() {
        for state in states {
            let (p, v) = (state.position, state.velocity);
            let numbers = [state.time, p.x, p.y, p.z, v.x, v.y, v.z];
            let numbers = numbers.map(|number| format!("{number:e}"));
            writeln!(text, "{body},{}", numbers.join(",")).unwrap();
        }
    }
    std::fs::write(path, text).unwrap();
}

/// A certified conflict of two points that rest at the origin.
fn at_the_origin() -> Conflict {
    let mut scene = Scene::new();
    for _ in 0..2 {
        let rest = Trajectory::at_rest(DVec3::ZERO).unwrap();
        scene.insert(Body::new(rest)).unwrap();
    }
    let query = Query::new(Window::new(0.0, 1.0).unwrap()).with_accuracy(Accuracy::Certified);
    scene.screen(&query).unwrap().conflicts[0]
}

/// The rows as conflicts of the two bodies; what the table does not say is zero.
fn read_rows(path: &Path, ids: [BodyId; 2]) -> Vec<Conflict> {
    let any = at_the_origin();
    let mut table = csv::Reader::from_path(path).unwrap();
    table
        .deserialize::<Vec<f64>>()
        .map(|row| {
            let row = row.unwrap();
            let times = |first: usize| TimeEnclosure {
                earliest: row[first],
                latest: row[first + 1],
            };
            let mut conflict = any;
            (conflict.a, conflict.b) = (ids[0], ids[1]);
            (conflict.enter, conflict.exit) = (row[2], row[3]);
            (conflict.closest.time, conflict.closest.separation) = (row[4], row[5]);
            conflict.clip = Clip::default();
            let proof = conflict.certificate.as_mut().unwrap();
            (proof.error, proof.resolved) = (row[6], row[8] > 0.5);
            (proof.enter, proof.exit, proof.closest) = (times(9), times(11), times(13));
            conflict
        })
        .collect()
}

#[test]
fn files_are_answered_exactly() {
    let folder = std::env::temp_dir().join(format!("nearmiss-oracle-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let (states, output) = (folder.join("states.csv"), folder.join("out.csv"));
    let mut rng = ChaCha8Rng::seed_from_u64(77);
    let (mut rows, mut unresolved) = (0, 0);
    for family in FAMILIES {
        for number in 0..12 {
            let case = Case::draw(&mut rng, family);
            write_states(&case, &states);
            let window = case
                .window
                .map_or("..".to_owned(), |(from, to)| format!("{from}..{to}"));
            let outside = match case.outside {
                Outside::Absent => "absent",
                Outside::Extrapolate => "extrapolate",
                Outside::Coast => "coast",
                other => panic!("no option for {other:?}"),
            };
            let result = example("screen")
                .arg(&states)
                .args([
                    "--accuracy",
                    "certified",
                    "--margin",
                    &case.margin.to_string(),
                ])
                .arg(format!("--window={window}"))
                .args(["--outside", outside])
                .arg("--output")
                .arg(&output)
                .output()
                .unwrap();
            let said = String::from_utf8_lossy(&result.stderr);
            assert!(result.status.success(), "{family:?} {number}: {said}");
            let scene = case.scene();
            let ids: Vec<BodyId> = scene.bodies().map(|(id, _)| id).collect();
            let found = read_rows(&output, [ids[0], ids[1]]);
            let truth = Truth::of(&case);
            assert_eq!(
                truth.wrong(&found),
                None,
                "{family:?} {number}: {case:?} {found:?}"
            );
            assert_eq!(
                truth.wrong_thoroughly(&found),
                None,
                "{family:?} {number}: {case:?}"
            );
            rows += found.len();
            let is_open = |conflict: &&Conflict| !conflict.certificate.unwrap().resolved;
            unresolved += found.iter().filter(is_open).count();
        }
    }
    std::fs::remove_dir_all(&folder).unwrap();
    assert!(
        rows > 80 && unresolved > 0 && unresolved < rows,
        "{rows} {unresolved}"
    );
}
