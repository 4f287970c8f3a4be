//! `palpate detect`: a recorded sweep against two force maps or a bank (`spec/command-line.md`).

pub mod arguments;
mod many;
mod records;
mod robust;

use std::fmt::Display;
use std::path::{Path, PathBuf};

use anstyle::AnsiColor;
use serde_json::json;

use super::CliError;
use super::error::refuse;
use super::output::{Envelope, marked, note, warn, write};
pub use arguments::DetectArguments;
use arguments::{Known, ModelName};
use palpate::bank::{Bank, BankSearch};
use palpate::chart::place_figure;
use palpate::csv::Layout;
use palpate::detect::Decision;
use palpate::force_map::{ForceMap, ForceTable, Hypotheses};
use palpate::rows::Rows;
use palpate::text::extremes;
use palpate::trace::{
    Cause, Criterion, Fit, Motion, Noise, Question, Record, Trace, in_words, reasons,
};

/// The largest error of the depth that is assumed, m.
const DEPTH_TOLERANCE: f64 = 0.3e-3;

/// Runs the command.
///
/// Implements: CLI-040, CLI-043, CLI-003, CLI-048, CLI-055, CLI-017, CLI-140, CLI-143, CLI-146.
pub fn detect(arguments: &DetectArguments) -> Result<(), CliError> {
    robust::check_options(arguments)?;
    let layout = arguments.sweep.layout.get()?;
    if arguments.model.model == ModelName::Robust {
        return robust::detect(arguments, &layout);
    }
    // There is one, as has been checked.
    let record = read(arguments, &layout, &arguments.traces[0])?;
    let noise = arguments.noise.noise(&layout)?;
    match &arguments.hypotheses.bank {
        Some(path) => by_bank(arguments, record, noise, path),
        None => by_maps(arguments, record, noise),
    }
}

/// The record in a file, or of standard input for `-`.
///
/// Implements: CLI-175, CLI-201.
fn read(arguments: &DetectArguments, layout: &Layout, path: &Path) -> Result<Noted, CliError> {
    let trace = if path == Path::new("-") {
        let text = palpate::file::text_of(std::io::stdin());
        let text = text.map_err(CliError::file("read", Path::new("standard input")))?;
        Trace::from_csv_as(&text, "-", layout)?
    } else {
        Trace::read(path, layout)?
    };
    let notes = trace.notes().to_vec();
    let motion = arguments.sweep.velocity.zip(arguments.sweep.start);
    let mut record = trace.record(motion.map(|(velocity, start)| Motion { velocity, start }))?;
    if let Some(sd) = arguments.sweep.depth_noise {
        record = record.with_depth_sd(sd)?;
    }
    Ok((record, notes))
}

/// Checks that each sample of a record has one depth: its own, that of --depth-mm or else the only one of the `bank`.
///
/// Implements: CLI-200.
fn check_depths(
    arguments: &DetectArguments,
    (record, _): &Noted,
    bank: Option<&Bank>,
) -> Result<(), CliError> {
    let (file, is_given) = (record.file(), !arguments.sweep.depths.is_empty());
    let of_bank = bank.map_or(0, |bank| bank.probe_depths().len());
    match record.depths() {
        Some(_) if is_given => refuse!("{file}: each sample has its depth; leave out --depth-mm"),
        None if !is_given && of_bank == 0 => {
            refuse!("{file}: the samples have no depths; give --depth-mm, or a column depth_mm")
        }
        None if !is_given && of_bank > 1 => {
            refuse!(
                "{file}: the samples have no depths, and the bank has {of_bank}; give --depth-mm, or a column depth_mm"
            )
        }
        _ => Ok(()),
    }
}

/// A record, and what a person should know of how it was read.
type Noted = (Record, Vec<String>);

/// The record, whose notes are printed.
fn told((record, notes): Noted) -> Record {
    notes.iter().for_each(|text| note(record.file(), text));
    record
}

