//! What came out.

use serde::Serialize;

use super::accepted::Accepted;
use super::diagnosis::{Diagnosis, diagnose};
use super::profile::Profile;
use super::suite::Suite;

/// What kind of mistake a wrong answer is.
///
/// Implements: ORA-058.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Class {
    /// A wrong number.
    Mathematics,
    /// An answer to what must be refused, or a refusal of what has an answer.
    Range,
    /// No answer, or one that is not of the form; a request that is none and is answered.
    Protocol,
}

impl Class {
    /// All of them, the gravest first.
    pub const ALL: [Class; 3] = [Class::Mathematics, Class::Range, Class::Protocol];
}

/// Which keys of a wrong answer, a bit each, are right, and which are those that each bug gives.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Traces {
    pub(crate) all: u64,
    pub(crate) right: u64,
    pub(crate) bugs: Vec<(String, u64)>,
}

impl Traces {
    /// The traces of every one of these bugs.
    pub(crate) fn of_all(flags: &[String]) -> Traces {
        let bugs = flags.iter().map(|flag| (flag.clone(), 1)).collect();
        Traces {
            all: 1,
            right: 0,
            bugs,
        }
    }
}

/// A wrong answer, or none.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Wrong {
    /// What kind of mistake it is.
    pub class: Class,
    /// What was wrong.
    pub reason: String,
    /// What it tells of bugs.
    pub traces: Traces,
}

/// What became of one case.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Outcome {
    /// The right answer, or a refusal where there must be one.
    Right,
    /// The right answer in a looser form than the protocol's, and how it is looser.
    Acceptable(String),
    /// A wrong answer, or none.
    Wrong(Wrong),
    /// Not asked, and why.
    Skipped(String),
}

impl Outcome {
    /// A mistake that tells of no bug.
    pub fn wrong(class: Class, reason: impl Into<String>) -> Outcome {
        let (reason, traces) = (reason.into(), Traces::default());
        Outcome::Wrong(Wrong {
            class,
            reason,
            traces,
        })
    }
}

/// What must be so for a program to pass.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, clap::ValueEnum)]
#[serde(rename_all = "lowercase")]
pub enum Require {
    /// Every answer is right.
    Right,
    /// No answer is wrong.
    Acceptable,
    /// No answer is wrong in mathematics or range.
    Range,
    /// No answer is wrong in mathematics.
    Mathematics,
}

impl Require {
    /// Whether an answer may be wrong in this class, or acceptable, which is no class.
    ///
    /// Implements: ORA-067.
    fn allows(self, class: Option<Class>) -> bool {
        match class {
            None => self != Require::Right,
            Some(Class::Mathematics) => false,
            Some(Class::Range) => self == Require::Mathematics,
            Some(Class::Protocol) => matches!(self, Require::Mathematics | Require::Range),
        }
    }
}

/// How a program is judged.
#[derive(Debug, Clone, PartialEq)]
pub struct Measure {
    /// The working precision.
    pub profile: Profile,
    /// Whether cases that are extreme in it count.
    pub extreme: bool,
    /// What must be so.
    pub require: Require,
    /// Mistakes that are known.
    pub accepted: Vec<Accepted>,
}

impl Measure {
    /// The stated tolerances, and nothing but right answers.
    pub fn exact() -> Measure {
        let (profile, accepted) = (Profile::exact(), Vec::new());
        Measure {
            profile,
            extreme: false,
            require: Require::Right,
            accepted,
        }
    }
}

/// The cases of one group, counted. Each stands in one of the columns after `cases`.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize)]
pub struct Count {
    /// The group.
    pub group: String,
    /// Its op.
    pub op: String,
    /// All its cases.
    pub cases: usize,
    /// Right answers, and refusals where they must be.
    pub right: usize,
    /// Right in a looser form.
    pub acceptable: usize,
    /// Wrong numbers.
    pub mathematics: usize,
    /// Answers to what must be refused, and refusals of what has an answer.
    pub range: usize,
    /// No answers, or none of the form.
    pub protocol: usize,
    /// Wrong or acceptable, and on the list of known mistakes.
    pub accepted: usize,
    /// Wrong where the precision ends, which does not count.
    pub extreme: usize,
    /// Not asked.
    pub skipped: usize,
}

/// An answer that is not right.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Finding {
    /// The group of the case.
    pub group: String,
    /// The case.
    pub case: String,
    /// What is special about it.
    pub comment: String,
    /// The class; of none, if the answer is acceptable.
    pub class: Option<Class>,
    /// What was wrong, or loose.
    pub reason: String,
    /// Why it is accepted, if it is on the list of known mistakes.
    pub accepted: Option<String>,
    /// Whether it is let pass since the case is extreme in the profile.
    pub extreme: bool,
    /// Whether the program fails for it.
    pub counts: bool,
}

/// A file of the program.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct ProgramFile {
    /// Its name, as it was given.
    pub name: String,
    /// The SHA-256 of what it holds.
    pub sha256: String,
}

/// Whose answers they are.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize)]
pub struct Program {
    /// The program and its arguments; empty where answers were read from a file.
    pub command: Vec<String>,
    /// What it calls its version.
    pub version: String,
    /// The files of the command, or of the answers.
    pub files: Vec<ProgramFile>,
}

