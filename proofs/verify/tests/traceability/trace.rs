//! From each requirement to its code, tests, proofs and vectors, by the annotations: comments that name requirements
//! (`spec/traceability.md`).

use std::collections::{BTreeMap, BTreeSet};

use palpate_verify::traceability::Requirement;

use crate::repository::{Repository, ending, program};
use crate::rust::{item_below, names_by_macro};
use crate::spec::{Defined, is_id, requirements};

/// How many requirements a person may inspect instead of a test (EVD-029).
const MOST_INSPECTED: usize = 10;

/// What is wrong: file, line from 1 and message.
pub type Problems = BTreeSet<(String, usize, String)>;

/// Three kinds of annotations: served by this code; checked by this test; shown for every input in a stated range.
const WORDS: [&str; 3] = ["Implements", "Verifies", "Proves"];

/// What may be wrong with a requirement.
const WRONG: [&str; 4] = [
    "has no code: no annotation \"Implements:\" names it",
    "has neither test nor proof: no annotation \"Verifies:\" names it",
    "is marked \"by inspection\", but there is a test or proof of it",
    "does not say where it is inspected, and why",
];

/// All requirements with what serves and what checks them.
#[derive(Debug, Default)]
pub struct Trace {
    /// In the order of their ids.
    pub requirements: Vec<Requirement>,
    /// The lines of a log that show that a test or proof has passed, as [`crate::log::Log`] notes them.
    pub evidence: BTreeMap<String, Vec<String>>,
    pub problems: Problems,
}

/// What stands below an annotation.
enum Place {
    Code(String),
    Vectors(String),
    /// Tests or proofs by their names, with the lines of their log.
    Evidence(BTreeMap<String, Vec<String>>),
}

impl Trace {
    pub fn of(repository: &Repository) -> Trace {
        let mut trace = Trace::default();
        let mut defined = requirements(repository, &mut trace.problems);
        let outside = repository.iter();
        for (path, text) in outside.filter(|(path, _)| !path.starts_with("spec/")) {
            let lines: Vec<&str> = text.lines().collect();
            for line in 0..lines.len() {
                let entered = trace.annotation(repository, &mut defined, path, &lines, line);
                if let Err(message) = entered {
                    trace.problems.insert((path.clone(), line + 1, message));
                }
            }
        }
        trace.judge(&defined);
        let requirements = defined.into_values().map(|defined| defined.requirement);
        trace.requirements = requirements.collect();
        trace
    }

    /// Enters the annotation that begins on a line, if one does.
    fn annotation(
        &mut self,
        repository: &Repository,
        defined: &mut BTreeMap<String, Defined>,
        path: &str,
        lines: &[&str],
        line: usize,
    ) -> Result<(), String> {
        let ending = ending(path);
        let said = comment(lines[line], ending);
        let word = WORDS
            .into_iter()
            .find(|word| said.is_some_and(|said| said.starts_with(&format!("{word}:"))));
        let Some((word, said)) = word.zip(said) else {
            // A page may talk of annotations.
            return match ending != "md" && names_an_id(lines[line]) {
                true => Err(format!(
                    "{:?} is no annotation: a comment of its own begins with \"Implements: \", \"Verifies: \" or \"Proves: \"",
                    lines[line].trim()
                )),
                false => Ok(()),
            };
        };
        let (mut listed, mut end) = (said[word.len() + 1..].trim().to_string(), line + 1);
        while listed.ends_with(',') && end < lines.len() {
            listed += " ";
            listed += comment(lines[end], ending).unwrap_or_default();
            end += 1;
        }
        let ids = listed.split_once('.').map(|(ids, _)| ids.split(", "));
        let ids = ids.filter(|ids| ids.clone().all(is_id)).ok_or_else(|| {
            format!("{said:?} is no annotation, expected \"{word}: ABC-001, ABC-002.\"")
        })?;
        let place = place(repository, path, word, lines[line], end)?;
        for id in ids {
            let row = defined.get_mut(id).map(|defined| &mut defined.requirement);
            let row = row.ok_or_else(|| format!("no chapter in spec/ has a requirement {id}"))?;
            let (cell, names) = match &place {
                Place::Code(name) => (&mut row.code, vec![name]),
                Place::Vectors(name) => (&mut row.vectors, vec![name]),
                Place::Evidence(tests) if word == "Proves" => {
                    (&mut row.proofs, tests.keys().collect())
                }
                Place::Evidence(tests) => (&mut row.tests, tests.keys().collect()),
            };
            cell.extend(names.into_iter().cloned());
            cell.sort();
            cell.dedup();
        }
        if let Place::Evidence(tests) = place {
            self.evidence.extend(tests);
        }
        Ok(())
    }

    /// Every requirement has code, and a test or proof.
    fn judge(&mut self, defined: &BTreeMap<String, Defined>) {
        for (id, defined) in defined {
            let row = &defined.requirement;
            let tested = !row.tests.is_empty() || !row.proofs.is_empty();
            let inspected = row.inspection.as_deref();
            let wrong = [
                row.code.is_empty(),
                inspected.is_none() && !tested,
                inspected.is_some() && tested,
                inspected == Some(""),
            ];
            for (_, message) in wrong.iter().zip(WRONG).filter(|(wrong, _)| **wrong) {
                let (path, message) = (defined.path.clone(), format!("{id} {message}"));
                self.problems.insert((path, defined.line, message));
            }
        }
        let is_inspected = |defined: &Defined| defined.requirement.inspection.is_some();
        let inspected = defined.iter().filter(|(_, defined)| is_inspected(defined));
        let inspected: Vec<&str> = inspected.map(|(id, _)| id.as_str()).collect();
        if inspected.len() > MOST_INSPECTED {
            let message = format!(
                "{} requirements are marked \"by inspection\", at most {MOST_INSPECTED} may be: {}",
                inspected.len(),
                inspected.join(", ")
            );
            self.problems.insert(("spec".into(), 0, message));
        }
    }
}

