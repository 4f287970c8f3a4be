//! Expected values: mpmath 1.4.1 at 50 digits, from the equations of the paper in the form of
//! `spec/detector.md` (Y and b formed first, with the weight 1/N), for the exact binary64
//! arguments, rounded once.

use super::*;
use palpate_asserts::{assert_near, assert_ulps, numbers_of};
use std::{format, vec, vec::Vec};
const TEMPLATE: Force<&[f64]> = Force::new(&[0.25, -0.5, 0.125, 0.3], &[0.34, 0.31, 0.22, 0.05]);
const RESIDUAL: Force<&[f64]> = Force::new(&[0.3, -0.4, 0.2, 0.1], &[0.4, 0.1, 0.3, -0.05]);
const NOISE_SD: Force<f64> = Force::new(0.1, 0.235);

fn filter() -> MatchedFilter<'static> {
    MatchedFilter::new(TEMPLATE, NOISE_SD).unwrap()
}

// Verifies: DET-013.
#[test]
fn filter_has_the_expected_signal_and_noise() {
    let filter = filter();
    assert_ulps(filter.b().lateral, 0.3233129289094391, 4.0);
    assert_ulps(filter.b().normal, 0.2562225595063791, 4.0);
    assert_ulps(filter.sigma().lateral, 0.05, 4.0);
    assert_ulps(filter.sigma().normal, 0.1175, 4.0);
    assert_ulps(filter.gamma(), 6.824045193444496, 4.0);
}

// Verifies: DET-015.
#[test]
fn statistic_of_a_residual() {
    let statistic = filter().statistic(RESIDUAL).unwrap();
    assert_ulps(statistic.y.lateral, 0.2551707420989295, 4.0);
    assert_ulps(statistic.y.normal, 0.2249021323923092, 4.0);
    assert_ulps(statistic.theta, 13.890037913082843, 8.0);
}

// Verifies: DET-015, DET-013.
#[test]
fn statistic_of_a_record() {
    let found = theta_of_record(
        Force::new(&[0.1, 0.05, 0.3, 0.0], &[1.7, 1.9, 1.3, 1.6]),
        Force::new(&[0.0, 0.1, 0.2, 0.1], &[1.6, 1.5, 1.4, 1.45]),
        Force::new(&[0.3, -0.2, 0.25, 0.15], &[1.94, 1.8, 1.55, 1.5]),
        Force::new(0.07, 0.2),
    )
    .unwrap();
    // Unrounded differences: without them F_p − F_0 alone would cost dozens of ulps.
    assert_ulps(found.y.lateral, 0.05231143743471868, 4.0);
    assert_ulps(found.y.normal, 0.1525379753095442, 4.0);
    assert_ulps(found.gamma, 6.596976734900338, 4.0);
    assert_ulps(found.theta, -8.913877551020407, 8.0);
}

// Verifies: DET-014.
#[test]
fn long_sums_that_cancel_stay_exact() {
    // r·Δ runs through 1.5, 2^80 + 2^39, 1.5, −2^80 + 2^39: plain summation loses every 1.5.
    const SAMPLES: usize = 1_000_000;
    let big = 2_f64.powi(40);
    let template = [1.0, big, 1.0, big].repeat(SAMPLES / 4);
    let residual = [1.5, big + 0.5, 1.5, -big + 0.5].repeat(SAMPLES / 4);
    let zeros = vec![0.0; SAMPLES];
    // Σ rΔ = Σ(even) 1.5 + Σ(odd) ½·2^40, of terms of 2^80.
    let expected = (SAMPLES / 2) as f64 * 1.5 + (SAMPLES / 2) as f64 * 0.5 * big;
    let sum = crate::stats::compensated::dot(&residual, &template, 1.0).value();
    assert_ulps(sum, expected, 2.0);
    let filter = MatchedFilter::new(Force::new(&template, &zeros), Force::new(1.0, 1.0)).unwrap();
    // r = Δ/2 but for one sample, which is ¼ larger where Δ = 1: Σ rΔ − ½ΣΔ² = ¼, of sums of 2^98.
    let mut halves: Vec<f64> = template.iter().map(|sample| sample / 2.0).collect();
    halves[0] += 0.25;
    let theta = filter.statistic(Force::new(&halves, &zeros)).unwrap().theta;
    assert_eq!(theta, 0.25);
}

/// Whole numbers of up to `bits` bits and either sign.
fn integers(stream: u64, count: usize, bits: u32) -> Vec<i128> {
    let generator = crate::stats::random::Generator::new(14, stream);
    (0..count as u64)
        .map(|i| i128::from(generator.words([i, 0, 9, 9])[0] as i64 >> (63 - bits)))
        .collect()
}

