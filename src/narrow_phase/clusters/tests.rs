//! Omitted pairs of spheres change no result: against all of them, solved one by one.

#![allow(clippy::unwrap_used, reason = "a failure fails the test")]

use super::super::certified::{
    CertifiedContact, MarginBand, Workspace, certified_approach, certified_contacts,
};
use super::super::contact::{
    ClosestSearch, SolvedSpan, closest_approach, contacts, contacts_of, join, solve,
};
use super::super::profile::DistanceProfile;
use super::sections::Rotations;
use super::{BodyView, ClusterPair, KeptQuestion, SpherePair};
use crate::accuracy::{Accuracy, TimeEnclosure};
use crate::hitbox::{Hitbox, Sphere};
use crate::knots::Knots;
use crate::narrow_phase::{Approach, Contact, widened};
use crate::orientation::Orientation;
use crate::rounding::exact::vector;
use crate::shape::BodyShape;
use crate::spans::{Span, spans};
use crate::trajectory::{Pieces, State, Trajectory};
use glam::{DQuat, DVec3};
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};

mod fixed;

/// A body of a case.
struct Mover {
    plan: Pieces,
    hitbox: Hitbox,
    orientation: Orientation,
    model_error: f64,
}

/// Two bodies and the time in question.
struct Case {
    bodies: [Mover; 2],
    margin: f64,
    window: (f64, f64),
    /// Common domain of both bodies, s.
    start: f64,
    end: f64,
}

/// Returns the first instant of the plans of a kind, s: some are late, where instants are rounded.
fn first_instant(kind: usize) -> f64 {
    [0.0, 0.0, 1e9][kind / 4 % 3]
}

fn turner(rng: &mut ChaCha8Rng, kind: usize, first: f64) -> Mover {
    let size = [1.0, 1e-6, 1e6][kind % 3];
    let speed = [0.5, 4.0][kind / 3 % 2] * size;
    let states = [0.0, 0.4, 1.0]
        .map(|time| State::new(first + time, vector(rng, 2.0 * size), vector(rng, speed)));
    let count = rng.random_range(if kind % 8 == 7 { 9..20 } else { 1..9 });
    let spheres = (0..count).map(|number| {
        // Some alike, some small, some points.
        let radius = [0.3, 0.3, rng.random_range(0.0..0.5), 0.0][number % 4] * size;
        let offset = vector(rng, size);
        Sphere { offset, radius }
    });
    let hitbox = Hitbox::cluster(spheres.collect()).unwrap();
    let spin = vector(rng, [1.0, 20.0][kind / 6 % 2]);
    let orientation = if kind.is_multiple_of(5) {
        Orientation::FIXED
    } else {
        let rotation = DQuat::from_scaled_axis(vector(rng, 3.0));
        Orientation::spin(first + rng.random_range(-1.0..1.0), rotation, spin).unwrap()
    };
    Mover {
        plan: Pieces::own(&Trajectory::from_states(&states).unwrap()),
        hitbox,
        orientation,
        model_error: [0.0, 0.0, 0.3][kind / 2 % 3] * size,
    }
}

/// A body at rest whose spheres are all at one place, but for rounding: their bounds leave nothing to
/// spare. Or a half-space at rest. Some are far apart, of some the middles meet.
fn hub(rng: &mut ChaCha8Rng, kind: usize, is_plane: bool, first: f64) -> Mover {
    let size = [1.0, 1e-6, 1e6][kind % 3];
    // Distances are constant in all parts, or in none: which of both wins a tie depends on what else does.
    let arm = [1e-16, 1e-9][kind / 3 % 2] * size;
    let far = [2.0, 2e12, 0.0][kind / 6 % 3] * size;
    let place = vector(rng, far);
    // Where the middles meet, arms are long, and hardly turn.
    let (base, slow) = if far > 0.0 {
        (DVec3::ZERO, 1.0)
    } else {
        (vector(rng, size), 1e-9)
    };
    let states = [0.0, 0.4, 1.0].map(|time| State::new(first + time, place, DVec3::ZERO));
    let radius = size * rng.random_range(0.1..1.0);
    let spheres = (0..rng.random_range(1..9)).map(|number: u32| Sphere {
        offset: base + vector(rng, arm),
        radius: [radius, radius.next_up(), radius.next_down()][number as usize % 3],
    });
    let spheres = spheres.collect();
    let spin = vector(rng, slow * [1.0, 60.0][kind / 2 % 2]);
    let rotation = DQuat::from_scaled_axis(vector(rng, 3.0));
    let (hitbox, orientation) = if is_plane {
        let normal = vector(rng, 1.0).normalize();
        (Hitbox::half_space(normal), Orientation::FIXED)
    } else {
        let spin = Orientation::spin(first + rng.random_range(-1.0..1.0), rotation, spin);
        (Hitbox::cluster(spheres), spin.unwrap())
    };
    Mover {
        plan: Pieces::own(&Trajectory::from_states(&states).unwrap()),
        hitbox: hitbox.unwrap(),
        orientation,
        model_error: 0.0,
    }
}

