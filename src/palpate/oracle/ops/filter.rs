//! The matched filter, Θ in white and coloured noise, and the scan.

use serde::Serialize;

use super::{List, Refused, Rows, arguments};
use crate::detect::coloured::{ColouredStatistic, coloured_scratch, theta_coloured};
use crate::detect::scan::Scan;
use crate::detect::{MatchedFilter, theta_of_record};
use crate::force::Force;
use crate::stats::NumericError;

/// Most rows of a covariance: its factorisation takes n³/6 products.
const MOST_ROWS: usize = 1000;
/// Most products of a scan in each channel.
const MOST_PRODUCTS: usize = 10_000_000;

arguments! {
    Template { template_x: List<f64>, template_y: List<f64>, noise_sd_x: f64, noise_sd_y: f64 }
}
arguments! {
    Record {
        observed_x: List<f64>,
        observed_y: List<f64>,
        f0_x: List<f64>,
        f0_y: List<f64>,
        f1_x: List<f64>,
        f1_y: List<f64>,
        noise_sd_x: f64,
        noise_sd_y: f64,
    }
}
arguments! { Coloured { residual: List<f64>, template: List<f64>, covariance: Rows } }
arguments! {
    Scanned {
        residual_x: List<f64>,
        residual_y: List<f64>,
        template_x: List<f64>,
        template_y: List<f64>,
        noise_sd_x: f64,
        noise_sd_y: f64,
    }
}

/// The samples of either channel.
fn series<'a>(List(x): &'a List<f64>, List(y): &'a List<f64>) -> Force<&'a [f64]> {
    Force::new(x, y)
}

/// b, σ and γ of a template.
#[derive(Debug, Serialize)]
pub struct Filter {
    b_x: f64,
    b_y: f64,
    sigma_x: f64,
    sigma_y: f64,
    gamma: f64,
}

/// The filter for a template.
pub fn matched_filter(arguments: Template) -> Result<Filter, NumericError> {
    let template = series(&arguments.template_x, &arguments.template_y);
    let noise_sd = Force::new(arguments.noise_sd_x, arguments.noise_sd_y);
    let filter = MatchedFilter::new(template, noise_sd)?;
    let [b_x, b_y] = filter.b().into_array();
    let [sigma_x, sigma_y] = filter.sigma().into_array();
    let gamma = filter.gamma();
    Ok(Filter {
        b_x,
        b_y,
        sigma_x,
        sigma_y,
        gamma,
    })
}

/// θ, y(0) and γ of a record.
#[derive(Debug, Serialize)]
pub struct Theta {
    theta: f64,
    y_x: f64,
    y_y: f64,
    gamma: f64,
}

/// What a record says in white noise.
pub fn theta(arguments: Record) -> Result<Theta, NumericError> {
    let observed = series(&arguments.observed_x, &arguments.observed_y);
    let f0 = series(&arguments.f0_x, &arguments.f0_y);
    let f1 = series(&arguments.f1_x, &arguments.f1_y);
    let noise_sd = Force::new(arguments.noise_sd_x, arguments.noise_sd_y);
    let found = theta_of_record(observed, f0, f1, noise_sd)?;
    Ok(Theta {
        theta: found.theta,
        y_x: found.y.lateral,
        y_y: found.y.normal,
        gamma: found.gamma,
    })
}

/// θ and γ in coloured noise.
///
/// Implements: ORA-011.
pub fn theta_colored(arguments: Coloured) -> Result<ColouredStatistic, Refused> {
    let Coloured {
        residual: List(residual),
        template: List(template),
        covariance,
    } = arguments;
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
        &residual,
        &template,
        &covariance,
        &mut scratch,
    )?)
}

/// Θ at every shift with the whole template in the record, and the largest.
#[derive(Debug, Serialize)]
pub struct Shifts {
    theta: Vec<f64>,
    max_theta: f64,
    argmax: usize,
}

/// Scans a record for a template.
///
/// Implements: ORA-011.
pub fn scan(arguments: Scanned) -> Result<Shifts, Refused> {
    let residual = series(&arguments.residual_x, &arguments.residual_y);
    let template = series(&arguments.template_x, &arguments.template_y);
    let noise_sd = Force::new(arguments.noise_sd_x, arguments.noise_sd_y);
    let (samples, length) = (residual.lateral.len(), template.lateral.len());
    if length.saturating_mul((samples + 1).saturating_sub(length)) > MOST_PRODUCTS {
        return Err(Refused::range(format_args!(
            "template_x of {length} samples on {samples} takes more than {MOST_PRODUCTS} products"
        )));
    }
    let scan = Scan::new(samples, template, noise_sd)?;
    let mut theta = vec![0.0; samples - length + 1];
    scan.theta(residual, 0, &mut theta)?;
    let maximum = scan.maximum(residual, scan.full_shifts())?;
    Ok(Shifts {
        theta,
        max_theta: maximum.theta,
        argmax: maximum.shift.unsigned_abs(),
    })
}
