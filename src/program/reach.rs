//! `palpate reach`: the greatest depth and the smallest size of an inclusion that can be detected (`spec/bank.md`).

use std::borrow::Borrow;
use std::path::PathBuf;

use askama::Template;
use clap::Args;
use serde::Serialize;

use super::detect::arguments::{Known, NoiseSd};
use super::numbers::probability;
use super::output::{Envelope, write};
use super::{CliError, Format};
use palpate::bank::{Bank, Reach, Reached, smallest_diameters};
use palpate::chart::reach_figure;
use palpate::decimal::format_scaled;
use palpate::refusal::Refusal;
use palpate::trace::{Unknown, in_words};

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
    /// Number of evenly spaced samples of the sweep [default: one at each lateral position of the bank]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=1_000_000))]
    samples: Option<u64>,
    /// Quantities to take as known instead of fitting: a list of offset, drift, gain and depth, or 'all' or 'none'
    #[arg(long, value_name = "LIST", value_parser = Known::parse, default_value = "depth")]
    known: Known,
    /// Output format
    #[arg(long, value_enum, default_value_t = Format::Table)]
    format: Format,
    /// Writes a figure of the greatest detectable depths as SVG
    #[arg(long, value_name = "FILE")]
    figure: Option<PathBuf>,
}

/// The answer; for people, lengths in mm.
#[derive(Debug, Serialize, Template)]
#[template(path = "cli.txt", block = "reach")]
struct ReachAnswer {
    bank: String,
    probe_depth_m: f64,
    noise_sd_lateral_n: f64,
    noise_sd_normal_n: f64,
    max_false_alarm: f64,
    max_miss: f64,
    samples: usize,
    /// What is unknown for the second of each two answers.
    unknown: Vec<Unknown>,
    gamma_needed: f64,
    depths_m: Vec<f64>,
    diameters_m: Vec<f64>,
    largest_depths: Vec<LargestDepth>,
    smallest_diameters: Vec<SmallestDiameter>,
}

/// The greatest detectable depth of an inclusion of one diameter and modulus.
#[derive(Debug, Serialize)]
struct LargestDepth {
    diameter_m: f64,
    youngs_modulus_pa: f64,
    nothing_unknown: DepthReached,
    unknown: DepthReached,
}

#[derive(Debug, Serialize)]
struct DepthReached {
    /// None if it is not detected at the least depth of the bank.
    largest_depth_m: Option<f64>,
    /// Whether it is detected at the greatest depth of the bank, so that the limit lies deeper.
    is_beyond_bank: bool,
    /// γ at each depth of the bank.
    gamma: Vec<f64>,
}

/// The smallest detectable diameter of an inclusion of one modulus at one depth; none if the largest of the bank is not detected.
#[derive(Debug, Serialize)]
struct SmallestDiameter {
    depth_m: f64,
    youngs_modulus_pa: f64,
    nothing_unknown_m: Option<f64>,
    unknown_m: Option<f64>,
}

