//! The matched filter, Θ of records in white and coloured noise and beside nuisances, the scan, and simulated records.

use numpy::PyUntypedArrayMethods;
use palpate::detect::coloured::{coloured_scratch, theta_coloured as coloured};
use palpate::detect::nuisance::{NoiseLevel, Nuisances, SubspaceDetector};
use palpate::detect::scan::{Scan, ScanMaximum};
use palpate::detect::simulate::Simulation;
use palpate::detect::{self, DetectError, theta_of_record};
use palpate::force::Force;
use palpate::stats::random::Generator;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple, PyType};
use rayon::prelude::*;

use crate::batch;
use crate::convert::{
    Any, Records, array, floats, halves, interruptible, json, of_record, on_all, pair, python,
    refused, si, tell, vector, wrong_shape,
};
use crate::oracle::asked;

/// Samples that are simulated between two looks for Ctrl-C, some 0.1 s of work.
const FEW: usize = 1 << 23;

/// The generator of a seed; records with and without an inclusion have streams of their own.
pub fn generator(seed: u64, inclusion: bool) -> Generator {
    Generator::new(seed, u64::from(inclusion))
}

/// Room for so many numbers, if there is memory for them.
pub fn zeros(count: usize) -> PyResult<Vec<f64>> {
    let mut values = Vec::new();
    values.try_reserve_exact(count).map_err(refused)?;
    values.resize(count, 0.0);
    Ok(values)
}

/// Both channels of records that are of the template's length.
fn same_length(records: &Records, samples: usize) -> PyResult<()> {
    let (what, expected, found) = ("records", samples, records.samples);
    let other = DetectError::LengthMismatch {
        what,
        expected,
        found,
    };
    (expected == found)
        .then_some(())
        .ok_or_else(|| refused(other))
}

/// theta, the log-likelihood ratio of an inclusion, of one record or many, in white noise.
///
/// A C-ordered array of 64-bit floats is read where it is; do not change it in another thread meanwhile.
#[doc = sections!(
    observed: "array_like, shape (2, n) or (k, 2, n)" = "Lateral and normal forces of a record, or of k, N.",
    f0, f1, noise_sd_n;
    "float, or ndarray, shape (k,)" = "theta of the record, or of each.";
    "Other shapes, or a sample that is not finite, with its place."
)]
/// Examples
/// --------
/// >>> theta([[0, 0], [1.5, 1.75]], f0=[[0, 0], [1.5, 1.5]], f1=[[0, 0], [1.5, 2]], noise_sd_n=0.25)
/// 0.0
// Implements: PYT-020.
#[pyfunction]
pub fn theta<'py>(
    py: Python<'py>,
    observed: Any<'_, 'py>,
    f0: Any<'_, 'py>,
    f1: Any<'_, 'py>,
    noise_sd_n: Any<'_, 'py>,
) -> PyResult<Py<PyAny>> {
    let observed = Records::new("observed", observed)?;
    let (f0, f1) = (Records::one("f0", f0)?, Records::one("f1", f1)?);
    same_length(&observed, f0.samples)?;
    let noise_sd = pair("noise_sd_n", noise_sd_n)?;
    let (values, f0, f1) = (observed.values()?, f0.force()?, f1.force()?);
    let found = match observed.count {
        None => theta_of_record(halves(values), f0, f1, noise_sd)
            .map(|found| vec![found.theta])
            .map_err(|error| (None, error)),
        Some(_) => py.detach(|| on_all(|| batch::theta(values, f0, f1, noise_sd)))?,
    };
    let found = found.map_err(|(number, error)| of_record(number, error))?;
    observed.answer(py, &[], found)
}

/// What the matched filter says of one record.
#[doc = sections!(
    theta: "float" = "The log-likelihood ratio.",
    y_n: "(float, float)" = "Y(0) of the paper's equation (5), lateral and normal, N.",
    gamma: "float" = "The signal-to-noise ratio.";;
)]
#[pyclass(frozen, get_all, module = "palpate")]
pub struct Statistic {
    /// The log-likelihood ratio.
    theta: f64,
    /// Y(0) of the paper's equation (5), (lateral, normal), N.
    y_n: [f64; 2],
    /// The signal-to-noise ratio.
    gamma: f64,
}

