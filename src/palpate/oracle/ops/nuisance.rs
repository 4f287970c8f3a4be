//! Θ beside nuisances: of one template, and of each hypothesis of a bank.

use super::{Answer, Arguments, Refused, check_rows};
use crate::detect::mixture::{likeliest, mixture_theta};
use crate::detect::nuisance::{NoiseLevel, Nuisances, SubspaceDetector};
use crate::detect::{DetectError, posterior};
use crate::stats::error::{check_samples, representable};

/// Most nuisances: each is projected onto those before it.
const MOST_NUISANCES: usize = 100;

/// T, γ, the residual, θ and rates of a whitened record beside nuisances.
///
/// Implements: ORA-011, ORA-020, ACC-014.
pub fn theta(arguments: &mut Arguments) -> Result<Answer, Refused> {
    let mut residual = arguments.numbers("residual")?;
    let mut template = arguments.numbers("template")?;
    let nuisances = arguments.rows("nuisances")?;
    let level = level(arguments)?;
    let [bias, eta] = arguments.each(["bias", "eta"])?;
    let samples = template.len();
    check_samples("template", &template, samples)?;
    let mut signals = signals(&nuisances, samples)?;
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

/// θ of each hypothesis beside nuisances, the largest, that of all together, and the probabilities that follow.
///
/// Implements: ORA-011, ORA-020.
pub fn bank_posterior(arguments: &mut Arguments) -> Result<Answer, Refused> {
    let residual = arguments.numbers("residual")?;
    let templates = arguments.rows("templates")?;
    let nuisances = arguments.rows("nuisances")?;
    let level = level(arguments)?;
    let prior = arguments.numbers("prior")?;
    let prior_h1 = arguments.number("prior_h1")?;
    let samples = residual.len();
    check_samples("residual", &residual, samples)?;
    check_samples("prior", &prior, prior.len())?;
    let words = [prior.len(), samples].map(|length| length.to_string());
    check_rows("templates", &templates, [prior.len(), samples], words)?;
    let mut signals = signals(&nuisances, samples)?;
    let nuisances = Nuisances::new(&mut signals, samples)?;
    let found = templates
        .into_iter()
        .map(|mut template| theta_of(nuisances, &mut template, &residual, level));
    let found = found.collect::<Result<Vec<_>, _>>()?;
    let theta: Vec<f64> = found.iter().map(|theta| theta.unwrap_or(0.0)).collect();
    let mixture = mixture_theta(&theta, &prior)?;
    let may_be = |&number: &usize| found[number].is_some() && prior[number] > 0.0;
    let largest = likeliest(&theta, (0..theta.len()).filter(may_be));
    let largest = largest.ok_or(DetectError::NoSignal)?;
    let theta_max = theta[largest];
    let posterior_h1 = posterior(mixture, prior_h1)?;
    let shares = shares(&theta, &prior);
    Ok(Answer::of([("theta", theta), ("posterior", shares)])
        .with("theta_mixture", mixture)
        .with("theta_max", theta_max)
        .with("hypothesis", largest)
        .with("posterior_h1", posterior_h1))
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

/// The probability of each hypothesis if one is true: π_k exp(θ_k), over the sum of all.
fn shares(theta: &[f64], prior: &[f64]) -> Vec<f64> {
    let may_be = (0..theta.len()).filter(|&number| prior[number] > 0.0);
    // As in the mixture: no exponent of a hypothesis that may be true is above 0.
    let largest = likeliest(theta, may_be).map_or(0.0, |number| theta[number]);
    let weight = |(prior, theta): (&f64, &f64)| match *prior {
        0.0 => 0.0,
        prior => prior * libm::exp(theta - largest),
    };
    let weights: Vec<f64> = prior.iter().zip(theta).map(weight).collect();
    let whole: f64 = weights.iter().sum();
    weights.iter().map(|weight| weight / whole).collect()
}

/// How the noise is known.
fn level(arguments: &mut Arguments) -> Result<NoiseLevel, Refused> {
    match &arguments.text("level")?[..] {
        "known" => Ok(NoiseLevel::Known),
        "unknown" => Ok(NoiseLevel::Unknown),
        level => Err(Refused::range(format_args!(
            "level is {level:?}, expected known or unknown"
        ))),
    }
}

/// Nuisances of `samples` numbers each, one after the other.
fn signals(nuisances: &[Vec<f64>], samples: usize) -> Result<Vec<f64>, Refused> {
    let number = nuisances.len();
    if number > MOST_NUISANCES {
        let wrong = format_args!("nuisances are {number}, expected at most {MOST_NUISANCES}");
        return Err(Refused::range(wrong));
    }
    let words = [number, samples].map(|length| length.to_string());
    check_rows("nuisances", nuisances, [number, samples], words)?;
    Ok(nuisances.concat())
}
