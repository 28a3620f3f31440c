//! One pair of cubics: ways to find its closest approach, their time and their errors.

use crate::Effort;
use crate::peers;
use crate::table::{Cell, Table};
use crate::timing::in_turns;
use crate::workloads::Workload;
use nearmiss::kernels::{
    ControlPoints, CubicBatch, Enclosure, InstructionSet, Real, closest_approach, enclose, scalar,
};
use std::hint::black_box;
use std::rc::Rc;

/// Local time in which the roots of the literature are sought.
const TOLERANCE: f64 = 6e-7;
/// An error, as a share of the pair's size, from which on a minimum counts as a wrong one.
const WRONG: f64 = 1e-4;

/// A way to find the least distances of many pairs.
trait Method {
    fn run(&mut self);
    /// The distances found by the last run, m.
    fn distances(&self) -> Vec<f64>;
}

/// A method that takes one pair at a time, and returns its least distance.
struct Single<F> {
    pairs: Rc<[ControlPoints<f64>]>,
    solve: F,
    found: Vec<f64>,
}

impl<F: Fn(&ControlPoints<f64>) -> f64> Method for Single<F> {
    fn run(&mut self) {
        for (found, pair) in self.found.iter_mut().zip(black_box(&*self.pairs)) {
            *found = (self.solve)(pair);
        }
        black_box(&self.found);
    }

    fn distances(&self) -> Vec<f64> {
        self.found.clone()
    }
}

/// The batch kernel in one precision.
struct Batch<R> {
    cubics: CubicBatch<R>,
    times: Vec<R>,
    found: Vec<R>,
}

impl<R: Real + Default> Batch<R> {
    fn new(cubics: CubicBatch<R>, count: usize) -> Self {
        let zeros = vec![R::default(); count];
        Self {
            cubics,
            times: zeros.clone(),
            found: zeros,
        }
    }
}

impl<R: Real + Into<f64>> Method for Batch<R> {
    fn run(&mut self) {
        let lanes = black_box(&self.cubics).lanes();
        closest_approach(
            InstructionSet::best(),
            &lanes,
            &mut self.times,
            &mut self.found,
        );
        black_box(&self.found);
    }

    fn distances(&self) -> Vec<f64> {
        self.found.iter().map(|&found| found.into()).collect()
    }
}

/// Enclosures of the least distance of the cubics as they are given, without error.
struct Certified {
    cubics: CubicBatch<f64>,
    errors: Vec<f64>,
    found: Vec<Enclosure>,
}

impl Certified {
    fn new(pairs: &[ControlPoints<f64>]) -> Self {
        let nothing = Enclosure {
            low: 0.0,
            high: 0.0,
            time: 0.0,
        };
        Self {
            cubics: batch(pairs),
            errors: vec![0.0; pairs.len()],
            found: vec![nothing; pairs.len()],
        }
    }
}

impl Method for Certified {
    fn run(&mut self) {
        let lanes = black_box(&self.cubics).lanes();
        enclose(
            InstructionSet::best(),
            &lanes,
            &self.errors,
            &mut self.found,
        );
        black_box(&self.found);
    }

    fn distances(&self) -> Vec<f64> {
        self.found.iter().map(|found| found.high).collect()
    }
}

fn batch(pairs: &[ControlPoints<f64>]) -> CubicBatch<f64> {
    let mut cubics = CubicBatch::new();
    cubics.extend(pairs.iter().copied());
    cubics
}

#[allow(
    clippy::cast_possible_truncation,
    reason = "rounding to f32 is what is measured"
)]
fn batch_f32(pairs: &[ControlPoints<f64>]) -> CubicBatch<f32> {
    let mut cubics = CubicBatch::new();
    cubics.extend(
        pairs
            .iter()
            .map(|pair| pair.map(|point| point.map(|x| x as f32))),
    );
    cubics
}

/// The largest distance of a control point, m.
fn size(pair: &ControlPoints<f64>) -> f64 {
    pair.iter().map(|&point| norm(point)).fold(0.0, f64::max)
}

fn norm([x, y, z]: [f64; 3]) -> f64 {
    (x * x + y * y + z * z).sqrt()
}

fn at(pair: &ControlPoints<f64>, s: f64) -> [f64; 3] {
    let t = 1.0 - s;
    let weights = [t * t * t, 3.0 * s * t * t, 3.0 * s * s * t, s * s * s];
    std::array::from_fn(|axis| (0..4).map(|k| weights[k] * pair[k][axis]).sum())
}

/// The least of `steps + 1` equidistant samples.
fn sampled(pair: &ControlPoints<f64>, steps: u32) -> f64 {
    let share = 1.0 / f64::from(steps);
    let distances = (0..=steps).map(|step| norm(at(pair, f64::from(step) * share)));
    distances.fold(f64::INFINITY, f64::min)
}

