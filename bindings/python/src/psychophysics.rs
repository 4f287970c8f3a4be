//! Counts of right answers.

use std::path::PathBuf;

use palpate_paper::psychophysics::{self, AnswerTable, paper_noise_levels};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::convert::{Any, json, python, refused};
use crate::oracle::asked;

/// Pooled rates of right answers, gamma from them, and how far the subjects differ from one binomial.
///
/// Where the trials differ, analyse_answers has a column for them.
#[doc = sections!(
    correct: "array_like or DataFrame, shape (subjects, conditions)" = "Right answers, whole numbers.",
    trials: "int" = "Trials of each.";
    "dict" = "pooled, rate, gamma, chi2, df; no unit.";
    "Counts that are no whole numbers up to the trials."
)]
#[pyfunction]
pub fn count_analysis<'py>(
    correct: &Bound<'py, PyAny>,
    trials: u32,
) -> PyResult<Bound<'py, PyAny>> {
    let arguments = PyDict::new(correct.py());
    arguments.set_item("correct", correct)?;
    arguments.set_item("trials", trials)?;
    asked(correct.py(), "count_analysis", &json(&arguments)?)
}

/// The analysis of a table of answers: intervals, gamma, dispersion of the subjects, share over depth.
#[doc = sections!(
    table: "str, PathLike or DataFrame, optional" = "subject, condition, trials and a column for each inclusion; by default Table 1 of the paper.";
    "dict" = "confidence, conditions, comparisons, depths in m; of the paper also noise_levels, the noise of its section 5, N.";
    "A table that is none, with line and column."
)]
#[pyfunction]
#[pyo3(signature = (table=None))]
pub fn analyse_answers<'py>(
    py: Python<'py>,
    table: Option<Any<'_, 'py>>,
) -> PyResult<Bound<'py, PyAny>> {
    let is_of_paper = table.is_none();
    let table = match table {
        None => AnswerTable::paper(),
        Some(frame) if frame.hasattr("to_csv")? => {
            let options = PyDict::new(py);
            options.set_item("index", false)?;
            let text = frame.call_method("to_csv", (), Some(&options))?;
            AnswerTable::from_csv(text.extract()?, "table")
        }
        Some(path) => AnswerTable::read(&path.extract::<PathBuf>()?),
    };
    let table = table.map_err(refused)?;
    let analysis = py.detach(|| psychophysics::analyse(&table));
    let answer = python(py, &analysis.map_err(refused)?)?;
    if is_of_paper {
        let levels = paper_noise_levels().map_err(refused)?;
        answer.set_item("noise_levels", python(py, &levels)?)?;
    }
    Ok(answer)
}
