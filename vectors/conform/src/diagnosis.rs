//! The bugs that explain the wrong answers of a group.

use std::cmp::Reverse;

use serde::Serialize;

use super::case::{Bug, Case, Group};
use super::outcome::{Class, Outcome, Wrong};

/// What the wrong answers of one class in one group point at.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Diagnosis {
    /// The group.
    pub group: String,
    /// The class.
    pub class: Class,
    /// The number of wrong answers of this class.
    pub wrong: usize,
    /// What explains at least half of them, what explains most first; if empty, they are unexplained.
    pub explanations: Vec<Explanation>,
}

/// A bug, or two at once, that would give wrong answers which were found.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Explanation {
    /// The bugs, one or two.
    pub bugs: Vec<NamedBug>,
    /// The number of wrong answers that they explain.
    pub explains: usize,
    /// The number of right answers that would be wrong with them.
    pub against: usize,
    /// The first case that they explain.
    pub first_case: String,
}

/// A bug with its flag.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct NamedBug {
    /// Its flag.
    pub flag: String,
    /// What is wrong.
    pub bug: String,
    /// Where to look.
    pub notes: String,
}

/// The largest number of explanations for a group and class.
const MOST: usize = 3;

/// The diagnosis of each class with wrong answers in a group, whose outcomes are given in the order of its cases. `is_counted` tells
/// which cases count.
///
/// Implements: ORA-047, ORA-048.
pub fn diagnose<'a>(
    group: &Group,
    outcomes: &'a [Outcome],
    is_counted: impl Fn(usize) -> bool,
) -> Vec<Diagnosis> {
    let of_class = |class: Class| {
        let wrong = |(index, outcome): (usize, &'a Outcome)| match outcome {
            Outcome::Wrong(wrong) if wrong.class == class => Some((index, wrong)),
            _ => None,
        };
        let wrong = outcomes.iter().enumerate().filter_map(wrong);
        let wrong = wrong.filter(|(index, _)| is_counted(*index)).collect();
        let found = Found {
            group,
            outcomes,
            wrong,
        };
        (!found.wrong.is_empty()).then(|| Diagnosis {
            group: group.name.clone(),
            class,
            wrong: found.wrong.len(),
            explanations: found.explanations(),
        })
    };
    Class::ALL.into_iter().filter_map(of_class).collect()
}

/// The wrong answers of one class.
struct Found<'a> {
    group: &'a Group,
    outcomes: &'a [Outcome],
    wrong: Vec<(usize, &'a Wrong)>,
}

impl Found<'_> {
    /// What explains at least half of the wrong answers. Two bugs are named only if they explain more than any one; of such pairs the
    /// best, of equal pairs the first.
    fn explanations(&self) -> Vec<Explanation> {
        let flags = self.group.flags.keys();
        let mut alone: Vec<_> = flags
            .map(|flag| (&flag[..], self.explanation(&[flag])))
            .collect();
        let explains = |one: &Option<Explanation>| one.as_ref().map_or(0, |one| one.explains);
        // The sort is stable: of equals, the first by name comes first, here and below.
        alone.sort_by_key(|(_, one)| Reverse(explains(one)));
        let mut best: Option<Explanation> = None;
        for (index, (one, _)) in alone.iter().enumerate() {
            for (other, _) in &alone[index + 1..] {
                let pair = self.explanation(&[one, other]);
                let most = explains(&best).max(explains(&alone[0].1));
                best = pair.filter(|pair| pair.explains > most).or(best);
            }
        }
        let alone = alone.into_iter().filter_map(|(_, one)| one);
        let mut found: Vec<_> = alone.chain(best).collect();
        found.retain(|one| 2 * one.explains >= self.wrong.len());
        found.sort_by_key(|one| (Reverse(one.explains), one.against));
        found.truncate(MOST);
        found
    }

    /// What these bugs explain, if they explain anything.
    fn explanation(&self, flags: &[&str]) -> Option<Explanation> {
        let wrong = self.wrong.iter();
        let mut explained = wrong.filter(|(_, wrong)| wrong.traces.are_of(flags));
        let (first, _) = explained.next()?;
        let named = |flag: &&str| {
            let Bug { bug, notes } = self.group.flags.get(*flag)?.clone();
            let flag = flag.to_string();
            Some(NamedBug { flag, bug, notes })
        };
        let is_against = |(case, outcome): &(&Case, &Outcome)| {
            let mut shown = case.flags.iter();
            **outcome == Outcome::Right && shown.any(|flag| flags.contains(&&flag[..]))
        };
        let cases = self.group.cases.iter().zip(self.outcomes);
        Some(Explanation {
            bugs: flags.iter().filter_map(named).collect(),
            explains: 1 + explained.count(),
            against: cases.filter(is_against).count(),
            first_case: self.group.cases[*first].id.clone(),
        })
    }
}
