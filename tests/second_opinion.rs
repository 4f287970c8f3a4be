//! The laws of `palpate::stats` beside those of statrs, which is written by others.

use palpate::stats::noncentral::{f_ratio, student_point};
use palpate::stats::tails::{chi_square_tail, gamma_tail};
use palpate::stats::{binomial, normal};
use statrs::distribution::{
    Binomial, ChiSquared, ContinuousCDF, DiscreteCDF, FisherSnedecor, Gamma, Normal, StudentsT,
};

/// statrs 0.19 has an erf, a gamma and a beta function that are wrong by up to 1e-10, relatively; a defect of ours is far larger.
const TOLERANCE: f64 = 1e-9;

/// Tails below this are left out: there statrs loses digits to a difference from 1.
const SMALLEST: f64 = 1e-5;

#[track_caller]
fn assert_near(ours: f64, theirs: f64, what: std::fmt::Arguments) {
    let error = (ours - theirs).abs();
    let holds = error <= TOLERANCE * theirs.abs().max(SMALLEST);
    assert!(holds, "{what}: {ours:e}, statrs {theirs:e}");
}

// Verifies: DET-001, PSY-030.
#[test]
fn continuous_laws_are_those_of_statrs() {
    let standard = Normal::standard();
    for k in -40..=40 {
        let x = 0.1 * f64::from(k);
        assert_near(
            normal::cdf(x).unwrap(),
            standard.cdf(x),
            format_args!("Φ({x})"),
        );
        let p = normal::cdf(x).unwrap();
        let quantile = normal::quantile(p).unwrap();
        assert_near(quantile, standard.inverse_cdf(p), format_args!("Φ⁻¹({p})"));
    }
    for degrees in [1.0, 2.0, 3.0, 7.5, 40.0, 300.0] {
        let chi_square = ChiSquared::new(degrees).unwrap();
        let gamma = Gamma::new(degrees, 1.0).unwrap();
        let student = StudentsT::new(0.0, 1.0, degrees).unwrap();
        for k in 1..=30 {
            let x = 0.1 * f64::from(k) * degrees;
            let what = format_args!("at {x} with {degrees} degrees");
            assert_near(chi_square_tail(x, degrees).unwrap(), chi_square.sf(x), what);
            assert_near(gamma_tail(degrees, x).unwrap(), gamma.sf(x), what);
            for denominator in [1.0, 4.0, 60.0] {
                let law = FisherSnedecor::new(degrees, denominator).unwrap();
                let (ratio, what) = (x / degrees, format_args!("F({degrees}, {denominator})"));
                let found = f_ratio(ratio, degrees, denominator, 0.0).unwrap();
                assert_near(found.upper, law.sf(ratio), what);
            }
        }
        for confidence in [0.5, 0.9, 0.99] {
            let quantile = student_point(0.5 * (1.0 - confidence), degrees).unwrap();
            let what = format_args!("t for {confidence} with {degrees} degrees");
            assert_near(student.sf(quantile), 0.5 * (1.0 - confidence), what);
        }
    }
}

// Verifies: DET-120.
#[test]
fn the_binomial_law_is_that_of_statrs() {
    for (trials, p) in [(1, 0.3), (20, 0.05), (100, 0.5), (1000, 0.81)] {
        let law = Binomial::new(p, trials).unwrap();
        for successes in 0..=trials {
            let what = format_args!("{successes} of {trials} at {p}");
            assert_near(
                binomial::at_most(successes, trials, p).unwrap(),
                law.cdf(successes),
                what,
            );
        }
    }
}