fn floats(integers: &[i128]) -> Vec<f64> {
    // At most 53 bits: exact.
    integers.iter().map(|&i| i as f64).collect()
}

/// Asserts that θ is within the stated bound of Σ rΔ − ½ΣΔ² for whole numbers (r, Δ): 2θ is a whole number too, or its nearest f64.
fn assert_exact(theta: f64, pairs: impl Iterator<Item = (i128, i128)>) {
    // Twice Θ and twice the size, exactly; 10⁶ · 2^101 is below 2^121.
    let (mut twice, mut size) = (0_i128, 0_i128);
    for (r, t) in pairs {
        twice += 2 * r * t - t * t;
        size += 2 * (r * t).abs() + t * t;
    }
    let error = ((2.0 * theta) as i128 - twice).unsigned_abs() as f64;
    let bound = 2.5 * f64::EPSILON * twice.unsigned_abs() as f64 + 1e-19 * size as f64;
    let found = format!("error {error:e}, bound {bound:e}, of {twice:e}");
    assert!(error <= bound + 1.0, "{found}");
}

// Verifies: DET-014.
#[test]
fn a_million_samples_are_within_the_stated_bound_of_exact_arithmetic() {
    const SAMPLES: usize = 1_000_000;
    let template = integers(0, SAMPLES, 50);
    let zeros = vec![0.0; SAMPLES];
    // Plain noise, and a residual Δ/2 + small, where Σ rΔ − ½ΣΔ² cancels to a part in 10⁷ or so.
    let plain = integers(1, SAMPLES, 50);
    let small = integers(2, SAMPLES, 30);
    let half = template.iter().zip(&small).map(|(t, s)| t / 2 + s);
    for residual in [plain, half.collect()] {
        let (t, r) = (floats(&template), floats(&residual));
        let unit = Force::new(1.0, 1.0);
        let filter = MatchedFilter::new(Force::new(&t, &zeros), unit).unwrap();
        let found = filter.statistic(Force::new(&r, &zeros)).unwrap();
        assert_exact(found.theta, residual.into_iter().zip(template.clone()));
    }
}

// Verifies: DET-014.
#[test]
fn rounding_errors_of_one_sign_do_not_add_up() {
    // (2^27+1)² has 55 bits, and every second product of this sum loses a 1: all in the same
    // direction.
    let factor = 134_217_729.0;
    let a = [factor, 1.0 - factor].repeat(50_000);
    let b = vec![factor; 100_000];
    let exact = 50_000.0 * factor;
    assert_eq!(crate::stats::compensated::dot(&a, &b, 1.0).value(), exact);
}

// Verifies: DET-014.
#[test]
fn a_difference_that_would_round_to_nothing_is_kept() {
    // Δ = 2^54 − 1 needs 54 bits and r = 2^53: 2Θ = Δ(2r − Δ) = 2^54 − 1, or 0 if Δ is rounded.
    const TOP: f64 = 9_007_199_254_740_992.0;
    let channels = |x| Force::new(x, &[0.0][..]);
    let unit = Force::new(1.0, 1.0);
    let (observed, f0, f1) = ([1.0], [1.0 - TOP], [TOP]);
    let found = theta_of_record(channels(&observed), channels(&f0), channels(&f1), unit).unwrap();
    assert_ulps(found.theta, TOP, 2.0);
}

// Verifies: DET-014.
#[test]
fn differences_of_forces_are_not_rounded() {
    // Forces of 53 bits and either sign: their differences have 54.
    const SAMPLES: usize = 500;
    let [observed, f0, f1] = [3, 4, 5].map(|stream| integers(stream, SAMPLES, 53));
    let zeros = vec![0.0; SAMPLES];
    let pairs = (0..SAMPLES).map(|i| (observed[i] - f0[i], f1[i] - f0[i]));
    let series = [&observed, &f0, &f1].map(|forces| floats(forces));
    let [observed, f0, f1] = series.each_ref().map(|x| Force::new(&x[..], &zeros[..]));
    let found = theta_of_record(observed, f0, f1, Force::new(1.0, 1.0)).unwrap();
    assert_exact(found.theta, pairs);
}

