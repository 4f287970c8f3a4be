//! What a record may hold beside noise, sample by sample: the signal of the inclusion, and nuisances of unknown amplitude.

use std::fmt;

use serde::Serialize;

use super::{Question, Record};
use crate::detect::DetectError;
use crate::detect::correlation::block_sums;
use crate::detect::nuisance::{DEPENDENT, Nuisances, SubspaceDetector};
use crate::force::Force;
use crate::force_map::{ForceTable, SAME_POSITION};
use crate::refusal::Refusal;
use crate::stats::error::check_positive;

/// What may be unknown of a sweep.
///
/// Implements: TRC-060.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Unknown {
    /// A constant force in each channel.
    Offset,
    /// A force in each channel that grows with the sample, from one end of the record to the other.
    Drift,
    /// The stiffness of the whole gel: the forces without inclusion times any number.
    Gain,
    /// The depth of the sweep, to first order about the one that is stated.
    Depth,
    /// The standard deviation of the noise.
    Variance,
}

impl Unknown {
    /// All of them.
    pub const ALL: [Unknown; 5] = {
        use Unknown::{Depth, Drift, Gain, Offset, Variance};
        [Offset, Drift, Gain, Depth, Variance]
    };
}

/// Its name on the command line and in JSON.
impl fmt::Display for Unknown {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.serialize(f)
    }
}

/// Names with commas, or "nothing".
pub fn in_words(unknown: &[Unknown]) -> String {
    let names: Vec<_> = unknown.iter().map(Unknown::to_string).collect();
    match names[..] {
        [] => "nothing".into(),
        _ => names.join(", "),
    }
}

/// Samples of both channels.
pub type Series = Force<Vec<f64>>;

/// The parts of a record, all in the same unit and over the same samples.
#[derive(Debug, Clone)]
pub struct Design {
    /// F_0.
    pub reference: Series,
    /// F_p − F_0.
    pub residual: Series,
    /// F_1 − F_0; nothing until it is set.
    pub template: Series,
    /// One for each amplitude that is unknown.
    pub nuisances: Vec<Series>,
    /// What a depth at the end of its tolerance adds to either hypothesis.
    pub depth_errors: Vec<Series>,
}

impl Design {
    /// The parts of `record` but for the template, by the map `without` inclusion, N.
    ///
    /// Implements: TRC-064.
    pub fn new(
        question: &Question<'_>,
        without: &ForceTable,
        record: &Record,
    ) -> Result<Design, Refusal> {
        let depth = question.depth;
        let f0 = record.expected(without, depth)?;
        let nuisances = nuisances(question.unknown, without.depths(), depth, |depth| {
            record.expected(without, depth)
        })?;
        let none = vec![0.0; record.positions().len()];
        let mut design = Design {
            residual: difference(record.forces(), f0.as_deref()),
            reference: f0,
            template: Force::new(none.clone(), none),
            nuisances,
            depth_errors: Vec::new(),
        };
        design.add_depth_error(question, without, record)?;
        Ok(design)
    }

    /// Counts what the tolerance of the depth does to the forces of `map`.
    ///
    /// Implements: TRC-064.
    pub fn add_depth_error(
        &mut self,
        question: &Question<'_>,
        map: &ForceTable,
        record: &Record,
    ) -> Result<(), Refusal> {
        let (depth, tolerance) = (question.depth, question.depth_tolerance);
        if !question.is_unknown(Unknown::Depth) && tolerance > 0.0 {
            let slope = depth_slope(map.depths(), depth, |depth| record.expected(map, depth))?;
            let error = slope.map(|slope| scaled(&slope, Force::new(tolerance, tolerance)));
            self.depth_errors.extend(error);
        }
        Ok(())
    }

    /// Takes the forces of the map `with` an inclusion for those of the inclusion that is looked for.
    pub fn set_template(
        &mut self,
        question: &Question<'_>,
        with: &ForceTable,
        record: &Record,
    ) -> Result<(), Refusal> {
        let f1 = record.expected(with, question.depth)?;
        self.template = difference(f1.as_deref(), self.reference.as_deref());
        Ok(())
    }

    /// The same with a function of each channel's series.
    fn map(&self, of: impl Fn(&Series) -> Series) -> Design {
        let all = |series: &[Series]| series.iter().map(&of).collect();
        Design {
            reference: of(&self.reference),
            residual: of(&self.residual),
            template: of(&self.template),
            nuisances: all(&self.nuisances),
            depth_errors: all(&self.depth_errors),
        }
    }

    /// The parts over the standard deviations of the noise.
    pub fn whitened(&self, noise_sd: Force<f64>) -> Design {
        self.map(|series| whitened(series, noise_sd))
    }

    /// The sums over blocks of so many samples.
    pub fn blocks(&self, length: usize) -> Design {
        self.map(|series| blocked(series, length))
    }

    /// What the depth may add to T at most.
    ///
    /// Implements: TRC-064.
    pub fn bias(&self, detector: &SubspaceDetector<'_>) -> f64 {
        let along = |error: &Series| detector.along(&stacked(error)).abs();
        self.depth_errors.iter().map(along).fold(0.0, f64::max)
    }

    /// Samples of a channel.
    pub fn samples(&self) -> usize {
        self.residual.lateral.len()
    }

    /// The nuisances, and the template where it is `with_template`, one after the other.
    pub fn signals(&self, with_template: bool) -> Vec<f64> {
        let template = with_template.then_some(&self.template);
        let signals = self.nuisances.iter().chain(template);
        signals.flat_map(stacked).collect()
    }

