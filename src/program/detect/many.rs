//! `palpate detect` for many records, each of a place of its own.

use std::collections::BTreeMap;
use std::fmt::Display;
use std::path::PathBuf;

use palpate::refusal::Refusal;
use palpate::rows::Rows;
use palpate::trace::Record;
use rayon::prelude::*;
use serde_json::Value;

use super::records::{Asked, Detector, tell_glitches};
use crate::output::{Envelope, csv_line, files_in, note, print};
use crate::progress::bar;
use crate::{CliError, Format, error::refuse};

/// The columns of the table of records in CSV.
const HEADER: &str = "trace,decision,posterior_h1,theta,false_alarm,miss,causes,error";

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
        let mut files = files_in(path, |file| {
            let end = file.extension();
            end.is_some_and(|end| end.eq_ignore_ascii_case("csv"))
        })?;
        if files.is_empty() {
            refuse!("{}: no file ends in .csv", path.display());
        }
        traces.append(&mut files);
    }
    Ok(traces)
}

/// What is said of a record.
struct Answer {
    /// None if its file was refused.
    is_judged: Option<bool>,
    /// Samples that were replaced.
    glitches: usize,
    rows: Rows,
}

/// Judges each record, and prints a line for each.
///
/// Implements: CLI-175.
pub fn detect(asked: Asked<'_>, traces: &[PathBuf]) -> Result<(), CliError> {
    let bar = bar(traces.len(), "records");
    let mut answers = BTreeMap::new();
    // One detector for all records along the same path.
    let mut alike: BTreeMap<Vec<u64>, Vec<(usize, Vec<Record>)>> = BTreeMap::new();
    // What is said of several files is said once.
    let mut notes: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for (number, path) in traces.iter().enumerate() {
        match asked.read(path) {
            Ok((passes, told)) => {
                for text in told {
                    let files: &mut Vec<_> = notes.entry(text).or_default();
                    files.push(passes[0].file().to_owned());
                }
                let path = passes.iter().map(path_of).collect::<Vec<_>>().concat();
                alike.entry(path).or_default().push((number, passes));
            }
            Err(error) => {
                answers.insert(number, refused(&path.display().to_string(), &error));
            }
        }
    }
    tell_notes(notes);
    let records = alike.values().flatten();
    let asked = &asked.with_gels(records.map(|(_, passes)| &passes[..]))?;
    let of = |passes: &[Record]| asked.detector(&asked.sweeps(passes));
    let judge = |records: Vec<(usize, Vec<Record>)>| {
        let first = of(&records[0].1);
        let judge = |(number, passes): &(usize, Vec<Record>)| {
            bar.inc(1);
            let answer = match &first {
                Ok(detector) => answer(asked, detector, passes),
                // The refusal names the file: it is another for each.
                Err(_) => of(passes).and_then(|own| answer(asked, &own, passes)),
            };
            let answer = answer.unwrap_or_else(|refusal| refused(passes[0].file(), &refusal));
            (*number, answer)
        };
        records.par_iter().map(judge).collect::<Vec<_>>()
    };
    let alike = alike.into_values().collect::<Vec<_>>().into_par_iter();
    let judged: Vec<_> = alike.flat_map_iter(judge).collect();
    answers.extend(judged);
    bar.finish_and_clear();
    tell(asked.arguments.format, answers.into_values().collect())
}

/// Tells each note once, with the first of its files and the number of the others.
fn tell_notes(notes: BTreeMap<String, Vec<String>>) {
    for (text, files) in notes {
        let more = match files.len() - 1 {
            0 => String::new(),
            more => format!(" (and {more} more)"),
        };
        note(format!("{}{more}", files[0]), &text);
    }
}