// Verifies: DET-016.
#[test]
fn units_of_any_size_give_the_same_gamma_and_theta() {
    // Powers of two: every result must be the same to the bit, unless the samples become subnormal.
    for power in [-900, -300, 40, 900] {
        let unit = 2_f64.powi(power);
        let scale = |samples: &[f64]| -> Vec<f64> { samples.iter().map(|s| s * unit).collect() };
        let (tx, ty) = (scale(TEMPLATE.lateral), scale(TEMPLATE.normal));
        let (rx, ry) = (scale(RESIDUAL.lateral), scale(RESIDUAL.normal));
        let filter =
            MatchedFilter::new(Force::new(&tx, &ty), NOISE_SD.map(|sd| sd * unit)).unwrap();
        assert_eq!(filter.gamma(), self::filter().gamma());
        let found = filter.statistic(Force::new(&rx, &ry)).unwrap();
        let expected = self::filter().statistic(RESIDUAL).unwrap();
        assert_eq!(found.theta, expected.theta);
        assert_ulps(found.y.lateral, expected.y.lateral * unit, 1.0);
    }
    // Subnormal template and noise.
    let tiny = f64::from_bits(2);
    let (x, y) = ([tiny, tiny], [tiny, -tiny]);
    let template = Force::new(&x[..], &y);
    let filter = MatchedFilter::new(template, Force::new(tiny, tiny)).unwrap();
    assert_eq!(filter.gamma(), 2.0);
}

// Verifies: DET-015.
#[test]
fn channel_without_signal_contributes_nothing() {
    let filter = MatchedFilter::new(Force::new(&[0.0, 0.0], &[3.0, 4.0]), Force::new(1e-9, 1.0));
    let filter = filter.unwrap();
    let found = filter.statistic(Force::new(&[1e9, -1e9], &[3.0, 4.0]));
    let found = found.unwrap();
    assert_eq!(found.y.lateral, 0.0);
    assert_eq!(found.theta, 12.5);
    assert_eq!(filter.gamma(), 5.0);
}

// Verifies: DET-005, CON-007.
#[test]
fn records_that_cannot_be_judged_are_refused() {
    let samples = [1.0, 2.0];
    let good: Force<&[f64]> = Force::new(&samples, &samples);
    let sd = Force::new(1.0, 1.0);
    fn filter_of(x: &[f64], y: &[f64], sd: Force<f64>) -> DetectError {
        MatchedFilter::new(Force::new(x, y), sd).unwrap_err()
    }
    let empty = DetectError::Empty { what: "template_x" };
    assert_eq!(filter_of(&[], &[], sd), empty);
    let (what, expected, found) = ("template_y", 2, 1);
    assert_eq!(
        filter_of(&samples, &[1.0], sd),
        DetectError::LengthMismatch {
            what,
            expected,
            found
        }
    );
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let bad = [0.0, bad];
        let filter = MatchedFilter::new(good, sd).unwrap();
        let expected = |what| DetectError::NotFinite { what, index: 1 };
        let statistic = |x, y| filter.statistic(Force::new(x, y)).unwrap_err();
        assert_eq!(statistic(&bad, &samples), expected("residual_x"));
        assert_eq!(statistic(&samples, &bad), expected("residual_y"));
        assert_eq!(filter_of(&samples, &bad, sd), expected("template_y"));
        for position in 0..6 {
            let mut series = [&samples[..]; 6];
            series[position] = &bad;
            let [ox, oy, ax, ay, bx, by] = series;
            let [record, f0, f1] = [(ox, oy), (ax, ay), (bx, by)].map(|(x, y)| Force::new(x, y));
            let what = ["observed_x", "observed_y", "f0_x", "f0_y", "f1_x", "f1_y"][position];
            let found = theta_of_record(record, f0, f1, sd);
            assert_eq!(found.unwrap_err(), expected(what));
        }
    }
    // The first list says how long all are.
    for (position, what) in ["f0_x", "f0_y", "f1_x", "f1_y"].into_iter().enumerate() {
        for other in [&[1.0][..], &[1.0, 2.0, 3.0]] {
            let mut series = [&samples[..]; 4];
            series[position] = other;
            let [ax, ay, bx, by] = series;
            let found = theta_of_record(good, Force::new(ax, ay), Force::new(bx, by), sd);
            let (expected, found_length) = (2, other.len());
            let mismatch = DetectError::LengthMismatch {
                what,
                expected,
                found: found_length,
            };
            assert_eq!(found.unwrap_err(), mismatch);
        }
    }
    for bad in [0.0, -0.0, -1.0, f64::NAN, f64::INFINITY] {
        let found = filter_of(&samples, &samples, Force::new(1.0, bad));
        assert!(matches!(
            found,
            DetectError::OutOfRange {
                what: "noise_sd_y",
                ..
            }
        ));
    }
    let found = filter_of(&[1e300], &[0.0], Force::new(1e-300, 1.0));
    assert_eq!(found, DetectError::Overflow { what: "gamma" });
}

