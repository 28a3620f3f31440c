//! Certificates through the public API: what they say where it can be worked out by hand.

#![allow(
    clippy::unwrap_used,
    reason = "a scene that cannot be built fails the test"
)]

mod support;

use glam::DVec3;
use nearmiss::{
    Accuracy, Body, Certificate, Conflict, Error, Hitbox, Query, Scene, Sphere, State, TimeBase,
    TimeEnclosure, Trajectory, Window,
};
use support::{scene_of, swarm};

fn line(times: [f64; 2], from: DVec3, velocity: DVec3) -> Trajectory {
    let states = times.map(|t| State::new(t, from + velocity * (t - times[0]), velocity));
    Trajectory::from_states(&states).unwrap()
}

fn scene(bodies: impl IntoIterator<Item = (Trajectory, Hitbox)>) -> Scene {
    let mut scene = Scene::new();
    for (trajectory, hitbox) in bodies {
        let body = Body::new(trajectory).with_hitbox(hitbox);
        scene.insert(body).unwrap();
    }
    scene
}

fn certified(scene: &Scene, margin: f64, window: Window) -> Vec<(Conflict, Certificate)> {
    let query = Query::new(window)
        .with_margin(margin)
        .with_accuracy(Accuracy::Certified);
    let conflicts = scene.screen(&query).unwrap().conflicts;
    conflicts
        .into_iter()
        .map(|conflict| (conflict, conflict.certificate.unwrap()))
        .collect()
}

fn holds(enclosure: TimeEnclosure, time: f64) -> bool {
    (enclosure.earliest..=enclosure.latest).contains(&time)
}

/// A pass at 3 m with 5 m/s: within 5 m from 0.8 s before to 0.8 s after.
fn pass() -> Scene {
    let flying = line([0.0, 12.0], DVec3::new(-30.0, 3.0, 0.0), 5.0 * DVec3::X);
    let resting = line([0.0, 12.0], DVec3::ZERO, DVec3::ZERO);
    scene([flying, resting].map(|trajectory| (trajectory, Hitbox::POINT)))
}

#[test]
fn a_pass_is_enclosed_to_a_few_roundings() {
    let found = certified(&pass(), 5.0, Window::ALL);
    assert_eq!(found.len(), 1);
    let (conflict, proof) = found[0];
    assert!(proof.resolved);
    for (enclosure, time) in [(proof.enter, 5.2), (proof.exit, 6.8), (proof.closest, 6.0)] {
        assert!(holds(enclosure, time), "{enclosure:?} {time}");
    }
    assert!((conflict.closest.separation - 3.0).abs() <= proof.error);
    // The local scale is some 100 m, its unit roundoff 1e-14.
    assert!(proof.error < 1e-12, "{}", proof.error);
    assert!(proof.enter.latest - proof.enter.earliest < 1e-12);
}

#[test]
fn a_window_cuts_the_enclosures() {
    let window = Window::new(6.5, 7.0).unwrap();
    let (conflict, proof) = certified(&pass(), 5.0, window)[0];
    let cut = TimeEnclosure {
        earliest: 6.5,
        latest: 6.5,
    };
    assert_eq!(proof.enter, cut);
    assert!(conflict.clip.at_enter && !conflict.clip.at_exit);
    assert!(holds(proof.closest, 6.5));
    // 2.5 m along and 3 m beside at the cut.
    let least = (2.5_f64 * 2.5 + 9.0).sqrt();
    assert!((conflict.closest.separation - least).abs() <= proof.error + 1e-15);
    assert!(certified(&pass(), 5.0, Window::new(7.0, 8.0).unwrap()).is_empty());
}

