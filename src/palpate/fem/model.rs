//! A phantom, meshed and factorised, and the probe's forces on it.

use super::assembly::StiffnessMatrix;
use super::cholesky::{Factor, check_residual};
use super::contact::{Contact, ContactState, Surface};
use super::element::SAMPLES;
use super::field::{BATCH, Checker, Field, FieldCheck, SamplingPoint, samples};
use super::finite::{Equilibrium, FiniteModel, Friction, law_of};
use super::mesh::Mesh;
use super::size::SizeField;
use super::{FemError, Pose, arithmetic};
use crate::decimal::mm;
use crate::force::Force;
use crate::force_map::{
    Certificate, ForceMap, ForceTable, Matrix, SAME_POSITION, SmallestDet, Source, check_axes,
    increasing,
};
use crate::phantom::{Geometry, Phantom, Strain};
use crate::refusal::Refusal;

/// A phantom, meshed and factorised.
///
/// ```
/// use palpate::fem::{Contact, Model, Pose};
/// use palpate::phantom::Phantom;
///
/// let phantom = Phantom::builtin("6.6")?;
/// let model = Model::new(&phantom, 2e-3, Contact::default())?;
/// assert_eq!((model.phantom(), model.mesh_size()), (&phantom, 2e-3));
/// // Two contact points on each of the edges, which have three nodes each.
/// assert_eq!(model.surface().positions.len(), model.mesh().surface.len() - 1);
///
/// let [left, right] = [-1e-3, 1e-3].map(|lateral| model.solve(Pose { depth: 2e-3, lateral }));
/// assert_eq!(left?.force.lateral, -right?.force.lateral);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct Model {
    phantom: Phantom,
    mesh_size: f64,
    mesh: Mesh,
    pub(super) matrix: StiffnessMatrix,
    pub(super) factor: Factor,
    surface: Surface,
    pub(super) samples: Vec<SamplingPoint>,
    /// The gel at finite strain, where the phantom asks for it; what is of small strain then serves fields alone.
    pub(super) finite: Option<FiniteModel>,
}

/// The probe at rest at one pose.
#[derive(Debug, Clone, PartialEq)]
pub struct PoseSolution {
    /// The pose.
    pub pose: Pose,
    /// Force on the probe, N.
    pub force: Force<f64>,
    /// Strain energy of phantom and skin, J.
    pub energy: f64,
    /// Largest penetration of a contact point, m.
    pub penetration: f64,
    /// The gel at rest.
    pub state: State,
}

/// The gel at rest under the probe.
#[derive(Debug, Clone, PartialEq)]
pub enum State {
    /// At small strain: displacements and contact forces of the surface.
    Small(ContactState),
    /// At finite strain.
    Finite(Box<Equilibrium>),
}

/// Deepest step between two poses of which one starts the other, over the probe's radius.
const DEPTH_STEP: f64 = 0.1;
/// Contact points under the probe with which a force is within 8 % of that on a fine mesh, in the plane and of a sphere.
const LEAST_POINTS: usize = 6;
const LEAST_POINTS_OF_SPHERE: usize = 12;
/// Depth over the probe's radius down to which fewer points do: the force is small, and so is its error.
const LIGHT: f64 = 0.02;
/// How often a step that does not converge is halved.
const HALVINGS: u32 = 6;

impl Model {
    /// Meshes and factorises a phantom; the mesh size, m, is that of [`Mesh::new`].
    ///
    /// # Errors
    /// As [`Mesh::new`], [`StiffnessMatrix::assemble`] and
    /// [`Factor::new`]; a vertical gap at finite strain.
    ///
    /// Implements: FIN-009.
    pub fn new(phantom: &Phantom, mesh_size: f64, contact: Contact) -> Result<Model, FemError> {
        Model::of(phantom, (mesh_size, contact), None)
    }

