//! The answer to a record, quantity by quantity: one list for programs (JSON, Python) and for people (a table).

use serde::{Serialize, Serializer};
use serde_json::{Value, json};

use crate::bank::{Bank, Location, Parameter};
use crate::detect::Decision;
use crate::detect::nuisance::{SubspaceTest, Threshold};
use crate::force::Force;
use crate::refusal::Refusal;
use crate::robust::{Class, PlaceInterval, RobustAnswer, RobustPlace};
use crate::trace::{Cause, Fit, Judgement};

/// The probability of the interval of each parameter of an inclusion.
pub const CREDIBLE: f64 = 0.95;

/// One quantity.
#[derive(Debug, Clone, PartialEq)]
struct Row {
    key: &'static str,
    /// For programs, in SI units.
    value: Value,
    /// For people: label and text, lengths in mm. None if people need no line for it.
    line: Option<[String; 2]>,
}

/// Whether a record was compared with both hypotheses, so that it has a posterior.
///
/// Implements: CLI-143.
fn is_compared(decision: Option<Decision>, causes: &[Cause]) -> bool {
    decision.is_some() || matches!(causes, [Cause::TooWeak | Cause::Zeroed])
}

/// Quantities in the order in which they are printed. Serialised, they are an object.
///
/// ```
/// use palpate::rows::Rows;
///
/// let mut rows = Rows::default();
/// rows.value("samples", 401);
/// rows.number("gamma", "gamma (signal-to-noise ratio)", 20.5);
/// assert_eq!(serde_json::to_string(&rows).unwrap(), r#"{"samples":401,"gamma":20.5}"#);
/// assert_eq!(rows.table(), "gamma (signal-to-noise ratio)      20.500000\n");
/// ```
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Rows(Vec<Row>);

impl Serialize for Rows {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.0.iter().map(|row| (row.key, &row.value)))
    }
}

/// Adds numbers, a line each: key, label and number.
macro_rules! numbers {
    ($rows:expr; $($key:ident: $label:literal, $number:expr;)*) => {
        $($rows.number(stringify!($key), $label, $number);)*
    };
}

impl Rows {
    /// Adds a quantity for programs alone.
    pub fn value(&mut self, key: &'static str, value: impl Into<Value>) {
        let (value, line) = (value.into(), None);
        self.0.push(Row { key, value, line });
    }

    /// Adds a number, of which people see six digits; a missing one is null, and has no line.
    pub fn number(&mut self, key: &'static str, label: &str, number: impl Into<Option<f64>>) {
        let number = number.into();
        let line = number.map(|number| [label.into(), digits(number)]);
        let value = number.into();
        self.0.push(Row { key, value, line });
    }

    /// Adds a number of each of several sweeps, or the number of one; a missing one is null, and so are those of sweeps that were not
    /// compared.
    pub fn list(&mut self, key: &'static str, label: &str, numbers: &[Option<f64>]) {
        match numbers {
            [] => self.number(key, label, None),
            [number] => self.number(key, label, *number),
            _ => {
                let text = |number: &Option<f64>| number.map_or("none".into(), digits);
                let text: Vec<String> = numbers.iter().map(text).collect();
                self.shown(key, label, json!(numbers), text.join(", "));
            }
        }
    }

    /// Adds a quantity that people see as `text`.
    pub fn shown(
        &mut self,
        key: &'static str,
        label: &str,
        value: impl Into<Value>,
        text: impl Into<String>,
    ) {
        let (value, line) = (value.into(), Some([label.into(), text.into()]));
        self.0.push(Row { key, value, line });
    }

    /// The value of a quantity.
    pub fn get(&self, key: &str) -> Option<&Value> {
        let row = self.0.iter().find(|row| row.key == key);
        row.map(|row| &row.value)
    }

    /// Adds the quantities of `more`.
    pub fn append(&mut self, more: Rows) {
        self.0.extend(more.0);
    }

    /// The table for people.
    pub fn table(&self) -> String {
        let lines = self.0.iter().filter_map(|row| row.line.as_ref());
        lines
            .map(|[label, text]| format!("{label:<34} {text}\n"))
            .collect()
    }

