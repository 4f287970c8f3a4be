//! Thresholds, decisions and rates of error, each for numbers or for arrays that NumPy broadcasts.

use palpate::detect::{self, Costs, Decision, DetectError};
use pyo3::basic::CompareOp;
use pyo3::prelude::*;

use crate::convert::{Any, each, refused, vector};

type Answer<'py> = PyResult<Bound<'py, PyAny>>;

/// Functions of Python from functions of numbers; the words of each are its summary, what it gives, and examples.
macro_rules! functions {
    ($($(#[$doc:meta])* [$of:literal] $(#[$example:meta])* $name:ident($($argument:ident),+) = $value:expr;)+) => {
        $(
            $(#[$doc])*
            #[doc = sections!($($argument),+; "float or ndarray" = $of; "A number that is out of its range, with its place in arrays.")]
            $(#[$example])*
            #[pyfunction]
            pub fn $name<'py>($($argument: Any<'_, 'py>),+) -> Answer<'py> {
                each([$(stringify!($argument)),+], [$($argument),+], |[$($argument),+]| $value)
            }
        )+
    };
}

functions! {
    /// The probability of an inclusion after a record.
    ["Pr(H = 1 | theta)."]
    posterior(theta, prior_h1) = detect::posterior(theta, prior_h1);
    /// The threshold of the maximum a-posteriori rule.
    ["eta, ln(P0/P1)."]
    map_threshold(prior_h1) = detect::map_threshold(prior_h1);
    /// The threshold of least expected cost; cij is the cost of deciding i when H = j.
    ["eta."]
    bayes_threshold(prior_h1, c00, c01, c10, c11) =
        detect::bayes_threshold(prior_h1, Costs { c00, c01, c10, c11 });
    /// The threshold with the fewest false alarms among those with a rate of misses of at most max_miss.
    ["eta."]
    neyman_pearson_miss_threshold(gamma, max_miss) =
        detect::neyman_pearson_miss_threshold(gamma, max_miss);
    /// The threshold with the fewest misses among those with a rate of false alarms of at most max_false_alarm.
    ["eta."]
    neyman_pearson_false_alarm_threshold(gamma, max_false_alarm) =
        detect::neyman_pearson_false_alarm_threshold(gamma, max_false_alarm);
    /// The rate of misses at a rate of false alarms: the receiver operating characteristic.
    ["P(miss) = 1 - P(hit)."]
    /// Examples
    /// --------
    /// >>> round(1 - roc_miss(gamma=2, false_alarm=0.05), 3)  # P(hit)
    /// 0.639
    roc_miss(gamma, false_alarm) = detect::roc_miss(gamma, false_alarm);
    /// The area under the curve of hits against false alarms.
    ["The area, AUC."]
    auc(gamma) = detect::two_afc(gamma);
    /// The share of right answers in a two-alternative forced choice.
    ["p_correct."]
    two_afc(gamma) = detect::two_afc(gamma);
    /// The gamma with which a share of forced choices is right.
    ["gamma (d'), negative below one half."]
    gamma_from_two_afc(p_correct) = detect::gamma_from_two_afc(p_correct);
    /// The least gamma with at most these rates of false alarms and misses.
    ["gamma (d')."]
    required_gamma(max_false_alarm, max_miss) = detect::required_gamma(max_false_alarm, max_miss);
}

/// Whether a record has an inclusion: theta >= eta.
#[doc = sections!(theta, eta; "bool, or ndarray of bool" = "True for an inclusion."; "A NaN, or arrays that do not broadcast.")]
#[pyfunction]
pub fn decide<'py>(theta: Any<'_, 'py>, eta: Any<'_, 'py>) -> Answer<'py> {
    let decided = each(["theta", "eta"], [theta, eta], |[theta, eta]| {
        let inclusion = detect::decide(theta, eta)? == Decision::Inclusion;
        Ok::<f64, DetectError>(f64::from(u8::from(inclusion)))
    });
    decided?.rich_compare(0.5, CompareOp::Gt)
}

/// The rates of error of the detector at a threshold.
#[doc = sections!(
    gamma, eta;
    "(float, float) or (ndarray, ndarray)" = "The rates of false alarms, P_FA, and of misses, 1 - P_D.";
    "A number that is out of its range, with its place in arrays."
)]
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

/// The noise that a signal allows beside independent sources that are there already.
#[doc = sections!(
    signal_n: "float" = "The signal, N.",
    max_false_alarm: "float" = "The largest rate of false alarms.",
    max_miss: "float" = "The largest rate of misses.",
    sources_n: "array_like, shape (m,)" = "Standard deviations of the sources, N.";
    "(float, float, float)" = "gamma, total_allowed_n, remaining_n, N.";
    "A number that is out of its range."
)]
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
