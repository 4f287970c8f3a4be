//! Frictionless unilateral contact of the rigid probe with the condensed surface.
//!
//! The surface's displacements are u = C f with C the surface compliance. Each surface node i obeys
//! gap_i ≥ 0, λ_i ≥ 0, λ_i gap_i = 0, and carries the force λ_i n_i. With the probe's true normal at the
//! deformed node, n turns with u: Newton's method needs the curvature term λ (I − n nᵀ)/r.

use core::ops::Range;

use super::dense::SquareMatrix;
use super::front::{Front, TILE, substitute_back_one, substitute_forward};
use super::{FemError, Pose};
use crate::phantom::Probe;

/// How the gap between a surface node and the probe is measured.
///
/// ```
/// use palpate::fem::Contact;
///
/// assert_eq!(Contact::default(), Contact::DeformedNormal);
/// assert_eq!(Contact::VerticalGap.name(), "vertical-gap");
/// ```
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
    ///
    /// ```
    /// assert_eq!(palpate::fem::Contact::default().name(), "deformed-normal");
    /// ```
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
/// ```
#[doc = include_str!("coarse.example")]
/// use palpate::fem::ContactState;
///
/// let surface = model.surface();
/// let untouched = ContactState::untouched(surface.positions.len());
/// let state = surface.solve(pose, &untouched)?;
/// // What pushes on the gel pushes back on the probe.
/// let down: f64 = surface.nodal_forces(&state, pose).iter().map(|(_, [_, y])| y).sum();
/// assert!((down + model.solve(pose)?.normal_force).abs() < 1e-9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// Implements: FEM-009.
#[derive(Debug, Clone)]
pub struct Surface {
    /// Undeformed position of each free surface node, m.
    pub positions: Vec<[f64; 2]>,
    /// Displacements per force, m/N, both components of each node in turn; symmetric.
    pub compliance: SquareMatrix,
    /// The probe.
    pub probe: Probe,
    /// How the gap is measured.
    pub contact: Contact,
}

/// Surface displacements and contact forces at one pose.
///
/// ```
#[doc = include_str!("coarse.example")]
/// let state = model.solve(pose)?.state;
/// // Pressed where there is contact, and nowhere else.
/// for (node, &pressure) in state.pressures.iter().enumerate() {
///     assert_eq!(pressure > 0.0, state.active.contains(&node));
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
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
    ///
    /// ```
    /// use palpate::fem::ContactState;
    ///
    /// let state = ContactState::untouched(3);
    /// assert_eq!((state.pressures, state.active), (vec![0.0; 3], vec![]));
    /// ```
    pub fn untouched(nodes: usize) -> ContactState {
        ContactState {
            displacements: vec![[0.0; 2]; nodes],
            pressures: vec![0.0; nodes],
            active: Vec::new(),
            iterations: 0,
        }
    }

    /// Moves the nodes of a range that are not in contact to where the forces move them.
    fn follow(&mut self, elastic: &[[f64; 2]], nodes: Range<usize>) {
        let mut active = self.active.iter().copied().peekable();
        for (i, elastic) in nodes.zip(elastic) {
            while active.next_if(|&node| node < i).is_some() {}
            if active.peek() != Some(&i) {
                self.displacements[i] = *elastic;
            }
        }
    }

    /// Where the state goes if it keeps changing as it did since `earlier`, `ahead` times as far.
    ///
    /// ```
    /// use palpate::fem::ContactState;
    ///
    /// let earlier = ContactState::untouched(1);
    /// let later = ContactState { displacements: vec![[0.0, -1e-3]], ..earlier.clone() };
    /// assert_eq!(later.extrapolated(&earlier, 1.0).displacements, [[0.0, -2e-3]]);
    /// ```
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
    /// L in its panels, below it Wᵀ or, without turning, C_tn; Q in its update.
    front: Front,
    /// `None` for normals that are taken not to turn.
    turning: Option<Turning>,
}

/// The part of Newton's matrix that turns the normals.
#[derive(Debug)]
struct Turning {
    /// The diagonal of D.
    rates: Vec<f64>,
    /// Factor of I − D^½ Q D^½.
    slip: Front,
}

