//! What each convention makes of the difference of two force maps along a sweep.

use super::answer::{BridgeInclusion, Channel, Convention, Mean, Statistic};
use palpate::force::Force;
use palpate::force_map::{ForceMap, SAME_POSITION, peak};
use palpate::refusal::Refusal;

/// The difference F₁ − F₀ along a sweep.
#[derive(Debug, Clone, PartialEq)]
pub struct Signal {
    /// Lateral positions, m.
    pub laterals: Vec<f64>,
    /// Of each component of the force, N.
    pub forces: Force<Vec<f64>>,
}

/// A map over the whole sweep, or its part within `half`, m, of x = 0: a map that begins at x = 0 is completed by symmetry, as the
/// paper does, and refused if its phantom has none.
///
/// # Errors
/// As [`ForceMap::mirrored`], and for fewer than two positions.
///
/// Implements: PSY-070, CLI-081.
pub fn sweep(map: &ForceMap, half: Option<f64>) -> Result<ForceMap, Refusal> {
    let whole = map.whole()?;
    let Some(half) = half else { return Ok(whole) };
    let inside = whole.table().laterals().iter().copied();
    let inside: Vec<f64> = inside.filter(|&x| is_within(x, half)).collect();
    if inside.len() < 2 {
        let found = format!("lateral positions within --sweep-mm: {}", inside.len());
        return Err(Refusal::state(found, "give at least two"));
    }
    whole.at_laterals(&inside)
}

/// Whether x is within `half` of 0, both in m.
pub fn is_within(x: f64, half: f64) -> bool {
    x.abs() <= half + SAME_POSITION
}

impl Signal {
    /// The difference at one depth, m, of a map from its reference.
    pub fn new(reference: &ForceMap, map: &ForceMap, depth: f64) -> Result<Signal, Refusal> {
        let difference = map.signal(reference)?;
        Ok(Signal {
            laterals: difference.laterals().to_vec(),
            forces: difference.row(depth)?.map(<[f64]>::to_vec),
        })
    }

    /// What it says of the inclusion with a name.
    pub fn of_inclusion(&self, name: String) -> BridgeInclusion {
        let (peak_normal_n, peak_normal_at_m) = peak(&self.laterals, &self.forces.normal);
        let (peak_lateral_n, peak_lateral_at_m) = peak(&self.laterals, &self.forces.lateral);
        BridgeInclusion {
            name,
            peak_normal_n,
            peak_normal_at_m,
            mean_normal_n: mean(&self.forces.normal),
            peak_lateral_n,
            peak_lateral_at_m,
        }
    }

    /// The part within `half`, m, of x = 0.
    pub fn within(&self, half: f64) -> Signal {
        let inside = |channel: &[f64]| {
            let poses = self.laterals.iter().zip(channel);
            let kept = poses.filter(|&(&x, _)| is_within(x, half));
            kept.map(|(_, &force)| force).collect()
        };
        Signal {
            laterals: inside(&self.laterals),
            forces: self.forces.as_deref().map(inside),
        }
    }

    /// The signal in N that a convention makes of the difference.
    ///
    /// Implements: PSY-070.
    pub fn strength(&self, convention: Convention) -> f64 {
        let weight = f64::from(u8::from(convention.mean == Mean::Kept));
        self.weighted(convention.statistic, convention.channel, weight)
    }

    /// The same where the mean over the sweep counts `weight` times, channel by channel.
    ///
    /// Implements: PSY-070.
    pub fn weighted(&self, statistic: Statistic, channel: Channel, weight: f64) -> f64 {
        let counted = Force::new(channel != Channel::Normal, channel != Channel::Lateral);
        let felt = self.forces.as_deref().zip(counted).map(|(forces, counts)| {
            let offset = (1.0 - weight) * mean(forces);
            let counts = f64::from(u8::from(counts));
            forces.iter().map(move |force| counts * (force - offset))
        });
        let energies = felt.normal.zip(felt.lateral).map(|(n, l)| n * n + l * l);
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
