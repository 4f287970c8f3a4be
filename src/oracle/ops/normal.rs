//! The normal law.

use super::{Answer, Arguments, Refused};
use crate::stats::normal;

/// Φ(x).
pub fn cdf(arguments: &mut Arguments) -> Result<Answer, Refused> {
    let p = normal::cdf(arguments.number("x")?).map_err(Refused::range)?;
    Ok(Answer::default().with("p", p))
}

/// Φ⁻¹(p).
pub fn quantile(arguments: &mut Arguments) -> Result<Answer, Refused> {
    let x = normal::quantile(arguments.number("p")?).map_err(Refused::range)?;
    Ok(Answer::default().with("x", x))
}
