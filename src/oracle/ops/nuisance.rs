//! Θ beside nuisances.

use super::{Answer, Arguments, Refused, check_rows};
use crate::detect::nuisance::{NoiseLevel, Nuisances, SubspaceDetector};
use crate::stats::error::check_samples;

/// Most nuisances: each is projected onto those before it.
const MOST_NUISANCES: usize = 100;

/// T, γ, the residual, θ and rates of a whitened record beside nuisances.
///
/// Implements: ORA-011, ORA-027, ACC-014.
pub fn theta(arguments: &mut Arguments) -> Result<Answer, Refused> {
    let mut residual = arguments.numbers("residual")?;
    let mut template = arguments.numbers("template")?;
    let nuisances = arguments.rows("nuisances")?;
    let level = match &arguments.text("level")?[..] {
        "known" => NoiseLevel::Known,
        "unknown" => NoiseLevel::Unknown,
        level => {
            let wrong = format_args!("level is {level:?}, expected known or unknown");
            return Err(Refused::range(wrong));
        }
    };
    let [bias, eta] = arguments.each(["bias", "eta"])?;
    let (number, samples) = (nuisances.len(), template.len());
    if number > MOST_NUISANCES {
        let wrong = format_args!("nuisances are {number}, expected at most {MOST_NUISANCES}");
        return Err(Refused::range(wrong));
    }
    check_samples("template", &template, samples)?;
    let words = [number, samples].map(|length| length.to_string());
    check_rows("nuisances", &nuisances, [number, samples], words)?;
    let mut signals = nuisances.concat();
    let nuisances = Nuisances::new(&mut signals, samples)?;
    let detector = SubspaceDetector::new(nuisances, &mut template)?;
    let found = detector.statistic(&mut residual)?;
    let test = found.test(level, bias)?;
    let rates = test.rates(test.bayes_threshold(eta)?)?;
    let answer = Answer::of([
        ("t", test.t),
        ("gamma", test.gamma),
        ("gamma_nominal", detector.gamma_nominal()),
        ("residual", found.residual),
        ("theta", test.theta()),
        ("false_alarm", rates.false_alarm),
        ("miss", rates.miss),
    ]);
    Ok(answer
        .with("rank", nuisances.rank())
        .with("degrees", found.degrees as usize)) // whole, and below the number of samples
}
