//! Phantoms, and the forces on the probe over them.

use std::cell::RefCell;
use std::path::PathBuf;
use std::sync::Arc;

use palpate::fem::certify::certified_map;
use palpate::fem::{Contact, FemError, Model, Pose};
use palpate::force::Force;
use palpate::phantom;
use palpate::refusal::Refusal;
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyFloat, PyTuple, PyType};
use rayon::prelude::*;
use toml::Table;

use crate::classes::{ForceMap, Phantom};
use crate::convert::{
    Any, array, axis, broadcast, doubt_metres, floats, html, in_unit, interruptible, json, on_all,
    python, refused, remade, scaled, si, tell,
};

/// The contact law of a name.
pub fn contact(name: &str) -> PyResult<Contact> {
    let known = [Contact::DeformedNormal, Contact::VerticalGap];
    let found = known.into_iter().find(|contact| contact.name() == name);
    let expected = known.map(Contact::name).join(" or ");
    found.ok_or_else(|| refused(Refusal::value("contact", format!("{name:?}"), expected)))
}

/// A force on the probe, N: lateral, normal = force.
#[doc = sections!(
    lateral_n: "float" = "Along +x, N.",
    normal_n: "float" = "Out of the gel, N.";;
)]
#[pyclass(frozen, get_all, module = "palpate")]
pub struct ProbeForce {
    /// Along +x, N.
    lateral_n: f64,
    /// Out of the gel, N.
    normal_n: f64,
}

#[pymethods]
impl ProbeForce {
    #[new]
    fn new(lateral_n: f64, normal_n: f64) -> PyResult<ProbeForce> {
        Ok(ProbeForce {
            lateral_n: si("lateral_n", lateral_n, 0)?,
            normal_n: si("normal_n", normal_n, 0)?,
        })
    }

    fn __iter__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let both = (self.lateral_n, self.normal_n).into_pyobject(py)?;
        both.call_method0("__iter__")
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> (Bound<'py, PyType>, (f64, f64)) {
        let of = slf.get();
        (slf.get_type(), (of.lateral_n, of.normal_n))
    }

    fn __repr__(&self) -> String {
        let ProbeForce {
            lateral_n,
            normal_n,
        } = self;
        format!("ProbeForce(lateral_n={lateral_n:?}, normal_n={normal_n:?})")
    }
}

/// The phantom of the tables of a phantom file.
fn of_tables(tables: &Table) -> PyResult<Phantom> {
    let text = toml::to_string(tables).map_err(refused)?;
    // No line: nobody has the text.
    let phantom = phantom::Phantom::from_toml(&text, "").map_err(|refusal| Refusal {
        line: None,
        ..refusal
    });
    Ok(Phantom(phantom.map_err(refused)?))
}

/// The key of the phantom file that a keyword names: layer_1_thickness_mm is layer[1].thickness_mm.
fn key(phantom: &phantom::Phantom, keyword: &str) -> PyResult<String> {
    let Some((table, key)) = keyword.split_once('_') else {
        return Ok(keyword.into());
    };
    let many = match table {
        "layer" => phantom.layers().len(),
        "inclusion" => phantom.inclusions().len(),
        _ => return Ok(format!("{table}.{key}")),
    };
    let numbered = key.split_once('_');
    let numbered = numbered.and_then(|(at, key)| Some((at.parse::<usize>().ok()?, key)));
    match numbered {
        None if many == 1 => Ok(format!("{table}[0].{key}")),
        Some((at, key)) if at < many => Ok(format!("{table}[{at}].{key}")),
        _ => {
            let found = format!("{keyword}: the phantom has {many} of these");
            // Without what stands where the number should: layer_gel_thickness_mm.
            let rest = numbered.map_or(key, |(_, rest)| rest);
            let known = ["thickness_mm", "diameter_mm", "depth_mm", "centre_x_mm"];
            let known = known
                .into_iter()
                .chain(["youngs_modulus_kpa", "poisson_ratio"]);
            let key = known.into_iter().find(|known| rest.ends_with(known));
            let expected = format!("say which, from 0, as in {table}_0_{}", key.unwrap_or(rest));
            Err(refused(Refusal::state(found, expected)))
        }
    }
}

