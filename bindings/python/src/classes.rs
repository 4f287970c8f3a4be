//! The classes of phantoms and force maps, which make each other; `phantom.rs` and `map.rs` have their methods.

use palpate::{force_map, phantom};
use pyo3::prelude::*;

/// A phantom: layers of gel in a well, inclusions in them or none, and the probe. Phantom(name) is one of the paper's five: "none",
/// "2.6", "4.6", "6.6", "8.6", the depth of the inclusion in mm.
///
/// Keywords change numbers of it, by the names of the phantom file (mm, kPa) behind that of their table: well_width_mm=40,
/// inclusion_depth_mm=5, layer_1_youngs_modulus_kpa=8, where layers and inclusions count from 0 and the only one needs no number.
#[doc = sections!(name: "str" = "One of the five.", edits;; "Another name, or a number that the phantom cannot have.")]
/// Examples
/// --------
/// >>> soft = Phantom("6.6", layer_1_youngs_modulus_kpa=4)
/// >>> lateral, normal = soft.solve(depth_mm=4, lateral_mm=0, mesh_mm=1)
/// >>> round(normal, 1)
/// 1.5
// Implements: PYT-007.
#[pyclass(frozen, eq, module = "palpate")]
#[derive(PartialEq)]
pub struct Phantom(pub phantom::Phantom);

/// The force on the probe over a grid of m depths and n lateral positions, N; made from measured forces.
#[doc = sections!(
    depths_mm: "array_like, shape (m,)" = "Depths of the probe, increasing, mm.",
    laterals_mm: "array_like, shape (n,)" = "Lateral positions, increasing, mm.",
    lateral_n: "array_like, shape (m, n), or None" = "Lateral forces along +x, N; None where they were not measured.",
    normal_n: "array_like, shape (m, n)" = "Normal forces out of the gel, N.",
    phantom: "Phantom, optional" = "What was measured, if that is known.",
    note: "str, optional" = "What is known beside N and mm.";;
    "Axes that do not increase, or forces of another shape or not finite."
)]
/// Examples
/// --------
/// >>> measured = ForceMap([1, 2], [-5, 0, 5], None, [[0.4, 0.5, 0.4], [0.9, 1.2, 0.9]], note="gel of 24 November")
/// >>> measured.sweep(1.5, [0, 2.5])
/// array([0.85, 0.75])
/// >>> measured.to_pandas().shape
/// (6, 3)
// Implements: PYT-002.
#[pyclass(frozen, eq, module = "palpate")]
#[derive(PartialEq)]
pub struct ForceMap(pub force_map::ForceMap);