/// Steps that the largest speed allows before the distance can fall below the least so far by a share of
/// the pair's size.
fn advanced(pair: &ControlPoints<f64>, share: f64) -> f64 {
    /// More are not waited for: of distances that hardly change.
    const MAX_STEPS: u32 = 100_000;
    let leg = |k: usize| {
        norm(std::array::from_fn(|axis| {
            pair[k + 1][axis] - pair[k][axis]
        }))
    };
    let speed = 3.0 * leg(0).max(leg(1)).max(leg(2));
    let tolerance = share * size(pair);
    let (mut s, mut least) = (0.0, norm(pair[0]));
    for _ in 0..MAX_STEPS {
        let distance = norm(at(pair, s));
        least = least.min(distance);
        s += (distance - least + tolerance) / speed;
        // No number where nothing moves.
        if s.is_nan() || s >= 1.0 {
            break;
        }
    }
    least.min(norm(pair[3]))
}

/// All methods on some pairs, by name; the first is the unit.
fn methods(pairs: &Rc<[ControlPoints<f64>]>) -> Vec<(String, Box<dyn Method>)> {
    fn single<F: Fn(&ControlPoints<f64>) -> f64 + 'static>(
        pairs: &Rc<[ControlPoints<f64>]>,
        solve: F,
    ) -> Box<dyn Method> {
        let found = vec![0.0; pairs.len()];
        Box::new(Single {
            pairs: Rc::clone(pairs),
            solve,
            found,
        })
    }
    let count = pairs.len();
    let polycool = single(pairs, |pair| peers::polycool(pair, TOLERANCE).1);
    let mut methods = vec![("polycool".to_owned(), polycool)];
    for steps in [8, 16, 32, 64, 128, 256, 512, 1024] {
        let name = format!("sampling, {steps} steps");
        methods.push((name, single(pairs, move |pair| sampled(pair, steps))));
    }
    let refined = single(pairs, |pair| peers::sampled(pair).1);
    methods.push(("sampling, 64 steps, refined".to_owned(), refined));
    for share in [1e-2, 1e-4] {
        let name = format!("conservative advancement, {share:.0e}");
        methods.push((name, single(pairs, move |pair| advanced(pair, share))));
    }
    methods.push((
        "companion matrix".to_owned(),
        single(pairs, |pair| peers::companion(pair).1),
    ));
    for tolerance in [6e-3, 6e-5, TOLERANCE, 0.0] {
        let name = format!("Yuksel, {tolerance:.0e}");
        let solve =
            move |pair: &ControlPoints<f64>| scalar::closest_approach_by_roots(pair, tolerance).1;
        methods.push((name, single(pairs, solve)));
    }
    let ours = single(pairs, |pair| scalar::closest_approach(pair).1);
    methods.push(("nearmiss, one by one".to_owned(), ours));
    let batch_f64 = Batch::new(batch(pairs), count);
    methods.push(("nearmiss, batch f64".to_owned(), Box::new(batch_f64)));
    let batch_f32 = Batch::new(batch_f32(pairs), count);
    methods.push(("nearmiss, batch f32".to_owned(), Box::new(batch_f32)));
    let certified = Box::new(Certified::new(pairs));
    methods.push(("nearmiss, certified batch".to_owned(), certified));
    methods
}

/// Time and errors of all methods on all kinds of pairs.
pub(crate) fn table(effort: &Effort, progress: &dyn Fn(f64)) -> Table {
    let count = effort.choose(4_096, 256);
    let turns = effort.choose(5, 3);
    let mut table = Table::new(
        "pair",
        format!(
            "One pair: closest approach of two cubics ({count} pairs of each kind, one thread)"
        ),
        &[
            "pairs",
            "method",
            "ns",
            "times polycool",
            "worst error/size",
            "wrong minima",
        ],
    );
    for (number, kind) in Workload::ALL.into_iter().enumerate() {
        let pairs: Rc<[_]> = kind.pairs(count, 1).into();
        let mut reference = Certified::new(&pairs);
        reference.run();
        let mut methods = methods(&pairs);
        let mut runs: Vec<_> = methods
            .iter_mut()
            .map(|(_, method)| || method.run())
            .collect();
        let times = in_turns(turns, &mut runs);
        drop(runs);
        for ((name, method), (time, ratio)) in methods.iter().zip(times) {
            let (mut worst, mut wrong) = (0.0_f64, 0);
            let found = method.distances();
            for ((found, known), pair) in found.iter().zip(&reference.found).zip(&*pairs) {
                let beyond = (known.low - found).max(found - known.high).max(0.0);
                let error = if found.is_nan() {
                    f64::INFINITY
                } else {
                    beyond / size(pair)
                };
                worst = worst.max(error);
                wrong += usize::from(error > WRONG);
            }
            #[allow(clippy::cast_precision_loss, reason = "shown")]
            let nanoseconds = time * 1e9 / count as f64;
            table.row(vec![
                kind.name().into(),
                name.as_str().into(),
                nanoseconds.into(),
                (1.0 / ratio).into(),
                worst.into(),
                Cell::from(wrong),
            ]);
        }
        #[allow(clippy::cast_precision_loss, reason = "shown")]
        progress((number + 1) as f64 / Workload::ALL.len() as f64);
    }
    table.note(
        "error: distance of the result from the certified enclosure of the least distance, in sizes \
         (farthest control point); wrong minima: errors above 1e-4.",
    );
    table.note(
        "An error of 0 is a result within the enclosure. The certified row is the reference: its errors are 0 by \
         definition.",
    );
    table
}
