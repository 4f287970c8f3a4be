//! All cases are asked, through crashes and silence.

use std::collections::BTreeSet;
use std::fs;
use std::process::Command;
use std::time::Instant;

use serde_json::{Value, json};

use crate::program::*;

// Verifies: ORA-040, ORA-048, ORA-049, ORA-057, ORA-069, ORA-075, VEC-011.
#[test]
fn our_oracle_passes_all_the_vectors_from_a_pipe_and_from_a_file() {
    let (folder, palpate) = (folder("ours"), palpate());
    // A pose at finite strain takes a while on a loaded machine.
    let piped = conform("--timeout-s 100 --format json", &[&palpate, "oracle"]);
    passes(&piped);
    assert!(piped.stderr.is_empty());
    let at = |words: &str| conform_at(&folder, words, &[]);
    passes(&at("questions --out q.jsonl"));
    let answer = |questions: &str| {
        sh(
            &folder,
            &format!("{questions} | '{palpate}' oracle >a.jsonl"),
        )
    };
    let started = Instant::now();
    answer("grep -av strain.:.finite q.jsonl");
    let seconds = started.elapsed().as_secs_f64();
    // Of a release build; a debug build on a loaded machine is some ten times slower.
    let most = if cfg!(debug_assertions) { 20.0 } else { 2.0 };
    assert!(seconds < most, "{seconds} s");
    answer("cat q.jsonl");
    let judged = at("judge q.jsonl a.jsonl --format json");
    passes(&judged);
    let vectors = concat!(env!("CARGO_MANIFEST_DIR"), "/..");
    let read = at(&format!(
        "judge q.jsonl a.jsonl --format json --vectors {vectors}"
    ));
    let same = "the vectors of the folder are those of the program";
    assert_eq!(stdout(&judged), stdout(&read), "{same}");
    let output = at("judge q.jsonl a.jsonl");
    passes(&output);
    let text = stdout(&output);
    let is_short = !text.contains("not right") && !text.contains("likely");
    assert!(is_short, "{text}");
    let [mut judged, mut piped] = [json_of(&judged), json_of(&piped)];
    let sum = judged["program"]["files"][0]["sha256"].take();
    assert_eq!(sum.as_str().map(str::len), Some(64));
    judged["program"] = Value::Null;
    piped["program"] = Value::Null;
    assert_eq!(judged, piped);
    let manifest = fs::read_to_string("../manifest.json").unwrap();
    let manifest: Value = serde_json::from_str(&manifest).unwrap();
    assert_eq!(judged["suite_sha256"], manifest["suite_sha256"]);
    let [cases, right] = ["cases", "right"].map(|count| total(&judged, count));
    assert_eq!([cases, right], [manifest["cases"].as_u64().unwrap(); 2]);
    assert!(cases >= 1500 && manifest["refused"].as_u64().unwrap() >= 250);
}

// Verifies: ORA-046, ORA-049.
#[test]
fn a_right_program_passes() {
    let palpate = palpate();
    run("right", &format!("exec '{palpate}' oracle"), &[]);
    run("right-by-line", &shell(""), &[]);
}

// Verifies: ORA-043, ORA-046.
#[test]
fn answers_that_are_none_are_failures_of_their_case() {
    for [test, answer, word] in rows(
        r#"
        empty | echo | no JSON
        text | echo hello | no JSON: hello
        nan | echo '{"id":"choice-002","ok":{"p_correct":NaN}}' | no JSON
        list | echo '[]' | id null
        no-id | echo '{"ok":{"p_correct":0.8413447460685429}}' | the id null
        other-id | echo '{"id":2,"ok":{"p_correct":0.8413447460685429}}' | id 2
        neither | echo '{"id":"choice-002"}' | either ok or error
        both | echo '{"id":"choice-002","ok":{},"error":{}}' | either ok or error
        ok-text | echo '{"id":"choice-002","ok":"0.84"}' | ok must be an object
        no-key | echo '{"id":"choice-002","ok":{"p":1}}' | p_correct is missing
        a-text | echo '{"id":"choice-002","ok":{"p_correct":"0.84"}}' | should be 0.8413447460685429
        a-list | echo '{"id":"choice-002","ok":{"p_correct":[0.8413447460685429]}}' | should be 0.8413447460685429
        refusal | echo '{"id":"choice-002","error":{"code":"x"}}' | refused
        no-error | echo '{"id":"choice-002","error":null}' | error must be an object with a code, not null
        nothing | : | no answer: the next one was for choice-003
        utf8 | printf '\377\n' | no JSON
        remark | echo remark; echo '{"id":"choice-002","ok":{}}' | no JSON: remark
        "#,
    ) {
        // A remark takes the place of the answer after it, which comes too late.
        let script = shell(&format!("*choice-002*) {answer};;"));
        run(&format!("none-{test}"), &script, &[("choice-002", word)]);
    }
}

