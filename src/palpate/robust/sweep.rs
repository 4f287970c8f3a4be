//! A sweep in its modes, and a record of it over its level.

use nalgebra::DVector;

use super::classes::Undisturbed;
use super::gates;
use super::gel::{GelChange, GelUncertainty};
use super::modes::{Modes, Spectrum};
use super::{RobustQuestion, RobustSweep, channels, expected};
use crate::force::Force;
use crate::force_map::ForceTable;
use crate::refusal::Refusal;
use crate::trace::Cause;
use crate::trace::contact::{RADIUS, in_air, is_narrow, level};
use crate::trace::design::depth_slope;

/// A sweep in its modes.
pub struct PreparedSweep {
    pub modes: Modes,
    /// Whether its records have lateral forces.
    pub has_lateral: bool,
    pub undisturbed: Undisturbed,
    forces: DVector<f64>,
}

/// A record without its glitches.
pub struct Cleaned {
    pub forces: Force<Vec<f64>>,
    /// Σ F f/Σ f² of its normal force.
    pub level: f64,
    /// The noise of each channel.
    pub noise: Force<Spectrum>,
    /// Samples that were replaced.
    pub glitches: usize,
}

/// The sweep, ready for its records.
///
/// # Errors
/// Samples outside the map; too few samples.
pub fn prepared(
    question: &RobustQuestion<'_>,
    without: &ForceTable,
    sweep: &RobustSweep<'_>,
) -> Result<PreparedSweep, Refusal> {
    let (record, depth) = (sweep.record, sweep.depth);
    let radius = sweep.changes.map_or(RADIUS, |changes| changes.radius);
    let of_default = GelUncertainty::default().depth_percent;
    let depth_percent = sweep.changes.map_or(of_default, |of| of.depth_percent);
    let samples = record.positions().len();
    let least = match question.noise_sd {
        Some(_) => gates::LEAST_SAMPLES_IN_NOISE,
        None => gates::LEAST_SAMPLES,
    };
    let few = Refusal::state(
        format!("{samples} samples"),
        format!("give at least {least}"),
    );
    few.in_file(record.file()).when(samples < least)?;
    let forces = expected(record, without, depth)?;
    let depths = without.depths();
    let slope = depth_slope(depths, depth, |depth| expected(record, without, depth))?;
    // A thick gel gives way as its depth, at least.
    let slope = slope.unwrap_or_else(|| forces.iter().map(|force| force / depth).collect());
    let at = |changes: &[GelChange]| {
        changes
            .iter()
            .map(|change| change.at(record, depth))
            .collect::<Result<Vec<_>, Refusal>>()
    };
    let (gel, support) = match sweep.changes {
        Some(changes) => (at(&changes.gel)?, at(&changes.support)?),
        None => (Vec::new(), Vec::new()),
    };
    let modes = Modes::new(record.positions(), radius, question.noise_sd.is_some());
    let undisturbed = Undisturbed {
        slope,
        gel,
        support,
        travelled: record.travelled(),
        depth_sd: 0.01 * depth_percent * depth,
        radius,
        is_zeroed: question.is_zeroed,
        forces,
    };
    let forces = modes.of(channels(&undisturbed.forces));
    Ok(PreparedSweep {
        modes,
        has_lateral: !record.forces().lateral.is_empty(),
        undisturbed,
        forces,
    })
}

impl PreparedSweep {
    /// Samples of a record in air at the start and at the end, but for so few as may be glitches.
    ///
    /// Implements: ROB-007.
    pub fn in_air(&self, question: &RobustQuestion<'_>, normal: &[f64]) -> [usize; 2] {
        if question.is_zeroed {
            return [0; 2];
        }
        let steps = normal.windows(2).map(|pair| pair[1] - pair[0]);
        let of_steps = || steps.map(|step| 0.5 * step * step).sum::<f64>() / normal.len() as f64;
        let stated = question.noise_sd.map(|sd| sd.normal * sd.normal);
        let expected = channels(&self.undisturbed.forces).normal;
        let ends = in_air(normal, expected, stated.unwrap_or_else(of_steps));
        ends.map(|count| {
            if count > gates::MOST_GLITCHES {
                count
            } else {
                0
            }
        })
    }

    /// A record of the sweep without its glitches, its level and its noise; or why it cannot be judged.
    ///
    /// Implements: ROB-001, ROB-002, ROB-004, ROB-011.
    pub fn cleaned(
        &self,
        question: &RobustQuestion<'_>,
        forces: Force<&[f64]>,
    ) -> Result<Cleaned, Cause> {
        let modes = &self.modes;
        if is_narrow(modes.width, self.undisturbed.radius) {
            return Err(Cause::Narrow);
        }
        if forces.into_array().into_iter().any(gates::is_saturated) {
            return Err(Cause::Saturated);
        }
        let steps = forces.map(gates::step);
        let clean = |(channel, step): (&[f64], f64)| {
            if channel.is_empty() {
                // Any forces do where none count.
                return Ok((vec![0.0; modes.samples()], 0));
            }
            let mut channel = channel.to_vec();
            let glitches =
                gates::without_glitches(modes, &mut channel, step).ok_or(Cause::Glitches);
            Ok((channel, glitches?))
        };
        let Force { lateral, normal } = forces.zip(steps).map(clean);
        let (lateral, normal) = (lateral?, normal?);
        let glitches = lateral.1 + normal.1;
        let forces = Force::new(lateral.0, normal.0);
        let expected = channels(&self.undisturbed.forces).normal;
        let level = match question.is_zeroed {
            true => 1.0,
            false => level(&forces.normal, expected),
        };
        let white = |sd: f64| Spectrum::white(modes, sd * sd);
        let noise = match question.noise_sd {
            Some(sd) => sd.map(white),
            None => (forces.as_ref().zip(steps))
                .map(|(channel, step)| modes.noise(channel, step, question.is_white)),
        };
        Ok(Cleaned {
            forces,
            level,
            noise,
            glitches,
        })
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

    /// Σ of the normal forces that the map expects, N.
    pub fn weight(&self) -> f64 {
        channels(&self.undisturbed.forces).normal.iter().sum()
    }
}
