//! `palpate detect` for many records, each of a place of its own.

use std::collections::BTreeMap;
use std::path::PathBuf;

use indicatif::ProgressBar;
use palpate::detect::Decision;
use palpate::robust::RobustAnswer;
use palpate::rows::Rows;
use palpate::trace::{Record, reasons};
use rayon::prelude::*;
use serde_json::Value;

use super::arguments::AnswerFormat;
use super::robust::{Asked, Detector, tell_glitches};
use crate::output::{Envelope, print};
use crate::progress::bar;
use crate::{CliError, error::refuse};

/// The columns of the table of records in CSV, after the file.
const COLUMNS: [&str; 6] = [
    "decision",
    "posterior_h1",
    "theta",
    "false_alarm",
    "miss",
    "causes",
];

/// The files that the command line names: itself, or those of a folder that end in `.csv`, by their names.
///
/// Implements: CLI-175.
pub fn traces(named: &[PathBuf]) -> Result<Vec<PathBuf>, CliError> {
    let mut traces = Vec::new();
    for path in named {
        if !path.is_dir() {
            traces.push(path.clone());
            continue;
        }
        let folder = std::fs::read_dir(path).map_err(CliError::file("read", path))?;
        let files = folder.map(|entry| Ok(entry?.path()));
        let files = files.collect::<Result<Vec<_>, std::io::Error>>();
        let mut files = files.map_err(CliError::file("read", path))?;
        files.retain(|file| {
            file.extension()
                .is_some_and(|end| end.eq_ignore_ascii_case("csv"))
        });
        files.sort();
        if files.is_empty() {
            refuse!("{}: no file ends in .csv", path.display());
        }
        traces.append(&mut files);
    }
    Ok(traces)
}

/// What is said of a record.
struct Judged {
    decision: Option<Decision>,
    /// The causes or the likeliest class, for people.
    why: String,
    /// Samples that were replaced.
    glitches: usize,
    rows: Rows,
}

/// Judges each record, and prints a line for each.
///
/// Implements: CLI-175.
pub fn detect(asked: &Asked<'_>, traces: &[PathBuf]) -> Result<(), CliError> {
    let bar = bar(traces.len(), "records");
    let mut answers = BTreeMap::new();
    // One detector for all records over the same positions.
    let mut alike: BTreeMap<Vec<u64>, Vec<(usize, Record)>> = BTreeMap::new();
    // One after the other, so that the notes have an order.
    for (number, path) in traces.iter().enumerate() {
        match asked.read(path) {
            Ok(record) => {
                let positions = record.positions().iter().map(|x| x.to_bits());
                let alike = alike.entry(positions.collect()).or_default();
                alike.push((number, record));
            }
            Err(error) => {
                answers.insert(number, Err(error));
            }
        }
    }
    let alike: Vec<_> = alike.into_values().collect();
    let judge = |records: &Vec<(usize, Record)>| judged(asked, records, &bar);
    let judged: Vec<_> = alike.par_iter().flat_map_iter(judge).collect();
    answers.extend(judged);
    bar.finish_and_clear();
    told(asked, traces, answers.into_values().collect())
}

/// What is said of records over the same positions, each with its number.
fn judged(
    asked: &Asked<'_>,
    records: &[(usize, Record)],
    bar: &ProgressBar,
) -> Vec<(usize, Result<Judged, CliError>)> {
    let of = |record: &Record| asked.detector(&asked.sweeps(std::slice::from_ref(record)));
    let first = records.first().map(|(_, record)| of(record));
    let judge = |(number, record): &(usize, Record)| {
        bar.inc(1);
        let judged = match &first {
            Some(Ok(detector)) => one(asked, detector, record),
            // The refusal names the file: it is another for each.
            _ => match of(record) {
                Ok(detector) => one(asked, &detector, record),
                Err(refusal) => Err(refusal.into()),
            },
        };
        (*number, judged)
    };
    records.par_iter().map(judge).collect()
}

fn one(asked: &Asked<'_>, detector: &Detector<'_>, record: &Record) -> Result<Judged, CliError> {
    let records = std::slice::from_ref(record);
    let (answer, place) = detector.judge(&asked.sweeps(records))?;
    let mut rows = asked.rows(&[record.file().into()], records);
    rows.append(answer.rows(asked.bank().zip(place.as_ref())));
    Ok(Judged {
        decision: answer.decision,
        why: why(&answer),
        glitches: answer.glitches.first().copied().unwrap_or(0),
        rows,
    })
}

