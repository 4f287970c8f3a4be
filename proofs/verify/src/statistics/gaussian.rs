//! Records in white noise, from the two forces to θ, against N(±γ²/2, γ²).

use super::checks::{Law, Test, count_test, kolmogorov_test, mean_test, tail_test, variance_test};
use super::{Check, Draw, Outcome};
use crate::Figure;
use palpate::detect::simulate::Simulation;
use palpate::detect::{neyman_pearson_false_alarm_threshold, neyman_pearson_miss_threshold};
use palpate::force::Force;

/// DET-015, DET-013, DET-015, DET-022, DET-025, DET-026, DET-113.
pub(super) const CHECKS: &[Check] = battery! {
    "coarse_mean_h0" => |draw| law(draw, COARSE, false, 0, mean_test);
    "coarse_mean_h1" => |draw| law(draw, COARSE, true, 1, mean_test);
    "coarse_variance_h0" => |draw| law(draw, COARSE, false, 2, variance_test);
    "coarse_variance_h1" => |draw| law(draw, COARSE, true, 3, variance_test);
    "coarse_kolmogorov_h0" => |draw| law(draw, COARSE, false, 4, kolmogorov_test);
    "coarse_kolmogorov_h1" => |draw| law(draw, COARSE, true, 5, kolmogorov_test);
    "coarse_false_alarms_at_1_percent" => coarse_false_alarms;
    "coarse_misses_at_5_percent" => coarse_misses;
    "coarse_noise_variance" => coarse_noise_variance;
    "single_mean_h1" => |draw| law(draw, SINGLE, true, 100, mean_test);
    "single_variance_h0" => |draw| law(draw, SINGLE, false, 110, variance_test);
    "traverse_mean_h1" => |draw| law(draw, TRAVERSE, true, 200, mean_test);
    "traverse_variance_h0" => |draw| law(draw, TRAVERSE, false, 210, variance_test);
    "traverse_false_alarms_at_5_percent" => traverse_false_alarms;
};

/// A setting, and the distance of the streams of two replicates.
type Series = (fn() -> Outcome<Setting>, u64);
const COARSE: Series = (coarse, 10);
const SINGLE: Series = (single, 1);
const TRAVERSE: Series = (traverse, 1);

/// A pair of hypotheses and their noise.
pub(super) struct Setting {
    pub f0: Force<Vec<f64>>,
    pub template: Force<Vec<f64>>,
    noise_sd: Force<f64>,
}

/// Eight coarse samples, both channels: γ = 1.91.
fn coarse() -> Outcome<Setting> {
    Ok(Setting {
        f0: Force::new(vec![0.0; 8], vec![1.48; 8]),
        template: Force::new(
            vec![0.02, 0.09, 0.16, 0.12, -0.12, -0.16, -0.09, -0.02],
            vec![0.03, 0.10, 0.22, 0.33, 0.33, 0.22, 0.10, 0.03],
        ),
        noise_sd: Force::new(0.25, 0.4),
    })
}

/// One lateral sample: γ = ½.
fn single() -> Outcome<Setting> {
    Ok(Setting {
        f0: Force::new(vec![0.1], vec![1.5]),
        template: Force::new(vec![-0.05], vec![0.0]),
        noise_sd: Force::new(0.1, 0.1),
    })
}

/// The forces of a traverse at 4 mm depth from the finite elements, as `palpate solve --phantom NAME --depths-mm 4
/// --laterals-mm -10:10:0.5 --format csv` prints them.
const TRAVERSE_WITHOUT: &str = include_str!("traverse_none.csv");
const TRAVERSE_WITH: &str = include_str!("traverse_4.6.csv");

/// Samples of a traverse between two positions of its file.
const SAMPLES_PER_POSITION: usize = 10;

