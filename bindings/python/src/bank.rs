//! Banks of inclusions, and records searched with them.

use std::borrow::Cow;
use std::path::PathBuf;
use std::sync::OnceLock;

use palpate::bank::{self, BankPlan, BankSearch, Location};
use palpate::detect::Decision;
use palpate::fem::FemError;
use palpate::force_map::{ForceMap as Map, SAME_POSITION};
use palpate::refusal::Refusal;
use palpate::robust::{GelChanges, GelUncertainty, Part, RobustQuestion, RobustSweep};
use palpate::trace::{Correlation, Criterion, Noise, Question, Record, Unknown};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyEllipsis, PyList, PyTuple};
use rayon::prelude::*;

use crate::classes::{ForceMap, Phantom};
use crate::convert::{
    Any, Names, array, finite_forces, give_reasons, html, in_unit, lengths, list, on_all, pair,
    python, refused, remade, si, tell,
};
use crate::map::axes;

/// Names of the parameters of an inclusion, and the power of ten from SI to their units.
const NAMES: [(&str, i32); 4] = [
    ("position_mm", 3),
    ("depth_mm", 3),
    ("diameter_mm", 3),
    ("youngs_modulus_kpa", -3),
];

/// What belongs to each parameter, by name and in its unit, in the order of the columns of places.
///
/// Implements: PYT-041.
fn named<'py, T: IntoPyObject<'py>>(
    py: Python<'py>,
    of: impl Fn(usize, i32) -> T,
) -> PyResult<Bound<'py, PyDict>> {
    let named = PyDict::new(py);
    for (axis, (name, power)) in NAMES.into_iter().enumerate() {
        named.set_item(name, of(axis, power))?;
    }
    Ok(named)
}

/// The forces of one gel without an inclusion, and with each of those that may be there: a full grid of positions, depths, diameters
/// and Young's moduli.
#[doc = sections!(
    reference: "ForceMap" = "The forces without an inclusion, N.",
    maps: "sequence of ForceMap" = "Those with each inclusion, whose phantoms make the full grid, N.";;
    "Maps of other poses or gels, or an inclusion that is missing or there twice."
)]
/// Examples
/// --------
/// >>> x = np.linspace(-8, 8, 81)
/// >>> bank = Bank.build(Phantom("6.6"), 4, [-8, -4, 0, 4, 8], offsets_mm=[-2, 0, 2], mesh_mm=2)
/// >>> record = bank.maps[2].sweep(4, x) + 0.05 * np.random.default_rng(1).standard_normal((2, 81))
/// >>> answer = bank.locate(x, record, noise_sd_n=0.05)
/// >>> answer["inclusion"], answer["likeliest"]["position_mm"]
/// (True, 2.0)
#[pyclass(frozen, module = "palpate")]
pub struct Bank {
    pub(crate) bank: bank::Bank,
    /// The gels beside that of the bank, once they were asked for.
    changes: OnceLock<Option<GelChanges>>,
}

impl Bank {
    fn of(bank: bank::Bank) -> Bank {
        let changes = OnceLock::new();
        Bank { bank, changes }
    }

    /// The gels beside that of the bank, under the passes of a record.
    pub fn changes_under(
        &self,
        record: &Record,
        passes: &[&Record],
    ) -> PyResult<Option<Cow<'_, GelChanges>>> {
        if record.depths().is_none() {
            return Ok(self.changes()?.map(Cow::Borrowed));
        }
        let usual = GelUncertainty::default();
        let reference = self.bank.reference();
        let depths = GelChanges::depths_along(reference, passes);
        let own = on_all(|| GelChanges::new(reference, &depths, &usual))?;
        Ok(own.map_err(refused)?.map(Cow::Owned))
    }

    /// Those under the probe at the depth of the bank, computed the first time.
    fn changes(&self) -> PyResult<Option<&GelChanges>> {
        if let Some(known) = self.changes.get() {
            return Ok(known.as_ref());
        }
        let (reference, depth) = (self.bank.reference(), self.bank.depth());
        let usual = GelUncertainty::default();
        let found = on_all(|| GelChanges::new(reference, &[depth], &usual))?;
        let found = found.map_err(refused)?;
        Ok(self.changes.get_or_init(|| found).as_ref())
    }
}

