//! Segments gathered into batches: verdicts against the motion of the segments themselves.

use nearmiss::glam::DVec3;
use nearmiss::kernels::{InstructionSet, SpanBatch, Verdict, scalar};
use nearmiss::{Segment, State, TimeBase, Trajectory};
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};

/// A body near `place` over 100..103 s, with knots at 101 and 102.5.
fn body(random: &mut ChaCha8Rng, place: DVec3) -> Trajectory {
    let mut vector = || DVec3::from_array([0; 3].map(|_| random.random_range(-5.0..5.0)));
    let states =
        [100.0, 101.0, 102.5, 103.0].map(|time| State::new(time, place + vector(), vector()));
    Trajectory::from_states(&states).unwrap()
}

/// The distances at many instants of the span, from the exact solver's own evaluation.
fn sampled(a: &Segment, b: &Segment, (start, end): (f64, f64), offset: DVec3) -> f64 {
    (0..=400)
        .map(|i| start + (end - start) * f64::from(i) / 400.0)
        .map(|time| ((a.motion_at(time).0 - b.motion_at(time).0) + offset).length())
        .fold(f64::INFINITY, f64::min)
}

#[test]
fn verdicts_on_segments_hold_for_their_motion() {
    let mut random = ChaCha8Rng::seed_from_u64(31);
    let (mut batch, mut batch_f32) = (SpanBatch::<f64>::new(), SpanBatch::<f32>::new());
    let mut cases = Vec::new();
    for i in 0..3_000 {
        // As far from the origin as it takes to spoil a difference of rounded positions.
        let place = DVec3::splat([0.0, 1e3, 1e6, 1e8][i % 4]);
        let (a, b) = (body(&mut random, place), body(&mut random, place));
        let (a, b) = (a.segments()[1], b.segments()[1]);
        // The whole segment, or a part of it.
        let span = [(101.0, 102.5), (101.3, 102.1)][i / 4 % 2];
        let offset = DVec3::new(0.0, random.random_range(-1.0..1.0), 0.0);
        let threshold = sampled(&a, &b, span, offset) * random.random_range(0.5..1.5);
        batch.push(&a, &b, span, offset, threshold);
        batch_f32.push(&a, &b, span, offset, threshold);
        cases.push((a, b, span, offset, threshold));
    }
    let mut verdicts = vec![Verdict::Undecided; batch.len()];
    let mut verdicts_f32 = verdicts.clone();
    batch.verdicts(InstructionSet::best(), &mut verdicts);
    batch_f32.verdicts(InstructionSet::best(), &mut verdicts_f32);
    let mut decided = [0, 0];
    for (i, (a, b, span, offset, threshold)) in cases.iter().enumerate() {
        let samples = sampled(a, b, *span, *offset);
        // Positions at 1e8 m are rounded to 1.5e-8 m when they are evaluated.
        let rounding = 1e-7;
        let (_, nearest) = scalar::closest_approach(&batch.lanes().control_points(i));
        for (verdict, decided) in [verdicts[i], verdicts_f32[i]].into_iter().zip(&mut decided) {
            match verdict {
                Verdict::Outside => assert!(samples >= threshold - rounding, "{i}"),
                Verdict::Inside => assert!(nearest <= *threshold, "{i}"),
                Verdict::Undecided => continue,
            }
            *decided += 1;
        }
        if verdicts_f32[i] != Verdict::Undecided {
            assert_eq!(verdicts[i], verdicts_f32[i], "{i}");
        }
    }
    // A threshold within 1e-5 of the distance is rare: one in 1e5.
    assert!(
        decided[0] == cases.len() && decided[1] + 3 >= cases.len(),
        "{decided:?}"
    );
    batch.clear();
    assert!(batch.is_empty() && batch.lanes().is_empty());
}

#[test]
fn what_rounds_is_never_decided() {
    let mut random = ChaCha8Rng::seed_from_u64(32);
    let line = |x: f64, y: f64| {
        let states = [0.0, 1.0].map(|t| State::new(t, DVec3::new(x + t, y, 0.0), DVec3::X));
        Trajectory::from_states(&states).unwrap()
    };
    // Parallel flight: the distance is the threshold, at any place.
    for _ in 0..200 {
        let (place, y) = (
            random.random_range(-1e6..1e6),
            random.random_range(0.1..10.0),
        );
        let (a, b) = (line(place, 0.0), line(place, y));
        let mut batch = SpanBatch::<f32>::new();
        let ends = [-1.0, y, y + 1e-3, y - 1e-3];
        for threshold in ends {
            batch.push(
                &a.segments()[0],
                &b.segments()[0],
                (0.0, 1.0),
                DVec3::ZERO,
                threshold,
            );
        }
        let mut verdicts = [Verdict::Inside; 4];
        batch.verdicts(InstructionSet::best(), &mut verdicts);
        let expected = [
            Verdict::Outside,
            Verdict::Undecided,
            Verdict::Inside,
            Verdict::Outside,
        ];
        assert_eq!(verdicts, expected, "{place} {y}");
    }
}

/// Far from the origin in absolute time a place is known to a rounding of its coordinates, and the
/// relative cubic, which is small, does not show that.
#[test]
fn what_is_badly_known_is_never_decided() {
    let rest = |x: f64| {
        let places = [DVec3::ZERO, DVec3::ZERO, DVec3::ZERO, DVec3::X * x];
        Trajectory::from_coefficients(&[0.0, 1.0], &[places], TimeBase::Absolute).unwrap()
    };
    let (a, b) = (rest(1e9), rest(1e9 + 1.0));
    let (a, b) = (&a.segments()[0], &b.segments()[0]);
    let mut batch = SpanBatch::<f64>::new();
    // Both together are known to 2e-7 m.
    let thresholds = [1.0 - 1e-6, 1.0 - 1e-7, 1.0 + 1e-7, 1.0 + 1e-6];
    for threshold in thresholds {
        batch.push(a, b, (0.0, 1.0), DVec3::ZERO, threshold);
    }
    let mut verdicts = [Verdict::Inside; 4];
    batch.verdicts(InstructionSet::best(), &mut verdicts);
    let [outside, one, other, inside] = verdicts;
    assert_eq!((one, other), (Verdict::Undecided, Verdict::Undecided));
    assert_eq!((outside, inside), (Verdict::Outside, Verdict::Inside));
}