/// Judges the record at the position for which the maps are.
fn by_maps(arguments: &DetectArguments, record: Noted, noise: Noise) -> Result<(), CliError> {
    let maps = TwoMaps::read(arguments)?;
    let (table, file) = (maps.reference.table(), maps.reference_file);
    check_depths(arguments, &record, None)?;
    let depth = depth(arguments)?.unwrap_or(0.0);
    let mut warnings = Warnings::default();
    let hypotheses = maps.hypotheses(&mut warnings)?;
    let record = trimmed(arguments, record, table, hypotheses.have_lateral())?;
    let record = told(record);
    let known = arguments.noise.known()?;
    let question = question(
        arguments,
        (&known, noise),
        depth,
        (table, file),
        &mut warnings,
    )?;
    let found = question.judge(hypotheses, &record)?;
    let mut rows = exactly_asked(arguments, &known, depth, record);
    rows.append(found.rows());
    let words = conclusion(&known, found.decision, &found.causes, &found.fit);
    let verdict = (found.decision, &found.causes[..]);
    rows.value("warnings", warnings.0);
    tell(arguments, verdict, &words, rows)
}

/// Searches the record for any inclusion of a bank.
///
/// Implements: CLI-140, CLI-040, CLI-163.
fn by_bank(
    arguments: &DetectArguments,
    record: Noted,
    noise: Noise,
    path: &Path,
) -> Result<(), CliError> {
    let bank = Bank::read(path)?;
    let (files, table) = (&arguments.hypotheses, bank.reference().table());
    check_depths(arguments, &record, Some(&bank))?;
    let depth = depth(arguments)?.unwrap_or(bank.depth());
    let record = told(trimmed(arguments, record, bank.base(), true)?);
    let prior = files.prior.as_ref();
    let prior = prior.map(|file| bank.read_prior(file)).transpose()?;
    let mut warnings = Warnings::default();
    let known = arguments.noise.known()?;
    let search = BankSearch {
        question: question(
            arguments,
            (&known, noise),
            depth,
            (table, path),
            &mut warnings,
        )?,
        bank: &bank,
        prior: prior.as_deref(),
        simulations: files.simulations.map(|number| (number, files.seed)),
    };
    let asked = &search.question;
    let is_by_misses = matches!(asked.criterion, Criterion::NeymanPearsonMiss { .. });
    let has_one_depth = bank.probe_depths().len() == 1 && warnings.0.is_empty();
    if is_by_misses && asked.has_depth_tolerance() && has_one_depth {
        let text = "its maps have a single depth of the probe: the misses keep their rate at this depth, not within the depth tolerance";
        warnings.tell("single_depth", path.display(), text);
    }
    let found = search.locate(&record)?;
    if found.bound.is_finer_than_nodes {
        let text = "its steps are too large for so little noise, so the intervals hold the true values less often: compute a bank with smaller steps";
        warnings.tell("coarse_bank", path.display(), text);
    }
    if let Some(path) = &files.figure {
        write(path, &place_figure(&bank, &found.place)?)?;
    }
    let mut rows = exactly_asked(arguments, &known, depth, record);
    rows.append(found.rows(&bank)?);
    let words = conclusion(&known, found.decision, &found.causes, &found.fit);
    let verdict = (found.decision, &found.causes[..]);
    rows.value("warnings", warnings.0);
    tell(arguments, verdict, &words, rows)
}

/// The record without the samples outside `map`, if --trim is given, and without lateral forces where the maps do not `have_lateral`
/// ones.
///
/// Implements: TRC-014.
fn trimmed(
    arguments: &DetectArguments,
    (mut record, mut notes): Noted,
    map: &ForceTable,
    have_lateral: bool,
) -> Result<Noted, CliError> {
    if !have_lateral && !record.forces().lateral.is_empty() {
        record = record.normal_alone();
        let note = "the maps have no lateral forces: those of the record are left out";
        notes.push(note.into());
    }
    if !arguments.sweep.trim {
        return Ok((record, notes));
    }
    let (record, left_out) = record.trimmed(map)?;
    notes.extend(left_out);
    Ok((record, notes))
}

/// The question to ask of a sweep at `depth` over the gel of `reference`, the map in `file`.
fn question<'a>(
    arguments: &DetectArguments,
    (known, noise): (&'a Known, Noise),
    depth: f64,
    (reference, file): (&ForceTable, &Path),
    warnings: &mut Warnings,
) -> Result<Question<'a>, CliError> {
    let question = Question {
        depth,
        depth_tolerance: depth_tolerance(arguments),
        is_zeroed: arguments.model.zeroed,
        unknown: &known.unknown,
        noise,
        criterion: arguments.criterion.criterion()?,
        prior_h1: arguments.criterion.prior_h1,
    };
    if question.has_depth_tolerance() && reference.depths().len() == 1 {
        let text = "the map has a single depth: the depth tolerance has no effect";
        warnings.tell("single_depth", file.display(), text);
    }
    Ok(question)
}

