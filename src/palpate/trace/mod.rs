//! A recorded sweep of the probe, judged against two force maps (`spec/trace.md`).
//!
//! | file | content |
//! |---|---|
//! | `mod.rs` | the trace, its positions, and the forces that a map expects there |
//! | `question.rs` | what is known of the record, and asked of it |
//! | `design.rs` | what the record may hold: signal, nuisances |
//! | `contact.rs` | whether the probe touches |
//! | `fit.rs` | whether it fits |
//! | `cause.rs` | why it cannot be judged |
//! | `judge.rs` | the answer at a known position |
//! | `path.rs` | records whose samples have depths of their own |
//! | `live.rs` | samples that come line by line |
//!
//! Where the position is not known, [`crate::bank`] judges the record.
//!
//! ```
//! use palpate::detect::Decision;
//! use palpate::force::Force;
//! use palpate::force_map::{ForceTable, Hypotheses, Matrix};
//! use palpate::trace::{Correlation, Criterion, Noise, Question, Trace, Unknown};
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
//! // A sweep over the inclusion, by a sensor with an offset of 0.3 N.
//! let mut text = String::from("position_mm,lateral_force_n,normal_force_n\n");
//! for (i, force) in [1.81, 1.78, 2.04, 2.32, 2.03, 1.81, 1.79].iter().enumerate() {
//!     let lateral = [0.02, -0.02, 0.01, -0.01, -0.02, 0.01, 0.01][i];
//!     text += &format!("{},{lateral},{force}\n", i as i32 - 3);
//! }
//! let record = Trace::from_csv(&text, "sweep.csv")?.record(None)?;
//! let question = Question {
//!     depth: 0.004,
//!     depth_tolerance: 0.0,
//!     is_zeroed: false,
//!     unknown: &[Unknown::Offset],
//!     noise: Noise { sd: Some(Force::new(0.02, 0.02)), correlation: Correlation::None },
//!     criterion: Criterion::MaximumAPosteriori,
//!     prior_h1: 0.5,
//! };
//! let found = question.judge(Hypotheses::of_tables(&reference, &inclusion)?, &record)?;
//! assert_eq!(found.decision, Some(Decision::Inclusion));
//! // The signal is there as it should be: T is near γ.
//! assert!((found.test.t - found.test.gamma).abs() < 4.0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod cause;
pub(crate) mod contact;
pub(crate) mod design;
mod fit;
mod judge;
mod live;
mod path;
mod question;
#[cfg(test)]
mod tests;

use std::path::Path;

pub use cause::{Cause, reasons};
pub use design::{gammas_along, nuisances};
pub use fit::{Fit, MISFIT_RATE};
pub use judge::Judgement;
pub(crate) use judge::{MUCH_LIKELIER, is_none};
pub use live::{LiveSample, LiveSamples};
pub use question::{Correlation, Criterion, LEAST_SAMPLES, Noise, Question, Unknown, in_words};

use crate::csv::{Column, Layout, Rows};
use crate::decimal::mm;
use crate::detect::DetectError;
use crate::force::Force;
use crate::force_map::{ForceTable, SAME_POSITION, Stencil};
use crate::refusal::Refusal;
use crate::stats::error::check_samples;
use crate::text::extremes;

/// Position, or time where there is no position; normal force; lateral force and depth, which may be missing.
const COLUMNS: [Column; 4] = [
    &[
        &[("position_mm", -3), ("position_m", 0)],
        &[("time_s", 0), ("time_ms", -3)],
    ],
    &[&[("normal_force_n", 0), ("normal_force_mn", -3)]],
    &[&[("lateral_force_n", 0), ("lateral_force_mn", -3)]],
    &[&[("depth_mm", -3), ("depth_m", 0)]],
];
/// How many of them a trace must have.
const REQUIRED: usize = 2;
/// The headers that are right, for a person.
const EXPECTED_HEADER: &str = "position_mm,lateral_force_n,normal_force_n, in any order, or time_s for the position, also position_m, time_ms and forces as _mn, or say with --columns what each holds";

