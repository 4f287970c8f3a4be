//! From Python to Rust and back: errors, units, arrays, tables.

use std::ffi::CString;
use std::fmt::Display;
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::Builder;
use std::time::Duration;

use numpy::ndarray::{ArrayD, IxDyn};
use numpy::{IntoPyArray, PyArrayDyn, PyArrayMethods, PyReadonlyArrayDyn, PyUntypedArrayMethods};
use palpate::decimal::{format_scaled, parse_scaled};
use palpate::force::Force;
use palpate::refusal::{Refusal, one_line};
use palpate::stats::NumericError;
use palpate::trace::Cause;
use pyo3::PyClass;
use pyo3::exceptions::{PyTypeError, PyUserWarning, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyCFunction, PyDict, PyList, PyTuple};
use rayon::{ThreadPool, ThreadPoolBuilder};
use serde::Serialize;

pyo3::create_exception!(
    palpate,
    Refused,
    PyValueError,
    "An input that is not what it must be, or a computation that has no answer: one line that says what is wrong and what would be right."
);

/// Lengths below this, mm, are probably metres: a gel has some 15 mm.
const PROBABLY_METRES: f64 = 0.05;
/// How often a long call looks for Ctrl-C.
const PERIOD: Duration = Duration::from_millis(50);
/// The stack of a long call, bytes, as of a main thread.
const STACK: usize = 8 << 20;

/// Whatever Python hands over.
pub type Any<'a, 'py> = &'a Bound<'py, PyAny>;

/// The exception for a reason of the crate's, with its words, but for the option of the command line.
///
/// Implements: PYT-005.
pub fn refused(reason: impl Display) -> PyErr {
    let reason = one_line(&reason.to_string());
    let reason = reason
        .replace(", or use --trim", "")
        .replace(" (--noise-sd-n)", "");
    Refused::new_err(reason)
}

/// `value` times 10^`power`, as if its shortest decimal were read.
///
/// Implements: PYT-004, PYT-005.
pub fn scaled(name: &str, value: f64, power: i32) -> Result<f64, Refusal> {
    let scaled = parse_scaled(&format!("{value:e}"), power);
    scaled.ok_or_else(|| Refusal::value(name, value, "a finite number"))
}

/// The same, or its exception.
pub fn si(name: &str, value: f64, power: i32) -> PyResult<f64> {
    scaled(name, value, power).map_err(refused)
}

/// An SI value in the unit that is 10^−`power` of it.
///
/// Implements: PYT-004.
pub fn in_unit(value: f64, power: i32) -> f64 {
    format_scaled(value, power).parse().unwrap_or(f64::NAN)
}

/// Warns where all lengths, which are mm, are so small that they are probably metres.
///
/// Implements: PYT-042.
pub fn doubt_metres(py: Python<'_>, name: &str, mm: &[f64]) -> PyResult<()> {
    let largest = mm.iter().fold(0.0, |largest: f64, x| largest.max(x.abs()));
    if !(f64::MIN_POSITIVE..PROBABLY_METRES).contains(&largest) {
        return Ok(());
    }
    let message = format!("{name} is at most {largest} mm; if these are metres, multiply by 1000");
    PyErr::warn(
        py,
        &py.get_type::<PyUserWarning>(),
        &CString::new(message)?,
        1,
    )
}

/// Lengths in mm, in m.
pub fn lengths(name: &str, mm: &Bound<PyAny>) -> PyResult<Vec<f64>> {
    doubt_metres(mm.py(), name, floats(name, mm)?.as_slice()?)?;
    list(name, mm, -3)
}

/// The lengths of an axis in mm, which increases, in m.
pub fn axis(name: &str, mm: &Bound<PyAny>) -> PyResult<Vec<f64>> {
    let axis = lengths(name, mm)?;
    if let Some(at) = axis.windows(2).position(|pair| pair[1] <= pair[0]) {
        let [before, found] = [axis[at], axis[at + 1]].map(|x| in_unit(x, 3));
        let right = format!("more than {before}, the one before it");
        return Err(refused(Refusal::value(
            format!("{name}[{}]", at + 1),
            found,
            right,
        )));
    }
    Ok(axis)
}

