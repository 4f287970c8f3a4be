//! Frictionless unilateral contact of the rigid probe with the condensed surface.
//!
//! The surface's displacements are u = C f with C the surface compliance. Each surface node i obeys
//! gap_i ≥ 0, λ_i ≥ 0, λ_i gap_i = 0, and carries the force λ_i n_i. With the probe's true normal at the
//! deformed node, n turns with u: Newton's method needs the curvature term λ (I − n nᵀ)/r.

use nalgebra::{Cholesky, DMatrix, DVector, Dyn, LU};

use super::{FemError, Pose};
use crate::phantom::Probe;

/// How the gap between a surface node and the probe is measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Contact {
    /// Distance of the deformed node from the circle, force along the circle's normal there: the default.
    #[default]
    DeformedNormal,
    /// Height of the circle above the node at its undeformed x, vertical force on the gel: the linear
    /// contact of small-displacement theory. The lateral force on the probe is that of the pressure
    /// on its slope, −∂U/∂x.
    VerticalGap,
}

impl Contact {
    /// The name on the command line and in files.
    pub fn name(self) -> &'static str {
        match self {
            Contact::DeformedNormal => "deformed-normal",
            Contact::VerticalGap => "vertical-gap",
        }
    }
}

/// Largest penetration of a node that counts as none, m: a nanonewton at the surface's stiffness.
const GAP_TOLERANCE: f64 = 1e-12;
/// Newton's method has converged when no displacement moves by more than this, m.
const STEP_TOLERANCE: f64 = 1e-13;
/// A tangent system is used again while each step is below this part of the one before.
const REUSE_BELOW: f64 = 0.2;
/// Iterations after which the active set changes by one node at a time, which cannot cycle.
const SIMULTANEOUS_CHANGES: usize = 25;
/// Iterations after which a pose has not converged.
const MOST_ITERATIONS: usize = 120;

/// Gap, normal and curvature at one node.
#[derive(Debug, Clone, Copy)]
struct Constraint {
    /// Distance to the probe, m; negative inside it.
    gap: f64,
    /// ∂gap/∂u, the direction of the force on the gel.
    normal: [f64; 2],
    /// |∂n/∂u| along the tangent, 1/m.
    curvature: f64,
}

/// The surface of a phantom, ready for contact.
///
/// Implements: FEM-009.
#[derive(Debug, Clone)]
pub struct Surface {
    /// Undeformed position of each free surface node, m.
    pub positions: Vec<[f64; 2]>,
    /// Displacements per force, m/N, both components of each node in turn; symmetric.
    pub compliance: DMatrix<f64>,
    /// The probe.
    pub probe: Probe,
    /// How the gap is measured.
    pub contact: Contact,
}

/// Surface displacements and contact forces at one pose.
///
/// Implements: FEM-010.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactState {
    /// Displacement of each surface node, m.
    pub displacements: Vec<[f64; 2]>,
    /// λ of each surface node, N; zero off the contact.
    pub pressures: Vec<f64>,
    /// Surface nodes in contact, ascending.
    pub active: Vec<usize>,
    /// Newton iterations spent on this pose.
    pub iterations: usize,
}

impl ContactState {
    /// The untouched surface.
    pub fn untouched(nodes: usize) -> ContactState {
        ContactState {
            displacements: vec![[0.0; 2]; nodes],
            pressures: vec![0.0; nodes],
            active: Vec::new(),
            iterations: 0,
        }
    }

    /// Where the state goes if it keeps changing as it did since `earlier`, `ahead` times as far.
    pub fn extrapolated(&self, earlier: &ContactState, ahead: f64) -> ContactState {
        let on = |now: f64, then: f64| now + ahead * (now - then);
        let mut state = self.clone();
        for (u, then) in state.displacements.iter_mut().zip(&earlier.displacements) {
            *u = [on(u[0], then[0]), on(u[1], then[1])];
        }
        for &node in &state.active {
            state.pressures[node] = on(state.pressures[node], earlier.pressures[node]).max(0.0);
        }
        state
    }
}

/// Newton's matrix at some state, factorised: see [`Surface::tangent_system`].
#[derive(Debug)]
struct TangentSystem {
    active: Vec<usize>,
    normals: Vec<[f64; 2]>,
    /// Of C_nn.
    normal_factor: Cholesky<f64, Dyn>,
    /// W.
    coupling: DMatrix<f64>,
    /// The diagonal of D.
    turning: Vec<f64>,
    /// Of I − Q D.
    slip_factor: LU<f64, Dyn, Dyn>,
}

