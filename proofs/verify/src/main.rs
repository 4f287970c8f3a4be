//! `palpate-verify`: the evidence of this build, on this machine (`spec/verification-plan.md`).

use std::hash::{BuildHasher, RandomState};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Parser;
use clap::builder::PossibleValuesParser;
use rayon::prelude::*;

use palpate::version::Build;
use palpate_program::output::{make_folder, print, write};
use palpate_program::progress::bar;
use palpate_program::{CliError, program as command};
use palpate_verify::components::Component;
use palpate_verify::evidence::{Evidence, PARTS, Soak, Verdict, left_out};
use palpate_verify::planted::Planted;
use palpate_verify::statistics::{battery, total_alpha};
use palpate_verify::system::System;
use palpate_verify::test_run::{self, TestRun, evidence_by_requirement};
use palpate_verify::{
    Check, Claim, Outcome, battery_outcome, checks, components, dossier, program,
};

/// Collects the evidence for this build on this machine: checks, test runs, a dossier for a reviewer.
#[derive(Debug, Parser)]
#[command(version, about)]
struct Arguments {
    /// The folder for the dossier and the files beside it
    #[arg(long, value_name = "DIR", default_value = "palpate-evidence")]
    out: PathBuf,
    /// Runs only these parts; the dossier is then no verdict on the build
    #[arg(long, value_name = "PART,…", value_parser = asked(), value_delimiter = ',')]
    only: Option<Vec<String>>,
    /// The file of the program palpate to judge; PATH is not searched [default: the one beside palpate-verify]
    #[arg(long, value_name = "FILE")]
    program: Option<PathBuf>,
    /// A test run, as .ci/run writes it to target/results/test-run.json; always checked; may be given several times
    #[arg(long, value_name = "FILE")]
    test_run: Vec<PathBuf>,
    /// What the tests find of planted defects, as `.ci/run all` writes it to target/ledger.json
    #[arg(long, value_name = "FILE")]
    planted: Option<PathBuf>,
    /// The bill of materials of the program, as `cargo cyclonedx --format json` writes it
    #[arg(long, value_name = "FILE")]
    sbom: Option<PathBuf>,
    /// Name of the operator, for the dossier
    #[arg(long, value_name = "NAME")]
    operator: Option<String>,
    /// Also runs N statistics batteries with fresh seeds
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    soak: Option<u32>,
    /// The seed of the first of them; the next ones count up from it
    #[arg(long, value_name = "S", requires = "soak")]
    seed: Option<u64>,
}

/// What `--only` takes: [`PARTS`] and the soak.
fn asked() -> PossibleValuesParser {
    PossibleValuesParser::new(PARTS.into_iter().chain(["soak"]))
}

fn main() -> ExitCode {
    command(std::env::args_os(), |arguments: Arguments| {
        verify(&arguments)
    })
}

/// Carries out the checks, and writes what came out.
fn verify(arguments: &Arguments) -> Result<(), CliError> {
    let inputs = Inputs::read(arguments)?;
    let left_out = left_out(arguments.only.as_deref(), !inputs.test_runs.is_empty());
    let runs = |part: &str| !left_out.contains(&part);
    // What can fail at once comes first: minutes of work shall not end for want of a place.
    make_folder(&arguments.out)?;
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
    let system = System::here(arguments.operator.clone());
    let executable = |path: PathBuf| Some((path.display().to_string(), program::sha256(&path)?));
    let own = std::env::current_exe().ok();
    let mut outcomes = carry_out(&runs, &inputs.judged);
    if runs("tests") {
        outcomes.push(test_run::outcome(
            &inputs.test_runs,
            Build::THIS.known_commit(),
        ));
    }
    let soak = soak.map(|(batteries, seed)| soak_battery(batteries, seed));
    let executables = own.into_iter().chain([inputs.judged]);
    let evidence = Evidence {
        build: Build::THIS,
        system,
        executables: executables.filter_map(executable).collect(),
        left_out,
        soak,
        requirements: evidence_by_requirement(&inputs.test_runs, &outcomes),
        outcomes,
        components: inputs.components,
        bill_of_materials: inputs.bill_of_materials,
        planted: inputs.planted,
        test_runs: inputs.test_runs,
    };
    write_evidence(&evidence, arguments)
}

/// The files that were given.
struct Inputs {
    /// The program to judge, by its absolute path: what runs is what is hashed.
    judged: PathBuf,
    test_runs: Vec<TestRun>,
    components: Vec<Component>,
    bill_of_materials: Option<String>,
    planted: Option<Planted>,
}

