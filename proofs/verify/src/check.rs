//! One thing that `palpate-verify` finds out on the user's own build.

use std::fmt;
use std::format;
use std::string::{String, ToString};
use std::vec::Vec;

/// A check: what it claims, which requirements it serves, and how it finds out.
///
/// ```
/// use palpate_verify::{Check, Figure};
///
/// let check = Check {
///     name: "arithmetic.third",
///     claim: "Three thirds are one.",
///     requirements: &["CON-006"],
///     repeatable: true,
///     run: || Ok(vec![Figure::at_most("error", (1.0f64 / 3.0 * 3.0 - 1.0).abs(), 1e-15)]),
/// };
/// assert_eq!(check.judge().unwrap().len(), 1);
/// let blind = Check { run: || Ok(Vec::new()), ..check };
/// assert_eq!(blind.judge().unwrap_err(), "check arithmetic.third measured nothing");
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Check {
    /// Its name, `part.what`, as in `fem.patch`.
    pub name: &'static str,
    /// What holds if it passes, in one sentence for a reader who does not know the code.
    pub claim: &'static str,
    /// The requirements whose evidence it is.
    pub requirements: &'static [&'static str],
    /// Whether the same build gives the same figures to the bit in each run: all but times.
    ///
    /// Implements: EVD-042.
    pub repeatable: bool,
    /// Measures. An error is a check that could not be carried out, or whose claim does not hold for a reason
    /// that is no number.
    pub run: fn() -> Result<Vec<Figure>, String>,
}

impl Check {
    /// Runs the check, and gives its figures if all of them pass.
    ///
    /// # Errors
    /// Its name, with why it could not be carried out or with the figures that break their bounds.
    ///
    /// Implements: EVD-043.
    pub fn judge(&self) -> Result<Vec<Figure>, String> {
        let name = self.name;
        let figures = (self.run)().map_err(|error| format!("check {name}: {error}"))?;
        let broken: Vec<String> = figures
            .iter()
            .filter(|figure| !figure.passes())
            .map(Figure::to_string)
            .collect();
        if figures.is_empty() {
            return Err(format!("check {name} measured nothing"));
        }
        if broken.is_empty() {
            return Ok(figures);
        }
        Err(format!("check {name}: {}", broken.join("; ")))
    }
}

/// A number that a check measured, and the bounds it must keep.
///
/// ```
/// use palpate_verify::Figure;
///
/// assert!(Figure::at_most("error, N", 1e-9, 1e-9).passes());
/// assert!(!Figure::at_least("observed order", 1.8, 1.9).passes());
/// assert!(!Figure::within("share", f64::NAN, 0.0, 1.0).passes());
/// assert!(Figure::count("cases that failed", 0, 0).passes());
/// // Without bounds, only a number that is not finite fails.
/// assert!(Figure::told("time, s", 1e300).passes());
/// assert!(!Figure::told("time, s", f64::INFINITY).passes());
/// ```
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

    /// A figure that must not be below `at_least`.
    pub fn at_least(what: impl Into<String>, value: f64, at_least: f64) -> Figure {
        Figure::within(what, value, at_least, f64::INFINITY)
    }

    /// A count that must be `expected`.
    pub fn count(what: impl Into<String>, value: u64, expected: u64) -> Figure {
        Figure::within(what, value as f64, expected as f64, expected as f64)
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
    ///
    /// Implements: EVD-041.
    pub fn passes(&self) -> bool {
        self.value.is_finite() && self.at_least <= self.value && self.value <= self.at_most
    }
}

impl fmt::Display for Figure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Figure {
            what,
            value,
            at_least,
            at_most,
        } = self;
        write!(f, "{what}: {value:?}")?;
        match (at_least.is_finite(), at_most.is_finite()) {
            (true, true) if at_least == at_most => write!(f, ", expected {at_least:?}"),
            (true, true) => write!(f, ", expected {at_least:?} to {at_most:?}"),
            (true, false) => write!(f, ", expected at least {at_least:?}"),
            (false, true) => write!(f, ", expected at most {at_most:?}"),
            (false, false) => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const NONE: f64 = f64::INFINITY;

    // Verifies: EVD-041.
    #[test]
    fn a_figure_passes_within_its_bounds_and_if_it_is_a_number() {
        for (value, at_least, at_most, passes) in [
            (1.0, 1.0, 1.0, true),
            (1.0, -NONE, 1.0, true),
            (1.0f64.next_up(), -NONE, 1.0, false),
            (1.0, 1.0, NONE, true),
            (1.0f64.next_down(), 1.0, NONE, false),
            (-0.0, 0.0, 0.0, true),
            (f64::MAX, -NONE, NONE, true),
            (NONE, -NONE, NONE, false),
            (-NONE, -NONE, 1.0, false),
            (f64::NAN, -NONE, NONE, false),
            (f64::NAN, -NONE, 1.0, false),
            (0.0, f64::NAN, 1.0, false),
            (0.0, -1.0, f64::NAN, false),
        ] {
            let figure = Figure::within("a figure", value, at_least, at_most);
            assert_eq!(figure.passes(), passes, "{figure:?}");
        }
    }

    // Verifies: EVD-041.
    #[test]
    fn bounds_are_where_they_are_said_to_be() {
        assert!(Figure::at_most("", -1e300, 0.5).passes());
        assert!(!Figure::at_most("", 0.6, 0.5).passes());
        assert!(Figure::at_least("", 1e300, 0.5).passes());
        assert!(!Figure::at_least("", 0.4, 0.5).passes());
        assert!(Figure::count("", 3, 3).passes());
        assert!(!Figure::count("", 2, 3).passes() && !Figure::count("", 4, 3).passes());
        assert!(Figure::told("", -1e300).passes() && !Figure::told("", f64::NAN).passes());
    }

    fn check(run: fn() -> Result<Vec<Figure>, String>) -> Check {
        Check {
            name: "part.what",
            claim: "",
            requirements: &[],
            repeatable: true,
            run,
        }
    }

    // Verifies: EVD-043.
    #[test]
    fn a_check_that_fails_names_every_figure_that_broke_its_bound() {
        let broken = check(|| {
            Ok([
                Figure::at_most("error, m", 2e-9, 1e-9),
                Figure::told("force, N", 1.5),
                Figure::at_least("order", f64::NAN, 2.9),
                Figure::count("cases", 3, 4),
            ]
            .into())
        });
        assert_eq!(
            broken.judge().unwrap_err(),
            "check part.what: error, m: 2e-9, expected at most 1e-9; order: NaN, expected at least 2.9; \
             cases: 3.0, expected 4.0"
        );
        let failed = check(|| Err("no".into())).judge();
        assert_eq!(failed.unwrap_err(), "check part.what: no");
        // Nothing measured is nothing shown.
        let empty = check(|| Ok(Vec::new())).judge();
        assert_eq!(empty.unwrap_err(), "check part.what measured nothing");
        let passed = check(|| Ok([Figure::told("force, N", 1.5)].into()));
        assert_eq!(passed.judge().unwrap().len(), 1);
    }
}
