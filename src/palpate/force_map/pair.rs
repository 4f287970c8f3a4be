//! Two maps that may be taken as the force without and with an inclusion.

use serde_json::{Value, json};

use super::table::check_same_poses;
use super::{ForceMap, ForceTable};
use crate::refusal::Refusal;

/// The forces that the two hypotheses expect, F₀ and F₁, over the same poses.
#[derive(Debug, Clone, Copy)]
pub struct Hypotheses<'a> {
    without: &'a ForceTable,
    with: &'a ForceTable,
}

impl<'a> Hypotheses<'a> {
    /// `without` and `with` an inclusion: the same gel under the same probe, from the same program, mesh and contact law;
    /// where a map does not say, it may be anything.
    ///
    /// ```
    /// use palpate::force::Force;
    /// use palpate::force_map::{ForceMap, ForceTable, Hypotheses, Matrix, Measurement, Source};
    /// use palpate::phantom::Phantom;
    ///
    /// let map = |name| {
    ///     let force = Matrix::from_fn(1, 1, |_, _| 1.5);
    ///     let forces = Force::new(force.clone(), force);
    ///     let table = ForceTable::new(vec![0.004], vec![0.0], forces)?;
    ///     let source = Source::Measured(Measurement::new("gel.csv", ""));
    ///     ForceMap::new(source, Phantom::builtin(name).ok(), table)
    /// };
    /// let (without, with) = (map("none")?, map("6.6")?);
    /// assert!(Hypotheses::new(&without, &with).is_ok());
    /// let swapped = Hypotheses::new(&with, &without).unwrap_err().to_string();
    /// assert!(swapped.starts_with("the maps are swapped"));
    /// # Ok::<(), palpate::refusal::Refusal>(())
    /// ```
    ///
    /// # Errors
    /// The first key whose values differ, with both; maps over other poses.
    ///
    /// Implements: MAP-053.
    pub fn new(without: &'a ForceMap, with: &'a ForceMap) -> Result<Hypotheses<'a>, Refusal> {
        check_gel(without, with)?;
        Hypotheses::of_tables(without.table(), with.table())
    }

    /// Any two tables over the same poses; the caller says that they belong together.
    ///
    /// # Errors
    /// Tables over other poses.
    ///
    /// Implements: TRC-020.
    pub fn of_tables(
        without: &'a ForceTable,
        with: &'a ForceTable,
    ) -> Result<Hypotheses<'a>, Refusal> {
        check_same_poses(with, without)?;
        Ok(Hypotheses { without, with })
    }

    /// Whether both tables have lateral forces, so that those of a record count.
    pub fn have_lateral(&self) -> bool {
        self.without.lateral().is_some() && self.with.lateral().is_some()
    }

    /// The forces without inclusion, F₀.
    pub fn without(&self) -> &'a ForceTable {
        self.without
    }

    /// The forces with the inclusion, F₁.
    pub fn with(&self) -> &'a ForceTable {
        self.with
    }
}

/// Checks that `with` is the gel of `without` with an inclusion.
///
/// # Errors
/// The first key whose values differ, with both.
pub(crate) fn check_gel(without: &ForceMap, with: &ForceMap) -> Result<(), Refusal> {
    let inclusions = |map: &ForceMap| map.phantom().map(|phantom| phantom.inclusions().len());
    let wrong = match (inclusions(without), inclusions(with)) {
        (Some(1..), Some(0)) => {
            "the maps are swapped: only the reference map contains an inclusion"
        }
        (Some(1..), _) => "the reference map already contains an inclusion; give a map without one",
        (_, Some(0)) => {
            "the map has no inclusion to compare with the reference; give a map with one"
        }
        _ => "",
    };
    Refusal::state(wrong, "").when(!wrong.is_empty())?;
    let different = first_difference("", &circumstances(without), &circumstances(with));
    different.map_or(Ok(()), |(key, reference, inclusion)| {
        let found = format!(
            "{key} is {inclusion}, but {reference} in the reference map; only the inclusions may differ"
        );
        Err(Refusal::state(found, ""))
    })
}

/// All but the inclusions that a force depends on, as in the file; null where the map does not say.
fn circumstances(map: &ForceMap) -> Value {
    let mut phantom = json!(map.phantom());
    if let Some(keys) = phantom.as_object_mut() {
        keys.remove("name");
        keys.remove("inclusion");
    }
    let certificate = map.certificate();
    json!({
        "phantom": phantom,
        "mesh_size_m": certificate.map(|certificate| certificate.mesh_size),
        "element": certificate.map(|certificate| &certificate.element),
        "contact": certificate.map(|certificate| &certificate.contact),
        "program_version": certificate.map(|_| map.program_version()),
    })
}

/// The first key whose values are known and differ, with both.
fn first_difference(key: &str, a: &Value, b: &Value) -> Option<(String, String, String)> {
    match (a, b) {
        (Value::Null, _) | (_, Value::Null) => None,
        (Value::Object(a), Value::Object(b)) => a.keys().chain(b.keys()).find_map(|name| {
            let key = format!("{key}{}{name}", if key.is_empty() { "" } else { "." });
            let said = |value: Option<&Value>| value.map_or("not given".into(), Value::to_string);
            match (a.get(name), b.get(name)) {
                (Some(a), Some(b)) => first_difference(&key, a, b),
                // A file leaves out what has its default.
                (a, b) => Some((key, said(a), said(b))),
            }
        }),
        (Value::Array(a), Value::Array(b)) if a.len() == b.len() => {
            let mut entries = a.iter().zip(b).enumerate();
            entries.find_map(|(k, (a, b))| first_difference(&format!("{key}[{k}]"), a, b))
        }
        _ => (a != b).then(|| (key.to_owned(), a.to_string(), b.to_string())),
    }
}
