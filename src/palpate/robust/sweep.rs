//! A sweep in its modes, and a record of it over its level.

use nalgebra::DVector;

use super::classes::Undisturbed;
use super::detector::MISFIT_RATE;
use super::gates;
use super::gel::{GelChange, GelUncertainty};
use super::modes::{Modes, Spectrum, along};
use super::{RobustQuestion, RobustSweep, channels, expected};
use crate::force::Force;
use crate::force_map::{ForceMap, ForceTable};
use crate::refusal::Refusal;
use crate::stats::noncentral::chi_square;
use crate::trace::contact::{RADIUS, in_air, is_narrow, level, radius, wrong_level};
use crate::trace::design::{difference, slope};
use crate::trace::{Cause, LEAST_SAMPLES, Record};

/// The force at a sample is at most so many times that at the mean depth.
const MOST_SHARE: f64 = 10.0;
/// The standard deviation of the zero of measured depths, over the radius of the probe: 0.2 mm.
///
/// Implements: ROB-082.
const ZERO: f64 = 0.031;
/// Samples of a sweep: beyond, a covariance between them would take gigabytes.
const MOST_SAMPLES: usize = 10_000;

/// A sweep in its modes.
pub struct PreparedSweep {
    pub modes: Modes,
    /// Whether its records have lateral forces.
    pub has_lateral: bool,
    pub undisturbed: Undisturbed,
    forces: DVector<f64>,
    /// Whether its records are in the reverse order of their files.
    is_reversed: bool,
}

/// The noise of the lateral force, over that of the normal force, below which it is in another unit, or comes from no sensor.
const QUIET: f64 = 0.02;

/// The variance of the noise is at most so many times the one that is stated.
const MOST_OF_STATED: f64 = 2.0;

/// Whether the squares that the modes leave of the lateral forces are next to nothing beside those of the normal ones.
///
/// Implements: ROB-009.
fn is_quiet(left: Force<f64>) -> bool {
    left.lateral < QUIET * QUIET * left.normal
}

/// A record without its glitches.
#[derive(Clone)]
pub struct Cleaned {
    pub forces: Force<Vec<f64>>,
    /// Σ F f/Σ f² of its normal force.
    pub level: f64,
    /// The noise of each channel.
    pub noise: Force<Spectrum>,
    /// Samples that were replaced.
    pub glitches: usize,
    /// Whether there is more noise than was stated.
    pub is_noisier: bool,
}

impl Cleaned {
    /// With the other sign of its lateral forces.
    ///
    /// Implements: ROB-009.
    pub fn turned(&self) -> Cleaned {
        let mut turned = self.clone();
        let lateral = turned.forces.lateral.iter_mut();
        lateral.for_each(|force| *force = -*force);
        turned
    }
}

impl RobustQuestion<'_> {
    /// The passes of a record under the probe of `reference` that are long enough to be sweeps, or the longest if none is; and how many
    /// samples the others have.
    ///
    /// Implements: ROB-083, ROB-084.
    pub fn passes(&self, record: &Record, reference: &ForceMap) -> (Vec<Record>, usize) {
        let radius = radius(reference);
        let width = |pass: &Record| {
            let x = pass.positions();
            x[x.len() - 1] - x[0]
        };
        let is_long = |pass: &Record| {
            !is_narrow(width(pass), radius) && pass.positions().len() >= self.least_samples()
        };
        let mut passes = record.passes();
        if passes.iter().any(is_long) {
            passes.retain(is_long);
        } else {
            passes.sort_by(|a, b| width(b).total_cmp(&width(a)));
            passes.truncate(1);
        }
        let kept: usize = passes.iter().map(|pass| pass.positions().len()).sum();
        (passes, record.positions().len() - kept)
    }

    /// The fewest samples of a sweep.
    fn least_samples(&self) -> usize {
        match self.noise_sd {
            Some(_) => gates::LEAST_SAMPLES_IN_NOISE,
            None => LEAST_SAMPLES,
        }
    }
}

