//! Coloured noise, made as nature makes it (mixing, feedback, moving averages), never from the
//! factor that is under test.

use crate::checks::{Law, mean_rejects, variance_rejects};
use crate::{ledger, seed};
use palpate::detect::coloured::{ColouredStatistic, coloured_scratch, theta_coloured};
use palpate::detect::stationary::{banded_scratch, theta_banded, theta_stationary};
use palpate::detect::{Channels, MatchedFilter};
use palpate::stats::random::Generator;

/// Samples a channel.
const SAMPLES: usize = 6;
const TEMPLATE: [f64; 2 * SAMPLES] = [
    0.1, 0.3, 0.2, -0.2, -0.3, -0.1, 0.05, 0.15, 0.3, 0.34, 0.2, 0.1,
];

/// A detector of coloured noise: residual → statistic.
type Detector = fn(&[f64]) -> ColouredStatistic;
/// A source of noise: 40 independent deviates → 12 samples.
type Noise = fn(&[f64]) -> [f64; 2 * SAMPLES];

fn channels(values: &[f64]) -> Channels<&[f64]> {
    Channels {
        x: &values[..SAMPLES],
        y: &values[SAMPLES..],
    }
}

/// What two channels share (a vibration of the probe) and what each has alone: n = 0.2 e + 0.3 g, g
/// common to x and y.
fn shared(deviates: &[f64]) -> [f64; 2 * SAMPLES] {
    std::array::from_fn(|i| 0.2 * deviates[i] + 0.3 * deviates[20 + i % SAMPLES])
}

fn shared_detector(residual: &[f64]) -> ColouredStatistic {
    let order = 2 * SAMPLES;
    let mut covariance = vec![0.0; order * order];
    for i in 0..order {
        covariance[i * order + i] = 0.04 + 0.09;
        covariance[i * order + (i + SAMPLES) % order] = 0.09;
    }
    theta_coloured(
        residual,
        &TEMPLATE,
        &covariance,
        &mut vec![0.0; coloured_scratch(order)],
    )
    .unwrap()
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

fn feedback_detector(residual: &[f64]) -> ColouredStatistic {
    let lags: [f64; SAMPLES] = std::array::from_fn(|lag| 0.04 / 0.36 * 0.8_f64.powi(lag as i32));
    let lags = Channels {
        x: &lags[..],
        y: &lags[..],
    };
    theta_stationary(
        channels(residual),
        channels(&TEMPLATE),
        lags,
        &mut [0.0; 2 * SAMPLES],
    )
    .unwrap()
}

/// A moving average, nᵢ = 0.2 eᵢ + 0.16 eᵢ₋₁.
fn moving_average(deviates: &[f64]) -> [f64; 2 * SAMPLES] {
    std::array::from_fn(|i| {
        let first = i + i / SAMPLES;
        0.2 * deviates[first + 1] + 0.16 * deviates[first]
    })
}

fn moving_average_detector(residual: &[f64]) -> ColouredStatistic {
    let lags = [0.04 + 0.0256, 0.032];
    let lags = Channels {
        x: &lags[..],
        y: &lags[..],
    };
    let mut scratch = [0.0; banded_scratch(2)];
    theta_banded(channels(residual), channels(&TEMPLATE), lags, &mut scratch).unwrap()
}

/// θ of a detector that takes each noise for white with its own variance.
fn without_whitening(residual: &[f64], sd: f64) -> f64 {
    let filter = MatchedFilter::new(channels(&TEMPLATE), Channels { x: sd, y: sd }).unwrap();
    filter.statistic(channels(residual)).unwrap().theta
}

fn sample(
    noise: Noise,
    sd: f64,
    detector: Detector,
    inclusion: bool,
    defect: &str,
    stream: u64,
    trials: usize,
) -> (Law, Vec<f64>) {
    let generator = Generator::new(seed(), stream);
    let mut deviates = [0.0; 40];
    let theta = (0..trials as u64)
        .map(|trial| {
            generator.normals(trial, 0, &mut deviates);
            let mut residual = noise(&deviates);
            if inclusion {
                residual.iter_mut().zip(TEMPLATE).for_each(|(r, t)| *r += t);
            }
            match defect {
                "whitening_left_out" => without_whitening(&residual, sd),
                _ => detector(&residual).theta,
            }
        })
        .collect();
    (Law::of_theta(detector(&TEMPLATE).gamma, inclusion), theta)
}

/// Mean under H = 1 and variance under H = 0 of θ in one kind of noise, whose samples have standard
/// deviation `sd`.
fn check(names: [&str; 2], noise: Noise, sd: f64, detector: Detector, stream: u64) {
    ledger::run(names[0], |defect, replicate, row| {
        let (law, theta) = sample(
            noise,
            sd,
            detector,
            true,
            defect,
            stream + replicate,
            row.trials,
        );
        mean_rejects(&theta, law, row.alpha)
    });
    ledger::run(names[1], |defect, replicate, row| {
        let (law, theta) = sample(
            noise,
            sd,
            detector,
            false,
            defect,
            stream + 10 + replicate,
            row.trials,
        );
        variance_rejects(&theta, law, row.alpha)
    });
}

// Verifies: DET-040, DET-041.
#[test]
fn noise_that_the_channels_share() {
    let names = ["shared_noise_mean_h1", "shared_noise_variance_h0"];
    check(names, shared, 0.13_f64.sqrt(), shared_detector, 400);
}

// Verifies: DET-044.
#[test]
fn noise_with_feedback() {
    let names = ["feedback_noise_mean_h1", "feedback_noise_variance_h0"];
    check(names, feedback, 0.2 / 0.6, feedback_detector, 430);
}

// Verifies: DET-045.
#[test]
fn noise_of_a_moving_average() {
    let names = ["moving_average_mean_h1", "moving_average_variance_h0"];
    check(
        names,
        moving_average,
        0.0656_f64.sqrt(),
        moving_average_detector,
        460,
    );
}
