//! What a monitor costs, counted: it is to suit the scene, whenever that is put in and however far the
//! lookahead goes, and no tick is to stand out.

use super::is_as_screened;
use super::scenarios::tick;
use super::support::{rng, vector, wander, with_every_change};
use glam::DVec3;
use nearmiss::{
    AlertLevel, Body, BodyId, Budget, Hitbox, Monitor, Query, Scene, State, Stats, Trajectory,
    Window,
};
use rand::rngs::ChaCha8Rng;

const LEVEL: AlertLevel = AlertLevel::at(1.0);

/// Bodies a few metres from each other, all around a place.
fn flock(around: DVec3) -> Vec<Body> {
    let mut rng = rng(3);
    let flights = (0..300).map(|_| {
        let (position, velocity) = (around + vector(&mut rng, 40.0), vector(&mut rng, 1.0));
        let states = [0.0, 60.0].map(|t| State::new(t, position + t * velocity, velocity));
        Body::new(Trajectory::from_states(&states).unwrap())
    });
    flights.collect()
}

/// Boxes in f32 are blind far from where they are measured from.
#[test]
fn bodies_that_are_put_in_later_and_far_away_cost_no_more() {
    let candidates = |around: DVec3, is_late: bool| {
        let (mut scene, mut later) = (Scene::new(), Vec::new());
        for body in flock(around) {
            if is_late {
                later.push(body);
            } else {
                scene.insert(body).unwrap();
            }
        }
        let mut monitor = with_every_change(Monitor::new(scene, 0.0, 10.0, &[LEVEL]).unwrap());
        // Nor does an empty tick before.
        tick(&mut monitor, 0.0);
        for body in later {
            monitor.insert(body).unwrap();
        }
        let mut candidates = 0;
        for step in 0..60 {
            tick(&mut monitor, 0.5 * f64::from(step));
            candidates += monitor.stats().candidates;
        }
        is_as_screened(&monitor, LEVEL);
        candidates
    };
    let far = DVec3::new(1e12, -3e12, 2e11);
    let least = candidates(DVec3::ZERO, false);
    assert!(least > 0);
    for is_late in [false, true] {
        let found = candidates(far, is_late);
        assert!(found <= 2 * least, "{found} {least}");
    }
}

/// Slices are as short as suits the bodies: a screening of the same window looks at about as much.
#[test]
fn a_long_lookahead_is_cut_into_as_many_slices_as_suit_it() {
    let mut rng = rng(17);
    let mut scene = Scene::new();
    for _ in 0..300 {
        let states = wander(&mut rng, 0.0, 400, 10.0, 400.0, 4.0);
        let plan = Trajectory::from_states(&states).unwrap();
        scene.insert(Body::new(plan)).unwrap();
    }
    let query = Query::new(Window::new(0.0, 3_000.0).unwrap());
    let query = query.with_margin(LEVEL.margin);
    let screened = scene.screen(&query).unwrap().stats;
    let mut monitor = with_every_change(Monitor::new(scene, 0.0, 3_000.0, &[LEVEL]).unwrap());
    tick(&mut monitor, 0.0);
    is_as_screened(&monitor, LEVEL);
    let found = monitor.stats().spans;
    assert!(found < 20 * screened.spans, "{found} {}", screened.spans);
}

/// A clock that goes on by many slices, but by little of the lookahead, has little that is new.
#[test]
fn a_step_over_what_is_known_keeps_it() {
    let mut rng = rng(18);
    let mut scene = Scene::new();
    for _ in 0..300 {
        let states = wander(&mut rng, 0.0, 500, 0.5, 400.0, 300.0);
        let plan = Trajectory::from_states(&states).unwrap();
        scene.insert(Body::new(plan)).unwrap();
    }
    let mut monitor = with_every_change(Monitor::new(scene, 0.0, 60.0, &[LEVEL]).unwrap());
    tick(&mut monitor, 0.0);
    let (all, slices) = (monitor.stats().boxes, monitor.stats().slices);
    assert!(slices > 85, "{slices}");
    for step in 1..=5 {
        tick(&mut monitor, 12.0 * f64::from(step));
        let new = monitor.stats().boxes;
        assert!(3 * new < all, "{new} {all}");
    }
    is_as_screened(&monitor, LEVEL);
    // One over all of it looks at what it passes and at all that lies ahead.
    tick(&mut monitor, 140.0);
    assert!(2 * monitor.stats().boxes > all);
    is_as_screened(&monitor, LEVEL);
}