/// The sweep, ready for its records.
///
/// # Errors
/// Samples outside the map; too few samples, or too many; a sweep over the surface by a map of no other depth.
///
/// Implements: ROB-085.
pub fn prepared(
    question: &RobustQuestion<'_>,
    without: &ForceTable,
    sweep: &RobustSweep<'_>,
    extent: Option<[f64; 2]>,
) -> Result<PreparedSweep, Refusal> {
    let record = sweep.record;
    let samples = record.positions().len();
    let least = question.least_samples();
    let remedy = match samples < least {
        true => format!("give at least {least}"),
        false => format!("give at most {MOST_SAMPLES}, such as means of neighbours"),
    };
    let wrong = Refusal::state(format_args!("{samples} samples"), remedy).in_file(record.file());
    wrong.when(!(least..=MOST_SAMPLES).contains(&samples))?;
    let undisturbed = undisturbed(question, without, sweep, extent)?;
    let is_stated = question.noise_sd.is_some();
    let modes = Modes::new(record.positions(), undisturbed.radius, is_stated);
    let forces = modes.of(channels(&undisturbed.forces));
    Ok(PreparedSweep {
        modes,
        has_lateral: !record.forces().lateral.is_empty(),
        undisturbed,
        forces,
        is_reversed: record.is_reversed(),
    })
}

/// What the sweep is like without disturbances.
fn undisturbed(
    question: &RobustQuestion<'_>,
    without: &ForceTable,
    sweep: &RobustSweep<'_>,
    extent: Option<[f64; 2]>,
) -> Result<Undisturbed, Refusal> {
    let (record, depth) = (sweep.record, sweep.depth);
    let radius = sweep.changes.map_or(RADIUS, |changes| changes.radius);
    let of_default = GelUncertainty::default().depth_percent;
    let depth_percent = sweep.changes.map_or(of_default, |of| of.depth_percent);
    let several = Refusal::state(
        "the record may have several passes, at depths of their own",
        "give each of its passes as a sweep",
    );
    let own = record
        .place()
        .ok_or_else(|| several.in_file(record.file()))?;
    let place = extent.unwrap_or(own);
    let samples = record.positions().len();
    let own_depths = record
        .depths()
        .map_or_else(|| vec![depth; samples], <[f64]>::to_vec);
    let forces = expected(record, without, depth)?;
    let slope = slope(record, without, depth, expected)?;
    let surface = Refusal::state(
        "the sweep touches the surface alone",
        "give a depth inside the gel, or maps with rows at several depths",
    );
    let touches = |depth: &f64| *depth <= 0.0;
    surface
        .in_file(record.file())
        .when(slope.is_none() && own_depths.iter().any(touches))?;
    // A thick gel gives way as its depth, at least.
    let over_depth = || (forces.iter().zip(own_depths.iter().cycle())).map(|(f, d)| f / d);
    let slope = slope.unwrap_or_else(|| over_depth().collect());
    let even = record.moved(|_| own_depths.iter().sum::<f64>() / samples as f64);
    let even = expected(&even, without, depth)?;
    let only = |is_so: bool, of: Vec<f64>| if is_so { of } else { Vec::new() };
    let times = |sd: f64| slope.iter().map(|slope| sd * slope).collect();
    let has_depths = record.depths().is_some();
    let zero_sd = ZERO * radius * depth_percent / of_default;
    let depth_noise = record.depth_sd();
    let is_depth_noise = depth_noise > 0.0 && question.noise_sd.is_some();
    let depth_sd = own_depths.iter().map(|depth| 0.01 * depth_percent * depth);
    let at = |changes: &[GelChange]| {
        let changes = changes.iter().map(|change| change.at(record, depth));
        changes.collect::<Result<Vec<_>, Refusal>>()
    };
    let (gel, support) = match sweep.changes {
        Some(changes) => (at(&changes.gel)?, at(&changes.support)?),
        None => (Vec::new(), Vec::new()),
    };
    Ok(Undisturbed {
        u: along(record.positions(), place),
        half: 0.5 * (place[1] - place[0]),
        uneven: only(has_depths, difference(&forces, &even)),
        share: share(channels(&forces).normal, channels(&even).normal),
        zero_error: only(has_depths, times(zero_sd)),
        depth_noise: only(is_depth_noise, times(depth_noise)),
        slope,
        gel,
        support,
        travelled: record.travelled(),
        depth_sd: depth_sd.collect(),
        radius,
        is_zeroed: question.is_zeroed,
        forces,
    })
}

