//! What a bank of the paper's gel reaches: 33 positions × 7 depths, swept at 41 positions, the probe 4 mm deep. Slow; run it by
//!
//! ```sh
//! cargo test --release -p palpate-tests bank_of_the_paper -- --ignored --nocapture
//! ```

use std::time::Instant;

use palpate::bank::{Bank, BankDetector, BankPlan, BankSearch};
use palpate::detect::nuisance::NoiseLevel;
use palpate::fem::{Contact, MESH_SIZE, Model};
use palpate::force::Force;
use palpate::force_map::ForceMap;
use palpate::phantom::Phantom;
use palpate::stats::binomial::clopper_pearson;
use palpate::stats::normal::{quantile, upper_tail};
use palpate::stats::random::Generator;
use palpate::trace::{Correlation, Criterion, Noise, Question, Record, Trace, Unknown, nuisances};

const DEPTH: f64 = 4e-3;
const USUAL: &[Unknown] = &[Unknown::Offset, Unknown::Drift, Unknown::Gain];

fn laterals() -> Vec<f64> {
    (-20..=20).map(|k| 5e-4 * f64::from(k)).collect()
}

fn bank() -> Bank {
    let phantom = Phantom::builtin("6.6").unwrap();
    let mut plan = BankPlan::new(phantom, DEPTH, &laterals()).unwrap();
    plan.positions = (-16..=16).map(|k| 5e-4 * f64::from(k)).collect();
    plan.depths = [2.6e-3, 3.6e-3, 4.6e-3, 5.6e-3, 6.6e-3, 7.6e-3, 8.6e-3].to_vec();
    let start = Instant::now();
    let bank = plan.bank().unwrap();
    println!(
        "the bank: {:.1} s on one core",
        start.elapsed().as_secs_f64()
    );
    bank
}

/// The forces with the inclusion at `x` and `depth`, mm, on a mesh of its own.
fn map(x: f64, depth: f64, mesh_size: f64) -> ForceMap {
    let phantom = Phantom::builtin("6.6").unwrap().changed(|parts| {
        parts.inclusions[0].centre_x = 1e-3 * x;
        parts.inclusions[0].depth = 1e-3 * depth;
    });
    let phantom = phantom.unwrap();
    let model = Model::new(&phantom, mesh_size, Contact::default()).unwrap();
    model.sweep(&[DEPTH], &laterals()).unwrap()
}

fn record(map: &ForceMap) -> Record {
    let forces = map.table().row(DEPTH).unwrap();
    let mut text = String::from("position_mm,lateral_force_n,normal_force_n\n");
    for (k, position) in laterals().iter().enumerate() {
        let [lateral, normal] = [forces.lateral[k], forces.normal[k]];
        text += &format!("{},{lateral},{normal}\n", 1e3 * position);
    }
    Trace::from_csv(&text, "exact.csv")
        .unwrap()
        .record(None)
        .unwrap()
}

/// The detector of a sweep with one sample at each position of the bank, in noise of `sd`.
fn detector(bank: &Bank, unknown: &[Unknown], sd: f64) -> BankDetector {
    let white = |force: Force<&[f64]>| -> Vec<f64> {
        let both = [force.lateral, force.normal].concat();
        both.iter().map(|value| value / sd).collect()
    };
    let reference = bank.reference();
    let f0 = white(reference.table().row(DEPTH).unwrap());
    let templates = bank.maps().iter().flat_map(|map| {
        let f1 = white(map.table().row(DEPTH).unwrap());
        f1.iter()
            .zip(&f0)
            .map(|(f1, f0)| f1 - f0)
            .collect::<Vec<_>>()
    });
    let expected = |depth| Ok(reference.table().row(depth)?.map(<[f64]>::to_vec));
    let signals = nuisances(unknown, reference.table().depths(), DEPTH, expected).unwrap();
    let signals = signals.iter().flat_map(|signal| white(signal.as_deref()));
    let number = bank.maps().len();
    let prior = vec![1.0 / number as f64; number];
    BankDetector::new(
        bank.axes(),
        templates.collect(),
        &prior,
        signals.collect(),
        &[],
        NoiseLevel::Known,
    )
    .unwrap()
}

