//! Tests of significance whose size is at most α for every n: no asymptotics.

use super::Outcome;
use palpate::stats::binomial::{at_least, at_most};
use palpate::stats::normal::{cdf, quantile, upper_tail};

/// A normal law.
#[derive(Clone, Copy)]
pub(super) struct Law {
    /// Mean.
    pub mean: f64,
    /// Standard deviation.
    pub sd: f64,
}

impl Law {
    /// The law (8) of Θ.
    pub(super) fn of_theta(gamma: f64, inclusion: bool) -> Self {
        let half = 0.5 * gamma * gamma;
        Self {
            mean: if inclusion { half } else { -half },
            sd: gamma,
        }
    }
}

/// Is the mean of the sample not that of the law? The standardised mean is N(0, 1) exactly.
pub(super) fn mean_rejects(sample: &[f64], law: Law, alpha: f64) -> Outcome<bool> {
    let n = sample.len() as f64;
    let mean = sample.iter().map(|x| x - law.mean).sum::<f64>() / n;
    Ok((mean / law.sd * n.sqrt()).abs() > -quantile(0.5 * alpha)?)
}

/// Is the variance about the law's mean not that of the law? Σ((x−μ)/σ)² is χ² with n degrees of
/// freedom; its tails are bounded after Laurent and Massart (Ann. Statist. 28, 2000): Pr(χ² ≥ n +
/// 2√(nt) + 2t) ≤ e^−t and Pr(χ² ≤ n − 2√(nt)) ≤ e^−t.
pub(super) fn variance_rejects(sample: &[f64], law: Law, alpha: f64) -> Outcome<bool> {
    let n = sample.len() as f64;
    let excess = sample
        .iter()
        .map(|x| ((x - law.mean) / law.sd).powi(2))
        .sum::<f64>()
        - n;
    let t = libm::log(2.0 / alpha);
    Ok(excess > 2.0 * (n * t).sqrt() + 2.0 * t || excess < -2.0 * (n * t).sqrt())
}

/// Is the sample not from the law?
pub(super) fn kolmogorov_rejects(sample: &[f64], law: Law, alpha: f64) -> Outcome<bool> {
    let below = sample.iter().map(|x| cdf((x - law.mean) / law.sd));
    Ok(uniform_rejects(below.collect::<Result<_, _>>()?, alpha))
}

/// Is the sample not uniform between 0 and 1? Kolmogorov's distance D with Massart's bound Pr(√n D > λ) ≤ 2 exp(−2λ²) (Ann. Probab.
/// 18, 1990).
pub(super) fn uniform_rejects(mut sample: Vec<f64>, alpha: f64) -> bool {
    sample.sort_unstable_by(f64::total_cmp);
    let n = sample.len() as f64;
    let mut distance = 0.0_f64;
    for (i, x) in sample.iter().enumerate() {
        distance = distance.max(x - i as f64 / n).max((i + 1) as f64 / n - x);
    }
    distance * n.sqrt() > libm::sqrt(0.5 * libm::log(2.0 / alpha))
}

/// Is the share of the sample at or beyond `threshold` not that of the law? An exact binomial test.
pub(super) fn tail_rejects(sample: &[f64], law: Law, threshold: f64, alpha: f64) -> Outcome<bool> {
    let count = sample.iter().filter(|&&x| x >= threshold).count() as u64;
    let p = upper_tail((threshold - law.mean) / law.sd)?;
    count_rejects(count, sample.len() as u64, p, alpha)
}

/// Is a count not Binomial(n, p)? Exact, two-sided.
pub(super) fn count_rejects(count: u64, n: u64, p: f64, alpha: f64) -> Outcome<bool> {
    Ok(at_least(count, n, p)? < 0.5 * alpha || at_most(count, n, p)? < 0.5 * alpha)
}

/// Is the mean of the sample not 0? Each entry lies in an interval of length 1 that what came before it fixes: Hoeffding's bound
/// Pr(|Σ| ≥ t) ≤ 2 exp(−2t²/n).
pub(super) fn mean_of_bounded_rejects(sample: &[f64], alpha: f64) -> bool {
    let (n, sum) = (sample.len() as f64, sample.iter().sum::<f64>());
    sum.abs() > libm::sqrt(0.5 * n * libm::log(2.0 / alpha))
}
