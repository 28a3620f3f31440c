//! Parts of the game's window that need no window: lines of events, and places of labels.

#![allow(
    clippy::unwrap_used,
    reason = "a scene that cannot be built fails the test"
)]

#[path = "../../../examples/game_loop/feed.rs"]
mod feed;
#[path = "../../../examples/game_loop/labels.rs"]
mod labels;

use feed::Feed;
use labels::{Area, Areas};
use nearmiss::glam::DVec3;
use nearmiss::{AlertLevel, Body, BodyId, Event, Monitor, Scene, State, Trajectory};
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};
use std::collections::BTreeMap;

const ROOM: usize = 9;
const STEP: f64 = 1.0 / 60.0;

/// A crowd whose plans change so often that events come and go within a few ticks.
struct Crowd {
    monitor: Monitor,
    ids: Vec<BodyId>,
    rng: ChaCha8Rng,
}

impl Crowd {
    fn new() -> Self {
        let mut rng = ChaCha8Rng::seed_from_u64(3);
        let mut scene = Scene::new();
        let mut insert = |_| {
            let body = Body::new(straight(&mut rng, 0.0, DVec3::ZERO));
            scene.insert(body).unwrap()
        };
        let ids = (0..40).map(&mut insert).collect();
        let levels = [
            AlertLevel::at(8.0),
            AlertLevel::at(4.0),
            AlertLevel::at(1.0),
        ];
        let monitor = Monitor::new(scene, 0.0, 5.0, &levels).unwrap();
        Self { monitor, ids, rng }
    }

    fn tick(&mut self, now: f64) -> Vec<Event> {
        for _ in 0..2 {
            let id = self.ids[self.rng.random_range(0..self.ids.len())];
            let before = self.monitor.now();
            let body = self.monitor.scene().body(id).unwrap();
            let place = body.trajectory.position(before).unwrap();
            let plan = straight(&mut self.rng, before, place);
            self.monitor.replan(id, before, plan).unwrap();
        }
        let mut events = Vec::new();
        self.monitor.advance(now, &mut events).unwrap();
        events
    }
}

fn straight(rng: &mut ChaCha8Rng, time: f64, place: DVec3) -> Trajectory {
    let mut vector = |size: f64| DVec3::from_array([0; 3].map(|_| rng.random_range(-size..size)));
    let place = if place == DVec3::ZERO {
        vector(40.0)
    } else {
        place
    };
    let (velocity, end) = (vector(8.0) - place / 10.0, 60.0);
    let states =
        [time, time + end].map(|at| State::new(at, place + velocity * (at - time), velocity));
    Trajectory::from_states(&states).unwrap()
}

/// One line a pair; what a line says stays for a second; what is over goes.
#[test]
fn lines_of_events_can_be_read() {
    let mut crowd = Crowd::new();
    let mut feed = Feed::default();
    // What each pair's line said, and since when.
    let mut shown: BTreeMap<(BodyId, BodyId), (String, f64)> = BTreeMap::new();
    let (mut raw, mut changes, mut most) = (0, 0, 0);
    for tick in 1..=1_200 {
        let now = f64::from(tick) * STEP;
        let events = crowd.tick(now);
        feed.note(now, &events, 1);
        feed.settle(now, ROOM);
        raw += events.len();
        let mut present = BTreeMap::new();
        for line in feed.lines() {
            let told = &line.shown;
            assert!(told.encounter.level >= 1, "the far level is off");
            let pair = (told.encounter.a, told.encounter.b);
            let text = format!("{} {} {}", told.time, told.word, told.encounter.level);
            let since = match shown.get(&pair) {
                Some((before, since)) if *before == text => *since,
                other => {
                    changes += 1;
                    if let Some((before, since)) = other {
                        assert!(now - since > 0.99, "{before} was replaced by {text}");
                    }
                    now
                }
            };
            assert!(
                present.insert(pair, (text, since)).is_none(),
                "two lines of {pair:?}"
            );
        }
        for (pair, (text, since)) in &shown {
            let stays = present.contains_key(pair) || now - since > 0.99;
            assert!(stays, "{text} of {pair:?} went at once");
        }
        most = most.max(present.len());
        shown = present;
    }
    assert!(
        raw > 2_000 && changes > 100 && most > ROOM,
        "{raw} {changes} {most}"
    );
    // A quiet world empties the panel.
    feed.note(100.0, &[], 1);
    feed.settle(100.0, ROOM);
    feed.settle(105.0, ROOM);
    assert!(feed.lines().is_empty());
}

/// Two bodies part by 1 m at 11 s and by 4 m at 14 s.
#[test]
fn the_line_of_a_pair_stays_until_its_last_encounter_is_over() {
    let mut scene = Scene::new();
    for (start, speed) in [(0.0, 0.0), (-10.0, 1.0)] {
        let state = |time| State::new(time, [start + speed * time, 0.0, 0.0], [speed, 0.0, 0.0]);
        let plan = Trajectory::from_states(&[state(0.0), state(60.0)]).unwrap();
        scene.insert(Body::new(plan)).unwrap();
    }
    let levels = [8.0, 4.0, 1.0].map(AlertLevel::at);
    let mut monitor = Monitor::new(scene, 0.0, 5.0, &levels).unwrap();
    let (mut feed, mut events) = (Feed::default(), Vec::new());
    let mut lines = |now: f64| {
        events.clear();
        monitor.advance(now, &mut events).unwrap();
        feed.note(now, &events, 1);
        feed.settle(now, ROOM);
        feed.lines().len()
    };
    for tick in 1..=960 {
        let now = f64::from(tick) * STEP;
        let count = lines(now);
        if (6.0..14.0).contains(&now) {
            assert_eq!(count, 1, "{now}");
        }
    }
    assert_eq!(lines(16.5), 0);
}

#[test]
fn labels_do_not_overlap() {
    let mut rng = ChaCha8Rng::seed_from_u64(5);
    let screen = (1280.0, 720.0);
    let panel = Area {
        x: 12.0,
        y: 12.0,
        width: 316.0,
        height: 236.0,
    };
    for (labels, least) in [(10, 8), (100, 80), (1_000, 300)] {
        let mut areas = Areas::new(screen);
        areas.take(panel);
        let mut placed = vec![panel];
        for _ in 0..labels {
            // Some of them outside.
            let at = (
                rng.random_range(-50.0..1330.0),
                rng.random_range(-50.0..770.0),
            );
            let size = (rng.random_range(20.0..140.0), 21.0);
            let Some(area) = areas.place(at, size) else {
                continue;
            };
            let is_on_screen = area.x >= 0.0
                && area.y >= 0.0
                && area.x + area.width <= screen.0
                && area.y + area.height <= screen.1;
            assert!(is_on_screen && (area.width, area.height) == size);
            let covers = |other: &Area| {
                area.x < other.x + other.width
                    && other.x < area.x + area.width
                    && area.y < other.y + other.height
                    && other.y < area.y + area.height
            };
            assert!(!placed.iter().any(covers), "{area:?}");
            placed.push(area);
        }
        // Besides the panel.
        let count = placed.len() - 1;
        assert!(count >= least, "{count} of {labels}");
    }
}