impl From<detect::Statistic> for Statistic {
    fn from(found: detect::Statistic) -> Statistic {
        Statistic {
            theta: found.theta,
            y_n: found.y.into_array(),
            gamma: found.gamma,
        }
    }
}

#[pymethods]
impl Statistic {
    #[new]
    fn new(theta: f64, y_n: [f64; 2], gamma: f64) -> PyResult<Statistic> {
        let y_n = [si("y_n[0]", y_n[0], 0)?, si("y_n[1]", y_n[1], 0)?];
        let (theta, gamma) = (si("theta", theta, 0)?, si("gamma", gamma, 0)?);
        Ok(Statistic { theta, y_n, gamma })
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> (Bound<'py, PyType>, (f64, [f64; 2], f64)) {
        let of = slf.get();
        (slf.get_type(), (of.theta, of.y_n, of.gamma))
    }

    fn __repr__(&self) -> String {
        let Statistic { theta, y_n, gamma } = self;
        format!("Statistic(theta={theta:?}, y_n={y_n:?}, gamma={gamma:?})")
    }
}

/// theta, y_n and gamma of one record.
#[doc = sections!(
    observed: "array_like, shape (2, n)" = "Lateral and normal forces of the record, N.",
    f0, f1, noise_sd_n;
    "Statistic" = "theta, y_n in N, gamma.";
    "As theta."
)]
#[pyfunction]
pub fn statistic(
    observed: Any<'_, '_>,
    f0: Any<'_, '_>,
    f1: Any<'_, '_>,
    noise_sd_n: Any<'_, '_>,
) -> PyResult<Statistic> {
    let (observed, f0) = (Records::one("observed", observed)?, Records::one("f0", f0)?);
    let (f1, noise_sd) = (Records::one("f1", f1)?, pair("noise_sd_n", noise_sd_n)?);
    let found = theta_of_record(observed.force()?, f0.force()?, f1.force()?, noise_sd);
    Ok(found.map_err(|error| of_record(None, error))?.into())
}

/// The matched filter of a template in white noise.
#[doc = sections!(
    template: "array_like, shape (2, n)" = "F_1 - F_0, lateral and normal, N.",
    noise_sd_n;;
    "A template that is not finite."
)]
#[pyclass(frozen, module = "palpate")]
pub struct MatchedFilter {
    template: Vec<f64>,
    noise_sd: Force<f64>,
}

impl MatchedFilter {
    fn filter(&self) -> PyResult<detect::MatchedFilter<'_>> {
        let filter = detect::MatchedFilter::new(halves(&self.template), self.noise_sd);
        filter.map_err(|error| of_record(None, error))
    }
}

#[pymethods]
impl MatchedFilter {
    #[new]
    fn new(template: Any<'_, '_>, noise_sd_n: Any<'_, '_>) -> PyResult<MatchedFilter> {
        let template = Records::one("template", template)?.values()?.to_vec();
        let noise_sd = pair("noise_sd_n", noise_sd_n)?;
        let filter = MatchedFilter { template, noise_sd };
        filter.filter()?;
        Ok(filter)
    }

    /// The signal-to-noise ratio.
    #[getter]
    fn gamma(&self) -> PyResult<f64> {
        Ok(self.filter()?.gamma())
    }

    /// The root mean square of the template, (lateral, normal), N.
    #[getter]
    fn b_n(&self) -> PyResult<[f64; 2]> {
        Ok(self.filter()?.b().into_array())
    }

    /// The standard deviation of y_n, (lateral, normal), N.
    #[getter]
    fn sigma_n(&self) -> PyResult<[f64; 2]> {
        Ok(self.filter()?.sigma().into_array())
    }

