//! Where the probe may stand.

use super::decimal::format_scaled;
use super::{Phantom, Probe};

/// Why the probe cannot stand at a pose. Values are SI, messages speak in mm.
///
/// ```
/// use palpate::phantom::{Phantom, PoseError};
///
/// let phantom = Phantom::builtin("none")?;
/// // 17 mm of half a well less the 6 mm of half a probe.
/// let error = phantom.check_pose(0.004, 0.0115).unwrap_err();
/// assert!(matches!(error, PoseError::Wall { limit, .. } if (limit - 0.011).abs() < 1e-15));
/// # Ok::<(), palpate::phantom::UnknownPhantom>(())
/// ```
///
/// Implements: PHA-013.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum PoseError {
    /// A coordinate is NaN or infinite.
    #[error("{coordinate}_mm = {value}, allowed: a finite number")]
    NotFinite {
        /// `depth` or `lateral`.
        coordinate: &'static str,
        /// Its value.
        value: f64,
    },
    /// The depth is negative or reaches the floor.
    #[error(
        "depth_mm = {}, allowed: at least 0 and below {}, the height of gel and skin",
        mm(*.depth), mm(*.total_height)
    )]
    Depth {
        /// The depth, m.
        depth: f64,
        /// Height of gel and skin, m.
        total_height: f64,
    },
    /// The probe would touch or enter a wall.
    #[error(
        "lateral_mm = {}, allowed at depth_mm = {}: above {} and below {}, where the probe, there {} mm to each side, clears the walls",
        mm(*.lateral), mm(*.depth), mm(-*.limit), mm(*.limit), mm(*.half_width)
    )]
    Wall {
        /// The depth, m.
        depth: f64,
        /// The lateral position, m.
        lateral: f64,
        /// Half the probe's width in the plane of the undeformed surface, m.
        half_width: f64,
        /// |lateral| must be below this, m.
        limit: f64,
    },
}

/// `length` (m) in mm, rounded to a nanometre: it may come from a square root.
fn mm(length: f64) -> String {
    if length.abs() < 1e3 {
        format!("{}", (length * 1e9).round() / 1e6)
    } else {
        format_scaled(length, 3)
    }
}

impl Probe {
    /// Half the width, m, of the probe in the plane of the undeformed surface when its lowest point
    /// lies `depth` (m, ≥ 0) below that plane.
    ///
    /// Implements: PHA-012.
    pub fn half_width_at(&self, depth: f64) -> f64 {
        if depth < self.radius {
            // √(R² − (R−d)²) without its cancellation.
            (depth * (2.0 * self.radius - depth)).sqrt()
        } else {
            self.radius
        }
    }
}

impl Phantom {
    /// Whether the probe may press to `depth` (m) anywhere.
    ///
    /// ```
    /// use palpate::phantom::Phantom;
    ///
    /// let phantom = Phantom::builtin("none")?;
    /// assert!(phantom.check_depth(0.004).is_ok());
    /// assert!(phantom.check_depth(0.0155).is_err());
    /// # Ok::<(), palpate::phantom::UnknownPhantom>(())
    /// ```
    ///
    /// # Errors
    /// [`PoseError`] if `depth` is not finite, negative, or not above the floor.
    ///
    /// Implements: PHA-011, PHA-013.
    pub fn check_depth(&self, depth: f64) -> Result<(), PoseError> {
        let total_height = self.total_height();
        if !depth.is_finite() {
            let (coordinate, value) = ("depth", depth);
            Err(PoseError::NotFinite { coordinate, value })
        } else if (0.0..total_height).contains(&depth) {
            Ok(())
        } else {
            Err(PoseError::Depth {
                depth,
                total_height,
            })
        }
    }

    /// Whether the probe may stand at `depth` and `lateral` (m): above the floor, clear of the walls.
    ///
    /// ```
    /// use palpate::phantom::Phantom;
    ///
    /// let phantom = Phantom::builtin("none")?;
    /// assert!(phantom.check_pose(0.004, -0.010).is_ok());
    /// assert!(phantom.check_pose(0.004, -0.012).is_err());
    /// # Ok::<(), palpate::phantom::UnknownPhantom>(())
    /// ```
    ///
    /// # Errors
    /// [`PoseError`] with the coordinate, its value and what is allowed.
    ///
    /// Implements: PHA-011, PHA-012, PHA-013, FEM-019.
    pub fn check_pose(&self, depth: f64, lateral: f64) -> Result<(), PoseError> {
        self.check_depth(depth)?;
        let half_width = self.probe.half_width_at(depth);
        let limit = self.gel.width / 2.0 - half_width;
        if !lateral.is_finite() {
            let (coordinate, value) = ("lateral", lateral);
            Err(PoseError::NotFinite { coordinate, value })
        } else if lateral.abs() < limit {
            Ok(())
        } else {
            Err(PoseError::Wall {
                depth,
                lateral,
                half_width,
                limit,
            })
        }
    }
}
