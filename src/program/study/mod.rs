//! `palpate study`: propagation of input uncertainty (`spec/study.md`).

mod file;
mod records;

use std::path::PathBuf;

use askama::Template;
use clap::{Args, Subcommand};
use rayon::prelude::*;

use super::CliError;
use super::error::refuse;
use super::output::{Envelope, Format, make_folder, print, write};
use super::progress::resumed_bar;
use file::read_plan;
use palpate::journal::Journal;
use palpate::refusal::Refusal;
use palpate_paper::report::text;
use palpate_paper::study::{Sampler, StudyResults};
use records::{Header, Outcome, Record, Records, Shard};

/// Arguments of `palpate study`.
#[derive(Debug, Args)]
pub struct StudyArguments {
    #[command(subcommand)]
    action: Action,
}

#[derive(Debug, Subcommand)]
enum Action {
    /// Computes the samples, all of them or one shard; continues an aborted run
    #[command(after_help = "Example:\n  palpate study run study.toml --out samples --shard 1/4")]
    Run(StudyRunArguments),
    /// Merges the samples of all shards and analyses them: uncertainty bands and sensitivity indices
    #[command(after_help = "Example:\n  palpate study merge samples --out study.json")]
    Merge(MergeArguments),
}

/// Arguments of `palpate study run`.
#[derive(Debug, Args)]
pub struct StudyRunArguments {
    /// TOML file with the uncertain inputs, their distributions, and what to compute
    #[arg(value_name = "STUDY")]
    study: PathBuf,
    /// Output folder for the samples
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Computes only the samples of shard K of N
    #[arg(long, value_name = "K/N", value_parser = Shard::parse, default_value = "1/1")]
    shard: Shard,
}

/// Arguments of `palpate study merge`.
#[derive(Debug, Args)]
pub struct MergeArguments {
    /// Folders written by 'palpate study run'
    #[arg(required = true, value_name = "DIR")]
    folders: Vec<PathBuf>,
    /// Output file for the results
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
    /// Output format
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

/// Implements: STU-024, STU-032.
fn run(arguments: &StudyRunArguments) -> Result<(), CliError> {
    let plan = read_plan(&arguments.study)?;
    let (sampler, shard) = (Sampler::new(&plan)?, arguments.shard);
    make_folder(&arguments.out)?;
    let path = shard.file(&arguments.out);
    let first = shard.number - 1;
    let of_shard = (first..sampler.design().samples()).step_by(shard.of);
    let mut is_left = vec![true; of_shard.len()];
    let (total, mut found, mut failed) = (is_left.len(), 0, 0);
    let header = Envelope::job("palpate-study-samples", Header { shard, plan: &plan });
    let part = Journal::open(path.clone(), &header, "palpate study run", |text| {
        let record = Record::parse(text, &sampler)?;
        let sample = record.sample;
        if !shard.has(sample) || !std::mem::take(&mut is_left[sample / shard.of]) {
            let found = format!("sample {sample} appears twice or belongs to another shard");
            return Err(Refusal::state(found, ""));
        }
        found += 1;
        failed += usize::from(record.is_failed());
        Ok(())
    })?;
    let bar = resumed_bar(&path, found, total, "samples");
    let compute = |sample: usize| {
        let outcome = match sampler.sample(sample) {
            Ok(values) => Outcome::Values(values),
            Err(refusal) => Outcome::Failed(refusal.to_string()),
        };
        let record = Record { sample, outcome };
        part.append(&record)?;
        bar.inc(1);
        Ok::<_, CliError>(usize::from(record.is_failed()))
    };
    let left = is_left
        .into_par_iter()
        .enumerate()
        .filter(|(_, left)| *left);
    let computed = left.map(|(at, _)| compute(first + at * shard.of));
    failed += computed.try_reduce(|| 0, |a, b| Ok(a + b))?;
    bar.finish_and_clear();
    print(&format!(
        "{total} samples in {}, of which {failed} failed\n",
        path.display()
    ))
}

/// Implements: STU-026, STU-027, STU-050, STU-051.
fn merge(arguments: &MergeArguments) -> Result<(), CliError> {
    let name = arguments
        .out
        .file_name()
        .unwrap_or_default()
        .to_string_lossy();
    if name.starts_with("samples-") {
        refuse!("--out {name} has the name of a file of samples; choose another");
    }
    let records = Records::find(&arguments.folders)?;
    let plan = records.plan()?;
    let sampler = Sampler::new(&plan)?;
    let failures = records.failures(&sampler)?;
    let columns = |range| records.columns(&sampler, range);
    let results = StudyResults::new(&sampler, records.arithmetic()?, &failures, columns)?;
    // Keys are strings, and all numbers are finite.
    let text = serde_json::to_string(&results).unwrap_or_default() + "\n";
    write(&arguments.out, &text)?;
    let table = Table { results: &results };
    let table = || table.render().unwrap_or_default();
    arguments.format.print(&results, table)
}

/// The results for people.
///
/// Implements: STU-051.
#[derive(Template)]
#[template(path = "cli.txt", block = "study")]
struct Table<'a> {
    results: &'a StudyResults,
}