// Verifies: ORA-044, ORA-045.
#[test]
fn a_crash_is_blamed_on_its_case_and_the_others_are_asked() {
    // It reads ahead, so that the answers before are not out yet when it dies.
    let palpate = palpate();
    let script = format!(
        "all=''; while IFS= read -r line; do case \"$line\" in *capabilities*) printf '%s\\n' \"$line\" | '{palpate}' oracle;;\n\
         *choice-002*) sleep 0.1; echo 'division by zero' >&2; exit 7;; *) printf '%s\\n' \"$line\" | '{palpate}' oracle;; esac; done"
    );
    let word = "exit status: 7; standard error: division by zero";
    run("crash", &script, &[("choice-002", word)]);
    // A program that dies of everything but the first question.
    let script = format!("read -r line; printf '%s\\n' \"$line\" | '{palpate}' oracle");
    let failures = CASES.map(|case| (case, "ended without an answer"));
    run("dies", &script, &failures);
}

// Verifies: ORA-044, ORA-045, ORA-079.
#[test]
fn cases_that_were_open_together_are_asked_again_alone() {
    // It dies of two lines at a time, so that it must be started again, once.
    let palpate = palpate();
    let script = format!(
        "echo start >>starts; while :; do sleep 0.1; lines=$(dd bs=65536 count=1 2>/dev/null)\n\
         case \"$lines\" in '') exit 0;; *'\n'*) exit 7;; esac; printf '%s\\n' \"$lines\" | '{palpate}' oracle; done"
    );
    // No case is to blame, and the program does not pass.
    let output = ask(&write("alone", &vectors()), "--format json", &script);
    fails(&output, 1, "stopped before the end of its input");
    let verdict = json_of(&output);
    assert_eq!(total(&verdict, "right"), 4, "{verdict}");
    let starts = folder_of("alone").join("starts");
    let starts = fs::read_to_string(starts).expect("the program was started");
    assert!(starts.lines().count() <= 2, "{starts}");
}

/// Nine cases like the one with this number.
fn nine_of(number: usize) -> Value {
    let mut many = vectors();
    let case = many["cases"][number].clone();
    let cases = (0..9).map(|index| {
        let mut case = case.clone();
        case["id"] = json!(format!("choice-1{index:02}"));
        case
    });
    many["cases"] = cases.collect();
    let flags = many["flags"].as_object_mut().expect("flags");
    let shown = case["flags"].as_array().expect("a list");
    flags.retain(|flag, _| shown.contains(&json!(flag)));
    many
}

// Verifies: ORA-048, ORA-079.
#[test]
fn a_program_that_stops_before_the_end_of_its_input_fails_and_the_verdict_says_how() {
    let folder = write("stops", &nine_of(2));
    fs::write(folder.join("known"), "choice-107 crashes\n").expect("written");
    let refusing = |first: &str| refusing("\"two_afc\"", first);
    let killed = refusing("[ $answered -lt 6 ] || kill -SEGV $$");
    let silent = refusing("[ $answered -lt 6 ] || exec sleep 60");
    let crashes = refusing("case $id in choice-107) exit 7;; esac");
    let hangs_up = refusing("") + "; exit 3";
    for (options, script, stops, note) in [
        ("", &killed, 1, "signal: 11"),
        ("--timeout-s 2", &silent, 1, "no answer within 2 s"),
        // What is accepted, or permitted, is a finding that does not count; the stops count.
        ("--accept known", &crashes, 2, "exit status: 7"),
        ("--require range", &crashes, 2, "exit status: 7"),
        ("", &hangs_up, 0, "at the end of its input: exit status: 3"),
    ] {
        let at = |format: &str| ask(&folder, &format!("{options} --format {format}"), script);
        let output = at("json");
        let verdict = json_of(&output);
        let failure = format!("stopped before the end of its input, stops: {stops}");
        match stops {
            0 => passes(&output),
            _ => fails(&output, 1, &failure),
        }
        assert_eq!(verdict["stops"], stops, "{verdict}");
        assert_eq!(verdict["passed"], stops == 0);
        let notes = verdict["notes"].as_array().expect("notes");
        assert!(
            notes.len() == 1 && notes[0].to_string().contains(note),
            "{notes:?}"
        );
        for format in ["table", "html"] {
            let output = at(format);
            assert!(stdout(&output).contains(note), "{output:?}");
        }
        let failures = stdout(&at("junit")).matches("<failure").count();
        assert_eq!(failures, usize::from(stops > 0));
    }
}

