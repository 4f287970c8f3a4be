//! `palpate detect`: a recorded sweep against two force maps (`spec/detect-command.md`).

use std::fmt::Display;
use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};

use super::detection::DetectAnswer;
use super::output::{note, print};
use super::{CliError, Format};
use crate::decimal::parse_scaled;
use crate::detect::Decision;
use crate::force::Force;
use crate::force_map::{ForceMap, Hypotheses};
use crate::refusal::one_line;
use crate::report::text;
use crate::trace::{
    Cause, Correlation, Criterion, DIED_AWAY, Fit, Location, Motion, Noise, Question, Record,
    Trace, Unknown,
};

/// Arguments of `palpate detect`.
#[derive(Debug, Args)]
pub struct DetectArguments {
    /// The recorded sweep: a header with position_mm (or time_s), lateral_force_n, normal_force_n, and a row for each sample
    #[arg(value_name = "TRACE.csv")]
    trace: PathBuf,
    /// The force map without inclusion: JSON as 'palpate solve --phantom none --format json' prints it, or measured CSV
    #[arg(long, value_name = "MAP")]
    reference: PathBuf,
    /// The force map with the inclusion; --scan says where its x = 0 lies
    #[arg(long, value_name = "MAP")]
    inclusion: PathBuf,
    /// Takes maps of different gels, meshes or versions of the program, and of any inclusions, and says so
    #[arg(long)]
    any_maps: bool,
    /// The constant depth of the sweep in mm
    #[arg(long, value_name = "D", value_parser = millimetres, allow_hyphen_values = true)]
    depth_mm: f64,
    /// The true depth is within so many mm of that
    #[arg(long, value_name = "T", value_parser = at_least_0, allow_hyphen_values = true, default_value = "0.3")]
    depth_tolerance_mm: f64,
    /// What is known, and not fitted to the record: a list of offset, drift, gain, depth and variance (of the noise); all; none
    #[arg(long = "known", value_name = "LIST", value_parser = unknowns, default_value = "depth")]
    unknown: Unknowns,
    /// Which samples are independent: auto (the record tells), white (all), or a recorded sweep without contact that tells
    #[arg(long, value_name = "auto|white|FILE", default_value = "auto")]
    noise: String,
    /// Standard deviation of the noise of one sample in N, both channels; without it the record tells
    #[arg(long, value_name = "S", value_parser = newtons, allow_hyphen_values = true,
          conflicts_with_all = ["noise_sd_lateral_n", "noise_sd_normal_n"])]
    noise_sd_n: Option<f64>,
    /// Standard deviation of the noise of one lateral sample in N
    #[arg(long, value_name = "S", value_parser = newtons, allow_hyphen_values = true, requires = "noise_sd_normal_n")]
    noise_sd_lateral_n: Option<f64>,
    /// Standard deviation of the noise of one normal sample in N
    #[arg(long, value_name = "S", value_parser = newtons, allow_hyphen_values = true, requires = "noise_sd_lateral_n")]
    noise_sd_normal_n: Option<f64>,
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
    /// Searches for the lateral position of the inclusion; without it the inclusion would lie at x = 0
    #[arg(long)]
    scan: bool,
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
struct Unknowns(Vec<Unknown>);

