//! The position, several depths, and noise in proportion to force.

use super::checks::{Law, count_test, variance_test};
use super::{Check, Draw, Outcome};
use crate::Figure;
use palpate::detect::mixture::mixture_theta;
use palpate::detect::scan::Scan;
use palpate::detect::weber::{WeberNoise, theta_weber};
use palpate::detect::{neyman_pearson_false_alarm_threshold, theta_of_record};
use palpate::force::Force;
use palpate::stats::normal::{cdf, upper_tail};

/// DET-053, DET-054; DET-070; DET-080.
pub(super) const CHECKS: &[Check] = battery! {
    "position_error" => position_error;
    "position_error_of_a_cut_signal" => cut_position_error;
    "mixture_false_alarms_at_5_percent" => mixture_false_alarms;
    "weber_tail_h0" => |draw| weber(draw, false, 630);
    "weber_tail_h1" => |draw| weber(draw, true, 640);
};

const UNIT: Force<f64> = Force::new(1.0, 1.0);

/// A bump and its slope, `length` samples, with that γ in noise of 1 N.
fn template(length: usize, width: f64, gamma: f64) -> Force<Vec<f64>> {
    let position = |i: usize| (i as f64 - (length - 1) as f64 / 2.0) / width;
    let bump = |i: usize| libm::exp(-0.5 * position(i) * position(i));
    let mut template = Force::new(
        (0..length)
            .map(|i| position(i) * bump(i))
            .collect::<Vec<_>>(),
        (0..length).map(bump).collect::<Vec<_>>(),
    );
    let energy: f64 = template
        .lateral
        .iter()
        .chain(&template.normal)
        .map(|t| t * t)
        .sum();
    for sample in template.lateral.iter_mut().chain(&mut template.normal) {
        *sample *= gamma / energy.sqrt();
    }
    template
}

/// Errors of the refined shift, in samples, for an inclusion that is taken to be at shift 60 of a
/// record of 160 samples and lies at `place`.
fn position_errors(draw: &Draw<'_>, template: &Force<Vec<f64>>, place: usize) -> Outcome<Vec<f64>> {
    const SAMPLES: usize = 160;
    let generator = draw.generator(610 + draw.replicate);
    let scan = Scan::new(SAMPLES, template.as_deref(), UNIT)?;
    let mut deviates = [0.0; 2 * SAMPLES];
    let errors = (0..draw.trials()).map(|trial| {
        generator.normals(trial, 0, &mut deviates);
        let (x, y) = deviates.split_at_mut(SAMPLES);
        for i in 0..template.lateral.len() {
            x[place + i] += template.lateral[i];
            y[place + i] += template.normal[i];
        }
        let found = scan.maximum(Force::new(x, y), scan.full_shifts())?;
        Ok(found.refined_shift - 60.0)
    });
    errors.collect()
}

/// Errors of the position meet the bound of Cramér and Rao, until the signal is too weak.
fn position_error(draw: &Draw<'_>) -> Outcome<Figure> {
    let gamma = draw.planted("signal_below_the_threshold_effect", 2.5, 25.0);
    let template = template(61, 6.0, gamma);
    // No slope is left at the ends.
    let square = |pair: &[f64]| (0.5 * (pair[2] - pair[0])).powi(2);
    let channels = [&template.lateral, &template.normal].into_iter();
    let squares: f64 = channels.flat_map(|of| of.windows(3)).map(square).sum();
    let sd = 1.0 / squares.sqrt();
    let place = draw.planted("template_shifted", 61, 60);
    let errors = position_errors(draw, &template, place)?;
    variance_test(&errors, Law { mean: 0.0, sd }, draw.row.alpha)
}

/// Samples of a record and of its template, which is cut off where the signal has not died away.
const CUT: usize = 61;

/// The vertex of the sums of DET-050 over the shifts 0 to 14, in plain arithmetic. `record` holds x, then y. Where the overlap is
/// forgotten, each shift has the energy of the whole template.
fn plain_place(template: &Force<Vec<f64>>, record: &[f64], overlap_forgotten: bool) -> f64 {
    let (x, y) = record.split_at(CUT);
    let theta = |shift: usize| -> f64 {
        let kept = if overlap_forgotten { CUT } else { CUT - shift };
        let of_channel = |template: &[f64], record: &[f64]| {
            let pairs = template.iter().zip(&record[shift..]);
            let energy: f64 = template[..kept].iter().map(|t| t * t).sum();
            pairs.map(|(t, r)| t * r).sum::<f64>() - 0.5 * energy
        };
        of_channel(&template.lateral, x) + of_channel(&template.normal, y)
    };
    let thetas: Vec<f64> = (0..15).map(theta).collect();
    let larger = |best: usize, k| if thetas[k] > thetas[best] { k } else { best };
    let best = (1..14).fold(1, larger);
    let (before, here, after) = (thetas[best - 1], thetas[best], thetas[best + 1]);
    best as f64 + 0.5 * (after - before) / (2.0 * here - before - after)
}

