//! One thing that `palpate verify` finds out on the user's own build.

use std::string::String;
use std::vec::Vec;

/// A check: what it claims, which requirements it serves, and how it finds out.
#[derive(Debug, Clone, Copy)]
pub struct Check {
    /// Its name, `part.what`, as in `fem.patch`.
    pub name: &'static str,
    /// What holds if it passes, in one sentence for a reader who does not know the code.
    pub claim: &'static str,
    /// The requirements whose evidence it is.
    pub requirements: &'static [&'static str],
    /// Whether the figures are the same on every run: not so for times.
    pub repeatable: bool,
    /// Measures. An error is a check that could not be carried out, or whose claim does not hold for a reason
    /// that is no number.
    pub run: fn() -> Result<Vec<Figure>, String>,
}

/// A number that a check measured, and the bounds it must keep.
#[derive(Debug, Clone, PartialEq)]
pub struct Figure {
    /// What was measured, with its unit at the end where it has one: `largest error of the displacement, m`.
    pub what: String,
    /// The value.
    pub value: f64,
    /// The least value that passes; −∞ where there is none.
    pub at_least: f64,
    /// The largest value that passes; +∞ where there is none.
    pub at_most: f64,
}

impl Figure {
    /// A figure that must not be above `at_most`.
    pub fn at_most(what: impl Into<String>, value: f64, at_most: f64) -> Figure {
        Figure::within(what, value, f64::NEG_INFINITY, at_most)
    }

    /// A figure that must lie in [`at_least`, `at_most`].
    pub fn within(what: impl Into<String>, value: f64, at_least: f64, at_most: f64) -> Figure {
        Figure {
            what: what.into(),
            value,
            at_least,
            at_most,
        }
    }

    /// A figure that is told and not judged; only a number that is not finite fails.
    pub fn told(what: impl Into<String>, value: f64) -> Figure {
        Figure::within(what, value, f64::NEG_INFINITY, f64::INFINITY)
    }

    /// Whether the value is finite and keeps its bounds.
    pub fn passes(&self) -> bool {
        self.value.is_finite() && self.at_least <= self.value && self.value <= self.at_most
    }
}
