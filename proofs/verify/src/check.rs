//! One thing that `palpate-verify` finds out on the user's own build, and what became of it.

use std::any::Any;
use std::fmt;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::Instant;

/// What a check claims, and for which requirements.
#[derive(Debug, Clone, Copy)]
pub struct Claim {
    /// The name of the check, `part.what`, as in `fem.patch`.
    pub name: &'static str,
    /// What holds if it passes, in one sentence for a reader who does not know the code.
    pub text: &'static str,
    /// The requirements whose evidence it is.
    pub requirements: &'static [&'static str],
    /// How the limits of its figures were derived, and in which version of the program they were fixed: `… Fixed in 0.1.0.`
    pub limits: &'static str,
}

/// Why something could not be measured, or why a claim does not hold for a reason that is no number.
pub type Error = Box<dyn std::error::Error + Send + Sync>;

/// What measuring gives: figures, or a part of the way to them.
pub type Measured<T = Vec<Figure>> = Result<T, Error>;

/// A check: what it claims, and how it finds out.
///
/// ```
/// use palpate_verify::{Figure, Outcome, checks};
///
/// let check = checks().find(|check| check.claim.name == "kernel.limit").ok_or("no such check")?;
/// let third = || Ok(vec![Figure::at_most("error", (1.0f64 / 3.0 * 3.0 - 1.0).abs(), 1e-15)]);
/// assert!(Outcome::measured(&check.claim, third).passed());
/// let blind = Outcome::measured(&check.claim, || Ok(Vec::new()));
/// assert_eq!(blind.complaint().unwrap(), "check kernel.limit: measured nothing");
/// # Ok::<(), &str>(())
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Check<Run = fn() -> Measured> {
    /// What it claims.
    pub claim: Claim,
    /// Measures.
    pub run: Run,
}

/// Checks, each by its name and the requirements whose evidence it is; how it finds out, what it claims, and its limits.
macro_rules! checks {
    ($($name:literal [$($id:literal),*] => $run:expr, $text:expr, $limits:expr;)+) => {
        &[$($crate::Check {
            claim: $crate::Claim { name: $name, text: $text, requirements: &[$($id),*], limits: $limits },
            run: $run,
        }),+]
    };
}

/// Figures, each by what was measured, in the words of `format!`; its kind, its value and its bounds.
macro_rules! figures {
    ($($what:literal => $kind:ident($($number:expr),+);)+) => {
        vec![$($crate::Figure::$kind(format_args!($what).to_string(), $($number),+)),+]
    };
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
            (true, true) if at_least == at_most => write!(f, " (must be {at_least:?})"),
            (true, true) => write!(f, " (must be from {at_least:?} to {at_most:?})"),
            (true, false) => write!(f, " (must be at least {at_least:?})"),
            (false, true) => write!(f, " (must be at most {at_most:?})"),
            (false, false) => Ok(()),
        }
    }
}

/// A check that was carried out, or tried.
#[derive(Debug, Clone, PartialEq)]
pub struct Outcome {
    /// The check, `part.what`.
    pub name: String,
    /// What holds if it passed.
    pub claim: &'static str,
    /// The requirements whose evidence it is.
    pub requirements: &'static [&'static str],
    /// How the limits of its figures were derived, and when they were fixed.
    pub limits: &'static str,
    /// What it measured; none if it could not be carried out.
    pub figures: Vec<Figure>,
    /// Why it failed beside its figures, or that it could not be carried out.
    pub failure: Option<String>,
    /// How long it took, s.
    pub seconds: f64,
}

impl Outcome {
    /// Carries a check out. A panic in it is a failure of this check, not of the run.
    pub fn of(check: &Check) -> Outcome {
        Outcome::measured(&check.claim, check.run)
    }

    /// As [`Outcome::of`], for a claim whose measurements need something from outside.
    pub fn measured(claim: &Claim, run: impl FnOnce() -> Measured) -> Outcome {
        let start = Instant::now();
        // What a check leaves behind is thrown away with it.
        let result = catch_unwind(AssertUnwindSafe(run))
            .unwrap_or_else(|panic| Err(format!("panicked: {}", message(&*panic)).into()));
        let (figures, failure) = match result {
            Ok(figures) if figures.is_empty() => (figures, Some("measured nothing".into())),
            Ok(figures) => (figures, None),
            Err(failure) => (Vec::new(), Some(failure.to_string())),
        };
        Outcome {
            name: claim.name.into(),
            claim: claim.text,
            requirements: claim.requirements,
            limits: claim.limits,
            figures,
            failure,
            seconds: start.elapsed().as_secs_f64(),
        }
    }

