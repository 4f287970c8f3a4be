//! What a test run's output says of the tests of the trace.

use std::collections::{BTreeMap, BTreeSet};

use crate::elsewhere::runner;
use crate::trace::Trace;
use palpate_conform::sha256;
use palpate_verify::record::{End, Entry, Record, SCHEMA};

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
    /// What was read.
    output: Vec<u8>,
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
    pub fn read(&mut self, output: impl AsRef<[u8]>) {
        self.output.extend(output.as_ref());
        let output = String::from_utf8_lossy(output.as_ref());
        let mut program = None;
        // The tests of the program that runs, and how long the step took that ends next.
        let (mut of_program, mut of_step) = (Vec::new(), None);
        // A test whose end stands in another line, since something was printed in between.
        let mut begun: Option<&str> = None;
        for line in without_colours(&output).lines() {
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
            let how = match self.entry(name, lines).result {
                End::Passed | End::Left => continue,
                End::Failed => "failed".into(),
                End::Ignored => "was ignored in every run".into(),
                End::Missing => {
                    let absent = lines.iter().find(|&line| !self.ends.contains_key(line));
                    format!("did not run: the log has no {:?}", absent.unwrap_or(name))
                }
            };
            let rows = trace.requirements.iter();
            let ids = rows.filter(|row| row.tests.contains(name) || row.proofs.contains(name));
            let ids: Vec<&str> = ids.map(|row| row.id.as_str()).collect();
            missing.push(format!("{name} {how} ({})", ids.join(", ")));
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
            log_sha256: sha256(self.output),
        }
    }

    /// A test or proof of the trace, whose end is the worst of its lines.
    fn entry(&self, name: &str, lines: &[String]) -> Entry {
        let left = self.left_to(name);
        let found: Vec<Option<&Ended>> = lines.iter().map(|line| self.ends.get(line)).collect();
        let ends = found.iter().map(|found| match (found, left) {
            (Some(ended), Some(_)) if ended.end == End::Ignored => End::Left,
            (Some(ended), _) => ended.end,
            // Of a script nothing is in the output; a test that cargo leaves out is there as ignored.
            (None, Some(command)) if !command.starts_with("cargo") => End::Left,
            (None, _) => End::Missing,
        });
        let ends: Vec<End> = ends.collect();
        let failed = ends.contains(&End::Failed).then_some(End::Failed);
        let worst = failed.or(ends.into_iter().min());
        let seconds = found.iter().filter_map(|found| found.as_ref()?.seconds);
        Entry {
            name: name.into(),
            result: worst.unwrap_or(End::Missing),
            seconds: seconds.reduce(f64::max),
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
