//! How many trials a second one core simulates. The NumPy twin `detect_numpy.py` runs the same job and
//! prints the same lines. On a quiet machine (wall clock), one after the other:
//!
//! ```sh
//! cargo bench -p palpate-benches --bench detect
//! python3 benches/detect_numpy.py
//! ```

use palpate::bank::{BankPlan, WatchQuestion, Watcher};
use palpate::detect::nuisance::{Nuisances, SubspaceDetector};
use palpate::detect::sequential::{Sequential, Wald, memory};
use palpate::detect::simulate::Simulation;
use palpate::detect::{Decision, DetectError, MatchedFilter};
use palpate::force::Force;
use palpate::force_map::{ForceTable, Matrix};
use palpate::phantom::Phantom;
use palpate::refusal::Refusal;
use palpate::robust::{AMPLITUDE, RobustDetector, RobustQuestion, RobustSignal, RobustSweep};
use palpate::stats::random::Generator;
use palpate::trace::{Record, Unknown};
use std::error::Error;
use std::time::Instant;

/// Samples a channel.
const SAMPLES: usize = 401;
/// Full records in one run.
const RECORDS: u64 = 100_000;

/// A force that rises over the inclusion, N: a bump of `height` and its slope sideways.
fn force(height: f64) -> Force<Vec<f64>> {
    let position = |i: usize| (i as f64 - 200.0) / 60.0;
    let bump = |i: usize| height * (-0.5 * position(i) * position(i)).exp();
    Force::new(
        (0..SAMPLES).map(|i| position(i) * bump(i)).collect(),
        (0..SAMPLES).map(|i| 1.5 + bump(i)).collect(),
    )
}

/// The best of five runs, in items a second.
fn rate(items: f64, mut run: impl FnMut() -> Result<f64, DetectError>) -> Result<f64, DetectError> {
    let mut best = 0.0_f64;
    for _ in 0..5 {
        let start = Instant::now();
        std::hint::black_box(run()?);
        best = best.max(items / start.elapsed().as_secs_f64());
    }
    Ok(best)
}

fn main() -> Result<(), Box<dyn Error>> {
    exact()?;
    for hypotheses in [131, 2000] {
        robust(hypotheses)?;
    }
    live()
}

/// What a sample of both forces costs while the sweep is taken, against 231 hypotheses beside offsets, drifts, gain and depth: in the
/// detector, and with interpolation, decision and coverage, and with an answer each.
fn live() -> Result<(), Box<dyn Error>> {
    let laterals: Vec<f64> = (-10..=10).map(|k| f64::from(k) * 1e-3).collect();
    let mut plan = BankPlan::new(Phantom::builtin("4.6")?, 4e-3, &laterals)?;
    plan.positions = (-16..=16).map(|k| f64::from(k) * 5e-4).collect();
    plan.depths = (0..7).map(|k| 2.6e-3 + 1e-3 * f64::from(k)).collect();
    plan.mesh_size = 2e-3;
    let bank = plan.bank()?;
    let question = WatchQuestion {
        unknown: vec![
            Unknown::Offset,
            Unknown::Drift,
            Unknown::Gain,
            Unknown::Depth,
        ],
        noise_sd: Force::new(0.1, 0.1),
        is_zeroed: false,
        prior_h1: 0.5,
        prior: None,
        test: Wald::new(0.01, 0.05)?,
    };
    let fresh = Watcher::new(&bank, &question)?;
    let sweep: Vec<f64> = (0..SAMPLES).map(|i| i as f64 * 40e-6 - 8e-3).collect();
    let reference = bank.reference().table().sweep(4e-3, &sweep)?;
    let generator = Generator::new(2026, 1);
    let noise = |at: usize| 0.1 * generator.normal(0, at as u64);
    let record = |at: usize| {
        Force::new(
            reference.lateral[at] + noise(2 * at),
            reference.normal[at] + noise(2 * at + 1),
        )
    };
    let samples: Vec<_> = (0..SAMPLES).map(|at| (sweep[at], record(at))).collect();
    let watched = |answers: bool| {
        rate(SAMPLES as f64, || {
            let mut watcher = fresh.clone();
            for (position, force) in &samples {
                watcher.push(*position, None, Some(force.lateral), force.normal)?;
                if answers {
                    std::hint::black_box(watcher.answer()?);
                }
            }
            Ok(watcher.answer()?.theta)
        })
    };
    let signals: Vec<f64> = (0..bank.maps().len()).map(|k| (k as f64).sin()).collect();
    let core = rate(SAMPLES as f64, || {
        let mut found = Sequential::new(vec![0.0; memory(signals.len(), 6)], signals.len(), 6)?;
        for (at, (_, force)) in samples.iter().enumerate() {
            let (time, depth) = (at as f64, noise(at));
            found.push(
                force.lateral,
                &[1.0, 0.0, time, 0.0, 0.3, depth],
                std::hint::black_box(&signals),
            )?;
            found.push(
                force.normal,
                &[0.0, 1.0, 0.0, time, 1.5, depth],
                std::hint::black_box(&signals),
            )?;
        }
        let most = found.evidence().map(|of| of.theta());
        Ok(most.fold(0.0, f64::max))
    })?;
    let [core, push, answer] = [core, watched(false)?, watched(true)?].map(|rate| 1e6 / rate);
    println!(
        "a sample against {} hypotheses beside 6 nuisances: {core:.2} us in the detector, {push:.2} us with decision, {answer:.2} us with an answer",
        bank.maps().len()
    );
    Ok(())
}

