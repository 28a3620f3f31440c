//! The README quotes what its two programs print. The programs themselves are compiled as documentation.

#![allow(clippy::unwrap_used, reason = "a failure fails the test")]

use nearmiss::{AlertLevel, Body, Hitbox, Monitor, Query, Scene, State, Trajectory};

/// Returns the README with single spaces.
fn readme() -> String {
    let words: Vec<&str> = include_str!("../README.md").split_whitespace().collect();
    words.join(" ")
}

#[test]
fn the_first_program_prints_what_the_readme_says() {
    let mut scene = Scene::new();
    for (start, speed) in [(0.0, 10.0), (100.0, -10.0)] {
        let state = |time| State::new(time, [start + speed * time, 0.0, 0.0], [speed, 0.0, 0.0]);
        let plan = Trajectory::from_states(&[state(0.0), state(10.0)]).unwrap();
        let body = Body::new(plan).with_hitbox(Hitbox::sphere(0.5).unwrap());
        scene.insert(body).unwrap();
    }
    let found = scene.screen(&Query::default().with_margin(2.0)).unwrap();
    let [conflict] = &found.conflicts[..] else {
        panic!("{:?}", found.conflicts);
    };
    assert!(readme().contains(&format!("It prints `{conflict}`")));
}

#[test]
fn the_loop_prints_what_the_readme_says() {
    let (mut scene, mut balls) = (Scene::new(), Vec::new());
    for (tag, x, speed) in [(7, -20.0, 10.0), (8, 20.0, -10.0)] {
        let start = State::new(0.0, [x, 0.0, 0.0], [speed, 0.0, 0.0]);
        let body = Body::new(Trajectory::coasting(start).unwrap()).with_tag(tag);
        let body = body.with_hitbox(Hitbox::sphere(1.0).unwrap());
        balls.push((scene.insert(body).unwrap(), start));
    }
    let contact = AlertLevel {
        margin: 0.0,
        release: 0.05,
    };
    let mut monitor = Monitor::new(scene, 0.0, 2.0, &[contact]).unwrap();
    let (mut events, mut printed) = (Vec::new(), Vec::new());
    for now in (1..180).map(|frame| f64::from(frame) / 60.0) {
        let moved =
            |start: State| State::new(now, start.position + now * start.velocity, start.velocity);
        let told = balls.iter().map(|&(id, start)| (id, moved(start)));
        monitor.track(now, told).unwrap();
        monitor.advance(now, &mut events).unwrap();
        printed.extend(events.drain(..).map(|event| format!("{event:.2}")));
    }
    let [predicted, revised, began, ended] = &printed[..] else {
        panic!("{printed:?}");
    };
    let readme = readme();
    assert!(
        readme.contains(&format!("It prints `{predicted}`")),
        "{predicted}"
    );
    // Dots stand for what is left out.
    for (line, shown) in [
        (revised, "at 0.12 s revised: ... to 2.10 s, ..."),
        (began, "at 1.90 s began: ..."),
        (ended, "at 2.10 s ended (separated): ..."),
    ] {
        let parts: Vec<&str> = shown.split("...").collect();
        let is_as_shown = line.starts_with(parts[0]) && line.contains(parts[1]);
        assert!(is_as_shown && readme.contains(shown), "{line}");
    }
}