/// The least variance of the noise of each channel, N²: that of its resolution, and that which is stated.
fn least_variance(steps: Force<f64>, stated: Option<Force<f64>>) -> Force<f64> {
    let stated = stated.unwrap_or_default();
    let least = |(step, stated): (f64, f64)| f64::max(step * step / 12.0, stated);
    steps.zip(stated).map(least)
}

/// The forces of a channel without glitches, with what uneven depths add; what was no glitch is as in the record, to the bit.
fn restored(((mut forces, uneven), record): ((Vec<f64>, &[f64]), &[f64])) -> Vec<f64> {
    for (at, force) in forces.iter_mut().enumerate() {
        let uneven = uneven.get(at).copied().unwrap_or_default();
        *force = match record.get(at) {
            Some(own) if own - uneven == *force => *own,
            _ => *force + uneven,
        };
    }
    forces
}

/// The forces at the samples over those at the mean depth.
fn share(forces: &[f64], even: &[f64]) -> Vec<f64> {
    let share = |(own, even): (&f64, &f64)| match own == even {
        true => 1.0,
        // A measured map may have no force there.
        false => (own / even).clamp(0.0, MOST_SHARE),
    };
    forces.iter().zip(even).map(share).collect()
}

impl PreparedSweep {
    /// Samples of a record in air at the start and at the end of its file, but for so few as may be glitches; none if there are none once
    /// so few glitches are replaced, for a spike is no air.
    ///
    /// Implements: ROB-007.
    pub fn in_air(
        &self,
        question: &RobustQuestion<'_>,
        normal: &[f64],
        cleaned: Option<&Cleaned>,
    ) -> [usize; 2] {
        if question.is_zeroed {
            return [0; 2];
        }
        let expected = channels(&self.undisturbed.forces).normal;
        let stated = question.stated_power().map(|power| power.normal);
        let ends = |normal: &[f64]| {
            let steps = normal.windows(2).map(|pair| pair[1] - pair[0]);
            let squares = steps.map(|step| 0.5 * step * step).sum::<f64>();
            let variance = stated.unwrap_or(squares / normal.len() as f64);
            in_air(normal, expected, variance)
        };
        let cleaned = cleaned.filter(|of| of.glitches <= gates::MOST_GLITCHES);
        if cleaned.is_some_and(|of| ends(&of.forces.normal) == [0; 2]) {
            return [0; 2];
        }
        let mut ends = ends(normal);
        if self.is_reversed {
            ends.reverse();
        }
        ends.map(|count| {
            if count > gates::MOST_GLITCHES {
                count
            } else {
                0
            }
        })
    }

    /// The level of a record of the sweep, by its normal forces.
    ///
    /// Implements: ROB-003.
    pub fn level(&self, question: &RobustQuestion<'_>, normal: &[f64]) -> f64 {
        match question.is_zeroed {
            true => 1.0,
            false => level(normal, channels(&self.undisturbed.forces).normal),
        }
    }

    /// A record of the sweep without its glitches, its level and its noise; or why it cannot be judged. The `level` of all sweeps says
    /// what uneven depths add.
    ///
    /// Implements: ROB-001, ROB-002, ROB-004, ROB-009, ROB-011.
    pub fn cleaned(
        &self,
        question: &RobustQuestion<'_>,
        record: Force<&[f64]>,
        level: f64,
    ) -> Result<Cleaned, Cause> {
        let modes = &self.modes;
        if is_narrow(modes.width, self.undisturbed.radius) {
            return Err(Cause::Narrow);
        }
        let mut of_channels = record.into_array().into_iter();
        if gates::is_stuck(record.normal) || of_channels.any(gates::is_saturated) {
            return Err(Cause::Saturated);
        }
        let steps = record.map(gates::step);
        let uneven = self.uneven(level);
        let stated = question.stated_power();
        let least = least_variance(steps, stated);
        let clean = |((channel, least), uneven): ((&[f64], f64), &[f64])| {
            if channel.is_empty() {
                // Any forces do where none count.
                return Ok((vec![0.0; modes.samples()], 0));
            }
            let mut channel = channel.to_vec();
            let pairs = channel.iter_mut().zip(uneven);
            pairs.for_each(|(force, uneven)| *force -= uneven);
            let glitches =
                gates::without_glitches(modes, &mut channel, least).ok_or(Cause::Glitches);
            Ok((channel, glitches?))
        };
        let Force { lateral, normal } = record.zip(least).zip(channels(&uneven)).map(clean);
        let (lateral, normal) = (lateral?, normal?);
        let glitches = lateral.1 + normal.1;
        let forces = Force::new(lateral.0, normal.0);
        let left = (forces.as_ref()).map(|of| modes.residual(of).iter().map(|r| r * r).sum());
        if self.has_lateral && is_quiet(left) {
            let level = wrong_level(self.level(question, &forces.normal));
            let unit = level.filter(|&of| of == Cause::ForceUnit);
            return Err(unit.unwrap_or(Cause::Channels));
        }
        let even = |power: f64| Spectrum::even(modes, power, power / question.correlation_length);
        let noise = match stated {
            Some(power) => power.map(even),
            None => (forces.as_ref().zip(steps))
                .map(|(channel, step)| modes.noise(channel, step, question.is_white)),
        };
        let forces = forces.zip(channels(&uneven)).zip(record).map(restored);
        Ok(Cleaned {
            level: self.level(question, &forces.normal),
            forces,
            noise,
            glitches,
            is_noisier: stated.is_some() && self.is_noisier(left, least, level),
        })
    }

