//! `palpate run`: from the phantoms to the report.

use std::path::{Path, PathBuf};

use clap::Args;
use indicatif::ProgressBar;
use rayon::prelude::*;

use super::CliError;
use super::config::Config;
use super::deformed::{deformed_mesh, shown};
use super::output::{make_folder, note, print, write};
use super::progress::{bar, tell_large_mesh};
use super::solve::{TheoryArguments, tell_large_strain};
use super::theories;
use palpate::csv::Layout;
use palpate::fem::certify::{certified_map, check_meshes};
use palpate::fem::{FemError, Model};
use palpate::file::read;
use palpate::force_map::ForceMap;
use palpate::phantom::Phantom;
use palpate::refusal::Refusal;
use palpate::robust::{GelChanges, GelUncertainty};
use palpate_paper::psychophysics::bridge::probe_depth;
use palpate_paper::report::{
    DeformedMesh, FileNames, Run, check_study, figures, findings, html, summary_json,
};
use palpate_paper::study::StudyResults;

/// Arguments of `palpate run`.
#[derive(Debug, Args)]
pub struct RunArguments {
    /// TOML file with phantoms, poses and noise to use instead of the paper's
    #[arg(long, value_name = "FILE")]
    config: Option<PathBuf>,
    #[command(flatten)]
    theory: TheoryArguments,
    /// Compares small strain, finite strain and friction in the report; takes a quarter of an hour for the paper's phantoms
    #[arg(long)]
    compare_theories: bool,
    /// Results of 'palpate study merge' for the same phantoms, to include in the report
    #[arg(long, value_name = "FILE")]
    study: Option<PathBuf>,
    /// Output folder for report.html, summary.json, maps/ and figures/
    #[arg(long, value_name = "DIR", default_value = "palpate-out")]
    out: PathBuf,
}

/// Runs the command.
///
/// Implements: CLI-030, CLI-031, CLI-032.
pub fn run(arguments: &RunArguments) -> Result<(), CliError> {
    let config = match &arguments.config {
        Some(path) => read(path, Config::from_toml)?,
        None => Config::default(),
    };
    let phantoms = config.read_phantoms()?;
    let phantoms = phantoms.iter().map(|phantom| arguments.theory.of(phantom));
    let phantoms = phantoms.collect::<Result<Vec<_>, _>>()?;
    config.check_theory(&phantoms)?;
    let measured = config.measured.iter();
    let measured = measured.map(|path| measured_map(&config.file(path), &config.columns));
    let measured = measured.collect::<Result<_, _>>()?;
    let study = arguments.study.as_deref();
    let study = study.map(|path| study_of(path, &config, &phantoms));
    let study = study.transpose()?;
    let theories = match arguments.compare_theories {
        true => theories::phantoms(&config, &phantoms)?,
        false => Vec::new(),
    };
    // The folder first: a run shall not fail at its end because it cannot be made.
    make_folder(&arguments.out)?;
    let (mut maps, deformed) = solve_all(&config, &phantoms)?;
    let theories = theories::compare(&config, &theories)?;
    let reference = maps.remove(0);
    let (depth, _) = probe_depth(reference.table().depths());
    let changes = GelChanges::new(&reference, &[depth], &GelUncertainty::default());
    let run = Run {
        changes: changes.map_err(CliError::fem(phantoms[0].name()))?,
        reference,
        maps,
        measured,
        deformed,
        settings: config.detection,
        study,
        theories,
    };
    let name = |map: &ForceMap| map.phantom().map_or("", Phantom::name).to_string();
    let is_new = |map: &&ForceMap| {
        let mut own = run.reference_and_maps();
        own.all(|own| own.phantom() != map.phantom())
    };
    let theories = run.theories.iter();
    let theories = theories.flat_map(|of| std::iter::once(&of.reference).chain(&of.maps));
    let strains = run.reference_and_maps().chain(theories.filter(is_new));
    let strains: Vec<_> = strains
        .map(|map| tell_large_strain(map, &name(map)))
        .collect();
    write_run(&run, &arguments.out)?;
    strains.into_iter().collect()
}