impl Mover {
    fn view(&self) -> BodyView<'_> {
        let Pieces { knots, segments } = &self.plan;
        let shape = BodyShape::new(&self.hitbox, self.orientation.turning(), self.model_error);
        BodyView::of((Knots::of(knots), segments), shape)
    }
}

impl Case {
    fn views(&self) -> [BodyView<'_>; 2] {
        self.bodies.each_ref().map(Mover::view)
    }

    fn band(&self) -> MarginBand {
        let [a, b] = self.views();
        MarginBand::new(self.margin, a.model_error_with(&b))
    }

    fn spans(&self) -> Vec<Span> {
        let [a, b] = self.views();
        spans(&a.knots, &b.knots, self.start, self.end).collect()
    }

    /// Calls `visit` with all pairs of spheres in all parts of a span.
    fn each_in(&self, span: Span, accuracy: Accuracy, mut visit: impl FnMut(&SpherePair, Span)) {
        let [a, b] = &self.views();
        let pair = ClusterPair::of(a, b, span, accuracy);
        if let Some(over_plane) = pair.over_plane() {
            return over_plane.each_sphere(&mut visit);
        }
        for section in pair.sections((span.start, span.end)) {
            let mut rotations = Rotations::default();
            let part = pair.part(&section, f64::INFINITY, &mut rotations);
            let part = part.unwrap();
            for number_a in (0_u32..).take(a.spheres.len()) {
                for number_b in (0_u32..).take(b.spheres.len()) {
                    visit(&part.pair((number_a, number_b)), section.span);
                }
            }
        }
    }

    /// Calls `visit` with all pairs of spheres in all parts of all spans.
    fn each(&self, accuracy: Accuracy, mut visit: impl FnMut(&SpherePair, Span)) {
        for span in self.spans() {
            self.each_in(span, accuracy, &mut visit);
        }
    }

    fn contacts(&self, window: (f64, f64)) -> Vec<Contact> {
        let [a, b] = &self.views();
        let (spans, mut found) = (self.spans().into_iter(), Vec::new());
        contacts(a, b, spans, self.margin, window, &mut found);
        found
    }

    /// Returns the contacts of all pairs, solved one by one.
    fn contacts_of_all(&self, margin: f64, window: (f64, f64)) -> Vec<Contact> {
        let mut found = Vec::new();
        self.each(Accuracy::Exact, |pair, span| {
            let profile = DistanceProfile::of(&pair.cubic);
            pair.contacts(&profile, span, margin, window, &mut found);
        });
        join(&mut found, 0);
        found
    }

    /// Returns what is kept of all spans.
    fn kept(&self, margins: &[f64], cuts: Option<&[f64]>) -> Vec<SolvedSpan> {
        let [a, b] = &self.views();
        let whole = ((f64::MIN, f64::MAX), f64::NEG_INFINITY);
        let mut kept = Vec::new();
        for span in self.spans() {
            let asked = KeptQuestion { margins, cuts };
            solve(a, b, span, &asked, whole, |_, one| kept.push(one));
        }
        kept
    }

    /// Compares contacts at its margin and at a larger one (m) in what is kept for these alone with those of all pairs of
    /// spheres, and at instants where windows cut; returns how many there were.
    fn check_whole_contacts(
        &self,
        larger: f64,
        windows: impl Iterator<Item = (f64, f64)>,
    ) -> usize {
        let [a, b] = &self.views();
        let margins = [self.margin, larger];
        let mut count = 0;
        let all = (f64::MIN, f64::MAX);
        // Also at knots: there nothing else is solved than for whole contacts, and the nearest pairs.
        let at_knot = |span: Span| [(all.0, span.end), (span.end, span.end), (span.start, all.1)];
        let windows = windows.chain(self.spans().into_iter().flat_map(at_knot));
        for (window, is_whole) in windows.map(|cut| (cut, false)).chain([(all, true)]) {
            let cuts: &[f64] = if is_whole { &[] } else { &[window.0, window.1] };
            let kept = self.kept(&margins, Some(cuts));
            for margin in margins.map(|margin| widened(margin, a.model_error_with(b))) {
                let found = kept_contacts(&kept, margin, window);
                let expected = self.contacts_of_all(margin, window);
                assert_eq!(found, expected, "{margin} {window:?} {is_whole}");
                count += found.len();
            }
        }
        count
    }

