//! The matched filter, Θ in white and coloured noise, and the scan.

use super::{Answer, Arguments, Refused, check_rows};
use crate::detect::coloured::{coloured_scratch, theta_coloured};
use crate::detect::scan::Scan;
use crate::detect::{MatchedFilter, theta_of_record};
use crate::force::Force;

/// Most rows of a covariance: its factorisation takes n³/6 products.
const MOST_ROWS: usize = 1000;
/// Most products of a scan in each channel.
const MOST_PRODUCTS: usize = 10_000_000;

fn noise_sd(arguments: &mut Arguments) -> Result<Force<f64>, Refused> {
    let [x, y] = arguments.each(["noise_sd_x", "noise_sd_y"])?;
    Ok(Force::new(x, y))
}

fn series(
    arguments: &mut Arguments,
    x: &'static str,
    y: &'static str,
) -> Result<Force<Vec<f64>>, Refused> {
    Ok(Force::new(arguments.numbers(x)?, arguments.numbers(y)?))
}

/// b, σ and γ of a template.
pub fn matched_filter(arguments: &mut Arguments) -> Result<Answer, Refused> {
    let template = series(arguments, "template_x", "template_y")?;
    let noise_sd = noise_sd(arguments)?;
    let filter = MatchedFilter::new(template.as_deref(), noise_sd)?;
    let (b, sigma) = (filter.b(), filter.sigma());
    Ok(Answer::of([
        ("b_x", b.lateral),
        ("b_y", b.normal),
        ("sigma_x", sigma.lateral),
        ("sigma_y", sigma.normal),
        ("gamma", filter.gamma()),
    ]))
}

/// θ, y(0) and γ of a record.
pub fn theta(arguments: &mut Arguments) -> Result<Answer, Refused> {
    let observed = series(arguments, "observed_x", "observed_y")?;
    let f0 = series(arguments, "f0_x", "f0_y")?;
    let f1 = series(arguments, "f1_x", "f1_y")?;
    let noise_sd = noise_sd(arguments)?;
    let found = theta_of_record(observed.as_deref(), f0.as_deref(), f1.as_deref(), noise_sd)?;
    Ok(Answer::of([
        ("theta", found.theta),
        ("y_x", found.y.lateral),
        ("y_y", found.y.normal),
        ("gamma", found.gamma),
    ]))
}

/// θ and γ in coloured noise.
pub fn theta_colored(arguments: &mut Arguments) -> Result<Answer, Refused> {
    let residual = arguments.numbers("residual")?;
    let template = arguments.numbers("template")?;
    let covariance = arguments.rows("covariance")?;
    let order = template.len();
    if order > MOST_ROWS {
        let wrong = format_args!("template has {order} samples, expected at most {MOST_ROWS}");
        return Err(Refused::range(wrong));
    }
    if order % 2 == 1 {
        let expected = "expected as many lateral as normal ones";
        let wrong = format_args!("template has {order} samples, {expected}");
        return Err(Refused::argument(wrong));
    }
    let words = [order, order].map(|order| order.to_string());
    check_rows("covariance", &covariance, [order; 2], words)?;
    let mut scratch = vec![0.0; coloured_scratch(order)];
    let found = theta_coloured(&residual, &template, &covariance.concat(), &mut scratch)?;
    Ok(Answer::of([("theta", found.theta), ("gamma", found.gamma)]))
}

/// Θ at every shift with the whole template in the record.
///
/// Implements: ORA-011.
pub fn scan(arguments: &mut Arguments) -> Result<Answer, Refused> {
    let residual = series(arguments, "residual_x", "residual_y")?;
    let template = series(arguments, "template_x", "template_y")?;
    let noise_sd = noise_sd(arguments)?;
    let (samples, length) = (residual.lateral.len(), template.lateral.len());
    if length.saturating_mul((samples + 1).saturating_sub(length)) > MOST_PRODUCTS {
        return Err(Refused::range(format_args!(
            "template_x of {length} samples on {samples} takes more than {MOST_PRODUCTS} products"
        )));
    }
    let scan = Scan::new(samples, template.as_deref(), noise_sd)?;
    let mut theta = vec![0.0; samples - length + 1];
    scan.theta(residual.as_deref(), 0, &mut theta)?;
    let maximum = scan.maximum(residual.as_deref(), scan.full_shifts())?;
    Ok(Answer::of([("theta", theta)])
        .with("max_theta", maximum.theta)
        .with("argmax", maximum.shift.unsigned_abs()))
}
