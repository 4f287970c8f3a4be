//! From a recorded sweep to a decision: `cargo run -p palpate --example record_to_decision`.

use std::error::Error;

use palpate::detect::Decision;
use palpate::fem::{Contact, Model};
use palpate::force_map::Hypotheses;
use palpate::phantom::Phantom;
use palpate::stats::random::Generator;
use palpate::trace::{Correlation, Criterion, Noise, Question, Trace, Unknown};

fn main() -> Result<(), Box<dyn Error>> {
    // What a sweep 4 mm deep would read, without an inclusion and with one 6.6 mm deep.
    let laterals: Vec<f64> = (-16..=16).map(|step| 5e-4 * f64::from(step)).collect();
    let map = |name| -> Result<_, Box<dyn Error>> {
        let model = Model::new(&Phantom::builtin(name)?, 1e-3, Contact::default())?;
        Ok(model.map(&[4e-3], &laterals, &|_| true)?)
    };
    let (without, with) = (map("none")?, map("6.6")?);

    // A file of the laboratory, here made up: noise of 0.05 N, and a sensor with an offset of 0.2 N.
    let noise = Generator::new(1, 0);
    let mut file = String::from("position_mm,lateral_force_n,normal_force_n\n");
    let truth = with.table().row(4e-3)?;
    for (sample, x) in laterals.iter().enumerate() {
        let read = |force: f64, noise: f64| force + 0.2 + 0.05 * noise;
        let lateral = read(truth.lateral[sample], noise.normal(0, sample as u64));
        let normal = read(truth.normal[sample], noise.normal(1, sample as u64));
        file += &format!("{},{lateral},{normal}\n", 1e3 * x);
    }

    let record = Trace::from_csv(&file, "sweep.csv")?.record(None)?;
    let question = Question {
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
    };
    let found = question.judge(Hypotheses::new(&without, &with)?, &record)?;
    match found.decision {
        Some(Decision::Inclusion) => println!("an inclusion"),
        Some(Decision::NoInclusion) => println!("no inclusion"),
        None => println!("cannot be judged: {:?}", found.causes),
    }
    println!(
        "posterior probability of an inclusion: {:.4}",
        found.posterior
    );
    println!("T = {:.2}, gamma = {:.2}", found.test.t, found.test.gamma);
    Ok(())
}
