//! What the probe does to the surface at one pose.

/// Each end of the contact moves ever more slowly: in the next step by about this part of its last.
const SLOWER: f64 = 0.8;

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

    /// Where the state goes if it keeps changing as it did since `earlier`, `ahead` times as far; all points between the ends of the
    /// contact are in contact.
    pub fn extrapolated(&self, earlier: &ContactState, ahead: f64) -> ContactState {
        let on = |now: f64, then: f64| now + ahead * (now - then);
        let mut state = self.clone();
        let then = earlier.displacements.as_flattened();
        for (u, &then) in state.displacements.as_flattened_mut().iter_mut().zip(then) {
            *u = on(*u, then);
        }
        let ends = |state: &ContactState| Some([*state.active.first()?, *state.active.last()?]);
        if let Some([first, last]) = ends(self) {
            // A contact begins in its middle.
            let [then_first, then_last] = ends(earlier).unwrap_or([first.midpoint(last); 2]);
            let most = (self.pressures.len() - 1) as f64;
            let [first, last] = [(first, then_first), (last, then_last)]
                .map(|(now, then)| now as f64 + SLOWER * ahead * (now as f64 - then as f64))
                .map(|end| end.clamp(0.0, most) as usize);
            state.active = (first..=last).collect();
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
