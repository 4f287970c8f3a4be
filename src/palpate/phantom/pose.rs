//! Where the probe may stand.

use std::ops::Bound::Excluded;

use super::limits::{AXIS, in_mm, within};
use super::{Geometry, Phantom, Probe};
use crate::decimal::mm;
use crate::refusal::Refusal;

impl Probe {
    /// Half the width, m, of the probe in the plane of the undeformed surface when its lowest point
    /// lies `depth` (m, ≥ 0) below that plane.
    ///
    /// Implements: PHA-011.
    pub fn half_width_at(&self, depth: f64) -> f64 {
        let depth = depth.min(self.radius);
        // √(R² − (R−d)²) without its cancellation.
        (depth * (2.0 * self.radius - depth)).sqrt()
    }
}

impl Phantom {
    /// Whether the probe may stand at `depth` and `lateral` (m): above the floor, clear of the walls.
    ///
    /// # Errors
    /// The coordinate in mm, its value and what is allowed.
    ///
    /// Implements: PHA-011, PHA-009.
    pub fn check_pose(&self, depth: f64, lateral: f64) -> Result<(), Refusal> {
        let why = " (the height of the layers)";
        within("depth_mm", mm(depth), 0.0..self.height(), why)?;
        if self.0.geometry == Geometry::Axisymmetric {
            within("lateral_mm", mm(lateral), 0.0..=0.0, AXIS)?;
        }
        let half_width = self.0.probe.half_width_at(depth);
        let limit = self.0.well.width / 2.0 - half_width;
        let (wide, low) = (in_mm(half_width), in_mm(depth));
        let why = format!(" (the probe, {wide} to each side when {low} deep, clears the walls)");
        let range = (Excluded(-limit), Excluded(limit));
        within("lateral_mm", mm(lateral), range, &why)
    }
}
