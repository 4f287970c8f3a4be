//! The deviates themselves.

use super::checks::{Law, count_test, kolmogorov_test};
use super::{Check, Draw, Outcome};
use crate::Figure;
use palpate::stats::normal::upper_tail;

/// DET-111, DET-110.
pub(super) const CHECKS: &[Check] = battery! {
    "generator_kolmogorov" => standard_normal;
    "generator_tails_beyond_4" => tails;
    // Neighbours within a trial, and the same place in two trials.
    "generator_signs_of_neighbours" => |draw| signs(draw, 520, (0, 1));
    "generator_signs_of_trials" => |draw| signs(draw, 530, (1, 0));
};

fn deviates(draw: &Draw<'_>, stream: u64) -> Vec<f64> {
    let mut deviates = vec![0.0; draw.row.trials];
    let generator = draw.generator(stream + draw.replicate);
    generator.normals(3, 0, &mut deviates);
    deviates
}

fn standard_normal(draw: &Draw<'_>) -> Outcome<Figure> {
    let mut deviates = deviates(draw, 500);
    if draw.defect == "shifted_by_1_percent" {
        deviates.iter_mut().for_each(|x| *x += 0.01);
    }
    kolmogorov_test(&deviates, Law { mean: 0.0, sd: 1.0 }, draw.row.alpha)
}

fn tails(draw: &Draw<'_>) -> Outcome<Figure> {
    // Without the ziggurat's tail there is nothing beyond 3.852.
    let largest = draw.planted("tail_left_out", 3.852, f64::INFINITY);
    let deviates = deviates(draw, 510);
    let tail = deviates.iter().filter(|x| x.abs().min(largest) > 4.0);
    let count = tail.count() as u64;
    count_test(count, draw.trials(), 2.0 * upper_tail(4.0)?, draw.row.alpha)
}

/// Equal signs of two independent deviates have probability ½; `step` leads from the trial and
/// index of one to those of the other.
fn signs(draw: &Draw<'_>, stream: u64, step: (u64, u64)) -> Outcome<Figure> {
    let generator = draw.generator(stream + draw.replicate);
    let (step_trial, step_index) = draw.planted("same_address", (0, 0), step);
    let equal = (0..draw.trials()).filter(|&i| {
        let one = generator.normal(2 * i, 6);
        let other = generator.normal(2 * i + step_trial, 6 + step_index);
        (one < 0.0) == (other < 0.0)
    });
    count_test(equal.count() as u64, draw.trials(), 0.5, draw.row.alpha)
}