impl TangentSystem {
    /// Increments of λ, and slips, that mend the mismatch u − C (n λ) of the active nodes, m. `None` if an
    /// increment is not finite.
    fn solve(&self, mismatch: &[[f64; 2]]) -> Option<(Vec<f64>, Vec<f64>)> {
        let (m, own) = (mismatch.len(), self.front.own);
        let mut x = vec![[0.0]; own + self.front.border];
        let mut slips = vec![0.0; m];
        for (k, (&n, &u)) in self.normals.iter().zip(mismatch).enumerate() {
            x[k] = [dot(n, u)];
            slips[k] = -dot(tangent(n), u);
        }
        match &self.turning {
            None => {
                substitute_forward(&self.front.panels, own, &mut x[..own]);
                let lower = &self.front.panels[..own * own / TILE];
                substitute_back_one(lower, own, &mut x[..own]);
                self.front.add_border_product(&x[..own], &mut slips);
            }
            Some(turning) => {
                // Leaves L⁻¹ r_n in the own rows, −C_tn C_nn⁻¹ r_n in the others.
                substitute_forward(&self.front.panels, own, &mut x);
                for (slip, [x]) in slips.iter_mut().zip(&x[own..]) {
                    *slip -= x;
                }
                turning.solve(&self.front, &mut slips);
                for (k, slip) in slips.iter().enumerate() {
                    x[own + k] = [turning.rates[k] * slip];
                }
                substitute_back_one(&self.front.panels, own, &mut x);
            }
        }
        let pressures: Vec<f64> = x[..m].iter().map(|[p]| *p).collect();
        let finite = pressures.iter().chain(&slips).all(|x| x.is_finite());
        finite.then_some((pressures, slips))
    }
}

impl Turning {
    /// From Q, in the front's update, and D.
    fn new(front: &Front, rates: Vec<f64>) -> Option<Turning> {
        let m = rates.len();
        let roots: Vec<f64> = rates.iter().map(|&rate| libm::sqrt(rate)).collect();
        let mut slip = Front::new(m, 0);
        for a in 0..m {
            for b in 0..=a {
                let unit = if a == b { 1.0 } else { 0.0 };
                let q = front.update[a / TILE * front.border + b][a % TILE];
                *slip.entry(a, b) = unit - roots[a] * q * roots[b];
            }
        }
        slip.pad_diagonal(m);
        slip.factorise().ok()?;
        Some(Turning { rates, slip })
    }