/// The share of the range of its positions by which a sample may lie behind one before it: the jitter of an encoder.
///
/// Implements: TRC-004.
pub const JITTER: f64 = 0.05;

/// What the samples of a trace are over.
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
    samples: Vec<Sample>,
    has: Has,
    notes: Vec<String>,
}

/// What is there beside positions and normal forces.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Has {
    lateral: bool,
    depths: bool,
}

/// The line of a sample, and its abscissa (s or m), normal and lateral force (N) and depth (m); 0 for what is not there.
type Sample = (usize, [f64; 4]);

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

/// A trace over positions, which increase but for jitter (see [`JITTER`]); where each sample has a depth of its own, in the order of time.
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
    /// One for each sample, or none.
    depths: Vec<f64>,
    /// The standard deviation of the error of each of them, m.
    depth_sd: f64,
    /// The first and the last position of the record of which this is a pass.
    place: Option<[f64; 2]>,
    forces: Force<Vec<f64>>,
}

impl Trace {
    /// Reads the trace at `path`, in this layout.
    ///
    /// # Errors
    /// As [`Trace::from_csv_as`]; a file that cannot be read as UTF-8.
    pub fn read(path: &Path, layout: &Layout) -> Result<Trace, Refusal> {
        crate::file::read(path, |text, file| Trace::from_csv_as(text, file, layout))
    }

    /// The trace in `text`, the content of `file`.
    ///
    /// # Errors
    /// The header does not name each of the three columns once, a row is malformed, times do not increase, positions do not go one
    /// way, or there is no row; with file and line.
    ///
    /// Implements: TRC-001, TRC-004, TRC-007, TRC-008.
    pub fn from_csv(text: &str, file: &str) -> Result<Trace, Refusal> {
        Trace::from_csv_as(text, file, &Layout::default())
    }

    /// As [`Trace::from_csv`], of a file in this layout.
    ///
    /// # Errors
    /// As [`Trace::from_csv`]; a layout that states what a trace does not have.
    ///
    /// Implements: MAP-046, MAP-048, TRC-011, TRC-080, TRC-081.
    pub fn from_csv_as(text: &str, file: &str, layout: &Layout) -> Result<Trace, Refusal> {
        let read = || {
            let read =
                Rows::parse_optional(text, COLUMNS, REQUIRED, EXPECTED_HEADER, layout, true)?;
            let (mut table, [.., lateral, depths]) = read;
            if !lateral {
                let note = "there is no lateral force: the normal force alone counts";
                table.notes.push(note.into());
            }
            let samples = table.rows;
            let (found, right) = match table.missing {
                0 => ("no samples under the header", "give at least one row"),
                _ => (
                    "each sample lacks a number",
                    "leave out a column that has none",
                ),
            };
            let empty = Refusal::state(found, right);
            empty.at(table.line).when(samples.is_empty())?;
            let abscissa = if table.names[0].starts_with("time") {
                check_times(&samples)?;
                Abscissa::Time
            } else {
                if !depths {
                    check_pass(&samples)?;
                }
                Abscissa::Position
            };
            Ok(Trace {
                file: file.into(),
                abscissa,
                samples,
                has: Has { lateral, depths },
                notes: table.notes,
            })
        };
        read().map_err(|refusal: Refusal| refusal.in_file(file))
    }

    /// What a person should know of how the file was read, such as the columns that are not used.
    ///
    /// Implements: MAP-041, MAP-044.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// What the trace is over.
    pub fn abscissa(&self) -> Abscissa {
        self.abscissa
    }

