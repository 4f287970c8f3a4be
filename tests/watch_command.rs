//! `palpate watch`, end to end, in pipes.

use std::fs::File;
use std::io::{BufRead, BufReader, Write};
use std::process::{Child, ChildStdin, ChildStdout, Stdio};
use std::sync::OnceLock;

use crate::program::{Place, send, text};
use palpate_asserts::assert_has;
use serde_json::{Value, json};

/// The folder with a bank of a coarse mesh and two sweeps, made once.
fn place() -> &'static Place {
    static PLACE: OnceLock<Place> = OnceLock::new();
    PLACE.get_or_init(|| {
        let place = Place::new("watch_command");
        place.succeed(
            "bank --phantom 4.6 --offsets-mm=-4:4:2 --depths-mm 3.6,4.6 --probe-depth-mm 4 --laterals-mm=-8:8:1 --mesh-mm 2 --out bank.json",
        );
        place.succeed("demo demo");
        place
    })
}

const WATCH: &str = "watch --bank bank.json --noise-sd-n 0.1";

fn start(line: &str) -> Child {
    let mut command = place().palpate(line);
    let piped = command.stdin(Stdio::piped()).stdout(Stdio::piped());
    piped.stderr(Stdio::piped()).spawn().unwrap()
}

/// The lines of JSON, the exit code and what is on standard error, for an input.
fn watched(line: &str, input: &str) -> (Vec<Value>, i32, String) {
    let mut child = start(line);
    let mut pipe = child.stdin.take().unwrap();
    let input = input.to_owned();
    let writer = std::thread::spawn(move || {
        // A program that refuses a line does not read the rest.
        let _ = pipe.write_all(input.as_bytes());
    });
    let output = child.wait_with_output().unwrap();
    writer.join().unwrap();
    let answers = text(&output.stdout).lines();
    let answers = answers.map(|line| serde_json::from_str(line).unwrap());
    (
        answers.collect(),
        output.status.code().unwrap(),
        text(&output.stderr).into(),
    )
}

/// The rows of a sweep below its header.
fn sweep(name: &str) -> String {
    place().read(&format!("demo/{name}.csv"))
}

fn detected(name: &str) -> Value {
    let line = format!(
        "detect demo/{name}.csv --model exact --bank bank.json --noise-sd-n 0.1 --known depth,variance --format json"
    );
    serde_json::from_str(&place().succeed(&line)).unwrap()
}

// Verifies: SEQ-025, CLI-183, CLI-184.
#[test]
fn the_last_answer_is_that_of_detect() {
    for (name, decision) in [
        ("sweep-with", "inclusion"),
        ("sweep-without", "no_inclusion"),
    ] {
        let (answers, code, error) = watched(WATCH, &sweep(name));
        assert_eq!((answers.len(), code, &*error), (402, 0, ""), "{name}");
        let (last, before) = (&answers[401], &answers[400]);
        let batch = detected(name);
        for (live, of_batch) in [("theta", "theta_mixture"), ("posterior_h1", "posterior_h1")] {
            let [live, of_batch] = [&last[live], &batch[of_batch]].map(|of| of.as_f64().unwrap());
            assert!((live - of_batch).abs() < 1e-9, "{name}: {live} {of_batch}");
        }
        assert_eq!(
            (&last["decision"], &batch["decision"]),
            (&json!(decision), &json!(decision))
        );
        assert_eq!(
            (&last["schema"], &last["is_last"], &before["is_last"]),
            (&json!("palpate-watch"), &json!(true), &json!(false))
        );
        for key in [
            "samples",
            "theta",
            "posterior_h1",
            "decision",
            "decided_at_sample",
            "likeliest",
        ] {
            assert_eq!(last[key], before[key], "{key}");
        }
        assert_eq!(
            (&last["places"], &last["covered"], &last["samples"]),
            (&json!(10), &json!(10), &json!(401))
        );
        // The first with a decision, and none before it.
        let decided = last["decided_at_sample"].as_u64().unwrap() as usize;
        assert!(decided > 10 && decided < 300, "{name}: {decided}");
        assert!(
            answers[..decided - 1]
                .iter()
                .all(|answer| answer["decision"].is_null())
        );
        assert_eq!(answers[decided - 1]["samples"], decided);
        // (2.326 + 1.645)², and ln 100 and ln 20.
        let near = |found: &Value, expected: f64| {
            assert!((found.as_f64().unwrap() - expected).abs() < 1e-3, "{found}")
        };
        near(&last["fixed_length_gamma_squared"], 15.7704);
        let (a, b) = (0.01 * 0.95 / 0.9995, 0.05 * 0.99 / 0.9995);
        let [upper, lower] = [4.605170, -2.995732];
        near(
            &last["mean_gamma_squared"][0],
            -2.0 * (a * upper + (1.0 - a) * lower),
        );
        near(
            &last["mean_gamma_squared"][1],
            2.0 * ((1.0 - b) * upper + b * lower),
        );
    }
}

