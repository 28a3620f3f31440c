//! A monitor that always has too little time tells, in the end, what one with all the time tells.

use super::is_as_screened;
use super::support::{line, rng, vector, wander, with_every_change};
use glam::DVec3;
use nearmiss::{
    AlertLevel, Body, BodyId, Budget, Event, EventKind, Hitbox, Monitor, Outside, Query, Scene,
    State, Trajectory, Window,
};
use rand::RngExt;
use rand::rngs::ChaCha8Rng;
use std::time::Duration;

/// A scene's size, and how its bodies fly.
struct World {
    cube: f64,
    /// When it begins and for how long, s.
    start: f64,
    duration: f64,
    outside: Outside,
    /// Knots at whole seconds and places at whole halves of a metre: many things at one instant.
    is_lattice: bool,
}

impl World {
    fn any(rng: &mut ChaCha8Rng) -> Self {
        Self {
            cube: rng.random_range(4.0..30.0),
            start: [0.0, 1e6, 1e9][rng.random_range(0..3)],
            duration: [20.0, 100.0, 1000.0][rng.random_range(0..3)],
            outside: [Outside::Absent, Outside::Coast][rng.random_range(0..2)],
            is_lattice: rng.random_bool(0.5),
        }
    }

    fn end(&self) -> f64 {
        self.start + self.duration
    }

    fn plan(&self, rng: &mut ChaCha8Rng, (start, end): (f64, f64)) -> Trajectory {
        let mut times: Vec<f64> = (0..rng.random_range(2..6))
            .map(|_| rng.random_range(start..end))
            .map(|time| {
                if self.is_lattice {
                    f64::round(time)
                } else {
                    time
                }
            })
            .collect();
        times.extend([start, end]);
        times.sort_unstable_by(f64::total_cmp);
        times.dedup();
        let speed = 1e-3 + rng.random_range(0.0..8.0) * self.cube / self.duration;
        let states: Vec<State> = times
            .into_iter()
            .map(|time| {
                let position = vector(rng, 0.5 * self.cube);
                let position = if self.is_lattice {
                    0.5 * (2.0 * position).round()
                } else {
                    position
                };
                State::new(time, position, vector(rng, speed))
            })
            .collect();
        Trajectory::from_states(&states)
            .unwrap()
            .with_outside(self.outside)
    }

    fn scene(&self, rng: &mut ChaCha8Rng) -> (Scene, Vec<BodyId>) {
        let mut scene = Scene::new();
        let has_floor = rng.random_bool(0.5);
        let ids = (0..rng.random_range(2..30))
            .map(|number| {
                let plan = self.plan(rng, (self.start, self.end()));
                let hitbox = if has_floor && number == 0 {
                    Hitbox::half_space(vector(rng, 1.0).normalize()).unwrap()
                } else {
                    Hitbox::sphere(rng.random_range(0.0..1.0)).unwrap()
                };
                scene.insert(Body::new(plan).with_hitbox(hitbox)).unwrap()
            })
            .collect();
        (scene, ids)
    }
}

/// When encounters began, and ended and how: level, bodies, rounded instants and separation. (The
/// nearest so far is seen at other instants: its last bits differ.)
pub(super) fn lived(events: &[Event]) -> Vec<(usize, u32, u32, i64, i64, String)> {
    #[allow(clippy::cast_possible_truncation, reason = "up to 1e15")]
    let rounded = |value: f64| (value * 1e6).round() as i64;
    let mut lived: Vec<_> = events
        .iter()
        .filter_map(|event| {
            let (encounter, how) = match event.kind {
                EventKind::Began(encounter) => (encounter, String::new()),
                EventKind::Ended(encounter, reason) => {
                    let nearest = rounded(encounter.closest.separation);
                    (encounter, format!("{reason:?} {nearest}"))
                }
                _ => return None,
            };
            let (a, b) = (encounter.a.slot(), encounter.b.slot());
            let times = [encounter.enter, event.time].map(rounded);
            Some((encounter.level, a, b, times[0], times[1], how))
        })
        .collect();
    lived.sort_unstable();
    lived
}

