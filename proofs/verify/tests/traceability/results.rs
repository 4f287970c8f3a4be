//! What a test run found, from the files of its folder: `steps.tsv` of `.ci/run`, and the results of cargo-nextest in JUnit's
//! format.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use palpate_conform::sha256;
use palpate_verify::test_run::{End, Entry, SCHEMA, TestRun};
use roxmltree::Document;

use crate::annotations::{Evidence, Traceability};

/// How a test or step ended, and how long it took, s.
type Ended = (End, Option<f64>);

/// The results of a test run.
#[derive(Debug, Default)]
pub struct Results {
    /// The worst end of each test, by its program and name.
    tests: BTreeMap<String, Ended>,
    /// The steps by their commands; those that the run left to another are there as such.
    steps: BTreeMap<String, Ended>,
    /// What the run says of itself.
    facts: BTreeMap<String, String>,
    /// All that was read.
    text: String,
}

impl Results {
    /// Reads the folder of a run.
    ///
    /// # Errors
    /// A line that names the file and what is wrong with it.
    pub fn read(folder: &Path) -> Result<Results, String> {
        let mut results = Results::default();
        let entries =
            fs::read_dir(folder).map_err(|error| format!("{}: {error}", folder.display()))?;
        let mut paths: Vec<_> = entries.flatten().map(|entry| entry.path()).collect();
        paths.sort();
        for path in paths {
            let add = match path.extension().and_then(|extension| extension.to_str()) {
                Some("tsv") => Results::add_steps,
                Some("xml") => Results::add_junit,
                _ => continue,
            };
            let text = fs::read_to_string(&path).map_err(|error| error.to_string());
            let added = text.and_then(|text| add(&mut results, &text));
            added.map_err(|error| format!("{}: {error}", path.display()))?;
        }
        Ok(results)
    }

    /// Adds steps, a line each: `passed`, seconds and command, or `left`, nothing and command, with tabs between them. A line
    /// with another word is a fact about the run.
    pub fn add_steps(&mut self, text: &str) -> Result<(), String> {
        self.text += text;
        for line in text.lines() {
            let [word, seconds, what] = line.split('\t').collect::<Vec<_>>()[..] else {
                return Err(format!(
                    "{line:?} does not have three parts with tabs between them"
                ));
            };
            let end = match word {
                "passed" => End::Passed,
                "failed" => End::Failed,
                "left" => End::Left,
                _ => {
                    self.facts.insert(word.into(), what.into());
                    continue;
                }
            };
            self.steps.insert(what.into(), (end, seconds.parse().ok()));
        }
        Ok(())
    }

    /// Adds the tests that cargo-nextest ran.
    pub fn add_junit(&mut self, text: &str) -> Result<(), String> {
        self.text += text;
        let document = Document::parse(text).map_err(|error| error.to_string())?;
        let tests = document
            .descendants()
            .filter(|node| node.has_tag_name("testcase"));
        for test in tests {
            let suite = test.parent().and_then(|suite| suite.attribute("name"));
            let (Some(program), Some(name)) = (suite, test.attribute("name")) else {
                return Err("a test or its program has no name".into());
            };
            let has = |tag: &str| test.children().any(|child| child.has_tag_name(tag));
            let end = if has("failure") || has("error") {
                End::Failed
            } else if has("skipped") {
                End::Ignored
            } else {
                End::Passed
            };
            let seconds = test.attribute("time").and_then(|time| time.parse().ok());
            let ended = self
                .tests
                .entry(format!("{program} {name}"))
                .or_insert((end, seconds));
            if end > ended.0 {
                *ended = (end, seconds);
            }
        }
        Ok(())
    }

    /// What became of a test or proof.
    fn ended(&self, name: &str, evidence: &Evidence) -> Ended {
        let ran = match evidence {
            Evidence::Test { .. } => self.tests.get(name).copied(),
            Evidence::Script(path) => {
                let runs = self.steps.iter().filter(|(command, _)| runs(command, path));
                runs.map(|(_, ended)| *ended).max_by_key(|(end, _)| *end)
            }
        };
        match (ran, evidence) {
            (Some(ended), _) if ended.0 != End::Ignored => ended,
            (_, &Evidence::Test { ignored }) => {
                let mut left = self.steps.iter().filter(|(_, (end, _))| *end == End::Left);
                let end = match left.any(|(command, _)| runs_test(command, name, ignored)) {
                    true => End::Left,
                    false if ignored => End::Ignored,
                    false => End::Missing,
                };
                (end, None)
            }
            _ => (End::Missing, None),
        }
    }

    /// The tests and proofs of the requirements that did not run or did not pass, each with how and for which requirements.
    pub fn missing(&self, traceability: &Traceability) -> Vec<String> {
        let mut missing = Vec::new();
        for (name, evidence) in &traceability.evidence {
            let how = match self.ended(name, evidence).0 {
                End::Passed | End::Left => continue,
                End::Failed => "failed",
                End::Ignored => "has the attribute #[ignore], and no step ran it",
                End::Missing => "did not run",
            };
            let rows = traceability.requirements.iter();
            let ids = rows.filter(|row| row.tests.contains(name) || row.proofs.contains(name));
            let ids: Vec<&str> = ids.map(|row| row.id.as_str()).collect();
            missing.push(format!("{name} {how} ({})", ids.join(", ")));
        }
        missing
    }

    /// The test run: what became of the tests and proofs of the requirements, of all other tests, and of the steps.
    pub fn test_run(&self, traceability: &Traceability) -> TestRun {
        let mut ends = self.steps.clone();
        ends.extend(self.tests.clone());
        let traced = traceability.evidence.iter();
        ends.extend(traced.map(|(name, evidence)| (name.clone(), self.ended(name, evidence))));
        let entries = ends.into_iter().map(|(name, (result, seconds))| Entry {
            name,
            result,
            seconds,
        });
        let fact = |key: &str| {
            self.facts
                .get(key)
                .map_or("not known", String::as_str)
                .to_string()
        };
        TestRun {
            schema: SCHEMA.into(),
            commit: fact("commit"),
            began: fact("began"),
            ended: fact("ended"),
            system: fact("system"),
            results_sha256: sha256(&self.text),
            requirements: traceability.requirements.clone(),
            entries: entries.collect(),
        }
    }
}

/// Whether a command runs a script, a file of Gappa's or a bench: one of its words is the path, or `--bench` stands before the
/// bench's name.
fn runs(command: &str, path: &str) -> bool {
    let mut words = command.split_whitespace();
    words.clone().any(|word| word == path)
        || words.any(|word| word == "--bench")
            && words.next().is_some_and(|bench| {
                path.starts_with("benches/") && path.ends_with(&format!("/{bench}.rs"))
            })
}

/// Whether a command runs this test by cargo-nextest, which takes the ignored tests or the others: it names the test program
/// (`--test NAME`), or no test program, and the package (`-p NAME`) or all of them.
fn runs_test(command: &str, test: &str, ignored: bool) -> bool {
    let program = test.split(' ').next().unwrap_or_default();
    let (package, target) = program.split_once("::").unwrap_or((program, ""));
    let words: Vec<&str> = command.split_whitespace().collect();
    let after = |flag: &str, value: &str| words.windows(2).any(|pair| pair == [flag, value]);
    let is_named = if words.contains(&"--test") {
        after("--test", target)
    } else {
        words.contains(&"--workspace") || after("-p", package)
    };
    words.contains(&"nextest") && words.contains(&"--run-ignored") == ignored && is_named
}
