//! The configuration of `palpate run`.

use palpate::decimal::format_scaled;
use palpate_program::config::Config;
use serde_json::json;

use crate::command_line::check_positions;
use crate::message::{check_line, check_message};
use crate::{FILE, Outcome, judged};

/// An accepted configuration has every number in its range, and is the same when it is written and
/// read again; a refusal names file and line.
pub fn config_toml(text: &str) -> Outcome {
    let accepted = |config: Config| {
        check_config(&config);
        let again = Config::from_toml(&written(&config), FILE).expect("it was written");
        assert_eq!(written(&again), written(&config));
    };
    judged(Config::from_toml(text, FILE), accepted, |error| {
        let message = error.to_string();
        check_message(&message);
        let place = message
            .strip_prefix(FILE)
            .and_then(|rest| rest.strip_prefix(':'));
        let line = place.and_then(|rest| rest.split_once(": ")?.0.parse().ok());
        check_line(line.unwrap_or_else(|| panic!("no line: {message}")), text);
    })
}

fn check_config(config: &Config) {
    check_positions(&config.depths);
    check_positions(&config.laterals);
    for number in [config.mesh.size_mm, config.detection.noise_sd_n] {
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
    let list = |positions: &[f64]| {
        let written = positions.iter().map(|&x| format_scaled(x, 3));
        written.collect::<Vec<_>>().join(",")
    };
    let contact = config.mesh.contact.name();
    let detection = &config.detection;
    let file = json!({
        "reference": config.reference.as_ref(),
        "phantoms": config.phantoms.iter().map(|name| name.as_ref()).collect::<Vec<_>>(),
        "measured": config.measured,
        "depths_mm": list(&config.depths),
        "laterals_mm": list(&config.laterals),
        "mesh": {"size_mm": config.mesh.size_mm, "contact": contact},
        "detection": {
            "noise_sd_n": detection.noise_sd_n,
            "max_false_alarm": detection.max_false_alarm,
            "max_miss": detection.max_miss,
            "prior_h1": detection.prior_h1,
        },
    });
    toml::to_string(&file).expect("numbers and texts")
}
