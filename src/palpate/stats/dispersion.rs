//! Whether counts of several subjects differ more than chance allows: χ² against one common share.

use super::NumericError;
use super::tails::chi_square_tail;

/// Expected counts below this make the chi-square law rough (Cochran's rule).
const ROUGH_BELOW: f64 = 5.0;

/// χ² of the subjects against one share of right answers for all.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
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
/// Never for counts that fit their trials, of at least one pair each.
///
/// Implements: PSY-031, ERR-007.
pub fn dispersion(counts: &[(u32, u32)]) -> Result<Option<Dispersion>, NumericError> {
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