    /// The record over positions, towards +x; a trace over times needs the motion, and only it.
    ///
    /// # Errors
    /// The motion is missing, or there for a trace over positions; the probe does not move; times make no finite positions.
    ///
    /// Implements: TRC-008, TRC-010, TRC-004.
    pub fn record(self, motion: Option<Motion>) -> Result<Record, Refusal> {
        let (file, mut samples) = (self.file, self.samples);
        let placed = match (self.abscissa, motion) {
            (Abscissa::Position, None) => Ok(()),
            (Abscissa::Time, Some(motion)) => move_along(&mut samples, motion),
            (Abscissa::Time, None) => Err(Refusal::state(
                "the samples have times",
                "give the velocity and the start of the sweep (--velocity-mm-s, --start-mm)",
            )),
            (Abscissa::Position, Some(_)) => Err(Refusal::state(
                "the samples have positions",
                "leave out velocity and start (--velocity-mm-s, --start-mm)",
            )),
        };
        placed.map_err(|refusal| refusal.in_file(&*file))?;
        Ok(Record::of(file, samples, self.has))
    }
}

/// Makes positions of times.
fn move_along(samples: &mut [Sample], motion: Motion) -> Result<(), Refusal> {
    let Motion { velocity, start } = motion;
    let found = format!("{velocity} m/s");
    let wrong = Refusal::value("velocity", found, "a finite number other than 0");
    wrong.when(!velocity.is_finite() || velocity == 0.0)?;
    for (line, [abscissa, ..]) in samples {
        *abscissa = start + velocity * *abscissa;
        if !abscissa.is_finite() {
            let found = format!("{abscissa} m from this time");
            return Err(Refusal::value("position", found, "a finite number").at(*line));
        }
    }
    Ok(())
}

/// Checks that times increase.
///
/// Implements: TRC-004.
fn check_times(samples: &[Sample]) -> Result<(), Refusal> {
    let next = samples.iter().skip(1);
    for ((_, [before, ..]), (line, [found, ..])) in samples.iter().zip(next) {
        if found <= before {
            let found = format!("time {found:?} s after {before:?} s");
            return Err(Refusal::state(found, "give times that increase").at(*line));
        }
    }
    Ok(())
}

/// Did the probe go towards −x?
fn backwards(samples: &[Sample]) -> bool {
    matches!(samples, [(_, first), .., (_, last)] if last[0] < first[0])
}

/// Checks that positions go one way, but for jitter.
///
/// Implements: TRC-004.
fn check_pass(samples: &[Sample]) -> Result<(), Refusal> {
    let sign = if backwards(samples) { -1.0 } else { 1.0 };
    let ways = || samples.iter().map(|(line, [x, ..])| (line, sign * x));
    let [least, most] = extremes(ways().map(|(_, way)| way)).unwrap_or_default();
    let jitter = JITTER * (most - least) + SAME_POSITION;
    let mut furthest = f64::NEG_INFINITY;
    for (&line, way) in ways() {
        if furthest - way > jitter {
            let [found, furthest] = [way, furthest].map(|way| mm(sign * way));
            return Err(Refusal::state(
                format!("position {found} mm after {furthest} mm"),
                format!(
                    "give one pass of the probe, in the order of time: at most {:.3} mm back, {} % of the range",
                    1e3 * jitter,
                    100.0 * JITTER
                ),
            )
            .at(line));
        }
        furthest = furthest.max(way);
    }
    Ok(())
}

impl Record {
    /// The record of `forces` (N; no lateral ones where they were not recorded) at `positions` (m), with the checks of
    /// [`Trace::from_csv`]. In messages `name` stands for the file, and the number of a sample, from 1, for its line.
    ///
    /// ```
    /// use palpate::force::Force;
    /// use palpate::trace::Record;
    ///
    /// // To the left: the samples are turned round, so that positions increase.
    /// let forces = Force::new(&[0.0, 0.0][..], &[1.5, 1.75][..]);
    /// let record = Record::new("sweep", &[0.003, 0.001], forces)?;
    /// assert_eq!(record.positions(), [0.001, 0.003]);
    /// assert_eq!(record.forces().normal, [1.75, 1.5]);
    /// # Ok::<(), palpate::refusal::Refusal>(())
    /// ```
    ///
    /// # Errors
    /// No sample; lists of different lengths; NaN or infinity; positions that do not go one way.
    ///
    /// Implements: TRC-004, TRC-008.
    pub fn new(name: &str, positions: &[f64], forces: Force<&[f64]>) -> Result<Record, Refusal> {
        Record::listed(name, positions, None, forces)
    }

