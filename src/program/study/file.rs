//! The file of a study: TOML.

use std::path::Path;

use serde::Deserialize;

use crate::CliError;
use crate::config::Config;
use palpate::csv::Rows;
use palpate::file::{from_toml, read};
use palpate::refusal::Refusal;
use palpate_paper::study::{Correlation, Distribution, Input, StudyPlan};

/// The study with the keys of the file.
///
/// Implements: STU-001.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct StudyFile {
    rows: usize,
    #[serde(default = "first_seed")]
    seed: u32,
    /// As in 'palpate run --config', with one depth.
    #[serde(default)]
    run: Config,
    #[serde(rename = "input")]
    inputs: Vec<Input>,
    #[serde(default, rename = "correlation")]
    correlations: Vec<Correlation>,
}

fn first_seed() -> u32 {
    1
}

/// The plan in the file at `path`.
///
/// # Errors
/// A file that cannot be read, is not TOML or lacks a key; phantoms that are refused; several depths; a plan that is refused.
///
/// Implements: STU-001, STU-011, STU-010.
pub fn read_plan(path: &Path) -> Result<StudyPlan, CliError> {
    let name = path.display().to_string();
    let mut file = read(path, |text, name| {
        let file: StudyFile = from_toml(text, name)?;
        let run = file.run.from_source(text, name);
        Ok(StudyFile { run, ..file })
    })?;
    let run = file.run;
    let of_file = |refusal: Refusal| refusal.in_file(&*name);
    let refused = |found: String| CliError::from(of_file(Refusal::state(found, "")));
    let [probe_depth] = run.depths[..] else {
        let depths = run.depths.len();
        let found = format!("run.depths_mm has {depths} depths; give one, such as \"4\"");
        return Err(refused(found));
    };
    if !run.measured.is_empty() {
        let found = "run.measured has no effect in a study; remove it";
        return Err(refused(found.into()));
    }
    let mut phantoms = run.read_phantoms()?;
    run.check_theory(&phantoms)?;
    for (at, input) in file.inputs.iter_mut().enumerate() {
        if let Distribution::Empirical { values, file } = &mut input.distribution
            && let Some(table) = file.take()
        {
            if !values.is_empty() {
                return Err(refused(format!(
                    "input[{at}].distribution.empirical has both values and a file; give one of them"
                )));
            }
            *values = read(&run.file(&table), column)?;
        }
    }
    let reference = phantoms.remove(0);
    let plan = StudyPlan {
        reference,
        phantoms,
        probe_depth,
        laterals: run.laterals.clone(),
        mesh_size: run.mesh.size_mm / 1e3,
        contact: run.mesh.contact,
        settings: run.detection,
        inputs: file.inputs,
        correlations: file.correlations,
        rows: file.rows,
        seed: file.seed,
    };
    plan.design().map_err(of_file)?;
    Ok(plan)
}

/// The values of a CSV table, in increasing order.
fn column(text: &str, file: &str) -> Result<Vec<f64>, Refusal> {
    let table = Rows::parse(text, [&[&[("value", 0)]]], "value");
    let table = table.map_err(|refusal| refusal.in_file(file))?;
    let mut values: Vec<f64> = table.rows.into_iter().map(|(_, [value])| value).collect();
    values.sort_by(f64::total_cmp);
    Ok(values)
}
