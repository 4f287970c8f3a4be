//! What the probe does to the surface at one pose.

/// Surface displacements and contact forces at one pose.
///
/// Implements: FEM-009.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactState {
    /// Displacement of each contact point, m.
    pub displacements: Vec<[f64; 2]>,
    /// λ of each contact point, N; zero off the contact.
    pub pressures: Vec<f64>,
    /// Points in contact, ascending.
    pub active: Vec<usize>,
    /// Iterations spent on this pose.
    pub iterations: usize,
}

impl ContactState {
    /// The untouched surface.
    pub fn untouched(points: usize) -> ContactState {
        ContactState {
            displacements: vec![[0.0; 2]; points],
            pressures: vec![0.0; points],
            active: Vec::new(),
            iterations: 0,
        }
    }

    /// Where the state goes if it keeps changing as it did since `earlier`, `ahead` times as far.
    pub fn extrapolated(&self, earlier: &ContactState, ahead: f64) -> ContactState {
        let on = |now: f64, then: f64| now + ahead * (now - then);
        let mut state = self.clone();
        let then = earlier.displacements.as_flattened();
        for (u, &then) in state.displacements.as_flattened_mut().iter_mut().zip(then) {
            *u = on(*u, then);
        }
        for &point in &state.active {
            state.pressures[point] = on(state.pressures[point], earlier.pressures[point]).max(0.0);
        }
        state
    }

    /// The state of the mirror image.
    pub(in crate::fem) fn mirrored(mut self) -> ContactState {
        let last = self.pressures.len() - 1;
        self.displacements.reverse();
        self.displacements.iter_mut().for_each(|u| u[0] = -u[0]);
        self.pressures.reverse();
        self.active = self.active.iter().rev().map(|i| last - i).collect();
        self
    }
}