    /// theta, y_n and gamma of one residual.
    #[doc = sections!(
        residual: "array_like, shape (2, n)" = "F_p - F_0, lateral and normal, N.";
        "Statistic" = "theta, y_n in N, gamma.";
        "Another length, or a sample that is not finite."
    )]
    fn statistic(&self, residual: Any<'_, '_>) -> PyResult<Statistic> {
        let residual = Records::one("residual", residual)?;
        let found = self.filter()?.statistic(residual.force()?);
        Ok(found.map_err(|error| of_record(None, error))?.into())
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyTuple>> {
        let MatchedFilter { template, noise_sd } = slf.get();
        let template = array(slf.py(), &[2, template.len() / 2], template.clone())?;
        (slf.get_type(), (template, noise_sd.into_array())).into_pyobject(slf.py())
    }

    fn __repr__(&self) -> PyResult<String> {
        let (samples, gamma) = (self.template.len() / 2, self.gamma()?);
        Ok(format!(
            "<MatchedFilter of 2 x {samples} samples, gamma {gamma:.3}>"
        ))
    }

    /// theta of one residual or many.
    #[doc = sections!(
        residual: "array_like, shape (2, n) or (k, 2, n)" = "F_p - F_0, lateral and normal, N.";
        "float, or ndarray, shape (k,)" = "theta of the record, or of each.";
        "Another length, or a sample that is not finite, with its place."
    )]
    fn theta<'py>(&self, py: Python<'py>, residual: Any<'_, 'py>) -> PyResult<Py<PyAny>> {
        let (residual, filter) = (Records::new("residual", residual)?, self.filter()?);
        same_length(&residual, filter.samples())?;
        let (values, count) = (residual.values()?, residual.count);
        let theta = |(number, record)| match filter.statistic(halves(record)) {
            Ok(found) => Ok(found.theta),
            Err(error) => Err(of_record(count.map(|_| number), error)),
        };
        let records = values.par_chunks_exact(2 * filter.samples()).enumerate();
        let found: PyResult<Vec<f64>> = py.detach(|| on_all(|| records.map(theta).collect()))?;
        residual.answer(py, &[], found?)
    }
}

/// theta and gamma in noise of any covariance.
#[doc = sections!(
    residual: "array_like, shape (2, n)" = "F_p - F_0, lateral and normal, N.",
    template: "array_like, shape (2, n)" = "F_1 - F_0, lateral and normal, N.",
    covariance: "array_like, shape (2 n, 2 n)" = "Of the n lateral samples, then the normal ones, N**2.";
    "(float, float)" = "theta and gamma.";
    "A covariance that is not symmetric and positive definite."
)]
#[pyfunction]
pub fn theta_coloured(
    py: Python<'_>,
    residual: Any<'_, '_>,
    template: Any<'_, '_>,
    covariance: Any<'_, '_>,
) -> PyResult<(f64, f64)> {
    let residual = Records::one("residual", residual)?;
    let template = Records::one("template", template)?;
    let covariance = floats("covariance", covariance)?;
    let order = 2 * template.samples;
    if covariance.shape() != [order, order] {
        let expected = format!("[{order}, {order}]");
        return Err(wrong_shape("covariance", covariance.shape(), &expected));
    }
    let residual = residual.values()?.to_vec();
    let (template, covariance) = (template.values()?.to_vec(), covariance.as_slice()?.to_vec());
    let mut scratch = zeros(coloured_scratch(order))?;
    interruptible(py, move || {
        let found = coloured(&residual, &template, &covariance, &mut scratch);
        let found = found.map_err(refused)?;
        Ok((found.theta, found.gamma))
    })
}

