//! Which bugs explain the wrong answers of a group.

use serde::Serialize;

use super::suite::Group;
use super::verdict::{Class, Outcome, Traces, Wrong};

/// What the wrong answers of one class in one group point at.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Diagnosis {
    /// The group.
    pub group: String,
    /// The class.
    pub class: Class,
    /// How many answers of this class are wrong.
    pub wrong: usize,
    /// What explains at least half of them, what explains most first; if there is none, they are unexplained.
    pub explanations: Vec<Explanation>,
}

/// A bug, or two at once, that would give wrong answers which were found.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Explanation {
    /// The bugs, one or two.
    pub bugs: Vec<NamedBug>,
    /// How many of the wrong answers they explain.
    pub explains: usize,
    /// How many answers are right that would be wrong with them.
    pub against: usize,
    /// The first case that they explain.
    pub first_case: String,
}

/// A bug by its flag.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct NamedBug {
    /// Its flag.
    pub flag: String,
    /// What is wrong.
    pub bug: String,
    /// Where to look.
    pub notes: String,
}

/// Most explanations that are given of a group.
const MOST: usize = 3;

/// The diagnosis of each class with wrong answers in a group. `is_counted` tells which cases count.
///
/// Implements: ORA-047, ORA-048.
pub fn diagnose(
    group: &Group,
    outcomes: &[Outcome],
    is_counted: impl Fn(usize) -> bool,
) -> Vec<Diagnosis> {
    let of_class = |class: Class| {
        let wrong = outcomes
            .iter()
            .enumerate()
            .filter_map(|(index, outcome)| match outcome {
                Outcome::Wrong(wrong) if wrong.class == class && is_counted(index) => {
                    Some((index, wrong))
                }
                _ => None,
            });
        Found {
            group,
            outcomes,
            wrong: wrong.collect(),
        }
        .diagnosis(class)
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
    fn diagnosis(&self, class: Class) -> Option<Diagnosis> {
        if self.wrong.is_empty() {
            return None;
        }
        let mut flags: Vec<&str> = self.group.flags.keys().map(|flag| &flag[..]).collect();
        let alone = |flag: &str| self.explanation(&[flag]);
        // Of two bugs the one that explains more comes first.
        flags.sort_by_cached_key(|flag| std::cmp::Reverse(alone(flag).map(|one| one.explains)));
        let mut found: Vec<Explanation> = flags.iter().filter_map(|flag| alone(flag)).collect();
        let best = found.first().map_or(0, |one| one.explains);
        let pairs = flags.iter().enumerate().flat_map(|(index, one)| {
            let others = flags[index + 1..].iter();
            others.filter_map(|other| self.explanation(&[one, other]))
        });
        // Two bugs are named only where they explain more than any one; of such pairs the best, of equals the first.
        let pair = pairs.reduce(|best, pair| match pair.explains > best.explains {
            true => pair,
            false => best,
        });
        found.extend(pair.filter(|pair| pair.explains > best));
        found.retain(|one| 2 * one.explains >= self.wrong.len());
        // A stable sort: of equals, the first by name.
        found.sort_by_key(|one| (std::cmp::Reverse(one.explains), one.against));
        found.truncate(MOST);
        let (group, wrong) = (self.group.name.clone(), self.wrong.len());
        Some(Diagnosis {
            group,
            class,
            wrong,
            explanations: found,
        })
    }

    fn explanation(&self, flags: &[&str]) -> Option<Explanation> {
        let mut explained = self
            .wrong
            .iter()
            .filter(|(_, wrong)| wrong.traces.are_of(flags));
        let (first, _) = explained.next()?;
        let named = |flag: &&str| {
            let bug = self.group.flags.get(*flag)?;
            let (flag, bug, notes) = (flag.to_string(), bug.bug.clone(), bug.notes.clone());
            Some(NamedBug { flag, bug, notes })
        };
        let shows = |index: &usize| {
            let case = &self.group.cases[*index];
            flags
                .iter()
                .any(|flag| case.flags.iter().any(|shown| shown == flag))
        };
        let is_right = |index: &usize| self.outcomes[*index] == Outcome::Right;
        Some(Explanation {
            bugs: flags.iter().filter_map(named).collect(),
            explains: 1 + explained.count(),
            against: (0..self.outcomes.len())
                .filter(shows)
                .filter(is_right)
                .count(),
            first_case: self.group.cases[*first].id.clone(),
        })
    }
}

impl Traces {
    /// Whether the answer is that of these bugs: of one with every key; of two, if each key is right or that of one of them.
    fn are_of<'a>(&'a self, flags: &[&'a str]) -> bool {
        let named = |flag: &'a str| self.bugs.iter().filter(move |bug| bug.0 == flag);
        let of = |flag: &'a str| named(flag).map(|bug| bug.1);
        flags
            .iter()
            .any(|flag| of(flag).any(|keys| keys == self.all))
            || match flags {
                [one, other] => of(one).any(|a| of(other).any(|b| self.needs_both(a, b))),
                _ => false,
            }
    }
    /// Whether neither set of keys leaves the other without a key to explain, and both leave none that is wrong.
    fn needs_both(&self, a: u64, b: u64) -> bool {
        self.right | a != self.all && self.right | b != self.all && self.right | a | b == self.all
    }
}
