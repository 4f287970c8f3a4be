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

use super::{Trial, plan};
use palpate::refusal::{Refusal, shortened};

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
    /// Names of the inclusions, as in Table 1: their depths in mm, with commas between.
    pub inclusions: String,
}

impl std::fmt::Display for Setup {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(
            f,
            "seed {}, {} trials, subject {}, condition {}, inclusions {}",
            self.seed, self.trials, self.subject, self.condition, self.inclusions
        )
    }
}

/// An experiment and its answers so far.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Journal {
    setup: Setup,
    plan: Vec<Trial>,
    right: Vec<bool>,
}

impl Journal {
    /// A journal without answers.
    pub fn new(setup: Setup) -> Journal {
        Journal {
            plan: plan(
                setup.seed,
                setup.inclusions.split(',').count(),
                setup.trials,
            ),
            setup,
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
        Some((number, *self.plan.get(number)?))
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
        let mut counts = vec![(0, 0); self.setup.inclusions.split(',').count()];
        for (trial, &right) in self.plan.iter().zip(&self.right) {
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
        let of = &self.setup;
        let mut row = format!("subject,condition,trials,{}\n", of.inclusions);
        row += &format!("{},{},{}", of.subject, of.condition, of.trials);
        for (correct, _) in self.counts() {
            row += &format!(",{correct}");
        }
        Some(row + "\n")
    }

    /// The text of the file.
    pub fn to_text(&self) -> String {
        let of = &self.setup;
        let answers: String = self.right.iter().map(|&right| line(right)).collect();
        format!(
            "{HEADER}\nseed {}\ntrials {}\nsubject {}\ncondition {}\ninclusions {}\n{answers}",
            of.seed, of.trials, of.subject, of.condition, of.inclusions
        )
    }

    /// Reads the text of a file. A last line that is not whole, as an abort leaves it, does not count.
    ///
    /// # Errors
    /// The first line that is wrong.
    ///
    /// Implements: PSY-003.
    pub fn parse(text: &str) -> Result<Journal, Refusal> {
        let whole = text.rfind('\n').map_or("", |end| &text[..=end]);
        // The lines after the end are empty.
        let head = &mut (1..).zip(whole.lines().chain(std::iter::repeat("")));
        // A carriage return would not be read back, and no name of the program holds one.
        let name = |text: &str| (!text.chars().any(char::is_control)).then(|| text.to_string());
        let are_names = |text: &String| {
            let count = text.split(',').count();
            count <= 100 && !text.split(',').any(str::is_empty)
        };
        let names = "and 1 to 100 names with commas between";
        let thousand = |trials: &usize| (1..=1000).contains(trials);
        let number = |text: &str| text.parse().ok().filter(thousand);
        let list = |text: &str| name(text).filter(are_names);
        value(head, HEADER, "", |rest| rest.is_empty().then_some(()))?;
        let mut journal = Journal::new(Setup {
            seed: value(head, "seed ", "and a whole number", |text| {
                text.parse().ok()
            })?,
            trials: value(head, "trials ", "and a number from 1 to 1000", number)?,
            subject: value(head, "subject ", "and a name", name)?,
            condition: value(head, "condition ", "and its name", name)?,
            inclusions: value(head, "inclusions ", names, list)?,
        });
        for (number, line) in (1..).zip(whole.lines()).skip(6) {
            let right = match line {
                "right" => true,
                "wrong" => false,
                _ => return Err(refused(number, line, "right or wrong")),
            };
            if journal.next().is_none() {
                return Err(refused(number, line, "no more answers than pairs"));
            }
            journal.answer(right);
        }
        Ok(journal)
    }
}

/// What `read` makes of the rest of the next line of the head, which begins with `key`.
fn value<'a, T>(
    head: &mut impl Iterator<Item = (usize, &'a str)>,
    key: &str,
    expected: &str,
    read: impl Fn(&str) -> Option<T>,
) -> Result<T, Refusal> {
    let (number, line) = head.next().unwrap_or_default();
    let value = line.strip_prefix(key).and_then(read);
    value.ok_or_else(|| refused(number, line, &format!("{key}{expected}")))
}

/// The line of an answer.
fn line(right: bool) -> &'static str {
    if right { "right\n" } else { "wrong\n" }
}

fn refused(number: usize, line: &str, expected: &str) -> Refusal {
    Refusal::state(format!("{:?}", shortened(line)), expected).at(number)
}

#[cfg(test)]
mod tests;
