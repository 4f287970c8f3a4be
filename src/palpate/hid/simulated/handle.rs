//! One axis of the handle in the hand.

/// Steps of the motion in one period of the device: a tenth of a millisecond is short against the
/// hand's spring on the handle's mass (some 60 ms a swing).
const STEPS: u32 = 10;

/// What moves on an axis, and what holds it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mechanics {
    /// Mass of handle and hand, kg.
    pub mass_kg: f64,
    /// Viscous damping of the device, N·s/m.
    pub damping_n_s_per_m: f64,
    /// Coulomb friction of the device, N.
    pub friction_n: f64,
    /// Play between handle and encoder, m.
    pub backlash_m: f64,
    /// Stiffness of the hand towards where it wants to be, N/m; an infinite one is there at once.
    pub hand_n_per_m: f64,
    /// Damping of the hand, N·s/m.
    pub hand_n_s_per_m: f64,
}

impl Mechanics {
    /// The paper's display, with 0.14 N of backdrive friction (Table 2), in a firm hand.
    pub const PAPER: Mechanics = Mechanics {
        mass_kg: 0.05,
        damping_n_s_per_m: 0.6,
        friction_n: 0.14,
        backlash_m: 20e-6,
        hand_n_per_m: 500.0,
        hand_n_s_per_m: 5.0,
    };
}

/// Position, velocity, and what the encoder sees of it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Handle {
    mechanics: Mechanics,
    /// Where the handle is, m.
    pub position: f64,
    velocity: f64,
    /// Where the encoder sees it, m.
    pub encoder: f64,
}

impl Handle {
    /// A handle at rest at `position` (m).
    pub fn at(mechanics: Mechanics, position: f64) -> Handle {
        Handle {
            mechanics,
            position,
            velocity: 0.0,
            encoder: position,
        }
    }

    /// Moves for `time` (s) under the motor's `force` (N), with the hand drawn to `target` (m).
    ///
    /// Implements: HID-020.
    pub fn advance(&mut self, time: f64, target: f64, force: f64) {
        if self.mechanics.hand_n_per_m.is_infinite() {
            self.position = target;
        } else {
            let step = time / f64::from(STEPS);
            for _ in 0..STEPS {
                self.advance_step(step, target, force);
            }
        }
        let half = self.mechanics.backlash_m / 2.0;
        self.encoder = self
            .encoder
            .clamp(self.position - half, self.position + half);
    }

    /// One step: velocity first, then position, so that the spring loses no energy to the method.
    fn advance_step(&mut self, step: f64, target: f64, force: f64) {
        let by = &self.mechanics;
        let spring = by.hand_n_per_m * (target - self.position);
        let viscous = (by.damping_n_s_per_m + by.hand_n_s_per_m) * self.velocity;
        let free = self.velocity + step / by.mass_kg * (force + spring - viscous);
        // Friction takes at most its impulse, and never reverses the motion: it sticks.
        let impulse = step / by.mass_kg * by.friction_n;
        self.velocity = free.signum() * (free.abs() - impulse).max(0.0);
        self.position += step * self.velocity;
    }
}
