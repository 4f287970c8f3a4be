//! The normal law.

use super::super::{Answer, Arguments, Refusal};
use crate::stats::normal;

/// Φ(x).
pub fn cdf(arguments: &mut Arguments) -> Result<Answer, Refusal> {
    let x = arguments.number("x")?;
    Ok(Answer::default().with("p", normal::cdf(x)?))
}

/// Φ⁻¹(p).
pub fn quantile(arguments: &mut Arguments) -> Result<Answer, Refusal> {
    let p = arguments.number("p")?;
    Ok(Answer::default().with("x", normal::quantile(p)?))
}
