//! Thresholds, rates of error and pair-wise tests of a known signal-to-noise ratio γ.
//!
//! Implements: CLB-010.

use palpate_core::detect;
pub use palpate_core::detect::noise_budget::NoiseBudget;
use palpate_core::detect::noise_budget::noise_budget;
pub use palpate_core::detect::{Costs, ErrorRates};

use crate::Error;
use crate::memory::{give, list, read};

/// 1 if θ ≥ η, an inclusion; 0 otherwise. Refuses NaN; a refusal is no answer.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palpate_decide(theta: f64, eta: f64, inclusion: *mut u8) -> Error {
    let decide = || Ok((detect::decide(theta, eta)? == detect::Decision::Inclusion).into());
    unsafe { give(inclusion, decide) }
}

/// Pr(H = 1 | record) from θ and the prior probability of an inclusion.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palpate_posterior(theta: f64, prior_h1: f64, p: *mut f64) -> Error {
    unsafe { give(p, || Ok(detect::posterior(theta, prior_h1)?)) }
}

/// η of the most probable hypothesis.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palpate_map_threshold(prior_h1: f64, eta: *mut f64) -> Error {
    unsafe { give(eta, || Ok(detect::map_threshold(prior_h1)?)) }
}

/// η of the least expected cost.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palpate_bayes_threshold(
    prior_h1: f64,
    costs: *const Costs,
    eta: *mut f64,
) -> Error {
    let threshold = || {
        let costs = unsafe { read(costs) }?;
        Ok(detect::bayes_threshold(prior_h1, costs)?)
    };
    unsafe { give(eta, threshold) }
}

/// The largest η with at most this rate of misses.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palpate_neyman_pearson_miss_threshold(
    gamma: f64,
    max_miss: f64,
    eta: *mut f64,
) -> Error {
    let threshold = || Ok(detect::neyman_pearson_miss_threshold(gamma, max_miss)?);
    unsafe { give(eta, threshold) }
}

/// The least η with at most this rate of false alarms.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palpate_neyman_pearson_false_alarm_threshold(
    gamma: f64,
    max_false_alarm: f64,
    eta: *mut f64,
) -> Error {
    let threshold = || {
        Ok(detect::neyman_pearson_false_alarm_threshold(
            gamma,
            max_false_alarm,
        )?)
    };
    unsafe { give(eta, threshold) }
}

/// The rates of error at a threshold η on θ.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palpate_error_rates(
    gamma: f64,
    eta: f64,
    rates: *mut ErrorRates,
) -> Error {
    unsafe { give(rates, || Ok(detect::error_rates(gamma, eta)?)) }
}

/// The rate of misses on the receiver operating characteristic at a rate of false alarms.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palpate_roc_miss(gamma: f64, false_alarm: f64, miss: *mut f64) -> Error {
    unsafe { give(miss, || Ok(detect::roc_miss(gamma, false_alarm)?)) }
}

/// The least γ for two rates of error.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palpate_required_gamma(
    max_false_alarm: f64,
    max_miss: f64,
    gamma: *mut f64,
) -> Error {
    let required = || Ok(detect::required_gamma(max_false_alarm, max_miss)?);
    unsafe { give(gamma, required) }
}

/// The rate of right answers in a choice of two; also the area under the receiver operating characteristic.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palpate_two_afc(gamma: f64, p_correct: *mut f64) -> Error {
    unsafe { give(p_correct, || Ok(detect::two_afc(gamma)?)) }
}

/// γ from the rate of right answers in a choice of two.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palpate_gamma_from_two_afc(p_correct: f64, gamma: *mut f64) -> Error {
    unsafe { give(gamma, || Ok(detect::gamma_from_two_afc(p_correct)?)) }
}

/// The noise that a signal of `signal_n` allows at two rates of error, beside `count` sources (standard deviations, N).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palpate_noise_budget(
    signal_n: f64,
    max_false_alarm: f64,
    max_miss: f64,
    sources_n: *const f64,
    count: usize,
    budget: *mut NoiseBudget,
) -> Error {
    let found = || {
        let sources = unsafe { list(sources_n, count) }?;
        Ok(noise_budget(signal_n, max_false_alarm, max_miss, sources)?)
    };
    unsafe { give(budget, found) }
}
