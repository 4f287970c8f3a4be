//! Frictionless unilateral contact of the rigid probe with the condensed surface, at two Gauss points on each edge there.
//!
//! The points' displacements are u = N C Nᵀ f with C the compliance of the surface's nodes and N their shape functions at the
//! points. Each point i obeys gap_i ≥ 0, λ_i ≥ 0, λ_i gap_i = 0, and carries the force λ_i n_i. With the probe's true normal at the
//! deformed point, n turns with u: Newton's method needs the curvature term λ (I − n nᵀ)/r.

mod state;

use std::ops::Range;

use faer::linalg::solvers::{Llt, Solve};
use faer::linalg::triangular_solve::solve_lower_triangular_in_place;
use faer::traits::pulp::{Arch, NullaryFnOnce};
use faer::{Col, Mat, Par, Side};
use nalgebra::Vector2;

use super::cholesky::reflect;
use super::mesh::Mesh;
use super::{FemError, Pose};
use crate::force::Force;
use crate::phantom::{Probe, Strain};
use crate::refusal::Refusal;
pub use state::ContactState;

/// How the gap between a surface node and the probe is measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Contact {
    /// Distance of the deformed surface from the circle; force along its normal.
    #[default]
    DeformedNormal,
    /// Height of the circle over the undeformed point; vertical force on the gel.
    ///
    /// The linear contact of small-displacement theory. The lateral force on the probe is that of the
    /// pressure on its slope, −∂U/∂x.
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

    /// Whether the forces of a gel at this strain can be computed with this law.
    ///
    /// # Errors
    /// `vertical-gap` at finite strain.
    ///
    /// Implements: FIN-009.
    pub fn check(self, strain: Strain) -> Result<(), Refusal> {
        let found = format!("{} contact at finite strain", self.name());
        let expected = "give deformed-normal contact, or strain = \"small\"";
        let is_refused = strain == Strain::Finite && self != Contact::DeformedNormal;
        Refusal::state(found, expected).when(is_refused)
    }
}

/// Largest penetration of a point that counts as none, m: a nanonewton at the surface's stiffness.
const GAP_TOLERANCE: f64 = 1e-12;
/// Newton's method has converged when no displacement moves by more than this, m.
const STEP_TOLERANCE: f64 = 1e-13;
/// A tangent system is used again while each step is below this part of the one before.
const REUSE_BELOW: f64 = 0.2;
/// Iterations after which the active set changes by its worst point alone, so that it does not cycle.
const SIMULTANEOUS_CHANGES: usize = 25;
/// Where nothing is in contact yet, the points that are at least this part as deep inside the probe as the deepest come first: those
/// further out would leave the contact again, two by two.
const FIRST_TAKEN: f64 = 0.8;
/// Of the points in contact that are pulled, those at least this part as much as the worst are dropped first: the others would come back.
const FIRST_DROPPED: f64 = 0.8;
/// Iterations after which a pose has not converged.
const MOST_ITERATIONS: usize = 120;

/// Gap, normal and curvature at one point.
#[derive(Debug, Clone, Copy)]
struct Constraint {
    /// Distance to the probe, m; negative inside it.
    gap: f64,
    /// ∂gap/∂u, the direction of the force on the gel.
    normal: Vector2<f64>,
    /// |∂n/∂u| along the tangent, 1/m.
    curvature: f64,
}

impl Constraint {
    /// The normal turned by a quarter.
    fn tangent(&self) -> Vector2<f64> {
        Vector2::new(-self.normal.y, self.normal.x)
    }
}

/// The surface of a phantom, ready for contact.
///
/// Implements: FEM-009, FEM-014.
#[derive(Debug, Clone)]
pub struct Surface {
    /// Undeformed position of each contact point from left to right, m.
    pub positions: Vec<[f64; 2]>,
    /// Length of surface that each contact point stands for, m.
    pub lengths: Vec<f64>,
    /// Displacements of the contact points per force on them, m/N, both components of each point in turn; symmetric, on a
    /// symmetric mesh also in x, to the bit.
    pub compliance: Mat<f64>,
    /// The same of the nodes at the surface.
    of_nodes: Mat<f64>,
    /// The probe.
    pub probe: Probe,
    /// How the gap is measured.
    pub contact: Contact,
}