    fn decision(&mut self, decision: Option<Decision>, causes: &[Cause]) {
        let key = match decision {
            Some(Decision::Inclusion) => "inclusion",
            Some(Decision::NoInclusion) => "no_inclusion",
            None => "cannot_be_judged",
        };
        self.shown("decision", "decision", key, key.replace('_', " "));
        self.value("causes", json!(causes));
    }

    /// T, γ and the amplitude of the signal, at one inclusion.
    fn test(&mut self, test: &SubspaceTest, gamma_nominal: f64, posterior: Option<f64>) {
        numbers! { self;
            gamma: "gamma (signal-to-noise ratio)", test.gamma;
            gamma_nominal: "gamma if everything were known", gamma_nominal;
            amplitude: "signal amplitude / predicted", test.t / test.gamma;
            amplitude_sd: "its standard deviation", 1.0 / test.gamma;
            posterior_h1: "posterior P(inclusion)", posterior;
        }
    }

    /// The samples in air at the start and at the end of each sweep.
    fn in_air(&mut self, sweeps: &[[usize; 2]]) {
        let value = json!(sweeps);
        let ends = |[start, end]: &[usize; 2]| format!("first {start}, last {end}");
        match sweeps.iter().all(|of| *of == [0; 2]) {
            true => self.value("samples_in_air", value),
            false => {
                let text = sweeps.iter().map(ends).collect::<Vec<_>>().join("; ");
                self.shown("samples_in_air", "samples in air", value, text);
            }
        }
    }

    /// How well the record fits.
    fn fit(&mut self, fit: &Fit) {
        self.value("fits", fit.noise_is_right());
        numbers! { self;
            noise_sd_lateral_n: "noise sd, lateral, N", fit.noise_sd.lateral;
            noise_sd_normal_n: "noise sd, normal, N", fit.noise_sd.normal;
        }
        match fit.limits {
            None => self.value("chi_square", fit.chi_square),
            Some(limits) => {
                let [found, low, high] = [fit.chi_square, limits[0], limits[1]].map(digits);
                let text = format!("{found} (accepted range {low} to {high})");
                self.shown("chi_square", "residual chi-square", fit.chi_square, text);
            }
        }
        self.value("chi_square_limits", fit.limits.map(Vec::from));
        self.value("degrees", fit.degrees);
        self.value("whiteness", fit.whiteness);
        self.value("theta_correlated", fit.theta_correlated);
        self.value("level", fit.level);
        self.in_air(&[fit.in_air]);
    }
}

impl RobustAnswer {
    /// The decision, what explains the record, and where the inclusion of a bank lies.
    ///
    /// Implements: CLI-043, ROB-041, ROB-042, ROB-043.
    pub fn rows(&self, place: Option<(&Bank, &RobustPlace)>) -> Rows {
        let mut rows = Rows::default();
        rows.value("model", "robust");
        rows.decision(self.decision, &self.causes);
        let is_weak = self.causes == [Cause::TooWeak];
        let is_compared = is_compared(self.decision, &self.causes);
        numbers! { rows;
            posterior_h1: "posterior P(inclusion)", is_compared.then_some(self.posterior);
            theta: "theta (log-likelihood ratio)", is_compared.then_some(self.theta);
            false_alarm: "P(false alarm), worst class", self.rates.map(|rates| rates.false_alarm);
            miss: "P(miss), worst class", self.rates.map(|rates| rates.miss);
        }
        for (hypothesis, key, label) in [
            (0, "class_without", "explanation without inclusion"),
            (1, "class_with", "explanation with an inclusion"),
        ] {
            if let Some(class) = self.likeliest_class(hypothesis) {
                let (Class { name, .. }, shares) = self.classes[class];
                let share = shares[hypothesis];
                let text = format!("{name} ({:.0} %)", 100.0 * share);
                rows.shown(
                    key,
                    label,
                    json!({"class": name, "probability": share}),
                    text,
                );
            }
        }
        let without = self.likeliest_class(0).filter(|_| is_weak);
        if let Some(remedy) = without.map(|class| self.classes[class].0.remedy()) {
            rows.shown("remedy", "what would help", remedy, remedy);
        }
        if let Some((bank, place)) = place.filter(|_| is_compared) {
            let (key, deepest) = ("no_inclusion_down_to_m", place.none_down_to);
            let is_of_two = self.decision != Some(Decision::NoInclusion) && place.several > 0.5;
            let is_told = self.decision != Some(Decision::Inclusion) && !is_of_two;
            match deepest.filter(|_| is_told) {
                Some(depth) => {
                    let text = format!("{:.3}", 1e3 * depth);
                    rows.shown(key, "no inclusion down to, mm", depth, text);
                }
                None => rows.value(key, deepest),
            }
            let only = if is_of_two {
                ", if there is one alone"
            } else {
                ""
            };
            place_rows(bank, place, only, &mut rows);
            let (key, several) = ("several_inclusions", place.several);
            match is_of_two {
                true => rows.number(key, "P(two inclusions, if any)", several),
                false => rows.value(key, several),
            }
        }
        let channels = |of: fn(&Force<Option<f64>>) -> Option<f64>| {
            self.noise_sd.iter().map(of).collect::<Vec<_>>()
        };
        let levels: Vec<_> = self.levels.iter().copied().map(Some).collect();
        rows.list("level", "force level / reference map", &levels);
        rows.list(
            "noise_sd_lateral_n",
            "noise sd, lateral, N",
            &channels(|sd| sd.lateral),
        );
        rows.list(
            "noise_sd_normal_n",
            "noise sd, normal, N",
            &channels(|sd| sd.normal),
        );
        rows.value("glitches", json!(self.glitches));
        rows.in_air(&self.in_air);
        rows
    }
}

