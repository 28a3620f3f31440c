//! Omitted pairs change no result: against all pairs of spheres, solved one by one.

use super::super::super::certified::{Workspace, certified_approach};
use super::super::super::contact::closest_approach;
use super::super::super::profile::DistanceProfile;
use super::{Case, Mover, kept_contacts, vector};
use crate::accuracy::Accuracy;
use crate::hitbox::{Hitbox, Sphere};
use crate::narrow_phase::Contact;
use crate::orientation::Orientation;
use crate::spans::Span;
use crate::trajectory::{Outside, Pieces, State, Trajectory};
use crate::window::Window;
use glam::DVec3;
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};

mod rods;

/// Returns two bodies that do not turn.
fn resting(plans: [Pieces; 2], hitboxes: [Hitbox; 2], model_errors: [f64; 2]) -> [Mover; 2] {
    let [plan_a, plan_b] = plans;
    let [hitbox_a, hitbox_b] = hitboxes;
    let body = |plan, hitbox, model_error| Mover {
        plan,
        hitbox,
        orientation: Orientation::FIXED,
        model_error,
    };
    [
        body(plan_a, hitbox_a, model_errors[0]),
        body(plan_b, hitbox_b, model_errors[1]),
    ]
}

/// Returns a plan's pieces between two instants (s), or its own if they end there.
fn pieces(plan: Trajectory, (start, end): (f64, f64)) -> Pieces {
    let knots = plan.knots().to_vec();
    match Window::new(start, end) {
        Ok(window) if start < knots[0] => {
            Pieces::over(&plan.with_outside(Outside::Extrapolate), window)
        }
        _ => Pieces::own(&plan),
    }
}

/// Returns clusters of all kinds that fly by, into, and beside each other.
fn case(rng: &mut ChaCha8Rng, kind: usize) -> Case {
    let size = 10f64.powf(rng.random_range(-6.0..6.0));
    let far = [0.0, 1e3, 1e8][kind % 3] * size;
    let start = [0.0, 1.7e9][kind / 2 % 2];
    let hitbox = |rng: &mut ChaCha8Rng| {
        // Some are so many that they are put into groups.
        let count = if kind % 97 == 3 { 33..60 } else { 2..30 };
        let count = rng.random_range(count);
        let radius = size * rng.random_range(0.0..0.5);
        let sphere = |number: u32, rng: &mut ChaCha8Rng| {
            let cells = [number % 3, number / 3 % 3, number / 9];
            match kind / 4 % 5 {
                // A lattice: many pairs of spheres move alike.
                0 => (
                    DVec3::from_array(cells.map(f64::from)) * (0.5 * size),
                    radius / f64::from(1 + number % 2),
                ),
                // A rod.
                1 => (DVec3::X * (0.3 * size * f64::from(number)), radius),
                // Two groups: flown by one after the other.
                2 => (
                    vector(rng, size) + DVec3::X * (10.0 * size * f64::from(number % 2)),
                    radius,
                ),
                3 => (vector(rng, size), rng.random_range(0.0..=radius)),
                // One large sphere and points.
                _ => (vector(rng, size), if number == 0 { size } else { 0.0 }),
            }
        };
        // Some lie far from both bodies' positions, by a number that rounds what is near.
        let aside = DVec3::X * [0.0, 0.0, 0.0, 1e8 * size][kind / 2 % 4];
        let spheres = (0..count).map(|number| {
            let (offset, radius) = sphere(number, rng);
            let offset = offset + aside;
            Sphere { offset, radius }
        });
        match Hitbox::cluster(spheres.collect()) {
            Ok(hitbox) => hitbox,
            Err(error) => unreachable!("{error}"),
        }
    };
    let mut hitboxes = [hitbox(rng), hitbox(rng)];
    if kind % 11 == 7 {
        // Only one sphere: that around all is no larger.
        let sphere = Hitbox::cluster(hitboxes[0].spheres()[..1].to_vec());
        hitboxes[0] = sphere.unwrap_or_else(|_| unreachable!());
    }
    let base = vector(rng, far);
    // From straight to wild; together, or at rest.
    let wild = [0.0, 0.3, 3.0, 20.0][rng.random_range(0..4)] * size;
    let speed = [0.0, 2.0, 30.0][rng.random_range(0..3)] * size;
    let together = vector(rng, speed);
    let plan = |rng: &mut ChaCha8Rng| {
        let relative = if kind.is_multiple_of(5) {
            DVec3::ZERO
        } else {
            vector(rng, speed)
        };
        let velocity = together + relative;
        let place = base + vector(rng, size) - velocity * 0.5;
        let states = [0.0, 0.4, 1.0].map(|time| {
            let velocity = velocity + vector(rng, wild);
            State::new(start + time, place + velocity * time, velocity)
        });
        match Trajectory::from_states(&states) {
            Ok(plan) => plan,
            Err(error) => unreachable!("{error}"),
        }
    };
    let plans = [plan(rng), plan(rng)];
    // Some from far before their knots on.
    let begin = [start, start, start, start - 700.0][kind / 3 % 4];
    let plans = plans.map(|plan| pieces(plan, (begin, start + 1.0)));
    let window = match kind % 7 {
        0 => (
            start + rng.random_range(0.0..0.5),
            start + rng.random_range(0.5..1.0),
        ),
        1 => (start + 0.45, start + 0.45),
        _ => (f64::MIN, f64::MAX),
    };
    let margin = [-0.3, 0.0, 0.1, 1.0, 5.0][rng.random_range(0..5)] * size;
    let model_errors = [[0.0, 0.0], [0.0, 0.1 * size], [0.4 * size, size]][kind % 3];
    let mut case = Case {
        bodies: resting(plans, hitboxes, model_errors),
        margin,
        window,
        start: begin,
        end: start + 1.0,
    };
    if kind.is_multiple_of(4) {
        // A touch, as far as rounding can tell.
        let nearest = case.nearest(window);
        case.margin = nearest.map_or(margin, |nearest| nearest.separation);
    }
    case
}

