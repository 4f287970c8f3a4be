//! What `palpate detect` is asked.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};

use crate::numbers::{millimetres, newtons, probability, tolerance};
use crate::{CliError, Format};
use palpate::force::Force;
use palpate::trace::{Correlation, Criterion, Noise, Trace, Unknown};

/// Arguments of `palpate detect`.
#[derive(Debug, Args)]
pub struct DetectArguments {
    /// The recorded sweep: a header with position_mm (or time_s), lateral_force_n, normal_force_n, and a row for each sample
    #[arg(value_name = "TRACE.csv")]
    pub(super) trace: PathBuf,
    /// The force map without inclusion: JSON as 'palpate solve --phantom none --format json' prints it, or measured CSV
    #[arg(long, value_name = "MAP", required_unless_present = "bank")]
    pub(super) reference: Option<PathBuf>,
    /// The force map with the inclusion at the position that is tested
    #[arg(long, value_name = "MAP", required_unless_present = "bank")]
    pub(super) inclusion: Option<PathBuf>,
    /// A bank of inclusions, as 'palpate bank' writes it: decides whether one of them is there, and estimates where
    #[arg(long, value_name = "BANK", conflicts_with_all = ["reference", "inclusion", "any_maps"])]
    pub(super) bank: Option<PathBuf>,
    /// The probability of each inclusion of the bank given that there is one: a CSV file with position_mm, depth_mm, diameter_mm,
    /// youngs_modulus_kpa and weight [default: all the same]
    #[arg(long, value_name = "FILE", conflicts_with = "reference")]
    pub(super) prior: Option<PathBuf>,
    /// With a bank, sets the threshold for neyman-pearson-false-alarm by N simulated records instead of a bound
    #[arg(long, value_name = "N", conflicts_with = "reference")]
    pub(super) simulations: Option<u64>,
    /// The seed of the simulated records
    #[arg(
        long,
        value_name = "SEED",
        requires = "simulations",
        default_value = "1999"
    )]
    pub(super) seed: u64,
    /// Accepts maps of different gels, meshes, program versions or inclusions, with a warning
    #[arg(long)]
    pub(super) any_maps: bool,
    /// The indentation depth of the sweep in mm [default with a bank: that of the bank]
    #[arg(long, value_name = "D", value_parser = millimetres, allow_hyphen_values = true, required_unless_present = "bank")]
    pub(super) depth_mm: Option<f64>,
    /// How far the true depth may be from that, in mm
    #[arg(long, value_name = "T", value_parser = tolerance, allow_hyphen_values = true, default_value = "0.3")]
    pub(super) depth_tolerance_mm: f64,
    /// What is known and therefore not fitted: a list of offset, drift, gain, depth and variance (of the noise); all; none
    #[arg(long = "known", value_name = "LIST", value_parser = unknowns, default_value = "depth")]
    pub(super) unknown: Unknowns,
    /// How the noise of the samples is correlated: auto (estimated from the record), white (independent), or a file with a
    /// sweep without contact, from which correlation and standard deviation are estimated
    #[arg(long, value_name = "auto|white|FILE", default_value = "auto")]
    pub(super) noise: String,
    #[command(flatten)]
    pub(super) noise_sd: NoiseSd,
    /// Probability of an inclusion before the sweep
    #[arg(long, value_name = "P", value_parser = probability, allow_hyphen_values = true, default_value = "0.5")]
    pub(super) prior_h1: f64,
    /// How the threshold is chosen
    #[arg(long, value_enum, default_value_t = CriterionName::Map)]
    criterion: CriterionName,
    /// The miss rate for neyman-pearson-miss
    #[arg(long, value_name = "B", value_parser = probability, allow_hyphen_values = true)]
    pub(super) max_miss: Option<f64>,
    /// The false-alarm rate for neyman-pearson-false-alarm
    #[arg(long, value_name = "A", value_parser = probability, allow_hyphen_values = true)]
    pub(super) max_false_alarm: Option<f64>,
    /// Leaves out samples outside the lateral positions of the maps, and reports how many
    #[arg(long)]
    pub(super) trim: bool,
    /// Velocity of the probe in mm/s, for a trace over time
    #[arg(long, value_name = "V", value_parser = millimetres, allow_hyphen_values = true, requires = "start_mm")]
    pub(super) velocity_mm_s: Option<f64>,
    /// Lateral position of the probe at time 0 in mm, for a trace over time
    #[arg(long, value_name = "X0", value_parser = millimetres, allow_hyphen_values = true, requires = "velocity_mm_s")]
    pub(super) start_mm: Option<f64>,
    /// How the answer is printed
    #[arg(long, value_enum, default_value_t = Format::Table)]
    pub(super) format: Format,
    /// Writes a figure of the inclusion's position as SVG; with a bank
    #[arg(long, value_name = "FILE", conflicts_with = "reference")]
    pub(super) figure: Option<PathBuf>,
}