/// What is unknown where `text` lists what is known.
///
/// Implements: CLI-140.
fn unknowns(text: &str) -> Result<Unknowns, String> {
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

fn newtons(text: &str) -> Result<f64, String> {
    parse_scaled(text, 0)
        .filter(|&noise| noise > 0.0)
        .ok_or_else(|| "expected N above 0, such as 0.1".into())
}

fn probability(text: &str) -> Result<f64, String> {
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
        // The parser has refused all but one for both, one for each, or none.
        let both = self.noise_sd_n.map(|sd| Force::new(sd, sd));
        let each = self.noise_sd_lateral_n.zip(self.noise_sd_normal_n);
        let sd = both.or(each.map(|(lateral, normal)| Force::new(lateral, normal)));
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
fn asked(arguments: &DetectArguments, samples: usize) -> DetectAnswer {
    let mut answer = DetectAnswer::default();
    answer.tell("schema", "palpate-detection");
    answer.tell("schema_version", 2);
    answer.tell("program_version", env!("CARGO_PKG_VERSION"));
    let path = |path: &Path| path.display().to_string();
    answer.tell("trace", path(&arguments.trace));
    answer.tell("reference", path(&arguments.reference));
    answer.tell("inclusion", path(&arguments.inclusion));
    answer.tell("samples", samples);
    answer.tell("depth_m", arguments.depth_mm);
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
    let mut record = trace.record(motion)?;
    let (reference, inclusion) = (map(&arguments.reference)?, map(&arguments.inclusion)?);
    if arguments.trim {
        let left_out;
        (record, left_out) = record.trimmed(reference.table())?;
        left_out.iter().for_each(|text| note(record.file(), text));
    }
    let mut warnings = Warnings::default();
    if arguments.depth_tolerance_mm > 0.0
        && !arguments.unknown.0.contains(&Unknown::Depth)
        && reference.table().depths().len() == 1
    {
        let text = "a single depth: what another depth within its tolerance does is not counted";
        warnings.tell("single_depth", arguments.reference.display(), text);
    }
    let question = Question {
        hypotheses: hypotheses(arguments, &reference, &inclusion, &mut warnings)?,
        depth: arguments.depth_mm,
        depth_tolerance: arguments.depth_tolerance_mm,
        unknown: &arguments.unknown.0,
        noise: arguments.noise()?,
        criterion: arguments.criterion()?,
        prior_h1: arguments.prior_h1,
    };
    let mut answer = asked(arguments, record.positions().len());
    let (decision, causes, fit) = if arguments.scan {
        let found = question.locate(&record)?;
        warnings.of_broad_signal(&found, &record);
        warnings.of_other_place(&inclusion, &arguments.inclusion);
        answer.located(&found);
        (found.decision, found.causes, found.fit)
    } else {
        let found = question.judge(&record)?;
        answer.judged(&found);
        (found.decision, found.causes, found.fit)
    };
    answer.tell("warnings", warnings.0);
    let last = conclusion(&question, decision, &causes, &fit);
    print(&match arguments.format {
        Format::Table => format!("{}\n{last}\n", answer.table),
        Format::Json => answer.json(),
    })?;
    match decision {
        Some(_) => Ok(()),
        None => {
            let (file, why) = (record.file(), reasons(&causes));
            Err(CliError::Unjudged(format!(
                "{file}: cannot be judged: {why}"
            )))
        }
    }
}

/// What was decided, whether the record fits, and what was assumed.
///
/// Implements: CLI-144.
fn conclusion(
    question: &Question<'_>,
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
            .filter(|of| is_known != question.unknown.contains(of));
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

    /// Implements: TRC-042.
    fn of_broad_signal(&mut self, found: &Location, record: &Record) {
        if found.template_edge > DIED_AWAY {
            let share = 100.0 * found.template_edge;
            let text = format!(
                "the signal at an end of the maps is still {share:.0} % of its largest: the position may be off by much more than its sd says"
            );
            self.tell("template_edge", record.file(), &text);
        }
    }

    /// Implements: CLI-044.
    fn of_other_place(&mut self, inclusion: &ForceMap, path: &Path) {
        let inclusions = inclusion.phantom().into_iter();
        let inclusions = inclusions.flat_map(|of| &of.inclusions);
        let middles = inclusions.map(|inclusion| {
            let [left, right, ..] = inclusion.extent();
            text::millimetres(0.5 * (left + right))
        });
        let middles: Vec<String> = middles.collect();
        if middles.iter().any(|x| x != "0") {
            let middles = middles.join(", ");
            let text = format!(
                "the position is where x = 0 of this map lies; its phantom has inclusions at x = {middles} mm"
            );
            self.tell("off_axis", path.display(), &text);
        }
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
    arguments: &DetectArguments,
    reference: &'a ForceMap,
    inclusion: &'a ForceMap,
    warnings: &mut Warnings,
) -> Result<Hypotheses<'a>, CliError> {
    let file = arguments.inclusion.display();
    let any = Hypotheses::of_tables(reference.table(), inclusion.table());
    let any = any.map_err(|error| error.in_file(file.to_string()))?;
    match Hypotheses::new(reference, inclusion) {
        Ok(hypotheses) => Ok(hypotheses),
        Err(error) if arguments.any_maps => {
            warnings.tell("any_maps", file, &error.to_string());
            Ok(any)
        }
        Err(error) => {
            let hint = format!("{error} (or use --any-maps)");
            Err(CliError::refused(file)(hint))
        }
    }
}
