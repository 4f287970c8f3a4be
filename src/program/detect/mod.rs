//! `palpate detect`: a recorded sweep against two force maps (`spec/command-line.md`).

mod answer;
pub mod arguments;

use std::fmt::Display;
use std::path::{Path, PathBuf};

use serde_json::json;

use super::output::{note, print, write};
use super::{CliError, Format};
use answer::DetectAnswer;
pub use arguments::DetectArguments;
use palpate::bank::{Bank, BankSearch};
use palpate::chart::place_figure;
use palpate::detect::Decision;
use palpate::force_map::{ForceMap, ForceTable, Hypotheses};
use palpate::refusal::one_line;
use palpate::trace::{Cause, Fit, Motion, Question, Record, Trace, Unknown, in_words};

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
    answer.tell("unknown", json!(arguments.unknown.0));
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
/// Implements: CLI-040, CLI-043, CLI-003, CLI-048, CLI-055, CLI-017, CLI-140, CLI-143, CLI-146.
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
    let mut found = match &arguments.bank {
        Some(path) => by_bank(arguments, record, path, &mut warnings)?,
        None => by_maps(arguments, record, &mut warnings)?,
    };
    found.answer.tell("warnings", warnings.0);
    print(&match arguments.format {
        Format::Table => format!(
            "{}\n{}\n",
            found.answer.table,
            conclusion(&arguments.unknown.0, &found)
        ),
        Format::Json => found.answer.json(),
    })?;
    match found.decision {
        Some(_) => Ok(()),
        None => {
            let (file, why) = (arguments.trace.display(), reasons(&found.causes));
            let why = format!("{file}: cannot be judged: {why}");
            Err(CliError::Unjudged(why))
        }
    }
}

/// What a record says.
struct Found {
    answer: DetectAnswer,
    decision: Option<Decision>,
    causes: Vec<Cause>,
    fit: Fit,
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
    })
}

/// The record searched for any inclusion of a bank.
///
/// Implements: CLI-140, CLI-040, CLI-163.
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
    })
}

/// What was decided, whether the record fits, and what was assumed.
///
/// Implements: CLI-043.
fn conclusion(unknown: &[Unknown], found: &Found) -> String {
    let fits = match found.fit.limits {
        None => "in the noise that the record itself shows",
        Some(_) => "in a record that fits the noise stated",
    };
    let decided = match found.decision {
        Some(Decision::Inclusion) => format!("An inclusion was found, {fits}"),
        Some(Decision::NoInclusion) => format!("No inclusion was found, {fits}"),
        None => format!("The record cannot be judged: {}", reasons(&found.causes)),
    };
    let names = |is_known: bool| {
        let of = Unknown::ALL.into_iter();
        let of = of.filter(|of| is_known != unknown.contains(of));
        in_words(&of.collect::<Vec<_>>())
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
