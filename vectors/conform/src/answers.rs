//! Which case a line answers.

use std::collections::{HashSet, VecDeque};

use serde_json::Value;

use super::case::{Case, Question};
use super::judge::judge;
use super::plan::Plan;
use super::profile::Profile;
use super::suite::Suite;
use super::text::{cut, shortened};
use super::verdict::{Class, Outcome};

/// Cases that were asked, and what became of them.
pub struct Answers<'a> {
    /// The cases.
    pub cases: Vec<&'a Case>,
    /// What became of each.
    pub outcomes: Vec<Option<Outcome>>,
    /// Cases that were asked and have no answer yet, the oldest first.
    pub waiting: VecDeque<usize>,
    /// What else there is to say.
    pub notes: Vec<String>,
    profile: &'a Profile,
    /// Whether a line that is no answer is passed over.
    lenient: bool,
    /// The ids of cases that are judged.
    judged: HashSet<&'a str>,
}

impl<'a> Answers<'a> {
    /// Of these cases, none of which is asked yet.
    pub fn new(cases: Vec<&'a Case>, profile: &'a Profile, lenient: bool) -> Answers<'a> {
        Answers {
            outcomes: vec![None; cases.len()],
            waiting: VecDeque::new(),
            notes: Vec::new(),
            profile,
            lenient,
            judged: HashSet::new(),
            cases,
        }
    }

    /// Finds out which case a line answers, and judges it. False for a line that answers nothing
    /// that is still open.
    ///
    /// Implements: ORA-043.
    pub fn take(&mut self, line: &[u8]) -> bool {
        let answer = serde_json::from_slice::<Value>(line);
        let Some(&oldest) = self.waiting.front() else {
            return false;
        };
        let answer = match answer {
            Ok(answer) if answer.is_object() || !self.lenient => answer,
            _ => {
                let text = cut(&String::from_utf8_lossy(line));
                if self.lenient {
                    self.notes
                        .push(format!("passed over, since it is no answer: {text}"));
                    return false;
                }
                self.fail(format!("answered with no JSON: {text}"));
                return true;
            }
        };
        let id = answer.get("id").unwrap_or(&Value::Null);
        let name = id.as_str().unwrap_or_default();
        if let Some(place) = self
            .waiting
            .iter()
            .position(|&index| self.cases[index].id == name)
        {
            for _ in 0..place {
                self.fail(format!("no answer: the next one was for {name}"));
            }
            self.settle(judge(self.cases[self.waiting[0]], &answer, self.profile));
            return true;
        }
        if self.judged.contains(name) {
            return false; // a late answer, whose case has failed already
        }
        let case = self.cases[oldest];
        let (found, wanted) = (shortened(id), Value::from(&case.id[..]));
        let reason = format!(
            "answered with the id {found}, expected {wanted}: {}",
            shortened(&answer)
        );
        self.settle(match judge(case, &answer, self.profile) {
            // Without an id the order says what was answered.
            outcome if id.is_null() && matches!(case.question, Question::Line(_)) => outcome,
            Outcome::Right if id.is_null() => Outcome::Acceptable(reason),
            _ => Outcome::wrong(Class::Protocol, reason),
        });
        true
    }

    /// The oldest open case has no answer that is one.
    pub fn fail(&mut self, reason: String) {
        self.settle(Outcome::wrong(Class::Protocol, reason));
    }

    /// The oldest open case has this outcome.
    fn settle(&mut self, outcome: Outcome) {
        if let Some(index) = self.waiting.pop_front() {
            self.judged.insert(&self.cases[index].id);
            self.outcomes[index] = Some(outcome);
        }
    }

    /// How many cases are judged.
    pub fn settled(&self) -> usize {
        self.judged.len()
    }
}

/// What all cases of a suite are judged to be by lines of answers in their order; a case without an answer is wrong.
///
/// Implements: ORA-043.
pub fn judge_lines(suite: &Suite, lines: &[u8], profile: &Profile) -> Vec<Vec<Outcome>> {
    let plan = Plan::new(suite, &[], |_| true);
    let lines = lines.split(|&byte| byte == b'\n');
    judge_planned(suite, plan, lines, profile, false).0
}

/// The outcomes of all cases, and notes, by lines of answers to those that the plan asks.
pub fn judge_planned<'a>(
    suite: &Suite,
    plan: Plan,
    lines: impl IntoIterator<Item = &'a [u8]>,
    profile: &Profile,
    lenient: bool,
) -> (Vec<Vec<Outcome>>, Vec<String>) {
    let mut answers = Answers::new(plan.cases(suite), profile, lenient);
    answers.waiting = (0..answers.cases.len()).collect();
    for line in lines {
        answers.take(line);
    }
    (plan.outcomes(answers.outcomes, "no answer"), answers.notes)
}
