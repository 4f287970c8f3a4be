//! A phantom, meshed and factorised, and the probe's forces on it.

use super::assembly::StiffnessMatrix;
use super::cholesky::{Factor, check_residual};
use super::contact::{Contact, ContactState, Surface};
use super::field::{BATCH, Batch, Field, FieldCheck, Samples};
use super::mesh::Mesh;
use super::outline::QUARTERS;
use super::{FemError, MeshOptions, Pose};
use crate::force_map::{Certificate, ForceMap, ForceTable, Matrix, SmallestDet, Source};
use crate::phantom::Phantom;

/// A phantom, meshed and factorised.
///
/// ```
/// use palpate::fem::{Contact, MeshOptions, Model, Pose};
/// use palpate::phantom::Phantom;
///
/// let phantom = Phantom::builtin("6.6")?;
/// let options = MeshOptions { size: 2e-3, ..MeshOptions::default() };
/// let model = Model::new(&phantom, &options, Contact::default())?;
/// assert_eq!((model.phantom(), model.options()), (&phantom, &options));
/// assert_eq!(model.surface().positions.len(), model.mesh().surface().len());
/// assert_eq!(model.matrix().column_starts.len(), model.matrix().numbering.unknowns() + 1);
/// assert_eq!(model.factor().surface_compliance(), model.surface().compliance);
///
/// let [left, right] = [-1e-3, 1e-3].map(|lateral| model.solve(Pose { depth: 2e-3, lateral }));
/// assert_eq!(left?.lateral_force, -right?.lateral_force);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct Model {
    phantom: Phantom,
    options: MeshOptions,
    mesh: Mesh,
    matrix: StiffnessMatrix,
    factor: Factor,
    surface: Surface,
    samples: Samples,
}

/// The probe at rest at one pose.
///
/// ```
#[doc = include_str!("coarse.example")]
/// let solution = model.solve(pose)?;
/// // Right of the inclusion, which pushes the probe up and away.
/// assert!(solution.normal_force > 0.0 && solution.lateral_force > 0.0);
/// assert!(solution.energy > 0.0 && solution.penetration < 1e-11);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct PoseSolution {
    /// The pose.
    pub pose: Pose,
    /// Force on the probe out of the gel, N.
    pub normal_force: f64,
    /// Force on the probe along +x, N.
    pub lateral_force: f64,
    /// Strain energy of phantom and skin, J.
    pub energy: f64,
    /// Largest penetration of a surface node, m.
    pub penetration: f64,
    /// Displacements and contact forces of the surface.
    pub state: ContactState,
}

/// Deepest step between two poses of which one starts the other, over the probe's radius.
const DEPTH_STEP: f64 = 0.1;
/// How often a step that does not converge is halved.
const HALVINGS: u32 = 6;

impl Model {
    /// Meshes and factorises a phantom.
    ///
    /// ```
    /// use palpate::fem::{Contact, FemError, MeshOptions, Model};
    /// use palpate::phantom::Phantom;
    ///
    /// let mut phantom = Phantom::builtin("6.6")?;
    /// phantom.gel.material.poisson_ratio = 0.5; // would be incompressible
    /// let refused = Model::new(&phantom, &MeshOptions::default(), Contact::default());
    /// assert!(matches!(refused, Err(FemError::Phantom(_))));
    /// # Ok::<(), palpate::phantom::UnknownPhantom>(())
    /// ```
    ///
    /// # Errors
    /// [`FemError::Phantom`] for a phantom that is not valid, [`FemError::MeshSize`],
    /// [`FemError::Degenerate`], [`FemError::NotPositiveDefinite`].
    pub fn new(
        phantom: &Phantom,
        options: &MeshOptions,
        contact: Contact,
    ) -> Result<Model, FemError> {
        Model::with_quarters(phantom, options, contact, QUARTERS)
    }

    /// As [`Model::new`], with `quarters`/4 of the cells along each line of the mesh.
    pub(super) fn with_quarters(
        phantom: &Phantom,
        options: &MeshOptions,
        contact: Contact,
        quarters: usize,
    ) -> Result<Model, FemError> {
        phantom.validate()?;
        let mesh = Mesh::with_quarters(phantom, options, quarters)?;
        let matrix = StiffnessMatrix::assemble(&mesh, phantom)?;
        let factor = Factor::new(&matrix)?;
        let positions = mesh.nodes[mesh.surface()].to_vec();
        let surface = Surface::new(
            factor.surface_compliance(),
            positions,
            phantom.probe,
            contact,
        );
        let samples = Samples::new(&mesh, &matrix);
        Ok(Model {
            phantom: phantom.clone(),
            options: *options,
            mesh,
            matrix,
            factor,
            surface,
            samples,
        })
    }