// Verifies: SEQ-021, SEQ-023, CLI-184.
#[test]
fn a_sensor_set_to_zero_tells_an_inclusion_but_never_that_there_is_none() {
    let line = format!("{WATCH} --zeroed");
    let (answers, code, error) = watched(&line, &sweep("sweep-without"));
    let last = &answers[answers.len() - 1];
    assert_eq!((code, &last["decision"]), (3, &Value::Null), "{last}");
    assert_eq!(last["causes"], json!(["zeroed"]));
    assert_eq!(
        (&last["covered"], &last["excluded"]),
        (&json!(10), &json!(0))
    );
    assert_has(
        &error,
        "palpate: -: cannot be judged: a sensor that was set to zero on the gel",
    );
    let (answers, code, error) = watched(&line, &sweep("sweep-with"));
    let last = &answers[answers.len() - 1];
    assert_eq!((code, &*error), (0, ""));
    assert_eq!(last["decision"], "inclusion");
}

// Verifies: CLI-182, SEQ-024.
#[test]
fn csv_and_json_say_the_same_and_gaps_are_counted() {
    let csv = sweep("sweep-with");
    let rows = csv
        .lines()
        .filter(|line| !line.starts_with('#'))
        .skip(1)
        .take(80);
    let json: Vec<String> = rows
        .map(|row| {
            let fields: Vec<f64> = row.split(',').map(|field| field.parse().unwrap()).collect();
            let header = csv
                .lines()
                .find(|line| line.starts_with("position_mm"))
                .unwrap();
            let pairs = header
                .split(',')
                .zip(fields)
                .map(|(key, value)| (key.to_string(), json!(value)));
            Value::Object(pairs.collect()).to_string()
        })
        .collect();
    let (of_json, code, _) = watched(WATCH, &json.join("\n"));
    let above: Vec<&str> = csv
        .lines()
        .take(
            csv.lines()
                .position(|line| line.starts_with("position_mm"))
                .unwrap()
                + 81,
        )
        .collect();
    let (of_csv, _, error) = watched(WATCH, &above.join("\n"));
    assert_eq!((of_json.len(), code), (81, 3));
    assert_eq!(of_json, of_csv);
    assert_has(
        &error,
        "palpate: -: undecided: an inclusion is not excluded at ",
    );
    let gaps = "position_mm,lateral_force_n,normal_force_n\n0,,1\n0,0,nan\n8.1,0,1\n";
    let (answers, code, _) = watched(WATCH, gaps);
    let last = answers.last().unwrap();
    assert_eq!(
        (
            answers.len(),
            code,
            &last["samples"],
            &last["missing"],
            &last["outside"]
        ),
        (4, 3, &json!(0), &json!(2), &json!(1))
    );
    assert_eq!(
        (
            &last["posterior_h1"],
            &last["likeliest"],
            &last["open_positions_m"].as_array().unwrap().len()
        ),
        (&json!(0.5), &Value::Null, &5)
    );
}

/// A program that runs, its input, and its output line by line.
fn running(line: &str) -> (Child, ChildStdin, BufReader<ChildStdout>) {
    let mut child = start(line);
    let (input, output) = (child.stdin.take().unwrap(), child.stdout.take().unwrap());
    (child, input, BufReader::new(output))
}

fn next(output: &mut impl BufRead) -> Value {
    let mut line = String::new();
    output.read_line(&mut line).unwrap();
    serde_json::from_str(&line).unwrap_or_else(|error| panic!("{line:?}: {error}"))
}

// Verifies: CLI-183, CLI-184.
#[test]
fn an_answer_follows_each_sample_at_once_and_a_signal_ends_it_with_the_last() {
    let (mut child, mut input, mut output) = running(WATCH);
    writeln!(input, "position_mm,normal_force_n").unwrap();
    for (number, position) in (1..).zip([0.0, 0.5, 1.0]) {
        writeln!(input, "{position},1.5").unwrap();
        let answer = next(&mut output);
        assert_eq!(
            (&answer["samples"], &answer["is_last"]),
            (&json!(number), &json!(false))
        );
    }
    // The input stays open.
    send("INT", &child);
    let answer = next(&mut output);
    assert_eq!(
        (&answer["samples"], &answer["is_last"]),
        (&json!(3), &json!(true))
    );
    assert_eq!(child.wait().unwrap().code(), Some(3));
    drop(input);
}

