//! Expected values: closed forms, and mpmath 1.4.1 at 40 digits for Owen's T by quadrature.

use super::*;
use crate::stats::tests::{assert_near, assert_ulps, numbers};
extern crate std;
use std::vec::Vec;

const UNIT: Force<f64> = Force::new(1.0, 1.0);

fn bound(template: &[f64], samples: usize, count: usize, eta: f64) -> f64 {
    let zeros: Vec<f64> = template.iter().map(|_| 0.0).collect();
    let scan = Scan::new(samples, Force::new(template, &zeros), UNIT).unwrap();
    let (mut gamma, mut angle) = ([0.0; 32], [0.0; 32]);
    let law = MaximumLaw::new(&scan, 0, &mut gamma[..count], &mut angle[..count]).unwrap();
    law.false_alarm_bound(eta).unwrap()
}

/// Template (4, 2): γ² = 20 and correlation 8/20. η, exact, Rice or the union if less, union.
const TWO_SHIFTS: &str = "
-5.0 0.2231260551744205 0.23053468050979498 0.2635524772829727
0.0 0.024118759567461175 0.025347318677468263 0.025347318677468263
5.0 0.0007885616214067944 0.0007962301575908116 0.0007962301575908116
";

// Verifies: DET-055, DET-056, DET-057.
#[test]
fn two_shifts_have_an_exact_probability_below_the_bound() {
    for [eta, exact, rice, union] in numbers(TWO_SHIFTS) {
        let bound = bound(&[4.0, 2.0], 3, 2, eta);
        // The bound is rounded up by a part in 10⁹.
        assert_near(bound, rice, 2e-9 * rice);
        assert!(bound > exact && bound <= union * (1.0 + 2e-9));
    }
}

// Verifies: DET-057.
#[test]
fn bound_is_all_but_exact_for_a_smooth_template() {
    let bump = |i| libm::exp(-f64::from((i - 10) * (i - 10)) / 50.0);
    let template: Vec<f64> = (0..21).map(bump).collect();
    for (eta, exact, rice) in [
        (0.0, 0.07661734145065467, 0.07663454113807089),
        (2.0, 0.017767753579670687, 0.017778378599135128),
    ] {
        let bound = bound(&template, 22, 2, eta);
        assert_near(bound, rice, 2e-9 * rice);
        assert!(bound > exact && bound < 1.001 * exact);
    }
}

// Verifies: DET-056.
#[test]
fn independent_shifts_have_an_exact_probability_below_the_bound() {
    // A template of one sample: K independent Θ. Exact: 1 − Φ(u)^K with u = η/γ + γ/2.
    for eta in [-1.0, 0.5, 2.0, 6.0] {
        let bound = bound(&[2.0], 20, 20, eta);
        let tail = lower_tail(-(eta / 2.0 + 1.0));
        let exact = 1.0 - libm::pow(1.0 - tail, 20.0);
        assert!(bound >= exact, "{eta}: {exact} {bound}");
        assert!(bound <= (20.0 * tail).min(1.0) * (1.0 + 2e-9));
    }
}

// Verifies: DET-058.
#[test]
fn threshold_keeps_the_promise_and_is_the_least_that_does() {
    let template = [0.5, 1.0, 2.0, 1.0, 0.5];
    let scan = Scan::new(20, Force::new(&template, &template), UNIT).unwrap();
    let (mut gamma, mut angle) = ([0.0; 24], [0.0; 24]);
    let law = MaximumLaw::new(&scan, -4, &mut gamma, &mut angle).unwrap();
    for rate in [0.3, 0.05, 1e-3, 1e-9] {
        let eta = law.threshold(rate).unwrap();
        assert!(law.false_alarm_bound(eta).unwrap() <= rate);
        assert!(law.false_alarm_bound(eta - 1e-8).unwrap() > rate);
    }
    for rate in [0.0, 1.0, f64::NAN] {
        assert!(law.threshold(rate).is_err());
    }
    assert!(
        law.false_alarm_bound(f64::INFINITY).is_err() && law.false_alarm_bound(f64::NAN).is_err()
    );
    let nothing = Scan::new(5, Force::new(&[0.0], &[0.0]), UNIT).unwrap();
    assert!(MaximumLaw::new(&nothing, 0, &mut gamma, &mut angle).is_err());
    let law = MaximumLaw::new(&nothing, 0, &mut gamma[..5], &mut angle[..5]).unwrap();
    assert_eq!(law.threshold(0.1), Err(DetectError::NoSignal));
    assert!(MaximumLaw::new(&nothing, 0, &mut [], &mut []).is_err());
    assert!(MaximumLaw::new(&nothing, 0, &mut gamma[..5], &mut angle[..3]).is_err());
}

