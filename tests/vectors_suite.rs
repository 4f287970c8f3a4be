//! The vectors are as their generator writes them, and the suite is sound, by the Python programs that come with it.
//! Where Python or mpmath is missing, a notice is given, unless `PALPATE_REQUIRE_WITNESSES=1` asks for them.

use std::collections::BTreeSet;

use crate::witness::printed;
use serde_json::{Value, json as value};

// Verifies: VEC-007.
#[test]
#[ignore = "takes three minutes; the suite's own check finds a file that is not of the manifest"]
fn the_files_are_as_the_generator_writes_them() {
    if let Some(text) = printed("vectors/generate.py", &["--check"]) {
        assert!(text.contains("files are as generated"), "{text}");
    }
}

// Verifies: VEC-001, VEC-003, VEC-004, VEC-005, VEC-008, VEC-011, VEC-014, VEC-016,
// VEC-018. The second route has the order of operations of VEC-011, Cowper's points as tables print them, and θ by projection.
#[test]
#[ignore = "slow, and rarely breaks"]
fn the_suite_is_sound() {
    if let Some(text) = printed("vectors/check.py", &[]) {
        assert!(text.contains(" 0 problems"), "{text}");
    }
}

// Verifies: VEC-014.
#[test]
fn a_suite_with_a_fault_is_not_sound() {
    let folder = format!("{}/vectors", crate::ROOT);
    if let Some(text) = printed("tests/vectors_suite/faults.py", &[&folder]) {
        assert_eq!(text, "12 faults found\n");
    }
}

fn json(path: &str) -> Value {
    let path = format!("{}/{path}", crate::ROOT);
    serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap()
}

fn cases(group: &str) -> Vec<Value> {
    let file = json(&format!("vectors/{group}.json"));
    file["cases"].as_array().unwrap().clone()
}

fn is_lower_hex(text: &str) -> bool {
    let digit = |c: char| c.is_ascii_digit() || ('a'..='f').contains(&c);
    text.chars().all(digit)
}

/// Checks each text under a key that ends in `_bits`, and counts them.
fn check_bits(value: &Value, key: &str) -> usize {
    match value {
        Value::Array(items) => items.iter().map(|item| check_bits(item, key)).sum(),
        Value::Object(members) => members
            .iter()
            .map(|(key, item)| check_bits(item, key))
            .sum(),
        Value::String(text) if key.ends_with("_bits") => {
            let digits = text.strip_prefix("0x").unwrap_or_default();
            assert!(digits.len() == 8 && is_lower_hex(digits), "{key}: {text}");
            1
        }
        _ => 0,
    }
}

// Verifies: VEC-019.
#[test]
fn a_list_that_is_cut_is_found() {
    let spec = include_str!("../spec/vectors.md");
    let (_, table) = spec
        .split_once("| op | argument | entries | cuts |\n|---|---|---|---|\n")
        .unwrap();
    let mut rows = 0;
    for row in table.lines().take_while(|line| line.starts_with('|')) {
        let cells = row.split('|').map(|cell| cell.trim_matches([' ', '`']));
        let cells: Vec<&str> = cells.collect();
        let [_, op, argument, entries, cuts, _] = cells[..] else {
            panic!("{row}");
        };
        let entries: usize = entries.parse().unwrap();
        let cuts = cuts.split(',').filter(|cut| !cut.is_empty()).count();
        let finds_cuts = |case: &Value| {
            let length = case["args"][argument].as_array().map_or(0, Vec::len);
            let shown = case["wrong"].to_string().matches("record_cut").count();
            !case["ok"].is_null() && length >= entries && shown >= cuts
        };
        assert!(cases(op).iter().any(finds_cuts), "{row}");
        rows += 1;
    }
    assert!(rows >= 12, "{rows}");
}

// Verifies: VEC-010. The cases that must be refused have other bits and bytes on purpose.
#[test]
fn bits_and_bytes_are_written_in_lower_case_hexadecimal() {
    for group in ["servo_axis", "servo_interpolate"] {
        let answered = cases(group)
            .into_iter()
            .filter(|case| !case["ok"].is_null());
        let parts = answered.map(|case| value!([case["args"], case["ok"], case["wrong"]]));
        let checked: usize = parts.map(|parts| check_bits(&parts, "")).sum();
        assert!(checked > 200, "{group}: {checked}");
    }
    for (group, part) in [("report_decode", "args"), ("report_encode", "ok")] {
        let answered = cases(group)
            .into_iter()
            .filter(|case| !case["ok"].is_null());
        let bytes: Vec<String> = answered
            .map(|case| case[part]["bytes"].as_str().unwrap().into())
            .collect();
        assert!(bytes.len() > 30, "{group}: {}", bytes.len());
        let sound = |text: &String| text.len().is_multiple_of(2) && is_lower_hex(text);
        assert!(bytes.iter().all(sound), "{group}");
    }
}

/// The names of a report's fields in the table of VEC-010.
fn fields_in_the_specification(report: u64) -> BTreeSet<String> {
    let spec = include_str!("../spec/vectors.md");
    let row = spec
        .lines()
        .find_map(|line| line.strip_prefix(&format!("| {report} | ")))
        .unwrap();
    let names = row.split('`').skip(1).step_by(2);
    names.map(String::from).collect()
}

