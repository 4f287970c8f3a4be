//! What a test run's output says of the tests of the trace.

use std::collections::{BTreeMap, BTreeSet};

use palpate_verify::record::{End, Entry, Record, SCHEMA};
use sha2::Digest;

use crate::elsewhere::runner;
use crate::trace::Trace;

/// The output of one or more runs.
#[derive(Debug, Default)]
pub struct Log {
    /// The worst end of each test by its program and name, except that a test that one run ignores may pass in another. What
    /// succeeded otherwise is there by its line, and each word of a command, since that may name a script.
    ends: BTreeMap<String, Ended>,
    /// The commands that the run left to another.
    left: Vec<String>,
    /// What the run says of itself, in lines `== KEY: VALUE`.
    said: BTreeMap<String, String>,
    /// The SHA-256 of what was read.
    digest: sha2::Sha256,
}

/// How a test or step ended, and how long it took: of a test, all tests of its program.
#[derive(Debug, Clone, Copy)]
struct Ended {
    end: End,
    seconds: Option<f64>,
}

impl Log {
    /// Adds the output of a run, standard output and standard error in one, so that the lines in which cargo names a
    /// test program stand above those of its tests.
    pub fn read(&mut self, output: &str) {
        self.digest.update(output);
        let mut program = None;
        // The tests of the program that runs, and how long the step took that ends next.
        let (mut of_program, mut of_step) = (Vec::new(), None);
        // A test whose end stands in another line, since something was printed in between.
        let mut begun: Option<&str> = None;
        for line in without_colours(output).lines() {
            if let Some(running) = line.trim_start().strip_prefix("Running ") {
                program = test_program(running);
                of_program.clear();
            } else if line.trim_start().starts_with("Doc-tests ") || line.starts_with("== ") {
                program = None;
            }
            if let Some(program) = &program
                && let Some((name, end)) = test_line(line, &mut begun)
            {
                of_program.push(format!("{program} {name}"));
                self.note(format!("{program} {name}"), end, None);
            }
            let finished = line.rsplit_once("; finished in ");
            if let Some((_, took)) = finished {
                self.took(&of_program, took.trim_end_matches('s').parse().ok());
            }
            match line.strip_prefix("== ") {
                Some(said) => self.step(said, line, &mut of_step),
                None => self.scenario(line),
            }
        }
    }

    /// A line of `.ci/run` after its `== `; `seconds` is what the line before said that a step took.
    fn step(&mut self, said: &str, line: &str, seconds: &mut Option<f64>) {
        if let Some(took) = said.strip_suffix(" s") {
            *seconds = took.parse().ok();
        } else if let Some(command) = said.strip_prefix("ok: ") {
            let bench = command.split_once("--bench ");
            let bench = bench.map(|(_, name)| format!("benches/{name}.rs"));
            let words = command.split_whitespace().map(String::from);
            for what in words.chain(bench).chain([line.into()]) {
                self.note(what, End::Passed, *seconds);
            }
            *seconds = None;
        } else if let Some(left) = said.strip_prefix("left to .ci/run all: ") {
            self.left.push(left.into());
        } else if let Some((key, value)) = said.split_once(": ") {
            self.said.insert(key.into(), value.into());
        }
    }

    /// A line of the test on the HID stack that names a scenario.
    fn scenario(&mut self, line: &str) {
        let passed = line.strip_prefix("hid-stack: ok ");
        if let Some((name, _)) = passed.and_then(|name| name.split_once(':')) {
            let what = format!("hid-stack: ok {}", name.trim_start());
            self.note(what, End::Passed, None);
        }
    }

    fn note(&mut self, what: String, end: End, seconds: Option<f64>) {
        let noted = self.ends.entry(what).or_insert(Ended { end, seconds });
        noted.end = end.max(noted.end);
    }

    fn took(&mut self, tests: &[String], seconds: Option<f64>) {
        for test in tests {
            if let Some(ended) = self.ends.get_mut(test) {
                ended.seconds = seconds;
            }
        }
    }

