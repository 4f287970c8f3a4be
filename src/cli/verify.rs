//! `palpate verify`: the statistics battery (`spec/detect-command.md`).

use std::hash::{BuildHasher, RandomState};

use clap::Args;
use rayon::prelude::*;

use super::CliError;
use super::output::print;
use super::progress::bar;
use crate::verify::statistics::{Check, FIXED_SEED, Failure, battery, total_alpha};

/// Arguments of `palpate verify`.
#[derive(Debug, Args)]
pub struct VerifyArguments {
    /// Runs N batteries with fresh seeds, instead of one with the tests' seed and its negative controls
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    soak: Option<u32>,
    /// The seed of the first battery; the next ones count on from it
    #[arg(long, value_name = "S", requires = "soak")]
    seed: Option<u64>,
}

/// Runs the command.
///
/// Implements: CLI-050, CLI-051, CLI-052, CLI-053, CLI-054.
pub fn verify(arguments: &VerifyArguments) -> Result<(), CliError> {
    match arguments.soak {
        Some(batteries) => soak(batteries, arguments.seed.unwrap_or_else(fresh_seed)),
        None => once(),
    }
}

/// A seed from the system's randomness.
fn fresh_seed() -> u64 {
    RandomState::new().hash_one(0)
}

fn once() -> Result<(), CliError> {
    let checks: Vec<&Check> = battery().collect();
    let bar = bar(checks.len(), "checks and negative controls");
    let run = |check: &&Check| {
        let notes = check.run(FIXED_SEED)?;
        check.run_negative_controls(FIXED_SEED)?;
        bar.inc(1);
        Ok(notes)
    };
    // The first failure in the battery's order, however the threads take turns.
    let results: Vec<Result<_, Failure>> = checks.par_iter().map(run).collect();
    bar.finish_and_clear();
    let notes = results.into_iter().collect::<Result<Vec<_>, _>>();
    let notes = notes
        .map_err(|failure| CliError::Check(format!("{failure}; repeat with: palpate verify")))?;
    for note in notes.concat() {
        print(&format!("{note}\n"))?;
    }
    print(&format!(
        "{} checks passed with seed {FIXED_SEED}, and saw every defect that they should\n",
        checks.len()
    ))
}

fn soak(batteries: u32, seed: u64) -> Result<(), CliError> {
    let total_alpha = total_alpha().map_err(CliError::Check)?;
    let checks: Vec<&Check> = battery().collect();
    // Before the work: whoever stops it can still repeat it.
    print(&format!(
        "{batteries} times {} checks, seed {seed}\n",
        checks.len()
    ))?;
    let jobs = u64::from(batteries) * checks.len() as u64;
    let bar = bar(usize::try_from(jobs).unwrap_or(usize::MAX), "checks");
    let failed = |job: u64| {
        let check = checks[(job % checks.len() as u64) as usize];
        let result = check.run(seed.wrapping_add(job / checks.len() as u64));
        bar.inc(1);
        result.err()
    };
    let failure = (0..jobs).into_par_iter().find_map_first(failed);
    bar.finish_and_clear();
    let chance = f64::from(batteries) * total_alpha;
    let stated =
        format!("a detector without defect fails such a run with probability {chance:.2e} at most");
    match failure {
        Some(failure) => Err(CliError::Check(format!(
            "{failure}; {stated}; repeat with: palpate verify --soak 1 --seed {}",
            failure.seed
        ))),
        None => print(&format!("all passed; {stated}\n")),
    }
}
