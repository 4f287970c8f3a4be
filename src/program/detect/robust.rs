//! `palpate detect` with the robust model, which is the default.

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;

use super::arguments::ModelName;
use super::{DetectArguments, TwoMaps, Warnings, asked, tell, trimmed};
use crate::CliError;
use crate::error::refuse;
use crate::output::{note, write};
use serde_json::json;

use palpate::bank::Bank;
use palpate::chart::explanation_figure;
use palpate::detect::Decision;
use palpate::force_map::ForceMap;
use palpate::phantom::Phantom;
use palpate::robust::{
    GelChanges, GelUncertainty, RobustAnswer, RobustPlace, RobustQuestion, RobustSweep,
};
use palpate::rows::Rows;
use palpate::trace::{Correlation, Record, reasons};

/// Refuses options of the other model.
///
/// Implements: CLI-040.
pub fn check_options(arguments: &DetectArguments) -> Result<(), CliError> {
    let (model, files, criterion) = (
        &arguments.model,
        &arguments.hypotheses,
        &arguments.criterion,
    );
    let of_exact = [
        ("--criterion", criterion.criterion.is_some()),
        ("--max-miss", criterion.max_miss.is_some()),
        ("--max-false-alarm", criterion.max_false_alarm.is_some()),
        (
            "--depth-tolerance-mm",
            arguments.sweep.depth_tolerance.is_some(),
        ),
        ("--simulations", files.simulations.is_some()),
    ];
    let of_robust = [
        ("--sure", model.sure.is_some()),
        ("--zeroed", model.zeroed),
        ("--together", model.together),
        ("--reference-sweep", !model.reference_sweeps.is_empty()),
        ("--gel-uncertainty", model.gel_uncertainty.is_some()),
    ];
    let (options, other) = match model.model {
        ModelName::Robust => (&of_exact[..], "exact"),
        ModelName::Exact => (&of_robust[..], "robust"),
    };
    if let Some((option, _)) = options.iter().find(|(_, is_given)| *is_given) {
        refuse!("{option} needs --model {other}");
    }
    if model.model == ModelName::Exact && files.figure.is_some() && files.bank.is_none() {
        refuse!("--figure with --model exact needs --bank");
    }
    if arguments.traces.len() > 1 && !model.together {
        refuse!(
            "{} traces need --together, for sweeps of one place",
            arguments.traces.len()
        );
    }
    Ok(())
}

/// Judges the sweeps of one place.
///
/// Implements: CLI-040, CLI-043, ROB-030, ROB-033, ROB-040.
pub fn detect(arguments: &DetectArguments, records: Vec<Record>) -> Result<(), CliError> {
    let known = arguments.noise.undisturbed()?;
    let noise = arguments.noise.noise()?;
    let longer = match noise.correlation {
        Correlation::Known(length) => length.sqrt(),
        Correlation::None | Correlation::OfRecord => 1.0,
    };
    let default = RobustQuestion::default();
    let question = RobustQuestion {
        known: &known,
        is_zeroed: arguments.model.zeroed,
        noise_sd: noise.sd.map(|sd| sd.map(|sd| sd * longer)),
        is_white: noise.correlation == Correlation::None,
        prior_h1: arguments.criterion.prior_h1,
        sure: arguments.model.sure.unwrap_or(default.sure),
    };
    let mut warnings = Warnings::default();
    let (answer, rows) = match &arguments.hypotheses.bank {
        Some(path) => by_bank(arguments, &question, records, &Bank::read(path)?)?,
        None => by_maps(arguments, &question, records, &mut warnings)?,
    };
    let files = arguments
        .traces
        .iter()
        .chain(&arguments.model.reference_sweeps);
    for (file, replaced) in files
        .zip(&answer.glitches)
        .filter(|(_, replaced)| **replaced > 0)
    {
        note(
            file.display(),
            &format!("samples replaced as glitches: {replaced}"),
        );
    }
    let verdict = (answer.decision, &answer.causes[..]);
    tell(arguments, verdict, &conclusion(&answer), rows, warnings)
}

fn by_maps(
    arguments: &DetectArguments,
    question: &RobustQuestion<'_>,
    records: Vec<Record>,
    warnings: &mut Warnings,
) -> Result<(RobustAnswer, Rows), CliError> {
    let maps = TwoMaps::read(arguments)?;
    let hypotheses = maps.hypotheses(warnings)?;
    let depths = depths(arguments, 0.0)?;
    let sweeps = Sweeps::new(arguments, question, records, &depths, &maps.reference)?;
    let answer = question.judge(hypotheses, &sweeps.get())?;
    draw(arguments, &sweeps.records, &answer, None)?;
    let mut rows = robustly_asked(arguments, question, &depths, &sweeps.records);
    rows.append(answer.rows(None));
    Ok((answer, rows))
}