/// A tick searches from nothing where the clock passes a slice or more of the lookahead with each: kept boxes do not pay there.
#[test]
fn a_lookahead_of_a_frame_is_searched_from_nothing() {
    const BODIES: u32 = 300;
    const FRAME: f64 = 1.0 / 60.0;
    for (frames, most) in [(0.5, 4), (1.0, 3), (2.0, 2), (3.0, 2)] {
        let mut rng = rng(19);
        let mut scene = Scene::new();
        for _ in 0..BODIES {
            let states = wander(&mut rng, 0.0, 12, 1.0, 200.0, 20.0);
            let plan = Trajectory::from_states(&states).unwrap();
            scene.insert(Body::new(plan)).unwrap();
        }
        let monitor = Monitor::new(scene, 0.0, frames * FRAME, &[LEVEL]).unwrap();
        let mut monitor = with_every_change(monitor);
        for frame in 0..40 {
            tick(&mut monitor, f64::from(frame) * FRAME);
            let boxes = monitor.stats().boxes;
            let is_few = boxes <= most * u64::from(BODIES);
            assert!(frame < 10 || is_few, "{frames} {frame} {boxes}");
        }
        is_as_screened(&monitor, LEVEL);
    }
}

/// Slices that suit bodies at rest, or an empty scene, do not suit what becomes of them; nor do those
/// of fast bodies when they have come to rest.
#[test]
fn a_scene_that_becomes_another_one_gets_other_slices() {
    const BODIES: usize = 500;
    let plan = |rng: &mut ChaCha8Rng, now: f64, speed: f64| {
        let states = wander(rng, now, 80, 1.0, 200.0, speed);
        Trajectory::from_states(&states).unwrap()
    };
    let work = |monitor: &mut Monitor, now: f64| {
        tick(monitor, now);
        monitor.stats().boxes + monitor.stats().candidates
    };
    for (slow, fast) in [(0.01, 20.0), (20.0, 0.01)] {
        for inserted in [false, true] {
            let mut rng = rng(23);
            let (mut scene, mut ids) = (Scene::new(), Vec::new());
            for _ in 0..if inserted { 0 } else { BODIES } {
                let body = Body::new(plan(&mut rng, 0.0, slow));
                ids.push(scene.insert(body).unwrap());
            }
            let mut monitor = with_every_change(Monitor::new(scene, 0.0, 60.0, &[LEVEL]).unwrap());
            let mut now = 0.0;
            for number in 0..BODIES {
                now += 1e-3;
                let new = plan(&mut rng, now, fast);
                if inserted {
                    ids.push(monitor.insert(Body::new(new)).unwrap());
                } else {
                    monitor.set_trajectory(ids[number], new).unwrap();
                }
                tick(&mut monitor, now);
            }
            let scene = monitor.scene().clone();
            let mut fresh = with_every_change(Monitor::new(scene, now, 60.0, &[LEVEL]).unwrap());
            tick(&mut fresh, now);
            let mut done = [0; 2];
            for number in 0..100 {
                now += 1e-2;
                let new = plan(&mut rng, now, fast);
                for (monitor, done) in [&mut monitor, &mut fresh].into_iter().zip(&mut done) {
                    monitor
                        .set_trajectory(ids[5 * number], new.clone())
                        .unwrap();
                    *done += work(monitor, now);
                }
            }
            assert!(done[0] < 4 * done[1], "{slow} {fast} {inserted} {done:?}");
            is_as_screened(&monitor, LEVEL);
        }
    }
}

