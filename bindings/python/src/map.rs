//! Force maps.

use std::path::PathBuf;

use numpy::PyUntypedArrayMethods;
use palpate::force::Force;
use palpate::force_map::{self, ForceTable, Matrix, Measurement, SAME_POSITION, Source};
use palpate::refusal::Refusal;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use crate::classes::{ForceMap, Phantom};
use crate::convert::{
    Any, array, array_in_unit, axis, channels, doubt_metres, each, floats, html, in_unit, lengths,
    python, refused, remade, scaled, si, wrong_shape,
};

/// The columns that a notebook shows at most.
const COLUMNS: usize = 12;

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

    /// The force at a pose in m, N: none in air, and a line from there to the first depth.
    ///
    /// Implements: PYT-040.
    pub fn at(&self, depth: f64, lateral: f64) -> Result<Force<f64>, Refusal> {
        let table = self.0.table();
        table.both()?;
        let first = table.depths()[0];
        if depth < 0.0 || depth == 0.0 && first > 0.0 {
            return Ok(Force::new(0.0, 0.0));
        }
        let (row, share) = match depth < first - SAME_POSITION {
            true => (first, depth / first),
            false => (depth, 1.0),
        };
        let force = table.sweep(row, &[lateral])?;
        Ok(force.map(|of| share * of[0]))
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
            Ok::<f64, Refusal>(of(self.at(depth?, lateral?)?))
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
        let depths = axis("depths_mm", depths_mm)?;
        let laterals = axis("laterals_mm", laterals_mm)?;
        let lateral = lateral_n.map(|lateral| matrix("lateral_n", lateral));
        let (normal, lateral) = (matrix("normal_n", normal_n)?, lateral.transpose()?);
        let table = ForceTable::of_channels(depths, laterals, normal, lateral).map_err(refused)?;
        let source = Source::Measured(Measurement::new("", note));
        let phantom = phantom.map(|phantom| phantom.0.clone());
        let map = force_map::ForceMap::new(source, phantom, table);
        Ok(ForceMap(map.map_err(refused)?))
    }

    /// The map in a file: measured forces if its name ends in .csv, else JSON as palpate solve writes it.
    #[doc = sections!(path; "ForceMap" = "The map, N."; "No such file, or one that is no map, with line and key.")]
    #[staticmethod]
    fn read(path: PathBuf) -> PyResult<ForceMap> {
        Ok(ForceMap(force_map::ForceMap::read(&path).map_err(refused)?))
    }

    /// The map of a JSON text, as to_json gives it.
    #[doc = sections!(text; "ForceMap" = "The map, with all of its digits."; "A text that is no map, with line and key.")]
    #[staticmethod]
    fn from_json(text: &str) -> PyResult<ForceMap> {
        let map = force_map::ForceMap::from_json(text, "text");
        Ok(ForceMap(map.map_err(refused)?))
    }

    /// The map as JSON, with all of its digits; lengths are in m, forces in N.
    fn to_json(&self) -> String {
        self.0.to_json()
    }

    /// Writes the map to a file: poses and forces alone (mm, N) if its name ends in .csv, else JSON, which keeps everything.
    #[doc = sections!(path;;)]
    fn write(&self, path: PathBuf) -> PyResult<()> {
        let csv = path
            .extension()
            .is_some_and(|end| end.eq_ignore_ascii_case("csv"));
        let text = match csv {
            true => self.0.table().to_csv(),
            false => self.0.to_json(),
        };
        Ok(palpate::file::write(&path, &text)?)
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

    /// What is known of measured forces beside N and mm; empty for computed ones.
    #[getter]
    fn note(&self) -> &str {
        match self.0.source() {
            Source::Measured(measurement) => &measurement.note,
            Source::FiniteElements { .. } => "",
        }
    }

    /// The phantom, if it is known.
    #[getter]
    fn phantom(&self) -> Option<Phantom> {
        self.0.phantom().cloned().map(Phantom)
    }

    /// How good the computation was, as a dictionary whose keys state their SI units; None for measured forces.
    #[getter]
    fn certificate<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyAny>>> {
        let certificate = self.0.certificate();
        certificate
            .map(|certificate| python(py, certificate))
            .transpose()
    }

    /// The forces at a depth of the map.
    #[doc = sections!(
        depth_mm: "float" = "One of depths_mm, mm.";
        "ndarray, shape (2, n)" = "Lateral and normal forces, N.";
        "A depth that is not in the map, or a map without lateral forces."
    )]
    fn row<'py>(&self, py: Python<'py>, depth_mm: f64) -> PyResult<Bound<'py, PyAny>> {
        let depth = si("depth_mm", depth_mm, -3)?;
        channels(py, self.0.table().row(depth).map_err(refused)?)
    }

    /// The forces expected along a sweep at one depth, linear between the poses of the map.
    #[doc = sections!(
        depth_mm,
        laterals_mm: "array_like, shape (n,)" = "Lateral positions of the probe, mm.";
        "ndarray, shape (2, n) or (n,)" = "Lateral and normal forces, or normal ones alone if the map has no others, N.";
        "A pose beyond the map."
    )]
    fn sweep<'py>(
        &self,
        py: Python<'py>,
        depth_mm: f64,
        laterals_mm: Any<'_, 'py>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let depth = si("depth_mm", depth_mm, -3)?;
        doubt_metres(py, "depth_mm", &[depth_mm])?;
        let laterals = lengths("laterals_mm", laterals_mm)?;
        channels(py, self.0.table().sweep(depth, &laterals).map_err(refused)?)
    }

    /// The forces at poses that broadcast: bilinear between the poses of the map, zero in air (depth_mm <= 0), and a line from the surface to
    /// the first depth.
    #[doc = sections!(
        depth_mm: "float or array_like" = "Depth of the probe, mm.",
        lateral_mm: "float or array_like" = "Lateral position of the probe, mm.";
        "(float, float) or (ndarray, ndarray)" = "Lateral and normal force, N, of the shape of the poses.";
        "A pose beyond the map, or a map without lateral forces."
    )]
    fn force<'py>(
        &self,
        py: Python<'py>,
        depth_mm: Any<'_, 'py>,
        lateral_mm: Any<'_, 'py>,
    ) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyAny>)> {
        doubt_metres(py, "depth_mm", floats("depth_mm", depth_mm)?.as_slice()?)?;
        let poses = [depth_mm, lateral_mm];
        let lateral = self.component(poses, |force| force.lateral)?;
        Ok((lateral, self.component(poses, |force| force.normal)?))
    }

    /// A pandas DataFrame with a row for each pose: depth_mm and lateral_mm in mm, lateral_n (if the map has it) and normal_n in N; needs pandas.
    // Implements: PYT-045.
    fn to_pandas<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let table = self.0.table();
        let (depths, laterals) = (table.depths(), table.laterals());
        let columns = PyDict::new(py);
        let (across, down) = (laterals.len(), depths.len());
        let each = depths.iter().flat_map(|&depth| vec![depth; across]);
        columns.set_item("depth_mm", array_in_unit(py, &each.collect::<Vec<_>>(), 3))?;
        columns.set_item("lateral_mm", array_in_unit(py, &laterals.repeat(down), 3))?;
        if let Some(lateral) = table.lateral() {
            columns.set_item("lateral_n", lateral.values())?;
        }
        columns.set_item("normal_n", table.normal().values())?;
        py.import("pandas")?.call_method1("DataFrame", (columns,))
    }

    /// An xarray Dataset of lateral_n and normal_n, N, over depth_mm and lateral_mm; needs xarray and pandas.
    // Implements: PYT-045.
    fn to_xarray<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        py.import("xarray")?;
        let frame = self.to_pandas(py)?;
        let frame = frame.call_method1("set_index", (["depth_mm", "lateral_mm"],))?;
        frame.call_method0("to_xarray")
    }

    /// Draws the normal forces, N, over lateral position and depth, mm; needs Matplotlib.
    #[doc = sections!(
        ax,
        of: "array_like, shape (m, n), optional" = "What to draw instead, such as the difference from another map, N.";
        "matplotlib Axes" = "Where it was drawn.";
    )]
    // Implements: PYT-045.
    #[pyo3(signature = (ax=None, of=None))]
    fn plot<'py>(
        &self,
        py: Python<'py>,
        ax: Option<Bound<'py, PyAny>>,
        of: Option<Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let ax = axes(py, ax)?;
        let options = PyDict::new(py);
        options.set_item("shading", "nearest")?;
        let forces = of.map_or_else(|| self.normal_n(py), Ok)?;
        let grid = (self.laterals_mm(py), self.depths_mm(py), forces);
        let drawn = ax.call_method("pcolormesh", grid, Some(&options))?;
        ax.call_method1("set_xlabel", ("lateral position, mm",))?;
        ax.call_method1("set_ylabel", ("depth, mm",))?;
        if !ax.call_method0("yaxis_inverted")?.extract::<bool>()? {
            ax.call_method0("invert_yaxis")?;
        }
        options.clear();
        options.set_item("ax", &ax)?;
        options.set_item("label", "force, N")?;
        let figure = ax.call_method0("get_figure")?;
        figure.call_method("colorbar", (drawn,), Some(&options))?;
        Ok(ax)
    }

    /// The forces as an array for NumPy, N: shape (2, m, n), lateral ones first, or (m, n), normal ones alone.
    // Implements: PYT-045.
    #[pyo3(signature = (dtype=None, copy=None))]
    fn __array__<'py>(
        &self,
        py: Python<'py>,
        dtype: Option<Bound<'py, PyAny>>,
        copy: Option<bool>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let _ = copy; // It always is one.
        let (lateral, normal) = (self.lateral_n(py)?, self.normal_n(py)?);
        let asarray = py.import("numpy")?.getattr("asarray")?;
        match lateral {
            Some(lateral) => asarray.call1(((lateral, normal), dtype)),
            None => asarray.call1((normal, dtype)),
        }
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyTuple>> {
        remade(slf, "from_json", slf.get().0.to_json())
    }

    // Implements: PYT-044.
    fn _repr_html_(&self) -> String {
        let table = self.0.table();
        let laterals = table.laterals();
        let shown = (0..laterals.len()).step_by(laterals.len().div_ceil(COLUMNS));
        let shown: Vec<usize> = shown.collect();
        let head = |&at: &usize| format!("{} mm", in_unit(laterals[at], 3));
        let heads = std::iter::once("normal force, N".into()).chain(shown.iter().map(head));
        let row = |(depth, forces): (&f64, &[f64])| {
            let depth = format!("{} mm", in_unit(*depth, 3));
            let forces = shown.iter().map(|&at| format!("{:.3}", forces[at]));
            std::iter::once(depth).chain(forces).collect()
        };
        let rows: Vec<_> = table
            .depths()
            .iter()
            .zip(table.normal().rows())
            .map(row)
            .collect();
        html(&self.__repr__(), &heads.collect::<Vec<_>>(), &rows)
    }

    fn __repr__(&self) -> String {
        let table = self.0.table();
        let ends = |axis: &[f64]| {
            let [from, to] = [axis[0], axis[axis.len() - 1]].map(|x| in_unit(x, 3));
            format!("{} from {from} to {to} mm", axis.len())
        };
        let (depths, laterals) = (ends(table.depths()), ends(table.laterals()));
        let normal = table.normal().values().iter();
        let [least, most] = normal.fold(
            [f64::INFINITY, f64::NEG_INFINITY],
            |[least, most], &force| [least.min(force), most.max(force)],
        );
        let phantom = self.0.phantom().map_or("unknown", |phantom| phantom.name());
        format!(
            "<ForceMap of phantom {phantom:?}: depths {depths}, lateral positions {laterals}, normal force {least:.3} to {most:.3} N>"
        )
    }
}

/// `ax`, or Matplotlib's current axes.
pub fn axes<'py>(py: Python<'py>, ax: Option<Bound<'py, PyAny>>) -> PyResult<Bound<'py, PyAny>> {
    let current = || py.import("matplotlib.pyplot")?.call_method0("gca");
    ax.map_or_else(current, Ok)
}
