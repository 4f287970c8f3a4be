//! What came out.

use serde::Serialize;

use super::suite::Suite;

/// What became of one case.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Outcome {
    /// The right answer.
    Passed,
    /// Refused, as it must be.
    Refused,
    /// A wrong answer, or none.
    Failed {
        /// What was wrong.
        reason: String,
        /// The flags of the bugs that would do so.
        bugs: Vec<String>,
    },
    /// Not asked: the program does not claim the op.
    Skipped,
}

impl Outcome {
    /// A failure that tells of no certain bug.
    pub fn failed(reason: impl Into<String>) -> Outcome {
        let reason = reason.into();
        Outcome::Failed {
            reason,
            bugs: Vec::new(),
        }
    }
}

/// The cases of one group, counted.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Count {
    /// The group.
    pub group: String,
    /// Its op.
    pub op: String,
    /// All its cases.
    pub cases: usize,
    /// Right answers.
    pub passed: usize,
    /// Refused, as they must be.
    pub refused: usize,
    /// Wrong answers, and missing ones.
    pub failed: usize,
    /// Not asked, because the program does not claim the op.
    pub skipped: usize,
}

/// A case that failed.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Failure {
    /// Its group.
    pub group: String,
    /// Its name.
    pub case: String,
    /// What is special about it.
    pub comment: String,
    /// What was wrong.
    pub reason: String,
    /// The flags of the bugs that would do so.
    pub bugs: Vec<String>,
}

/// A bug that the answers point at.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct LikelyBug {
    /// Its flag.
    pub flag: String,
    /// The group of the cases.
    pub group: String,
    /// What is wrong.
    pub bug: String,
    /// Where to look.
    pub notes: String,
    /// How many answers are those of this bug.
    pub cases: usize,
    /// The first of these cases.
    pub first_case: String,
}

/// What became of all cases.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Verdict {
    /// The program and its arguments.
    pub command: Vec<String>,
    /// What it calls its version.
    pub version: String,
    /// The SHA-256 of the suite.
    pub suite_sha256: String,
    /// Whether everything that was asked was answered rightly.
    pub passed: bool,
    /// By group.
    pub groups: Vec<Count>,
    /// Bugs that the answers point at, those with the most cases first.
    pub likely_bugs: Vec<LikelyBug>,
    /// The cases that failed.
    pub failures: Vec<Failure>,
    /// What else there is to say.
    pub notes: Vec<String>,
    /// The outcome of each case, group by group.
    #[serde(skip)]
    pub outcomes: Vec<Vec<Outcome>>,
}

impl Verdict {
    /// Counts the outcomes, which are in the order of the groups and their cases.
    ///
    /// Implements: ORA-047, ORA-048.
    pub fn new(
        suite: &Suite,
        command: Vec<String>,
        version: String,
        outcomes: Vec<Vec<Outcome>>,
        notes: Vec<String>,
    ) -> Verdict {
        let mut verdict = Verdict {
            command,
            version,
            suite_sha256: suite.sha256.clone(),
            passed: false,
            groups: Vec::new(),
            likely_bugs: Vec::new(),
            failures: Vec::new(),
            notes,
            outcomes,
        };
        for (index, group) in suite.groups.iter().enumerate() {
            let outcomes = &verdict.outcomes[index];
            let count = |of: fn(&Outcome) -> bool| outcomes.iter().filter(|o| of(o)).count();
            verdict.groups.push(Count {
                group: group.name.clone(),
                op: group.op.clone(),
                cases: group.cases.len(),
                passed: count(|o| *o == Outcome::Passed),
                refused: count(|o| *o == Outcome::Refused),
                failed: count(|o| matches!(o, Outcome::Failed { .. })),
                skipped: count(|o| *o == Outcome::Skipped),
            });
            for (case, outcome) in group.cases.iter().zip(outcomes) {
                if let Outcome::Failed { reason, bugs } = outcome {
                    verdict.failures.push(Failure {
                        group: group.name.clone(),
                        case: case.id.clone(),
                        comment: case.comment.clone(),
                        reason: reason.clone(),
                        bugs: bugs.clone(),
                    });
                }
            }
        }
        verdict.likely_bugs = likely_bugs(suite, &verdict.failures);
        verdict.passed = verdict.failures.is_empty() && verdict.has_evidence();
        verdict
    }

    /// How many cases were asked.
    pub fn checked(&self) -> usize {
        self.groups
            .iter()
            .map(|group| group.cases - group.skipped)
            .sum()
    }

    /// Whether an op of the program was asked, if there was one to ask: that it refuses lines which
    /// everybody must refuse says nothing of it.
    fn has_evidence(&self) -> bool {
        let ops = || self.groups.iter().filter(|group| !group.op.is_empty());
        self.checked() > 0 && (ops().count() == 0 || ops().any(|group| group.skipped == 0))
    }

    /// What is wrong with the whole, if something is.
    ///
    /// Implements: ORA-049.
    pub fn failure(&self) -> Option<String> {
        if !self.has_evidence() {
            let ops = self.groups.iter().map(|group| &group.op[..]);
            let ops: Vec<&str> = ops.filter(|op| !op.is_empty()).collect();
            return Some(format!(
                "nothing checked: the program claims none of the ops of these vectors ({})",
                ops.join(", ")
            ));
        }
        (!self.passed)
            .then(|| format!("{} of {} cases failed", self.failures.len(), self.checked()))
    }
}

/// Implements: ORA-053.
fn likely_bugs(suite: &Suite, failures: &[Failure]) -> Vec<LikelyBug> {
    let mut likely: Vec<LikelyBug> = Vec::new();
    for failure in failures {
        for flag in &failure.bugs {
            let known = |bug: &&mut LikelyBug| bug.flag == *flag && bug.group == failure.group;
            if let Some(bug) = likely.iter_mut().find(known) {
                bug.cases += 1;
                continue;
            }
            let group = suite
                .groups
                .iter()
                .find(|group| group.name == failure.group);
            let bug = group.and_then(|group| group.flags.get(flag));
            likely.push(LikelyBug {
                flag: flag.clone(),
                group: failure.group.clone(),
                bug: bug.map_or_else(String::new, |bug| bug.bug.clone()),
                notes: bug.map_or_else(String::new, |bug| bug.notes.clone()),
                cases: 1,
                first_case: failure.case.clone(),
            });
        }
    }
    // A stable sort: of equals, the first that was seen.
    likely.sort_by_key(|bug| std::cmp::Reverse(bug.cases));
    likely
}