/// Newton's matrix for increments of λ and of each point's slip b along its tangent t, factorised. With δu = −gap n + b t,
/// u = C (n λ) linearised and projected on n and t reads
///
/// C_nn δλ + C_nt D b = r_n, C_tn δλ + (C_tt D − I) b = r_t, D = diag(λ κ).
///
/// Eliminating δλ by Cholesky's factor L of C_nn leaves (I − Q D) b = C_tn C_nn⁻¹ r_n − r_t with
/// Q = C_tt − WᵀW, W = L⁻¹ C_nt. With D^½ on both sides it is symmetric, and positive definite where the contact is stable.
#[derive(Debug)]
struct Tangent {
    /// Those of the state at which it was built.
    constraints: Vec<Constraint>,
    /// Factor of C_nn.
    pushed: Llt<f64>,
    /// C_tn.
    across: Mat<f64>,
    /// The diagonal of D^½.
    roots: Vec<f64>,
    /// Q.
    slid: Mat<f64>,
    /// Factor of I − D^½ Q D^½.
    slip: Llt<f64>,
}

impl Tangent {
    /// Increments of λ, and slips, that mend the mismatch u − C (n λ) of the points in contact, m. `None` if an
    /// increment is not finite.
    fn solve(&self, mismatch: &[Vector2<f64>]) -> Option<(Col<f64>, Col<f64>)> {
        let along = |direction: fn(&Constraint) -> Vector2<f64>| {
            let project = |k: usize| direction(&self.constraints[k]).dot(&mismatch[k]);
            Col::from_fn(mismatch.len(), project)
        };
        let scaled = |x: &Col<f64>| Col::from_fn(x.nrows(), |k| self.roots[k] * x[k]);
        let (normal, tangential) = (along(|c| c.normal), along(Constraint::tangent));
        let r = &self.across * self.pushed.solve(&normal) - tangential;
        // b = r + Q D^½ (I − D^½ Q D^½)⁻¹ D^½ r.
        let slips = &r + &self.slid * scaled(&self.slip.solve(scaled(&r)));
        let turned = scaled(&scaled(&slips));
        let pressures = self.pushed.solve(normal - self.across.transpose() * turned);
        let finite = pressures.iter().chain(slips.iter()).all(|x| x.is_finite());
        finite.then_some((pressures, slips))
    }
}

/// Where an edge's contact points lie, from −1 at its left end to 1 at its right.
const GAUSS: [f64; 2] = [-0.577_350_269_189_625_8, 0.577_350_269_189_625_8];

/// The nodes of a contact point's edge, by their numbers at the surface, and their shape functions at the point.
fn nodes_of(point: usize) -> [(usize, f64); 3] {
    let (first, x) = (point / 2 * 2, GAUSS[point % 2]);
    [
        (first, 0.5 * x * (x - 1.0)),
        (first + 1, 1.0 - x * x),
        (first + 2, 0.5 * x * (x + 1.0)),
    ]
}

/// Adds to the displacements from place `first` on what forces at places do, each with its place, by the compliance of all places.
struct Push<'a> {
    displacements: &'a mut [[f64; 2]],
    compliance: &'a Mat<f64>,
    first: usize,
    forces: &'a [(usize, [f64; 2])],
}

impl NullaryFnOnce for Push<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let displacements = self.displacements.as_flattened_mut();
        for (place, force) in self.forces {
            let column = |k| &self.compliance.col_as_slice(2 * place + k)[2 * self.first..];
            let columns = column(0).iter().zip(column(1));
            for (u, (x, y)) in displacements.iter_mut().zip(columns) {
                *u = force[0].mul_add(*x, force[1].mul_add(*y, *u));
            }
        }
    }
}

