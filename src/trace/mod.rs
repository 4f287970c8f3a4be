//! A recorded sweep of the probe, judged against two force maps (`spec/trace.md`).
//!
//! | file | content |
//! |---|---|
//! | `mod.rs` | the trace, its positions, and the forces that a map expects there |
//! | `csv.rs` | the file |
//! | `error.rs` | what can be wrong |
//! | `judge.rs` | criterion, and the record at a known position |
//! | `locate.rs` | the scan for the position, equation (10) |
//!
//! ```
//! use palpate::detect::{Channels, Decision};
//! use palpate::force_map::{ForceTable, Matrix};
//! use palpate::trace::{Criterion, Trace, judge, locate};
//!
//! // Maps at 4 mm over −3 … 3 mm: 1.5 N, and with the inclusion a bump.
//! let map = |bump: [f64; 7]| {
//!     let laterals = (-3..=3).map(|x| f64::from(x) * 1e-3).collect();
//!     let matrix = |force: [f64; 7]| Matrix::from_fn(1, 7, |_, column| force[column]);
//!     ForceTable::new(vec![0.004], laterals, matrix(bump.map(|b| 1.5 + b)), matrix([0.0; 7]))
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
//! let noise_sd = Channels { x: 0.125, y: 0.125 };
//!
//! // Where the maps have it, half of the signal is found: θ = Σ rΔ/s² − γ²/2 = 16 − 12.
//! let (eta, found) =
//!     judge(&record, &reference, &inclusion, 0.004, noise_sd, Criterion::Map, 0.5)?;
//! assert_eq!((eta, found.statistic.theta), (0.0, 4.0));
//! let found = locate(&record, &reference, &inclusion, 0.004, noise_sd, Criterion::Map, 0.5)?;
//! assert_eq!((found.decision, found.theta_max), (Decision::Inclusion, 12.0));
//! assert!((found.position - 0.001).abs() < 1e-12);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod csv;
mod error;
mod judge;
mod locate;
#[cfg(test)]
mod tests;

pub use error::{TraceError, TraceProblem};
pub use judge::{Criterion, Misfit, judge};
pub use locate::{DIED_AWAY, Location, MOST_SAMPLES, UNIFORM, locate};

use crate::detect::Channels;
use crate::force_map::{ForceTable, SAME_POSITION, Sweep};

/// What the first column of a trace counts.
///
/// ```
/// use palpate::trace::{Abscissa, Trace};
///
/// let text = "time_s,lateral_force_n,normal_force_n\n0,0,1.5\n0.1,0,1.75\n";
/// assert_eq!(Trace::from_csv(text, "sweep.csv")?.abscissa(), Abscissa::Time);
/// # Ok::<(), palpate::trace::TraceError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Abscissa {
    /// Seconds since some start.
    Time,
    /// Lateral position of the probe, m.
    Position,
}

/// Forces on the probe as they were recorded, at least one sample.
///
/// ```
/// use palpate::trace::{Abscissa, Trace};
///
/// let text = "position_mm,lateral_force_mn,normal_force_n\n-1,-250,1.5\n1,250,1.75\n";
/// let trace = Trace::from_csv(text, "sweep.csv")?;
/// assert_eq!(trace.abscissa(), Abscissa::Position);
/// let record = trace.record(None)?;
/// assert_eq!(record.positions(), [-0.001, 0.001]);
/// assert_eq!(record.forces().x, [-0.25, 0.25]);
/// # Ok::<(), palpate::trace::TraceError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Trace {
    file: String,
    abscissa: Abscissa,
    samples: Vec<Sample>,
}

/// One row of the file.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Sample {
    line: usize,
    /// s or m.
    abscissa: f64,
    /// Force on the probe, N.
    force: Channels<f64>,
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
/// assert_eq!(record.forces().y, [1.75, 1.5]);
/// # Ok::<(), palpate::trace::TraceError>(())
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
/// use palpate::force_map::{ForceTable, Matrix};
/// use palpate::trace::Trace;
///
/// let text = "position_mm,lateral_force_n,normal_force_n\n1,0,1.5\n3,0,1.75\n";
/// let record = Trace::from_csv(text, "sweep.csv")?.record(None)?;
/// assert_eq!(record.file(), "sweep.csv");
/// assert_eq!((record.positions(), record.forces().y), (&[0.001, 0.003][..], &[1.5, 1.75][..]));
/// // What a map of 0, 1, 2 N at 0, 2, 4 mm expects there.
/// let matrix = || Matrix::from_fn(1, 3, |_, column| column as f64);
/// let map = ForceTable::new(vec![0.004], vec![0.0, 0.002, 0.004], matrix(), matrix())?;
/// assert_eq!(record.expected(&map, 0.004)?.y, [0.5, 1.5]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Record {
    file: String,
    samples: Vec<Sample>,
    positions: Vec<f64>,
    forces: Channels<Vec<f64>>,
}

