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
//! | `explanation.rs` | what either hypothesis expects of a record |
//! | `place.rs` | the hypotheses of a bank, and where the inclusion lies |

mod classes;
mod detector;
pub(crate) mod evidence;
mod explanation;
mod gates;
mod gel;
mod modes;
mod place;
mod sweep;
#[cfg(test)]
mod tests;

pub use classes::{CLASSES, Class, Part};
pub use detector::RobustDetector;
pub use explanation::Explanation;
pub use gel::{GelChange, GelChanges, GelUncertainty};
pub use place::{BankHypotheses, PlaceInterval, RobustPlace};

use crate::bank::Bank;
use crate::detect::mixture::mixture_theta;
use crate::detect::{Decision, ErrorRates};
use crate::force::Force;
use crate::force_map::{ForceTable, Hypotheses};
use crate::refusal::Refusal;
use crate::stats::error::{check_positive, check_probability, in_range};
use crate::trace::design::{self, difference, stacked};
use crate::trace::{Cause, Record, refused};

/// What is known of a record, and when an answer is sure.
///
/// Implements: ROB-040, ROB-050.
#[derive(Debug, Clone, Copy)]
pub struct RobustQuestion<'a> {
    /// Disturbances that are not there.
    pub known: &'a [Part],
    /// Whether the sensor was set to zero on the gel.
    pub is_zeroed: bool,
    /// The standard deviation of the noise on a sample, N; none if it is to be estimated from the record.
    pub noise_sd: Option<Force<f64>>,
    /// The correlation length of the noise that is stated, samples: 1 of white noise.
    pub correlation_length: f64,
    /// Whether noise that is estimated is white.
    pub is_white: bool,
    /// Pr(H = 1) before the sweep.
    pub prior_h1: f64,
    /// The posterior from which there is an inclusion; up to 1 minus this there is none.
    pub sure: f64,
}

/// The standard deviation of the amplitude of a signal, over that of its map: stiffness and size of the inclusion, and finite strain, are
/// not those of the map. Of a bank with several diameters the size is one of them.
pub const AMPLITUDE: f64 = 0.4;
const AMPLITUDE_OF_DIAMETERS: f64 = 0.15;

/// One sweep of the place in question, or a reference sweep of the same gel. A record whose samples have depths of their own is the
/// sweeps that are its [passes](Record::passes).
#[derive(Debug, Clone, Copy)]
pub struct RobustSweep<'a> {
    /// The forces.
    pub record: &'a Record,
    /// Its depth, m, if its samples have none of their own.
    pub depth: f64,
    /// The gels beside that of the maps at these depths; none of measured maps.
    pub changes: Option<&'a GelChanges>,
    /// Whether it is over another place of the gel, where there is no inclusion.
    pub is_reference: bool,
}

impl<'a> RobustSweep<'a> {
    /// A sweep of the place in question.
    pub fn new(record: &'a Record, depth: f64, changes: Option<&'a GelChanges>) -> RobustSweep<'a> {
        RobustSweep {
            record,
            depth,
            changes,
            is_reference: false,
        }
    }
}

/// Nothing is known, an inclusion is as probable as none, and an answer is sure from 0.95 on.
impl Default for RobustQuestion<'_> {
    fn default() -> Self {
        RobustQuestion {
            known: &[],
            is_zeroed: false,
            noise_sd: None,
            correlation_length: 1.0,
            is_white: false,
            prior_h1: 0.5,
            sure: 0.95,
        }
    }
}

/// A hypothesis: what an inclusion adds to the forces at the samples of each sweep, stacked, N.
#[derive(Debug, Clone)]
pub struct RobustSignal {
    /// One series for each sweep.
    pub of_sweeps: Vec<Vec<f64>>,
    /// The standard deviation of its amplitude, over that of its map.
    pub amplitude_sd: f64,
    /// Its probability, given an inclusion.
    pub prior: f64,
}

/// The answer.
#[derive(Debug, Clone, Default, PartialEq)]
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
    pub classes: Vec<(Class, [f64; 2])>,
    /// The largest rates of a false "inclusion" and a false "no inclusion", over the classes with a posterior above 1 %; none if the
    /// record cannot be compared.
    pub rates: Option<ErrorRates>,
    /// Σ F f/Σ f² of the normal force of each sweep.
    pub levels: Vec<f64>,
    /// Standard deviation of the noise of each sweep, N.
    pub noise_sd: Vec<Force<Option<f64>>>,
    /// Samples of each sweep that were replaced.
    pub glitches: Vec<usize>,
    /// Samples of each sweep in air at its start and at its end.
    pub in_air: Vec<[usize; 2]>,
    /// What either hypothesis expects of the records, where they were compared.
    pub explanation: Option<Explanation>,
    /// Whether "no inclusion" would rest on lateral forces that may not be what they are said to be.
    pub is_none_doubtful: bool,
}

