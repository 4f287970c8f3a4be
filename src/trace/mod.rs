//! A recorded sweep of the probe, judged against two force maps (`spec/trace.md`).
//!
//! | file | content |
//! |---|---|
//! | `mod.rs` | the trace, its positions, and the forces that a map expects there |
//! | `judge.rs` | criterion, and the record at a known position |
//! | `locate.rs` | the scan for the position, equation (10) |
//!
//! ```
//! use palpate::force::Force;
//! use palpate::detect::Decision;
//! use palpate::force_map::{ForceTable, Hypotheses, Matrix};
//! use palpate::trace::{Criterion, Question, Trace};
//!
//! // Maps at 4 mm over −3 … 3 mm: 1.5 N, and with the inclusion a bump.
//! let map = |bump: [f64; 7]| {
//!     let laterals = (-3..=3).map(|x| f64::from(x) * 1e-3).collect();
//!     let matrix = |force: [f64; 7]| Matrix::from_fn(1, 7, |_, column| force[column]);
//!     ForceTable::new(vec![0.004], laterals, Force::new(matrix([0.0; 7]), matrix(bump.map(|b| 1.5 + b))))
//! };
//! let reference = map([0.0; 7])?;
//! let inclusion = map([0.0, 0.0, 0.25, 0.5, 0.25, 0.0, 0.0])?;
//!
//! // A sweep over an inclusion 1 mm to the right of where the maps have theirs.
//! let mut text = String::from("position_mm,lateral_force_n,normal_force_n\n");
//! for (i, force) in [1.5, 1.5, 1.5, 1.75, 2.0, 1.75, 1.5].iter().enumerate() {
//!     text += &format!("{},0,{force}\n", i as i32 - 3);
//! }
//! let record = Trace::from_csv(&text, "sweep.csv")?.record(None)?;
//! let question = Question {
//!     hypotheses: Hypotheses::of_tables(&reference, &inclusion)?,
//!     depth: 0.004,
//!     noise_sd: Force { lateral: 0.125, normal: 0.125 },
//!     criterion: Criterion::Map,
//!     prior_h1: 0.5,
//! };
//!
//! // Where the maps have it, half of the signal is found: θ = Σ rΔ/s² − γ²/2 = 16 − 12.
//! let found = question.judge(&record)?;
//! assert_eq!((found.eta, found.assessment.statistic.theta), (0.0, 4.0));
//! let found = question.locate(&record)?;
//! assert_eq!((found.decision, found.theta_max), (Decision::Inclusion, 12.0));
//! assert!((found.position - 0.001).abs() < 1e-12);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod judge;
mod locate;
#[cfg(test)]
mod tests;

use std::path::Path;

pub use judge::{Criterion, Judgement, Misfit, Question};
pub use locate::{DIED_AWAY, Location, MOST_SAMPLES, UNIFORM};

use crate::csv::{Column, Rows};
use crate::decimal::format_scaled;
use crate::detect::DetectError;
use crate::force::Force;
use crate::force_map::{ForceTable, SAME_POSITION};
use crate::refusal::Refusal;

/// Position or time, lateral force, normal force.
const COLUMNS: [Column; 3] = [
    &[
        ("position_mm", -3),
        ("position_m", 0),
        ("time_s", 0),
        ("time_ms", -3),
    ],
    &[("lateral_force_n", 0), ("lateral_force_mn", -3)],
    &[("normal_force_n", 0), ("normal_force_mn", -3)],
];
/// The headers that are right, for a person.
const EXPECTED_HEADER: &str = "position_mm,lateral_force_n,normal_force_n, in any order, or time_s for the position, also position_m, time_ms and forces as _mn";

/// What the first column of a trace counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Abscissa {
    /// Seconds since some start.
    Time,
    /// Lateral position of the probe, m.
    Position,
}

/// Forces on the probe as they were recorded, at least one sample.
#[derive(Debug, Clone, PartialEq)]
pub struct Trace {
    file: String,
    abscissa: Abscissa,
    /// The line of each sample, its abscissa (s or m), lateral and normal force (N).
    samples: Vec<(usize, [f64; 3])>,
}