/// Where the clock's resolution is a tenth of a microsecond, an exit is enclosed by instants between which
/// the bodies go as far: in a window that begins at the later one they are apart, and proven to be.
#[test]
fn what_is_proven_outside_is_not_reported() {
    let mut apart = 0;
    for step in 0..200 {
        let aside = 0.9 * f64::from(step) / 200.0;
        let flying = line([1e9, 1e9 + 7.0], DVec3::new(-3.0, aside, 0.0), DVec3::X);
        let scene = scene(
            [flying, line([1e9, 2e9], DVec3::ZERO, DVec3::ZERO)].map(|plan| (plan, Hitbox::POINT)),
        );
        let (whole, _) = certified(&scene, 1.0, Window::ALL)[0];
        let (mut later, mut sooner) = (whole.exit, whole.enter);
        for _ in 0..4 {
            let after = certified(&scene, 1.0, Window::new(later, 1e9 + 7.0).unwrap());
            let before = certified(&scene, 1.0, Window::new(1e9, sooner).unwrap());
            for (conflict, proof) in after.iter().chain(&before) {
                assert!(
                    conflict.closest.separation - proof.error <= 1.0,
                    "{conflict:?}"
                );
            }
            apart += usize::from(after.is_empty()) + usize::from(before.is_empty());
            (later, sooner) = (later.next_up(), sooner.next_down());
        }
    }
    // From the first instant after it on.
    assert!(apart > 1_000, "{apart}");
}

/// Bodies that leave a third one, or come to it, with more and more speed: nearest at an end of the
/// span, where the distance is known at once, however little is known of the rest.
#[test]
fn the_end_of_a_span_is_enclosed_to_a_few_roundings() {
    let resting = Body::new(line([0.0, 1.0], DVec3::ZERO, DVec3::ZERO));
    for (from, to, speeds, nearest) in [
        (0.0, 1.0, [1.0, 3.0], 0.0),
        (0.0, 1.0, [1.0, 2.999_999_999_9], 0.0),
        (1.0, 2.0, [1.0, 3.0], 0.0),
        (-1.0, 0.0, [3.0, 1.0], 1.0),
        (-2.0, -1.0, [3.0, 1.0], 1.0),
    ] {
        let states = [(0.0, from, speeds[0]), (1.0, to, speeds[1])]
            .map(|(t, x, v)| State::new(t, x * DVec3::X, v * DVec3::X));
        let moving = Body::new(Trajectory::from_states(&states).unwrap());
        let window = Window::new(0.0, 1.0).unwrap();
        let found = nearmiss::pair::certified_closest_approach(&moving, &resting, window);
        let found = found.unwrap().unwrap();
        let least = f64::min(f64::abs(from), f64::abs(to));
        assert!((found.approach.separation - least).abs() <= found.error);
        // The slope is 1 m/s there; a few ten roundings of 2 m.
        assert!(holds(found.time, nearest), "{found:?}");
        assert!(found.time.latest - found.time.earliest < 1e-13, "{found:?}");
    }
}

/// Least at a flat place, and the margin a few roundings above that. The instants that values and
/// slopes leave to the least distance would reach beyond a conflict that short.
#[test]
fn the_closest_approach_is_enclosed_within_the_conflict() {
    let mut found = 0;
    for (aside, step) in [(0.3, 1e-16), (3.0, 1e-15)] {
        // x = (t - 0.4)³
        let states = [0.0, 1.0].map(|t: f64| {
            let since = t - 0.4;
            let place = DVec3::new(since.powi(3), aside, 0.0);
            State::new(t, place, 3.0 * since * since * DVec3::X)
        });
        let moving = Trajectory::from_states(&states).unwrap();
        let resting = line([0.0, 1.0], DVec3::ZERO, DVec3::ZERO);
        let scene = scene([moving, resting].map(|plan| (plan, Hitbox::POINT)));
        for steps in 0..400 {
            let margin = aside + f64::from(steps) * step;
            for (conflict, proof) in certified(&scene, margin, Window::ALL) {
                found += 1;
                let TimeEnclosure { earliest, latest } = proof.closest;
                assert!(proof.enter.earliest <= earliest, "{margin} {proof:?}");
                assert!(latest <= proof.exit.latest, "{margin} {proof:?}");
                assert!(holds(proof.closest, conflict.closest.time));
            }
        }
    }
    assert_eq!(found, 800);
}

/// Rounding cannot tell a touch from a miss: reported, and marked.
#[test]
fn a_touch_is_unresolved() {
    let found = certified(&pass(), 3.0, Window::ALL);
    assert_eq!(found.len(), 1);
    let (conflict, proof) = found[0];
    assert!(!proof.resolved);
    assert!(holds(proof.enter, 6.0) && holds(proof.exit, 6.0) && holds(proof.closest, 6.0));
    assert!((conflict.closest.separation - 3.0).abs() <= proof.error);
    // Certainly apart, and certainly not: a thousand roundings to either side.
    assert!(certified(&pass(), 3.0 - 1e-11, Window::ALL).is_empty());
    assert!(certified(&pass(), 3.0 + 1e-11, Window::ALL)[0].1.resolved);
}