impl Case {
    /// Returns windows that begin and end at instants of contacts.
    fn windows_at(&self, contacts: &[Contact]) -> Vec<(f64, f64)> {
        let end = self.end;
        let of_contact = |contact: &Contact| {
            let Contact { enter, exit, .. } = *contact;
            let time = contact.closest.time;
            [(exit, end), (self.start, enter), (time, end), (time, time)]
        };
        let windows = contacts.iter().take(3).flat_map(of_contact);
        let windows = windows.chain([self.window]);
        windows.filter(|window| window.0 <= window.1).collect()
    }
}

#[test]
fn contacts_are_those_of_all_pairs() {
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    let (mut several, mut one) = (0, 0);
    for kind in 0..4_000 {
        let case = case(&mut rng, kind);
        let found = case.contacts(case.window);
        one += usize::from(found.len() == 1);
        several += usize::from(found.len() > 1);
        for window in case.windows_at(&found) {
            let expected = case.contacts_of_all(case.band().outer, window);
            assert_eq!(case.contacts(window), expected, "{kind} {window:?}");
        }
    }
    assert!(one > 1_000 && several > 100, "{one} {several}");
}

/// The cached part of a span serves all smaller margins, in any window.
#[test]
fn what_is_kept_of_a_span_serves_for_all_margins_and_windows() {
    let mut rng = ChaCha8Rng::seed_from_u64(4);
    let (mut several, mut count, mut all) = (0, 0, 0);
    for kind in 0..2_000 {
        let case = case(&mut rng, kind);
        let [a, b] = &case.views();
        let kept = case.kept(&[case.margin], None);
        count += kept.len();
        all += case.spans().len() * a.spheres.len() * b.spheres.len();
        let found = kept_contacts(&kept, case.band().outer, (f64::MIN, f64::MAX));
        let begin = case.start + f64::max(rng.random_range(-0.5..1.0), 0.0);
        let any = (begin, begin + rng.random_range(0.0..1.0));
        for window in case.windows_at(&found).into_iter().chain([any]) {
            let less = case.margin.abs() * rng.random_range(0.0..1.0);
            for margin in [case.band().outer, case.margin - less] {
                let found = kept_contacts(&kept, margin, window);
                let expected = case.contacts_of_all(margin, window);
                assert_eq!(found, expected, "{kind} {margin} {window:?}");
                several += found.len();
            }
        }
    }
    assert!(
        several > 5_000 && 5 * count < all,
        "{several} {count} {all}"
    );
}

#[test]
fn whole_contacts_are_those_of_all_pairs() {
    let mut rng = ChaCha8Rng::seed_from_u64(5);
    let mut count = 0;
    for kind in 0..2_000 {
        let case = case(&mut rng, kind);
        let found = case.contacts(case.window);
        let larger = case.margin + case.margin.abs() * rng.random_range(0.0..1.0);
        count += case.check_whole_contacts(larger, case.windows_at(&found).into_iter());
    }
    assert!(count > 5_000, "{count}");
}

#[test]
fn proofs_are_those_of_all_pairs() {
    let mut rng = ChaCha8Rng::seed_from_u64(2);
    let (mut workspace, mut all) = (Workspace::default(), Workspace::default());
    let (mut resolved, mut unresolved) = (0, 0);
    for kind in 0..800 {
        let case = case(&mut rng, kind);
        for window in case.windows_at(&case.contacts(case.window)) {
            let found = case.proofs(window, &mut workspace);
            let expected = case.proofs_of_all(window, &mut all);
            assert_eq!(found, expected, "{kind} {window:?}");
            resolved += found.iter().filter(|one| one.certificate.resolved).count();
            unresolved += found.iter().filter(|one| !one.certificate.resolved).count();
        }
    }
    assert!(resolved > 500 && unresolved > 5, "{resolved} {unresolved}");
}

