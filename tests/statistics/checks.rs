//! Tests of significance whose size is at most α for every n: no asymptotics.

use palpate::stats::binomial::{at_least, at_most};
use palpate::stats::normal::{cdf, quantile, upper_tail};

/// A normal law.
#[derive(Clone, Copy)]
pub struct Law {
    /// Mean.
    pub mean: f64,
    /// Standard deviation.
    pub sd: f64,
}

impl Law {
    /// The law (8) of Θ.
    pub fn of_theta(gamma: f64, inclusion: bool) -> Self {
        let half = 0.5 * gamma * gamma;
        Self {
            mean: if inclusion { half } else { -half },
            sd: gamma,
        }
    }
}

/// Is the mean of the sample not that of the law? The standardised mean is N(0, 1) exactly.
pub fn mean_rejects(sample: &[f64], law: Law, alpha: f64) -> bool {
    let n = sample.len() as f64;
    let mean = sample.iter().map(|x| x - law.mean).sum::<f64>() / n;
    (mean / law.sd * n.sqrt()).abs() > -quantile(0.5 * alpha).unwrap()
}

/// Is the variance about the law's mean not that of the law? Σ((x−μ)/σ)² is χ² with n degrees of
/// freedom; its tails are bounded after Laurent and Massart (Ann. Statist. 28, 2000): Pr(χ² ≥ n +
/// 2√(nt) + 2t) ≤ e^−t and Pr(χ² ≤ n − 2√(nt)) ≤ e^−t.
pub fn variance_rejects(sample: &[f64], law: Law, alpha: f64) -> bool {
    let n = sample.len() as f64;
    let excess = sample
        .iter()
        .map(|x| ((x - law.mean) / law.sd).powi(2))
        .sum::<f64>()
        - n;
    let t = (2.0 / alpha).ln();
    excess > 2.0 * (n * t).sqrt() + 2.0 * t || excess < -2.0 * (n * t).sqrt()
}

/// Is the sample not from the law? Kolmogorov's distance D with Massart's bound Pr(√n D > λ) ≤ 2
/// exp(−2λ²) (Ann. Probab. 18, 1990).
pub fn kolmogorov_rejects(sample: &[f64], law: Law, alpha: f64) -> bool {
    let mut sorted = sample.to_vec();
    sorted.sort_unstable_by(f64::total_cmp);
    let n = sorted.len() as f64;
    let distance = sorted.iter().enumerate().fold(0.0_f64, |largest, (i, x)| {
        let law = cdf((x - law.mean) / law.sd).unwrap();
        largest
            .max(law - i as f64 / n)
            .max((i + 1) as f64 / n - law)
    });
    distance * n.sqrt() > (0.5 * (2.0 / alpha).ln()).sqrt()
}

/// Is the share of the sample at or beyond `threshold` not that of the law? An exact binomial test.
pub fn tail_rejects(sample: &[f64], law: Law, threshold: f64, alpha: f64) -> bool {
    let count = sample.iter().filter(|&&x| x >= threshold).count() as u64;
    let p = upper_tail((threshold - law.mean) / law.sd).unwrap();
    count_rejects(count, sample.len() as u64, p, alpha)
}

/// Is a count not Binomial(n, p)? Exact, two-sided.
pub fn count_rejects(count: u64, n: u64, p: f64, alpha: f64) -> bool {
    at_least(count, n, p).unwrap() < 0.5 * alpha || at_most(count, n, p).unwrap() < 0.5 * alpha
}

/// Is a count too large for a probability of at most `p`? Exact, one-sided.
pub fn excess_rejects(count: u64, n: u64, p: f64, alpha: f64) -> bool {
    at_least(count, n, p).unwrap() < alpha
}