// Verifies: BNK-042.
#[test]
#[ignore = "slow: run it with --release"]
fn a_noiseless_inclusion_is_found_between_the_points() {
    let bank = bank();
    for depth in [2.6, 4.6, 6.6, 8.6] {
        let mut worst = [0.0_f64; 2];
        for x in [0.23, -1.25, 2.75, 4.25, 5.25, -6.8, 7.25, 7.75] {
            let record = record(&map(x, depth, MESH_SIZE));
            let question = Question {
                depth: DEPTH,
                depth_tolerance: 0.0,
                is_zeroed: false,
                unknown: &[],
                noise: Noise {
                    sd: Some(Force::new(0.1, 0.1)),
                    correlation: Correlation::None,
                },
                criterion: Criterion::MaximumAPosteriori,
                prior_h1: 0.5,
            };
            let search = BankSearch {
                question,
                bank: &bank,
                prior: None,
                simulations: None,
            };
            let [found_x, found_depth, ..] = search.locate(&record).unwrap().place.estimate;
            worst[0] = worst[0].max((1e3 * found_x - x).abs());
            worst[1] = worst[1].max((1e3 * found_depth - depth).abs());
        }
        println!(
            "{depth} mm deep, forces of a mesh of 0.5 mm: position off by {:.3} mm at most, depth by {:.3} mm",
            worst[0], worst[1]
        );
        assert!(worst[0] <= 0.05 && worst[1] <= 0.1, "{depth}: {worst:?}");
    }
}

// Verifies: BNK-042, BNK-050.
#[test]
#[ignore = "slow: run it with --release"]
fn estimates_spread_as_the_bound_says() {
    const RECORDS: u64 = 4000;
    let bank = bank();
    for (x, depth, unknown) in [
        (1.75, 4.1, &[][..]),
        (1.75, 4.1, USUAL),
        (-3.25, 5.1, &[]),
        (0.25, 3.1, USUAL),
    ] {
        let at = [1e-3 * x, 1e-3 * depth, bank.axes()[2][0], bank.axes()[3][0]];
        // γ, beside what is unknown, of a signal between the points: that of the noise of 1 N over the noise.
        let of_one = detector(&bank, unknown, 1.0);
        let signal = of_one.template_at(at);
        let gamma = signal.iter().map(|s| s * s).sum::<f64>().sqrt();
        for wanted in [3.0, 5.0, 8.0, 12.0, 20.0] {
            let sd = gamma / wanted;
            let detector = detector(&bank, unknown, sd);
            let signal: Vec<f64> = signal.iter().map(|s| s / sd).collect();
            let bound = detector.bound(at).sd;
            let generator = Generator::new(18, wanted as u64);
            // The likeliest place and the mean; of each position and depth: Σ of errors and of their squares.
            let mut sums = [[[0.0; 2]; 2]; 2];
            for trial in 0..RECORDS {
                let mut record = vec![0.0; signal.len()];
                generator.normals(trial, 0, &mut record);
                record.iter_mut().zip(&signal).for_each(|(r, s)| *r += s);
                let place = detector.place(&detector.statistic(&mut record).unwrap());
                for (sums, estimate) in sums.iter_mut().zip([place.estimate, place.mean()]) {
                    for (axis, [sum, squares]) in sums.iter_mut().enumerate() {
                        let off = estimate[axis] - at[axis];
                        *sum += off / RECORDS as f64;
                        *squares += off * off / RECORDS as f64;
                    }
                }
            }
            for (name, sums) in ["likeliest", "mean"].into_iter().zip(sums) {
                let spread = |axis: usize| {
                    let [bias, square] = sums[axis];
                    let least = bound[axis].unwrap();
                    [(square - bias * bias).sqrt() / least, bias / least]
                };
                let [[sd, bias], [sd_of_depth, bias_of_depth]] = [spread(0), spread(1)];
                println!(
                    "{x} mm, {depth} mm deep, {} unknown, gamma {wanted}, {name}: position sd {sd:.3}, bias {bias:+.3} of the bound {:.3} mm; depth {sd_of_depth:.3}, {bias_of_depth:+.3} of {:.3} mm",
                    unknown.len(),
                    1e3 * bound[0].unwrap(),
                    1e3 * bound[1].unwrap(),
                );
                // The likeliest place alone, with nothing else unknown, is still in the threshold effect at γ = 8.
                let least = if name == "mean" || !unknown.is_empty() {
                    8.0
                } else {
                    12.0
                };
                if wanted >= least {
                    let holds = (sd - 1.0).abs() <= 0.1 && bias.abs() < 0.2;
                    assert!(holds, "{name} {sd} {bias}");
                }
            }
        }
    }
}

