//! Records of a probe that does not touch the gel, or not all the time.

use super::*;

// Verifies: TRC-016, TRC-075, ROB-003, ROB-042, CLI-143.
#[test]
fn a_sensor_set_to_zero_never_tells_that_there_is_nothing() {
    let sweep = sweep(maps(place())[0].table());
    let air: Vec<_> = sweep.iter().map(|[x, ..]| [*x, 0.0, 0.0]).collect();
    write_trace(place(), "air.csv", &air, 7);
    for hypotheses in [MAPS, "--bank bank.json"] {
        for model in ["exact", "robust"] {
            let asked = format!("detect air.csv --model {model} {hypotheses} {USUAL} --zeroed");
            let output = place().run(&format!("{asked} --format json"));
            let said = text(&output.stderr);
            let found: Value = serde_json::from_slice(&output.stdout).expect(said);
            assert_eq!(output.status.code(), Some(3), "{found}");
            assert_eq!(found["decision"], "cannot_be_judged");
            if model == "exact" {
                assert_eq!(found["causes"], json!(["zeroed"]), "{found}");
                assert!(found["posterior_h1"].as_f64().is_some_and(|p| p < 0.5));
                assert_has(
                    said,
                    "air.csv: cannot be judged: a sensor that was set to zero",
                );
            }
        }
    }
}

/// The causes and the samples in air, by both models, or one with a bank.
fn unjudged(trace: &str, hypotheses: &str, more: &str) -> Vec<(Value, Value)> {
    let judged = |model: &str| {
        let asked = format!("detect {trace} --model {model} {hypotheses} {USUAL} {more}");
        let output = place().run(&format!("{asked} --format json"));
        let said = text(&output.stderr);
        let answer: Value = serde_json::from_slice(&output.stdout).expect(said);
        (answer["causes"].clone(), answer["samples_in_air"].clone())
    };
    ["robust", "exact"].map(judged).into()
}

// Verifies: TRC-016, TRC-017, ROB-003, ROB-007, CLI-143, CLI-140.
#[test]
fn a_record_with_air_is_not_judged_and_says_how_much() {
    let sweep = sweep(maps(place())[1].table());
    // The probe comes down at the first position, or is lifted at the last, on the way there or back.
    let air = |x: f64, samples: usize| vec![[x, 0.0, 0.0]; samples];
    let down = [air(-8.0, 6), sweep.clone()].concat();
    let up = [sweep.clone(), air(8.0, 4)].concat();
    let back: Vec<_> = up.iter().rev().copied().collect();
    let never: Vec<_> = sweep.iter().map(|[x, ..]| [*x, 0.0, 0.0]).collect();
    for (name, forces, causes, samples) in [
        ("down.csv", down, "in_air", json!([[6, 0]])),
        ("up.csv", up, "in_air", json!([[0, 4]])),
        ("back.csv", back, "in_air", json!([[4, 0]])),
        ("never.csv", never, "no_contact", json!([[0, 0]])),
    ] {
        write_trace(place(), name, &forces, 5);
        for hypotheses in [MAPS, "--bank bank.json"] {
            for (found, in_air) in unjudged(name, hypotheses, "") {
                assert_eq!(
                    (&found[0], &in_air),
                    (&json!(causes), &samples),
                    "{name} {found}"
                );
            }
        }
    }
    let output = place().run(&format!("detect down.csv {MAPS} {USUAL}"));
    assert_eq!(output.status.code(), Some(3));
    assert_has(
        text(&output.stdout),
        "samples in air                     first 6, last 0\n",
    );
    assert_has(
        text(&output.stderr),
        "down.csv: cannot be judged: samples at the start or at the end are in air: leave them out",
    );
    // A sensor that was set to zero on the gel says nothing of contact.
    let zeroed = sweep
        .iter()
        .map(|[x, lateral, normal]| [*x, *lateral, normal - sweep[0][2]]);
    write_trace(place(), "zeroed.csv", &zeroed.collect::<Vec<_>>(), 6);
    for (found, _) in unjudged("zeroed.csv", MAPS, "") {
        assert_eq!(found[0], "no_contact", "{found}");
    }
    for (found, in_air) in unjudged("zeroed.csv", MAPS, "--zeroed") {
        assert!(
            found != json!(["no_contact"]) && in_air == json!([[0, 0]]),
            "{found}"
        );
    }
}
