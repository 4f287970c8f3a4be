//! Monte Carlo of the detector against its laws, in checks whose probability of failing by chance
//! is stated and added up. `proofs/verify/tests/statistics` runs them with a fixed seed, `palpate-verify --soak`
//! with fresh ones.
//!
//! Every check has a row in `ledger.csv`: its α, its number of trials, and its power against named
//! defects. Each defect also runs as a negative control, which the check must reject as often as
//! the ledger says. `power.py` computes the powers.
//!
//! ```
//! use palpate_verify::statistics::{FIXED_SEED, battery, total_alpha};
//!
//! let checks: Vec<&str> = battery().map(|check| check.name()).collect();
//! assert!(checks.contains(&"coarse_mean_h0"));
//! // What all of them together may find by chance, with a seed that is not the fixed one.
//! assert!(total_alpha()? < 1e-6);
//! let first = battery().next().ok_or("an empty battery")?;
//! assert!(first.run(FIXED_SEED).is_ok());
//! # Ok::<(), String>(())
//! ```

mod bounds;
mod checks;
mod colour;
mod gaussian;
mod generator;
mod ledger;

use std::cell::RefCell;
use std::error::Error;
use std::fmt;
use std::string::{String, ToString};
use std::vec::Vec;

pub use ledger::Row;
use palpate::stats::random::Generator;

/// The seed of the battery in the tests, whose result is therefore always the same.
pub const FIXED_SEED: u64 = 20_261_121;

/// Replicates of a negative control: a power of 0.999 or more misses one of three with probability
/// 0.003 at most.
const REPLICATES: u64 = 3;

/// The powers that [`REPLICATES`] can show; a lesser one is stated in the ledger, but three
/// replicates cannot tell it from none.
const SHOWN_POWER: f64 = 0.999;

/// What a check may come upon: a detector that refuses what it should accept, or a broken ledger.
type Outcome<T> = Result<T, std::boxed::Box<dyn Error + Send + Sync>>;

/// One test of significance with the records that it is for.
///
/// ```
/// use palpate_verify::statistics::{Check, FIXED_SEED, battery};
///
/// let check: &Check = battery().find(|check| check.name() == "coarse_mean_h0").ok_or("no such check")?;
/// assert_eq!(check.run(FIXED_SEED).map_err(|failure| failure.to_string())?, Vec::<String>::new());
/// # Ok::<(), String>(())
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Check {
    name: &'static str,
    /// Draws a sample and tests it: is it rejected?
    rejects: fn(&Draw<'_>) -> Outcome<bool>,
}

/// How a check shall draw its sample.
struct Draw<'a> {
    seed: u64,
    /// The detector's defect, "" for none.
    defect: &'a str,
    /// 0 without a defect, and then from 1 on.
    replicate: u64,
    row: &'a Row,
    notes: RefCell<Vec<String>>,
}

impl Draw<'_> {
    /// The generator of a stream of this draw.
    fn generator(&self, stream: u64) -> Generator {
        Generator::new(self.seed, stream)
    }

    fn trials(&self) -> u64 {
        self.row.trials as u64
    }
}

/// Why a check failed.
///
/// ```
/// use palpate_verify::statistics::{Failure, Reason};
///
/// let failure = Failure { check: "coarse_mean_h0", seed: 7, reason: Reason::Rejected { alpha: 1e-9 } };
/// let said = "check coarse_mean_h0 rejects the detector at alpha = 1e-9, seed 7";
/// assert_eq!(failure.to_string(), said);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Failure {
    /// The check.
    pub check: &'static str,
    /// The seed.
    pub seed: u64,
    /// What happened.
    pub reason: Reason,
}

/// What happened in a check that failed.
///
/// ```
/// use palpate_verify::statistics::{Failure, Reason};
///
/// let reason = Reason::Blind { defect: "half_left_out" };
/// let failure = Failure { check: "coarse_mean_h0", seed: 7, reason };
/// assert!(failure.to_string().contains("does not see the defect half_left_out"));
/// ```
#[derive(Debug, Clone, PartialEq)]
pub enum Reason {
    /// The check rejects the detector.
    Rejected {
        /// The largest probability of this for a detector without defect.
        alpha: f64,
    },
    /// The check does not see a defect.
    Blind {
        /// The defect.
        defect: &'static str,
    },
    /// The detector refused records that it should have accepted, or the ledger is broken.
    Refused(String),
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Failure { check, seed, .. } = self;
        match &self.reason {
            Reason::Rejected { alpha } => {
                write!(
                    f,
                    "check {check} rejects the detector at alpha = {alpha:e}, seed {seed}"
                )
            }
            Reason::Blind { defect } => {
                write!(
                    f,
                    "check {check} does not see the defect {defect}, seed {seed}"
                )
            }
            Reason::Refused(error) => write!(f, "check {check} cannot run, seed {seed}: {error}"),
        }
    }
}

