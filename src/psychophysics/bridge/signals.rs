//! What each convention makes of the difference of two force maps along a sweep.

use super::{Channel, Convention, Offset, Statistic};
use crate::force_map::{ForceCurve, ForceMap, SAME_POSITION};
use crate::refusal::Refusal;

/// The difference F₁ − F₀ along a sweep.
#[derive(Debug, Clone, PartialEq)]
pub struct Signal {
    /// Lateral positions, m.
    pub laterals: Vec<f64>,
    /// Of the normal force, N.
    pub normal: Vec<f64>,
    /// Of the lateral force, N.
    pub lateral: Vec<f64>,
}

/// A difference and where it is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Peak {
    /// The force with its sign, N.
    pub force: f64,
    /// The position, m.
    pub at: f64,
}

/// A map over the whole sweep: one that begins at x = 0 is completed by symmetry, as the paper does, and refused if its phantom
/// has none.
///
/// # Errors
/// As [`ForceMap::mirrored`].
///
/// Implements: PSY-072.
pub fn whole_sweep(map: &ForceMap) -> Result<ForceMap, Refusal> {
    let from_centre = map.laterals().len() > 1 && map.laterals()[0].abs() <= SAME_POSITION;
    if from_centre {
        map.mirrored()
    } else {
        Ok(map.clone())
    }
}

impl Signal {
    /// The difference at one depth, m, of a map from its reference.
    pub fn new(reference: &ForceMap, map: &ForceMap, depth: f64) -> Result<Signal, Refusal> {
        let difference = map.signal(reference)?;
        let ForceCurve {
            laterals,
            normal_force,
            lateral_force,
        } = difference.row(depth)?;
        Ok(Signal {
            laterals: laterals.to_vec(),
            normal: normal_force.to_vec(),
            lateral: lateral_force.to_vec(),
        })
    }

    /// The largest magnitude in a channel of this signal; of equals the one nearest to x = 0, then that at x > 0.
    pub fn peak(&self, channel: &[f64]) -> Peak {
        let poses = self.laterals.iter().zip(channel);
        poses
            .map(|(&at, &force)| Peak { force, at })
            .max_by(|a, b| {
                let larger = a.force.abs().total_cmp(&b.force.abs());
                let nearer = b.at.abs().total_cmp(&a.at.abs());
                larger.then(nearer).then(a.at.total_cmp(&b.at))
            })
            .unwrap_or(Peak {
                force: 0.0,
                at: 0.0,
            })
    }

    /// The part within `half`, m, of x = 0.
    pub fn within(&self, half: f64) -> Signal {
        let inside = |channel: &[f64]| {
            let poses = self.laterals.iter().zip(channel);
            let kept = poses.filter(|(x, _)| x.abs() <= half + SAME_POSITION);
            kept.map(|(_, &force)| force).collect()
        };
        Signal {
            laterals: inside(&self.laterals),
            normal: inside(&self.normal),
            lateral: inside(&self.lateral),
        }
    }

    /// The signal in N that a convention makes of the difference.
    ///
    /// Implements: PSY-070, PSY-071.
    pub fn strength(&self, convention: Convention) -> f64 {
        let weight = match convention.offset {
            Offset::Kept => 1.0,
            Offset::Removed => 0.0,
        };
        self.weighted(convention.statistic, convention.channel, weight)
    }

    /// The same where the mean over the sweep counts `weight` times, channel by channel.
    ///
    /// Implements: PSY-084.
    pub fn weighted(&self, statistic: Statistic, channel: Channel, weight: f64) -> f64 {
        let felt = |forces: &[f64], counts: bool| -> Vec<f64> {
            let offset = (1.0 - weight) * mean(forces);
            let counts = f64::from(u8::from(counts));
            let force = |force: &f64| counts * (force - offset);
            forces.iter().map(force).collect()
        };
        let normal = felt(&self.normal, channel != Channel::Lateral);
        let lateral = felt(&self.lateral, channel != Channel::Normal);
        let energies = normal.iter().zip(&lateral).map(|(n, l)| n * n + l * l);
        let energy = match statistic {
            Statistic::Peak => energies.fold(0.0, f64::max),
            Statistic::MatchedFilter => energies.sum::<f64>() / self.laterals.len() as f64,
        };
        libm::sqrt(energy)
    }
}

/// The mean over the positions of a sweep.
pub fn mean(forces: &[f64]) -> f64 {
    forces.iter().sum::<f64>() / forces.len() as f64
}
