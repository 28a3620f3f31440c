//! Sharp minima have narrow enclosures in time, wherever they are.

use crate::case::{Case, least_violation};
use crate::oracle_support::Polygon;
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};

fn at(points: &Polygon, s: f64) -> [f64; 3] {
    let t = 1.0 - s;
    let weights = [t * t * t, 3.0 * t * t * s, 3.0 * t * s * s, s * s * s];
    std::array::from_fn(|axis| (0..4).map(|j| weights[j] * points[j][axis]).sum())
}

fn distance(points: &Polygon, s: f64) -> f64 {
    at(points, s).iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// The local minima, from samples and thirds of the intervals next to them: parameter and distance.
fn local_minima(points: &Polygon) -> Vec<(f64, f64)> {
    const SAMPLES: u32 = 1_000;
    let place = |i: u32| f64::from(i) / f64::from(SAMPLES);
    let values: Vec<f64> = (0..=SAMPLES).map(|i| distance(points, place(i))).collect();
    let mut found = Vec::new();
    for i in 0..=SAMPLES {
        let (before, after) = (i.saturating_sub(1), (i + 1).min(SAMPLES));
        let value = values[i as usize];
        if values[before as usize] < value || values[after as usize] < value {
            continue;
        }
        let (mut low, mut high) = (place(before), place(after));
        while high - low > 1e-12 {
            let third = (high - low) / 3.0;
            if distance(points, low + third) < distance(points, high - third) {
                high -= third;
            } else {
                low += third;
            }
        }
        let s = 0.5 * (low + high);
        found.push((s, distance(points, s)));
    }
    found
}

/// True if the distance is more than a millionth above the least one wherever it is farther than
/// 0.002 from that in time.
fn is_sharp(points: &Polygon) -> bool {
    let minima = local_minima(points);
    let (best, least) = minima
        .iter()
        .copied()
        .min_by(|x, y| x.1.total_cmp(&y.1))
        .unwrap();
    let beside = [best - 0.002, best + 0.002].into_iter();
    let beside = beside.filter(|s| (0.0..=1.0).contains(s));
    minima
        .iter()
        .copied()
        .filter(|(s, _)| (s - best).abs() > 0.002)
        .chain(beside.map(|s| (s, distance(points, s))))
        .all(|(_, distance)| distance > least + 1e-6)
}

/// A random cubic seen from a place on it, from beside it, and along a line.
fn motion(random: &mut ChaCha8Rng, kind: usize) -> Polygon {
    let points: Polygon = [(); 4].map(|()| [(); 3].map(|()| random.random_range(-1.0..1.0)));
    let s = random.random_range(0.0..1.0);
    let [origin, kept] = match kind {
        0 => [points[0], [1.0; 3]],
        1 => [points[3], [1.0; 3]],
        2 => [at(&points, s), [1.0; 3]],
        3 => [[0.0; 3], [1.0; 3]],
        4 => [points[0].map(|x| 0.9 * x), [1.0; 3]],
        5 => [at(&points, s), [1.0, 1.0, 0.1]],
        6 => [points[0], [1.0, 0.0, 0.0]],
        _ => [at(&points, s), [1.0, 0.0, 0.0]],
    };
    points.map(|point| std::array::from_fn(|axis| (point[axis] - origin[axis]) * kept[axis]))
}

/// The minimum is at the start, at the end or between. Before wide enclosures were trimmed, three
/// in ten of the first two kinds were wide, and as many of kind 5.
#[test]
fn sharp_minima_have_narrow_enclosures() {
    let mut random = ChaCha8Rng::seed_from_u64(11);
    let (mut sharp, mut places) = ([0; 3], [0; 3]);
    for number in 0..8_000 {
        let points = motion(&mut random, number % 8);
        let case = Case::new(points, 0.0, [[0.0; 3]; 4]);
        let claim = case.cubic.least_distance();
        let wrong = least_violation(&case, &claim, number / 8 % 20 == 0);
        assert!(wrong.is_none(), "{wrong:?} {claim:?} {points:?}");
        let place = usize::from(claim.guess > 0.0) + usize::from(claim.guess >= 1.0);
        places[place] += 1;
        if is_sharp(&points) {
            sharp[place] += 1;
            let width = claim.parameter.last - claim.parameter.first;
            assert!(width < 1e-3, "kind {}: {claim:?} {points:?}", number % 8);
        }
    }
    assert!(
        sharp.iter().all(|&count| count > 500),
        "{sharp:?} of {places:?}"
    );
}
