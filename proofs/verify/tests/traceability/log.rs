//! What a test run's output says of the tests of the trace.

use std::collections::BTreeMap;

use crate::elsewhere::runner;
use crate::trace::Trace;

/// How a test ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum End {
    Ignored,
    Ok,
    Failed,
}

/// The output of one or more runs.
#[derive(Debug, Default)]
pub struct Log {
    /// The worst end of each test by its program and name, except that a test that one run ignores may pass in another. What
    /// succeeded otherwise is there by its line, and each word of a command, since that may name a script.
    ends: BTreeMap<String, End>,
    /// The commands that the run left to another.
    left: Vec<String>,
}

impl Log {
    /// Adds the output of a run, standard output and standard error in one, so that the lines in which cargo names a
    /// test program stand above those of its tests.
    pub fn read(&mut self, output: &str) {
        let output = without_colours(output);
        let mut program = None;
        // A test whose end stands in another line, since something was printed in between.
        let mut begun: Option<&str> = None;
        for line in output.lines() {
            if let Some(running) = line.trim_start().strip_prefix("Running ") {
                program = test_program(running);
            } else if line.trim_start().starts_with("Doc-tests ") || line.starts_with("== ") {
                program = None;
            }
            if let Some(program) = &program
                && let Some((name, end)) = test_line(line, &mut begun)
            {
                self.note(format!("{program} {name}"), end);
            }
            if let Some(command) = line.strip_prefix("== ok: ") {
                let bench = command.split_once("--bench ");
                let bench = bench.map(|(_, name)| format!("benches/{name}.rs"));
                let words = command.split_whitespace().map(String::from);
                for what in words.chain(bench).chain([line.into()]) {
                    self.note(what, End::Ok);
                }
            }
            let left = line.strip_prefix("== left to .ci/run all: ");
            self.left.extend(left.map(String::from));
            let passed = line.strip_prefix("hid-stack: ok ");
            if let Some((passed, _)) = passed.and_then(|name| name.split_once(':')) {
                self.note(format!("hid-stack: ok {}", passed.trim_start()), End::Ok);
            }
        }
    }

    fn note(&mut self, what: String, end: End) {
        let noted = self.ends.entry(what).or_insert(end);
        *noted = end.max(*noted);
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
            let missed = lines.iter().find_map(|line| match self.ends.get(line) {
                Some(End::Ok) => None,
                Some(End::Ignored) if left.is_some() => None,
                Some(End::Ignored) => Some("was ignored in every run".into()),
                Some(End::Failed) => Some("failed".into()),
                // Of a script nothing is in the output; a test that cargo leaves out is there as ignored.
                None if left.is_some_and(|command| !command.starts_with("cargo")) => None,
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
        "ok" => Some(End::Ok),
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
