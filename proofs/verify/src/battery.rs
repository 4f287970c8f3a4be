//! The statistics battery as outcomes: what each of its checks claims, and for which requirements.

use super::statistics::{Check, FIXED_SEED};
use super::{Claim, Measured, Outcome};

/// Groups of checks: the beginning of their names, the requirements that they serve, and what they claim.
macro_rules! groups {
    ($($start:literal [$($id:literal),+] $claim:literal)+) => {
        &[$(($start, $claim, &[$($id),+])),+]
    };
}

/// A check is of the first group with the beginning of its name.
pub(crate) const GROUPS: &[(&str, &str, &[&str])] = groups! {
    "coarse_mean" ["DET-015", "DET-013", "DET-113"] "Θ of full records has the mean ∓γ²/2."
    "coarse_variance" ["DET-013", "DET-015", "DET-113"] "Θ of full records has the variance γ²."
    "coarse_kolmogorov" ["DET-015", "DET-113"] "Θ of full records is normal."
    "coarse_noise_variance" ["DET-113"] "The noise of simulated records has the variance that was asked for."
    "coarse_" ["DET-022", "DET-025", "DET-026"] "The thresholds of Neyman and Pearson give their rates of error."
    "single_" ["DET-015"] "Θ of one sample of one channel has its law."
    "traverse_" ["DET-015", "DET-026", "DET-113"] "Θ over a traverse of computed maps has its law and its false alarms."
    "shared_noise_" ["DET-040", "DET-041"] "Noise that the channels share is whitened."
    "feedback_noise_" ["DET-040", "DET-041"] "Noise with feedback is whitened."
    "moving_average_" ["DET-040", "DET-041"] "Noise of a moving average is whitened."
    "generator_" ["DET-111", "DET-110"] "Deviates are standard normal, with their tails, and independent."
    "position_error_of_a_cut_signal" ["DET-050", "DET-053"]
        "Where the signal leaves the record, the place has the mean and the spread of sums over what was observed."
    "position_error" ["DET-053", "DET-054"] "Position errors meet the bound of Cramér and Rao until the signal is too weak."
    "nuisance_t_" ["NUI-001", "NUI-003", "NUI-016"]
        "T beside offsets, drifts and a gain of any size is normal with standard deviation 1."
    "nuisance_residual_" ["NUI-003", "NUI-016", "DET-130"] "What neither the nuisances nor the template explain is χ²."
    "nuisance_errors_" ["NUI-008", "NUI-014", "NUI-013"]
        "The thresholds of T give their rates of error, whether or not the level of the noise is known."
    "nuisance_" ["NUI-003", "NUI-008", "NUI-016", "DET-130"]
        "Where the level of the noise is unknown, T has Student's law, and T² that of F."
    "ljung_box_" ["NUI-020"] "The test for white noise rejects it as often as it should."
    "bank_" ["BNK-031", "BNK-034", "BNK-040", "BNK-042", "CLI-153"]
        "The posterior of a bank is calibrated: ranks and intervals of the place, and the probability of an inclusion."
    "robust_" ["ROB-031", "ROB-032"] "The posterior over classes of disturbance is calibrated, where the record is of one of them."
    "sequential_" ["SEQ-001", "SEQ-010", "SEQ-012"] "A sequential test keeps its rates of error, also on a record that is too short."
    "mixture_" ["DET-070"] "Mixtures of depths have their false alarms."
    "weber_" ["DET-080"] "Noise in proportion to the force has its tails."
};

fn group(name: &str) -> (&'static str, &'static [&'static str]) {
    let found = GROUPS.iter().find(|(start, ..)| name.starts_with(start));
    found.map_or(("", &[]), |&(_, claim, requirements)| (claim, requirements))
}

/// The limits of a check that were fixed in a version.
macro_rules! limits {
    ($version:literal) => {
        concat!(
            "The theorem that the figure names, at the α of the ledger. Fixed in ",
            $version,
            "."
        )
    };
}

/// Runs a check of the battery with the seed of the tests, and with each defect that it must see.
pub fn outcome(check: &Check) -> Outcome {
    let (text, requirements) = group(check.name);
    let limits = match check.name.split('_').next() {
        Some("robust" | "sequential") => limits!("0.3.0"),
        Some("nuisance" | "ljung" | "bank") => limits!("0.2.0"),
        _ => limits!("0.1.0"),
    };
    let claim = Claim {
        name: check.name,
        text,
        requirements,
        limits,
    };
    Outcome {
        name: format!("statistics.{}", check.name),
        ..Outcome::measured(&claim, || figures(check))
    }
}

fn figures(check: &Check) -> Measured {
    let row = check.row();
    let mut figures = vec![check.observe(FIXED_SEED)?];
    check.run_negative_controls(FIXED_SEED)?;
    let seen = row.shown_defects().count() as f64;
    figures.extend(figures! {
        "probability of failing by chance" => told(row.alpha);
        "trials" => told(row.trials as f64);
        "defects planted and seen" => told(seen);
    });
    Ok(figures)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::statistics::battery;

    #[test]
    fn every_check_of_the_battery_has_a_claim_of_its_group() {
        for check in battery() {
            assert!(!group(check.name).0.is_empty(), "{}", check.name);
        }
        // Every group is the first one of some check.
        for (start, claim, _) in GROUPS {
            let used = battery().any(|check| group(check.name).0 == *claim);
            assert!(used, "{start}");
        }
    }

    #[test]
    fn a_check_of_the_battery_tells_its_row_of_the_ledger() {
        let check = battery()
            .find(|check| check.name == "coarse_noise_variance")
            .unwrap();
        let outcome = outcome(check);
        assert!(outcome.passed(), "{outcome:?}");
        assert_eq!(outcome.name, "statistics.coarse_noise_variance");
        let values: Vec<f64> = outcome.figures.iter().map(|figure| figure.value).collect();
        assert_eq!(values[1..], [2.5e-8, 200_000.0, 1.0]);
        assert!(outcome.figures[0].at_least.is_finite() && outcome.figures[0].at_most.is_finite());
    }
}