/// The interval of each parameter that the bank varies.
fn place_rows(bank: &Bank, place: &RobustPlace, only: &str, rows: &mut Rows) {
    for (axis, parameter) in Parameter::ALL.into_iter().enumerate() {
        let Some(interval) = place.intervals[axis] else {
            continue;
        };
        let (key, scale, label) = parameter_row(parameter);
        let shown = |x: f64| format!("{:.3}", scale * x);
        let (estimate, range) = (shown(interval.estimate), interval.in_words(shown));
        let text = format!("{estimate}, 95 % interval {range}{only}");
        let ends = [interval.lower, interval.upper];
        let value =
            json!({"estimate": interval.estimate, "interval": ends, "unit": parameter.unit()});
        rows.shown(key, label, value, text);
    }
    rows.value("hypotheses", bank.maps().len());
}

/// The key of a parameter, its scale for people and their words for it.
fn parameter_row(parameter: Parameter) -> (&'static str, f64, &'static str) {
    match parameter {
        Parameter::Position => ("position", 1e3, "position, mm"),
        Parameter::Depth => ("inclusion_depth", 1e3, "inclusion depth, mm"),
        Parameter::Diameter => ("diameter", 1e3, "diameter, mm"),
        Parameter::Modulus => ("youngs_modulus", 1e-3, "Young's modulus, kPa"),
    }
}

impl Judgement {
    /// The decision, the test behind it and how well the record fits.
    ///
    /// Implements: CLI-043, CLI-055.
    pub fn rows(&self) -> Rows {
        let mut rows = Rows::default();
        rows.decision(self.decision, &self.causes);
        rows.number("t", "T (detection statistic)", self.test.t);
        let (least, text) = match self.threshold {
            Threshold::At(t) => (Some(t), digits(t)),
            Threshold::Always => (None, "none: any T detects".into()),
            Threshold::Never => (None, "none: no T detects".into()),
        };
        rows.shown("t_threshold", "T threshold", least, text);
        rows.number("theta", "theta (log-likelihood ratio)", self.test.theta());
        let is_compared = is_compared(self.decision, &self.causes);
        let posterior = is_compared.then_some(self.posterior);
        rows.test(&self.test, self.gamma_nominal, posterior);
        numbers! { rows;
            false_alarm: "P(false alarm) at most", self.rates.false_alarm;
            miss: "P(miss) at most", self.rates.miss;
        }
        rows.fit(&self.fit);
        rows
    }
}