/// A phantom, meshed and factorised; lengths in mm.
fn model(phantom: &phantom::Phantom, mesh_mm: f64, contact_name: &str) -> PyResult<Model> {
    let (size, contact) = (si("mesh_mm", mesh_mm, -3)?, contact(contact_name)?);
    Model::new(phantom, size, contact).map_err(refused)
}

/// The forces at poses, N, on all processors, a few at a time, so that this thread hears of Ctrl-C.
fn solved(py: Python<'_>, model: Arc<Model>, poses: &[Pose]) -> PyResult<Vec<Force<f64>>> {
    let mut forces = Vec::with_capacity(poses.len());
    for few in poses.chunks(on_all(rayon::current_num_threads)?) {
        py.check_signals()?;
        let (model, few) = (model.clone(), few.to_vec());
        forces.extend(interruptible(py, move || {
            let found = few.par_iter().map(|&pose| Ok(model.solve(pose)?.force));
            let found: Result<Vec<_>, FemError> = on_all(|| found.collect())?;
            found.map_err(refused)
        })?);
    }
    Ok(forces)
}

impl Phantom {
    fn tables(&self) -> PyResult<Table> {
        self.0.to_toml().parse().map_err(refused)
    }
}

#[pymethods]
impl Phantom {
    #[new]
    #[pyo3(signature = (name, /, **edits))]
    fn new(name: &Bound<PyAny>, edits: Option<&Bound<PyDict>>) -> PyResult<Phantom> {
        let Ok(text) = name.extract::<String>() else {
            let message = format!("name is {name}, but must be a text, such as \"6.6\"");
            return Err(PyTypeError::new_err(message));
        };
        Phantom(phantom::Phantom::builtin(&text).map_err(refused)?).edited(edits)
    }

