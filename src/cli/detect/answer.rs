//! The answer of `palpate detect`, for programs and for people.

use serde::Serializer as _;
use serde_json::{Value, json};

use crate::bank::{Bank, Location, Parameter};
use crate::cli::CliError;
use crate::detect::Decision;
use crate::detect::nuisance::{SubspaceTest, Threshold};
use crate::force_map::SAME_POSITION;
use crate::refusal::Refusal;
use crate::stats::binomial::ConfidenceInterval;
use crate::trace::{Cause, Fit, Judgement};

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

    fn decision(&mut self, decision: Option<Decision>, causes: &[Cause]) {
        let (key, text) = match decision {
            Some(Decision::Inclusion) => ("inclusion", "inclusion"),
            Some(Decision::NoInclusion) => ("no_inclusion", "no inclusion"),
            None => ("cannot_be_judged", "cannot be judged"),
        };
        self.tell("decision", key);
        self.line("decision", text);
        self.tell(
            "causes",
            causes.iter().map(|cause| cause.code()).collect::<Vec<_>>(),
        );
    }

    /// The record judged with the inclusion at x = 0.
    pub fn judged(&mut self, found: &Judgement) {
        let (test, rates) = (&found.test, found.rates);
        self.decision(found.decision, &found.causes);
        self.number("t", "T (signal over noise)", test.t);
        let (least, text) = match found.threshold {
            Threshold::Always => (None, "any T is enough".into()),
            Threshold::At(threshold) => (Some(threshold), number(threshold)),
            Threshold::Never => (None, "no T is enough".into()),
        };
        self.tell("t_threshold", least);
        self.line("T of an inclusion, at least", &text);
        self.number("theta", "theta (log-likelihood ratio)", test.theta());
        self.test(test, found.gamma_nominal);
        self.posterior(found.decision.map(|_| found.posterior));
        self.number("false_alarm", "P(false alarm) at most", rates.false_alarm);
        self.number("miss", "P(miss) at most", rates.miss);
        self.fit(&found.fit);
    }

    /// The record searched for any inclusion of `bank`.
    ///
    /// Implements: CLI-150, CLI-153.
    pub fn located(&mut self, bank: &Bank, found: &Location) -> Result<(), CliError> {
        let decided_by = match found.by_mixture {
            true => "theta_mixture",
            false => "theta_max",
        };
        self.decision(found.decision, &found.causes);
        self.tell("decided_by", decided_by);
        self.line("decided by", &format!("{decided_by} >= eta"));
        self.number(
            "theta_max",
            "theta_max, the likeliest inclusion",
            found.theta_max,
        );
        self.number(
            "theta_mixture",
            "theta_mixture, any inclusion",
            found.theta_mixture,
        );
        self.number("eta", "eta (threshold)", found.eta);
        if let Some(calibrated) = found.calibrated {
            let ConfidenceInterval { lower, upper } = calibrated.false_alarm;
            let text = format!("{} to {}", number(lower), number(upper));
            self.tell("calibrated_false_alarm", vec![lower, upper]);
            self.tell("simulations", calibrated.simulations);
            self.line("P(false alarm), simulated, 99 %", &text);
        }
        self.test(&found.test, found.gamma_nominal);
        self.posterior(found.decision.map(|_| found.posterior));
        self.number(
            "false_alarm_bound",
            "P(false alarm) at most",
            found.false_alarm_bound,
        );
        self.number("miss_bound", "P(miss) there at most", found.miss_bound);
        self.tell("hypotheses", bank.maps().len());
        self.place(bank, found)?;
        self.fit(&found.fit);
        Ok(())
    }

    /// Each parameter that the bank varies.
    ///
    /// Implements: CLI-153.
    fn place(&mut self, bank: &Bank, found: &Location) -> Result<(), CliError> {
        let mean = found.place.mean();
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
            let ends = [interval.low, interval.high];
            self.tell(key, json!({"estimate": estimate, "mean": mean[axis], "interval": ends, "sd_bound": sd, "unit": parameter.unit()}));
            let shown = |x: f64| format!("{:.3}", scale * x);
            let [low, high] = ends.map(shown);
            let sd = sd.map_or("not known".into(), |sd| format!("at least {}", shown(sd)));
            let text = format!("{}, {low} to {high} with 95 %, sd {sd}", shown(estimate));
            self.line(name, &text);
            if [first, last]
                .iter()
                .any(|end| (end - estimate).abs() <= SAME_POSITION)
            {
                self.line("", "(at an end of the bank: it may lie beyond)");
            }
        }
        Ok(())
    }

    /// What was found at the place where it was found.
    fn test(&mut self, test: &SubspaceTest, gamma_nominal: f64) {
        self.number("gamma", "gamma (signal to noise)", test.gamma);
        self.number(
            "gamma_nominal",
            "gamma if nothing were unknown",
            gamma_nominal,
        );
        self.number(
            "amplitude",
            "signal found over expected",
            test.t / test.gamma,
        );
        self.number("amplitude_sd", "its standard deviation", 1.0 / test.gamma);
    }

    fn posterior(&mut self, posterior: Option<f64>) {
        self.tell("posterior_h1", posterior);
        if let Some(posterior) = posterior {
            self.line("posterior of an inclusion", &number(posterior));
        }
    }

    /// How well the record fits.
    fn fit(&mut self, fit: &Fit) {
        let sd = fit.noise_sd;
        self.tell("fits", fit.noise_is_right());
        self.number(
            "noise_sd_lateral_n",
            "noise of a sample, lateral, N",
            sd.lateral,
        );
        self.number(
            "noise_sd_normal_n",
            "noise of a sample, normal, N",
            sd.normal,
        );
        self.tell("chi_square", fit.chi_square);
        self.tell("chi_square_limits", fit.limits.map(Vec::from));
        if let Some([low, high]) = fit.limits {
            let [chi_square, low, high] = [fit.chi_square, low, high].map(number);
            let text = format!("{chi_square}, {low} to {high} if it fits");
            self.line("chi-square of what is left", &text);
        }
        self.tell("degrees", fit.degrees);
        self.tell("whiteness", fit.whiteness);
        self.tell("block", fit.block);
        let samples = format!("{:.0}", fit.effective_samples);
        self.tell("effective_samples", fit.effective_samples);
        self.line("independent samples, both channels", &samples);
        self.tell("level", fit.level);
        if let Some(level) = fit.level {
            self.line("forces over the reference's", &number(level));
        }
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
