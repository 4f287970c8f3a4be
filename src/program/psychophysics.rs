//! `palpate psychophysics`: analysis of counts of correct answers, alone or with force maps (`spec/command-line.md`).

use std::path::{Path, PathBuf};

use askama::Template;
use clap::Args;
use serde::Serialize;

use super::experiment::{named_file, warn_of_depth};
use super::numbers::length;
use super::output::Envelope;
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
    /// Counts of correct answers: a CSV file with subject, condition, trials and one column per inclusion, its name ending in its depth
    /// in mm; one row per subject and condition. Or a row per trial with subject, condition, inclusion and correct, as PsychoPy and jsPsych
    /// write them [default: Table 1 of the paper]
    #[arg(value_name = "CSV")]
    counts: Option<PathBuf>,
    /// Force map without inclusion, for the noise in newtons and the predicted proportions correct
    #[arg(long, value_name = "FILE", requires = "inclusion")]
    reference: Option<PathBuf>,
    /// Force map with an inclusion, with the name of its column: 6.6=map.json; two or more
    #[arg(long, visible_alias = "map", value_name = "NAME=FILE", requires = "reference", value_parser = named_file)]
    inclusion: Vec<(String, PathBuf)>,
    /// Assumed half-width of the subjects' sweeps in mm [default: that of the maps]
    #[arg(long = "sweep-mm", value_name = "W", requires = "reference", value_parser = length)]
    half_sweep: Option<f64>,
    /// Output format
    #[arg(long, value_enum, default_value_t = Format::Table)]
    format: Format,
}

/// The answer.
#[derive(Debug, Serialize, Template)]
#[template(path = "psychophysics.txt", block = "answer")]
struct PsychophysicsAnswer {
    /// The file of the counts, or `Table 1`.
    counts: String,
    /// The analysis of the counts alone.
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
        bridge: bridge.transpose()?,
        counts: path.map_or("Table 1".into(), |path| path.display().to_string()),
        analysis: analyse(&table)?,
        noise_levels: noise_levels.transpose()?,
    };
    let table = text(&answer);
    let answer = Envelope::new("palpate-psychophysics", 1, answer);
    arguments.format.print(&answer, || table)
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
    let bridge = bridge(table, &reference, &named, arguments.half_sweep)?;
    for ((name, map), (_, path)) in named.into_iter().zip(&arguments.inclusion) {
        warn_of_depth(name, path, map);
    }
    Ok(bridge)
}

/// The answer for people, by `templates/psychophysics.txt`.
///
/// Implements: CLI-082.
fn text(answer: &PsychophysicsAnswer) -> String {
    let (counts, confidence) = (&answer.counts, 100.0 * answer.analysis.confidence);
    // Writing to a String does not fail.
    let words = answer.render().unwrap_or_default();
    let lines: Vec<&str> = words.trim_end().lines().collect();
    let blocks = lines.chunk_by(|one, other| one.contains('\t') == other.contains('\t'));
    let text: String = blocks.map(columns).collect();
    format!("{counts}: proportions correct with {confidence} % intervals\n\n{text}")
}

/// Lines as they are, or rows with their cells left-aligned in columns; a row may have fewer than others.
fn columns<'a>(lines: &[&'a str]) -> String {
    let cells = |line: &&'a str| line.split('\t').collect::<Vec<_>>();
    let rows: Vec<_> = lines.iter().map(cells).collect();
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

fn has_rough_p(condition: &ConditionAnalysis) -> bool {
    let mut dispersions = condition.inclusions.iter().filter_map(|of| of.dispersion);
    dispersions.any(|found| found.is_rough)
}

fn parameter(found: &Parameter, scale: f64, digits: usize) -> String {
    let ends = [&found.bounds, &found.dispersed_bounds];
    let [bounds, dispersed] = ends.map(|of| open(of, scale, digits));
    let value = scale * found.value;
    format!("{value:.digits$} {bounds}, allowing for the dispersion between subjects {dispersed}")
}

fn bounds(found: &Bounds) -> String {
    format!("[{:.3}, {:.3}]", found.lower, found.upper)
}

/// An interval times `scale`, with "no bound" for a missing end.
fn open(found: &OpenBounds, scale: f64, digits: usize) -> String {
    let end =
        |end: Option<f64>| end.map_or("no bound".into(), |end| format!("{:.digits$}", scale * end));
    format!("[{}, {}]", end(found.lower), end(found.upper))
}

fn p_value(p: &Option<f64>) -> String {
    p.as_ref().map_or("-".into(), known_p)
}

fn known_p(p: &f64) -> String {
    if *p < 1e-3 {
        format!("{p:.0e}")
    } else {
        format!("{p:.3}")
    }
}
