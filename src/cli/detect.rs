//! `palpate detect`: a recorded sweep against two force maps (`spec/detect-command.md`).

use std::fmt::Display;
use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};

use super::detection::DetectAnswer;
use super::output::{note, print, write};
use super::{CliError, Format};
use crate::bank::{Bank, BankSearch};
use crate::decimal::parse_scaled;
use crate::detect::Decision;
use crate::force::Force;
use crate::force_map::{ForceMap, ForceTable, Hypotheses};
use crate::refusal::one_line;
use crate::report::place_figure;
use crate::trace::{
    Cause, Correlation, Criterion, Fit, Motion, Noise, Question, Record, Trace, Unknown,
};

/// Arguments of `palpate detect`.
#[derive(Debug, Args)]
pub struct DetectArguments {
    /// The recorded sweep: a header with position_mm (or time_s), lateral_force_n, normal_force_n, and a row for each sample
    #[arg(value_name = "TRACE.csv")]
    trace: PathBuf,
    /// The force map without inclusion: JSON as 'palpate solve --phantom none --format json' prints it, or measured CSV
    #[arg(
        long,
        value_name = "MAP",
        requires = "inclusion",
        required_unless_present = "bank"
    )]
    reference: Option<PathBuf>,
    /// The force map with the inclusion, where that map has it
    #[arg(
        long,
        value_name = "MAP",
        requires = "reference",
        required_unless_present = "bank"
    )]
    inclusion: Option<PathBuf>,
    /// A bank of inclusions, as 'palpate bank' makes it: says whether one of them is there, and where it lies
    #[arg(long, value_name = "BANK", conflicts_with_all = ["reference", "inclusion", "any_maps"])]
    bank: Option<PathBuf>,
    /// The probability of each inclusion of the bank given that there is one: a CSV file with position_mm, depth_mm, diameter_mm,
    /// youngs_modulus_kpa and weight [default: all the same]
    #[arg(
        long,
        value_name = "FILE",
        requires = "bank",
        conflicts_with = "reference"
    )]
    prior: Option<PathBuf>,
    /// Sets the threshold for neyman-pearson-false-alarm with a bank by so many simulated records, and not by a bound
    #[arg(
        long,
        value_name = "N",
        requires = "bank",
        conflicts_with = "reference"
    )]
    simulations: Option<u64>,
    /// The seed of these simulations
    #[arg(
        long,
        value_name = "SEED",
        requires = "simulations",
        default_value = "1999"
    )]
    seed: u64,
    /// Takes maps of different gels, meshes or versions of the program, and of any inclusions, and says so
    #[arg(long)]
    any_maps: bool,
    /// The constant depth of the sweep in mm [default with a bank: that of the bank]
    #[arg(long, value_name = "D", value_parser = millimetres, allow_hyphen_values = true, required_unless_present = "bank")]
    depth_mm: Option<f64>,
    /// The true depth is within so many mm of that
    #[arg(long, value_name = "T", value_parser = at_least_0, allow_hyphen_values = true, default_value = "0.3")]
    depth_tolerance_mm: f64,
    /// What is known, and not fitted to the record: a list of offset, drift, gain, depth and variance (of the noise); all; none
    #[arg(long = "known", value_name = "LIST", value_parser = unknowns, default_value = "depth")]
    unknown: Unknowns,
    /// Which samples are independent: auto (the record tells), white (all), or a recorded sweep without contact that tells; the
    /// same tells the noise of a sample where it is not stated
    #[arg(long, value_name = "auto|white|FILE", default_value = "auto")]
    noise: String,
    #[command(flatten)]
    noise_sd: NoiseSd,
    /// Probability of an inclusion before the sweep
    #[arg(long, value_name = "P", value_parser = probability, allow_hyphen_values = true, default_value = "0.5")]
    prior_h1: f64,
    /// What the threshold shall achieve
    #[arg(long, value_enum, default_value_t = CriterionName::Map)]
    criterion: CriterionName,
    /// Largest rate of misses, for neyman-pearson-miss
    #[arg(long, value_name = "B", value_parser = probability, allow_hyphen_values = true)]
    max_miss: Option<f64>,
    /// Largest rate of false alarms, for neyman-pearson-false-alarm
    #[arg(long, value_name = "A", value_parser = probability, allow_hyphen_values = true)]
    max_false_alarm: Option<f64>,
    /// Leaves out the samples outside the lateral positions of the maps, and says how many
    #[arg(long)]
    trim: bool,
    /// Velocity of the probe in mm/s, for a trace over time
    #[arg(long, value_name = "V", value_parser = millimetres, allow_hyphen_values = true, requires = "start_mm")]
    velocity_mm_s: Option<f64>,
    /// Lateral position of the probe at time 0 in mm, for a trace over time
    #[arg(long, value_name = "X0", value_parser = millimetres, allow_hyphen_values = true, requires = "velocity_mm_s")]
    start_mm: Option<f64>,
    /// How the answer is printed
    #[arg(long, value_enum, default_value_t = Format::Table)]
    format: Format,
    /// Writes a figure of where the inclusion lies, if there is one, as SVG
    #[arg(
        long,
        value_name = "FILE",
        requires = "bank",
        conflicts_with = "reference"
    )]
    figure: Option<PathBuf>,
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
    /// A bound on misses.
    NeymanPearsonMiss,
    /// A bound on false alarms.
    NeymanPearsonFalseAlarm,
}

