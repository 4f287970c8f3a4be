//! Θ_max, the position, and noise in proportion to force.

use crate::checks::{Law, count_rejects, excess_rejects, variance_rejects};
use crate::{ledger, seed};
use palpate::detect::mixture::mixture_theta;
use palpate::detect::position::{MaximumLaw, position_bound, slope};
use palpate::detect::scan::Scan;
use palpate::detect::simulate::count_false_alarms;
use palpate::detect::weber::{WeberNoise, theta_weber};
use palpate::detect::{Channels, neyman_pearson_false_alarm_threshold, theta_of_record};
use palpate::stats::binomial::clopper_pearson;
use palpate::stats::normal::{cdf, upper_tail};
use palpate::stats::random::Generator;

const UNIT: Channels<f64> = Channels { x: 1.0, y: 1.0 };

/// A bump and its slope, `length` samples, with that γ in noise of 1 N.
fn template(length: usize, width: f64, gamma: f64) -> Channels<Vec<f64>> {
    let position = |i: usize| (i as f64 - (length - 1) as f64 / 2.0) / width;
    let bump = |i: usize| (-0.5 * position(i) * position(i)).exp();
    let mut template = Channels {
        x: (0..length)
            .map(|i| position(i) * bump(i))
            .collect::<Vec<_>>(),
        y: (0..length).map(bump).collect::<Vec<_>>(),
    };
    let energy: f64 = template.x.iter().chain(&template.y).map(|t| t * t).sum();
    for sample in template.x.iter_mut().chain(&mut template.y) {
        *sample *= gamma / energy.sqrt();
    }
    template
}

fn view(channels: &Channels<Vec<f64>>) -> Channels<&[f64]> {
    Channels {
        x: &channels.x,
        y: &channels.y,
    }
}

// Verifies: DET-056, DET-058.
#[test]
fn false_alarms_of_theta_max_keep_their_bound() {
    const SAMPLES: usize = 48;
    let template = template(17, 3.0, 3.0);
    let scan = Scan::new(SAMPLES, view(&template), UNIT).unwrap();
    let count = scan.shifts().count();
    let (mut gamma, mut angle) = (vec![0.0; count], vec![0.0; count]);
    let law = MaximumLaw::new(&scan, *scan.shifts().start(), &mut gamma, &mut angle).unwrap();
    ledger::run("theta_max_false_alarms", |defect, replicate, row| {
        let eta = match defect {
            "threshold_of_one_position" => neyman_pearson_false_alarm_threshold(3.0, 0.05).unwrap(),
            _ => law.threshold(0.05).unwrap(),
        };
        let generator = Generator::new(seed(), 600 + replicate);
        let mut residual = [0.0; 2 * SAMPLES];
        let trials = 0..row.trials as u64;
        let alarms =
            count_false_alarms(&scan, scan.shifts(), eta, &generator, trials, &mut residual)
                .unwrap();
        if defect.is_empty() {
            // How far the bound is from the truth: the interval of the rate that was seen.
            let seen = clopper_pearson(alarms, row.trials as u64, 0.99).unwrap();
            let union = law.union_bound(eta).unwrap();
            println!(
                "false alarms: {:.4} to {:.4}, bound 0.05, union bound {union:.4}",
                seen.lower, seen.upper
            );
        }
        excess_rejects(alarms, row.trials as u64, 0.05, row.alpha)
    });
}

/// Errors of the refined shift, in samples, for an inclusion that is taken to be at shift 60 of a
/// record of 160 samples.
fn position_errors(
    template: &Channels<Vec<f64>>,
    place: usize,
    stream: u64,
    trials: usize,
) -> Vec<f64> {
    const SAMPLES: usize = 160;
    let generator = Generator::new(seed(), stream);
    let scan = Scan::new(SAMPLES, view(template), UNIT).unwrap();
    let mut deviates = [0.0; 2 * SAMPLES];
    (0..trials as u64)
        .map(|trial| {
            generator.normals(trial, 0, &mut deviates);
            let (x, y) = deviates.split_at_mut(SAMPLES);
            for i in 0..template.x.len() {
                x[place + i] += template.x[i];
                y[place + i] += template.y[i];
            }
            let found = scan.maximum(Channels { x, y }, scan.full_shifts()).unwrap();
            found.refined_shift - 60.0
        })
        .collect()
}

