//! A detector that knows what the world may do to its model: a record is compared with the maps once for each class of disturbance,
//! and the classes are averaged (`spec/robust.md`). The paper's detector, in [`crate::trace`], has one class: the maps hold.
//!
//! | file | content |
//! |---|---|
//! | `mod.rs` | the question, and the answer to two maps or a bank |
//! | `gates.rs` | what is wrong with a record whatever the gel |
//! | `modes.rs` | a record in smooth modes; its noise |
//! | `sweep.rs` | a sweep in its modes, a record over its level |
//! | `gel.rs` | the gels beside that of the maps |
//! | `classes.rs` | the disturbances, and their classes |
//! | `evidence.rs` | the density of a record by classes and hypotheses |
//! | `detector.rs` | all of it for some sweeps, and what it says of records |
//! | `place.rs` | the hypotheses of a bank, and where the inclusion lies |

mod classes;
mod detector;
mod evidence;
mod gates;
mod gel;
mod modes;
mod place;
mod sweep;
#[cfg(test)]
mod tests;

pub use classes::{CLASSES, Class, Part};
pub use detector::RobustDetector;
pub use gel::{GelChange, GelChanges};
pub use place::{BankHypotheses, PlaceInterval, RobustPlace};

use crate::bank::Bank;
use crate::detect::Decision;
use crate::detect::mixture::mixture_theta;
use crate::force::Force;
use crate::force_map::{ForceTable, Hypotheses};
use crate::refusal::Refusal;
use crate::stats::error::{check_positive, check_probability, in_range};
use crate::trace::design::{channels, difference, expected};
use crate::trace::{Cause, Record, refused};

/// What is known of a record, and when an answer is sure.
///
/// Implements: ROB-040, ROB-050.
#[derive(Debug, Clone, Copy)]
pub struct RobustQuestion<'a> {
    /// Disturbances that are not there.
    pub known: &'a [Part],
    /// Whether the sensor was set to zero on the gel.
    pub is_tared: bool,
    /// The standard deviation of white noise on a sample, N; none if it is to be estimated from the record.
    pub noise_sd: Option<Force<f64>>,
    /// Pr(H = 1) before the sweep.
    pub prior_h1: f64,
    /// The posterior from which there is an inclusion; up to 1 minus this there is none.
    pub sure: f64,
}

/// One sweep of the place in question.
#[derive(Debug, Clone, Copy)]
pub struct RobustSweep<'a> {
    /// The forces.
    pub record: &'a Record,
    /// Its depth, m.
    pub depth: f64,
    /// The gels beside that of the maps at this depth; none of measured maps.
    pub changes: Option<&'a GelChanges>,
}

/// A hypothesis: what an inclusion adds to the forces at the samples of each sweep, stacked, N.
#[derive(Debug, Clone)]
pub struct RobustSignal {
    /// One series for each sweep.
    pub of_sweeps: Vec<Vec<f64>>,
    /// Its probability, given an inclusion.
    pub prior: f64,
}

/// The answer.
#[derive(Debug, Clone, PartialEq)]
pub struct RobustAnswer {
    /// Ĥ; none if the record cannot be judged.
    pub decision: Option<Decision>,
    /// Why not, the likeliest cause first.
    pub causes: Vec<Cause>,
    /// ln of the likelihood ratio of an inclusion, averaged over the classes.
    pub theta: f64,
    /// Pr(H = 1 | record).
    pub posterior: f64,
    /// ln of the likelihood ratio of each signal.
    pub thetas: Vec<f64>,
    /// The posterior of each class without and with an inclusion, in the order of the classes that count.
    pub classes: Vec<(&'static str, [f64; 2])>,
    /// Σ F f/Σ f² of the normal force of each sweep.
    pub levels: Vec<f64>,
    /// Standard deviation of the noise of each sweep, N.
    pub noise_sd: Vec<Force<f64>>,
    /// Samples of each sweep that were replaced.
    pub glitches: Vec<usize>,
}

impl RobustQuestion<'_> {
    fn check(&self) -> Result<(), Refusal> {
        let checked = || {
            check_probability("prior_h1", self.prior_h1)?;
            in_range(
                self.sure > 0.5 && self.sure < 1.0,
                "sure",
                self.sure,
                "above 0.5 and below 1",
            )?;
            let sd = self.noise_sd.unwrap_or(Force::new(1.0, 1.0));
            check_positive("noise_sd_lateral_n", sd.lateral)?;
            check_positive("noise_sd_normal_n", sd.normal)
        };
        checked().map(|_| ()).map_err(Refusal::from)
    }

    /// Judges sweeps of one place for the inclusion of one map, where that map has it.
    ///
    /// # Errors
    /// Positions or depths outside the maps; too few samples; a probability or a noise out of its range.
    ///
    /// Implements: ROB-030, ROB-004.
    pub fn judge(
        &self,
        hypotheses: Hypotheses<'_>,
        sweeps: &[RobustSweep<'_>],
    ) -> Result<RobustAnswer, Refusal> {
        let (without, with) = (hypotheses.without(), hypotheses.with());
        let signal = |&RobustSweep { record, depth, .. }: &RobustSweep<'_>| {
            let none = expected(record, without, depth)?;
            Ok(difference(&expected(record, with, depth)?, &none))
        };
        let of_sweeps = sweeps
            .iter()
            .map(signal)
            .collect::<Result<Vec<_>, Refusal>>()?;
        let normal = of_sweeps.iter().flat_map(|series| channels(series).normal);
        let is_exchanged = normal.sum::<f64>() < 0.0;
        let prior = 1.0;
        let mut answer = self.answer(without, sweeps, &[RobustSignal { of_sweeps, prior }])?;
        if is_exchanged {
            answer.decision = None;
            answer.causes.insert(0, Cause::Exchanged);
        }
        Ok(answer)
    }

    /// Searches sweeps of one place, all at the depth of the bank, for any inclusion of it, or two.
    ///
    /// # Errors
    /// Positions outside the bank; too few samples; a prior that is none; a probability or a noise out of its range.
    ///
    /// Implements: ROB-030, ROB-041.
    pub fn locate(
        &self,
        bank: &Bank,
        prior: Option<&[f64]>,
        changes: Option<&GelChanges>,
        records: &[&Record],
    ) -> Result<(RobustAnswer, RobustPlace), Refusal> {
        if let Some(prior) = prior {
            // Whether it is one.
            mixture_theta(&vec![0.0; bank.maps().len()], prior).map_err(refused)?;
        }
        let hypotheses = BankHypotheses::new(bank, prior);
        let depth = bank.depth();
        let sweeps = records.iter().map(|&record| RobustSweep {
            record,
            depth,
            changes,
        });
        let sweeps: Vec<_> = sweeps.collect();
        let signals = hypotheses.signals(records)?;
        let answer = self.answer(bank.reference().table(), &sweeps, &signals)?;
        let place = hypotheses.place(&answer);
        Ok((answer, place))
    }

    fn answer(
        &self,
        without: &ForceTable,
        sweeps: &[RobustSweep<'_>],
        signals: &[RobustSignal],
    ) -> Result<RobustAnswer, Refusal> {
        let records: Vec<_> = sweeps.iter().map(|sweep| sweep.record.forces()).collect();
        RobustDetector::new(self, without, sweeps, signals)?.judge(self, &records)
    }
}
