//! Whether a sampled device can play a table without feeding energy to the hand: by its damping, which must make up for
//! forces that come late, and by its friction, which must make up for forces that have no potential (`spec/servo.md`).

use super::{EXTRAPOLATION_CELLS, Force, Table};

/// What damps a device, and what its samples miss.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Damping {
    /// Time between two samples, T, s.
    pub period_s: f64,
    /// Whole periods from a sample to the time at which the device makes its force, D/T.
    pub delay_periods: u16,
    /// Viscous damping of an axis, b, N·s/m.
    pub damping_n_s_per_m: f64,
    /// Coulomb friction of an axis, f_c, N.
    pub friction_n: f64,
    /// Position resolution, Δ, m.
    pub resolution_m: f64,
}

impl Damping {
    /// The stiffest spring, N/m, whose delay the damping makes up for: b / (T/2 + D). `None` unless
    /// period and resolution are above 0, damping and friction at least 0, and all finite.
    ///
    /// Implements: SRV-052.
    pub fn stiffest(&self) -> Option<f64> {
        let positive = |value: f64| value > 0.0 && value.is_finite();
        let sound = positive(self.period_s)
            && positive(self.resolution_m)
            && (self.damping_n_s_per_m == 0.0 || positive(self.damping_n_s_per_m))
            && (self.friction_n == 0.0 || positive(self.friction_n));
        if !sound {
            return None;
        }
        let delay = 0.5 + f64::from(self.delay_periods);
        Some(self.damping_n_s_per_m / (delay * self.period_s))
    }
}

/// The stiffness of a table, N/m: the largest singular value of ∂(F_x, F_n)/∂(x, d) anywhere on it
/// and on the continued cells.
///
/// ∂F/∂x is linear in d, and ∂F/∂d in x, so that the largest is at a corner of a cell.
///
/// ```
/// use palpate_core::force::Force;
/// use palpate_core::servo::{Axis, Table, stiffness};
///
/// // 4 N at half a metre, wherever the probe stands.
/// let force = |normal| Force { lateral: 0.0, normal };
/// let forces = [force(0.0), force(0.0), force(4.0), force(4.0)];
/// let axis = Axis::new(&[0.0, 0.5], &[2.0]).expect("an axis");
/// let table = Table::new(axis, axis, &forces)?;
/// assert_eq!(stiffness(&table), 8.0);
/// # Ok::<(), palpate_core::servo::InvalidTable>(())
/// ```
///
/// Implements: SRV-050.
pub fn stiffness(table: &Table) -> f64 {
    let (depths, laterals) = (table.depths().knots(), table.laterals().knots());
    let columns = laterals.len();
    let forces = table.forces();
    let node = |row, column| {
        let force = forces.get(row * columns + column);
        force.copied().unwrap_or_default()
    };
    let mut largest = 0.0;
    for (row, depth) in depths.windows(2).enumerate() {
        for (column, lateral) in laterals.windows(2).enumerate() {
            let corners = [
                [node(row, column), node(row, column + 1)],
                [node(row + 1, column), node(row + 1, column + 1)],
            ];
            let size = [width(depth), width(lateral)];
            // Nothing is played above the surface.
            let begins_below = row == 0 && depth.first().is_some_and(|&first| first > 0.0);
            let along_depth = fractions(begins_below, row + 2 == depths.len());
            let along_lateral = fractions(column == 0, column + 2 == columns);
            for s in along_depth {
                for t in along_lateral {
                    let slope = largest_singular_value(slopes(&corners, size, s, t));
                    largest = if slope > largest { slope } else { largest };
                }
            }
        }
    }
    largest
}

/// The width of a cell, m.
fn width(ends: &[f32]) -> f64 {
    match ends {
        &[start, end] => f64::from(end) - f64::from(start),
        _ => f64::INFINITY, // a window of two has two
    }
}

/// The first and last fraction of a cell that is played: one cell further at the table's borders.
fn fractions(first: bool, last: bool) -> [f64; 2] {
    let beyond = f64::from(EXTRAPOLATION_CELLS);
    [
        if first { -beyond } else { 0.0 },
        if last { 1.0 + beyond } else { 1.0 },
    ]
}

/// ∂(F_x, F_n)/∂(x, d) of a bilinear cell of the size (depth, lateral) at the fractions s, t.
fn slopes(corners: &[[Force<f32>; 2]; 2], size: [f64; 2], s: f64, t: f64) -> [[f64; 2]; 2] {
    let component = |of: fn(&Force<f32>) -> f32| {
        let [[a, b], [c, d]] = corners.map(|row| row.map(|force| f64::from(of(&force))));
        let along_lateral = ((1.0 - s) * (b - a) + s * (d - c)) / size[1];
        let along_depth = ((1.0 - t) * (c - a) + t * (d - b)) / size[0];
        [along_lateral, along_depth]
    };
    [
        component(|force| force.lateral),
        component(|force| force.normal),
    ]
}

/// The largest singular value of [[a, b], [c, d]]: half of |(a + d, b − c)| + |(a − d, b + c)|.
fn largest_singular_value([[a, b], [c, d]]: [[f64; 2]; 2]) -> f64 {
    0.5 * (libm::hypot(a + d, b - c) + libm::hypot(a - d, b + c))
}
