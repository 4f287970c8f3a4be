//! Thresholds, error rates, and what they ask of the noise.

use std::collections::BTreeMap;

use serde::de::IgnoredAny;
use serde::{Deserialize, Serialize};
use serde_json::value::RawValue;

use super::{List, Refused, arguments, arguments_of, named};
use crate::detect::noise_budget::{self, NoiseBudget};
use crate::detect::{self, Costs, ErrorRates};
use crate::stats::NumericError;

arguments! { GammaEta { gamma: f64, eta: f64 } }
arguments! { Curve { gamma: f64, false_alarm: List<f64> } }
arguments! { Rates { max_false_alarm: f64, max_miss: f64 } }
arguments! {
    Budget { signal_n: f64, max_false_alarm: f64, max_miss: f64, sources_n: List<f64> }
}
arguments! { #[allow(dead_code)] Map { criterion: IgnoredAny, prior_h1: f64 } }
arguments! {
    #[allow(dead_code)]
    Bayes { criterion: IgnoredAny, prior_h1: f64, c00: f64, c01: f64, c10: f64, c11: f64 }
}
arguments! { #[allow(dead_code)] Miss { criterion: IgnoredAny, gamma: f64, max_miss: f64 } }
arguments! {
    #[allow(dead_code)]
    FalseAlarm { criterion: IgnoredAny, gamma: f64, max_false_alarm: f64 }
}

/// What names the other arguments of a threshold.
#[derive(Debug, Deserialize)]
struct Criterion {
    criterion: String,
}

/// η of a criterion.
pub fn threshold(arguments: &RawValue) -> Result<BTreeMap<&'static str, f64>, Refused> {
    let text = arguments.get();
    let Criterion { criterion } = arguments_of(text)?;
    let eta = match &criterion[..] {
        "map" => {
            let Map { prior_h1, .. } = arguments_of(text)?;
            detect::map_threshold(prior_h1)
        }
        "bayes" => {
            let Bayes {
                prior_h1,
                c00,
                c01,
                c10,
                c11,
                ..
            } = arguments_of(text)?;
            detect::bayes_threshold(prior_h1, Costs { c00, c01, c10, c11 })
        }
        "neyman_pearson_miss" => {
            let Miss {
                gamma, max_miss, ..
            } = arguments_of(text)?;
            detect::neyman_pearson_miss_threshold(gamma, max_miss)
        }
        "neyman_pearson_false_alarm" => {
            let FalseAlarm {
                gamma,
                max_false_alarm,
                ..
            } = arguments_of(text)?;
            detect::neyman_pearson_false_alarm_threshold(gamma, max_false_alarm)
        }
        _ => {
            let right = "map, bayes, neyman_pearson_miss or neyman_pearson_false_alarm";
            let wrong = format_args!("criterion is {criterion:?}; it must be {right}");
            return Err(Refused::range(wrong));
        }
    };
    Ok(named("eta", eta?))
}

/// P_fa and P_miss at a threshold.
pub fn error_rates(arguments: GammaEta) -> Result<ErrorRates, NumericError> {
    detect::error_rates(arguments.gamma, arguments.eta)
}

/// The operating characteristic at given false-alarm rates, and the area under it.
#[derive(Debug, Serialize)]
pub struct Roc {
    miss: Vec<f64>,
    auc: f64,
}

/// The operating characteristic.
pub fn roc(arguments: Curve) -> Result<Roc, Refused> {
    let Curve {
        gamma,
        false_alarm: List(rates),
    } = arguments;
    if rates.is_empty() {
        let wrong = "false_alarm is empty, but must hold at least one rate";
        return Err(Refused::argument(wrong));
    }
    let miss = rates.iter().map(|&rate| detect::roc_miss(gamma, rate));
    Ok(Roc {
        miss: miss.collect::<Result<_, _>>()?,
        auc: detect::two_afc(gamma)?,
    })
}

/// The least γ for two rates.
pub fn required_gamma(rates: Rates) -> Result<BTreeMap<&'static str, f64>, NumericError> {
    let gamma = detect::required_gamma(rates.max_false_alarm, rates.max_miss);
    gamma.map(|gamma| named("gamma", gamma))
}

/// How much noise there may be.
pub fn noise_budget(arguments: Budget) -> Result<NoiseBudget, NumericError> {
    let Budget {
        signal_n,
        max_false_alarm,
        max_miss,
        sources_n: List(sources),
    } = arguments;
    noise_budget::noise_budget(signal_n, max_false_alarm, max_miss, &sources)
}
