//! The errata of the paper (`spec/errata.md`): each test asserts what is printed and what is true.

use palpate::detect::scan::Scan;
use palpate::detect::{
    MatchedFilter, error_rates, gamma_from_two_afc, neyman_pearson_false_alarm_threshold,
    required_gamma, two_afc,
};
use palpate::force::Force;
use palpate::stats::binomial::clopper_pearson;
use palpate::stats::random::Generator;
use palpate_paper::psychophysics::AnswerTable;

/// Asserts that `value` is `printed` when it is rounded to `unit`.
#[track_caller]
fn assert_prints_as(value: f64, printed: f64, unit: f64) {
    let holds = (value - printed).abs() <= 0.5 * unit;
    assert!(holds, "{value} does not round to {printed}");
}

// Verifies: ERR-001.
#[test]
fn err_001_second_row_of_equation_3() {
    let f0 = [1.0, 2.0, 3.0];
    let f1 = [1.5, 2.25, 3.5];
    let template = [0.5, 0.25, 0.5];
    let zeros = [0.0; 3];
    let sd = Force::new(1.0, 1.0);
    let filter = MatchedFilter::new(Force::new(&template, &zeros), sd).unwrap();
    let statistic = |input: &[f64]| filter.statistic(Force::new(input, &zeros)).unwrap();
    let y = |input: &[f64]| statistic(input).y.lateral;
    // Equation (6) wants ‖F_1x − F_0x‖ = (0.5625/3)^½ in the absence of noise.
    let mean_by_6 = 0.1875_f64.sqrt();
    let without_f0: Vec<f64> = f1.iter().zip(f0).map(|(f1, f0)| f1 - f0).collect();
    // True: (F_1x − F_0x) ∗ h_x.
    assert!((y(&without_f0) - mean_by_6).abs() < 1e-15);
    // Printed: ⟨F_1x, Δ⟩/‖Δ‖ = (3.0625/3)/0.4330.
    assert!((y(&f1) - 3.0625 / 3.0 / mean_by_6).abs() < 1e-14);
    assert!(y(&f1) > 5.0 * mean_by_6, "printed: F_1x ∗ h_x");
}

/// |Y_x(t)| of a noise-free record whose inclusion is at `position`, for a probe at 0.002 m/s sampled every
/// 0.5 s from t = 0 to 10 s, and a template that is a bump of 3 samples.
fn y_at(time: f64, position: f64) -> f64 {
    const SPEED: f64 = 0.002;
    const BUMP: [f64; 3] = [0.2, 0.5, 0.2];
    let mut record = [0.0; 21];
    let centre = (position / SPEED / 0.5).round() as usize;
    record[centre - 1..=centre + 1].copy_from_slice(&BUMP);
    let at = (time / 0.5).round() as usize;
    let mut template = [0.0; 21];
    template[at - 1..=at + 1].copy_from_slice(&BUMP);
    let zeros = [0.0; 21];
    let sd = Force::new(1.0, 1.0);
    let filter = MatchedFilter::new(Force::new(&template, &zeros), sd).unwrap();
    let found = filter.statistic(Force::new(&record, &zeros)).unwrap();
    found.y.lateral
}

/// The root mean square of that bump in 21 samples: 0.33/21.
const BUMP_NORM: f64 = 0.125_356_634_105_601_74;

// Verifies: ERR-002.
#[test]
fn err_002_time_at_which_y_has_law_6() {
    let (position, speed) = (0.012, 0.002);
    // True: t = x/v = 6 s.
    assert!((y_at(position / speed, position) - BUMP_NORM).abs() < 1e-15);
    // v/x = 1/6 s⁻¹ is not a time; read as one it falls where the response is zero.
    let printed = (speed / position / 0.5_f64).round().max(1.0) * 0.5;
    assert_eq!(y_at(printed, position), 0.0);
}

// Verifies: ERR-003.
#[test]
fn err_003_time_at_which_y_is_largest() {
    let (position, speed) = (0.016, 0.002);
    let times = (1..20).map(|sample| f64::from(sample) * 0.5);
    let largest = times.max_by(|a, b| y_at(*a, position).total_cmp(&y_at(*b, position)));
    let largest = largest.unwrap();
    assert_eq!(largest, 8.0, "true: t = x/v");
    assert_eq!(position / speed, 8.0);
    assert!((largest - speed / position).abs() > 7.0, "printed: t = v/x");
}

// Verifies: ERR-004.
#[test]
fn err_004_gamma_of_84_per_cent() {
    assert_prints_as(gamma_from_two_afc(0.84).unwrap(), 1.406, 1e-3);
    assert_prints_as(gamma_from_two_afc(253.0 / 300.0).unwrap(), 1.426, 1e-3);
    let printed = 1.45;
    // No share that rounds to 84 % gives 1.45.
    assert!(gamma_from_two_afc(0.845).unwrap() < printed);
    assert_prints_as(two_afc(printed).unwrap(), 0.847, 1e-3);
}

// Verifies: ERR-005.
#[test]
fn err_005_noise_left_for_the_display() {
    let gamma = required_gamma(0.05, 0.05).unwrap();
    assert_prints_as(gamma, 3.3, 0.1);
    let total = 0.5 / gamma;
    let left = |total: f64| (total * total - 0.01_f64).sqrt();
    assert_prints_as(left(0.15), 0.1118, 1e-4);
    assert_prints_as(left(total), 0.1145, 1e-4);
    // Both print as 0.11, and at 0.11 N the requirement is met with some to spare.
    assert_prints_as(left(0.15), 0.11, 0.01);
    assert_prints_as(left(total), 0.11, 0.01);
    let gamma_at_printed = 0.5 / (0.11_f64 * 0.11 + 0.01).sqrt();
    assert!(error_rates(gamma_at_printed, 0.0).unwrap().miss < 0.05);
}

