//! Many records at once.

use super::{MAPS, place};
use crate::program::text;
use palpate_asserts::assert_has;
use serde_json::Value;

const KNOWN: &str = "--depth-mm 3 --known smooth,surface,stage,tilt,friction,relaxation,walk";

/// A folder with two records, a file that is none, and one that is not meant.
fn folder() -> [&'static str; 2] {
    let [with, without] = ["with.csv", "without.csv"].map(|file| place().read(file));
    std::fs::create_dir_all(place().at("many")).unwrap();
    place().write("many/b wïth.csv", with);
    place().write("many/a,wïthout.CSV", without);
    place().write("many/c broken.csv", "position_mm,lateral_force_n\n0,1\n");
    place().write("many/notes.txt", "none");
    let machine = place().read("with.csv").replace("lateral_force_n", "Fx");
    place().write("machine.csv", machine);
    ["many/a,wïthout.CSV", "many/b wïth.csv"]
}

// Verifies: CLI-175, CLI-003.
#[test]
fn each_record_of_a_folder_is_judged_alone() {
    let files = folder();
    let command = format!("detect many {MAPS} {KNOWN}");
    let output = place().run(&format!("{command} --format json"));
    let (told, said) = (text(&output.stdout), text(&output.stderr));
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert_has(
        said,
        "many/c broken.csv:1: no column normal_force_n|palpate: refused: 1 of 3 files",
    );
    let lines: Vec<Value> = told
        .lines()
        .map(|line| serde_json::from_str(line).unwrap())
        .collect();
    assert_eq!(lines.len(), 3);
    // As each of them alone.
    for (line, file) in lines.iter().zip(["without.csv", "with.csv"]) {
        let alone = place().run(&format!("detect {file} {MAPS} {KNOWN} --format json"));
        let alone: Value = serde_json::from_slice(&alone.stdout).unwrap();
        for key in [
            "decision",
            "posterior_h1",
            "theta",
            "samples",
            "known",
            "noise_sd_normal_n",
            "warnings",
        ] {
            assert_eq!(line[key], alone[key], "{key}");
        }
    }
    assert_eq!([&lines[0]["trace"], &lines[1]["trace"]], files);
    assert_has(
        lines[2]["error"].as_str().unwrap(),
        "no column normal_force_n",
    );
    let figure = place().refused(&format!("{command} --figure many.svg"));
    assert_eq!(
        figure,
        "--figure draws one place; give one trace, or --together"
    );
    // The same in CSV and for people.
    let csv = place().run(&format!("{command} --format csv"));
    let csv: Vec<_> = text(&csv.stdout).lines().map(String::from).collect();
    assert_eq!(
        csv[0],
        "trace,decision,posterior_h1,theta,false_alarm,miss,causes,error"
    );
    let of = |line: &Value| {
        let number = |key: &str| line[key].to_string();
        ["posterior_h1", "theta", "false_alarm", "miss"]
            .map(number)
            .join(",")
    };
    assert_eq!(
        csv[1],
        format!(
            "\"many/a,wïthout.CSV\",{},{},,",
            "no_inclusion",
            of(&lines[0])
        )
    );
    assert_eq!(
        csv[2],
        format!("many/b wïth.csv,inclusion,{},,", of(&lines[1]))
    );
    assert!(
        csv[3].starts_with("many/c broken.csv,,,,,,,\"many/c broken.csv:1: no column"),
        "{}",
        csv[3]
    );
    let table = place().run(&command);
    let table: Vec<_> = text(&table.stdout).lines().map(String::from).collect();
    assert_eq!(
        table[0].trim_end(),
        "file                decision          posterior  explanation or causes"
    );
    assert!(
        table[1].starts_with("many/a,wïthout.CSV  no inclusion      0.0"),
        "{}",
        table[1]
    );
    assert!(
        table[2].starts_with("many/b wïth.csv     inclusion         "),
        "{}",
        table[2]
    );
    assert!(
        table[3].starts_with("many/c broken.csv   refused           -"),
        "{}",
        table[3]
    );
}

// Verifies: CLI-175, MAP-045.
#[test]
fn what_is_to_be_said_of_several_files_is_said_once() {
    folder();
    let output = place().run(&format!(
        "detect machine.csv with.csv machine.csv {MAPS} {KNOWN}"
    ));
    let expected =
        "palpate: note: machine.csv (and 1 more): column \"Fx\" is read as lateral_force_n\n";
    assert_eq!(text(&output.stderr), expected);
}

// Verifies: CLI-175.
#[test]
fn several_records_and_a_bank() {
    let output = place().run("detect with.csv without.csv with.csv --bank bank.json --format json");
    let lines = text(&output.stdout).lines();
    let lines: Vec<Value> = lines
        .map(|line| serde_json::from_str(line).unwrap())
        .collect();
    assert_eq!(lines.len(), 3);
    assert_eq!(lines[0], lines[2]);
    let alone = place().run("detect with.csv --bank bank.json --format json");
    let alone: Value = serde_json::from_slice(&alone.stdout).unwrap();
    for key in ["theta", "position", "several_inclusions"] {
        assert_eq!(
            (&lines[0][key], lines[0][key].is_null()),
            (&alone[key], false),
            "{key}"
        );
    }
    let undecided = lines
        .iter()
        .any(|line| line["decision"] == "cannot_be_judged");
    assert_eq!(output.status.code(), Some(if undecided { 3 } else { 0 }));
}

// Verifies: CLI-175. Friction and relaxation depend on where the probe began.
#[test]
fn a_sweep_the_other_way_is_judged_as_if_alone() {
    let with = place().read("with.csv");
    let mut lines: Vec<&str> = with.lines().collect();
    lines[2..].reverse();
    place().write("back.csv", lines.join("\n"));
    let thetas = |files: &str| -> Vec<Value> {
        let told = place().run(&format!("detect {files} {MAPS} --depth-mm 3 --format json"));
        let all = serde_json::Deserializer::from_slice(&told.stdout).into_iter::<Value>();
        all.map(|line| line.unwrap()["theta"].clone()).collect()
    };
    let alone = ["with.csv", "back.csv"].map(|file| thetas(file)[0].clone());
    assert_ne!(alone[0], alone[1]);
    assert_eq!(thetas("with.csv back.csv"), alone);
}

// Verifies: CLI-175.
#[test]
fn standard_input_is_a_record() {
    let mut piped = place().palpate(&format!("detect - {MAPS} {KNOWN} --format json"));
    piped.stdin(std::fs::File::open(place().at("with.csv")).unwrap());
    let piped = piped.output().unwrap();
    let found: Value = serde_json::from_slice(&piped.stdout).unwrap();
    let named = place().run(&format!("detect with.csv {MAPS} {KNOWN} --format json"));
    let named: Value = serde_json::from_slice(&named.stdout).unwrap();
    assert_eq!(
        (&found["trace"], &found["theta"]),
        (&"-".into(), &named["theta"])
    );
}
