//! Expected values: mpmath at 40 digits, by Gram–Schmidt in exact arithmetic, the tails of t by the incomplete beta function.
use std::vec;
use std::vec::Vec;

use proptest::prelude::*;

use super::*;
use crate::detect::error_rates;
use palpate_asserts::assert_near;

const SAMPLES: usize = 12;

/// A constant, a line and something else; the template and the record, all without rounding.
fn signals() -> [Vec<f64>; 5] {
    let series = |of: &dyn Fn(usize) -> f64| (0..SAMPLES).map(of).collect();
    [
        series(&|_| 1.0),
        series(&|i| (2.0 * i as f64 - 11.0) / 8.0),
        series(&|i| (i * i * 5 % 7) as f64 / 4.0),
        series(&|i| (i * 3 % 5) as f64 - 0.5),
        series(&|i| ((i * i * 7 + 3 * i) % 11) as f64 / 4.0 - 1.0),
    ]
}

/// T, γ and the residual of a record beside the first three signals.
fn statistic(record: &[f64]) -> SubspaceStatistic {
    let [a, b, c, mut template, _] = signals();
    let mut nuisances = [a, b, c].concat();
    let nuisances = Nuisances::new(&mut nuisances, SAMPLES).unwrap();
    let detector = SubspaceDetector::new(nuisances, &mut template).unwrap();
    assert!((detector.gamma_nominal() - 7.0).abs() < 1e-14);
    detector.statistic(&mut record.to_vec()).unwrap()
}

fn close(found: f64, expected: f64) {
    assert_near(found / expected, 1.0, 1e-12);
}

// Verifies: NUI-001, NUI-003, NUI-007, NUI-008.
#[test]
fn the_statistic_is_that_of_the_complement() {
    let [.., record] = signals();
    let found = statistic(&record);
    close(found.gamma, 4.816937762021007);
    close(found.t, 1.6478011024129822);
    close(found.residual, 5.174391403455745);
    assert_eq!(found.degrees, 8.0);
    close(
        found.test(NoiseLevel::Known, 0.0).unwrap().theta(),
        -3.6640893470790377,
    );
    let test = found.test(NoiseLevel::Unknown, 0.25).unwrap();
    close(test.t, 2.048897083331049);
    close(test.gamma, 5.989442364578842);
    close(test.theta(), -2.9561243619120834);
    close(test.bias, 0.25 * test.t / found.t);
}

/// The T that a threshold is at.
fn at(threshold: Threshold) -> f64 {
    match threshold {
        Threshold::At(t) => t,
        _ => panic!("{threshold:?}"),
    }
}

/// The test of that record with a bias of ¼ in its unit.
fn test() -> SubspaceTest {
    let [.., record] = signals();
    let test = statistic(&record).test(NoiseLevel::Unknown, 0.0).unwrap();
    SubspaceTest { bias: 0.25, ..test }
}

// Verifies: NUI-014, NUI-012, NUI-013.
#[test]
fn thresholds_and_rates_of_an_unknown_level() {
    let test = test();
    for (eta, t) in [
        (0.0, 2.994721182289421),
        (1.0, 3.3100518868976634),
        (-1.0, 2.6793904776811788),
    ] {
        let found = at(test.bayes_threshold(eta).unwrap());
        close(found, t);
        let there = SubspaceTest { t: found, ..test };
        assert!((there.theta() - eta).abs() < 1e-12);
    }
    for (t, false_alarm, miss) in [
        (1.0, 0.23736559246295239, 0.0007325034196545483),
        (1.5, 0.12331293710769659, 0.001419812984631771),
        (3.0, 0.012529462164952026, 0.012735590882466098),
    ] {
        let found = test.rates(Threshold::At(t)).unwrap();
        close(found.false_alarm, false_alarm);
        close(found.miss, miss);
    }
    close(
        test.false_alarm_threshold(0.05).unwrap(),
        2.1095480375308986,
    );
    close(test.miss_threshold(0.05).unwrap(), 3.8798943270479436);
}

