//! Thresholds, rates of error, and what they ask of the noise.

use super::{Answer, Arguments, Refused};
use crate::detect::{self, Costs};

/// η of a criterion.
pub fn threshold(arguments: &mut Arguments) -> Result<Answer, Refused> {
    let criterion = arguments.text("criterion")?;
    let eta = match &criterion[..] {
        "map" => detect::map_threshold(arguments.number("prior_h1")?)?,
        "bayes" => {
            let prior_h1 = arguments.number("prior_h1")?;
            let costs = Costs {
                c00: arguments.number("c00")?,
                c01: arguments.number("c01")?,
                c10: arguments.number("c10")?,
                c11: arguments.number("c11")?,
            };
            detect::bayes_threshold(prior_h1, costs)?
        }
        "neyman_pearson_miss" => detect::neyman_pearson_miss_threshold(
            arguments.number("gamma")?,
            arguments.number("max_miss")?,
        )?,
        "neyman_pearson_false_alarm" => detect::neyman_pearson_false_alarm_threshold(
            arguments.number("gamma")?,
            arguments.number("max_false_alarm")?,
        )?,
        _ => {
            let expected = "map, bayes, neyman_pearson_miss or neyman_pearson_false_alarm";
            let wrong = format_args!("criterion is {criterion:?}, expected {expected}");
            return Err(Refused::range(wrong));
        }
    };
    Ok(Answer::default().with("eta", eta))
}

/// P_fa and P_miss at a threshold.
pub fn error_rates(arguments: &mut Arguments) -> Result<Answer, Refused> {
    let rates = detect::error_rates(arguments.number("gamma")?, arguments.number("eta")?)?;
    Ok(Answer::default()
        .with("false_alarm", rates.false_alarm)
        .with("miss", rates.miss))
}

/// The operating characteristic at given rates of false alarm, and the area under it.
pub fn roc(arguments: &mut Arguments) -> Result<Answer, Refused> {
    let gamma = arguments.number("gamma")?;
    let false_alarm = arguments.numbers("false_alarm")?;
    if false_alarm.is_empty() {
        let wrong = "false_alarm is empty, expected at least one rate";
        return Err(Refused::argument(wrong));
    }
    let miss = false_alarm
        .iter()
        .map(|&rate| detect::roc_miss(gamma, rate));
    Ok(Answer::default()
        .with("miss", miss.collect::<Result<Vec<f64>, _>>()?)
        .with("auc", detect::auc(gamma)?))
}

/// The least γ for two rates.
pub fn required_gamma(arguments: &mut Arguments) -> Result<Answer, Refused> {
    let max_false_alarm = arguments.number("max_false_alarm")?;
    let max_miss = arguments.number("max_miss")?;
    Ok(Answer::default().with("gamma", detect::required_gamma(max_false_alarm, max_miss)?))
}

/// The share of right forced choices.
pub fn two_afc(arguments: &mut Arguments) -> Result<Answer, Refused> {
    let p_correct = detect::two_afc(arguments.number("gamma")?)?;
    Ok(Answer::default().with("p_correct", p_correct))
}

/// The γ of a share of right forced choices.
pub fn gamma_from_two_afc(arguments: &mut Arguments) -> Result<Answer, Refused> {
    let gamma = detect::gamma_from_two_afc(arguments.number("p_correct")?)?;
    Ok(Answer::default().with("gamma", gamma))
}

/// How much noise there may be.
pub fn noise_budget(arguments: &mut Arguments) -> Result<Answer, Refused> {
    let budget = detect::noise_budget::noise_budget(
        arguments.number("signal_n")?,
        arguments.number("max_false_alarm")?,
        arguments.number("max_miss")?,
        &arguments.numbers("sources_n")?,
    )?;
    Ok(Answer::default()
        .with("gamma", budget.gamma)
        .with("total_allowed_n", budget.total_allowed)
        .with("remaining_n", budget.remaining))
}