const fn costs(c00: f64, c01: f64, c10: f64, c11: f64) -> Costs {
    Costs { c00, c01, c10, c11 }
}

const ZERO_ONE: Costs = costs(0.0, 1.0, 1.0, 0.0);

// Verifies: DET-022.
#[test]
fn threshold_of_largest_posterior() {
    for [prior, expected] in numbers_of("tables/detect.txt", "threshold by the prior") {
        assert_ulps(map_threshold(prior).unwrap(), expected, 4.0);
    }
}

// Verifies: DET-022.
#[test]
fn threshold_of_least_cost() {
    // DET-001.
    let eta = bayes_threshold(0.02, costs(1.0, 500.0, 20.0, 5.0)).unwrap();
    assert_near(eta, 0.6317015147083768, 5.0 * f64::EPSILON);
    // ln of 0.99 · 1/(0.01 · 100): the logarithms of priors and costs, ±4.6, nearly cancel.
    let eta = bayes_threshold(0.01, costs(0.0, 100.0, 1.0, 0.0)).unwrap();
    assert_near(eta, -0.010050335853501463, 4.02 * f64::EPSILON);
    assert_eq!(bayes_threshold(0.02, ZERO_ONE), map_threshold(0.02));
}

// Verifies: DET-022.
#[test]
fn a_bayes_threshold_is_accurate_for_costs_almost_equal_and_far_apart() {
    let threshold =
        |false_alarm, miss| bayes_threshold(0.5, costs(0.0, miss, false_alarm, 0.0)).unwrap();
    // ln(1 + 2⁻⁴⁰) = 2⁻⁴⁰ − 2⁻⁸¹ + …; the difference of two logarithms would be off by 10⁻¹⁵.
    let almost = 1024.0 * (1.0 + f64::powi(2.0, -40));
    assert_near(threshold(almost, 1024.0), 9.094947017725146e-13, 1e-27);
    assert_near(threshold(1024.0, almost), -9.094947017725146e-13, 1e-27);
    // ± 310 ln 10, where the quotient overflows; 10⁻³¹⁰ is subnormal, within 3 · 10⁻¹⁵ of itself.
    assert_near(threshold(1.0, 1e-310), 713.8013788281543, 1e-12);
    assert_near(threshold(1e-310, 1.0), -713.8013788281543, 1e-12);
}

// Verifies: DET-022, DET-025.
#[test]
fn thresholds_of_neyman_and_pearson() {
    let by_miss = neyman_pearson_miss_threshold(2.5, 0.05).unwrap();
    assert_ulps(by_miss, -0.9871340673786817, 8.0);
    let by_false_alarm = neyman_pearson_false_alarm_threshold(2.5, 0.001).unwrap();
    assert_ulps(by_false_alarm, 4.600580765419534, 8.0);
}

// Verifies: DET-026.
#[test]
fn rates_of_error_at_a_threshold() {
    for [gamma, eta, false_alarm, miss] in numbers_of("tables/detect.txt", "rates") {
        let rates = error_rates(gamma, eta).unwrap();
        // Two roundings of z = η/γ ± γ/2 change Φ(−z) by at most 2u z² of itself.
        let ulps = |z: f64| 4.0 + 4.0 * z * z;
        let (middle, half) = (eta / gamma, gamma / 2.0);
        assert_ulps(rates.false_alarm, false_alarm, ulps(middle + half));
        assert_ulps(rates.miss, miss, ulps(middle - half));
    }
    // Θ ≡ 0 decides by equation (9) alone.
    for [gamma, eta, false_alarm, miss] in numbers_of("tables/detect.txt", "rates without doubt") {
        let expected = ErrorRates { false_alarm, miss };
        assert_eq!(error_rates(gamma, eta), Ok(expected), "{gamma} {eta}");
    }
}

// Verifies: DET-027.
#[test]
fn operating_characteristic() {
    for [gamma, false_alarm, miss] in numbers_of("tables/detect.txt", "operating characteristic") {
        assert_ulps(roc_miss(gamma, false_alarm).unwrap(), miss, 16.0);
    }
    assert_eq!((roc_miss(2.0, 0.0), roc_miss(2.0, 1.0)), (Ok(1.0), Ok(0.0)));
    for [gamma, expected] in numbers_of("tables/detect.txt", "forced choice") {
        assert_ulps(two_afc(gamma).unwrap(), expected, 2.0);
    }
}