/// Runs the command.
///
/// Implements: CLI-160, CLI-163.
pub fn reach(arguments: &ReachArguments) -> Result<(), CliError> {
    let bank = Bank::read(&arguments.bank)?;
    // The variance of the noise is stated.
    let unknown = arguments.known.unknown.iter().copied();
    let unknown: Vec<Unknown> = unknown.filter(|&of| of != Unknown::Variance).collect();
    let noise_sd = arguments.noise_sd.get().ok_or_else(|| {
        let message = "give --noise-sd-n, or both --noise-sd-lateral-n and --noise-sd-normal-n";
        CliError::Usage(message.into())
    })?;
    let samples = arguments.samples.map(|samples| samples as usize);
    let plain = Reach {
        bank: &bank,
        samples,
        noise_sd,
        max_false_alarm: arguments.max_false_alarm,
        max_miss: arguments.max_miss,
        unknown: &[],
    };
    let beside = Reach {
        unknown: &unknown,
        ..plain
    };
    let file = arguments.bank.display().to_string();
    let in_bank = |refusal: Refusal| refusal.in_file(&*file);
    let gamma_needed = plain.gamma()?;
    let plain = plain.reached().map_err(in_bank)?;
    let beside = beside.reached().map_err(in_bank)?;
    if let Some(path) = &arguments.figure {
        let words = in_words(&unknown);
        write(path, &reach_figure(&bank, &plain, &beside, &words)?)?;
    }
    let answer = ReachAnswer {
        probe_depth_m: bank.depth(),
        noise_sd_lateral_n: noise_sd.lateral,
        noise_sd_normal_n: noise_sd.normal,
        max_false_alarm: arguments.max_false_alarm,
        max_miss: arguments.max_miss,
        samples: samples.unwrap_or(bank.reference().laterals().len()),
        unknown,
        gamma_needed,
        depths_m: bank.axes()[1].clone(),
        diameters_m: bank.axes()[2].clone(),
        smallest_diameters: smallest(&bank, [&plain, &beside], gamma_needed),
        largest_depths: largest(&plain, &beside),
        bank: file,
    };
    // Writing to a String does not fail.
    let table = answer.render().unwrap_or_default();
    let answer = Envelope::new("palpate-reach", 1, answer);
    arguments.format.print(&answer, || table)
}

/// Implements: CLI-160.
fn largest(plain: &[Reached], beside: &[Reached]) -> Vec<LargestDepth> {
    let reached = |of: &Reached| DepthReached {
        largest_depth_m: of.depth,
        is_beyond_bank: of.is_beyond,
        gamma: of.gamma.clone(),
    };
    let pairs = plain.iter().zip(beside);
    let row = |(plain, beside): (&Reached, &Reached)| LargestDepth {
        diameter_m: plain.diameter,
        youngs_modulus_pa: plain.modulus,
        nothing_unknown: reached(plain),
        unknown: reached(beside),
    };
    pairs.map(row).collect()
}

/// Implements: CLI-160.
fn smallest(bank: &Bank, reached: [&[Reached]; 2], needed: f64) -> Vec<SmallestDiameter> {
    let [_, depths, diameters, moduli] = bank.axes();
    let of_modulus = |(modulus, &youngs_modulus_pa): (usize, &f64)| {
        let [plain, beside] = reached.map(|reached| {
            let of_modulus = &reached[modulus * diameters.len()..][..diameters.len()];
            smallest_diameters(bank, of_modulus, needed)
        });
        let rows = depths.iter().zip(plain.into_iter().zip(beside));
        let row = rows.map(
            |(&depth_m, (nothing_unknown_m, unknown_m))| SmallestDiameter {
                depth_m,
                youngs_modulus_pa,
                nothing_unknown_m,
                unknown_m,
            },
        );
        row.collect::<Vec<_>>()
    };
    moduli.iter().enumerate().flat_map(of_modulus).collect()
}

impl ReachAnswer {
    fn depth(&self, reached: &DepthReached) -> String {
        match reached.largest_depth_m {
            Some(depth) if reached.is_beyond_bank => {
                format!("deeper than the bank ({})", in_mm(depth))
            }
            Some(depth) => format!("{:.2}", 1e3 * depth),
            None => {
                let least = self.depths_m.first().copied().unwrap_or(f64::NAN);
                format!("not even at the least depth ({})", in_mm(least))
            }
        }
    }

    fn width(&self, found: &Option<f64>) -> String {
        let ends = (self.diameters_m.first(), self.diameters_m.last());
        match (found, ends) {
            (Some(width), (Some(least), _)) if width <= least => {
                format!("smaller than the bank ({})", in_mm(width))
            }
            (Some(width), _) => format!("{:.2}", 1e3 * width),
            (None, (_, most)) => {
                let most = most.unwrap_or(&f64::NAN);
                format!("not even the largest ({})", in_mm(most))
            }
        }
    }
}

fn in_mm(length: impl Borrow<f64>) -> String {
    format_scaled(*length.borrow(), 3)
}