    /// The phantom.
    pub fn phantom(&self) -> &Phantom {
        &self.phantom
    }

    /// How fine the mesh was asked for.
    pub fn options(&self) -> &MeshOptions {
        &self.options
    }

    /// The mesh.
    pub fn mesh(&self) -> &Mesh {
        &self.mesh
    }

    /// The stiffness matrix.
    pub fn matrix(&self) -> &StiffnessMatrix {
        &self.matrix
    }

    /// The factor of the stiffness matrix.
    pub fn factor(&self) -> &Factor {
        &self.factor
    }

    /// The surface with its compliance.
    pub fn surface(&self) -> &Surface {
        &self.surface
    }

    /// The force at one pose.
    ///
    /// ```
    #[doc = include_str!("coarse.example")]
    /// let [shallow, deep] = [1e-3, 2e-3].map(|depth| model.solve(Pose { depth, lateral: 0.0 }));
    /// let (shallow, deep) = (shallow?, deep?);
    /// // Twice the depth is more than twice the force: the contact grows.
    /// assert!(deep.normal_force > 2.0 * shallow.normal_force);
    /// assert!(deep.lateral_force.abs() < 1e-12);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`FemError::Pose`] where the probe cannot stand, [`FemError::NoConvergence`].
    ///
    /// Implements: FEM-019, FEM-020, FEM-021, FEM-025, FEM-080.
    pub fn solve(&self, pose: Pose) -> Result<PoseSolution, FemError> {
        self.phantom.check_pose(pose.depth, pose.lateral)?;
        // The right half stands for both, so that mirrored poses have mirrored forces to the bit.
        let right = Pose {
            lateral: pose.lateral.abs(),
            ..pose
        };
        let surface = Pose {
            depth: 0.0,
            ..right
        };
        let untouched = ContactState::untouched(self.surface.positions.len());
        let solution = self.solution(right, self.approach(right, surface, &untouched)?);
        Ok(if pose.lateral < 0.0 {
            solution.mirrored()
        } else {
            solution
        })
    }

    /// Leads the contact from a solved pose down to `pose`, in steps that halve where they fail.
    fn approach(
        &self,
        pose: Pose,
        from: Pose,
        start: &ContactState,
    ) -> Result<ContactState, FemError> {
        let whole = pose.depth - from.depth;
        let longest = DEPTH_STEP * self.phantom.probe.radius;
        let shortest = longest.min(whole) / f64::from(1u32 << HALVINGS);
        let (mut state, mut depth, mut step) = (start.clone(), from.depth, longest);
        let mut iterations = 0;
        loop {
            let next = if pose.depth - depth <= step {
                pose.depth
            } else {
                depth + step
            };
            match self.surface.solve(
                Pose {
                    depth: next,
                    ..pose
                },
                &state,
            ) {
                Ok(solved) => {
                    iterations += solved.iterations;
                    (state, depth) = (solved, next);
                    if depth == pose.depth {
                        state.iterations = iterations;
                        return Ok(state);
                    }
                }
                Err(FemError::NoConvergence { .. }) if step > shortest => {
                    step = 0.5 * step.min(pose.depth - depth);
                }
                Err(FemError::NoConvergence { iterations, .. }) => {
                    return Err(FemError::NoConvergence { pose, iterations });
                }
                Err(error) => return Err(error),
            }
        }
    }

    fn solution(&self, pose: Pose, state: ContactState) -> PoseSolution {
        let [lateral_force, normal_force] = self.surface.probe_force(&state, pose);
        let work = |(node, force): &(usize, [f64; 2])| {
            let u = state.displacements[*node];
            force[0] * u[0] + force[1] * u[1]
        };
        let energy = 0.5
            * self
                .surface
                .nodal_forces(&state, pose)
                .iter()
                .map(work)
                .sum::<f64>();
        let penetration = self.surface.penetration(&state, pose);
        PoseSolution {
            pose,
            normal_force,
            lateral_force,
            energy,
            penetration,
            state,
        }
    }

