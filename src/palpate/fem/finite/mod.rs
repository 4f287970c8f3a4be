//! The force on the probe at finite strain, with and without friction (`spec/finite-strain.md`).
//!
//! | file | content |
//! |---|---|
//! | `mod.rs` | a gel at finite strain, led from pose to pose |
//! | `law.rs` | the material, and an element made of it |
//! | `system.rs` | unknowns, equations, and the tangent condensed to the nodes under the probe |
//! | `contact.rs` | contact and friction of those nodes |

mod contact;
mod law;
mod system;
#[cfg(test)]
mod tests;

use std::ops::Range;

use nalgebra::Vector2;

use self::contact::Patch;
use self::system::{Equations, System};
use super::cholesky::RESIDUAL_LIMIT;
use super::field::FieldCheck;
use super::mesh::Mesh;
use super::{FemError, Pose};
use crate::force::Force;
use crate::phantom::Phantom;

pub(super) use contact::Place;
pub use contact::{Friction, Touch};
pub use law::name as law_of;

/// Longest way from one pose to the next, over the probe's radius.
const STEP: f64 = 0.16;
/// How often a step that fails is halved.
const HALVINGS: u32 = 6;
/// Newton's iterations for one step.
const MOST_ITERATIONS: usize = 20;
/// The largest force out of balance, over the force of the contact, and N.
const BALANCE: [f64; 2] = [1e-9, 1e-11];
/// Nodes so much farther out than the probe's edge, over its radius, count among those under it.
const MARGIN: f64 = 0.15;
/// A gel of which some point keeps less than this part of its area is refused.
pub const LEAST_DET: f64 = 0.05;

/// A phantom at finite strain.
///
/// Implements: FIN-006.
#[derive(Debug, Clone)]
pub struct FiniteModel {
    phantom: Phantom,
    mesh: Mesh,
    friction: Friction,
    system: System,
}

/// The gel at rest under the probe at finite strain.
#[derive(Debug, Clone, PartialEq)]
pub struct Equilibrium {
    /// The pose.
    pub pose: Pose,
    /// Force on the probe, N.
    pub force: Force<f64>,
    /// Stored energy, J.
    pub energy: f64,
    /// Largest depth of a surface node inside the probe, m.
    pub penetration: f64,
    /// The checks of the field: forces out of balance over those of the contact, the balance of probe, floor and walls, and the
    /// smallest J.
    pub check: FieldCheck,
    /// Newton's iterations since the pose before.
    pub iterations: usize,
    /// How each node at the surface touches the probe.
    pub touches: Vec<Touch>,
    /// The force on the gel at each node at the surface, N.
    pub forces: Vec<[f64; 2]>,
    /// Displacement of each node of the mesh, m.
    pub displacements: Vec<[f64; 2]>,
    state: Vec<f64>,
}

/// The gel between two of Newton's iterations.
#[derive(Clone)]
struct Trial {
    state: Vec<f64>,
    equations: Equations,
    /// As in [`Equilibrium`].
    touches: Vec<Touch>,
    /// The force on the gel at each node at the surface, N.
    forces: Vec<[f64; 2]>,
    /// Where each node at the surface was on the probe before the step: its arc from the probe's lowest point, m.
    arcs: Vec<f64>,
}

impl FiniteModel {
    /// A meshed phantom.
    ///
    /// # Errors
    /// [`FemError::Refused`] if an element is turned inside out; [`FemError::OutOfMemory`].
    pub fn new(
        phantom: &Phantom,
        mesh: &Mesh,
        friction: Friction,
    ) -> Result<FiniteModel, FemError> {
        Ok(FiniteModel {
            phantom: phantom.clone(),
            mesh: mesh.clone(),
            friction,
            system: System::new(mesh, phantom)?,
        })
    }

    /// The gel before the probe touches it, with the probe above `lateral`, m.
    pub fn untouched(&self, lateral: f64) -> Equilibrium {
        let surface = self.mesh.surface.len();
        Equilibrium {
            pose: Pose {
                depth: 0.0,
                lateral,
            },
            force: Force::default(),
            energy: 0.0,
            penetration: 0.0,
            check: FieldCheck {
                residual: 0.0,
                imbalance: 0.0,
                min_det: 1.0,
            },
            iterations: 0,
            touches: vec![Touch::Apart; surface],
            forces: vec![[0.0; 2]; surface],
            displacements: vec![[0.0; 2]; self.mesh.nodes.len()],
            state: vec![0.0; self.system.unknowns()],
        }
    }

