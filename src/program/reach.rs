//! `palpate reach`: the greatest depth and the smallest size of an inclusion that can be detected (`spec/bank.md`).

use std::path::PathBuf;

use askama::Template;
use clap::Args;
use serde::Serialize;

use super::detect::arguments::{Known, NoiseSd};
use super::error::refuse;
use super::numbers::probability;
use super::output::{Envelope, svg_file, write};
use super::path::PathArguments;
use super::{CliError, Format};
use palpate::bank::{Bank, BesideClass, Reach, Reached, smallest_diameters};
use palpate::chart::reach_figure;
use palpate::decimal::{kpa, mm};
use palpate::force::Force;
use palpate::phantom::Phantom;
use palpate::refusal::Refusal;
use palpate::robust::{GelChanges, GelUncertainty};
use palpate::text;
use palpate::trace::{Record, Unknown, in_words};

/// Arguments of `palpate reach`.
#[derive(Debug, Args)]
pub struct ReachArguments {
    /// Bank of inclusions from 'palpate bank'
    #[arg(long, value_name = "BANK")]
    bank: PathBuf,
    #[command(flatten)]
    noise_sd: NoiseSd,
    /// False-alarm rate of a search over the whole bank
    #[arg(long, value_name = "A", value_parser = probability, allow_hyphen_values = true, default_value = "0.01")]
    max_false_alarm: f64,
    /// Miss rate
    #[arg(long, value_name = "B", value_parser = probability, allow_hyphen_values = true, default_value = "0.05")]
    max_miss: f64,
    /// Number of evenly spaced samples of a sweep over the bank, where no path is given [default: one at each lateral position]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=1_000_000), conflicts_with_all = ["depths", "path"])]
    samples: Option<u64>,
    #[command(flatten)]
    path: PathArguments,
    /// Quantities to take as known instead of fitting: a list of offset, drift, gain and depth, or 'all' or 'none'
    #[arg(long, value_name = "LIST", value_parser = Known::parse, default_value = "depth")]
    known: Known,
    /// Adds the γ that remains after each class of disturbance of 'palpate detect' is allowed for
    #[arg(long)]
    classes: bool,
    /// Output format
    #[arg(long, value_enum, default_value_t = Format::Table)]
    format: Format,
    /// Writes a figure of the greatest detectable depths as SVG
    #[arg(long, value_name = "FILE.svg", value_parser = svg_file())]
    figure: Option<PathBuf>,
}

/// What was asked.
#[derive(Debug, Serialize)]
struct Asked {
    bank: String,
    /// None along a path.
    probe_depth_m: Option<f64>,
    noise_sd_lateral_n: f64,
    noise_sd_normal_n: f64,
    max_false_alarm: f64,
    max_miss: f64,
    samples: usize,
    /// What is unknown for the second of each two answers.
    unknown: Vec<Unknown>,
}

/// The answer; for people, lengths in mm.
#[derive(Debug, Serialize, Template)]
#[template(path = "cli.txt", block = "reach")]
struct ReachAnswer {
    #[serde(flatten)]
    asked: Asked,
    gamma_needed: f64,
    depths_m: Vec<f64>,
    diameters_m: Vec<f64>,
    largest_depths: Vec<LargestDepth>,
    smallest_diameters: Vec<SmallestDiameter>,
    /// With --classes.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    beside_classes: Vec<BesideClasses>,
}

/// γ of an inclusion of one diameter and modulus at each depth of the bank, beside each class of disturbance.
#[derive(Debug, Serialize)]
struct BesideClasses {
    diameter_m: f64,
    youngs_modulus_pa: f64,
    classes: Vec<BesideClass>,
}

/// The greatest detectable depth of an inclusion of one diameter and modulus.
#[derive(Debug, Serialize)]
struct LargestDepth {
    diameter_m: f64,
    youngs_modulus_pa: f64,
    nothing_unknown: Reached,
    unknown: Reached,
}

/// The smallest detectable diameter of an inclusion of one modulus at one depth; none if the largest of the bank is not detected.
#[derive(Debug, Serialize)]
struct SmallestDiameter {
    depth_m: f64,
    youngs_modulus_pa: f64,
    nothing_unknown_m: Option<f64>,
    unknown_m: Option<f64>,
    /// Whether each is the least diameter of the bank, so that a smaller one may be detected too.
    nothing_unknown_is_beyond_bank: bool,
    unknown_is_beyond_bank: bool,
}

impl ReachArguments {
    fn asked(&self, bank: &Bank, sweep: &Record) -> Result<Asked, CliError> {
        let Some(noise_sd) = self.noise_sd.get() else {
            refuse!("give --noise-sd-n, or both --noise-sd-lateral-n and --noise-sd-normal-n");
        };
        // The variance of the noise is stated.
        let unknown = self.known.unknown.iter().copied();
        Ok(Asked {
            bank: self.bank.display().to_string(),
            probe_depth_m: sweep.depths().is_none().then_some(bank.depth()),
            noise_sd_lateral_n: noise_sd.lateral,
            noise_sd_normal_n: noise_sd.normal,
            max_false_alarm: self.max_false_alarm,
            max_miss: self.max_miss,
            samples: sweep.positions().len(),
            unknown: unknown.filter(|&of| of != Unknown::Variance).collect(),
        })
    }
}