/// 401 samples of a traverse over the inclusion 4.6 mm deep, as the paper's probe makes it: γ = 9.30.
pub(super) fn traverse() -> Outcome<Setting> {
    let (f0, f1) = (sampled(TRAVERSE_WITHOUT)?, sampled(TRAVERSE_WITH)?);
    let pairs = f0.as_ref().zip(f1.as_ref());
    let template = pairs.map(|(f0, f1)| f0.iter().zip(f1).map(|(f0, f1)| f1 - f0).collect());
    Ok(Setting {
        f0,
        template,
        noise_sd: Force::new(0.5, 0.6615),
    })
}

/// The forces of a file, interpolated linearly between its positions.
fn sampled(file: &str) -> Outcome<Force<Vec<f64>>> {
    let mut rows: Vec<[f64; 2]> = Vec::new();
    for line in file.lines().skip(1) {
        // depth_mm, lateral_mm, normal_force_n, lateral_force_n
        let fields = line
            .split(',')
            .map(str::parse)
            .collect::<Result<Vec<f64>, _>>()?;
        let [_, _, normal, lateral] = fields[..] else {
            return Err(format!("{line:?} has not four fields").into());
        };
        rows.push([lateral, normal]);
    }
    let samples = SAMPLES_PER_POSITION * rows.len().saturating_sub(1);
    let channel = |c: usize| {
        let sample = |i: usize| {
            let (row, part) = (i / SAMPLES_PER_POSITION, i % SAMPLES_PER_POSITION);
            let (here, next) = (rows[row][c], rows[(row + 1).min(rows.len() - 1)][c]);
            here + part as f64 / SAMPLES_PER_POSITION as f64 * (next - here)
        };
        (0..=samples).map(sample).collect()
    };
    Ok(Force::new(channel(0), channel(1)))
}

fn forces(setting: &Setting, inclusion: bool) -> Force<Vec<f64>> {
    let share = if inclusion { 1.0 } else { 0.0 };
    let channels = setting.f0.as_ref().zip(setting.template.as_ref());
    channels.map(|(f0, template)| {
        f0.iter()
            .zip(template)
            .map(|(f0, t)| f0 + share * t)
            .collect()
    })
}

/// The law that θ should have, and a sample of θ from records judged by the library, or by a
/// detector with a defect.
fn sample(
    draw: &Draw<'_>,
    (setting, step): Series,
    inclusion: bool,
    stream: u64,
) -> Outcome<(Law, Vec<f64>)> {
    let setting = setting()?;
    let simulation = Simulation::new(
        setting.f0.as_deref(),
        setting.template.as_deref(),
        setting.noise_sd,
        draw.generator(stream + step * draw.replicate),
    )?;
    let force = forces(&setting, inclusion);
    let mut residual = vec![0.0; 2 * setting.f0.lateral.len()];
    let thetas = (0..draw.trials()).map(|trial| {
        let statistic = simulation.trial(trial, force.as_deref(), &mut residual)?;
        Ok(if draw.defect.is_empty() {
            statistic.theta
        } else {
            with_defect(&setting, inclusion, &residual, draw.defect)
        })
    });
    let thetas = thetas.collect::<Outcome<_>>()?;
    let law = Law::of_theta(simulation.filter().gamma(), inclusion);
    Ok((law, thetas))
}

