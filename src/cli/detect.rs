//! `palpate detect`: a recorded sweep against two force maps (`spec/detect-command.md`).

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};

use super::detection::DetectAnswer;
use super::output::print;
use super::{CliError, Format};
use crate::decimal::parse_scaled;
use crate::force::Force;
use crate::force_map::{ForceMap, Hypotheses};
use crate::report::text;
use crate::trace::{Criterion, DIED_AWAY, Location, Motion, Question, Record, Trace};

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
    /// Standard deviation of the noise of one sample in N, both channels
    #[arg(long, value_name = "S", value_parser = newtons, allow_hyphen_values = true,
          conflicts_with_all = ["noise_sd_lateral_n", "noise_sd_normal_n"],
          required_unless_present_all = ["noise_sd_lateral_n", "noise_sd_normal_n"])]
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

    /// Implements: CLI-041.
    fn noise_sd(&self) -> Force<f64> {
        // The parser has refused all but one for both or one for each; of 0 the detector would.
        let of = |channel: Option<f64>| self.noise_sd_n.or(channel).unwrap_or(0.0);
        Force {
            lateral: of(self.noise_sd_lateral_n),
            normal: of(self.noise_sd_normal_n),
        }
    }
}

/// What was asked.
fn asked(arguments: &DetectArguments, samples: usize, noise_sd: Force<f64>) -> DetectAnswer {
    let mut answer = DetectAnswer::default();
    answer.tell("schema", "palpate-detection");
    answer.tell("schema_version", 1);
    answer.tell("program_version", env!("CARGO_PKG_VERSION"));
    let path = |path: &Path| path.display().to_string();
    answer.tell("trace", path(&arguments.trace));
    answer.tell("reference", path(&arguments.reference));
    answer.tell("inclusion", path(&arguments.inclusion));
    answer.tell("samples", samples);
    answer.tell("depth_m", arguments.depth_mm);
    answer.tell("noise_sd_lateral_n", noise_sd.lateral);
    answer.tell("noise_sd_normal_n", noise_sd.normal);
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
/// Implements: CLI-040, CLI-043, CLI-044, CLI-046, CLI-048, CLI-055.
pub fn detect(arguments: &DetectArguments) -> Result<(), CliError> {
    let (criterion, noise_sd) = (arguments.criterion()?, arguments.noise_sd());
    let motion = arguments.velocity_mm_s.zip(arguments.start_mm);
    let motion = motion.map(|(velocity, start)| Motion { velocity, start });
    let record = Trace::read(&arguments.trace)?.record(motion)?;
    let (reference, inclusion) = (map(&arguments.reference)?, map(&arguments.inclusion)?);
    let question = Question {
        hypotheses: hypotheses(arguments, &reference, &inclusion)?,
        depth: arguments.depth_mm,
        noise_sd,
        criterion,
        prior_h1: arguments.prior_h1,
    };
    let mut answer = asked(arguments, record.positions().len(), noise_sd);
    let misfit = if arguments.scan {
        let found = question.locate(&record)?;
        warn_of_broad_signal(&found, &record);
        warn_of_other_place(&inclusion, &arguments.inclusion);
        answer.located(&found);
        found.misfit
    } else {
        let found = question.judge(&record)?;
        answer.judged(&found);
        found.misfit
    };
    answer.misfit(&misfit);
    if misfit.is_too_large() {
        let (file, chi_square, limit) = (record.file(), misfit.chi_square, misfit.limit);
        eprintln!(
            "palpate: warning: {file}: the record fits neither map: chi-square {chi_square:.1}, expected at most {limit:.1}: depth, noise or maps are probably not those of the sweep, and the decision means little"
        );
    }
    print(&match arguments.format {
        Format::Table => answer.table,
        Format::Json => answer.json(),
    })
}

/// Implements: TRC-042.
fn warn_of_broad_signal(found: &Location, record: &Record) {
    if found.template_edge > DIED_AWAY {
        let (file, share) = (record.file(), 100.0 * found.template_edge);
        eprintln!(
            "palpate: warning: {file}: the signal at an end of the maps is still {share:.0} % of its largest: the position is drawn towards the maps' x = 0, which its sd does not count"
        );
    }
}

/// Implements: CLI-043.
fn warn_of_other_place(inclusion: &ForceMap, path: &Path) {
    let inclusions = inclusion.phantom().into_iter();
    let inclusions = inclusions.flat_map(|of| &of.inclusions);
    let middles = inclusions.map(|inclusion| {
        let [left, right, ..] = inclusion.extent();
        text::millimetres(0.5 * (left + right))
    });
    let middles: Vec<String> = middles.collect();
    if middles.iter().any(|x| x != "0") {
        let (file, middles) = (path.display(), middles.join(", "));
        eprintln!(
            "palpate: warning: {file}: the position is where x = 0 of this map lies; its phantom has inclusions at x = {middles} mm"
        );
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
) -> Result<Hypotheses<'a>, CliError> {
    let file = arguments.inclusion.display();
    let any = Hypotheses::of_tables(reference.table(), inclusion.table());
    let any = any.map_err(|error| error.in_file(file.to_string()))?;
    match Hypotheses::new(reference, inclusion) {
        Ok(hypotheses) => Ok(hypotheses),
        Err(error) if arguments.any_maps => {
            eprintln!("palpate: warning: {file}: {error}");
            Ok(any)
        }
        Err(error) => {
            let hint = format!("{error} (or use --any-maps)");
            Err(CliError::refused(file)(hint))
        }
    }
}