// Verifies: DET-053, DET-054, DET-060, DET-061.
#[test]
fn position_errors_meet_the_bound_of_cramer_and_rao_until_the_signal_is_too_weak() {
    ledger::run("position_error", |defect, replicate, row| {
        let gamma = if defect == "signal_below_the_threshold_effect" {
            2.5
        } else {
            25.0
        };
        let template = template(61, 6.0, gamma);
        let mut slopes = Channels {
            x: vec![0.0; 61],
            y: vec![0.0; 61],
        };
        slope(&template.x, 1.0, &mut slopes.x).unwrap();
        slope(&template.y, 1.0, &mut slopes.y).unwrap();
        let bound = position_bound(view(&slopes), UNIT).unwrap();
        let place = if defect == "template_shifted" { 61 } else { 60 };
        let errors = position_errors(&template, place, 610 + replicate, row.trials);
        let ratio = errors.iter().map(|e| e * e).sum::<f64>() / errors.len() as f64 / bound / bound;
        println!(
            "γ = {gamma}: mean square error {ratio:.3} of the bound's {:.5}",
            bound * bound
        );
        variance_rejects(
            &errors,
            Law {
                mean: 0.0,
                sd: bound,
            },
            row.alpha,
        )
    });
}

// Verifies: DET-070.
#[test]
fn a_mixture_of_depths_that_look_the_same_is_one_depth() {
    // Both depths have the template 2 N in noise of 1 N, so Λ = θ and its law is (8) with γ = 2.
    ledger::run(
        "mixture_false_alarms_at_5_percent",
        |defect, replicate, row| {
            let generator = Generator::new(seed(), 620 + replicate);
            let eta = neyman_pearson_false_alarm_threshold(2.0, 0.05).unwrap();
            let alarms = (0..row.trials as u64).filter(|&trial| {
                let theta = 2.0 * generator.normal(trial, 0) - 2.0;
                let mixture = mixture_theta(&[theta, theta], &[0.3, 0.7]).unwrap();
                let prior_left_out = if defect.is_empty() { 0.0 } else { 2.0_f64.ln() };
                mixture + prior_left_out >= eta
            });
            count_rejects(alarms.count() as u64, row.trials as u64, 0.05, row.alpha)
        },
    );
}

/// Forces and noise of one normal sample, where Θ is a quadratic in the noise and its law is known
/// exactly.
const FORCE: [f64; 2] = [1.5, 1.9];
const WEBER: WeberNoise = WeberNoise {
    floor: 0.05,
    fraction: 0.2,
};

/// Pr(Θ ≥ η) under either hypothesis, from the roots of Θ(F) = η.
fn weber_tail(inclusion: bool, eta: f64) -> f64 {
    let variance = FORCE.map(|force| 0.0025 + 0.04 * force * force);
    // Θ(F) − η = a F² + b F + c with a > 0, because the larger force has the larger variance.
    let a = 0.5 * (1.0 / variance[0] - 1.0 / variance[1]);
    let b = FORCE[1] / variance[1] - FORCE[0] / variance[0];
    let c = 0.5
        * (FORCE[0] * FORCE[0] / variance[0] - FORCE[1] * FORCE[1] / variance[1]
            + (variance[0] / variance[1]).ln())
        - eta;
    let root = (b * b - 4.0 * a * c).sqrt();
    let (mean, sd) = (
        FORCE[usize::from(inclusion)],
        variance[usize::from(inclusion)].sqrt(),
    );
    let standard = |force: f64| (force - mean) / sd;
    cdf(standard((-b - root) / (2.0 * a))).unwrap()
        + upper_tail(standard((-b + root) / (2.0 * a))).unwrap()
}

// Verifies: DET-080, DET-081.
#[test]
fn theta_in_proportional_noise_has_its_tails() {
    const ETA: f64 = 0.25;
    for (name, inclusion, stream) in [("weber_tail_h0", false, 630), ("weber_tail_h1", true, 640)] {
        ledger::run(name, |defect, replicate, row| {
            let generator = Generator::new(seed(), stream + replicate);
            let force = FORCE[usize::from(inclusion)];
            let alarms = (0..row.trials as u64).filter(|&trial| {
                let observed = force + WEBER.sd(force) * generator.normal(trial, 0);
                let record = Channels {
                    x: &[0.0][..],
                    y: &[observed],
                };
                let f0 = Channels {
                    x: &[0.0][..],
                    y: &FORCE[..1],
                };
                let f1 = Channels {
                    x: &[0.0][..],
                    y: &FORCE[1..],
                };
                let theta = match defect {
                    "constant_noise_presumed" => {
                        let sd = Channels {
                            x: 1.0,
                            y: WEBER.sd(FORCE[0]),
                        };
                        theta_of_record(record, f0, f1, sd).unwrap().theta
                    }
                    _ => {
                        let noise = Channels { x: WEBER, y: WEBER };
                        let theta = theta_weber(record, f0, f1, noise).unwrap();
                        let logarithm = (WEBER.sd(FORCE[0]) / WEBER.sd(FORCE[1])).ln();
                        if defect == "logarithm_left_out" {
                            theta - logarithm
                        } else {
                            theta
                        }
                    }
                };
                theta >= ETA
            });
            let alarms = alarms.count() as u64;
            count_rejects(
                alarms,
                row.trials as u64,
                weber_tail(inclusion, ETA),
                row.alpha,
            )
        });
    }
}