/// Where the signal leaves the record before it has died away, the position is drawn back: an inclusion at 6 is found at 4.36, with
/// the error that the noise has to first order.
fn cut_position_error(draw: &Draw<'_>) -> Outcome<Figure> {
    const PLACE: usize = 6;
    const STEP: f64 = 1e-3;
    let whole = template(CUT + 2 * PLACE, 20.0, 1000.0);
    let template = Force::new(
        whole.lateral[PLACE..][..CUT].to_vec(),
        whole.normal[PLACE..][..CUT].to_vec(),
    );
    let signal = [&whole.lateral[..CUT], &whole.normal[..CUT]].concat();
    let mean = plain_place(&template, &signal, false);
    let slope = |i: usize| {
        let mut moved = signal.clone();
        moved[i] += STEP;
        (plain_place(&template, &moved, false) - mean) / STEP
    };
    let sd = (0..2 * CUT).map(|i| slope(i).powi(2)).sum::<f64>().sqrt();
    let generator = draw.generator(615 + draw.replicate);
    let scan = Scan::new(CUT, template.as_deref(), UNIT)?;
    let mut record = [0.0; 2 * CUT];
    let places = (0..draw.trials()).map(|trial| {
        generator.normals(trial, 0, &mut record);
        (record.iter_mut().zip(&signal)).for_each(|(sample, signal)| *sample += signal);
        if draw.defect == "overlap_forgotten" {
            return Ok(plain_place(&template, &record, true));
        }
        let (x, y) = record.split_at(CUT);
        Ok(scan.maximum(Force::new(x, y), 0..=14)?.refined_shift)
    });
    let places = places.collect::<Outcome<Vec<f64>>>()?;
    variance_test(&places, Law { mean, sd }, draw.row.alpha)
}

/// Two depths that look the same are one. Both have the template 2 N in noise of 1 N, so Λ = θ and
/// its law is (8) with γ = 2.
fn mixture_false_alarms(draw: &Draw<'_>) -> Outcome<Figure> {
    let generator = draw.generator(620 + draw.replicate);
    let eta = neyman_pearson_false_alarm_threshold(2.0, 0.05)?;
    let prior_left_out = draw.planted("prior_left_out", core::f64::consts::LN_2, 0.0);
    let mut alarms = 0;
    for trial in 0..draw.trials() {
        let theta = 2.0 * generator.normal(trial, 0) - 2.0;
        let mixture = mixture_theta(&[theta, theta], &[0.3, 0.7])?;
        alarms += u64::from(mixture + prior_left_out >= eta);
    }
    count_test(alarms, draw.trials(), 0.05, draw.row.alpha)
}

/// Forces and noise of one normal sample, where Θ is a quadratic in the noise and its law is known
/// exactly.
const FORCE: [f64; 2] = [1.5, 1.9];
const WEBER: WeberNoise = WeberNoise {
    floor: 0.05,
    fraction: 0.2,
};

/// Pr(Θ ≥ η) under either hypothesis, from the roots of Θ(F) = η.
fn weber_tail(inclusion: bool, eta: f64) -> Outcome<f64> {
    let variance = FORCE.map(|force| 0.0025 + 0.04 * force * force);
    // Θ(F) − η = a F² + b F + c with a > 0, because the larger force has the larger variance.
    let a = 0.5 * (1.0 / variance[0] - 1.0 / variance[1]);
    let b = FORCE[1] / variance[1] - FORCE[0] / variance[0];
    let c = 0.5
        * (FORCE[0] * FORCE[0] / variance[0] - FORCE[1] * FORCE[1] / variance[1]
            + libm::log(variance[0] / variance[1]))
        - eta;
    let root = (b * b - 4.0 * a * c).sqrt();
    let (mean, sd) = (
        FORCE[usize::from(inclusion)],
        variance[usize::from(inclusion)].sqrt(),
    );
    let standard = |force: f64| (force - mean) / sd;
    let below = cdf(standard((-b - root) / (2.0 * a)))?;
    Ok(below + upper_tail(standard((-b + root) / (2.0 * a)))?)
}

/// θ of one observed force, by the detector or by one with a defect.
fn weber_theta(observed: f64, defect: &str) -> Outcome<f64> {
    let channels = |y| Force::new(&[0.0][..], y);
    let record = channels(core::slice::from_ref(&observed));
    let (f0, f1) = (channels(&FORCE[..1]), channels(&FORCE[1..]));
    if defect == "constant_noise_presumed" {
        let sd = Force::new(1.0, WEBER.sd(FORCE[0]));
        return Ok(theta_of_record(record, f0, f1, sd)?.theta);
    }
    let theta = theta_weber(record, f0, f1, Force::new(WEBER, WEBER))?;
    Ok(match defect {
        "logarithm_left_out" => theta - libm::log(WEBER.sd(FORCE[0]) / WEBER.sd(FORCE[1])),
        _ => theta,
    })
}

/// Θ in proportional noise has its tails.
fn weber(draw: &Draw<'_>, inclusion: bool, stream: u64) -> Outcome<Figure> {
    const ETA: f64 = 0.25;
    let generator = draw.generator(stream + draw.replicate);
    let force = FORCE[usize::from(inclusion)];
    let mut alarms = 0;
    for trial in 0..draw.trials() {
        let observed = force + WEBER.sd(force) * generator.normal(trial, 0);
        alarms += u64::from(weber_theta(observed, draw.defect)? >= ETA);
    }
    count_test(
        alarms,
        draw.trials(),
        weber_tail(inclusion, ETA)?,
        draw.row.alpha,
    )
}