/// What a line says as a comment: in Python every line counts, since docstrings have no mark.
fn comment<'a>(line: &'a str, ending: &str) -> Option<&'a str> {
    let line = line.trim();
    let said = match ending {
        "rs" | "js" => line.strip_prefix("//")?.trim_start_matches(['/', '!']),
        "md" => line.strip_prefix("<!--")?.trim_end_matches("-->"),
        "py" => line.trim_matches(['#', '"']),
        _ => line.strip_prefix('#')?,
    };
    Some(said.trim())
}

/// Whether a line has one of the words, in capitals or not, with an id behind it.
fn names_an_id(line: &str) -> bool {
    let mut words = line
        .split_whitespace()
        .map(|word| word.trim_matches(|c: char| !c.is_alphanumeric()));
    let named = |word: &str| WORDS.iter().any(|known| known.eq_ignore_ascii_case(word));
    words.any(named) && words.next().is_some_and(is_id)
}

/// What an annotation of this word, which ends before line `end`, is about.
fn place(
    repository: &Repository,
    path: &str,
    word: &str,
    line: &str,
    end: usize,
) -> Result<Place, String> {
    let text = &repository[path];
    let rust = path.ends_with(".rs");
    let below = text.lines().nth(end).unwrap_or_default();
    match word {
        "Proves" if !path.starts_with("proofs/") => {
            Err("\"Proves:\" stands in proofs/ alone".into())
        }
        "Implements" if rust && !line.starts_with("//!") => {
            let item = item_below(text, end)
                .ok_or("below it stands no item, field or variant that it could be about")?;
            let owner = item.owner.map(|owner| owner + "::").unwrap_or_default();
            Ok(Place::Code(format!("{path} {owner}{}", item.name)))
        }
        "Implements" => Ok(Place::Code(path.into())),
        _ if rust && !path.starts_with("benches/") => test(repository, path, end),
        _ if path.starts_with("vectors/generator/") => {
            let def = below.strip_prefix("def ");
            let name = def.and_then(|def| def.split_once('('));
            let (name, _) = name.ok_or("it does not stand above a function that makes a group")?;
            let file = format!("vectors/{name}.json");
            match repository.contains_key(&file) {
                true => Ok(Place::Vectors(file)),
                false => Err(format!("there is no {file}")),
            }
        }
        _ if path == ".ci/run" => {
            let command = below.strip_prefix("step ");
            let command = command.ok_or("it does not stand above a step")?;
            let (name, shown) = (format!("{path} {command}"), format!("== ok: {command}"));
            Ok(Place::Evidence([(name, vec![shown])].into()))
        }
        _ => Ok(Place::Evidence([(path.into(), vec![path.into()])].into())),
    }
}

/// A test function, or a scenario of the test on the HID stack.
fn test(repository: &Repository, path: &str, end: usize) -> Result<Place, String> {
    let item = item_below(&repository[path], end).filter(|item| item.kind == "fn");
    let item = item.ok_or("it does not stand above a test function")?;
    let of = program(repository, path).ok_or("the file belongs to no program")?;
    let functions = match item.name.starts_with('$') {
        true => names_by_macro(&repository[path], end),
        false => vec![item.name],
    };
    let mut tests = BTreeMap::new();
    for function in functions {
        let modules = of.modules.iter().chain(&item.modules).chain([&function]);
        let name = modules.map(String::as_str).collect::<Vec<_>>().join("::");
        let passed = if item.is_test {
            vec![format!("{} {name}", of.shown)]
        } else if path.starts_with("tests/hid-stack/") {
            scenarios(repository, &function)
        } else {
            return Err(format!("`{function}` below it has no #[test]"));
        };
        if passed.is_empty() {
            return Err(format!("no list `ALL` of scenarios runs `{function}`"));
        }
        tests.insert(format!("{}::{name}", of.root), passed);
    }
    Ok(Place::Evidence(tests))
}

/// The lines of the scenarios that call a function: the guest runs those in its lists `ALL`, each a name and a call.
fn scenarios(repository: &Repository, function: &str) -> Vec<String> {
    let in_guest = |path: &str| path.starts_with("tests/hid-stack/src/");
    let sources = repository.iter().filter(|(path, _)| in_guest(path));
    let lists = sources.filter_map(|(_, text)| {
        let (_, list) = text.split_once("const ALL: ")?;
        list.split("];").next()
    });
    let mut passed = Vec::new();
    for entry in lists.flat_map(|list| list.split('(')) {
        let Some((name, call)) = entry.trim_start().split_once("\",") else {
            continue;
        };
        let mut words = call.split(|c: char| !(c.is_alphanumeric() || c == '_'));
        if words.any(|word| word == function) {
            passed.push(format!("hid-stack: ok {}", name.trim_start_matches('"')));
        }
    }
    passed
}
