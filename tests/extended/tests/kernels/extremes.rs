//! Pairs at the ends of the range and beyond it.

use super::exact::Exact;
use super::{
    ControlPoints, CubicBatch, Enclosure, InstructionSet, Verdict, enclose, enclosures, scalar,
    within,
};

#[test]
fn extremes_have_answers() {
    let [mut still, mut zero] = [[[3.0, 4.0, 0.0]; 4], [[0.0; 3]; 4]];
    assert_eq!(scalar::closest_approach(&still).1, 5.0);
    assert_eq!(scalar::closest_approach(&zero).1, 0.0);
    assert_eq!(scalar::within(&still, 5.0, 4.999), Verdict::Outside);
    assert_eq!(scalar::within(&still, 5.001, 5.0), Verdict::Inside);
    assert_eq!(scalar::within(&zero, 0.0, 0.0), Verdict::Undecided);
    // Through zero in the middle, and a threshold of zero.
    let crossing = [
        [-3.0, 0.0, 0.0],
        [-1.0, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [3.0, 0.0, 0.0],
    ];
    assert_eq!(scalar::closest_approach(&crossing), (0.5, 0.0));
    assert_eq!(scalar::within(&crossing, 1e-9, 1e-9), Verdict::Inside);
    assert_eq!(scalar::within(&crossing, -1.0, 0.0), Verdict::Undecided);
    for exponent in [-1070, -1000, -500, -300, -60, 60, 300, 500, 1000] {
        let factor = 2.0_f64.powi(exponent);
        still = still.map(|_| [3.0 * factor, 4.0 * factor, 0.0]);
        zero = crossing.map(|point| point.map(|x| x * factor));
        assert_eq!(
            scalar::closest_approach(&still).1,
            5.0 * factor,
            "2^{exponent}"
        );
        assert!(
            scalar::closest_approach(&zero).1 <= factor * 1e-15,
            "2^{exponent}"
        );
        for pair in [still, zero] {
            let exact = Exact::new(&pair);
            let found = scalar::enclose(&pair, 0.0);
            assert!(!exact.is_certainly_below(found.low) && !exact.is_certainly_above(found.high));
            let all = enclosures(InstructionSet::best(), &[pair], &[0.0]);
            assert!(
                !exact.is_certainly_below(all[0].low) && !exact.is_certainly_above(all[0].high)
            );
            let limit = 2.0 * factor;
            let inside = scalar::within(&pair, limit, limit);
            let expected = if pair == still {
                Verdict::Outside
            } else {
                Verdict::Inside
            };
            // In the subnormal range a sound answer may be that nothing is certain.
            assert!(inside == expected || (exponent < -900 && inside == Verdict::Undecided));
        }
    }
    // Squares that overflow in f32.
    let far: ControlPoints<f32> = [[-3e25, 1e25, 0.0], [-1e25; 3], [1e25; 3], [3e25, 0.0, 1e25]];
    let (time, distance) = scalar::closest_approach(&far);
    assert!((0.0..=1.0).contains(&time) && distance < 3e25);
    assert_eq!(scalar::within(&far, 1e20, 1e20), Verdict::Outside);
}

#[test]
fn slices_of_different_lengths_are_refused() {
    use nearmiss::kernels::Lanes;

    let (long, short) = ([0.0; 3], [0.0; 2]);
    assert!(Lanes::new([[&long[..]; 4]; 3]).is_some());
    let mut slices = [[&long[..]; 4]; 3];
    slices[2][3] = &short;
    assert!(Lanes::new(slices).is_none());
}

/// Nothing is certain about what is no number, alone or among others that are.
#[test]
fn nothing_is_claimed_of_what_is_not_finite() {
    let plain = [[1.0_f64, 2.0, 3.0]; 4];
    let bad = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY];
    let mut cubics = vec![plain; 100];
    for (number, cubic) in (0..).zip(&mut cubics) {
        if number % 3 > 0 {
            cubic[(number / 3) % 4][number % 4 % 3] = bad[number % 5 % 3];
        }
    }
    let is_plain = |number: usize| number.is_multiple_of(3);
    let mut batch = CubicBatch::new();
    cubics.iter().for_each(|cubic| batch.push(*cubic));
    let (errors, unbounded) = (
        vec![0.0; 100],
        Enclosure {
            low: 0.0,
            high: f64::INFINITY,
            time: 0.0,
        },
    );
    for instructions in InstructionSet::available() {
        let mut enclosures = vec![unbounded; 100];
        enclose(instructions, &batch.lanes(), &errors, &mut enclosures);
        for (number, found) in enclosures.iter().enumerate() {
            let holds = (found.low, found.high) == (0.0, f64::INFINITY);
            assert!(holds != is_plain(number), "{found:?}");
            assert!(scalar::enclose(&cubics[number], 0.0).low == 0.0 || is_plain(number));
        }
        for (threshold, expected) in [(0.5, Verdict::Outside), (1e3, Verdict::Inside)] {
            let thresholds = vec![threshold; 100];
            let mut verdicts = vec![Verdict::Undecided; 100];
            within(
                instructions,
                &batch.lanes(),
                &thresholds,
                &thresholds,
                &mut verdicts,
            );
            for (number, found) in verdicts.into_iter().enumerate() {
                let expected = if is_plain(number) {
                    expected
                } else {
                    Verdict::Undecided
                };
                assert_eq!(found, expected, "{number}");
                assert_eq!(
                    scalar::within(&cubics[number], threshold, threshold),
                    expected
                );
            }
        }
        // Errors that bound nothing.
        for error in [-1.0, -1e308, f64::NAN, f64::INFINITY] {
            enclose(instructions, &batch.lanes(), &[error; 100], &mut enclosures);
            assert!(
                enclosures
                    .iter()
                    .all(|found| found.low <= 0.0 && found.high >= f64::INFINITY)
            );
            assert_eq!(scalar::enclose(&plain, error).high, f64::INFINITY);
        }
    }
}