impl Trace {
    /// What the trace is over.
    pub fn abscissa(&self) -> Abscissa {
        self.abscissa
    }

    /// The record over positions; a trace over times needs the motion, and only it.
    ///
    /// # Errors
    /// [`TraceProblem::Motion`] if the motion is missing, or there for a trace over positions;
    /// [`TraceProblem::Velocity`] if the probe does not move; [`TraceProblem::Position`] and
    /// [`TraceProblem::Order`] if times make no positions.
    ///
    /// Implements: TRC-010, TRC-011, TRC-012, TRC-013.
    pub fn record(self, motion: Option<Motion>) -> Result<Record, TraceError> {
        let mut samples = self.samples;
        match (self.abscissa, motion) {
            (Abscissa::Position, None) => {}
            (Abscissa::Time, Some(motion)) => {
                let velocity = motion.velocity;
                if !velocity.is_finite() || velocity == 0.0 {
                    return Err(TraceProblem::Velocity { velocity }.at(&self.file, None));
                }
                for sample in &mut samples {
                    sample.abscissa = motion.start + velocity * sample.abscissa;
                }
                if velocity < 0.0 {
                    samples.reverse();
                }
            }
            (abscissa, _) => return Err(TraceProblem::Motion { abscissa }.at(&self.file, None)),
        }
        check_positions(&samples).map_err(|(problem, line)| problem.at(&self.file, line))?;
        Ok(Record {
            positions: samples.iter().map(|sample| sample.abscissa).collect(),
            forces: Channels {
                x: samples.iter().map(|sample| sample.force.x).collect(),
                y: samples.iter().map(|sample| sample.force.y).collect(),
            },
            file: self.file,
            samples,
        })
    }
}

/// Checks that positions are finite and increase.
fn check_positions(samples: &[Sample]) -> Result<(), (TraceProblem, usize)> {
    let mut before = f64::NEG_INFINITY;
    for sample in samples {
        let position = sample.abscissa;
        if !position.is_finite() {
            return Err((TraceProblem::Position { position }, sample.line));
        }
        if position <= before + SAME_POSITION {
            let problem = TraceProblem::Order {
                abscissa: Abscissa::Position,
                found: position,
                before,
            };
            return Err((problem, sample.line));
        }
        before = position;
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
    pub fn forces(&self) -> Channels<&[f64]> {
        view(&self.forces)
    }

    /// The forces that `map` expects at `depth` (m) at the samples, N.
    ///
    /// ```
    /// use palpate::force_map::{ForceTable, Matrix};
    /// use palpate::trace::{Trace, TraceProblem};
    ///
    /// let matrix = || Matrix::from_fn(1, 2, |_, column| column as f64);
    /// let map = ForceTable::new(vec![0.004], vec![0.0, 0.004], matrix(), matrix())?;
    /// // 5 mm is outside the map: no force is made up.
    /// let text = "position_mm,lateral_force_n,normal_force_n\n1,0,1.5\n5,0,1.75\n";
    /// let record = Trace::from_csv(text, "sweep.csv")?.record(None)?;
    /// let error = record.expected(&map, 0.004).unwrap_err();
    /// assert_eq!(error.line, Some(3));
    /// assert!(matches!(error.problem, TraceProblem::Outside { position: 0.005, .. }));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`TraceProblem::Outside`] with the line of the first sample outside the map's lateral
    /// positions; [`TraceProblem::Map`] for a depth outside its depths.
    ///
    /// Implements: TRC-024.
    pub fn expected(&self, map: &ForceTable, depth: f64) -> Result<Channels<Vec<f64>>, TraceError> {
        let laterals = map.laterals();
        let (first, last) = (laterals[0], laterals[laterals.len() - 1]);
        let inside = first - SAME_POSITION..=last + SAME_POSITION;
        let outside = |sample: &&Sample| !inside.contains(&sample.abscissa);
        if let Some(sample) = self.samples.iter().find(outside) {
            let position = sample.abscissa;
            let problem = TraceProblem::Outside {
                position,
                first,
                last,
            };
            return Err(problem.at(&self.file, sample.line));
        }
        let sweep = map.sweep(depth, &self.positions);
        Ok(channels(sweep.map_err(|error| {
            TraceProblem::from(error).at(&self.file, None)
        })?))
    }
}

/// Lateral forces are channel x, normal ones channel y.
fn channels(sweep: Sweep) -> Channels<Vec<f64>> {
    Channels {
        x: sweep.lateral_force,
        y: sweep.normal_force,
    }
}

fn view(channels: &Channels<Vec<f64>>) -> Channels<&[f64]> {
    Channels {
        x: &channels.x,
        y: &channels.y,
    }
}