    /// Cauchy stress (σ_xx, σ_yy, σ_zz, σ_xy), Pa, at a sampling point of an element, under the displacement gradient there.
    pub(super) fn stress(
        &self,
        equilibrium: &Equilibrium,
        element: usize,
        at: [f64; 2],
        gradient: [[f64; 2]; 2],
    ) -> [f64; 4] {
        self.system
            .stress(&equilibrium.state, element, at, gradient)
    }

    /// The same gel under a probe whose nodes stick and slip as the path leads them.
    pub fn along_path(&self) -> FiniteModel {
        let friction = match self.friction {
            Friction::Steady(mu) => Friction::Path(mu),
            other => other,
        };
        FiniteModel {
            friction,
            ..self.clone()
        }
    }

    /// Leads the probe from pose to pose.
    ///
    /// # Errors
    /// As [`FiniteModel::lead`].
    pub fn path(&self, from: Equilibrium, poses: &[Pose]) -> Result<Vec<Equilibrium>, FemError> {
        let mut solved: Vec<Equilibrium> = Vec::with_capacity(poses.len());
        for &pose in poses {
            let next = match &solved[..] {
                [] => self.lead(&from, None, pose)?,
                [first] => self.lead(first, Some(&from), pose)?,
                [.., before, now] => self.lead(now, Some(before), pose)?,
            };
            solved.push(next);
        }
        Ok(solved)
    }

    /// Leads the probe along a straight line from one pose to another, in steps that halve where they fail.
    ///
    /// # Errors
    /// [`FemError::Pose`] where the probe cannot stand; [`FemError::NoConvergence`].
    pub fn lead(
        &self,
        from: &Equilibrium,
        earlier: Option<&Equilibrium>,
        to: Pose,
    ) -> Result<Equilibrium, FemError> {
        let checked = self.phantom.check_pose(to.depth, to.lateral);
        checked.map_err(|refusal| FemError::Pose(refusal.into()))?;
        let (start, way) = (from.pose, distance(from.pose, to));
        let longest = STEP * self.phantom.probe().radius;
        let parts = libm::ceil(way / longest - 1e-9).max(1.0);
        let (mut reached, mut part) = (0.0, 1.0 / parts);
        let shortest = part / f64::from(1u32 << HALVINGS);
        let (mut now, mut before, mut iterations) = (from.clone(), earlier.cloned(), 0);
        while reached < 1.0 {
            let next = if 1.0 - reached < 1.5 * part {
                1.0
            } else {
                reached + part
            };
            let on = |from: f64, to: f64| {
                if next == 1.0 {
                    to
                } else {
                    from + next * (to - from)
                }
            };
            let pose = Pose {
                depth: on(start.depth, to.depth),
                lateral: on(start.lateral, to.lateral),
            };
            match self.step(&now, before.as_ref(), pose)? {
                Ok(solved) => {
                    iterations += solved.iterations;
                    before = Some(std::mem::replace(&mut now, solved));
                    reached = next;
                }
                Err(spent) if part <= shortest => {
                    let iterations = iterations + spent;
                    return Err(FemError::NoConvergence { pose, iterations });
                }
                Err(spent) => {
                    iterations += spent;
                    part = 0.5 * (next - reached);
                }
            }
        }
        now.iterations = iterations;
        Ok(now)
    }

    /// One step from `now` to `pose`: from where the gel goes if it keeps moving as it did since `before`, else from where it is.
    fn step(
        &self,
        now: &Equilibrium,
        before: Option<&Equilibrium>,
        pose: Pose,
    ) -> Result<Result<Equilibrium, usize>, FemError> {
        let ahead = before.and_then(|before| {
            let [past, next] = [[before.pose, now.pose], [now.pose, pose]]
                .map(|[a, b]| Vector2::new(b.lateral - a.lateral, b.depth - a.depth));
            let straight = past.dot(&next) / libm::sqrt(past.dot(&past) * next.dot(&next));
            let ahead = libm::sqrt(next.dot(&next) / past.dot(&past));
            (before.pose.depth > 0.0 && straight > 0.99 && ahead <= 2.0).then(|| {
                let on = |(now, then): (&f64, &f64)| now + ahead * (now - then);
                now.state
                    .iter()
                    .zip(&before.state)
                    .map(on)
                    .collect::<Vec<f64>>()
            })
        });
        let mut spent = 0;
        if let Some(state) = ahead {
            match self.solve(now, state, pose)? {
                Ok(solved) => return Ok(Ok(solved)),
                Err(iterations) => spent = iterations,
            }
        }
        let solved = self.solve(now, now.state.clone(), pose)?;
        Ok(solved.map_err(|iterations| iterations + spent))
    }

