//! The ops by name.

// An answer has a type for each of its values, of the value's name.
#![allow(non_camel_case_types)]

mod counts;
mod decision;
mod element;
mod filter;
mod hid_report;
mod interpolation;
mod nuisance;
mod probe;
mod robust;
mod sequential;
mod servo;

use super::answer::{Code, Refused, answer, json};
use super::arguments::{Bits, List, Rows, Whole, arguments_of, with_arguments};
use crate::detect;
use crate::detect::noise_budget::noise_budget;
use crate::refusal::did_you_mean;
use crate::stats::{noncentral, normal};
use counts::MOST_TRIALS;
pub use probe::Models;

/// An op.
#[derive(Debug, Clone, Copy)]
pub struct Op {
    /// Its name in a request.
    pub name: &'static str,
    /// The JSON text of its answer, from that of its arguments.
    pub function: fn(&str, &mut Models) -> Result<Vec<u8>, Refused>,
}

/// An op: its name, its arguments, and its answer to them. An op of a text reads the arguments itself.
macro_rules! op {
    ($name:literal, $text:ident => $answer:expr) => {
        Op { name: $name, function: |$text, _| json($answer) }
    };
    ($name:literal, $arguments:tt => $answer:expr) => {
        Op {
            name: $name,
            function: |text, _| with_arguments!(text, $arguments => json($answer)),
        }
    };
    ($name:literal, $arguments:tt, $models:ident => $answer:expr) => {
        Op {
            name: $name,
            function: |text, $models| with_arguments!(text, $arguments => json($answer)),
        }
    };
}

