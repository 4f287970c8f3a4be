//! The probe on a gel whose stiffness is linear for the moment: which nodes touch, which slip, and with which forces.
//!
//! Every touching node lies on the circle. Coulomb's law holds at each: a node that slips is dragged along by μ times its
//! pressure, a node that sticks keeps its place on the probe under less.

use faer::linalg::solvers::Solve;
use faer::{Col, Mat, Side};
use nalgebra::Vector2;

use crate::fem::Pose;

/// Penetration, m, from which on a node touches.
const GAP_TOLERANCE: f64 = 1e-12;
/// A change of all displacements, m, that ends the iterations.
const STEP_TOLERANCE: f64 = 1e-12;
/// The part of the whole contact force by which a force may be on the wrong side of a law.
const FORCE_TOLERANCE: f64 = 1e-9;
/// After so many iterations nodes come and go one by one.
const SIMULTANEOUS_CHANGES: usize = 12;
const MOST_ITERATIONS: usize = 60;

/// How a node at the surface and the probe touch.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Touch {
    /// Not at all.
    Apart,
    /// The node slides along the probe, to the right (1) or to the left (−1); 0 where nothing tells, without friction.
    Slips(f64),
    /// The node keeps its place on the probe.
    Sticks,
}

/// How the probe came to its pose, as far as friction asks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Friction {
    /// There is none.
    None,
    /// The probe has been sliding to the right for so long that every node slips to the left along it.
    Steady(f64),
    /// By the path: nodes stick until μ times their pressure no longer holds them.
    Path(f64),
}

impl Friction {
    /// Steady sliding with this coefficient μ; without friction where it is 0.
    ///
    /// Implements: FIN-012.
    pub fn steady(mu: f64) -> Friction {
        match mu {
            0.0 => Friction::None,
            mu => Friction::Steady(mu),
        }
    }

    /// Coulomb's coefficient μ.
    pub fn coefficient(self) -> f64 {
        match self {
            Friction::None => 0.0,
            Friction::Steady(mu) | Friction::Path(mu) => mu,
        }
    }
}

/// The nodes under the probe and what moves them.
///
/// Implements: FIN-005, FIN-010, FIN-011.
pub(super) struct Patch<'a> {
    pub pose: Pose,
    pub radius: f64,
    pub friction: Friction,
    /// Undeformed positions, m.
    pub positions: &'a [[f64; 2]],
    /// Displacements, m, at which `forces` hold them, x and y of each.
    pub displacements: &'a [f64],
    pub forces: &'a [f64],
    pub stiffness: &'a Mat<f64>,
    /// Where each node was on the probe before this step: its arc from the probe's lowest point, m.
    pub arcs: &'a [f64],
}

/// The patch in contact.
#[derive(Debug, Clone)]
pub(super) struct Settled {
    pub displacements: Vec<f64>,
    pub touches: Vec<Touch>,
    /// Forces on the gel, N.
    pub forces: Vec<f64>,
}

/// A node seen from the probe's axis.
#[derive(Clone, Copy)]
pub(in crate::fem) struct Place {
    pub gap: f64,
    pub normal: Vector2<f64>,
    distance: f64,
    /// From the probe's lowest point along its face, m.
    pub arc: f64,
}

impl Place {
    /// Of a node at `position`, m, under a probe of this radius, m.
    pub fn new(position: Vector2<f64>, pose: Pose, radius: f64) -> Place {
        let arm = position - Vector2::new(pose.lateral, radius - pose.depth);
        let distance = libm::sqrt(arm.dot(&arm));
        Place {
            gap: distance - radius,
            normal: arm / distance,
            distance,
            arc: radius * libm::atan2(arm.x, -arm.y),
        }
    }

    /// To the right along the probe's face, where the normal points down.
    pub fn tangent(&self) -> Vector2<f64> {
        Vector2::new(-self.normal.y, self.normal.x)
    }

    /// The parts of a force along the normal and along the tangent.
    fn parts(&self, force: Vector2<f64>) -> [f64; 2] {
        [force.dot(&self.normal), force.dot(&self.tangent())]
    }
}

/// The force on a node, N.
fn force_at(forces: &[f64], node: usize) -> Vector2<f64> {
    Vector2::new(forces[2 * node], forces[2 * node + 1])
}

