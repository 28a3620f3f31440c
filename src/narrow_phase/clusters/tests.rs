//! What is left out changes nothing: against all pairs of spheres, solved one by one.

use super::super::certified::{Workspace, certified_approach, certified_contacts};
use super::super::contact::{
    Contact, Nearest, closest_approach, contacts, contacts_of, join, solve,
};
use super::super::stretches::Profile;
use super::{Candidate, Clusters};
use crate::hitbox::{Hitbox, Sphere};
use crate::narrow_phase::Party;
use crate::spans::{Span, spans};
use crate::trajectory::{State, Trajectory};
use glam::DVec3;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Two bodies and what is asked about them.
struct Case {
    plans: [Trajectory; 2],
    hitboxes: [Hitbox; 2],
    margin: f64,
    clip: (f64, f64),
}

/// Clusters of all kinds that fly by, into, and beside each other.
fn case(rng: &mut ChaCha8Rng, kind: usize) -> Case {
    let size = 10f64.powf(rng.random_range(-6.0..6.0));
    let far = [0.0, 1e3, 1e8][kind % 3] * size;
    let vector = |rng: &mut ChaCha8Rng, half: f64| {
        DVec3::from_array([0; 3].map(|_| rng.random_range(-half..=half)))
    };
    let hitbox = |rng: &mut ChaCha8Rng| {
        let count = rng.random_range(2..30);
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
        let spheres = (0..count).map(|number| {
            let (offset, radius) = sphere(number, rng);
            Sphere { offset, radius }
        });
        match Hitbox::cluster(spheres.collect()) {
            Ok(hitbox) => hitbox,
            Err(error) => unreachable!("{error}"),
        }
    };
    let hitboxes = [hitbox(rng), hitbox(rng)];
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
            State::new(time, place + velocity * time, velocity)
        });
        match Trajectory::from_states(&states) {
            Ok(plan) => plan,
            Err(error) => unreachable!("{error}"),
        }
    };
    let plans = [plan(rng), plan(rng)];
    let clip = match kind % 7 {
        0 => (rng.random_range(0.0..0.5), rng.random_range(0.5..1.0)),
        1 => (0.45, 0.45),
        _ => (f64::MIN, f64::MAX),
    };
    let margin = [-0.3, 0.0, 0.1, 1.0, 5.0][rng.random_range(0..5)] * size;
    let mut case = Case {
        plans,
        hitboxes,
        margin,
        clip,
    };
    if kind.is_multiple_of(4) {
        // A touch, as far as rounding can tell.
        let [a, b] = &case.parties();
        let nearest = closest_approach(a, b, case.spans().into_iter(), clip);
        case.margin = nearest.map_or(margin, |nearest| nearest.separation);
    }
    case
}

impl Case {
    fn parties(&self) -> [Party<'_>; 2] {
        [0, 1].map(|number: usize| Party {
            knots: self.plans[number].knots(),
            segments: self.plans[number].segments(),
            spheres: self.hitboxes[number].spheres(),
            bounding: self.hitboxes[number].bounding(),
        })
    }

    fn spans(&self) -> Vec<Span> {
        let [a, b] = self.parties();
        let (from, to) = (self.clip.0.max(0.0), self.clip.1.min(1.0));
        spans(a.knots, b.knots, from, to).collect()
    }

    /// Each pair of spheres over each span.
    fn each(&self, mut visit: impl FnMut(&super::SpherePair, Span)) {
        let [a, b] = &self.parties();
        for span in self.spans() {
            let clusters = Clusters::of(a, b, span);
            for number_a in 0..a.spheres.len() {
                for number_b in 0..b.spheres.len() {
                    let number = |number| u32::try_from(number).unwrap_or(u32::MAX);
                    visit(
                        &clusters.pair(&Candidate {
                            a: number(number_a),
                            b: number(number_b),
                            low: 0.0,
                        }),
                        span,
                    );
                }
            }
        }
    }
}

