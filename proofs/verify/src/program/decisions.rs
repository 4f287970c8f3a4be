//! What `palpate detect` decides on made-up maps, against plain sums, and what it must not decide.

use std::path::Path;
use std::process::Output;

use serde_json::Value;
use tempfile::TempDir;

use super::run_in;
use crate::Measured;
use palpate::phantom::Phantom;
use palpate::stats::normal::upper_tail;
use palpate::stats::random::Generator;

/// Samples of the sweep, 0.5 mm apart, and the standard deviation of their noise, N.
const SAMPLES: usize = 41;
const NOISE: f64 = 0.05;
/// Indentation of the sweep, and how far it may be off, mm.
const DEPTH: f64 = 3.0;
const TOLERANCE: f64 = 0.1;
/// The size of the inclusion's force, so that γ is about 5.
const SIZE: f64 = 0.125;

/// Rounding of sums of 82 numbers of up to 30 standard deviations of the noise each: 82 · 30 · 2⁻⁵³, and as much again for the program's.
const SUMS: f64 = 1e-12;
/// The probability beyond either limit of χ² (TRC-070).
const BEYOND: f64 = 5e-7;

fn position(sample: usize) -> f64 {
    0.5 * sample as f64 - 10.0
}

/// The lateral and the normal force at a place of the sweep, N, which are in proportion to the depth in mm.
fn forces(depth: f64, x: f64, inclusion: bool) -> [f64; 2] {
    let bump = (-x * x / 8.0).exp() * if inclusion { SIZE } else { 0.0 };
    [-0.1 * depth * x * bump, depth * (0.5 + 0.2 * bump)]
}

/// The sweep as one list, over the noise.
fn scaled(depth: f64, inclusion: bool) -> Vec<f64> {
    let samples = (0..SAMPLES).flat_map(|i| forces(depth, position(i), inclusion));
    samples.map(|force| force / NOISE).collect()
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn difference(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a - b).collect()
}

/// The forces of a sweep with the inclusion and noise, N.
fn record() -> [[f64; 2]; SAMPLES] {
    let mut noise = [0.0; 2 * SAMPLES];
    Generator::new(20_261_123, 0).normals(0, 0, &mut noise);
    let sample = |i: usize| {
        let [lateral, normal] = forces(DEPTH, position(i), true);
        [
            lateral + NOISE * noise[2 * i],
            normal + NOISE * noise[2 * i + 1],
        ]
    };
    std::array::from_fn(sample)
}

/// A folder with the maps `without.csv` and `with.csv`, deleted at the end.
struct Folder(TempDir);

impl Folder {
    fn new() -> Measured<Folder> {
        let folder = Folder(TempDir::new()?);
        for (name, inclusion) in [("without.csv", false), ("with.csv", true)] {
            let rows = [2.0, DEPTH].into_iter().flat_map(|depth| {
                (0..SAMPLES).map(move |i| {
                    let [lateral, normal] = forces(depth, position(i), inclusion);
                    format!("{depth},{},{lateral:e},{normal:e}\n", position(i))
                })
            });
            let head = "depth_mm,lateral_mm,lateral_force_n,normal_force_n\n";
            folder.write(name, &[head.into(), rows.collect::<String>()].concat())?;
        }
        Ok(folder)
    }

    fn write(&self, name: &str, text: &str) -> Measured<()> {
        let path = self.0.path().join(name);
        let written = std::fs::write(&path, text);
        Ok(written.map_err(|error| format!("{}: {error}", path.display()))?)
    }

    /// Writes a record.
    fn write_record(&self, name: &str, forces: &[[f64; 2]]) -> Measured<()> {
        let rows = (0..)
            .zip(forces)
            .map(|(i, [lateral, normal])| format!("{},{lateral:e},{normal:e}\n", position(i)));
        let head = "position_mm,lateral_force_n,normal_force_n\n";
        self.write(name, &[head.into(), rows.collect::<String>()].concat())
    }

    /// What the program does with arguments, which spaces separate.
    fn run(&self, program: &Path, arguments: &str) -> Measured<Output> {
        run_in(
            self.0.path(),
            program,
            &arguments.split(' ').collect::<Vec<_>>(),
        )
    }
}

const MAPS: &str = "--reference without.csv --inclusion with.csv";
const KNOWN: &str = "--depth-mm 3 --noise white --known all --format json";