// Verifies: NUI-007, NUI-010.
#[test]
fn theta_of_a_record_that_fits_without_an_inclusion_all_but_exactly() {
    let test = SubspaceTest {
        t: 0.0,
        gamma: 1e12,
        ..test()
    };
    // 4.5 ln [8/(8 + 10²⁴)].
    close(test.theta(), -239.32170310579767);
}

// Verifies: NUI-010.
#[test]
fn a_theta_that_no_number_can_hold_is_refused() {
    // T and γ are 1e160, whose squares are none.
    let mut template = [1e150, 0.0, 0.0];
    let nuisances = Nuisances::new(&mut [], 3).unwrap();
    let detector = SubspaceDetector::new(nuisances, &mut template).unwrap();
    let statistic = detector.statistic(&mut [1e150, 1e-10, 0.0]).unwrap();
    let found = statistic.test(NoiseLevel::Unknown, 0.0);
    assert!(found.is_err(), "{found:?}");
}

// Verifies: NUI-012, NUI-014.
#[test]
fn too_few_samples_cannot_make_up_for_any_prior() {
    let test = test();
    // c γ² = ν (c − 1)² has a root at c ≈ γ²/ν + 2.
    assert_eq!(test.bayes_threshold(9.0), Ok(Threshold::Never));
    assert_eq!(test.bayes_threshold(-9.0), Ok(Threshold::Always));
    let never = ErrorRates {
        false_alarm: 0.0,
        miss: 1.0,
    };
    assert_eq!(test.rates(Threshold::Never).unwrap(), never);
    let always = ErrorRates {
        false_alarm: 1.0,
        miss: 0.0,
    };
    assert_eq!(test.rates(Threshold::Always).unwrap(), always);
    assert_eq!(Threshold::Always.decide(-1e300), Decision::Inclusion);
    assert_eq!(Threshold::Never.decide(1e300), Decision::NoInclusion);
}

// Verifies: NUI-007, NUI-013, NUI-014.
#[test]
fn with_a_known_level_and_no_bias_the_laws_are_those_of_theta() {
    let test = SubspaceTest {
        t: 1.0,
        gamma: 3.0,
        degrees: None,
        bias: 0.0,
    };
    for eta in [-4.0, 0.0, 1.5, 7.0] {
        let found = test.rates(test.bayes_threshold(eta).unwrap()).unwrap();
        let expected = error_rates(3.0, eta).unwrap();
        close(found.false_alarm, expected.false_alarm);
        close(found.miss, expected.miss);
    }
    let t = test.false_alarm_threshold(0.01).unwrap();
    close(test.rates(Threshold::At(t)).unwrap().false_alarm, 0.01);
    let t = test.miss_threshold(0.01).unwrap();
    close(test.rates(Threshold::At(t)).unwrap().miss, 0.01);
}

// Verifies: NUI-001, NUI-004.
#[test]
fn dependent_signals_count_once() {
    let [a, b, ..] = signals();
    let sum: Vec<f64> = std::iter::zip(&a, &b)
        .map(|(a, b)| 1e6 * a - 1e-3 * b)
        .collect();
    let zero = vec![0.0; SAMPLES];
    let mut all = [a.clone(), zero, b, sum.clone(), a].concat();
    let nuisances = Nuisances::new(&mut all, SAMPLES).unwrap();
    assert_eq!(nuisances.rank().get(), 2);
    let mut template = sum;
    let refused = SubspaceDetector::new(nuisances, &mut template);
    assert_eq!(refused.err(), Some(DetectError::NoSignal));
    // Whatever is left of a vector whose square no number holds is not nothing.
    let refused = nuisances.project(&mut [1e200; SAMPLES]);
    assert_eq!(refused, Err(DetectError::Overflow { what: "gamma" }));
}

