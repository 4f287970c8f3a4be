//! Measured forces at any poses, made a map.

use palpate::force::Force;
use palpate::force_map::{self, Measurement, Source, gridded};
use palpate::refusal::Refusal;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::classes::{ForceMap, Phantom};
use crate::convert::{Any, doubt_metres, finite_forces, floats, in_unit, list, pair, refused, si};

/// The map of forces that were measured at any poses, jittered or scattered, as palpate import-map makes it: put on a grid by planes
/// through the samples near each pose, and smoothed if that is asked. Forces on a grid are a ForceMap already.
#[doc = sections!(
    depths_mm: "array_like, shape (n,)" = "Depth of the probe at each sample, mm.",
    laterals_mm: "array_like, shape (n,)" = "Lateral position at each sample, mm.",
    forces_n,
    grid_mm: "float or (float, float)" = "Step of the grid, or those of depth and lateral position, mm.",
    smooth_mm: "float, optional" = "Half-width of parabolas over the lateral positions that smooth the forces, mm.",
    phantom: "Phantom, optional" = "What was measured, if that is known.",
    note: "str, optional" = "What is known beside N and mm.";
    "(ForceMap, dict)" = "The map, and what was found: largest_shift_mm, of a sample from the grid, (depth, lateral), mm; residual_n, root mean square of what the planes leave, (lateral, normal), N; noise_sd_n, (lateral, normal), N, and degrees_of_freedom of the smoothing, or None.";
    "A pose of the grid without a sample, too narrow a window, or a sample that is not finite."
)]
/// Examples
/// --------
/// >>> depths, laterals = np.repeat([1.0, 2.0, 3.0], 50), np.tile(np.linspace(-8, 8, 50), 3)
/// >>> measured, found = import_map(depths + 0.02, laterals, 0.4 * depths, grid_mm=(1, 2))
/// >>> measured.laterals_mm.size, round(found["largest_shift_mm"][0], 3)
/// (9, 0.02)
// Implements: PYT-053.
#[pyfunction]
#[pyo3(signature = (depths_mm, laterals_mm, forces_n, grid_mm, smooth_mm=None, phantom=None, note=""))]
#[allow(clippy::too_many_arguments, reason = "keywords in Python")]
pub fn import_map<'py>(
    py: Python<'py>,
    depths_mm: Any<'_, 'py>,
    laterals_mm: Any<'_, 'py>,
    forces_n: Any<'_, 'py>,
    grid_mm: Any<'_, 'py>,
    smooth_mm: Option<f64>,
    phantom: Option<&Phantom>,
    note: &str,
) -> PyResult<(ForceMap, Bound<'py, PyDict>)> {
    let mut measurement = Measurement::new("", note);
    let steps = pair("grid_mm", grid_mm)?.into_array();
    let steps = [si("grid_mm", steps[0], -3)?, si("grid_mm", steps[1], -3)?];
    let (samples, has_lateral) = samples(depths_mm, laterals_mm, forces_n)?;
    let found = py.detach(|| gridded(&samples, has_lateral, steps));
    let found = found.map_err(refused)?;
    measurement.grid = Some(steps);
    let told = PyDict::new(py);
    told.set_item(
        "largest_shift_mm",
        found.largest_shift.map(|of| in_unit(of, 3)),
    )?;
    told.set_item("residual_n", found.residual.into_array())?;
    let (mut table, mut noise) = (found.table, None);
    if let Some(half_width) = smooth_mm {
        let wrong = Refusal::value("smooth_mm", half_width, "finite and greater than 0");
        wrong
            .when(!(half_width > 0.0 && half_width.is_finite()))
            .map_err(refused)?;
        let half_width = si("smooth_mm", half_width, -3)?;
        let smoothed = table.smoothed(half_width).map_err(refused)?;
        measurement.smoothed_half_width = Some(half_width);
        noise = Some((smoothed.noise_sd.into_array(), smoothed.degrees_of_freedom));
        table = smoothed.table;
    }
    told.set_item("noise_sd_n", noise.map(|of| of.0))?;
    told.set_item("degrees_of_freedom", noise.map(|of| of.1))?;
    let phantom = phantom.map(|phantom| phantom.0.clone());
    let map = force_map::ForceMap::new(Source::Measured(measurement), phantom, table);
    Ok((ForceMap(map.map_err(refused)?), told))
}

/// Depth and lateral position (m), normal and lateral force (N) of each sample, and whether it has the last.
fn samples(depths_mm: Any, laterals_mm: Any, forces_n: Any) -> PyResult<(Vec<[f64; 4]>, bool)> {
    let names = ["depths_mm", "laterals_mm"];
    let axes = [depths_mm, laterals_mm];
    for (name, axis) in names.iter().zip(axes) {
        doubt_metres(axis.py(), name, floats(name, axis)?.as_slice()?)?;
    }
    let depths = list(names[0], depths_mm, -3)?;
    let laterals = list(names[1], laterals_mm, -3)?;
    let Force { lateral, normal } = finite_forces("forces_n", forces_n)?;
    let lengths = [depths.len(), laterals.len(), normal.len()];
    let found = format!("depths_mm, laterals_mm and forces_n have {lengths:?} samples");
    let differ = Refusal::state(
        found,
        "give a depth, a lateral position and a force of each",
    );
    differ.when(lengths != [lengths[0]; 3]).map_err(refused)?;
    let force = |at: usize| lateral.get(at).copied().unwrap_or(0.0);
    let sample = |at| [depths[at], laterals[at], normal[at], force(at)];
    Ok(((0..depths.len()).map(sample).collect(), !lateral.is_empty()))
}
