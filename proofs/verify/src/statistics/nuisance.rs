//! Records with offsets, drifts and a gain of any size, against the laws of what is left beside those; and the test for white
//! noise.

use super::checks::{count_test, uniform_test};
use super::gaussian::traverse;
use super::{Check, Draw, Outcome};
use crate::Figure;
use palpate::detect::correlation::ljung_box;
use palpate::detect::nuisance::{
    NoiseLevel, Nuisances, SubspaceDetector, SubspaceStatistic, Threshold,
};
use palpate::force::Force;
use palpate::stats::noncentral::{Tail, chi_square, chi_square_point, f_ratio, student};
use palpate::stats::normal::cdf;

/// NUI-016; NUI-016, DET-130; NUI-016, DET-130; NUI-014, NUI-013, NUI-014; NUI-020. All but the last also NUI-001, NUI-003,
/// NUI-003, NUI-008.
pub(super) const CHECKS: &[Check] = battery! {
    "nuisance_t_kolmogorov" => |draw| law(draw, LONG, t, 700);
    "nuisance_residual_kolmogorov" => |draw| law(draw, SHORT, residual, 710);
    "nuisance_student_kolmogorov" => |draw| law(draw, SHORT, studentised, 720);
    "nuisance_f_kolmogorov" => |draw| law(draw, SHORT, squared, 730);
    "nuisance_errors_of_known_level" => |draw| errors(draw, NoiseLevel::Known, 740);
    "nuisance_errors_of_unknown_level" => |draw| errors(draw, NoiseLevel::Unknown, 750);
    "ljung_box_at_5_percent" => ljung_box_rate;
};

/// One sample of the traverse in so many: 41 a channel, γ = 9.17, or 5 a channel, γ = 3.19, which leave 4 degrees of freedom.
const LONG: usize = 10;
const SHORT: usize = 100;
const NOISE_SD: Force<f64> = Force::new(0.07, 0.09);
/// Standard deviation of the amplitudes of the nuisances: times that of the noise, the gain times F_0.
const AMPLITUDE: f64 = 100.0;