// Verifies: DET-027.
#[test]
fn signal_to_noise_ratio_for_given_rates() {
    for (rate, gamma) in [(0.05, 3.2897072539029453), (0.001, 4.7350859331192865)] {
        assert_ulps(required_gamma(rate, 0.05).unwrap(), gamma, 4.0);
    }
    assert_eq!(required_gamma(0.5, 0.5), Ok(0.0));
    assert_eq!(required_gamma(0.9, 0.5), Ok(0.0));
    for [p, expected] in numbers_of("tables/detect.txt", "gamma of a share") {
        assert_ulps(gamma_from_two_afc(p).unwrap(), expected, 5.0);
    }
}

// Verifies: DET-021.
#[test]
fn posterior_probability_by_bayes() {
    assert_ulps(posterior(1.5, 0.01).unwrap(), 0.0433090057825766, 32.0);
    assert_ulps(posterior(-30.0, 0.5).unwrap(), 9.357622968839299e-14, 8.0);
    assert_ulps(posterior(0.0, 0.3).unwrap(), 0.3, 4.0);
    assert_eq!(posterior(1e300, 0.2), Ok(1.0));
    assert_eq!(posterior(-1e300, 0.2), Ok(0.0));
}

// Verifies: DET-020.
#[test]
fn the_threshold_itself_decides_for_an_inclusion() {
    assert_eq!(decide(1.5, 1.5), Ok(Decision::Inclusion));
    assert_eq!(decide(1.5_f64.next_down(), 1.5), Ok(Decision::NoInclusion));
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        assert!(decide(bad, 0.0).is_err() && decide(0.0, bad).is_err());
    }
}

// Verifies: DET-005, DET-008.
#[test]
fn questions_without_a_finite_answer_are_refused() {
    for p in [0.0, 1.0, -0.1, 1.5, f64::NAN] {
        assert!(map_threshold(p).is_err() && posterior(0.0, p).is_err());
        assert!(bayes_threshold(p, ZERO_ONE).is_err());
        assert!(neyman_pearson_miss_threshold(1.0, p).is_err());
        assert!(neyman_pearson_false_alarm_threshold(1.0, p).is_err());
        assert!(required_gamma(p, 0.1).is_err() && required_gamma(0.1, p).is_err());
        assert!(gamma_from_two_afc(p).is_err());
        if p != 0.0 && p != 1.0 {
            assert!(roc_miss(1.0, p).is_err());
        }
    }
    for gamma in [-1.0, f64::NAN, f64::INFINITY] {
        assert!(error_rates(gamma, 0.0).is_err() && roc_miss(gamma, 0.5).is_err());
        assert!(two_afc(gamma).is_err());
        assert!(neyman_pearson_miss_threshold(gamma, 0.1).is_err());
        assert!(neyman_pearson_false_alarm_threshold(gamma, 0.1).is_err());
    }
    assert!(error_rates(1.0, f64::NAN).is_err() && posterior(f64::NAN, 0.5).is_err());
    let without_signal = neyman_pearson_false_alarm_threshold(0.0, 0.1);
    assert_eq!(without_signal, Err(DetectError::NoSignal));
    assert_eq!(neyman_pearson_miss_threshold(0.0, 0.1), Ok(0.0));
    assert!(neyman_pearson_miss_threshold(1e200, 0.1).is_err());
    let (inf, nan) = (f64::INFINITY, f64::NAN);
    for (c01, c10) in [(0.0, 1.0), (1.0, 0.0), (-1.0, 1.0), (inf, 1.0), (1.0, nan)] {
        assert!(bayes_threshold(0.5, costs(0.0, c01, c10, 0.0)).is_err());
    }
}

// Verifies: DET-009.
#[test]
fn what_is_refused_is_never_a_decision() {
    let decided = |sd, eta| {
        decide(
            theta_of_record(RESIDUAL, RESIDUAL, TEMPLATE, sd)?.theta,
            eta,
        )
    };
    assert!(decided(NOISE_SD, 0.0).is_ok());
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        assert!(decided(Force::new(bad, 1.0), 0.0).is_err() && decided(NOISE_SD, bad).is_err());
    }
}

// Verifies: DET-005.
#[test]
fn an_error_says_what_where_and_what_would_be_right() {
    use std::string::ToString;
    let message = decide(f64::NAN, 0.0).unwrap_err().to_string();
    assert!(message.contains("theta") && message.contains("NaN") && message.contains("finite"));
}