/// What became of all cases.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Verdict {
    /// Whose answers they are.
    pub program: Program,
    /// The version of this program.
    pub conform_version: &'static str,
    /// The SHA-256 of the suite.
    pub suite_sha256: String,
    /// The working precision.
    pub profile: Profile,
    /// Whether extreme cases count.
    pub extreme_counts: bool,
    /// What must be so.
    pub require: Require,
    /// Whether it is so.
    pub passed: bool,
    /// By group.
    pub groups: Vec<Count>,
    /// What explains the wrong answers, group by group.
    pub diagnosis: Vec<Diagnosis>,
    /// The answers that are not right.
    pub findings: Vec<Finding>,
    /// Cases on the list of known mistakes that are right now.
    pub mended: Vec<String>,
    /// What else there is to say.
    pub notes: Vec<String>,
    /// The outcome of each case, group by group.
    #[serde(skip)]
    pub outcomes: Vec<Vec<Outcome>>,
}

impl Verdict {
    /// Counts the outcomes, which are in the order of the groups and their cases.
    ///
    /// Implements: ORA-047, ORA-048, ORA-067.
    pub fn new(
        suite: &Suite,
        measure: &Measure,
        program: Program,
        outcomes: Vec<Vec<Outcome>>,
        notes: Vec<String>,
    ) -> Verdict {
        let mut verdict = Verdict {
            program,
            conform_version: env!("CARGO_PKG_VERSION"),
            suite_sha256: suite.sha256.clone(),
            profile: measure.profile.clone(),
            extreme_counts: measure.extreme,
            require: measure.require,
            passed: false,
            groups: Vec::new(),
            diagnosis: Vec::new(),
            findings: Vec::new(),
            mended: Vec::new(),
            notes,
            outcomes: Vec::new(),
        };
        for (group, outcomes) in suite.groups.iter().zip(&outcomes) {
            let is_extreme =
                |index: usize| !measure.extreme && measure.profile.is_extreme(&group.cases[index]);
            let (name, op) = (group.name.clone(), group.op.clone());
            let mut count = Count {
                group: name,
                op,
                cases: group.cases.len(),
                ..Count::default()
            };
            for (index, (case, outcome)) in group.cases.iter().zip(outcomes).enumerate() {
                let accepted = measure
                    .accepted
                    .iter()
                    .find(|accepted| accepted.case == case.id);
                let finding = |class, reason: &String| {
                    let is_numbers = matches!(class, Some(Class::Mathematics | Class::Range));
                    let extreme = is_numbers && is_extreme(index);
                    Finding {
                        group: group.name.clone(),
                        case: case.id.clone(),
                        comment: case.comment.clone(),
                        class,
                        reason: reason.clone(),
                        accepted: accepted.map(|accepted| accepted.reason.clone()),
                        extreme,
                        counts: accepted.is_none() && !extreme && !measure.require.allows(class),
                    }
                };
                let finding = match outcome {
                    Outcome::Right => {
                        count.right += 1;
                        verdict
                            .mended
                            .extend(accepted.map(|accepted| accepted.case.clone()));
                        continue;
                    }
                    Outcome::Skipped(_) => {
                        count.skipped += 1;
                        continue;
                    }
                    Outcome::Acceptable(reason) => finding(None, reason),
                    Outcome::Wrong(wrong) => finding(Some(wrong.class), &wrong.reason),
                };
                *count.column(&finding) += 1;
                verdict.findings.push(finding);
            }
            verdict.groups.push(count);
            verdict
                .diagnosis
                .extend(diagnose(group, outcomes, |index| !is_extreme(index)));
        }
        verdict.outcomes = outcomes;
        verdict.passed = verdict.failed() == 0 && verdict.has_evidence();
        verdict
    }

    /// The sum of one column over the groups.
    pub fn total(&self, column: impl Fn(&Count) -> usize) -> usize {
        self.groups.iter().map(column).sum()
    }

    /// How many cases were asked.
    pub fn checked(&self) -> usize {
        self.total(|group| group.cases - group.skipped)
    }

    /// How many findings the program fails for.
    pub fn failed(&self) -> usize {
        self.findings
            .iter()
            .filter(|finding| finding.counts)
            .count()
    }

    /// Whether an op of the program was asked, if there was one to ask: that it refuses lines which
    /// everybody must refuse says nothing of it.
    fn has_evidence(&self) -> bool {
        let ops = || self.groups.iter().filter(|group| !group.op.is_empty());
        let is_asked = |group: &Count| group.skipped < group.cases;
        self.checked() > 0 && (ops().count() == 0 || ops().any(is_asked))
    }

    /// What is wrong with the whole, if something is.
    ///
    /// Implements: ORA-049.
    pub fn failure(&self) -> Option<String> {
        if !self.has_evidence() {
            let ops = self.groups.iter().map(|group| &group.op[..]);
            let ops: Vec<&str> = ops.filter(|op| !op.is_empty()).collect();
            let ops = ops.join(", ");
            return Some(format!(
                "nothing checked: none of the ops of these vectors was asked ({ops})"
            ));
        }
        let (failed, checked) = (self.failed(), self.checked());
        (failed > 0).then(|| format!("{failed} of {checked} cases failed"))
    }
}

impl Count {
    /// Where a finding counts.
    fn column(&mut self, finding: &Finding) -> &mut usize {
        match (finding.class, &finding.accepted) {
            (_, Some(_)) => &mut self.accepted,
            _ if finding.extreme => &mut self.extreme,
            (None, None) => &mut self.acceptable,
            (Some(Class::Mathematics), None) => &mut self.mathematics,
            (Some(Class::Range), None) => &mut self.range,
            (Some(Class::Protocol), None) => &mut self.protocol,
        }
    }
}