impl Surface {
    /// The surface of a mesh whose nodes there have the compliance `of_nodes`.
    pub(super) fn new(mesh: &Mesh, of_nodes: Mat<f64>, probe: Probe, contact: Contact) -> Surface {
        let (mut positions, mut lengths) = (Vec::new(), Vec::new());
        for edge in mesh.surface.windows(3).step_by(2) {
            let [left, right] = [edge[0], edge[2]].map(|node| mesh.nodes[node][0]);
            for x in GAUSS {
                positions.push([0.5 * (left + right) + x * (0.5 * (right - left)), 0.0]);
                lengths.push(0.5 * (right - left));
            }
        }
        let size = 2 * positions.len();
        let mut compliance = Mat::<f64>::zeros(size, size);
        for place in 0..size {
            let [a, b, c] = nodes_of(place / 2)
                .map(|(node, n)| (n, of_nodes.col_as_slice(2 * node + place % 2)));
            let pushed = a.1.iter().zip(b.1).zip(c.1);
            let pushed: Vec<f64> =
                (pushed.map(|((x, y), z)| a.0 * x + b.0 * y + c.0 * z)).collect();
            let below = compliance.col_as_slice_mut(place).iter_mut().enumerate();
            for (row, u) in below.skip(place) {
                let [a, b, c] = nodes_of(row / 2).map(|(node, n)| n * pushed[2 * node + row % 2]);
                *u = a + b + c;
            }
        }
        if mesh.symmetric {
            // The mean with the mirror image, whose places run the other way.
            let image = |place: usize| size - 2 - 2 * (place / 2) + place % 2;
            for column in 0..size {
                for row in column..size {
                    let ends = [image(row), image(column)];
                    let mirrored = (ends[0].max(ends[1]), ends[0].min(ends[1]));
                    if (column, row) <= (mirrored.1, mirrored.0) {
                        let sign = if row % 2 == column % 2 { 1.0 } else { -1.0 };
                        let mean = 0.5 * (compliance[(row, column)] + sign * compliance[mirrored]);
                        compliance[(row, column)] = mean;
                        compliance[mirrored] = sign * mean;
                    }
                }
            }
        }
        reflect(&mut compliance);
        Surface {
            positions,
            lengths,
            compliance,
            of_nodes,
            probe,
            contact,
        }
    }

    /// Displacement of each node at the surface, m, and the force on it, N.
    pub(super) fn at_nodes(
        &self,
        state: &ContactState,
        pose: Pose,
    ) -> (Vec<[f64; 2]>, Vec<[f64; 2]>) {
        let nodes = self.of_nodes.ncols() / 2;
        let mut forces = vec![[0.0; 2]; nodes];
        for (point, force) in self.forces(state, pose) {
            for (node, n) in nodes_of(point) {
                for direction in 0..2 {
                    forces[node][direction] += n * force[direction];
                }
            }
        }
        let loads = forces.iter().copied().enumerate();
        let loads: Vec<_> = loads.filter(|(_, force)| *force != [0.0; 2]).collect();
        let mut displacements = vec![[0.0; 2]; nodes];
        Arch::new().dispatch(Push {
            displacements: &mut displacements,
            compliance: &self.of_nodes,
            first: 0,
            forces: &loads,
        });
        (displacements, forces)
    }

    /// The gap of a point displaced by `u`, its slope and how that turns; `None` where the circle has none.
    fn constraint(&self, point: usize, u: [f64; 2], pose: Pose) -> Option<Constraint> {
        let radius = self.probe.radius;
        let centre = Vector2::new(pose.lateral, radius - pose.depth);
        let arm = Vector2::from(self.positions[point]) + Vector2::from(u) - centre;
        match self.contact {
            Contact::DeformedNormal => {
                let r = libm::sqrt(arm.dot(&arm));
                (r > 0.0).then_some(Constraint {
                    gap: r - radius,
                    normal: arm / r,
                    curvature: 1.0 / r,
                })
            }
            Contact::VerticalGap => {
                let x = self.positions[point][0] - centre.x;
                let square = radius * radius - x * x;
                (square > 0.0).then_some(Constraint {
                    gap: -libm::sqrt(square) - arm.y,
                    normal: Vector2::new(0.0, -1.0),
                    curvature: 0.0,
                })
            }
        }
    }