impl RobustAnswer {
    /// The likeliest class without (0) or with (1) an inclusion, by its number.
    pub fn likeliest_class(&self, hypothesis: usize) -> Option<usize> {
        let share = |class: &usize| self.classes[*class].1[hypothesis];
        (0..self.classes.len()).max_by(|a, b| share(a).total_cmp(&share(b)))
    }
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
            check_positive("noise_sd_normal_n", sd.normal)?;
            let length = self.correlation_length;
            in_range(length >= 1.0, "correlation_length", length, "at least 1")
        };
        checked().map(|_| ()).map_err(Refusal::from)
    }

    /// The variance of the modes of the noise that is stated, N².
    ///
    /// Implements: ROB-012.
    fn stated_power(&self) -> Option<Force<f64>> {
        let power = |sd: f64| sd * sd * self.correlation_length;
        self.noise_sd.map(|sd| sd.map(power))
    }

    /// Judges sweeps of one place for the inclusion of one map, where that map has it.
    ///
    /// # Errors
    /// Positions or depths outside the maps; too few samples; a probability or a noise out of its range.
    ///
    /// Implements: ROB-030.
    pub fn judge(
        &self,
        hypotheses: Hypotheses<'_>,
        sweeps: &[RobustSweep<'_>],
    ) -> Result<RobustAnswer, Refusal> {
        self.detector(hypotheses, sweeps)?.judge(&records(sweeps))
    }

    /// The detector of records over the positions of these sweeps.
    ///
    /// # Errors
    /// As [`RobustQuestion::judge`].
    pub fn detector(
        &self,
        hypotheses: Hypotheses<'_>,
        sweeps: &[RobustSweep<'_>],
    ) -> Result<RobustDetector<'_>, Refusal> {
        let (without, with) = (hypotheses.without(), hypotheses.with());
        let normal = (!hypotheses.have_lateral()).then(|| without.of_normal());
        let without = normal.as_ref().unwrap_or(without);
        let signal = |sweep: &RobustSweep<'_>| sweep.signal(with, &sweep.expected(without)?);
        let of_sweeps = sweeps.iter().map(signal).collect::<Result<_, Refusal>>()?;
        let signal = RobustSignal {
            of_sweeps,
            amplitude_sd: AMPLITUDE,
            prior: 1.0,
        };
        RobustDetector::new(*self, without, sweeps, &[signal])
    }

    /// Searches sweeps of one place, all at the depth of the bank, for any inclusion of it, or two.
    ///
    /// # Errors
    /// Another depth; positions outside the bank; too few samples; a prior that is none; a probability or a noise out of its range.
    ///
    /// Implements: ROB-030, ROB-041.
    pub fn locate(
        &self,
        bank: &Bank,
        prior: Option<&[f64]>,
        sweeps: &[RobustSweep<'_>],
    ) -> Result<(RobustAnswer, RobustPlace), Refusal> {
        let (detector, hypotheses) = self.bank_detector(bank, prior, sweeps)?;
        let answer = detector.judge(&records(sweeps))?;
        let place = hypotheses.place(&answer);
        Ok((answer, place))
    }

    /// The detector of a bank's inclusions in records over the positions of these sweeps, and its hypotheses.
    ///
    /// # Errors
    /// As [`RobustQuestion::locate`].
    pub fn bank_detector<'b>(
        &self,
        bank: &'b Bank,
        prior: Option<&[f64]>,
        sweeps: &[RobustSweep<'_>],
    ) -> Result<(RobustDetector<'_>, BankHypotheses<'b>), Refusal> {
        if let Some(prior) = prior {
            // Whether it is one.
            mixture_theta(&vec![0.0; bank.maps().len()], prior).map_err(refused)?;
        }
        let mut even = sweeps
            .iter()
            .filter(|sweep| sweep.record.depths().is_none());
        even.try_for_each(|sweep| bank.check_depth(sweep.depth))?;
        let mut hypotheses = BankHypotheses::new(bank, prior);
        hypotheses.is_zeroed = self.is_zeroed;
        let signals = hypotheses.signals(sweeps)?;
        let without = bank.reference().table();
        let detector = RobustDetector::new(*self, without, sweeps, &signals)?;
        Ok((detector, hypotheses))
    }
}

/// The forces that `map` expects of `record`, N, stacked; lateral ones of 0 where the map has none, which then do not
/// count.
///
/// # Errors
/// As [`Record::expected`].
///
/// Implements: ROB-006.
fn expected(record: &Record, map: &ForceTable, depth: f64) -> Result<Vec<f64>, Refusal> {
    let mut expected = record.expected(map, depth)?;
    expected.lateral.resize(expected.normal.len(), 0.0);
    Ok(stacked(expected))
}

/// The channels of stacked samples of both.
fn channels(stacked: &[f64]) -> Force<&[f64]> {
    design::channels(stacked, stacked.len() / 2)
}

fn records<'a>(sweeps: &[RobustSweep<'a>]) -> Vec<Force<&'a [f64]>> {
    sweeps.iter().map(|sweep| sweep.record.forces()).collect()
}

impl RobustSweep<'_> {
    /// The forces of a map at the samples, stacked, N.
    fn expected(&self, map: &ForceTable) -> Result<Vec<f64>, Refusal> {
        expected(self.record, map, self.depth)
    }

    /// What the inclusion of the map `with` adds to the forces `none` without inclusion, N.
    fn signal(&self, with: &ForceTable, none: &[f64]) -> Result<Vec<f64>, Refusal> {
        let signal = difference(&self.expected(with)?, none);
        Ok(match self.is_reference {
            true => vec![0.0; signal.len()],
            false => signal,
        })
    }
}
