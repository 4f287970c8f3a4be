//! Records whose inclusion lies anywhere, against the posterior of a bank: simulation-based calibration.

use super::checks::{count_test, mean_of_bounded_test, uniform_test};
use super::{Check, Draw, Outcome};
use crate::Figure;
use palpate::bank::{BankDetector, PlacePosterior};
use palpate::detect::nuisance::NoiseLevel;
use palpate::detect::posterior;

/// BNK-040, BNK-042; BNK-031, BNK-034.
pub(super) const CHECKS: &[Check] = battery! {
    "bank_ranks_kolmogorov" => ranks;
    "bank_intervals_at_90_percent" => intervals;
    "bank_posterior_of_inclusion" => reliability;
};

/// Two samples of either channel over the noise, with the inclusion at 0 and at 1; between them the signal is linear in its place,
/// and the channels differ in that the lateral one does not depend on it.
const ENDS: [[f64; 4]; 2] = [[2.0, 1.0, 1.0, 3.0], [2.0, 1.0, 5.0, -1.0]];

/// The truth and the posterior of each record.
fn places(draw: &Draw<'_>, stream: u64) -> Outcome<Vec<(f64, PlacePosterior)>> {
    let axes = [vec![0.0, 1.0], vec![0.0], vec![0.0], vec![0.0]];
    // Noise that is half as large again in the normal channel as is thought.
    let scale = draw.planted(
        "variance_of_one_channel",
        [1.0, 1.0, 1.0 / 1.5, 1.0 / 1.5],
        [1.0; 4],
    );
    let mut ends = ENDS.map(|end| [0, 1, 2, 3].map(|sample: usize| scale[sample] * end[sample]));
    if draw.defect == "template_of_the_neighbour" {
        ends.reverse();
    }
    let level = NoiseLevel::Known;
    let detector = BankDetector::new(&axes, ends.concat(), &[0.5; 2], vec![], &[], level)?;
    let generator = draw.generator(stream + draw.replicate);
    let place = |trial| {
        let [word, ..] = generator.words([0, trial, 2, 0]);
        let truth = (word >> 11) as f64 / (1_u64 << 53) as f64;
        let mut record = [0.0; 4];
        generator.normals(trial, 0, &mut record);
        for (sample, record) in record.iter_mut().enumerate() {
            let signal = (1.0 - truth) * ENDS[0][sample] + truth * ENDS[1][sample];
            *record = scale[sample] * (*record + signal);
        }
        Ok((truth, detector.place(&detector.statistic(&mut record)?)))
    };
    (0..draw.trials()).map(place).collect()
}

/// Are the ranks of the truth in the posterior uniform?
fn ranks(draw: &Draw<'_>) -> Outcome<Figure> {
    let places = places(draw, 800)?.into_iter();
    let ranks = places.map(|(truth, place)| place.at_most(0, truth));
    Ok(uniform_test(ranks.collect(), draw.row.alpha))
}

/// Do intervals of 90 % hold the truth as often?
fn intervals(draw: &Draw<'_>) -> Outcome<Figure> {
    let held = places(draw, 810)?.into_iter().map(|(truth, place)| {
        let interval = place.interval(0, 0.9)?;
        Ok(u64::from(
            interval.lower <= truth && truth <= interval.upper,
        ))
    });
    let held = held.sum::<Outcome<u64>>()?;
    count_test(held, draw.trials(), 0.9, draw.row.alpha)
}

/// Is there an inclusion as often as its probabilities say?
fn reliability(draw: &Draw<'_>) -> Outcome<Figure> {
    /// Each point has a channel to itself.
    const GAMMA: [f64; 2] = [1.5, 2.0];
    const PRIOR: [f64; 2] = [0.7, 0.3];
    const PRIOR_H1: f64 = 0.3;
    let axes = [vec![0.0, 1.0], vec![0.0], vec![0.0], vec![0.0]];
    let templates = vec![GAMMA[0], 0.0, 0.0, GAMMA[1]];
    let level = NoiseLevel::Known;
    let detector = BankDetector::new(&axes, templates, &PRIOR, vec![], &[], level)?;
    let presumed = draw.planted("prior_left_out", 0.5, PRIOR_H1);
    let generator = draw.generator(820 + draw.replicate);
    let excess = (0..draw.trials()).map(|trial| {
        let [a, b, ..] = generator.words([0, trial, 2, 0]);
        let [of_h, of_point] = [a, b].map(|word| (word >> 11) as f64 / (1_u64 << 53) as f64);
        let is_there = of_h < PRIOR_H1;
        let mut record = [0.0; 2];
        generator.normals(trial, 0, &mut record);
        if is_there {
            let point = usize::from(of_point >= PRIOR[0]);
            record[point] += GAMMA[point];
        }
        let mut statistic = detector.statistic(&mut record)?;
        if draw.defect == "gamma_for_its_square" {
            let pairs = statistic.theta.iter_mut().zip(GAMMA);
            pairs.for_each(|(theta, gamma)| *theta += 0.5 * gamma * (gamma - 1.0));
        }
        let probability = posterior(detector.mixture(&statistic)?, presumed)?;
        Ok(f64::from(u8::from(is_there)) - probability)
    });
    let excess = excess.collect::<Outcome<Vec<f64>>>()?;
    Ok(mean_of_bounded_test(&excess, draw.row.alpha))
}
