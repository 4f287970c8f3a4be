//! Wald's rates and mean numbers of samples, by simulation.

use super::*;
use crate::detect::{decide, neyman_pearson_false_alarm_threshold, required_gamma};
use crate::stats::{Bounds, binomial::clopper_pearson};

/// Records of each hypothesis.
const TRIALS: u64 = 100_000;
/// Samples of the fixed-length test with the same rates.
const FIXED: usize = 100;
const RATE: f64 = 0.01;

/// What ends a record: Ĥ for the evidence after a number of samples, if the test is over.
type Test<'a> = &'a dyn Fn(Evidence, usize) -> Option<Decision>;

/// How many of the records of `truth` were answered "inclusion", how many "no inclusion", and their mean number of samples. The
/// signal changes its sign from sample to sample, beside an unknown offset.
fn simulated(truth: Decision, test: Test<'_>) -> ([u64; 2], f64) {
    let size = required_gamma(RATE, RATE).unwrap() / (FIXED as f64).sqrt();
    let generator = Generator::new(20_261_126, u64::from(truth == Decision::Inclusion));
    let (mut answers, mut samples, mut noise) = ([0; 2], 0, [0.0; 64]);
    for trial in 0..TRIALS {
        let mut found = Sequential::new([0.0; memory(1, 1)], 1, 1).unwrap();
        let answer = (0..).find_map(|sample: usize| {
            if sample.is_multiple_of(noise.len()) {
                generator.normals(trial, sample as u64, &mut noise);
            }
            let signal = if sample.is_multiple_of(2) {
                size
            } else {
                -size
            };
            let there = if truth == Decision::Inclusion {
                signal
            } else {
                0.0
            };
            found
                .push(
                    40.0 + there + noise[sample % noise.len()],
                    &[1.0],
                    &[signal],
                )
                .unwrap();
            test(found.evidence().next().unwrap(), sample + 1)
        });
        answers[usize::from(answer == Some(Decision::NoInclusion))] += 1;
        samples += found.rows();
    }
    (answers, samples as f64 / TRIALS as f64)
}

fn interval(count: u64) -> Bounds {
    clopper_pearson(count, TRIALS, 0.99).unwrap()
}

// With overshoot the rates are α e^(−0.583 γ_1) = 0.76 %, 27 records of 100,000 less or more: their interval ends below 1 % but for a
// probability of 10⁻¹⁰. A θ without the ½, bounds for 1.5 % or a noise off by 10 % end beyond it.
// Verifies: SEQ-001, SEQ-010, SEQ-011.
#[test]
fn both_rates_are_kept_with_less_than_half_of_the_samples() {
    let wald = Wald::new(RATE, RATE).unwrap();
    let test = |evidence: Evidence, _| wald.decide(evidence.theta()).unwrap();
    let gamma_squared = required_gamma(RATE, RATE).unwrap().powi(2) / FIXED as f64;
    for (truth, wrong) in [(Decision::NoInclusion, 0), (Decision::Inclusion, 1)] {
        let (answers, mean) = simulated(truth, &test);
        assert!(
            interval(answers[wrong]).upper <= RATE,
            "{truth:?}: {answers:?}"
        );
        // Siegmund's mean: the bounds lie 0.583 γ_1 further out. Within five standard deviations, 0.35, and what is of the order of the
        // overshoot's variance, 0.3.
        let expected = wald.mean_gamma_squared(truth);
        let further = 1.0 + 0.583 * gamma_squared.sqrt() / wald.upper();
        assert_near(mean, further * expected / gamma_squared, 0.7);
        assert!(
            mean >= expected / gamma_squared && mean <= 0.6 * FIXED as f64,
            "{mean}"
        );
    }
}

// Verifies: SEQ-012.
#[test]
fn a_record_that_ends_early_is_decided_with_the_stated_rates() {
    let wald = Wald::new(RATE, RATE).unwrap();
    let end = 30;
    let test = |evidence: Evidence, samples| {
        let theta = evidence.theta();
        let at_end = (samples == end).then(|| decide(theta, 0.0).unwrap());
        wald.decide(theta).unwrap().or(at_end)
    };
    let gamma = required_gamma(RATE, RATE).unwrap() * (end as f64 / FIXED as f64).sqrt();
    let stated = wald.truncated(gamma, 0.0).unwrap();
    let (answers, _) = simulated(Decision::NoInclusion, &test);
    let found = interval(answers[0]);
    // Ten times what the test alone would be allowed: a rate that forgets the end is seen.
    assert!(
        found.upper <= stated.false_alarm && found.lower > 9.0 * RATE,
        "{found:?} {stated:?}"
    );
    let (answers, _) = simulated(Decision::Inclusion, &test);
    assert!(interval(answers[1]).upper <= stated.miss);
}

// The reason for all of it.
// Verifies: SEQ-010.
#[test]
fn who_looks_again_and_again_by_the_fixed_threshold_raises_false_alarms() {
    let test = |evidence: Evidence, samples: usize| {
        let gamma = evidence.gamma_squared.sqrt();
        let eta = neyman_pearson_false_alarm_threshold(gamma, RATE).unwrap_or(f64::MAX);
        let decision = decide(evidence.theta(), eta).unwrap();
        let is_over = decision == Decision::Inclusion || samples == FIXED;
        is_over.then_some(decision)
    };
    let (answers, _) = simulated(Decision::NoInclusion, &test);
    assert!(interval(answers[0]).lower > 5.0 * RATE, "{answers:?}");
}
