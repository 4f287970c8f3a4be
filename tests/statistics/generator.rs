//! The deviates themselves.

use crate::checks::{Law, count_rejects, kolmogorov_rejects};
use crate::{ledger, seed};
use palpate::stats::normal::upper_tail;
use palpate::stats::random::Generator;

fn deviates(stream: u64, count: usize) -> Vec<f64> {
    let mut deviates = vec![0.0; count];
    Generator::new(seed(), stream).normals(3, 0, &mut deviates);
    deviates
}

// Verifies: DET-112.
#[test]
fn deviates_are_standard_normal() {
    ledger::run("generator_kolmogorov", |defect, replicate, row| {
        let mut deviates = deviates(500 + replicate, row.trials);
        if defect == "shifted_by_1_percent" {
            deviates.iter_mut().for_each(|x| *x += 0.01);
        }
        kolmogorov_rejects(&deviates, Law { mean: 0.0, sd: 1.0 }, row.alpha)
    });
}

// Verifies: DET-112.
#[test]
fn deviates_have_their_tails() {
    ledger::run("generator_tails_beyond_4", |defect, replicate, row| {
        // Without the ziggurat's tail there is nothing beyond 3.852.
        let largest = if defect == "tail_left_out" {
            3.852
        } else {
            f64::INFINITY
        };
        let tail = deviates(510 + replicate, row.trials)
            .iter()
            .filter(|x| x.abs().min(largest) > 4.0)
            .count();
        count_rejects(
            tail as u64,
            row.trials as u64,
            2.0 * upper_tail(4.0).unwrap(),
            row.alpha,
        )
    });
}

// Verifies: DET-111.
#[test]
fn deviates_of_neighbouring_addresses_are_independent() {
    // Equal signs of two independent deviates have probability ½.
    for (name, step, stream) in [
        ("generator_signs_of_neighbours", (0, 1), 520),
        ("generator_signs_of_trials", (1, 0), 530),
    ] {
        ledger::run(name, |defect, replicate, row| {
            let generator = Generator::new(seed(), stream + replicate);
            let (step_trial, step_index) = if defect == "same_address" {
                (0, 0)
            } else {
                step
            };
            let equal = (0..row.trials as u64)
                .filter(|&i| {
                    let one = generator.normal(2 * i, 6);
                    let other = generator.normal(2 * i + step_trial, 6 + step_index);
                    (one < 0.0) == (other < 0.0)
                })
                .count();
            count_rejects(equal as u64, row.trials as u64, 0.5, row.alpha)
        });
    }
}