    fn nearest(&self, window: (f64, f64)) -> Option<Approach> {
        let [a, b] = &self.views();
        closest_approach(a, b, self.spans().into_iter(), window)
    }

    /// Returns the closest approach of all pairs, solved one by one.
    fn nearest_of_all(&self, window: (f64, f64)) -> Option<Approach> {
        let mut nearest = ClosestSearch::new();
        for span in self.spans() {
            self.each_in(span, Accuracy::Exact, |pair, part| {
                if part.start <= window.1 && window.0 <= part.end {
                    nearest.push(pair, part, window);
                }
            });
            nearest.end_span();
        }
        nearest.closest
    }

    fn proofs(&self, window: (f64, f64), workspace: &mut Workspace) -> Vec<CertifiedContact> {
        let [a, b] = &self.views();
        let (spans, mut found) = (self.spans().into_iter(), Vec::new());
        certified_contacts(a, b, spans, self.margin, window, workspace, &mut found);
        found
    }

    /// Returns the proofs of all pairs, solved one by one.
    fn proofs_of_all(&self, window: (f64, f64), all: &mut Workspace) -> Vec<CertifiedContact> {
        let ([a, b], band) = (&self.views(), self.band());
        all.clear();
        self.each(Accuracy::Certified, |pair, span| {
            all.solve(pair, span, &band, window);
        });
        let mut found = Vec::new();
        all.join((a, b), &band, window, &mut found);
        found
    }
}

/// Returns the contacts within a margin in what is kept of spans.
fn kept_contacts(kept: &[SolvedSpan], margin: f64, window: (f64, f64)) -> Vec<Contact> {
    let mut found = Vec::new();
    contacts_of(kept.iter(), margin, window, &mut found);
    found
}

/// Returns the instants between which bodies are proven to be in contact, or may be, and which of both.
fn ends_of(proven: &[CertifiedContact]) -> Vec<(bool, TimeEnclosure, TimeEnclosure)> {
    let ends = proven.iter().map(|one| {
        let proof = one.certificate;
        (proof.resolved, proof.enter, proof.exit)
    });
    ends.collect()
}

#[test]
fn omitted_pairs_change_nothing() {
    let mut rng = ChaCha8Rng::seed_from_u64(9);
    let rng = &mut rng;
    let (mut touching, mut certain, mut whole) = (0, 0, 0);
    let mut workspace = Workspace::default();
    for kind in 0..720 {
        let (turns, other) = (kind / 3, kind / 3 - kind / 3 % 5 + 1);
        let begin = first_instant(turns);
        let bodies = match kind % 3 {
            0 => [turner(rng, turns, begin), turner(rng, other, begin)],
            1 => [
                hub(rng, turns, false, begin),
                hub(rng, turns, turns % 2 == 1, begin),
            ],
            _ => [
                turner(rng, 5 * turns + 1, begin),
                hub(rng, 5 * turns + 1, true, begin),
            ],
        };
        let kind = turns;
        let cut = [0.0..0.5, 0.5..1.0].map(|range| begin + rng.random_range(range));
        let window = [(f64::MIN, f64::MAX), (cut[0], cut[1])][kind % 2];
        let mut case = Case {
            bodies,
            margin: 0.0,
            window,
            start: begin,
            end: begin + 1.0,
        };
        let found = case.nearest(window);
        assert_eq!(found, case.nearest_of_all(window), "{kind}");

        let least = found.unwrap().separation;
        let size = [1.0, 1e-6, 1e6][kind % 3];
        // At the least separation, farther, and nearer by less than is told apart there.
        let far = case.views().map(|view| view.segments[0].origin().length());
        let more = [
            0.0,
            rng.random_range(0.0..1.0) * size,
            -1e-15 * (far[0] + far[1]),
        ];
        case.margin = least + more[kind % 5 % 3];
        let [a, b] = &case.views();
        let outer = case.band().outer;
        // Windows that begin or end with a contact, or where a rotation's cubic does.
        let found = case.contacts(window);
        let ends = found.iter().flat_map(|one| [one.enter, one.exit]);
        let cut = a
            .turning
            .map(|turning| turning.section_at(begin + 0.5, Accuracy::Exact).end);
        let instants: Vec<f64> = ends.take(4).chain(cut).collect();
        let windows = |&at: &f64| [(window.0, at), (at, at), (at, window.1)];
        for window in instants.iter().flat_map(windows).chain([window]) {
            let expected = case.contacts_of_all(outer, window);
            assert_eq!(case.contacts(window), expected, "{kind} {window:?}");
        }
        touching += found.len();

        // As a monitor solves it, in two steps. The first one may end shortly before a contact, in the part of
        // the span that has it.
        let expected = case.contacts_of_all(outer, window);
        let middle = 0.5 * (window.0 + window.1);
        let enters = expected.iter().map(|one| one.enter);
        let steps = enters
            .take(4)
            .flat_map(|enter| [enter.next_down(), enter - 1e-3 * (window.1 - window.0)]);
        let mut kept = Vec::new();
        for (step, margin) in [(middle, case.margin + size)]
            .into_iter()
            .chain(steps.map(|step| (step, case.margin)))
        {
            kept.clear();
            for span in case.spans() {
                let step = step.max(span.start).min(span.end);
                let first = ((span.start, step), f64::NEG_INFINITY);
                let asked = KeptQuestion {
                    margins: &[margin],
                    cuts: None,
                };
                let after = solve(a, b, span, &asked, first, |_, solved| kept.push(solved));
                let rest = ((step, span.end), after);
                solve(a, b, span, &asked, rest, |_, solved| kept.push(solved));
            }
            let found = kept_contacts(&kept, outer, window);
            assert_eq!(found, expected, "{kind}, {step}");
        }

        let windows = instants.iter().flat_map(windows).chain([window]);
        whole += case.check_whole_contacts(case.margin + size, windows);

        let proven = case.proofs(window, &mut workspace);
        let expected = case.proofs_of_all(window, &mut workspace);
        assert_eq!(ends_of(&proven), ends_of(&expected), "{kind}");
        certain += proven.iter().filter(|one| one.certificate.resolved).count();
    }
    assert!(
        touching > 200 && certain > 100 && whole > 1_000,
        "{touching} {certain} {whole}"
    );
}