/// Plans change while the clock is far ahead of what the poorer monitor knows. (After the clock's own
/// instant: what is at that instant the richer one has reported, and the poorer one has not.)
fn replan(rng: &mut ChaCha8Rng, world: &World, monitors: [&mut Monitor; 2], id: BodyId, now: f64) {
    let from = now
        + if rng.random_bool(0.3) {
            1e-6
        } else {
            rng.random_range(1e-6..world.duration / 6.0)
        };
    let start = from - rng.random_range(0.0..3.0);
    let plan = world.plan(rng, (start, start + world.duration));
    let done = monitors.map(|monitor| monitor.replan(id, from, plan.clone()).is_ok());
    assert_eq!(done[0], done[1]);
}

#[test]
fn a_budget_delays_what_is_told_and_changes_none_of_it() {
    let mut begun = 0;
    for seed in 0..super::ticks(1500) / 5 {
        let mut rng = rng(u64::from(seed));
        let world = World::any(&mut rng);
        let (scene, ids) = world.scene(&mut rng);
        let margin: f64 = rng.random_range(0.0..2.0);
        let release = margin + rng.random_range(0.0..2.0);
        let levels = [
            AlertLevel::at(margin).with_release(release),
            AlertLevel::at(0.0),
        ];
        let lookahead = [0.05, 0.5, 1.0, 3.0][rng.random_range(0..4)];
        let monitor_of = |scene| {
            with_every_change(Monitor::new(scene, world.start, lookahead, &levels).unwrap())
        };
        let (mut rich, mut poor) = (monitor_of(scene.clone()), monitor_of(scene));
        let (mut events, mut late) = (Vec::new(), Vec::new());
        let mut now = world.start;
        while now < world.end() + 5.0 {
            for _ in 0..rng.random_range(0..4) {
                let id = ids[rng.random_range(0..ids.len())];
                replan(&mut rng, &world, [&mut rich, &mut poor], id, now);
            }
            now += match rng.random_range(0..10) {
                0 => 0.0,
                1..5 => rng.random_range(0.0..world.duration / 3.0),
                _ => rng.random_range(0.0..2.0 * lookahead),
            };
            rich.advance(now, &mut events).unwrap();
            let work = [1, 3, 10, 100, 1000][rng.random_range(0..5)];
            poor.advance_within(now, Budget::Work(work), &mut late)
                .unwrap();
            // Now and then it comes to know all, bit by bit.
            if rng.random_bool(0.3) {
                while !poor.is_caught_up() {
                    poor.advance_within(now, Budget::Work(work), &mut late)
                        .unwrap();
                }
            }
        }
        poor.advance(now, &mut late).unwrap();
        let expected = lived(&events);
        begun += expected.len();
        assert_eq!(lived(&late), expected, "{seed}");
    }
    assert!(begun > 1000, "{begun}");
}

const LEVEL: AlertLevel = AlertLevel::at(2.0).with_release(2.5);

/// Advances to `now` as often as it takes to know all; returns how often that was. What is known up to
/// then is never taken back, and all that a screening finds there.
fn catch_up(monitor: &mut Monitor, now: f64, time: Duration, reported: &mut Vec<Event>) -> u32 {
    let mut calls: u32 = 0;
    loop {
        let known = monitor.complete_until();
        monitor
            .advance_within(now, Budget::Time(time), reported)
            .unwrap();
        assert!(monitor.complete_until() >= known, "{known} was known");
        calls += 1;
        // Screenings take longer than the ticks.
        if monitor.complete_until() > now && calls.is_multiple_of(16) {
            is_as_screened(monitor, LEVEL);
        }
        if monitor.is_caught_up() {
            is_as_screened(monitor, LEVEL);
            return calls;
        }
        // A call looks at a thousand boxes or candidates at least; there are some 100,000 of them.
        assert!(calls < 2_000, "it does not come to an end");
    }
}