    /// What runs a test or proof, if that was left to another run.
    fn left_to(&self, name: &str) -> Option<&'static str> {
        runner(name).filter(|command| self.left.iter().any(|left| left.contains(command)))
    }

    /// The tests and proofs of the trace that did not run or did not pass, each with how and for which requirements.
    pub fn missing(&self, trace: &Trace) -> Vec<String> {
        let mut missing = Vec::new();
        for (name, lines) in &trace.evidence {
            let left = self.left_to(name);
            let missed =
                lines
                    .iter()
                    .find_map(|line| match self.ends.get(line).map(|ended| ended.end) {
                        Some(End::Passed) => None,
                        Some(End::Ignored) if left.is_some() => None,
                        Some(End::Ignored) => Some("was ignored in every run".into()),
                        Some(End::Failed) => Some("failed".into()),
                        // Of a script nothing is in the output; a test that cargo leaves out is there as ignored.
                        None if left.is_some_and(|command| !command.starts_with("cargo")) => None,
                        Some(_) => Some("did not run".into()),
                        None => Some(format!("did not run: the log has no \"{line}\"")),
                    });
            if let Some(how) = missed {
                let rows = trace.requirements.iter();
                let ids = rows.filter(|row| row.tests.contains(name) || row.proofs.contains(name));
                let ids: Vec<&str> = ids.map(|row| row.id.as_str()).collect();
                missing.push(format!("{name} {how} ({})", ids.join(", ")));
            }
        }
        missing
    }

    /// The record of the run: the tests and proofs of the trace by their names there, the other tests by program and name, and the steps.
    pub fn record(self, trace: &Trace) -> Record {
        let mut entries: Vec<Entry> = trace
            .evidence
            .iter()
            .map(|(name, lines)| self.entry(name, lines))
            .collect();
        let known: BTreeSet<&String> = trace.evidence.values().flatten().collect();
        let others = self
            .ends
            .iter()
            .filter(|(line, _)| !known.contains(line) && line.contains(' '));
        entries.extend(others.map(|(line, ended)| Entry {
            name: line.clone(),
            result: ended.end,
            seconds: ended.seconds,
        }));
        let said = |key: &str| {
            self.said
                .get(key)
                .cloned()
                .unwrap_or_else(|| "not known".into())
        };
        Record {
            schema: SCHEMA.into(),
            commit: said("commit"),
            began: said("began"),
            ended: said("ended"),
            system: said("system"),
            entries,
            log_sha256: self
                .digest
                .finalize()
                .iter()
                .map(|byte| format!("{byte:02x}"))
                .collect(),
        }
    }

    /// A test or proof of the trace, whose end is the worst of its lines.
    fn entry(&self, name: &str, lines: &[String]) -> Entry {
        let found = |line: &String| {
            self.ends.get(line).copied().unwrap_or(Ended {
                end: End::Missing,
                seconds: None,
            })
        };
        let ended: Vec<Ended> = lines.iter().map(found).collect();
        let failed = ended.iter().any(|ended| ended.end == End::Failed);
        let worst = ended
            .iter()
            .map(|ended| ended.end)
            .min()
            .unwrap_or(End::Missing);
        let result = match worst {
            _ if failed => End::Failed,
            End::Missing | End::Ignored if self.left_to(name).is_some() => End::Left,
            worst => worst,
        };
        Entry {
            name: name.into(),
            result,
            seconds: ended
                .iter()
                .filter_map(|ended| ended.seconds)
                .reduce(f64::max),
        }
    }
}

/// Name and root of the program of `unittests src/lib.rs (target/debug/deps/palpate-0123)`.
fn test_program(running: &str) -> Option<String> {
    let (root, file) = running.strip_suffix(')')?.split_once(" (")?;
    let root = root.strip_prefix("unittests ").unwrap_or(root);
    let (name, _) = file.rsplit('/').next()?.rsplit_once('-')?;
    Some(format!("{name} {root}"))
}

/// Name and end of `test a::b ... ok`; of `test a::b - should panic ... ok` as well. Where something else follows the dots,
/// the name is `begun`, and the next line that is an end belongs to it.
fn test_line<'a>(line: &'a str, begun: &mut Option<&'a str>) -> Option<(&'a str, End)> {
    let test = line.strip_prefix("test ");
    let Some((name, rest)) = test.and_then(|test| test.split_once(" ... ")) else {
        return begun.take_if(|_| end(line).is_some()).zip(end(line));
    };
    let name = name.split(" - ").next()?;
    *begun = Some(name);
    begun.take_if(|_| end(rest).is_some()).zip(end(rest))
}

fn end(text: &str) -> Option<End> {
    match text.split([',', ' ']).next()? {
        "ok" => Some(End::Passed),
        "FAILED" => Some(End::Failed),
        "ignored" => Some(End::Ignored),
        _ => None,
    }
}

/// The text without the sequences `ESC [ … m` of a terminal.
fn without_colours(text: &str) -> String {
    let mut parts = text.split("\u{1b}[");
    let mut plain: String = parts.next().unwrap_or_default().into();
    for part in parts {
        plain.push_str(part.split_once('m').map_or("", |(_, after)| after));
    }
    plain
}