/// A list of numbers in a unit, or one number, in SI.
pub fn list(name: &str, values: &Bound<PyAny>, power: i32) -> PyResult<Vec<f64>> {
    let values = floats(name, values)?;
    if !matches!(values.shape(), [] | [_]) {
        return Err(wrong_shape(name, values.shape(), "[n]"));
    }
    let named = |(index, &value): (usize, &f64)| si(&format!("{name}[{index}]"), value, power);
    values.as_slice()?.iter().enumerate().map(named).collect()
}

/// SI values as an array in a unit.
pub fn array_in_unit<'py>(py: Python<'py>, values: &[f64], power: i32) -> Bound<'py, PyAny> {
    let values: Vec<f64> = values.iter().map(|&value| in_unit(value, power)).collect();
    values.into_pyarray(py).into_any()
}

/// Numbers as an array of a shape, row by row.
pub fn array<'py>(
    py: Python<'py>,
    shape: &[usize],
    values: Vec<f64>,
) -> PyResult<Bound<'py, PyAny>> {
    let array = ArrayD::from_shape_vec(IxDyn(shape), values).map_err(refused)?;
    Ok(array.into_pyarray(py).into_any())
}

/// Samples of both channels as an array of shape (2, n), the lateral ones first.
pub fn channels<'py, S: AsRef<[f64]>>(
    py: Python<'py>,
    force: Force<S>,
) -> PyResult<Bound<'py, PyAny>> {
    let force = force.as_ref().map(AsRef::as_ref);
    let shape = [2, force.normal.len()];
    // No lateral ones: normal forces alone.
    let is_normal_alone = force.lateral.is_empty() && !force.normal.is_empty();
    let shape = &shape[usize::from(is_normal_alone)..];
    array(py, shape, force.into_array().concat())
}

/// The class of NumPy's masked arrays.
fn masked_array(py: Python<'_>) -> PyResult<Bound<'_, PyAny>> {
    py.import("numpy.ma")?.getattr("MaskedArray")
}

/// Whether `values` are a masked array, or a list with one in it, down to so many `levels`: NumPy would make numbers of what is masked.
fn has_mask<'py>(
    values: &Bound<'py, PyAny>,
    masked: &Bound<'py, PyAny>,
    levels: u32,
) -> PyResult<bool> {
    if !values.is_instance_of::<PyList>() && !values.is_instance_of::<PyTuple>() {
        return values.is_instance(masked);
    }
    // NumPy makes no numbers of a list that is deeper, or within itself.
    if levels == 0 {
        return Ok(false);
    }
    for value in values.try_iter()? {
        if has_mask(&value?, masked, levels - 1)? {
            return Ok(true);
        }
    }
    Ok(false)
}

/// Most axes of an array of NumPy.
const MOST_AXES: u32 = 64;

/// What NumPy makes of `values` as 64-bit floats in C order: the array itself where it is that already.
///
/// Implements: PYT-003, PYT-005.
pub fn floats<'py>(
    name: &str,
    values: &Bound<'py, PyAny>,
) -> PyResult<PyReadonlyArrayDyn<'py, f64>> {
    let numpy = values.py().import("numpy")?;
    let masked = has_mask(values, &masked_array(values.py())?, MOST_AXES)?;
    let kind: String = numpy
        .call_method1("asarray", (values,))
        .and_then(|array| array.getattr("dtype")?.getattr("kind")?.extract())
        .unwrap_or_default();
    if masked || kind.is_empty() || !"fiu".contains(&*kind) {
        let found = values.get_type().name()?;
        let message = format!("{name} is a {found}, but must be real numbers or an array of them");
        return Err(PyTypeError::new_err(message));
    }
    // C order, aligned, and a plain array.
    let array = numpy.call_method1("require", (values, "f8", "CAE"))?;
    let array = array.cast_into::<PyArrayDyn<f64>>()?;
    array.try_readonly().map_err(refused)
}

/// The same of the shape (n,).
pub fn vector<'py>(
    name: &str,
    values: &Bound<'py, PyAny>,
) -> PyResult<PyReadonlyArrayDyn<'py, f64>> {
    let values = floats(name, values)?;
    match values.shape() {
        [_] => Ok(values),
        shape => Err(wrong_shape(name, shape, "[n]")),
    }
}

/// The exception for an array of another shape than is `right`.
pub fn wrong_shape(name: &str, shape: &[usize], right: &str) -> PyErr {
    let found = format!("{name} has the shape {shape:?}");
    refused(Refusal::state(found, format!("give {right}")))
}

