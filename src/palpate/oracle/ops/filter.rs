//! The matched filter, Θ in white and coloured noise, and the scan.

use serde::Serialize;

use super::{List, Refused, Rows, answer};
use crate::detect::coloured::{ColouredStatistic, coloured_scratch, theta_coloured};
use crate::detect::scan::Scan;
use crate::detect::{MatchedFilter, theta_of_record};
use crate::force::Force;
use crate::stats::NumericError;

/// Most rows of a covariance: its factorisation takes n³/6 products.
const MOST_ROWS: usize = 1000;
/// Most products of a scan in each channel.
const MOST_PRODUCTS: usize = 10_000_000;

/// The samples of either channel.
type Samples = [List<f64>; 2];

fn force([List(x), List(y)]: &Samples) -> Force<&[f64]> {
    Force::new(x, y)
}

/// b, σ and γ of a template.
pub fn matched_filter(template: Samples, [x, y]: [f64; 2]) -> Result<impl Serialize, NumericError> {
    let filter = MatchedFilter::new(force(&template), Force::new(x, y))?;
    let [b_x, b_y] = filter.b().into_array();
    let [sigma_x, sigma_y] = filter.sigma().into_array();
    Ok(answer! { b_x, b_y, sigma_x, sigma_y, gamma: filter.gamma() })
}

/// θ, y(0) and γ of a record.
pub fn theta(
    observed: Samples,
    f0: Samples,
    f1: Samples,
    [x, y]: [f64; 2],
) -> Result<impl Serialize, NumericError> {
    let found = theta_of_record(force(&observed), force(&f0), force(&f1), Force::new(x, y))?;
    let [y_x, y_y] = found.y.into_array();
    Ok(answer! { theta: found.theta, y_x, y_y, gamma: found.gamma })
}

/// θ and γ in coloured noise.
///
/// Implements: ORA-011.
pub fn theta_colored(
    residual: &[f64],
    template: &[f64],
    covariance: &Rows,
) -> Result<ColouredStatistic, Refused> {
    let order = template.len();
    if order > MOST_ROWS {
        let wrong = format_args!("template has {order} samples, but may have at most {MOST_ROWS}");
        return Err(Refused::range(wrong));
    }
    if order % 2 == 1 {
        let right = "must have as many lateral as normal ones";
        let wrong = format_args!("template has {order} samples, but {right}");
        return Err(Refused::argument(wrong));
    }
    let covariance = covariance.concat("covariance", order, order)?;
    let mut scratch = vec![0.0; coloured_scratch(order)];
    Ok(theta_coloured(
        residual,
        template,
        &covariance,
        &mut scratch,
    )?)
}

/// Θ at every shift with the whole template in the record, and the largest.
///
/// Implements: ORA-011.
pub fn scan(
    residual: Samples,
    template: Samples,
    [x, y]: [f64; 2],
) -> Result<impl Serialize, Refused> {
    let (residual, template) = (force(&residual), force(&template));
    let (samples, length) = (residual.lateral.len(), template.lateral.len());
    if length.saturating_mul((samples + 1).saturating_sub(length)) > MOST_PRODUCTS {
        return Err(Refused::range(format_args!(
            "template_x of {length} samples on {samples} takes more than {MOST_PRODUCTS} products"
        )));
    }
    let scan = Scan::new(samples, template, Force::new(x, y))?;
    let mut theta = vec![0.0; samples - length + 1];
    scan.theta(residual, 0, &mut theta)?;
    let maximum = scan.maximum(residual, scan.full_shifts())?;
    let argmax = maximum.shift.unsigned_abs();
    Ok(answer! { theta, max_theta: maximum.theta, argmax })
}
