//! From each requirement to its code, tests, proofs and vectors.

use std::collections::{BTreeMap, BTreeSet};

use crate::annotation::{Annotation, Word, annotations};
use crate::crates::{Crate, Crates};
use crate::problem::Problem;
use crate::rust::{Item, item_below, names_by_macro};
use crate::scenarios::Scenarios;
use crate::sources::{Repository, Source};
use crate::spec::{Requirement, requirements};

/// How many requirements a person may inspect instead of a test (EVD-029).
pub const MOST_INSPECTED: usize = 10;

/// The script that runs everything.
const CI: &str = ".ci/run";

/// What shows that a test or proof has run.
#[derive(Debug, Clone, PartialEq)]
pub enum Evidence {
    /// A test function: cargo's line for `name` in the section of its crate.
    Test { krate: Crate, name: String },
    /// A scenario of the test on the HID stack: its lines, by their names.
    Scenario { lines: Vec<String> },
    /// A script, a bench or a Gappa file that `.ci/run` runs.
    Program { path: String },
    /// A step of `.ci/run`: the command.
    Step { command: String },
}

/// What the annotations say of one requirement.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Row {
    pub code: BTreeSet<String>,
    pub tests: BTreeSet<String>,
    pub proofs: BTreeSet<String>,
    pub vectors: BTreeSet<String>,
}

/// All requirements with what serves and what checks them.
#[derive(Debug, Default)]
pub struct Trace {
    pub requirements: Vec<Requirement>,
    pub rows: BTreeMap<String, Row>,
    /// Every test and proof that a row names.
    pub evidence: BTreeMap<String, Evidence>,
    pub problems: Vec<Problem>,
}

impl Trace {
    pub fn of(repository: &Repository) -> Trace {
        let mut problems = Vec::new();
        let requirements = requirements(&repository.chapters, &mut problems);
        let ids = requirements
            .iter()
            .map(|requirement| requirement.id.clone());
        let rows = ids.map(|id| (id, Row::default())).collect();
        let mut trace = Trace {
            requirements,
            rows,
            problems,
            ..Trace::default()
        };
        let crates = Crates::find(repository);
        let scenarios = Scenarios::find(repository);
        for source in &repository.sources {
            for annotation in annotations(source, &mut trace.problems) {
                let found = Place::of(repository, &crates, &scenarios, source, &annotation);
                match found {
                    Ok(place) => trace.enter(source, &annotation, place),
                    Err(message) => trace.refuse(source, &annotation, message),
                }
            }
        }
        trace.judge();
        trace
    }

    fn refuse(&mut self, source: &Source, annotation: &Annotation, message: String) {
        let problem = Problem::new(&source.path, annotation.line + 1, message);
        self.problems.push(problem);
    }

    /// Implements: EVD-021.
    fn enter(&mut self, source: &Source, annotation: &Annotation, place: Place) {
        for id in &annotation.ids {
            let Some(row) = self.rows.get_mut(id) else {
                let message = format!("no chapter in spec/ has a requirement {id}");
                self.refuse(source, annotation, message);
                continue;
            };
            let cell = match (&place, annotation.word) {
                (Place::Code(_), _) => &mut row.code,
                (Place::Vectors(_), _) => &mut row.vectors,
                (Place::Evidence(_), Word::Proves) => &mut row.proofs,
                (Place::Evidence(_), _) => &mut row.tests,
            };
            cell.extend(place.names());
        }
        if let Place::Evidence(evidence) = place {
            self.evidence.extend(evidence);
        }
    }

