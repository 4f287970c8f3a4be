//! The records that the robust model judges: what is asked of each, and its detector.

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::path::{Path, PathBuf};

use serde_json::json;

use super::{DetectArguments, Warnings, asked, check_depths, trimmed};
use crate::CliError;
use crate::error::refuse;
use crate::output::note;
use palpate::bank::Bank;
use palpate::csv::Layout;
use palpate::force_map::{ForceMap, Hypotheses};
use palpate::phantom::Phantom;
use palpate::refusal::Refusal;
use palpate::robust::{
    BankHypotheses, GelChanges, GelUncertainty, RobustAnswer, RobustDetector, RobustPlace,
    RobustQuestion, RobustSweep,
};
use palpate::rows::Rows;
use palpate::trace::Record;

/// The forces to compare records with.
pub enum Between<'a> {
    /// Those of two maps, the first of which is also here.
    Maps(Hypotheses<'a>, &'a ForceMap),
    /// Those of a bank, and the prior of each of its maps.
    Bank(&'a Bank, Option<&'a [f64]>),
}

impl Between<'_> {
    /// The depth of a sweep for which none is given, m: the parser asks for one beside maps.
    pub fn depth(&self) -> f64 {
        match self {
            Between::Maps(..) => 0.0,
            Between::Bank(bank, _) => bank.depth(),
        }
    }
}

/// What is asked of each record.
pub struct Asked<'a> {
    pub arguments: &'a DetectArguments,
    pub layout: &'a Layout,
    pub question: RobustQuestion<'a>,
    pub between: Between<'a>,
    pub warnings: Warnings,
    /// Of each sweep of a place, m.
    pub depths: Vec<f64>,
    pub references: Vec<Record>,
    /// The gels beside that of the maps, by the bits of the depths at which they are computed.
    pub changes: BTreeMap<Vec<u64>, Option<GelChanges>>,
}

impl<'a> Asked<'a> {
    /// The passes of all records of these traces, which are different records, and whose notes are printed.
    ///
    /// Implements: CLI-239.
    pub fn read_all(&self, traces: &[PathBuf]) -> Result<Vec<Record>, CliError> {
        let passes = traces.iter().map(|path| {
            let (passes, notes) = self.read(path)?;
            notes.iter().for_each(|text| note(passes[0].file(), text));
            Ok(passes)
        });
        let passes = passes.collect::<Result<Vec<_>, CliError>>()?;
        for (at, record) in passes.iter().enumerate() {
            for before in &passes[..at] {
                check_other(&before[0], &record[0])?;
            }
        }
        Ok(passes.into_iter().flatten().collect())
    }

