//! What a study found.

use std::ops::Range;
use std::path::Path;

use serde::{Deserialize, Serialize};

use super::design::{BESIDE_MEDIAN, Values};
use super::indices::{Estimate, indices};
use super::{Band, Change, Index, Kind, Quantity, Sampler, StudyPlan, band};
use crate::psychophysics::CONFIDENCE;
use crate::psychophysics::bridge::LEVEL;
use palpate::fem::certify;
use palpate::file::{check_schema, from_json};
use palpate::refusal::Refusal;
use palpate::stats::binomial;

/// Numbers that are held at once, over all samples and some quantities: 32 MiB.
const HELD: usize = 1 << 22;
/// A sample that could not be computed.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Failure {
    /// Its number.
    pub sample: usize,
    /// Why.
    pub reason: String,
}

/// What one input by itself does to a quantity at the medians of all.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Slope {
    /// The change of the quantity from the lower to the upper quartile of the input.
    pub between_quartiles: f64,
    /// That change over that of the input, in the units of both.
    pub per_unit: f64,
    /// The same in per cent per per cent; `None` for an input that is added to a number.
    pub elasticity: Option<f64>,
}

/// What a study says of one quantity.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct QuantityResult {
    /// Which.
    #[serde(flatten)]
    pub quantity: Quantity,
    /// Its value with all inputs at their medians; `None` where that sample failed.
    pub at_medians: Option<f64>,
    /// The grid convergence index there: how far the value may be from that of an infinitely fine mesh.
    pub numerical_band: Option<f64>,
    /// Where the samples lie.
    pub band: Option<Band>,
    /// For each input.
    pub slopes: Vec<Option<Slope>>,
    /// For each group of inputs; empty where the quantity does not vary.
    pub indices: Vec<Index>,
}

/// Whether a statement about the paper's gel holds for all inputs.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Conclusion {
    /// The quantity that decides.
    #[serde(flatten)]
    pub quantity: Quantity,
    /// The statement: the quantity is at least so large, or below.
    pub limit: f64,
    /// Whether it is "at least".
    pub at_least: bool,
    /// Whether it holds with all inputs at their medians.
    pub at_medians: Option<bool>,
    /// The share of the samples for which it holds.
    pub share: f64,
    /// The lower end of Clopper and Pearson's interval of 95 %.
    pub lower: f64,
    /// The upper end.
    pub upper: f64,
}

/// What a study found.
///
/// Implements: STU-050.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct StudyResults {
    /// "palpate-study".
    pub schema: String,
    /// The version of the schema.
    pub schema_version: u64,
    /// The version of the program.
    pub program_version: String,
    /// The arithmetic of the solver that computed the samples.
    pub arithmetic: String,
    /// What was varied.
    pub plan: StudyPlan,
    /// The names of the inputs of each group.
    pub groups: Vec<Vec<String>>,
    /// The number of samples.
    pub samples: usize,
    /// How many of them failed.
    pub failed: usize,
    /// The first of those.
    pub failures: Vec<Failure>,
    /// Rows of which no sample failed: the indices are of them.
    pub rows_used: usize,
    /// What holds for which share of the samples.
    pub conclusions: Vec<Conclusion>,
    /// All quantities.
    pub quantities: Vec<QuantityResult>,
}

impl StudyResults {
    /// Reads the results at `path`.
    ///
    /// # Errors
    /// A file that cannot be read as UTF-8, and what is no document of this schema; with the file, and line and key where there are any.
    ///
    /// Implements: STU-050.
    pub fn read(path: &Path) -> Result<StudyResults, Refusal> {
        palpate::file::read(path, |text, file| {
            let read = check_schema(text, Self::SCHEMA, Self::SCHEMA_VERSION);
            let read = read.and_then(|()| from_json(text));
            read.map_err(|refusal| refusal.in_file(file))
        })
    }

    /// What the study says of one quantity, if it has it.
    pub fn of(&self, phantom: &str, kind: &Kind) -> Option<&QuantityResult> {
        let mut quantities = self.quantities.iter();
        quantities.find(|of| of.quantity.phantom == phantom && of.quantity.kind == *kind)
    }

    /// The quantities for people: all but the forces beside x = 0, and the p-values, which the conclusions are about.
    pub fn listed(&self) -> impl Iterator<Item = &QuantityResult> {
        self.quantities.iter().filter(|of| match of.quantity.kind {
            Kind::NormalForceN { lateral_m } => lateral_m == 0.0,
            Kind::LateralForceN { .. } | Kind::ConventionP { .. } => false,
            _ => true,
        })
    }

