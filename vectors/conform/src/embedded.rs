//! The vectors that are part of this program, so that it can check others wherever it is.

macro_rules! files {
    ($($name:literal),* $(,)?) => {
        &[$(($name, include_str!(concat!("../../", $name)))),*]
    };
}

/// Every file of `vectors/` that counts, by name.
///
/// Implements: ORA-040.
pub(super) const FILES: &[(&str, &str)] = files![
    "bank_posterior.json",
    "chi_square_tail.json",
    "count_analysis.json",
    "element_stiffness.json",
    "error_rates.json",
    "f_tail.json",
    "gamma_from_two_afc.json",
    "interpolate.json",
    "manifest.json",
    "matched_filter.json",
    "noise_budget.json",
    "normal_cdf.json",
    "normal_quantile.json",
    "probe_force.json",
    "proportion_interval.json",
    "report_decode.json",
    "report_encode.json",
    "requests.json",
    "required_gamma.json",
    "roc.json",
    "scan.json",
    "schema.json",
    "servo_axis.json",
    "servo_interpolate.json",
    "student_tail.json",
    "theta.json",
    "theta_colored.json",
    "theta_nuisances.json",
    "threshold.json",
    "two_afc.json",
];
