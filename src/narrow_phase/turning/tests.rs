//! Omitted pairs of spheres change no result: against all of them, solved one by one.

#![allow(clippy::unwrap_used, reason = "a failure fails the test")]

use super::super::certified::{MarginBand, Workspace, certified_contacts};
use super::super::contact::{ClosestSearch, closest_approach, contacts, contacts_of, join, solve};
use super::super::stretches::DistanceProfile;
use super::cells::Rotations;
use super::{BodyView, SpherePair, TurningPair};
use crate::accuracy::Accuracy;
use crate::hitbox::{Hitbox, Sphere};
use crate::knots::Knots;
use crate::orientation::Orientation;
use crate::shape::BodyShape;
use crate::spans::{Span, spans};
use crate::trajectory::{State, Trajectory};
use glam::{DQuat, DVec3};
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};

/// A body with its plan.
struct Turner {
    plan: Trajectory,
    hitbox: Hitbox,
    orientation: Orientation,
    model_error: f64,
}

fn vector(rng: &mut ChaCha8Rng, half: f64) -> DVec3 {
    DVec3::from_array([0; 3].map(|_| rng.random_range(-half..=half)))
}

fn turner(rng: &mut ChaCha8Rng, kind: usize) -> Turner {
    let size = [1.0, 1e-6, 1e6][kind % 3];
    let speed = [0.5, 4.0][kind / 3 % 2] * size;
    let states =
        [0.0, 0.4, 1.0].map(|time| State::new(time, vector(rng, 2.0 * size), vector(rng, speed)));
    let count = rng.random_range(1..9);
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
        Orientation::spin(rng.random_range(-1.0..1.0), rotation, spin).unwrap()
    };
    Turner {
        plan: Trajectory::from_states(&states).unwrap(),
        hitbox,
        orientation,
        model_error: [0.0, 0.0, 0.3][kind / 2 % 3] * size,
    }
}

impl Turner {
    fn view(&self) -> BodyView<'_> {
        let shape = BodyShape::new(&self.hitbox, self.orientation.turning(), self.model_error);
        BodyView::of((Knots::of(self.plan.knots()), self.plan.segments()), shape)
    }
}

/// Calls `visit` with all pairs of spheres in all parts of all spans.
fn each(
    [a, b]: &[BodyView<'_>; 2],
    all: &[Span],
    accuracy: Accuracy,
    mut visit: impl FnMut(&SpherePair, Span),
) {
    for &span in all {
        let Some(pair) = TurningPair::of(a, b, span, accuracy) else {
            continue;
        };
        for cell in pair.cells((span.start, span.end)) {
            let part = pair.part(&cell, f64::INFINITY, &mut Rotations::default());
            let part = part.unwrap();
            for number_a in (0_u32..).take(a.spheres.len()) {
                for number_b in (0_u32..).take(b.spheres.len()) {
                    visit(&part.pair((number_a, number_b)), cell.span);
                }
            }
        }
    }
}

#[test]
fn omitted_pairs_change_nothing() {
    let mut rng = ChaCha8Rng::seed_from_u64(9);
    let rng = &mut rng;
    let (mut touching, mut certain) = (0, 0);
    let mut workspace = Workspace::default();
    for kind in 0..240 {
        let bodies = [turner(rng, kind), turner(rng, kind - kind % 5 + 1)];
        let views = [bodies[0].view(), bodies[1].view()];
        let [a, b] = &views;
        let all: Vec<Span> = spans(&a.knots, &b.knots, 0.0, 1.0).collect();
        let whole = (f64::MIN, f64::MAX);
        let clip = [
            whole,
            (rng.random_range(0.0..0.5), rng.random_range(0.5..1.0)),
        ][kind % 2];

        let mut nearest = ClosestSearch::new();
        each(&views, &all, Accuracy::Exact, |pair, span| {
            if span.start <= clip.1 && clip.0 <= span.end {
                nearest.push(pair, span, clip);
            }
        });
        nearest.settle();
        let found = closest_approach(a, b, all.iter().copied(), clip);
        assert_eq!(found, nearest.closest, "{kind}");

        let least = found.unwrap().separation;
        let size = [1.0, 1e-6, 1e6][kind % 3];
        let margin = least + [0.0, rng.random_range(0.0..1.0) * size][kind / 2 % 2];
        let band = MarginBand::new(margin, a.model_error_with(b));
        let (mut found, mut expected) = (Vec::new(), Vec::new());
        contacts(a, b, all.iter().copied(), margin, clip, &mut found);
        each(&views, &all, Accuracy::Exact, |pair, span| {
            let profile = DistanceProfile::of(&pair.cubic);
            pair.contacts(&profile, span, band.outer, clip, &mut expected);
        });
        join(&mut expected, 0);
        assert_eq!(found, expected, "{kind}");
        touching += found.len();

        // As a monitor solves it, in two steps.
        let mut kept = Vec::new();
        for &span in &all {
            let middle = 0.5 * (span.start + span.end);
            let first = ((span.start, middle), f64::NEG_INFINITY);
            let after = solve(a, b, span, margin + size, first, |_, solved| {
                kept.push(solved)
            });
            let rest = ((middle, span.end), after);
            solve(a, b, span, margin + size, rest, |_, solved| {
                kept.push(solved)
            });
        }
        found.clear();
        contacts_of(kept.iter(), band.outer, clip, &mut found);
        assert_eq!(found, expected, "{kind}");

        let (mut proven, mut expected) = (Vec::new(), Vec::new());
        let over = all.iter().copied();
        certified_contacts(a, b, over, margin, clip, &mut workspace, &mut proven);
        workspace.clear();
        each(&views, &all, Accuracy::Certified, |pair, span| {
            workspace.solve(pair, span, &band, clip);
        });
        workspace.join((a, b), &band, clip, &mut expected);
        let ends = |one: &super::super::CertifiedContact| {
            let proof = one.certificate;
            (proof.resolved, proof.enter, proof.exit)
        };
        assert_eq!(
            proven.iter().map(ends).collect::<Vec<_>>(),
            expected.iter().map(ends).collect::<Vec<_>>(),
            "{kind}"
        );
        certain += proven.iter().filter(|one| one.certificate.resolved).count();
    }
    assert!(touching > 200 && certain > 100, "{touching} {certain}");
}
