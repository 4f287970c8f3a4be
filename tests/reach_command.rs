//! `palpate reach`, end to end, against plain sums over the maps of a coarse bank.

use std::sync::OnceLock;

use crate::program::Place;
use palpate::bank::Bank;
use palpate::force_map::ForceMap;
use palpate_asserts::assert_has;
use serde_json::Value;

/// The folder with a bank of two depths and two diameters, made once.
fn place() -> &'static Place {
    static PLACE: OnceLock<Place> = OnceLock::new();
    PLACE.get_or_init(|| {
        let place = Place::new("reach_command");
        place.succeed(
            "bank --phantom 6.6 --offsets-mm=-1,1 --depths-mm 3.6,6.6 --diameters-mm 4,6 --probe-depth-mm 3 \
             --laterals-mm=-8:8:1 --mesh-mm 2 --out bank.json",
        );
        place
    })
}

fn bank() -> Bank {
    Bank::read(&place().at("bank.json")).unwrap()
}

/// Both channels of a map at the depth of the probe.
fn channels(map: &ForceMap) -> [Vec<f64>; 2] {
    let row = map.table().row(3e-3).unwrap();
    [row.lateral.to_vec(), row.normal.to_vec()]
}

/// γ of a map in noise of 1 N: all of its signal, or what an offset of each channel leaves of it.
fn gamma(bank: &Bank, map: usize, has_offset: bool) -> f64 {
    let pairs = channels(&bank.maps()[map])
        .into_iter()
        .zip(channels(bank.reference()));
    let energy = pairs.map(|(with, without)| {
        let signal = with.iter().zip(&without).map(|(a, b)| a - b);
        let signal: Vec<f64> = signal.collect();
        let mean = match has_offset {
            true => signal.iter().sum::<f64>() / signal.len() as f64,
            false => 0.0,
        };
        signal.iter().map(|x| (x - mean).powi(2)).sum::<f64>()
    });
    energy.sum::<f64>().sqrt()
}

/// The γ that is needed: by Python's statistics.NormalDist, −Φ⁻¹(0.01/8) − Φ⁻¹(0.05), the bank having 8 maps.
const NEEDED: f64 = 3.023341439739147 + 1.644853626951472;

fn reach(more: &str) -> Value {
    let answer = place().succeed(&format!("reach --bank bank.json --format json {more}"));
    serde_json::from_str(&answer).unwrap()
}

#[track_caller]
fn assert_near(found: &Value, expected: f64) {
    let found = found.as_f64().unwrap();
    // Both are sums of 34 squares, in other orders; then logarithms of ratios near 1.
    let holds = (found / expected - 1.0).abs() < 1e-9;
    assert!(holds, "found {found}, expected {expected}");
}

/// Where ln γ, linear between two points, is that needed.
fn crossing([a, b]: [f64; 2], [gamma_a, gamma_b]: [f64; 2], needed: f64) -> f64 {
    a + (b - a) * (gamma_a / needed).ln() / (gamma_a / gamma_b).ln()
}

// Verifies: CLI-160, BNK-070, BNK-071.
#[test]
fn depths_and_diameters_are_those_of_plain_sums() {
    let bank = bank();
    // Maps in the order of positions, depths, diameters: that at −1 mm is the nearest to 0, as is its mirror image.
    let [shallow_small, deep_small, shallow, deep] = [0, 2, 4, 6];
    for (known, has_offset) in [
        ("offset,drift,gain,depth", false),
        ("drift,gain,depth", true),
    ] {
        let of = |map| gamma(&bank, map, has_offset);
        // The largest depth of the 6 mm lies between those of the bank, and so does the smallest diameter at 6.6 mm.
        let sd = (of(deep) * of(shallow)).sqrt() / NEEDED;
        let found = reach(&format!("--noise-sd-n {sd:e} --known {known}"));
        assert_near(&found["gamma_needed"], NEEDED);
        let row = &found["largest_depths"][1];
        assert_eq!(row["diameter_m"], 6e-3);
        assert_eq!(row["youngs_modulus_pa"], 1.2e6);
        let key = if has_offset {
            "unknown"
        } else {
            "nothing_unknown"
        };
        assert_near(&row[key]["gamma"][0], of(shallow) / sd);
        assert_near(&row[key]["gamma"][1], of(deep) / sd);
        let depth = crossing([3.6e-3, 6.6e-3], [of(shallow), of(deep)], NEEDED * sd);
        assert_near(&row[key]["largest_depth_m"], depth);
        assert_eq!(row[key]["is_beyond_bank"], false);
        let sd = (of(deep_small) * of(deep)).sqrt() / NEEDED;
        let found = reach(&format!("--noise-sd-n {sd:e} --known {known}"));
        let row = &found["smallest_diameters"][1];
        assert_eq!(row["depth_m"], 6.6e-3);
        let width = crossing([4e-3, 6e-3], [of(deep_small), of(deep)], NEEDED * sd);
        let key = if has_offset {
            "unknown_m"
        } else {
            "nothing_unknown_m"
        };
        assert_near(&row[key], width);
        let is_beyond = key.replace("_m", "_is_beyond_bank");
        assert_eq!(row[&is_beyond], false);
        assert!(of(shallow_small) > of(deep_small));
    }
    // What is unknown costs γ, by default offset, drift and gain.
    let found = reach("--noise-sd-lateral-n 0.01 --noise-sd-normal-n 0.02");
    assert_eq!(
        found["unknown"],
        serde_json::json!(["offset", "drift", "gain"])
    );
    let row = &found["largest_depths"][0];
    let [plain, beside] = ["nothing_unknown", "unknown"].map(|key| row[key]["gamma"][0].as_f64());
    assert!(beside < plain, "{row}");
    // Four times the samples have about twice the γ.
    let more = reach("--noise-sd-lateral-n 0.01 --noise-sd-normal-n 0.02 --samples 68");
    let ratio = more["largest_depths"][0]["nothing_unknown"]["gamma"][0]
        .as_f64()
        .unwrap()
        / plain.unwrap();
    assert!((ratio - 2.0).abs() < 0.1, "{ratio}");
}

