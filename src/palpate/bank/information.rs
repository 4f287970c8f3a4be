//! How well a place can be known.

use super::detector::BankDetector;
use crate::detect::nuisance::Nuisances;

/// How far apart two signals are whose difference is the derivative, over the distance between the points there.
const STEP: f64 = 0.05;

/// The Cramér–Rao bound: no unbiased estimate of a parameter has a smaller standard deviation than this, m or Pa. `None` for a
/// parameter that the bank does not vary, or that the signal does not tell.
///
/// Implements: BNK-050.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlaceBound {
    /// With all other parameters of the bank unknown.
    pub sd: [Option<f64>; 4],
    /// With all others known.
    pub alone: [Option<f64>; 4],
    /// Whether a record tells places apart that are nearer than the nodes of the posterior (BNK-040), so that its intervals hold the true
    /// value less often than they state.
    pub is_finer_than_nodes: bool,
}

impl BankDetector {
    /// The bound at the parameters `at`, beside the nuisances of this detector, in noise of a known level.
    ///
    /// Implements: BNK-050, CLI-146.
    pub fn bound(&self, at: [f64; 4]) -> PlaceBound {
        let axes = &self.cells().axes;
        let slopes = [0, 1, 2, 3].map(|axis: usize| {
            let along = &axes[axis];
            let half = STEP * along.size(along.cell(at[axis]));
            let beside = |by: f64| {
                let mut beside = at;
                beside[axis] += by;
                self.template_at(beside)
            };
            along.is_free().then(|| {
                let pairs = beside(half).into_iter().zip(beside(-half));
                let slope = pairs.map(|(after, before)| (after - before) / (2.0 * half));
                slope.collect::<Vec<_>>()
            })
        });
        let bound = |axis: usize, with_others: bool| {
            let mut slope = slopes[axis].clone()?;
            let others = slopes.iter().enumerate();
            let others = others.filter(|&(other, _)| with_others && other != axis);
            let others = others.filter_map(|(_, slope)| slope.as_deref());
            let mut others: Vec<f64> = others.flatten().copied().collect();
            let space = Nuisances::new(&mut others, slope.len()).ok()?;
            let left = space.project(&mut slope).ok()?;
            (left > 0.0).then(|| 1.0 / left)
        };
        let alone = [0, 1, 2, 3].map(|axis| bound(axis, false));
        let is_finer = |axis: usize| {
            let along = &axes[axis];
            let apart = along.size(along.cell(at[axis])) / along.nodes as f64;
            alone[axis].is_some_and(|sd| sd < apart)
        };
        PlaceBound {
            sd: [0, 1, 2, 3].map(|axis| bound(axis, true)),
            alone,
            is_finer_than_nodes: (0..4).any(is_finer),
        }
    }
}