/// What a record says beside signals of unknown amplitude.
#[doc = sections!(
    residual: "array_like, shape (m,)" = "All samples of both channels over the standard deviation of their noise, no unit.",
    template: "array_like, shape (m,)" = "The signal, alike.",
    nuisances: "array_like, shape (p, m)" = "Signals of unknown amplitude, alike.",
    level,
    bias: "float, optional" = "What a nuisance that is known within bounds may add to t.",
    eta: "float, optional" = "The threshold of theta.";
    "dict" = "t, gamma, gamma_nominal, residual, theta, false_alarm, miss, rank, degrees.";
    "A template that the nuisances explain, or too few samples."
)]
#[pyfunction]
#[pyo3(signature = (residual, template, nuisances, level="known", bias=0.0, eta=0.0))]
pub fn theta_nuisances<'py>(
    py: Python<'py>,
    residual: Any<'_, 'py>,
    template: Any<'_, 'py>,
    nuisances: Any<'_, 'py>,
    level: &str,
    bias: f64,
    eta: f64,
) -> PyResult<Bound<'py, PyAny>> {
    let mut residual = vector("residual", residual)?.as_slice()?.to_vec();
    let mut template = vector("template", template)?.as_slice()?.to_vec();
    let signals = floats("nuisances", nuisances)?;
    let samples = template.len();
    if !matches!(*signals.shape(), [0] | [0, _]) && signals.shape().get(1..) != Some(&[samples]) {
        let expected = format!("[p, {samples}]");
        return Err(wrong_shape("nuisances", signals.shape(), &expected));
    }
    let level = match level {
        "known" => NoiseLevel::Known,
        "unknown" => NoiseLevel::Unknown,
        level => {
            let message = format!("level is {level:?}, but must be known or unknown");
            return Err(refused(message));
        }
    };
    let mut signals = signals.as_slice()?.to_vec();
    let mut judge = || {
        let nuisances = Nuisances::new(&mut signals, samples)?;
        let detector = SubspaceDetector::new(nuisances, &mut template)?;
        let found = detector.statistic(&mut residual)?;
        let test = found.test(level, bias)?;
        let rates = test.rates(test.bayes_threshold(eta)?)?;
        let finite = detect::decide(test.theta(), 0.0);
        finite.map(|_| {
            serde_json::json!({
                "t": test.t, "gamma": test.gamma, "gamma_nominal": detector.gamma_nominal(),
                "residual": found.residual, "theta": test.theta(), "false_alarm": rates.false_alarm,
                "miss": rates.miss, "rank": nuisances.rank().get(), "degrees": found.degrees,
            })
        })
    };
    python(py, &judge().map_err(refused)?)
}

/// theta of each of several signals beside nuisances, and what follows from them.
#[doc = sections!(
    residual: "array_like, shape (m,)" = "All samples of both channels over the standard deviation of their noise, no unit.",
    templates: "array_like, shape (q, m)" = "The signals, alike.",
    nuisances: "array_like, shape (p, m)" = "Signals of unknown amplitude, alike.",
    prior: "array_like, shape (q,)" = "Probability of each signal given an inclusion.",
    level, own_prior_h1;
    "dict" = "Lists theta and posterior; theta_mixture, theta_max, posterior_h1; hypothesis, the likeliest signal, from 0.";
    "As theta_nuisances; a prior that does not add up to 1."
)]
#[pyfunction]
#[pyo3(signature = (residual, templates, nuisances, prior, level="known", prior_h1=0.5))]
pub fn bank_posterior<'py>(
    py: Python<'py>,
    residual: Any<'_, 'py>,
    templates: Any<'_, 'py>,
    nuisances: Any<'_, 'py>,
    prior: Any<'_, 'py>,
    level: &str,
    prior_h1: f64,
) -> PyResult<Bound<'py, PyAny>> {
    let arguments = PyDict::new(py);
    arguments.set_item("residual", residual)?;
    arguments.set_item("templates", templates)?;
    arguments.set_item("nuisances", nuisances)?;
    arguments.set_item("prior", prior)?;
    arguments.set_item("level", level)?;
    arguments.set_item("prior_h1", prior_h1)?;
    asked(py, "bank_posterior", &json(&arguments)?)
}