/// The motion of the probe while times were recorded.
///
/// ```
/// use palpate::trace::{Motion, Trace};
///
/// // To the left from 3 mm, at 20 mm/s: the samples are turned round, so that positions increase.
/// let text = "time_s,lateral_force_n,normal_force_n\n0,0,1.5\n0.1,0,1.75\n";
/// let motion = Motion { velocity: -0.02, start: 0.003 };
/// let record = Trace::from_csv(text, "sweep.csv")?.record(Some(motion))?;
/// assert_eq!(record.positions(), [0.001, 0.003]);
/// assert_eq!(record.forces().normal, [1.75, 1.5]);
/// # Ok::<(), palpate::refusal::Refusal>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Motion {
    /// Velocity along +x, m/s; negative if the probe moved towards −x.
    pub velocity: f64,
    /// Lateral position at time 0, m.
    pub start: f64,
}

/// A trace over positions, which increase by more than [`SAME_POSITION`] from sample to sample.
///
/// ```
/// use palpate::force::Force;
/// use palpate::force_map::{ForceTable, Matrix};
/// use palpate::trace::Trace;
///
/// let text = "position_mm,lateral_force_n,normal_force_n\n1,0,1.5\n3,0,1.75\n";
/// let record = Trace::from_csv(text, "sweep.csv")?.record(None)?;
/// assert_eq!(record.file(), "sweep.csv");
/// assert_eq!((record.positions(), record.forces().normal), (&[0.001, 0.003][..], &[1.5, 1.75][..]));
/// // What a map of 0, 1, 2 N at 0, 2, 4 mm expects there.
/// let matrix = || Matrix::from_fn(1, 3, |_, column| column as f64);
/// let map = ForceTable::new(vec![0.004], vec![0.0, 0.002, 0.004], Force::new(matrix(), matrix()))?;
/// assert_eq!(record.expected(&map, 0.004)?.normal, [0.5, 1.5]);
/// # Ok::<(), palpate::refusal::Refusal>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Record {
    file: String,
    /// The line of each sample.
    lines: Vec<usize>,
    positions: Vec<f64>,
    forces: Force<Vec<f64>>,
}

impl Trace {
    /// Reads the trace at `path`.
    ///
    /// # Errors
    /// As [`Trace::from_csv`]; a file that cannot be read as UTF-8.
    pub fn read(path: &Path) -> Result<Trace, Refusal> {
        crate::input::parse(path, Trace::from_csv)
    }

    /// The trace in `text`, the content of `file`.
    ///
    /// # Errors
    /// The header does not name the three columns, a row is malformed, positions or times do not increase, or there is no row;
    /// with file and line.
    ///
    /// Implements: TRC-001, TRC-002, TRC-003, TRC-004, TRC-005, TRC-006, TRC-007, TRC-008.
    pub fn from_csv(text: &str, file: &str) -> Result<Trace, Refusal> {
        let read = || {
            let table = Rows::parse(text, COLUMNS, EXPECTED_HEADER)?;
            let samples = table.rows;
            if samples.is_empty() {
                let found = "no samples under the header";
                return Err(Refusal::state(found, "at least one row").at(table.line));
            }
            let abscissa = if table.names[0].starts_with("time") {
                Abscissa::Time
            } else {
                Abscissa::Position
            };
            check_order(abscissa, &samples)?;
            let file = file.into();
            Ok(Trace {
                file,
                abscissa,
                samples,
            })
        };
        read().map_err(|refusal: Refusal| refusal.in_file(file))
    }

    /// What the trace is over.
    pub fn abscissa(&self) -> Abscissa {
        self.abscissa
    }

