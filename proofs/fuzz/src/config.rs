//! The configuration of `palpate run`.

use std::fmt::Write;

use palpate::cli::arguments::ContactName;
use palpate::cli::config::Config;
use palpate::phantom::decimal::format_scaled;

use crate::command_line::check_positions;
use crate::message::{check_line, check_message};
use crate::{FILE, Outcome, text};

/// An accepted configuration has every number in its range, and is the same when it is written and
/// read again; a refusal names file and line.
///
/// Implements: EVD-081, EVD-082.
pub fn config_toml(bytes: &[u8]) -> Outcome {
    let Some(text) = text(bytes) else {
        return Outcome::Refused;
    };
    match Config::from_toml(text, FILE) {
        Ok(config) => {
            check_config(&config);
            let again = Config::from_toml(&written(&config), FILE).expect("it was written");
            assert_eq!(written(&again), written(&config));
            Outcome::Accepted
        }
        Err(error) => {
            let message = error.to_string();
            check_message(&message);
            let line = message
                .strip_prefix(FILE)
                .and_then(|rest| rest.strip_prefix(':'))
                .and_then(|rest| rest.split_once(": "))
                .and_then(|(line, _)| line.parse().ok());
            check_line(line.unwrap_or_else(|| panic!("no line: {message}")), text);
            Outcome::Refused
        }
    }
}

fn check_config(config: &Config) {
    check_positions(&config.depths_mm.0);
    check_positions(&config.laterals_mm.0);
    for number in [config.mesh.size_mm, config.detection.noise_sd] {
        assert!(number.is_finite() && number > 0.0, "{number}");
    }
    let detection = &config.detection;
    for rate in [
        detection.max_false_alarm,
        detection.max_miss,
        detection.prior_h1,
    ] {
        assert!(rate > 0.0 && rate < 1.0, "{rate}");
    }
}

/// The configuration as a file.
fn written(config: &Config) -> String {
    let quoted = |text: &str| toml::Value::String(text.into()).to_string();
    let texts = |texts: Vec<String>| texts.iter().map(|text| quoted(text)).collect::<Vec<_>>();
    let phantoms = config.phantoms.iter().map(|name| name.as_ref().clone());
    let list = |positions: &[f64]| {
        let written = positions.iter().map(|&x| format_scaled(x, 3));
        quoted(&written.collect::<Vec<_>>().join(","))
    };
    let measured = config
        .measured
        .iter()
        .map(|path| path.display().to_string());
    let contact = match config.mesh.contact {
        ContactName::DeformedNormal => "deformed-normal",
        ContactName::VerticalGap => "vertical-gap",
    };
    let mut text = String::new();
    // Writing to a String cannot fail.
    let _ = writeln!(text, "reference = {}", quoted(config.reference.as_ref()));
    let _ = writeln!(
        text,
        "phantoms = [{}]",
        texts(phantoms.collect()).join(", ")
    );
    let _ = writeln!(
        text,
        "measured = [{}]",
        texts(measured.collect()).join(", ")
    );
    let _ = writeln!(text, "depths_mm = {}", list(&config.depths_mm.0));
    let _ = writeln!(text, "laterals_mm = {}", list(&config.laterals_mm.0));
    let _ = writeln!(text, "[mesh]\nsize_mm = {:?}", config.mesh.size_mm);
    let _ = writeln!(text, "contact = {contact:?}");
    let detection = &config.detection;
    let _ = writeln!(text, "[detection]\nnoise_sd_n = {:?}", detection.noise_sd);
    let _ = writeln!(text, "max_false_alarm = {:?}", detection.max_false_alarm);
    let _ = writeln!(text, "max_miss = {:?}", detection.max_miss);
    let _ = writeln!(text, "prior_h1 = {:?}", detection.prior_h1);
    text
}