/// The maps of a plan, the reference first; on all processors, a few at a time, so that this thread hears of Ctrl-C.
fn solved(plan: &BankPlan, progress: Option<&Py<PyAny>>) -> PyResult<Vec<Map>> {
    let solves = plan.solves().map_err(refused)?;
    let all = solves.len() + 1;
    let mut maps = vec![plan.reference().map_err(refused)?];
    tell(progress, 1, all)?;
    let threads = on_all(rayon::current_num_threads)?;
    let mut last = vec![None; threads];
    for (number, few) in (0..).zip(solves.chunks(threads)) {
        let found = few.par_iter().zip(&mut last);
        let found = found.map(|(solve, last)| plan.solve(solve, last));
        let found: Result<Vec<_>, FemError> = on_all(|| found.collect())?;
        let found = found.map_err(refused)?;
        maps.extend(found.into_iter().flatten());
        tell(progress, 1 + number * threads + few.len(), all)?;
    }
    Ok(maps)
}

/// Positions over a bank, m.
///
/// Implements: PYT-005.
pub fn over(bank: &bank::Bank, positions_mm: Any) -> PyResult<Vec<f64>> {
    let positions = list("positions_mm", positions_mm, -3)?;
    let laterals = bank.reference().table().laterals();
    let (first, last) = (laterals[0], laterals[laterals.len() - 1]);
    let over = first - SAME_POSITION..=last + SAME_POSITION;
    if let Some(at) = positions.iter().position(|x| !over.contains(x)) {
        let [found, first, last] = [positions[at], first, last].map(|x| in_unit(x, 3));
        let right = format!("between {first} and {last}, as in the bank; leave the others out");
        let beyond = Refusal::value(format!("positions_mm[{at}]"), found, right);
        return Err(refused(beyond));
    }
    Ok(positions)
}

/// The record of forces, or of normal forces alone, at positions over a bank.
///
/// Implements: PYT-005.
fn record(
    bank: &bank::Bank,
    positions_mm: Any,
    forces_n: Any,
    depths_mm: Option<Any>,
) -> PyResult<Record> {
    let positions = over(bank, positions_mm)?;
    let forces = finite_forces("forces_n", forces_n)?;
    let forces = forces.as_ref().map(Vec::as_slice);
    let depths = depths_mm.map(|depths| lengths("depths_mm", depths));
    let record = match depths.transpose()? {
        None if bank.probe_depths().len() > 1 => {
            let found = format!(
                "the bank has {} depths of the probe",
                bank.probe_depths().len()
            );
            let remedy = "give depths_mm, the depth of each sample";
            return Err(refused(Refusal::state(found, remedy)));
        }
        None => Record::new("record", &positions, forces),
        Some(depths) => Record::along("record", &positions, &depths, forces),
    };
    record.map_err(refused)
}

/// Those of `all` that the `names` under a key of Python name; "all" and "none" name them too.
pub fn chosen<T: Copy + ToString>(
    key: &str,
    names: Vec<String>,
    all: impl IntoIterator<Item = T>,
) -> PyResult<Vec<T>> {
    let all: Vec<(String, T)> = all.into_iter().map(|of| (of.to_string(), of)).collect();
    match &names[..] {
        [name] if name == "all" => return Ok(all.into_iter().map(|(_, of)| of).collect()),
        [name] if name == "none" => return Ok(Vec::new()),
        _ => {}
    }
    let of_name = |name: String| {
        let found = all.iter().find(|(known, _)| *known == name);
        let known: Vec<_> = all.iter().map(|(known, _)| &known[..]).collect();
        let right = format!("one of {}", known.join(", "));
        let (_, found) = found.ok_or_else(|| refused(Refusal::value(key, name, right)))?;
        Ok(*found)
    };
    names.into_iter().map(of_name).collect()
}

/// The criterion of at most one of two rates.
fn criterion(max_miss: Option<f64>, max_false_alarm: Option<f64>) -> PyResult<Criterion> {
    match (max_miss, max_false_alarm) {
        (None, None) => Ok(Criterion::MaximumAPosteriori),
        (Some(max_miss), None) => Ok(Criterion::NeymanPearsonMiss { max_miss }),
        (None, Some(max_false_alarm)) => Ok(Criterion::NeymanPearsonFalseAlarm { max_false_alarm }),
        _ => Err(refused(
            "max_miss and max_false_alarm are both given; give one of them",
        )),
    }
}

