//! Whether subjects differ more than chance allows: χ² against one common share.

use serde::Serialize;

use super::{Condition, Result};
use crate::stats::noncentral::f_ratio;
use crate::stats::tails::chi_square_tail;

/// Expected counts below this make the chi-square law rough (Cochran's rule).
const ROUGH_BELOW: f64 = 5.0;

/// χ² of the subjects against one share of right answers for all.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Dispersion {
    /// Σ (kᵢ − nᵢp̂)²/(nᵢ p̂ (1−p̂)).
    pub chi_square: f64,
    /// Subjects less one.
    pub degrees: u32,
    /// χ² per degree of freedom: 1 if answers were all alike.
    pub ratio: f64,
    /// Pr(X ≥ χ²) by the chi-square law.
    pub p_value: f64,
    /// The smallest expected number of right or wrong answers of a subject.
    pub smallest_expected: f64,
    /// Whether that is below 5, so that the p-value is rough.
    pub is_rough: bool,
}

/// χ² of the counts (right answers, pairs); `None` for one subject, or if all answers are right or
/// all wrong.
///
/// # Errors
/// Never for counts that fit their trials.
///
/// Implements: PSY-031, ERR-007.
pub fn dispersion(counts: &[(u32, u32)]) -> Result<Option<Dispersion>> {
    let sum = |part: fn(&(u32, u32)) -> u32| counts.iter().map(part).map(f64::from).sum::<f64>();
    let (correct, trials) = (sum(|count| count.0), sum(|count| count.1));
    if counts.len() < 2 || correct == 0.0 || correct == trials {
        return Ok(None);
    }
    let (right, wrong) = (correct / trials, (trials - correct) / trials);
    let (mut chi_square, mut smallest_expected) = (0.0, f64::MAX);
    for &(k, n) in counts {
        let n = f64::from(n);
        let excess = f64::from(k) - n * right;
        chi_square += excess * excess / (n * right * wrong);
        smallest_expected = smallest_expected.min(n * right.min(wrong));
    }
    let degrees = counts.len() as u32 - 1;
    Ok(Some(Dispersion {
        chi_square,
        degrees,
        ratio: chi_square / f64::from(degrees),
        p_value: chi_square_tail(chi_square, f64::from(degrees))?,
        smallest_expected,
        is_rough: smallest_expected < ROUGH_BELOW,
    }))
}

/// How much the subjects of a condition differ.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Overdispersion {
    /// χ² per degree of freedom.
    pub ratio: f64,
    /// Its degrees of freedom.
    pub degrees: u32,
}

impl Overdispersion {
    /// χ² over the first `inclusions` columns; `None` where no inclusion has one.
    ///
    /// # Errors
    /// As [`dispersion`].
    ///
    /// Implements: PSY-034.
    pub fn new(condition: &Condition, inclusions: usize) -> Result<Option<Self>> {
        let (mut chi_square, mut degrees) = (0.0, 0);
        for column in 0..inclusions {
            if let Some(found) = dispersion(&condition.counts(column))? {
                chi_square += found.chi_square;
                degrees += found.degrees;
            }
        }
        let ratio = chi_square / f64::from(degrees);
        Ok((degrees > 0).then_some(Overdispersion { ratio, degrees }))
    }

    /// φ, at least 1: answers that vary less than chance allows are no reason for narrower intervals.
    ///
    /// Implements: PSY-034.
    pub fn factor(self) -> f64 {
        self.ratio.max(1.0)
    }

    /// The p-value of a deviance by the F law; `None` without degrees of freedom.
    ///
    /// Implements: PSY-042.
    pub fn p_value(self, deviance: f64, degrees: u32) -> Result<Option<f64>> {
        if degrees == 0 {
            return Ok(None);
        }
        let ratio = deviance / f64::from(degrees) / self.factor();
        let p_value = f_ratio(ratio, f64::from(degrees), f64::from(self.degrees), 0.0)?;
        Ok(Some(p_value.upper))
    }
}
