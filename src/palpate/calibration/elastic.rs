//! The force on the probe over its depth, of a gel that does not relax.

use crate::fem::{Contact, FemError, Model};
use crate::force_map::ForceMap;
use crate::phantom::Phantom;
use crate::refusal::Refusal;

/// Depths of the table of a gel, and the first over the last.
const DEPTHS: i32 = 32;
const FIRST_DEPTH: f64 = 0.005;
/// The share by which the modulus of a layer is changed, to see what it does to the forces.
const CHANGE: f64 = 0.05;

/// The forces of a gel over depth, which change with its moduli.
#[derive(Debug, Clone)]
pub struct Gel {
    /// The phantom whose forces they are.
    pub phantom: Phantom,
    /// The forces, for one lateral position.
    pub map: ForceMap,
    /// ln of each depth (mm) and of the force there (N).
    logarithms: Vec<[f64; 2]>,
    /// d ln F/d ln E at each depth, for each modulus.
    exponents: Vec<Vec<f64>>,
}

/// What a gel is asked.
#[derive(Debug, Clone, Copy)]
pub struct Indentation<'a> {
    /// The layers whose moduli are not known, each on its own; empty for one factor of all moduli.
    pub layers: &'a [usize],
    /// Where the probe goes down, m.
    pub lateral: f64,
    /// The mesh size, m.
    pub mesh_size: f64,
}

impl Gel {
    /// The forces of `phantom` down to a depth, m.
    ///
    /// # Errors
    /// As [`Model::map`]; a force that is not above 0.
    ///
    /// Implements: CAL-011.
    pub(super) fn new(
        phantom: &Phantom,
        asked: Indentation<'_>,
        deepest: f64,
    ) -> Result<Gel, FemError> {
        let found =
            "the phantom's probe rubs, and the forces of a map with friction are those of a sweep";
        let rubs = Refusal::state(found, "leave out probe.friction");
        rubs.when(phantom.probe().friction != 0.0)?;
        let ratio = libm::log(FIRST_DEPTH) / f64::from(DEPTHS - 1);
        let depth = |k: i32| deepest * libm::exp(ratio * f64::from(k));
        let depths: Vec<f64> = (0..DEPTHS).rev().map(depth).collect();
        let model = Model::new(phantom, asked.mesh_size, Contact::default())?;
        let map = |model: &Model| model.map(&depths, &[asked.lateral], &|_| true);
        let logarithms = |map: &ForceMap| -> Vec<f64> {
            let forces = map.table().normal().values().iter();
            forces.map(|force| libm::log(*force)).collect()
        };
        let own = map(&model)?;
        let found = "the mesh is so coarse that a light touch has no force";
        let mut forces = own.table().normal().values().iter();
        let coarse = Refusal::state(found, "give a smaller mesh size");
        coarse.when(forces.any(|force| *force <= 0.0))?;
        let mut exponents = Vec::new();
        for &layer in asked.layers {
            let changed = |factor: f64| -> Result<Vec<f64>, FemError> {
                let stiffened = stiffened(phantom, &[layer], &[factor])?;
                Ok(logarithms(&map(&model.with_phantom(&stiffened)?)?))
            };
            let (less, more) = (changed(1.0 - CHANGE)?, changed(1.0 + CHANGE)?);
            let range = libm::log((1.0 + CHANGE) / (1.0 - CHANGE));
            let pairs = less.iter().zip(more);
            exponents.push(pairs.map(|(less, more)| (more - less) / range).collect());
        }
        if asked.layers.is_empty() {
            // All moduli and the forces have one factor.
            exponents.push(vec![1.0; depths.len()]);
        }
        let pairs = depths.iter().zip(logarithms(&own));
        let pairs = pairs.map(|(depth, force)| [libm::log(1e3 * depth), force]);
        Ok(Gel {
            phantom: phantom.clone(),
            logarithms: pairs.collect(),
            map: own,
            exponents,
        })
    }

    /// The force (N) at a depth (mm) where each modulus is e^`changes` times that of the phantom: ln F is a cubic of ln d between the
    /// depths of the table, and a line beyond them.
    ///
    /// Implements: CAL-011.
    fn force(&self, depth: f64, changes: &[f64]) -> f64 {
        let x = libm::log(depth);
        let above = self.logarithms.partition_point(|[depth, _]| *depth < x);
        let at = above.clamp(1, self.logarithms.len() - 1);
        let [[from, low], [to, high]] = [self.logarithms[at - 1], self.logarithms[at]];
        let share = (x - from) / (to - from);
        // A gel at its surface is that at the least depth of the table.
        let own = share.clamp(0.0, 1.0);
        let force = |at: usize| self.logarithms.get(at).map(|[_, force]| *force);
        let before = at
            .checked_sub(2)
            .and_then(force)
            .unwrap_or(2.0 * low - high);
        let after = force(at + 1).unwrap_or(2.0 * high - low);
        // Beside the line: of Catmull and Rom.
        let [left, right] = [before - 2.0 * low + high, low - 2.0 * high + after];
        let bent = -0.5 * own * (1.0 - own) * ((1.0 - own) * left + own * right);
        let pairs = self.exponents.iter().zip(changes);
        let changed = pairs.map(|(exponents, change)| {
            change * (exponents[at - 1] + own * (exponents[at] - exponents[at - 1]))
        });
        libm::exp(low + share * (high - low) + bent + changed.sum::<f64>())
    }
}

/// `phantom` with the moduli of some layers multiplied by factors; without a layer, all moduli by the first factor.
///
/// # Errors
/// A modulus that no phantom has.
pub(super) fn stiffened(
    phantom: &Phantom,
    layers: &[usize],
    factors: &[f64],
) -> Result<Phantom, Refusal> {
    phantom.changed(|parts| {
        for (layer, factor) in layers.iter().zip(factors) {
            parts.layers[*layer].material.youngs_modulus *= factor;
        }
        if layers.is_empty() {
            let all = parts.materials_mut();
            all.for_each(|material| {
                material.youngs_modulus *= factors[0];
                material.yeoh_c20 *= factors[0];
                material.fibre_modulus *= factors[0];
            });
        }
    })
}

/// The law of the force over depth.
#[derive(Debug, Clone)]
pub enum Elastic {
    /// F = k dᵖ e^(q d), of any gel and probe.
    Empirical,
    /// That of a phantom.
    Gel(Box<Gel>),
}

impl Elastic {
    /// How many parameters the law has: ln k, ln p and q, or the ln of a factor for each modulus.
    pub(super) fn parameters(&self) -> usize {
        match self {
            Elastic::Empirical => 3,
            Elastic::Gel(gel) => gel.exponents.len(),
        }
    }

    /// The force, N, at a depth, mm.
    ///
    /// Implements: CAL-010.
    pub(super) fn force(&self, depth: f64, parameters: &[f64]) -> f64 {
        match self {
            _ if depth <= 0.0 => 0.0,
            Elastic::Empirical => {
                let [stiffness, exponent, growth] = [0, 1, 2].map(|at| parameters[at]);
                libm::exp(stiffness + libm::exp(exponent) * libm::log(depth) + growth * depth)
            }
            Elastic::Gel(gel) => gel.force(depth, parameters),
        }
    }
}
