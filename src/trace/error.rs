//! What can be wrong with a trace.

use std::fmt;

use super::{Abscissa, MOST_SAMPLES, UNIFORM};
use crate::csv::CsvProblem;
use crate::detect::DetectError;
use crate::force_map::InvalidForceMap;
use crate::phantom::decimal::format_scaled;

/// Why a trace is refused: one line that begins with the file.
///
/// ```
/// use palpate::trace::Trace;
///
/// let text = "position_mm,lateral_force_n,normal_force_n\n0,0,1.5\n0,0,1.5\n";
/// let error = Trace::from_csv(text, "sweep.csv").unwrap_err();
/// assert_eq!((error.file.as_str(), error.line), ("sweep.csv", Some(3)));
/// ```
///
/// Implements: TRC-008.
#[derive(Debug, Clone, PartialEq)]
pub struct TraceError {
    /// The file, as its reader named it.
    pub file: String,
    /// The line, from 1, where there is one.
    pub line: Option<usize>,
    /// What is wrong there.
    pub problem: TraceProblem,
}

impl fmt::Display for TraceError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.line {
            Some(line) => write!(f, "{}:{line}: {}", self.file, self.problem),
            None => write!(f, "{}: {}", self.file, self.problem),
        }
    }
}

impl std::error::Error for TraceError {}

/// What is wrong with a trace.
///
/// ```
/// use palpate::trace::{Abscissa, Trace, TraceProblem};
///
/// // Times are no positions before the motion is known.
/// let text = "time_s,lateral_force_n,normal_force_n\n0,0,1.5\n";
/// let error = Trace::from_csv(text, "sweep.csv")?.record(None).unwrap_err();
/// assert_eq!(error.problem, TraceProblem::Motion { abscissa: Abscissa::Time });
/// # Ok::<(), palpate::trace::TraceError>(())
/// ```
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum TraceProblem {
    /// The file cannot be read.
    #[error("cannot be read: {0}")]
    Read(String),
    /// A line of the file is malformed.
    #[error(transparent)]
    Csv(#[from] CsvProblem),
    /// A header and nothing under it.
    #[error("no samples under the header, expected at least one row")]
    Empty,
    /// Positions or times that do not increase.
    #[error("{} after {}, expected it to increase", value(*.abscissa, *.found), amount(*.abscissa, *.before))]
    Order {
        /// What the samples are over.
        abscissa: Abscissa,
        /// The value, m or s.
        found: f64,
        /// The value before it, m or s.
        before: f64,
    },
    /// The motion is missing, or superfluous.
    #[error("{}", motion(.abscissa))]
    Motion {
        /// What the trace is over.
        abscissa: Abscissa,
    },
    /// The probe does not move.
    #[error("velocity = {velocity} m/s, expected a finite number other than 0")]
    Velocity {
        /// The velocity, m/s.
        velocity: f64,
    },
    /// A time makes no position.
    #[error("position = {position} m from this time, expected a finite number")]
    Position {
        /// The position, m.
        position: f64,
    },
    /// The maps do not reach as far as the trace.
    #[error("position {} mm is outside the maps, expected {} to {} mm", mm(*.position), mm(*.first), mm(*.last))]
    Outside {
        /// The position, m.
        position: f64,
        /// The first position of the maps, m.
        first: f64,
        /// The last position of the maps, m.
        last: f64,
    },
    /// A map gives no forces for the trace.
    #[error(transparent)]
    Map(#[from] InvalidForceMap),
    /// The scan wants equal steps.
    #[error(
        "position {} mm, expected {} mm: a scan shifts the template by whole samples, so the steps must be equal within {UNIFORM:e} of a step",
        mm(*.found), mm(*.expected)
    )]
    NotUniform {
        /// The position, m.
        found: f64,
        /// Where equal steps would put it, m.
        expected: f64,
    },
    /// The scan wants a record of a certain size.
    #[error("{samples} samples, expected 2 to {MOST_SAMPLES} for a scan")]
    Samples {
        /// Samples in the record.
        samples: usize,
    },
    /// The maps do not hold the inclusion's own position.
    #[error("the maps cover {} to {} mm, expected the inclusion's position, 0 mm, among them", mm(*.first), mm(*.last))]
    NoOrigin {
        /// The first position of the maps, m.
        first: f64,
        /// The last position of the maps, m.
        last: f64,
    },
    /// The record is shorter than the signal that it is searched for.
    #[error(
        "{record} samples, expected at least the {template} that the maps cover at this spacing: a scan needs a sweep as long as the maps, or maps over fewer lateral positions"
    )]
    Short {
        /// Samples in the record.
        record: usize,
        /// Samples in the template.
        template: f64,
    },
    /// Both maps expect the same forces.
    #[error("the maps do not differ at the samples, expected a signal to decide by")]
    NoSignal,
    /// The detector refuses.
    #[error(transparent)]
    Detect(#[from] DetectError),
}

/// A position in mm, exactly.
fn mm(position: f64) -> String {
    format_scaled(position, 3)
}

/// A position or time with its unit.
fn amount(abscissa: Abscissa, amount: f64) -> String {
    match abscissa {
        Abscissa::Time => format!("{} s", format_scaled(amount, 0)),
        Abscissa::Position => format!("{} mm", mm(amount)),
    }
}

/// A position or time with its name and unit.
fn value(abscissa: Abscissa, found: f64) -> String {
    let name = match abscissa {
        Abscissa::Time => "time",
        Abscissa::Position => "position",
    };
    format!("{name} {}", amount(abscissa, found))
}

fn motion(abscissa: &Abscissa) -> &'static str {
    match abscissa {
        Abscissa::Time => {
            "the samples have times, expected a velocity and a start to make positions of them (--velocity-mm-s, --start-mm)"
        }
        Abscissa::Position => {
            "the samples have positions, expected neither velocity nor start (--velocity-mm-s, --start-mm)"
        }
    }
}

impl TraceProblem {
    /// This problem in `line` (from 1) of `file`.
    pub(super) fn at(self, file: &str, line: impl Into<Option<usize>>) -> TraceError {
        let (file, line) = (file.into(), line.into());
        TraceError {
            file,
            line,
            problem: self,
        }
    }
}
