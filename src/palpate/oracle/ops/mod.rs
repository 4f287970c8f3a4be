//! The ops by name.

mod counts;
mod decision;
mod element;
mod filter;
mod interpolation;
mod law;
mod nuisance;
mod probe;
mod proportion;
mod report;
mod servo;

use super::answer::{Answer, Code, Refused};
use super::arguments::{Arguments, Bits, check_rows};
use crate::detect;
use crate::stats::{NumericError, normal};

/// What computes an answer from arguments.
pub type Function = fn(&mut Arguments) -> Result<Answer, Refused>;

/// An op.
#[derive(Debug, Clone, Copy)]
pub struct Op {
    /// Its name in a request.
    pub name: &'static str,
    /// The names of its arguments.
    pub arguments: &'static str,
    /// What answers it.
    pub function: Function,
}

const fn op(name: &'static str, arguments: &'static str, function: Function) -> Op {
    Op {
        name,
        arguments,
        function,
    }
}

// Arguments of the ops that have many.
const TEMPLATE: &str = "template_x template_y noise_sd_x noise_sd_y";
const RECORD: &str = "observed_x observed_y f0_x f0_y f1_x f1_y noise_sd_x noise_sd_y";
const SCAN: &str = "residual_x residual_y template_x template_y noise_sd_x noise_sd_y";
const CRITERIA: &str = "criterion prior_h1 c00 c01 c10 c11 gamma max_miss max_false_alarm";
const BUDGET: &str = "signal_n max_false_alarm max_miss sources_n";
const MAP_AND_POSE: &str = "depths_m laterals_m table_n depth_m lateral_m";
const TABLE_AND_POSE: &str = "depth_knots lateral_knots table_bits depth_bits lateral_bits";
const ELEMENT: &str = "nodes_m youngs_modulus_pa poissons_ratio";
const PROPORTION: &str = "successes trials confidence method";
const LAW: &str = "x degrees noncentrality";
const LAW_OF_RATIO: &str = "x numerator denominator noncentrality";
const COLOURED: &str = "residual template covariance";
const BESIDE_NUISANCES: &str = "residual template nuisances level bias eta";
const BANK: &str = "residual templates nuisances level prior prior_h1";

/// All ops.
///
/// Implements: ORA-020.
pub const OPS: &[Op] = &[
    op("capabilities", "", capabilities),
    op("normal_cdf", "x", |a| number(a, "x", "p", normal::cdf)),
    op("normal_quantile", "p", |a| {
        number(a, "p", "x", normal::quantile)
    }),
    op("matched_filter", TEMPLATE, filter::matched_filter),
    op("theta", RECORD, filter::theta),
    op("theta_colored", COLOURED, filter::theta_colored),
    op("theta_nuisances", BESIDE_NUISANCES, nuisance::theta),
    op("bank_posterior", BANK, nuisance::bank_posterior),
    op("threshold", CRITERIA, decision::threshold),
    op("error_rates", "gamma eta", decision::error_rates),
    op("roc", "gamma false_alarm", decision::roc),
    op(
        "required_gamma",
        "max_false_alarm max_miss",
        decision::required_gamma,
    ),
    op("two_afc", "gamma", |a| {
        number(a, "gamma", "p_correct", detect::two_afc)
    }),
    op("gamma_from_two_afc", "p_correct", |a| {
        number(a, "p_correct", "gamma", detect::gamma_from_two_afc)
    }),
    op("proportion_interval", PROPORTION, proportion::interval),
    op("chi_square_tail", LAW, law::chi_square),
    op("f_tail", LAW_OF_RATIO, law::f_ratio),
    op("student_tail", LAW, law::student),
    op("noise_budget", BUDGET, decision::noise_budget),
    op("interpolate", MAP_AND_POSE, interpolation::interpolate),
    op("scan", SCAN, filter::scan),
    op("element_stiffness", ELEMENT, element::stiffness),
    op("servo_axis", "knots coordinate_bits", servo::axis),
    op("servo_interpolate", TABLE_AND_POSE, servo::interpolate),
    op("report_decode", "bytes", report::decode),
    op("report_encode", report::FIELDS, report::encode),
    op("count_analysis", "correct trials", counts::analysis),
    op("probe_force", "phantom depth_m lateral_m", probe::force),
];

/// The op of that name.
///
/// # Errors
/// [`Code::UnknownOp`].
pub fn find(name: &str) -> Result<&'static Op, Refused> {
    OPS.iter().find(|op| op.name == name).ok_or_else(|| {
        let names: Vec<&str> = OPS.iter().map(|op| op.name).collect();
        let names = names.join(", ");
        let unknown = format_args!("unknown op {name:?}: expected one of {names}");
        Refused::new(Code::UnknownOp, unknown)
    })
}

/// What `function` makes of the number `name`, as the number `result`.
fn number(
    arguments: &mut Arguments,
    name: &'static str,
    result: &'static str,
    function: fn(f64) -> Result<f64, NumericError>,
) -> Result<Answer, Refused> {
    Ok(Answer::of([(result, function(arguments.number(name)?)?)]))
}

/// Implements: ORA-020.
fn capabilities(_: &mut Arguments) -> Result<Answer, Refused> {
    let names: Vec<&str> = OPS.iter().map(|op| op.name).collect();
    let version = env!("CARGO_PKG_VERSION");
    Ok(Answer::of([("version", version)]).with("ops", names))
}