// Verifies: VEC-010.
#[test]
fn reports_have_their_number_and_the_fields_of_the_table() {
    for (group, part) in [("report_decode", "ok"), ("report_encode", "args")] {
        let mut seen = BTreeSet::new();
        for case in cases(group) {
            if case["ok"].is_null() {
                continue;
            }
            let mut fields = case[part].as_object().unwrap().clone();
            let report = fields.remove("report").unwrap().as_u64().unwrap();
            let names: BTreeSet<String> = fields.keys().cloned().collect();
            assert_eq!(names, fields_in_the_specification(report), "{}", case["id"]);
            let whole = |value: &Value| value.is_i64() || value.is_u64();
            assert!(fields.values().all(whole), "{}", case["id"]);
            seen.insert(report);
        }
        assert!(seen.iter().eq(&[1, 2, 3, 4]), "{group}: {seen:?}");
    }
}

// Verifies: VEC-011.
#[test]
fn forces_come_from_another_program_with_its_band_and_ours() {
    for source in ["probe_force.py", "mesh.py"] {
        let path = format!("{}/vectors/probe_force/{source}", crate::ROOT);
        let text = std::fs::read_to_string(path).unwrap();
        // It computes in its own process: it starts no other program, and reads nothing of ours.
        for ours in [
            "subprocess",
            "os.system",
            "ctypes",
            "import palpate",
            "target/",
        ] {
            assert!(!text.contains(ours), "{source}: {ours}");
        }
    }
    let data = json("vectors/probe_force/forces.json");
    let poses = data["poses"].as_array().unwrap();
    let (mut compared, mut finite) = (0, 0);
    for case in cases("probe_force") {
        if case["ok"].is_null() {
            continue;
        }
        if case["args"]["strain"] == "finite" {
            finite += 1;
            of_the_table(&case);
            continue;
        }
        let mm = |key: &str| case["args"][key].as_f64().unwrap().abs() * 1e3;
        let near =
            |pose: &Value, key: &str, mm: f64| (pose[key].as_f64().unwrap() - mm).abs() < 1e-9;
        let pose = poses.iter().find(|pose| {
            pose["phantom"] == case["args"]["phantom"]
                && near(pose, "depth_mm", mm("depth_m"))
                && near(pose, "lateral_mm", mm("lateral_m"))
        });
        let newtons = |key: &str| pose.unwrap()[key].as_f64().unwrap() * 1e-3;
        // The data are for x ≥ 0.
        let side = case["args"]["lateral_m"].as_f64().unwrap().signum();
        let normal = newtons("normal_force_mn");
        let lateral = side * newtons("lateral_force_mn");
        let expected = [
            // VEC-011: 0.3 % of the normal force, 1.5 mN of the lateral.
            (
                "normal_force_n",
                normal,
                newtons("normal_band_mn") + 3e-3 * normal,
            ),
            (
                "lateral_force_n",
                lateral,
                newtons("lateral_band_mn") + 1.5e-3,
            ),
        ];
        for (key, force, tolerance) in expected {
            let found = case["ok"][key].as_f64().unwrap();
            // The decimals of the data are exact in mN; a product by 10⁻³ is off in the last place.
            let holds = (found - force).abs() < 1e-12;
            assert!(holds, "{}: {found} {force}", case["id"]);
            let allowed = case["tolerance"][key]["absolute"].as_f64().unwrap();
            // Bounds are rounded up to two digits.
            let ratio = allowed / tolerance;
            let holds = (1.0 - 1e-12..1.1).contains(&ratio);
            assert!(holds, "{}: {allowed} {tolerance}", case["id"]);
        }
        compared += 1;
    }
    assert!(compared >= 80 && finite == 4, "{compared} {finite}");
}

/// Checks a force at finite strain: the other program's of `tables/finite_strain.txt`, within 0.5 % and 3 mN.
fn of_the_table(case: &Value) {
    let number = |part: &str, key: &str| case[part][key].as_f64().unwrap();
    let lateral = 1e3 * number("args", "lateral_m");
    let disc = case["args"]["phantom"].as_str().unwrap();
    let start = format!("hyperelastic {disc} {lateral} ");
    let mut rows = include_str!("tables/finite_strain.txt").lines();
    let row = rows.find_map(|row| row.strip_prefix(&start)).unwrap();
    let forces: Vec<f64> = row.split(' ').map(|force| force.parse().unwrap()).collect();
    let expected = [
        ("lateral_force_n", forces[0], 3e-3),
        ("normal_force_n", forces[1], 5e-3 * forces[1]),
    ];
    for (key, force, tolerance) in expected {
        assert_eq!(number("ok", key), force, "{}", case["id"]);
        let ratio = case["tolerance"][key]["absolute"].as_f64().unwrap() / tolerance;
        assert!(
            (1.0 - 1e-12..1.1).contains(&ratio),
            "{}: {ratio}",
            case["id"]
        );
    }
}
