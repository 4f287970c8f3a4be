//! Where an inclusion lies, by a bank of what may be there: `cargo run -p palpate --example bank_to_posterior`.

use std::error::Error;

use palpate::bank::{BankPlan, BankSearch};
use palpate::phantom::Phantom;
use palpate::stats::random::Generator;
use palpate::trace::{Correlation, Criterion, Noise, Question, Trace, Unknown};

fn main() -> Result<(), Box<dyn Error>> {
    // Five positions and three depths of the inclusion of a built-in phantom, under a probe 4 mm deep.
    let in_mm = |values: &[f64]| -> Vec<f64> { values.iter().map(|value| 1e-3 * value).collect() };
    let laterals: Vec<f64> = (-16..=16).map(|step| 5e-4 * f64::from(step)).collect();
    let mut plan = BankPlan::new(Phantom::builtin("4.6")?, 4e-3, &laterals)?;
    plan.positions = in_mm(&[-4.0, -2.0, 0.0, 2.0, 4.0]);
    plan.depths = in_mm(&[3.6, 4.6, 5.6]);
    plan.mesh_size = 1e-3;
    let bank = plan.bank()?;

    // A sweep over the inclusion at x = 2 mm, 4.6 mm deep, in noise of 0.05 N.
    let truth = (0..bank.maps().len()).find(|&map| bank.point(map)[..2] == [2e-3, 4.6e-3]);
    let truth = bank.maps()[truth.ok_or("a map of that point")?]
        .table()
        .row(4e-3)?;
    let noise = Generator::new(1, 0);
    let mut file = String::from("position_mm,lateral_force_n,normal_force_n\n");
    for (sample, x) in laterals.iter().enumerate() {
        let lateral = truth.lateral[sample] + 0.05 * noise.normal(0, sample as u64);
        let normal = truth.normal[sample] + 0.05 * noise.normal(1, sample as u64);
        file += &format!("{},{lateral},{normal}\n", 1e3 * x);
    }

    let search = BankSearch {
        question: Question {
            depth: 4e-3,
            depth_tolerance: 0.0,
            is_zeroed: false,
            unknown: &[Unknown::Offset, Unknown::Variance],
            noise: Noise {
                sd: None,
                correlation: Correlation::None,
            },
            criterion: Criterion::MaximumAPosteriori,
            prior_h1: 0.5,
        },
        bank: &bank,
        prior: None,
        simulations: None,
    };
    let found = search.locate(&Trace::from_csv(&file, "sweep.csv")?.record(None)?)?;
    println!(
        "posterior probability of an inclusion: {:.4}",
        found.posterior
    );
    for (axis, name) in ["position", "depth"].into_iter().enumerate() {
        let interval = found.place.interval(axis, 0.95)?;
        println!(
            "{name}: {:.2} mm, with 95 % from {:.2} to {:.2} mm",
            1e3 * found.place.estimate[axis],
            1e3 * interval.lower,
            1e3 * interval.upper
        );
    }
    Ok(())
}