/// A constant distance exactly at the margin is one unresolved conflict all along.
#[test]
fn formation_at_the_margin() {
    let plan = |y: f64| {
        line(
            [0.0, 9.0],
            DVec3::new(0.1, y, 0.3),
            DVec3::new(1.7, 0.3, 0.0),
        )
    };
    let pair = scene([0.0, 2.0].map(|y| (plan(y), Hitbox::POINT)));
    let (conflict, proof) = certified(&pair, 2.0, Window::ALL)[0];
    assert!(!proof.resolved);
    assert_eq!((conflict.enter, conflict.exit), (0.0, 9.0));
    assert!(holds(proof.enter, 0.0) && holds(proof.exit, 9.0));
}

/// Two spheres of a cluster follow each other through the margin. Where the gap between them is
/// there for certain, these are two conflicts; where they overlap, one; where the one leaves as
/// the other comes, nobody can tell.
#[test]
fn gaps_between_spheres() {
    let behind = |gap: f64| {
        let sphere = |x: f64| Sphere {
            offset: DVec3::new(x, 0.0, 0.0),
            radius: 0.1,
        };
        let cluster = Hitbox::cluster(vec![sphere(0.0), sphere(-2.0 - gap)]).unwrap();
        let flying = line([0.0, 12.0], DVec3::new(-5.0, 0.1, 0.0), DVec3::X);
        let resting = line([0.0, 12.0], DVec3::new(0.0, 0.1, 0.0), DVec3::ZERO);
        scene([(flying, cluster), (resting, Hitbox::sphere(0.4).unwrap())])
    };
    // Each sphere is within 1 m for 2 s.
    let found = |gap: f64| certified(&behind(gap), 0.5, Window::ALL);
    let resolved =
        |found: &[(Conflict, Certificate)]| found.iter().all(|(_, proof)| proof.resolved);
    let apart = found(1e-9);
    assert!(apart.len() == 2 && resolved(&apart), "{apart:?}");
    let over = found(-1e-9);
    assert!(over.len() == 1 && resolved(&over), "{over:?}");
    let open = found(0.0);
    assert!(open.len() == 1 && !resolved(&open), "{open:?}");
    assert!(holds(open[0].1.enter, 4.0) && holds(open[0].1.exit, 8.0));
}

/// A polynomial in absolute time, a million kilometres out, is known to 6e-8 m only. Its true
/// distance is 1 m less half of that; no filter may forget it.
#[test]
fn what_is_known_less_well_is_not_lost() {
    let far = 1e9;
    // Just less than half a unit in the last place of 1e9: lost when it is added.
    let lost = 5.9e-8;
    let creeping = [DVec3::ZERO, DVec3::ZERO, DVec3::ZERO, DVec3::X * far];
    let creeping = [
        creeping[0],
        creeping[1],
        DVec3::X * (lost / 1000.0),
        creeping[3],
    ];
    let plan =
        Trajectory::from_coefficients(&[1000.0, 1001.0], &[creeping], TimeBase::Absolute).unwrap();
    let resting = line([1000.0, 1001.0], DVec3::X * (far + 1.0), DVec3::ZERO);
    let pair = scene([plan, resting].map(|trajectory| (trajectory, Hitbox::POINT)));
    let found = certified(&pair, 1.0 - lost / 2.0, Window::ALL);
    assert_eq!(found.len(), 1);
    let (conflict, proof) = found[0];
    assert!(!proof.resolved);
    let truth = 1.0 - lost * 1.001;
    assert!((conflict.closest.separation - truth).abs() <= proof.error);
}