    /// Every requirement has code, and a test or proof.
    ///
    /// Implements: EVD-020, EVD-029.
    fn judge(&mut self) {
        for requirement in &self.requirements {
            let Requirement { id, chapter, .. } = requirement;
            let row = &self.rows[id];
            let tested = !row.tests.is_empty() || !row.proofs.is_empty();
            let mut refuse = |message: String| {
                let path = format!("spec/{chapter}");
                let problem = Problem::new(&path, requirement.line, message);
                self.problems.push(problem);
            };
            if row.code.is_empty() {
                refuse(format!(
                    "{id} has no code: nothing says \"Implements: {id}.\""
                ));
            }
            match (&requirement.inspection, tested) {
                (None, false) => refuse(format!(
                    "{id} has neither test nor proof: nothing says \"Verifies: {id}.\""
                )),
                (Some(_), true) => refuse(format!(
                    "{id} is marked \"by inspection\", but there is a test or proof of it"
                )),
                (Some(reason), false) if reason.is_empty() => {
                    refuse(format!("{id} does not say where it is inspected, and why"));
                }
                _ => {}
            }
        }
        let inspected = self.requirements.iter().filter(|r| r.inspection.is_some());
        let inspected: Vec<&str> = inspected.map(|r| r.id.as_str()).collect();
        if inspected.len() > MOST_INSPECTED {
            let message = format!(
                "{} requirements are marked \"by inspection\", at most {MOST_INSPECTED} may be: {}",
                inspected.len(),
                inspected.join(", ")
            );
            self.problems.push(Problem::new("spec", 0, message));
        }
    }
}

/// What an annotation stands at.
///
/// Implements: EVD-024.
enum Place {
    Code(String),
    Vectors(String),
    /// By name.
    Evidence(Vec<(String, Evidence)>),
}

impl Place {
    fn names(&self) -> Vec<String> {
        match self {
            Place::Code(name) | Place::Vectors(name) => vec![name.clone()],
            Place::Evidence(evidence) => evidence.iter().map(|(name, _)| name.clone()).collect(),
        }
    }

    /// Implements: EVD-024, EVD-026.
    fn of(
        repository: &Repository,
        crates: &Crates,
        scenarios: &Scenarios,
        source: &Source,
        annotation: &Annotation,
    ) -> Result<Place, String> {
        let path = source.path.as_str();
        let proof_folder = path.starts_with("proofs/");
        if annotation.word == Word::Proves && !proof_folder {
            return Err("\"Proves:\" stands in proofs/ alone".into());
        }
        let rust = source.extension() == "rs";
        match annotation.word {
            Word::Implements if rust => code(source, annotation),
            Word::Implements => Ok(Place::Code(path.into())),
            Word::Verifies if path.starts_with("vectors/generator/") => {
                vectors(repository, source, annotation)
            }
            _ if rust && !path.starts_with("benches/") => {
                test(crates, scenarios, source, annotation)
            }
            _ if path == CI => step(source, annotation),
            _ => program(repository, path),
        }
    }
}

fn code(source: &Source, annotation: &Annotation) -> Result<Place, String> {
    let path = &source.path;
    let line = source.text.lines().nth(annotation.line).unwrap_or_default();
    if line.starts_with("//!") {
        return Ok(Place::Code(path.clone()));
    }
    let item = item_below(&source.text, annotation.end)
        .ok_or("below it stands no item, field or variant that it could be about")?;
    let owner = item.owner.map(|owner| format!("{owner}::"));
    let owner = owner.unwrap_or_default();
    Ok(Place::Code(format!("{path} {owner}{}", item.name)))
}

fn test(
    crates: &Crates,
    scenarios: &Scenarios,
    source: &Source,
    annotation: &Annotation,
) -> Result<Place, String> {
    let item = item_below(&source.text, annotation.end)
        .filter(|item| item.kind == "fn")
        .ok_or("it does not stand above a test function")?;
    let places = crates.places.get(&source.path).ok_or(
        "the file belongs to no crate: no `mod` leads to it, so that nothing in it can run",
    )?;
    if !item
        .attributes
        .iter()
        .any(|attribute| attribute == "#[test]")
    {
        return scenario(scenarios, source, places, &item);
    }
    let functions = if item.name.starts_with('$') {
        names_by_macro(&source.text, annotation.line)
    } else {
        vec![item.name]
    };
    let mut named = Vec::new();
    for (krate, module) in places {
        for function in &functions {
            let path = [module.clone(), item.modules.clone(), vec![function.clone()]];
            let (krate, name) = (krate.clone(), path.concat().join("::"));
            let key = format!("{}::{name}", krate.root);
            named.push((key, Evidence::Test { krate, name }));
        }
    }
    if named.is_empty() {
        return Err("nothing calls the macro that makes the test".into());
    }
    Ok(Place::Evidence(named))
}