/// What a record costs with the robust model: once for all records over the same positions, and each.
fn robust(hypotheses: usize) -> Result<(), Refusal> {
    let laterals: Vec<f64> = (0..SAMPLES).map(|i| i as f64 * 40e-6 - 8e-3).collect();
    let of = |channel: Vec<f64>| Matrix::from_fn(1, SAMPLES, |_, i| channel[i]);
    let flat = ForceTable::new(vec![4e-3], laterals.clone(), force(0.0).map(of))?;
    let mut noise = vec![0.0; 2 * SAMPLES];
    Generator::new(2026, 0).normals(0, 0, &mut noise);
    let Force { lateral, normal } = force(0.34);
    let noisy = |channel: Vec<f64>, noise: &[f64]| -> Vec<f64> {
        channel
            .iter()
            .zip(noise)
            .map(|(f, n)| f + 0.1 * n)
            .collect()
    };
    let lateral = noisy(lateral, &noise[..SAMPLES]);
    let normal = noisy(normal, &noise[SAMPLES..]);
    let record = Record::new("record", &laterals, Force::new(&lateral, &normal))?;
    let signal = |number: usize| {
        let Force { lateral, normal } = force(0.5 * (number + 1) as f64 / hypotheses as f64);
        let normal: Vec<f64> = normal.iter().map(|f| f - 1.5).collect();
        RobustSignal {
            of_sweeps: vec![[lateral, normal].concat()],
            amplitude_sd: AMPLITUDE,
            prior: 1.0 / hypotheses as f64,
        }
    };
    let signals: Vec<_> = (0..hypotheses).map(signal).collect();
    let question = RobustQuestion::default();
    let sweep = RobustSweep::new(&record, 4e-3, None);
    let detector = RobustDetector::new(question, &flat, &[sweep], &signals)?;
    let mut best = [f64::INFINITY; 2];
    for _ in 0..15 {
        let start = Instant::now();
        std::hint::black_box(RobustDetector::new(question, &flat, &[sweep], &signals)?);
        best[0] = best[0].min(1e3 * start.elapsed().as_secs_f64());
        let start = Instant::now();
        let answer = detector.judge(&[record.forces()])?;
        best[1] = best[1].min(1e3 * start.elapsed().as_secs_f64());
        assert_eq!(answer.decision, Some(Decision::Inclusion));
    }
    let [once, each] = best;
    println!(
        "robust, {hypotheses} hypotheses: {once:.1} ms for the positions, {each:.1} ms a record"
    );
    Ok(())
}

fn exact() -> Result<(), DetectError> {
    let (f0, f1) = (force(0.0), force(0.34));
    let pairs = f0.as_ref().zip(f1.as_ref());
    let template =
        pairs.map(|(f0, f1)| -> Vec<f64> { f0.iter().zip(f1).map(|(f0, f1)| f1 - f0).collect() });
    let (f0, f1, template) = (f0.as_deref(), f1.as_deref(), template.as_deref());
    let noise_sd = Force::new(3.0, 3.0);
    let generator = Generator::new(2026, 0);
    let simulation = Simulation::new(f0, template, noise_sd, generator)?;
    let mut scratch = vec![0.0; 2 * SAMPLES];
    let records = rate(RECORDS as f64, || {
        let mut sum = 0.0;
        for trial in 0..RECORDS {
            sum += simulation.trial(trial, f1, &mut scratch)?.theta;
        }
        Ok(sum)
    })?;
    println!("full records (2 x {SAMPLES} samples): {records:.4e} trials/s");
    beside_nuisances(f0, template, noise_sd)
}

/// What a record costs with all nuisances, against the statistic of known parameters.
fn beside_nuisances(
    f0: Force<&[f64]>,
    template: Force<&[f64]>,
    noise_sd: Force<f64>,
) -> Result<(), DetectError> {
    let white = |force: Force<&[f64]>| -> Vec<f64> {
        let channels = force.zip(noise_sd).into_array().into_iter();
        channels
            .flat_map(|(samples, sd)| samples.iter().map(move |sample| sample / sd))
            .collect()
    };
    let power = |n: i32| -> Vec<f64> { (0..SAMPLES).map(|i| (i as f64 / 400.0).powi(n)).collect() };
    let [none, one, line, square, cube] =
        [vec![0.0; SAMPLES], power(0), power(1), power(2), power(3)];
    // An offset and a drift of each channel, and what a gain and a depth may be like.
    let signals = [
        [&one, &none],
        [&none, &one],
        [&line, &none],
        [&none, &line],
        [&line, &square],
        [&square, &cube],
    ];
    let mut signals = signals
        .map(|[lateral, normal]| white(Force::new(lateral, normal)))
        .concat();
    let (mut white_template, mut record) = (white(template), white(template));
    let nuisances = Nuisances::new(&mut signals, 2 * SAMPLES)?;
    assert_eq!(nuisances.rank().get(), 6);
    let detector = SubspaceDetector::new(nuisances, &mut white_template)?;
    let filter = MatchedFilter::new(template, noise_sd)?;
    let of_known = rate(RECORDS as f64, || {
        let thetas = (0..RECORDS).map(|_| Ok(filter.statistic(std::hint::black_box(f0))?.theta));
        thetas.sum()
    })?;
    let beside = rate(RECORDS as f64, || {
        let ts = (0..RECORDS).map(|_| Ok(detector.statistic(std::hint::black_box(&mut record))?.t));
        ts.sum()
    })?;
    let [of_known, beside] = [of_known, beside].map(|rate| 1e6 / rate);
    println!(
        "statistic of a record: {of_known:.3} us with known parameters, {beside:.3} us beside 6 nuisances: {:.2} times",
        beside / of_known
    );
    Ok(())
}