/// One record of shape (2, n), or k of them: (k, 2, n).
pub struct Records<'py> {
    array: PyReadonlyArrayDyn<'py, f64>,
    /// k; none for one record.
    pub count: Option<usize>,
    /// n.
    pub samples: usize,
}

impl<'py> Records<'py> {
    /// The records in `values`.
    pub fn new(name: &str, values: &Bound<'py, PyAny>) -> PyResult<Records<'py>> {
        let array = floats(name, values)?;
        let (count, samples) = match *array.shape() {
            [2, samples] => (None, samples),
            [count, 2, samples] => (Some(count), samples),
            ref shape => {
                let expected = "[2, n], lateral and normal samples, or [k, 2, n]";
                return Err(wrong_shape(name, shape, expected));
            }
        };
        Ok(Records {
            array,
            count,
            samples,
        })
    }

    /// The one record in `values`.
    pub fn one(name: &str, values: &Bound<'py, PyAny>) -> PyResult<Records<'py>> {
        let records = Records::new(name, values);
        records
            .ok()
            .filter(|records| records.count.is_none())
            .ok_or_else(|| {
                let right = "[2, n], the lateral and the normal samples of one record";
                match floats(name, values) {
                    Ok(values) => wrong_shape(name, values.shape(), right),
                    Err(error) => error,
                }
            })
    }

    /// All samples, record by record, lateral ones first.
    pub fn values(&self) -> PyResult<&[f64]> {
        Ok(self.array.as_slice()?)
    }

    /// The samples of the only record.
    pub fn force(&self) -> PyResult<Force<&[f64]>> {
        Ok(halves(self.values()?))
    }

    /// Numbers, `each` of every record, as Python gets them: a float, or an array without the axis of the records, for one record.
    pub fn answer(&self, py: Python<'py>, each: &[usize], values: Vec<f64>) -> PyResult<Py<PyAny>> {
        let shape: Vec<usize> = self.count.iter().chain(each).copied().collect();
        Ok(number_or_array(py, &shape, values)?.unbind())
    }
}

/// The two channels of a record.
pub fn halves(record: &[f64]) -> Force<&[f64]> {
    let (lateral, normal) = record.split_at(record.len() / 2);
    Force::new(lateral, normal)
}

/// The exception for what is refused of the record with a number, if it is one of several. The crate's observed_y[7] is observed[1, 7] here.
///
/// Implements: PYT-005.
pub fn of_record(number: Option<usize>, error: NumericError) -> PyErr {
    let error = error.to_string();
    let error = error.replace("_x[", "[0, ").replace("_y[", "[1, ");
    match number {
        None => refused(error),
        Some(number) => refused(format!("record {number}: {error}")),
    }
}

/// The samples of a record of the shape (2, n), or normal ones alone, (n,), without a NaN.
///
/// Implements: PYT-005.
pub fn finite_forces(name: &str, values: &Bound<PyAny>) -> PyResult<Force<Vec<f64>>> {
    let array = floats(name, values)?;
    let (shape, samples) = (array.shape(), array.as_slice()?);
    let last = *shape.last().unwrap_or(&1);
    if let Some(at) = samples.iter().position(|force| !force.is_finite()) {
        let at = match shape {
            [_] => at.to_string(),
            _ => format!("{}, {}", at / last, at % last),
        };
        let found = format!("{name}[{at}] is NaN or infinite; leave such samples out");
        return Err(refused(found));
    }
    match shape {
        [_] => Ok(Force::new(Vec::new(), samples.to_vec())),
        _ => Ok(Records::one(name, values)?.force()?.map(<[f64]>::to_vec)),
    }
}

/// A standard deviation for both channels, or (lateral, normal), N.
pub fn pair(name: &str, values: &Bound<PyAny>) -> PyResult<Force<f64>> {
    let values = floats(name, values)?;
    for sd in values.as_slice()? {
        let wrong = Refusal::value(name, sd, "finite and greater than 0");
        wrong
            .when(!(sd.is_finite() && *sd > 0.0))
            .map_err(refused)?;
    }
    match *values.as_slice()? {
        [both] => Ok(Force::new(both, both)),
        [lateral, normal] => Ok(Force::new(lateral, normal)),
        _ => {
            let expected = "a number, or one of each channel";
            Err(wrong_shape(name, values.shape(), expected))
        }
    }
}

/// A function of numbers, for numbers or for arrays that NumPy broadcasts: their shape, and what it gives row by row.
///
/// Implements: PYT-003.
pub fn broadcast<'py, T, E: Display, const N: usize>(
    names: [&str; N],
    arguments: [&Bound<'py, PyAny>; N],
    function: impl Fn([f64; N]) -> Result<T, E>,
) -> PyResult<(Vec<usize>, Vec<T>)> {
    let py = arguments[0].py();
    for (name, argument) in names.iter().zip(arguments) {
        floats(name, argument)?;
    }
    let list = PyList::new(py, arguments)?;
    let broadcast = py.import("numpy")?.getattr("broadcast_arrays")?;
    let broadcast = broadcast.call1(list.to_tuple()).map_err(refused)?;
    let broadcast: Vec<Bound<PyAny>> = broadcast.extract()?;
    let arrays = names.iter().zip(&broadcast);
    let arrays = arrays.map(|(name, array)| floats(name, array));
    let arrays = arrays.collect::<PyResult<Vec<_>>>()?;
    let slices = arrays.iter().map(|array| array.as_slice());
    let slices = slices.collect::<Result<Vec<_>, _>>()?;
    let shape = arrays[0].shape().to_vec();
    let at = |index: usize| {
        let found = function(std::array::from_fn(|argument| slices[argument][index]));
        found.map_err(|error| match shape.is_empty() {
            true => refused(error),
            false => refused(format!("element {index}: {error}")),
        })
    };
    let values = (0..slices[0].len()).map(at).collect::<PyResult<_>>()?;
    Ok((shape, values))
}

/// The same where it gives a number, as Python gets it.
pub fn each<'py, E: Display, const N: usize>(
    names: [&str; N],
    arguments: [&Bound<'py, PyAny>; N],
    function: impl Fn([f64; N]) -> Result<f64, E>,
) -> PyResult<Bound<'py, PyAny>> {
    let (shape, values) = broadcast(names, arguments, function)?;
    number_or_array(arguments[0].py(), &shape, values)
}

/// A float without a shape, else an array.
fn number_or_array<'py>(
    py: Python<'py>,
    shape: &[usize],
    values: Vec<f64>,
) -> PyResult<Bound<'py, PyAny>> {
    match (shape, &values[..]) {
        ([], [value]) => Ok(value.into_pyobject(py)?.into_any()),
        _ => array(py, shape, values),
    }
}

