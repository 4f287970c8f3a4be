//! `palpate psychophysics`, end to end.

use std::sync::OnceLock;

use crate::program::Place;
use palpate_asserts::assert_has;
use serde_json::{Value, json};

const INCLUSIONS: [&str; 4] = ["2.6", "4.6", "6.6", "8.6"];

/// A folder with coarse maps over x ≥ 0, made once.
fn place() -> &'static Place {
    static PLACE: OnceLock<Place> = OnceLock::new();
    PLACE.get_or_init(|| {
        let place = Place::new("psychophysics_command");
        for phantom in ["none"].into_iter().chain(INCLUSIONS) {
            let poses = "--depths-mm=4 --laterals-mm=0:10:1 --mesh-mm=2 --format=json";
            place.write(
                phantom,
                place.succeed(&format!("solve --phantom {phantom} {poses}")),
            );
        }
        place
    })
}

fn answer(arguments: &str) -> Value {
    let output = place().run(&format!("psychophysics --format json {arguments}"));
    let holds = output.status.success() && output.stderr.is_empty();
    assert!(holds, "{output:?}");
    serde_json::from_slice(&output.stdout).unwrap()
}

/// Reference and maps as arguments; the option that names a map is free.
fn maps(option: &str) -> String {
    let maps = INCLUSIONS.map(|name| format!(" {option} {name}={name}"));
    format!("--reference none{}", maps.concat())
}

// Verifies: CLI-080, CLI-082.
#[test]
fn without_a_file_it_analyses_table_1() {
    let answer = answer("");
    assert_eq!(answer["schema"], "palpate-psychophysics");
    assert_eq!(answer["schema_version"], 1);
    assert_eq!(answer["counts"], "Table 1");
    assert!(answer["bridge"].is_null());
    let playback = &answer["analysis"]["conditions"][1];
    assert_eq!(playback["name"], "FEM data");
    let third = &playback["inclusions"][2];
    assert_eq!(third["pooled"]["correct"], 253);
    assert_eq!(third["pooled"]["trials"], 300);
    assert_eq!(third["depth_m"], 6.6e-3);
    // A subject who was always right: no upper end, as null.
    let gamma = &playback["subjects"][0]["rates"][0]["gamma"];
    assert!(gamma["upper"].is_null() && gamma["lower"].is_number());
    let levels = answer["noise_levels"]["levels"].as_array().unwrap();
    assert_eq!(levels.len(), 5);
    let text = place().succeed("psychophysics");
    assert!(text.contains("253/300") && text.contains("p is rough") && text.contains("235"));
}

// Verifies: CLI-081, CLI-082.
#[test]
fn maps_add_noise_and_predicted_shares() {
    let arguments = maps("--inclusion");
    let found = answer(&arguments);
    let bridge = &found["bridge"];
    // x ≥ 0 completed by symmetry.
    assert_eq!(
        (&bridge["positions"], &bridge["from_m"]),
        (&json!(21), &json!(-0.01))
    );
    let playback = &bridge["conditions"][1];
    assert_eq!(playback["conventions"].as_array().unwrap().len(), 12);
    let at_6_6 = &playback["noise_by_inclusion"][2];
    let [noise, signal] = ["noise_n", "signal_n"].map(|key| at_6_6[key].as_f64().unwrap());
    // γ of 253/300 (mpmath).
    assert!((signal / noise - 1.4258841436632816).abs() < 1e-12);
    // The peak of 8.6 mm lies off the inclusion.
    let deepest = &bridge["inclusions"][3];
    assert!(deepest["peak_normal_at_m"].as_f64().unwrap().abs() > 4e-3);
    // The level of the normal force is rejected with coarse meshes too.
    for condition in bridge["conditions"].as_array().unwrap() {
        assert_eq!(condition["verdict"]["support"], "change_along_sweep");
    }
    // How much of the level may count, over ±3 to ±10 mm by the peak and by the whole sweep.
    assert_eq!(bridge["weight_ranges"], 48);
    let weights = playback["weights"].as_array().unwrap();
    assert_eq!(weights.len(), 16);
    assert_eq!(weights[15]["half_sweep_m"], 0.01);
    assert_eq!(weights[15]["statistic"], "matched_filter");
    assert!(weights[15]["left"]["upper"].as_f64().unwrap() < 1.0);
    assert_eq!(weights[15]["fits_worst"]["offset"], "kept");
    // The other name of the option, the order of the maps, and the table for people.
    assert_eq!(answer(&maps("--map")), found);
    let swept = &answer(&format!("{arguments} --sweep-mm 5"))["bridge"];
    assert_eq!(
        (&swept["positions"], &swept["to_m"]),
        (&json!(11), &json!(0.005))
    );
    // Within the sweep that is asked for: ±3, ±4 and ±5 mm.
    assert_eq!(swept["weight_ranges"], 18);
    let text = place().succeed(&format!("psychophysics {arguments}"));
    let words = "peak, normal force less its mean|rejected|weight of the level|the lateral force in all 16 fits";
    assert_has(&text, words);
}

// Verifies: CLI-240.
#[test]
fn a_map_of_another_depth_than_its_name_is_told() {
    let place = Place::new("depth_of_a_name");
    for phantom in ["none", "2.6", "4.6"] {
        let poses = "--depths-mm=0:4:1 --laterals-mm=-8:8:4 --mesh-mm=2 --format=json";
        let map = place.succeed(&format!("solve --phantom {phantom} {poses}"));
        place.write(phantom, map);
    }
    let ideal = "experiment --trials 1 --seconds 1 --seed 1 --observer ideal --noise 3 --journal";
    for command in ["psychophysics", &format!("{ideal} wrong.jsonl")] {
        let maps = "--reference none --inclusion 2.6=2.6 --inclusion 6.6=4.6";
        let output = place.run(&format!("{command} {maps}"));
        let told = String::from_utf8(output.stderr).unwrap();
        let expected =
            "palpate: warning: 4.6: the inclusion of the map named \"6.6\" is 4.6 mm deep\n";
        assert_eq!(told, expected, "{command}");
        assert!(output.status.success());
    }
    let right = place.run(&format!(
        "{ideal} right.jsonl --reference none --inclusion 4.6=4.6"
    ));
    assert!(right.status.success() && right.stderr.is_empty());
}

// Verifies: CLI-080, CLI-082, CLI-003.
#[test]
fn a_file_of_counts_is_analysed_alone() {
    let counts = "subject,condition,trials,soft 3,soft 5\nme,gel,20,20,10\n";
    place().write("counts.csv", counts);
    let answer = answer("counts.csv");
    assert!(answer["noise_levels"].is_null());
    let condition = &answer["analysis"]["conditions"][0];
    assert!(condition["psychometric"].is_null() && condition["dispersion"].is_null());
    assert!(condition["inclusions"][0]["clustered"].is_null());
    assert_eq!(condition["inclusions"][1]["pooled"]["gamma"]["gamma"], 0.0);
    let text = place().succeed("psychophysics counts.csv");
    assert!(text.contains("no bound"), "{text}");
}

// A file without an end is refused too.
// Verifies: CLI-008, CLI-081, CLI-003.
#[test]
fn what_is_refused_is_named_in_one_line() {
    place().write("bad.csv", "subject,condition,trials,2.6\n1,gel,30,31\n");
    place().refuses("psychophysics", |words| format!("psychophysics {words}"));
}
