//! What `palpate detect` is asked.

use std::fmt::Display;
use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};

use crate::error::refuse;
use crate::layout::LayoutArguments;
use crate::numbers::{length_or_zero, newtons, position, probability, sure_probability, velocity};
use crate::output::{note, svg_file};
use crate::{CliError, Format};
use palpate::csv::Layout;
use palpate::force::Force;
use palpate::robust::Part;
use palpate::trace::{Correlation, Criterion, Noise, Trace, Unknown};

/// Arguments of `palpate detect`.
#[derive(Debug, Args)]
pub struct DetectArguments {
    /// The recorded sweep: a CSV file with position_mm (or time_s), lateral_force_n and normal_force_n, one row per sample. Several, or
    /// folders of them, are each judged alone, or all --together; - is standard input
    #[arg(value_name = "TRACE.csv", required = true)]
    pub(super) traces: Vec<PathBuf>,
    #[command(flatten)]
    pub(super) model: ModelArguments,
    #[command(flatten)]
    pub(super) hypotheses: MapsOrBank,
    #[command(flatten)]
    pub(super) sweep: Sweep,
    #[command(flatten)]
    pub(super) noise: NoiseArguments,
    #[command(flatten)]
    pub(super) criterion: CriterionArguments,
    /// Output format
    #[arg(long, value_enum, default_value_t = Format::Table)]
    pub(super) format: Format,
}

/// What the record may hold beside an inclusion.
#[derive(Debug, Args)]
pub(super) struct ModelArguments {
    /// What may affect the record apart from noise and an inclusion
    #[arg(long, value_enum, default_value_t = ModelName::Robust)]
    pub model: ModelName,
    /// Posterior probability for the answer "inclusion"; "no inclusion" needs at most 1 minus this [default: 0.95]
    #[arg(long, value_name = "P", value_parser = sure_probability, allow_hyphen_values = true)]
    pub sure: Option<f64>,
    /// The sensor was set to zero on the gel, so the forces cannot show whether the probe touches it; the answer is then never "no
    /// inclusion"
    #[arg(long)]
    pub zeroed: bool,
    /// Judges all traces together, as sweeps over the same place
    #[arg(long)]
    pub together: bool,
    /// A sweep of the same gel over a place without an inclusion, at the first --depth-mm; may be given several times
    #[arg(long = "reference-sweep", value_name = "TRACE.csv")]
    pub reference_sweeps: Vec<PathBuf>,
    /// How well the gel is known: a TOML file with standard deviations in percent
    #[arg(long, value_name = "FILE")]
    pub gel_uncertainty: Option<PathBuf>,
}

/// The models by name.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(super) enum ModelName {
    /// Whatever gels, motions and sensors usually do to the forces.
    Robust,
    /// Nothing but what is fitted: the paper's detector.
    Exact,
}

/// The forces to compare the record with.
#[derive(Debug, Args)]
pub(super) struct MapsOrBank {
    /// Force map without inclusion: JSON from 'palpate solve --phantom none --format json', or a measured map in CSV
    #[arg(long, value_name = "MAP", required_unless_present = "bank")]
    pub reference: Option<PathBuf>,
    /// Force map with the inclusion at the position to be tested
    #[arg(long, value_name = "MAP", required_unless_present = "bank")]
    pub inclusion: Option<PathBuf>,
    /// Accepts maps of different gels, meshes, program versions or inclusions, with a warning
    #[arg(long)]
    pub any_maps: bool,
    /// Bank of inclusions from 'palpate bank': tests for any of them and estimates its position
    #[arg(long, value_name = "BANK", conflicts_with_all = ["reference", "inclusion", "any_maps"])]
    pub bank: Option<PathBuf>,
    /// Probability of each inclusion of the bank, given that there is one: a CSV file with position_mm, depth_mm, diameter_mm,
    /// youngs_modulus_kpa and weight [default: all equal]
    #[arg(long, value_name = "FILE", conflicts_with = "reference")]
    pub prior: Option<PathBuf>,
    /// Calibrates the threshold on N simulated records instead of a bound; with a bank and --max-false-alarm
    #[arg(
        long,
        value_name = "N",
        conflicts_with = "reference",
        requires = "max_false_alarm"
    )]
    pub simulations: Option<u64>,
    /// Seed of the simulated records
    #[arg(
        long,
        value_name = "SEED",
        requires = "simulations",
        default_value = "1999"
    )]
    pub seed: u64,
    /// Writes a figure as SVG: the record beside what explains it without and with an inclusion. With --model exact and a bank: the
    /// inclusion's position
    #[arg(long, value_name = "FILE.svg", value_parser = svg_file())]
    pub figure: Option<PathBuf>,
}

