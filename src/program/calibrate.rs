//! `palpate calibrate`: what force–depth curves say of a gel.

use std::path::PathBuf;

use clap::Args;
use serde_json::json;

use super::error::refuse;
use super::layout::LayoutArguments;
use super::numbers::{for_each, length, position};
use super::output::{Envelope, note, svg_file, warn, write};
use super::solve::{phantom, tell_large_strain_to};
use super::{CliError, Format};
use palpate::calibration::{
    Calibration, CalibrationQuestion, Curve, Elastic, Indentation, Interval, calibrate as fitted,
    calibrated, modulus_row, pooled_moduli,
};
use palpate::chart::calibration_figure;
use palpate::fem::MESH_SIZE;
use palpate::phantom::Phantom;
use palpate::refusal::Refusal;
use palpate::rows::Rows;

/// Arguments of `palpate calibrate`.
#[derive(Debug, Args)]
pub struct CalibrateArguments {
    /// Recorded indentations: CSV files with depth_mm, normal_force_n and, to see how the force relaxes, time_s; each begins above the gel
    #[arg(value_name = "CURVE.csv", required = true)]
    curves: Vec<PathBuf>,
    /// The gel and the probe (built-in phantom or file), whose moduli are found; without it an empirical law is fitted
    #[arg(long, value_name = "NAME|FILE")]
    phantom: Option<String>,
    /// A layer whose modulus is found, by its name; may be given twice [default: one factor for all moduli]
    #[arg(long = "layer", value_name = "LAYER", requires = "phantom")]
    layers: Vec<String>,
    /// Lateral position of the curves in mm, or of each of several
    #[arg(long = "lateral-mm", value_name = "X", value_parser = position, value_delimiter = ',', allow_hyphen_values = true, default_value = "0", requires = "phantom")]
    laterals: Vec<f64>,
    /// Depth at which the probe touches the gel, in mm on the scale of the curve, or auto to estimate it
    #[arg(
        long = "contact",
        value_name = "auto|MM",
        default_value = "auto",
        allow_hyphen_values = true
    )]
    contact: String,
    /// Mesh size in mm [default: 0.5]
    #[arg(long = "mesh-mm", value_parser = length, value_name = "H", requires = "phantom")]
    mesh_size: Option<f64>,
    #[command(flatten)]
    layout: LayoutArguments,
    /// Writes the phantom with the moduli that were found, for other commands
    #[arg(long, value_name = "FILE.toml", requires = "phantom")]
    out: Option<PathBuf>,
    /// Writes how well the depth is known, for 'palpate detect --gel-uncertainty'
    #[arg(long, value_name = "FILE.toml")]
    uncertainty_out: Option<PathBuf>,
    /// Writes a figure as SVG: each curve, its fit, and the residual
    #[arg(long, value_name = "FILE.svg", value_parser = svg_file())]
    figure: Option<PathBuf>,
    /// Output format
    #[arg(long, value_enum, default_value_t = Format::Table)]
    format: Format,
}

/// Runs the command.
///
/// Implements: CLI-176, CLI-017, CLI-003, CLI-015, CAL-042.
pub fn calibrate(arguments: &CalibrateArguments) -> Result<(), CliError> {
    let phantom = arguments.phantom.as_deref().map(phantom).transpose()?;
    let layers = layers(arguments, phantom.as_ref())?;
    let contact = contact(&arguments.contact)?;
    if contact.is_some() && arguments.uncertainty_out.is_some() {
        refuse!("--uncertainty-out needs --contact auto");
    }
    let layout = arguments.layout.get()?;
    let curves = arguments
        .curves
        .iter()
        .map(|path| Curve::read(path, &layout));
    let curves = curves.collect::<Result<Vec<_>, _>>()?;
    for (at, curve) in curves.iter().enumerate() {
        let samples = |of: &Curve| [of.depths(), of.forces()].concat();
        let mut before = curves[..at].iter();
        if let Some(same) = before.find(|of| samples(of) == samples(curve)) {
            let (file, same) = (curve.file(), same.file());
            refuse!("{file}: the same samples as {same}; name each curve once");
        }
    }
    let Some(laterals) = for_each(&arguments.laterals, curves.len()) else {
        let positions = arguments.laterals.len();
        refuse!("--lateral-mm has {positions} positions; give one, or one for each curve")
    };
    let mut found = Vec::new();
    for (curve, lateral) in curves.iter().zip(laterals) {
        curve
            .notes()
            .iter()
            .for_each(|text| note(curve.file(), text));
        let indentation = Indentation {
            layers: &layers,
            lateral,
            mesh_size: arguments.mesh_size.unwrap_or(MESH_SIZE),
        };
        let gel = phantom.as_ref().map(|phantom| (phantom, indentation));
        let name = phantom.as_ref().map_or("", Phantom::name);
        let calibration = fitted(curve, CalibrationQuestion { gel, contact });
        found.push(calibration.map_err(CliError::fem(name))?);
    }
    if let Some(path) = &arguments.figure {
        write(path, &calibration_figure(&found)?)?;
    }
    tell(arguments, &found, (phantom.as_ref(), &layers))?;
    let strains: Vec<_> = found.iter().map(strain).collect();
    strains.into_iter().collect()
}

