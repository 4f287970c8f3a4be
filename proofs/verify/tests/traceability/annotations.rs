//! From each requirement to its code, tests, proofs and vectors, by the annotations: comments that name requirements
//! (`spec/verification-plan.md`).

use std::collections::{BTreeMap, BTreeSet};

use palpate_verify::test_run::Requirement;

use crate::repository::{Repository, ending};
use crate::rust::{Item, Items};
use crate::spec::{Defined, is_id, requirements};

/// What is wrong: file, line from 1 and message.
pub type Problems = BTreeSet<(String, usize, String)>;

/// Three kinds of annotations: served by this code; checked by this test; shown for every input in a stated range.
const WORDS: [&str; 3] = ["Implements", "Verifies", "Proves"];

/// All requirements with what serves and what checks them.
#[derive(Debug, Default)]
pub struct Traceability {
    /// In the order of their ids.
    pub requirements: Vec<Requirement>,
    /// The tests and proofs by their names.
    pub evidence: BTreeMap<String, Evidence>,
    pub problems: Problems,
}

/// What carries out a test or proof.
#[derive(Debug, Clone, PartialEq)]
pub enum Evidence {
    /// A test function, which cargo-nextest runs; by default not if it has the attribute `#[ignore]`.
    Test { ignored: bool },
    /// A script, a bench or a file of Gappa's, which a step of `.ci/run` runs.
    Script(String),
}

/// What stands below an annotation.
enum Place {
    Code(String),
    Vectors(String),
    Evidence(BTreeMap<String, Evidence>),
}

/// A file with annotations.
struct Source<'a> {
    repository: &'a Repository,
    path: &'a str,
    lines: Vec<&'a str>,
    /// Of a Rust file.
    items: Items,
}

/// An annotation.
struct Annotation<'a> {
    word: &'static str,
    ids: Vec<String>,
    /// The line on which it begins.
    text: &'a str,
    /// The line below it, from 0.
    end: usize,
}

impl Traceability {
    pub fn of(repository: &Repository) -> Traceability {
        let mut problems = Problems::new();
        let mut defined = requirements(repository, &mut problems);
        let mut evidence = BTreeMap::new();
        let outside = repository.files.iter();
        for (path, text) in outside.filter(|(path, _)| !path.starts_with("spec/")) {
            let mut refuse = |line, message| problems.insert((path.clone(), line, message));
            let source = match Source::of(repository, path, text) {
                Ok(source) => source,
                Err((line, message)) => {
                    refuse(line, message);
                    continue;
                }
            };
            for line in 0..source.lines.len() {
                let entered = source.annotation(line).and_then(|annotation| {
                    annotation.map_or(Ok(()), |found| {
                        enter(&mut defined, &mut evidence, &found, source.place(&found)?)
                    })
                });
                if let Err(message) = entered {
                    refuse(line + 1, message);
                }
            }
        }
        judge(&defined, &mut problems);
        let requirements = defined.into_values().map(|defined| defined.requirement);
        Traceability {
            requirements: requirements.collect(),
            evidence,
            problems,
        }
    }
}

/// Enters what stands below an annotation for each of its requirements.
fn enter(
    defined: &mut BTreeMap<String, Defined>,
    evidence: &mut BTreeMap<String, Evidence>,
    annotation: &Annotation<'_>,
    place: Place,
) -> Result<(), String> {
    for id in &annotation.ids {
        let row = defined.get_mut(id).map(|defined| &mut defined.requirement);
        let row = row.ok_or_else(|| format!("no chapter in spec/ has a requirement {id}"))?;
        let (cell, names) = match &place {
            Place::Code(name) => (&mut row.code, vec![name]),
            Place::Vectors(name) => (&mut row.vectors, vec![name]),
            Place::Evidence(found) if annotation.word == "Proves" => {
                (&mut row.proofs, found.keys().collect())
            }
            Place::Evidence(found) => (&mut row.tests, found.keys().collect()),
        };
        cell.extend(names.into_iter().cloned());
        cell.sort();
        cell.dedup();
    }
    if let Place::Evidence(found) = place {
        evidence.extend(found);
    }
    Ok(())
}

/// Every requirement has code, and a test or proof.
fn judge(defined: &BTreeMap<String, Defined>, problems: &mut Problems) {
    for (id, defined) in defined {
        let row = &defined.requirement;
        let mut refuse = |message: &str| {
            let message = format!("{id} {message}");
            problems.insert((defined.path.clone(), defined.line, message));
        };
        if row.code.is_empty() {
            refuse("has no code: no annotation \"Implements:\" names it");
        }
        if row.tests.is_empty() && row.proofs.is_empty() {
            refuse("has neither test nor proof: no annotation \"Verifies:\" names it");
        }
    }
}