/// The rows of an answer, with parameters of the inclusion in mm and kPa.
fn told<'py>(py: Python<'py>, bank: &bank::Bank, found: &Location) -> PyResult<Bound<'py, PyAny>> {
    let place = &found.place;
    let at = |point: [f64; 4]| named(py, |axis, power| in_unit(point[axis], power));
    let intervals = [0, 1, 2, 3].map(|axis| found.interval(bank, axis));
    let intervals = intervals.into_iter().collect::<Result<Vec<_>, _>>();
    let intervals = intervals.map_err(refused)?;
    let interval = |axis: usize, power| {
        let only = Some(place.estimate[axis]);
        let ends = intervals[axis].map_or([only; 2], |of| [of.lower, of.upper]);
        ends.map(|end| end.map(|end| in_unit(end, power)))
    };
    let answer = python(py, &found.rows(bank).map_err(refused)?)?;
    let decided = found.decision.map(|found| found == Decision::Inclusion);
    answer.set_item("inclusion", decided)?;
    give_reasons(&answer, &found.causes)?;
    for (key, named) in [
        ("likeliest", at(found.point)?),
        ("estimate", at(place.estimate)?),
        ("mean", at(place.mean())?),
        ("interval_95", named(py, interval)?),
    ] {
        answer.set_item(key, named)?;
    }
    let nodes: Vec<_> = place.nodes().collect();
    let powers = NAMES.map(|(_, power)| power);
    let places = nodes
        .iter()
        .flat_map(|(at, _)| at.iter().zip(powers))
        .map(|(&value, power)| in_unit(value, power));
    answer.set_item("places", array(py, &[nodes.len(), 4], places.collect())?)?;
    let mass = nodes.iter().map(|(_, mass)| *mass).collect();
    answer.set_item("probabilities", array(py, &[nodes.len()], mass)?)?;
    Ok(answer)
}

#[pymethods]
impl Bank {
    #[new]
    fn new(reference: &ForceMap, maps: Vec<PyRef<ForceMap>>) -> PyResult<Bank> {
        let maps = maps.iter().map(|map| map.0.clone()).collect();
        let bank = bank::Bank::new(reference.0.clone(), maps);
        Ok(Bank::of(bank.map_err(refused)?))
    }

