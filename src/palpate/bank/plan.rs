//! Which maps a bank needs, and their computation.

use serde::Serialize;

use super::{Bank, Parameter, axis};
use crate::fem::{Contact, FemError, Model};
use crate::force_map::{ForceMap, SAME_POSITION, increasing};
use crate::phantom::{Phantom, Shape};
use crate::refusal::Refusal;

/// The mesh size of a bank unless another is asked for, m: a third longer than that of a single map, which takes half
/// the time. `spec/bank.md` has what it does to estimates.
///
/// Implements: BNK-020.
pub const MESH_SIZE: f64 = 0.65e-3;

/// How far from the depth of the probe the reference has further depths, m: for a depth that is known within a tolerance or
/// unknown.
///
/// Implements: BNK-020.
const BESIDE: f64 = 0.3e-3;

/// The maps that make a bank.
///
/// ```
/// use palpate::bank::{Bank, BankPlan};
/// use palpate::phantom::Phantom;
///
/// let mut plan = BankPlan::new(Phantom::builtin("6.6")?, 4e-3, &[-6e-3, -3e-3, 0.0, 3e-3, 6e-3])?;
/// plan.positions = vec![-2e-3, 0.0, 2e-3];
/// plan.mesh_size = 2e-3;
/// let solves = plan.solves()?;
/// // The inclusion at −2 mm is the mirror image of that at 2 mm.
/// assert_eq!(solves.len(), 2);
/// let (mut maps, mut last) = (Vec::new(), None);
/// for solve in &solves {
///     maps.extend(plan.solve(solve, &mut last)?);
/// }
/// let bank = Bank::new(plan.reference()?, maps)?;
/// assert_eq!(bank.axes()[0], [-2e-3, 0.0, 2e-3]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// Implements: BNK-020.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct BankPlan {
    /// The gel with the one inclusion that all hypotheses are made of.
    phantom: Phantom,
    /// Depths of the probe, m, increasing.
    #[serde(rename = "probe_depths_m")]
    pub probe_depths: Vec<f64>,
    /// Lateral positions of the probe, m.
    #[serde(rename = "laterals_m")]
    laterals: Vec<f64>,
    /// x of the inclusion's centre, m.
    #[serde(rename = "offsets_m")]
    pub positions: Vec<f64>,
    /// Depth of its highest point, m.
    #[serde(rename = "depths_m")]
    pub depths: Vec<f64>,
    /// Its diameter, m, of a disc.
    #[serde(rename = "diameters_m")]
    pub diameters: Vec<f64>,
    /// Its Young's modulus, Pa.
    #[serde(rename = "youngs_moduli_pa")]
    pub moduli: Vec<f64>,
    /// The mesh size, m.
    #[serde(rename = "mesh_size_m")]
    pub mesh_size: f64,
    /// How the gap to the probe is measured.
    pub contact: Contact,
}

/// One computation for a bank.
#[derive(Debug, Clone, PartialEq)]
pub struct BankSolve {
    /// The gel with the inclusion.
    pub phantom: Phantom,
    /// Whether the mirror image is of the bank too.
    pub image: bool,
}

impl BankPlan {
    /// The plan for the inclusion of `phantom` alone, under a probe at `depth` and `laterals` (m); the lists of the hypotheses
    /// can be changed.
    ///
    /// # Errors
    /// A phantom with no inclusion or several.
    ///
    /// Implements: BNK-020.
    pub fn new(phantom: Phantom, depth: f64, laterals: &[f64]) -> Result<BankPlan, Refusal> {
        let [inclusion] = phantom.inclusions() else {
            let found = format!("the phantom has {} inclusions", phantom.inclusions().len());
            let remedy = "give one, of which the hypotheses are made";
            return Err(Refusal::state(found, remedy));
        };
        let [positions, depths, diameters, moduli] =
            Parameter::ALL.map(|parameter| vec![parameter.of(inclusion)]);
        Ok(BankPlan {
            probe_depths: vec![depth],
            laterals: laterals.to_vec(),
            positions,
            depths,
            diameters,
            moduli,
            mesh_size: MESH_SIZE,
            contact: Contact::default(),
            phantom,
        })
    }

