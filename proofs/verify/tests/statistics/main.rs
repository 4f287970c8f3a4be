//! The battery of `palpate_verify::statistics`. Seeds are fixed, so nothing here is flaky; with
//! `PALPATE_SEED=<number>` the same battery runs on fresh seeds, and its checks fail by chance with
//! at most the probability that the ledger adds up to. (`palpate-verify --soak` is the way to run
//! many.)

use palpate_verify::statistics::{Check, FIXED_SEED, battery};

/// Runs the checks of these names with their negative controls.
fn check(names: &[&str]) {
    let seed = match std::env::var("PALPATE_SEED") {
        Ok(seed) => seed.parse().expect("PALPATE_SEED is a whole number"),
        Err(_) => FIXED_SEED,
    };
    for name in names {
        let found: Option<&Check> = battery().find(|check| check.name() == *name);
        let check = found.unwrap_or_else(|| panic!("{name} is no check"));
        let notes = check
            .run(seed)
            .unwrap_or_else(|failure| panic!("{failure}"));
        notes.iter().for_each(|note| println!("{note}"));
        let controls = check.run_negative_controls(seed);
        controls.unwrap_or_else(|failure| panic!("{failure}"));
    }
}

#[test]
fn every_check_runs_here() {
    let here = include_str!("main.rs");
    for check in battery() {
        let quoted = format!("\"{}\"", check.name());
        assert!(here.contains(&quoted), "{quoted} is not run");
    }
}

// Verifies: DET-012, DET-013, DET-015, DET-113.
#[test]
fn coarse_mean() {
    check(&["coarse_mean_h0", "coarse_mean_h1"]);
}

// Verifies: DET-013, DET-015, DET-113.
#[test]
fn coarse_variance() {
    check(&[
        "coarse_variance_h0",
        "coarse_variance_h1",
        "coarse_noise_variance",
    ]);
}

// Verifies: DET-015, DET-113.
#[test]
fn coarse_distribution() {
    check(&["coarse_kolmogorov_h0", "coarse_kolmogorov_h1"]);
}

// Verifies: DET-024, DET-025, DET-026.
#[test]
fn coarse_rates_at_the_thresholds_of_neyman_and_pearson() {
    check(&[
        "coarse_false_alarms_at_1_percent",
        "coarse_misses_at_5_percent",
    ]);
}

// Verifies: DET-012, DET-015.
#[test]
fn single_sample_of_one_channel() {
    check(&["single_mean_h1", "single_variance_h0"]);
}

// Verifies: DET-015, DET-026, DET-113.
#[test]
fn traverse_of_401_samples() {
    check(&[
        "traverse_mean_h1",
        "traverse_variance_h0",
        "traverse_false_alarms_at_5_percent",
    ]);
}

// Verifies: DET-114.
#[test]
fn theta_drawn_directly() {
    check(&["direct_kolmogorov"]);
}

// Verifies: DET-040, DET-041.
#[test]
fn noise_that_the_channels_share() {
    check(&["shared_noise_mean_h1", "shared_noise_variance_h0"]);
}

// Verifies: DET-044.
#[test]
fn noise_with_feedback() {
    check(&["feedback_noise_mean_h1", "feedback_noise_variance_h0"]);
}

// Verifies: DET-045.
#[test]
fn noise_of_a_moving_average() {
    check(&["moving_average_mean_h1", "moving_average_variance_h0"]);
}

// Verifies: DET-112.
#[test]
fn deviates_are_standard_normal_with_their_tails() {
    check(&["generator_kolmogorov", "generator_tails_beyond_4"]);
}

// Verifies: DET-111.
#[test]
fn deviates_of_neighbouring_addresses_are_independent() {
    check(&["generator_signs_of_neighbours", "generator_signs_of_trials"]);
}

// Verifies: DET-056, DET-058.
#[test]
fn false_alarms_of_theta_max_keep_their_bound() {
    check(&["theta_max_false_alarms"]);
}

// Verifies: DET-053, DET-054, DET-060, DET-061.
#[test]
fn position_errors_meet_the_bound_of_cramer_and_rao_until_the_signal_is_too_weak() {
    check(&["position_error"]);
}

// Verifies: DET-050, DET-052, DET-053, DET-054.
#[test]
fn the_position_of_a_cut_signal_is_drawn_back_as_its_sums_say() {
    check(&["position_error_of_a_cut_signal"]);
}

// Verifies: DET-070.
#[test]
fn a_mixture_of_depths_that_look_the_same_is_one_depth() {
    check(&["mixture_false_alarms_at_5_percent"]);
}

// Verifies: DET-080, DET-081.
#[test]
fn theta_in_proportional_noise_has_its_tails() {
    check(&["weber_tail_h0", "weber_tail_h1"]);
}
