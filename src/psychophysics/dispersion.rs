//! Whether subjects differ more than chance allows: χ² against one common share.

use serde::Serialize;

use super::{Condition, PsychophysicsError};
use crate::stats::tails::{chi_square_tail, f_tail};

/// Expected counts below this make the chi-square law rough (Cochran's rule).
const ROUGH_BELOW: f64 = 5.0;

/// χ² of the subjects against one share of right answers for all.
///
/// ```
/// use palpate::psychophysics::dispersion;
///
/// // With 4 pairs a subject the chi-square law is rough.
/// let found = dispersion(&[(1, 4), (3, 4)])?;
/// assert!(found.is_some_and(|found| found.smallest_expected == 2.0 && found.is_rough));
/// # Ok::<(), palpate::psychophysics::PsychophysicsError>(())
/// ```
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
/// ```
/// use palpate::psychophysics::dispersion;
///
/// // Each 5 from the 15 of 30 expected: χ² = 2 · 25/7.5.
/// let found = dispersion(&[(10, 30), (20, 30)])?;
/// assert!(found.is_some_and(|found| (found.chi_square - 20.0 / 3.0).abs() < 1e-12));
/// assert_eq!(dispersion(&[(30, 30), (30, 30)])?, None);
/// # Ok::<(), palpate::psychophysics::PsychophysicsError>(())
/// ```
///
/// # Errors
/// Never for counts that fit their trials.
///
/// Implements: PSY-031, ERR-007.
pub fn dispersion(counts: &[(u32, u32)]) -> Result<Option<Dispersion>, PsychophysicsError> {
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

/// χ² per degree of freedom over the first `inclusions` columns, and its degrees of freedom; `None` where
/// no inclusion has a χ².
///
/// # Errors
/// As [`dispersion`].
///
/// Implements: PSY-034.
pub fn overall_dispersion(
    condition: &Condition,
    inclusions: usize,
) -> Result<Option<(f64, u32)>, PsychophysicsError> {
    let (mut chi_square, mut degrees) = (0.0, 0);
    for column in 0..inclusions {
        if let Some(found) = dispersion(&condition.counts(column))? {
            chi_square += found.chi_square;
            degrees += found.degrees;
        }
    }
    Ok((degrees > 0).then(|| (chi_square / f64::from(degrees), degrees)))
}

/// How much the subjects of a condition differ: φ and its degrees of freedom.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Overdispersion {
    /// χ² per degree of freedom, at least 1.
    pub factor: f64,
    /// Its degrees of freedom.
    pub degrees: f64,
}

impl Overdispersion {
    /// The p-value of a deviance by the F law; `None` without degrees of freedom.
    ///
    /// Implements: PSY-043.
    pub fn p_value(self, deviance: f64, degrees: u32) -> Result<Option<f64>, PsychophysicsError> {
        if degrees == 0 {
            return Ok(None);
        }
        let degrees = f64::from(degrees);
        let ratio = deviance / degrees / self.factor;
        Ok(Some(f_tail(ratio, degrees, self.degrees)?))
    }
}

impl From<(f64, u32)> for Overdispersion {
    fn from((ratio, degrees): (f64, u32)) -> Overdispersion {
        Overdispersion {
            // Answers that vary less than chance allows are no reason for narrower intervals.
            factor: ratio.max(1.0),
            degrees: f64::from(degrees),
        }
    }
}