// Verifies: CLI-160.
#[test]
fn what_lies_beyond_the_bank_is_said() {
    let table = place().succeed("reach --bank bank.json --noise-sd-n 1e-9");
    let said =
        "deeper than the bank (6.6)|smaller than the bank (4.0)|unknown: offset, drift, gain";
    assert_has(&table, said);
    let table = place().succeed("reach --bank bank.json --noise-sd-n 1e3 --known all");
    let said = "not even at the least depth (3.6)|not even the largest (6.0)|unknown: nothing";
    assert_has(&table, said);
    assert!(!table.contains("than the bank"), "{table}");
}

// Verifies: CLI-160.
#[test]
fn a_rate_that_is_not_0_is_not_said_to_be() {
    let rates = |false_alarm: &str| {
        let table = place().succeed(&format!(
            "reach --bank bank.json --noise-sd-n 1 --max-false-alarm {false_alarm} --max-miss 0.07"
        ));
        let first = table.lines().next().unwrap();
        first.split_once(": ").unwrap().1.to_owned()
    };
    let search = "false alarms in a search over the whole bank, and 7 % misses.";
    assert_eq!(rates("2e-14"), format!("at most 0.000000000002 % {search}"));
    assert_eq!(rates("2e-300"), format!("at most 2.0e−298 % {search}"));
}

// Verifies: CLI-163.
#[test]
fn the_figure_shows_both_lines_and_says_them_in_words() {
    place().succeed("reach --bank bank.json --noise-sd-n 0.005 --figure reach.svg");
    let figure = place().read("reach.svg");
    let words = "<svg|Diameter of the inclusion (mm)|Largest depth at which it is found (mm)|4 mm wide, 1200 kPa:|>\nnothing unknown\n<|>\nunknown: offset, drift, gain\n<";
    assert_has(&figure, words);
}

// Verifies: CLI-160, CLI-002, CLI-237.
#[test]
fn bad_arguments_are_refused_in_one_line() {
    place().refuses("reach", |words| format!("reach {words}"));
}

/// A class takes a part of γ, and none more than is left beside an offset of each channel, which is in every class.
// Verifies: CLI-161, BNK-072.
#[test]
fn each_class_of_disturbance_leaves_a_part_of_gamma() {
    let bank = bank();
    let noise = "--noise-sd-n 0.05 --samples 161 --known drift,gain,depth";
    let found = reach(&format!("{noise} --classes"));
    let rows = found["beside_classes"].as_array().unwrap();
    let [_, depths, diameters, _] = bank.axes();
    assert_eq!(rows.len(), diameters.len());
    for (row, beside) in rows.iter().zip(found["largest_depths"].as_array().unwrap()) {
        assert_eq!(row["diameter_m"], beside["diameter_m"]);
        let numbers = |of: &Value| -> Vec<f64> {
            let list = of.as_array().unwrap().iter();
            list.map(|number| number.as_f64().unwrap()).collect()
        };
        let most = numbers(&beside["unknown"]["gamma"]);
        let classes = row["classes"].as_array().unwrap();
        assert_eq!(classes.len(), 43);
        assert_eq!(classes[0]["class"], "the maps hold");
        let holds = numbers(&classes[0]["gamma"]);
        for class in classes {
            let gamma = numbers(&class["gamma"]);
            assert_eq!(gamma.len(), depths.len());
            for ((gamma, most), holds) in gamma.iter().zip(&most).zip(&holds) {
                assert!(0.0 < *gamma && gamma <= holds && holds < most, "{class}");
            }
        }
    }
    let table = place().succeed(&format!("reach --bank bank.json {noise} --classes"));
    assert_has(&table, "gamma, 4.0 mm wide, ");
    assert_has(&table, "the surface is domed or dished");
    assert!(reach(noise).get("beside_classes").is_none());
}

// Verifies: CLI-234, BNK-082.
#[test]
fn along_a_path_every_pass_counts() {
    // Two passes over the positions of the bank, at the depth of its probe, have √2 times γ.
    let [one, two] = ["3", "3,3"].map(|depths| {
        reach(&format!(
            "--noise-sd-n 1 --known all --depths-mm {depths} --speed-mm-s 10 --rate-hz 10"
        ))
    });
    let gamma = |of: &Value| of["largest_depths"][0]["nothing_unknown"]["gamma"][0].clone();
    assert_near(&gamma(&two), 2f64.sqrt() * gamma(&one).as_f64().unwrap());
    // Of the map at −1 mm, which is the nearest to 0 with its mirror image.
    assert_near(&gamma(&one), self::gamma(&bank(), 0, false));
    assert_eq!(
        (&two["samples"], &two["probe_depth_m"]),
        (&34.into(), &Value::Null)
    );
    let path = "time_s,position_mm,depth_mm\n0,-8,3\n1.6,8,3\n";
    place().write("path.csv", path);
    assert_eq!(
        gamma(&reach("--noise-sd-n 1 --path path.csv --rate-hz 10")),
        gamma(&one)
    );
    let refusal = place().refused("reach --bank bank.json --noise-sd-n 1 --depths-mm 3 --to-mm 9");
    assert_has(
        &refusal,
        "position 8.1 mm at a depth of 3.0 mm is outside the maps",
    );
    assert_has(&refusal, "give a path over them");
    assert_eq!(
        reach("--noise-sd-n 1 --classes --depths-mm 3,3 --rate-hz 20")["samples"],
        66
    );
}