/// Five signals of unknown amplitude, by their names; `f0` is whitened.
fn nuisances(f0: Vec<f64>) -> [(&'static str, Vec<f64>); 5] {
    let samples = f0.len() / 2;
    let line = |sample: usize| 2.0 * sample as f64 / (samples - 1) as f64 - 1.0;
    let alone = |channel: usize, of: &dyn Fn(usize) -> f64| -> Vec<f64> {
        let sample = |i| {
            if i / samples == channel {
                of(i % samples)
            } else {
                0.0
            }
        };
        (0..2 * samples).map(sample).collect()
    };
    [
        ("lateral_offset", alone(0, &|_| 1.0)),
        ("normal_offset", alone(1, &|_| 1.0)),
        ("lateral_drift", alone(0, &line)),
        ("normal_drift", alone(1, &line)),
        ("gain", f0),
    ]
}

/// What the detector, or one with a defect, says about records, every second of which is of an inclusion; and whether it is. Each
/// record deviates from its hypothesis by so much of T, towards the other one.
fn statistics(
    draw: &Draw<'_>,
    step: usize,
    deviation: f64,
    stream: u64,
) -> Outcome<Vec<(bool, SubspaceStatistic)>> {
    let setting = traverse()?;
    let white = |force: &Force<Vec<f64>>| -> Vec<f64> {
        let channels = force.as_deref().zip(NOISE_SD).into_array().into_iter();
        let white = |(samples, sd): (&[f64], f64)| -> Vec<f64> {
            (samples.iter().step_by(step).map(|sample| sample / sd)).collect()
        };
        channels.flat_map(white).collect()
    };
    let (template, nuisances) = (white(&setting.template), nuisances(white(&setting.f0)));
    let left_out = draw.defect.strip_suffix("_left_out");
    let presumed = nuisances.iter().filter(|(name, _)| left_out != Some(*name));
    let mut space: Vec<f64> = presumed.flat_map(|(_, signal)| signal.clone()).collect();
    let space = Nuisances::new(&mut space, template.len())?;
    let mut projected = template.clone();
    let detector = SubspaceDetector::new(space, &mut projected)?;
    let generator = draw.generator(stream + draw.replicate);
    let towards_other = deviation / detector.gamma();
    let mut deviates = vec![0.0; template.len() + nuisances.len()];
    let statistics = (0..draw.trials()).map(|trial| {
        generator.normals(trial, 0, &mut deviates);
        let (record, amplitudes) = deviates.split_at_mut(template.len());
        let is_there = trial % 2 == 1;
        let inclusion = if is_there {
            1.0 - towards_other
        } else {
            towards_other
        };
        let signals = nuisances.iter().map(|(_, signal)| signal);
        let amplitudes = amplitudes.iter().map(|amplitude| AMPLITUDE * amplitude);
        for (signal, amplitude) in signals.zip(amplitudes).chain([(&template, inclusion)]) {
            let samples = record.iter_mut().zip(signal);
            samples.for_each(|(sample, signal)| *sample += amplitude * signal);
        }
        let found = detector.statistic(record)?;
        Ok((is_there, with_defect(draw.defect, &detector, found)))
    });
    statistics.collect()
}

/// What is said where a formula has a defect.
fn with_defect(
    defect: &str,
    detector: &SubspaceDetector<'_>,
    mut found: SubspaceStatistic,
) -> SubspaceStatistic {
    match defect {
        "nominal_gamma" => {
            found.gamma = detector.gamma_nominal();
            found.t *= detector.gamma() / found.gamma;
        }
        "template_left_in" => found.residual += found.t * found.t,
        "degrees_off_by_one" => found.degrees += 1.0,
        _ => {}
    }
    found
}

/// The probability of a smaller value than that of a statistic, by the law about a centre; with a defect's name.
type Below = fn(&str, f64, SubspaceStatistic) -> Outcome<f64>;

/// Has a value its law, with and without an inclusion?
fn law(draw: &Draw<'_>, step: usize, below: Below, stream: u64) -> Outcome<Figure> {
    let statistics = statistics(draw, step, 0.0, stream)?.into_iter();
    let below = statistics.map(|(is_there, found)| {
        let centre = if is_there { found.gamma } else { 0.0 };
        below(draw.defect, centre, found)
    });
    let below = below.collect::<Outcome<_>>()?;
    Ok(uniform_test(below, draw.row.alpha))
}

fn t(_: &str, centre: f64, found: SubspaceStatistic) -> Outcome<f64> {
    Ok(cdf(found.test(NoiseLevel::Known, 0.0)?.t - centre)?)
}

fn residual(_: &str, _: f64, found: SubspaceStatistic) -> Outcome<f64> {
    Ok(chi_square(found.residual, found.degrees, 0.0)?.lower)
}

/// T over the estimate of σ, which is 1.
fn studentised(defect: &str, centre: f64, found: SubspaceStatistic) -> Outcome<f64> {
    let t = found.test(NoiseLevel::Unknown, 0.0)?.t;
    Ok(match defect {
        "central_law" => student(t, found.degrees, 0.0)?.lower,
        "normal_law" => cdf(t - centre)?,
        _ => student(t, found.degrees, centre)?.lower,
    })
}

fn squared(defect: &str, centre: f64, found: SubspaceStatistic) -> Outcome<f64> {
    let t = found.test(NoiseLevel::Unknown, 0.0)?.t;
    let (square, noncentrality) = (t * t, centre * centre);
    let tails = match defect {
        "central_law" => f_ratio(square, 1.0, found.degrees, 0.0),
        "chi_square_law" => chi_square(square, 1.0, noncentrality),
        _ => f_ratio(square, 1.0, found.degrees, noncentrality),
    };
    Ok(tails?.lower)
}

/// Have false alarms and misses at their thresholds the rate that was asked for, in records that deviate by the bias?
fn errors(draw: &Draw<'_>, level: NoiseLevel, stream: u64) -> Outcome<Figure> {
    const RATE: f64 = 0.01;
    const BIAS: f64 = 0.5;
    let presumed = draw.planted("bias_left_out", 0.0, BIAS);
    let statistics = statistics(draw, SHORT, BIAS, stream)?.into_iter();
    let wrong = statistics.map(|(is_there, found)| {
        let mut test = found.test(level, presumed)?;
        if draw.defect == "normal_law" {
            test.degrees = None;
        }
        // Beyond the threshold for a rate are the T of a lower one.
        let rates = test.rates(Threshold::At(test.t))?;
        let rate = if is_there {
            rates.miss
        } else {
            rates.false_alarm
        };
        Ok(u64::from(rate < RATE))
    });
    let wrong = wrong.sum::<Outcome<u64>>()?;
    count_test(wrong, draw.trials(), RATE, draw.row.alpha)
}

/// How often is the autocorrelation of white noise less probable than 5 %? With so few samples a little less often than that, but
/// how often is known exactly.
fn ljung_box_rate(draw: &Draw<'_>) -> Outcome<Figure> {
    const SAMPLES: usize = 20;
    /// By Imhof's integral, `autocorrelation_rate` in `power.py`.
    const RATE: f64 = 0.047_389_859_56;
    // With one lag, a defect of the statistic or its law is another level of p.
    let point = |degrees| chi_square_point(Tail::Upper(0.05), degrees);
    let least = match draw.defect {
        "degrees_off_by_one" => point(2.0)?,
        "n_for_n_plus_2" => point(1.0)? * 22.0 / 20.0,
        _ => point(1.0)?,
    };
    let level = chi_square(least, 1.0, 0.0)?.upper;
    let generator = draw.generator(760 + draw.replicate);
    let mut noise = [0.0; SAMPLES];
    let improbable = (0..draw.trials()).map(|trial| {
        generator.normals(trial, 0, &mut noise);
        Ok(u64::from(ljung_box(&noise, 1)? <= level))
    });
    let improbable = improbable.sum::<Outcome<u64>>()?;
    count_test(improbable, draw.trials(), RATE, draw.row.alpha)
}
