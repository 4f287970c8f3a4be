//! The pressure under the probe as a tactile array reads it: the normal force on each of its elements.

use super::{FemError, Model, Pose, PoseSolution};

impl Model {
    /// The normal force, N, on each of `elements` strips of equal width that lie side by side in x over the probe, from −R on
    /// its left to R, and move with it.
    ///
    /// The force on an edge at the surface is spread evenly over the edge's deformed length: the forces of its two contact
    /// points swing against each other, their sum does not. What lies beyond an end of the array counts to its last element.
    ///
    /// Implements: FEM-083.
    pub fn array(&self, solution: &PoseSolution, elements: usize) -> Vec<f64> {
        let (pose, state) = (solution.pose, &solution.state);
        let (mesh, radius) = (self.mesh(), self.phantom().probe.radius);
        let (displacements, _) = self.surface().at_nodes(state, pose);
        let nodes = mesh.surface.iter().zip(displacements);
        let places = nodes.map(|(&node, [u, _])| mesh.nodes[node][0] + u - pose.lateral);
        let corners: Vec<f64> = places.step_by(2).collect();
        let border = |k: usize| radius * (2.0 * k as f64 / elements as f64 - 1.0);
        let mut forces = vec![0.0; elements];
        for &point in &state.active {
            let edge = [corners[point / 2], corners[point / 2 + 1]];
            let before = |k: usize| match k {
                0 => 0.0,
                k if k == elements => 1.0,
                k => part_before(border(k), edge),
            };
            for (k, force) in forces.iter_mut().enumerate() {
                *force += state.pressures[point] * (before(k + 1) - before(k));
            }
        }
        forces
    }

    /// [`Model::array`] with the probe at `depth` and each of `laterals`, m.
    ///
    /// # Errors
    /// As [`Model::solve`].
    ///
    /// Implements: FEM-014.
    pub fn array_sweep(
        &self,
        depth: f64,
        laterals: &[f64],
        elements: usize,
    ) -> Result<Vec<Vec<f64>>, FemError> {
        let solved = self.solved_laterals(laterals).into_iter().map(|lateral| {
            let solution = self.solve(Pose { depth, lateral })?;
            Ok((lateral, self.array(&solution, elements)))
        });
        let solved = solved.collect::<Result<Vec<_>, FemError>>()?;
        let at = |x: f64| solved.iter().find(|of| of.0 == x).map(|of| of.1.clone());
        let mirrored = |x: f64| at(-x).map(|forces| forces.into_iter().rev().collect());
        let forces = |&x: &f64| at(x).or_else(|| mirrored(x));
        Ok(laterals.iter().filter_map(forces).collect())
    }
}

/// The part of an interval that lies before a border.
fn part_before(border: f64, [left, right]: [f64; 2]) -> f64 {
    let length = (right - left).max(f64::MIN_POSITIVE);
    ((border - left) / length).clamp(0.0, 1.0)
}