    /// [`Model::new`] of another phantom at this mesh size and contact. Where the two differ in their materials alone, mesh, order
    /// of elimination and pattern of the factor serve again.
    ///
    /// # Errors
    /// As [`Model::new`].
    ///
    /// Implements: FEM-084.
    pub fn with_phantom(&self, phantom: &Phantom) -> Result<Model, FemError> {
        let alike = phantom.is_meshed_as(&self.phantom).then_some(self);
        Model::of(phantom, (self.mesh_size, self.surface.contact), alike)
    }

    fn of(
        phantom: &Phantom,
        (mesh_size, contact): (f64, Contact),
        alike: Option<&Model>,
    ) -> Result<Model, FemError> {
        let (mesh, matrix, factor);
        if let Some(alike) = alike {
            mesh = alike.mesh.clone();
            matrix = alike.matrix.clone().filled(&mesh, phantom)?;
            factor = Factor::of(alike.factor.symbolic.clone(), &matrix)?;
        } else {
            mesh = Mesh::new(phantom, mesh_size)?;
            matrix = StiffnessMatrix::assemble(&mesh, phantom)?;
            factor = Factor::new(&matrix)?;
        }
        let compliance = factor.surface_compliance(&matrix)?;
        let surface = Surface::new(&mesh, compliance, phantom.probe(), contact);
        let size = SizeField::new(phantom, mesh_size);
        let samples = samples(&mesh, &matrix, &size, phantom.geometry());
        let finite = match phantom.strain() {
            Strain::Small => None,
            Strain::Finite => {
                contact.check(Strain::Finite)?;
                let friction = Friction::steady(phantom.probe().friction);
                Some(FiniteModel::new(phantom, &mesh, friction)?)
            }
        };
        Ok(Model {
            phantom: phantom.clone(),
            mesh_size,
            mesh,
            matrix,
            factor,
            surface,
            samples,
            finite,
        })
    }

    /// The phantom.
    pub fn phantom(&self) -> &Phantom {
        &self.phantom
    }

    /// The mesh size that was asked for, m.
    pub fn mesh_size(&self) -> f64 {
        self.mesh_size
    }

    /// The mesh.
    pub fn mesh(&self) -> &Mesh {
        &self.mesh
    }

    /// The surface with its compliance at small strain.
    pub fn surface(&self) -> &Surface {
        &self.surface
    }

    /// Whether the probe can stand there, on enough contact points.
    ///
    /// Implements: PHA-011, FEM-085.
    fn check_pose(&self, pose: Pose) -> Result<(), FemError> {
        let stands = self.phantom.check_pose(pose.depth, pose.lateral);
        stands.map_err(|refusal| FemError::Pose(refusal.into()))?;
        let points = self.surface.reach(&ContactState::untouched(0), pose).len();
        let least = match self.phantom.geometry() {
            Geometry::Plane => LEAST_POINTS,
            Geometry::Axisymmetric => LEAST_POINTS_OF_SPHERE,
        };
        if points >= least || pose.depth <= LIGHT * self.phantom.probe().radius {
            return Ok(());
        }
        let [depth, lateral] = [pose.depth, pose.lateral].map(mm);
        let found = format!(
            "the mesh has {points} contact points under the probe at depth {depth} mm, lateral {lateral} mm, too few for a force"
        );
        let coarse = Refusal::state(found, "give a smaller mesh size or a larger probe");
        Err(FemError::Pose(coarse.into()))
    }

    /// The force at one pose.
    ///
    /// # Errors
    /// [`FemError::Pose`] where the probe cannot stand or has too few contact points, [`FemError::NoConvergence`].
    ///
    /// Implements: PHA-011, FEM-020, FEM-021, FEM-080, FEM-083.
    pub fn solve(&self, pose: Pose) -> Result<PoseSolution, FemError> {
        self.check_pose(pose)?;
        // Where the phantom is symmetric the right half stands for both, so that mirrored poses have mirrored forces to the bit.
        if self.mesh.symmetric && self.finite.is_none() && pose.lateral < 0.0 {
            let mut image = self.column(&[pose.depth], -pose.lateral)?;
            return Ok(image.swap_remove(0).mirrored());
        }
        let mut solution = self.column(&[pose.depth], pose.lateral)?.swap_remove(0);
        if self.finite.is_none() && self.is_mirrored(&[pose.lateral]) {
            solution.force.lateral = 0.0;
        }
        Ok(solution)
    }