#[test]
fn contacts_are_those_of_all_pairs() {
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    let (mut found, mut expected) = (Vec::new(), Vec::<Contact>::new());
    let (mut several, mut one) = (0, 0);
    for kind in 0..6_000 {
        let case = case(&mut rng, kind);
        let [a, b] = &case.parties();
        found.clear();
        contacts(
            a,
            b,
            case.spans().into_iter(),
            case.margin,
            case.clip,
            &mut found,
        );
        expected.clear();
        case.each(|pair, span| {
            pair.contacts(
                &Profile::of(&pair.cubic),
                span,
                case.margin,
                case.clip,
                &mut expected,
            );
        });
        join(&mut expected, 0);
        assert_eq!(found, expected, "{kind}");
        one += usize::from(found.len() == 1);
        several += usize::from(found.len() > 1);
    }
    assert!(one > 1_500 && several > 100, "{one} {several}");
}

/// What a monitor keeps of a span serves for all smaller margins, in any window.
#[test]
fn the_envelope_serves_for_all_margins_and_windows() {
    let mut rng = ChaCha8Rng::seed_from_u64(4);
    let (mut kept, mut found, mut expected) = (Vec::new(), Vec::new(), Vec::<Contact>::new());
    let (mut several, mut count, mut all) = (0, 0, 0);
    for kind in 0..3_000 {
        let case = case(&mut rng, kind);
        let [a, b] = &case.parties();
        kept.clear();
        for span in case.spans() {
            solve(a, b, span, case.margin, |solved| kept.push(solved));
        }
        count += kept.len();
        all += case.spans().len() * a.spheres.len() * b.spheres.len();
        for round in 0..6 {
            let less = case.margin.abs() * rng.random_range(0.0..1.0);
            let margin = case.margin - if round == 0 { 0.0 } else { less };
            let begin: f64 = rng.random_range(-0.5..1.0);
            let clip = (begin.max(0.0), begin.max(0.0) + rng.random_range(0.0..1.0));
            found.clear();
            contacts_of(kept.iter(), margin, clip, &mut found);
            expected.clear();
            case.each(|pair, span| {
                pair.contacts(&Profile::of(&pair.cubic), span, margin, clip, &mut expected);
            });
            join(&mut expected, 0);
            assert_eq!(found, expected, "{kind} {round}");
            several += found.len();
        }
    }
    assert!(
        several > 5_000 && 5 * count < all,
        "{several} {count} {all}"
    );
}

#[test]
fn proofs_are_those_of_all_pairs() {
    let mut rng = ChaCha8Rng::seed_from_u64(2);
    let (mut workspace, mut all) = (Workspace::default(), Workspace::default());
    let (mut found, mut expected) = (Vec::new(), Vec::new());
    let (mut resolved, mut unresolved) = (0, 0);
    for kind in 0..1_500 {
        let case = case(&mut rng, kind);
        let [a, b] = &case.parties();
        found.clear();
        let spans = case.spans().into_iter();
        certified_contacts(
            a,
            b,
            spans,
            case.margin,
            case.clip,
            &mut workspace,
            &mut found,
        );
        expected.clear();
        all.clear();
        case.each(|pair, span| {
            all.solve(pair, span, case.margin, case.clip);
        });
        all.join((a, b), case.margin, case.clip, &mut expected);
        assert_eq!(found, expected, "{kind}");
        resolved += found.iter().filter(|one| one.certificate.resolved).count();
        unresolved += found.iter().filter(|one| !one.certificate.resolved).count();
    }
    assert!(resolved > 500 && unresolved > 5, "{resolved} {unresolved}");
}

#[test]
fn the_nearest_is_that_of_all_pairs() {
    let mut rng = ChaCha8Rng::seed_from_u64(3);
    for kind in 0..4_000 {
        let case = case(&mut rng, kind);
        let [a, b] = &case.parties();
        let found = closest_approach(a, b, case.spans().into_iter(), case.clip);
        let mut nearest = Nearest::default();
        let mut before = None;
        case.each(|pair, span| {
            if before.replace(span).is_some_and(|before| before != span) {
                nearest.settle();
            }
            nearest.push(pair, span, case.clip);
        });
        nearest.settle();
        assert_eq!(found, nearest.closest, "{kind}");
        if kind % 10 == 0 {
            let certified = certified_approach(a, b, case.spans().into_iter(), case.clip);
            let (approach, error, _) = certified.unwrap_or_else(|| unreachable!());
            let nearest = nearest.separation();
            assert!(
                (approach.separation - nearest).abs() <= 2.0 * error,
                "{kind}"
            );
        }
    }
}
