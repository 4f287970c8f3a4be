//! The answer of `palpate detect`, for programs and for people.

use std::borrow::Borrow;

use askama::Template;
use serde::Serializer as _;
use serde_json::{Value, json};

use crate::CliError;
use palpate::bank::{Bank, Location, Parameter};
use palpate::detect::Decision;
use palpate::detect::nuisance::{SubspaceTest, Threshold};
use palpate::force_map::SAME_POSITION;
use palpate::refusal::Refusal;
use palpate::trace::{Cause, Fit, Judgement};

/// The probability of the intervals of an inclusion's parameters.
const CREDIBLE: f64 = 0.95;

/// What was asked and what the record says, in the order in which it is printed.
///
/// Implements: CLI-045.
#[derive(Debug, Default)]
pub struct DetectAnswer {
    /// For programs, in SI.
    entries: Vec<(&'static str, Value)>,
    /// For people, lengths in mm.
    pub table: String,
}

/// What people are told of a record judged with the inclusion at x = 0.
#[derive(Template)]
#[template(path = "cli.txt", block = "detect_maps")]
struct Judged<'a> {
    found: &'a Judgement,
}

/// What they are told of one searched for any inclusion of a bank.
#[derive(Template)]
#[template(path = "cli.txt", block = "detect_bank")]
struct Located<'a> {
    found: &'a Location,
    decided_by: &'a str,
    place: String,
}

impl DetectAnswer {
    /// What programs are told.
    pub fn tell(&mut self, key: &'static str, value: impl Into<Value>) {
        self.entries.push((key, value.into()));
    }

    fn decision(&mut self, decision: Option<Decision>, causes: &[Cause]) {
        let key = match decision {
            Some(Decision::Inclusion) => "inclusion",
            Some(Decision::NoInclusion) => "no_inclusion",
            None => "cannot_be_judged",
        };
        self.tell("decision", key);
        self.tell("causes", json!(causes));
    }

    /// The record judged with the inclusion at x = 0.
    pub fn judged(&mut self, found: &Judgement) {
        self.decision(found.decision, &found.causes);
        self.tell("t", found.test.t);
        let least = match found.threshold {
            Threshold::At(threshold) => Some(threshold),
            Threshold::Always | Threshold::Never => None,
        };
        self.tell("t_threshold", least);
        self.tell("theta", found.test.theta());
        self.test(&found.test, found.gamma_nominal);
        self.tell("posterior_h1", found.decision.map(|_| found.posterior));
        self.tell("false_alarm", found.rates.false_alarm);
        self.tell("miss", found.rates.miss);
        self.fit(&found.fit);
        // Writing to a String does not fail.
        self.table = Judged { found }.render().unwrap_or_default();
    }

    /// The record searched for any inclusion of `bank`.
    ///
    /// Implements: CLI-140, CLI-153.
    pub fn located(&mut self, bank: &Bank, found: &Location) -> Result<(), CliError> {
        let decided_by = match found.by_mixture {
            true => "theta_mixture",
            false => "theta_max",
        };
        self.decision(found.decision, &found.causes);
        self.tell("decided_by", decided_by);
        self.tell("theta_max", found.theta_max);
        self.tell("theta_mixture", found.theta_mixture);
        self.tell("eta", found.eta);
        if let Some(calibrated) = found.calibrated {
            let rate = calibrated.false_alarm;
            self.tell("calibrated_false_alarm", vec![rate.lower, rate.upper]);
            self.tell("simulations", calibrated.simulations);
        }
        self.test(&found.test, found.gamma_nominal);
        self.tell("posterior_h1", found.decision.map(|_| found.posterior));
        self.tell("false_alarm_bound", found.false_alarm_bound);
        self.tell("miss_bound", found.miss_bound);
        self.tell("hypotheses", bank.maps().len());
        let place = self.place(bank, found)?;
        self.fit(&found.fit);
        let table = Located {
            found,
            decided_by,
            place,
        };
        self.table = table.render().unwrap_or_default();
        Ok(())
    }

    /// Each parameter that the bank varies: what people are told of it.
    ///
    /// Implements: CLI-153.
    fn place(&mut self, bank: &Bank, found: &Location) -> Result<String, CliError> {
        let mean = found.place.mean();
        let mut lines = String::new();
        let mut line = |label: &str, text: &str| lines += &format!("{label:<34} {text}\n");
        for (axis, parameter) in (0..).zip(Parameter::ALL) {
            let points = &bank.axes()[axis];
            let (&[first, .., last], sd) = (&points[..], found.bound.sd[axis]) else {
                continue;
            };
            let interval = found.place.interval(axis, CREDIBLE);
            let interval = interval.map_err(Refusal::from)?;
            let (key, scale, name) = match parameter {
                Parameter::Position => ("position", 1e3, "position, mm"),
                Parameter::Depth => ("inclusion_depth", 1e3, "depth of the inclusion, mm"),
                Parameter::Diameter => ("diameter", 1e3, "diameter, mm"),
                Parameter::Modulus => ("youngs_modulus", 1e-3, "Young's modulus, kPa"),
            };
            let estimate = found.place.estimate[axis];
            let ends = [interval.lower, interval.upper];
            self.tell(key, json!({"estimate": estimate, "mean": mean[axis], "interval": ends, "sd_bound": sd, "unit": parameter.unit()}));
            let shown = |x: f64| format!("{:.3}", scale * x);
            let [low, high] = ends.map(shown);
            let sd = sd.map_or("not known".into(), |sd| format!("at least {}", shown(sd)));
            let text = format!("{}, {low} to {high} with 95 %, sd {sd}", shown(estimate));
            line(name, &text);
            let is_end = |end: &f64| (end - estimate).abs() <= SAME_POSITION;
            if [first, last].iter().any(is_end) {
                line("", "(at an end of the bank: it may lie beyond)");
            }
        }
        Ok(lines)
    }

    /// What was found at the place where it was found.
    fn test(&mut self, test: &SubspaceTest, gamma_nominal: f64) {
        self.tell("gamma", test.gamma);
        self.tell("gamma_nominal", gamma_nominal);
        self.tell("amplitude", test.t / test.gamma);
        self.tell("amplitude_sd", 1.0 / test.gamma);
    }

    /// How well the record fits.
    fn fit(&mut self, fit: &Fit) {
        self.tell("fits", fit.noise_is_right());
        self.tell("noise_sd_lateral_n", fit.noise_sd.lateral);
        self.tell("noise_sd_normal_n", fit.noise_sd.normal);
        self.tell("chi_square", fit.chi_square);
        self.tell("chi_square_limits", fit.limits.map(Vec::from));
        self.tell("degrees", fit.degrees);
        self.tell("whiteness", fit.whiteness);
        self.tell("block", fit.block);
        self.tell("effective_samples", fit.effective_samples);
        self.tell("level", fit.level);
    }

    /// The answer as JSON.
    pub fn json(&self) -> String {
        let mut text = Vec::new();
        let entries = self.entries.iter().map(|(key, value)| (key, value));
        // Keys are strings and a vector takes all that is written: nothing here can fail.
        let _ = serde_json::Serializer::pretty(&mut text).collect_map(entries);
        String::from_utf8_lossy(&text).into_owned() + "\n"
    }
}

/// Six digits.
fn number(value: impl Borrow<f64>) -> String {
    let value = *value.borrow();
    if value != 0.0 && !(1e-4..1e6).contains(&value.abs()) {
        format!("{value:.5e}")
    } else {
        format!("{value:.6}")
    }
}