    /// Contact at `pose`, starting from the state of a pose nearby.
    ///
    /// # Errors
    /// [`FemError::NoConvergence`], which names the pose.
    ///
    /// Implements: FEM-009, FEM-011, FEM-060.
    pub fn solve(&self, pose: Pose, start: &ContactState) -> Result<ContactState, FemError> {
        let failed = |iterations| FemError::NoConvergence { pose, iterations };
        let mut state = start.clone();
        let mut reach = self.reach(&state, pose);
        let (mut kept, mut elastic, mut step) = (None, None, f64::INFINITY);
        for iteration in 0..MOST_ITERATIONS {
            let least = match iteration {
                0 => FIRST_TAKEN,
                1..SIMULTANEOUS_CHANGES => 0.0,
                _ => 1.0,
            };
            // Where the points in contact are foretold, forces come before the first look at them.
            let is_foretold = iteration == 0 && !state.active.is_empty();
            if is_foretold || self.revise(&mut state, pose, reach.clone(), least) {
                self.settle(&mut state, pose, reach.clone())
                    .ok_or(failed(iteration))?;
                (kept, elastic, step) = (None, None, f64::INFINITY);
                continue;
            }
            if step <= STEP_TOLERANCE {
                if reach.len() == self.positions.len() {
                    state.iterations = iteration;
                    return Ok(state);
                }
                reach = 0..self.positions.len();
            } else {
                // The old tangent serves as long as it lets the steps shrink well.
                let tangent = match kept.take() {
                    Some(tangent) => tangent,
                    None => self.tangent(&state, pose).ok_or(failed(iteration))?,
                };
                let before = step;
                let now = || self.response(&state, pose, reach.clone());
                let under_forces = elastic.take().unwrap_or_else(now);
                let moved = self.newton(&mut state, pose, &tangent, &under_forces);
                step = moved.ok_or(failed(iteration))?;
                kept = (step <= REUSE_BELOW * before).then_some(tangent);
            }
            let under_forces = self.response(&state, pose, reach.clone());
            // The points that are not in contact go where the forces move them.
            let before = std::mem::replace(&mut state.displacements, under_forces.clone());
            for &point in &state.active {
                state.displacements[point] = before[point];
            }
            elastic = Some(under_forces);
        }
        Err(failed(MOST_ITERATIONS))
    }

    /// The points that the probe may well touch: those below its chord at the undeformed surface, and those in contact.
    pub(super) fn reach(&self, state: &ContactState, pose: Pose) -> Range<usize> {
        let half = self.probe.half_width_at(pose.depth);
        let from = |x: f64| self.positions.partition_point(|position| position[0] < x);
        let (first, last) = (from(pose.lateral - half), from(pose.lateral + half));
        let [start, end] = [state.active.first(), state.active.last()];
        start.map_or(first, |&i| first.min(i))..end.map_or(last, |&i| last.max(i + 1))
    }

    /// While points come and go: forces along the present normals that bring the points in contact onto the probe, C_nn λ = n·u −
    /// gap, and the displacements under them. `None` if C_nn is singular or a point lies on the probe's axis.
    fn settle(&self, state: &mut ContactState, pose: Pose, reach: Range<usize>) -> Option<()> {
        let constraints = self.constraints(state, pose)?;
        let normals: Vec<Vector2<f64>> = constraints.iter().map(|c| c.normal).collect();
        let onto = |k: usize| {
            let u = Vector2::from(state.displacements[state.active[k]]);
            constraints[k].normal.dot(&u) - constraints[k].gap
        };
        let onto = Col::from_fn(constraints.len(), onto);
        let pressures = self.pushed(&state.active, &normals)?.solve(onto);
        for (&i, pressure) in state.active.iter().zip(pressures.iter()) {
            state.pressures[i] = *pressure;
        }
        state.displacements = self.response(state, pose, reach);
        Some(())
    }

