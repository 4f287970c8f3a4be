//! The answer of `palpate detect`, for programs and for people.

use serde::Serializer as _;
use serde_json::Value;

use crate::detect::Decision;
use crate::trace::{Judgement, Location, Misfit};

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

impl DetectAnswer {
    /// What programs alone are told.
    pub fn tell(&mut self, key: &'static str, value: impl Into<Value>) {
        self.entries.push((key, value.into()));
    }

    fn line(&mut self, label: &str, text: &str) {
        self.table += &format!("{label:<34} {text}\n");
    }

    fn number(&mut self, key: &'static str, label: &str, value: f64) {
        self.tell(key, value);
        self.line(label, &number(value));
    }

    fn length(&mut self, key: &'static str, label: &str, metres: f64) {
        self.tell(key, metres);
        self.line(label, &format!("{:.3}", metres * 1e3));
    }

    fn decision(&mut self, decision: Decision) {
        let (key, text) = match decision {
            Decision::Inclusion => ("inclusion", "inclusion"),
            Decision::NoInclusion => ("no_inclusion", "no inclusion"),
        };
        self.tell("decision", key);
        self.line("decision", text);
    }

    /// The record judged with the inclusion at x = 0.
    pub fn judged(&mut self, found: &Judgement) {
        let (eta, found) = (found.eta, &found.assessment);
        let (statistic, rates) = (found.statistic, found.rates);
        self.decision(found.decision);
        self.number("theta", "theta (log-likelihood ratio)", statistic.theta);
        self.number("eta", "eta (threshold)", eta);
        self.number("gamma", "gamma (signal to noise)", statistic.gamma);
        self.number("posterior_h1", "posterior of an inclusion", found.posterior);
        self.number("false_alarm", "P(false alarm) at eta", rates.false_alarm);
        self.number("miss", "P(miss) at eta", rates.miss);
        self.number("y_lateral_n", "Y(0) lateral, N", statistic.y.lateral);
        self.number("y_normal_n", "Y(0) normal, N", statistic.y.normal);
    }

    /// The record searched for the inclusion.
    pub fn located(&mut self, found: &Location) {
        let mixture = found.theta_mixture;
        let decided_by = match found.by_mixture {
            true => "theta_mixture",
            false => "theta_max",
        };
        let (false_alarm, miss) = (found.false_alarm_bound, found.miss_bound);
        let sd_label = "its sd at least (Cramer-Rao), mm";
        self.decision(found.decision);
        self.tell("decided_by", decided_by);
        self.line("decided by", &format!("{decided_by} >= eta"));
        self.number("theta_max", "theta_max", found.theta_max);
        self.number("theta_mixture", "theta_mixture, any position", mixture);
        self.number("eta", "eta (threshold)", found.eta);
        self.number("gamma", "gamma at the maximum", found.gamma);
        self.number("posterior_h1", "posterior of an inclusion", found.posterior);
        self.number("false_alarm_bound", "P(false alarm) at most", false_alarm);
        self.number("miss_bound", "P(miss) there at most", miss);
        self.length("position_m", "position, mm", found.position);
        self.length("position_sd_bound_m", sd_label, found.position_sd_bound);
        self.tell("template_edge", found.template_edge);
        self.tell("candidates", found.candidates);
    }

    /// How well the nearer map fits the record.
    pub fn misfit(&mut self, misfit: &Misfit) {
        self.tell("chi_square", misfit.chi_square);
        self.tell("chi_square_limit", misfit.limit);
        let [chi_square, limit] = [misfit.chi_square, misfit.limit].map(number);
        let text = format!("{chi_square}, at most {limit} if it fits");
        self.line("chi-square of the nearer map", &text);
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
fn number(value: f64) -> String {
    if value != 0.0 && !(1e-4..1e6).contains(&value.abs()) {
        format!("{value:.5e}")
    } else {
        format!("{value:.6}")
    }
}
