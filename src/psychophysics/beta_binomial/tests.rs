//! Expected values: scipy, Nelder and Mead on gamma functions, and Brent's method (`reference.py`).

use super::*;
use crate::psychophysics::Table;
use crate::stats::check::assert_near;

// The golden section leaves √ρ within 2/12 · 4·10⁻⁶, so ρ within 5·10⁻⁷ and p, which hardly depends on it, too; the
// ends follow from a value that is right to 10⁻⁹ with slopes above 1.
const TOLERANCE: f64 = 1e-6;

// Verifies: PSY-032, PSY-033.
#[test]
fn fits_of_table_1() {
    let table = Table::paper().unwrap();
    for (condition, column, rate, rate_ends, correlation, ends, gain) in [
        (
            0,
            0,
            0.9616577674253071,
            [0.8229401473664738, 0.9913505975367575],
            0.17412311379838546,
            [0.03434942031347645, 0.7043734420586059],
            16.380638854229282,
        ),
        (
            1,
            0,
            0.973339226529758,
            [0.9350778239655425, 0.9892849464899945],
            0.00989294147969269,
            [0.0, 0.15081134108663063],
            0.2787312355760143,
        ),
        (
            1,
            2,
            0.8444735431904716,
            [0.7251259012201761, 0.9140447967057539],
            0.1146139488762808,
            [0.03637657775319252, 0.3148684094323343],
            18.763086784063354,
        ),
        (
            0,
            3,
            0.6669312998834205,
            [0.574452831636971, 0.747410687532652],
            0.0431494885066823,
            [0.0021307364762822856, 0.1534348645926911],
            4.559789469856781,
        ),
    ] {
        let found = beta_binomial(&table.conditions()[condition].counts(column))
            .unwrap()
            .unwrap();
        assert_near(found.rate, rate, TOLERANCE);
        assert_near(found.rate_bounds.lower, rate_ends[0], TOLERANCE);
        assert_near(found.rate_bounds.upper, rate_ends[1], TOLERANCE);
        assert_near(found.correlation, correlation, TOLERANCE);
        assert_near(found.correlation_bounds.lower.unwrap(), ends[0], TOLERANCE);
        assert_near(found.correlation_bounds.upper.unwrap(), ends[1], TOLERANCE);
        assert_near(found.deviance_gain, gain, 1e-8);
        assert!(!found.is_binomial);
        // Half the tail of one degree of freedom: Φ(−√gain).
        let tail = crate::stats::normal::upper_tail(gain.sqrt()).unwrap();
        assert_near(found.p_value / tail, 1.0, 1e-7);
    }
}

// Verifies: PSY-033.
#[test]
fn counts_that_vary_no_more_than_a_binomial_have_no_correlation() {
    let measured = &Table::paper().unwrap().conditions()[2].counts(3);
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