    /// The record over positions; a trace over times needs the motion, and only it.
    ///
    /// # Errors
    /// The motion is missing, or there for a trace over positions; the probe does not move; times make no positions.
    ///
    /// Implements: TRC-008, TRC-010, TRC-011, TRC-012, TRC-013.
    pub fn record(self, motion: Option<Motion>) -> Result<Record, Refusal> {
        let Trace {
            file,
            mut samples,
            abscissa,
        } = self;
        let placed = match (abscissa, motion) {
            (Abscissa::Position, None) => Ok(()),
            (Abscissa::Time, Some(motion)) => move_along(&mut samples, motion),
            (Abscissa::Time, None) => Err(Refusal::state(
                "the samples have times",
                "a velocity and a start to make positions of them (--velocity-mm-s, --start-mm)",
            )),
            (Abscissa::Position, Some(_)) => Err(Refusal::state(
                "the samples have positions",
                "neither velocity nor start (--velocity-mm-s, --start-mm)",
            )),
        };
        placed.map_err(|refusal| refusal.in_file(&*file))?;
        let column = |of: usize| samples.iter().map(|(_, sample)| sample[of]).collect();
        Ok(Record {
            lines: samples.iter().map(|(line, _)| *line).collect(),
            positions: column(0),
            forces: Force::new(column(1), column(2)),
            file,
        })
    }
}

/// Makes positions of times.
fn move_along(samples: &mut [(usize, [f64; 3])], motion: Motion) -> Result<(), Refusal> {
    let Motion { velocity, start } = motion;
    if !velocity.is_finite() || velocity == 0.0 {
        let expected = "a finite number other than 0";
        return Err(Refusal::value(
            "velocity",
            format!("{velocity} m/s"),
            expected,
        ));
    }
    for (_, [abscissa, ..]) in samples.iter_mut() {
        *abscissa = start + velocity * *abscissa;
    }
    if velocity < 0.0 {
        samples.reverse();
    }
    check_order(Abscissa::Position, samples)
}

/// Checks that times increase, or that positions are finite and increase by more than [`SAME_POSITION`].
fn check_order(abscissa: Abscissa, samples: &[(usize, [f64; 3])]) -> Result<(), Refusal> {
    let (name, unit, power, least) = match abscissa {
        Abscissa::Time => ("time", "s", 0, 0.0),
        Abscissa::Position => ("position", "mm", 3, SAME_POSITION),
    };
    let mut before = f64::NEG_INFINITY;
    for &(line, [found, ..]) in samples {
        if !found.is_finite() {
            let found = format!("{found} m from this time");
            return Err(Refusal::value(name, found, "a finite number").at(line));
        }
        if found <= before + least {
            let [found, before] = [found, before].map(|value| format_scaled(value, power));
            let found = format!("{name} {found} {unit} after {before} {unit}");
            return Err(Refusal::state(found, "it to increase").at(line));
        }
        before = found;
    }
    Ok(())
}

impl Record {
    /// The file that the record comes from, as its reader named it.
    pub fn file(&self) -> &str {
        &self.file
    }

    /// Lateral positions of the samples, m, increasing.
    pub fn positions(&self) -> &[f64] {
        &self.positions
    }

    /// The recorded force on the probe, N, one sample for each position.
    pub fn forces(&self) -> Force<&[f64]> {
        self.forces.as_deref()
    }

    /// The forces that `map` expects at `depth` (m) at the samples, N.
    ///
    /// # Errors
    /// The first sample outside the map's lateral positions, with its line; a depth outside its depths.
    ///
    /// Implements: TRC-008, TRC-024.
    pub fn expected(&self, map: &ForceTable, depth: f64) -> Result<Force<Vec<f64>>, Refusal> {
        let laterals = map.laterals();
        let (first, last) = (laterals[0], laterals[laterals.len() - 1]);
        let inside = first - SAME_POSITION..=last + SAME_POSITION;
        let outside = |position: &f64| !inside.contains(position);
        let expected = match self.positions.iter().position(outside) {
            Some(sample) => {
                let [position, first, last] = [self.positions[sample], first, last].map(mm);
                let found = format!("position {position} mm is outside the maps");
                Err(Refusal::state(found, format!("{first} to {last} mm")).at(self.lines[sample]))
            }
            None => map.sweep(depth, &self.positions),
        };
        expected.map_err(|refusal| refusal.in_file(&self.file))
    }
}

/// A position in mm, exactly.
fn mm(position: f64) -> String {
    format_scaled(position, 3)
}

/// What the detector refuses, in the words of a trace.
fn refused(error: DetectError) -> Refusal {
    match error {
        DetectError::NoSignal => {
            let found = "the maps do not differ at the samples";
            Refusal::state(found, "a signal to decide by")
        }
        error => Refusal::state(error, ""),
    }
}