/// What plain sums say of a record.
struct Sums {
    gamma: f64,
    t: f64,
    chi_square: f64,
    /// The largest change of T's mean by a depth that is off by its tolerance.
    bias: f64,
}

impl Sums {
    fn of(record: &[[f64; 2]; SAMPLES]) -> Sums {
        let [without, with] = [false, true].map(|inclusion| scaled(DEPTH, inclusion));
        let signal = difference(&with, &without);
        let gamma = dot(&signal, &signal).sqrt();
        let scaled_record: Vec<f64> = record.iter().flatten().map(|force| force / NOISE).collect();
        let rest = difference(&scaled_record, &without);
        let t = dot(&rest, &signal) / gamma;
        // Forces in proportion to the depth: a depth off by 0.1 mm of 3 mm changes them by this share.
        let slope = |map: &[f64]| TOLERANCE / DEPTH * dot(map, &signal).abs() / gamma;
        Sums {
            gamma,
            t,
            chi_square: dot(&rest, &rest) - t * t,
            bias: slope(&without).max(slope(&with)),
        }
    }
}

pub(super) fn decisions(program: &Path) -> Measured {
    let folder = Folder::new()?;
    let record = record();
    folder.write_record("record.csv", &record)?;
    let arguments = format!(
        "detect record.csv --model exact {MAPS} {KNOWN} --noise-sd-n {NOISE} --depth-tolerance-mm {TOLERANCE}"
    );
    let output = folder.run(program, &arguments)?;
    let answer: Value = serde_json::from_slice(&output.stdout).map_err(|error| {
        let said = String::from_utf8_lossy(&output.stderr);
        format!("{arguments}: {error}: {}", said.trim_end())
    })?;
    let number = |key: &str| answer[key].as_f64().unwrap_or(f64::NAN);

    let Sums {
        gamma,
        t,
        chi_square,
        bias,
    } = Sums::of(&record);
    let degrees = 2 * SAMPLES as u64 - 1;
    let whole = |key: &str| number(key) as u64;
    let limit = |end: usize| {
        answer["chi_square_limits"][end]
            .as_f64()
            .unwrap_or(f64::NAN)
    };
    let relative = |found: f64, expected: f64| (found / expected - 1.0).abs();
    let rate = number("false_alarm");
    let stated = [
        answer["decision"] == "inclusion",
        answer["fits"] == true,
        answer["noise_sd_lateral_n"] == NOISE && answer["noise_sd_normal_n"] == NOISE,
    ];
    Ok(figures! {
        "right of: the decision, that the record fits, the noise" => count(stated.iter().filter(|&&right| right).count() as u64, 3);
        "samples" => count(whole("samples"), SAMPLES as u64);
        "degrees of freedom of χ²" => count(whole("degrees"), degrees);
        "γ" => told(gamma);
        "relative error of γ" => at_most(relative(number("gamma"), gamma), SUMS);
        "error of T" => at_most((number("t") - t).abs(), SUMS * gamma);
        "error of Θ" => at_most((number("theta") - gamma * (t - 0.5 * gamma)).abs(), SUMS * gamma * gamma);
        "relative error of χ²" => at_most(relative(number("chi_square"), chi_square), SUMS);
        "relative error of the probability above the upper limit of χ²" => at_most(relative(above(limit(1), degrees), BEYOND), 1e-6);
        "relative error of the probability below the lower limit of χ²" => at_most(relative(1.0 - above(limit(0), degrees), BEYOND), 1e-6);
        "relative error of the false-alarm rate, the depth being off by its tolerance" => at_most(relative(rate, tail(number("t_threshold") - bias)), 1e-9);
        "false-alarm rate over that of a depth that is known" => at_least(rate / tail(number("t_threshold")), 1.1);
    })
}

/// The probability that χ² with an odd number of degrees of freedom is above x: Abramowitz and Stegun, 26.4.4.
fn above(x: f64, degrees: u64) -> f64 {
    let root = x.sqrt();
    let terms = (1..degrees).step_by(2).scan(1.0, |term, r| {
        *term *= if r == 1 { root } else { x / r as f64 };
        Some(*term)
    });
    let density = (-0.5 * x).exp() / (2.0 * std::f64::consts::PI).sqrt();
    2.0 * (tail(root) + density * terms.sum::<f64>())
}

fn tail(z: f64) -> f64 {
    upper_tail(z).unwrap_or(f64::NAN)
}

