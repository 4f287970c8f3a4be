//! Records that are judged row by row, against the rates of Wald's test, which a convolution gives (`power.py`).

use super::checks::count_test;
use super::{Check, Draw, Outcome};
use crate::Figure;
use palpate::detect::sequential::{Evidence, Sequential, Wald, memory};
use palpate::detect::{Decision, decide, neyman_pearson_false_alarm_threshold};

/// SEQ-001, SEQ-010, SEQ-012.
pub(super) const CHECKS: &[Check] = battery! {
    "sequential_false_alarms" => |draw| answers(draw, Decision::NoInclusion, ROWS, FALSE_ALARM);
    "sequential_misses" => |draw| answers(draw, Decision::Inclusion, ROWS, MISS);
    "sequential_false_alarms_of_a_short_record" => |draw| answers(draw, Decision::NoInclusion, SHORT, SHORT_FALSE_ALARM);
};

/// The rates that are asked for.
const RATE: f64 = 0.05;
/// Rows of a record, and of one that ends before the test does and is decided at 0 then.
const ROWS: usize = 40;
const SHORT: usize = 8;
/// The signal by turns at two depths of the probe, in noise of 1, and F_0 there less that at the mean depth.
const SIGNAL: [f64; 2] = [0.3, 0.9];
const FORCE: [f64; 2] = [-1.5, 1.5];
/// The rates by `power.py`.
const FALSE_ALARM: f64 = 0.030_131_586_940_330;
const MISS: f64 = 0.030_131_586_940_330;
const SHORT_FALSE_ALARM: f64 = 0.171_439_716_477_054;

/// Is the share of wrong answers that of the law?
fn answers(draw: &Draw<'_>, truth: Decision, rows: usize, rate: f64) -> Outcome<Figure> {
    let stream = 900 + 10 * u64::from(truth == Decision::Inclusion) + rows as u64;
    let generator = draw.generator(100 * stream + draw.replicate);
    let (mut wrong, mut noise) = (0, [0.0; ROWS]);
    for trial in 0..draw.trials() {
        generator.normals(trial, 0, &mut noise);
        let answer = answer(draw.defect, truth, &noise[..rows])?;
        wrong += u64::from(answer.is_some_and(|answer| answer != truth));
    }
    count_test(wrong, draw.trials(), rate, draw.row.alpha)
}

/// What a record is answered, with an offset that its first row tells.
fn answer(defect: &str, truth: Decision, noise: &[f64]) -> Outcome<Option<Decision>> {
    let test = Wald::new(RATE, RATE)?;
    let mut found = Sequential::new([0.0; memory(1, 1)], 1, 1)?;
    found.push(1e3, &[1.0], &[2.0])?;
    for (row, noise) in noise.iter().enumerate() {
        let (signal, force) = (SIGNAL[row % 2], FORCE[row % 2]);
        let there = if truth == Decision::Inclusion {
            signal
        } else {
            0.0
        };
        match defect {
            "depth_taken_as_constant" => found.push(noise + there + force, &[0.0], &[0.6])?,
            _ => found.push(noise + there, &[0.0], &[signal])?,
        }
        let evidence = found.evidence().next().ok_or("no evidence")?;
        if let Some(decision) = decided(defect, &test, evidence)? {
            return Ok(Some(decision));
        }
    }
    let evidence = found.evidence().next().ok_or("no evidence")?;
    let ends = noise.len() == SHORT && defect != "truncation_forgotten";
    Ok(if ends {
        Some(decide(theta(defect, evidence), 0.0)?)
    } else {
        None
    })
}

/// What is answered after a row.
fn decided(defect: &str, test: &Wald, evidence: Evidence) -> Outcome<Option<Decision>> {
    Ok(match defect {
        "fixed_test_at_each_row" => {
            let gamma = evidence.gamma_squared.sqrt();
            let eta = neyman_pearson_false_alarm_threshold(gamma, RATE)?;
            Some(decide(evidence.theta(), eta)?).filter(|answer| *answer == Decision::Inclusion)
        }
        _ => test.decide(theta(defect, evidence))?,
    })
}

fn theta(defect: &str, evidence: Evidence) -> f64 {
    match defect {
        "half_left_out" => evidence.theta() - 0.5 * evidence.gamma_squared,
        _ => evidence.theta(),
    }
}