/// The standard deviation of the noise of a sample, of both channels or of each.
#[derive(Debug, Args)]
pub struct NoiseSd {
    /// Standard deviation of the noise of one sample in N, both channels
    #[arg(long, value_name = "S", value_parser = newtons, allow_hyphen_values = true,
          conflicts_with_all = ["noise_sd_lateral_n", "noise_sd_normal_n"])]
    noise_sd_n: Option<f64>,
    /// Standard deviation of the noise of one lateral sample in N
    #[arg(long, value_name = "S", value_parser = newtons, allow_hyphen_values = true, requires = "noise_sd_normal_n")]
    noise_sd_lateral_n: Option<f64>,
    /// Standard deviation of the noise of one normal sample in N
    #[arg(long, value_name = "S", value_parser = newtons, allow_hyphen_values = true, requires = "noise_sd_lateral_n")]
    noise_sd_normal_n: Option<f64>,
}

impl NoiseSd {
    /// What was stated, N; none if nothing was. The parser has refused all but one for both, one for each, or none.
    pub fn get(&self) -> Option<Force<f64>> {
        let both = self.noise_sd_n.map(|sd| Force::new(sd, sd));
        let each = self.noise_sd_lateral_n.zip(self.noise_sd_normal_n);
        both.or(each.map(|(lateral, normal)| Force::new(lateral, normal)))
    }
}

/// The criteria by name.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum CriterionName {
    /// The most probable hypothesis for the prior.
    Map,
    /// A given miss rate.
    NeymanPearsonMiss,
    /// A given false-alarm rate.
    NeymanPearsonFalseAlarm,
}

/// What is unknown of a sweep.
#[derive(Debug, Clone)]
pub struct Unknowns(pub Vec<Unknown>);

/// What is unknown where `text` lists what is known.
///
/// Implements: CLI-140.
pub fn unknowns(text: &str) -> Result<Unknowns, String> {
    let names = Unknown::ALL.map(|of| of.to_string());
    let known: Vec<String> = match text {
        "none" => Vec::new(),
        "all" => names.clone().into(),
        list => list.split(',').map(|name| name.trim().into()).collect(),
    };
    if let Some(name) = known.iter().find(|name| !names.contains(name)) {
        let names = names.join(", ");
        return Err(format!("{name:?} is none of {names}, all and none"));
    }
    let unknown = Unknown::ALL.into_iter();
    let unknown = unknown.filter(|of| !known.contains(&of.to_string()));
    Ok(Unknowns(unknown.collect()))
}

impl DetectArguments {
    pub fn criterion_name(&self) -> String {
        let name = self.criterion.to_possible_value();
        name.map_or(String::new(), |name| name.get_name().into())
    }

    /// Implements: CLI-042.
    pub fn criterion(&self) -> Result<Criterion, CliError> {
        use CriterionName::{Map, NeymanPearsonFalseAlarm, NeymanPearsonMiss};
        match (self.criterion, self.max_miss, self.max_false_alarm) {
            (Map, None, None) => Ok(Criterion::Map),
            (NeymanPearsonMiss, Some(max_miss), None) => {
                Ok(Criterion::NeymanPearsonMiss { max_miss })
            }
            (NeymanPearsonFalseAlarm, None, Some(max_false_alarm)) => {
                Ok(Criterion::NeymanPearsonFalseAlarm { max_false_alarm })
            }
            (criterion, ..) => {
                let name = self.criterion_name();
                let [miss, false_alarm] = [NeymanPearsonMiss, NeymanPearsonFalseAlarm]
                    .map(|of| if criterion == of { "a" } else { "no" });
                Err(CliError::Usage(format!(
                    "--criterion {name}: expected {miss} --max-miss and {false_alarm} --max-false-alarm"
                )))
            }
        }
    }

    /// Implements: CLI-041.
    pub fn noise(&self) -> Result<Noise, CliError> {
        let sd = self.noise_sd.get();
        let noise = match &*self.noise {
            "auto" => Noise {
                sd,
                correlation: Correlation::OfRecord,
            },
            "white" => Noise {
                sd,
                correlation: Correlation::None,
            },
            file => {
                let blank = Noise::of_blank(&Trace::read(Path::new(file))?)?;
                Noise {
                    sd: sd.or(blank.sd),
                    ..blank
                }
            }
        };
        if noise.sd.is_none() && !self.unknown.0.contains(&Unknown::Variance) {
            let message =
                "--known variance: expected --noise-sd-n, or --noise FILE, which says what it is";
            return Err(CliError::Usage(message.into()));
        }
        Ok(noise)
    }
}
