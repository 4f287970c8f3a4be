//! An experiment with one subject, and its answers so far. A journal keeps them ([`palpate::journal`]), so that an aborted experiment
//! continues with the next pair:
//!
//! ```text
//! {"schema":"palpate-experiment","schema_version":1,"seed":42,"trials":30,"subject":"1","condition":"FEM data","inclusions":["2.6","4.6"]}
//! {"right":true}
//! {"right":false}
//! ```

use palpate::refusal::{Refusal, shortened};
use serde::{Deserialize, Serialize};

use super::counts::columns;
use super::{Trial, plan};

/// What an experiment is: the first line of its journal.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[serde(tag = "schema", rename = "palpate-experiment")]
pub struct Setup {
    /// The version of this line and of those that follow.
    pub schema_version: u32,
    /// The seed of the plan.
    pub seed: u64,
    /// Pairs for each inclusion.
    pub trials: usize,
    /// Who answers.
    pub subject: String,
    /// What is played, as in Table 1: "FEM data".
    pub condition: String,
    /// Names of the inclusions, as in Table 1: their depths in mm.
    pub inclusions: Vec<String>,
}

/// The answer to one pair: a further line of the journal.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Answer {
    /// Whether the subject chose the sample with the inclusion.
    pub right: bool,
}

/// An experiment and its answers so far.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Experiment {
    setup: Setup,
    plan: Vec<Trial>,
    answers: Vec<Answer>,
}

impl Experiment {
    /// An experiment without answers.
    ///
    /// # Errors
    /// An inclusion whose name no table of counts may have, or that is there twice.
    ///
    /// Implements: PSY-004.
    pub fn new(setup: Setup) -> Result<Experiment, Refusal> {
        let names = setup.inclusions.iter();
        columns(names.map(|name| ("inclusion".into(), name.as_str())))?;
        Ok(Experiment {
            plan: plan(setup.seed, setup.inclusions.len(), setup.trials),
            setup,
            answers: Vec::new(),
        })
    }

    /// The next pair, with its number from 0; `None` when all are answered.
    pub fn next(&self) -> Option<(usize, Trial)> {
        let number = self.answers.len();
        Some((number, *self.plan.get(number)?))
    }

    /// Adds the answer to the next pair.
    ///
    /// # Errors
    /// All pairs are answered.
    pub fn answer(&mut self, answer: Answer) -> Result<(), Refusal> {
        if self.next().is_none() {
            let pairs = self.plan.len();
            let found = format!("one answer too many: the experiment has {pairs} pairs");
            return Err(Refusal::state(found, ""));
        }
        self.answers.push(answer);
        Ok(())
    }

    /// Adds the answer that a line of the journal holds.
    ///
    /// # Errors
    /// The line is not an answer, or all pairs are answered.
    ///
    /// Implements: PSY-003.
    pub fn take(&mut self, line: &str) -> Result<(), Refusal> {
        let answer = serde_json::from_str(line);
        let refused = |_| {
            let line = shortened(line);
            let found = format!("{line:?} is not an answer; delete the line or the file");
            Refusal::state(found, "")
        };
        self.answer(answer.map_err(refused)?)
    }

    /// Right answers to each inclusion, and answers in all.
    ///
    /// Implements: PSY-004.
    pub fn counts(&self) -> Vec<(usize, usize)> {
        let mut counts = vec![(0, 0); self.setup.inclusions.len()];
        for (trial, answer) in self.plan.iter().zip(&self.answers) {
            let (correct, answered) = &mut counts[trial.inclusion];
            *correct += usize::from(answer.right);
            *answered += 1;
        }
        counts
    }

    /// The row of Table 1, with its header; `None` until all pairs are answered.
    ///
    /// Implements: PSY-004.
    pub fn table_row(&self) -> Option<String> {
        if self.next().is_some() {
            return None;
        }
        let setup = &self.setup;
        let (subject, condition, trials) = (&setup.subject, &setup.condition, setup.trials);
        let correct = |(correct, _)| format!(",{correct}");
        let counts: String = self.counts().into_iter().map(correct).collect();
        let inclusions = setup.inclusions.join(",");
        Some(format!(
            "subject,condition,trials,{inclusions}\n{subject},{condition},{trials}{counts}\n"
        ))
    }
}

#[cfg(test)]
mod tests;
