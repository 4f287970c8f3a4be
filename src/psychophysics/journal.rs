//! The answers of one subject, in a file that grows by a line with each, so that an aborted session
//! goes on where it stopped.
//!
//! ```text
//! palpate-experiment 1
//! seed 42
//! trials 30
//! subject 1
//! condition FEM data
//! inclusions 2.6,4.6,6.6,8.6
//! right
//! wrong
//! ```

use super::{Plan, Trial};

const HEADER: &str = "palpate-experiment 1";

/// What an experiment is.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Setup {
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

impl std::fmt::Display for Setup {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Setup {
            seed,
            trials,
            subject,
            condition,
            inclusions,
        } = self;
        write!(
            f,
            "seed {seed}, {trials} trials, subject {subject}, condition {condition}, inclusions {}",
            inclusions.join(",")
        )
    }
}

/// An experiment and its answers so far.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Journal {
    setup: Setup,
    plan: Plan,
    right: Vec<bool>,
}

/// Why a text is no journal.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("line {line}: {found:?}, expected {expected}")]
pub struct JournalError {
    /// Which line, from 1.
    pub line: usize,
    /// What stands there.
    pub found: String,
    /// What would be right.
    pub expected: String,
}

impl Journal {
    /// A journal without answers.
    pub fn new(setup: Setup) -> Journal {
        let plan = Plan::new(setup.seed, setup.inclusions.len(), setup.trials);
        Journal {
            setup,
            plan,
            right: Vec::new(),
        }
    }

    /// What the experiment is.
    pub fn setup(&self) -> &Setup {
        &self.setup
    }

    /// The next pair, with its number from 0; `None` when all are answered.
    pub fn next(&self) -> Option<(usize, Trial)> {
        let number = self.right.len();
        Some((number, *self.plan.trials().get(number)?))
    }

    /// Notes the answer to the next pair; the line that the file grows by.
    pub fn answer(&mut self, right: bool) -> &'static str {
        self.right.push(right);
        line(right)
    }

    /// Right answers to each inclusion, and answers in all.
    ///
    /// Implements: PSY-004.
    pub fn counts(&self) -> Vec<(usize, usize)> {
        let mut counts = vec![(0, 0); self.setup.inclusions.len()];
        for (trial, &right) in self.plan.trials().iter().zip(&self.right) {
            let (correct, answered) = &mut counts[trial.inclusion];
            *correct += usize::from(right);
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
        let counts = self.counts();
        let correct: Vec<String> = counts.iter().map(|(right, _)| right.to_string()).collect();
        let Setup {
            subject,
            condition,
            trials,
            inclusions,
            ..
        } = &self.setup;
        Some(format!(
            "subject,condition,trials,{}\n{subject},{condition},{trials},{}\n",
            inclusions.join(","),
            correct.join(",")
        ))
    }

    /// The text of the file.
    pub fn to_text(&self) -> String {
        let Setup {
            seed,
            trials,
            subject,
            condition,
            inclusions,
        } = &self.setup;
        let answers: String = self.right.iter().map(|&right| line(right)).collect();
        format!(
            "{HEADER}\nseed {seed}\ntrials {trials}\nsubject {subject}\ncondition {condition}\ninclusions {}\n{answers}",
            inclusions.join(",")
        )
    }

    /// Reads the text of a file. A last line that is not whole, as an abort leaves it, does not count.
    ///
    /// # Errors
    /// [`JournalError`].
    ///
    /// Implements: PSY-003.
    pub fn parse(text: &str) -> Result<Journal, JournalError> {
        let whole = text.rfind('\n').map_or("", |end| &text[..=end]);
        let mut lines = whole.lines().enumerate();
        let mut key = |key: &str, expected: &str| {
            let (at, line) = lines.next().unwrap_or((whole.lines().count(), ""));
            let error = JournalError {
                line: at + 1,
                found: line.chars().take(80).collect(),
                expected: format!("{key}{expected}"),
            };
            match line.strip_prefix(key) {
                Some(value) => Ok((value.to_string(), error)),
                None => Err(error),
            }
        };
        let (rest, error) = key(HEADER, "")?;
        if !rest.is_empty() {
            return Err(error);
        }
        let (seed, error) = key("seed ", "and a whole number")?;
        let seed = seed.parse().map_err(|_| error)?;
        let (trials, error) = key("trials ", "and a number from 1 to 1000")?;
        let trials = trials.parse().map_err(|_| error.clone())?;
        if !(1..=1000).contains(&trials) {
            return Err(error);
        }
        let mut name = |which: &str, expected: &str| {
            let (name, error) = key(which, expected)?;
            // A carriage return would not be read back, and no name of the program holds one.
            if name.chars().any(char::is_control) {
                return Err(error);
            }
            Ok((name, error))
        };
        let (subject, _) = name("subject ", "and a name")?;
        let (condition, _) = name("condition ", "and its name")?;
        let (inclusions, error) = name("inclusions ", "and 1 to 100 names with commas between")?;
        let inclusions: Vec<String> = inclusions.split(',').map(str::to_string).collect();
        if inclusions.len() > 100 || inclusions.iter().any(String::is_empty) {
            return Err(error);
        }
        let mut journal = Journal::new(Setup {
            seed,
            trials,
            subject,
            condition,
            inclusions,
        });
        for (at, line) in lines {
            let right = match line {
                "right" => true,
                "wrong" => false,
                _ => return Err(wrong_answer(at, line, "right or wrong")),
            };
            if journal.next().is_none() {
                return Err(wrong_answer(at, line, "no more answers than pairs"));
            }
            journal.answer(right);
        }
        Ok(journal)
    }
}

/// The line of an answer.
fn line(right: bool) -> &'static str {
    if right { "right\n" } else { "wrong\n" }
}

fn wrong_answer(at: usize, line: &str, expected: &str) -> JournalError {
    JournalError {
        line: at + 1,
        found: line.chars().take(80).collect(),
        expected: expected.to_string(),
    }
}

#[cfg(test)]
mod tests;