    /// The record of lists, whose numbers from 1 stand for lines.
    fn listed(
        name: &str,
        positions: &[f64],
        depths: Option<&[f64]>,
        Force { lateral, normal }: Force<&[f64]>,
    ) -> Result<Record, Refusal> {
        let read = || {
            let (all, has_lateral) = (positions.len(), !lateral.is_empty());
            depths.map_or(Ok(()), |depths| check_samples("depths", depths, all))?;
            check_samples("positions", positions, all)?;
            if has_lateral {
                check_samples("lateral forces", lateral, all)?;
            }
            check_samples("normal forces", normal, all)?;
            let of = |list: &[f64], k: usize| list.get(k).copied().unwrap_or_default();
            let own = depths.unwrap_or_default();
            let sample = |k| (k + 1, [positions[k], normal[k], of(lateral, k), of(own, k)]);
            let samples: Vec<Sample> = (0..all).map(sample).collect();
            if depths.is_none() {
                check_pass(&samples)?;
            }
            let has = Has {
                lateral: has_lateral,
                depths: depths.is_some(),
            };
            Ok(Record::of(name.into(), samples, has))
        };
        read().map_err(|refusal: Refusal| refusal.in_file(name))
    }

    /// The record of samples over positions that go one way, or that have depths.
    ///
    /// Implements: TRC-010, TRC-081, TRC-085.
    fn of(file: String, mut samples: Vec<Sample>, has: Has) -> Record {
        if !has.depths && backwards(&samples) {
            samples.reverse();
        }
        let column = |of: usize| samples.iter().map(|(_, sample)| sample[of]).collect();
        let there = |is_there, of| if is_there { column(of) } else { Vec::new() };
        Record {
            lines: samples.iter().map(|(line, _)| *line).collect(),
            positions: column(0),
            depths: there(has.depths, 3),
            depth_sd: 0.0,
            place: None,
            forces: Force::new(there(has.lateral, 2), column(1)),
            file,
        }
    }

    /// The file that the record comes from, as its reader named it.
    pub fn file(&self) -> &str {
        &self.file
    }

    /// Lateral positions of the samples, m, increasing but for jitter.
    pub fn positions(&self) -> &[f64] {
        &self.positions
    }

    /// Whether its samples are in the reverse order of those in the file, because the probe went towards −x.
    pub fn is_reversed(&self) -> bool {
        self.lines[0] > self.lines[self.lines.len() - 1]
    }

    /// How far the probe had moved at each sample, m: from where the record began, whichever way it went.
    pub fn travelled(&self) -> Vec<f64> {
        let [start, end] = [0, self.positions.len() - 1].map(|at| self.positions[at]);
        let is_reversed = self.is_reversed();
        let way = |x: &f64| if is_reversed { end - x } else { x - start };
        // A step back at the start is jitter.
        let way = |x: &f64| way(x).max(0.0);
        self.positions.iter().map(way).collect()
    }

    /// The recorded force on the probe, N, one sample for each position; no lateral forces where they were not recorded.
    pub fn forces(&self) -> Force<&[f64]> {
        self.forces.as_deref()
    }

