//! What people feel: two-alternative forced choice (paper §4, `spec/psychophysics.md`).
//!
//! | file | content |
//! |---|---|
//! | `plan.rs` | which pair when: random, from a seed |
//! | `experiment.rs` | one subject's experiment and the answers so far |
//! | `observer.rs` | one sample played through device and servo, as it was felt; the ideal observer, who decides by Θ |
//! | `counts.rs` | right answers of subjects to inclusions |
//! | `table.rs`, `table1.csv` | tables of them: Table 1 and files of its form |
//! | `trials.rs` | files with a row for each trial |
//! | `analysis.rs` | everything that the counts say by themselves, from the files below |
//! | `rates.rs` | shares, intervals, γ |
//! | `dispersion.rs`, `beta_binomial.rs` | subjects who differ |
//! | `psychometric.rs` | the share over depth |
//! | `choice.rs`, `search.rs` | the likelihood of answers in pairs, and how its top is found |
//! | `conditions.rs` | conditions against one another, subjects as blocks |
//! | `noise.rs` | the noise levels of the paper's §5 |
//! | `bridge/` | force maps against the counts |
//!
//! ```
//! use palpate::detect::gamma_from_two_afc;
//! use palpate_paper::psychophysics::{AnswerTable, analyse};
//!
//! // Playback of FEM data, inclusion 6.6 mm deep: 84 % of all answers are right, γ = 1.42.
//! let analysis = analyse(&AnswerTable::paper()?)?;
//! let pooled = analysis.conditions[1].inclusions[2].pooled;
//! assert_eq!((pooled.correct, pooled.trials), (253, 300));
//! assert_eq!(pooled.gamma.gamma, Some(gamma_from_two_afc(253.0 / 300.0)?));
//! # Ok::<(), palpate::refusal::Refusal>(())
//! ```

mod analysis;
mod beta_binomial;
pub mod bridge;
mod choice;
mod conditions;
mod counts;
mod dispersion;
mod experiment;
pub mod noise;
mod observer;
mod plan;
mod psychometric;
mod rates;
mod search;
mod table;
#[cfg(test)]
mod tests;
mod trials;

pub use analysis::{Analysis, ConditionAnalysis, InclusionAnalysis, SubjectAnalysis, analyse};
pub use beta_binomial::BetaBinomial;
pub use conditions::{ConditionComparison, Difference, InclusionDifference};
pub use counts::{Column, Condition, MOST_TRIALS, Subject, depth_unlike_name};
pub use experiment::{Answer, Experiment, Setup};
pub use noise::{NoiseDecomposition, NoiseLevel, paper_noise_levels};
pub use observer::{Felt, IdealObserver, present};
pub use palpate::stats::dispersion::{Dispersion, dispersion};
pub use plan::{Interval, Trial, plan};
pub use psychometric::{Parameter, Psychometric};
pub use rates::{Bounds, CONFIDENCE, Clustered, GammaEstimate, OpenBounds, Rate};
pub use table::{AnswerTable, FEM_PLAYBACK};

use palpate::refusal::Refusal;

/// What an analysis found, or why it was refused.
type Result<T, E = Refusal> = core::result::Result<T, E>;
