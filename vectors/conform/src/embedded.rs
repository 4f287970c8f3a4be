//! The vectors that are part of this program, so that it can check others wherever it is.

macro_rules! files {
    ($($name:ident)*) => {
        &[$((concat!(stringify!($name), ".json"), include_str!(concat!("../../", stringify!($name), ".json")))),*]
    };
}

/// Every file of `vectors/` that counts, by name.
///
/// Implements: ORA-040.
pub(super) const FILES: &[(&str, &str)] = files! {
    bank_posterior chi_square_tail count_analysis element_stiffness error_rates f_tail
    gamma_from_two_afc interpolate manifest matched_filter noise_budget normal_cdf normal_quantile
    probe_force proportion_interval report_decode report_encode requests required_gamma
    robust_evidence roc scan schema sequential_evidence servo_axis servo_interpolate student_tail theta theta_colored
    theta_nuisances threshold two_afc
};
