//! What a record may hold beside noise, sample by sample: the signal of the inclusion, and nuisances of unknown amplitude.

use super::question::{LEAST_SAMPLES, Question, Unknown};
use super::{Record, refused};
use crate::decimal::mm;
use crate::detect::DetectError;
use crate::detect::nuisance::{DEPENDENT, Nuisances, Rank, SubspaceDetector};
use crate::force::Force;
use crate::force_map::{ForceTable, SAME_POSITION, shallowest};
use crate::refusal::Refusal;
use crate::stats::error::{check_positive, representable};

/// The parts of a record, all in the same unit and over the same samples: of each part the lateral samples, if the record has any, and
/// then the normal ones.
#[derive(Debug, Clone)]
pub struct Design {
    /// Samples of a channel.
    pub samples: usize,
    /// F_0.
    pub reference: Vec<f64>,
    /// F_p − F_0.
    pub residual: Vec<f64>,
    /// F_1 − F_0; nothing until it is set.
    pub template: Vec<f64>,
    /// One for each amplitude that is unknown.
    pub nuisances: Vec<Vec<f64>>,
    /// What a depth at the end of its tolerance adds to either hypothesis.
    pub depth_errors: Vec<Vec<f64>>,
    /// The standard deviation of what the independent errors of the depths add, N, with the sign of ∂F_0/∂d; nothing if there are none.
    pub depth_noise: Vec<f64>,
    /// Whether the samples are in the reverse order of the file.
    pub is_reversed: bool,
}

impl Design {
    /// The parts of `record` but for the template, by the map `without` inclusion, N.
    ///
    /// # Errors
    /// As [`Record::expected`]; noise that is neither stated nor unknown, or cannot be estimated from so few samples; errors of the depths
    /// in noise that is not stated, or by a map of one depth.
    ///
    /// Implements: TRC-064, TRC-068.
    pub fn new(
        question: &Question<'_>,
        without: &ForceTable,
        record: &Record,
    ) -> Result<Design, Refusal> {
        let reference = expected(record, without, question.depth)?;
        let samples = record.positions().len();
        check_noise(question, record)?;
        let slope = || slope(record, without, question.depth, expected);
        let found = "the errors of the depths cannot be told from noise that is estimated";
        let is_mixed = record.depth_sd() > 0.0 && question.noise.sd.is_none();
        Refusal::state(found, "state the noise (--noise-sd-n)").when(is_mixed)?;
        let depth_noise = match record.depth_sd() {
            0.0 => Vec::new(),
            sd => scaled(&slope()?.ok_or_else(single_depth)?, sd),
        };
        let mut design = Design {
            samples,
            residual: difference(&stacked(record.forces()), &reference),
            template: vec![0.0; reference.len()],
            nuisances: nuisances_of(question.unknown, (&reference, samples), slope)?,
            reference,
            depth_errors: Vec::new(),
            depth_noise,
            is_reversed: record.is_reversed(),
        };
        design
            .depth_errors
            .extend(depth_error(question, without, record)?);
        Ok(design)
    }

    /// The parts over the standard deviations of the noise, or over the covariance of the two channels where the depths have errors.
    ///
    /// Implements: TRC-086.
    pub fn whitened(&self, noise_sd: Force<f64>) -> Design {
        let of = |part: &[f64]| self.over_noise(part, noise_sd);
        let all = |parts: &[Vec<f64>]| parts.iter().map(|part| of(part)).collect();
        Design {
            samples: self.samples,
            reference: of(&self.reference),
            residual: of(&self.residual),
            template: of(&self.template),
            nuisances: all(&self.nuisances),
            depth_errors: all(&self.depth_errors),
            depth_noise: self.depth_noise.clone(),
            is_reversed: self.is_reversed,
        }
    }

    /// A part, N, over the standard deviations of the noise, or over the covariance as in [`Design::whitened`].
    ///
    /// Implements: TRC-086.
    pub fn over_noise(&self, part: &[f64], noise_sd: Force<f64>) -> Vec<f64> {
        match &self.depth_noise[..] {
            [] => whitened(part, self.samples, noise_sd),
            beside => whitened_beside(part, self.samples, noise_sd, beside),
        }
    }

