//! Questions in a file, and answers from one, for a program that cannot serve a pipe.

use std::collections::{HashMap, HashSet};
use std::path::Path;

use serde_json::Value;

use super::answers::{Answers, CAPABILITIES, Capabilities};
use super::columns;
use super::measure::Measure;
use super::program::Program;
use super::suite::Suite;
use super::text::Invalid;
use super::verdict::Verdict;

/// How questions are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum Form {
    /// The requests of the pipe, one per line
    Jsonl,
    /// A table with one number per row, without the questions about the form of requests
    Csv,
}

/// The questions of a suite as a file.
///
/// Implements: ORA-057, ORA-064.
pub fn questions(suite: &Suite, form: Form) -> String {
    if form == Form::Csv {
        return columns::questions(suite);
    }
    let requests = suite.requests().map(|(_, line)| line);
    let first = format!("{CAPABILITIES}\n");
    std::iter::once(first).chain(requests).collect()
}

/// Judges answers from a file to questions from a file, and returns the part of the suite that was asked.
///
/// # Errors
/// A file that cannot be read, questions that are not of this suite, and rows that are not of a table of answers.
///
/// Implements: ORA-075, ORA-064.
pub fn judge_files(
    suite: Suite,
    skip: &[String],
    questions: &Path,
    answers: &Path,
    measure: &Measure,
    lenient: bool,
) -> Result<(Verdict, Suite), Invalid> {
    let read = |path: &Path| {
        let bytes = std::fs::read(path);
        bytes.map_err(|error| Invalid::new(path.display(), error))
    };
    let (asked, answered) = (read(questions)?, read(answers)?);
    let asked = String::from_utf8_lossy(&asked);
    let is_table = asked.starts_with(columns::HEAD);
    let part = if is_table { columns::asked } else { part_asked };
    let suite =
        part(suite, &asked).map_err(|message| Invalid::new(questions.display(), message))?;
    let mut judged = Answers::new(&suite, skip, &measure.profile, lenient);
    let version = if is_table {
        columns::judge_table(&mut judged, &String::from_utf8_lossy(&answered))
            .map_err(|message| Invalid::new(answers.display(), message))?;
        judged.notes.push(NO_CAPABILITIES.into());
        String::new()
    } else {
        judge_lines(&mut judged, &answered)
    };
    let (outcomes, notes) = judged.outcomes("no answer");
    let program = Program::of_answers(answers, version);
    let verdict = Verdict::new(&suite, measure, program, outcomes, notes, 0);
    Ok((verdict, suite))
}

/// The part of the suite whose requests these lines are.
fn part_asked(suite: Suite, text: &str) -> Result<Suite, String> {
    let requests = suite.requests();
    let known: HashMap<String, String> = requests
        .map(|(case, line)| (line, case.id.clone()))
        .collect();
    let mut ids = HashSet::new();
    for (number, line) in (1..).zip(text.lines()) {
        if line != CAPABILITIES {
            let id = known.get(&format!("{line}\n"));
            ids.insert(id.ok_or_else(|| format!("line {number} is no question of these vectors"))?);
        }
    }
    Ok(suite.part(|case| ids.contains(&case.id)))
}

/// A note on answers among which none is to capabilities.
const NO_CAPABILITIES: &str =
    "no answer to capabilities: the program is taken to claim the ops with an answer";

/// Judges lines of answers. Returns the version of the program, if there is one.
fn judge_lines(answers: &mut Answers, text: &[u8]) -> String {
    let (mut lines, mut claims) = (Vec::new(), None);
    for line in text.split(|&byte| byte == b'\n') {
        match Capabilities::read(line) {
            Some(found) => claims = Some(found),
            None => lines.push(line),
        }
    }
    // What follows the end of the last line is no line.
    lines.pop_if(|last| last.is_empty());
    if let Some(claims) = &claims {
        answers.claim(&claims.ops);
    } else {
        let id = |line: &&[u8]| {
            let answer: Value = serde_json::from_slice(line).ok()?;
            Some(answer["id"].as_str()?.to_string())
        };
        let ids: HashSet<String> = lines.iter().filter_map(id).collect();
        answers.claim_answered(|id| ids.contains(id));
        answers.notes.push(NO_CAPABILITIES.into());
    }
    while answers.ask().is_some() {}
    for line in lines {
        answers.take(line);
    }
    claims.map_or_else(String::new, |claims| claims.version())
}
