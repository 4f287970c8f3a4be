//! Which cases are asked of a program.

use serde_json::Value;

use super::case::Case;
use super::suite::Suite;
use super::verdict::{Class, Outcome};

/// The first request.
pub const CAPABILITIES: &str = r#"{"args":{},"id":"capabilities","op":"capabilities"}"#;

/// What a program says that it can do.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Capabilities {
    /// What it calls its version.
    pub version: String,
    /// The ops that it claims.
    pub ops: Vec<String>,
}

impl Capabilities {
    /// Those of a line, if it is the answer to [`CAPABILITIES`].
    pub fn read(line: &[u8]) -> Option<Capabilities> {
        let answer: Value = serde_json::from_slice(line).ok()?;
        let ok = answer.get("ok")?;
        let ops = ok
            .get("ops")?
            .as_array()?
            .iter()
            .map(|op| op.as_str().map(str::to_string));
        let version = match ok.get("version")? {
            Value::String(version) => version.clone(),
            version => version.to_string(),
        };
        (answer.get("id")? == "capabilities").then_some(())?;
        Some(Capabilities {
            version,
            ops: ops.collect::<Option<_>>()?,
        })
    }
}

/// The cases that are asked, and those that are not.
pub struct Plan {
    /// Group and case of each that is asked, in their order.
    pub asked: Vec<(usize, usize)>,
    /// Why each case is skipped that is not asked; group by group.
    outcomes: Vec<Vec<Outcome>>,
}

impl Plan {
    /// Skips groups and cases by name, and the groups whose op is not claimed. Lines of no op are for every program.
    ///
    /// Implements: ORA-048, ORA-040.
    pub fn new(suite: &Suite, skip: &[String], is_claimed: impl Fn(&str) -> bool) -> Plan {
        let mut asked = Vec::new();
        let mut outcomes = Vec::new();
        for (index, group) in suite.groups.iter().enumerate() {
            let is_claimed = group.op.is_empty() || is_claimed(&group.op);
            let mut of_group = Vec::new();
            for (number, case) in group.cases.iter().enumerate() {
                let is_left_out = skip.contains(&case.id) || skip.contains(&group.name);
                if is_claimed && !is_left_out {
                    asked.push((index, number));
                }
                of_group.push(Outcome::Skipped(match is_left_out {
                    true => "left out by --skip".into(),
                    false => format!("the program does not claim {}", group.op),
                }));
            }
            outcomes.push(of_group);
        }
        Plan { asked, outcomes }
    }

    /// Of a program that does not say what it claims: the ops with an answer.
    pub fn of_answered(suite: &Suite, skip: &[String], is_answered: impl Fn(&str) -> bool) -> Plan {
        Plan::new(suite, skip, |op| {
            let mut groups = suite.groups.iter().filter(|group| group.op == op);
            groups.any(|group| group.cases.iter().any(|case| is_answered(&case.id)))
        })
    }

    /// The cases that are asked.
    pub fn cases<'a>(&self, suite: &'a Suite) -> Vec<&'a Case> {
        self.asked
            .iter()
            .map(|&(group, case)| &suite.groups[group].cases[case])
            .collect()
    }

    /// The outcomes of all cases, with those of the cases that were asked; one without is wrong for the reason `never`.
    pub fn outcomes(mut self, asked: Vec<Option<Outcome>>, never: &str) -> Vec<Vec<Outcome>> {
        for ((group, case), outcome) in self.asked.into_iter().zip(asked) {
            let never = || Outcome::wrong(Class::Protocol, never);
            self.outcomes[group][case] = outcome.unwrap_or_else(never);
        }
        self.outcomes
    }
}