// Verifies: ERR-006.
#[test]
fn err_006_false_alarms_of_theta_max() {
    // Twenty places a record that do not overlap, so that Θ_max is the largest of twenty
    // independent Θ.
    const PLACES: usize = 20;
    const TRIALS: u64 = 4000;
    let gamma = 3.0;
    let template = [gamma];
    let sd = Force::new(1.0, 1.0);
    let scan = Scan::new(PLACES, Force::new(&template, &[0.0]), sd).unwrap();
    let eta = neyman_pearson_false_alarm_threshold(gamma, 0.05).unwrap();
    let (mut false_alarms, mut misses, mut misses_without_scan) = (0, 0, 0);
    let (mut noise, zeros) = ([0.0; PLACES], [0.0; PLACES]);
    for trial in 0..TRIALS {
        Generator::new(6, 0).normals(trial, 0, &mut noise);
        let maximum = |residual: &[f64]| {
            let residual = Force::new(residual, &zeros);
            scan.maximum(residual, scan.full_shifts()).unwrap().theta
        };
        false_alarms += u32::from(maximum(&noise) >= eta);
        let mut with_inclusion = noise;
        with_inclusion[7] += gamma;
        let there = scan.maximum(Force::new(&with_inclusion, &zeros), 7..=7);
        let there = there.unwrap().theta;
        assert!(maximum(&with_inclusion) >= there);
        misses += u32::from(maximum(&with_inclusion) < eta);
        misses_without_scan += u32::from(there < eta);
    }
    // Printed: "more conservative" — misses do not increase.
    assert!(misses <= misses_without_scan);
    // True as well: false alarms rise from 5 % to 1 − 0.95²⁰ = 64.2 %. Six standard deviations,
    // √(0.23/4000) = 0.0076 each.
    let rate = f64::from(false_alarms) / TRIALS as f64;
    assert!((rate - 0.6415).abs() < 0.046, "{rate}");
}

/// χ²/df of 10 counts of 30 about their common rate, df = 9: 1 on average if subjects differ by
/// chance alone.
fn dispersion(counts: &[(u32, u32)]) -> f64 {
    let counts = counts.iter().map(|&(right, _)| f64::from(right));
    let rate = counts.clone().sum::<f64>() / 300.0;
    let expected = 30.0 * rate;
    let squares = counts.map(|count| (count - expected).powi(2));
    squares.sum::<f64>() / (expected * (1.0 - rate)) / 9.0
}

// Verifies: ERR-007.
#[test]
fn err_007_subjects_vary_more_than_a_binomial() {
    let table = AnswerTable::paper().unwrap();
    let columns = table.conditions().iter();
    let columns: Vec<_> = columns
        .flat_map(|of| [0, 1, 2, 3].map(|j| of.counts(j)))
        .collect();
    let mut dispersions: Vec<f64> = columns.iter().map(|counts| dispersion(counts)).collect();
    // The table is the paper's: its means, in tenths.
    let sum = |counts: &Vec<(u32, u32)>| counts.iter().map(|count| count.0).sum();
    let means: Vec<u32> = columns.iter().map(sum).collect();
    let printed = [288, 275, 247, 200, 292, 277, 253, 189, 268, 228, 229, 174];
    assert_eq!(means, printed);
    // Printed: intervals that presume 1 throughout. The upper 1 % point of χ²₉/9 is 21.666/9 = 2.41
    // (Natrella, Table T-6).
    let significant = dispersions.iter().filter(|&&value| value > 2.41).count();
    // True: half of the 12 columns and more are beyond the 1 % point.
    assert!(significant >= 6, "{dispersions:?}");
    dispersions.sort_by(f64::total_cmp);
    let median = f64::midpoint(dispersions[5], dispersions[6]);
    // An interval is too narrow by the root of the dispersion.
    assert!((1.4..2.3).contains(&median.sqrt()), "{median}");
}

// Verifies: ERR-008.
#[test]
fn err_008_noise_of_the_subjects() {
    let noise_mn = |gamma: f64| 340.0 / gamma;
    assert_prints_as(noise_mn(1.45), 235.0, 5.0);
    for (share, noise) in [(0.84, 242.0), (253.0 / 300.0, 238.0)] {
        assert_prints_as(noise_mn(gamma_from_two_afc(share).unwrap()), noise, 1.0);
    }
}

// Verifies: ERR-009.
#[test]
fn err_009_noise_of_table_2() {
    // Table 2's sources for playback, in mN; printed as 170.
    let explained = (140.0f64 * 140.0 + 93.0 * 93.0 + 0.5 * 0.5).sqrt();
    assert_prints_as(explained, 170.0, 10.0);
    let noise_mn = |share: f64| 340.0 / gamma_from_two_afc(share).unwrap();
    // Pooled: 253 of 300, the largest share that is not rejected gives the least noise.
    let least = noise_mn(clopper_pearson(253, 300, 0.95).unwrap().upper);
    assert!((200.0..205.0).contains(&least), "{least}");
    assert!(explained < least);
    // Student's interval of the ten subjects' shares at 6.6 mm, t₉(0.975) = 2.262 (Natrella, Table T-4).
    let counts = AnswerTable::paper().unwrap().conditions()[1].counts(2);
    let shares = counts.iter().map(|&(right, _)| f64::from(right) / 30.0);
    let shares: Vec<f64> = shares.collect();
    let mean = shares.iter().sum::<f64>() / 10.0;
    let spread: f64 = shares.iter().map(|share| (share - mean).powi(2)).sum();
    let reach = 2.262 * (spread / 9.0 / 10.0).sqrt();
    assert!(noise_mn(mean + reach) < explained && explained < noise_mn(mean - reach));
}
