//! What became of a check.

use std::any::Any;
use std::format;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::string::{String, ToString};
use std::time::Instant;
use std::vec::Vec;

use super::{Check, Figure};

/// A check that was carried out, or tried.
#[derive(Debug, Clone, PartialEq)]
pub struct Outcome {
    /// The check, `part.what`.
    pub name: String,
    /// What holds if it passed.
    pub claim: String,
    /// The requirements whose evidence it is.
    pub requirements: Vec<String>,
    /// What it measured; none if it could not be carried out.
    pub figures: Vec<Figure>,
    /// Why it failed beside its figures, or that it could not be carried out.
    pub failure: Option<String>,
    /// Whether the figures are the same on every run: not so for times.
    pub repeatable: bool,
    /// How long it took, s.
    pub seconds: f64,
}

impl Outcome {
    /// Carries a check out. A panic in it is a failure of this check, not of the run.
    ///
    /// Implements: EVD-002, EVD-003.
    pub fn of(check: &Check) -> Outcome {
        Outcome {
            repeatable: check.repeatable,
            ..Outcome::measured(check.name, check.claim, check.requirements, check.run)
        }
    }

    /// As [`Outcome::of`], for what is no [`Check`].
    pub(super) fn measured(
        name: &str,
        claim: &str,
        requirements: &[&str],
        run: impl FnOnce() -> Result<Vec<Figure>, String>,
    ) -> Outcome {
        let start = Instant::now();
        // What a check leaves behind is thrown away with it.
        let result = catch_unwind(AssertUnwindSafe(run))
            .unwrap_or_else(|panic| Err(format!("panicked: {}", message(&*panic))));
        let (figures, failure) = match result {
            Ok(figures) if figures.is_empty() => (figures, Some("measured nothing".to_string())),
            Ok(figures) => (figures, None),
            Err(failure) => (Vec::new(), Some(failure)),
        };
        Outcome {
            name: name.to_string(),
            claim: claim.to_string(),
            requirements: requirements.iter().map(ToString::to_string).collect(),
            figures,
            failure,
            repeatable: true,
            seconds: start.elapsed().as_secs_f64(),
        }
    }

    /// The part that the check belongs to.
    pub fn part(&self) -> &str {
        self.name.split('.').next().unwrap_or_default()
    }

    /// Whether it was carried out and every figure keeps its bounds.
    ///
    /// Implements: EVD-002.
    pub fn passed(&self) -> bool {
        self.failure.is_none() && self.figures.iter().all(Figure::passes)
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

    fn outcome(run: fn() -> Result<Vec<Figure>, String>) -> Outcome {
        Outcome::of(&Check {
            name: "part.what",
            claim: "It holds.",
            requirements: &["EVD-002"],
            repeatable: true,
            run,
        })
    }

    // Verifies: EVD-002.
    #[test]
    fn a_check_passes_if_all_its_figures_do() {
        let good = outcome(|| Ok(vec![Figure::at_most("error", 1.0, 1.0)]));
        assert!(good.passed());
        assert_eq!(good.part(), "part");
        for bad in [1.1, f64::NAN, f64::INFINITY] {
            let figures = vec![
                Figure::told("told", 1.0),
                Figure::at_most("error", bad, 1.0),
            ];
            let outcome = Outcome {
                figures,
                ..good.clone()
            };
            assert!(!outcome.passed(), "{bad}");
        }
        assert!(!outcome(|| Ok(vec![Figure::told("told", f64::NAN)])).passed());
        assert!(!outcome(|| Ok(Vec::new())).passed());
    }

    // Verifies: EVD-002, EVD-003.
    #[test]
    fn a_check_that_cannot_run_or_panics_fails_and_says_why() {
        let refused = outcome(|| Err("no mesh".into()));
        assert!(!refused.passed());
        assert_eq!(refused.failure.as_deref(), Some("no mesh"));
        let panicked = outcome(|| panic!("index {}", 7));
        assert!(!panicked.passed());
        assert_eq!(panicked.failure.as_deref(), Some("panicked: index 7"));
    }
}
