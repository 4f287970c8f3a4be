//! `palpate detect` with the robust model, which is the default.

use std::collections::BTreeMap;
use std::path::PathBuf;

use super::arguments::ModelName;
use super::records::{Asked, Between, tell_glitches};
use super::{DetectArguments, TwoMaps, Warnings, many, tell};
use crate::error::refuse;
use crate::numbers::for_each;
use crate::output::write;
use crate::{CliError, Format};
use palpate::bank::Bank;
use palpate::chart::explanation_figure;
use palpate::csv::Layout;
use palpate::detect::Decision;
use palpate::robust::{Part, RobustAnswer, RobustQuestion};
use palpate::trace::{Correlation, reasons};

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
    let is_one = arguments.traces.len() == 1 && !arguments.traces[0].is_dir();
    if !is_one && model.model == ModelName::Exact {
        refuse!("--model exact judges one trace; give one file");
    }
    let is_csv = arguments.format == Format::Csv;
    if is_csv && (model.together || model.model == ModelName::Exact) {
        refuse!("--format csv is a table of records, without --together or --model exact");
    }
    Ok(())
}

/// Judges sweeps of one place, or each of many records.
///
/// Implements: CLI-040, CLI-043, ROB-030, ROB-033, ROB-040.
pub fn detect(arguments: &DetectArguments, layout: &Layout) -> Result<(), CliError> {
    let known = arguments.noise.undisturbed()?;
    let question = question(arguments, layout, &known)?;
    let mut warnings = Warnings::default();
    let (maps, bank, prior);
    let between = match &arguments.hypotheses.bank {
        Some(path) => {
            bank = Bank::read(path)?;
            let file = arguments.hypotheses.prior.as_ref();
            prior = file.map(|file| bank.read_prior(file)).transpose()?;
            Between::Bank(&bank, prior.as_deref())
        }
        None => {
            maps = TwoMaps::read(arguments)?;
            Between::Maps(maps.hypotheses(&mut warnings)?, &maps.reference)
        }
    };
    let traces = many::traces(&arguments.traces)?;
    let is_csv = arguments.format == Format::Csv;
    let is_alone = traces == arguments.traces && traces.len() == 1 && !is_csv;
    let is_one = arguments.model.together || is_alone;
    if !is_one && arguments.hypotheses.figure.is_some() {
        refuse!("--figure draws one place; give one trace, or --together");
    }
    let sweeps = if is_one { traces.len() } else { 1 };
    let asked = Asked {
        arguments,
        layout,
        depths: depths(arguments, between.depth(), sweeps)?,
        question,
        between,
        warnings,
        references: Vec::new(),
        changes: BTreeMap::new(),
    };
    if is_one {
        one(asked, &traces)
    } else {
        many::detect(asked, &traces)
    }
}

/// Judges sweeps of one place.
fn one(asked: Asked<'_>, traces: &[PathBuf]) -> Result<(), CliError> {
    let arguments = asked.arguments;
    let records = asked.read_all(traces)?;
    let asked = asked.with_gels([&records[..]].into_iter())?;
    let sweeps = asked.sweeps(&records);
    let (answer, place) = asked.detector(&sweeps)?.judge(&sweeps)?;
    for (sweep, replaced) in sweeps.iter().zip(&answer.glitches) {
        tell_glitches(sweep.record.file(), *replaced);
    }
    let place = asked.bank().zip(place.as_ref());
    if let Some(path) = &arguments.hypotheses.figure {
        let all: Vec<_> = sweeps.iter().map(|sweep| sweep.record.clone()).collect();
        write(path, &explanation_figure(&all, &answer, place)?)?;
    }
    let rows = asked.rows(traces, &records, answer.rows(place));
    let verdict = (answer.decision, &answer.causes[..]);
    tell(arguments, verdict, &conclusion(&answer), rows)
}

/// What is known of each record.
fn question<'a>(
    arguments: &DetectArguments,
    layout: &Layout,
    known: &'a [Part],
) -> Result<RobustQuestion<'a>, CliError> {
    let noise = arguments.noise.noise(layout)?;
    let default = RobustQuestion::default();
    Ok(RobustQuestion {
        known,
        is_zeroed: arguments.model.zeroed,
        noise_sd: noise.sd,
        correlation_length: match noise.correlation {
            Correlation::Known(length) => length,
            Correlation::None | Correlation::OfRecord => 1.0,
        },
        is_white: noise.correlation == Correlation::None,
        prior_h1: arguments.criterion.prior_h1,
        sure: arguments.model.sure.unwrap_or(default.sure),
    })
}

/// The depth of each of so many sweeps, m.
fn depths(arguments: &DetectArguments, of_bank: f64, sweeps: usize) -> Result<Vec<f64>, CliError> {
    let depths = match &arguments.sweep.depths[..] {
        [] => &[of_bank],
        depths => depths,
    };
    let Some(each) = for_each(depths, sweeps) else {
        let (of, other) = match sweeps {
            1 => ("sweep", "--together for several sweeps of a place"),
            _ => ("sweeps", "one for each"),
        };
        let count = depths.len();
        refuse!("--depth-mm has {count} depths for {sweeps} {of} of a place; give one, or {other}")
    };
    Ok(each)
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
