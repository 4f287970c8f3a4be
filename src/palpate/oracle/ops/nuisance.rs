//! Θ beside nuisances: of one template, and of each hypothesis of a bank.

use serde::Serialize;

use super::{List, Refused, Rows, answer};
use crate::bank::{likeliest, shares};
use crate::detect::mixture::mixture_theta;
use crate::detect::nuisance::{NoiseLevel, Nuisances, SubspaceDetector};
use crate::detect::{DetectError, posterior};
use crate::stats::error::{check_samples, representable};

/// Most nuisances: each is projected onto those before it.
const MOST_NUISANCES: usize = 100;

/// T, γ, the residual, θ and error rates of a whitened record beside nuisances.
///
/// Implements: ORA-011, ORA-020, ACC-014.
pub fn theta(
    List(mut residual): List<f64>,
    List(mut template): List<f64>,
    nuisances: &Rows,
    level: &str,
    bias: f64,
    eta: f64,
) -> Result<impl Serialize + use<>, Refused> {
    let level = level_of(level)?;
    let samples = template.len();
    check_samples("template", &template, samples)?;
    let mut signals = signals(nuisances, samples)?;
    let nuisances = Nuisances::new(&mut signals, samples)?;
    let detector = SubspaceDetector::new(nuisances, &mut template)?;
    let found = detector.statistic(&mut residual)?;
    let test = found.test(level, bias)?;
    let rates = test.rates(test.bayes_threshold(eta)?)?;
    Ok(answer! {
        t: test.t,
        gamma: test.gamma,
        gamma_nominal: detector.gamma_nominal(),
        rank: nuisances.rank().get(),
        residual: found.residual,
        degrees: found.degrees as usize, // whole, and below the number of samples
        theta: test.theta(),
        false_alarm: rates.false_alarm,
        miss: rates.miss,
    })
}

/// θ of each hypothesis beside nuisances, of all together, the largest, and the probabilities that follow.
///
/// Implements: ORA-011, ORA-020.
pub fn bank_posterior(
    residual: &[f64],
    templates: &Rows,
    nuisances: &Rows,
    level: &str,
    prior: &[f64],
    prior_h1: f64,
) -> Result<impl Serialize + use<>, Refused> {
    let level = level_of(level)?;
    let samples = residual.len();
    check_samples("residual", residual, samples)?;
    check_samples("prior", prior, prior.len())?;
    let mut templates = templates.concat("templates", prior.len(), samples)?;
    let mut signals = signals(nuisances, samples)?;
    let nuisances = Nuisances::new(&mut signals, samples)?;
    let found = templates
        .chunks_exact_mut(samples)
        .map(|template| theta_of(nuisances, template, residual, level))
        .collect::<Result<Vec<_>, _>>()?;
    let theta: Vec<f64> = found.iter().map(|theta| theta.unwrap_or(0.0)).collect();
    let theta_mixture = mixture_theta(&theta, prior)?;
    let may_be = |&number: &usize| found[number].is_some() && prior[number] > 0.0;
    let hypothesis = likeliest(&theta, (0..theta.len()).filter(may_be));
    let hypothesis = hypothesis.ok_or(DetectError::NoSignal)?;
    Ok(answer! {
        theta_mixture,
        theta_max: theta[hypothesis],
        hypothesis,
        posterior_h1: posterior(theta_mixture, prior_h1)?,
        posterior: shares(&theta, prior),
        theta: theta,
    })
}

/// θ of one hypothesis, none if the nuisances explain its template.
fn theta_of(
    nuisances: Nuisances,
    template: &mut [f64],
    residual: &[f64],
    level: NoiseLevel,
) -> Result<Option<f64>, DetectError> {
    let detector = match SubspaceDetector::new(nuisances, template) {
        Err(DetectError::NoSignal) => return Ok(None),
        detector => detector?,
    };
    let found = detector.statistic(&mut residual.to_vec())?;
    let theta = found.test(level, 0.0)?.theta();
    representable("theta", theta).map(Some)
}

/// How the noise is known.
fn level_of(word: &str) -> Result<NoiseLevel, Refused> {
    match word {
        "known" => Ok(NoiseLevel::Known),
        "unknown" => Ok(NoiseLevel::Unknown),
        _ => Err(Refused::word("level", word, "known or unknown")),
    }
}

/// Nuisances of `samples` numbers each, one after the other.
pub fn signals(nuisances: &Rows, samples: usize) -> Result<Vec<f64>, Refused> {
    limited("nuisances", nuisances, samples, MOST_NUISANCES)
}

/// Of the argument `name` its lists of `samples` numbers each, one after the other.
///
/// # Errors
/// More lists than `most`, or one of another length.
pub fn limited(name: &str, lists: &Rows, samples: usize, most: usize) -> Result<Vec<f64>, Refused> {
    let number = lists.0.len();
    if number > most {
        let wrong = format_args!("{name} are {number}, but may be at most {most}");
        return Err(Refused::range(wrong));
    }
    lists.concat(name, number, samples)
}