/// Cases, a line each: by what the forces of the record are multiplied, the arguments, and words of the message.
const REFUSED: &str = "\
a number that is none: inf, MAPS --noise-sd-n 0.05, record.csv:2: normal_force_n
maps that do not differ: 1, --reference with.csv --inclusion with.csv --noise-sd-n 0.05, do not differ
forces in mN: 1e3, MAPS --noise-sd-n 0.05, not in the stated unit
less noise than stated: 1, MAPS --noise-sd-n 0.25, the noise is not as stated
more noise than stated: 1, MAPS --noise-sd-n 0.01, the noise is not as stated";

/// Walls and floor of a gel that nothing holds, with what the message says of the direction.
const LOOSE: [[&str; 3]; 3] = [
    ["sliding", "free", "holds the layers up"],
    ["free", "sliding", "from sliding sideways"],
    ["free", "free", "holds the layers up"],
];

pub(super) fn refusals(program: &Path) -> Measured {
    let folder = Folder::new()?;
    let mut wrong = Vec::new();
    let mut judge = |case: &str, arguments: &str, words: &str| -> Measured<()> {
        let output = folder.run(program, arguments)?;
        let said = String::from_utf8_lossy(&output.stderr);
        let right = !output.status.success() && said.contains(words) && tells_nothing(&output);
        if !right {
            wrong.push(format!("{case} ({:?}, {})", output.status, said.trim_end()));
        }
        Ok(())
    };
    for line in REFUSED.lines() {
        let (case, rest) = line.split_once(": ").ok_or(line)?;
        let [factor, arguments, words] = rest.split(", ").collect::<Vec<_>>()[..] else {
            return Err(line.into());
        };
        let factor: f64 = factor.parse()?;
        let forces = record().map(|forces| forces.map(|force| factor * force));
        folder.write_record("record.csv", &forces)?;
        let arguments = arguments.replace("MAPS", MAPS);
        judge(
            case,
            &format!("detect record.csv --model exact {KNOWN} {arguments}"),
            words,
        )?;
    }
    for [walls, floor, words] in LOOSE {
        let gel = Phantom::builtin("none")?.to_toml();
        let support = |key: &str, held: &str| format!("{key} = {held:?}");
        let gel = gel
            .replace(&support("walls", "fixed"), &support("walls", walls))
            .replace(&support("floor", "fixed"), &support("floor", floor));
        folder.write("gel.toml", &gel)?;
        let case = format!("walls {walls}, floor {floor}");
        let solve = "solve --phantom gel.toml --mesh-mm 2 --depths-mm 1 --laterals-mm 0";
        judge(&case, solve, words)?;
    }
    let first = wrong
        .first()
        .map_or(String::new(), |case| format!(", the first {case}"));
    Ok(figures! {
        "cases" => count((REFUSED.lines().count() + LOOSE.len()) as u64, 8);
        "cases that were not refused, or not for this reason{first}" => count(wrong.len() as u64, 0);
    })
}

/// Whether an output holds neither a decision nor a probability: it is empty, or an answer that none can be given.
fn tells_nothing(output: &Output) -> bool {
    let answer: Result<Value, _> = serde_json::from_slice(&output.stdout);
    output.stdout.is_empty()
        || answer.is_ok_and(|answer| {
            answer["decision"] == "cannot_be_judged" && answer["posterior_h1"].is_null()
        })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn probabilities_beyond_chi_square_are_those_of_tables() {
        // Abramowitz and Stegun, table 26.8: the points that χ² is above with probability 0.001 and 0.995.
        for (degrees, x, p) in [(1, 10.828, 0.001), (9, 27.877, 0.001), (29, 13.1211, 0.995)] {
            let found = above(x, degrees);
            assert!((found / p - 1.0).abs() < 2e-3, "{degrees}: {found}");
        }
    }

    #[test]
    fn a_program_that_answers_always_or_never_fails() {
        for (text, judged) in [
            ("echo '{\"decision\": \"inclusion\", \"t\": 5}'", true),
            (
                "echo '{\"decision\": \"no_inclusion\", \"posterior_h1\": 0}'; exit 3",
                true,
            ),
            ("echo no >&2; exit 2", false),
        ] {
            let program = crate::program::tests::script(text);
            let decided = decisions(&program);
            assert_eq!(decided.is_ok(), judged, "{decided:?}");
            for measured in decided.into_iter().chain(refusals(&program)) {
                assert!(
                    measured.iter().any(|figure| !figure.passes()),
                    "{measured:?}"
                );
            }
        }
    }
}
