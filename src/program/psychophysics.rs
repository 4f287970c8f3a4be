//! `palpate psychophysics`: counts of right answers, and force maps against them
//! (`spec/command-line.md`).

use std::path::{Path, PathBuf};

use askama::Template;
use clap::Args;
use serde::Serialize;

use super::experiment::named_file;
use super::numbers::length;
use super::{CliError, Format};
use palpate::force_map::{ForceMap, Hypotheses};
use palpate_paper::psychophysics::bridge::{Bridge, bridge};
use palpate_paper::psychophysics::{
    Analysis, AnswerTable, Bounds, ConditionAnalysis, NoiseDecomposition, OpenBounds, Parameter,
    analyse, paper_noise_levels,
};

/// Arguments of `palpate psychophysics`.
#[derive(Debug, Args)]
pub struct PsychophysicsArguments {
    /// Counts of right answers: a header subject,condition,trials and the inclusions, each name ending in its depth in mm, and a row for each subject and condition; without it Table 1 of the paper
    #[arg(value_name = "CSV")]
    counts: Option<PathBuf>,
    /// The force map without inclusion, for the noise in newtons and the predicted shares
    #[arg(long, value_name = "FILE", requires = "inclusion")]
    reference: Option<PathBuf>,
    /// The force map of an inclusion, with the name of its column: 6.6=map.json; two or more
    #[arg(long, visible_alias = "map", value_name = "NAME=FILE", requires = "reference", value_parser = named_file)]
    inclusion: Vec<(String, PathBuf)>,
    /// Half the width of the sweep that the subjects are assumed to make, in mm [default: that of the maps]
    #[arg(long, value_name = "W", requires = "reference", value_parser = length)]
    sweep_mm: Option<f64>,
    /// How the answer is printed
    #[arg(long, value_enum, default_value_t = Format::Table)]
    format: Format,
}

/// The answer.
#[derive(Debug, Serialize)]
struct PsychophysicsAnswer {
    schema: &'static str,
    schema_version: u32,
    program_version: &'static str,
    /// The file of the counts, or `Table 1`.
    counts: String,
    /// What the counts say by themselves.
    analysis: Analysis,
    /// The noise levels of the paper's §5, only with its own Table 1.
    noise_levels: Option<NoiseDecomposition>,
    /// The force maps against the counts, if there are maps.
    bridge: Option<Bridge>,
}

/// Runs the command.
///
/// Implements: CLI-080, CLI-081, CLI-082, CLI-003.
pub fn psychophysics(arguments: &PsychophysicsArguments) -> Result<(), CliError> {
    let path = arguments.counts.as_ref();
    let table = path.map_or_else(AnswerTable::paper, |path| AnswerTable::read(path))?;
    let bridge = arguments.reference.as_ref();
    let bridge = bridge.map(|reference| against_maps(arguments, &table, reference));
    let noise_levels = path.is_none().then(paper_noise_levels);
    let answer = PsychophysicsAnswer {
        schema: "palpate-psychophysics",
        schema_version: 1,
        program_version: env!("CARGO_PKG_VERSION"),
        bridge: bridge.transpose()?,
        counts: path.map_or("Table 1".into(), |path| path.display().to_string()),
        analysis: analyse(&table)?,
        noise_levels: noise_levels.transpose()?,
    };
    arguments.format.print(&answer, text)
}

fn against_maps(
    arguments: &PsychophysicsArguments,
    table: &AnswerTable,
    reference: &Path,
) -> Result<Bridge, CliError> {
    let reference = ForceMap::read(reference)?;
    let mut maps = Vec::new();
    for (name, path) in &arguments.inclusion {
        let map = ForceMap::read(path)?;
        let checked = Hypotheses::new(&reference, &map);
        checked.map_err(CliError::refused(path.display()))?;
        maps.push((name.as_str(), map));
    }
    let named: Vec<_> = maps.iter().map(|(name, map)| (*name, map)).collect();
    Ok(bridge(table, &reference, &named, arguments.sweep_mm)?)
}

/// The answer for people. Its words are in `templates/psychophysics.txt`.
///
/// Implements: CLI-082.
fn text(answer: &PsychophysicsAnswer) -> String {
    let (counts, confidence) = (&answer.counts, 100.0 * answer.analysis.confidence);
    let words = Text { answer }.render();
    // Writing to a String does not fail.
    let words = words.expect("lines of text and numbers");
    let lines: Vec<&str> = words.trim_end().lines().collect();
    let blocks = lines.chunk_by(|one, other| one.contains('\t') == other.contains('\t'));
    let text: String = blocks.map(columns).collect();
    format!("{counts}: shares of right answers with intervals of {confidence} %\n\n{text}")
}

/// Lines as they are, or rows with their cells left-aligned in columns; a row may have fewer than others.
fn columns(lines: &[&str]) -> String {
    let rows = lines
        .iter()
        .map(|line| line.split('\t').collect::<Vec<_>>());
    let rows: Vec<_> = rows.collect();
    let width = |column: usize| {
        let cells = rows.iter().filter_map(|row| row.get(column));
        cells.map(|cell| cell.chars().count()).max().unwrap_or(0)
    };
    let line = |row: &Vec<&str>| {
        if let [line] = row[..] {
            return format!("{line}\n");
        }
        let cells = row.iter().enumerate();
        let padded = cells.map(|(column, cell)| format!("{cell:<0$}", width(column)));
        let line = format!("  {}", padded.collect::<Vec<_>>().join("  "));
        line.trim_end().to_string() + "\n"
    };
    rows.iter().map(line).collect()
}

#[derive(Template)]
#[template(path = "psychophysics.txt", block = "answer")]
struct Text<'a> {
    answer: &'a PsychophysicsAnswer,
}

fn has_rough_p(condition: &ConditionAnalysis) -> bool {
    let mut dispersions = condition.inclusions.iter().filter_map(|of| of.dispersion);
    dispersions.any(|found| found.is_rough)
}

fn parameter(found: &Parameter, scale: f64, digits: usize) -> String {
    let ends = [&found.bounds, &found.dispersed_bounds];
    let [bounds, dispersed] = ends.map(|of| open(of, scale, digits));
    let value = scale * found.value;
    format!("{value:.digits$} {bounds}, with the subjects' dispersion {dispersed}")
}

fn bounds(found: &Bounds) -> String {
    format!("[{:.3}, {:.3}]", found.lower, found.upper)
}

/// An interval times `scale`; an end that is missing is said to be.
fn open(found: &OpenBounds, scale: f64, digits: usize) -> String {
    let end =
        |end: Option<f64>| end.map_or("no bound".into(), |end| format!("{:.digits$}", scale * end));
    format!("[{}, {}]", end(found.lower), end(found.upper))
}

fn p_value(p: &Option<f64>) -> String {
    p.as_ref().map_or("-".into(), known_p)
}

fn known_p(p: &f64) -> String {
    match *p < 1e-3 {
        true => format!("{p:.0e}"),
        false => format!("{p:.3}"),
    }
}