/// θ of a detector with one defect, in plain arithmetic.
fn with_defect(setting: &Setting, inclusion: bool, residual: &[f64], defect: &str) -> f64 {
    let Setting {
        template, noise_sd, ..
    } = setting;
    let (x, y) = residual.split_at(template.lateral.len());
    let (template_x, template_y) = match defect {
        "channels_swapped" => (&template.normal, &template.lateral),
        _ => (&template.lateral, &template.normal),
    };
    let mut theta = 0.0;
    for (residual, template, truth, sd) in [
        (x, template_x, &template.lateral, noise_sd.lateral),
        (y, template_y, &template.normal, noise_sd.normal),
    ] {
        for (i, (&residual, &truth)) in residual.iter().zip(truth).enumerate() {
            let template = match (defect, i) {
                ("template_shifted", 0) => 0.0,
                ("template_shifted", i) => template[i - 1],
                (_, i) => template[i],
            };
            let signal = if inclusion { truth } else { 0.0 };
            let residual = match defect {
                // The noise in the record has a variance 1 % above what the detector presumes.
                "variance_off_1_percent" => signal + (residual - signal) * libm::sqrt(1.01),
                _ => residual,
            };
            let half = if defect == "half_left_out" { 1.0 } else { 0.5 };
            let variance = if defect == "sd_for_variance" {
                sd
            } else {
                sd * sd
            };
            theta += template * (residual - half * template) / variance;
        }
    }
    theta
}

/// Has a sample of θ its law, by a test of significance?
fn law(
    draw: &Draw<'_>,
    series: Series,
    inclusion: bool,
    stream: u64,
    test: Test,
) -> Outcome<Figure> {
    let (law, theta) = sample(draw, series, inclusion, stream)?;
    test(&theta, law, draw.row.alpha)
}

/// The noise of each of a record's 16 samples, which tells of its variance what θ, one number a record, tells with 16 times the trials.
fn coarse_noise_variance(draw: &Draw<'_>) -> Outcome<Figure> {
    let setting = coarse()?;
    let f0 = setting.f0.as_deref();
    let generator = draw.generator(8 + 10 * draw.replicate);
    let simulation = Simulation::new(f0, setting.template.as_deref(), setting.noise_sd, generator)?;
    let excess = draw.planted("variance_off_1_percent", libm::sqrt(1.01), 1.0);
    let mut residual = [0.0; 16];
    let mut noise = Vec::new();
    for trial in 0..draw.trials() {
        simulation.trial(trial, f0, &mut residual)?;
        let (x, y) = residual.split_at(8);
        noise.extend(x.iter().map(|x| excess * x / setting.noise_sd.lateral));
        noise.extend(y.iter().map(|y| excess * y / setting.noise_sd.normal));
    }
    let law = Law { mean: 0.0, sd: 1.0 };
    variance_test(&noise, law, draw.row.alpha)
}

fn coarse_false_alarms(draw: &Draw<'_>) -> Outcome<Figure> {
    let (law, theta) = sample(draw, COARSE, false, 6)?;
    let eta = neyman_pearson_false_alarm_threshold(law.sd, 0.01)?;
    let alarms = theta.iter().filter(|&&theta| theta >= eta).count();
    count_test(alarms as u64, draw.trials(), 0.01, draw.row.alpha)
}

fn coarse_misses(draw: &Draw<'_>) -> Outcome<Figure> {
    let (law, theta) = sample(draw, COARSE, true, 7)?;
    let eta = neyman_pearson_miss_threshold(law.sd, 0.05)?;
    let misses = theta.iter().filter(|&&theta| theta < eta).count();
    count_test(misses as u64, draw.trials(), 0.05, draw.row.alpha)
}

fn traverse_false_alarms(draw: &Draw<'_>) -> Outcome<Figure> {
    let (law, theta) = sample(draw, TRAVERSE, false, 220)?;
    let eta = neyman_pearson_false_alarm_threshold(law.sd, 0.05)?;
    tail_test(&theta, law, eta, draw.row.alpha)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_plain_detector_without_a_defect_is_the_library() {
        let mut rows = crate::statistics::ledger::ROWS.iter();
        let row = rows.find(|row| row.name == "traverse_mean_h1").unwrap();
        let thetas = |defect| {
            let draw = Draw {
                seed: 5,
                defect,
                replicate: 0,
                row,
            };
            sample(&draw, COARSE, true, 0).unwrap().1
        };
        for (plain, library) in std::iter::zip(thetas("none"), thetas("")) {
            assert!((plain - library).abs() < 1e-13);
        }
    }
}
