//! Expected values: scipy, Nelder and Mead on gamma functions, and Brent's method (`reference.py`).

use super::*;
use crate::psychophysics::AnswerTable;
use palpate_asserts::{assert_near, numbers};

// The golden section leaves √ρ within 2/12 · 4·10⁻⁶, so ρ within 5·10⁻⁷ and p, which hardly depends on it, too; the
// ends follow from a value that is right to 10⁻⁹ with slopes above 1.
const TOLERANCE: f64 = 1e-6;

/// Condition, column, rate with the ends of its interval, correlation with those of its own, and the gain of deviance.
const EXPECTED: &str = "
0 0 0.961657767425 0.822940147366 0.991350597537 0.174123113798 0.034349420313 0.704373442059 16.380638854229
1 0 0.973339226530 0.935077823966 0.989284946490 0.009892941480 0.000000000000 0.150811341087 0.278731235576
1 2 0.844473543190 0.725125901220 0.914044796706 0.114613948876 0.036376577753 0.314868409432 18.763086784063
0 3 0.666931299883 0.574452831637 0.747410687533 0.043149488507 0.002130736476 0.153434864593 4.559789469857
";

// Verifies: PSY-032.
#[test]
fn fits_of_table_1() {
    let table = AnswerTable::paper().unwrap();
    for [condition, column, expected @ .., gain] in numbers::<9>(EXPECTED) {
        let condition = &table.conditions()[condition as usize];
        let found = beta_binomial(&condition.counts(column as usize));
        let found = found.unwrap().unwrap();
        let (of_rate, of_correlation) = (found.rate_bounds, found.correlation_bounds);
        let numbers = [
            found.rate,
            of_rate.lower,
            of_rate.upper,
            found.correlation,
            of_correlation.lower.unwrap(),
            of_correlation.upper.unwrap(),
        ];
        for (found, expected) in numbers.into_iter().zip(expected) {
            assert_near(found, expected, TOLERANCE);
        }
        assert_near(found.deviance_gain, gain, 1e-8);
        assert!(!found.is_binomial);
        // Half the tail of one degree of freedom: Φ(−√gain).
        let tail = palpate::stats::normal::upper_tail(gain.sqrt()).unwrap();
        assert_near(found.p_value / tail, 1.0, 1e-7);
    }
}

// Verifies: PSY-032.
#[test]
fn counts_that_vary_no_more_than_a_binomial_have_no_correlation() {
    let measured = &AnswerTable::paper().unwrap().conditions()[2].counts(3);
    let found = beta_binomial(measured).unwrap().unwrap();
    assert!(found.is_binomial && found.correlation == 0.0);
    assert_eq!(found.correlation_bounds.lower, Some(0.0));
    assert_eq!((found.deviance_gain, found.p_value), (0.0, 1.0));
    assert_near(found.rate, 174.0 / 300.0, 1e-12);
}

// Two subjects, one always right and one always wrong: no correlation is too large.
// Verifies: PSY-032.
#[test]
fn an_end_that_does_not_exist_is_missing() {
    let found = beta_binomial(&[(30, 30), (0, 30)]).unwrap().unwrap();
    assert_eq!(found.correlation_bounds.upper, None);
    assert_near(found.rate, 0.5, 1e-9);
    assert_eq!(beta_binomial(&[(30, 30), (30, 30)]), Ok(None));
    assert_eq!(beta_binomial(&[(0, 30), (0, 30)]), Ok(None));
    assert_eq!(beta_binomial(&[(20, 30)]), Ok(None));
}