/// Also where nobody changes, and after a jump into the middle of a slice.
#[test]
fn no_tick_stands_out() {
    let mut scene = Scene::new();
    let mut rng = rng(5);
    for _ in 0..1_000 {
        let states = wander(&mut rng, 0.0, 60, 1.0, 150.0, 10.0);
        let plan = Trajectory::from_states(&states).unwrap();
        scene.insert(Body::new(plan)).unwrap();
    }
    let mut monitor = with_every_change(Monitor::new(scene, 0.0, 5.0, &[LEVEL]).unwrap());
    tick(&mut monitor, 0.0);
    for from in [0.0, 33.3] {
        // With the next one the slice ahead is as far as it is to be by then.
        tick(&mut monitor, from);
        tick(&mut monitor, from + 1e-3);
        let work = (1..=600).map(|number| {
            tick(&mut monitor, from + f64::from(number) / 60.0);
            monitor.stats().boxes + monitor.stats().candidates
        });
        let work: Vec<u64> = work.collect();
        let mean = work.iter().sum::<u64>() / 600;
        let most = work.iter().max().unwrap();
        assert!(mean > 0 && *most < 20 * mean, "{most} {mean}");
    }
}

/// A crowd is searched to the end where instants are almost as far apart as slices. (It does not need the least step
/// of a search in parts of a slice: no scene is known that does.)
#[test]
fn a_crowd_late_on_the_clock_is_searched_to_the_end() {
    let mut rng = rng(23);
    // Neighbouring instants are a quarter of a second apart.
    let now = (1_u64 << 50) as f64;
    let mut scene = Scene::new();
    for _ in 0..400 {
        // To and fro in a small place, so that many slices suit them.
        let states = (-4..40).map(|step| {
            let (position, velocity) = (vector(&mut rng, 500.0), vector(&mut rng, 20_000.0));
            State::new(now + 0.25 * f64::from(step), position, velocity)
        });
        let plan = Trajectory::from_states(&states.collect::<Vec<_>>()).unwrap();
        scene.insert(Body::new(plan)).unwrap();
    }
    let mut monitor = Monitor::new(scene, now, 4.0, &[LEVEL]).unwrap();
    let (mut ticks, mut events) = (0, Vec::new());
    while !monitor.is_caught_up() {
        let budget = Budget::Work(100_000);
        monitor.advance_within(now, budget, &mut events).unwrap();
        ticks += 1;
        assert!(
            ticks < 100,
            "known up to {}",
            monitor.complete_until() - now
        );
    }
    is_as_screened(&monitor, LEVEL);
}

const TOUCH: AlertLevel = AlertLevel::at(0.0);

/// Bodies of a world, and where they go.
struct Crowd {
    rng: ChaCha8Rng,
    monitor: Monitor,
    bodies: Vec<(BodyId, State)>,
    now: f64,
}

impl Crowd {
    const STEP: f64 = 1.0 / 60.0;

    /// Returns bodies in a cube of a half side (m), with speeds up to one (m/s), and a monitor with a lookahead (s).
    fn of(count: usize, (half, speed, lookahead): (f64, f64, f64)) -> Self {
        let mut rng = rng(29);
        let mut scene = Scene::new();
        let mut put = |_| {
            let velocity = speed * vector(&mut rng, 1.0);
            let state = State::new(0.0, vector(&mut rng, half), velocity);
            let hitbox = Hitbox::sphere(0.02).unwrap();
            let body = Body::new(Trajectory::coasting(state).unwrap()).with_hitbox(hitbox);
            (scene.insert(body).unwrap(), state)
        };
        let bodies = (0..count).map(&mut put).collect();
        Self {
            monitor: Monitor::new(scene, 0.0, lookahead, &[TOUCH]).unwrap(),
            bodies,
            rng,
            now: 0.0,
        }
    }