    /// Leads the contact from a solved pose down to `pose`, in steps that halve where they fail.
    fn approach(
        &self,
        pose: Pose,
        from: Pose,
        start: &ContactState,
    ) -> Result<ContactState, FemError> {
        let whole = pose.depth - from.depth;
        let longest = DEPTH_STEP * self.phantom.probe().radius;
        let shortest = longest.min(whole) / f64::from(1u32 << HALVINGS);
        let (mut state, mut reached, mut step) = (start.clone(), from.depth, longest);
        let mut iterations = 0;
        loop {
            let last = pose.depth - reached <= step;
            let depth = if last { pose.depth } else { reached + step };
            match self.surface.solve(Pose { depth, ..pose }, &state) {
                Ok(solved) => {
                    iterations += solved.iterations;
                    (state, reached) = (solved, depth);
                    if last {
                        state.iterations = iterations;
                        return Ok(state);
                    }
                }
                Err(FemError::NoConvergence { iterations, .. }) if step <= shortest => {
                    return Err(FemError::NoConvergence { pose, iterations });
                }
                Err(_) => step = 0.5 * step.min(pose.depth - reached),
            }
        }
    }

    fn solution(&self, pose: Pose, state: ContactState) -> PoseSolution {
        let forces = self.surface.forces(&state, pose).into_iter();
        let work = forces.map(|(point, force)| {
            let u = state.displacements[point];
            0.5 * (force[0] * u[0] + force[1] * u[1])
        });
        PoseSolution {
            pose,
            force: self.surface.probe_force(&state, pose),
            energy: work.sum(),
            penetration: self.surface.penetration(&state, pose),
            state: State::Small(state),
        }
    }

    /// The whole field at a solved pose, by a full solve under its contact forces.
    ///
    /// # Errors
    /// [`FemError::Residual`].
    pub fn field(&self, solution: &PoseSolution) -> Result<Field, FemError> {
        let mut u = vec![0.0; self.matrix.unknowns()];
        match &solution.state {
            State::Small(state) => {
                let (_, forces) = self.surface.at_nodes(state, solution.pose);
                for (place, load) in self.matrix.surface.iter().zip(forces.as_flattened()) {
                    if let Some(unknown) = *place {
                        u[unknown] = *load;
                    }
                }
                u = self.factor.solve(&self.matrix, &u)?.0;
            }
            State::Finite(equilibrium) => {
                for (node, moved) in equilibrium.displacements.iter().enumerate() {
                    for (k, moved) in moved.iter().enumerate() {
                        if let Some(unknown) = self.matrix.unknown(node, k) {
                            u[unknown] = *moved;
                        }
                    }
                }
            }
        }
        // The row of zeros behind the unknowns stands for what is held.
        let rows: Vec<[f64; 1]> = u.iter().map(|&u| [u]).chain([[0.0]]).collect();
        let row = |node, k| self.matrix.unknown(node, k).unwrap_or(u.len());
        let displacements =
            (0..self.mesh.nodes.len()).map(|node| [0, 1].map(|k| rows[row(node, k)][0]));
        let gradient = |sample: &SamplingPoint| {
            sample
                .gradient(|row| &rows[row])
                .map(|row| row.map(|[g]| g))
        };
        let elements = self.samples.chunks(SAMPLES.len());
        let gradients = elements.map(|samples| samples.iter().map(gradient).collect());
        Ok(Field {
            displacements: displacements.collect(),
            gradients: gradients.collect(),
        })
    }

