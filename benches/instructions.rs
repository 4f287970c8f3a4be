//! Instructions of what a run's time goes to, counted by callgrind, whatever the machine's load: `cargo bench -p palpate-benches --bench
//! instructions` (needs valgrind and the runner `gungraun-runner`). Each has a ceiling a tenth above what was counted; ends with an error
//! above it.

#![allow(missing_docs)] // of what its macros make

use std::hint::black_box;

use gungraun::prelude::*;
use gungraun::{Callgrind, EventKind, LibraryBenchmarkConfig};
use palpate::detect::sequential::{Sequential, memory};
use palpate::fem::{Contact, Model};
use palpate::force::Force;
use palpate::force_map::{ForceMap, ForceTable, Matrix};
use palpate::phantom::Phantom;
use palpate::robust::{
    AMPLITUDE, RobustAnswer, RobustDetector, RobustQuestion, RobustSignal, RobustSweep,
};
use palpate::trace::Record;

/// A ceiling, a tenth above what was counted.
///
/// Implements: CON-012.
fn at_most(instructions: u64) -> LibraryBenchmarkConfig {
    let mut counted = Callgrind::default();
    counted.hard_limits([(EventKind::Ir, instructions)]);
    LibraryBenchmarkConfig::default().tool(counted).to_owned()
}

const SAMPLES: usize = 161;

/// Positions of the samples, m.
fn positions() -> Vec<f64> {
    (0..SAMPLES).map(|i| i as f64 * 1e-4 - 8e-3).collect()
}

/// A bump at `place` in samples, N, and waves in place of noise.
fn bump(size: f64, place: f64) -> Vec<f64> {
    let v = |i: usize| (i as f64 - place) / 30.0;
    let of = |i: usize| size * (-0.5 * v(i) * v(i)).exp() + 0.02 * (9.0 * i as f64).sin();
    (0..SAMPLES).map(of).collect()
}

fn phantom() -> Phantom {
    Phantom::builtin("6.6").expect("a built-in phantom")
}

fn model() -> Model {
    Model::new(&phantom(), 2e-3, Contact::default()).expect("a coarse mesh")
}

#[library_benchmark(config = at_most(120_500_000))]
#[bench::coarse(phantom())]
fn model_of_a_phantom(phantom: Phantom) -> Model {
    Model::new(black_box(&phantom), 2e-3, Contact::default()).expect("a coarse mesh")
}

#[library_benchmark(config = at_most(27_500_000))]
#[bench::coarse(model())]
fn forces_at_three_poses(model: Model) -> ForceMap {
    black_box(&model)
        .sweep(&[4e-3], &[0.0, 1e-3, 2e-3])
        .expect("poses within the well")
}

fn robust() -> (RobustDetector<'static>, Vec<f64>, Vec<f64>) {
    let even = |channel: Vec<f64>| Matrix::from_fn(1, SAMPLES, |_, i| channel[i]);
    let flat = Force::new(bump(0.0, 0.0), vec![1.5; SAMPLES]);
    let map = ForceTable::new(vec![4e-3], positions(), flat.map(even)).expect("a map");
    let (lateral, normal) = (bump(0.1, 60.0), bump(0.3, 80.0));
    let normal: Vec<f64> = normal.iter().map(|f| f + 1.5).collect();
    let record = Record::new("record", &positions(), Force::new(&lateral, &normal));
    let record = record.expect("a record");
    let sweep = RobustSweep::new(&record, 4e-3, None);
    let signal = |number: usize| RobustSignal {
        of_sweeps: vec![[bump(0.1, 60.0), bump(0.3, number as f64)].concat()],
        amplitude_sd: AMPLITUDE,
        prior: 1.0 / 100.0,
    };
    let signals: Vec<_> = (0..100).map(signal).collect();
    let detector = RobustDetector::new(RobustQuestion::default(), &map, &[sweep], &signals);
    (detector.expect("a detector"), lateral, normal)
}

#[library_benchmark(config = at_most(52_500_000))]
#[bench::a_hundred_hypotheses(robust())]
fn record_by_the_robust_model(
    (detector, lateral, normal): (RobustDetector<'static>, Vec<f64>, Vec<f64>),
) -> RobustAnswer {
    let record = Force::new(&lateral[..], &normal[..]);
    detector.judge(black_box(&[record])).expect("an answer")
}

const HYPOTHESES: usize = 231;
const NUISANCES: usize = 6;
type Live = (Sequential<Vec<f64>>, Vec<f64>);

fn live() -> Live {
    let memory = vec![0.0; memory(HYPOTHESES, NUISANCES)];
    let found = Sequential::new(memory, HYPOTHESES, NUISANCES).expect("hypotheses");
    (found, (0..HYPOTHESES).map(|k| (k as f64).sin()).collect())
}

#[library_benchmark(config = at_most(1_206_000))]
#[bench::beside_six_nuisances(live())]
fn fifty_samples_of_a_live_record((mut found, signals): Live) -> Sequential<Vec<f64>> {
    for at in 0..50 {
        let time = f64::from(at);
        let (force, depth) = ((0.7 * time).sin(), (0.3 * time).cos());
        for row in [
            [1.0, 0.0, time, 0.0, 0.3, depth],
            [0.0, 1.0, 0.0, time, 1.5, depth],
        ] {
            found
                .push(force, &row, black_box(&signals))
                .expect("finite numbers");
        }
    }
    found
}

library_benchmark_group!(
    name = parts;
    benchmarks = model_of_a_phantom, forces_at_three_poses, record_by_the_robust_model, fifty_samples_of_a_live_record
);

// Verifies: CON-012.
main!(library_benchmark_groups = parts);