/// Warns where the strain is too large for the model, down to the greatest depth of a curve.
///
/// Implements: CLI-015, CLI-003.
fn strain(of: &Calibration<'_>) -> Result<(), CliError> {
    let (Elastic::Gel(gel), Some(deepest)) = (&of.elastic, of.greatest_depth()?) else {
        return Ok(());
    };
    tell_large_strain_to(deepest, &gel.map, gel.phantom.name())
}

/// The numbers of the layers that are named.
fn layers(
    arguments: &CalibrateArguments,
    phantom: Option<&Phantom>,
) -> Result<Vec<usize>, CliError> {
    let all = phantom.map_or(&[][..], Phantom::layers);
    let mut numbers = Vec::new();
    for name in &arguments.layers {
        let named = (0..all.len()).filter(|&number| all[number].name == *name);
        match named.collect::<Vec<_>>()[..] {
            [number] if !numbers.contains(&number) => numbers.push(number),
            [_, _, ..] => {
                refuse!("--layer {name:?} is the name of several layers; give each its own")
            }
            _ => {
                let names: Vec<_> = all.iter().map(|layer| &*layer.name).collect();
                refuse!(
                    "--layer {name:?} is unknown or given twice; give each once, of {}",
                    names.join(", ")
                );
            }
        }
    }
    Ok(numbers)
}

fn contact(text: &str) -> Result<Option<f64>, CliError> {
    match text {
        "auto" => Ok(None),
        depth => match position(depth) {
            Ok(depth) => Ok(Some(depth)),
            Err(error) => refuse!("--contact {depth:?}: {error}, or auto"),
        },
    }
}

/// A modulus that is so many times the phantom's, or so many times smaller, is more likely a force in another unit.
const FAR: f64 = 30.0;

/// Warns of moduli that are far from those of the phantom.
///
/// Implements: CLI-238.
fn tell_far_moduli(phantom: &Phantom, layers: &[usize], moduli: &[(String, Interval)]) {
    let numbers = if layers.is_empty() { &[0] } else { layers };
    for (number, (name, modulus)) in numbers.iter().zip(moduli) {
        let factor = modulus.estimate / phantom.layers()[*number].material.youngs_modulus;
        if !(1.0 / FAR..=FAR).contains(&factor) {
            warn(&format!(
                "{name}: {factor:.2e} times Young's modulus of the phantom; check the unit of the forces, or give a phantom nearer to the gel"
            ));
        }
    }
}

/// Says which curves cannot be judged, and why if it is one.
fn unjudged(found: &[Calibration<'_>]) -> Option<String> {
    let bad = found
        .iter()
        .filter_map(|of| Some((of.curve.file(), of.cause?)));
    let bad: Vec<_> = bad.collect();
    match bad[..] {
        [] => None,
        [(file, cause)] => Some(format!("{file}: cannot be judged: {}", cause.in_words())),
        [..] => {
            let files: Vec<_> = bad.iter().map(|(file, _)| *file).collect();
            Some(format!(
                "{} of {} curves cannot be judged: {}; the answer of each says why",
                bad.len(),
                found.len(),
                files.join(", ")
            ))
        }
    }
}

/// Prints the answers; writes what was found if all curves could be judged, else fails.
///
/// Implements: CLI-176.
fn tell(
    arguments: &CalibrateArguments,
    found: &[Calibration<'_>],
    (phantom, layers): (Option<&Phantom>, &[usize]),
) -> Result<(), CliError> {
    let rows = found
        .iter()
        .map(|of| of.rows(layers))
        .collect::<Result<Vec<_>, _>>()?;
    let moduli = pooled_moduli(found, layers)?;
    let mut table: Vec<String> = Vec::new();
    for (of, rows) in found.iter().zip(&rows) {
        if found.len() > 1 {
            table.push(format!("{}\n", of.curve.file()));
        }
        table.push(rows.table());
    }
    let mut answer = Rows::default();
    answer.value("phantom", json!(arguments.phantom));
    answer.value("curves", json!(rows));
    let unjudged = unjudged(found);
    if unjudged.is_none() && found.len() > 1 && !moduli.is_empty() {
        let mut all = Rows::default();
        modulus_row(&mut all, "all curves: Young's modulus, kPa", &moduli);
        table.push(all.table());
        answer.append(all);
    }
    if let Some(phantom) = phantom {
        tell_far_moduli(phantom, layers, &moduli);
    }
    let answer = Envelope::new("palpate-calibration", 1, answer);
    arguments.format.print(&answer, || table.concat())?;
    if let Some(message) = unjudged {
        return Err(CliError::Unjudged(message));
    }
    if let (Some(path), Some(phantom)) = (&arguments.out, phantom) {
        write(path, &calibrated(phantom, layers, &moduli)?.to_toml())?;
    }
    if let Some(path) = &arguments.uncertainty_out {
        let percent = |of: &Calibration| Ok(of.depth_percent()?.zip(of.greatest_depth()?));
        let percents = found
            .iter()
            .map(percent)
            .collect::<Result<Vec<_>, Refusal>>()?;
        // All contacts were estimated.
        let largest = (percents.into_iter().flatten()).max_by(|a, b| a.0.total_cmp(&b.0));
        let (percent, depth) = largest.unwrap_or_default();
        let depth = 1e3 * depth;
        let text = format!(
            "# From the contact that palpate calibrate estimated, at a depth of {depth:.3} mm. At half of it, write twice as much.\n\
             depth_percent = {percent:.3}\n"
        );
        write(path, &text)?;
    }
    Ok(())
}