/// Anything that serde writes, as dictionaries, lists, numbers and texts.
pub fn python<'py>(py: Python<'py>, value: &impl Serialize) -> PyResult<Bound<'py, PyAny>> {
    let text = serde_json::to_string(value).map_err(refused)?;
    py.import("json")?.call_method1("loads", (text,))
}

/// Puts the words for the causes of an answer beside their codes.
///
/// Implements: PYT-049.
pub fn give_reasons(answer: &Bound<PyAny>, causes: &[Cause]) -> PyResult<()> {
    let reasons: Vec<String> = causes.iter().map(Cause::to_string).collect();
    answer.set_item("reasons", reasons)
}

/// The JSON of dictionaries, lists, arrays, numbers and texts.
///
/// Implements: PYT-005.
pub fn json(value: &Bound<PyAny>) -> PyResult<String> {
    let py = value.py();
    // Arrays, series and frames.
    let arrays = PyCFunction::new_closure(py, None, None, |arguments, _| {
        let (py, value) = (arguments.py(), arguments.get_item(0)?);
        let array = py.import("numpy")?.call_method1("asarray", (&value,))?;
        let kind: String = array.getattr("dtype")?.getattr("kind")?.extract()?;
        // Any other object is an array of itself, without an axis.
        let axes: usize = array.getattr("ndim")?.extract()?;
        let is_json = "biufU".contains(&*kind) || kind == "O" && axes > 0;
        if !is_json || value.is_instance(&masked_array(py)?)? {
            let found = value.get_type().name()?;
            let message =
                format!("a {found} is no argument; give numbers, texts or arrays of them");
            return Err(PyTypeError::new_err(message));
        }
        // A list of numbers that Python does not have would be one of arrays again.
        let array = match &*kind {
            "f" => array.call_method1("astype", ("f8",))?,
            _ => array,
        };
        array.call_method0("tolist").map(Bound::unbind)
    })?;
    let options = PyDict::new(py);
    options.set_item("allow_nan", false)?;
    options.set_item("default", arrays)?;
    let json = py.import("json")?;
    let text = json.call_method("dumps", (value,), Some(&options));
    text.map_err(|error| match error.is_instance_of::<PyValueError>(py) {
        true => refused(error.value(py)),
        false => error,
    })?
    .extract()
}