/// All ops.
///
/// Implements: ORA-020.
pub const OPS: &[Op] = &[
    op!("capabilities", {} => answer! { version: env!("CARGO_PKG_VERSION"), ops: names() }),
    op!("normal_cdf", { x: f64 } => answer! { p: normal::cdf(x)? }),
    op!("normal_quantile", { p: f64 } => answer! { x: normal::quantile(p)? }),
    op!("matched_filter", {
        template_x: List<f64>, template_y: List<f64>, noise_sd_x: f64, noise_sd_y: f64
    } => filter::matched_filter([template_x, template_y], [noise_sd_x, noise_sd_y])?),
    op!("theta", {
        observed_x: List<f64>, observed_y: List<f64>, f0_x: List<f64>, f0_y: List<f64>,
        f1_x: List<f64>, f1_y: List<f64>, noise_sd_x: f64, noise_sd_y: f64
    } => filter::theta([observed_x, observed_y], [f0_x, f0_y], [f1_x, f1_y], [noise_sd_x, noise_sd_y])?),
    op!("theta_colored", { residual: List<f64>, template: List<f64>, covariance: Rows } =>
        filter::theta_colored(&residual.0, &template.0, &covariance)?),
    op!("theta_nuisances", {
        residual: List<f64>, template: List<f64>, nuisances: Rows, level: String, bias: f64, eta: f64
    } => nuisance::theta(residual, template, &nuisances, &level, bias, eta)?),
    op!("bank_posterior", {
        residual: List<f64>, templates: Rows, nuisances: Rows, level: String, prior: List<f64>, prior_h1: f64
    } => nuisance::bank_posterior(&residual.0, &templates, &nuisances, &level, &prior.0, prior_h1)?),
    op!("robust_evidence", {
        record: List<f64>, noise: List<f64>, weights: List<f64>, covariances: Rows, signals: Rows, sizes: List<f64>,
        prior: List<f64>, shape: Rows
    } => robust::evidence_of(
        [record.0, noise.0], (&weights.0, &covariances), (&signals, &sizes.0, &prior.0), &shape)?),
    op!("sequential_evidence", {
        residual: List<f64>, templates: Rows, nuisances: Rows, max_false_alarm: f64, max_miss: f64
    } => sequential::sequential(&residual.0, &templates, &nuisances, [max_false_alarm, max_miss])?),
    op!("threshold", text => answer! { eta: decision::threshold(text)? }),
    op!("error_rates", { gamma: f64, eta: f64 } => detect::error_rates(gamma, eta)?),
    op!("roc", { gamma: f64, false_alarm: List<f64> } => decision::roc(gamma, &false_alarm.0)?),
    op!("required_gamma", { max_false_alarm: f64, max_miss: f64 } =>
        answer! { gamma: detect::required_gamma(max_false_alarm, max_miss)? }),
    op!("two_afc", { gamma: f64 } => answer! { p_correct: detect::two_afc(gamma)? }),
    op!("gamma_from_two_afc", { p_correct: f64 } =>
        answer! { gamma: detect::gamma_from_two_afc(p_correct)? }),
    op!("proportion_interval", {
        successes: Whole<0, MOST_TRIALS>, trials: Whole<1, MOST_TRIALS>, confidence: f64, method: String
    } => counts::interval(successes, trials, confidence, &method)?),
    op!("chi_square_tail", { x: f64, degrees: f64, noncentrality: f64 } =>
        noncentral::chi_square(x, degrees, noncentrality)?),
    op!("f_tail", { x: f64, numerator: f64, denominator: f64, noncentrality: f64 } =>
        noncentral::f_ratio(x, numerator, denominator, noncentrality)?),
    op!("student_tail", { x: f64, degrees: f64, noncentrality: f64 } =>
        noncentral::student(x, degrees, noncentrality)?),
    op!("noise_budget", { signal_n: f64, max_false_alarm: f64, max_miss: f64, sources_n: List<f64> } =>
        noise_budget(signal_n, max_false_alarm, max_miss, &sources_n.0)?),
    op!("interpolate", {
        depths_m: List<f64>, laterals_m: List<f64>, table_n: Rows, depth_m: f64, lateral_m: f64
    } => interpolation::interpolate(&depths_m.0, &laterals_m.0, &table_n, depth_m, lateral_m)?),
    op!("scan", {
        residual_x: List<f64>, residual_y: List<f64>, template_x: List<f64>, template_y: List<f64>,
        noise_sd_x: f64, noise_sd_y: f64
    } => filter::scan([residual_x, residual_y], [template_x, template_y], [noise_sd_x, noise_sd_y])?),
    op!("element_stiffness", { nodes_m: Rows, youngs_modulus_pa: f64, poissons_ratio: f64 } =>
        element::stiffness(&nodes_m, youngs_modulus_pa, poissons_ratio)?),
    op!("servo_axis", { knots: List<f64>, coordinate_bits: Bits } =>
        servo::axis(&knots, coordinate_bits)?),
    op!("servo_interpolate", {
        depth_knots: List<f64>, lateral_knots: List<f64>, table_bits: List<List<Bits>>,
        depth_bits: Bits, lateral_bits: Bits
    } => servo::interpolate(&depth_knots, &lateral_knots, &table_bits, depth_bits, lateral_bits)?),
    op!("report_decode", { bytes: String } => hid_report::decode(&bytes)?),
    op!("report_encode", text => answer! { bytes: hid_report::encode(text)? }),
    op!("count_analysis", { correct: Rows, trials: Whole<1, MOST_TRIALS> } =>
        counts::analysis(&correct, trials)?),
    op!("probe_force", { phantom: String, depth_m: f64, lateral_m: f64, strain: Option<String> }, models =>
        probe::force(phantom, depth_m, lateral_m, strain, models)?),
];

/// The op of that name.
///
/// # Errors
/// [`Code::UnknownOp`].
pub fn find(name: &str) -> Result<&'static Op, Refused> {
    OPS.iter().find(|op| op.name == name).ok_or_else(|| {
        let similar = did_you_mean(name, names());
        let names = names().join(", ");
        let unknown = format_args!("unknown op {name:?}{similar}; the ops are {names}");
        Refused::new(Code::UnknownOp, unknown)
    })
}

fn names() -> Vec<&'static str> {
    OPS.iter().map(|op| op.name).collect()
}
