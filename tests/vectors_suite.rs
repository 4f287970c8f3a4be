//! The vectors are as their generator writes them, and the suite is sound, by the Python programs that come with it.
//! Where Python or mpmath is missing, a notice is given, unless `PALPATE_REQUIRE_WITNESSES=1` asks for them.

use std::collections::BTreeSet;
use std::io::ErrorKind;
use std::process::Command;

use crate::witness::present::present;
use serde_json::{Value, json as value};

/// Python with mpmath: the one of the environment, or the system's.
fn python() -> Command {
    Command::new(std::env::var_os("PALPATE_PYTHON").unwrap_or_else(|| "python3".into()))
}

/// What is missing, if anything is.
fn missing() -> Option<&'static str> {
    match python().args(["-c", "import mpmath"]).output() {
        Err(error) if error.kind() == ErrorKind::NotFound => Some("Python"),
        Ok(output) if String::from_utf8_lossy(&output.stderr).contains("ModuleNotFoundError") => {
            Some("mpmath")
        }
        _ => None,
    }
}

/// Runs a script of `vectors/`, which must succeed, and gives what it printed.
fn run(script: &str, arguments: &[&str]) -> Option<String> {
    if !present(missing()) {
        return None;
    }
    let path = format!("{}/vectors/{script}", crate::ROOT);
    let output = python()
        .args(["-B", &path])
        .args(arguments)
        .output()
        .unwrap();
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    let holds = output.status.success();
    assert!(
        holds,
        "{script}: {text}{}",
        String::from_utf8_lossy(&output.stderr)
    );
    Some(text)
}

// Verifies: VEC-007.
#[test]
#[ignore = "takes two minutes; the suite's own check finds a file that is not of the manifest"]
fn the_files_are_as_the_generator_writes_them() {
    if let Some(text) = run("generate.py", &["--check"]) {
        assert!(text.contains("files are as generated"), "{text}");
    }
}

// Verifies: VEC-001, VEC-003, VEC-004, VEC-005, VEC-008, VEC-011, VEC-014, VEC-016,
// VEC-018. The second route has the order of operations of VEC-011, Cowper's points as tables print them, and θ by projection.
#[test]
fn the_suite_is_sound() {
    if let Some(text) = run("check.py", &[]) {
        assert!(text.contains(" 0 problems"), "{text}");
    }
}

/// Plants a fault at a time in files of the suite, and prints what `check.py` says of each. `at` sets the number at the end of a path.
const FAULTS: &str = r#"
import copy, json, math, struct, sys
sys.path.insert(0, sys.argv[1])
import check

def at(*path):
    def plant(data):
        for key in path[:-2]:
            data = data[key]
        data[path[-2]] = path[-1]
    return plant

def answered(value):
    def plant(data):
        case = data["cases"][1]
        case["ok"]["p"], case["bits"]["p"] = value, "0x" + struct.pack(">d", value).hex()
    return plant

def route(data):
    check.check_second_route(data, 1, 0)

for name, plant, look in [
    ("normal_cdf", at("cases", 0, "other", 1), lambda data: check.check_form("normal_cdf.json", data)),
    ("normal_cdf", at("cases", 0, "id", "other-001"), lambda data: check.check_form("normal_cdf.json", data)),
    ("normal_cdf", at("cases", 0, "error", "failed"), lambda data: check.check_form("normal_cdf.json", data)),
    ("normal_cdf", at("cases", 0, "flags", ["unexplained"]), lambda data: check.check_flags("normal_cdf.json", data)),
    ("normal_cdf", at("cases", 0, "bits", "p", "0x3FE0000000000000"), check.check_numbers),
    ("normal_cdf", at("cases", 0, "wrong", 0, "ok", "p", math.nextafter(0.5, 1)), check.check_numbers),
    ("normal_cdf", at("cases", 0, "condition", "p", 7.9), check.check_conditions),
    ("normal_cdf", answered(0.6), route),
    ("normal_cdf", at("cases", 1, "condition", "p", 1e-9), route),
    ("requests", at("cases", 0, "error", "bad_request"), check.check_refusals),
    ("probe_force", at("cases", 0, "ok", "normal_force_n", 1.0), check.check_probe),
]:
    sound = json.loads((check.HERE / f"{name}.json").read_text())
    faulty = copy.deepcopy(sound)
    plant(faulty)
    for data in sound, faulty:
        check.problems.clear()
        look(data)
        print(*(check.problems[:1] or ["sound"]))
check.problems.clear()
check.check_manifest([])
print("sound", *check.problems[:1], sep="\n")
"#;

// Verifies: VEC-014.
#[test]
fn a_suite_with_a_fault_is_not_sound() {
    if !present(missing()) {
        return;
    }
    let folder = format!("{}/vectors", crate::ROOT);
    let output = python().args(["-B", "-c", FAULTS, &folder]).output();
    let output = output.unwrap();
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    let said: Vec<&str> = text.lines().collect();
    let faulty: Vec<&str> = said.iter().skip(1).step_by(2).copied().collect();
    let sound = said.iter().step_by(2).all(|said| *said == "sound");
    assert!(sound, "{output:?}");
    let expected = [
        "normal_cdf-001: keys of the case",
        "other-001: id",
        "normal_cdf-001: either args or line, and either ok or error",
        "normal_cdf.json: flags used and explained differ",
        "normal_cdf-001: bits of p",
        "normal_cdf-001: the wrong answer erf_for_phi is within ten tolerances",
        "normal_cdf-001: the condition of p is 7.9",
        "normal_cdf-002: p by the second route is",
        "normal_cdf-002: p with f32 arguments is",
        "requests-001: bad_json, or not",
        "probe_force-001: normal_force_n is not that of the data",
        "manifest.json: files: ",
    ];
    assert_eq!(faulty.len(), expected.len(), "{output:?}");
    for (said, expected) in faulty.iter().zip(expected) {
        assert!(
            said.starts_with(expected),
            "{said:?}: expected {expected:?}"
        );
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
    let mut compared = 0;
    for case in cases("probe_force") {
        if case["ok"].is_null() {
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
    assert!(compared >= 80, "{compared}");
}
