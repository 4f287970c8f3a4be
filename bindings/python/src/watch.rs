//! A sweep against a bank while it is taken.

use palpate::bank::{WatchQuestion, Watcher as Inner};
use palpate::detect::sequential::Wald;
use palpate::trace::Unknown;
use pyo3::prelude::*;

use crate::bank::{Bank, chosen};
use crate::convert::{Any, Names, list, pair, python, refused, si};

/// Watcher(bank, noise_sd_n) judges a sweep against a bank while it is taken, as palpate watch does. noise_sd_n: of a sample in N, one for
/// both channels or (lateral, normal). unknown: what is fitted, of offset, drift, gain and depth. max_false_alarm, max_miss: the rates of
/// false answers, however often one looks. prior: shape (maps,), of each map given an inclusion; prior_h1: of an inclusion. zeroed: whether
/// the sensor was set to zero on the gel.
#[pyclass(module = "palpate")]
pub struct Watcher {
    watcher: Inner,
}

#[pymethods]
impl Watcher {
    /// Implements: PYT-032, PYT-048.
    #[new]
    #[pyo3(signature = (bank, noise_sd_n, unknown=Names::of(&["offset", "drift", "gain"]), max_false_alarm=0.01,
        max_miss=0.05, prior=None, prior_h1=0.5, zeroed=false),
        text_signature = "(bank, noise_sd_n, unknown=('offset', 'drift', 'gain'), max_false_alarm=0.01, max_miss=0.05, prior=None, prior_h1=0.5, zeroed=False)")]
    #[allow(clippy::too_many_arguments, reason = "keywords in Python")]
    fn new(
        bank: &Bank,
        noise_sd_n: Any<'_, '_>,
        unknown: Names,
        max_false_alarm: f64,
        max_miss: f64,
        prior: Option<Any<'_, '_>>,
        prior_h1: f64,
        zeroed: bool,
    ) -> PyResult<Watcher> {
        let question = WatchQuestion {
            unknown: chosen("unknown", unknown.list(), Unknown::ALL)?,
            noise_sd: pair("noise_sd_n", noise_sd_n)?,
            is_zeroed: zeroed,
            prior_h1,
            prior: prior.map(|prior| list("prior", prior, 0)).transpose()?,
            test: Wald::new(max_false_alarm, max_miss).map_err(refused)?,
        };
        let watcher = Inner::new(&bank.bank, &question).map_err(refused)?;
        Ok(Watcher { watcher })
    }

    /// Adds a sample and returns what all samples so far say, a dictionary with the keys of palpate watch, in SI (posterior_h1, decision,
    /// likeliest, open_positions_m ...). position_mm in mm, the forces in N, without a lateral one if the sensor has none; depth_mm of the sample,
    /// in mm, for a bank of several depths of the probe; a NaN is missing.
    #[pyo3(signature = (position_mm, normal_force_n, lateral_force_n=None, depth_mm=None))]
    fn push<'py>(
        &mut self,
        py: Python<'py>,
        position_mm: f64,
        normal_force_n: f64,
        lateral_force_n: Option<f64>,
        depth_mm: Option<f64>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let metres = |name, value: f64| match value.is_nan() {
            true => Ok(f64::NAN),
            false => si(name, value, -3),
        };
        let x = metres("position_mm", position_mm)?;
        let depth = depth_mm
            .map(|depth| metres("depth_mm", depth))
            .transpose()?;
        let pushed = (self.watcher).push_at(x, depth, lateral_force_n, normal_force_n);
        let answer = pushed.and_then(|()| self.watcher.answer());
        python(py, &answer.map_err(refused)?)
    }
}
