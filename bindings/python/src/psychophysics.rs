//! Counts of right answers.

use std::path::PathBuf;

use palpate_paper::psychophysics::{self, AnswerTable, paper_noise_levels};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::convert::{json, python, refused};
use crate::oracle::asked;

/// Pooled rates of right answers, gamma from them, and how far the subjects differ from one binomial, as a dictionary: pooled, rate,
/// gamma, chi2, df.
///
/// correct: right answers, whole numbers of shape (subjects, conditions), each of so many trials (no unit).
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

/// The analysis of a table of answers as a dictionary: confidence, conditions, comparisons; intervals, gamma, dispersion of the
/// subjects, share over depth. Depths are in m.
///
/// path: a CSV file (subject, condition, trials and a column for each inclusion); without it Table 1 of the paper, and then also
/// noise_levels, the noise of its section 5, in N.
#[pyfunction]
#[pyo3(signature = (path=None))]
pub fn analyse_answers(py: Python<'_>, path: Option<PathBuf>) -> PyResult<Bound<'_, PyAny>> {
    let table = path
        .as_ref()
        .map_or_else(AnswerTable::paper, |path| AnswerTable::read(path));
    let table = table.map_err(refused)?;
    let analysis = py.detach(|| psychophysics::analyse(&table));
    let answer = python(py, &analysis.map_err(refused)?)?;
    if path.is_none() {
        let levels = paper_noise_levels().map_err(refused)?;
        answer.set_item("noise_levels", python(py, &levels)?)?;
    }
    Ok(answer)
}