    /// What neither the nuisances nor the template explain of the record, and the number of amplitudes that did.
    pub fn unexplained(&self) -> Result<(Series, usize), DetectError> {
        let (mut signals, mut left) = (self.signals(true), stacked(&self.residual));
        let signals = Nuisances::new(&mut signals, left.len())?;
        signals.project(&mut left);
        let normal = left.split_off(self.samples());
        Ok((Force::new(left, normal), signals.rank()))
    }

    /// The standard deviation of a sample by what is left of the record, whose parts are in newtons.
    ///
    /// # Errors
    /// Nothing is left of a channel: its noise is not known.
    ///
    /// Implements: TRC-068.
    pub fn noise_sd(&self) -> Result<Force<f64>, DetectError> {
        let (left, explained) = self.unexplained()?;
        let degrees = self.samples() as f64 - 0.5 * explained as f64;
        let sd = left.as_deref().zip(self.residual.as_deref());
        let sd = sd.map(|(left, all)| {
            let found = squares(left);
            // Less is rounding.
            if found > DEPENDENT * DEPENDENT * squares(all) {
                libm::sqrt(found / degrees.max(1.0))
            } else {
                0.0
            }
        });
        check_positive("noise_sd_lateral_n", sd.lateral)?;
        check_positive("noise_sd_normal_n", sd.normal)?;
        Ok(sd)
    }

    /// Σ F_p F_0 / Σ F_0² of whitened parts; none if its standard deviation is above 0.1.
    ///
    /// Implements: TRC-070.
    pub fn level(&self) -> Option<f64> {
        let (reference, residual) = (stacked(&self.reference), stacked(&self.residual));
        let square = squares(&reference);
        let products = std::iter::zip(reference, residual).map(|(a, b)| a * b);
        let cross: f64 = products.sum();
        (square >= 100.0).then(|| 1.0 + cross / square)
    }
}

pub(crate) fn blocked(series: &Series, length: usize) -> Series {
    let sums = |series: &[f64]| block_sums(series, length).collect();
    series.as_deref().map(sums)
}

/// The lateral samples and then the normal ones.
pub fn stacked(series: &Series) -> Vec<f64> {
    [&series.lateral[..], &series.normal[..]].concat()
}

/// Σ of the squares.
pub fn squares(values: &[f64]) -> f64 {
    values.iter().map(|value| value * value).sum()
}

/// A series over the standard deviations of the noise.
pub fn whitened(series: &Series, noise_sd: Force<f64>) -> Series {
    scaled(series, noise_sd.map(|sd| 1.0 / sd))
}

fn scaled(series: &Series, factor: Force<f64>) -> Series {
    let channels = series.as_deref().zip(factor);
    channels.map(|(series, factor)| series.iter().map(|value| factor * value).collect())
}

pub(crate) fn difference(a: Force<&[f64]>, b: Force<&[f64]>) -> Series {
    a.zip(b)
        .map(|(a, b)| std::iter::zip(a, b).map(|(a, b)| a - b).collect())
}

/// One signal for each amplitude that is `unknown` of a sweep at `depth` (m). `expected` gives its forces without inclusion, N, for
/// a depth, by a map with rows at `depths`.
///
/// # Errors
/// A map of one depth where the depth is unknown; a depth that `expected` refuses.
///
/// Implements: TRC-060.
pub fn nuisances(
    unknown: &[Unknown],
    depths: &[f64],
    depth: f64,
    expected: impl Fn(f64) -> Result<Series, Refusal>,
) -> Result<Vec<Series>, Refusal> {
    let f0 = expected(depth)?;
    let samples = f0.normal.len();
    let alone = |series: &dyn Fn(usize) -> f64| {
        let series: Vec<f64> = (0..samples).map(series).collect();
        let none = vec![0.0; samples];
        let lateral = Force::new(series.clone(), none.clone());
        [lateral, Force::new(none, series)]
    };
    let mut nuisances = Vec::new();
    if unknown.contains(&Unknown::Offset) {
        nuisances.extend(alone(&|_| 1.0));
    }
    if unknown.contains(&Unknown::Drift) {
        let last = samples.saturating_sub(1).max(1) as f64;
        nuisances.extend(alone(&|sample| 2.0 * sample as f64 / last - 1.0));
    }
    if unknown.contains(&Unknown::Gain) {
        nuisances.push(f0);
    }
    if unknown.contains(&Unknown::Depth) {
        nuisances.push(depth_slope(depths, depth, expected)?.ok_or_else(|| {
            let found = "the maps have a single depth";
            Refusal::state(found, "rows at other depths, where the depth is unknown")
        })?);
    }
    Ok(nuisances)
}

/// ∂F/∂d at the samples, N/m, between the `depths` on either side of `depth`; none if there is no other.
///
/// Implements: TRC-060.
fn depth_slope(
    depths: &[f64],
    depth: f64,
    expected: impl Fn(f64) -> Result<Series, Refusal>,
) -> Result<Option<Series>, Refusal> {
    let mut upwards = depths.iter().rev();
    let above = upwards.find(|&&row| row < depth - SAME_POSITION);
    let below = depths.iter().find(|&&row| row > depth + SAME_POSITION);
    let (from, to) = (*above.unwrap_or(&depth), *below.unwrap_or(&depth));
    if from == to {
        return Ok(None);
    }
    let (shallow, deep) = (expected(from)?, expected(to)?);
    let change = difference(deep.as_deref(), shallow.as_deref());
    let rate = 1.0 / (to - from);
    Ok(Some(scaled(&change, Force::new(rate, rate))))
}
