//! The oracle: every operation of `spec/oracle.md` by its name.

use palpate::oracle::Oracle;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::convert::{json, refused};

/// What the oracle answers to `arguments`, an object of JSON.
pub fn asked<'py>(py: Python<'py>, op: &str, arguments: &str) -> PyResult<Bound<'py, PyAny>> {
    let op = serde_json::to_string(op).map_err(refused)?;
    let line = format!("{{\"id\":0,\"op\":{op},\"args\":{arguments}}}");
    let mut answer = Vec::new();
    py.detach(|| Oracle::default().answer(line.as_bytes(), &mut answer));
    let loads = py.import("json")?.getattr("loads")?;
    let answer = loads.call1((answer.as_slice(),))?;
    let answer = answer.cast::<PyDict>()?;
    match (answer.get_item("ok")?, answer.get_item("error")?) {
        (Some(answer), _) => Ok(answer),
        (None, Some(error)) => Err(refused(error.get_item("message")?)),
        (None, None) => Err(refused("the oracle gave no answer")),
    }
}

/// A question to the oracle: any operation by its name, whose keys state their units.
#[doc = sections!(
    op: "str" = "The operation; capabilities lists them.",
    arguments;
    "dict" = "The answer, in SI.";
    "What the oracle answers with an error."
)]
/// Examples
/// --------
/// >>> ask("two_afc", gamma=0)
/// {'p_correct': 0.5}
#[pyfunction]
#[pyo3(signature = (op, **arguments))]
pub fn ask<'py>(
    py: Python<'py>,
    op: &str,
    arguments: Option<&Bound<'py, PyDict>>,
) -> PyResult<Bound<'py, PyAny>> {
    let arguments = arguments.map_or_else(|| Ok("{}".into()), |arguments| json(arguments))?;
    asked(py, op, &arguments)
}
