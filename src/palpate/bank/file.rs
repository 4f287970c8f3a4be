//! Banks as JSON (`spec/bank.md`).

use std::borrow::Cow;
use std::path::Path;

use serde::{Deserialize, Serialize};

use super::Bank;
use crate::csv::{Column, Rows};
use crate::file::{check_schema, from_json, to_json};
use crate::force_map::ForceMap;
use crate::refusal::Refusal;

/// What the key `schema` of a bank says.
///
/// Implements: BNK-010.
pub const SCHEMA: &str = "palpate-bank";

/// The version of the schema that this program writes and reads.
///
/// Implements: BNK-010.
pub const SCHEMA_VERSION: u64 = 1;

/// The parameters of an inclusion, and its weight.
const PRIOR_COLUMNS: [Column; 5] = [
    &[&[("position_mm", -3), ("position_m", 0)]],
    &[&[("depth_mm", -3), ("depth_m", 0)]],
    &[&[("diameter_mm", -3), ("diameter_m", 0)]],
    &[&[("youngs_modulus_kpa", 3), ("youngs_modulus_pa", 0)]],
    &[&[("weight", 0)]],
];
const PRIOR_HEADER: &str =
    "position_mm,depth_mm,diameter_mm,youngs_modulus_kpa,weight, in any order";

/// The file's keys, in the order in which they are written.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Document<'a> {
    schema: Cow<'a, str>,
    schema_version: u64,
    reference: Cow<'a, ForceMap>,
    maps: Cow<'a, [ForceMap]>,
}

impl Document<'_> {
    fn is_known(&self) -> bool {
        (&*self.schema, self.schema_version) == (SCHEMA, SCHEMA_VERSION)
    }
}

impl Bank {
    /// This bank as JSON.
    ///
    /// Implements: BNK-010.
    pub fn to_json(&self) -> String {
        to_json(&Document {
            schema: SCHEMA.into(),
            schema_version: SCHEMA_VERSION,
            reference: Cow::Borrowed(&self.reference),
            maps: Cow::Borrowed(&self.maps),
        })
    }

    /// The bank in `text`, the content of `file`, which is named in errors alone.
    ///
    /// # Errors
    /// As [`ForceMap::from_json`] for the document and each of its maps, and as [`Bank::new`].
    ///
    /// Implements: BNK-010.
    pub fn from_json(text: &str, file: &str) -> Result<Bank, Refusal> {
        let read = || {
            let document = match from_json::<Document>(text) {
                Ok(document) if document.is_known() => document,
                // A newer file may have keys that this program does not know, so its version says more than they do.
                other => check_schema(text, SCHEMA, SCHEMA_VERSION).and(other)?,
            };
            Bank::new(document.reference.into_owned(), document.maps.into_owned())
        };
        read().map_err(|refusal| refusal.in_file(file))
    }

    /// Reads the bank at `path`.
    ///
    /// # Errors
    /// As [`Bank::from_json`]; a file that cannot be read as UTF-8.
    ///
    /// Implements: BNK-010.
    pub fn read(path: &Path) -> Result<Bank, Refusal> {
        crate::file::read(path, Bank::from_json)
    }

    /// Reads a prior from `path`: CSV with the parameters of each inclusion and its weight, in any order and unit of weight.
    ///
    /// # Errors
    /// A row that is malformed, names no inclusion of the bank or one for the second time, or has a weight below 0; with the line.
    /// Inclusions without a row have the weight 0, but not all.
    ///
    /// Implements: BNK-012.
    pub fn read_prior(&self, path: &Path) -> Result<Vec<f64>, Refusal> {
        let read =
            |text: &str, file: &str| self.prior(text).map_err(|refusal| refusal.in_file(file));
        crate::file::read(path, read)
    }

    /// The prior of each map in `text`.
    pub(super) fn prior(&self, text: &str) -> Result<Vec<f64>, Refusal> {
        let table = Rows::parse(text, PRIOR_COLUMNS, PRIOR_HEADER)?;
        let mut prior: Vec<Option<f64>> = vec![None; self.maps.len()];
        for (line, [position, depth, diameter, modulus, weight]) in table.rows {
            let same = |(a, b): (f64, f64)| (a - b).abs() <= 1e-9 * a.abs().max(b.abs()).max(1.0);
            let asked = [position, depth, diameter, modulus];
            let is_asked = |&map: &usize| self.point(map).into_iter().zip(asked).all(same);
            let found = (0..self.maps.len())
                .find(is_asked)
                .ok_or_else(|| Refusal::state("this inclusion is not in the bank", "").at(line))?;
            let twice = Refusal::state("this inclusion is there twice", "give each once");
            twice.at(line).when(prior[found].is_some())?;
            let below = Refusal::value("weight", weight, "at least 0").at(line);
            below.when(!(0.0..f64::INFINITY).contains(&weight))?;
            prior[found] = Some(weight);
        }
        let whole: f64 = prior.iter().flatten().sum();
        let is_right = whole > 0.0 && whole.is_finite();
        let found = format!("the weights add up to {whole}");
        Refusal::state(found, "give weights whose sum is finite and above 0").when(!is_right)?;
        let share = |weight: Option<f64>| weight.unwrap_or(0.0) / whole;
        Ok(prior.into_iter().map(share).collect())
    }
}