impl TangentSystem {
    /// Increments of λ, and slips, that mend the mismatch u − C (n λ) of the active nodes, m. `None` if
    /// the system is singular or an increment is not finite.
    fn solve(&self, mismatch: &[[f64; 2]]) -> Option<(DVector<f64>, DVector<f64>)> {
        if mismatch.is_empty() {
            // The probe clears the surface; the dense solvers refuse empty systems.
            return Some((DVector::zeros(0), DVector::zeros(0)));
        }
        let along = |direction: &dyn Fn([f64; 2]) -> [f64; 2]| {
            let components = self
                .normals
                .iter()
                .zip(mismatch)
                .map(|(&n, &u)| dot(direction(n), u));
            DVector::from_iterator(mismatch.len(), components)
        };
        let (mut pressures, mut slips) = (along(&|n| n), -along(&tangent));
        let lower = self.normal_factor.l_dirty();
        lower
            .solve_lower_triangular_mut(&mut pressures)
            .then_some(())?;
        for (b, slip) in slips.iter_mut().enumerate() {
            *slip += self.coupling.column(b).dot(&pressures);
        }
        self.slip_factor.solve_mut(&mut slips).then_some(())?;
        for (b, slip) in slips.iter().enumerate() {
            pressures.axpy(-slip * self.turning[b], &self.coupling.column(b), 1.0);
        }
        lower
            .tr_solve_lower_triangular_mut(&mut pressures)
            .then_some(())?;
        let finite = pressures.iter().chain(&slips).all(|x| x.is_finite());
        finite.then_some((pressures, slips))
    }
}