// Verifies: NUI-010.
#[test]
fn refusals() {
    let none = || Nuisances::new(&mut [], 2).unwrap();
    assert!(Nuisances::new(&mut [], 0).is_err());
    assert!(Nuisances::new(&mut [1.0; 5], 2).is_err());
    assert!(Nuisances::new(&mut [1.0, f64::NAN], 2).is_err());
    assert!(SubspaceDetector::new(none(), &mut [1.0]).is_err());
    assert!(SubspaceDetector::new(none(), &mut [1.0, f64::INFINITY]).is_err());
    let mut template = [1.0, 2.0];
    // A sample for the nuisance, one for the template, none for the noise.
    let mut constant = [1.0; 2];
    let full = Nuisances::new(&mut constant, 2).unwrap();
    assert!(SubspaceDetector::new(full, &mut template).is_err());
    let detector = SubspaceDetector::new(none(), &mut template).unwrap();
    assert!(detector.statistic(&mut [1.0]).is_err());
    assert!(detector.statistic(&mut [f64::NAN, 1.0]).is_err());
    assert!(detector.statistic(&mut [f64::MAX; 2]).is_err());
    let exact = detector.statistic(&mut [1.0, 2.0]).unwrap();
    assert!(exact.test(NoiseLevel::Unknown, 0.0).is_err());
    assert!(exact.test(NoiseLevel::Known, -1.0).is_err());
    let test = exact.test(NoiseLevel::Known, 0.0).unwrap();
    assert!(test.rates(Threshold::At(f64::NAN)).is_err());
    assert!(test.bayes_threshold(f64::INFINITY).is_err());
    assert!(test.miss_threshold(1.0).is_err());
}

proptest! {
    // Verifies: NUI-001, NUI-003.
    #[test]
    fn only_the_space_of_the_nuisances_counts(
        record in prop::collection::vec(-4.0..4.0, SAMPLES),
        order in Just([0, 1, 2, 0, 1, 2]).prop_shuffle(),
        scales in prop::array::uniform6(0.01..100.0_f64),
        signs in prop::array::uniform6(prop::bool::ANY),
    ) {
        let [a, b, c, template, _] = signals();
        let each = [a, b, c];
        let all = (0..6).flat_map(|at| {
            let factor = if signs[at] { scales[at] } else { -scales[at] };
            each[order[at]].iter().map(move |value| factor * value)
        });
        let (mut all, mut template) = (all.collect::<Vec<f64>>(), template);
        let nuisances = Nuisances::new(&mut all, SAMPLES).unwrap();
        let detector = SubspaceDetector::new(nuisances, &mut template).unwrap();
        let (found, expected) = (detector.statistic(&mut record.clone()).unwrap(), statistic(&record));
        prop_assert_eq!((nuisances.rank().get(), found.degrees), (3, expected.degrees));
        // Sums of 12 products of numbers up to 4, through three projections.
        for (found, expected) in [(found.t, expected.t), (found.gamma, expected.gamma), (found.residual, expected.residual)] {
            prop_assert!((found - expected).abs() < 1e-11, "{} {}", found, expected);
        }
    }

    // Verifies: NUI-003.
    #[test]
    fn no_nuisance_changes_the_statistic(
        record in prop::collection::vec(-4.0..4.0, SAMPLES),
        amplitudes in prop::array::uniform3(-1e3..1e3),
    ) {
        let nuisances = &signals()[..3];
        let more = |sample: usize| -> f64 {
            std::iter::zip(nuisances, amplitudes).map(|(nuisance, amplitude)| amplitude * nuisance[sample]).sum()
        };
        let disturbed: Vec<f64> = (0..SAMPLES).map(|sample| record[sample] + more(sample)).collect();
        let (found, expected) = (statistic(&disturbed), statistic(&record));
        // Sums of 12 products of numbers up to 4 · 10³, each rounded by 10⁻¹⁶ of itself.
        prop_assert!((found.t - expected.t).abs() < 1e-10);
        // Of their squares: what is left is a difference of numbers up to 2 · 10⁸.
        prop_assert!((found.residual - expected.residual).abs() < 1e-5);
    }
}