impl Location {
    /// The decision, the tests behind it, where the inclusion of `bank` lies and how well the record fits.
    ///
    /// # Errors
    /// An interval that is not finite.
    ///
    /// Implements: CLI-043, CLI-055, CLI-140.
    pub fn rows(&self, bank: &Bank) -> Result<Rows, Refusal> {
        let mut rows = Rows::default();
        rows.decision(self.decision, &self.causes);
        let statistic = ["theta_max", "theta_mixture"];
        let name = statistic[usize::from(self.threshold.by_mixture)];
        rows.shown("decided_by", "decided by", name, format!("{name} >= eta"));
        numbers! { rows;
            theta_max: "theta_max (best-fitting inclusion)", self.theta_max;
            theta_mixture: "theta_mixture (any inclusion)", self.theta_mixture;
            eta: "eta (threshold)", self.threshold.eta;
        }
        if let Some(calibrated) = self.threshold.calibrated {
            let rate = [calibrated.false_alarm.lower, calibrated.false_alarm.upper];
            let [low, high] = rate.map(digits);
            let text = format!("{low} to {high} (99 % interval)");
            let (key, label) = ("calibrated_false_alarm", "P(false alarm), simulated");
            rows.shown(key, label, json!(rate), text);
            rows.value("simulations", calibrated.simulations);
        }
        let is_compared = is_compared(self.decision, &self.causes);
        let posterior = is_compared.then_some(self.posterior);
        rows.test(&self.test, self.gamma_nominal, posterior);
        numbers! { rows;
            false_alarm_bound: "P(false alarm) at most", self.threshold.false_alarm_bound;
            miss_bound: "P(miss) of best fit at most", self.threshold.miss_bound;
        }
        rows.value("hypotheses", bank.maps().len());
        self.place_rows(bank, &mut rows)?;
        rows.fit(&self.fit);
        Ok(rows)
    }

    /// The 95 % interval of the parameter of one axis, around its estimate; none if the bank does not vary it.
    ///
    /// # Errors
    /// An interval that is not finite.
    ///
    /// Implements: CLI-153.
    pub fn interval(&self, bank: &Bank, axis: usize) -> Result<Option<PlaceInterval>, Refusal> {
        if bank.axes()[axis].len() == 1 {
            return Ok(None);
        }
        Ok(Some(self.place.ends(axis, CREDIBLE)?))
    }

    /// The estimate of each parameter that the bank varies.
    ///
    /// Implements: CLI-153.
    fn place_rows(&self, bank: &Bank, rows: &mut Rows) -> Result<(), Refusal> {
        let mean = self.place.mean();
        for (axis, parameter) in Parameter::ALL.into_iter().enumerate() {
            let Some(interval) = self.interval(bank, axis)? else {
                continue;
            };
            let (key, scale, label) = parameter_row(parameter);
            let (estimate, sd) = (interval.estimate, self.bound.sd[axis]);
            let ends = [interval.lower, interval.upper];
            let value = json!({"estimate": estimate, "mean": mean[axis], "interval": ends, "sd_bound": sd, "unit": parameter.unit()});
            let shown = |x: f64| format!("{:.3}", scale * x);
            let range = interval.in_words(shown);
            let sd = sd.map_or("unknown".into(), |sd| format!("at least {}", shown(sd)));
            let mut text = shown(estimate) + &format!(", 95 % interval {range}, sd {sd}");
            if ends.contains(&None) {
                text += "; the bank ends there";
            }
            rows.shown(key, label, value, text);
        }
        Ok(())
    }
}

/// Six digits.
fn digits(value: f64) -> String {
    if value != 0.0 && !(1e-4..1e6).contains(&value.abs()) {
        format!("{value:.5e}")
    } else {
        format!("{value:.6}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    // Verifies: CLI-043.
    #[test]
    fn each_sweep_has_its_place_in_a_list() {
        let mut rows = Rows::default();
        rows.list("levels", "levels", &[None, Some(1.5), None]);
        rows.list("one", "one", &[Some(2.5)]);
        rows.list("nothing", "nothing", &[None]);
        rows.list("not_compared", "not compared", &[]);
        let text = rows.table();
        let texts: Vec<&str> = text.lines().map(|line| line[35..].trim()).collect();
        assert_eq!(texts, ["none, 1.500000, none", "2.500000"]);
        let json =
            json!({"levels": [null, 1.5, null], "one": 2.5, "nothing": null, "not_compared": null});
        assert_eq!(serde_json::to_value(&rows).unwrap(), json);
    }
}
