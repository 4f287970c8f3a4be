//! How far the forces of a map are from those of an infinitely fine mesh: Roache's grid convergence index on
//! three meshes (ASME V&V 20).

use std::convert::Infallible;

use super::{FemError, Mesh, Model};
use crate::decimal::mm;
use crate::force_map::{Discretization, ForceMap, ForceTable, Matrix};
use crate::refusal::Refusal;
use crate::stats::tails::halved;

/// Ratios of the sizes of the three meshes, middle over fine and coarse over middle.
///
/// Implements: FEM-026.
pub const MESH_RATIOS: [f64; 2] = [4.0 / 3.0, 1.5];
/// The same ratios, at least, by the numbers of nodes: a size is √(area/nodes).
///
/// Implements: FEM-086.
const LEAST_RATIO: f64 = 1.2;
/// An observed order is trusted between these.
const TRUSTED_ORDERS: core::ops::RangeInclusive<f64> = 1.0..=4.0;
/// The order counted on, at most: that of a contact's edge between two nodes.
const HIGHEST_ORDER: f64 = 2.0;
/// Safety factors where the order is trusted, and where it is not.
const SAFETY: f64 = 1.25;
const SAFETY_UNTRUSTED: f64 = 3.0;

/// The force map of [`Model::map`] with the discretisation's band around each force. `solved` is told of each pose
/// of all three meshes, and says whether to go on.
///
/// Implements: FEM-026, FEM-028, FEM-086, PYT-010, PYT-056.
///
/// # Errors
/// As [`check_meshes`], [`Model::new`] and [`Model::map`].
pub fn certified_map(
    model: &Model,
    depths: &[f64],
    laterals: &[f64],
    solved: &dyn Fn(usize) -> bool,
) -> Result<ForceMap, FemError> {
    model.check_poses(depths, laterals)?;
    check_meshes(model)?;
    let coarser = |size: f64| {
        let forces = || -> Result<(usize, ForceTable), FemError> {
            let coarser = Model::new(model.phantom(), size, model.surface().contact)?;
            let table = coarser.table(depths, laterals, solved)?;
            Ok((coarser.mesh().nodes.len(), table))
        };
        forces().map_err(of_mesh(size))
    };
    let [middle, coarse] = coarser_sizes(model);
    // The coarsest first: what it refuses shall not cost the time of the others.
    let (coarse_nodes, coarse) = coarser(coarse)?;
    let (middle_nodes, middle) = coarser(middle)?;
    let finest = model.map(depths, laterals, solved)?;
    let (fine, middle) = (finest.table().both()?, middle.both()?);
    let bands = fine.zip(middle).zip(coarse.both()?);
    let bands = bands.map(|((fine, middle), coarse)| {
        Matrix::from_fn(depths.len(), laterals.len(), |row, column| {
            band([fine, middle, coarse].map(|force| force.row(row)[column]))
        })
    });
    let discretization = Discretization {
        nodes: [model.mesh().nodes.len(), middle_nodes, coarse_nodes],
        normal_force_band: bands.normal,
        lateral_force_band: bands.lateral,
    };
    Ok(finest.with_discretization(discretization)?)
}

/// Refuses error bands where two of the three meshes are too much alike, as coarse ones are.
///
/// # Errors
/// [`FemError::Refused`] there, and as [`Mesh::new`] of a coarser mesh.
///
/// Implements: FEM-086.
pub fn check_meshes(model: &Model) -> Result<(), FemError> {
    let mut nodes = vec![model.mesh().nodes.len()];
    for size in coarser_sizes(model) {
        let mesh = Mesh::new(model.phantom(), size).map_err(of_mesh(size))?;
        nodes.push(mesh.nodes.len());
    }
    let is_alike = |pair: &[usize]| (pair[0] as f64) < LEAST_RATIO * LEAST_RATIO * pair[1] as f64;
    let found = format!(
        "the three meshes for the error bands have {}, {} and {} nodes, too much alike to tell how far a force is off",
        nodes[0], nodes[1], nodes[2]
    );
    let alike = Refusal::state(found, "give a smaller mesh size");
    Ok(alike.when(nodes.windows(2).any(is_alike))?)
}

/// The sizes, m, of the middle and the coarse mesh.
fn coarser_sizes(model: &Model) -> [f64; 2] {
    let [middle, coarse] = MESH_RATIOS;
    [middle, middle * coarse].map(|ratio| ratio * model.mesh_size())
}

/// What makes an error name the coarser mesh, of a size in m, that it comes from.
fn of_mesh(size: f64) -> impl Fn(FemError) -> FemError {
    let part = format!("the mesh of {} mm for the error bands", mm(size));
    move |error| match error {
        FemError::Refused(of) => FemError::Refused(of.of_part(&part).into()),
        FemError::Pose(of) => FemError::Pose(of.of_part(&part).into()),
        other => other,
    }
}

/// The observed order p of f(h) = f₀ + c hᵖ through three values that change in one direction, finest first; `None`
/// for values that swing or do not change, or without such an order above 0.
///
/// ε₃₂/ε₂₁ = r₂₁ᵖ (r₃₂ᵖ − 1)/(r₂₁ᵖ − 1), which grows with p, by bisection.
///
/// Implements: FEM-026.
pub(super) fn observed_order([fine, middle, coarse]: [f64; 3]) -> Option<f64> {
    let ratio = (coarse - middle) / (middle - fine);
    let of_order = |p: f64| {
        let [r21, r32] = MESH_RATIOS.map(|ratio| libm::pow(ratio, p));
        r21 * (r32 - 1.0) / (r21 - 1.0)
    };
    let ends = [1e-3, 64.0];
    // Written so that a NaN is no order.
    if !(ratio >= of_order(ends[0]) && ratio.is_finite()) {
        return None;
    }
    let is_above = |p| Ok::<_, Infallible>(of_order(p) < ratio);
    let Ok([order, _]) = halved(60, ends, is_above);
    Some(order)
}

/// The band around the finest of three forces, finest first, N.
///
/// Implements: FEM-026.
pub fn band(forces: [f64; 3]) -> f64 {
    let [fine, middle, coarse] = forces;
    let error = |change: f64, order: f64| change / (libm::pow(MESH_RATIOS[0], order) - 1.0);
    let change = (middle - fine).abs();
    match observed_order(forces) {
        Some(order) if TRUSTED_ORDERS.contains(&order) => {
            SAFETY * error(change, order.min(HIGHEST_ORDER))
        }
        // Swings, or a change so small by chance that the order comes out too high: the largest change counts.
        _ => {
            let largest = change.max((coarse - fine).abs());
            SAFETY_UNTRUSTED * largest
        }
    }
}
