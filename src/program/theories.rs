//! `palpate run --compare-theories`: the phantoms of a run under several theories of the gel.

use rayon::prelude::*;

use super::CliError;
use super::config::Config;
use super::deformed::{deformed_mesh, shown};
use super::progress::{bar, tell_time};
use palpate::fem::{FemError, Model, Pose};
use palpate::phantom::{Material, Phantom, Strain};
use palpate_paper::psychophysics::bridge::probe_depth;
use palpate_paper::report::Theory;

/// What is compared: strain and coefficient of friction.
const THEORIES: [(Strain, f64); 3] = [
    (Strain::Small, 0.0),
    (Strain::Finite, 0.0),
    (Strain::Finite, 0.3),
];
/// The part by which Poisson's ratios are changed up and down for the leverage, at the most.
const CHANGE: f64 = 2e-3;

/// The phantoms, the reference first, under each theory.
///
/// # Errors
/// A phantom or a contact law that a theory does not have.
///
/// Implements: CLI-179.
pub fn phantoms(config: &Config, phantoms: &[Phantom]) -> Result<Vec<Vec<Phantom>>, CliError> {
    let under = |phantom: &Phantom, (strain, friction): (Strain, f64)| {
        config.mesh.contact.check(strain)?;
        phantom.changed(|parts| {
            parts.strain = strain;
            parts.probe.friction = friction;
        })
    };
    let theory = |theory: (Strain, f64)| {
        let (strain, friction) = theory;
        let of = |phantom: &Phantom| {
            let place = format!(
                "--compare-theories: at {strain} strain, friction {friction}, phantom {}",
                phantom.name()
            );
            under(phantom, theory).map_err(CliError::refused(place))
        };
        phantoms.iter().map(of).collect()
    };
    THEORIES.into_iter().map(theory).collect()
}

/// What was found of the phantoms of each theory.
///
/// Implements: CLI-179.
pub fn compare(config: &Config, theories: &[Vec<Phantom>]) -> Result<Vec<Theory>, CliError> {
    let theory = |phantoms: &Vec<Phantom>| solve(config, phantoms);
    theories.iter().map(theory).collect()
}

fn solve(config: &Config, phantoms: &[Phantom]) -> Result<Theory, CliError> {
    let (depths, laterals) = (&config.depths, &config.laterals);
    let size = config.mesh.size_mm / 1e3;
    let failed = |at: usize| CliError::fem(phantoms[at].name());
    let models = phantoms.par_iter().map(|phantom| {
        Model::new(phantom, size, config.mesh.contact).map_err(CliError::fem(phantom.name()))
    });
    let models = models.collect::<Result<Vec<_>, _>>()?;
    let poses = models
        .iter()
        .map(|model| depths.len() * model.solved_laterals(laterals).len());
    let poses: Vec<usize> = poses.collect();
    let most = poses.iter().copied().max().unwrap_or(0);
    tell_time(&phantoms[0], size, [phantoms.len(), most]).map_err(failed(0))?;
    let bar = bar(poses.iter().sum(), "poses");
    let maps = models.par_iter().map(|model| {
        let map = model.map(depths, laterals, &|poses| {
            bar.inc(poses as u64);
            true
        });
        map.map_err(CliError::fem(model.phantom().name()))
    });
    let mut maps = maps.collect::<Result<Vec<_>, _>>()?;
    bar.finish_and_clear();
    let shown = shown(phantoms);
    let deformed = deformed_mesh(&models[shown], &maps[shown]);
    let leverage = poisson_leverage(config, &models[0]);
    Ok(Theory {
        reference: maps.remove(0),
        maps,
        deformed: deformed.map_err(failed(shown))?,
        poisson_leverage: leverage.map_err(failed(0))?,
    })
}

/// d ln F_n / d ln ν of the normal force at the probe depth and x = 0, `None` at the surface; from below where no phantom has the larger
/// ratios.
///
/// Implements: REP-090.
fn poisson_leverage(config: &Config, model: &Model) -> Result<Option<f64>, FemError> {
    let phantom = model.phantom();
    let (depth, _) = probe_depth(&config.depths);
    let lateral = 0.0;
    let changed = |factor: f64| {
        phantom.changed(|parts| {
            let materials = parts.materials_mut();
            materials.for_each(|of| of.poisson_ratio *= factor);
        })
    };
    let force = |phantom: &Phantom| {
        let model = model.with_phantom(phantom)?;
        Ok::<f64, FemError>(model.solve(Pose { depth, lateral })?.force.normal)
    };
    // Half of the way to ν = 0.5 at the most.
    let most = |most: f64, of: &Material| most.min(0.25 / of.poisson_ratio - 0.5);
    let change = phantom
        .materials()
        .filter(|of| of.poisson_ratio > 0.0)
        .fold(CHANGE, most);
    let less = force(&changed(1.0 - change)?)?;
    if less == 0.0 {
        return Ok(None);
    }
    if let Ok(phantom) = changed(1.0 + change) {
        let more = force(&phantom)?;
        return Ok(Some((more - less) / (more + less) / change));
    }
    let [own, least] = [force(phantom)?, force(&changed(1.0 - 2.0 * change)?)?];
    // Of second order, as the difference of both sides.
    Ok(Some(
        (3.0 * own - 4.0 * less + least) / (2.0 * change * own),
    ))
}