impl Error for Failure {}

/// The whole battery, in a fixed order.
///
/// ```
/// use palpate_verify::statistics::battery;
/// use std::collections::HashSet;
///
/// let names: HashSet<&str> = battery().map(|check| check.name()).collect();
/// assert_eq!(names.len(), battery().count());
/// ```
pub fn battery() -> impl Iterator<Item = &'static Check> {
    [
        gaussian::CHECKS,
        colour::CHECKS,
        generator::CHECKS,
        bounds::CHECKS,
    ]
    .into_iter()
    .flatten()
}

/// Σα: the largest probability that a detector without defect fails one battery.
///
/// ```
/// let total = palpate_verify::statistics::total_alpha()?;
/// assert!(total > 0.0 && total <= 1e-6);
/// # Ok::<(), String>(())
/// ```
///
/// # Errors
/// What is wrong with the ledger.
pub fn total_alpha() -> Result<f64, String> {
    let rows = ledger::rows().map_err(|error| error.to_string())?;
    Ok(rows.iter().map(|row| row.alpha).sum())
}

impl Check {
    const fn new(name: &'static str, rejects: fn(&Draw<'_>) -> Outcome<bool>) -> Check {
        Check { name, rejects }
    }

    /// Its name in the ledger.
    ///
    /// ```
    /// use palpate_verify::statistics::battery;
    ///
    /// assert!(battery().any(|check| check.name() == "coarse_mean_h1"));
    /// ```
    pub fn name(&self) -> &'static str {
        self.name
    }

    /// Runs the check on the detector, and gives what it has to remark.
    ///
    /// ```
    /// use palpate_verify::statistics::{FIXED_SEED, battery};
    ///
    /// let check = battery().find(|check| check.name() == "direct_kolmogorov");
    /// let check = check.ok_or("no such check")?;
    /// assert!(check.run(FIXED_SEED).is_ok());
    /// # Ok::<(), &str>(())
    /// ```
    ///
    /// # Errors
    /// [`Failure`], for a detector without defect with probability α at most.
    ///
    /// Implements: CLI-051.
    pub fn run(&self, seed: u64) -> Result<Vec<String>, Failure> {
        let row = self.row(seed)?;
        let (rejected, notes) = self.draw(seed, "", 0, &row)?;
        if rejected {
            let alpha = row.alpha;
            return Err(self.failure(seed, Reason::Rejected { alpha }));
        }
        Ok(notes)
    }

    /// Runs the check on a detector with each of the defects that the ledger says it sees.
    ///
    /// ```
    /// use palpate_verify::statistics::{FIXED_SEED, battery};
    ///
    /// let check = battery().find(|check| check.name() == "direct_kolmogorov");
    /// let check = check.ok_or("no such check")?;
    /// // It sees each defect that the ledger says it sees.
    /// assert_eq!(check.run_negative_controls(FIXED_SEED), Ok(()));
    /// # Ok::<(), &str>(())
    /// ```
    ///
    /// # Errors
    /// [`Failure`] if it does not see one: with probability 0.003 a defect at most, for seeds
    /// other than [`FIXED_SEED`].
    ///
    /// Implements: CLI-050.
    pub fn run_negative_controls(&self, seed: u64) -> Result<(), Failure> {
        let row = self.row(seed)?;
        for defect in row.shown_defects() {
            for replicate in 1..=REPLICATES {
                if !self.draw(seed, defect, replicate, &row)?.0 {
                    return Err(self.failure(seed, Reason::Blind { defect }));
                }
            }
        }
        Ok(())
    }

    fn draw(
        &self,
        seed: u64,
        defect: &str,
        replicate: u64,
        row: &Row,
    ) -> Result<(bool, Vec<String>), Failure> {
        let draw = Draw {
            seed,
            defect,
            replicate,
            row,
            notes: RefCell::default(),
        };
        let rejected = (self.rejects)(&draw)
            .map_err(|error| self.failure(seed, Reason::Refused(error.to_string())))?;
        Ok((rejected, draw.notes.into_inner()))
    }

    /// Its row in the ledger.
    ///
    /// ```
    /// use palpate_verify::statistics::battery;
    ///
    /// for check in battery() {
    ///     assert_eq!(check.row(7)?.name, check.name());
    /// }
    /// # Ok::<(), palpate_verify::statistics::Failure>(())
    /// ```
    ///
    /// # Errors
    /// [`Failure`] with this seed if the ledger is broken.
    pub fn row(&self, seed: u64) -> Result<Row, Failure> {
        ledger::row(self.name)
            .map_err(|error| self.failure(seed, Reason::Refused(error.to_string())))
    }

    fn failure(&self, seed: u64, reason: Reason) -> Failure {
        let check = self.name;
        Failure {
            check,
            seed,
            reason,
        }
    }
}

#[cfg(test)]
mod tests;
