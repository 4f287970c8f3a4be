//! Questions in a file, and answers from one, for a program that cannot serve a pipe.

use std::collections::{HashMap, HashSet};
use std::path::Path;

use serde_json::Value;

use super::answers::judge_planned;
use super::case::{Case, Expected, Wanted};
use super::plan::{CAPABILITIES, Capabilities, Plan};
use super::profile::Profile;
use super::suite::{Invalid, Suite};
use super::verdict::{Measure, Outcome, Program, Verdict};
use super::{columns, verdict::Class};

/// How questions are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum Form {
    /// The requests of the pipe, a line each
    Jsonl,
    /// A number a row; without the questions that only a reader of JSON can get wrong
    Csv,
}

/// The questions of a suite as a file.
///
/// Implements: ORA-057, ORA-064.
pub fn questions(suite: &Suite, form: Form) -> String {
    if form == Form::Csv {
        return columns::questions(suite);
    }
    let mut text = format!("{CAPABILITIES}\n");
    for group in &suite.groups {
        text.extend(group.cases.iter().map(|case| case.line(&group.op)));
    }
    text
}

/// Judges answers from a file to questions from a file; the suite is the part that was asked.
///
/// # Errors
/// A file that cannot be read, questions that are not of this suite, and rows of a table that are none.
///
/// Implements: ORA-075, ORA-064.
pub fn judge_files(
    suite: &Suite,
    skip: &[String],
    questions: &Path,
    answers: &Path,
    measure: &Measure,
    lenient: bool,
) -> Result<(Verdict, Suite), Invalid> {
    let text = read(questions)?;
    let text = String::from_utf8_lossy(&text);
    let is_table = text.starts_with(columns::HEAD);
    let suite = if is_table {
        columns::asked(suite, &text)
    } else {
        asked(suite, &text)
    }
    .map_err(|message| Invalid::new(questions.display(), message))?;
    let answered = read(answers)?;
    let program = |version| Program::of_answers(answers, version);
    if is_table {
        let profile = &measure.profile;
        let read = columns::read_answers(&String::from_utf8_lossy(&answered), lenient);
        let (found, notes) = read.map_err(|message| Invalid::new(answers.display(), message))?;
        let outcomes = judge_table(&suite, skip, &found, profile);
        let verdict = Verdict::new(&suite, measure, program(String::new()), outcomes, notes);
        return Ok((verdict, suite));
    }
    let (mut lines, mut claims) = (Vec::new(), None);
    for line in answered.split(|&byte| byte == b'\n') {
        match Capabilities::read(line) {
            Some(found) => claims = Some(found),
            None => lines.push(line),
        }
    }
    // What follows the end of the last line is no line.
    lines.pop_if(|last| last.is_empty());
    let plan = match &claims {
        Some(claims) => Plan::new(&suite, skip, |op| {
            claims.ops.iter().any(|claimed| claimed == op)
        }),
        None => {
            let ids = ids(&lines);
            Plan::of_answered(&suite, skip, |id| ids.contains(id))
        }
    };
    let (outcomes, mut notes) = judge_planned(&suite, plan, lines, &measure.profile, lenient);
    if claims.is_none() {
        notes.push("no answer to capabilities: the ops with an answer are taken for those that the program claims".into());
    }
    let version = claims.map_or_else(String::new, |claims| claims.version);
    let verdict = Verdict::new(&suite, measure, program(version), outcomes, notes);
    Ok((verdict, suite))
}

fn read(path: &Path) -> Result<Vec<u8>, Invalid> {
    std::fs::read(path).map_err(|error| Invalid::new(path.display(), error.to_string()))
}

/// The part of the suite whose requests these lines are.
fn asked(suite: &Suite, text: &str) -> Result<Suite, String> {
    let mut known = HashMap::new();
    for group in &suite.groups {
        known.extend(
            group
                .cases
                .iter()
                .map(|case| (case.line(&group.op), &case.id[..])),
        );
    }
    let mut ids = HashSet::new();
    for (number, line) in (1..)
        .zip(text.lines())
        .filter(|(_, line)| *line != CAPABILITIES)
    {
        let id = known.get(&format!("{line}\n"));
        ids.insert(*id.ok_or_else(|| format!("line {number} is no question of these vectors"))?);
    }
    Ok(part(suite, |case| ids.contains(&case.id[..])))
}

/// The part of the suite with these cases.
pub fn part(suite: &Suite, is_asked: impl Fn(&Case) -> bool) -> Suite {
    let mut suite = suite.clone();
    for group in &mut suite.groups {
        group.cases.retain(&is_asked);
    }
    suite.groups.retain(|group| !group.cases.is_empty());
    suite
}

/// The ids of lines that are answers.
fn ids(lines: &[&[u8]]) -> HashSet<String> {
    let id = |line: &&[u8]| {
        let answer: Value = serde_json::from_slice(line).ok()?;
        answer.get("id")?.as_str().map(str::to_string)
    };
    lines.iter().filter_map(id).collect()
}

/// Judges the answers of a table: a group without an answer is not claimed.
fn judge_table(
    suite: &Suite,
    skip: &[String],
    found: &HashMap<String, Value>,
    profile: &Profile,
) -> Vec<Vec<Outcome>> {
    let plan = Plan::of_answered(suite, skip, |id| found.contains_key(id));
    let outcome = |case: &Case| {
        let Some(mut answer) = found.get(&case.id).cloned() else {
            return Outcome::wrong(Class::Protocol, "no answer");
        };
        if let Expected::Values(values) = &case.expected {
            for Wanted { key, value, .. } in values {
                if let Some(found) = answer.pointer_mut("/ok").and_then(|ok| ok.get_mut(key)) {
                    *found = columns::typed(found, value);
                }
            }
        }
        super::judge(case, &answer, profile)
    };
    let outcomes = plan
        .cases(suite)
        .into_iter()
        .map(outcome)
        .map(Some)
        .collect();
    plan.outcomes(outcomes, "no answer")
}