// Verifies: ORA-044, ORA-045.
#[test]
fn silence_is_blamed_on_its_case_and_the_others_are_asked() {
    // In this time a loaded machine starts the oracle, which the shell does for each line.
    let script = shell("*choice-003*) exec sleep 60;;");
    let failures = [("choice-003", "no answer within 2 s")];
    run_within("2", "silence", &script, &failures);
    // After six silences the rest is not asked.
    let (folder, script) = (
        write("silent", &nine_of(0)),
        shell("*choice*) exec sleep 60;;"),
    );
    let output = ask(&folder, "--timeout-s 0.5", &script);
    fails(&output, 1, "9 of 9 cases failed");
    assert!(stdout(&output).contains("silent 6 times"), "{output:?}");
}

// Verifies: ORA-042, ORA-049.
#[test]
fn a_program_that_does_not_answer_capabilities_is_refused() {
    for [script, word] in rows(
        r#"
        exit 4 | exit status: 4
        exec sleep 5 | no answer within 0.3 s
        yes garbage | answered "garbage"
        yes '{"id":"capabilities","ok":{}}' | answered
        echo '{"id":1,"ok":{"version":"1","ops":[]}}' | answered
        cat | answered
        cat </dev/zero | the program
        "#,
    ) {
        let output = conform("--timeout-s 0.3", &["sh", "-c", script]);
        fails(&output, 1, &format!("{word}, it must answer"));
        assert!(output.stdout.is_empty());
    }
}

// Verifies: ORA-043, ORA-044.
#[test]
fn a_flood_ends() {
    let claims = r#"echo '{"id":"capabilities","ok":{"version":"1","ops":["two_afc"]}}'"#;
    let script = format!("{claims}; exec yes garbage");
    let failures = CASES.map(|case| (case, "no JSON: garbage"));
    run("garbage", &script, &failures);
    // Answers without end to what is judged already are no sign of life.
    let script =
        format!("{claims}; exec yes '{{\"id\":\"choice-001\",\"ok\":{{\"p_correct\":0.5}}}}'");
    let silent = [1, 2, 3].map(|case| (CASES[case], "no answer within"));
    run_within("0.3", "repeats", &script, &silent);
}

// Verifies: ORA-048, ORA-049.
#[test]
fn what_is_not_claimed_is_skipped_and_nothing_is_no_verdict() {
    let claims = |ops: &str| {
        format!(
            "echo '{{\"id\":\"capabilities\",\"ok\":{{\"version\":\"1\",\"ops\":[{ops}]}}}}'; cat >/dev/null"
        )
    };
    let folder = write("claims-nothing", &vectors());
    let output = ask(&folder, "--format json", &claims(""));
    fails(&output, 1, "nothing checked");
    let verdict = json_of(&output);
    assert_eq!(total(&verdict, "skipped"), 4);
    assert_eq!(verdict["passed"], false);
    let program = claims("\"three_afc\"");
    fails(&ask(&folder, "", &program), 1, "nothing checked, two_afc");
    // The lines that everybody must refuse are asked, and not answered here.
    let output = conform("--timeout-s 0.2", &["sh", "-c", &program]);
    fails(&output, 1, "nothing checked");
}

// Verifies: ORA-040, ORA-049.
#[test]
fn wrong_command_lines_are_refused() {
    let folder = write("usage", &vectors());
    fs::create_dir(folder.join("empty")).expect("a folder");
    for [options, program, word] in rows(
        r#"
        --only choices | true | "choices"
        --vectors /no/such/folder | true | /no/such/folder
        --vectors empty | true | no vectors
        --timeout-s 0 | true | 0.01 to 86400
        --timeout-s nan | true | 0.01 to 86400
        --vectors . | /no/such/program | cannot start /no/such/program
        --vectors . |  | CMD
        "#,
    ) {
        let program: Vec<&str> = program.split_whitespace().collect();
        fails(&conform_at(&folder, options, &program), 2, word);
    }
}

/// Few enough crates, none of them of the solver, the device or the plots.
// Verifies: ORA-070.
#[test]
fn the_program_stands_on_few_crates() {
    let words = "tree --offline -p palpate-conform -e normal,build --prefix none";
    let mut tree = Command::new(env!("CARGO"));
    let tree = tree.args(words.split(' ')).output().expect("cargo starts");
    let lines = stdout(&tree).lines();
    let crates: BTreeSet<&str> = lines.filter_map(|line| line.split(' ').next()).collect();
    let is_few = crates.contains("serde_json") && crates.len() <= 30;
    assert!(is_few && !crates.contains("palpate"), "{crates:?}");
}