    /// Whether the squares that the modes leave of a channel are more than noise of a variance and errors of the depths would leave.
    ///
    /// Implements: ROB-040.
    fn is_noisier(&self, left: Force<f64>, variance: Force<f64>, level: f64) -> bool {
        let degrees = (self.modes.samples() - self.modes.count()) as f64;
        let depth_noise = channels(&self.undisturbed.depth_noise);
        let of_depths = depth_noise.map(|sd| sd.iter().fold(0.0, |most, sd| sd.abs().max(most)));
        let more = |((left, variance), sd): ((f64, f64), f64)| {
            let most = MOST_OF_STATED * (variance + level * level * sd * sd);
            // NaN and infinity are more.
            chi_square(left / most, degrees, 0.0).map_or(true, |tail| tail.upper < MISFIT_RATE)
        };
        let more = left.zip(variance).zip(of_depths).map(more);
        more.normal || self.has_lateral && more.lateral
    }

    /// What uneven depths add to the forces of a record of some level, N: nothing if there are none.
    ///
    /// Implements: ROB-081.
    fn uneven(&self, level: f64) -> Vec<f64> {
        self.undisturbed
            .uneven
            .iter()
            .map(|of| level * of)
            .collect()
    }

    /// Which amplitudes of the modes count: all, or those of the normal force.
    pub fn counted(&self) -> impl Iterator<Item = bool> {
        let count = self.modes.count();
        (0..2 * count).map(move |mode| self.has_lateral || mode >= count)
    }

    /// The amplitudes of a record's modes over a level, beside those of the map, and the variances of their noise.
    pub fn reduced(&self, of: &Cleaned, level: f64) -> [DVector<f64>; 2] {
        let amplitudes = self.modes.of(of.forces.as_deref()) / level - &self.forces;
        let noise = of.noise.as_ref().map(|noise| &noise.of_modes);
        let noise = noise.into_array().into_iter().flatten().copied();
        [
            amplitudes,
            DVector::from_iterator(2 * self.modes.count(), noise) / (level * level),
        ]
    }

    /// The forces at the samples, N, for amplitudes beside those of the map and a level.
    pub fn expected(&self, amplitudes: &DVector<f64>, level: f64) -> Force<Vec<f64>> {
        let count = self.modes.count();
        let [lateral, normal] = [0, count].map(|start| {
            let amplitudes = amplitudes.rows(start, count).into_owned();
            self.modes.series(&amplitudes)
        });
        let of_map = channels(&self.undisturbed.forces);
        of_map
            .zip(Force::new(lateral, normal))
            .map(|(map, beside)| {
                let pairs = map.iter().zip(&beside);
                pairs.map(|(map, beside)| level * (map + beside)).collect()
            })
    }

    /// The mean of the normal forces that the map expects, N.
    pub fn weight(&self) -> f64 {
        let normal = channels(&self.undisturbed.forces).normal;
        normal.iter().sum::<f64>() / normal.len() as f64
    }
}