    /// The phantom in a TOML text or file, in mm and kPa.
    #[doc = sections!(
        text_or_path: "str or PathLike" = "The text, if it is a str with a line break, else the file.";
        "Phantom" = "What the text describes.";
        "No such file, or a text that is no phantom, with line and key."
    )]
    #[staticmethod]
    fn from_toml(text_or_path: &Bound<PyAny>) -> PyResult<Phantom> {
        let text = text_or_path.extract::<String>().ok();
        let phantom = match text.filter(|text| text.contains('\n')) {
            Some(text) => phantom::Phantom::from_toml(&text, ""),
            None => phantom::Phantom::read(&text_or_path.extract::<PathBuf>()?),
        };
        Ok(Phantom(phantom.map_err(refused)?))
    }

    /// The phantom of a dictionary with the keys of a phantom file, in mm and kPa.
    #[doc = sections!(
        tables: "dict" = "As to_dict gives it, mm and kPa.";
        "Phantom" = "What the dictionary describes.";
        "A dictionary that is no phantom, with the key."
    )]
    #[staticmethod]
    fn from_dict(tables: &Bound<PyDict>) -> PyResult<Phantom> {
        of_tables(&serde_json::from_str(&json(tables)?).map_err(refused)?)
    }

    /// A copy with other numbers, named as in Phantom(name, ...), in mm and kPa.
    #[doc = sections!(edits; "Phantom" = "The copy."; "A name or a number that the phantom cannot have.")]
    #[pyo3(signature = (**edits))]
    fn edited(&self, edits: Option<&Bound<PyDict>>) -> PyResult<Phantom> {
        let Some(edits) = edits else {
            return Ok(Phantom(self.0.clone()));
        };
        for (keyword, value) in edits {
            if let Ok(number) = value.extract::<f64>() {
                si(&keyword.to_string(), number, 0)?;
            }
        }
        let edits: Table = serde_json::from_str(&json(edits)?).map_err(refused)?;
        let keyed = edits
            .iter()
            .map(|(keyword, value)| Ok((key(&self.0, keyword)?, value)));
        let keyed = keyed.collect::<PyResult<Vec<_>>>()?;
        Ok(Phantom(self.0.set(keyed).map_err(refused)?))
    }

    /// The text of a phantom file, in mm and kPa.
    fn to_toml(&self) -> String {
        self.0.to_toml()
    }

    /// A dictionary with the keys of a phantom file, in mm and kPa.
    fn to_dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        python(py, &self.tables()?)
    }

    /// The name of the phantom.
    #[getter]
    fn name(&self) -> &str {
        self.0.name()
    }

    /// The height of the outer surface above the floor, mm.
    #[getter]
    fn height_mm(&self) -> f64 {
        in_unit(self.0.height(), 3)
    }

    /// The depth of the highest point of all inclusions, mm; None without any.
    #[getter]
    fn inclusion_depth_mm(&self) -> Option<f64> {
        Some(in_unit(self.0.inclusion_depth()?, 3))
    }

    /// The force on the probe at a pose, or at poses that broadcast, by finite elements.
    #[doc = sections!(
        depth_mm: "float or array_like" = "Depth of the probe's lowest point below the surface, mm.",
        lateral_mm: "float or array_like, optional" = "Lateral position of the probe, mm.",
        mesh_mm, contact;
        "ProbeForce, or ndarray, shape (2, ...)" = "The force of one pose, or those of the shape of the poses, lateral ones first, N.";
        "A pose that the probe cannot have, a mesh that is too fine, or no equilibrium."
    )]
    /// Examples
    /// --------
    /// >>> lateral, normal = Phantom("6.6").solve([2, 4], 0, mesh_mm=2)
    /// >>> normal.shape
    /// (2,)
    // Implements: PYT-010, PYT-050.
    #[pyo3(signature = (depth_mm, lateral_mm=None, mesh_mm=0.5, contact="deformed-normal"),
        text_signature = "($self, depth_mm, lateral_mm=0.0, mesh_mm=0.5, contact='deformed-normal')")]
    fn solve<'py>(
        &self,
        py: Python<'py>,
        depth_mm: Any<'_, 'py>,
        lateral_mm: Option<Any<'_, 'py>>,
        mesh_mm: f64,
        contact: &str,
    ) -> PyResult<Bound<'py, PyAny>> {
        let middle = PyFloat::new(py, 0.0).into_any();
        let arguments = [depth_mm, lateral_mm.unwrap_or(&middle)];
        let names = ["depth_mm", "lateral_mm"];
        doubt_metres(py, names[0], floats(names[0], depth_mm)?.as_slice()?)?;
        // Before the model is made: a pose that cannot be is cheap to refuse.
        let (shape, poses) = broadcast(names, arguments, |pose| {
            let [depth, lateral] = [0, 1].map(|axis| scaled(names[axis], pose[axis], -3));
            let (depth, lateral) = (depth?, lateral?);
            self.0.check_pose(depth, lateral)?;
            Ok::<Pose, Refusal>(Pose { depth, lateral })
        })?;
        let (phantom, contact) = (self.0.clone(), contact.to_owned());
        let model = interruptible(py, move || model(&phantom, mesh_mm, &contact))?;
        let forces = solved(py, Arc::new(model), &poses)?;
        if let ([], [force]) = (&shape[..], &forces[..]) {
            let force = ProbeForce {
                lateral_n: force.lateral,
                normal_n: force.normal,
            };
            return Ok(Bound::new(py, force)?.into_any());
        }
        let lateral = forces.iter().map(|force| force.lateral);
        let both = lateral.chain(forces.iter().map(|force| force.normal));
        array(py, &[&[2], &shape[..]].concat(), both.collect())
    }

    /// Writes the deformed mesh of a pose, with displacements, stresses and pressure, m and Pa, as a .vtu file for ParaView, PyVista and meshio.
    /// A file that is there is overwritten.
    #[doc = sections!(
        path, depth_mm, own_lateral_mm, mesh_mm, contact;;
        "As solve; an axisymmetric phantom."
    )]
    // Implements: PYT-055.
    #[pyo3(signature = (path, depth_mm, lateral_mm=0.0, mesh_mm=0.5, contact="deformed-normal"))]
    fn write_vtu(
        &self,
        py: Python<'_>,
        path: PathBuf,
        depth_mm: f64,
        lateral_mm: f64,
        mesh_mm: f64,
        contact: &str,
    ) -> PyResult<()> {
        doubt_metres(py, "depth_mm", &[depth_mm])?;
        let (depth, lateral) = (
            si("depth_mm", depth_mm, -3)?,
            si("lateral_mm", lateral_mm, -3)?,
        );
        self.0.check_pose(depth, lateral).map_err(refused)?;
        let (phantom, contact) = (self.0.clone(), contact.to_owned());
        let text = interruptible(py, move || {
            let model = model(&phantom, mesh_mm, &contact)?;
            let solved = model.solve(Pose { depth, lateral });
            let text = solved.and_then(|solution| model.vtu(&solution));
            text.map_err(refused)
        });
        Ok(palpate::file::write(&path, &text?)?)
    }

    /// The force map over depths and lateral positions, as solve but for the last digits, and faster.
    #[doc = sections!(
        depths_mm: "array_like, shape (m,)" = "Depths of the probe, increasing, mm.",
        laterals_mm: "array_like, shape (n,)" = "Lateral positions, increasing, mm.",
        mesh_mm, contact, progress,
        certify: "bool, optional" = "Whether two coarser meshes are solved too, for the error bands of the certificate's discretization; refused for a mesh that is too coarse for them.";
        "ForceMap" = "The forces, N, with their certificate.";
        "As solve; an axis that does not increase."
    )]
    // Implements: PYT-010, PYT-056.
    #[pyo3(signature = (depths_mm, laterals_mm, mesh_mm=0.5, contact="deformed-normal", progress=None, certify=false))]
    #[allow(clippy::too_many_arguments, reason = "keywords in Python")]
    fn map(
        &self,
        py: Python<'_>,
        depths_mm: &Bound<PyAny>,
        laterals_mm: &Bound<PyAny>,
        mesh_mm: f64,
        contact: &str,
        progress: Option<Py<PyAny>>,
        certify: bool,
    ) -> PyResult<ForceMap> {
        let depths = axis("depths_mm", depths_mm)?;
        let laterals = axis("laterals_mm", laterals_mm)?;
        py.detach(|| {
            let model = model(&self.0, mesh_mm, contact)?;
            let meshes = if certify { 3 } else { 1 };
            let all = meshes * depths.len() * model.solved_laterals(&laterals).len();
            // Poses that are solved, and what was raised.
            let state = RefCell::new((0, None));
            let solved = |poses| {
                let (done, raised) = &mut *state.borrow_mut();
                *done += poses;
                *raised = tell(progress.as_ref(), *done, all).err();
                raised.is_none()
            };
            let map = match certify {
                true => certified_map(&model, &depths, &laterals, &solved),
                false => model.map(&depths, &laterals, &solved),
            };
            map.map(ForceMap).map_err(|error| match error {
                FemError::Stopped => state.into_inner().1.unwrap_or_else(|| refused(error)),
                error => refused(error),
            })
        })
    }

    /// All of it: two phantoms of one name may differ.
    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        Ok(format!("Phantom.from_dict({})", self.to_dict(py)?.repr()?))
    }

    // Implements: PYT-044.
    fn _repr_html_(&self) -> PyResult<String> {
        let mut rows = Vec::new();
        for (table, value) in self.tables()? {
            let one = [value.clone()];
            let of_table = value.as_array().map_or(&one[..], |all| all);
            for (number, value) in of_table.iter().enumerate() {
                let key = if of_table.len() > 1 {
                    format!("{table} {number}")
                } else {
                    table.clone()
                };
                let text = value.as_table().map_or_else(
                    || value.to_string(),
                    |keys| {
                        let keys = keys.iter().map(|(key, value)| format!("{key} {value}"));
                        keys.collect::<Vec<_>>().join(", ")
                    },
                );
                rows.push(vec![key, text]);
            }
        }
        Ok(html(&format!("Phantom {}", self.0.name()), &[], &rows))
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyTuple>> {
        remade(slf, "from_toml", slf.get().to_toml())
    }
}