/// The same conflicts as without certificates, their numbers within the enclosures.
#[test]
fn certified_and_exact_agree() {
    let scene = scene_of(&swarm(23, 150, 60.0));
    for window in [Window::ALL, Window::new(10.0, 31.0).unwrap()] {
        let query = Query::new(window).with_margin(1.5);
        let exact = scene.screen(&query).unwrap().conflicts;
        let found = certified(&scene, 1.5, window);
        assert!(exact.len() > 20);
        assert_eq!(exact.len(), found.len());
        for (plain, (conflict, proof)) in exact.iter().zip(&found) {
            assert!(proof.resolved);
            assert_eq!(
                (plain.a, plain.b, plain.clip),
                (conflict.a, conflict.b, conflict.clip)
            );
            // Both are good to a few roundings of some 1000 m and 60 s.
            assert!((plain.enter - conflict.enter).abs() < 1e-11);
            assert!((plain.closest.separation - conflict.closest.separation).abs() < 1e-12);
            assert!(holds(proof.enter, conflict.enter) && holds(proof.exit, conflict.exit));
            assert!(holds(proof.closest, conflict.closest.time));
            let pair = scene.certified_closest_approach(plain.a, plain.b, window);
            let least = pair.unwrap().unwrap();
            let below = least.approach.separation - least.error;
            assert!(below <= conflict.closest.separation + proof.error);
        }
    }
}

/// Beside a jump, where instants are too coarse to tell its sides apart: what is reported of the closest
/// instant is of the cubic that is followed then.
#[test]
fn the_closest_instant_is_of_one_cubic() {
    for (start, next) in [
        (1.7e9, 1.7e9_f64.next_up()),
        (1.0, 1.0_f64.next_up()),
        (0.0, 1e-3),
    ] {
        let at = |time: f64, x: f64| State::new(time, DVec3::new(x, 1.0, 0.0), DVec3::ZERO);
        let jumps = [
            at(start, -10.0),
            at(next, 8.0),
            at(next + 1.0, 5.0),
            at(next + 2.0, 20.0),
        ];
        let rests = [start, next + 2.0].map(|time| State::new(time, DVec3::ZERO, DVec3::ZERO));
        let plans = [&rests[..], &jumps[..]].map(|states| Trajectory::from_states(states).unwrap());
        let scene = scene(plans.map(|plan| (plan, Hitbox::POINT)));
        let window = Window::new(next, next + 2.0).unwrap();
        for (conflict, proof) in certified(&scene, 100.0, window) {
            let closest = conflict.closest;
            let distance = closest.position_a.distance(closest.position_b);
            assert!((distance - closest.separation).abs() <= proof.error + 1e-12);
            assert!(closest.relative_velocity.length() < 1e5);
        }
    }
}

/// Terms of a polynomial that cancel, but for errors that are beyond the range of numbers.
#[test]
fn a_polynomial_of_which_nothing_is_known_is_refused() {
    let start = 2_f64.powi(330);
    let knots = [start, start.next_up()];
    let b = DVec3::X * 2_f64.powi(358);
    let polynomial = [DVec3::ZERO, b, -b * start, DVec3::ZERO];
    let plan = Trajectory::from_coefficients(&knots, &[polynomial], TimeBase::Absolute);
    assert!(matches!(plan, Err(Error::OutOfRange { .. })), "{plan:?}");
}

/// Just before a power of two, after which instants are half as fine: dead reckoning leads through the
/// points that it should.
#[test]
fn coasting_is_proven_whatever_the_clock_shows() {
    const LATER: f64 = 128.0;
    for exponent in [5, 7, 10, 16, 20, 25, 31] {
        for step in 1..40 {
            let clock = 2_f64.powi(exponent) - 0.140_625 * f64::from(step);
            // With bits that are lost beyond the power of two.
            let clock = clock.next_down();
            let velocity = DVec3::new(10.0, -0.25, 3.0);
            let comes = Trajectory::coasting(State::new(clock, DVec3::ONE, velocity)).unwrap();
            let rests = Trajectory::at_rest(DVec3::ONE + LATER * velocity).unwrap();
            let scene = scene([comes, rests].map(|plan| (plan, Hitbox::POINT)));
            let window = Window::new(clock, clock + 200.0).unwrap();
            let ids: Vec<_> = scene.bodies().map(|(id, _)| id).collect();
            let found = scene.certified_closest_approach(ids[0], ids[1], window);
            let found = found.unwrap().unwrap();
            let (separation, error) = (found.approach.separation, found.error);
            assert!(separation <= error, "{clock}: {separation:e} {error:e}");
            assert!(error < 1e-11, "{clock}: {error:e}");
            // As near as an instant can be to that.
            let (time, meets) = (found.time, clock + LATER);
            assert!(time.earliest <= meets.next_up() && meets.next_down() <= time.latest);
        }
    }
}
