//! The likelihood of right answers in pairs: an answer is right because the difference was perceived, or
//! by a guess, and a share of lapses is wrong whatever was felt.

use super::counts::Condition;
use super::search::change;

/// Right answers and pairs at one inclusion.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Count {
    /// Right answers.
    pub right: f64,
    /// Wrong answers.
    pub wrong: f64,
}

impl Count {
    /// Of right answers and pairs.
    pub fn new(right: f64, trials: f64) -> Count {
        let wrong = trials - right;
        Count { right, wrong }
    }

    /// Of all subjects under a condition together, at the inclusion in `column`.
    pub fn pooled(condition: &Condition, column: usize) -> Count {
        let (correct, trials) = condition.pooled(column);
        Count::new(correct as f64, trials as f64)
    }

    /// The pairs.
    pub fn trials(self) -> f64 {
        self.right + self.wrong
    }

    /// The log-likelihood at its largest, with a share of its own.
    pub fn saturated(self) -> f64 {
        let of = |n: f64| times_log(n, n / self.trials());
        of(self.right) + of(self.wrong)
    }
}

/// n ln p, with 0 ln 0 = 0.
fn times_log(n: f64, p: f64) -> f64 {
    if n == 0.0 { 0.0 } else { n * libm::log(p) }
}

/// How well a difference is perceived: F with a right answer in ½ + ½F of the pairs, and 1 − F beside it,
/// which the difference from 1 would lose.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Perceived {
    /// F.
    pub share: f64,
    /// 1 − F.
    pub missed: f64,
}

impl Perceived {
    /// F = 2Φ(γ/√2) − 1, so that ½ + ½F is the paper's Figure 9.
    pub fn at_gamma(gamma: f64) -> Perceived {
        let half = 0.5 * gamma;
        // The smaller one, from which the other loses nothing.
        let (share, missed) = if half < 0.5 {
            let share = libm::erf(half);
            (share, 1.0 - share)
        } else {
            let missed = libm::erfc(half);
            (1.0 - missed, missed)
        };
        Perceived { share, missed }
    }

    /// The probability ½ + (½ − λ)F of a right answer.
    pub fn right(self, lapse: f64) -> f64 {
        0.5 + (0.5 - lapse) * self.share
    }

    /// That of a wrong one.
    pub fn wrong(self, lapse: f64) -> f64 {
        0.5 * self.missed + lapse * self.share
    }

    /// The log-likelihood of a count.
    pub fn log_likelihood(self, count: Count, lapse: f64) -> f64 {
        times_log(count.right, self.right(lapse)) + times_log(count.wrong, self.wrong(lapse))
    }
}

/// Twice the log-likelihood that a share of its own for each of `counts` gains.
pub fn deviance<'a>(counts: impl IntoIterator<Item = &'a Count>, log_likelihood: f64) -> f64 {
    let saturated: f64 = counts.into_iter().map(|count| count.saturated()).sum();
    2.0 * (saturated - log_likelihood).max(0.0)
}

/// The log-likelihood of counts at several inclusions.
pub fn log_likelihood(counts: &[Count], perceived: &[Perceived], lapse: f64) -> f64 {
    let of = |(&count, perceived): (&Count, &Perceived)| perceived.log_likelihood(count, lapse);
    counts.iter().zip(perceived).map(of).sum()
}

/// The share of lapses, from 0 to ½, with the largest likelihood, which is concave in it.
pub fn best_lapse(counts: &[Count], perceived: &[Perceived]) -> f64 {
    let rises = |lapse: f64| {
        let slope = |(count, perceived): (&Count, &Perceived)| {
            let quotient = |n: f64, p: f64| if n == 0.0 { 0.0 } else { n / p };
            let towards_wrong = quotient(count.wrong, perceived.wrong(lapse));
            perceived.share * (towards_wrong - quotient(count.right, perceived.right(lapse)))
        };
        counts.iter().zip(perceived).map(slope).sum::<f64>() > 0.0
    };
    if !rises(0.0) {
        return 0.0;
    }
    change(rises, 0.0, 0.5)
}
