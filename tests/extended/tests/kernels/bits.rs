//! The same bits with every instruction set, alone and anywhere in a batch, and on any thread.

use super::workloads::Workload;
use super::{
    ControlPoints, InstructionSet, Verdict, approaches, approaches_f32, batch, batch_f32,
    enclosures, rounded, scalar, within,
};

/// A hash of everything the kernels say with an instruction set (FNV-1a over the bits).
fn hash(instructions: InstructionSet, pairs: &[ControlPoints<f64>]) -> u64 {
    let mut hash = 0xcbf2_9ce4_8422_2325_u64;
    let mut add = |bits: u64| hash = (hash ^ bits).wrapping_mul(0x0100_0000_01b3);
    let (times, distances) = approaches(instructions, pairs);
    times
        .iter()
        .chain(&distances)
        .for_each(|x| add(x.to_bits()));
    let (times, distances_f32) = approaches_f32(instructions, pairs);
    times
        .iter()
        .chain(&distances_f32)
        .for_each(|x| add(u64::from(x.to_bits())));
    for found in enclosures(instructions, pairs, &vec![1e-13; pairs.len()]) {
        for x in [found.low, found.high, found.time] {
            add(x.to_bits());
        }
    }
    let mut verdicts = vec![Verdict::Undecided; pairs.len()];
    // Thresholds on both sides of the distances, and very close.
    let inner: Vec<f64> = distances.iter().map(|d| d * (1.0 - 1e-9)).collect();
    let outer: Vec<f64> = distances.iter().rev().copied().collect();
    within(
        instructions,
        &batch(pairs).lanes(),
        &inner,
        &outer,
        &mut verdicts,
    );
    verdicts.iter().for_each(|v| add(*v as u64));
    let outer: Vec<f32> = distances_f32.iter().rev().copied().collect();
    within(
        instructions,
        &batch_f32(pairs).lanes(),
        &distances_f32,
        &outer,
        &mut verdicts,
    );
    verdicts.iter().for_each(|v| add(*v as u64));
    hash
}

#[test]
fn every_level_gives_the_same_bits() {
    for workload in Workload::ALL {
        let pairs = workload.pairs(5_003, 17);
        let portable = hash(InstructionSet::PORTABLE, &pairs);
        for instructions in InstructionSet::available() {
            assert_eq!(
                hash(instructions, &pairs),
                portable,
                "{} {workload:?}",
                instructions.name()
            );
        }
    }
    assert!(InstructionSet::available().contains(&InstructionSet::best()));
}

#[test]
fn a_pair_has_the_same_bits_alone_and_anywhere_in_a_batch() {
    let pairs = Workload::Near.pairs(300, 18);
    let (times, distances) = approaches(InstructionSet::best(), &pairs);
    let (times_f32, distances_f32) = approaches_f32(InstructionSet::best(), &pairs);
    for (i, pair) in pairs.iter().enumerate() {
        assert_eq!(scalar::closest_approach(pair), (times[i], distances[i]));
        let single = scalar::closest_approach(&rounded(pair));
        assert_eq!(single, (times_f32[i], distances_f32[i]));
    }
    for count in [0, 1, 2, 7, 8, 9, 95, 96, 97, 193] {
        assert_eq!(
            approaches(InstructionSet::best(), &pairs[..count]).1,
            distances[..count]
        );
        let shifted = approaches(InstructionSet::best(), &pairs[300 - count..]).1;
        assert_eq!(shifted, distances[300 - count..]);
    }
}

#[cfg(feature = "parallel")]
#[test]
fn threads_do_not_change_the_bits() {
    use nearmiss::kernels::parallel;

    let pairs = Workload::Near.pairs(20_001, 19);
    let (times, distances) = approaches(InstructionSet::best(), &pairs);
    let found = enclosures(InstructionSet::best(), &pairs, &vec![1e-12; pairs.len()]);
    let lanes = batch(&pairs);
    let limits = vec![1.0; pairs.len()];
    let mut verdicts = vec![Verdict::Undecided; pairs.len()];
    within(
        InstructionSet::best(),
        &lanes.lanes(),
        &limits,
        &limits,
        &mut verdicts,
    );
    for threads in 1..=4 {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        pool.install(|| {
            let (mut t, mut d) = (vec![0.0; pairs.len()], vec![0.0; pairs.len()]);
            parallel::closest_approach(InstructionSet::best(), &lanes.lanes(), &mut t, &mut d);
            assert_eq!((&t, &d), (&times, &distances));
            let mut e = found.clone();
            e.reverse();
            parallel::enclose(
                InstructionSet::best(),
                &lanes.lanes(),
                &vec![1e-12; pairs.len()],
                &mut e,
            );
            assert_eq!(e, found);
            let mut v = vec![Verdict::Undecided; pairs.len()];
            parallel::within(
                InstructionSet::best(),
                &lanes.lanes(),
                &limits,
                &limits,
                &mut v,
            );
            assert_eq!(v, verdicts);
        });
    }
}