    /// Tells the first bodies other states, each from its own, in a step of the clock; returns what the tick did.
    fn tell(&mut self, count: usize, to: impl Fn(&mut ChaCha8Rng, State) -> State) -> Stats {
        self.now += Self::STEP;
        for (_, state) in &mut self.bodies[..count] {
            let velocity = state.velocity;
            let place = state.position + (self.now - state.time) * velocity;
            *state = to(&mut self.rng, State::new(self.now, place, velocity));
        }
        let told = self.bodies[..count].iter().copied();
        self.monitor.track(self.now, told).unwrap();
        tick(&mut self.monitor, self.now);
        *self.monitor.stats()
    }

    /// Tells the first bodies other velocities again and again, with coordinates up to a speed (m/s); returns the work of the
    /// later ticks, in candidates. A box takes as long as six of them, at least.
    fn turn(&mut self, count: usize, speed: f64) -> u64 {
        let ticks = (0..22).map(|_| {
            self.tell(count, |rng, state| {
                State::new(state.time, state.position, vector(rng, speed))
            })
        });
        let work = ticks.map(|stats| 6 * stats.boxes + stats.candidates);
        work.skip(2).sum()
    }

    /// Returns the bodies with a monitor that never had others, on the same clock.
    fn anew(&self) -> Self {
        let mut scene = Scene::new();
        let old = self.monitor.scene();
        let mut again = |&(id, state): &(BodyId, State)| {
            let body = old.body(id).unwrap().clone();
            (scene.insert(body).unwrap(), state)
        };
        let bodies = self.bodies.iter().map(&mut again).collect();
        let lookahead = self.monitor.lookahead();
        Self {
            monitor: Monitor::new(scene, self.now, lookahead, &[TOUCH]).unwrap(),
            bodies,
            rng: rng(31),
            now: self.now,
        }
    }
}

/// Searches from nothing have as many slices as suit the bodies, too, where kept slices are as many as before.
#[test]
fn bodies_that_crowd_together_are_searched_in_as_many_slices_as_suit_them() {
    const BODIES: usize = 1_000;
    let mut crowd = Crowd::of(BODIES, (50.0, 10.0, 2.0));
    for _ in 0..200 {
        crowd.tell(BODIES, |rng, state| {
            State::new(state.time, 0.988 * state.position, vector(rng, 10.0))
        });
    }
    let mut fresh = crowd.anew();
    let work = [&mut crowd, &mut fresh].map(|crowd| crowd.turn(BODIES, 10.0));
    assert!(4 * work[0] < 5 * work[1], "{work:?}");
    is_as_screened(&crowd.monitor, TOUCH);
}

/// Slices suit bodies that begin to move among many that rest.
#[test]
fn some_that_begin_to_move_among_bodies_at_rest_get_other_slices() {
    const BODIES: usize = 1_000;
    let mut crowd = Crowd::of(BODIES, (50.0, 0.0, 20.0));
    for _ in 0..5 {
        crowd.tell(0, |_, state| state);
    }
    crowd.turn(BODIES / 4, 20.0);
    let mut fresh = crowd.anew();
    let work = [&mut crowd, &mut fresh].map(|crowd| crowd.turn(BODIES / 4, 20.0));
    assert!(4 * work[0] < 5 * work[1], "{work:?}");
    is_as_screened(&crowd.monitor, TOUCH);
}

/// After a peak, what is done from nothing where all bodies change is done so where all that are left do.
#[test]
fn a_few_bodies_that_are_left_of_many_cost_no_more_than_they_alone() {
    const LEFT: usize = 100;
    let mut crowd = Crowd::of(40 * LEFT, (80.0, 10.0, 2.0));
    crowd.tell(0, |_, state| state);
    for (id, _) in crowd.bodies.split_off(LEFT) {
        crowd.monitor.remove(id).unwrap();
    }
    crowd.turn(LEFT, 10.0);
    let mut fresh = crowd.anew();
    let work = [&mut crowd, &mut fresh].map(|crowd| crowd.turn(LEFT, 10.0));
    assert!(2 * work[0] < 3 * work[1], "{work:?}");
    is_as_screened(&crowd.monitor, TOUCH);
}
