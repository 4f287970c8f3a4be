//! Counts of right answers.

use std::path::PathBuf;

use palpate_paper::psychophysics::{self, AnswerTable, paper_noise_levels};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::convert::{Any, json, python, refused};
use crate::oracle::asked;

/// Pooled rates of right answers, gamma from them, and how far the subjects differ from one binomial, as a dictionary: pooled, rate,
/// gamma, chi2, df.
///
/// correct: right answers, whole numbers of shape (subjects, conditions), an array or a DataFrame, each of so many trials (no unit). Where
/// the trials differ, analyse_answers has a column for them.
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
/// table: a CSV file or a DataFrame (subject, condition, trials and a column for each inclusion); without it Table 1 of the paper, and then
/// also noise_levels, the noise of its section 5, in N.
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
