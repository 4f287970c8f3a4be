//! Monte Carlo of the detector against its laws, in checks whose probability of failing by chance
//! is stated and added up. `tests/statistics` runs them with a fixed seed, `palpate verify --soak`
//! with fresh ones.
//!
//! Every check has a row in `ledger.csv`: its α, its number of trials, and its power against named
//! defects. Each defect also runs as a negative control, which the check must reject as often as
//! the ledger says. `power.py` computes the powers.

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

use crate::detect::Channels;
use crate::stats::random::Generator;
pub use ledger::Row;

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
    pub fn name(&self) -> &'static str {
        self.name
    }

    /// Runs the check on the detector, and gives what it has to remark.
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

fn view(channels: &Channels<Vec<f64>>) -> Channels<&[f64]> {
    Channels {
        x: &channels.x,
        y: &channels.y,
    }
}

#[cfg(test)]
mod tests;