    /// Newton's iterations at one pose, from `state`. The number of iterations where they lead nowhere.
    ///
    /// Implements: FIN-007.
    fn solve(
        &self,
        from: &Equilibrium,
        state: Vec<f64>,
        pose: Pose,
    ) -> Result<Result<Equilibrium, usize>, FemError> {
        let Some(mut trial) = self.trial(from, state) else {
            return Ok(Err(0));
        };
        for iteration in 0..MOST_ITERATIONS {
            let (out, contact) = self.out_of_balance(&trial.equations, &trial.forces);
            let is_balanced = out <= BALANCE[0] * contact + BALANCE[1];
            // 1e-11 N is much of a light contact; of the lightest, so is rounding.
            let is_last = iteration + 1 == MOST_ITERATIONS;
            let is_exact = is_last || relative(out, contact) <= RESIDUAL_LIMIT;
            if iteration > 0 && is_balanced && is_exact {
                return Ok(self.accept(pose, trial, iteration).ok_or(iteration));
            }
            let balanced = (iteration > 0 && is_balanced).then(|| trial.clone());
            match (self.iterate(trial, pose)?, balanced) {
                (Some(next), _) => trial = next,
                (None, Some(last)) => {
                    return Ok(self.accept(pose, last, iteration).ok_or(iteration));
                }
                (None, None) => return Ok(Err(iteration)),
            }
        }
        Ok(Err(MOST_ITERATIONS))
    }

    /// Where the iterations begin: at `state`, touched as the pose before is.
    fn trial(&self, from: &Equilibrium, state: Vec<f64>) -> Option<Trial> {
        let places = self.places(&from.state, from.pose);
        Some(Trial {
            equations: self.system.equations(&state)?,
            state,
            touches: from.touches.clone(),
            forces: from.forces.clone(),
            arcs: places.iter().map(|place| place.arc).collect(),
        })
    }

    /// One of Newton's iterations; `None` where it leads nowhere.
    fn iterate(&self, trial: Trial, pose: Pose) -> Result<Option<Trial>, FemError> {
        let Trial {
            mut state,
            equations,
            mut touches,
            mut forces,
            arcs,
        } = trial;
        let under = self.under(&state, pose);
        let Some(first) = self.system.unknown(self.mesh.surface[under.start], 0) else {
            return Ok(None);
        };
        let unknowns = first..first + 2 * under.len();
        let Some(condensed) = self.system.condense(&equations, unknowns.clone())? else {
            return Ok(None);
        };
        let position = |&node: &usize| self.mesh.nodes[node];
        let positions: Vec<[f64; 2]> = self.mesh.surface[under.clone()]
            .iter()
            .map(position)
            .collect();
        let patch = Patch {
            pose,
            radius: self.phantom.probe().radius,
            friction: self.friction,
            positions: &positions,
            displacements: &state[unknowns.clone()],
            forces: &condensed.forces,
            stiffness: &condensed.stiffness,
            arcs: &arcs[under.clone()],
        };
        let Some(settled) = patch.settle(&touches[under.clone()]) else {
            return Ok(None);
        };
        let moved = settled.displacements.iter().zip(&state[unknowns]);
        let moved: Vec<f64> = moved.map(|(to, from)| to - from).collect();
        let changes = condensed.changes(&equations, &moved, &settled.forces)?;
        touches.fill(Touch::Apart);
        forces.fill([0.0; 2]);
        touches[under.clone()].copy_from_slice(&settled.touches);
        forces[under].copy_from_slice(settled.forces.as_chunks().0);
        let equations = self.admissible(&mut state, &changes);
        Ok(equations.map(|equations| Trial {
            state,
            equations,
            touches,
            forces,
            arcs,
        }))
    }

    /// Adds the changes to the state, halved until no element is turned inside out.
    fn admissible(&self, state: &mut Vec<f64>, changes: &[f64]) -> Option<Equations> {
        let mut part = 1.0;
        for _ in 0..HALVINGS {
            let next = state.iter().zip(changes).map(|(z, dz)| z + part * dz);
            let next: Vec<f64> = next.collect();
            if let Some(equations) = self.system.equations(&next) {
                *state = next;
                return Some(equations);
            }
            part *= 0.5;
        }
        None
    }

    /// The largest force that nothing balances, and the sum of the contact's forces, N.
    fn out_of_balance(&self, equations: &Equations, pushed: &[[f64; 2]]) -> (f64, f64) {
        let mut rest = equations.forces.clone();
        let mut contact = 0.0;
        for (&node, force) in self.mesh.surface.iter().zip(pushed) {
            contact += libm::sqrt(force[0] * force[0] + force[1] * force[1]);
            for (k, force) in force.iter().enumerate() {
                if let Some(unknown) = self.system.unknown(node, k) {
                    rest[unknown] -= force;
                }
            }
        }
        (
            rest.iter()
                .fold(0.0, |largest: f64, force| largest.max(force.abs())),
            contact,
        )
    }

