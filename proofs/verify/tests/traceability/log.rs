//! What a test run's output says of the tests of the trace.

use std::collections::BTreeMap;

use crate::trace::{Evidence, Trace, names_program};

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
    /// By the root as cargo shows it, the name of the crate and the name of the test: the worst end, except that a
    /// test that one run ignores may pass in another.
    tests: BTreeMap<(String, String, String), End>,
    /// Scenarios that passed.
    scenarios: Vec<String>,
    /// Commands of `.ci/run` that succeeded.
    commands: Vec<String>,
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
            if let Some((root, krate)) = &program
                && let Some((name, end)) = test_line(line, &mut begun)
            {
                let key = (root.clone(), krate.clone(), name.into());
                let noted = self.tests.entry(key).or_insert(end);
                *noted = end.max(*noted);
            }
            if let Some(command) = line.strip_prefix("== ok: ") {
                self.commands.push(command.into());
            }
            if let Some(rest) = line.strip_prefix("hid-stack: ok") {
                let name = rest.trim_start().split_once(':');
                self.scenarios.extend(name.map(|(name, _)| name.into()));
            }
        }
    }

    /// The tests and proofs of the trace that did not run or did not pass, each with how and for which requirements.
    ///
    /// Implements: EVD-031.
    pub fn missing(&self, trace: &Trace) -> Vec<String> {
        let mut missing = Vec::new();
        for (name, evidence) in &trace.evidence {
            if let Some(how) = self.missed(evidence) {
                let rows = trace.rows.iter();
                let ids =
                    rows.filter(|(_, row)| row.tests.contains(name) || row.proofs.contains(name));
                let ids: Vec<&str> = ids.map(|(id, _)| id.as_str()).collect();
                missing.push(format!("{name} {how} ({})", ids.join(", ")));
            }
        }
        missing
    }

    /// What the log says instead of "passed"; nothing if it says so.
    fn missed(&self, evidence: &Evidence) -> Option<String> {
        match evidence {
            Evidence::Test { krate, name } => {
                let key = (krate.shown.clone(), krate.name.clone(), name.clone());
                match self.tests.get(&key) {
                    Some(End::Ok) => None,
                    Some(End::Ignored) => Some("was ignored in every run".into()),
                    Some(End::Failed) => Some("failed".into()),
                    None => Some("did not run: it is not in the log".into()),
                }
            }
            Evidence::Scenario { lines } => {
                let absent = lines.iter().find(|line| !self.scenarios.contains(line))?;
                Some(format!("did not run: no line \"hid-stack: ok {absent}\""))
            }
            Evidence::Step { command } => {
                let ran = self.commands.contains(command);
                (!ran).then(|| format!("did not run: no line \"== ok: {command}\""))
            }
            Evidence::Program { path } => {
                let mut commands = self.commands.iter();
                let ran = commands.any(|command| names_program(command, path));
                (!ran).then(|| "did not run: no line \"== ok: …\" names it".into())
            }
        }
    }
}

/// Root and name of the crate of `unittests src/lib.rs (target/debug/deps/palpate-0123)`.
fn test_program(running: &str) -> Option<(String, String)> {
    let (root, file) = running.strip_suffix(')')?.split_once(" (")?;
    let root = root.strip_prefix("unittests ").unwrap_or(root);
    let name = file.rsplit(['/', '\\']).next()?;
    let (name, _) = name.rsplit_once('-')?;
    Some((root.replace('\\', "/"), name.into()))
}

/// Name and end of `test a::b ... ok`; of `test a::b - should panic ... ok` as well. Where something else follows the dots,
/// the name is `begun`, and the next line that is an end belongs to it.
fn test_line<'a>(line: &'a str, begun: &mut Option<&'a str>) -> Option<(&'a str, End)> {
    let Some((name, rest)) = line
        .strip_prefix("test ")
        .and_then(|test| test.split_once(" ... "))
    else {
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
