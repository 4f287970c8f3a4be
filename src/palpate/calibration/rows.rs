//! The answer, quantity by quantity.

use serde_json::{Value, json};

use super::{Calibration, CurveCause, Elastic, Interval, Relaxation};
use crate::refusal::Refusal;
use crate::rows::Rows;
use crate::text::digits;

/// Seconds after which it is said what is left of a force.
const AFTER: [f64; 3] = [1.0, 3.0, 10.0];

impl Calibration<'_> {
    /// What the curve says: contact, law, relaxation, sensor, each with its interval, or why it cannot be judged. `layers` are those of
    /// the question.
    ///
    /// # Errors
    /// Numbers that no interval has.
    ///
    /// Implements: CAL-032, CAL-040.
    pub fn rows(&self, layers: &[usize]) -> Result<Rows, Refusal> {
        let mut rows = Rows::default();
        let curve = self.curve;
        rows.value("curve", curve.file());
        rows.value("samples", curve.depths().len());
        let cause = self.cause.map(CurveCause::in_words);
        rows.value("cause", json!(self.cause));
        if let Some(cause) = cause {
            rows.shown("remedy", "cannot be judged", cause, cause);
        }
        let at = (curve.forces().iter().zip(curve.depths())).max_by(|a, b| a.0.total_cmp(b.0));
        if let Some((force, depth)) = at {
            let size = match force.abs() < 0.1 {
                true => digits(force),
                false => format!("{force:.4}"),
            };
            let text = format!("{size}, at {:.3} mm of the curve", 1e3 * depth);
            let value = json!({"force_n": force, "depth_m": depth});
            rows.shown("highest_force", "highest force, N", value, text);
        }
        interval(
            &mut rows,
            ["contact", "contact, mm", "m"],
            1e3,
            self.contact()?,
        );
        self.law_rows(layers, &mut rows)?;
        if self.cause.is_none() {
            rows.value("contact_law_correlation", self.correlation());
            self.relaxation_rows(&mut rows)?;
        }
        let [offset, drift] = self.baseline()?;
        interval(
            &mut rows,
            ["offset", "offset of the sensor, N", "N"],
            1.0,
            offset,
        );
        interval(
            &mut rows,
            ["drift", "its drift over the curve, N", "N"],
            1.0,
            drift,
        );
        interval(
            &mut rows,
            ["noise_sd", "noise sd, N", "N"],
            1.0,
            self.noise_sd()?,
        );
        Ok(rows)
    }

    /// Moduli, or stiffness and exponent.
    fn law_rows(&self, layers: &[usize], rows: &mut Rows) -> Result<(), Refusal> {
        let law = self.law()?;
        match (&self.elastic, &law[..]) {
            (Elastic::Empirical, [stiffness, exponent, growth]) => {
                let growth = growth.map(libm::log);
                let [k, p, q] = [*stiffness, *exponent, growth].map(|of| shown(of, 1.0));
                let text = format!("F = k d^p e^(q d), mm; k {k} N; p {p}; q {q}");
                let value = json!({"k_n": written(*stiffness), "p": written(*exponent), "q_per_mm": written(growth)});
                rows.shown("empirical_law", "law", value, text);
            }
            (Elastic::Gel(_), [_, ..]) => {
                modulus_row(rows, "Young's modulus, kPa", &self.moduli(layers)?)
            }
            // A curve that cannot be judged.
            _ => {}
        }
        Ok(())
    }

    fn relaxation_rows(&self, rows: &mut Rows) -> Result<(), Refusal> {
        let terms = self.relaxation_terms()?;
        let text = match (self.relaxation, &terms[..]) {
            (Relaxation::PowerLaw, [(time, exponent)]) => {
                let [time, exponent] = [time, exponent].map(|of| shown(*of, 1.0));
                format!("g = (1 + t/tau)^(-beta); tau {time} s; beta {exponent}")
            }
            (_, []) => "none".into(),
            (_, terms) => {
                let term = |(time, weight): &(Interval, Interval)| {
                    format!("g {} with tau {} s", shown(*weight, 1.0), shown(*time, 1.0))
                };
                terms.iter().map(term).collect::<Vec<_>>().join("; ")
            }
        };
        let second = match self.relaxation {
            Relaxation::PowerLaw => "exponent",
            _ => "weight",
        };
        let values = terms
            .iter()
            .map(|(time, weight)| json!({"tau_s": written(*time), second: written(*weight)}));
        let value = json!({"form": self.relaxation, "terms": values.collect::<Vec<_>>()});
        rows.shown("relaxation", "relaxation", value, text);
        let held: Vec<_> = AFTER
            .iter()
            .filter_map(|s| Some((*s, self.held_after(*s)?)))
            .collect();
        if !held.is_empty() && !terms.is_empty() {
            let texts = held
                .iter()
                .map(|(seconds, left)| format!("{left:.3} after {seconds} s"));
            let text = texts.collect::<Vec<_>>().join(", ");
            let values = held
                .iter()
                .map(|(seconds, left)| json!({"seconds": seconds, "left": left}));
            let values: Vec<Value> = values.collect();
            rows.shown("held", "force left of the highest", values, text);
        }
        Ok(())
    }
}

/// The modulus of each layer, under a label.
pub fn modulus_row(rows: &mut Rows, label: &str, moduli: &[(String, Interval)]) {
    let texts = moduli
        .iter()
        .map(|(name, of)| format!("{name} {}", shown(*of, 1e-3)));
    let text = texts.collect::<Vec<_>>().join("; ");
    let value = |(name, of): &(String, Interval)| json!({"layer": name, "estimate": of.estimate, "interval": of.ends, "unit": "Pa"});
    let values: Vec<Value> = moduli.iter().map(value).collect();
    rows.shown("youngs_modulus", label, values, text);
}

/// An interval for programs.
fn written(of: Interval) -> Value {
    json!({"estimate": of.estimate, "interval": of.ends})
}

/// An interval for people.
fn shown(of: Interval, scale: f64) -> String {
    let Interval { estimate, ends } = of.map(|value| scale * value);
    let width = (ends[1] - ends[0]).abs();
    if width == 0.0 {
        return format!("{estimate:.3}, as given");
    }
    let decimals = (1.0 - libm::floor(libm::log10(width))).clamp(0.0, 9.0) as usize;
    let [low, high] = ends;
    format!("{estimate:.decimals$} ({low:.decimals$} to {high:.decimals$})")
}

/// A quantity with its interval, if there is one; what is known has no width, and no line.
fn interval(
    rows: &mut Rows,
    [key, label, unit]: [&'static str; 3],
    scale: f64,
    of: Option<Interval>,
) {
    match of {
        None => rows.value(key, Value::Null),
        Some(of) => {
            let value = json!({"estimate": of.estimate, "interval": of.ends, "unit": unit});
            rows.shown(key, label, value, shown(of, scale));
        }
    }
}