    /// Displacements of the points in contact along one direction each, per force along another, m/N; on and below the diagonal, and
    /// where `whole`, above it.
    fn between(&self, active: &[usize], [of, by]: [&[Vector2<f64>]; 2], whole: bool) -> Mat<f64> {
        let mut compliance = Mat::zeros(active.len(), active.len());
        for (column, (&j, by)) in active.iter().zip(by).enumerate() {
            let [by_x, by_y] = [0, 1].map(|k| self.compliance.col_as_slice(2 * j + k));
            let u = |row| by_x[row] * by.x + by_y[row] * by.y;
            let first = if whole { 0 } else { column };
            let column = compliance.col_as_slice_mut(column)[first..].iter_mut();
            for ((to, &i), of) in column.zip(&active[first..]).zip(&of[first..]) {
                *to = of.x * u(2 * i) + of.y * u(2 * i + 1);
            }
        }
        compliance
    }

    /// The factor of C_nn; `None` where it is singular.
    fn pushed(&self, active: &[usize], normals: &[Vector2<f64>]) -> Option<Llt<f64>> {
        let compliance = self.between(active, [normals; 2], false);
        compliance.llt(Side::Lower).ok()
    }

    /// Newton's matrix at a state. `None` where it is singular or the contact unstable, or if a point lies on the probe's
    /// axis.
    ///
    /// Implements: FEM-022.
    fn tangent(&self, state: &ContactState, pose: Pose) -> Option<Tangent> {
        let m = state.active.len();
        let constraints = self.constraints(state, pose)?;
        let normal: Vec<Vector2<f64>> = constraints.iter().map(|c| c.normal).collect();
        let tangent: Vec<Vector2<f64>> = constraints.iter().map(Constraint::tangent).collect();
        let between = |of, by| self.between(&state.active, [of, by], true);
        let pushed = self.pushed(&state.active, &normal)?;
        let across = between(&tangent, &normal);
        let mut slid = between(&tangent, &tangent);
        let mut w = across.transpose().to_owned();
        solve_lower_triangular_in_place(pushed.L(), w.as_mut(), Par::Seq);
        slid -= w.transpose() * &w;
        let active = state.active.iter().zip(&constraints);
        let root = |(&i, c): (&usize, &Constraint)| libm::sqrt(state.pressures[i] * c.curvature);
        let roots: Vec<f64> = active.map(root).collect();
        let slip = Mat::from_fn(m, m, |a, b| {
            let unit = if a == b { 1.0 } else { 0.0 };
            unit - roots[a] * slid[(a, b)] * roots[b]
        });
        Some(Tangent {
            constraints,
            pushed,
            across,
            roots,
            slid,
            slip: slip.llt(Side::Lower).ok()?,
        })
    }

    fn constraints(&self, state: &ContactState, pose: Pose) -> Option<Vec<Constraint>> {
        let constraint = |&i: &usize| self.constraint(i, state.displacements[i], pose);
        state.active.iter().map(constraint).collect()
    }

    /// One Newton step on the points in contact, given the displacements of all points under the present forces; updates
    /// displacements and forces, and returns the largest displacement increment, m. `None` if it is not finite.
    fn newton(
        &self,
        state: &mut ContactState,
        pose: Pose,
        system: &Tangent,
        elastic: &[[f64; 2]],
    ) -> Option<f64> {
        let constraints = self.constraints(state, pose)?;
        let mismatch = |(&i, constraint): (&usize, &Constraint)| {
            let [u, elastic] = [state.displacements[i], elastic[i]].map(Vector2::from);
            u - constraint.gap * constraint.normal - elastic
        };
        let pairs = state.active.iter().zip(&constraints);
        let mismatch: Vec<Vector2<f64>> = pairs.clone().map(mismatch).collect();
        let (pressures, slips) = system.solve(&mismatch)?;
        let mut largest = 0.0f64;
        for (a, (&i, constraint)) in pairs.enumerate() {
            let step = slips[a] * constraint.tangent() - constraint.gap * constraint.normal;
            largest = largest.max(step.amax());
            state.displacements[i] = (Vector2::from(state.displacements[i]) + step).into();
            state.pressures[i] += pressures[a];
        }
        Some(largest)
    }