// Verifies: DET-060, DET-061.
#[test]
fn position_bound_of_a_straight_slope() {
    // 100 samples of slope 3 N/m in noise of 0.6 N: information 100 · 25, so 1/50 m.
    let flat = [0.0; 100];
    let mut slopes = [0.0; 100];
    let line: Vec<f64> = (0..100).map(|i| 1.0 + 3.0 * 0.25 * f64::from(i)).collect();
    slope(&line, 0.25, &mut slopes).unwrap();
    assert_eq!(slopes, [3.0; 100]);
    let sd = Force::new(0.1, 0.6);
    let bound = position_bound(Force::new(&flat, &slopes), sd).unwrap();
    assert_ulps(bound, 0.02, 4.0);
    let none = Force::new(&flat[..], &flat[..]);
    assert_eq!(position_bound(none, sd), Err(DetectError::NoSignal));
    // A parabola: the middle is exact, an end is half a step off.
    slope(&[0.0, 1.0, 4.0, 9.0], 1.0, &mut slopes[..4]).unwrap();
    assert_eq!(slopes[..4], [1.0, 2.0, 4.0, 5.0]);
    assert!(slope(&[1.0], 1.0, &mut [0.0]).is_err() && slope(&[], 1.0, &mut []).is_err());
    assert!(slope(&line, 0.0, &mut slopes).is_err());
    assert!(slope(&line, 1.0, &mut slopes[..9]).is_err());
    assert!(slope(&[0.0, f64::NAN], 1.0, &mut slopes[..2]).is_err());
    assert!(slope(&[-f64::MAX, f64::MAX], 1.0, &mut slopes[..2]).is_err());
}

// Verifies: DET-056, DET-057.
#[test]
fn a_shift_without_signal_exceeds_what_is_not_above_zero() {
    // Template (0, 1) one sample before the record's end: nothing overlaps, so Θ = 0 for certain.
    let template = [0.0, 1.0];
    let channels = Force::new(&template[..], &[0.0, 0.0]);
    let scan = Scan::new(3, channels, UNIT).unwrap();
    let (mut gamma, mut angle) = ([0.0; 1], [0.0; 1]);
    let law = MaximumLaw::new(&scan, 2, &mut gamma, &mut angle).unwrap();
    for (eta, expected) in [(-1.0, 1.0), (0.0, 1.0), (1e-300, 0.0), (1.0, 0.0)] {
        assert_eq!(law.false_alarm_bound(eta), Ok(expected), "{eta}");
    }
}

// Verifies: DET-057.
#[test]
fn bounds_are_rounded_up_by_a_part_in_ten_to_the_nine() {
    // One shift: the bound is the tail Φ(−½) at η = 0 for γ = 1; mpmath, 20 digits.
    let tail = 0.308_537_538_725_986_9;
    let excess = bound(&[1.0], 1, 1, 0.0) / tail - 1.0;
    assert!((0.5e-9..1.5e-9).contains(&excess), "{excess}");
}

// Verifies: DET-058.
#[test]
fn the_threshold_is_found_wherever_it_lies() {
    // One shift has the exact law N(−γ²/2, γ²): η = −γ²/2 + γΦ⁻¹(1 − α).
    for gamma in [1e-3, 1.0, 30.0] {
        for (rate, quantile) in [
            (1e-12, 7.034_483_825_301_131),
            (0.5, 0.0),
            (0.999_999_999, -5.997_807_015_007_686_7),
        ] {
            let template = [gamma];
            let channels = Force::new(&template[..], &[0.0]);
            let scan = Scan::new(1, channels, UNIT).unwrap();
            let (mut gammas, mut angle) = ([0.0; 1], [0.0; 1]);
            let law = MaximumLaw::new(&scan, 0, &mut gammas, &mut angle).unwrap();
            let found = law.threshold(rate).unwrap();
            let expected = -0.5 * gamma * gamma + gamma * quantile;
            // The bound is rounded up by 1e-9, at the rate 1 − 1e-9 as much as its distance from 1:
            // there η moves by up to the quantile's slope over that, here less than 0.2 γ.
            let slack = if rate > 0.9 { 0.2 } else { 1e-8 };
            assert_near(found, expected, slack * gamma);
        }
    }
}