    /// The checks of the whole field at each solved pose of this model.
    ///
    /// # Errors
    /// [`FemError::OutOfMemory`].
    pub fn checks(&self, solutions: &[PoseSolution]) -> Result<Vec<FieldCheck>, FemError> {
        let equilibria = solutions
            .iter()
            .filter_map(|solution| match &solution.state {
                State::Finite(equilibrium) => Some(equilibrium.check),
                State::Small(_) => None,
            });
        let mut checks: Vec<FieldCheck> = equilibria.collect();
        let small = solutions
            .iter()
            .filter_map(|s| Some((s.contact()?, s.pose)));
        let poses = small.map(|(state, pose)| self.surface.at_nodes(state, pose));
        let poses: Vec<_> = poses.collect();
        let mut checker = Checker::new(&self.matrix, &self.factor, &self.samples);
        for poses in poses.chunks(BATCH) {
            checks.extend(checker.check(poses)?);
        }
        Ok(checks)
    }

    /// Solves one lateral position at increasing depths, each pose starting the next.
    ///
    /// Implements: FEM-063.
    fn column(&self, depths: &[f64], lateral: f64) -> Result<Vec<PoseSolution>, FemError> {
        if let Some(finite) = &self.finite {
            let poses: Vec<Pose> = depths
                .iter()
                .map(|&depth| Pose { depth, lateral })
                .collect();
            let column = finite.path(finite.untouched(lateral), &poses)?;
            return Ok(column.into_iter().map(PoseSolution::from).collect());
        }
        let above = Pose {
            depth: 0.0,
            lateral,
        };
        let untouched = ContactState::untouched(self.surface.positions.len());
        let (mut from, mut state) = (above, untouched.clone());
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
            // Where the gel is turned inside out, one way to a pose may fail and another not.
            let solved = self
                .approach(pose, from, &start)
                .or_else(|_| self.approach(pose, from, &state))
                .or_else(|_| self.approach(pose, above, &untouched))?;
            earlier = Some((from.depth, std::mem::replace(&mut state, solved)));
            from = pose;
            solutions.push(self.solution(pose, state.clone()));
        }
        Ok(solutions)
    }

    /// The gel under a probe that goes from pose to pose, with the checks of its fields; with friction, nodes stick and slip as that way
    /// leads them.
    ///
    /// # Errors
    /// As [`Model::solve`]; [`FemError::Residual`].
    ///
    /// Implements: FIN-011, FEM-008.
    pub fn path(&self, poses: &[Pose]) -> Result<(Vec<PoseSolution>, Vec<FieldCheck>), FemError> {
        poses.iter().try_for_each(|&pose| self.check_pose(pose))?;
        let path: Vec<PoseSolution> = match (&self.finite, poses.first()) {
            (Some(finite), Some(first)) => {
                let finite = finite.along_path();
                let path = finite.path(finite.untouched(first.lateral), poses)?;
                path.into_iter().map(PoseSolution::from).collect()
            }
            _ => poses
                .iter()
                .map(|&pose| self.solve(pose))
                .collect::<Result<_, _>>()?,
        };
        let checks = self.residuals(&path)?;
        Ok((path, checks))
    }

    /// The force map over `depths` × `laterals` (m, both increasing) with its certificate. Negative lateral
    /// positions are the mirror images of positive ones. `solved` is told after each lateral position how
    /// many poses that were, and says whether to go on.
    ///
    /// Implements: FEM-014, FEM-013, FEM-038, FEM-060, PYT-010.
    ///
    /// # Errors
    /// As [`Model::solve`], and [`FemError::Residual`], [`FemError::Refused`], [`FemError::Stopped`].
    pub fn map(
        &self,
        depths: &[f64],
        laterals: &[f64],
        solved: &dyn Fn(usize) -> bool,
    ) -> Result<ForceMap, FemError> {
        let (right, solutions) = self.columns(depths, laterals, solved)?;
        self.map_of(&solutions, [depths, &right], laterals)
    }

    /// The lateral positions that are solved for a map, and the solutions at all depths of each in turn.
    fn columns(
        &self,
        depths: &[f64],
        laterals: &[f64],
        solved: &dyn Fn(usize) -> bool,
    ) -> Result<(Vec<f64>, Vec<PoseSolution>), FemError> {
        self.check_poses(depths, laterals)?;
        let right = self.solved_laterals(laterals);
        let mut solutions = Vec::with_capacity(right.len() * depths.len());
        for &lateral in &right {
            solutions.extend(self.column(depths, lateral)?);
            if !solved(depths.len()) {
                return Err(FemError::Stopped);
            }
        }
        Ok((right, solutions))
    }

    /// The forces of [`Model::map`] alone; of the fields only those at the deepest poses are checked.
    ///
    /// # Errors
    /// As [`Model::map`].
    ///
    /// Implements: FEM-026.
    pub(super) fn table(
        &self,
        depths: &[f64],
        laterals: &[f64],
        solved: &dyn Fn(usize) -> bool,
    ) -> Result<ForceTable, FemError> {
        let (right, solutions) = self.columns(depths, laterals, solved)?;
        let deepest = solutions.chunks(depths.len()).filter_map(<[_]>::last);
        self.residuals(&deepest.cloned().collect::<Vec<_>>())?;
        let mut table = force_table(&solutions, [depths, &right])?;
        if self.is_mirrored(&right) {
            table = table.mirrored()?;
        }
        Ok(table.at_columns(&table.columns_at(laterals)?)?)
    }

    /// Whether a map over these lateral positions is half of one.
    fn is_mirrored(&self, right: &[f64]) -> bool {
        self.mesh.symmetric && right[0] == 0.0
    }

    /// [`Model::checks`], with an error where a residual is too large.
    fn residuals(&self, solutions: &[PoseSolution]) -> Result<Vec<FieldCheck>, FemError> {
        let checks = self.checks(solutions)?;
        for check in &checks {
            check_residual(check.residual)?;
        }
        Ok(checks)
    }

    /// [`Model::map`] without progress. At a single depth each position starts the next, which takes a fifth of the time and changes
    /// the last digits of the forces.
    ///
    /// # Errors
    /// As [`Model::map`].
    ///
    /// Implements: FEM-040.
    pub fn sweep(&self, depths: &[f64], laterals: &[f64]) -> Result<ForceMap, FemError> {
        let &[depth] = depths else {
            return self.map(depths, laterals, &|_| true);
        };
        self.check_poses(&[depth], laterals)?;
        let right = self.solved_laterals(laterals);
        let mut solutions: Vec<PoseSolution> = Vec::with_capacity(right.len());
        for &lateral in &right {
            let pose = Pose { depth, lateral };
            let near = solutions
                .last()
                .map(|near| match (&near.state, &self.finite) {
                    (State::Small(state), _) => {
                        Some(self.solution(pose, self.surface.solve(pose, state).ok()?))
                    }
                    (State::Finite(near), Some(finite)) => {
                        Some(finite.lead(near, None, pose).ok()?.into())
                    }
                    (State::Finite(_), None) => None,
                });
            match near.flatten() {
                Some(solution) => solutions.push(solution),
                None => solutions.extend(self.column(&[depth], lateral)?),
            }
        }
        self.map_of(&solutions, [&[depth], &right], laterals)
    }

    /// Axes first: a list that cannot be a map shall not cost the time to solve it.
    pub(super) fn check_poses(&self, depths: &[f64], laterals: &[f64]) -> Result<(), FemError> {
        check_axes(depths, laterals)?;
        for &lateral in laterals {
            for &depth in depths {
                self.check_pose(Pose { depth, lateral })?;
            }
        }
        Ok(())
    }

    /// The map at `laterals` of the solutions over `depths` × `right`, which come column by column.
    fn map_of(
        &self,
        solutions: &[PoseSolution],
        [depths, right]: [&[f64]; 2],
        laterals: &[f64],
    ) -> Result<ForceMap, FemError> {
        let checks = self.residuals(solutions)?;
        let table = force_table(solutions, [depths, right])?;
        let min_det = by_columns(&checks, depths.len(), |check| check.min_det);
        let certificate = self.certificate(solutions, &checks, min_det, [depths, right])?;
        let source = Source::FiniteElements { certificate };
        let mut map = ForceMap::new(source, Some(self.phantom.clone()), table)?;
        if self.is_mirrored(right) {
            map = map.mirrored()?;
        }
        Ok(map.at_laterals(laterals)?)
    }

    /// The lateral positions that [`Model::map`] solves for a map at `laterals`, m, increasing: of a symmetric phantom the
    /// distinct |x|, with 0 among them wherever there is a mirror image to make.
    pub fn solved_laterals(&self, laterals: &[f64]) -> Vec<f64> {
        let mut solved = laterals.to_vec();
        if self.mesh.symmetric && laterals.iter().any(|&x| x < 0.0) {
            solved.push(0.0);
            solved.iter_mut().for_each(|x| *x = x.abs());
        }
        let mut solved = increasing(solved.into_iter());
        solved.dedup_by(|next, x| *next - *x <= SAME_POSITION);
        solved
    }

    fn certificate(
        &self,
        solutions: &[PoseSolution],
        checks: &[FieldCheck],
        min_det: Matrix,
        [depths, laterals]: [&[f64]; 2],
    ) -> Result<Certificate, FemError> {
        // No det can be found only where a field is not finite, and then its residual is not either.
        let smallest_det = SmallestDet::of(&min_det, depths, laterals)
            .ok_or(FemError::Residual { residual: f64::NAN })?;
        Ok(Certificate {
            worst_relative_residual: largest(checks.iter().map(|check| check.residual)),
            worst_force_balance: largest(checks.iter().map(|check| check.imbalance)),
            largest_penetration: largest(solutions.iter().map(|s| s.penetration)),
            newton_iterations: solutions.iter().map(PoseSolution::iterations).sum(),
            mesh_size: self.mesh_size,
            nodes: self.mesh.nodes.len(),
            elements: self.mesh.regions.len(),
            element: self.finite.as_ref().map_or("t6", |_| "taylor-hood").into(),
            contact: self.surface.contact.name().into(),
            arithmetic: arithmetic().into(),
            smallest_det,
            min_det,
            law: self.finite.as_ref().map(|_| law_of(&self.phantom)),
            discretization: None,
        })
    }
}

