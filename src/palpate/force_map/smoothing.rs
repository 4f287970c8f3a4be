//! Measured forces with less of the sensor's noise: parabolas along the lateral positions (`spec/force-map.md`).

use nalgebra::DMatrix;

use super::{ForceTable, Matrix, SAME_POSITION};
use crate::decimal::mm;
use crate::force::Force;
use crate::refusal::Refusal;

/// Fewest positions of a window: a parabola goes through three.
const FEWEST: usize = 4;

/// A smoothed table, and what that took away.
#[derive(Debug, Clone, PartialEq)]
pub struct Smoothed {
    /// The smoothed forces.
    pub table: ForceTable,
    /// √(Σr²/ν) of the residuals r, N: the standard deviation of the noise, if the forces are parabolas in each window; none of a force
    /// that is not there.
    pub noise_sd: Force<Option<f64>>,
    /// ν, of each channel: how many forces there are more than parameters that were fitted to them.
    pub degrees_of_freedom: f64,
}

/// The positions whose forces make one smoothed force.
struct Window {
    /// The first of them.
    start: usize,
    /// The weight of each.
    weights: Vec<f64>,
    /// The weight of the position itself.
    own: f64,
}

impl Window {
    /// The window around position `at` of `laterals`, moved in at the ends.
    ///
    /// Implements: MAP-070, MAP-071.
    fn new(laterals: &[f64], at: usize, half_width: f64) -> Result<Window, Refusal> {
        let (first, last) = (laterals[0], laterals[laterals.len() - 1]);
        let half = half_width.min(0.5 * (last - first));
        let middle = laterals[at].max(first + half).min(last - half);
        let reach = half + SAME_POSITION;
        // The position itself is in it, whatever was rounded.
        let start = laterals.partition_point(|x| *x < middle - reach).min(at);
        let end = laterals
            .partition_point(|x| *x <= middle + reach)
            .max(at + 1);
        let (count, position) = (end - start, mm(laterals[at]));
        let found = format!(
            "{count} lateral positions are within {} mm of {position} mm",
            mm(half_width)
        );
        let expected =
            format!("choose a half-width with at least {FEWEST}, through which a parabola goes");
        Refusal::state(found, expected).when(count < FEWEST)?;
        let powers = |row: usize, power| {
            let x = (laterals[start + row] - laterals[at]) / half;
            [1.0, x, x * x][power]
        };
        // With an orthonormal basis Q of the parabolas, QQᵀ f are the fitted forces.
        let basis = DMatrix::from_fn(end - start, 3, powers).qr().q();
        let weights = &basis * basis.row(at - start).transpose();
        Ok(Window {
            start,
            own: weights[at - start],
            weights: weights.as_slice().to_vec(),
        })
    }

    fn smooth(&self, forces: &[f64]) -> f64 {
        let forces = &forces[self.start..];
        std::iter::zip(&self.weights, forces)
            .map(|(weight, force)| weight * force)
            .sum()
    }
}