    /// Displacement of each point within reach under the present forces, of the others as they are, m.
    fn response(&self, state: &ContactState, pose: Pose, reach: Range<usize>) -> Vec<[f64; 2]> {
        let mut u = state.displacements.clone();
        u[reach.clone()].fill([0.0; 2]);
        Arch::new().dispatch(Push {
            displacements: &mut u[reach.clone()],
            compliance: &self.compliance,
            first: reach.start,
            forces: &self.forces(state, pose),
        });
        u
    }

    /// Drops points in contact that would be pulled and adds points inside the probe, of those within reach, if they are at
    /// least this part as bad as the worst. While the ends of the contact are pulled, points between them stay. Returns whether
    /// the set changed.
    fn revise(
        &self,
        state: &mut ContactState,
        pose: Pose,
        reach: Range<usize>,
        least: f64,
    ) -> bool {
        let mut active = state.active.iter().peekable();
        let violation = |i: usize| match active.next_if_eq(&&i) {
            // Pulls and penetrations are weighed against each other by the point's own compliance.
            Some(_) => state.pressures[i] * self.compliance[(2 * i + 1, 2 * i + 1)],
            None => self
                .constraint(i, state.displacements[i], pose)
                .map_or(0.0, |constraint| constraint.gap + GAP_TOLERANCE),
        };
        let mut violations: Vec<f64> = reach.clone().map(violation).collect();
        let is_pulled = |i: &&usize| state.pressures[**i] < 0.0;
        let left = state.active.iter().take_while(is_pulled).count();
        let right = state.active.iter().rev().take_while(is_pulled).count();
        if (1..state.active.len()).contains(&(left + right)) {
            for &i in &state.active[left..state.active.len() - right] {
                violations[i - reach.start] = 0.0;
            }
        }
        let worst = violations.iter().copied().fold(0.0, f64::min);
        let pulls = state.active.iter().map(|i| violations[i - reach.start]);
        let worst_pull = pulls.fold(0.0, f64::min);
        let is_large = |&(_, v): &(usize, f64)| v < 0.0 && v <= least * worst;
        for (i, violation) in reach.zip(violations).filter(is_large) {
            match state.active.binary_search(&i) {
                Ok(_) if violation > FIRST_DROPPED * worst_pull => {}
                Ok(at) => {
                    state.active.remove(at);
                    state.pressures[i] = 0.0;
                }
                Err(at) => state.active.insert(at, i),
            }
        }
        worst < 0.0
    }

    /// Force on the gel at each point in contact, N.
    pub fn forces(&self, state: &ContactState, pose: Pose) -> Vec<(usize, [f64; 2])> {
        let force = |&i: &usize| {
            let constraint = self.constraint(i, state.displacements[i], pose)?;
            Some((i, (constraint.normal * state.pressures[i]).into()))
        };
        state.active.iter().filter_map(force).collect()
    }

    /// Force on the probe, N: that on the gel reversed, or, for the vertical gap, the
    /// pressure on the circle's slope, so that F = −∂U/∂(x, y) of the probe in both cases.
    ///
    /// Implements: FEM-012, FEM-050, FEM-059, CON-004.
    pub(super) fn probe_force(&self, state: &ContactState, pose: Pose) -> Force<f64> {
        let mut total = Force::default();
        for (i, [x, y]) in self.forces(state, pose) {
            total.normal -= y;
            total.lateral -= match self.contact {
                Contact::DeformedNormal => x,
                Contact::VerticalGap => {
                    let offset = self.positions[i][0] - pose.lateral;
                    let radius = self.probe.radius;
                    -y * offset / libm::sqrt(radius * radius - offset * offset)
                }
            };
        }
        total
    }

    /// Largest penetration of any contact point, m.
    pub(super) fn penetration(&self, state: &ContactState, pose: Pose) -> f64 {
        let points = state.displacements.iter().enumerate();
        let gaps = points.filter_map(|(i, &u)| Some(self.constraint(i, u, pose)?.gap));
        gaps.map(|gap| -gap).fold(0.0, f64::max)
    }
}
