//! Answers that are not right, and the columns of a verdict.

use std::ops::AddAssign;

use serde::Serialize;

use super::outcome::Class;

/// An answer that is not right.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Finding {
    /// The group of the case.
    pub group: String,
    /// The case.
    pub case: String,
    /// What is special about it.
    pub comment: String,
    /// The class; none if the answer is acceptable.
    pub class: Option<Class>,
    /// What is wrong, or how the answer is loose.
    pub reason: String,
    /// Why it is accepted, if it is on the list of known mistakes.
    pub accepted: Option<String>,
    /// Whether it is permitted because the case is extreme in the profile.
    pub extreme: bool,
    /// Whether the program fails for it.
    pub counts: bool,
}

impl Finding {
    /// The class in words, and why the program does not fail for it.
    pub fn kind(&self) -> String {
        let class = self.class_name();
        match &self.accepted {
            Some(why) => format!("{class}, accepted ({why})"),
            None if self.extreme => format!("{class}, extreme"),
            None => class.into(),
        }
    }

    /// The class in a word.
    pub fn class_name(&self) -> &'static str {
        self.class.map_or("acceptable", Class::name)
    }
}

/// Declares the columns once: the fields, their names in order, and their sums.
macro_rules! columns {
    ($($(#[$doc:meta])+ $name:ident)*) => {
        /// The cases of a group, counted. Each case is in one of the columns after `cases`.
        #[derive(Debug, Clone, Default, PartialEq, Eq, Serialize)]
        pub struct Counts {
            $($(#[$doc])+ pub $name: usize,)*
            /// The findings that the program fails for.
            #[serde(skip)]
            pub failed: usize,
        }

        impl Counts {
            /// The name and the count of each column.
            pub fn columns(&self) -> impl Iterator<Item = (&'static str, usize)> {
                [$((stringify!($name), self.$name)),*].into_iter()
            }
        }

        impl AddAssign<&Counts> for Counts {
            fn add_assign(&mut self, other: &Counts) {
                $(self.$name += other.$name;)*
                self.failed += other.failed;
            }
        }
    };
}

columns! {
    /// All cases.
    cases
    /// Right answers, and refusals where they are expected.
    right
    /// Right answers in a looser form.
    acceptable
    /// Wrong numbers.
    mathematics
    /// Answers where a refusal is expected, and refusals where an answer is expected.
    range
    /// No answers, or answers in the wrong form.
    protocol
    /// Wrong or acceptable answers on the list of known mistakes.
    accepted
    /// Wrong answers at the limit of the precision, which do not count.
    extreme
    /// Cases that were not asked.
    skipped
}

impl Counts {
    /// Counts an answer that is not right.
    pub fn add(&mut self, finding: &Finding) {
        self.failed += usize::from(finding.counts);
        let column = match (finding.class, &finding.accepted) {
            (_, Some(_)) => &mut self.accepted,
            _ if finding.extreme => &mut self.extreme,
            (None, None) => &mut self.acceptable,
            (Some(Class::Mathematics), None) => &mut self.mathematics,
            (Some(Class::Range), None) => &mut self.range,
            (Some(Class::Protocol), None) => &mut self.protocol,
        };
        *column += 1;
    }

    /// The cases that were asked.
    pub fn checked(&self) -> usize {
        self.cases - self.skipped
    }
}