/// Reads the results of a study that fits the run.
fn study_of(path: &Path, config: &Config, phantoms: &[Phantom]) -> Result<StudyResults, CliError> {
    let study = StudyResults::read(path)?;
    let poses = (probe_depth(&config.depths).0, &config.laterals[..]);
    let phantoms: Vec<_> = phantoms.iter().collect();
    let checked = check_study(&study, &phantoms, poses, &config.detection);
    checked.map_err(CliError::refused(path.display()))?;
    Ok(study)
}

/// Reads a measured map, in CSV in this layout.
///
/// Implements: CLI-031, CLI-174.
fn measured_map(path: &Path, layout: &Layout) -> Result<ForceMap, CliError> {
    let (map, notes) = ForceMap::read_as(path, Some(layout))?;
    notes.iter().for_each(|text| note(path.display(), text));
    if map.certificate().is_some() {
        let reason = "this map was computed; 'measured' takes measured maps, as palpate import-map writes them";
        return Err(CliError::refused(path.display())(reason));
    }
    Ok(map)
}

/// Solves all maps, the phantoms in parallel, and the field of one pose.
///
/// Implements: CLI-007, CON-006.
fn solve_all(
    config: &Config,
    phantoms: &[Phantom],
) -> Result<(Vec<ForceMap>, DeformedMesh), CliError> {
    let bar = bar(0, "force maps");
    let shown = shown(phantoms);
    let solve = |(index, phantom): (usize, &Phantom)| {
        solve_phantom(config, phantom, index == shown, &bar).map_err(CliError::fem(phantom.name()))
    };
    let solved = phantoms.par_iter().enumerate().map(solve);
    let (maps, deformed): (_, Vec<_>) = solved.collect::<Result<_, _>>()?;
    bar.finish_and_clear();
    let none = || CliError::Usage("no phantom to run".into());
    Ok((
        maps,
        deformed.into_iter().flatten().next().ok_or_else(none)?,
    ))
}

fn solve_phantom(
    config: &Config,
    phantom: &Phantom,
    shown: bool,
    bar: &ProgressBar,
) -> Result<(ForceMap, Option<DeformedMesh>), FemError> {
    let mesh = &config.mesh;
    tell_large_mesh(phantom, mesh.size_mm / 1e3)?;
    let model = Model::new(phantom, mesh.size_mm / 1e3, mesh.contact)?;
    let (depths, laterals) = (&config.depths, &config.laterals);
    // On three meshes, where they differ enough for bands: a coarse run shall have its report, which says that it has none.
    let meshes = check_meshes(&model).map_or(1, |()| 3);
    bar.inc_length((meshes * depths.len() * model.solved_laterals(laterals).len()) as u64);
    let solved = |poses| {
        bar.inc(poses as u64);
        true
    };
    let map = match meshes {
        3 => certified_map(&model, depths, laterals, &solved)?,
        _ => model.map(depths, laterals, &solved)?,
    };
    let deformed = shown.then(|| deformed_mesh(&model, &map)).transpose()?;
    Ok((map, deformed))
}

/// Writes all files and prints where they are.
fn write_run(run: &Run, out: &Path) -> Result<(), CliError> {
    let failed = |refusal: Refusal| CliError::Check(format!("report: {refusal}"));
    let findings = findings(run).map_err(failed)?;
    let figures = figures(run, &findings).map_err(failed)?;
    make_folder(&out.join("maps"))?;
    make_folder(&out.join("figures"))?;
    let mut names = FileNames::default();
    for map in run.reference_and_maps() {
        let name = map.phantom().map_or("", |phantom| phantom.name());
        let name = names.unique("map", name, "json");
        write(&out.join("maps").join(name), &map.to_json())?;
    }
    for figure in &figures {
        write(&out.join("figures").join(&figure.file_name), &figure.svg)?;
    }
    write(&out.join("summary.json"), &summary_json(&findings, run))?;
    let report = out.join("report.html");
    write(&report, &html(run, &findings, &figures))?;
    print(&format!(
        "{} force maps, {} figures, summary.json and the report in {}\n",
        1 + run.maps.len(),
        figures.len(),
        report.display()
    ))
}