/// Where the probe was.
#[derive(Debug, Args)]
pub(super) struct Sweep {
    /// Indentation depth of the sweep in mm, or of each of several [default: a column depth_mm, else that of the bank]
    #[arg(long = "depth-mm", value_name = "D", value_parser = position, value_delimiter = ',', allow_hyphen_values = true)]
    pub depths: Vec<f64>,
    /// Standard deviation of the error of each depth of a column depth_mm, in mm [default: 0]
    #[arg(long = "depth-noise-mm", value_name = "S", value_parser = length_or_zero, allow_hyphen_values = true)]
    pub depth_noise: Option<f64>,
    /// Largest expected error of the depth, or of all depths alike, in mm [default: 0.3]; with --model exact
    #[arg(long = "depth-tolerance-mm", value_name = "T", value_parser = length_or_zero, allow_hyphen_values = true)]
    pub depth_tolerance: Option<f64>,
    /// Drops samples outside the lateral range of the maps, and reports how many
    #[arg(long)]
    pub trim: bool,
    #[command(flatten)]
    pub layout: LayoutArguments,
    /// Velocity of the probe in mm/s, for a trace over time
    #[arg(long = "velocity-mm-s", value_name = "V", value_parser = velocity, allow_hyphen_values = true, requires = "start")]
    pub velocity: Option<f64>,
    /// Lateral position of the probe at time 0 in mm, for a trace over time
    #[arg(long = "start-mm", value_name = "X0", value_parser = position, allow_hyphen_values = true, requires = "velocity")]
    pub start: Option<f64>,
}

/// What is known of the sensor and of its noise.
#[derive(Debug, Args)]
pub(super) struct NoiseArguments {
    /// Disturbances that cannot occur: a list of smooth, gel, support, stage, surface, tilt, friction, relaxation and walk. With --model
    /// exact, quantities that are known and not fitted: a list of offset, drift, gain, depth and variance (of the noise) [default: depth].
    /// Or 'all' or 'none'
    #[arg(long, value_name = "LIST")]
    known: Option<String>,
    /// Correlation of the noise: auto (estimated from the record; --model exact does not judge a record with correlated noise), white
    /// (independent samples), or a file with a sweep without contact, from which correlation and standard deviation are estimated
    #[arg(long, value_name = "auto|white|FILE", default_value = "auto")]
    pub noise: String,
    #[command(flatten)]
    noise_sd: NoiseSd,
}

/// The standard deviation of the noise of a sample, of both channels or of each.
#[derive(Debug, Args)]
pub struct NoiseSd {
    /// Noise standard deviation of one sample in N, both channels
    #[arg(long, value_name = "S", value_parser = newtons, allow_hyphen_values = true,
          conflicts_with_all = ["noise_sd_lateral_n", "noise_sd_normal_n"])]
    noise_sd_n: Option<f64>,
    /// Noise standard deviation of one lateral sample in N
    #[arg(long, value_name = "S", value_parser = newtons, allow_hyphen_values = true, requires = "noise_sd_normal_n")]
    noise_sd_lateral_n: Option<f64>,
    /// Noise standard deviation of one normal sample in N
    #[arg(long, value_name = "S", value_parser = newtons, allow_hyphen_values = true, requires = "noise_sd_lateral_n")]
    noise_sd_normal_n: Option<f64>,
}

/// How to decide.
#[derive(Debug, Args)]
pub(super) struct CriterionArguments {
    /// Prior probability of an inclusion
    #[arg(long, value_name = "P", value_parser = probability, allow_hyphen_values = true, default_value = "0.5")]
    pub prior_h1: f64,
    /// Decision criterion [default: map]; with --model exact
    #[arg(long, value_enum)]
    pub criterion: Option<CriterionName>,
    /// Miss rate for neyman-pearson-miss
    #[arg(long, value_name = "B", value_parser = probability, allow_hyphen_values = true)]
    pub max_miss: Option<f64>,
    /// False-alarm rate for neyman-pearson-false-alarm
    #[arg(long, value_name = "A", value_parser = probability, allow_hyphen_values = true)]
    pub max_false_alarm: Option<f64>,
}

/// The criteria by name.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(super) enum CriterionName {
    /// The more probable hypothesis (maximum a posteriori).
    Map,
    /// A given miss rate.
    NeymanPearsonMiss,
    /// A given false-alarm rate.
    NeymanPearsonFalseAlarm,
}

/// What is known of a sweep, and the rest, which is fitted.
#[derive(Debug, Clone)]
pub struct Known {
    pub known: Vec<Unknown>,
    pub unknown: Vec<Unknown>,
}

