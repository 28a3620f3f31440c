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
#[path = "../../support/example.rs"]
mod example;
mod oracle_support;

use cases::{Case, FAMILIES};
use check::Truth;
use example::example;
use glam::DVec3;
use nearmiss::{BodyId, Certificate, Clip, ClosestApproach, Conflict, Outside, TimeEnclosure};
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

/// The rows as conflicts of the two bodies; what the table does not say is zero.
fn read_rows(path: &Path, ids: [BodyId; 2]) -> Vec<Conflict> {
    let mut table = csv::Reader::from_path(path).unwrap();
    table
        .deserialize::<Vec<f64>>()
        .map(|row| {
            let row = row.unwrap();
            let times = |first: usize| TimeEnclosure {
                earliest: row[first],
                latest: row[first + 1],
            };
            Conflict {
                a: ids[0],
                b: ids[1],
                enter: row[2],
                exit: row[3],
                closest: ClosestApproach {
                    time: row[4],
                    separation: row[5],
                    position_a: DVec3::ZERO,
                    position_b: DVec3::ZERO,
                    relative_velocity: DVec3::ZERO,
                    sphere_a: 0,
                    sphere_b: 0,
                },
                clip: Clip::default(),
                certificate: Some(Certificate {
                    error: row[6],
                    resolved: row[8] > 0.5,
                    enter: times(9),
                    exit: times(11),
                    closest: times(13),
                }),
            }
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
