//! Rates of error of the largest of many.

use super::*;
use crate::detect::nuisance::SubspaceTest;
use crate::stats::binomial::clopper_pearson;
use crate::stats::normal;
use crate::stats::random::{Generator, uniform};
use palpate_asserts::assert_near;

/// Records whose Θ_max is at least `eta`, of so many without inclusion but with `mean`.
fn alarms(detector: &BankDetector, eta: f64, mean: &[f64], seed: u64, records: u64) -> u64 {
    let generator = Generator::new(seed, 0);
    let maximum = |trial| detector.simulated_maximum(mean, generator, trial).unwrap();
    (0..records).filter(|&trial| maximum(trial) >= eta).count() as u64
}

fn tests(detector: &BankDetector) -> Vec<SubspaceTest> {
    let mut record = vec![0.0; SAMPLES];
    Generator::new(3, 3).normals(0, 0, &mut record);
    let statistic = detector.statistic(&mut record).unwrap();
    detector.tests(&statistic).unwrap()
}

// Verifies: BNK-051, ERR-006.
#[test]
fn the_bound_is_the_sum_of_the_tails_and_keeps_the_rate() {
    let detector = detector(6.0, false, NoiseLevel::Known);
    let tests = tests(&detector);
    let expected = |eta: f64| -> f64 {
        let tail = |gamma: &f64| normal::upper_tail(eta / gamma + 0.5 * gamma).unwrap();
        detector.gamma().iter().map(tail).sum()
    };
    for eta in [0.5, 2.0, 6.0] {
        let found = false_alarm_bound(&tests, eta).unwrap();
        assert_near(found, expected(eta).min(1.0), 1e-13);
    }
    assert_eq!(false_alarm_bound(&tests, -1e3).unwrap(), 1.0);
    let eta = false_alarm_threshold(&tests, 0.01).unwrap();
    assert!((expected(eta) - 0.01).abs() < 1e-9);
    let found = alarms(&detector, eta, &[0.0; SAMPLES], 5, 20_000);
    assert!(clopper_pearson(found, 20_000, 0.999_999).unwrap().lower < 0.01);
    assert!(false_alarm_threshold(&tests, 0.0).is_err());
    assert!(false_alarm_threshold(&[], 0.01).is_err());
}

// Verifies: BNK-053.
#[test]
fn a_calibrated_threshold_has_its_rate_on_other_seeds() {
    let known = detector(6.0, true, NoiseLevel::Known);
    let unknown = detector(6.0, true, NoiseLevel::Unknown);
    for (detector, rate) in [(&known, 0.01), (&unknown, 0.02)] {
        let found = detector.calibrate(rate, 20_000, 1).unwrap();
        let interval = found.false_alarm;
        assert!(interval.lower < rate && rate < interval.upper && interval.upper < 1.25 * rate);
        let again = alarms(detector, found.eta, &[0.0; SAMPLES], 2, 20_000);
        let again = clopper_pearson(again, 20_000, 0.9999).unwrap();
        let overlap = again.lower < interval.upper && interval.lower < again.upper;
        assert!(overlap, "{again:?} {interval:?}");
        // The sum over 65 points that are much alike is far above it.
        assert!(found.eta < false_alarm_threshold(&tests(detector), rate).unwrap());
    }
    assert!(known.calibrate(1e-4, 20_000, 1).is_err());
}

// Verifies: BNK-053.
#[test]
fn a_calibrated_threshold_counts_deviations_to_both_sides() {
    let templates: Vec<f64> = [1.0, 2.0].iter().flat_map(|x| signal(*x, 2.0)).collect();
    let points = [vec![1.0, 2.0], vec![2.0], vec![1.0], vec![1.0]];
    let against = times(-0.5, &signal(1.5, 2.0));
    let new = |deviations: &[Vec<f64>]| {
        let (templates, known) = (templates.clone(), NoiseLevel::Known);
        BankDetector::new(&points, templates, &[0.5; 2], vec![], deviations, known).unwrap()
    };
    let (without, with) = (new(&[]), new(std::slice::from_ref(&against)));
    let eta = with.calibrate(0.05, 10_000, 1).unwrap().eta;
    assert!(eta > without.calibrate(0.05, 10_000, 1).unwrap().eta);
    // The deviation takes from the signal; the other direction is the one that alarms.
    let worst = times(-1.0, &against);
    let found = alarms(&without, eta, &worst, 2, 10_000);
    let found = clopper_pearson(found, 10_000, 0.9999).unwrap();
    assert!(found.lower < 0.0565 && 0.0441 < found.upper, "{found:?}");
}

/// A bank of which nothing but the noise is seen: signals of a billionth of it.
fn blind(deviations: &[Vec<f64>]) -> BankDetector {
    let templates = [signal(1.0, 2.0), signal(2.0, 2.0)].map(|of| times(1e-9, &of));
    let points = [vec![1.0, 2.0], vec![2.0], vec![1.0], vec![1.0]];
    let (templates, known) = (templates.concat(), NoiseLevel::Known);
    BankDetector::new(&points, templates, &[0.5; 2], vec![], deviations, known).unwrap()
}