    /// The group of inputs with the largest total index of a quantity, and that.
    pub fn largest<'a>(&self, of: &'a QuantityResult) -> Option<(String, &'a Estimate)> {
        let groups = self.groups.iter().zip(&of.indices);
        let largest = groups.max_by(|a, b| a.1.total.value.total_cmp(&b.1.total.value));
        largest.map(|(names, index)| (names.join(" and "), &index.total))
    }

    /// The schema's name.
    pub const SCHEMA: &str = "palpate-study";
    /// The schema's version.
    pub const SCHEMA_VERSION: u64 = 1;
    /// How many failures are told with their reason.
    pub const TOLD: usize = 20;

    /// The results of a study whose samples were computed with `arithmetic`. `columns` gives the values of some quantities in all samples,
    /// a NaN for those that failed; it is called for one block of quantities after another.
    ///
    /// # Errors
    /// Those of `columns`.
    ///
    /// Implements: STU-040, STU-043, STU-032, STU-050.
    pub fn new<E: From<Refusal>>(
        sampler: &Sampler<'_>,
        arithmetic: &str,
        failures: &[Failure],
        columns: impl Fn(Range<usize>) -> Result<Vec<Vec<f64>>, E>,
    ) -> Result<StudyResults, E> {
        let (plan, design) = (sampler.plan(), sampler.design());
        let samples = design.samples();
        let quantities = sampler.quantities();
        let (mut results, mut conclusions) = (Vec::new(), Vec::new());
        let mut rows_used = 0;
        let block = (HELD / samples).clamp(1, quantities.len().max(1));
        for from in (0..quantities.len()).step_by(block) {
            let to = (from + block).min(quantities.len());
            for (quantity, values) in quantities[from..to].iter().zip(columns(from..to)?) {
                let values = design.split(&values);
                let column = Column { sampler, values };
                let (result, rows) = column.result(quantity)?;
                rows_used = rows;
                results.push(result);
                conclusions.extend(column.conclusion(quantity)?);
            }
        }
        let name = |&input: &usize| plan.inputs[input].name.clone();
        let names = |group: &Vec<usize>| group.iter().map(name).collect();
        Ok(StudyResults {
            schema: Self::SCHEMA.into(),
            schema_version: Self::SCHEMA_VERSION,
            program_version: env!("CARGO_PKG_VERSION").into(),
            arithmetic: arithmetic.into(),
            plan: plan.clone(),
            groups: design.groups().iter().map(names).collect(),
            samples,
            failed: failures.len(),
            failures: failures.iter().take(Self::TOLD).cloned().collect(),
            rows_used,
            conclusions,
            quantities: results,
        })
    }
}

/// One quantity in all samples.
struct Column<'a> {
    sampler: &'a Sampler<'a>,
    values: Values<'a>,
}

impl Column<'_> {
    /// The values of both samples that did not fail.
    fn sampled(&self) -> Vec<f64> {
        let both = self.values.rows.iter().flat_map(|row| &row[..2]).copied();
        both.filter(|value| value.is_finite()).collect()
    }

    fn result(&self, quantity: &Quantity) -> Result<(QuantityResult, usize), Refusal> {
        let plan = self.sampler.plan();
        let medians = [0, 1, 2].map(|mesh| self.values.medians[mesh]);
        let known = |value: f64| value.is_finite().then_some(value);
        let is_whole = |row: &&[f64]| row.iter().all(|value| value.is_finite());
        let whole = self.values.rows.iter().copied().filter(is_whole);
        let whole: Vec<&[f64]> = whole.collect();
        let slopes = (0..plan.inputs.len()).map(|input| self.slope(input));
        let result = QuantityResult {
            quantity: quantity.clone(),
            at_medians: known(medians[0]),
            numerical_band: known(certify::band(medians)),
            band: band(self.sampled())?,
            slopes: slopes.collect(),
            indices: indices(&whole, plan.seed.into()).unwrap_or_default(),
        };
        Ok((result, whole.len()))
    }

    /// Implements: STU-043.
    fn slope(&self, input: usize) -> Option<Slope> {
        let [below, above] = [0, 1].map(|side| self.values.quartiles[2 * input + side]);
        let of = &self.sampler.plan().inputs[input];
        let [from, to] = BESIDE_MEDIAN.map(|p| of.distribution.quantile(p));
        let per_unit = (above - below) / (to - from);
        let relative = of.distribution.quantile(0.5) / self.values.medians[0];
        let elasticity = (of.change != Change::Offset).then_some(per_unit * relative);
        per_unit.is_finite().then_some(Slope {
            between_quartiles: above - below,
            per_unit,
            elasticity: elasticity.filter(|elasticity| elasticity.is_finite()),
        })
    }

    /// Implements: STU-043.
    fn conclusion(&self, quantity: &Quantity) -> Result<Option<Conclusion>, Refusal> {
        let (limit, at_least) = match quantity.kind {
            Kind::Gamma => (self.sampler.plan().settings.required_gamma()?, true),
            Kind::ConventionP { .. } => (LEVEL, false),
            _ => return Ok(None),
        };
        let holds = |value: &f64| (*value >= limit) == at_least;
        let sampled = self.sampled();
        let held = sampled.iter().filter(|value| holds(value)).count();
        if sampled.is_empty() {
            return Ok(None);
        }
        let at_medians = Some(self.values.medians[0]).filter(|value| value.is_finite());
        let found = binomial::clopper_pearson(held as u64, sampled.len() as u64, CONFIDENCE)?;
        Ok(Some(Conclusion {
            quantity: quantity.clone(),
            limit,
            at_least,
            at_medians: at_medians.as_ref().map(holds),
            share: held as f64 / sampled.len() as f64,
            lower: found.lower,
            upper: found.upper,
        }))
    }
}