impl Known {
    /// Reads a list of what is known, `all` or `none`.
    ///
    /// Implements: CLI-140.
    pub fn parse(text: &str) -> Result<Known, String> {
        let known = listed(text, Unknown::ALL)?;
        let is_known = |of: &Unknown| known.contains(of);
        let (known, unknown) = Unknown::ALL.into_iter().partition(is_known);
        Ok(Known { known, unknown })
    }
}

/// Those of `all` that a list names, or `all` or `none`.
fn listed<T: Copy + Display>(
    text: &str,
    all: impl IntoIterator<Item = T>,
) -> Result<Vec<T>, String> {
    let all: Vec<T> = all.into_iter().collect();
    let names: Vec<String> = all.iter().map(T::to_string).collect();
    let listed: Vec<String> = match text {
        "none" => Vec::new(),
        "all" => names.clone(),
        list => list.split(',').map(|name| name.trim().into()).collect(),
    };
    if let Some(name) = listed.iter().find(|name| !names.contains(name)) {
        let names = names.join(", ");
        return Err(format!(
            "{name:?} is none of {names}; give a list of these, all or none"
        ));
    }
    let is_listed = |of: &T| listed.contains(&of.to_string());
    Ok(all.into_iter().filter(is_listed).collect())
}

impl NoiseSd {
    /// What was stated, N; none if nothing was. The parser has refused all but one for both, one for each, or none.
    pub fn get(&self) -> Option<Force<f64>> {
        let both = self.noise_sd_n.map(|sd| Force::new(sd, sd));
        let each = self.noise_sd_lateral_n.zip(self.noise_sd_normal_n);
        both.or(each.map(|(lateral, normal)| Force::new(lateral, normal)))
    }
}

impl CriterionArguments {
    fn of_name(&self) -> CriterionName {
        self.criterion.unwrap_or(CriterionName::Map)
    }

    /// The name of the criterion.
    pub fn name(&self) -> String {
        let name = self.of_name().to_possible_value();
        name.map_or(String::new(), |name| name.get_name().into())
    }

    /// The criterion with its rate.
    ///
    /// Implements: CLI-042.
    pub fn criterion(&self) -> Result<Criterion, CliError> {
        use CriterionName::{Map, NeymanPearsonFalseAlarm, NeymanPearsonMiss};
        let needs = match (self.of_name(), self.max_miss, self.max_false_alarm) {
            (Map, None, None) => return Ok(Criterion::MaximumAPosteriori),
            (NeymanPearsonMiss, Some(max_miss), None) => {
                return Ok(Criterion::NeymanPearsonMiss { max_miss });
            }
            (NeymanPearsonFalseAlarm, None, Some(max_false_alarm)) => {
                return Ok(Criterion::NeymanPearsonFalseAlarm { max_false_alarm });
            }
            (Map, ..) => "takes neither --max-miss nor --max-false-alarm",
            (NeymanPearsonMiss, ..) => "needs --max-miss and takes no --max-false-alarm",
            (NeymanPearsonFalseAlarm, ..) => "needs --max-false-alarm and takes no --max-miss",
        };
        refuse!("--criterion {} {needs}", self.name())
    }
}

impl NoiseArguments {
    /// What is known with the exact model.
    pub fn known(&self) -> Result<Known, CliError> {
        let known = Known::parse(self.known.as_deref().unwrap_or("depth"));
        known.or_else(|error| refuse!("--known {error}"))
    }

    /// What does not disturb the sweep, with the robust model.
    ///
    /// Implements: ROB-050.
    pub fn undisturbed(&self) -> Result<Vec<Part>, CliError> {
        let known = listed(self.known.as_deref().unwrap_or("none"), Part::KNOWN);
        known.or_else(|error| refuse!("--known {error}"))
    }

    /// The noise as it was stated or is to be estimated, from a blank sweep in this layout.
    ///
    /// Implements: CLI-041.
    pub fn noise(&self, layout: &Layout) -> Result<Noise, CliError> {
        let sd = self.noise_sd.get();
        let of = |correlation| Noise { sd, correlation };
        let noise = match &*self.noise {
            "auto" => of(Correlation::OfRecord),
            "white" => of(Correlation::None),
            file => {
                let blank = Trace::read(Path::new(file), layout)?;
                blank.notes().iter().for_each(|text| note(file, text));
                let blank = Noise::of_blank(&blank)?;
                let sd = sd.or(blank.sd);
                Noise { sd, ..blank }
            }
        };
        Ok(noise)
    }
}
