//! `palpate-verify`: the evidence of this build, on this machine (`spec/evidence.md`).

use std::hash::{BuildHasher, RandomState};
use std::path::PathBuf;
use std::process::ExitCode;

use clap::{Parser, ValueEnum};
use rayon::prelude::*;

use palpate::build::Build;
use palpate::cli::output::{make_folder, print, write};
use palpate::cli::progress::bar;
use palpate::cli::{CliError, program};
use palpate_verify::evidence::{Evidence, PARTS, Soak, Verdict};
use palpate_verify::statistics::{battery, total_alpha};
use palpate_verify::{
    Check, Outcome, battery_outcome, build, checks, dossier, supply, traceability,
};

/// The evidence for this build, found out on this machine: evidence.json and a dossier.
#[derive(Debug, Parser)]
#[command(version, about)]
struct Arguments {
    /// The folder for evidence.json and dossier.html
    #[arg(long, value_name = "DIR", default_value = "palpate-evidence")]
    out: PathBuf,
    /// Only these parts; the dossier is then no verdict on the build
    #[arg(long, value_name = "PART,…", value_enum, value_delimiter = ',')]
    only: Option<Vec<Part>>,
    /// N batteries of the statistics with fresh seeds, besides the parts
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    soak: Option<u32>,
    /// The seed of the first battery of the soak; the next ones count on from it
    #[arg(long, value_name = "S", requires = "soak")]
    seed: Option<u64>,
}

/// A part of the verification.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Part {
    Statistics,
    Diagnosis,
    Vectors,
    Fem,
    Kernel,
    Timing,
    Soak,
}

impl Part {
    fn name(self) -> &'static str {
        match self {
            Part::Soak => "soak",
            part => PARTS[part as usize],
        }
    }
}

fn main() -> ExitCode {
    program(std::env::args_os(), |arguments: Arguments| {
        verify(&arguments)
    })
}

/// Carries out the checks, and writes what came out.
fn verify(arguments: &Arguments) -> Result<(), CliError> {
    let asked = |part: &str| match &arguments.only {
        None => true,
        Some(only) => only.iter().any(|asked| asked.name() == part),
    };
    if arguments.only.is_some() && asked("soak") && arguments.soak.is_none() {
        let message = "--only soak: expected --soak N, the number of batteries";
        return Err(CliError::Usage(message.into()));
    }
    // What can fail at once comes first: minutes of work shall not end for want of a place.
    make_folder(&arguments.out)?;
    let requirements = traceability::requirements().map_err(CliError::Check)?;
    let components = supply::components().map_err(CliError::Check)?;
    let soak = arguments
        .soak
        .map(|batteries| (batteries, arguments.seed.unwrap_or_else(fresh_seed)));
    if let Some((batteries, seed)) = soak {
        // Before the work: whoever stops it can still repeat it.
        let checks = battery().count();
        print(&format!(
            "soak: {batteries} times {checks} checks, seed {seed}\n"
        ))?;
    }
    let evidence = Evidence {
        build: Build::THIS,
        processor: build::processor().unwrap_or_else(|| "not known".into()),
        left_out: PARTS.into_iter().filter(|part| !asked(part)).collect(),
        outcomes: carry_out(&asked),
        soak: soak
            .map(|(batteries, seed)| soak_battery(batteries, seed))
            .transpose()?,
        requirements,
        components,
    };
    write_evidence(&evidence, arguments)
}

/// A seed from the system's randomness.
fn fresh_seed() -> u64 {
    RandomState::new().hash_one(0)
}

/// Carries out every check of the parts that were asked for. Those of time come last, and alone.
fn carry_out(asked: &dyn Fn(&str) -> bool) -> Vec<Outcome> {
    let battery: Vec<_> = battery().filter(|_| asked("statistics")).collect();
    let part = |check: &&Check| asked(check.name.split('.').next().unwrap_or_default());
    let checks: Vec<_> = checks().filter(part).collect();
    let (timed, checks): (Vec<_>, Vec<_>) = checks.into_iter().partition(|check| !check.repeatable);
    let bar = bar(battery.len() + checks.len() + timed.len(), "checks");
    let counted = |outcome: Outcome| {
        bar.inc(1);
        outcome
    };
    let mut outcomes: Vec<Outcome> = battery
        .par_iter()
        .map(|check| counted(battery_outcome(check)))
        .collect();
    outcomes.par_extend(checks.par_iter().map(|check| counted(Outcome::of(check))));
    outcomes.extend(timed.iter().map(|check| counted(Outcome::of(check))));
    bar.finish_and_clear();
    outcomes
}

/// Runs the battery with fresh seeds.
fn soak_battery(batteries: u32, seed: u64) -> Result<Soak, CliError> {
    let total_alpha = total_alpha().map_err(CliError::Check)?;
    let checks: Vec<_> = battery().collect();
    let jobs = u64::from(batteries) * checks.len() as u64;
    let bar = bar(usize::try_from(jobs).unwrap_or(usize::MAX), "soak");
    let failed = |job: u64| {
        let check = checks[(job % checks.len() as u64) as usize];
        let seed = seed.wrapping_add(job / checks.len() as u64);
        let failure = check.run(seed).err();
        bar.inc(1);
        failure.map(|failure| {
            format!("{failure}; repeat with: palpate-verify --only soak --soak 1 --seed {seed}")
        })
    };
    // The first failure in this order, however the threads take turns.
    let failure = (0..jobs).into_par_iter().find_map_first(failed);
    bar.finish_and_clear();
    Ok(Soak {
        batteries,
        seed,
        false_failure: f64::from(batteries) * total_alpha,
        failure,
    })
}

/// Writes the two files, says what was found and where it is told.
fn write_evidence(evidence: &Evidence, arguments: &Arguments) -> Result<(), CliError> {
    let page = arguments.out.join("dossier.html");
    write(&arguments.out.join("evidence.json"), &evidence.to_json())?;
    write(&page, &dossier::dossier(evidence))?;
    print(&summary(evidence))?;
    print(&format!(
        "evidence.json and dossier.html in {}\n",
        arguments.out.display()
    ))?;
    match evidence.verdict() {
        Verdict::Passed | Verdict::Partial => Ok(()),
        Verdict::Failed => Err(CliError::Check(format!(
            "{}; see {}",
            complaint(evidence),
            page.display()
        ))),
    }
}

/// A line for each part.
fn summary(evidence: &Evidence) -> String {
    let mut lines = String::new();
    for part in PARTS {
        let all = evidence.part(part).count();
        let passed = evidence
            .part(part)
            .filter(|outcome| outcome.passed())
            .count();
        lines += &match all {
            0 => format!("{part}: not run\n"),
            _ => format!("{part}: {passed} of {all} checks passed\n"),
        };
    }
    if let Some(soak) = &evidence.soak {
        let result = if soak.failure.is_none() {
            "all passed"
        } else {
            "FAILED"
        };
        lines += &format!(
            "soak: {result}; a detector without defect fails such a run with probability {:.2e} at most\n",
            soak.false_failure
        );
    }
    lines
}

/// What failed, in one line.
fn complaint(evidence: &Evidence) -> String {
    let names: Vec<&str> = evidence
        .failed()
        .map(|outcome| outcome.name.as_str())
        .collect();
    let soak = evidence.soak.iter().filter_map(|soak| soak.failure.clone());
    let checks = (!names.is_empty()).then(|| {
        format!(
            "{} of {} checks failed: {}",
            names.len(),
            evidence.outcomes.len(),
            names.join(", ")
        )
    });
    checks
        .into_iter()
        .chain(soak)
        .collect::<Vec<_>>()
        .join("; ")
}