    /// Solves (I − Q D) b = r in place: b = r + Q D^½ (I − D^½ Q D^½)⁻¹ D^½ r.
    fn solve(&self, front: &Front, slips: &mut [f64]) {
        let own = self.slip.own;
        let root = |k: usize| libm::sqrt(self.rates[k]);
        let mut scaled = vec![[0.0]; own];
        for (k, slip) in slips.iter().enumerate() {
            scaled[k] = [root(k) * slip];
        }
        substitute_forward(&self.slip.panels, own, &mut scaled);
        substitute_back_one(&self.slip.panels, own, &mut scaled);
        for k in 0..slips.len() {
            scaled[k][0] *= root(k);
        }
        front.add_update_product(&scaled, slips);
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
    /// A surface with that compliance.
    pub(super) fn new(
        compliance: SquareMatrix,
        positions: Vec<[f64; 2]>,
        probe: Probe,
        contact: Contact,
    ) -> Surface {
        Surface {
            positions,
            compliance,
            probe,
            contact,
        }
    }

    /// The gap of a node displaced by `u`, its slope and how that turns; `None` where the circle has none.
    ///
    /// Implements: FEM-022.
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

    /// The 2 × 2 block of the compliance between nodes `i` and `j`: `[r][c]` moves i along r per force along c.
    fn block(&self, i: usize, j: usize) -> [[f64; 2]; 2] {
        let at = |row: usize, column: usize| self.compliance[(row, column)];
        [
            [at(2 * i, 2 * j), at(2 * i, 2 * j + 1)],
            [at(2 * i + 1, 2 * j), at(2 * i + 1, 2 * j + 1)],
        ]
    }

    /// Contact at `pose`, starting from the state of a pose nearby.
    ///
    /// ```
    #[doc = include_str!("coarse.example")]
    /// use palpate::fem::ContactState;
    ///
    /// let untouched = ContactState::untouched(model.surface().positions.len());
    /// let above = model.surface().solve(pose, &untouched)?;
    /// // From there, half a millimetre deeper takes more nodes into contact.
    /// let deeper = model.surface().solve(Pose { depth: 2.5e-3, ..pose }, &above)?;
    /// assert!(deeper.active.len() > above.active.len());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// Implements: FEM-009, FEM-010, FEM-011, FEM-060.
    ///
    /// # Errors
    /// [`FemError::NoConvergence`], which names the pose.
    pub fn solve(&self, pose: Pose, start: &ContactState) -> Result<ContactState, FemError> {
        let failed = |iterations| FemError::NoConvergence { pose, iterations };
        let everywhere = 0..self.positions.len();
        let mut state = start.clone();
        self.revise(&mut state, pose, everywhere.clone(), usize::MAX);
        // Nodes far from the probe are moved at the end alone, and examined then.
        let mut window = self.window(&state, pose);
        let mut elastic = self
            .response(&state, pose, window.clone())
            .ok_or(failed(0))?;
        let mut tangent_system: Option<TangentSystem> = None;
        let mut last_step = f64::INFINITY;
        // While nodes come and go, normals that do not turn will do: the full system is the cost.
        let mut settled = state.active == start.active;
        for iteration in 0..MOST_ITERATIONS {
            // The old tangent serves as long as it lets the steps shrink well.
            let system = match tangent_system.take() {
                Some(system) if system.active == state.active => system,
                _ => self
                    .tangent_system(&state, pose, settled)
                    .ok_or(failed(iteration))?,
            };
            let step = self
                .newton(&mut state, pose, &system, &elastic, window.start)
                .ok_or(failed(iteration))?;
            elastic = self
                .response(&state, pose, window.clone())
                .ok_or(failed(iteration))?;
            state.follow(&elastic, window.clone());
            let at_most = if iteration < SIMULTANEOUS_CHANGES {
                usize::MAX
            } else {
                1
            };
            let mut changed = self.revise(&mut state, pose, window.clone(), at_most);
            if !changed && step <= STEP_TOLERANCE {
                let whole = self
                    .response(&state, pose, everywhere.clone())
                    .ok_or(failed(iteration))?;
                state.follow(&whole, everywhere.clone());
                changed = self.revise(&mut state, pose, everywhere.clone(), at_most);
                if !changed {
                    state.iterations = iteration + 1;
                    return Ok(state);
                }
                window = everywhere.clone();
            }
            if changed {
                elastic = self
                    .response(&state, pose, window.clone())
                    .ok_or(failed(iteration))?;
            }
            settled = !changed;
            let full = system.turning.is_some();
            (tangent_system, last_step) = if full && step <= REUSE_BELOW * last_step {
                (Some(system), step)
            } else {
                (None, f64::INFINITY)
            };
        }
        Err(failed(MOST_ITERATIONS))
    }

    /// The nodes under the probe's part below the undeformed surface and as much again on either side, and all
    /// active ones.
    fn window(&self, state: &ContactState, pose: Pose) -> Range<usize> {
        let reach = 2.0 * libm::sqrt(2.0 * self.probe.radius * pose.depth);
        let first = self
            .positions
            .partition_point(|[x, _]| *x < pose.lateral - reach);
        let last = self
            .positions
            .partition_point(|[x, _]| *x <= pose.lateral + reach);
        let active = (state.active.first(), state.active.last());
        match active {
            (Some(&low), Some(&high)) => first.min(low)..last.max(high + 1),
            _ => first..last,
        }
    }

    /// Factorises the system for increments of λ and of each node's slip b along its tangent t. With
    /// δu = −gap n + b t, u = C (n λ) linearised and projected on n and t reads
    ///
    /// C_nn δλ + C_nt D b = r_n, C_tn δλ + (C_tt D − I) b = r_t, D = diag(λ κ).
    ///
    /// Eliminating δλ by Cholesky's factor L of C_nn leaves (I − Q D) b = C_tn C_nn⁻¹ r_n − r_t with
    /// Q = C_tt − WᵀW, W = L⁻¹ C_nt. With D^½ on both sides it is symmetric, and positive definite where the
    /// contact is stable. Unless the normals are to be `turning`, D is taken as 0, which costs an eighth. `None`
    /// where the system is singular or unstable, or if a node lies on the probe's axis.
    ///
    /// Implements: FEM-022.
    fn tangent_system(
        &self,
        state: &ContactState,
        pose: Pose,
        turning: bool,
    ) -> Option<TangentSystem> {
        let m = state.active.len();
        let constraints = self.constraints(state, pose)?;
        let mut front = Front::new(m, m);
        let own = front.own;
        for (b, (&j, constraint)) in state.active.iter().zip(&constraints).enumerate() {
            let directions = [constraint.normal, tangent(constraint.normal)];
            for (a, (&i, constraint)) in state.active.iter().zip(&constraints).enumerate() {
                let [n, t] = [constraint.normal, tangent(constraint.normal)];
                let block = self.block(i, j);
                let [pushed, slid] = directions.map(|v| block.map(|row| dot(row, v)));
                *front.entry(own + a, b) = dot(t, pushed);
                if a >= b {
                    *front.entry(a, b) = dot(n, pushed);
                    if turning {
                        *front.entry(own + a, own + b) = dot(t, slid);
                    }
                }
            }
        }
        front.pad_diagonal(m);
        let rates = state
            .active
            .iter()
            .zip(&constraints)
            .map(|(&j, constraint)| state.pressures[j] * constraint.curvature)
            .collect();
        let turning = if turning {
            front.eliminate(|_| 0).ok()?;
            Some(Turning::new(&front, rates)?)
        } else {
            front.factorise().ok()?;
            None
        };
        let normals = constraints.iter().map(|constraint| constraint.normal);
        Some(TangentSystem {
            active: state.active.clone(),
            normals: normals.collect(),
            front,
            turning,
        })
    }

    fn constraints(&self, state: &ContactState, pose: Pose) -> Option<Vec<Constraint>> {
        state
            .active
            .iter()
            .map(|&i| self.constraint(i, state.displacements[i], pose))
            .collect()
    }

    /// One Newton step on the active nodes, given the displacements `elastic` of the nodes from `first` on under
    /// the present forces; updates displacements and pressures, and returns the largest displacement
    /// increment, m. `None` if it is not finite.
    fn newton(
        &self,
        state: &mut ContactState,
        pose: Pose,
        system: &TangentSystem,
        elastic: &[[f64; 2]],
        first: usize,
    ) -> Option<f64> {
        let constraints = self.constraints(state, pose)?;
        let mismatch = |(&i, constraint): (&usize, &Constraint)| {
            [0, 1].map(|d| {
                state.displacements[i][d]
                    - constraint.gap * constraint.normal[d]
                    - elastic[i - first][d]
            })
        };
        let mismatch: Vec<[f64; 2]> = state
            .active
            .iter()
            .zip(&constraints)
            .map(mismatch)
            .collect();
        let (pressures, slips) = system.solve(&mismatch)?;
        let mut largest = 0.0f64;
        for (a, (&i, constraint)) in state.active.iter().zip(&constraints).enumerate() {
            state.pressures[i] += pressures[a];
            let t = tangent(constraint.normal);
            for d in 0..2 {
                let step = slips[a] * t[d] - constraint.gap * constraint.normal[d];
                largest = largest.max(step.abs());
                state.displacements[i][d] += step;
            }
        }
        Some(largest)
    }

    /// Displacements of some nodes under the present forces.
    fn response(
        &self,
        state: &ContactState,
        pose: Pose,
        nodes: Range<usize>,
    ) -> Option<Vec<[f64; 2]>> {
        let mut u = vec![[0.0; 2]; nodes.len()];
        let unknowns = self.compliance.order();
        let columns = self.compliance.as_slice();
        for &j in &state.active {
            let n = self.constraint(j, state.displacements[j], pose)?.normal;
            let [x, y] = n.map(|n| n * state.pressures[j]);
            let column = |direction: usize| {
                let start = (2 * j + direction) * unknowns;
                let rows = &columns[start + 2 * nodes.start..start + 2 * nodes.end];
                rows.as_chunks::<2>().0
            };
            for ((u, by_x), by_y) in u.iter_mut().zip(column(0)).zip(column(1)) {
                for d in 0..2 {
                    u[d] += x * by_x[d] + y * by_y[d];
                }
            }
        }
        Some(u)
    }

    /// Drops active nodes that would be pulled and adds nodes inside the probe, of those in `nodes`: all at
    /// once, or the `at_most` worst. Returns whether the set changed.
    fn revise(
        &self,
        state: &mut ContactState,
        pose: Pose,
        nodes: Range<usize>,
        at_most: usize,
    ) -> bool {
        let mut violations: Vec<(f64, usize)> = Vec::new();
        let mut active = state.active.iter().copied().peekable();
        for i in nodes {
            while active.next_if(|&node| node < i).is_some() {}
            // Pulls and penetrations are weighed against each other by the node's own compliance.
            let violation = if active.peek() == Some(&i) {
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
    ///
    /// ```
    #[doc = include_str!("coarse.example")]
    /// let solution = model.solve(pose)?;
    /// for (node, [_, y]) in model.surface().nodal_forces(&solution.state, pose) {
    ///     assert!(solution.state.active.contains(&node) && y < 0.0); // into the gel
    /// }
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
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
    /// Implements: FEM-012, FEM-057, FEM-059, CON-004.
    pub(super) fn probe_force(&self, state: &ContactState, pose: Pose) -> [f64; 2] {
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
    pub(super) fn penetration(&self, state: &ContactState, pose: Pose) -> f64 {
        let gap = |i: usize| {
            self.constraint(i, state.displacements[i], pose)
                .map_or(0.0, |c| c.gap)
        };
        (0..self.positions.len())
            .map(|i| -gap(i))
            .fold(0.0, f64::max)
    }
}
