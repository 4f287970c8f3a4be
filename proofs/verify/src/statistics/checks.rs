//! Tests of significance whose size is at most α for every n: no asymptotics.

use super::Outcome;
use crate::Figure;
use palpate::stats::binomial::{at_least, at_most, first};
use palpate::stats::normal::{cdf, quantile, upper_tail};
use palpate::text::trimmed;

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

/// A test of significance of a sample at α.
pub(super) type Test = fn(&[f64], Law, f64) -> Outcome<Figure>;

/// Is the mean of the sample that of the law? The standardised mean is N(0, 1) exactly.
pub(super) fn mean_test(sample: &[f64], law: Law, alpha: f64) -> Outcome<Figure> {
    let n = sample.len() as f64;
    let mean = sample.iter().map(|x| x - law.mean).sum::<f64>() / n;
    let limit = -quantile(0.5 * alpha)?;
    let what = format!("mean of {n} less the law's, in standard errors (limits: normal quantiles)");
    Ok(Figure::within(
        what,
        mean / law.sd * n.sqrt(),
        -limit,
        limit,
    ))
}

/// Is the variance about the law's mean that of the law? Σ((x−μ)/σ)² is χ² with n degrees of
/// freedom; its tails are bounded after Laurent and Massart (Ann. Statist. 28, 2000): Pr(χ² ≥ n +
/// 2√(nt) + 2t) ≤ e^−t and Pr(χ² ≤ n − 2√(nt)) ≤ e^−t.
pub(super) fn variance_test(sample: &[f64], law: Law, alpha: f64) -> Outcome<Figure> {
    let n = sample.len() as f64;
    let squares = sample.iter().map(|x| ((x - law.mean) / law.sd).powi(2));
    let t = libm::log(2.0 / alpha) / n;
    let what = format!("variance of {n} over the law's (limits: Laurent and Massart)");
    let (low, high) = (1.0 - 2.0 * t.sqrt(), 1.0 + 2.0 * t.sqrt() + 2.0 * t);
    Ok(Figure::within(what, squares.sum::<f64>() / n, low, high))
}

/// Is the sample from the law?
pub(super) fn kolmogorov_test(sample: &[f64], law: Law, alpha: f64) -> Outcome<Figure> {
    let below = sample.iter().map(|x| cdf((x - law.mean) / law.sd));
    Ok(uniform_test(below.collect::<Result<_, _>>()?, alpha))
}

/// Is the sample uniform between 0 and 1? Kolmogorov's distance D with Massart's bound Pr(√n D > λ) ≤ 2 exp(−2λ²) (Ann. Probab.
/// 18, 1990).
pub(super) fn uniform_test(mut sample: Vec<f64>, alpha: f64) -> Figure {
    sample.sort_unstable_by(f64::total_cmp);
    let n = sample.len() as f64;
    // What is no number is as far as can be: a maximum passes over it.
    let are_numbers = sample.iter().all(|x| x.is_finite());
    let mut distance = if are_numbers { 0.0 } else { f64::INFINITY };
    for (i, x) in sample.iter().enumerate() {
        distance = distance.max(x - i as f64 / n).max((i + 1) as f64 / n - x);
    }
    let what = format!("Kolmogorov's distance of {n} from the law (limit: Massart)");
    Figure::at_most(what, distance, libm::sqrt(0.5 * libm::log(2.0 / alpha) / n))
}

/// Is the share of the sample at or beyond `threshold` that of the law? An exact binomial test.
pub(super) fn tail_test(sample: &[f64], law: Law, threshold: f64, alpha: f64) -> Outcome<Figure> {
    let count = sample.iter().filter(|&&x| x >= threshold).count() as u64;
    let p = upper_tail((threshold - law.mean) / law.sd)?;
    count_test(count, sample.len() as u64, p, alpha)
}

/// Is a count Binomial(n, p)? Exact, two-sided: the limits are the counts whose tails hold α/2 or more.
pub(super) fn count_test(count: u64, n: u64, p: f64, alpha: f64) -> Outcome<Figure> {
    let least = first(0, n, |count| Ok(at_most(count, n, p)? >= 0.5 * alpha))?;
    let beyond = first(0, n, |count| Ok(at_least(count, n, p)? < 0.5 * alpha))?;
    let what = format!(
        "share of {n}, {} by the law (limits: binomial)",
        trimmed(p, 6)
    );
    let share = |count: u64| count as f64 / n as f64;
    Ok(Figure::within(
        what,
        share(count),
        share(least),
        share(beyond - 1),
    ))
}

/// Is the mean of the sample 0? Each entry lies in an interval of length 1 that what came before it fixes: Hoeffding's bound
/// Pr(|Σ| ≥ t) ≤ 2 exp(−2t²/n).
pub(super) fn mean_of_bounded_test(sample: &[f64], alpha: f64) -> Figure {
    let (n, sum) = (sample.len() as f64, sample.iter().sum::<f64>());
    let limit = libm::sqrt(0.5 * libm::log(2.0 / alpha) / n);
    let what = format!("mean of {n} differences (limits: Hoeffding)");
    Figure::within(what, sum / n, -limit, limit)
}

/// Is each cell the true one as often as is told? Each trial tells ln of the cells' weights, whose shares p are the probabilities, and the
/// cell that is true. Bets at the odds of p gain nothing but by chance: with the shares q of any other law, E Π q/p = 1, and so
/// Pr(Π q/p ≥ 1/α) ≤ α (Markov), whatever the number of trials. Of four bets, with α/4 each, q is p^0.7 and p^1.4 (what is told is too sure,
/// or not sure enough), and p exp(±s/2) with a score s of each cell.
pub(super) fn odds_test(
    told: impl Iterator<Item = Outcome<(Vec<f64>, usize)>>,
    scores: &[f64],
    alpha: f64,
) -> Outcome<Figure> {
    const BETS: [(f64, f64); 4] = [(0.7, 0.0), (1.4, 0.0), (1.0, -0.5), (1.0, 0.5)];
    let (mut gains, mut n) = ([0.0; 4], 0);
    for trial in told {
        let (logs, truth) = trial?;
        let own = log_share(&logs, truth);
        for (gain, (power, tilt)) in gains.iter_mut().zip(BETS) {
            let bet = logs.iter().zip(scores);
            let bet: Vec<f64> = bet.map(|(log, score)| power * log + tilt * score).collect();
            *gain += log_share(&bet, truth) - own;
        }
        n += 1;
    }
    let most = gains.into_iter().fold(f64::NEG_INFINITY, f64::max);
    let what = format!("largest ln of the gain of four bets on {n} (limit: Markov)");
    Ok(Figure::at_most(what, most, libm::log(4.0 / alpha)))
}

/// ln of the share of a weight, of the logarithms of all.
fn log_share(logs: &[f64], at: usize) -> f64 {
    logs[at] - log_sum(logs)
}

/// ln Σ eˣ.
pub(super) fn log_sum(logs: &[f64]) -> f64 {
    let largest = logs.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let sum = logs.iter().map(|log| libm::exp(log - largest));
    largest + libm::log(sum.sum())
}
