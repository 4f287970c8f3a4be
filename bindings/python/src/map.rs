//! Force maps.

use std::path::PathBuf;

use numpy::PyUntypedArrayMethods;
use palpate::force::Force;
use palpate::force_map::{self, ForceTable, Matrix, Measurement, Source};
use palpate::refusal::Refusal;
use pyo3::prelude::*;

use crate::classes::{ForceMap, Phantom};
use crate::convert::{
    Any, array, array_in_unit, channels, each, floats, in_unit, list, python, refused, scaled, si,
    wrong_shape,
};

/// The matrix of an array of shape (m, n).
fn matrix(name: &str, values: Any) -> PyResult<Matrix> {
    let values = floats(name, values)?;
    let matrix = match *values.shape() {
        [_, columns] => Matrix::new(columns, values.as_slice()?.to_vec()),
        _ => None,
    };
    matrix.ok_or_else(|| wrong_shape(name, values.shape(), "[m, n]"))
}

impl ForceMap {
    fn forces<'py>(&self, py: Python<'py>, forces: &Matrix) -> PyResult<Bound<'py, PyAny>> {
        let shape = [forces.row_count(), forces.column_count()];
        array(py, &shape, forces.values().to_vec())
    }

    /// The component `of` of the force at poses in mm.
    fn component<'py>(
        &self,
        poses: [Any<'_, 'py>; 2],
        of: fn(Force<f64>) -> f64,
    ) -> PyResult<Bound<'py, PyAny>> {
        let names = ["depth_mm", "lateral_mm"];
        each(names, poses, |pose| {
            let [depth, lateral] = [0, 1].map(|axis| scaled(names[axis], pose[axis], -3));
            Ok::<f64, Refusal>(of(self.0.table().force(depth?, lateral?)?))
        })
    }
}

#[pymethods]
impl ForceMap {
    #[new]
    #[pyo3(signature = (depths_mm, laterals_mm, lateral_n, normal_n, phantom=None, note=""))]
    fn new(
        depths_mm: Any,
        laterals_mm: Any,
        lateral_n: Option<Any>,
        normal_n: Any,
        phantom: Option<&Phantom>,
        note: &str,
    ) -> PyResult<ForceMap> {
        let depths = list("depths_mm", depths_mm, -3)?;
        let laterals = list("laterals_mm", laterals_mm, -3)?;
        let lateral = lateral_n.map(|lateral| matrix("lateral_n", lateral));
        let (normal, lateral) = (matrix("normal_n", normal_n)?, lateral.transpose()?);
        let table = ForceTable::of_channels(depths, laterals, normal, lateral).map_err(refused)?;
        let source = Source::Measured(Measurement::new("", note));
        let phantom = phantom.map(|phantom| phantom.0.clone());
        let map = force_map::ForceMap::new(source, phantom, table);
        Ok(ForceMap(map.map_err(refused)?))
    }

    /// The map in a file: measured forces if its name ends in .csv, else JSON as palpate solve writes it.
    #[staticmethod]
    fn read(path: PathBuf) -> PyResult<ForceMap> {
        Ok(ForceMap(force_map::ForceMap::read(&path).map_err(refused)?))
    }

    /// Writes the map to a file: poses and forces alone (mm, N) if its name ends in .csv, else JSON, which keeps everything.
    fn write(&self, path: PathBuf) -> PyResult<()> {
        let csv = path
            .extension()
            .is_some_and(|end| end.eq_ignore_ascii_case("csv"));
        let text = match csv {
            true => self.0.table().to_csv(),
            false => self.0.to_json(),
        };
        Ok(std::fs::write(path, text)?)
    }

    /// The depths, mm: shape (m,).
    #[getter]
    fn depths_mm<'py>(&self, py: Python<'py>) -> Bound<'py, PyAny> {
        array_in_unit(py, self.0.table().depths(), 3)
    }

    /// The lateral positions, mm: shape (n,).
    #[getter]
    fn laterals_mm<'py>(&self, py: Python<'py>) -> Bound<'py, PyAny> {
        array_in_unit(py, self.0.table().laterals(), 3)
    }

    /// The lateral forces along +x, N: shape (m, n); None if the map has none.
    #[getter]
    fn lateral_n<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyAny>>> {
        let lateral = self.0.table().lateral();
        lateral.map(|forces| self.forces(py, forces)).transpose()
    }

    /// The normal forces out of the gel, N: shape (m, n).
    #[getter]
    fn normal_n<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.forces(py, self.0.table().normal())
    }

    /// The phantom, if it is known.
    #[getter]
    fn phantom(&self) -> Option<Phantom> {
        self.0.phantom().cloned().map(Phantom)
    }

    /// How good the computation was, as a dictionary with the keys of spec/force-map.md in SI units; None for measured forces.
    #[getter]
    fn certificate<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyAny>>> {
        let certificate = self.0.certificate();
        certificate
            .map(|certificate| python(py, certificate))
            .transpose()
    }

    /// The forces at a depth of the map, in mm: shape (2, n), lateral and normal, N.
    fn row<'py>(&self, py: Python<'py>, depth_mm: f64) -> PyResult<Bound<'py, PyAny>> {
        let depth = si("depth_mm", depth_mm, -3)?;
        channels(py, self.0.table().row(depth).map_err(refused)?)
    }

    /// The forces expected along a sweep at a depth, in mm, at laterals_mm, shape (n,), in mm: linear between the poses of the map, refused
    /// beyond them. Shape (2, n), lateral and normal, N; (n,), normal alone, if the map has no lateral forces.
    fn sweep<'py>(
        &self,
        py: Python<'py>,
        depth_mm: f64,
        laterals_mm: Any<'_, 'py>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let depth = si("depth_mm", depth_mm, -3)?;
        let laterals = list("laterals_mm", laterals_mm, -3)?;
        channels(py, self.0.table().sweep(depth, &laterals).map_err(refused)?)
    }

    /// The forces (lateral, normal) in N at poses in mm, numbers or arrays that broadcast: bilinear between the poses of the map, and
    /// beyond them as its last cell goes on.
    fn force<'py>(
        &self,
        depth_mm: Any<'_, 'py>,
        lateral_mm: Any<'_, 'py>,
    ) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyAny>)> {
        let poses = [depth_mm, lateral_mm];
        let lateral = self.component(poses, |force| force.lateral)?;
        Ok((lateral, self.component(poses, |force| force.normal)?))
    }

    fn __repr__(&self) -> String {
        let (depths, laterals) = (self.0.table().depths(), self.0.table().laterals());
        let phantom = self.0.phantom().map_or("unknown", |phantom| phantom.name());
        let [from, to] = [laterals[0], laterals[laterals.len() - 1]].map(|x| in_unit(x, 3));
        let (rows, columns) = (depths.len(), laterals.len());
        format!(
            "<ForceMap of phantom {phantom:?}: {rows} depths, {columns} lateral positions from {from} to {to} mm>"
        )
    }
}
