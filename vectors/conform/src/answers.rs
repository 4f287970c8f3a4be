//! The cases that are asked, and which case a line answers.

use std::collections::{HashSet, VecDeque};

use serde::Deserialize;
use serde_json::Value;

use super::case::{Case, Group, Question};
use super::judge::judge;
use super::outcome::{Class, Outcome};
use super::profile::Profile;
use super::suite::Suite;
use super::text::{cut, shortened};

/// The first request.
pub const CAPABILITIES: &str = r#"{"args":{},"id":"capabilities","op":"capabilities"}"#;

/// What a program claims to be able to do.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
pub struct Capabilities {
    version: Value,
    /// The ops that it claims.
    pub ops: Vec<String>,
}

impl Capabilities {
    /// Those of a line, if it is the answer to [`CAPABILITIES`].
    pub fn read(line: &[u8]) -> Option<Capabilities> {
        #[derive(Deserialize)]
        struct Answer {
            id: String,
            ok: Capabilities,
        }
        let answer: Answer = serde_json::from_slice(line).ok()?;
        (answer.id == "capabilities").then_some(answer.ok)
    }

    /// What the program calls its version.
    pub fn version(&self) -> String {
        let text = self.version.as_str().map(str::to_string);
        text.unwrap_or_else(|| self.version.to_string())
    }
}

/// The cases of a suite: those to ask, those that are open, and the outcomes.
pub struct Answers<'a> {
    cases: Vec<(&'a Group, &'a Case)>,
    /// The outcome of each case.
    outcomes: Vec<Option<Outcome>>,
    /// Cases to be asked, by their index, the next one first.
    queue: VecDeque<usize>,
    /// Cases that were asked and have no answer yet, by their index, the oldest first.
    open: VecDeque<usize>,
    /// What else the verdict should say.
    pub notes: Vec<String>,
    profile: &'a Profile,
    /// Whether a line that is no answer is ignored.
    pub lenient: bool,
    /// The ids of cases that are judged.
    judged: HashSet<&'a str>,
}

impl<'a> Answers<'a> {
    /// No answers yet; groups and cases are skipped by name.
    ///
    /// Implements: ORA-040.
    pub fn new(suite: &'a Suite, skip: &[String], profile: &'a Profile, lenient: bool) -> Self {
        let of_group = |group: &'a Group| group.cases.iter().map(move |case| (group, case));
        let cases: Vec<_> = suite.groups.iter().flat_map(of_group).collect();
        let left_out = |(group, case): &(&Group, &Case)| {
            let is_left_out = skip.contains(&case.id) || skip.contains(&group.name);
            is_left_out.then(|| Outcome::Skipped("left out by --skip".into()))
        };
        Answers {
            outcomes: cases.iter().map(left_out).collect(),
            cases,
            queue: VecDeque::new(),
            open: VecDeque::new(),
            notes: Vec::new(),
            profile,
            lenient,
            judged: HashSet::new(),
        }
    }

    /// Skips the groups whose op the program does not claim, and queues the rest. Lines of no op are for every program.
    ///
    /// Implements: ORA-048.
    pub fn claim(&mut self, ops: &[String]) {
        for (index, (group, _)) in self.cases.iter().enumerate() {
            let is_claimed = group.op.is_empty() || ops.contains(&group.op);
            match &mut self.outcomes[index] {
                Some(_) => {}
                None if is_claimed => self.queue.push_back(index),
                outcome => {
                    *outcome = Some(Outcome::Unclaimed(group.op.clone()));
                }
            }
        }
    }

    /// Takes the ops with an answer for those that the program claims, and queues their cases.
    pub fn claim_answered(&mut self, is_answered: impl Fn(&str) -> bool) {
        let answered = self.cases.iter().filter(|(_, case)| is_answered(&case.id));
        let mut ops: Vec<String> = answered.map(|(group, _)| group.op.clone()).collect();
        ops.dedup();
        self.claim(&ops);
    }

    /// Opens the next case and returns its request.
    pub fn ask(&mut self) -> Option<String> {
        let index = self.queue.pop_front()?;
        self.open.push_back(index);
        let (group, case) = self.cases[index];
        Some(case.line(&group.op))
    }

    /// Puts the open cases back, to be asked again.
    pub fn take_back(&mut self) {
        while let Some(last) = self.open.pop_back() {
            self.queue.push_front(last);
        }
    }

    /// The number of cases that are to be asked.
    pub fn queued(&self) -> usize {
        self.queue.len()
    }

    /// The number of cases that were asked and have no answer yet.
    pub fn open(&self) -> usize {
        self.open.len()
    }

    /// Finds out which case a line answers, and judges it. False for a line that answers no open case.
    ///
    /// Implements: ORA-043.
    pub fn take(&mut self, line: &[u8]) -> bool {
        let Some(&oldest) = self.open.front() else {
            return false;
        };
        let answer = match serde_json::from_slice::<Value>(line) {
            Ok(answer) if answer.is_object() || !self.lenient => answer,
            _ => {
                let line = String::from_utf8_lossy(line);
                if self.lenient {
                    self.notes.push(ignored(&line));
                } else {
                    self.fail(format!("answered with no JSON: {}", cut(&line)));
                }
                return !self.lenient;
            }
        };
        let id = answer.get("id").unwrap_or(&Value::Null);
        let name = id.as_str().unwrap_or_default();
        let mut open = self.open.iter();
        if let Some(place) = open.position(|&index| self.cases[index].1.id == name) {
            for _ in 0..place {
                self.fail(format!("no answer: the next one was for {name}"));
            }
            self.settle(|case, profile| judge(case, &answer, profile));
            return true;
        }
        if self.judged.contains(name) {
            return false; // A late answer, whose case has failed already.
        }
        let (_, case) = self.cases[oldest];
        let reason = format!(
            "answered with the id {} instead of {:?}: {}",
            shortened(id),
            case.id,
            shortened(&answer)
        );
        self.settle(|case, profile| match judge(case, &answer, profile) {
            // Without an id the order says what was answered.
            outcome if id.is_null() && matches!(case.question, Question::Line(_)) => outcome,
            Outcome::Right if id.is_null() => Outcome::Acceptable(reason),
            _ => Outcome::wrong(Class::Protocol, reason),
        });
        true
    }

    /// The oldest open case has no valid answer.
    pub fn fail(&mut self, reason: impl Into<String>) {
        self.settle(|_, _| Outcome::wrong(Class::Protocol, reason));
    }

    /// Judges the oldest open case.
    pub fn settle(&mut self, judge: impl FnOnce(&Case, &Profile) -> Outcome) {
        if let Some(index) = self.open.pop_front() {
            let (_, case) = self.cases[index];
            self.judged.insert(&case.id);
            self.outcomes[index] = Some(judge(case, self.profile));
        }
    }

    /// The number of cases that are judged.
    pub fn settled(&self) -> usize {
        self.judged.len()
    }

    /// The outcomes of all cases, and the notes; a case without an outcome is wrong for the reason `never`.
    pub fn outcomes(self, never: &str) -> (Vec<Outcome>, Vec<String>) {
        let never = || Outcome::wrong(Class::Protocol, never);
        let outcomes = self.outcomes.into_iter();
        let outcomes = outcomes.map(|outcome| outcome.unwrap_or_else(never));
        (outcomes.collect(), self.notes)
    }
}

/// The note on a line that is ignored.
pub fn ignored(line: &str) -> String {
    format!("ignored, since it is no answer: {}", cut(line))
}
