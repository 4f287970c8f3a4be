//! The detector's error rates on the paper's inclusions: by the closed form, and counted in simulated records.

use super::{Check, Claim, Figure, Measured};
use palpate::detect::simulate::Simulation;
use palpate::detect::{error_rates, neyman_pearson_false_alarm_threshold, two_afc};
use palpate::fem::{Contact, MESH_SIZE, Model};
use palpate::force::Force;
use palpate::phantom::Phantom;
use palpate::stats::Bounds;
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
    let claim = Claim {
        name,
        text: "False alarms, misses and right answers in pairs are as frequent in simulated records as the closed form says.",
        requirements: &["DET-013", "DET-025", "DET-026", "DET-027"],
        limits: "Intervals of Clopper and Pearson around the simulated counts, confidence 1 − 1e-9. Fixed in 0.1.0.",
    };
    Check { claim, run }
}

/// Simulates records over the inclusion and over none, and counts.
fn rates(inclusion: &str, noise: f64) -> Measured {
    let (f0, f1) = (forces("none")?, forces(inclusion)?);
    let pairs = f0.as_ref().zip(f1.as_ref());
    let difference = |(f0, f1): (&Vec<f64>, &Vec<f64>)| -> Vec<f64> {
        f0.iter().zip(f1).map(|(f0, f1)| f1 - f0).collect()
    };
    let template = pairs.map(difference);
    let (noise_sd, generator) = (Force::new(noise, noise), Generator::new(SEED, 0));
    let simulation = Simulation::new(f0.as_deref(), template.as_deref(), noise_sd, generator)?;
    let gamma = simulation.filter().gamma();
    let eta = neyman_pearson_false_alarm_threshold(gamma, FALSE_ALARM)?;
    let (mut silent, mut found, mut in_order) = (0, 0, 0);
    let mut scratch = vec![0.0; 2 * f0.lateral.len()];
    for record in 0..RECORDS {
        let mut theta = |trial, forces: &Force<Vec<f64>>| {
            let statistic = simulation.trial(trial, forces.as_deref(), &mut scratch);
            statistic.map(|statistic| statistic.theta)
        };
        let (without, with) = (theta(2 * record, &f0)?, theta(2 * record + 1, &f1)?);
        silent += u64::from(without < eta);
        found += u64::from(with >= eta);
        in_order += u64::from(with > without);
    }
    let error = error_rates(gamma, eta)?;
    Ok(vec![
        Figure::told("γ", gamma),
        Figure::told("threshold η", eta),
        judged(
            "records without inclusion, no alarm",
            1.0 - error.false_alarm,
            silent,
        )?,
        judged("records with inclusion, found", 1.0 - error.miss, found)?,
        judged("pairs in the right order", two_afc(gamma)?, in_order)?,
    ])
}

/// The share by the closed form, which must lie in the interval of what was counted.
fn judged(what: &str, closed_form: f64, counted: u64) -> Measured<Figure> {
    let Bounds { lower, upper } = clopper_pearson(counted, RECORDS, CONFIDENCE)?;
    let what = format!("{what} ({counted} of {RECORDS} simulated)");
    Ok(Figure::within(what, closed_form, lower, upper))
}

/// Forces along the paper's traverse.
fn forces(name: &str) -> Measured<Force<Vec<f64>>> {
    let phantom = Phantom::builtin(name)?;
    let laterals: Vec<f64> = (-20..=20).map(|k| f64::from(k) * 0.5e-3).collect();
    let map = Model::new(&phantom, MESH_SIZE, Contact::default())
        .and_then(|model| model.map(&[DEPTH], &laterals, &|_| true))
        .map_err(|error| format!("phantom {name}: {error}"))?;
    let forces = map.table().both().map_err(|error| error.to_string())?;
    Ok(forces.map(|component| component.row(0).to_vec()))
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
