//! The verdict on a program.

use serde::Serialize;

use super::case::Group;
use super::counts::{Counts, Finding};
use super::diagnosis::{Diagnosis, diagnose};
use super::measure::Measure;
use super::outcome::{Class, Outcome};
use super::program::Program;
use super::suite::Suite;

/// The counts of one group.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct GroupCounts {
    /// The group.
    pub group: String,
    /// Its op.
    pub op: String,
    /// Its counts.
    #[serde(flatten)]
    pub counts: Counts,
}

/// The outcomes of all cases, counted and explained.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Verdict {
    /// The program that gave the answers.
    pub program: Program,
    /// The version of `palpate-conform`.
    pub conform_version: &'static str,
    /// The SHA-256 of the suite.
    pub suite_sha256: String,
    /// How the program was judged.
    #[serde(flatten)]
    pub measure: Measure,
    /// Whether the program passes.
    pub passed: bool,
    /// Why it fails, if it does.
    pub failure: Option<String>,
    /// How often the program ended or was silent before its input ended.
    pub stops: usize,
    /// The counts of each group.
    pub groups: Vec<GroupCounts>,
    /// The ops of the groups that were not asked because the program does not claim them.
    #[serde(skip)]
    pub unclaimed: Vec<String>,
    /// The groups in which no case failed, but no value was right either.
    #[serde(skip)]
    pub not_shown: Vec<String>,
    /// The sums of the counts over the groups.
    #[serde(skip)]
    pub totals: Counts,
    /// What explains the wrong answers, group by group.
    pub diagnosis: Vec<Diagnosis>,
    /// The answers that are not right.
    pub findings: Vec<Finding>,
    /// Cases on the list of known mistakes that are right now.
    pub mended: Vec<String>,
    /// What else there is to say.
    pub notes: Vec<String>,
    /// The outcome of each case, in the order of the suite.
    #[serde(skip)]
    pub outcomes: Vec<Outcome>,
}

impl Verdict {
    /// Counts the outcomes; there is one for each case, in the order of the suite.
    ///
    /// Implements: ORA-047, ORA-048, ORA-067.
    pub fn new(
        suite: &Suite,
        measure: &Measure,
        program: Program,
        outcomes: Vec<Outcome>,
        notes: Vec<String>,
        stops: usize,
    ) -> Verdict {
        let mut verdict = Verdict {
            program,
            conform_version: env!("CARGO_PKG_VERSION"),
            suite_sha256: suite.sha256.clone(),
            measure: measure.clone(),
            passed: false,
            failure: None,
            stops,
            groups: Vec::new(),
            unclaimed: Vec::new(),
            not_shown: Vec::new(),
            totals: Counts::default(),
            diagnosis: Vec::new(),
            findings: Vec::new(),
            mended: Vec::new(),
            notes,
            outcomes: Vec::new(),
        };
        let mut rest = &outcomes[..];
        for group in &suite.groups {
            let (of_group, others) = rest.split_at(group.cases.len());
            verdict.add(group, of_group);
            rest = others;
        }
        verdict.outcomes = outcomes;
        verdict.failure = verdict.why_it_fails();
        verdict.passed = verdict.failure.is_none();
        verdict
    }

    fn add(&mut self, group: &Group, outcomes: &[Outcome]) {
        let Measure {
            profile,
            extreme,
            require,
            accepted,
            ..
        } = &self.measure;
        let is_extreme = |index: usize| !extreme && profile.is_extreme(&group.cases[index]);
        let has_values = group.cases.iter().any(|case| case.expected.is_number());
        let mut judged = group.cases.iter().zip(outcomes);
        let shows_a_value =
            judged.any(|(case, outcome)| case.expected.is_number() && outcome.is_right());
        let mut counts = Counts::default();
        for (index, (case, outcome)) in group.cases.iter().zip(outcomes).enumerate() {
            counts.cases += 1;
            let accepted = accepted.get(&case.id).cloned();
            let (class, reason) = match outcome {
                Outcome::Right => {
                    counts.right += 1;
                    self.mended.extend(accepted.map(|_| case.id.clone()));
                    continue;
                }
                Outcome::Skipped(_) | Outcome::Unclaimed(_) => {
                    counts.skipped += 1;
                    continue;
                }
                Outcome::Acceptable(reason) => (None, reason),
                Outcome::Wrong(wrong) => (Some(wrong.class), &wrong.reason),
            };
            let is_numeric = matches!(class, Some(Class::Mathematics | Class::Range));
            let extreme = is_numeric && is_extreme(index);
            let is_permitted = match class {
                Some(Class::Protocol) if case.expected.is_number() => false,
                Some(Class::Range) if case.expected.is_number() && !shows_a_value => false,
                class => require.permits(class),
            };
            let finding = Finding {
                group: group.name.clone(),
                case: case.id.clone(),
                comment: case.comment.clone(),
                class,
                reason: reason.clone(),
                counts: accepted.is_none() && !extreme && !is_permitted,
                accepted,
                extreme,
            };
            counts.add(&finding);
            self.findings.push(finding);
        }
        let is_unclaimed = |outcome: &Outcome| matches!(outcome, Outcome::Unclaimed(_));
        // Others of the group may be left out.
        if outcomes.iter().any(is_unclaimed) {
            self.unclaimed.push(group.op.clone());
        }
        if has_values && !shows_a_value && counts.checked() > 0 && counts.failed == 0 {
            self.not_shown.push(group.name.clone());
        }
        self.diagnosis
            .extend(diagnose(group, outcomes, |index| !is_extreme(index)));
        self.totals += &counts;
        self.groups.push(GroupCounts {
            group: group.name.clone(),
            op: group.op.clone(),
            counts,
        });
    }

    /// Why the program fails, if it does. That it refuses lines which everybody must refuse shows nothing: one of its ops must have been
    /// asked, if these vectors have any, and each of them if they were chosen by name. Nor is an op shown by refusals alone, and by wrong
    /// values that do not count: one value must be right.
    ///
    /// Implements: ORA-049, ORA-078, ORA-079.
    fn why_it_fails(&self) -> Option<String> {
        let has_op = |group: &&GroupCounts| !group.op.is_empty();
        let ops: Vec<&GroupCounts> = self.groups.iter().filter(has_op).collect();
        let Counts { failed, .. } = self.totals;
        let checked = self.totals.checked();
        let is_nothing = match &ops[..] {
            [] => checked == 0,
            ops => ops.iter().all(|group| group.counts.checked() == 0),
        };
        if is_nothing {
            let ops: Vec<&str> = ops.iter().map(|group| &group.op[..]).collect();
            let ops = ops.join(", ");
            return Some(format!(
                "nothing checked: none of the ops of these vectors was asked ({ops})"
            ));
        }
        if self.measure.named && !self.unclaimed.is_empty() {
            let ops = self.unclaimed.join(", ");
            return Some(format!(
                "{ops} not checked: chosen by name, but the program does not claim it"
            ));
        }
        let mut reasons = Vec::new();
        if failed > 0 {
            reasons.push(format!("{failed} of {checked} cases failed"));
        }
        if !self.not_shown.is_empty() {
            let groups = self.not_shown.join(", ");
            reasons.push(format!(
                "no value is right, so that nothing is shown of {groups}"
            ));
        }
        if self.stops > 0 {
            reasons.push(format!(
                "the program stopped before the end of its input (stops: {})",
                self.stops
            ));
        }
        (!reasons.is_empty()).then(|| reasons.join("; "))
    }
}