// Verifies: BNK-051, BNK-053, BNK-054.
#[test]
#[ignore = "slow: run it with --release"]
fn a_calibrated_threshold_keeps_its_rate_on_fresh_seeds() {
    let bank = bank();
    for unknown in [&[][..], USUAL] {
        let detector = detector(&bank, unknown, 0.1);
        for (rate, simulations) in [(1e-2, 100_000), (1e-3, 400_000)] {
            let found = detector.calibrate(rate, simulations, 1).unwrap();
            let interval = found.false_alarm;
            let rare = detector.rare_false_alarms(found.eta, 100_000, 7).unwrap();
            for seed in [2, 3, 4] {
                let generator = Generator::new(seed, 0);
                let none = vec![0.0; detector.samples()];
                let maximum = |trial| detector.simulated_maximum(&none, generator, trial).unwrap();
                let alarms = (0..simulations)
                    .filter(|&trial| maximum(trial) >= found.eta)
                    .count() as u64;
                let again = alarms as f64 / simulations as f64;
                println!(
                    "{} unknown, {rate}: stated {:.3e} to {:.3e}, seed {seed}: {again:.3e}, by importance {:.3e} ± {:.0e}, bound {:.2e}",
                    unknown.len(),
                    interval.lower,
                    interval.upper,
                    rare.rate,
                    rare.standard_error,
                    rare.union
                );
                let again = clopper_pearson(alarms, simulations, 0.999).unwrap();
                assert!(again.lower < interval.upper && interval.lower < again.upper);
            }
            let holds = interval.lower < rare.rate && rare.rate < interval.upper;
            assert!(holds, "{rare:?}");
        }
    }
}

// Verifies: BNK-054.
#[test]
#[ignore = "slow: run it with --release"]
fn the_power_of_a_search_is_near_that_of_a_known_place() {
    let bank = bank();
    let at = [1.75e-3, 4.1e-3, bank.axes()[2][0], bank.axes()[3][0]];
    for unknown in [&[][..], USUAL] {
        let of_one = detector(&bank, unknown, 1.0).template_at(at);
        let gamma = of_one.iter().map(|s| s * s).sum::<f64>().sqrt();
        for wanted in [2.0, 3.0, 4.0, 5.0, 6.0, 7.0] {
            let detector = detector(&bank, unknown, gamma / wanted);
            let eta = detector.calibrate(0.01, 20_000, 1).unwrap().eta;
            let found = detector.power(eta, at, 4_000, 2).unwrap();
            let known = upper_tail(-quantile(0.01).unwrap() - wanted).unwrap();
            println!(
                "{} unknown, gamma {wanted}: power {:.3} to {:.3} with 1 % false alarms; {known:.3} if the place were known",
                unknown.len(),
                found.lower,
                found.upper
            );
            assert!(found.lower < known);
        }
    }
}
