//! An experiment with one subject, and its answers so far. A journal keeps them ([`palpate::journal`]), so that an aborted experiment
//! continues with the next pair:
//!
//! ```text
//! {"schema":"palpate-experiment","schema_version":2,"seed":42,"trials":30,"subject":"1","condition":"FEM data","inclusions":["2.6","4.6"],
//!  "observer":"ideal","noise_sd_n":2.0,"seconds":3,"maps_sha256":["5c1…","d28…","07e…"]}
//! {"right":true}
//! {"right":false}
//! ```

use palpate::refusal::{Refusal, shortened};
use serde::{Deserialize, Serialize};

use super::counts::columns;
use super::{Trial, plan};

/// What an experiment is: the first line of its journal.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(tag = "schema", rename = "palpate-experiment")]
pub struct Setup {
    /// The version of this line and of those that follow: 2.
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
    /// What kind of observer answers: "person" or "ideal".
    pub observer: String,
    /// The ideal observer's noise on each sample of each channel, N.
    #[serde(rename = "noise_sd_n")]
    pub noise_sd: Option<f64>,
    /// How long each sample is played.
    pub seconds: u64,
    /// SHA-256 of the force map without an inclusion and of that of each inclusion, as palpate writes them in JSON.
    pub maps_sha256: Vec<String>,
}

impl Setup {
    /// Whether a table of counts may have these inclusions.
    ///
    /// # Errors
    /// An inclusion whose name no table of counts may have, or that is there twice.
    ///
    /// Implements: PSY-004.
    pub fn check_names(&self) -> Result<(), Refusal> {
        let names = self.inclusions.iter();
        columns(names.map(|name| ("inclusion".into(), name.as_str())))?;
        Ok(())
    }
}

/// The answer to one pair: a further line of the journal.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Answer {
    /// Whether the subject chose the sample with the inclusion.
    pub right: bool,
}

/// An experiment and its answers so far.
#[derive(Debug, Clone, PartialEq)]
pub struct Experiment {
    setup: Setup,
    plan: Vec<Trial>,
    answers: Vec<Answer>,
}

impl Experiment {
    /// An experiment without answers.
    ///
    /// # Errors
    /// As [`Setup::check_names`].
    ///
    /// Implements: PSY-004.
    pub fn new(setup: Setup) -> Result<Experiment, Refusal> {
        setup.check_names()?;
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