/// What is unknown of a sweep.
#[derive(Debug, Clone)]
pub(super) struct Unknowns(pub Vec<Unknown>);

/// What is unknown where `text` lists what is known.
///
/// Implements: CLI-140.
pub(super) fn unknowns(text: &str) -> Result<Unknowns, String> {
    let known: Vec<&str> = match text {
        "none" => Vec::new(),
        "all" => Unknown::ALL.map(Unknown::name).into(),
        list => list.split(',').map(str::trim).collect(),
    };
    match known
        .iter()
        .find(|name| Unknown::ALL.iter().all(|of| of.name() != **name))
    {
        Some(name) => Err(format!(
            "{name:?} is none of {}, all and none",
            Unknown::ALL.map(Unknown::name).join(", ")
        )),
        None => Ok(Unknowns(
            Unknown::ALL
                .into_iter()
                .filter(|of| !known.contains(&of.name()))
                .collect(),
        )),
    }
}

fn at_least_0(text: &str) -> Result<f64, String> {
    parse_scaled(text, -3)
        .filter(|&length| length >= 0.0)
        .ok_or_else(|| "expected mm, at least 0, such as 0.3".into())
}

fn millimetres(text: &str) -> Result<f64, String> {
    parse_scaled(text, -3).ok_or_else(|| "expected a finite number, such as 2.5".into())
}

pub(super) fn newtons(text: &str) -> Result<f64, String> {
    parse_scaled(text, 0)
        .filter(|&noise| noise > 0.0)
        .ok_or_else(|| "expected N above 0, such as 0.1".into())
}

pub(super) fn probability(text: &str) -> Result<f64, String> {
    parse_scaled(text, 0)
        .filter(|&probability| probability > 0.0 && probability < 1.0)
        .ok_or_else(|| "expected a probability strictly between 0 and 1".into())
}

impl DetectArguments {
    fn criterion_name(&self) -> String {
        let name = self.criterion.to_possible_value();
        name.map_or(String::new(), |name| name.get_name().into())
    }