// Verifies: CLI-003, CLI-183.
#[test]
fn a_reader_that_goes_away_ends_it_quietly() {
    let (child, mut input, mut output) = running(WATCH);
    writeln!(input, "position_mm,normal_force_n\n0,1.5").unwrap();
    assert_eq!(next(&mut output)["samples"], 1);
    drop(output);
    writeln!(input, "0.5,1.5").unwrap();
    let ended = child.wait_with_output().unwrap();
    assert_eq!((ended.status.code(), text(&ended.stderr)), (Some(0), ""));
}

// Verifies: CLI-183.
#[test]
fn an_answer_that_is_not_due_is_left_out_but_for_decisions_and_the_last() {
    let (answers, ..) = watched(
        &format!("{WATCH} --every-ms 10000000"),
        &sweep("sweep-with"),
    );
    let samples: Vec<_> = answers
        .iter()
        .map(|answer| answer["samples"].as_u64().unwrap())
        .collect();
    let decided = answers[1]["decided_at_sample"].as_u64().unwrap();
    assert_eq!(samples, [1, decided, 401]);
}

// Verifies: CLI-182, CLI-184.
#[test]
fn what_cannot_be_watched_is_refused_after_what_could() {
    let header = "position_mm,normal_force_n\n";
    for (line, input, answers, expected) in [
        (WATCH, "", 0, "-: standard input has no samples"),
        (
            WATCH,
            "time_s,normal_force_n\n1,2\n",
            0,
            "-:1: no column position_mm or position_m",
        ),
        (
            WATCH,
            &format!("{header}0,1\n0,x\n0,1\n"),
            1,
            "-:3: normal_force_n = \"x\"",
        ),
        (
            WATCH,
            &format!("{header}0,1e60\n"),
            0,
            "-:2: normal force over its noise is",
        ),
        (
            "watch --bank bank.json",
            header,
            0,
            "the noise cannot be estimated",
        ),
        (
            &format!("{WATCH} --max-false-alarm 0.6 --max-miss 0.6"),
            header,
            0,
            "max_false_alarm + max_miss is 1.2",
        ),
        (
            "watch --bank no.json --noise-sd-n 1",
            header,
            0,
            "no.json: cannot be read",
        ),
        (
            &format!("{WATCH} --figure no/such.svg"),
            &format!("{header}0,1\n"),
            2,
            "write no/such.svg: ",
        ),
    ] {
        let (found, code, error) = watched(line, input);
        assert_eq!(
            (found.len(), code, error.lines().count()),
            (answers, 2, 1),
            "{line}: {error}"
        );
        assert!(
            error.starts_with(&format!("palpate: {expected}")),
            "{error}"
        );
    }
}

// Verifies: CLI-003, CLI-184.
#[cfg(unix)]
#[test]
fn an_input_that_cannot_be_read_is_not_one_that_ended() {
    let folder = File::open(place().at("")).unwrap();
    let output = place().palpate(WATCH).stdin(folder).output().unwrap();
    let expected = "palpate: -: cannot be read: Is a directory (os error 21)\n";
    assert_eq!(
        (output.status.code(), text(&output.stderr)),
        (Some(2), expected)
    );
}

// Verifies: CLI-233, SEQ-026, SEQ-022.
#[test]
fn the_figure_shows_what_half_a_sweep_has_told() {
    let text = sweep("sweep-without");
    let half: String = text
        .lines()
        .take(180)
        .map(|line| format!("{line}\n"))
        .collect();
    let (answers, ..) = watched(&format!("{WATCH} --figure half.svg"), &half);
    let last = &answers[answers.len() - 1];
    let count = |key: &str| last[key].as_u64().unwrap();
    let [places, covered, excluded] = ["places", "covered", "excluded"].map(count);
    // Five positions at two depths; the sweep ends at −0.84 mm, so that it tells of what lies left and nothing of what lies right.
    assert_eq!(places, 10);
    assert!(
        excluded > 0 && excluded < covered && covered < places,
        "{last}"
    );
    let [uncovered, open] = [places - covered, covered - excluded];
    let figure = place().read("half.svg");
    let words = format!(
        "Of 10 places, not covered by the path: {uncovered}, an inclusion is not excluded: {open}, an inclusion is excluded: {excluded}."
    );
    assert_has(&figure, &words);
    // A dot for each place, and one in the key for each kind.
    assert_eq!(figure.matches("<circle").count() as u64, places + 3);
}