    /// The same with the reference sweeps, and the gels beside that of the maps under the records that are judged `together`.
    ///
    /// Implements: ROB-080.
    pub fn with_gels<'r>(
        mut self,
        together: impl Iterator<Item = &'r [Record]>,
    ) -> Result<Asked<'a>, CliError> {
        let model = &self.arguments.model;
        self.references = self.read_all(&model.reference_sweeps)?;
        let file = model.gel_uncertainty.as_ref();
        let uncertainty = file.map(|file| GelUncertainty::read(file)).transpose()?;
        let uncertainty = uncertainty.unwrap_or_default().beside(self.question.known);
        let reference = self.reference();
        if file.is_some() && reference.phantom().is_none() {
            refuse!("--gel-uncertainty needs maps that state their phantom; leave it out");
        }
        let name = reference.phantom().map_or("", Phantom::name);
        for records in together {
            for depths in self.depths_of_gels(records)? {
                if let Entry::Vacant(entry) = self.changes.entry(bits(&depths)) {
                    let found = GelChanges::new(reference, &depths, &uncertainty);
                    entry.insert(found.map_err(CliError::fem(name))?);
                }
            }
        }
        Ok(self)
    }

    /// The lists of depths at which the gels are needed for records that are judged together, m.
    fn depths_of_gels(&self, records: &[Record]) -> Result<Vec<Vec<f64>>, Refusal> {
        let mut all = records.iter().chain(&self.references);
        let mut lists = Vec::new();
        if all.any(|record| record.depths().is_none()) {
            for &depth in &self.depths {
                self.bank().map_or(Ok(()), |bank| bank.check_depth(depth))?;
                lists.push(vec![depth]);
            }
        }
        lists.extend(self.depths_along(records));
        Ok(lists)
    }

    /// The depths under those of the records, judged together, whose samples have depths of their own, m; none if there is none.
    fn depths_along(&self, records: &[Record]) -> Option<Vec<f64>> {
        let all = records.iter().chain(&self.references);
        let own: Vec<_> = all.filter(|record| record.depths().is_some()).collect();
        (!own.is_empty()).then(|| GelChanges::depths_along(self.reference(), &own))
    }

    /// The map without an inclusion.
    fn reference(&self) -> &'a ForceMap {
        match self.between {
            Between::Maps(_, reference) => reference,
            Between::Bank(bank, _) => bank.reference(),
        }
    }

    /// The bank, if there is one.
    pub fn bank(&self) -> Option<&'a Bank> {
        match self.between {
            Between::Maps(..) => None,
            Between::Bank(bank, _) => Some(bank),
        }
    }

    /// Reads the passes of a record, without what is outside the maps if --trim is given.
    ///
    /// Implements: ROB-083.
    pub fn read(&self, path: &Path) -> Result<(Vec<Record>, Vec<String>), CliError> {
        let record = super::read(self.arguments, self.layout, path)?;
        check_depths(self.arguments, &record, self.bank())?;
        let (have_lateral, table) = match self.between {
            Between::Maps(hypotheses, map) => (hypotheses.have_lateral(), map.table()),
            Between::Bank(bank, _) => (true, bank.base()),
        };
        let (record, mut notes) = trimmed(self.arguments, record, table, have_lateral)?;
        let (passes, left_out) = self.question.passes(&record, self.reference());
        if left_out > 0 {
            let count = record.positions().len();
            notes.push(format!(
                "{left_out} of {count} samples left out: their passes are too short"
            ));
        }
        Ok((passes, notes))
    }

    /// The sweeps of a place, and behind them the reference sweeps, at the first depth.
    pub fn sweeps<'r>(&'r self, records: &'r [Record]) -> Vec<RobustSweep<'r>> {
        let all = records.iter().chain(&self.references).enumerate();
        let along = self.depths_along(records).unwrap_or_default();
        let sweep = |(number, record)| {
            let depth = *self.depths.get(number).unwrap_or(&self.depths[0]);
            RobustSweep {
                record,
                depth,
                changes: match record.depths() {
                    Some(_) => self.changes(&along),
                    None => self.changes(&[depth]),
                },
                is_reference: number >= records.len(),
            }
        };
        all.map(sweep).collect()
    }

    /// The gels beside that of the maps that are computed at these depths, m.
    fn changes(&self, depths: &[f64]) -> Option<&GelChanges> {
        self.changes.get(&bits(depths))?.as_ref()
    }

    /// The detector for records over the positions of these sweeps.
    pub fn detector(&self, sweeps: &[RobustSweep<'_>]) -> Result<Detector<'_>, Refusal> {
        Ok(match &self.between {
            Between::Maps(hypotheses, _) => {
                Detector(self.question.detector(*hypotheses, sweeps)?, None)
            }
            Between::Bank(bank, prior) => {
                let (detector, of) = self.question.bank_detector(bank, *prior, sweeps)?;
                Detector(detector, Some(of))
            }
        })
    }

    /// What was asked of the records of these traces, and the `answer`.
    pub fn rows(&self, traces: &[PathBuf], records: &[Record], answer: Rows) -> Rows {
        let mut rows = asked(self.arguments, traces, &self.depths, records);
        let files = self.arguments.model.reference_sweeps.iter();
        let files: Vec<_> = files.map(|file| file.display().to_string()).collect();
        rows.value("reference_sweeps", files);
        rows.value("known", json!(self.question.known));
        rows.value("sure", self.question.sure);
        rows.value("zeroed", self.question.is_zeroed);
        rows.append(answer);
        rows.value("warnings", self.warnings.0.clone());
        rows
    }
}

/// Refuses a record whose samples are those of another one: it would count as two.
///
/// Implements: CLI-239.
fn check_other(a: &Record, b: &Record) -> Result<(), Refusal> {
    let is_same =
        a.positions() == b.positions() && a.depths() == b.depths() && a.forces() == b.forces();
    let found = format!("the same samples as {}", a.file());
    let refusal = Refusal::state(found, "name each record once");
    refusal.in_file(b.file()).when(is_same)
}

/// Depths as a key.
fn bits(depths: &[f64]) -> Vec<u64> {
    depths.iter().map(|depth| depth.to_bits()).collect()
}

/// The detector, and of a bank what tells the place.
pub struct Detector<'a>(RobustDetector<'a>, Option<BankHypotheses<'a>>);

impl Detector<'_> {
    /// What these sweeps say, and by a bank where the inclusion lies.
    pub fn judge(
        &self,
        sweeps: &[RobustSweep<'_>],
    ) -> Result<(RobustAnswer, Option<RobustPlace>), Refusal> {
        let Detector(detector, bank) = self;
        for reference in sweeps.iter().filter(|sweep| sweep.is_reference) {
            for sweep in sweeps.iter().filter(|sweep| !sweep.is_reference) {
                check_other(sweep.record, reference.record)?;
            }
        }
        let forces: Vec<_> = sweeps.iter().map(|sweep| sweep.record.forces()).collect();
        let answer = detector.judge(&forces).map_err(|refusal| {
            let mut files: Vec<_> = sweeps.iter().map(|sweep| sweep.record.file()).collect();
            files.dedup();
            refusal.in_file(files.join(", "))
        })?;
        let place = bank.as_ref().map(|bank| bank.place(&answer));
        Ok((answer, place))
    }
}

/// Implements: ROB-002.
pub fn tell_glitches(file: &str, replaced: usize) {
    if replaced > 0 {
        let text = format!("samples replaced as glitches: {replaced}");
        note(file, &text);
    }
}