/// theta at every place of a template within a record, and the largest.
///
/// theta has the shape (n - m + 1,), with the template's first sample on sample 0, 1, ... of the record; shift is that sample of the
/// largest, refined_shift the vertex of a parabola, in samples. For k records each has k as its first axis.
#[doc = sections!(
    residual: "array_like, shape (2, n) or (k, 2, n)" = "F_p - F_0, lateral and normal, N.",
    template: "array_like, shape (2, m), m <= n" = "F_1 - F_0, lateral and normal, N.",
    noise_sd_n;
    "dict" = "theta, max_theta, gamma there, shift, refined_shift.";
    "A template that is longer, or a sample that is not finite, with its place."
)]
// Implements: PYT-020.
#[pyfunction]
pub fn scan<'py>(
    py: Python<'py>,
    residual: Any<'_, 'py>,
    template: Any<'_, 'py>,
    noise_sd_n: Any<'_, 'py>,
) -> PyResult<Bound<'py, PyDict>> {
    let residual = Records::new("residual", residual)?;
    let template = Records::one("template", template)?;
    let noise_sd = pair("noise_sd_n", noise_sd_n)?;
    let (samples, count) = (residual.samples, residual.count);
    let scan = Scan::new(samples, template.force()?, noise_sd).map_err(refused)?;
    let shifts = samples - template.samples + 1;
    let mut theta = zeros(count.unwrap_or(1).saturating_mul(shifts))?;
    let records = residual.values()?.par_chunks_exact(2 * samples);
    let of_one = |(record, theta): (&[f64], &mut [f64])| {
        scan.theta(halves(record), 0, theta)?;
        scan.maximum(halves(record), scan.full_shifts())
    };
    let all = records.zip(theta.par_chunks_exact_mut(shifts)).enumerate();
    let all = all
        .map(|(number, one)| of_one(one).map_err(|error| of_record(count.map(|_| number), error)));
    let found = py.detach(|| on_all(|| all.collect::<PyResult<Vec<ScanMaximum>>>()))??;
    let answer = PyDict::new(py);
    let each = |of: fn(&ScanMaximum) -> f64| found.iter().map(of).collect::<Vec<f64>>();
    let set = |key, values| answer.set_item(key, residual.answer(py, &[], values)?);
    answer.set_item("theta", residual.answer(py, &[shifts], theta)?)?;
    set("max_theta", each(|found| found.theta))?;
    set("gamma", each(|found| found.gamma))?;
    set("refined_shift", each(|found| found.refined_shift))?;
    let shift = array(py, &[found.len()], each(|found| found.shift as f64))?;
    let shift = shift.call_method1("astype", ("int64",))?;
    match count {
        None => answer.set_item("shift", shift.get_item(0)?)?,
        Some(_) => answer.set_item("shift", shift)?,
    }
    Ok(answer)
}

/// theta of simulated records: F_0 or F_1 and white noise, judged by the matched filter of F_1 - F_0.
#[doc = sections!(
    f0, f1, noise_sd_n,
    inclusion: "bool" = "Whether the records have the inclusion.",
    trials: "int" = "How many records.",
    seed: "int, optional" = "The same seed gives the same records; of a NumPy generator: rng.integers(2**63).";
    "ndarray, shape (trials,)" = "theta of each record, for any number of threads.";
    "As theta; more trials than there is memory for."
)]
// Implements: PYT-020.
#[pyfunction]
#[pyo3(signature = (f0, f1, noise_sd_n, inclusion, trials, seed=1999))]
pub fn simulate_theta<'py>(
    py: Python<'py>,
    f0: Any<'_, 'py>,
    f1: Any<'_, 'py>,
    noise_sd_n: Any<'_, 'py>,
    inclusion: bool,
    trials: usize,
    seed: u64,
) -> PyResult<Bound<'py, PyAny>> {
    let (f0, f1) = (Records::one("f0", f0)?, Records::one("f1", f1)?);
    same_length(&f1, f0.samples)?;
    let pairs = f1.values()?.iter().zip(f0.values()?);
    let template: Vec<f64> = pairs.map(|(f1, f0)| f1 - f0).collect();
    let (noise_sd, generator) = (pair("noise_sd_n", noise_sd_n)?, generator(seed, inclusion));
    let force = if inclusion { f1.force()? } else { f0.force()? };
    let simulation = Simulation::new(f0.force()?, halves(&template), noise_sd, generator);
    let (simulation, length) = (simulation.map_err(refused)?, template.len());
    let mut theta = zeros(trials)?;
    let trial = |residual: &mut Vec<f64>, (trial, theta): (usize, &mut f64)| {
        *theta = simulation.trial(trial as u64, force, residual)?.theta;
        Ok(())
    };
    // A few at a time, so that this thread hears of Ctrl-C.
    let few = (FEW / length.max(1)).max(1);
    for (number, theta) in theta.chunks_mut(few).enumerate() {
        let places = theta.par_iter_mut().enumerate();
        let places = places.map(|(at, theta)| (number * few + at, theta));
        let simulate = || places.try_for_each_init(|| vec![0.0; length], trial);
        let done: Result<(), DetectError> = py.detach(|| on_all(simulate))?;
        done.map_err(|error| of_record(None, error))?;
        tell(None, trials, trials)?;
    }
    array(py, &[trials], theta)
}