    fn places(&self, state: &[f64], pose: Pose) -> Vec<Place> {
        let radius = self.phantom.probe().radius;
        let place = |&node: &usize| {
            let u = self.system.displacement(state, node);
            Place::new(
                Vector2::from(self.mesh.nodes[node]) + Vector2::from(u),
                pose,
                radius,
            )
        };
        self.mesh.surface.iter().map(place).collect()
    }

    /// The nodes at the surface that the probe may touch.
    fn under(&self, state: &[f64], pose: Pose) -> Range<usize> {
        let radius = self.phantom.probe().radius;
        let reach = self.phantom.probe().half_width_at(pose.depth) + MARGIN * radius;
        let is_under = |&at: &usize| {
            let node = self.mesh.surface[at];
            let x = self.mesh.nodes[node][0];
            let moved = x + self.system.displacement(state, node)[0];
            (x - pose.lateral).abs() <= reach || (moved - pose.lateral).abs() <= reach
        };
        let free =
            |&at: &usize| (0..2).all(|k| self.system.unknown(self.mesh.surface[at], k).is_some());
        let all = || (0..self.mesh.surface.len()).filter(free);
        let mut under = all().filter(is_under);
        // Of a probe between two nodes, the one nearest to it.
        let away = |at: &usize| (self.mesh.nodes[self.mesh.surface[*at]][0] - pose.lateral).abs();
        let nearest = || all().min_by(|a, b| away(a).total_cmp(&away(b)));
        let first = under.next().or_else(nearest).unwrap_or(0);
        first..under.next_back().map_or(first + 1, |last| last + 1)
    }

    /// What the solution is; `None` where it folds, or passes through the probe, or keeps too little of some point's area.
    ///
    /// Implements: FIN-007.
    fn accept(&self, pose: Pose, trial: Trial, iterations: usize) -> Option<Equilibrium> {
        let Trial {
            state,
            equations,
            touches,
            forces,
            ..
        } = trial;
        let places = self.places(&state, pose);
        let penetration = places
            .iter()
            .fold(0.0, |deepest: f64, place| deepest.max(-place.gap));
        let (out, contact) = self.out_of_balance(&equations, &forces);
        let displacements: Vec<[f64; 2]> = (0..self.mesh.nodes.len())
            .map(|node| self.system.displacement(&state, node))
            .collect();
        let deformed = |&node: &usize| {
            Vector2::from(self.mesh.nodes[node]) + Vector2::from(displacements[node])
        };
        let surface: Vec<Vector2<f64>> = self.mesh.surface.iter().map(deformed).collect();
        let folds = crosses_itself(&surface);
        if folds || equations.least_det < LEAST_DET || penetration > 1e-9 {
            return None;
        }
        let mut force = Force::default();
        for [x, y] in &forces {
            force.lateral -= x;
            force.normal -= y;
        }
        let [x, y] = equations.reaction;
        Some(Equilibrium {
            pose,
            force,
            energy: equations.energy,
            penetration,
            check: FieldCheck {
                residual: relative(out, contact),
                imbalance: (x - force.lateral).abs().max((y - force.normal).abs()),
                min_det: equations.least_det,
            },
            iterations,
            touches,
            forces,
            displacements,
            state,
        })
    }
}

/// The force out of balance over that of the contact; absolute, N, where there is none.
fn relative(out: f64, contact: f64) -> f64 {
    if contact > 0.0 { out / contact } else { out }
}

/// How far one pose is from another along x or down, m.
fn distance(a: Pose, b: Pose) -> f64 {
    (a.depth - b.depth).abs().max((a.lateral - b.lateral).abs())
}

/// Whether a line from point to point crosses itself.
fn crosses_itself(line: &[Vector2<f64>]) -> bool {
    let side = |a: Vector2<f64>, b: Vector2<f64>, c: Vector2<f64>| (b - a).perp(&(c - a));
    let crosses = |[a, b]: [Vector2<f64>; 2], [c, d]: [Vector2<f64>; 2]| {
        side(a, b, c) * side(a, b, d) < 0.0 && side(c, d, a) * side(c, d, b) < 0.0
    };
    let segments: Vec<[Vector2<f64>; 2]> = line.windows(2).map(|p| [p[0], p[1]]).collect();
    let behind = |at: usize| segments.iter().skip(at + 2);
    let one = |(at, segment): (usize, &[Vector2<f64>; 2])| {
        behind(at).any(|other| crosses(*segment, *other))
    };
    segments.iter().enumerate().any(one)
}