/// Tops at rest: their spheres are on the axis, and stay where they are. So bounds leave nothing to spare
/// but the errors of the cubics, which differ: a sphere with a long arm may be nearer than another one,
/// or farther, by its error.
#[test]
fn errors_of_the_cubics_are_not_dropped() {
    let mut rng = ChaCha8Rng::seed_from_u64(10);
    let rng = &mut rng;
    let mut workspace = Workspace::default();
    for round in 0..80 {
        let size = [1.0, 1e-6, 1e6][round % 3];
        let axis = vector(rng, 1.0).normalize();
        // Arms, distances behind the nearest one, and the margin from there.
        let (arms, more) = [([0.1, 1.0, 0.9], -0.2e-6), ([1.0, 0.1, 0.2], 0.75e-6)][round / 3 % 2];
        let spheres = arms
            .iter()
            .zip([0.0, 0.5e-6, 0.4e-6])
            .map(|(arm, behind)| Sphere {
                offset: axis * (arm * size),
                radius: (2.0 - arm - behind) * size,
            });
        let orientation = Orientation::spin(0.0, DQuat::IDENTITY, axis * 6.0).unwrap();
        let at = |place: DVec3, hitbox: Result<Hitbox, _>, orientation| {
            let states = [0.0, 1.0].map(|time| State::new(time, place, DVec3::ZERO));
            Mover {
                plan: Pieces::own(&Trajectory::from_states(&states).unwrap()),
                hitbox: hitbox.unwrap(),
                orientation,
                model_error: 0.0,
            }
        };
        let top = at(DVec3::ZERO, Hitbox::cluster(spheres.collect()), orientation);
        let (place, other, radius) = if round % 4 < 2 {
            (5.0, Hitbox::half_space(-axis), 0.0)
        } else {
            (6.0, Hitbox::sphere(size), 1.0)
        };
        let other = at(axis * (place * size), other, Orientation::FIXED);
        let [near, margin] = [0.0, more].map(|more| (place - radius - 2.0 + more) * size);
        let mut case = Case {
            bodies: [top, other],
            margin,
            window: (0.1, 0.9),
            start: 0.0,
            end: 1.0,
        };
        if round % 8 >= 4 {
            case.bodies.reverse();
        }
        let proven = case.proofs(case.window, &mut workspace);
        let expected = case.proofs_of_all(case.window, &mut workspace);
        assert_eq!(ends_of(&proven), ends_of(&expected), "{round}");
        assert_eq!(proven.len(), 1, "{round}");
        assert_eq!(proven[0].certificate.resolved, more > 0.0, "{round}");
        let [a, b] = &case.views();
        let (found, error, _) =
            certified_approach(a, b, case.spans().into_iter(), case.window).unwrap();
        // What may be nearer by its error is part of the enclosure.
        assert!(
            found.separation - error < near - 0.3e-6 * size,
            "{round} {error}"
        );
    }
}