impl Inputs {
    /// Reads them, and refuses a part that lacks what it needs.
    fn read(arguments: &Arguments) -> Result<Inputs, CliError> {
        let only = arguments.only.as_deref().unwrap_or_default();
        let lacks = |part: &str, is_given: bool| !is_given && only.iter().any(|only| only == part);
        if lacks("soak", arguments.soak.is_some()) {
            let message = "--only soak needs --soak N, the number of batteries";
            return Err(CliError::Usage(message.into()));
        }
        if lacks("tests", !arguments.test_run.is_empty()) {
            let message = "--only tests needs --test-run FILE, which .ci/run writes";
            return Err(CliError::Usage(message.into()));
        }
        let test_runs = arguments.test_run.iter().map(|path| TestRun::read(path));
        let components = match &arguments.sbom {
            Some(path) => components::bill_of_materials(path),
            None => Ok(components::locked()),
        };
        let planted = arguments.planted.as_deref().map(Planted::read);
        let judged = program::judged(arguments.program.as_deref());
        Ok(Inputs {
            judged: judged.map_err(|error| CliError::Usage(format!("--program: {error}")))?,
            planted: planted.transpose().map_err(CliError::Usage)?,
            test_runs: test_runs
                .collect::<Result<_, _>>()
                .map_err(CliError::Usage)?,
            components: components.map_err(CliError::Usage)?,
            bill_of_materials: arguments.sbom.as_deref().and_then(program::sha256),
        })
    }
}

/// A seed from the system's randomness.
fn fresh_seed() -> u64 {
    RandomState::new().hash_one(0)
}

/// Carries out every check of the parts that run, but that of the test runs. Those of time come last, and alone.
fn carry_out(runs: &dyn Fn(&str) -> bool, judged: &Path) -> Vec<Outcome> {
    type Job<'a> = Box<dyn Fn() -> Outcome + Sync + 'a>;
    let of_part = |claim: &Claim| runs(claim.name.split('.').next().unwrap_or_default());
    let mut jobs: Vec<Job> = Vec::new();
    for check in battery().filter(|_| runs("statistics")) {
        jobs.push(Box::new(move || battery_outcome(check)));
    }
    for check in program::CHECKS.iter().filter(|check| of_part(&check.claim)) {
        let judge = move || Outcome::measured(&check.claim, || (check.run)(judged));
        jobs.push(Box::new(judge));
    }
    let is_timed = |check: &&Check| check.claim.name.starts_with("timing.");
    let checks = checks().filter(|check| of_part(&check.claim));
    let (timed, others): (Vec<_>, Vec<_>) = checks.partition(is_timed);
    for check in others {
        jobs.push(Box::new(move || Outcome::of(check)));
    }
    let bar = bar(jobs.len() + timed.len(), "checks");
    let counted = |outcome: Outcome| {
        bar.inc(1);
        outcome
    };
    let mut outcomes: Vec<Outcome> = jobs.par_iter().map(|job| counted(job())).collect();
    outcomes.extend(timed.into_iter().map(|check| counted(Outcome::of(check))));
    bar.finish_and_clear();
    outcomes
}

/// Runs the battery with fresh seeds.
fn soak_battery(batteries: u32, seed: u64) -> Soak {
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
    Soak {
        batteries,
        seed,
        false_failure: f64::from(batteries) * total_alpha(),
        failure,
    }
}

/// Writes the files, says what was found and where it is told.
fn write_evidence(evidence: &Evidence, arguments: &Arguments) -> Result<(), CliError> {
    let page = arguments.out.join("dossier.html");
    let file = |name: &str, text: &str| write(&arguments.out.join(name), text);
    file("evidence.json", &evidence.to_json())?;
    file("requirements.csv", &dossier::requirements(evidence))?;
    file("test-runs.csv", &dossier::test_runs(evidence))?;
    write(&page, &dossier::dossier(evidence))?;
    print(&summary(evidence))?;
    print(&format!(
        "dossier.html, evidence.json, requirements.csv and test-runs.csv in {}\n",
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
        let passed = evidence.part(part).filter(|outcome| outcome.passed());
        let passed = passed.count();
        lines += &match all {
            0 if part == "tests" && evidence.test_runs.is_empty() => {
                "tests: no test run given\n".into()
            }
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
    let names: Vec<&str> = evidence.failed().map(|outcome| &outcome.name[..]).collect();
    let (failed, all) = (names.len(), evidence.outcomes.len());
    let checks = format!("{failed} of {all} checks failed: {}", names.join(", "));
    let checks = (failed > 0).then_some(checks).into_iter();
    let soak = evidence.soak.iter().filter_map(|soak| soak.failure.clone());
    checks.chain(soak).collect::<Vec<_>>().join("; ")
}
