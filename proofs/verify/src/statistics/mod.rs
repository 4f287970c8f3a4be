//! Monte Carlo of the detector against its laws, in checks whose probability of failing by chance
//! is stated and added up. `proofs/verify/tests/statistics.rs` runs them with a fixed seed, `palpate-verify --soak`
//! with fresh ones.
//!
//! Every check has a row in `ledger.csv`: its α, its number of trials, and its power against named
//! defects. Each defect also runs as a negative control, which the check must reject as often as
//! the ledger says. `power.py` computes the powers.
//!
//! ```
//! use palpate_verify::statistics::{FIXED_SEED, battery, total_alpha};
//!
//! let check = battery().find(|check| check.name == "coarse_mean_h0").ok_or("no such check")?;
//! check.run(FIXED_SEED)?;
//! // It sees each defect that the ledger says it sees.
//! check.run_negative_controls(FIXED_SEED)?;
//! // What all of them together may find by chance, with a seed that is not the fixed one.
//! assert!(total_alpha() < 1e-6);
//! # Ok::<(), String>(())
//! ```

/// Checks of the battery, each by its name in the ledger and how it draws and measures.
macro_rules! battery {
    ($($name:literal => $measure:expr;)+) => {
        &[$($crate::statistics::Check { name: $name, measure: $measure }),+]
    };
}

mod bank;
mod bounds;
mod checks;
mod colour;
mod gaussian;
mod generator;
mod ledger;
mod nuisance;
mod robust;
mod sequential;

use crate::Figure;
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

/// What a check may come upon: a detector that refuses what it should accept.
type Outcome<T> = crate::Measured<T>;

/// One test of significance with the records that it is for.
#[derive(Debug, Clone, Copy)]
pub struct Check {
    /// Its name in the ledger.
    pub name: &'static str,
    /// Draws a sample, and measures on it what the test judges, with the limits at the row's α.
    measure: fn(&Draw<'_>) -> Outcome<Figure>,
}

/// How a check shall draw its sample.
struct Draw<'a> {
    seed: u64,
    /// The detector's defect, "" for none.
    defect: &'a str,
    /// 0 without a defect, and then from 1 on.
    replicate: u64,
    row: &'a Row,
}

impl Draw<'_> {
    /// The generator of a stream of this draw.
    fn generator(&self, stream: u64) -> Generator {
        Generator::new(self.seed, stream)
    }

    fn trials(&self) -> u64 {
        self.row.trials as u64
    }

    /// A value, or another with this defect.
    fn planted<T>(&self, defect: &str, wrong: T, right: T) -> T {
        if self.defect == defect { wrong } else { right }
    }
}

/// The whole battery, in a fixed order.
pub fn battery() -> impl Iterator<Item = &'static Check> {
    [
        gaussian::CHECKS,
        colour::CHECKS,
        generator::CHECKS,
        bounds::CHECKS,
        nuisance::CHECKS,
        bank::CHECKS,
        robust::CHECKS,
        sequential::CHECKS,
    ]
    .into_iter()
    .flatten()
}

/// Σα: the largest probability that a detector without defect fails one battery.
pub fn total_alpha() -> f64 {
    ledger::ROWS.iter().map(|row| row.alpha).sum()
}

impl Check {
    /// What the check observes on the detector, with its limits.
    ///
    /// # Errors
    /// That it cannot run.
    pub fn observe(&self, seed: u64) -> Result<Figure, String> {
        self.draw(seed, "", 0)
    }

    /// Runs the check on the detector.
    ///
    /// # Errors
    /// That it rejects the detector, which it does to one without defect with probability α at most; or that it cannot run.
    pub fn run(&self, seed: u64) -> Result<(), String> {
        let (name, observed) = (self.name, self.observe(seed)?);
        if observed.passes() {
            return Ok(());
        }
        let alpha = self.row().alpha;
        Err(format!(
            "check {name} rejects the detector at alpha = {alpha:e}, seed {seed}: {observed}"
        ))
    }

    /// Runs the check on a detector with each of the defects that the ledger says it sees.
    ///
    /// # Errors
    /// That it does not see one: with probability 0.003 a defect at most, for seeds other than [`FIXED_SEED`]; or that it cannot run.
    pub fn run_negative_controls(&self, seed: u64) -> Result<(), String> {
        for defect in self.row().shown_defects() {
            for replicate in 1..=REPLICATES {
                if self.draw(seed, defect, replicate)?.passes() {
                    let name = self.name;
                    return Err(format!(
                        "check {name} does not see the defect {defect}, seed {seed}"
                    ));
                }
            }
        }
        Ok(())
    }

    fn draw(&self, seed: u64, defect: &str, replicate: u64) -> Result<Figure, String> {
        let draw = Draw {
            seed,
            defect,
            replicate,
            row: self.row(),
        };
        let figure = (self.measure)(&draw);
        figure.map_err(|error| format!("check {} cannot run, seed {seed}: {error}", self.name))
    }

    /// Its row in the ledger; a test sees that there is one.
    pub fn row(&self) -> &'static Row {
        let row = ledger::ROWS.iter().find(|row| row.name == self.name);
        row.unwrap_or_else(|| panic!("{} is not in the ledger", self.name))
    }
}

#[cfg(test)]
mod tests;
