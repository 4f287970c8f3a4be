//! How deep an inclusion may lie, and how small it may be, to be found.

use palpate::bank::{BesideClass, Reach, Reached, smallest_diameters};
use palpate::refusal::Refusal;
use palpate::trace::{Record, Unknown};
use pyo3::prelude::*;
use serde_json::{Map, Value, json};

use crate::bank::{Bank, chosen, over};
use crate::convert::{Any, Names, in_unit, lengths, pair, python, refused};

/// How deep the inclusions of a bank may lie, and how small they may be, to be found in a sweep: what palpate reach states, at the position of
/// the bank nearest to 0, in white noise of a known level.
///
/// Each of largest_depths, for a diameter_mm and youngs_modulus_kpa, has gamma at each depth of the bank, largest_depth_mm (None: not found
/// at the least depth) and is_beyond_bank (found at the greatest), and with classes gamma beside each class of disturbance that judge
/// averages over. Each of smallest_diameters, for a depth_mm and youngs_modulus_kpa, has smallest_diameter_mm (None: not even the largest).
#[doc = sections!(
    bank: "Bank" = "The inclusions, of several depths and diameters.",
    noise_sd_n,
    unknown: "str or sequence of str, optional" = "What is fitted, of offset, drift, gain and depth.",
    own_max_false_alarm, own_max_miss,
    positions_mm: "array_like, shape (n,), optional" = "Lateral positions of the samples, mm; by default those of the bank.",
    own_depths_mm,
    classes: "bool, optional" = "Whether gamma beside each class of disturbance is computed too.";
    "dict" = "gamma_needed; largest_depths and smallest_diameters, mm.";
    "A sample beyond the bank, or a name or a number that makes no sense."
)]
/// Examples
/// --------
/// >>> bank = Bank.build(Phantom("6.6"), 3, np.arange(-8, 9), offsets_mm=0, depths_mm=[3.6, 5.6, 7.6], mesh_mm=2)
/// >>> answer = reach(bank, noise_sd_n=0.05, unknown="offset")
/// >>> round(answer["largest_depths"][0]["largest_depth_mm"], 1)
/// 6.0
// Implements: PYT-054.
#[pyfunction]
#[pyo3(signature = (bank, noise_sd_n, unknown=Names::of(&["offset", "drift", "gain"]), max_false_alarm=0.01, max_miss=0.05,
    positions_mm=None, depths_mm=None, classes=false),
    text_signature = "(bank, noise_sd_n, unknown=('offset', 'drift', 'gain'), max_false_alarm=0.01, max_miss=0.05, positions_mm=None, depths_mm=None, classes=False)")]
#[allow(clippy::too_many_arguments, reason = "keywords in Python")]
pub fn reach<'py>(
    py: Python<'py>,
    bank: &Bank,
    noise_sd_n: Any<'_, 'py>,
    unknown: Names,
    max_false_alarm: f64,
    max_miss: f64,
    positions_mm: Option<Any<'_, 'py>>,
    depths_mm: Option<Any<'_, 'py>>,
    classes: bool,
) -> PyResult<Bound<'py, PyAny>> {
    for (name, rate) in [("max_false_alarm", max_false_alarm), ("max_miss", max_miss)] {
        let wrong = Refusal::value(name, rate, "above 0 and below 1");
        wrong.when(!(rate > 0.0 && rate < 1.0)).map_err(refused)?;
    }
    // The level of the noise is stated.
    let all = Unknown::ALL.into_iter();
    let all = all.filter(|&unknown| unknown != Unknown::Variance);
    let reach = Reach {
        bank: &bank.bank,
        sweep: &sweep(bank, positions_mm, depths_mm)?,
        noise_sd: pair("noise_sd_n", noise_sd_n)?,
        max_false_alarm,
        max_miss,
        unknown: &chosen("unknown", unknown.list(), all)?,
    };
    let answer = py.detach(|| -> PyResult<Value> {
        let beside: Option<Vec<Vec<BesideClass>>> = match classes {
            true => Some(beside_classes(bank, &reach)?),
            false => None,
        };
        let (gamma, reached) = (reach.gamma(), reach.reached());
        let (gamma, reached) = (gamma.map_err(refused)?, reached.map_err(refused)?);
        let rows = reached.iter().enumerate();
        let row = |(at, of): (usize, &Reached)| {
            let classes = beside.as_ref().map(|all| &all[at][..]);
            largest(of, classes)
        };
        let depths: Vec<Value> = rows.map(row).collect();
        let diameters = smallest(&bank.bank, &reached, gamma);
        Ok(json!({"gamma_needed": gamma, "largest_depths": depths, "smallest_diameters": diameters}))
    });
    python(py, &answer?)
}

/// Where the samples are taken.
fn sweep(bank: &Bank, positions_mm: Option<Any>, depths_mm: Option<Any>) -> PyResult<Record> {
    let record = match (positions_mm, depths_mm) {
        (None, None) => bank.bank.sweep(None),
        (None, Some(_)) => {
            let found = "depths_mm are given without positions_mm; give both";
            return Err(refused(found));
        }
        (Some(positions), None) => Record::planned(&over(&bank.bank, positions)?, &[]),
        (Some(positions), Some(depths)) => {
            let depths = lengths("depths_mm", depths)?;
            if depths.is_empty() {
                return Err(refused("depths_mm is empty; give one for each position"));
            }
            Record::planned(&over(&bank.bank, positions)?, &depths)
        }
    };
    record.map_err(refused)
}

fn beside_classes(bank: &Bank, reach: &Reach) -> PyResult<Vec<Vec<BesideClass>>> {
    let passes = reach.passes();
    let changes = bank.changes_under(reach.sweep, &passes.iter().collect::<Vec<_>>())?;
    reach.beside_classes(changes.as_deref()).map_err(refused)
}

fn largest(of: &Reached, classes: Option<&[BesideClass]>) -> Value {
    let mut row = json!({
        "diameter_mm": in_unit(of.diameter, 3), "youngs_modulus_kpa": in_unit(of.modulus, -3), "gamma": of.gamma,
        "largest_depth_mm": of.depth.map(|depth| in_unit(depth, 3)), "is_beyond_bank": of.is_beyond,
    });
    if let Some(classes) = classes {
        let named = classes.iter().map(|of| (of.class.into(), json!(of.gamma)));
        row["classes"] = Value::Object(named.collect::<Map<_, _>>());
    }
    row
}

fn smallest(bank: &palpate::bank::Bank, reached: &[Reached], needed: f64) -> Vec<Value> {
    let [_, depths, diameters, _] = bank.axes();
    let of_modulus = |reached: &[Reached]| {
        let found = smallest_diameters(bank, reached, needed);
        let modulus = in_unit(reached[0].modulus, -3);
        let row = |(depth, found): (&f64, Option<f64>)| {
            json!({
                "depth_mm": in_unit(*depth, 3), "youngs_modulus_kpa": modulus,
                "smallest_diameter_mm": found.map(|diameter| in_unit(diameter, 3)),
                "is_beyond_bank": found.is_some_and(|diameter| diameter <= diameters[0]),
            })
        };
        depths.iter().zip(found).map(row).collect::<Vec<_>>()
    };
    reached
        .chunks(diameters.len())
        .flat_map(of_modulus)
        .collect()
}
