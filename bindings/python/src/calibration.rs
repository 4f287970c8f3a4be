//! Force–depth curves.

use palpate::calibration::{self, CalibrationQuestion, Curve, Indentation};
use pyo3::prelude::*;

use crate::classes::Phantom;
use crate::convert::{Any, interruptible, lengths, list, python, refused, si};

/// What a force-depth curve says of a gel: the answer of palpate calibrate for one curve.
#[doc = sections!(
    depths_mm: "array_like, shape (n,)" = "Depths that grow into the gel from any zero, mm.",
    forces_n: "array_like, shape (n,)" = "Normal forces, N.",
    times_s: "array_like, shape (n,), optional" = "Times of the samples, for relaxation, s.",
    phantom: "Phantom, optional" = "The gel and the probe; by default an empirical law is fitted.",
    layers: "sequence of int, optional" = "Layers, from 0, whose moduli are found; by default one factor of all moduli.",
    lateral_mm: "float, optional" = "Where the probe goes down, mm.",
    contact_mm: "float, optional" = "Where it touches the gel, on the depths, mm; by default it is estimated.",
    mesh_mm;
    "dict" = "The JSON of palpate calibrate, in SI, with cause and remedy; and phantom, with the moduli that were found, or None.";
    "No curve, or a layer that the phantom does not have."
)]
// Implements: PYT-031.
#[pyfunction]
#[pyo3(signature = (depths_mm, forces_n, times_s=None, phantom=None, layers=vec![], lateral_mm=0.0, contact_mm=None, mesh_mm=0.5),
    text_signature = "(depths_mm, forces_n, times_s=None, phantom=None, layers=(), lateral_mm=0.0, contact_mm=None, mesh_mm=0.5)")]
#[allow(clippy::too_many_arguments, reason = "keywords in Python")]
pub fn calibrate<'py>(
    py: Python<'py>,
    depths_mm: Any<'_, 'py>,
    forces_n: Any<'_, 'py>,
    times_s: Option<Any<'_, 'py>>,
    phantom: Option<&Phantom>,
    layers: Vec<usize>,
    lateral_mm: f64,
    contact_mm: Option<f64>,
    mesh_mm: f64,
) -> PyResult<Bound<'py, PyAny>> {
    let (depths, forces) = (
        lengths("depths_mm", depths_mm)?,
        list("forces_n", forces_n, 0)?,
    );
    let times = times_s.map(|times| list("times_s", times, 0)).transpose()?;
    let curve = Curve::new("curve", times.as_deref(), &depths, &forces).map_err(refused)?;
    let lateral = si("lateral_mm", lateral_mm, -3)?;
    let mesh_size = si("mesh_mm", mesh_mm, -3)?;
    let contact = contact_mm
        .map(|contact| si("contact_mm", contact, -3))
        .transpose()?;
    let is_of_gel = !layers.is_empty() || lateral != 0.0;
    if phantom.is_none() && is_of_gel {
        return Err(refused("layers and lateral_mm need a phantom"));
    }
    let own = phantom.map(|phantom| phantom.0.clone());
    let (rows, calibrated) = interruptible(py, move || {
        let indentation = Indentation {
            layers: &layers,
            lateral,
            mesh_size,
        };
        let gel = own.as_ref().map(|own| (own, indentation));
        let question = CalibrationQuestion { gel, contact };
        let found = calibration::calibrate(&curve, question).map_err(refused)?;
        let moduli = found.moduli(&layers).map_err(refused)?;
        let own = own.as_ref().filter(|_| !moduli.is_empty());
        let calibrated = own.map(|own| calibration::calibrated(own, &layers, &moduli));
        let calibrated = calibrated.transpose().map_err(refused)?;
        Ok((found.rows(&layers).map_err(refused)?, calibrated))
    })?;
    let told = python(py, &rows)?;
    told.set_item("phantom", calibrated.map(Phantom))?;
    Ok(told)
}