    /// What the depth may add to T at most.
    ///
    /// # Errors
    /// Overflow.
    ///
    /// Implements: TRC-064.
    pub fn bias(&self, detector: &SubspaceDetector<'_>) -> Result<f64, DetectError> {
        let mut errors = self.depth_errors.iter();
        errors.try_fold(0.0, |most: f64, error| {
            let bias = representable("bias", detector.along(error))?;
            Ok(most.max(bias.abs()))
        })
    }

    /// The channels of a part; no lateral samples where the record has none.
    pub fn channels<'a>(&self, part: &'a [f64]) -> Force<&'a [f64]> {
        channels(part, self.samples)
    }

    /// Whether the record has lateral forces.
    pub fn has_lateral(&self) -> bool {
        self.residual.len() > self.samples
    }

    /// The nuisances, and the template where it is `with_template`, one after the other.
    pub fn signals(&self, with_template: bool) -> Vec<f64> {
        let template = with_template.then_some(&self.template);
        let signals = self.nuisances.iter().chain(template);
        signals.flatten().copied().collect()
    }

    /// What neither the nuisances nor the template explain of the record, and the number of amplitudes that did, of those that count once.
    pub fn unexplained(&self) -> Result<(Vec<f64>, Rank), DetectError> {
        let (mut signals, mut left) = (self.signals(true), self.residual.clone());
        let signals = Nuisances::new(&mut signals, left.len())?;
        signals.project(&mut left)?;
        Ok((left, signals.rank()))
    }

    /// The standard deviation of a sample, estimated from the record, whose parts are in newtons; anything for a channel that it does not
    /// have.
    ///
    /// # Errors
    /// Nothing is left of a channel: its noise is not known.
    ///
    /// Implements: TRC-068.
    pub fn noise_sd(&self) -> Result<Force<f64>, DetectError> {
        let (left, explained) = self.unexplained()?;
        let channels = self.residual.len() / self.samples;
        let degrees = self.samples as f64 - explained.get() as f64 / channels as f64;
        let sd = self.channels(&left).zip(self.channels(&self.residual));
        let sd = sd.map(|(left, all)| {
            if all.is_empty() {
                return 1.0;
            }
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
}

/// What the tolerance of the depth does to the forces of `map`, N; none where the depth is exact or unknown, or the map has one depth.
///
/// # Errors
/// A tolerance that is no length; as [`Record::expected`].
///
/// Implements: TRC-064.
pub fn depth_error(
    question: &Question<'_>,
    map: &ForceTable,
    record: &Record,
) -> Result<Option<Vec<f64>>, Refusal> {
    let (depth, tolerance) = (question.depth, question.depth_tolerance);
    let right = "a length of at least 0 mm";
    let wrong = Refusal::value("depth_tolerance_mm", mm(tolerance), right);
    wrong.when(!(0.0..f64::INFINITY).contains(&tolerance))?;
    if !question.has_depth_tolerance() {
        return Ok(None);
    }
    let slope = slope(record, map, depth, expected)?;
    Ok(slope.map(|slope| scaled(&slope, tolerance)))
}

/// Refuses a record whose noise is neither stated nor can be estimated.
///
/// Implements: TRC-068.
fn check_noise(question: &Question<'_>, record: &Record) -> Result<(), Refusal> {
    if question.noise.sd.is_some() {
        return Ok(());
    }
    let found = "the noise is not stated, and its variance is taken as known";
    let remedy = "state the noise (--noise-sd-n, or --noise FILE), or take the variance as unknown";
    Refusal::state(found, remedy).when(!question.is_unknown(Unknown::Variance))?;
    let samples = record.positions().len();
    let remedy = format!("give at least {LEAST_SAMPLES}, or state the noise (--noise-sd-n)");
    let found = format!("{samples} samples, whose noise is not stated");
    let few = Refusal::state(found, remedy).in_file(record.file());
    few.when(!record.forces().lateral.is_empty() && samples < LEAST_SAMPLES)
}

/// The lateral samples, if there are any, and then the normal ones.
pub fn stacked(series: Force<impl AsRef<[f64]>>) -> Vec<f64> {
    [series.lateral.as_ref(), series.normal.as_ref()].concat()
}

/// The forces that `map` expects of `record` at `depth` (m), N, stacked, in the channels that the record has.
///
/// # Errors
/// As [`Record::expected`].
///
/// Implements: TRC-015.
pub fn expected(record: &Record, map: &ForceTable, depth: f64) -> Result<Vec<f64>, Refusal> {
    let mut expected = record.expected(map, depth)?;
    expected.lateral.truncate(record.forces().lateral.len());
    Ok(stacked(expected))
}

/// The channels of stacked samples, of which each has so many.
pub(crate) fn channels(stacked: &[f64], samples: usize) -> Force<&[f64]> {
    let (lateral, normal) = stacked.split_at(stacked.len() - samples);
    Force::new(lateral, normal)
}

/// Σ of the squares.
pub fn squares(values: &[f64]) -> f64 {
    values.iter().map(|value| value * value).sum()
}

/// Stacked samples, so many of each channel, over the standard deviations of the noise.
pub fn whitened(stack: &[f64], samples: usize, noise_sd: Force<f64>) -> Vec<f64> {
    let channels = channels(stack, samples).zip(noise_sd);
    stacked(channels.map(|(samples, sd)| scaled(samples, 1.0 / sd)))
}

/// The same where a common error of both channels of a sample is `beside` their noise: over the Cholesky factor of their covariance.
///
/// Implements: TRC-086.
fn whitened_beside(stack: &[f64], samples: usize, sd: Force<f64>, beside: &[f64]) -> Vec<f64> {
    let Force { lateral, normal } = channels(stack, samples).zip(channels(beside, samples));
    let root = |sd: f64, of: f64| libm::sqrt(sd * sd + of * of);
    let mut white = Vec::with_capacity(stack.len());
    let mut along = vec![(0.0, 0.0); samples];
    for ((value, of), along) in lateral.0.iter().zip(lateral.1).zip(&mut along) {
        let own = root(sd.lateral, *of);
        white.push(value / own);
        *along = (of / own, value / own);
    }
    for ((value, of), (share, lateral)) in normal.0.iter().zip(normal.1).zip(along) {
        let common = of * share;
        let own = root(sd.normal, *of * libm::sqrt(1.0 - share * share));
        white.push((value - common * lateral) / own);
    }
    white
}

fn scaled(values: &[f64], factor: f64) -> Vec<f64> {
    values.iter().map(|value| factor * value).collect()
}

pub(crate) fn difference(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a - b).collect()
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
    expected: impl Fn(f64) -> Result<Force<Vec<f64>>, Refusal>,
) -> Result<Vec<Force<Vec<f64>>>, Refusal> {
    let f0 = expected(depth)?;
    let samples = f0.normal.len();
    let slope = || depth_slope(depths, depth, |depth| expected(depth).map(stacked));
    let nuisances = nuisances_of(unknown, (&*stacked(f0), samples), slope)?;
    let apart = |nuisance: &Vec<f64>| channels(nuisance, samples).map(<[f64]>::to_vec);
    Ok(nuisances.iter().map(apart).collect())
}

/// As [`nuisances`], all stacked, with the forces `f0` without inclusion, so many samples of each channel, and their `slope` ∂F_0/∂d.
pub(crate) fn nuisances_of(
    unknown: &[Unknown],
    (f0, samples): (&[f64], usize),
    slope: impl Fn() -> Result<Option<Vec<f64>>, Refusal>,
) -> Result<Vec<Vec<f64>>, Refusal> {
    let alone = |series: &dyn Fn(usize) -> f64| {
        let in_channel = |channel: usize| {
            let all = 0..f0.len();
            let is_in = |at: usize| at / samples == channel;
            all.map(|at| if is_in(at) { series(at % samples) } else { 0.0 })
                .collect()
        };
        (0..f0.len() / samples)
            .map(in_channel)
            .collect::<Vec<Vec<f64>>>()
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
        nuisances.push(f0.to_vec());
    }
    if unknown.contains(&Unknown::Depth) {
        nuisances.push(slope()?.ok_or_else(single_depth)?);
    }
    Ok(nuisances)
}

/// An unknown depth has no signal.
pub(crate) fn single_depth() -> Refusal {
    let found = "the maps have a single depth";
    Refusal::state(found, "give rows at other depths, or the depth as known")
}

/// ∂F/∂d at the samples, N/m, between the `depths` on either side of `depth`; none if there is no other.
///
/// Implements: TRC-060.
pub(crate) fn depth_slope(
    depths: &[f64],
    depth: f64,
    expected: impl Fn(f64) -> Result<Vec<f64>, Refusal>,
) -> Result<Option<Vec<f64>>, Refusal> {
    let mut upwards = depths.iter().rev();
    let above = upwards.find(|&&row| row < depth - SAME_POSITION);
    let below = depths.iter().find(|&&row| row > depth + SAME_POSITION);
    let (from, to) = (*above.unwrap_or(&depth), *below.unwrap_or(&depth));
    if from == to {
        return Ok(None);
    }
    let (shallow, deep) = (expected(from)?, expected(to)?);
    let change = difference(&deep, &shallow);
    Ok(Some(scaled(&change, 1.0 / (to - from))))
}

/// γ of each map `with` an inclusion, along `sweep`, a record of which the forces count for nothing, in noise of `noise_sd` (N). What is
/// `unknown` bends the forces `without` inclusion; `base` are the same at the depths of the maps alone, over which these have their
/// signals. `depth` (m) is that of a sweep whose samples have none.
///
/// # Errors
/// As [`Record::expected`]; an unknown depth of a map of one depth.
///
/// Implements: BNK-080, BNK-082.
pub fn gammas_along<'a>(
    (sweep, depth): (&Record, f64),
    unknown: &[Unknown],
    noise_sd: Force<f64>,
    without: &ForceTable,
    (base, with): (&ForceTable, impl IntoIterator<Item = &'a ForceTable>),
) -> Result<Vec<f64>, Refusal> {
    let (f0, samples) = (expected(sweep, without, depth)?, sweep.positions().len());
    let none = expected(sweep, base, depth)?;
    let slope = || slope(sweep, without, depth, expected);
    let nuisances = nuisances_of(unknown, (&f0, samples), slope)?;
    let white = |signal: &[f64]| whitened(signal, samples, noise_sd);
    let mut nuisances: Vec<f64> = nuisances.iter().flat_map(|of| white(of)).collect();
    let space = Nuisances::new(&mut nuisances, f0.len()).map_err(refused)?;
    let gamma = |map| {
        let f1 = expected(sweep, map, depth)?;
        let signal = &mut white(&difference(&f1, &none));
        space.project(signal).map_err(refused)
    };
    with.into_iter().map(gamma).collect()
}

/// Half the way over which ∂F/∂d is taken at a sample with a depth of its own, m.
const HALF_STEP: f64 = 0.05e-3;

/// ∂F/∂d of `map` at the samples of `record`, N/m, of forces as `expected` gives them: at the depth of each sample, or at `depth` (m)
/// where the record has none; none if the map has one depth.
///
/// # Errors
/// As [`Record::expected`].
///
/// Implements: TRC-060, TRC-084.
pub(crate) fn slope(
    record: &Record,
    map: &ForceTable,
    depth: f64,
    expected: impl Fn(&Record, &ForceTable, f64) -> Result<Vec<f64>, Refusal>,
) -> Result<Option<Vec<f64>>, Refusal> {
    let (rows, last) = (map.depths(), map.depths().len() - 1);
    if record.depths().is_none() {
        return depth_slope(rows, depth, |depth| expected(record, map, depth));
    }
    if last == 0 {
        return Ok(None);
    }
    let least = shallowest(rows);
    let beside = |way: f64| record.moved(|depth| (depth + way).clamp(least, rows[last]));
    let [shallow, deep] = [-HALF_STEP, HALF_STEP].map(beside);
    let ways = deep
        .depths()
        .into_iter()
        .flatten()
        .zip(shallow.depths().into_iter().flatten());
    let ways: Vec<f64> = ways.map(|(deep, shallow)| deep - shallow).collect();
    let change = difference(
        &expected(&deep, map, depth)?,
        &expected(&shallow, map, depth)?,
    );
    let pairs = change.iter().zip(ways.iter().cycle());
    Ok(Some(pairs.map(|(change, way)| change / way).collect()))
}