fn dot(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

/// The tangent to a normal: n turned by a quarter.
fn tangent(n: [f64; 2]) -> [f64; 2] {
    [-n[1], n[0]]
}

impl Surface {
    /// Inverts the surface stiffness L Lᵀ given by its factor.
    ///
    /// Implements: FEM-007.
    pub fn new(
        factor: DMatrix<f64>,
        positions: Vec<[f64; 2]>,
        probe: Probe,
        contact: Contact,
    ) -> Surface {
        let mut compliance = Cholesky::pack_dirty(factor).inverse();
        compliance.fill_lower_triangle_with_upper_triangle();
        Surface {
            positions,
            compliance,
            probe,
            contact,
        }
    }

    fn constraint(&self, node: usize, u: [f64; 2], pose: Pose) -> Option<Constraint> {
        let radius = self.probe.radius;
        let [x, y] = self.positions[node];
        let centre = [pose.lateral, radius - pose.depth];
        match self.contact {
            Contact::DeformedNormal => {
                let arm = [x + u[0] - centre[0], y + u[1] - centre[1]];
                let r = libm::sqrt(dot(arm, arm));
                let normal = [arm[0] / r, arm[1] / r];
                (r > 0.0).then_some(Constraint {
                    gap: r - radius,
                    normal,
                    curvature: 1.0 / r,
                })
            }
            Contact::VerticalGap => {
                let square = radius * radius - (x - centre[0]) * (x - centre[0]);
                let gap = centre[1] - libm::sqrt(square) - y - u[1];
                (square > 0.0).then_some(Constraint {
                    gap,
                    normal: [0.0, -1.0],
                    curvature: 0.0,
                })
            }
        }
    }

    /// The 2 × 2 block of the compliance between nodes `i` and `j`, applied to `v`.
    fn response(&self, i: usize, j: usize, v: [f64; 2]) -> [f64; 2] {
        // The matrix is symmetric: column access is contiguous.
        let at = |row: usize, column: usize| self.compliance[(row, column)];
        [
            at(2 * i, 2 * j) * v[0] + at(2 * i, 2 * j + 1) * v[1],
            at(2 * i + 1, 2 * j) * v[0] + at(2 * i + 1, 2 * j + 1) * v[1],
        ]
    }

    /// Contact at `pose`, starting from the state of a pose nearby.
    ///
    /// Implements: FEM-009, FEM-010, FEM-011.
    ///
    /// # Errors
    /// [`FemError::NoConvergence`], which names the pose.
    pub fn solve(&self, pose: Pose, start: &ContactState) -> Result<ContactState, FemError> {
        let failed = |iterations| FemError::NoConvergence { pose, iterations };
        let mut state = start.clone();
        self.revise(&mut state, pose, usize::MAX);
        let mut tangent_system: Option<TangentSystem> = None;
        let mut last_step = f64::INFINITY;
        for iteration in 0..MOST_ITERATIONS {
            // The old tangent serves as long as it lets the steps shrink well: factorising is the cost.
            let system = match tangent_system.take() {
                Some(system) if system.active == state.active => system,
                _ => self.tangent_system(&state, pose).ok_or(failed(iteration))?,
            };
            let step = self
                .newton(&mut state, pose, &system)
                .ok_or(failed(iteration))?;
            let at_most = if iteration < SIMULTANEOUS_CHANGES {
                usize::MAX
            } else {
                1
            };
            let changed = self.revise(&mut state, pose, at_most);
            if !changed && step <= STEP_TOLERANCE {
                state.iterations = iteration + 1;
                return Ok(state);
            }
            (tangent_system, last_step) = if step <= REUSE_BELOW * last_step {
                (Some(system), step)
            } else {
                (None, f64::INFINITY)
            };
        }
        Err(failed(MOST_ITERATIONS))
    }

    /// Factorises the system for increments of λ and of each node's slip b along its tangent t. With
    /// δu = −gap n + b t, u = C (n λ) linearised and projected on n and t reads
    ///
    /// C_nn δλ + C_nt D b = r_n, C_tn δλ + (C_tt D − I) b = r_t, D = diag(λ κ).
    ///
    /// Eliminating δλ by Cholesky's factor L of C_nn leaves (I − Q D) b = C_tn C_nn⁻¹ r_n − r_t with
    /// Q = C_tt − WᵀW, W = L⁻¹ C_nt. `None` if a node lies on the probe's axis.
    fn tangent_system(&self, state: &ContactState, pose: Pose) -> Option<TangentSystem> {
        let m = state.active.len();
        let constraints = self.constraints(state, pose)?;
        let [mut nn, mut nt, mut tt] = [0; 3].map(|_| DMatrix::zeros(m, m));
        for (b, (&j, constraint)) in state.active.iter().zip(&constraints).enumerate() {
            let [push, slide] = [constraint.normal, tangent(constraint.normal)];
            for (a, (&i, constraint)) in state.active.iter().zip(&constraints).enumerate() {
                let [n, t] = [constraint.normal, tangent(constraint.normal)];
                let slid = self.response(i, j, slide);
                nn[(a, b)] = dot(n, self.response(i, j, push));
                nt[(a, b)] = dot(n, slid);
                tt[(a, b)] = dot(t, slid);
            }
        }
        let normal_factor = Cholesky::new(nn)?;
        let coupling = normal_factor.l_dirty().solve_lower_triangular(&nt)?;
        let turning: Vec<f64> = state
            .active
            .iter()
            .zip(&constraints)
            .map(|(&j, constraint)| state.pressures[j] * constraint.curvature)
            .collect();
        let mut slip = DMatrix::identity(m, m);
        for a in 0..m {
            for b in 0..=a {
                let q = tt[(a, b)] - coupling.column(a).dot(&coupling.column(b));
                slip[(a, b)] -= q * turning[b];
                if a != b {
                    slip[(b, a)] -= q * turning[a];
                }
            }
        }
        Some(TangentSystem {
            active: state.active.clone(),
            normals: constraints
                .iter()
                .map(|constraint| constraint.normal)
                .collect(),
            normal_factor,
            coupling,
            turning,
            slip_factor: slip.lu(),
        })
    }

    fn constraints(&self, state: &ContactState, pose: Pose) -> Option<Vec<Constraint>> {
        state
            .active
            .iter()
            .map(|&i| self.constraint(i, state.displacements[i], pose))
            .collect()
    }

    /// One Newton step on the active nodes; updates displacements and pressures, and returns the
    /// largest displacement increment of an active node, m. `None` if the system is singular.
    fn newton(&self, state: &mut ContactState, pose: Pose, system: &TangentSystem) -> Option<f64> {
        let constraints = self.constraints(state, pose)?;
        let mut mismatch = Vec::with_capacity(constraints.len());
        for (&i, constraint) in state.active.iter().zip(&constraints) {
            let mut u =
                [0, 1].map(|d| state.displacements[i][d] - constraint.gap * constraint.normal[d]);
            for (&j, constraint) in state.active.iter().zip(&constraints) {
                let elastic =
                    self.response(i, j, constraint.normal.map(|n| n * state.pressures[j]));
                u = [u[0] - elastic[0], u[1] - elastic[1]];
            }
            mismatch.push(u);
        }
        let (pressures, slips) = system.solve(&mismatch)?;
        let mut largest = 0.0f64;
        let mut moved = Vec::with_capacity(constraints.len());
        for (a, (&i, constraint)) in state.active.iter().zip(&constraints).enumerate() {
            state.pressures[i] += pressures[a];
            let t = tangent(constraint.normal);
            let step = [0, 1].map(|d| slips[a] * t[d] - constraint.gap * constraint.normal[d]);
            largest = largest.max(step[0].abs()).max(step[1].abs());
            let u = state.displacements[i];
            moved.push([u[0] + step[0], u[1] + step[1]]);
        }
        self.displace(state, &moved, pose)?;
        Some(largest)
    }

    /// Displacements of the whole surface under the pressures, with normals at `moved`, where the
    /// active nodes are put.
    fn displace(&self, state: &mut ContactState, moved: &[[f64; 2]], pose: Pose) -> Option<()> {
        let mut u = DVector::zeros(2 * self.positions.len());
        for (&j, &at) in state.active.iter().zip(moved) {
            let n = self.constraint(j, at, pose)?.normal;
            for direction in 0..2 {
                u.axpy(
                    state.pressures[j] * n[direction],
                    &self.compliance.column(2 * j + direction),
                    1.0,
                );
            }
        }
        for (i, displacement) in state.displacements.iter_mut().enumerate() {
            *displacement = [u[2 * i], u[2 * i + 1]];
        }
        for (&j, &at) in state.active.iter().zip(moved) {
            state.displacements[j] = at;
        }
        Some(())
    }

    /// Drops active nodes that would be pulled and adds nodes inside the probe: all at once, or the
    /// `at_most` worst. Returns whether the set changed.
    fn revise(&self, state: &mut ContactState, pose: Pose, at_most: usize) -> bool {
        let mut violations: Vec<(f64, usize)> = Vec::new();
        for i in 0..self.positions.len() {
            let active = state.active.binary_search(&i).is_ok();
            // Pulls and penetrations are weighed against each other by the node's own compliance.
            let violation = if active {
                state.pressures[i] * self.compliance[(2 * i + 1, 2 * i + 1)]
            } else {
                match self.constraint(i, state.displacements[i], pose) {
                    Some(constraint) => (constraint.gap + GAP_TOLERANCE).min(0.0),
                    None => 0.0,
                }
            };
            if violation < 0.0 {
                violations.push((violation, i));
            }
        }
        if violations.len() > at_most {
            violations.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
            violations.truncate(at_most);
        }
        for &(_, i) in &violations {
            match state.active.binary_search(&i) {
                Ok(at) => {
                    state.active.remove(at);
                    state.pressures[i] = 0.0;
                }
                Err(at) => state.active.insert(at, i),
            }
        }
        !violations.is_empty()
    }

    /// Force on the gel at each active node, N.
    pub fn nodal_forces(&self, state: &ContactState, pose: Pose) -> Vec<(usize, [f64; 2])> {
        let force = |&i: &usize| {
            let constraint = self.constraint(i, state.displacements[i], pose)?;
            Some((i, constraint.normal.map(|n| n * state.pressures[i])))
        };
        state.active.iter().filter_map(force).collect()
    }

    /// Force on the probe (lateral, normal), N: that on the gel reversed, or, for the vertical gap, the
    /// pressure on the circle's slope, so that F = −∂U/∂(x, y) of the probe in both cases.
    ///
    /// Implements: FEM-012.
    pub fn probe_force(&self, state: &ContactState, pose: Pose) -> [f64; 2] {
        let mut total = [0.0; 2];
        for (i, [x, y]) in self.nodal_forces(state, pose) {
            total[1] -= y;
            total[0] -= match self.contact {
                Contact::DeformedNormal => x,
                Contact::VerticalGap => {
                    let offset = self.positions[i][0] - pose.lateral;
                    -y * offset
                        / libm::sqrt(self.probe.radius * self.probe.radius - offset * offset)
                }
            };
        }
        total
    }

    /// Largest penetration of any surface node, m.
    pub fn penetration(&self, state: &ContactState, pose: Pose) -> f64 {
        let gap = |i: usize| {
            self.constraint(i, state.displacements[i], pose)
                .map_or(0.0, |c| c.gap)
        };
        (0..self.positions.len())
            .map(|i| -gap(i))
            .fold(0.0, f64::max)
    }
}