/// Where a pass has which forces, which way it went and over which place, as numbers.
fn path_of(pass: &Record) -> Vec<u64> {
    let positions = pass
        .positions()
        .iter()
        .chain(pass.depths().into_iter().flatten());
    let numbers = positions.map(|x| x.to_bits());
    let lists = [pass.forces().lateral.len(), pass.positions().len()].map(|of| of as u64);
    let way = pass.travelled()[0].to_bits();
    let place = pass.place().into_iter().flatten().map(f64::to_bits);
    lists
        .into_iter()
        .chain([way])
        .chain(place)
        .chain(numbers)
        .collect()
}

/// What is said of a record by the detector of its path.
fn answer(
    asked: &Asked<'_>,
    detector: &Detector<'_>,
    records: &[Record],
) -> Result<Answer, Refusal> {
    let (answer, place) = detector.judge(&asked.sweeps(records))?;
    let rows = answer.rows(asked.bank().zip(place.as_ref()));
    Ok(Answer {
        is_judged: Some(answer.decision.is_some()),
        // Those of reference sweeps, which stand behind, are not its own.
        glitches: answer.glitches.iter().take(records.len()).sum(),
        rows: asked.rows(&[records[0].file().into()], records, rows),
    })
}

/// What is said of a file that is refused.
fn refused(file: &str, error: &impl Display) -> Answer {
    let mut rows = Rows::default();
    rows.value("trace", file);
    rows.value("error", error.to_string());
    Answer {
        is_judged: None,
        glitches: 0,
        rows,
    }
}

/// Prints a line for each record, and errors; fails if one was not judged.
fn tell(format: Format, answers: Vec<Answer>) -> Result<(), CliError> {
    let field = |answer: &Answer, key: &str| text(answer.rows.get(key));
    for answer in &answers {
        tell_glitches(&field(answer, "trace"), answer.glitches);
        if answer.is_judged.is_none() {
            crate::output::say(format_args!("palpate: {}\n", field(answer, "error")));
        }
    }
    let lines: String = match format {
        Format::Table => table(&answers),
        Format::Csv => {
            let line = |answer| csv_line(HEADER.split(',').map(|key| field(answer, key)));
            format!("{HEADER}\n") + &answers.iter().map(line).collect::<String>()
        }
        Format::Json => {
            let line = |answer: &Answer| {
                let answer = Envelope::new("palpate-detection", 4, &answer.rows);
                serde_json::to_string(&answer).unwrap_or_default() + "\n"
            };
            answers.iter().map(line).collect()
        }
    };
    print(&lines)?;
    let count = |of| {
        answers
            .iter()
            .filter(|answer| answer.is_judged == of)
            .count()
    };
    let (refused, unjudged, all) = (count(None), count(Some(false)), answers.len());
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

/// The table for people: file, decision, posterior, and the likeliest class or the causes.
fn table(answers: &[Answer]) -> String {
    let line = |answer: &Answer| {
        let field = |key: &str| answer.rows.get(key);
        let decision = answer
            .is_judged
            .map_or("refused".into(), |_| text(field("decision")));
        let class = match &*decision {
            "inclusion" => field("class_with"),
            _ => field("class_without"),
        };
        let class = class.map(|class| text(class.get("class")));
        let why = match answer.is_judged {
            Some(false) => text(field("causes")),
            _ => class.unwrap_or_default(),
        };
        let posterior = field("posterior_h1").and_then(Value::as_f64);
        let posterior = posterior.map_or("-".into(), |posterior| format!("{posterior:.6}"));
        [
            text(field("trace")),
            decision.replace('_', " "),
            posterior,
            why,
        ]
    };
    let head = ["file", "decision", "posterior", "explanation or causes"].map(String::from);
    let lines: Vec<_> = std::iter::once(head)
        .chain(answers.iter().map(line))
        .collect();
    let width = |line: &[String; 4]| line[0].chars().count();
    let width = lines.iter().map(width).max().unwrap_or(0);
    let line = |[file, decision, posterior, why]: &[String; 4]| {
        let line = format!("{file:<width$}  {decision:<16}  {posterior:<9}  {why}");
        line.trim_end().to_owned() + "\n"
    };
    lines.iter().map(line).collect()
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