fn by_bank(
    arguments: &DetectArguments,
    question: &RobustQuestion<'_>,
    records: Vec<Record>,
    bank: &Bank,
) -> Result<(RobustAnswer, Rows), CliError> {
    let depths = depths(arguments, bank.depth())?;
    let mut given = depths.iter().map(|depth| bank.check_depth(*depth));
    given.try_for_each(|checked| checked)?;
    let prior = arguments.hypotheses.prior.as_ref();
    let prior = prior.map(|file| bank.read_prior(file)).transpose()?;
    let sweeps = Sweeps::new(arguments, question, records, &depths, bank.reference())?;
    let (answer, place) = question.locate(bank, prior.as_deref(), &sweeps.get())?;
    let place = Some((bank, &place));
    draw(arguments, &sweeps.records, &answer, place)?;
    let mut rows = robustly_asked(arguments, question, &depths, &sweeps.records);
    rows.append(answer.rows(place));
    Ok((answer, rows))
}

/// What was asked of the robust model.
fn robustly_asked(
    arguments: &DetectArguments,
    question: &RobustQuestion<'_>,
    depths: &[f64],
    records: &[Record],
) -> Rows {
    let mut rows = asked(arguments, depths, records);
    let files = arguments.model.reference_sweeps.iter();
    let files: Vec<_> = files.map(|file| file.display().to_string()).collect();
    rows.value("reference_sweeps", files);
    rows.value("known", json!(question.known));
    rows.value("sure", question.sure);
    rows.value("zeroed", question.is_zeroed);
    rows
}

/// Writes the figure, if one is wanted.
///
/// Implements: CLI-163.
fn draw(
    arguments: &DetectArguments,
    records: &[Record],
    answer: &RobustAnswer,
    place: Option<(&Bank, &RobustPlace)>,
) -> Result<(), CliError> {
    if let Some(path) = &arguments.hypotheses.figure {
        write(path, &explanation_figure(records, answer, place)?)?;
    }
    Ok(())
}

/// The depth of each trace, m.
fn depths(arguments: &DetectArguments, of_bank: f64) -> Result<Vec<f64>, CliError> {
    let sweeps = arguments.traces.len();
    match arguments.sweep.depths[..] {
        [] => Ok(vec![of_bank; sweeps]),
        [depth] => Ok(vec![depth; sweeps]),
        ref depths if depths.len() == sweeps => Ok(depths.to_vec()),
        ref depths => {
            let count = depths.len();
            refuse!("--depth-mm has {count} depths for {sweeps} traces; give one, or one for each")
        }
    }
}

/// The sweeps of the place, and reference sweeps after them, with the gels beside that of the maps.
struct Sweeps {
    records: Vec<Record>,
    depths: Vec<f64>,
    /// The number of those of the place.
    of_place: usize,
    /// By the bits of the depth.
    changes: BTreeMap<u64, Option<GelChanges>>,
}

impl Sweeps {
    fn new(
        arguments: &DetectArguments,
        question: &RobustQuestion<'_>,
        records: Vec<Record>,
        depths: &[f64],
        reference: &ForceMap,
    ) -> Result<Sweeps, CliError> {
        let file = arguments.model.gel_uncertainty.as_ref();
        let uncertainty = file.map(|file| GelUncertainty::read(file)).transpose()?;
        let uncertainty = uncertainty.unwrap_or_default().beside(question.known);
        let trim = |record| trimmed(arguments, record, reference.table());
        let records = records
            .into_iter()
            .map(trim)
            .collect::<Result<Vec<_>, _>>()?;
        let mut changes = BTreeMap::new();
        for &depth in depths {
            if let Entry::Vacant(entry) = changes.entry(depth.to_bits()) {
                let name = reference.phantom().map_or("", Phantom::name);
                let found = GelChanges::new(reference, depth, &uncertainty);
                entry.insert(found.map_err(CliError::fem(name))?);
            }
        }
        let mut depths = depths.to_vec();
        let of_place = depths.len();
        depths.resize(records.len(), depths[0]);
        Ok(Sweeps {
            records,
            depths,
            of_place,
            changes,
        })
    }

    fn get(&self) -> Vec<RobustSweep<'_>> {
        let sweeps = self.records.iter().zip(&self.depths).enumerate();
        let sweep = |(number, (record, &depth))| RobustSweep {
            record,
            depth,
            changes: self.changes[&depth.to_bits()].as_ref(),
            is_reference: number >= self.of_place,
        };
        sweeps.map(sweep).collect()
    }
}

/// What was decided, and what explains the record.
///
/// Implements: CLI-043, ROB-043.
fn conclusion(answer: &RobustAnswer) -> String {
    let classes = answer.classes.len();
    let averaged = format!("averaged over {classes} classes of disturbance");
    match answer.decision {
        Some(Decision::Inclusion) => format!("Inclusion detected, {averaged}."),
        Some(Decision::NoInclusion) => format!("No inclusion detected, {averaged}."),
        None => format!("The record cannot be judged: {}.", reasons(&answer.causes)),
    }
}