    /// The computations, in the order of the bank but without those that are mirror images of others.
    ///
    /// # Errors
    /// A diameter for a shape that has none; a hypothesis that does not fit into the gel, with its parameters; a pose that the
    /// probe cannot take.
    ///
    /// Implements: BNK-021, BNK-020.
    pub fn solves(&self) -> Result<Vec<BankSolve>, Refusal> {
        for &depth in &self.probe_depths {
            let mut poses = self.laterals.iter();
            poses.try_for_each(|&lateral| self.phantom.check_pose(depth, lateral))?;
        }
        let mirrored = self.laterals.iter().rev().map(|x| 0.0 - x);
        let is_even = mirrored.eq(self.laterals.iter().copied());
        let mut solves = Vec::new();
        let axes = [&self.positions, &self.depths, &self.diameters, &self.moduli];
        let axes = axes.map(Vec::as_slice);
        for number in 0..axes.iter().map(|values| values.len()).product() {
            let point = axis::point(axes, number);
            let phantom = self.hypothesis(point)?;
            let [position, ..] = point;
            let has_mirrored = position != 0.0 && self.positions.contains(&(0.0 - position));
            let image = is_even && has_mirrored && phantom.mirror_image().is_some();
            if position > 0.0 || !image {
                solves.push(BankSolve { phantom, image });
            }
        }
        Ok(solves)
    }

    /// The phantom of one hypothesis.
    fn hypothesis(&self, point: [f64; 4]) -> Result<Phantom, Refusal> {
        let [position, depth, diameter, modulus] = point;
        let of_file = &self.phantom.inclusions()[0];
        let is_disc = matches!(of_file.shape, Shape::Disc { .. });
        if !is_disc && Parameter::Diameter.of(of_file) != diameter {
            let found = "the inclusion is no disc";
            return Err(Refusal::state(found, "give a disc, or one diameter"));
        }
        let [x, y, d] = [position, depth, diameter].map(|length| 1e3 * length);
        let of = format!(
            "the inclusion at {x:.3} mm, {y:.3} mm deep, {d:.3} mm wide, of {:.1} kPa",
            1e-3 * modulus
        );
        let phantom = self.phantom.changed(|parts| {
            let inclusion = &mut parts.inclusions[0];
            inclusion.centre_x = position;
            inclusion.depth = depth;
            inclusion.material.youngs_modulus = modulus;
            if is_disc {
                inclusion.shape = Shape::Disc { diameter };
            }
        });
        phantom.map_err(|refusal| refusal.of_part(&of))
    }

    /// The forces without inclusion, at each depth of the probe and at one on either side, where the probe can stand and no other
    /// depth of the probe is nearer.
    ///
    /// # Errors
    /// As [`Model::map`].
    ///
    /// Implements: BNK-020, BNK-081.
    pub fn reference(&self) -> Result<ForceMap, FemError> {
        let phantom = self.phantom.without_inclusions();
        let stands = |depth: f64| {
            let mut poses = self.laterals.iter();
            poses.all(|&lateral| phantom.check_pose(depth, lateral).is_ok())
        };
        let is_nearest = |depth: f64, beside: f64| {
            let mut others = self.probe_depths.iter().filter(|other| **other != depth);
            others.all(|other| (beside - other).abs() >= (beside - depth).abs() - SAME_POSITION)
        };
        let around = |&depth: &f64| {
            let beside = [(depth - BESIDE).max(0.5 * depth), depth + BESIDE];
            let beside = beside.map(|at| (stands(at) && is_nearest(depth, at)).then_some(at));
            beside.into_iter().flatten().chain([depth])
        };
        let mut depths = increasing(self.probe_depths.iter().flat_map(around));
        depths.dedup_by(|next, depth| *next - *depth <= SAME_POSITION);
        let model = Model::new(&phantom, self.mesh_size, self.contact)?;
        model.map(&depths, &self.laterals, &|_| true)
    }

    /// The map of one hypothesis, and that of its mirror image. `last` is the model of the one before, whose mesh serves again
    /// where they differ in the modulus alone.
    ///
    /// # Errors
    /// As [`Model::sweep`].
    ///
    /// Implements: BNK-020.
    pub fn solve(
        &self,
        solve: &BankSolve,
        last: &mut Option<Model>,
    ) -> Result<Vec<ForceMap>, FemError> {
        // A model that does not serve again goes before the next comes.
        last.take_if(|last| !solve.phantom.is_meshed_as(last.phantom()));
        let model = match last {
            Some(last) => last.with_phantom(&solve.phantom)?,
            None => Model::new(&solve.phantom, self.mesh_size, self.contact)?,
        };
        let model = last.insert(model);
        let map = model.sweep(&self.probe_depths, &self.laterals)?;
        let image = solve.image.then(|| map.mirror_image()).transpose()?;
        Ok(std::iter::once(map).chain(image).collect())
    }

    /// The bank, computed on this thread.
    ///
    /// # Errors
    /// As [`BankPlan::solves`], [`BankPlan::reference`] and [`BankPlan::solve`].
    pub fn bank(&self) -> Result<Bank, FemError> {
        let (mut maps, mut last) = (Vec::new(), None);
        for solve in self.solves()? {
            maps.extend(self.solve(&solve, &mut last)?);
        }
        Ok(Bank::new(self.reference()?, maps)?)
    }
}