/// Runs the command.
///
/// Implements: CLI-160, CLI-163, CLI-234.
pub fn reach(arguments: &ReachArguments) -> Result<(), CliError> {
    let bank = Bank::read(&arguments.bank)?;
    let sweep = sweep(arguments, &bank)?;
    let asked = arguments.asked(&bank, &sweep)?;
    let plain = Reach {
        bank: &bank,
        sweep: &sweep,
        noise_sd: Force::new(asked.noise_sd_lateral_n, asked.noise_sd_normal_n),
        max_false_alarm: asked.max_false_alarm,
        max_miss: asked.max_miss,
        unknown: &[],
    };
    let unknown = &asked.unknown;
    let beside = Reach { unknown, ..plain };
    let in_bank = |refusal: Refusal| refusal.in_file(&*asked.bank);
    let beyond = |refusal| Refusal {
        line: None,
        remedy: "give a path over them".into(),
        ..in_bank(refusal)
    };
    sweep.expected(bank.base(), bank.depth()).map_err(beyond)?;
    let gamma_needed = plain.gamma()?;
    let beside_classes = match arguments.classes {
        true => beside_classes(&plain)?,
        false => Vec::new(),
    };
    let plain = plain.reached().map_err(in_bank)?;
    let beside = beside.reached().map_err(in_bank)?;
    if let Some(path) = &arguments.figure {
        let words = in_words(&asked.unknown);
        write(path, &reach_figure(&bank, &plain, &beside, &words)?)?;
    }
    let answer = ReachAnswer {
        gamma_needed,
        depths_m: bank.axes()[1].clone(),
        diameters_m: bank.axes()[2].clone(),
        smallest_diameters: smallest(&bank, [&plain, &beside], gamma_needed),
        largest_depths: plain.into_iter().zip(beside).map(largest).collect(),
        beside_classes,
        asked,
    };
    // Writing to a String does not fail.
    let table = answer.render().unwrap_or_default();
    let answer = Envelope::new("palpate-reach", 1, answer);
    arguments.format.print(&answer, || table)
}

/// The sweep along the path that was given, or over the bank.
fn sweep(arguments: &ReachArguments, bank: &Bank) -> Result<Record, CliError> {
    Ok(match arguments.path.path()? {
        Some(path) => path.sweep()?,
        None if bank.probe_depths().len() > 1 => {
            refuse!(
                "the bank has several depths of the probe; give the sweep, by --depths-mm or --path"
            )
        }
        None => bank.sweep(arguments.samples.map(|samples| samples as usize))?,
    })
}

/// Implements: CLI-161.
fn beside_classes(reach: &Reach<'_>) -> Result<Vec<BesideClasses>, CliError> {
    let (reference, uncertainty) = (reach.bank.reference(), GelUncertainty::default());
    let depths = match reach.sweep.depths() {
        Some(_) => GelChanges::depths_along(reference, &reach.passes().iter().collect::<Vec<_>>()),
        None => vec![reach.bank.depth()],
    };
    let changes = GelChanges::new(reference, &depths, &uncertainty);
    let name = reference.phantom().map_or("", Phantom::name);
    let found = reach.beside_classes(changes.map_err(CliError::fem(name))?.as_ref())?;
    let [_, _, diameters, moduli] = reach.bank.axes();
    let each = moduli
        .iter()
        .flat_map(|modulus| diameters.iter().map(move |of| (*of, *modulus)));
    let row = |((diameter_m, youngs_modulus_pa), classes)| BesideClasses {
        diameter_m,
        youngs_modulus_pa,
        classes,
    };
    Ok(each.zip(found).map(row).collect())
}

/// Implements: CLI-160.
fn largest((nothing_unknown, unknown): (Reached, Reached)) -> LargestDepth {
    LargestDepth {
        diameter_m: nothing_unknown.diameter,
        youngs_modulus_pa: nothing_unknown.modulus,
        nothing_unknown,
        unknown,
    }
}

/// Implements: CLI-160.
fn smallest(bank: &Bank, reached: [&[Reached]; 2], needed: f64) -> Vec<SmallestDiameter> {
    let [_, depths, diameters, moduli] = bank.axes();
    let mut rows = Vec::new();
    for (modulus, &youngs_modulus_pa) in moduli.iter().enumerate() {
        let [plain, beside] = reached.map(|reached| {
            let of_modulus = &reached[modulus * diameters.len()..][..diameters.len()];
            smallest_diameters(bank, of_modulus, needed)
        });
        for (at, &depth_m) in depths.iter().enumerate() {
            rows.push(SmallestDiameter {
                depth_m,
                youngs_modulus_pa,
                nothing_unknown_m: plain[at],
                unknown_m: beside[at],
                nothing_unknown_is_beyond_bank: plain[at].is_some_and(|of| of <= diameters[0]),
                unknown_is_beyond_bank: beside[at].is_some_and(|of| of <= diameters[0]),
            });
        }
    }
    rows
}

impl ReachAnswer {
    fn depth(&self, reached: &Reached) -> String {
        match reached.depth {
            Some(depth) if reached.is_beyond => format!("deeper than the bank ({})", mm(depth)),
            Some(depth) => format!("{:.2}", 1e3 * depth),
            None => format!("not even at the least depth ({})", mm(self.depths_m[0])),
        }
    }

    /// Numbers times `scale` in columns of their own.
    fn columns(numbers: &[f64], scale: f64) -> String {
        let columns = numbers
            .iter()
            .map(|number| format!("{:>9.2}", scale * number));
        columns.collect()
    }

    fn width(&self, found: &Option<f64>) -> String {
        // An axis of a bank has a point at least.
        let [least, most] = [0, self.diameters_m.len() - 1].map(|at| self.diameters_m[at]);
        match *found {
            Some(width) if width <= least => format!("smaller than the bank ({})", mm(width)),
            Some(width) => format!("{:.2}", 1e3 * width),
            None => format!("not even the largest ({})", mm(most)),
        }
    }
}