/// The largest error of the depth, m, with the exact model.
fn depth_tolerance(arguments: &DetectArguments) -> f64 {
    arguments.sweep.depth_tolerance.unwrap_or(DEPTH_TOLERANCE)
}

/// The one depth of the exact model, m, if it was given.
fn depth(arguments: &DetectArguments) -> Result<Option<f64>, CliError> {
    match arguments.sweep.depths[..] {
        [] => Ok(None),
        [depth] => Ok(Some(depth)),
        ref depths => refuse!("--depth-mm has {} depths; give one", depths.len()),
    }
}

/// What was asked of any model of the records of these traces, or of their passes.
///
/// Implements: CLI-045.
fn asked(
    arguments: &DetectArguments,
    traces: &[PathBuf],
    depths: &[f64],
    records: &[Record],
) -> Rows {
    let mut rows = Rows::default();
    let path = |path: &Path| path.display().to_string();
    let samples: Vec<_> = records.iter().map(|of| of.positions().len()).collect();
    let own = records
        .iter()
        .flat_map(|record| record.depths().into_iter().flatten());
    let own = extremes(own.copied());
    match (traces, depths, &samples[..], own) {
        ([trace], _, all, Some(range)) => {
            rows.value("trace", path(trace));
            rows.value("samples", all.iter().sum::<usize>());
            rows.value("depth_range_m", json!(range));
        }
        ([trace], [depth], [samples], None) => {
            rows.value("trace", path(trace));
            rows.value("samples", *samples);
            rows.value("depth_m", *depth);
        }
        (traces, depths, samples, own) => {
            let traces: Vec<_> = traces.iter().map(|of| path(of)).collect();
            rows.value("traces", json!(traces));
            rows.value("samples", json!(samples));
            match own {
                Some(range) => rows.value("depth_range_m", json!(range)),
                None => rows.value("depths_m", json!(depths)),
            }
        }
    }
    let files = &arguments.hypotheses;
    for (key, file) in [
        ("reference", &files.reference),
        ("inclusion", &files.inclusion),
        ("bank", &files.bank),
        ("prior", &files.prior),
        ("gel_uncertainty", &arguments.model.gel_uncertainty),
    ] {
        file.iter().for_each(|file| rows.value(key, path(file)));
    }
    let sweep = &arguments.sweep;
    for (key, number) in [
        ("depth_noise_m", sweep.depth_noise),
        ("velocity_m_s", sweep.velocity),
        ("start_m", sweep.start),
    ] {
        number.iter().for_each(|number| rows.value(key, *number));
    }
    let columns = sweep.layout.columns.iter();
    columns.for_each(|columns| rows.value("columns", &**columns));
    rows.value("noise", &*arguments.noise.noise);
    rows.value("prior_h1", arguments.criterion.prior_h1);
    rows
}

/// What was asked of the exact model.
fn exactly_asked(arguments: &DetectArguments, known: &Known, depth: f64, record: Record) -> Rows {
    let mut rows = asked(arguments, &arguments.traces, &[depth], &[record]);
    rows.value("model", "exact");
    rows.value("depth_tolerance_m", depth_tolerance(arguments));
    rows.value("unknown", json!(known.unknown));
    rows.value("zeroed", arguments.model.zeroed);
    let criterion = &arguments.criterion;
    rows.value("criterion", criterion.name());
    for (key, rate) in [
        ("max_miss", criterion.max_miss),
        ("max_false_alarm", criterion.max_false_alarm),
    ] {
        rate.into_iter().for_each(|rate| rows.value(key, rate));
    }
    if arguments.hypotheses.simulations.is_some() {
        rows.value("seed", arguments.hypotheses.seed);
    }
    rows
}

