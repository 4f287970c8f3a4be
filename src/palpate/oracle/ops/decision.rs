//! Thresholds, and the operating characteristic.

use serde::{Deserialize, Serialize};

use super::{Refused, answer, arguments_of, with_arguments};
use crate::detect::{self, Costs};

/// What chooses the other arguments of a threshold.
#[derive(Debug, Deserialize)]
struct Chosen {
    criterion: String,
}

/// η of a criterion.
pub fn threshold(text: &str) -> Result<f64, Refused> {
    let Chosen { criterion } = arguments_of(text)?;
    Ok(match &criterion[..] {
        "map" => with_arguments!(text, [criterion] { prior_h1: f64 } =>
            detect::map_threshold(prior_h1)),
        "bayes" => with_arguments!(text, [criterion] {
            prior_h1: f64, c00: f64, c01: f64, c10: f64, c11: f64
        } => detect::bayes_threshold(prior_h1, Costs { c00, c01, c10, c11 })),
        "neyman_pearson_miss" => with_arguments!(text, [criterion] { gamma: f64, max_miss: f64 } =>
            detect::neyman_pearson_miss_threshold(gamma, max_miss)),
        "neyman_pearson_false_alarm" => with_arguments!(text, [criterion] {
            gamma: f64, max_false_alarm: f64
        } => detect::neyman_pearson_false_alarm_threshold(gamma, max_false_alarm)),
        _ => {
            let right = "map, bayes, neyman_pearson_miss or neyman_pearson_false_alarm";
            return Err(Refused::word("criterion", &criterion, right));
        }
    }?)
}

/// The operating characteristic at given false-alarm rates, and the area under it.
pub fn roc(gamma: f64, false_alarm: &[f64]) -> Result<impl Serialize, Refused> {
    if false_alarm.is_empty() {
        let wrong = "false_alarm is empty, but must hold at least one rate";
        return Err(Refused::argument(wrong));
    }
    let miss = false_alarm.iter();
    let miss = miss.map(|&rate| detect::roc_miss(gamma, rate));
    let miss: Vec<f64> = miss.collect::<Result<_, _>>()?;
    Ok(answer! { miss, auc: detect::two_afc(gamma)? })
}
