//! Thresholds, decisions and rates of error, each for numbers or for arrays.

use palpate::detect::{self, Costs};
use pyo3::IntoPyObjectExt;
use pyo3::prelude::*;

use crate::convert::{array, each, floats, refused};

type Any<'a, 'py> = &'a Bound<'py, PyAny>;
type Answer<'py> = PyResult<Bound<'py, PyAny>>;

/// Whether theta >= eta: an inclusion. Numbers or arrays of any shapes that broadcast; a bool or an array of them.
#[pyfunction]
pub fn decide<'py>(theta: Any<'_, 'py>, eta: Any<'_, 'py>) -> Answer<'py> {
    let found = each(["theta", "eta"], [theta, eta], |[theta, eta]| {
        let decision = detect::decide(theta, eta);
        decision.map(|decision| f64::from(u8::from(decision == detect::Decision::Inclusion)))
    })?;
    found.gt(0.5)?.into_bound_py_any(theta.py())
}

/// Pr(H = 1 | theta) for the prior Pr(H = 1), numbers or arrays.
#[pyfunction]
#[pyo3(signature = (theta, prior_h1=None))]
pub fn posterior<'py>(theta: Any<'_, 'py>, prior_h1: Option<Any<'_, 'py>>) -> Answer<'py> {
    let half = 0.5.into_bound_py_any(theta.py())?;
    let arguments = [theta, prior_h1.unwrap_or(&half)];
    each(["theta", "prior_h1"], arguments, |[theta, prior_h1]| {
        detect::posterior(theta, prior_h1)
    })
}

/// The threshold eta of the maximum a-posteriori rule, ln(P0/P1), for the prior Pr(H = 1), numbers or arrays.
#[pyfunction]
pub fn map_threshold<'py>(prior_h1: Any<'_, 'py>) -> Answer<'py> {
    each(["prior_h1"], [prior_h1], |[prior_h1]| {
        detect::map_threshold(prior_h1)
    })
}

/// The threshold eta of least expected cost; cij is the cost of deciding i when H = j, in any one unit. Numbers or arrays.
#[pyfunction]
pub fn bayes_threshold<'py>(
    prior_h1: Any<'_, 'py>,
    c00: Any<'_, 'py>,
    c01: Any<'_, 'py>,
    c10: Any<'_, 'py>,
    c11: Any<'_, 'py>,
) -> Answer<'py> {
    let names = ["prior_h1", "c00", "c01", "c10", "c11"];
    let arguments = [prior_h1, c00, c01, c10, c11];
    each(names, arguments, |[prior_h1, c00, c01, c10, c11]| {
        detect::bayes_threshold(prior_h1, Costs { c00, c01, c10, c11 })
    })
}

/// The threshold eta with the fewest false alarms among those with a rate of misses of at most max_miss. Numbers or arrays.
#[pyfunction]
pub fn neyman_pearson_miss_threshold<'py>(
    gamma: Any<'_, 'py>,
    max_miss: Any<'_, 'py>,
) -> Answer<'py> {
    let names = ["gamma", "max_miss"];
    each(names, [gamma, max_miss], |[gamma, max_miss]| {
        detect::neyman_pearson_miss_threshold(gamma, max_miss)
    })
}

/// The threshold eta with the fewest misses among those with a rate of false alarms of at most max_false_alarm. Numbers or arrays.
#[pyfunction]
pub fn neyman_pearson_false_alarm_threshold<'py>(
    gamma: Any<'_, 'py>,
    max_false_alarm: Any<'_, 'py>,
) -> Answer<'py> {
    let names = ["gamma", "max_false_alarm"];
    each(names, [gamma, max_false_alarm], |[gamma, rate]| {
        detect::neyman_pearson_false_alarm_threshold(gamma, rate)
    })
}

/// The rates (false_alarm, miss) of the detector of signal-to-noise ratio gamma at the threshold eta. Numbers or arrays.
#[pyfunction]
pub fn error_rates<'py>(
    gamma: Any<'_, 'py>,
    eta: Any<'_, 'py>,
) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyAny>)> {
    let (names, arguments) = (["gamma", "eta"], [gamma, eta]);
    let false_alarm = each(names, arguments, |[gamma, eta]| {
        detect::error_rates(gamma, eta).map(|rates| rates.false_alarm)
    })?;
    let miss = each(names, arguments, |[gamma, eta]| {
        detect::error_rates(gamma, eta).map(|rates| rates.miss)
    })?;
    Ok((false_alarm, miss))
}

/// The rate of misses at a rate of false alarms: the receiver operating characteristic. Numbers or arrays.
#[pyfunction]
pub fn roc_miss<'py>(gamma: Any<'_, 'py>, false_alarm: Any<'_, 'py>) -> Answer<'py> {
    let names = ["gamma", "false_alarm"];
    each(names, [gamma, false_alarm], |[gamma, false_alarm]| {
        detect::roc_miss(gamma, false_alarm)
    })
}

/// The area under the curve of hits against false alarms. Numbers or arrays.
#[pyfunction]
pub fn auc<'py>(gamma: Any<'_, 'py>) -> Answer<'py> {
    each(["gamma"], [gamma], |[gamma]| detect::auc(gamma))
}

/// The share of right answers in a two-alternative forced choice. Numbers or arrays.
#[pyfunction]
pub fn two_afc<'py>(gamma: Any<'_, 'py>) -> Answer<'py> {
    each(["gamma"], [gamma], |[gamma]| detect::two_afc(gamma))
}

/// The gamma with which a share p_correct of forced choices is right; negative below one half. Numbers or arrays.
#[pyfunction]
pub fn gamma_from_two_afc<'py>(p_correct: Any<'_, 'py>) -> Answer<'py> {
    each(["p_correct"], [p_correct], |[p_correct]| {
        detect::gamma_from_two_afc(p_correct)
    })
}

/// The least gamma with at most these rates of false alarms and misses. Numbers or arrays.
#[pyfunction]
pub fn required_gamma<'py>(max_false_alarm: Any<'_, 'py>, max_miss: Any<'_, 'py>) -> Answer<'py> {
    let names = ["max_false_alarm", "max_miss"];
    each(names, [max_false_alarm, max_miss], |[false_alarm, miss]| {
        detect::required_gamma(false_alarm, miss)
    })
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
    let sources = floats("sources_n", sources_n)?;
    let budget = detect::noise_budget::noise_budget(
        signal_n,
        max_false_alarm,
        max_miss,
        sources.as_slice()?,
    )
    .map_err(refused)?;
    Ok((budget.gamma, budget.total_allowed, budget.remaining))
}

/// count values of theta drawn from its law, normal with mean -gamma**2/2 without and +gamma**2/2 with an inclusion and standard
/// deviation gamma: an array of shape (count,), the same for the same seed.
#[pyfunction]
#[pyo3(signature = (gamma, inclusion, count, seed=1999))]
pub fn draw_theta<'py>(
    py: Python<'py>,
    gamma: f64,
    inclusion: bool,
    count: usize,
    seed: u64,
) -> Answer<'py> {
    let generator = crate::detector::generator(seed, inclusion);
    let mut theta = crate::detector::zeros(count)?;
    let drawn =
        py.detach(|| detect::simulate::draw_theta(&generator, gamma, inclusion, 0, &mut theta));
    drawn.map_err(refused)?;
    array(py, &[count], theta)
}