    /// Implements: CLI-042.
    fn criterion(&self) -> Result<Criterion, CliError> {
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

    /// Implements: CLI-041, CLI-141, CLI-142.
    fn noise(&self) -> Result<Noise, CliError> {
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

/// What was asked.
fn asked(arguments: &DetectArguments, depth: f64, samples: usize) -> DetectAnswer {
    let mut answer = DetectAnswer::default();
    answer.tell("schema", "palpate-detection");
    answer.tell("schema_version", 3);
    answer.tell("program_version", env!("CARGO_PKG_VERSION"));
    let path = |path: &Path| path.display().to_string();
    answer.tell("trace", path(&arguments.trace));
    let files = [
        ("reference", &arguments.reference),
        ("inclusion", &arguments.inclusion),
        ("bank", &arguments.bank),
        ("prior", &arguments.prior),
    ];
    for (key, file) in files {
        file.iter().for_each(|file| answer.tell(key, path(file)));
    }
    answer.tell("samples", samples);
    answer.tell("depth_m", depth);
    answer.tell("depth_tolerance_m", arguments.depth_tolerance_mm);
    let unknown = arguments.unknown.0.iter().map(|of| of.name());
    answer.tell("unknown", unknown.collect::<Vec<_>>());
    answer.tell("noise", &*arguments.noise);
    answer.tell("prior_h1", arguments.prior_h1);
    answer.tell("criterion", arguments.criterion_name());
    let bounds = [
        ("max_miss", arguments.max_miss),
        ("max_false_alarm", arguments.max_false_alarm),
    ];
    for (key, bound) in bounds {
        bound.into_iter().for_each(|rate| answer.tell(key, rate));
    }
    answer
}

/// Runs the command.
///
/// Implements: CLI-040, CLI-043, CLI-044, CLI-046, CLI-048, CLI-055, CLI-056, CLI-057, CLI-143, CLI-145.
pub fn detect(arguments: &DetectArguments) -> Result<(), CliError> {
    let motion = arguments.velocity_mm_s.zip(arguments.start_mm);
    let motion = motion.map(|(velocity, start)| Motion { velocity, start });
    let trace = Trace::read(&arguments.trace)?;
    trace
        .notes()
        .iter()
        .for_each(|text| note(arguments.trace.display(), text));
    let record = trace.record(motion)?;
    let mut warnings = Warnings::default();
    let found = match &arguments.bank {
        Some(path) => by_bank(arguments, record, path, &mut warnings)?,
        None => by_maps(arguments, record, &mut warnings)?,
    };
    let Found {
        mut answer,
        decision,
        causes,
        fit,
        file,
    } = found;
    answer.tell("warnings", warnings.0);
    let last = conclusion(&arguments.unknown.0, decision, &causes, &fit);
    print(&match arguments.format {
        Format::Table => format!("{}\n{last}\n", answer.table),
        Format::Json => answer.json(),
    })?;
    match decision {
        Some(_) => Ok(()),
        None => {
            let why = reasons(&causes);
            Err(CliError::Unjudged(format!(
                "{file}: cannot be judged: {why}"
            )))
        }
    }
}

/// What a record says.
struct Found {
    answer: DetectAnswer,
    decision: Option<Decision>,
    causes: Vec<Cause>,
    fit: Fit,
    /// The name of the record.
    file: String,
}

/// The record without the samples outside `map`, if that was asked for.
fn trimmed(
    arguments: &DetectArguments,
    record: Record,
    map: &ForceTable,
) -> Result<Record, CliError> {
    if !arguments.trim {
        return Ok(record);
    }
    let (record, left_out) = record.trimmed(map)?;
    left_out.iter().for_each(|text| note(record.file(), text));
    Ok(record)
}

/// What is asked of a sweep at `depth` over a gel whose forces `reference` has, read from `file`.
fn question<'a>(
    arguments: &'a DetectArguments,
    depth: f64,
    reference: &ForceTable,
    file: &Path,
    warnings: &mut Warnings,
) -> Result<Question<'a>, CliError> {
    if arguments.depth_tolerance_mm > 0.0
        && !arguments.unknown.0.contains(&Unknown::Depth)
        && reference.depths().len() == 1
    {
        let text = "a single depth: what another depth within its tolerance does is not counted";
        warnings.tell("single_depth", file.display(), text);
    }
    Ok(Question {
        depth,
        depth_tolerance: arguments.depth_tolerance_mm,
        unknown: &arguments.unknown.0,
        noise: arguments.noise()?,
        criterion: arguments.criterion()?,
        prior_h1: arguments.prior_h1,
    })
}

/// The record judged where two maps have the inclusion.
fn by_maps(
    arguments: &DetectArguments,
    record: Record,
    warnings: &mut Warnings,
) -> Result<Found, CliError> {
    // The parser has refused all but a bank or both maps with a depth.
    let (none, path) = (PathBuf::new(), &arguments.inclusion);
    let [reference_path, path] = [&arguments.reference, path].map(|p| p.as_ref().unwrap_or(&none));
    let (reference, inclusion) = (map(reference_path)?, map(path)?);
    let depth = arguments.depth_mm.unwrap_or(0.0);
    let record = trimmed(arguments, record, reference.table())?;
    let question = question(
        arguments,
        depth,
        reference.table(),
        reference_path,
        warnings,
    )?;
    let hypotheses = hypotheses(arguments.any_maps, path, &reference, &inclusion, warnings)?;
    let found = question.judge(hypotheses, &record)?;
    let mut answer = asked(arguments, depth, record.positions().len());
    answer.judged(&found);
    Ok(Found {
        answer,
        decision: found.decision,
        causes: found.causes,
        fit: found.fit,
        file: record.file().into(),
    })
}

/// The record searched for any inclusion of a bank.
///
/// Implements: CLI-150, CLI-151, CLI-152, CLI-163.
fn by_bank(
    arguments: &DetectArguments,
    record: Record,
    path: &Path,
    warnings: &mut Warnings,
) -> Result<Found, CliError> {
    let bank = Bank::read(path)?;
    let depth = arguments.depth_mm.unwrap_or(bank.depth());
    let record = trimmed(arguments, record, bank.reference().table())?;
    let prior = arguments.prior.as_ref();
    let prior = prior.map(|file| bank.read_prior(file)).transpose()?;
    let search = BankSearch {
        question: question(arguments, depth, bank.reference().table(), path, warnings)?,
        bank: &bank,
        prior: prior.as_deref(),
        simulations: arguments.simulations.map(|number| (number, arguments.seed)),
    };
    let found = search.locate(&record)?;
    if let Some(path) = &arguments.figure {
        write(path, &place_figure(&bank, &found.place)?)?;
    }
    let mut answer = asked(arguments, depth, record.positions().len());
    answer.located(&bank, &found)?;
    Ok(Found {
        answer,
        decision: found.decision,
        causes: found.causes,
        fit: found.fit,
        file: record.file().into(),
    })
}

/// What was decided, whether the record fits, and what was assumed.
///
/// Implements: CLI-144.
fn conclusion(
    unknown: &[Unknown],
    decision: Option<Decision>,
    causes: &[Cause],
    fit: &Fit,
) -> String {
    let fits = match fit.limits {
        None => "in the noise that the record itself shows",
        Some(_) => "in a record that fits the noise stated",
    };
    let decided = match decision {
        Some(Decision::Inclusion) => format!("An inclusion was found, {fits}"),
        Some(Decision::NoInclusion) => format!("No inclusion was found, {fits}"),
        None => format!("The record cannot be judged: {}", reasons(causes)),
    };
    let names = |is_known: bool| {
        let of = Unknown::ALL
            .into_iter()
            .filter(|of| is_known != unknown.contains(of));
        let names: Vec<_> = of.map(Unknown::name).collect();
        if names.is_empty() {
            "nothing".into()
        } else {
            names.join(", ")
        }
    };
    let (known, fitted) = (names(true), names(false));
    format!("{decided}; taken as known: {known}; fitted: {fitted}.")
}

fn reasons(causes: &[Cause]) -> String {
    let causes: Vec<_> = causes.iter().map(Cause::to_string).collect();
    causes.join("; ")
}

/// The codes of the warnings.
#[derive(Default)]
struct Warnings(Vec<&'static str>);

impl Warnings {
    /// Implements: CLI-146.
    fn tell(&mut self, code: &'static str, file: impl Display, text: &str) {
        eprintln!("palpate: warning: {}", one_line(&format!("{file}: {text}")));
        self.0.push(code);
    }
}

fn map(path: &Path) -> Result<ForceMap, CliError> {
    if path.exists() {
        return Ok(ForceMap::read(path)?);
    }
    // A built-in phantom has a name elsewhere, but its forces depend on depths and mesh.
    let hint = "no such force map; 'palpate solve --phantom none --depths-mm ... --laterals-mm ... --format json' makes one";
    Err(CliError::refused(path.display())(hint))
}

/// Refuses maps of which one is not the other with an inclusion, or tells of them where they are meant.
///
/// Implements: CLI-047.
fn hypotheses<'a>(
    any_maps: bool,
    file: &Path,
    reference: &'a ForceMap,
    inclusion: &'a ForceMap,
    warnings: &mut Warnings,
) -> Result<Hypotheses<'a>, CliError> {
    let file = file.display();
    let any = Hypotheses::of_tables(reference.table(), inclusion.table());
    let any = any.map_err(|error| error.in_file(file.to_string()))?;
    match Hypotheses::new(reference, inclusion) {
        Ok(hypotheses) => Ok(hypotheses),
        Err(error) if any_maps => {
            warnings.tell("any_maps", file, &error.to_string());
            Ok(any)
        }
        Err(error) => {
            let hint = format!("{error} (or use --any-maps)");
            Err(CliError::refused(file)(hint))
        }
    }
}
