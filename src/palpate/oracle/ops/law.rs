//! Tails of the laws of quadratic statistics.

use super::{Answer, Arguments, Refused};
use crate::stats::noncentral::{self, Tails};

/// Of chi-square.
pub fn chi_square(arguments: &mut Arguments) -> Result<Answer, Refused> {
    let [x, degrees, noncentrality] = arguments.each(["x", "degrees", "noncentrality"])?;
    Ok(answer(noncentral::chi_square(x, degrees, noncentrality)?))
}

/// Of F.
pub fn f_ratio(arguments: &mut Arguments) -> Result<Answer, Refused> {
    let [x, numerator, denominator, noncentrality] =
        arguments.each(["x", "numerator", "denominator", "noncentrality"])?;
    let tails = noncentral::f_ratio(x, numerator, denominator, noncentrality)?;
    Ok(answer(tails))
}

/// Of Student's t.
pub fn student(arguments: &mut Arguments) -> Result<Answer, Refused> {
    let [x, degrees, noncentrality] = arguments.each(["x", "degrees", "noncentrality"])?;
    Ok(answer(noncentral::student(x, degrees, noncentrality)?))
}

fn answer(tails: Tails) -> Answer {
    Answer::of([("lower", tails.lower), ("upper", tails.upper)])
}