    /// The whole field at a solved pose, by a full solve under its contact forces.
    ///
    /// ```
    #[doc = include_str!("coarse.example")]
    /// let solution = model.solve(pose)?;
    /// let field = model.field(&solution)?;
    /// let surface = &field.displacements[model.mesh().surface()];
    /// for (found, kept) in surface.iter().zip(&solution.state.displacements) {
    ///     assert!((found[1] - kept[1]).abs() < 1e-9);
    /// }
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`FemError::Residual`].
    pub fn field(&self, solution: &PoseSolution) -> Result<Field, FemError> {
        let numbering = &self.matrix.numbering;
        let first = numbering.first_surface_unknown();
        let mut force = vec![0.0; numbering.unknowns()];
        for (node, component) in self.surface.nodal_forces(&solution.state, solution.pose) {
            force[first + 2 * node..][..2].copy_from_slice(&component);
        }
        let (u, _) = self.factor.solve(&self.matrix, &force)?;
        let component = |node, direction| {
            numbering
                .unknown(node, direction)
                .map_or(0.0, |unknown| u[unknown])
        };
        let nodes = 0..self.mesh.nodes.len();
        Ok(Field {
            displacements: nodes
                .map(|node| [component(node, 0), component(node, 1)])
                .collect(),
            gradients: self.samples.gradients(&u),
        })
    }

    /// The checks of the whole field at each solved pose.
    ///
    /// ```
    #[doc = include_str!("coarse.example")]
    /// let checks = model.checks(&[model.solve(pose)?]);
    /// assert!(checks[0].residual < 1e-8);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn checks(&self, solutions: &[PoseSolution]) -> Vec<FieldCheck> {
        let first = self.matrix.numbering.first_surface_unknown();
        let mut batch = Batch::new(self.matrix.numbering.unknowns());
        let mut checks = vec![FieldCheck::UNTOUCHED; solutions.len()];
        let touching: Vec<usize> = (0..solutions.len())
            .filter(|&at| !solutions[at].state.active.is_empty())
            .collect();
        for chunk in touching.chunks(BATCH) {
            for (column, &at) in chunk.iter().enumerate() {
                let PoseSolution { state, pose, .. } = &solutions[at];
                let forces = self.surface.nodal_forces(state, *pose);
                batch.set(column, first, &state.displacements, &forces);
            }
            let columns = batch.check(&self.matrix, &self.factor, &self.samples);
            for (&at, check) in chunk.iter().zip(columns) {
                checks[at] = check;
            }
        }
        checks
    }

    /// Solves one lateral position at increasing depths, each pose starting the next.
    fn column(&self, depths: &[f64], lateral: f64) -> Result<Vec<PoseSolution>, FemError> {
        let mut from = Pose {
            depth: 0.0,
            lateral,
        };
        let mut state = ContactState::untouched(self.surface.positions.len());
        let mut solutions = Vec::with_capacity(depths.len());
        let mut earlier: Option<(f64, ContactState)> = None;
        for &depth in depths {
            let pose = Pose { depth, lateral };
            let start = match &earlier {
                Some((before, earlier)) if from.depth > *before => {
                    state.extrapolated(earlier, (depth - from.depth) / (from.depth - before))
                }
                _ => state.clone(),
            };
            let solved = self.approach(pose, from, &start)?;
            earlier = Some((from.depth, std::mem::replace(&mut state, solved)));
            from = pose;
            solutions.push(self.solution(pose, state.clone()));
        }
        Ok(solutions)
    }

    /// The force map over `depths` × `laterals` (m, both increasing) with its certificate. Negative lateral
    /// positions are the mirror images of positive ones. `solved` is told after each lateral position how
    /// many poses that were.
    ///
    /// ```
    #[doc = include_str!("coarse.example")]
    /// use std::cell::Cell;
    ///
    /// let poses = Cell::new(0);
    /// let map = model.map(&[1e-3, 2e-3], &[-2e-3, 0.0, 2e-3], &|solved| poses.set(poses.get() + solved))?;
    /// assert_eq!(poses.get(), 4); // those at −2 mm are mirror images
    /// assert_eq!(map.normal_force().row(1)[0], map.normal_force().row(1)[2]);
    /// let certificate = map.certificate().expect("a computed map");
    /// assert!(certificate.worst_relative_residual < 1e-8);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// Implements: FEM-014, FEM-015, FEM-061.
    ///
    /// # Errors
    /// As [`Model::solve`], and [`FemError::Residual`], [`FemError::Map`].
    pub fn map(
        &self,
        depths: &[f64],
        laterals: &[f64],
        solved: &dyn Fn(usize),
    ) -> Result<ForceMap, FemError> {
        // Axes first: a list that cannot be a map shall not cost the time to solve it.
        let zeros = || Matrix::from_fn(depths.len(), laterals.len(), |_, _| 0.0);
        ForceTable::new(depths.to_vec(), laterals.to_vec(), zeros(), zeros())?;
        for &lateral in laterals {
            for &depth in depths {
                self.phantom.check_pose(depth, lateral)?;
            }
        }
        let right = solved_laterals(laterals);
        let mut solutions = Vec::with_capacity(right.len() * depths.len());
        for &lateral in &right {
            let column = self.column(depths, lateral)?;
            solutions.extend(column);
            solved(depths.len());
        }
        let checks = self.checks(&solutions);
        for check in &checks {
            check_residual(check.residual)?;
        }
        // Solutions and checks come column by column.
        let matrix = |entry: &dyn Fn(usize) -> f64| {
            Matrix::from_fn(depths.len(), right.len(), |row, column| {
                entry(column * depths.len() + row)
            })
        };
        let table = ForceTable::new(
            depths.to_vec(),
            right.clone(),
            matrix(&|at| solutions[at].normal_force),
            matrix(&|at| solutions[at].lateral_force),
        )?;
        let certificate = self.certificate(
            &solutions,
            &checks,
            matrix(&|at| checks[at].min_det),
            depths,
            &right,
        )?;
        let map = ForceMap::new(
            Source::FiniteElements { certificate },
            Some(self.phantom.clone()),
            table,
        )?;
        let map = if right[0] == 0.0 {
            map.mirrored()?
        } else {
            map
        };
        Ok(map.at_laterals(laterals)?)
    }

    fn certificate(
        &self,
        solutions: &[PoseSolution],
        checks: &[FieldCheck],
        min_det: Matrix,
        depths: &[f64],
        laterals: &[f64],
    ) -> Result<Certificate, FemError> {
        let worst =
            |value: &dyn Fn(&FieldCheck) -> f64| checks.iter().map(value).fold(0.0, f64::max);
        // No det can be found only where a field is not finite, and then its residual is not either.
        let smallest_det = SmallestDet::of(&min_det, depths, laterals)
            .ok_or(FemError::Residual { residual: f64::NAN })?;
        Ok(Certificate {
            worst_relative_residual: worst(&|check| check.residual),
            worst_force_balance: worst(&|check| check.imbalance),
            largest_penetration: solutions.iter().map(|s| s.penetration).fold(0.0, f64::max),
            newton_iterations: solutions.iter().map(|s| s.state.iterations).sum(),
            mesh_size: self.options.size,
            nodes: self.mesh.nodes.len(),
            elements: self.mesh.regions.len(),
            element: self.mesh.element.name().into(),
            contact: self.surface.contact.name().into(),
            smallest_det,
            min_det,
            discretization: None,
        })
    }
}