impl<'a> Source<'a> {
    fn of(
        repository: &'a Repository,
        path: &'a str,
        text: &'a str,
    ) -> Result<Source<'a>, (usize, String)> {
        let is_annotated = WORDS.iter().any(|word| text.contains(word));
        let items = if path.ends_with(".rs") && is_annotated {
            Items::of(text)?
        } else {
            Items::default()
        };
        Ok(Source {
            repository,
            path,
            lines: text.lines().collect(),
            items,
        })
    }

    /// The annotation that begins on a line, if one does.
    fn annotation(&self, line: usize) -> Result<Option<Annotation<'a>>, String> {
        let (text, ending) = (self.lines[line], ending(self.path));
        let said = comment(text, ending).unwrap_or_default();
        let begun = WORDS.into_iter().find_map(|word| {
            let listed = said.strip_prefix(word)?.strip_prefix(':')?;
            Some((word, listed.trim().to_string()))
        });
        let Some((word, mut listed)) = begun else {
            // A page may talk of annotations.
            if ending != "md" && names_an_id(text) {
                let text = text.trim();
                return Err(format!(
                    "{text:?} is no annotation: a comment of its own begins with \"Implements: \", \"Verifies: \" or \"Proves: \""
                ));
            }
            return Ok(None);
        };
        let mut end = line + 1;
        while listed.ends_with(',') && end < self.lines.len() {
            listed += " ";
            listed += comment(self.lines[end], ending).unwrap_or_default();
            end += 1;
        }
        let ids = listed.split_once('.').map(|(ids, _)| ids.split(", "));
        let ids = ids.filter(|ids| ids.clone().all(is_id)).ok_or_else(|| {
            format!("{said:?} is no annotation; it must be like \"{word}: ABC-001, ABC-002.\"")
        })?;
        Ok(Some(Annotation {
            word,
            ids: ids.map(String::from).collect(),
            text,
            end,
        }))
    }

    /// What an annotation is about.
    fn place(&self, annotation: &Annotation<'_>) -> Result<Place, String> {
        let (path, word) = (self.path, annotation.word);
        let is_rust = path.ends_with(".rs");
        match word {
            "Proves" if !path.starts_with("proofs/") => {
                Err("\"Proves:\" stands in proofs/ alone".into())
            }
            "Implements" if is_rust && !annotation.text.starts_with("//!") => {
                let items = self.items_below(annotation);
                let item = items
                    .into_iter()
                    .next()
                    .ok_or("below it stands no item, field or variant that it could be about")?;
                let owner = item.owner.map(|owner| owner + "::").unwrap_or_default();
                Ok(Place::Code(format!("{path} {owner}{}", item.name)))
            }
            "Implements" => Ok(Place::Code(path.into())),
            _ if is_rust && !path.starts_with("benches/") => self.tests(annotation),
            _ if path.starts_with("vectors/generator/") => self.vectors(annotation),
            _ => Ok(Place::Evidence([script(path, "")].into())),
        }
    }

    /// The items below an annotation; comments may lie between, an empty line may not.
    fn items_below(&self, annotation: &Annotation<'_>) -> Vec<Item> {
        let mut below = (annotation.end..).zip(&self.lines[annotation.end..]);
        match below.find(|(_, line)| !line.trim().starts_with("//")) {
            Some((at, line)) if !line.is_empty() => self.items.at(at + 1),
            _ => Vec::new(),
        }
    }

    /// The file of the vectors that the function below makes.
    fn vectors(&self, annotation: &Annotation<'_>) -> Result<Place, String> {
        let below = self.lines.get(annotation.end);
        let name = below.and_then(|below| below.strip_prefix("def ")?.split('(').next());
        let name = name.ok_or("it does not stand above a function that makes a group")?;
        let file = format!("vectors/{name}.json");
        if !self.repository.files.contains_key(&file) {
            return Err(format!("there is no {file}"));
        }
        Ok(Place::Vectors(file))
    }

    /// Test functions, or a scenario of the test on the HID stack.
    fn tests(&self, annotation: &Annotation<'_>) -> Result<Place, String> {
        let program = self.repository.program(self.path);
        let (id, modules) = program.ok_or("the file belongs to no program")?;
        let mut tests = BTreeMap::new();
        for item in self.items_below(annotation) {
            let function = item.name.as_str();
            let (name, evidence) = if item.is_test {
                let inner = item.modules.iter().map(String::as_str);
                let path: Vec<&str> = modules
                    .iter()
                    .copied()
                    .chain(inner)
                    .chain([function])
                    .collect();
                let ignored = item.is_ignored;
                (
                    format!("{id} {}", path.join("::")),
                    Evidence::Test { ignored },
                )
            } else if self.path.starts_with(GUEST) {
                script("tests/hid-stack/run", function)
            } else {
                return Err(format!("`{function}` below it has no #[test]"));
            };
            tests.insert(name, evidence);
        }
        if tests.is_empty() {
            return Err("it does not stand above a test function".into());
        }
        Ok(Place::Evidence(tests))
    }
}

/// A script, or a part of it.
fn script(path: &str, part: &str) -> (String, Evidence) {
    let name = format!("{path} {part}");
    (name.trim_end().into(), Evidence::Script(path.into()))
}

/// The scenarios that `tests/hid-stack/run` carries out in a guest; it fails if one of them does. The compiler tells of one that
/// is in no list of scenarios.
const GUEST: &str = "tests/hid-stack/src/";

/// What a line says as a comment: in Python every line counts, since docstrings have no mark.
fn comment<'a>(line: &'a str, ending: &str) -> Option<&'a str> {
    let line = line.trim();
    let said = match ending {
        "rs" | "js" => line.strip_prefix("//")?.trim_start_matches(['/', '!']),
        "c" => line.strip_prefix("/*")?.trim_end_matches("*/"),
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
