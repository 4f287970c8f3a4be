//! Records of known classes of disturbance and signals, against the posteriors of the robust detector's evidence.

use std::iter::zip;

use super::checks::{log_sum, odds_test};
use super::{Check, Draw, Outcome};
use crate::Figure;
use palpate::oracle::Oracle;
use palpate::stats::random::Generator;
use serde::Deserialize;

/// ROB-031, ROB-032.
pub(super) const CHECKS: &[Check] = battery! {
    "robust_posterior_of_inclusion" => of_inclusion;
    "robust_posterior_of_classes" => of_classes;
    "robust_posterior_of_signals" => of_signals;
};

type Modes = [f64; 6];

/// Variance of each mode.
const NOISE: f64 = 0.25;
/// Standard deviations of a signal's amplitude and shape, over those of the signal (ROB-031).
const AMPLITUDE: f64 = 0.4;
const SHAPE: f64 = 0.15;
const PRIOR_H1: f64 = 0.4;
/// Weights of the classes, which do not add up to 1, and directions of which each has a normal amplitude.
const WEIGHTS: [f64; 4] = [8.0, 2.0, 1.0, 1.0];
const OFFSET: Modes = [2.0, 0.0, 0.0, 0.0, 0.0, 0.0];
const CLASSES: [&[Modes]; 4] = [
    &[OFFSET],
    &[
        OFFSET,
        [0.0, 2.0, 1.0, 0.0, 0.0, 1.0],
        [0.0, 0.0, 2.0, 1.0, 0.0, -3.0],
    ],
    &[OFFSET, [2.0, 0.0, -2.0, 2.0, 0.0, 3.0]],
    &[OFFSET, [0.0, 1.0, 3.0, -2.0, 1.0, 3.0]],
];
/// Signals; two sizes, so that the nearest of eight is each one's own.
const MEANS: [Modes; 4] = [
    [0.0, 2.0, 3.0, -1.0, 1.0, 2.0],
    [0.0, 1.0, 2.0, -2.0, 1.0, 2.0],
    [0.0, 1.0, 2.0, 0.0, -1.0, 2.0],
    [0.0, 1.0, 1.0, -1.0, 0.0, 1.0],
];
const SIZES: [f64; 4] = [4.0, 4.0, 2.0, 2.0];
const PRIOR: [f64; 4] = [0.3, 0.3, 0.2, 0.2];
const SHAPES: &[Modes] = &[
    [0.0, 1.0, 0.0, 1.0, 0.0, 0.0],
    [0.0, 0.0, 1.0, 0.0, 1.0, 0.0],
    [0.0, 0.0, 0.0, 1.0, 1.0, 1.0],
];

/// A record, and what it is of.
struct Truth {
    is_inclusion: bool,
    class: usize,
    signal: usize,
    record: Modes,
}

impl Truth {
    /// By its parts: noise, directions of its class, and a signal of its own amplitude and shape.
    fn new(generator: &Generator, trial: u64, prior_h1: f64) -> Truth {
        let shares = generator.words([0, trial, 2, 0]);
        let [of_h, of_class, of_signal, _] =
            shares.map(|word| (word >> 11) as f64 / (1_u64 << 53) as f64);
        let is_inclusion = of_h < prior_h1;
        let (class, signal) = (chosen(&WEIGHTS, of_class), chosen(&PRIOR, of_signal));
        let mut deviates = [0.0; 13];
        generator.normals(trial, 0, &mut deviates);
        let mut record: Modes = std::array::from_fn(|mode| NOISE.sqrt() * deviates[mode]);
        let mut add = |times: f64, direction: &Modes| {
            zip(&mut record, direction).for_each(|(sum, part)| *sum += times * part);
        };
        zip(CLASSES[class], &deviates[6..9]).for_each(|(direction, of)| add(*of, direction));
        if is_inclusion {
            add(1.0 + AMPLITUDE * deviates[9], &MEANS[signal]);
            let share = SHAPE * SIZES[signal];
            zip(SHAPES, &deviates[10..]).for_each(|(direction, of)| add(share * of, direction));
        }
        Truth {
            is_inclusion,
            class,
            signal,
            record,
        }
    }
}

/// The first number up to which `shares` hold this part of their sum.
fn chosen(shares: &[f64], part: f64) -> usize {
    let mut left = part * shares.iter().sum::<f64>();
    let is_beyond = |share: &f64| {
        left -= share;
        left < 0.0
    };
    shares.iter().position(is_beyond).unwrap_or(0)
}

/// Σ vvᵀ, with more directions of their own lengths.
fn covariance(directions: &[Modes], more: &[Modes], times: f64) -> [Modes; 6] {
    let mut sum = [[0.0; 6]; 6];
    let more = more.iter().map(|direction| (times, direction));
    for (times, v) in directions.iter().map(|v| (1.0, v)).chain(more) {
        zip(&mut sum, v).for_each(|(row, a)| zip(row, v).for_each(|(at, b)| *at += times * a * b));
    }
    sum
}

/// The evidence of the oracle.
#[derive(Deserialize)]
struct Evidence {
    without: Vec<f64>,
    by_class: Vec<f64>,
    with: Vec<f64>,
}

#[derive(Deserialize)]
struct Line {
    ok: Evidence,
}

/// The detector, or one with a defect.
struct Detector<'a> {
    oracle: Oracle,
    defect: &'a str,
    modes: usize,
    /// What every question has in common, and for each signal what it has if its amplitude is certain.
    question: String,
    fixed: Vec<String>,
}

