//! `palpate detect` with the robust model, which is the default.

use std::path::PathBuf;

use super::arguments::ModelName;
use super::{DetectArguments, Warnings, asked, hypotheses, map, reasons, trimmed};
use crate::CliError;
use crate::error::refuse;
use crate::output::Envelope;
use palpate::bank::Bank;
use palpate::detect::Decision;
use palpate::force_map::{ForceMap, SAME_POSITION};
use palpate::phantom::Phantom;
use palpate::robust::{GelChanges, RobustAnswer, RobustQuestion, RobustSweep};
use palpate::rows::Rows;
use palpate::trace::{Correlation, Record};

/// The posterior from which an answer is sure, unless another is asked for.
const SURE: f64 = 0.95;

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
        ("--figure", files.figure.is_some()),
    ];
    let of_robust = [
        ("--sure", model.sure.is_some()),
        ("--zeroed", model.zeroed),
        ("--together", model.together),
    ];
    let (options, other) = match model.model {
        ModelName::Robust => (&of_exact[..], "exact"),
        ModelName::Exact => (&of_robust[..], "robust"),
    };
    if let Some((option, _)) = options.iter().find(|(_, is_given)| *is_given) {
        refuse!("{option} needs --model {other}");
    }
    let sure = model.sure.unwrap_or(SURE);
    if sure <= 0.5 {
        refuse!("--sure {sure} must be above 0.5");
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
/// Implements: CLI-040, CLI-043, ROB-030, ROB-040.
pub fn detect(arguments: &DetectArguments, records: Vec<Record>) -> Result<(), CliError> {
    let known = arguments.noise.undisturbed()?;
    let noise = arguments.noise.noise()?;
    let longer = match noise.correlation {
        Correlation::Known(length) => length.sqrt(),
        Correlation::None | Correlation::OfRecord => 1.0,
    };
    let question = RobustQuestion {
        known: &known,
        is_tared: arguments.model.zeroed,
        noise_sd: noise.sd.map(|sd| sd.map(|sd| sd * longer)),
        prior_h1: arguments.criterion.prior_h1,
        sure: arguments.model.sure.unwrap_or(SURE),
    };
    let mut warnings = Warnings::default();
    let (answer, mut rows) = match &arguments.hypotheses.bank {
        Some(path) => by_bank(arguments, &question, records, &Bank::read(path)?)?,
        None => by_maps(arguments, &question, records, &mut warnings)?,
    };
    rows.value("warnings", warnings.0);
    let table = format!("{}\n{}\n", rows.table(), conclusion(&answer));
    arguments
        .format
        .print(&Envelope::new("palpate-detection", 4, rows), || table)?;
    if answer.decision.is_none() {
        let (file, why) = (arguments.traces[0].display(), reasons(&answer.causes));
        return Err(CliError::Unjudged(format!(
            "{file}: cannot be judged: {why}"
        )));
    }
    Ok(())
}

fn by_maps(
    arguments: &DetectArguments,
    question: &RobustQuestion<'_>,
    records: Vec<Record>,
    warnings: &mut Warnings,
) -> Result<(RobustAnswer, Rows), CliError> {
    // The parser has refused all but a bank or both maps with a depth.
    let (none, files) = (PathBuf::new(), &arguments.hypotheses);
    let [reference_path, path] =
        [&files.reference, &files.inclusion].map(|path| path.as_ref().unwrap_or(&none));
    let (reference, inclusion) = (map(reference_path)?, map(path)?);
    let tables = hypotheses(files.any_maps, path, &reference, &inclusion, warnings)?;
    let depths = depths(arguments, records.len(), 0.0)?;
    let records = all_trimmed(arguments, records, &reference)?;
    let mut changes: Vec<Option<GelChanges>> = Vec::new();
    for (at, depth) in depths.iter().enumerate() {
        let known = depths[..at].iter().position(|of| of == depth);
        changes.push(match known {
            Some(same) => changes[same].clone(),
            None => gel_changes(&reference, *depth)?,
        });
    }
    let sweeps = records.iter().zip(&depths).zip(&changes);
    let sweeps = sweeps.map(|((record, &depth), changes)| RobustSweep {
        record,
        depth,
        changes: changes.as_ref(),
    });
    let answer = question.judge(tables, &sweeps.collect::<Vec<_>>())?;
    let mut rows = asked(arguments, &depths, &records);
    rows.append(answer.rows(None));
    Ok((answer, rows))
}

fn by_bank(
    arguments: &DetectArguments,
    question: &RobustQuestion<'_>,
    records: Vec<Record>,
    bank: &Bank,
) -> Result<(RobustAnswer, Rows), CliError> {
    let depths = depths(arguments, records.len(), bank.depth())?;
    if let Some(depth) = depths
        .iter()
        .find(|depth| (*depth - bank.depth()).abs() > SAME_POSITION)
    {
        let [depth, of_bank] = [*depth, bank.depth()].map(palpate::decimal::mm);
        refuse!("--depth-mm {depth} is not the bank's; give {of_bank}, or a bank for that depth");
    }
    let records = all_trimmed(arguments, records, bank.reference())?;
    let prior = arguments.hypotheses.prior.as_ref();
    let prior = prior.map(|file| bank.read_prior(file)).transpose()?;
    let changes = gel_changes(bank.reference(), bank.depth())?;
    let all: Vec<&Record> = records.iter().collect();
    let (answer, place) = question.locate(bank, prior.as_deref(), changes.as_ref(), &all)?;
    let mut rows = asked(arguments, &depths, &records);
    rows.append(answer.rows(Some((bank, &place))));
    Ok((answer, rows))
}

/// The depth of each sweep, m.
fn depths(arguments: &DetectArguments, sweeps: usize, of_bank: f64) -> Result<Vec<f64>, CliError> {
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

fn all_trimmed(
    arguments: &DetectArguments,
    records: Vec<Record>,
    map: &ForceMap,
) -> Result<Vec<Record>, CliError> {
    let trim = |record| trimmed(arguments, record, map.table());
    records.into_iter().map(trim).collect()
}

fn gel_changes(map: &ForceMap, depth: f64) -> Result<Option<GelChanges>, CliError> {
    let name = map.phantom().map_or("", Phantom::name);
    GelChanges::new(map, depth).map_err(CliError::fem(name))
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
