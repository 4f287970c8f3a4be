//! Thresholds, decisions and rates of error, each for numbers or for arrays that NumPy broadcasts.

use palpate::detect::{self, Costs, Decision, DetectError};
use pyo3::basic::CompareOp;
use pyo3::prelude::*;

use crate::convert::{Any, each, refused, vector};

type Answer<'py> = PyResult<Bound<'py, PyAny>>;

/// Functions of Python from functions of numbers.
macro_rules! functions {
    ($($(#[$doc:meta])* $name:ident($($argument:ident),+) = $value:expr;)+) => {
        $(
            $(#[$doc])*
            #[pyfunction]
            pub fn $name<'py>($($argument: Any<'_, 'py>),+) -> Answer<'py> {
                each([$(stringify!($argument)),+], [$($argument),+], |[$($argument),+]| $value)
            }
        )+
    };
}

functions! {
    /// Pr(H = 1 | theta) for the prior Pr(H = 1), numbers or arrays.
    posterior(theta, prior_h1) = detect::posterior(theta, prior_h1);
    /// The threshold eta of the maximum a-posteriori rule, ln(P0/P1), for the prior Pr(H = 1), numbers or arrays.
    map_threshold(prior_h1) = detect::map_threshold(prior_h1);
    /// The threshold eta of least expected cost; cij is the cost of deciding i when H = j, in any one unit. Numbers or arrays.
    bayes_threshold(prior_h1, c00, c01, c10, c11) =
        detect::bayes_threshold(prior_h1, Costs { c00, c01, c10, c11 });
    /// The threshold eta with the fewest false alarms among those with a rate of misses of at most max_miss. Numbers or arrays.
    neyman_pearson_miss_threshold(gamma, max_miss) =
        detect::neyman_pearson_miss_threshold(gamma, max_miss);
    /// The threshold eta with the fewest misses among those with a rate of false alarms of at most max_false_alarm. Numbers or
    /// arrays.
    neyman_pearson_false_alarm_threshold(gamma, max_false_alarm) =
        detect::neyman_pearson_false_alarm_threshold(gamma, max_false_alarm);
    /// The rate of misses, P(miss) = 1 - P(hit), at a rate of false alarms: the receiver operating characteristic of gamma, which is d'.
    /// Numbers or arrays.
    ///
    /// >>> round(1 - roc_miss(gamma=2, false_alarm=0.05), 3)  # P(hit)
    /// 0.639
    roc_miss(gamma, false_alarm) = detect::roc_miss(gamma, false_alarm);
    /// The area under the curve of hits against false alarms, for numbers or arrays gamma, which is d' of signal detection theory.
    auc(gamma) = detect::two_afc(gamma);
    /// The share of right answers in a two-alternative forced choice, for numbers or arrays gamma (d').
    two_afc(gamma) = detect::two_afc(gamma);
    /// The gamma with which a share p_correct of forced choices is right; negative below one half. Numbers or arrays.
    gamma_from_two_afc(p_correct) = detect::gamma_from_two_afc(p_correct);
    /// The least gamma with at most these rates of false alarms and misses. Numbers or arrays.
    required_gamma(max_false_alarm, max_miss) = detect::required_gamma(max_false_alarm, max_miss);
}

/// Whether theta >= eta: an inclusion. Numbers or arrays; a bool or an array of them.
#[pyfunction]
pub fn decide<'py>(theta: Any<'_, 'py>, eta: Any<'_, 'py>) -> Answer<'py> {
    let decided = each(["theta", "eta"], [theta, eta], |[theta, eta]| {
        let inclusion = detect::decide(theta, eta)? == Decision::Inclusion;
        Ok::<f64, DetectError>(f64::from(u8::from(inclusion)))
    });
    decided?.rich_compare(0.5, CompareOp::Gt)
}

/// The rates (false_alarm, miss) of the detector of signal-to-noise ratio gamma at the threshold eta. Numbers or arrays.
#[pyfunction]
pub fn error_rates<'py>(
    gamma: Any<'_, 'py>,
    eta: Any<'_, 'py>,
) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyAny>)> {
    let rate = |of: fn(detect::ErrorRates) -> f64| {
        each(["gamma", "eta"], [gamma, eta], |[gamma, eta]| {
            detect::error_rates(gamma, eta).map(of)
        })
    };
    Ok((rate(|rates| rates.false_alarm)?, rate(|rates| rates.miss)?))
}

/// The noise that a signal of signal_n newtons allows: (gamma, total_allowed_n, remaining_n), where the independent sources_n, an
/// array of shape (m,) of standard deviations in newtons, are there already.
#[pyfunction]
pub fn noise_budget(
    signal_n: f64,
    max_false_alarm: f64,
    max_miss: f64,
    sources_n: Any<'_, '_>,
) -> PyResult<(f64, f64, f64)> {
    let sources = vector("sources_n", sources_n)?;
    let sources = sources.as_slice()?;
    let budget = detect::noise_budget::noise_budget(signal_n, max_false_alarm, max_miss, sources);
    let budget = budget.map_err(refused)?;
    Ok((budget.gamma, budget.total_allowed_n, budget.remaining_n))
}
