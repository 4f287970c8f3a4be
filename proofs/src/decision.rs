//! The detector's decision.

use bolero::{Driver, TypeGenerator};
use palpate_core::detect::{Decision, decide};

/// Any statistic and threshold.
#[derive(Debug, Clone)]
pub struct Compared {
    pub theta: f64,
    pub eta: f64,
}

impl TypeGenerator for Compared {
    fn generate<D: Driver>(driver: &mut D) -> Option<Self> {
        const ODD: [f64; 4] = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 0.0];
        let number = |driver: &mut D| match driver.gen_variant(4, 0)? {
            1 => Some(ODD[driver.gen_variant(ODD.len(), 0)?]),
            _ => driver.produce::<f64>(),
        };
        let theta = number(driver)?;
        let eta = match driver.gen_variant(4, 0)? {
            1 => theta,
            _ => number(driver)?,
        };
        Some(Compared { theta, eta })
    }
}

// Verifies: DET-005, DET-009, DET-020.
#[test]
#[cfg_attr(kani, kani::proof, kani::solver(cadical))]
fn no_inclusion_is_never_decided_without_finite_numbers() {
    harness!(Compared, |case| {
        let &Compared { theta, eta } = case;
        let decision = decide(theta, eta);
        if theta.is_finite() && eta.is_finite() {
            let inclusion = decision == Ok(Decision::Inclusion);
            let none = decision == Ok(Decision::NoInclusion);
            assert!(inclusion == (theta >= eta) && none == (theta < eta));
        } else {
            assert!(decision.is_err());
        }
        reached! {
            "a NaN for the statistic": theta.is_nan(),
            "an infinite statistic": theta.is_infinite(),
            "a threshold that is not finite": !eta.is_finite(),
            "on the threshold": theta == eta,
            "below the threshold": theta < eta,
        }
    });
}