/// Implements: EVD-027.
fn scenario(
    scenarios: &Scenarios,
    source: &Source,
    places: &[(Crate, Vec<String>)],
    item: &Item,
) -> Result<Place, String> {
    let Item { name, .. } = item;
    if !source.path.starts_with("tests/hid-stack/") {
        return Err(format!("`{name}` below it has no #[test]"));
    }
    let lines = scenarios.lines_of(name);
    if lines.is_empty() {
        return Err(format!("no list `ALL` of scenarios runs `{name}`"));
    }
    let (krate, module) = &places[0];
    let path = [module.clone(), vec![name.clone()]].concat().join("::");
    let key = format!("{}::{path}", krate.root);
    Ok(Place::Evidence(vec![(key, Evidence::Scenario { lines })]))
}

/// The group of vectors that the function below the annotation makes: the file of its name.
fn vectors(
    repository: &Repository,
    source: &Source,
    annotation: &Annotation,
) -> Result<Place, String> {
    let below = source.text.lines().nth(annotation.end).unwrap_or_default();
    let name = below
        .strip_prefix("def ")
        .and_then(|def| def.split_once('('));
    let (name, _) = name.ok_or("it does not stand above a function that makes a group")?;
    let file = format!("vectors/{name}.json");
    if repository.vectors.contains(&file) {
        Ok(Place::Vectors(file))
    } else {
        Err(format!("there is no {file}"))
    }
}

/// The step of `.ci/run` below the annotation.
fn step(source: &Source, annotation: &Annotation) -> Result<Place, String> {
    let below = source.text.lines().nth(annotation.end).unwrap_or_default();
    let command = below
        .strip_prefix("step ")
        .ok_or("it does not stand above a step")?;
    let command = command.to_string();
    let name = format!("{CI} {command}");
    Ok(Place::Evidence(vec![(name, Evidence::Step { command })]))
}

/// A script, a bench or a Gappa file as a whole.
///
/// Implements: EVD-027.
fn program(repository: &Repository, path: &str) -> Result<Place, String> {
    let run = repository.source(CI).map_or("", |run| &run.text);
    let commands = run.lines().filter(|line| !line.trim().starts_with('#'));
    if commands.into_iter().any(|line| names_program(line, path)) {
        let path = path.to_string();
        let evidence = Evidence::Program { path: path.clone() };
        Ok(Place::Evidence(vec![(path, evidence)]))
    } else {
        Err(format!(
            "{path} is no evidence of its own: .ci/run does not run it (if a cargo test does, annotate that one)"
        ))
    }
}

/// Whether a command names this program: by its path, which may hold one `*`, or as `--bench NAME`.
pub fn names_program(command: &str, path: &str) -> bool {
    let bench = path.strip_prefix("benches/");
    let bench = bench.and_then(|bench| bench.strip_suffix(".rs"));
    let words: Vec<&str> = command
        .split_whitespace()
        .map(|word| word.trim_matches(['"', ';']))
        .collect();
    let by_path = words.iter().any(|word| match word.split_once('*') {
        Some((start, end)) => start.contains('/') && path.starts_with(start) && path.ends_with(end),
        None => *word == path,
    });
    let by_bench = bench.is_some_and(|bench| {
        let mut pairs = words.windows(2);
        pairs.any(|pair| pair == ["--bench", bench])
    });
    by_path || by_bench
}
