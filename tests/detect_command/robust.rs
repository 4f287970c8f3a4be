//! The robust model, which is the default, end to end.

use super::{MAPS, place, write_trace};
use crate::program::text;
use palpate::force_map::ForceMap;
use serde_json::{Value, json};

/// The answer in JSON and the code of the end.
fn answer(arguments: &str) -> (Value, Option<i32>) {
    let output = place().run(&format!("detect {arguments} --format json"));
    let said = text(&output.stderr).to_string();
    let answer = serde_json::from_slice(&output.stdout);
    (answer.expect(&said), output.status.code())
}

// Verifies: CLI-140, CLI-143, CLI-043, ROB-003, ROB-004, ROB-030, ROB-040, ROB-043, ROB-050.
#[test]
fn the_robust_model_is_the_default_and_has_three_answers() {
    let map = ForceMap::read(&place().at("inclusion.json")).unwrap();
    let row = map.table().row(0.003).unwrap();
    let laterals = map.table().laterals();
    let sweep = |scale: f64, along: f64| -> Vec<[f64; 3]> {
        let sample = |at: usize| {
            [
                1e3 * along * laterals[at],
                scale * row.lateral[at],
                scale * row.normal[at],
            ]
        };
        (0..laterals.len()).map(sample).collect()
    };
    for (file, scale, along) in [
        ("strong.csv", 20.0, 1.0),
        ("metres.csv", 1.0, 1e-3),
        ("turned.csv", -1.0, 1.0),
    ] {
        write_trace(place(), file, &sweep(scale, along), 9);
    }
    let sharp =
        "--depth-mm 3 --known gel,support,surface,stage,tilt,friction,relaxation,walk,smooth";
    let (found, code) = answer(&format!("with.csv {MAPS} {sharp}"));
    assert_eq!(
        (&found["decision"], code),
        (&json!("inclusion"), Some(0)),
        "{found}"
    );
    assert_eq!(
        (&found["model"], &found["schema_version"]),
        (&json!("robust"), &json!(4))
    );
    // Beside what is known, two classes are left.
    assert!(found["posterior_h1"].as_f64().unwrap() > 0.95);
    assert!(
        ["the maps hold", "the forces are off smoothly by 0.5 %"]
            .contains(&found["class_with"]["class"].as_str().unwrap())
    );
    let (found, code) = answer(&format!("without.csv {MAPS} {sharp}"));
    assert_eq!(
        (&found["decision"], code),
        (&json!("no_inclusion"), Some(0)),
        "{found}"
    );
    // Where nothing is known, 33 samples in noise of 0.1 N are too few.
    let (found, code) = answer(&format!("without.csv {MAPS} --depth-mm 3 --sure 0.999"));
    assert_eq!(
        (&found["causes"], code),
        (&json!(["too_weak"]), Some(3)),
        "{found}"
    );
    assert!(found["posterior_h1"].is_f64());
    for (file, cause) in [
        ("strong.csv", "level"),
        ("metres.csv", "narrow"),
        ("turned.csv", "sign"),
    ] {
        let (found, code) = answer(&format!("{file} {MAPS} --depth-mm 3"));
        assert_eq!(
            (&found["causes"], code),
            (&json!([cause]), Some(3)),
            "{found}"
        );
        assert_eq!(found["posterior_h1"], Value::Null);
    }
    // Two sweeps of one place say more than one.
    let theta = |traces: &str, depths: &str| {
        let (found, _) = answer(&format!(
            "{traces} {MAPS} --depth-mm {depths} --known gel,support"
        ));
        found["theta"].as_f64().unwrap()
    };
    let both = theta("with.csv disturbed.csv --together", "3");
    assert!(both > theta("with.csv", "3"), "{both}");
    assert_eq!(both, theta("with.csv disturbed.csv --together", "3,3"));
}

// Verifies: ROB-041, ROB-042.
#[test]
fn a_bank_tells_where_and_down_to_which_depth_there_is_none() {
    let known = "--known gel,support,surface,stage,tilt,friction,relaxation,walk,smooth";
    let (found, _) = answer(&format!(
        "moved.csv --bank bank.json --noise-sd-lateral-n 0.05 --noise-sd-normal-n 0.12 {known}"
    ));
    assert_eq!(found["decision"], "inclusion", "{found}");
    let ends = &found["position"]["interval"];
    let holds = |end: &Value, is_within: fn(f64) -> bool| {
        end.is_null() || end.as_f64().is_some_and(is_within)
    };
    assert!(
        holds(&ends[0], |x| x < 1.5e-3) && holds(&ends[1], |x| x > 1.5e-3),
        "{found}"
    );
    assert_eq!(found["no_inclusion_down_to_m"], Value::Null);
    let (found, _) = answer(&format!(
        "without.csv --bank bank.json --noise-sd-lateral-n 0.05 --noise-sd-normal-n 0.12 {known}"
    ));
    assert_eq!(found["decision"], "no_inclusion", "{found}");
    assert_eq!(found["no_inclusion_down_to_m"], 3.6e-3);
}