/// A displacement that the contact leaves free: of `node` along `along`, where the force along `balanced` vanishes.
struct Unknown {
    node: usize,
    along: Vector2<f64>,
    balanced: Vector2<f64>,
    /// What turning the normal adds to the stiffness, N/m.
    turning: f64,
}

impl Patch<'_> {
    /// The contact, starting from `touches`; `None` where the iterations do not end or the contact is not stable.
    pub fn settle(&self, touches: &[Touch]) -> Option<Settled> {
        let mut settled = Settled {
            displacements: self.displacements.to_vec(),
            touches: touches.to_vec(),
            forces: Vec::new(),
        };
        let mut step = f64::INFINITY;
        for iteration in 0..MOST_ITERATIONS {
            let forces = self.forces_at(&settled.displacements);
            let places = self.places(&settled.displacements);
            let changed = self.revise(&mut settled.touches, &places, &forces, iteration);
            if !changed && step <= STEP_TOLERANCE {
                settled.forces = forces;
                for (node, touch) in settled.touches.iter().enumerate() {
                    if *touch == Touch::Apart {
                        settled.forces[2 * node..][..2].fill(0.0);
                    }
                }
                return Some(settled);
            }
            let moves = self.newton(&settled.touches, &places, &forces)?;
            step = 0.0;
            for (u, du) in settled.displacements.iter_mut().zip(&moves) {
                *u += du;
                step = step.max(du.abs());
            }
            // A NaN is refused as well.
            if !step.is_finite() || moves.iter().any(|du| du.is_nan()) {
                return None;
            }
        }
        None
    }

    /// The forces, N, that hold the nodes at `displacements`.
    fn forces_at(&self, displacements: &[f64]) -> Vec<f64> {
        let moved = displacements
            .iter()
            .zip(self.displacements)
            .map(|(a, b)| a - b);
        let pushed = self.stiffness * Col::from_iter(moved.collect::<Vec<_>>());
        let pushed = (0..pushed.nrows()).map(|k| pushed[k]);
        pushed
            .zip(self.forces)
            .map(|(pushed, held)| held + pushed)
            .collect()
    }

    fn places(&self, displacements: &[f64]) -> Vec<Place> {
        let nodes = self.positions.iter().zip(displacements.as_chunks::<2>().0);
        let place = |(x, u): (&[f64; 2], &[f64; 2])| {
            Place::new(
                Vector2::from(*x) + Vector2::from(*u),
                self.pose,
                self.radius,
            )
        };
        nodes.map(place).collect()
    }

    /// Lets nodes that are pulled go, and nodes inside the probe touch it; has nodes stick and slip. Whether anything changed.
    fn revise(
        &self,
        touches: &mut [Touch],
        places: &[Place],
        forces: &[f64],
        iteration: usize,
    ) -> bool {
        let mu = self.friction.coefficient();
        let of = |node: usize| places[node].parts(force_at(forces, node));
        let touching = (0..touches.len()).filter(|&node| touches[node] != Touch::Apart);
        let whole: f64 = touching.map(|node| of(node)[0].max(0.0)).sum();
        let tolerance = FORCE_TOLERANCE * whole;
        // A change for each node that needs one, and how badly.
        let change = |node: usize| {
            let [pressure, drag] = of(node);
            let place = &places[node];
            let slid = place.arc - self.arcs[node];
            match touches[node] {
                Touch::Apart if place.gap < -GAP_TOLERANCE => {
                    Some((self.entering(slid), -place.gap / self.radius))
                }
                Touch::Apart => None,
                // The first forces are those of another pose.
                _ if iteration == 0 => None,
                _ if pressure < -tolerance => Some((Touch::Apart, -pressure / whole)),
                Touch::Sticks if drag.abs() > mu * pressure + tolerance => {
                    let excess = (drag.abs() - mu * pressure) / whole;
                    Some((Touch::Slips(-drag.signum()), excess))
                }
                Touch::Slips(way)
                    if matches!(self.friction, Friction::Path(_))
                        && slid * way < -GAP_TOLERANCE =>
                {
                    Some((Touch::Sticks, -slid * way / self.radius))
                }
                _ => None,
            }
        };
        let changes = (0..touches.len()).filter_map(|node| Some((node, change(node)?)));
        let mut changes: Vec<(usize, (Touch, f64))> = changes.collect();
        if iteration >= SIMULTANEOUS_CHANGES {
            changes.sort_by(|a, b| b.1.1.total_cmp(&a.1.1));
            changes.truncate(1);
        }
        for &(node, (touch, _)) in &changes {
            touches[node] = touch;
        }
        !changes.is_empty()
    }

    /// What a node does that has just met the probe, `slid` metres along it since the step began.
    fn entering(&self, slid: f64) -> Touch {
        match self.friction {
            Friction::None => Touch::Slips(0.0),
            Friction::Steady(_) => Touch::Slips(-1.0),
            Friction::Path(_) if slid == 0.0 => Touch::Sticks,
            Friction::Path(_) => Touch::Slips(slid.signum()),
        }
    }

    /// Newton's step of all displacements, m: prescribed along the normal of a node that touches and along the face where it
    /// sticks, else such that the forces balance.
    fn newton(&self, touches: &[Touch], places: &[Place], forces: &[f64]) -> Option<Vec<f64>> {
        let mu = self.friction.coefficient();
        let mut moves = vec![0.0; forces.len()];
        let mut unknowns = Vec::with_capacity(forces.len());
        for (node, (touch, place)) in touches.iter().zip(places).enumerate() {
            let (normal, tangent) = (place.normal, place.tangent());
            let mut prescribed = -place.gap * normal;
            let mut free = |along, balanced, turning| {
                unknowns.push(Unknown {
                    node,
                    along,
                    balanced,
                    turning,
                });
            };
            match *touch {
                Touch::Apart => {
                    for axis in [Vector2::x(), Vector2::y()] {
                        free(axis, axis, 0.0);
                    }
                    continue;
                }
                Touch::Slips(way) => {
                    let [pressure, drag] = place.parts(force_at(forces, node));
                    let turning = (way * mu * drag - pressure) / place.distance;
                    free(tangent, tangent + way * mu * normal, turning);
                }
                Touch::Sticks => {
                    let back = (self.arcs[node] - place.arc) * place.distance / self.radius;
                    prescribed += back * tangent;
                }
            }
            moves[2 * node] = prescribed.x;
            moves[2 * node + 1] = prescribed.y;
        }
        let pushed = self.stiffness * Col::from_fn(moves.len(), |k| moves[k]);
        let rest = |unknown: &Unknown| {
            let k = 2 * unknown.node;
            let force = force_at(forces, unknown.node) + Vector2::new(pushed[k], pushed[k + 1]);
            -unknown.balanced.dot(&force)
        };
        let rest = Col::from_iter(unknowns.iter().map(rest).collect::<Vec<_>>());
        let amounts = self.amounts(&unknowns, rest)?;
        for (unknown, amount) in unknowns.iter().zip(amounts.iter()) {
            moves[2 * unknown.node] += amount * unknown.along.x;
            moves[2 * unknown.node + 1] += amount * unknown.along.y;
        }
        Some(moves)
    }

    /// How far, m, the free displacements go so that the forces `rest`, N, balance.
    fn amounts(&self, unknowns: &[Unknown], rest: Col<f64>) -> Option<Col<f64>> {
        let matrix = self.between(unknowns);
        // Without friction the tangent is symmetric, and positive definite where the contact is stable.
        Some(match self.friction {
            Friction::None => matrix.llt(Side::Lower).ok()?.solve(rest),
            _ => matrix.partial_piv_lu().solve(rest),
        })
    }

    /// The stiffness over the free displacements, N/m.
    fn between(&self, unknowns: &[Unknown]) -> Mat<f64> {
        let mut matrix = Mat::zeros(unknowns.len(), unknowns.len());
        for (column, by) in unknowns.iter().enumerate() {
            let [x, y] = [0, 1].map(|k| self.stiffness.col_as_slice(2 * by.node + k));
            let entries = matrix.col_as_slice_mut(column).iter_mut();
            for (entry, of) in entries.zip(unknowns) {
                let k = 2 * of.node;
                let force = Vector2::new(
                    x[k] * by.along.x + y[k] * by.along.y,
                    x[k + 1] * by.along.x + y[k + 1] * by.along.y,
                );
                *entry = of.balanced.dot(&force);
            }
            matrix[(column, column)] += by.turning;
        }
        matrix
    }
}