    /// The part that the check belongs to.
    pub fn part(&self) -> &str {
        self.name.split('.').next().unwrap_or_default()
    }

    /// Whether the same build gives the same figures to the bit in each run: all but times.
    pub fn is_repeatable(&self) -> bool {
        self.part() != "timing"
    }

    /// Whether it was carried out and every figure keeps its bounds.
    pub fn passed(&self) -> bool {
        self.failure.is_none() && self.figures.iter().all(Figure::passes)
    }

    /// Of a check that did not pass its name, with why it could not be carried out or with the figures that break their bounds.
    pub fn complaint(&self) -> Option<String> {
        let broken = self.figures.iter().filter(|figure| !figure.passes());
        let wrong = self.failure.iter().cloned();
        let wrong: Vec<String> = wrong.chain(broken.map(Figure::to_string)).collect();
        (!wrong.is_empty()).then(|| format!("check {}: {}", self.name, wrong.join("; ")))
    }
}

/// What a panic says.
fn message(panic: &(dyn Any + Send)) -> &str {
    let text = panic.downcast_ref::<String>().map(String::as_str);
    text.or_else(|| panic.downcast_ref::<&str>().copied())
        .unwrap_or("without a message")
}

#[cfg(test)]
mod tests {
    use super::*;

    const NONE: f64 = f64::INFINITY;

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

    #[test]
    fn bounds_are_where_they_are_said_to_be() {
        for (figure, passes) in [
            (Figure::at_most("", -1e300, 0.5), true),
            (Figure::at_most("", 0.6, 0.5), false),
            (Figure::at_least("", 1e300, 0.5), true),
            (Figure::at_least("", 0.4, 0.5), false),
            (Figure::count("", 3, 3), true),
            (Figure::count("", 2, 3), false),
            (Figure::count("", 4, 3), false),
            (Figure::told("", -1e300), true),
            (Figure::told("", f64::NAN), false),
        ] {
            assert_eq!(figure.passes(), passes, "{figure}");
        }
    }

    fn outcome(run: fn() -> Measured) -> Outcome {
        let checks: &[Check] = checks! { "part.what" [] => run, "It holds.", "Fixed in 0.1.0."; };
        Outcome::of(&checks[0])
    }

    #[test]
    fn a_check_passes_if_all_its_figures_do_and_names_those_that_break_their_bounds() {
        let good = outcome(|| {
            Ok(figures! {
                "force, N" => told(1.5);
                "error" => at_most(1.0, 1.0);
            })
        });
        assert!(good.passed() && good.complaint().is_none());
        assert_eq!(good.part(), "part");
        for bad in [1.1, f64::NAN, f64::INFINITY] {
            let mut outcome = good.clone();
            outcome.figures[1].value = bad;
            assert!(!outcome.passed(), "{bad}");
        }
        let broken = outcome(|| {
            Ok(figures! {
                "error, m" => at_most(2e-9, 1e-9);
                "force, N" => told(1.5);
                "order" => at_least(f64::NAN, 2.9);
                "cases" => count(3, 4);
            })
        });
        assert_eq!(
            broken.complaint().unwrap(),
            "check part.what: error, m: 2e-9 (must be at most 1e-9); order: NaN (must be at least 2.9); \
             cases: 3.0 (must be 4.0)"
        );
    }

    #[test]
    fn a_check_that_cannot_run_or_panics_or_measures_nothing_fails_and_says_why() {
        for (run, why) in [
            ((|| Err("no mesh".into())) as fn() -> Measured, "no mesh"),
            (|| panic!("index {}", 7), "panicked: index 7"),
            (|| Ok(Vec::new()), "measured nothing"),
        ] {
            let failed = outcome(run);
            assert!(!failed.passed());
            assert_eq!(failed.failure.as_deref(), Some(why));
            assert_eq!(
                failed.complaint().unwrap(),
                format!("check part.what: {why}")
            );
        }
    }
}
