//! Coloured noise, made as nature makes it (mixing, feedback, moving averages), never from the
//! factor that is under test.

use super::checks::{Law, mean_test, variance_test};
use super::{Check, Draw, Outcome};
use crate::Figure;
use palpate::detect::coloured::{ColouredStatistic, coloured_scratch, theta_coloured};
use palpate::detect::{DetectError, MatchedFilter};
use palpate::force::Force;

/// DET-040, DET-041.
pub(super) const CHECKS: &[Check] = battery! {
    "shared_noise_mean_h1" => |draw| law(draw, &SHARED, true);
    "shared_noise_variance_h0" => |draw| law(draw, &SHARED, false);
    "feedback_noise_mean_h1" => |draw| law(draw, &FEEDBACK, true);
    "feedback_noise_variance_h0" => |draw| law(draw, &FEEDBACK, false);
    "moving_average_mean_h1" => |draw| law(draw, &MOVING_AVERAGE, true);
    "moving_average_variance_h0" => |draw| law(draw, &MOVING_AVERAGE, false);
};

/// One kind of noise.
struct Colour {
    noise: Noise,
    /// The covariance of two samples, N².
    covariance: fn(usize, usize) -> f64,
    /// The first stream.
    stream: u64,
}

const SHARED: Colour = Colour {
    noise: shared,
    covariance: |i, j| match (i.abs_diff(j), i.abs_diff(j) % SAMPLES) {
        (0, _) => 0.04 + 0.09,
        (_, 0) => 0.09,
        _ => 0.0,
    },
    stream: 400,
};
const FEEDBACK: Colour = Colour {
    noise: feedback,
    covariance: |i, j| {
        if i / SAMPLES == j / SAMPLES {
            0.04 / 0.36 * libm::pow(0.8, i.abs_diff(j) as f64)
        } else {
            0.0
        }
    },
    stream: 430,
};
const MOVING_AVERAGE: Colour = Colour {
    noise: moving_average,
    covariance: |i, j| match (i / SAMPLES == j / SAMPLES, i.abs_diff(j)) {
        (_, 0) => 0.04 + 0.0256,
        (true, 1) => 0.032,
        _ => 0.0,
    },
    stream: 460,
};

/// Samples a channel.
const SAMPLES: usize = 6;
const TEMPLATE: [f64; 2 * SAMPLES] = [
    0.1, 0.3, 0.2, -0.2, -0.3, -0.1, 0.05, 0.15, 0.3, 0.34, 0.2, 0.1,
];

/// A source of noise: 40 independent deviates → 12 samples.
type Noise = fn(&[f64]) -> [f64; 2 * SAMPLES];

fn channels(values: &[f64]) -> Force<&[f64]> {
    Force::new(&values[..SAMPLES], &values[SAMPLES..])
}

/// What two channels share (a vibration of the probe) and what each has alone: n = 0.2 e + 0.3 g, g
/// common to x and y.
fn shared(deviates: &[f64]) -> [f64; 2 * SAMPLES] {
    std::array::from_fn(|i| 0.2 * deviates[i] + 0.3 * deviates[20 + i % SAMPLES])
}

/// Feedback, nᵢ = 0.8 nᵢ₋₁ + 0.2 eᵢ, in each channel, started in its stationary law.
fn feedback(deviates: &[f64]) -> [f64; 2 * SAMPLES] {
    let mut noise = [0.0; 2 * SAMPLES];
    for i in 0..2 * SAMPLES {
        noise[i] = if i % SAMPLES == 0 {
            0.2 / 0.6 * deviates[i]
        } else {
            0.8 * noise[i - 1] + 0.2 * deviates[i]
        };
    }
    noise
}

/// A moving average, nᵢ = 0.2 eᵢ + 0.16 eᵢ₋₁.
fn moving_average(deviates: &[f64]) -> [f64; 2 * SAMPLES] {
    std::array::from_fn(|i| {
        let first = i + i / SAMPLES;
        0.2 * deviates[first + 1] + 0.16 * deviates[first]
    })
}

/// What a residual says beside this noise.
fn judged(colour: &Colour, residual: &[f64]) -> Result<ColouredStatistic, DetectError> {
    const ORDER: usize = 2 * SAMPLES;
    let entry = |at: usize| (colour.covariance)(at / ORDER, at % ORDER);
    let covariance: [f64; ORDER * ORDER] = std::array::from_fn(entry);
    let mut scratch = [0.0; coloured_scratch(ORDER)];
    theta_coloured(residual, &TEMPLATE, &covariance, &mut scratch)
}

/// θ of a detector that takes each noise for white with its own variance.
fn without_whitening(residual: &[f64], variance: f64) -> Result<f64, DetectError> {
    let sd = libm::sqrt(variance);
    let filter = MatchedFilter::new(channels(&TEMPLATE), Force::new(sd, sd))?;
    Ok(filter.statistic(channels(residual))?.theta)
}

/// Has θ the mean of its law under H = 1, or its variance under H = 0?
fn law(draw: &Draw<'_>, colour: &Colour, inclusion: bool) -> Outcome<Figure> {
    let stream = colour.stream + if inclusion { 0 } else { 10 };
    let generator = draw.generator(stream + draw.replicate);
    let mut deviates = [0.0; 40];
    let theta = (0..draw.trials()).map(|trial| {
        generator.normals(trial, 0, &mut deviates);
        let mut residual = (colour.noise)(&deviates);
        if inclusion {
            residual.iter_mut().zip(TEMPLATE).for_each(|(r, t)| *r += t);
        }
        match draw.defect {
            "whitening_left_out" => without_whitening(&residual, (colour.covariance)(0, 0)),
            _ => Ok(judged(colour, &residual)?.theta),
        }
    });
    let theta: Vec<f64> = theta.collect::<Result<_, _>>()?;
    let law = Law::of_theta(judged(colour, &TEMPLATE)?.gamma, inclusion);
    let test = if inclusion { mean_test } else { variance_test };
    test(&theta, law, draw.row.alpha)
}
