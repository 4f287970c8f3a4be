//! How much subjects differ, and what follows for their pooled counts.

use palpate::stats::dispersion::dispersion;
use palpate::stats::noncentral::f_ratio;

use super::{Condition, Result};

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