/// Prints the answer, in a table after what it means in `words`; fails with the causes if there is no decision.
///
/// Implements: CLI-045, CLI-043, CLI-003.
fn tell(
    arguments: &DetectArguments,
    (decision, causes): (Option<Decision>, &[Cause]),
    words: &str,
    rows: Rows,
) -> Result<(), CliError> {
    let table = format!("{}\n\n{}", with_mark(decision, words), rows.table());
    let answer = Envelope::new("palpate-detection", 4, rows);
    arguments.format.print(&answer, || table)?;
    if decision.is_none() {
        // A reference sweep can be the one at fault.
        let references = &arguments.model.reference_sweeps;
        let files = arguments.traces.iter().chain(references);
        let files: Vec<_> = files.map(|file| file.display().to_string()).collect();
        let (files, why) = (files.join(", "), reasons(causes));
        let message = format!("{files}: cannot be judged: {why}");
        return Err(CliError::Unjudged(message));
    }
    Ok(())
}

/// The words with their decision in colour, where a terminal shows it.
///
/// Implements: CLI-225.
fn with_mark(decision: Option<Decision>, words: &str) -> String {
    let color = match decision {
        Some(Decision::Inclusion) => AnsiColor::Red,
        Some(Decision::NoInclusion) => AnsiColor::Green,
        None => AnsiColor::Yellow,
    };
    let (decided, rest) = words.split_at(words.find([',', ':']).unwrap_or(words.len()));
    marked(decided, color) + rest
}

/// What was decided, whether the record fits, and what was assumed.
///
/// Implements: CLI-043.
fn conclusion(known: &Known, decision: Option<Decision>, causes: &[Cause], fit: &Fit) -> String {
    let noise = match fit.limits {
        None => "with the noise estimated from the record",
        Some(_) => "and the record fits the stated noise",
    };
    let decided = match decision {
        Some(Decision::Inclusion) => format!("Inclusion detected, {noise}"),
        Some(Decision::NoInclusion) => format!("No inclusion detected, {noise}"),
        None => format!("The record cannot be judged: {}", reasons(causes)),
    };
    let [known, fitted] = [&known.known, &known.unknown].map(|names| in_words(names));
    format!("{decided}. Known: {known}. Fitted: {fitted}.")
}

/// The codes of the warnings.
#[derive(Default)]
struct Warnings(Vec<&'static str>);

impl Warnings {
    /// Implements: CLI-146.
    fn tell(&mut self, code: &'static str, file: impl Display, text: &str) {
        warn(&format!("{file}: {text}"));
        self.0.push(code);
    }
}

/// The maps without and with an inclusion.
struct TwoMaps<'a> {
    reference: ForceMap,
    inclusion: ForceMap,
    reference_file: &'a Path,
    file: &'a Path,
    any_maps: bool,
}

impl<'a> TwoMaps<'a> {
    fn read(arguments: &'a DetectArguments) -> Result<TwoMaps<'a>, CliError> {
        let files = &arguments.hypotheses;
        // The parser has refused all but a bank or both maps with a depth.
        let paths = [&files.reference, &files.inclusion];
        let [reference_file, file] = paths.map(|path| path.as_deref().unwrap_or(Path::new("")));
        Ok(TwoMaps {
            reference: map(reference_file)?,
            inclusion: map(file)?,
            reference_file,
            file,
            any_maps: files.any_maps,
        })
    }

    /// Refuses maps of which one is not the other with an inclusion, or warns of them where they are meant.
    ///
    /// Implements: CLI-047.
    fn hypotheses(&self, warnings: &mut Warnings) -> Result<Hypotheses<'_>, CliError> {
        let (file, reference) = (self.file.display(), &self.reference);
        let any = Hypotheses::of_tables(reference.table(), self.inclusion.table());
        let any = any.map_err(|error| error.in_file(file.to_string()))?;
        match Hypotheses::new(reference, &self.inclusion) {
            Ok(hypotheses) => Ok(hypotheses),
            Err(error) if self.any_maps => {
                warnings.tell("any_maps", file, &error.to_string());
                Ok(any)
            }
            Err(error) => refuse!("{file}: {error} (or use --any-maps)"),
        }
    }
}

fn map(path: &Path) -> Result<ForceMap, CliError> {
    if path.exists() {
        let (map, notes) = ForceMap::read_as(path, None)?;
        notes.iter().for_each(|text| note(path.display(), text));
        return Ok(map);
    }
    // A built-in phantom has a name elsewhere, but its forces depend on depths and mesh.
    refuse!(
        "{}: no such force map; 'palpate solve --phantom none --depths-mm ... --laterals-mm ... --format json' makes one",
        path.display()
    )
}