/// A value of each pose, as a row for each depth; the poses come column by column.
fn by_columns<T>(poses: &[T], depths: usize, value: impl Fn(&T) -> f64) -> Matrix {
    Matrix::from_fn(depths, poses.len() / depths, |row, column| {
        value(&poses[column * depths + row])
    })
}

fn force_table(
    solutions: &[PoseSolution],
    [depths, laterals]: [&[f64]; 2],
) -> Result<ForceTable, Refusal> {
    let forces = Force {
        lateral: by_columns(solutions, depths.len(), |solution| solution.force.lateral),
        normal: by_columns(solutions, depths.len(), |solution| solution.force.normal),
    };
    ForceTable::new(depths.to_vec(), laterals.to_vec(), forces)
}

/// The largest of values that are at least 0.
fn largest(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(0.0, f64::max)
}

impl From<Equilibrium> for PoseSolution {
    fn from(equilibrium: Equilibrium) -> PoseSolution {
        PoseSolution {
            pose: equilibrium.pose,
            force: equilibrium.force,
            energy: equilibrium.energy,
            penetration: equilibrium.penetration,
            state: State::Finite(equilibrium.into()),
        }
    }
}

impl PoseSolution {
    /// Displacements and contact forces of the surface at small strain; `None` at finite strain.
    pub fn contact(&self) -> Option<&ContactState> {
        match &self.state {
            State::Small(state) => Some(state),
            State::Finite(_) => None,
        }
    }

    /// Newton's iterations spent on this pose.
    fn iterations(&self) -> usize {
        match &self.state {
            State::Small(state) => state.iterations,
            State::Finite(equilibrium) => equilibrium.iterations,
        }
    }

    /// The same probe at −x, at small strain.
    fn mirrored(mut self) -> PoseSolution {
        self.pose.lateral = -self.pose.lateral;
        self.force.lateral = -self.force.lateral;
        if let State::Small(state) = self.state {
            self.state = State::Small(state.mirrored());
        }
        self
    }
}
