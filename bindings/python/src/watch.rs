//! A sweep against a bank while it is taken.

use palpate::bank::{WatchQuestion, Watcher as Inner};
use palpate::detect::sequential::Wald;
use palpate::trace::Unknown;
use pyo3::prelude::*;

use crate::bank::{Bank, chosen};
use crate::convert::{Any, Names, give_reasons, list, pair, python, refused, si};

/// A sweep that is judged against a bank while it is taken, as palpate watch does; the rates of error hold however often one looks.
#[doc = sections!(
    bank: "Bank" = "The inclusions that may be there.",
    noise_sd_n,
    unknown: "str or sequence of str, optional" = "What is fitted, of offset, drift, gain and depth.",
    own_max_false_alarm, own_max_miss, prior, own_prior_h1, zeroed;;
    "A name or a number that makes no sense, or a prior that does not add up to 1."
)]
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

    /// Adds a sample, of which a NaN is missing, and tells what all so far say.
    #[doc = sections!(
        position_mm: "float" = "Lateral position, mm.",
        normal_force_n: "float" = "Normal force out of the gel, N.",
        lateral_force_n: "float, optional" = "Lateral force along +x, if the sensor has it, N.",
        depth_mm: "float, optional" = "Depth of the sample, for a bank of several depths of the probe, mm.";
        "dict" = "The JSON of palpate watch, in SI (posterior_h1, decision, likeliest ...), and reasons, the words for causes.";
        "An infinity, a force beyond 1e50 times its noise, or a depth that is missing, where the bank has several."
    )]
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
        let pushed = (self.watcher).push(x, depth, lateral_force_n, normal_force_n);
        let answer = pushed.and_then(|()| self.watcher.answer());
        let answer = answer.map_err(refused)?;
        let told = python(py, &answer)?;
        give_reasons(&told, &answer.causes)?;
        Ok(told)
    }
}