/// The causes, or what else the record looks like.
fn why(answer: &RobustAnswer) -> String {
    match answer.decision {
        None => reasons(&answer.causes),
        Some(decision) => {
            let hypothesis = usize::from(decision == Decision::Inclusion);
            let class = answer.likeliest_class(hypothesis);
            class.map_or(String::new(), |class| {
                format!("as if {}", answer.classes[class].0.name)
            })
        }
    }
}

/// Prints a line for each record, and errors; fails if one was not judged.
fn told(
    asked: &Asked<'_>,
    traces: &[PathBuf],
    answers: Vec<Result<Judged, CliError>>,
) -> Result<(), CliError> {
    let names: Vec<_> = traces
        .iter()
        .map(|path| path.display().to_string())
        .collect();
    let width = names
        .iter()
        .map(|name| name.chars().count())
        .max()
        .unwrap_or(0);
    let mut text = match asked.arguments.format {
        AnswerFormat::Table => format!("{:<width$}  {:<16}  posterior\n", "file", "decision"),
        AnswerFormat::Csv => format!("file,{},error\n", COLUMNS.join(",")),
        AnswerFormat::Json => String::new(),
    };
    let (mut refused, mut unjudged) = (0, 0);
    for (name, answer) in names.iter().zip(&answers) {
        match answer {
            Ok(answer) => {
                tell_glitches(name, answer.glitches);
                unjudged += usize::from(answer.decision.is_none());
            }
            Err(error) => {
                refused += 1;
                eprintln!("palpate: {error}");
            }
        }
        text += &match asked.arguments.format {
            AnswerFormat::Table => line(name, width, answer),
            AnswerFormat::Csv => csv_line(name, answer),
            AnswerFormat::Json => json_line(name, answer),
        };
    }
    print(&text)?;
    let all = names.len();
    match (refused, unjudged) {
        (0, 0) => Ok(()),
        (0, _) => {
            let message = format!("cannot be judged: {unjudged} of {all} records");
            Err(CliError::Unjudged(message))
        }
        (_, 0) => refuse!("refused: {refused} of {all} files"),
        _ => refuse!("refused: {refused} of {all} files; cannot be judged: {unjudged}"),
    }
}

/// A line for people.
fn line(name: &str, width: usize, answer: &Result<Judged, CliError>) -> String {
    let (decision, posterior, why) = match answer {
        Ok(answer) => {
            let decision = text(answer.rows.get("decision")).replace('_', " ");
            let posterior = answer.rows.get("posterior_h1").and_then(Value::as_f64);
            let posterior = posterior.map_or("-".into(), |posterior| format!("{posterior:.6}"));
            (decision, posterior, &*answer.why)
        }
        Err(_) => ("refused".into(), "-".into(), "see the message"),
    };
    format!("{name:<width$}  {decision:<16}  {posterior:<9}  {why}\n")
}

fn csv_line(name: &str, answer: &Result<Judged, CliError>) -> String {
    let mut fields = vec![quoted(name)];
    match answer {
        Ok(answer) => {
            fields.extend(COLUMNS.map(|key| quoted(&text(answer.rows.get(key)))));
            fields.push(String::new());
        }
        Err(error) => {
            fields.extend(COLUMNS.map(|_| String::new()));
            fields.push(quoted(&error.to_string()));
        }
    }
    fields.join(",") + "\n"
}

fn json_line(name: &str, answer: &Result<Judged, CliError>) -> String {
    let refused;
    let rows = match answer {
        Ok(answer) => &answer.rows,
        Err(error) => {
            let mut rows = Rows::default();
            rows.value("trace", name);
            rows.value("error", error.to_string());
            refused = rows;
            &refused
        }
    };
    let line = serde_json::to_string(&Envelope::new("palpate-detection", 4, rows));
    line.unwrap_or_default() + "\n"
}

/// A value in a field: a list with semicolons, nothing for none.
fn text(value: Option<&Value>) -> String {
    match value {
        None | Some(Value::Null) => String::new(),
        Some(Value::String(text)) => text.clone(),
        Some(Value::Array(list)) => {
            let list: Vec<_> = list.iter().map(|value| text(Some(value))).collect();
            list.join(";")
        }
        Some(value) => value.to_string(),
    }
}

/// A field of CSV, in quotes where it needs them.
fn quoted(field: &str) -> String {
    if field.contains([',', '"', '\n']) {
        format!("\"{}\"", field.replace('"', "\"\""))
    } else {
        field.into()
    }
}