// Of the records that set the threshold, as many exceed it as it was made for, whatever the noise; of others about as many.
// Verifies: BNK-053, BNK-054.
#[test]
fn a_threshold_is_judged_on_other_records_than_those_that_set_it() {
    let detector = blind(&[]);
    let mut differ = 0;
    for seed in 1..=5 {
        let set = detector.calibrate(0.05, 4000, seed).unwrap();
        let at = [1.0, 2.0, 1.0, 1.0];
        let power = detector.power(set.eta, at, 4000, seed).unwrap();
        assert!(power.lower < 0.0565 && 0.0441 < power.upper, "{power:?}");
        differ += u32::from(power != set.false_alarm);
    }
    // The same count by chance comes in one of 35 seeds: 1/√(2π · 4000 · 0.05 · 0.95).
    assert!(differ >= 3, "{differ}");
    // Of two points without anything in common one is drawn, and where the noise along the other exceeds η too, each counts half.
    let p = normal::upper_tail(1.6).unwrap();
    let orthogonal = [[3.0, 0.0, 0.0], [0.0, 3.0, 0.0]].concat();
    let two = at_positions(&[0.0, 1.0], orthogonal, &[0.5; 2]);
    for seed in 1..=5 {
        let found = two.rare_false_alarms(0.3, 4000, seed).unwrap().rate;
        let generator = Generator::new(seed, 0);
        let exceeds_too = |trial: &u64| {
            let other = u64::from(uniform(generator.words([0, *trial, 2, 0])[0]) < 0.5);
            generator.normal(*trial, other) >= 1.6
        };
        let both = (0..4000).filter(exceeds_too).count() as f64 / 4000.0;
        differ += u32::from((found - p * (2.0 - both)).abs() > 1e-12);
    }
    assert!(differ >= 7, "{differ}");
}

// Verifies: BNK-053.
#[test]
fn each_deviation_is_calibrated_in_noise_of_its_own() {
    // Deviations without an effect on any signal: the threshold is the largest of 21 that are drawn alike, which is that of the
    // records without deviation in one of 21 seeds, and always if they share their noise.
    let none = vec![vec![0.0; SAMPLES]; 10];
    let eta = |detector: &BankDetector, seed| detector.calibrate(0.05, 400, seed).unwrap().eta;
    let (without, with) = (blind(&[]), blind(&none));
    let above = (1..=5).filter(|&seed| eta(&with, seed) > eta(&without, seed));
    assert!(above.count() >= 3);
}

// Verifies: BNK-054.
#[test]
fn the_power_is_that_of_one_point_and_more_with_its_neighbours() {
    let one = at_positions(&[0.0], signal(0.0, 2.0), &[1.0]);
    let gamma = one.gamma()[0];
    for eta in [-1.0, 0.5, 2.0] {
        let found = one.power(eta, [0.0; 4], 20_000, 1).unwrap();
        let expected = normal::upper_tail(eta / gamma - 0.5 * gamma).unwrap();
        let holds = found.lower < expected && expected < found.upper;
        assert!(holds, "{eta}: {found:?} {expected}");
        assert!(found.upper - found.lower < 0.02);
    }
    let many = detector(6.0, true, NoiseLevel::Known);
    let at = [1.0, 3.0, 1.0, 1.0];
    let own = many.gamma()[2 * 13 + 7];
    let found = many.power(3.0, at, 20_000, 2).unwrap();
    let alone = normal::upper_tail(3.0 / own - 0.5 * own).unwrap();
    assert!(found.lower > alone, "{found:?}");
    assert!(many.power(3.0, at, 0, 2).is_err());
}

// Verifies: BNK-054.
#[test]
fn rare_rates_are_those_of_the_tails_and_of_plain_simulation() {
    // One point: the tail itself, to rounding.
    let one = at_positions(&[0.0], signal(0.0, 2.0), &[1.0]);
    let gamma = one.gamma()[0];
    let eta = gamma * (7.0 - 0.5 * gamma);
    let found = one.rare_false_alarms(eta, 100, 1).unwrap();
    assert!((found.rate / normal::upper_tail(7.0).unwrap() - 1.0).abs() < 1e-10);
    // Two orthogonal points: 1 − (1 − p)², of which 100,000 samples see the share of both at once with 0.5 % of it.
    let (a, b) = ([3.0, 0.0, 0.0], [0.0, 3.0, 0.0]);
    let two = at_positions(&[0.0, 1.0], [a, b].concat(), &[0.5; 2]);
    let p = normal::upper_tail(0.3 / 3.0 + 1.5).unwrap();
    let found = two.rare_false_alarms(0.3, 100_000, 3).unwrap();
    assert_near(found.rate, p * (2.0 - p), 5.0 * found.standard_error);
    assert!((found.union - 2.0 * p).abs() < 1e-15);
    // Many points against plain simulation.
    let many = detector(6.0, true, NoiseLevel::Known);
    let eta = many.calibrate(0.01, 20_000, 4).unwrap().eta;
    let found = many.rare_false_alarms(eta, 20_000, 5).unwrap();
    let plain = alarms(&many, eta, &[0.0; SAMPLES], 6, 20_000);
    let plain = clopper_pearson(plain, 20_000, 0.9999).unwrap();
    let holds = plain.lower < found.rate && found.rate < plain.upper;
    assert!(holds, "{found:?} {plain:?}");
    assert!(found.standard_error < 0.02 * found.rate);
    // A rate that plain simulation cannot reach.
    let rare = many.rare_false_alarms(eta + 25.0, 20_000, 5).unwrap();
    assert!(0.0 < rare.rate && rare.rate < 1e-9, "{rare:?}");
    assert!(rare.standard_error < 0.02 * rare.rate, "{rare:?}");
    let unknown = detector(6.0, true, NoiseLevel::Unknown);
    assert!(unknown.rare_false_alarms(1.0, 100, 1).is_err());
}