impl ForceTable {
    /// This table with each force replaced by that of the parabola which fits the forces of its row within `half_width` (m) best.
    ///
    /// # Errors
    /// A half-width that is not above 0, or with fewer than four positions in a window; forces that are not finite.
    ///
    /// Implements: MAP-070, MAP-071, MAP-073.
    pub fn smoothed(&self, half_width: f64) -> Result<Smoothed, Refusal> {
        let is_right = half_width > 0.0 && half_width.is_finite();
        let expected = "a finite number of metres above 0";
        Refusal::value("half-width", half_width, expected).when(!is_right)?;
        let (depths, laterals) = (self.depths(), self.laterals());
        let window = |at| Window::new(laterals, at, half_width);
        let windows = (0..laterals.len())
            .map(window)
            .collect::<Result<Vec<_>, _>>()?;
        let smooth = |forces: &Matrix| {
            Matrix::from_fn(depths.len(), laterals.len(), |row, column| {
                windows[column].smooth(forces.row(row))
            })
        };
        let (normal, lateral) = (smooth(self.normal()), self.lateral().map(smooth));
        let table = ForceTable::of_channels(depths.into(), laterals.into(), normal, lateral)?;
        let residual = self.minus(&table)?;
        // A least-squares fit has as much variance at a point as the point's own weight.
        let free: f64 = windows.iter().map(|window| 1.0 - window.own).sum();
        let degrees_of_freedom = depths.len() as f64 * free;
        let channels = Force::new(residual.lateral(), Some(residual.normal()));
        let noise_sd = channels.map(|residual| {
            let squares: f64 = residual?.values().iter().map(|r| r * r).sum();
            Some((squares / degrees_of_freedom).sqrt())
        });
        Ok(Smoothed {
            table,
            noise_sd,
            degrees_of_freedom,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use palpate_asserts::assert_near;

    /// These normal forces, and lateral ones of twice their size to the other side.
    fn table(laterals: &[f64], normal: &[f64]) -> ForceTable {
        let matrix = |sign: f64| Matrix::from_fn(1, laterals.len(), |_, at| sign * normal[at]);
        let forces = Force::new(matrix(-2.0), matrix(1.0));
        ForceTable::new(vec![0.004], laterals.to_vec(), forces).unwrap()
    }

    /// Positions of equal steps of 0.5 mm from −2 mm on.
    fn steps(count: usize) -> Vec<f64> {
        (0..count).map(|at| at as f64 * 0.5e-3 - 2e-3).collect()
    }

    // Verifies: MAP-070.
    #[test]
    fn with_equal_steps_it_is_the_filter_of_savitzky_and_golay() {
        // By the tables of Savitzky and Golay (1964) and, at the ends, of Gorry (1990): (−3, 12, 17, 12, −3), (31, 9, −3, −5, 3) and
        // (9, 13, 12, 6, −5), each over 35.
        let forces = [1.0, 4.0, 2.0, 8.0, 5.0, 7.0, 1.0, 0.0, 3.0];
        let expected =
            [36.0, 108.0, 160.0, 187.0, 256.0, 167.0, 77.0, 56.0, 70.0].map(|f| f / 35.0);
        let found = table(&steps(9), &forces).smoothed(1e-3).unwrap();
        for (at, expected) in expected.into_iter().enumerate() {
            let both = found.table.both().unwrap();
            let [lateral, normal] = both.into_array().map(|of| of.values()[at]);
            // Weights of a few units times forces below 10 N, each rounded some ten times.
            assert_near(normal, expected, 1e-13);
            assert_near(lateral, -2.0 * expected, 2e-13);
        }
        // Of the windows at either end the weights are 31/35, 13/35, and 17/35 in each of the five middle ones.
        let free = 9.0 - (2.0 * 31.0 + 2.0 * 13.0 + 5.0 * 17.0) / 35.0;
        assert!((found.degrees_of_freedom - free).abs() < 1e-13);
        let squares: f64 = std::iter::zip(forces, expected)
            .map(|(f, e)| (f - e) * (f - e))
            .sum();
        let sd = (squares / free).sqrt();
        assert_near(found.noise_sd.normal.unwrap(), sd, 1e-13);
        assert_near(found.noise_sd.lateral.unwrap(), 2.0 * sd, 2e-13);
    }

    // Verifies: MAP-070.
    #[test]
    fn a_parabola_over_any_positions_stays_what_it_is() {
        let laterals = [
            -7e-3, -6.5e-3, -4e-3, -3.9e-3, -1e-3, 0.0, 0.2e-3, 2e-3, 5e-3, 5.5e-3,
        ];
        let forces = laterals.map(|x| 1.5 - 80.0 * x + 4e4 * x * x);
        for half_width in [4e-3, 9e-3, 1.0] {
            let found = table(&laterals, &forces).smoothed(half_width).unwrap();
            for (found, expected) in std::iter::zip(found.table.normal().values(), forces) {
                assert!((found - expected).abs() < 1e-13, "{found} {expected}");
            }
            assert!(found.noise_sd.normal.unwrap() < 1e-13);
        }
    }

    // Verifies: MAP-073.
    #[test]
    fn the_residual_tells_the_noise() {
        let generator = crate::stats::random::Generator::new(20_261_122, 9);
        let laterals: Vec<f64> = (0..4000).map(|at| f64::from(at) * 1e-4).collect();
        let forces: Vec<f64> = (0..4000)
            .map(|at| 1.5 + 0.02 * generator.normal(0, at))
            .collect();
        let found = table(&laterals, &forces).smoothed(0.5e-3).unwrap();
        // The variance of Σr²/ν for white noise is about 2σ⁴/ν: σ is found within 5 standard errors of √(1/2ν).
        let error = (0.5 / found.degrees_of_freedom).sqrt();
        assert_near(found.noise_sd.normal.unwrap() / 0.02, 1.0, 5.0 * error);
    }

    // Verifies: MAP-083.
    #[test]
    fn the_normal_force_alone_is_smoothed_as_beside_another() {
        let both = table(&steps(9), &[1.0, 4.0, 2.0, 8.0, 5.0, 7.0, 1.0, 0.0, 3.0]);
        let [one, both] = [both.of_normal(), both].map(|table| table.smoothed(1e-3).unwrap());
        assert_eq!(
            (one.table.normal(), one.table.lateral()),
            (both.table.normal(), None)
        );
        assert_eq!(
            (one.noise_sd.normal, one.noise_sd.lateral),
            (both.noise_sd.normal, None)
        );
    }

    // Verifies: MAP-071.
    #[test]
    fn a_window_of_three_is_refused() {
        let table = table(&steps(9), &[0.0; 9]);
        assert!(table.smoothed(1e-3 - 0.9e-9).is_ok());
        for (half_width, expected) in [
            (
                0.99e-3,
                "3 lateral positions are within 0.99 mm of -1.0 mm; choose a half-width with at least 4",
            ),
            (0.0, "half-width = 0, but must be"),
            (-1.0, "half-width = -1, but must be"),
            (f64::NAN, "half-width = NaN, but must be"),
            (f64::INFINITY, "half-width = inf, but must be"),
        ] {
            let error = table.smoothed(half_width).unwrap_err().to_string();
            assert!(error.starts_with(expected), "{error}");
        }
    }
}