/// Calls `progress` with what is done and all there is, and looks for Ctrl-C; whatever is raised ends the work.
///
/// Implements: PYT-010.
pub fn tell(progress: Option<&Py<PyAny>>, done: usize, all: usize) -> PyResult<()> {
    Python::attach(|py| {
        py.check_signals()?;
        match progress {
            Some(progress) => progress.call1(py, (done, all)).map(|_| ()),
            None => Ok(()),
        }
    })
}

/// What long `work` gives, which Ctrl-C ends for who waits; the work itself then goes on to its end, and nobody hears of it.
///
/// Implements: PYT-010.
pub fn interruptible<T: Send + 'static>(
    py: Python<'_>,
    work: impl FnOnce() -> PyResult<T> + Send + 'static,
) -> PyResult<T> {
    let (send, mut done) = channel();
    // Nobody hears of it: that is no error.
    let work = move || send.send(work()).unwrap_or_default();
    let thread = Builder::new().stack_size(STACK).spawn(work)?;
    loop {
        let heard;
        (done, heard) = py.detach(move || {
            let heard = done.recv_timeout(PERIOD);
            (done, heard)
        });
        match heard {
            Ok(found) => return found,
            Err(RecvTimeoutError::Timeout) => py.check_signals()?,
            Err(RecvTimeoutError::Disconnected) => match thread.join() {
                Err(panic) => std::panic::resume_unwind(panic),
                Ok(()) => return Err(refused("the computation ended without an answer")),
            },
        }
    }
}

/// What `work` gives, whose loops run on all processors. A process that was forked has threads of its own: those of its parent are not there.
///
/// Implements: PYT-010.
pub fn on_all<T: Send>(work: impl FnOnce() -> T + Send) -> PyResult<T> {
    static THREADS: Mutex<Option<(u32, Arc<ThreadPool>)>> = Mutex::new(None);
    let own = std::process::id();
    let mut known = THREADS.lock().unwrap_or_else(PoisonError::into_inner);
    let threads = match &*known {
        Some((process, threads)) if *process == own => threads.clone(),
        _ => {
            let threads = Arc::new(ThreadPoolBuilder::new().build().map_err(refused)?);
            // The end of the parent's would wait for its threads.
            std::mem::forget(known.replace((own, threads.clone())));
            threads
        }
    };
    drop(known);
    Ok(threads.install(work))
}

/// How pickle and copy make an object again: by the function `maker` of its class from a text.
///
/// Implements: PYT-043.
pub fn remade<'py, T: PyClass>(
    object: &Bound<'py, T>,
    maker: &str,
    text: String,
) -> PyResult<Bound<'py, PyTuple>> {
    let py = object.py();
    let call = py
        .import("operator")?
        .call_method1("methodcaller", (maker, text))?;
    (call, (object.as_any().get_type(),)).into_pyobject(py)
}

/// One name, or several.
#[derive(FromPyObject)]
pub enum Names {
    One(String),
    Many(Vec<String>),
}

impl Names {
    pub fn of(names: &[&str]) -> Names {
        Names::Many(names.iter().map(|&name| name.into()).collect())
    }

    pub fn list(self) -> Vec<String> {
        match self {
            Names::One(name) => vec![name],
            Names::Many(names) => names,
        }
    }
}

/// A table for notebooks: a caption, the heads of the columns, and rows.
///
/// Implements: PYT-044.
pub fn html(caption: &str, heads: &[String], rows: &[Vec<String>]) -> String {
    let cells = |tag: &str, cells: &[String]| {
        let cells = cells
            .iter()
            .map(|cell| format!("<{tag}>{}</{tag}>", escaped(cell)));
        format!("<tr>{}</tr>", cells.collect::<String>())
    };
    let rows = rows.iter().map(|row| cells("td", row)).collect::<String>();
    let (caption, heads) = (escaped(caption), cells("th", heads));
    format!("<table><caption>{caption}</caption>{heads}{rows}</table>")
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;")
}
