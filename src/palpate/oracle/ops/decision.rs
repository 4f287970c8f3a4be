//! Thresholds, rates of error, and what they ask of the noise.

use super::{Answer, Arguments, Refused};
use crate::detect::{self, Costs};

/// η of a criterion.
pub fn threshold(arguments: &mut Arguments) -> Result<Answer, Refused> {
    let criterion = arguments.text("criterion")?;
    let eta = match &criterion[..] {
        "map" => detect::map_threshold(arguments.number("prior_h1")?)?,
        "bayes" => {
            let names = ["prior_h1", "c00", "c01", "c10", "c11"];
            let [prior_h1, c00, c01, c10, c11] = arguments.each(names)?;
            detect::bayes_threshold(prior_h1, Costs { c00, c01, c10, c11 })?
        }
        "neyman_pearson_miss" => {
            let [gamma, max_miss] = arguments.each(["gamma", "max_miss"])?;
            detect::neyman_pearson_miss_threshold(gamma, max_miss)?
        }
        "neyman_pearson_false_alarm" => {
            let [gamma, max_false_alarm] = arguments.each(["gamma", "max_false_alarm"])?;
            detect::neyman_pearson_false_alarm_threshold(gamma, max_false_alarm)?
        }
        _ => {
            let expected = "map, bayes, neyman_pearson_miss or neyman_pearson_false_alarm";
            let wrong = format_args!("criterion is {criterion:?}, expected {expected}");
            return Err(Refused::range(wrong));
        }
    };
    Ok(Answer::of([("eta", eta)]))
}

/// P_fa and P_miss at a threshold.
pub fn error_rates(arguments: &mut Arguments) -> Result<Answer, Refused> {
    let [gamma, eta] = arguments.each(["gamma", "eta"])?;
    let rates = detect::error_rates(gamma, eta)?;
    Ok(Answer::of([
        ("false_alarm", rates.false_alarm),
        ("miss", rates.miss),
    ]))
}

/// The operating characteristic at given rates of false alarm, and the area under it.
pub fn roc(arguments: &mut Arguments) -> Result<Answer, Refused> {
    let gamma = arguments.number("gamma")?;
    let false_alarm = arguments.numbers("false_alarm")?;
    if false_alarm.is_empty() {
        let wrong = "false_alarm is empty, expected at least one rate";
        return Err(Refused::argument(wrong));
    }
    let miss = false_alarm.iter();
    let miss = miss.map(|&rate| detect::roc_miss(gamma, rate));
    let miss: Vec<f64> = miss.collect::<Result<_, _>>()?;
    Ok(Answer::of([("miss", miss)]).with("auc", detect::two_afc(gamma)?))
}

/// The least γ for two rates.
pub fn required_gamma(arguments: &mut Arguments) -> Result<Answer, Refused> {
    let [max_false_alarm, max_miss] = arguments.each(["max_false_alarm", "max_miss"])?;
    let gamma = detect::required_gamma(max_false_alarm, max_miss)?;
    Ok(Answer::of([("gamma", gamma)]))
}

/// How much noise there may be.
pub fn noise_budget(arguments: &mut Arguments) -> Result<Answer, Refused> {
    let names = ["signal_n", "max_false_alarm", "max_miss"];
    let [signal, max_false_alarm, max_miss] = arguments.each(names)?;
    let sources = arguments.numbers("sources_n")?;
    let budget = detect::noise_budget::noise_budget(signal, max_false_alarm, max_miss, &sources)?;
    Ok(Answer::of([
        ("gamma", budget.gamma),
        ("total_allowed_n", budget.total_allowed_n),
        ("remaining_n", budget.remaining_n),
    ]))
}
