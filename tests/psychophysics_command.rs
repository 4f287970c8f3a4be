//! `palpate psychophysics`, end to end.
#![cfg(feature = "cli")]

use std::fs;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::sync::OnceLock;

use serde_json::Value;

fn palpate(arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_palpate"));
    command.args(arguments).output().unwrap()
}

/// A folder with coarse maps over x ≥ 0, made once.
fn folder() -> &'static Path {
    static FOLDER: OnceLock<PathBuf> = OnceLock::new();
    FOLDER.get_or_init(|| {
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("psychophysics_command");
        fs::create_dir_all(&folder).unwrap();
        for phantom in ["none", "2.6", "4.6", "6.6", "8.6"] {
            let solved = palpate(&[
                "solve",
                "--phantom",
                phantom,
                "--depths-mm=4",
                "--laterals-mm=0:10:1",
                "--mesh-mm=2",
                "--format=json",
            ]);
            assert!(solved.status.success(), "{solved:?}");
            fs::write(folder.join(phantom), solved.stdout).unwrap();
        }
        folder
    })
}

fn json(arguments: &[&str]) -> Value {
    let output = palpate(&[&["psychophysics", "--format", "json"], arguments].concat());
    assert!(
        output.status.success() && output.stderr.is_empty(),
        "{output:?}"
    );
    serde_json::from_slice(&output.stdout).unwrap()
}

/// Reference and maps as arguments; the option that names a map is free.
fn maps(option: &str) -> Vec<String> {
    let file = |name: &str| folder().join(name).display().to_string();
    let mut arguments = vec!["--reference".into(), file("none")];
    for name in ["2.6", "4.6", "6.6", "8.6"] {
        arguments.extend([option.to_string(), format!("{name}={}", file(name))]);
    }
    arguments
}

fn borrowed(arguments: &[String]) -> Vec<&str> {
    arguments.iter().map(String::as_str).collect()
}

// Verifies: CLI-080, CLI-082.
#[test]
fn without_a_file_it_analyses_table_1() {
    let answer = json(&[]);
    assert_eq!(answer["schema"], "palpate-psychophysics");
    assert_eq!(answer["schema_version"], 1);
    assert_eq!(answer["counts"], "Table 1");
    assert!(answer["bridge"].is_null());
    let playback = &answer["analysis"]["conditions"][1];
    assert_eq!(playback["name"], "FEM data");
    let third = &playback["inclusions"][2];
    assert_eq!(
        (&third["pooled"]["correct"], &third["pooled"]["trials"]),
        (&253.into(), &300.into())
    );
    assert_eq!(third["depth_m"], 6.6e-3);
    // A subject who was always right: no upper end, as null.
    let gamma = &playback["subjects"][0]["rates"][0]["gamma"];
    assert!(gamma["upper"].is_null() && gamma["lower"].is_number());
    assert_eq!(
        answer["noise_levels"]["levels"].as_array().unwrap().len(),
        5
    );
    let text = palpate(&["psychophysics"]);
    let text = String::from_utf8(text.stdout).unwrap();
    assert!(text.contains("253/300") && text.contains("p is rough") && text.contains("235"));
}

// Verifies: CLI-081, CLI-082, CLI-083.
#[test]
fn maps_add_noise_and_predicted_shares() {
    let arguments = maps("--inclusion");
    let answer = json(&borrowed(&arguments));
    let bridge = &answer["bridge"];
    // x ≥ 0 completed by symmetry.
    assert_eq!(
        (&bridge["positions"], &bridge["from_m"]),
        (&21.into(), &(-0.01).into())
    );
    let playback = &bridge["conditions"][1];
    assert_eq!(playback["conventions"].as_array().unwrap().len(), 12);
    let noise = playback["noise_by_inclusion"][2]["noise_n"]
        .as_f64()
        .unwrap();
    let signal = playback["noise_by_inclusion"][2]["signal_n"]
        .as_f64()
        .unwrap();
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
    let other = maps("--map");
    assert_eq!(json(&borrowed(&other)), answer);
    let mut swept = arguments.clone();
    swept.extend(["--sweep-mm".into(), "5".into()]);
    let swept = json(&borrowed(&swept));
    assert_eq!(
        (&swept["bridge"]["positions"], &swept["bridge"]["to_m"]),
        (&11.into(), &0.005.into())
    );
    // Within the sweep that is asked for: ±3, ±4 and ±5 mm.
    assert_eq!(swept["bridge"]["weight_ranges"], 18);
    let arguments = [&["psychophysics"], &borrowed(&arguments)[..]].concat();
    let text = String::from_utf8(palpate(&arguments).stdout).unwrap();
    assert!(text.contains("peak, normal force less its mean") && text.contains("rejected"));
    assert!(
        text.contains("weight of the level") && text.contains("the lateral force in all 16 fits")
    );
}