    /// This record without the samples outside the lateral positions of `map`, and in words how many these are, if any.
    ///
    /// ```
    /// use palpate::force_map::ForceTable;
    /// use palpate::trace::Trace;
    ///
    /// let map = "depth_mm,lateral_mm,normal_force_n,lateral_force_n\n4,0,1.5,0\n4,2,1.5,0\n";
    /// let map = ForceTable::from_csv(map, "map.csv")?;
    /// let text = "position_mm,lateral_force_n,normal_force_n\n-1,0,1.5\n1,0,1.75\n";
    /// let (record, note) = Trace::from_csv(text, "sweep.csv")?.record(None)?.trimmed(&map)?;
    /// assert_eq!(record.positions(), [0.001]);
    /// assert_eq!(note.unwrap(), "1 of 2 samples left out, which are outside the maps, 0.0 to 2.0 mm");
    /// # Ok::<(), palpate::refusal::Refusal>(())
    /// ```
    ///
    /// # Errors
    /// No sample is left.
    ///
    /// Implements: TRC-025.
    pub fn trimmed(self, map: &ForceTable) -> Result<(Record, Option<String>), Refusal> {
        let all = self.positions.len();
        let kept: Vec<usize> = (0..all).filter(|&at| self.is_over(map, at)).collect();
        let (left_out, range) = (all - kept.len(), self.range(map));
        if kept.is_empty() {
            let found = format!("all of {all} samples are outside the maps, which have {range}");
            return Err(Refusal::state(found, "").in_file(self.file));
        }
        let note =
            format!("{left_out} of {all} samples left out, which are outside the maps, {range}");
        Ok((self.only(&kept), (left_out > 0).then_some(note)))
    }

    /// This record without its lateral forces, if it has any, for maps that have none.
    ///
    /// Implements: TRC-014.
    pub fn normal_alone(mut self) -> Record {
        self.forces.lateral.clear();
        self
    }

    /// The forces that `map` expects at the samples, N, at their own depths or, where the record has none, at `depth` (m); no lateral
    /// ones if it has none.
    ///
    /// # Errors
    /// The first sample outside the map's lateral positions, or at a depth outside its depths, with its line; a depth outside its depths;
    /// a record with lateral forces where the map has none.
    ///
    /// Implements: TRC-008, TRC-014, TRC-024, TRC-082, CLI-140.
    pub fn expected(&self, map: &ForceTable, depth: f64) -> Result<Force<Vec<f64>>, Refusal> {
        let other = Refusal::state(
            "the record has lateral forces, and the maps have none",
            "leave out those of the record",
        );
        let is_other = !self.forces.lateral.is_empty() && map.lateral().is_none();
        other.in_file(&*self.file).when(is_other)?;
        let mut samples = 0..self.positions.len();
        let expected = match samples.find(|&at| !self.is_over(map, at)) {
            Some(at) => {
                let mut found = format!("position {} mm", mm(self.positions[at]));
                if let Some(depth) = self.depths.get(at) {
                    found += &format!(" at a depth of {} mm", mm(*depth));
                }
                found += &format!(" is outside the maps, which have {}", self.range(map));
                Err(Refusal::state(found, "leave it out, or use --trim").at(self.lines[at]))
            }
            None => match self.depths() {
                Some(depths) => map.path(depths, &self.positions),
                None => map.sweep(depth, &self.positions),
            },
        };
        expected.map_err(|refusal| refusal.in_file(&self.file))
    }

    /// Whether sample `at` is within the lateral positions of `map`, and its depth within the depths.
    fn is_over(&self, map: &ForceTable, at: usize) -> bool {
        let depth = self.depths.get(at);
        is_within(map.laterals(), self.positions[at])
            && depth.is_none_or(|depth| Stencil::of_rows(map.depths(), *depth).is_some())
    }

    /// The poses of `map` in words.
    fn range(&self, map: &ForceTable) -> String {
        let ends = |axis: &[f64]| format!("{} to {} mm", mm(axis[0]), mm(axis[axis.len() - 1]));
        match self.depths() {
            None => ends(map.laterals()),
            Some(_) => format!(
                "{} at depths of {}",
                ends(map.laterals()),
                ends(map.depths())
            ),
        }
    }
}

/// Whether a position (m) is within the ends of an axis.
fn is_within(axis: &[f64], position: f64) -> bool {
    let (first, last) = (axis[0], axis[axis.len() - 1]);
    (first - SAME_POSITION..=last + SAME_POSITION).contains(&position)
}

/// What the detector refuses, in the words of a trace.
pub fn refused(error: DetectError) -> Refusal {
    match error {
        DetectError::NoSignal => {
            let found = "the maps do not differ at the samples, and leave no signal to decide by";
            let right = "check where the samples are: a depth below the surface is positive";
            Refusal::state(found, right)
        }
        error => Refusal::state(error, ""),
    }
}
