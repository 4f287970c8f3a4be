//! Traces as CSV.

use std::path::Path;

use super::{Abscissa, Sample, Trace, TraceError, TraceProblem, check_positions};
use crate::csv::{Column, Header, header_and_rows};
use crate::detect::Channels;

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

impl Trace {
    /// Reads the trace at `path`.
    ///
    /// ```
    /// use palpate::trace::Trace;
    ///
    /// let path = std::env::temp_dir().join(format!("sweep-{}.csv", std::process::id()));
    /// std::fs::write(&path, "position_mm,lateral_force_n,normal_force_n\n0,0,1.5\n")?;
    /// assert_eq!(Trace::read(&path)?.record(None)?.forces().y, [1.5]);
    /// # std::fs::remove_file(&path)?;
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// As [`Trace::from_csv`]; [`TraceProblem::Read`] if the file cannot be read as UTF-8.
    pub fn read(path: &Path) -> Result<Trace, TraceError> {
        let file = path.display().to_string();
        let text = crate::input::read(path)
            .map_err(|error| TraceProblem::Read(error.to_string()).at(&file, None))?;
        Trace::from_csv(&text, &file)
    }

    /// The trace in `text`, the content of `file`.
    ///
    /// # Errors
    /// [`TraceError`] if the header does not name the three columns, a row is malformed, positions
    /// or times do not increase, or there is no row.
    ///
    /// Implements: TRC-001, TRC-002, TRC-003, TRC-004, TRC-005, TRC-006, TRC-007.
    pub fn from_csv(text: &str, file: &str) -> Result<Trace, TraceError> {
        let refused = |line| move |problem| TraceProblem::from(problem).at(file, line);
        let ((line, header), rows) = header_and_rows(text);
        let header = Header::parse(header, COLUMNS, EXPECTED_HEADER).map_err(refused(line))?;
        let abscissa = if header.name(0).starts_with("time") {
            Abscissa::Time
        } else {
            Abscissa::Position
        };
        let mut samples = Vec::new();
        for (line, row) in rows {
            let [abscissa, x, y] = header.numbers(row).map_err(refused(line))?;
            samples.push(Sample {
                line,
                abscissa,
                force: Channels { x, y },
            });
        }
        if samples.is_empty() {
            return Err(TraceProblem::Empty.at(file, line));
        }
        match abscissa {
            Abscissa::Time => check_times(&samples),
            Abscissa::Position => check_positions(&samples),
        }
        .map_err(|(problem, line)| problem.at(file, line))?;
        Ok(Trace {
            file: file.into(),
            abscissa,
            samples,
        })
    }
}

/// Checks that times increase.
fn check_times(samples: &[Sample]) -> Result<(), (TraceProblem, usize)> {
    let falls = |pair: &&[Sample]| pair[1].abscissa <= pair[0].abscissa;
    match samples.windows(2).find(falls) {
        Some(pair) => {
            let problem = TraceProblem::Order {
                abscissa: Abscissa::Time,
                found: pair[1].abscissa,
                before: pair[0].abscissa,
            };
            Err((problem, pair[1].line))
        }
        None => Ok(()),
    }
}
