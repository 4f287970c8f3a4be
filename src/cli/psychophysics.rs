//! `palpate psychophysics`: counts of right answers, and force maps against them
//! (`spec/psychophysics-command.md`).

use std::path::PathBuf;

use clap::Args;
use serde::Serialize;

use super::experiment::named_file;
use super::lists::length;
use super::output::print;
use super::psychophysics_text::text;
use super::{CliError, Format};
use crate::force_map::{ForceMap, SAME_POSITION};
use crate::psychophysics::bridge::{Bridge, bridge, whole_sweep};
use crate::psychophysics::{Analysis, NoiseDecomposition, Table, analyse, paper_noise_levels};

/// Arguments of `palpate psychophysics`.
#[derive(Debug, Args)]
pub struct PsychophysicsArguments {
    /// Counts of right answers: a header subject,condition,trials and the inclusions, each name ending in its depth in mm, and a row for each subject and condition; without it Table 1 of the paper
    #[arg(value_name = "CSV")]
    counts: Option<PathBuf>,
    /// The force map without inclusion, for the noise in newtons and the predicted shares
    #[arg(long, value_name = "FILE", requires = "inclusion")]
    reference: Option<PathBuf>,
    /// The force map of an inclusion, by the name of its column: 6.6=map.json; two or more
    #[arg(long, visible_alias = "map", value_name = "NAME=FILE", requires = "reference", value_parser = named_file)]
    inclusion: Vec<(String, PathBuf)>,
    /// Half of the sweep that the subjects are taken to use, in mm; without it all of the maps
    #[arg(long, value_name = "W", requires = "reference", value_parser = length)]
    sweep_mm: Option<f64>,
    /// How the answer is printed
    #[arg(long, value_enum, default_value_t = Format::Table)]
    format: Format,
}

/// The answer.
#[derive(Debug, Serialize)]
pub struct Answer {
    schema: &'static str,
    schema_version: u32,
    program_version: &'static str,
    /// The file of the counts, or `Table 1`.
    pub counts: String,
    /// What the counts say by themselves.
    pub analysis: Analysis,
    /// The noise levels of the paper's §5, only with its own Table 1.
    pub noise_levels: Option<NoiseDecomposition>,
    /// The force maps against the counts, if there are maps.
    pub bridge: Option<Bridge>,
}

/// Runs the command.
///
/// Implements: CLI-080, CLI-081, CLI-082, CLI-083, CLI-084, CLI-085.
pub fn psychophysics(arguments: &PsychophysicsArguments) -> Result<(), CliError> {
    let table = match &arguments.counts {
        Some(path) => Table::read(path)?,
        None => Table::paper()?,
    };
    let maps = read_maps(arguments)?;
    let bridge = match &maps {
        Some((reference, maps)) => {
            let named: Vec<_> = maps
                .iter()
                .map(|(name, map)| (name.as_str(), map))
                .collect();
            Some(bridge(&table, reference, &named)?)
        }
        None => None,
    };
    let path = arguments.counts.as_ref();
    let answer = Answer {
        schema: "palpate-psychophysics",
        schema_version: 1,
        program_version: env!("CARGO_PKG_VERSION"),
        counts: path.map_or("Table 1".into(), |path| path.display().to_string()),
        analysis: analyse(&table)?,
        noise_levels: if path.is_none() {
            Some(paper_noise_levels()?)
        } else {
            None
        },
        bridge,
    };
    print(&match arguments.format {
        Format::Table => text(&answer),
        // Keys are strings and every number is finite: nothing here can fail.
        Format::Json => serde_json::to_string_pretty(&answer).unwrap_or_default() + "\n",
    })
}

/// The reference and the maps with their names.
type Maps = (ForceMap, Vec<(String, ForceMap)>);

fn read_maps(arguments: &PsychophysicsArguments) -> Result<Option<Maps>, CliError> {
    let Some(reference) = &arguments.reference else {
        return Ok(None);
    };
    let read = |path: &PathBuf| -> Result<ForceMap, CliError> {
        let map = ForceMap::read(path)?;
        match arguments.sweep_mm {
            Some(half) => swept(&map, half)
                .map_err(|error| CliError::Usage(format!("{}: {error}", path.display()))),
            None => Ok(map),
        }
    };
    let reference = read(reference)?;
    let mut maps = Vec::new();
    for (name, path) in &arguments.inclusion {
        let map = read(path)?;
        let checked = map.check_reference(&reference);
        checked.map_err(|error| CliError::Usage(format!("{}: {error}", path.display())))?;
        maps.push((name.clone(), map));
    }
    Ok(Some((reference, maps)))
}

/// The part of a map within `half`, m, of x = 0.
///
/// Implements: CLI-083.
fn swept(map: &ForceMap, half: f64) -> Result<ForceMap, String> {
    let whole = whole_sweep(map).map_err(|error| error.to_string())?;
    let inside = |x: &f64| x.abs() <= half + SAME_POSITION;
    let laterals: Vec<f64> = whole.laterals().iter().copied().filter(inside).collect();
    if laterals.len() < 2 {
        return Err(format!(
            "{} lateral positions within --sweep-mm, expected at least two",
            laterals.len()
        ));
    }
    whole
        .at_laterals(&laterals)
        .map_err(|error| error.to_string())
}
