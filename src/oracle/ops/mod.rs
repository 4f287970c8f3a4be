//! The ops by name.

mod counts;
mod decision;
mod element;
mod filter;
mod interpolation;
mod normal;
mod probe;
mod proportion;
mod report;
mod servo;

pub use probe::Models;

use super::{Answer, Arguments, Code, Refusal};

/// What computes an answer from arguments.
pub type Function = fn(&mut Models, &mut Arguments) -> Result<Answer, Refusal>;

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

macro_rules! ops {
    ($($name:literal ($arguments:literal) => $function:path),* $(,)?) => {
        &[$(Op {
            name: $name,
            arguments: $arguments,
            function: |_, arguments| $function(arguments),
        }),*]
    };
}

/// The ops that need nothing but their arguments.
const PLAIN: &[Op] = ops![
    "capabilities" ("") => capabilities,
    "normal_cdf" ("x") => normal::cdf,
    "normal_quantile" ("p") => normal::quantile,
    "matched_filter" ("template_x template_y noise_sd_x noise_sd_y") => filter::matched_filter,
    "theta" ("observed_x observed_y f0_x f0_y f1_x f1_y noise_sd_x noise_sd_y") => filter::theta,
    "theta_colored" ("residual template covariance") => filter::theta_colored,
    "threshold" ("criterion prior_h1 c00 c01 c10 c11 gamma max_miss max_false_alarm") => decision::threshold,
    "error_rates" ("gamma eta") => decision::error_rates,
    "roc" ("gamma false_alarm") => decision::roc,
    "required_gamma" ("max_false_alarm max_miss") => decision::required_gamma,
    "two_afc" ("gamma") => decision::two_afc,
    "gamma_from_two_afc" ("p_correct") => decision::gamma_from_two_afc,
    "proportion_interval" ("successes trials confidence method") => proportion::interval,
    "noise_budget" ("signal_n max_false_alarm max_miss sources_n") => decision::noise_budget,
    "interpolate" ("depths_m laterals_m table_n depth_m lateral_m") => interpolation::interpolate,
    "scan" ("residual_x residual_y template_x template_y noise_sd_x noise_sd_y") => filter::scan,
    "element_stiffness" ("nodes_m youngs_modulus_pa poissons_ratio") => element::stiffness,
    "servo_axis" ("knots coordinate_bits") => servo::axis,
    "servo_interpolate" ("depth_knots lateral_knots table_bits depth_bits lateral_bits") => servo::interpolate,
    "report_decode" ("bytes") => report::decode,
    "report_encode" ("report lateral normal buttons status sequence force_sequence flags version \
        position_unit_nm force_unit_un largest_force_mn period_us watchdog_ms \
        damping_mn_s_per_m friction_mn control") => report::encode,
    "count_analysis" ("correct trials") => counts::analysis,
];

/// The ops that keep models.
const WITH_MODELS: &[Op] = &[Op {
    name: "probe_force",
    arguments: "phantom depth_m lateral_m",
    function: probe::force,
}];

/// All ops.
///
/// Implements: ORA-020.
pub fn all() -> impl Iterator<Item = &'static Op> {
    PLAIN.iter().chain(WITH_MODELS)
}

/// The op of that name.
///
/// # Errors
/// [`Code::UnknownOp`].
pub fn find(name: &str) -> Result<&'static Op, Refusal> {
    all().find(|op| op.name == name).ok_or_else(|| {
        let names: Vec<&str> = all().map(|op| op.name).collect();
        let names = names.join(", ");
        Refusal::new(
            Code::UnknownOp,
            format!("unknown op {name:?}: expected one of {names}"),
        )
    })
}

/// Implements: ORA-021.
fn capabilities(_: &mut Arguments) -> Result<Answer, Refusal> {
    Ok(Answer::default()
        .with("version", env!("CARGO_PKG_VERSION"))
        .with("ops", all().map(|op| op.name).collect::<Vec<_>>()))
}
