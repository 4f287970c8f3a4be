//! The answer of `palpate detect`, for programs and for people.

use std::fmt::Write;
use std::path::PathBuf;

use serde::Serialize;

use crate::detect::assessment::Assessment;
use crate::detect::{Channels, Decision};
use crate::trace::{Criterion, Location, Misfit};

/// What was asked and what the record says.
///
/// Implements: CLI-045.
#[derive(Debug, Serialize)]
pub struct Answer {
    #[serde(flatten)]
    pub question: Question,
    #[serde(flatten)]
    pub known: Option<AtKnownPosition>,
    #[serde(flatten)]
    pub unknown: Option<AtUnknownPosition>,
    chi_square: f64,
    chi_square_limit: f64,
}

/// What was asked.
#[derive(Debug, Serialize)]
pub struct Question {
    schema: &'static str,
    schema_version: u32,
    program_version: &'static str,
    trace: String,
    reference: String,
    inclusion: String,
    samples: usize,
    depth_m: f64,
    noise_sd_lateral_n: f64,
    noise_sd_normal_n: f64,
    prior_h1: f64,
    criterion: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    max_miss: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    max_false_alarm: Option<f64>,
}

impl Question {
    /// The question about trace, reference and inclusion in `files`; depth in m, noise in N.
    pub fn new(
        files: [&PathBuf; 3],
        samples: usize,
        depth: f64,
        noise_sd: Channels<f64>,
        prior_h1: f64,
        criterion: Criterion,
    ) -> Question {
        let [trace, reference, inclusion] = files.map(|path| path.display().to_string());
        let (criterion, max_miss, max_false_alarm) = match criterion {
            Criterion::Map => ("map", None, None),
            Criterion::NeymanPearsonMiss { max_miss } => {
                ("neyman-pearson-miss", Some(max_miss), None)
            }
            Criterion::NeymanPearsonFalseAlarm { max_false_alarm } => {
                ("neyman-pearson-false-alarm", None, Some(max_false_alarm))
            }
        };
        Question {
            schema: "palpate-detection",
            schema_version: 1,
            program_version: env!("CARGO_PKG_VERSION"),
            trace,
            reference,
            inclusion,
            samples,
            depth_m: depth,
            noise_sd_lateral_n: noise_sd.x,
            noise_sd_normal_n: noise_sd.y,
            prior_h1,
            criterion,
            max_miss,
            max_false_alarm,
        }
    }
}

/// The record judged with the inclusion at x = 0.
#[derive(Debug, Serialize)]
pub struct AtKnownPosition {
    decision: &'static str,
    theta: f64,
    eta: f64,
    gamma: f64,
    posterior_h1: f64,
    false_alarm: f64,
    miss: f64,
    y_lateral_n: f64,
    y_normal_n: f64,
}

impl From<(f64, Assessment)> for AtKnownPosition {
    fn from((eta, found): (f64, Assessment)) -> Self {
        AtKnownPosition {
            decision: name(found.decision),
            theta: found.statistic.theta,
            eta,
            gamma: found.statistic.gamma,
            posterior_h1: found.posterior,
            false_alarm: found.rates.false_alarm,
            miss: found.rates.miss,
            y_lateral_n: found.statistic.y.x,
            y_normal_n: found.statistic.y.y,
        }
    }
}

/// The record searched for the inclusion.
#[derive(Debug, Serialize)]
pub struct AtUnknownPosition {
    decision: &'static str,
    decided_by: &'static str,
    theta_max: f64,
    theta_mixture: f64,
    eta: f64,
    gamma: f64,
    posterior_h1: f64,
    false_alarm_bound: f64,
    miss_bound: f64,
    position_m: f64,
    position_sd_bound_m: f64,
    template_edge: f64,
    candidates: usize,
}

impl From<Location> for AtUnknownPosition {
    fn from(found: Location) -> Self {
        AtUnknownPosition {
            decision: name(found.decision),
            decided_by: if found.by_mixture {
                "theta_mixture"
            } else {
                "theta_max"
            },
            theta_max: found.theta_max,
            theta_mixture: found.theta_mixture,
            eta: found.eta,
            gamma: found.gamma,
            posterior_h1: found.posterior,
            false_alarm_bound: found.false_alarm_bound,
            miss_bound: found.miss_bound,
            position_m: found.position,
            position_sd_bound_m: found.position_sd_bound,
            template_edge: found.template_edge,
            candidates: found.candidates,
        }
    }
}

fn name(decision: Decision) -> &'static str {
    match decision {
        Decision::Inclusion => "inclusion",
        Decision::NoInclusion => "no_inclusion",
    }
}

impl Answer {
    /// The answer to a question, by one of the two tests.
    pub fn new(
        question: Question,
        known: Option<AtKnownPosition>,
        unknown: Option<AtUnknownPosition>,
        misfit: Misfit,
    ) -> Answer {
        Answer {
            question,
            known,
            unknown,
            chi_square: misfit.chi_square,
            chi_square_limit: misfit.limit,
        }
    }

    /// The answer as JSON, in SI.
    pub fn json(&self) -> String {
        // Keys are strings and every number is finite: nothing here can fail.
        serde_json::to_string_pretty(self).unwrap_or_default() + "\n"
    }

    /// The answer for people, lengths in mm.
    pub fn table(&self) -> String {
        let mut text = String::new();
        let mut line = |label: &str, value: String| {
            // Writing to a String cannot fail.
            let _ = writeln!(text, "{label:<34} {value}");
        };
        if let Some(found) = &self.known {
            line("decision", said(found.decision));
            line("theta (log-likelihood ratio)", number(found.theta));
            line("eta (threshold)", number(found.eta));
            line("gamma (signal to noise)", number(found.gamma));
            line("posterior of an inclusion", number(found.posterior_h1));
            line("P(false alarm) at eta", number(found.false_alarm));
            line("P(miss) at eta", number(found.miss));
            line("Y(0) lateral, N", number(found.y_lateral_n));
            line("Y(0) normal, N", number(found.y_normal_n));
        }
        if let Some(found) = &self.unknown {
            line("decision", said(found.decision));
            line("decided by", format!("{} >= eta", found.decided_by));
            line("theta_max", number(found.theta_max));
            line("theta_mixture, any position", number(found.theta_mixture));
            line("eta (threshold)", number(found.eta));
            line("gamma at the maximum", number(found.gamma));
            line("posterior of an inclusion", number(found.posterior_h1));
            line("P(false alarm) at most", number(found.false_alarm_bound));
            line("P(miss) there at most", number(found.miss_bound));
            let millimetres = |metres: f64| format!("{:.3}", metres * 1e3);
            line("position, mm", millimetres(found.position_m));
            line(
                "its sd at least (Cramer-Rao), mm",
                millimetres(found.position_sd_bound_m),
            );
        }
        let limit = number(self.chi_square_limit);
        line(
            "chi-square of the nearer map",
            format!("{}, at most {limit} if it fits", number(self.chi_square)),
        );
        text
    }
}

fn said(decision: &str) -> String {
    decision.replace('_', " ")
}

/// Six digits.
fn number(value: f64) -> String {
    if value != 0.0 && !(1e-4..1e6).contains(&value.abs()) {
        format!("{value:.5e}")
    } else {
        format!("{value:.6}")
    }
}