// Verifies: CLI-080, CLI-084, CLI-085.
#[test]
fn a_file_of_counts_is_analysed_alone() {
    let path = folder().join("counts.csv");
    fs::write(
        &path,
        "subject,condition,trials,soft 3,soft 5\nme,gel,20,20,10\n",
    )
    .unwrap();
    let path = path.display().to_string();
    let answer = json(&[&path]);
    assert!(answer["noise_levels"].is_null());
    let condition = &answer["analysis"]["conditions"][0];
    assert!(condition["psychometric"].is_null() && condition["dispersion"].is_null());
    assert!(condition["inclusions"][0]["clustered"].is_null());
    assert_eq!(condition["inclusions"][1]["pooled"]["gamma"]["gamma"], 0.0);
    let text = String::from_utf8(palpate(&["psychophysics", &path]).stdout).unwrap();
    assert!(text.contains("no bound"), "{text}");
}

// Verifies: CLI-081, CLI-083, CLI-085.
#[test]
fn what_is_refused_is_named_in_one_line() {
    let bad = "subject,condition,trials,2.6\n1,gel,30,31\n";
    fs::write(folder().join("bad.csv"), bad).unwrap();
    for (arguments, message) in [
        (
            "bad.csv",
            "bad.csv:2: 2.6 = \"31\", expected a whole number from 0 to the 30 trials",
        ),
        ("missing.csv", "missing.csv"),
        ("--reference none", "--inclusion"),
        ("--inclusion 2.6=2.6", "--reference"),
        (
            "--reference none --inclusion 2.6=2.6",
            "1 inclusions with a map, expected at least two",
        ),
        (
            "--reference none --inclusion 2.6=2.6 --inclusion 3.1=2.6",
            "inclusion \"3.1\" is no column of the table",
        ),
        (
            "--reference none --inclusion 2.6=2.6 --inclusion 2.6=2.6",
            "has two maps",
        ),
        ("--reference none --inclusion 2.6", "expected NAME=FILE"),
        (
            "--reference none --inclusion 2.6=2.6 --inclusion 8.6=2.6 --sweep-mm 0",
            "expected mm above 0",
        ),
        (
            "--reference none --inclusion 2.6=2.6 --inclusion 8.6=2.6 --sweep-mm 0.5",
            "1 lateral positions within --sweep-mm, expected at least two",
        ),
        ("--sweep-mm 3", "--reference"),
    ] {
        let mut command = Command::new(env!("CARGO_BIN_EXE_palpate"));
        command.current_dir(folder()).arg("psychophysics");
        let output = command.args(arguments.split(' ')).output().unwrap();
        let said = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{arguments}: {said}");
        assert!(
            said.starts_with("palpate: ") && said.contains(message),
            "{said}"
        );
        assert_eq!(said.lines().count(), 1, "{said}");
        assert!(output.stdout.is_empty());
    }
}

// Verifies: CLI-004.
#[test]
fn a_reader_who_has_gone_away_is_no_error() {
    let mut child = Command::new(env!("CARGO_BIN_EXE_palpate"))
        .arg("psychophysics")
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    assert!(child.wait().unwrap().success());
    let mut said = String::new();
    child
        .stderr
        .take()
        .unwrap()
        .read_to_string(&mut said)
        .unwrap();
    assert_eq!(said, "");
}

// Verifies: CLI-008.
#[test]
fn a_file_without_an_end_is_refused() {
    let output = palpate(&["psychophysics", "/dev/zero"]);
    assert_eq!(output.status.code(), Some(2));
    let error = String::from_utf8(output.stderr).unwrap();
    assert!(
        error.contains("/dev/zero") && error.contains("256 MiB"),
        "{error}"
    );
    assert_eq!(error.lines().count(), 1);
}