impl PoseSolution {
    /// The same probe at −x.
    fn mirrored(self) -> PoseSolution {
        let nodes = self.state.displacements.len();
        let state = ContactState {
            displacements: self
                .state
                .displacements
                .iter()
                .rev()
                .map(|&[x, y]| [-x, y])
                .collect(),
            pressures: self.state.pressures.iter().rev().copied().collect(),
            active: self
                .state
                .active
                .iter()
                .rev()
                .map(|&node| nodes - 1 - node)
                .collect(),
            iterations: self.state.iterations,
        };
        let pose = Pose {
            lateral: -self.pose.lateral,
            ..self.pose
        };
        PoseSolution {
            pose,
            lateral_force: -self.lateral_force,
            state,
            ..self
        }
    }
}

/// The lateral positions that [`Model::map`] solves for a map at `laterals`, m: the distinct |x|, increasing,
/// with 0 among them wherever there is a mirror image to make.
///
/// ```
/// use palpate::fem::solved_laterals;
///
/// assert_eq!(solved_laterals(&[-2e-3, 1e-3, 2e-3]), [0.0, 1e-3, 2e-3]);
/// ```
pub fn solved_laterals(laterals: &[f64]) -> Vec<f64> {
    let mut right: Vec<f64> = laterals.iter().map(|x| x.abs()).collect();
    if laterals.iter().any(|&x| x < 0.0) {
        right.push(0.0);
    }
    right.sort_by(f64::total_cmp);
    right.dedup();
    right
}
