//! The outcome of one case, and the classes of wrong answers.

use serde::Serialize;

/// The kind of mistake in a wrong answer, the most serious first.
///
/// Implements: ORA-058.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Class {
    /// A wrong number.
    Mathematics,
    /// An answer where a refusal is expected, or a refusal where an answer is expected.
    Range,
    /// No answer, or one in the wrong form; an answer to a malformed request.
    Protocol,
}

impl Class {
    /// All classes, the most serious first.
    pub const ALL: [Class; 3] = [Class::Mathematics, Class::Range, Class::Protocol];

    /// Its name in a verdict.
    pub fn name(self) -> &'static str {
        match self {
            Class::Mathematics => "mathematics",
            Class::Range => "range",
            Class::Protocol => "protocol",
        }
    }
}

/// Which keys of a wrong answer, one bit each, are right, and which have the value that a bug gives.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Traces {
    pub(super) all: u64,
    pub(super) right: u64,
    pub(super) bugs: Vec<(String, u64)>,
}

impl Traces {
    /// The traces of an answer that each of these bugs explains.
    pub(super) fn of_all(flags: &[String]) -> Traces {
        Traces {
            all: 1,
            right: 0,
            bugs: flags.iter().map(|flag| (flag.clone(), 1)).collect(),
        }
    }

    /// Whether these bugs explain the answer: one of them gives every key, or, of two, each key is right or has the value of one of
    /// them and neither is enough alone.
    pub(super) fn are_of(&self, flags: &[&str]) -> bool {
        let keys = |flag: &&str| {
            let of_flag = self.bugs.iter().filter(|(bug, _)| bug == flag);
            of_flag.map(|(_, keys)| *keys).collect()
        };
        let keys: Vec<Vec<u64>> = flags.iter().map(keys).collect();
        let needs_both = |a: u64, b: u64| {
            let without = [self.right | a, self.right | b];
            !without.contains(&self.all) && self.right | a | b == self.all
        };
        keys.iter().flatten().any(|&of_one| of_one == self.all)
            || match &keys[..] {
                [one, other] => one.iter().any(|&a| other.iter().any(|&b| needs_both(a, b))),
                _ => false,
            }
    }
}

/// A wrong answer, or no answer.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Wrong {
    /// The kind of mistake.
    pub class: Class,
    /// What is wrong.
    pub reason: String,
    /// What the answer tells about bugs.
    pub traces: Traces,
}

/// The outcome of one case.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Outcome {
    /// The right answer, or a refusal where one is expected.
    Right,
    /// The right answer in a looser form than the protocol's, and how it is looser.
    Acceptable(String),
    /// A wrong answer, or no answer.
    Wrong(Wrong),
    /// Left out on request, and why.
    Skipped(String),
    /// Not asked, because the program does not claim its op, which is this.
    Unclaimed(String),
}

impl Outcome {
    /// Whether the answer is right, if only in a looser form.
    pub fn is_right(&self) -> bool {
        matches!(self, Outcome::Right | Outcome::Acceptable(_))
    }

    /// A mistake that tells nothing about bugs.
    pub fn wrong(class: Class, reason: impl Into<String>) -> Outcome {
        Outcome::Wrong(Wrong {
            class,
            reason: reason.into(),
            traces: Traces::default(),
        })
    }
}