#[test]
fn the_nearest_is_that_of_all_pairs() {
    let mut rng = ChaCha8Rng::seed_from_u64(3);
    for kind in 0..3_000 {
        let case = case(&mut rng, kind);
        let [a, b] = &case.views();
        for window in case.windows_at(&case.contacts(case.window)) {
            let of_window = |span: &Span| span.end >= window.0 && span.start <= window.1;
            let spans = || case.spans().into_iter().filter(of_window);
            let found = closest_approach(a, b, spans(), window);
            let nearest = case.nearest_of_all(window);
            assert_eq!(found, nearest, "{kind} {window:?}");
            // Where a window cuts, the plain solver is off by what the rounding of time amounts to.
            if kind % 5 == 3 && window == (f64::MIN, f64::MAX) {
                let certified = certified_approach(a, b, spans(), window);
                let (approach, error, _) = certified.unwrap_or_else(|| unreachable!());
                let nearest = nearest.map_or(f64::NAN, |nearest| nearest.separation);
                let off = (approach.separation - nearest).abs();
                assert!(off <= 2.0 * error, "{kind}");
            }
        }
    }
}

/// Returns clusters that pass each other late on the clock, where representable instants are far
/// apart: between two of them, several pairs in turn are the nearest ones.
fn late_case(rng: &mut ChaCha8Rng) -> Case {
    const START: f64 = 1.7e9;
    let velocity = vector(rng, 1e4);
    let way = velocity.length() * 10f64.powf(rng.random_range(-9.0..-6.0));
    let aside = 10f64.powf(rng.random_range(-3.0..1.0));
    let radius = [0.0, 0.3 * aside][rng.random_range(0..2)];
    let hitboxes = [0, 1].map(|_| {
        let spheres = (0..4).map(|_| Sphere {
            offset: vector(rng, way),
            radius,
        });
        Hitbox::cluster(spheres.collect()).unwrap_or_else(|error| unreachable!("{error}"))
    });
    let across = velocity.any_orthonormal_vector() * aside;
    let middle = START + rng.random_range(0.3..0.7);
    let plans = [(velocity, across), (DVec3::ZERO, DVec3::ZERO)].map(|(velocity, place)| {
        let states = [START, START + 1.0]
            .map(|time| State::new(time, place + velocity * (time - middle), velocity));
        let plan = Trajectory::from_states(&states);
        Pieces::own(&plan.unwrap_or_else(|error| unreachable!("{error}")))
    });
    let more = [-way, 0.0, way, aside][rng.random_range(0..4)];
    Case {
        bodies: resting(plans, hitboxes, [0.0; 2]),
        margin: aside - 2.0 * radius + more,
        window: (f64::MIN, f64::MAX),
        start: START,
        end: START + 1.0,
    }
}

/// Windows begin and end at, or an instant beside, contacts and nearest instants of spheres.
#[test]
fn what_instants_are_rounded_by_rules_nothing_out() {
    let mut rng = ChaCha8Rng::seed_from_u64(5);
    let (mut workspace, mut all) = (Workspace::default(), Workspace::default());
    let mut several = 0;
    for round in 0..600 {
        let case = late_case(&mut rng);
        let mut instants = Vec::new();
        case.each(Accuracy::Exact, |pair, span| {
            let profile = DistanceProfile::of(&pair.cubic);
            let mut found = Vec::new();
            pair.contacts(&profile, span, case.band().outer, case.window, &mut found);
            let of_contact = |one: &Contact| [one.enter, one.closest.time, one.exit];
            instants.extend(found.iter().flat_map(of_contact));
        });
        let whole = (case.start, case.end);
        let kept = case.kept(&[case.margin], None);
        for _ in 0..8.min(instants.len()) {
            let any = |rng: &mut ChaCha8Rng| {
                let time = instants[rng.random_range(0..instants.len())];
                [time.next_down(), time, time.next_up()][rng.random_range(0..3)]
            };
            let (one, other) = (any(&mut rng), any(&mut rng));
            let windows = [
                (one, whole.1),
                (whole.0, one),
                (one.min(other), one.max(other)),
                (one, one),
            ];
            let window = windows[rng.random_range(0..4)];
            let expected = case.contacts_of_all(case.band().outer, window);
            assert_eq!(case.contacts(window), expected, "{round} {window:?}");
            let found = kept_contacts(&kept, case.band().outer, window);
            assert_eq!(found, expected, "{round} {window:?}");
            several += usize::from(!found.is_empty());
            let nearest = case.nearest_of_all(window);
            assert_eq!(case.nearest(window), nearest, "{round} {window:?}");
            let proven = case.proofs(window, &mut workspace);
            let expected = case.proofs_of_all(window, &mut all);
            assert_eq!(proven, expected, "{round} {window:?}");
        }
    }
    assert!(several > 500, "{several}");
}