impl Detector<'_> {
    fn new(defect: &str) -> Detector<'_> {
        let modes = if defect == "one_mode_short" { 5 } else { 6 };
        let question = question(defect, modes, 0.0);
        let fixed = match defect {
            "amplitude_fixed" => SIZES.map(|size| self::question("", modes, size)).to_vec(),
            _ => Vec::new(),
        };
        Detector {
            oracle: Oracle::default(),
            defect,
            modes,
            question,
            fixed,
        }
    }

    fn evidence(&mut self, record: &Modes) -> Outcome<Evidence> {
        let squares = record.map(|value| value * value);
        let noise = match self.defect {
            "noise_from_the_misfit" => squares.iter().sum::<f64>() / 6.0,
            // The last mode is among ten that are taken for noise.
            "one_mode_short" => 0.9 * NOISE + 0.1 * squares[5],
            _ => NOISE,
        };
        let mut ask = |record: &[f64], question: &str| -> Outcome<Evidence> {
            let noise = vec![noise; record.len()];
            let line = format!(
                r#"{{"id":0,"op":"robust_evidence","args":{{"record":{record:?},"noise":{noise:?},{question}}}}}"#
            );
            let mut answer = Vec::new();
            self.oracle.answer(line.as_bytes(), &mut answer);
            let line: Line = serde_json::from_slice(&answer)?;
            Ok(line.ok)
        };
        let mut found = ask(&record[..self.modes], &self.question)?;
        if self.defect == "weights_under_one_hypothesis" {
            let whole = libm::log(WEIGHTS.iter().sum());
            found.without.iter_mut().for_each(|log| *log += whole);
        }
        if self.defect == "amplitude_fixed" {
            // The density of what the signal leaves, in classes with its shape's error.
            let mut by_class = [[0.0; 4]; 4];
            for (signal, question) in self.fixed.iter().enumerate() {
                let left: Vec<f64> = zip(record, MEANS[signal]).map(|(y, m)| y - m).collect();
                let density = ask(&left, question)?.without;
                found.with[signal] = log_sum(&density);
                for (logs, density) in zip(&mut by_class, density) {
                    logs[signal] = density + libm::log(PRIOR[signal]);
                }
            }
            found.by_class = by_class.iter().map(|logs| log_sum(logs)).collect();
        }
        Ok(found)
    }
}

/// Classes, signals and shape as arguments of the oracle, with the error of the shape of a signal of some size in each class.
fn question(defect: &str, modes: usize, size: f64) -> String {
    let mut weights = WEIGHTS;
    match defect {
        "weights_left_out" => weights = [1.0; 4],
        "class_forgotten" => weights[3] = 1e-12,
        _ => {}
    }
    let cut = |row: &Modes| row[..modes].to_vec();
    let share = SHAPE * size;
    let classes = CLASSES.map(|class| covariance(class, SHAPES, share * share));
    let rows = classes.iter().flat_map(|class| &class[..modes]);
    let covariances: Vec<_> = rows.map(cut).collect();
    let shape: Vec<_> = covariance(SHAPES, &[], 0.0)[..modes]
        .iter()
        .map(cut)
        .collect();
    let signals = MEANS.each_ref().map(cut);
    format!(
        r#""weights":{weights:?},"covariances":{covariances:?},"signals":{signals:?},"sizes":{SIZES:?},"prior":{PRIOR:?},"shape":{shape:?}"#
    )
}

/// Tests what `cells` says of each record: ln of the weight of each cell, and which of them is true.
fn tested(
    draw: &Draw<'_>,
    stream: u64,
    prior_h1: f64,
    scores: &[f64],
    cells: impl Fn(&Truth, &Evidence) -> (Vec<f64>, usize),
) -> Outcome<Figure> {
    let generator = draw.generator(stream + draw.replicate);
    let mut detector = Detector::new(draw.defect);
    let told = (0..draw.trials()).map(|trial| {
        let truth = Truth::new(&generator, trial, prior_h1);
        let found = detector.evidence(&truth.record)?;
        Ok(cells(&truth, &found))
    });
    odds_test(told, scores, draw.row.alpha)
}

/// Is there an inclusion as often as the posterior says?
fn of_inclusion(draw: &Draw<'_>) -> Outcome<Figure> {
    tested(draw, 830, PRIOR_H1, &[0.0, 1.0], |truth, found| {
        let none = libm::log(1.0 - PRIOR_H1) + log_sum(&found.without);
        let any = libm::log(PRIOR_H1) + log_sum(&found.by_class);
        (vec![none, any], usize::from(truth.is_inclusion))
    })
}

/// Is each class with and without an inclusion the true one as often as its posterior says? The score is of the first.
fn of_classes(draw: &Draw<'_>) -> Outcome<Figure> {
    let scores = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0];
    tested(draw, 840, PRIOR_H1, &scores, |truth, found| {
        let none = found
            .without
            .iter()
            .map(|log| log + libm::log(1.0 - PRIOR_H1));
        let any = found.by_class.iter().map(|log| log + libm::log(PRIOR_H1));
        let cell = truth.class + 4 * usize::from(truth.is_inclusion);
        (none.chain(any).collect(), cell)
    })
}

/// Is each signal the true one as often as its posterior says, given an inclusion? The score is its number.
fn of_signals(draw: &Draw<'_>) -> Outcome<Figure> {
    tested(
        draw,
        850,
        1.0,
        &[0.0, 1.0 / 3.0, 2.0 / 3.0, 1.0],
        |truth, found| {
            let logs = zip(&found.with, PRIOR).map(|(log, prior)| log + libm::log(prior));
            (logs.collect(), truth.signal)
        },
    )
}
