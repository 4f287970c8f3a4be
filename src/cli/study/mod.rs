//! `palpate study`: what uncertain inputs do to every number (`spec/study.md`).

mod file;
mod records;

use std::path::PathBuf;

use askama::Template;
use clap::{Args, Subcommand};
use rayon::prelude::*;

use super::CliError;
use super::arguments::Format;
use super::output::{make_folder, note, print, write};
use super::part::Part;
use super::progress::bar;
use crate::report::text;
use crate::study::{Sampler, StudyResults};
use file::read_plan;
use records::{BEGINNING, Header, Outcome, Record, Records, Shard};

/// Arguments of `palpate study`.
#[derive(Debug, Args)]
pub struct StudyArguments {
    #[command(subcommand)]
    action: Action,
}

#[derive(Debug, Subcommand)]
enum Action {
    /// Computes samples, all or those of one shard; goes on where it was stopped
    Run(StudyRunArguments),
    /// Puts the samples of all shards together, and says what they show
    Merge(MergeArguments),
}

/// Arguments of `palpate study run`.
#[derive(Debug, Args)]
pub struct StudyRunArguments {
    /// What is varied, how, and what is computed: a TOML file
    #[arg(value_name = "STUDY")]
    study: PathBuf,
    /// The folder for the samples
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Computes the samples of shard K of N alone
    #[arg(long, value_name = "K/N", value_parser = Shard::parse, default_value = "1/1")]
    shard: Shard,
}

/// Arguments of `palpate study merge`.
#[derive(Debug, Args)]
pub struct MergeArguments {
    /// The folders of 'palpate study run'
    #[arg(required = true, value_name = "DIR")]
    folders: Vec<PathBuf>,
    /// The file for the results
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
    /// How the answer is printed
    #[arg(long, value_enum, default_value_t = Format::Table)]
    format: Format,
}

/// Runs the command.
pub fn study(arguments: &StudyArguments) -> Result<(), CliError> {
    match &arguments.action {
        Action::Run(arguments) => run(arguments),
        Action::Merge(arguments) => merge(arguments),
    }
}

/// Implements: STU-024, STU-025, STU-032.
fn run(arguments: &StudyRunArguments) -> Result<(), CliError> {
    let plan = read_plan(&arguments.study)?;
    let sampler = Sampler::new(&plan)?;
    let (samples, quantities) = (sampler.design().len(), sampler.quantities().len());
    let shard = arguments.shard;
    make_folder(&arguments.out)?;
    let path = shard.file(&arguments.out);
    let mut pending: Vec<bool> = (0..samples).map(|sample| shard.has(sample)).collect();
    let total = pending.iter().filter(|&&pending| pending).count();
    let (mut done, mut failed) = (0, 0);
    let header = Header::new(&plan, shard);
    let part = Part::open(
        path.clone(),
        &header,
        BEGINNING,
        "palpate study run",
        |text| {
            let record = Record::parse(text, samples, quantities)?;
            if !std::mem::take(&mut pending[record.sample]) {
                let found = format!(
                    "sample {}, which is there already or of another shard",
                    record.sample
                );
                return Err(crate::refusal::Refusal::state(
                    found,
                    "each of this shard once",
                ));
            }
            done += 1;
            failed += usize::from(matches!(record.outcome, Outcome::Failed(_)));
            Ok(())
        },
    )?;
    if done > 0 {
        note(
            path.display(),
            &format!("{done} of {total} samples taken over"),
        );
    }
    let bar = bar(total, "samples");
    bar.inc(done as u64);
    // What others took is no measure of the time left.
    bar.reset_eta();
    let compute = |sample: usize| {
        let outcome = match sampler.sample(sample) {
            Ok(values) => Outcome::Values(values),
            Err(refusal) => Outcome::Failed(refusal.to_string()),
        };
        let is_failed = matches!(outcome, Outcome::Failed(_));
        part.append(&Record { sample, outcome })?;
        bar.inc(1);
        Ok::<_, CliError>(usize::from(is_failed))
    };
    let samples = pending
        .par_iter()
        .enumerate()
        .filter(|(_, pending)| **pending);
    let of_now = samples
        .map(|(sample, _)| compute(sample))
        .try_reduce(|| 0, |a, b| Ok(a + b));
    failed += of_now?;
    bar.finish_and_clear();
    print(&format!(
        "{total} samples in {}, of which {failed} failed\n",
        path.display()
    ))
}

/// Implements: STU-026, STU-027, STU-050, STU-051.
fn merge(arguments: &MergeArguments) -> Result<(), CliError> {
    let records = Records::find(&arguments.folders)?;
    let plan = records.plan()?;
    let sampler = Sampler::new(&plan)?;
    let (samples, quantities) = (sampler.design().len(), sampler.quantities().len());
    let failures = records.failures(samples, quantities)?;
    let columns = |range| records.columns(samples, quantities, range);
    let results = StudyResults::new(&sampler, &plan, &failures, columns)?;
    // Keys are strings, and all numbers are finite.
    let text = serde_json::to_string(&results).unwrap_or_default() + "\n";
    write(&arguments.out, &text)?;
    arguments.format.print(&results, |results| {
        Table { results }.render().unwrap_or_default()
    })
}

/// The results for people.
///
/// Implements: STU-051.
#[derive(Template)]
#[template(path = "cli/study.txt")]
struct Table<'a> {
    results: &'a StudyResults,
}