    /// The bank for the one inclusion of a phantom, varied; what is None has the value of the phantom.
    #[doc = sections!(
        phantom: "Phantom" = "The gel with one inclusion.",
        probe_depth_mm: "float or array_like" = "Depth of the sweeps, or several that increase, mm.",
        laterals_mm: "array_like, shape (n,)" = "Lateral positions of the sweeps, increasing, mm.",
        offsets_mm: "float or array_like, optional" = "x of the inclusion's centre, mm.",
        depths_mm: "float or array_like, optional" = "Depths of the inclusion's top, mm.",
        diameters_mm: "float or array_like, optional" = "Diameters of the inclusion, mm.",
        stiffnesses_kpa: "float or array_like, optional" = "Young's moduli of the inclusion, kPa.",
        mesh_mm, contact, progress;
        "Bank" = "The forces without the inclusion and with each, N.";
        "An inclusion or a pose that cannot be, or a phantom without one inclusion."
    )]
    // Implements: PYT-010, PYT-020.
    #[staticmethod]
    #[pyo3(signature = (phantom, probe_depth_mm, laterals_mm, offsets_mm=None, depths_mm=None, diameters_mm=None, stiffnesses_kpa=None,
        mesh_mm=0.65, contact="deformed-normal", progress=None))]
    #[allow(clippy::too_many_arguments, reason = "keywords in Python")]
    fn build(
        py: Python<'_>,
        phantom: &Phantom,
        probe_depth_mm: Any,
        laterals_mm: Any,
        offsets_mm: Option<Any>,
        depths_mm: Option<Any>,
        diameters_mm: Option<Any>,
        stiffnesses_kpa: Option<Any>,
        mesh_mm: f64,
        contact: &str,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Bank> {
        let depths = lengths("probe_depth_mm", probe_depth_mm)?;
        let laterals = lengths("laterals_mm", laterals_mm)?;
        let deepest = depths.last().copied().unwrap_or_default();
        let plan = BankPlan::new(phantom.0.clone(), deepest, &laterals);
        let mut plan = plan.map_err(refused)?;
        plan.probe_depths = depths;
        plan.mesh_size = si("mesh_mm", mesh_mm, -3)?;
        plan.contact = crate::phantom::contact(contact)?;
        for (name, values, power, place) in [
            ("offsets_mm", offsets_mm, -3, &mut plan.positions),
            ("depths_mm", depths_mm, -3, &mut plan.depths),
            ("diameters_mm", diameters_mm, -3, &mut plan.diameters),
            ("stiffnesses_kpa", stiffnesses_kpa, 3, &mut plan.moduli),
        ] {
            if let Some(values) = values {
                *place = match power {
                    -3 => lengths(name, values)?,
                    _ => list(name, values, power)?,
                };
            }
        }
        let mut maps = py.detach(|| solved(&plan, progress.as_ref()))?;
        let reference = maps.remove(0);
        Ok(Bank::of(bank::Bank::new(reference, maps).map_err(refused)?))
    }

    /// The bank in a file, as palpate bank writes it.
    #[doc = sections!(path; "Bank" = "The bank."; "No such file, or one that is no bank, with line and key.")]
    #[staticmethod]
    fn read(path: PathBuf) -> PyResult<Bank> {
        Ok(Bank::of(bank::Bank::read(&path).map_err(refused)?))
    }

    /// The bank of a JSON text, as to_json gives it.
    #[doc = sections!(text; "Bank" = "The bank, with all of its digits."; "A text that is no bank, with line and key.")]
    #[staticmethod]
    fn from_json(text: &str) -> PyResult<Bank> {
        Ok(Bank::of(
            bank::Bank::from_json(text, "text").map_err(refused)?,
        ))
    }

    /// The bank as JSON, the text of a file; lengths are in m, forces in N.
    fn to_json(&self) -> String {
        self.bank.to_json()
    }

    /// Writes the bank to a file, for palpate detect too. A file that is there is overwritten.
    #[doc = sections!(path;;)]
    fn write(&self, path: PathBuf) -> PyResult<()> {
        Ok(palpate::file::write(&path, &self.bank.to_json())?)
    }

    /// The depth of the probe, mm.
    #[getter]
    fn probe_depth_mm(&self) -> f64 {
        in_unit(self.bank.depth(), 3)
    }

    /// The forces without an inclusion.
    #[getter]
    fn reference(&self) -> ForceMap {
        ForceMap(self.bank.reference().clone())
    }

    /// The forces with each inclusion: those of all positions, then those of the next depth, diameter, modulus.
    #[getter]
    fn maps<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyList>> {
        PyList::new(py, self.bank.maps().iter().cloned().map(ForceMap))
    }

    /// The values of position_mm, depth_mm, diameter_mm (mm) and youngs_modulus_kpa (kPa), lists in a dictionary.
    #[getter]
    fn axes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let values = |axis: usize, power| {
            let values = self.bank.axes()[axis].iter();
            values
                .map(|&value| in_unit(value, power))
                .collect::<Vec<_>>()
        };
        named(py, values)
    }

    /// Is an inclusion of the bank in a record, whatever gel, motion and sensor did to it? The answer of palpate detect --bank.
    ///
    /// The first call computes the gels beside that of the bank, one with depths_mm each time; the passes of that are judged together.
    #[doc = sections!(
        positions_mm, forces_n, own_noise_sd_n,
        known: "str or sequence of str, optional" = "What does not disturb: smooth, gel, support, stage, surface, tilt, friction, relaxation, walk.",
        zeroed,
        sure: "float, optional" = "The posterior from which on there is an inclusion.",
        prior, own_prior_h1, own_depths_mm;
        "dict" = "The JSON of palpate detect, in SI; inclusion (True, False or None: cannot be judged); reasons, the words for causes; and samples_left_out, of passes that are too short.";
        "A sample beyond the bank or not finite, or a name or a number that makes no sense."
    )]
    #[pyo3(signature = (positions_mm, forces_n, noise_sd_n=None, known=Names::of(&[]), zeroed=false, sure=0.95, prior=None, prior_h1=0.5,
        depths_mm=None),
        text_signature = "($self, positions_mm, forces_n, noise_sd_n=None, known=(), zeroed=False, sure=0.95, prior=None, prior_h1=0.5, depths_mm=None)")]
    #[allow(clippy::too_many_arguments, reason = "keywords in Python")]
    fn judge<'py>(
        &self,
        py: Python<'py>,
        positions_mm: Any<'_, 'py>,
        forces_n: Any<'_, 'py>,
        noise_sd_n: Option<Any<'_, 'py>>,
        known: Names,
        zeroed: bool,
        sure: f64,
        prior: Option<Any<'_, 'py>>,
        prior_h1: f64,
        depths_mm: Option<Any<'_, 'py>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let record = record(&self.bank, positions_mm, forces_n, depths_mm)?;
        let prior = prior.map(|prior| list("prior", prior, 0)).transpose()?;
        let known = chosen("known", known.list(), Part::KNOWN)?;
        let question = RobustQuestion {
            known: &known,
            is_zeroed: zeroed,
            noise_sd: noise_sd_n.map(|sd| pair("noise_sd_n", sd)).transpose()?,
            prior_h1,
            sure,
            ..RobustQuestion::default()
        };
        let found = py.detach(|| -> PyResult<_> {
            let reference = self.bank.reference();
            let (passes, left_out) = question.passes(&record, reference);
            let along: Vec<&Record> = passes.iter().collect();
            let changes = self.changes_under(&record, &along)?;
            let sweep = |record| RobustSweep::new(record, self.bank.depth(), changes.as_deref());
            let sweeps: Vec<_> = along.into_iter().map(sweep).collect();
            let found = question.locate(&self.bank, prior.as_deref(), &sweeps);
            Ok((found.map_err(refused)?, left_out))
        });
        let ((answer, place), left_out) = found?;
        let told = python(py, &answer.rows(Some((&self.bank, &place))))?;
        give_reasons(&told, &answer.causes)?;
        let decided = answer.decision.map(|found| found == Decision::Inclusion);
        told.set_item("inclusion", decided)?;
        told.set_item("samples_left_out", left_out)?;
        Ok(told)
    }

    /// Is one of the bank's inclusions in a record, and where? The answer of palpate detect --model exact, for the fewest errors, or with at
    /// most max_miss or max_false_alarm.
    ///
    /// The answer also has likeliest, estimate, mean and interval_95 of each parameter in mm and kPa, if there is an inclusion; places,
    /// shape (m, 4), one column for each key of axes in its order; and their probabilities, shape (m,).
    #[doc = sections!(
        positions_mm, forces_n, own_noise_sd_n,
        unknown: "str or sequence of str, optional" = "What is fitted, of offset, drift, gain, depth and variance.",
        white: "bool, optional" = "Whether the noise is white, so that it is not tested.",
        depth_tolerance_mm: "float, optional" = "The depth is known within so much, mm.",
        own_max_miss, own_max_false_alarm, prior, own_prior_h1, zeroed, own_depths_mm;
        "dict" = "As of judge, with what is above.";
        "As judge; both rates."
    )]
    #[pyo3(signature = (positions_mm, forces_n, noise_sd_n=None, unknown=Names::of(&["offset", "drift", "gain", "variance"]), white=false, depth_tolerance_mm=0.3, max_miss=None, max_false_alarm=None, prior=None, prior_h1=0.5, zeroed=false, depths_mm=None),
        text_signature = "($self, positions_mm, forces_n, noise_sd_n=None, unknown=('offset', 'drift', 'gain', 'variance'), white=False, depth_tolerance_mm=0.3, max_miss=None, max_false_alarm=None, prior=None, prior_h1=0.5, zeroed=False, depths_mm=None)")]
    #[allow(clippy::too_many_arguments, reason = "keywords in Python")]
    fn locate<'py>(
        &self,
        py: Python<'py>,
        positions_mm: Any<'_, 'py>,
        forces_n: Any<'_, 'py>,
        noise_sd_n: Option<Any<'_, 'py>>,
        unknown: Names,
        white: bool,
        depth_tolerance_mm: f64,
        max_miss: Option<f64>,
        max_false_alarm: Option<f64>,
        prior: Option<Any<'_, 'py>>,
        prior_h1: f64,
        zeroed: bool,
        depths_mm: Option<Any<'_, 'py>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let record = record(&self.bank, positions_mm, forces_n, depths_mm)?;
        let sd = noise_sd_n.map(|sd| pair("noise_sd_n", sd)).transpose()?;
        let correlation = match white {
            true => Correlation::None,
            false => Correlation::OfRecord,
        };
        let prior = prior.map(|prior| list("prior", prior, 0)).transpose()?;
        let search = BankSearch {
            question: Question {
                depth: self.bank.depth(),
                depth_tolerance: si("depth_tolerance_mm", depth_tolerance_mm, -3)?,
                is_zeroed: zeroed,
                unknown: &chosen("unknown", unknown.list(), Unknown::ALL)?,
                noise: Noise { sd, correlation },
                criterion: criterion(max_miss, max_false_alarm)?,
                prior_h1,
            },
            bank: &self.bank,
            prior: prior.as_deref(),
            simulations: None,
        };
        let found = py.detach(|| search.locate(&record));
        told(py, &self.bank, &found.map_err(refused)?)
    }

    /// Draws the posterior density of one parameter, given an inclusion; needs Matplotlib.
    #[doc = sections!(
        answer: "dict" = "An answer of locate.",
        parameter: "str, optional" = "A key of axes, with its unit, mm or kPa.",
        ax;
        "matplotlib Axes" = "Where it was drawn.";
        "Another parameter."
    )]
    // Implements: PYT-045.
    #[staticmethod]
    #[pyo3(signature = (answer, parameter="position_mm", ax=None))]
    fn plot<'py>(
        py: Python<'py>,
        answer: Any<'_, 'py>,
        parameter: &str,
        ax: Option<Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let column = NAMES.iter().position(|(name, _)| *name == parameter);
        let known = NAMES.map(|(name, _)| name).join(", ");
        let wrong = || {
            refused(Refusal::value(
                "parameter",
                parameter,
                format!("one of {known}"),
            ))
        };
        let column = column.ok_or_else(wrong)?;
        let places = answer
            .get_item("places")?
            .get_item((PyEllipsis::get(py), column))?;
        let options = PyDict::new(py);
        options.set_item("weights", answer.get_item("probabilities")?)?;
        options.set_item("bins", 40)?;
        options.set_item("density", true)?;
        let ax = axes(py, ax)?;
        ax.call_method("hist", (places,), Some(&options))?;
        ax.call_method1(
            "set_xlabel",
            (parameter
                .replacen("_mm", ", mm", 1)
                .replace("_kpa", ", kPa")
                .replace('_', " "),),
        )?;
        ax.call_method1("set_ylabel", ("probability density",))?;
        Ok(ax)
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyTuple>> {
        remade(slf, "from_json", slf.get().bank.to_json())
    }

    // Implements: PYT-044.
    fn _repr_html_(&self) -> String {
        let row = |(axis, (name, power)): (usize, (&str, i32))| {
            let values = self.bank.axes()[axis].iter();
            let values: Vec<_> = values.map(|&x| in_unit(x, power).to_string()).collect();
            vec![name.into(), values.join(", ")]
        };
        let rows: Vec<_> = NAMES.into_iter().enumerate().map(row).collect();
        html(&self.__repr__(), &[], &rows)
    }

    fn __repr__(&self) -> String {
        let (maps, depth) = (self.bank.maps().len(), self.probe_depth_mm());
        let varied = (0..4).filter(|&axis| self.bank.axes()[axis].len() > 1);
        let range = |axis: usize| {
            let (name, power) = NAMES[axis];
            let values = &self.bank.axes()[axis];
            let [from, to] = [values[0], values[values.len() - 1]].map(|x| in_unit(x, power));
            format!(", {name} {from} to {to} ({})", values.len())
        };
        let varied: String = varied.map(range).collect();
        format!("<Bank of {maps} inclusions{varied}, probe at {depth} mm>")
    }
}
