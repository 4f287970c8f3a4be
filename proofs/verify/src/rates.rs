//! The detector's error rates on the paper's inclusions: by the closed form, and counted in simulated records.

use super::{Check, Figure, Measured};
use palpate::detect::simulate::Simulation;
use palpate::detect::{error_rates, neyman_pearson_false_alarm_threshold, two_afc};
use palpate::fem::{Contact, MESH_SIZE, Model};
use palpate::force::Force;
use palpate::phantom::Phantom;
use palpate::stats::binomial::clopper_pearson;
use palpate::stats::random::Generator;

/// The noise of the paper's subjects, N, in each sample of both channels.
const NOISE_SD: f64 = 0.235;
/// So much noise that errors are frequent enough to be counted, N.
const LOUD: f64 = 4.0 * NOISE_SD;
/// The false alarms that are allowed.
const FALSE_ALARM: f64 = 0.05;
/// The depth of the probe, m.
const DEPTH: f64 = 4e-3;
/// Records of each kind.
const RECORDS: u64 = 100_000;
/// The confidence of the intervals: what a detector without defect misses, it misses with probability 1e-9 at most.
const CONFIDENCE: f64 = 1.0 - 1e-9;
/// The seed of the records.
const SEED: u64 = 19_990_101;

const CLAIM: &str = "False alarms, misses and right answers in pairs are as frequent in simulated records as the closed form says.";
const LIMITS: &str = "Intervals of Clopper and Pearson around the simulated counts, confidence 1 − 1e-9. Fixed in 0.1.0.";
const REQUIREMENTS: &[&str] = &["DET-013", "DET-025", "DET-026", "DET-027"];

/// Two checks for each of the paper's inclusions: with its noise, and with more.
pub(super) const CHECKS: &[Check] = &[
    check("rates.2.6_mm", || rates("2.6", NOISE_SD)),
    check("rates.2.6_mm_loud", || rates("2.6", LOUD)),
    check("rates.4.6_mm", || rates("4.6", NOISE_SD)),
    check("rates.4.6_mm_loud", || rates("4.6", LOUD)),
    check("rates.6.6_mm", || rates("6.6", NOISE_SD)),
    check("rates.6.6_mm_loud", || rates("6.6", LOUD)),
    check("rates.8.6_mm", || rates("8.6", NOISE_SD)),
    check("rates.8.6_mm_loud", || rates("8.6", LOUD)),
];

const fn check(name: &'static str, run: fn() -> Measured) -> Check {
    Check::new(name, CLAIM, REQUIREMENTS, LIMITS, run)
}

/// Simulates records over the inclusion and over none, and counts.
fn rates(inclusion: &str, noise: f64) -> Measured {
    let told = |error: &dyn std::fmt::Display| error.to_string();
    let f0 = forces("none")?;
    let f1 = forces(inclusion)?;
    let difference = |one: &[f64], zero: &[f64]| -> Vec<f64> {
        one.iter().zip(zero).map(|(one, zero)| one - zero).collect()
    };
    let template = Force::new(
        difference(&f1.lateral, &f0.lateral),
        difference(&f1.normal, &f0.normal),
    );
    let noise_sd = Force::new(noise, noise);
    let simulation = Simulation::new(
        f0.as_deref(),
        template.as_deref(),
        noise_sd,
        Generator::new(SEED, 0),
    )
    .map_err(|error| told(&error))?;
    let gamma = simulation.filter().gamma();
    let eta =
        neyman_pearson_false_alarm_threshold(gamma, FALSE_ALARM).map_err(|error| told(&error))?;
    let counts = count(&simulation, &f0, &f1, eta).map_err(|error| told(&error))?;
    let error = error_rates(gamma, eta).map_err(|error| told(&error))?;
    let area = two_afc(gamma).map_err(|error| told(&error))?;
    Ok(vec![
        Figure::told("γ", gamma),
        Figure::told("threshold η", eta),
        judged(
            "records without inclusion, no alarm",
            1.0 - error.false_alarm,
            counts.silent,
        )?,
        judged(
            "records with inclusion, found",
            1.0 - error.miss,
            counts.found,
        )?,
        judged("pairs in the right order", area, counts.in_order)?,
    ])
}

/// The share by the closed form, which must lie in the interval of what was counted.
fn judged(what: &str, closed_form: f64, counted: u64) -> Result<Figure, String> {
    let interval =
        clopper_pearson(counted, RECORDS, CONFIDENCE).map_err(|error| error.to_string())?;
    let what = format!("{what} ({counted} of {RECORDS} simulated)");
    Ok(Figure::within(
        what,
        closed_form,
        interval.lower,
        interval.upper,
    ))
}

/// Records that were judged rightly.
struct Counts {
    /// Without inclusion and without alarm.
    silent: u64,
    /// With inclusion and with alarm.
    found: u64,
    /// Pairs whose record with inclusion has the larger θ.
    in_order: u64,
}

fn count(
    simulation: &Simulation<'_>,
    f0: &Force<Vec<f64>>,
    f1: &Force<Vec<f64>>,
    eta: f64,
) -> Result<Counts, palpate::detect::DetectError> {
    let mut scratch = vec![0.0; 2 * f0.lateral.len()];
    let mut counts = Counts {
        silent: 0,
        found: 0,
        in_order: 0,
    };
    for record in 0..RECORDS {
        let without = simulation
            .trial(2 * record, f0.as_deref(), &mut scratch)?
            .theta;
        let with = simulation
            .trial(2 * record + 1, f1.as_deref(), &mut scratch)?
            .theta;
        counts.silent += u64::from(without < eta);
        counts.found += u64::from(with >= eta);
        counts.in_order += u64::from(with > without);
    }
    Ok(counts)
}

/// Forces along the paper's traverse.
fn forces(name: &str) -> Result<Force<Vec<f64>>, String> {
    let failed = |error: &dyn std::fmt::Display| format!("phantom {name}: {error}");
    let phantom = Phantom::builtin(name).map_err(|error| failed(&error))?;
    let laterals: Vec<f64> = (-20..=20).map(|k| f64::from(k) * 0.5e-3).collect();
    let map = Model::new(&phantom, MESH_SIZE, Contact::default())
        .and_then(|model| model.map(&[DEPTH], &laterals, &|_| ()))
        .map_err(|error| failed(&error))?;
    Ok(Force::new(
        map.table().forces().lateral.row(0).to_vec(),
        map.table().forces().normal.row(0).to_vec(),
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_agree_with_the_closed_form_and_a_wrong_rate_does_not() {
        let figures = (CHECKS[7].run)().unwrap();
        assert_eq!(figures.len(), 5);
        for figure in &figures {
            assert!(figure.passes(), "{figure:?}");
        }
        // The interval reaches 6.2 standard deviations to each side, each at most 0.0016: two per cent more would be seen.
        let sensitivity = &figures[3];
        let wrong = Figure {
            value: sensitivity.value + 0.02,
            ..sensitivity.clone()
        };
        assert!(!wrong.passes(), "{wrong:?}");
    }
}