/// However long any of it takes: of that, nothing is asserted.
#[test]
fn a_little_time_again_and_again_is_enough() {
    for micros in [0, 100, 3_000] {
        let time = Duration::from_micros(micros);
        let mut rng = rng(8);
        let mut scene = Scene::new();
        let mut ids = Vec::new();
        let mut any_plan = |start: f64| {
            let states = wander(&mut rng, start, 12, 1.0, 250.0, 5.0);
            Trajectory::from_states(&states).unwrap()
        };
        for _ in 0..5_000 {
            ids.push(scene.insert(Body::new(any_plan(-1.0))).unwrap());
        }
        let monitor_of =
            |scene| with_every_change(Monitor::new(scene, 0.0, 2.0, &[LEVEL]).unwrap());
        let (mut rich, mut poor) = (monitor_of(scene.clone()), monitor_of(scene));
        let (mut events, mut late) = (Vec::new(), Vec::new());
        rich.advance(0.0, &mut events).unwrap();
        let calls = catch_up(&mut poor, 0.0, time, &mut late);
        println!("{micros} us: caught up after {calls} calls");
        // The clock runs on, and nobody waits for it.
        for step in 1..20 {
            let now = 0.1 * f64::from(step);
            rich.advance(now, &mut events).unwrap();
            let known = poor.complete_until();
            poor.advance_within(now, Budget::Time(time), &mut late)
                .unwrap();
            assert!(poor.complete_until() >= known, "{known} was known");
        }
        catch_up(&mut poor, rich.now(), time, &mut late);
        assert_eq!(lived(&late), lived(&events));
        // New plans are to be looked at all over again.
        for &id in ids.iter().step_by(3) {
            let plan = any_plan(1.5);
            for monitor in [&mut rich, &mut poor] {
                monitor.set_trajectory(id, plan.clone()).unwrap();
            }
        }
        rich.advance(2.0, &mut events).unwrap();
        poor.advance_within(2.0, Budget::Time(time), &mut late)
            .unwrap();
        catch_up(&mut poor, 2.0, time, &mut late);
        let conflicts =
            [rich.conflicts(0).unwrap(), poor.conflicts(0).unwrap()].map(super::support::hash);
        assert_eq!(conflicts[0], conflicts[1]);
        assert!(poor.conflicts(0).unwrap().len() > 100);
    }
}

/// Late on the clock, instants are far apart: a contact begins a third of one after a budget has ended,
/// and is said to begin there.
#[test]
fn nothing_is_missing_that_begins_where_a_budget_ends() {
    const NOW: f64 = 1e6;
    const LOOKAHEAD: f64 = 3.0;
    // Where the second of three slices begins.
    let cut = NOW + 1.0;
    let late = 0.3 * (cut.next_up() - cut);
    let still = line(cut - 8.0, cut + 8.0, DVec3::ZERO, DVec3::ZERO);
    let comes = line(cut - 8.0, cut + 8.0, DVec3::X * (9.0 + late), -DVec3::X);
    let mut ends = 0;
    for work in 1..20 {
        let mut scene = Scene::new();
        for plan in [&still, &comes] {
            scene.insert(Body::new(plan.clone())).unwrap();
        }
        let mut monitor =
            with_every_change(Monitor::new(scene, NOW, LOOKAHEAD, &[AlertLevel::at(1.0)]).unwrap());
        let budget = Budget::Work(work);
        monitor
            .advance_within(NOW, budget, &mut Vec::new())
            .unwrap();
        let certain = monitor.complete_until();
        ends += u32::from(NOW < certain && certain <= cut);
        let query = Query::new(Window::new(NOW, certain).unwrap());
        let query = query.with_margin(1.0);
        let screened = monitor.scene().screen(&query).unwrap().conflicts;
        assert_eq!(monitor.conflicts(0).unwrap(), screened, "{work} {certain}");
    }
    assert!(ends > 0);
    let mut scene = Scene::new();
    for plan in [still, comes] {
        scene.insert(Body::new(plan)).unwrap();
    }
    let query = Query::new(Window::new(NOW, cut).unwrap());
    let found = scene.screen(&query.with_margin(1.0)).unwrap();
    assert_eq!(found.conflicts.len(), 1, "it is reported at the cut");
}
