//! `palpate-conform` against programs that answer rightly, wrongly, late, or not at all: `spec/oracle.md`.

#[path = "../../../tests/witness/present.rs"]
mod present;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use present::present;
use serde_json::{Value, json};

/// The program itself, which stands beside this package's; `cargo test --workspace` builds both.
fn palpate() -> String {
    let program = Path::new(env!("CARGO_BIN_EXE_palpate-conform")).with_file_name("palpate");
    assert!(program.exists(), "first: cargo build -p palpate");
    program.into_os_string().into_string().expect("UTF-8")
}

/// A folder of its own for each test, emptied at the start.
fn folder(test: &str) -> PathBuf {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("conform-{test}"));
    let _ = fs::remove_dir_all(&path);
    fs::create_dir_all(&path).expect("a folder for the test");
    path
}

fn conform(options: &[&str], program: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_palpate-conform"));
    command.args(options).arg("--").args(program);
    command.output().expect("the program starts")
}

fn stdout(output: &Output) -> &str {
    std::str::from_utf8(&output.stdout).expect("UTF-8")
}

/// The one line of an error.
fn error(output: &Output) -> &str {
    let text = std::str::from_utf8(&output.stderr).expect("UTF-8");
    assert_eq!(text.lines().count(), 1, "{text}");
    text.trim_end()
}

/// A file of four cases: ½, Φ(1), a refusal, and a whole line to be refused.
fn vectors() -> Value {
    // Φ(√2/√2), by mpmath.
    let one = 0.8413447460685429_f64;
    json!({
        "schema": "palpate-vectors", "schema_version": 1, "group": "choice", "op": "two_afc", "source": "by hand",
        "generator_version": "1.0.0", "tolerance": {"p_correct": {"ulp": 2, "reason": "a test"}},
        "flags": {
            "complement": {"bug": "the rate of wrong answers", "notes": "p for 1 - p"},
            "negative": {"bug": "a negative gamma is accepted", "notes": ""},
            "no_json": {"bug": "a line that is no JSON is answered", "notes": ""},
        },
        "cases": [
            {"id": "choice-001", "comment": "no signal", "args": {"gamma": 0}, "ok": {"p_correct": 0.5},
             "bits": {"p_correct": "0x3fe0000000000000"}, "flags": []},
            {"id": "choice-002", "comment": "root 2", "args": {"gamma": std::f64::consts::SQRT_2}, "ok": {"p_correct": one},
             "bits": {"p_correct": format!("{:#018x}", one.to_bits())}, "flags": ["complement"],
             "wrong": [{"flag": "complement", "ok": {"p_correct": 1.0 - one}}]},
            {"id": "choice-003", "comment": "below 0 <&>", "args": {"gamma": -1}, "error": "out_of_range", "flags": ["negative"]},
            {"id": "choice-004", "comment": "no JSON", "line": "{\"id\":\"choice-004\",\"op\":", "error": "bad_json", "flags": ["no_json"]},
        ],
    })
}

fn write(folder: &Path, vectors: &Value) -> String {
    fs::write(folder.join("choice.json"), vectors.to_string()).expect("written");
    folder.display().to_string()
}

/// A shell that answers each line by the oracle, but for what `special` cases do: patterns of `case`.
fn shell(special: &str) -> String {
    let palpate = palpate();
    format!(
        "while IFS= read -r line; do case \"$line\" in\n{special}\n*) printf '%s\\n' \"$line\" | '{palpate}' oracle;;\nesac; done"
    )
}

/// The verdict on a shell program, its exit code, and the reason of each failed case.
struct Found {
    code: Option<i32>,
    verdict: Value,
    reasons: Vec<(String, String)>,
}

fn run(test: &str, script: &str, timeout: &str) -> Found {
    let vectors = write(&folder(test), &vectors());
    let options = [
        "--vectors",
        &vectors,
        "--format",
        "json",
        "--timeout-s",
        timeout,
    ];
    let output = conform(&options, &["sh", "-c", script]);
    let verdict: Value =
        serde_json::from_slice(&output.stdout).unwrap_or_else(|e| panic!("{e}: {output:?}"));
    let text = |failure: &Value, key: &str| failure[key].as_str().unwrap().to_string();
    let failures = verdict["failures"].as_array().unwrap();
    let reasons = failures
        .iter()
        .map(|f| (text(f, "case"), text(f, "reason")))
        .collect();
    let code = output.status.code();
    Found {
        code,
        verdict,
        reasons,
    }
}

impl Found {
    /// Asserts that just these cases failed, each for a reason with this word.
    #[track_caller]
    fn expect(&self, failures: &[(&str, &str)]) {
        assert_eq!(
            self.code,
            Some(i32::from(!failures.is_empty())),
            "{}",
            self.verdict
        );
        assert_eq!(self.reasons.len(), failures.len(), "{:?}", self.reasons);
        for ((case, reason), (wanted, word)) in self.reasons.iter().zip(failures) {
            assert!(
                case == wanted && reason.contains(word),
                "{case}: {reason}, not {wanted}: {word}"
            );
        }
    }
}

// Verifies: ORA-040, ORA-048, ORA-049, VEC-011.
#[test]
fn our_oracle_passes_all_the_vectors_that_the_program_carries() {
    let output = conform(&[], &[&palpate(), "oracle"]);
    assert_eq!(output.status.code(), Some(0), "{}", stdout(&output));
    assert!(output.stderr.is_empty());
    let text = stdout(&output);
    assert!(
        !text.contains("failed\n ") && !text.contains("likely"),
        "{text}"
    );
    let carried = conform(&["--format", "json"], &[&palpate(), "oracle"]);
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/..");
    let read = conform(
        &["--format", "json", "--vectors", folder],
        &[&palpate(), "oracle"],
    );
    assert_eq!(
        stdout(&carried),
        stdout(&read),
        "the vectors of the folder are those of the program"
    );
    let verdict: Value = serde_json::from_slice(&carried.stdout).unwrap();
    let manifest: Value =
        serde_json::from_str(&fs::read_to_string(format!("{folder}/manifest.json")).unwrap())
            .unwrap();
    assert_eq!(verdict["suite_sha256"], manifest["suite_sha256"]);
    let total = |key: &str| -> u64 {
        verdict["groups"]
            .as_array()
            .unwrap()
            .iter()
            .map(|group| group[key].as_u64().unwrap())
            .sum()
    };
    assert_eq!(total("cases"), manifest["cases"].as_u64().unwrap());
    assert_eq!(total("refused"), manifest["refused"].as_u64().unwrap());
    assert_eq!(total("passed") + total("refused"), total("cases"));
    assert!(total("cases") >= 1500 && total("refused") >= 250);
}

// Verifies: ORA-046, ORA-049.
#[test]
fn a_right_program_passes() {
    let palpate = palpate();
    run("right", &format!("exec '{palpate}' oracle"), "20").expect(&[]);
    run("right-by-line", &shell(""), "20").expect(&[]);
}

// Verifies: ORA-047.
#[test]
fn wrong_answers_name_their_bug() {
    let answer = r#"echo '{"id":"choice-002","ok":{"p_correct":0.15865525393145707,"more":1}}';;"#;
    let found = run("wrong", &shell(&format!("*choice-002*) {answer}")), "20");
    found.expect(&[("choice-002", "expected 0.8413447460685429 within 2 ulp")]);
    assert_eq!(
        found.verdict["likely_bugs"],
        json!([{"flag": "complement", "group": "choice", "bug": "the rate of wrong answers", "notes": "p for 1 - p",
                "cases": 1, "first_case": "choice-002"}])
    );
    // A wrong answer that is no known bug's names none.
    let found = run(
        "odd",
        &shell("*choice-002*) echo '{\"id\":\"choice-002\",\"ok\":{\"p_correct\":0.5}}';;"),
        "20",
    );
    found.expect(&[("choice-002", "p_correct is 0.5")]);
    assert_eq!(found.verdict["likely_bugs"], json!([]));
    // What is not refused names the flags of the case.
    let found = run(
        "accepts",
        &shell("*choice-003*) echo '{\"id\":\"choice-003\",\"ok\":{\"p_correct\":0.2}}';;"),
        "20",
    );
    found.expect(&[("choice-003", "must be refused")]);
    assert_eq!(found.verdict["likely_bugs"][0]["flag"], "negative");
}

// Verifies: ORA-052.
#[test]
fn an_error_without_a_code_is_no_refusal() {
    for error in ["null", "false", r#""no""#, "[]", "{}", r#"{"code":null}"#] {
        let answer = format!("*choice-003*) echo '{{\"id\":\"choice-003\",\"error\":{error}}}';;");
        let word = format!("error is {error}, expected an object with a code");
        run("no-refusal", &shell(&answer), "20").expect(&[("choice-003", &word)]);
    }
    let answer = r#"*choice-003*) echo '{"id":"choice-003","error":{"code":"own"}}';;"#;
    run("refusal-of-its-own", &shell(answer), "20").expect(&[]);
}

// Verifies: ORA-043, ORA-046.
#[test]
fn answers_that_are_none_are_failures_of_their_case() {
    for (test, answer, word) in [
        ("empty", "echo", "no JSON"),
        ("text", "echo hello", "no JSON: hello"),
        (
            "nan",
            r#"echo '{"id":"choice-002","ok":{"p_correct":NaN}}'"#,
            "no JSON",
        ),
        ("list", "echo '[]'", "id null"),
        (
            "no-id",
            r#"echo '{"ok":{"p_correct":0.8413447460685429}}'"#,
            "id null",
        ),
        (
            "other-id",
            r#"echo '{"id":2,"ok":{"p_correct":0.8413447460685429}}'"#,
            "id 2",
        ),
        (
            "neither",
            r#"echo '{"id":"choice-002"}'"#,
            "either ok or error",
        ),
        (
            "both",
            r#"echo '{"id":"choice-002","ok":{},"error":{}}'"#,
            "either ok or error",
        ),
        (
            "no-key",
            r#"echo '{"id":"choice-002","ok":{"p":1}}'"#,
            "p_correct is missing",
        ),
        (
            "a-text",
            r#"echo '{"id":"choice-002","ok":{"p_correct":"0.84"}}'"#,
            "expected 0.8413447460685429",
        ),
        (
            "a-list",
            r#"echo '{"id":"choice-002","ok":{"p_correct":[0.8413447460685429]}}'"#,
            "expected 0.8413447460685429",
        ),
        (
            "refusal",
            r#"echo '{"id":"choice-002","error":{"code":"x"}}'"#,
            "refused",
        ),
        (
            "no-error",
            r#"echo '{"id":"choice-002","error":null}'"#,
            "error is null",
        ),
        ("nothing", ":", "no answer: the next one was for choice-003"),
        ("utf8", r"printf '\377\n'", "no JSON"),
    ] {
        let found = run(
            &format!("none-{test}"),
            &shell(&format!("*choice-002*) {answer};;")),
            "20",
        );
        found.expect(&[("choice-002", word)]);
    }
    // A remark before the answer takes the answer's place; the answer itself then comes too late.
    let remark = shell("*choice-002*) echo remark; echo '{\"id\":\"choice-002\",\"ok\":{}}';;");
    run("remark", &remark, "20").expect(&[("choice-002", "no JSON: remark")]);
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
    run("crash", &script, "20").expect(&[(
        "choice-002",
        "exit status: 7; standard error: division by zero",
    )]);
    // A program that dies of everything but the first question.
    let script = format!("read -r line; printf '%s\\n' \"$line\" | '{palpate}' oracle");
    let found = run("dies", &script, "20");
    let word = "ended without an answer";
    found
        .expect(&["choice-001", "choice-002", "choice-003", "choice-004"].map(|case| (case, word)));
}

// Verifies: ORA-044, ORA-045.
#[test]
fn silence_is_blamed_on_its_case_and_the_others_are_asked() {
    // In this time a loaded machine starts the oracle, which the shell does for each line.
    run("silence", &shell("*choice-003*) exec sleep 60;;"), "2")
        .expect(&[("choice-003", "no answer within 2 s")]);
    // After six silences the rest is not asked.
    let mut many = vectors();
    let case = many["cases"][0].clone();
    many["cases"] = (0..9)
        .map(|index| {
            let mut case = case.clone();
            case["id"] = json!(format!("choice-1{index:02}"));
            case
        })
        .collect();
    many["flags"] = json!({});
    let vectors = write(&folder("silent"), &many);
    let script = shell("*choice*) exec sleep 60;;");
    let output = conform(
        &["--vectors", &vectors, "--timeout-s", "0.5"],
        &["sh", "-c", &script],
    );
    assert_eq!(output.status.code(), Some(1));
    assert!(
        error(&output).contains("9 of 9 cases failed"),
        "{}",
        error(&output)
    );
    assert!(
        stdout(&output).contains("silent 6 times"),
        "{}",
        stdout(&output)
    );
}

// Verifies: ORA-042, ORA-049.
#[test]
fn a_program_that_does_not_answer_capabilities_is_refused() {
    for (script, word) in [
        ("exit 4", "exit status: 4"),
        ("exec sleep 5", "no answer within 0.3 s"),
        ("yes garbage", "answered \"garbage\""),
        ("yes '{\"id\":\"capabilities\",\"ok\":{}}'", "answered"),
        (
            "echo '{\"id\":1,\"ok\":{\"version\":\"1\",\"ops\":[]}}'",
            "answered",
        ),
        ("cat", "answered"),
        ("cat </dev/zero", "the program"),
    ] {
        let output = conform(&["--timeout-s", "0.3"], &["sh", "-c", script]);
        assert_eq!(output.status.code(), Some(1), "{script}");
        let error = error(&output);
        assert!(
            error.contains(word) && error.contains("expected a line like"),
            "{script}: {error}"
        );
        assert!(output.stdout.is_empty());
    }
}

// Verifies: ORA-043, ORA-044.
#[test]
fn a_flood_ends() {
    let claims = r#"echo '{"id":"capabilities","ok":{"version":"1","ops":["two_afc"]}}'"#;
    let every = ["choice-001", "choice-002", "choice-003", "choice-004"];
    run("garbage", &format!("{claims}; exec yes garbage"), "20")
        .expect(&every.map(|case| (case, "no JSON: garbage")));
    // Answers without end to what is judged already are no sign of life.
    let script =
        format!("{claims}; exec yes '{{\"id\":\"choice-001\",\"ok\":{{\"p_correct\":0.5}}}}'");
    run("repeats", &script, "0.3").expect(&[
        ("choice-002", "no answer within"),
        ("choice-003", "no answer within"),
        ("choice-004", "no answer within"),
    ]);
}

// Verifies: ORA-048, ORA-049.
#[test]
fn what_is_not_claimed_is_skipped_and_nothing_is_no_verdict() {
    let claims = |ops: &str| {
        format!(
            "echo '{{\"id\":\"capabilities\",\"ok\":{{\"version\":\"1\",\"ops\":[{ops}]}}}}'; cat >/dev/null"
        )
    };
    let found = run("claims-nothing", &claims(""), "20");
    assert_eq!(found.code, Some(1));
    assert_eq!(found.verdict["groups"][0]["skipped"], 4);
    assert_eq!(found.verdict["passed"], false);
    let claim = claims("\"three_afc\"");
    let output = conform(&["--timeout-s", "0.2"], &["sh", "-c", &claim]);
    // The lines that everybody must refuse are asked, and not answered here.
    assert_eq!(output.status.code(), Some(1));
    let vectors = write(&folder("claims-other"), &vectors());
    let output = conform(
        &["--vectors", &vectors],
        &["sh", "-c", &claims("\"three_afc\"")],
    );
    assert!(
        error(&output).contains("nothing checked"),
        "{}",
        error(&output)
    );
    assert!(error(&output).contains("two_afc"));
}

// Verifies: ORA-040, ORA-049.
#[test]
fn wrong_command_lines_are_refused() {
    let vectors = write(&folder("usage"), &vectors());
    let nowhere = folder("empty").display().to_string();
    for (options, program, word) in [
        (&["--only", "choices"][..], &["true"][..], "\"choices\""),
        (
            &["--vectors", "/no/such/folder"],
            &["true"],
            "/no/such/folder",
        ),
        (&["--vectors", &nowhere], &["true"], "no vectors"),
        (&["--timeout-s", "0"], &["true"], "0.01 to 86400"),
        (&["--timeout-s", "nan"], &["true"], "0.01 to 86400"),
        (
            &["--vectors", &vectors],
            &["/no/such/program"],
            "cannot start /no/such/program",
        ),
        (&["--vectors", &vectors], &[], "CMD"),
    ] {
        let output = conform(options, program);
        assert_eq!(output.status.code(), Some(2), "{options:?} {output:?}");
        assert!(
            error(&output).contains(word),
            "{options:?}: {}",
            error(&output)
        );
    }
}

// Verifies: ORA-041, VEC-001, VEC-002, VEC-003, VEC-004, VEC-005, VEC-006.
#[test]
fn files_that_are_not_valid_are_refused_with_file_and_case() {
    let set = |path: &str, value: Value| {
        let mut vectors = vectors();
        *vectors.pointer_mut(path).expect(path) = value;
        vectors
    };
    let add = |path: &str, key: &str, value: Value| {
        let mut vectors = vectors();
        vectors.pointer_mut(path).expect(path)[key] = value;
        vectors
    };
    let case = "case choice-002";
    let cases: &[(&str, Value, &[&str])] = &[
        (
            "schema",
            set("/schema", json!("other")),
            &["palpate-vectors"],
        ),
        (
            "version",
            set("/schema_version", json!(2)),
            &["version 2", "version 1"],
        ),
        ("key", add("", "extra", json!(1)), &["extra"]),
        (
            "case-key",
            add("/cases/1", "extra", json!(1)),
            &[case, "extra"],
        ),
        (
            "args-and-line",
            add("/cases/1", "line", json!("x")),
            &[case, "either args or line"],
        ),
        (
            "args-list",
            set("/cases/1/args", json!([])),
            &[case, "args must be an object"],
        ),
        (
            "two-lines",
            set("/cases/3/line", json!("a\nb")),
            &["case choice-004", "one line"],
        ),
        (
            "ok-and-error",
            add("/cases/1", "error", json!("bad_json")),
            &[case, "either ok or error"],
        ),
        (
            "code",
            set("/cases/2/error", json!("wrong")),
            &["case choice-003", "bad_argument"],
        ),
        (
            "same-id",
            set("/cases/1/id", json!("choice-001")),
            &["choice-001", "twice"],
        ),
        (
            "no-flag",
            set("/cases/1/flags", json!(["other"])),
            &[case, "other"],
        ),
        (
            "unused",
            add("/flags", "unused", json!({"bug": "a", "notes": ""})),
            &["unused"],
        ),
        (
            "bits",
            set("/cases/1/bits/p_correct", json!("0x3feaec4bd120d37e")),
            &[case, "bits", "p_correct"],
        ),
        ("no-bits", set("/cases/1/bits", json!({})), &[case, "bits"]),
        (
            "no-tolerance",
            set("/tolerance", json!({})),
            &["case choice-001", "no tolerance"],
        ),
        (
            "two-tolerances",
            set(
                "/tolerance/p_correct",
                json!({"ulp": 1, "relative": 1, "reason": "a"}),
            ),
            &["one of ulp"],
        ),
        (
            "no-reason",
            set("/tolerance/p_correct", json!({"ulp": 1, "reason": " "})),
            &["reason"],
        ),
        (
            "no-unit",
            set(
                "/tolerance/p_correct",
                json!({"absolute": 1, "reason": "a"}),
            ),
            &["unit"],
        ),
        (
            "negative",
            set("/tolerance/p_correct", json!({"ulp": -1, "reason": "a"})),
            &["-1"],
        ),
        (
            "near",
            set("/cases/1/wrong/0/ok/p_correct", json!(0.8413447460685439)),
            &[case, "ten times"],
        ),
        (
            "wrong-flag",
            set("/cases/1/wrong/0/flag", json!("negative")),
            &[case, "negative"],
        ),
        ("no-cases", set("/cases", json!([])), &["no cases"]),
    ];
    for (name, vectors, words) in cases {
        let folder = write(&folder(&format!("invalid-{name}")), vectors);
        let output = conform(&["--vectors", &folder], &[&palpate(), "oracle"]);
        assert_eq!(output.status.code(), Some(2), "{name}: {output:?}");
        let error = error(&output);
        assert!(error.contains("choice.json"), "{name}: {error}");
        for word in *words {
            assert!(error.contains(word), "{name}: {error} lacks {word}");
        }
    }
}

// Verifies: ORA-041, VEC-007.
#[test]
fn files_that_are_not_those_of_the_manifest_are_refused() {
    let here = folder("manifest");
    let vectors = write(&here, &vectors());
    let manifest = |file: &str, sum: &str, suite: &str| {
        let text = json!({"suite_sha256": suite, "files": [{"name": file, "sha256": sum}]});
        fs::write(here.join("manifest.json"), text.to_string()).unwrap();
        let output = conform(&["--vectors", &vectors], &[&palpate(), "oracle"]);
        assert_eq!(output.status.code(), Some(2));
        error(&output).to_string()
    };
    let wrong = manifest("choice.json", "00", "00");
    assert!(
        wrong.contains("choice.json") && wrong.contains("expected 00"),
        "{wrong}"
    );
    let sum = wrong
        .split("SHA-256 ")
        .nth(1)
        .unwrap()
        .split(',')
        .next()
        .unwrap();
    assert!(manifest("choice.json", sum, "00").contains("suite_sha256 is 00"));
    assert!(manifest("other.json", sum, "00").contains("choice.json: is not in manifest.json"));
}

// Verifies: ORA-050, ORA-051.
#[test]
fn the_verdict_for_ci_holds_every_case_and_is_the_same_each_time() {
    let vectors = write(&folder("junit"), &vectors());
    let script =
        shell("*choice-003*) echo '{\"id\":\"choice-003\",\"ok\":{\"p_correct\":\"<&>\"}}';;");
    let run = || {
        conform(
            &["--vectors", &vectors, "--format", "junit"],
            &["sh", "-c", &script],
        )
    };
    let output = run();
    let text = stdout(&output);
    assert_eq!(output.status.code(), Some(1));
    assert!(text.starts_with("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites "));
    assert!(
        text.contains(
            "<testsuite name=\"choice\" tests=\"4\" failures=\"1\" errors=\"0\" skipped=\"0\">"
        ),
        "{text}"
    );
    assert_eq!(text.matches("<testcase ").count(), 4);
    assert_eq!(text.matches("<failure ").count(), 1);
    assert!(text.contains("name=\"choice-003: below 0 &lt;&amp;&gt;\"><failure message=\"answered {&quot;p_correct&quot;:&quot;&lt;&amp;&gt;&quot;}"), "{text}");
    assert!(text.contains(">negative</failure>"));
    assert_eq!(stdout(&run()), text);
}

/// Python: the one of the environment, or the system's. It must be there, if `PALPATE_REQUIRE_WITNESSES=1`.
fn python() -> Option<String> {
    let python = std::env::var("PALPATE_PYTHON").unwrap_or_else(|_| "python3".into());
    let missing = Command::new(&python).arg("--version").output().is_err();
    present(missing.then_some(&python)).then_some(python)
}

const TOYS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/toys");

// Verifies: ORA-042, ORA-048.
#[test]
fn another_implementation_passes() {
    let Some(python) = python() else { return };
    let output = conform(&[], &[&python, "-B", &format!("{TOYS}/right.py")]);
    assert_eq!(output.status.code(), Some(0), "{}", stdout(&output));
}

/// The groups with a case that can show a bug.
fn groups_with(flag: &str) -> Vec<String> {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/..");
    let mut groups = Vec::new();
    for entry in fs::read_dir(folder).expect("the vectors") {
        let path = entry.expect("a file").path();
        if path.extension().is_none_or(|extension| extension != "json") {
            continue;
        }
        let file: Value = serde_json::from_str(&fs::read_to_string(&path).unwrap()).expect("JSON");
        if !file["flags"][flag].is_null() {
            groups.push(file["group"].as_str().unwrap().to_string());
        }
    }
    groups
}

// Verifies: ORA-047, ORA-049.
#[test]
fn the_bug_of_another_implementation_is_named() {
    let Some(python) = python() else { return };
    let wrong = format!("{TOYS}/wrong.py");
    let list = Command::new(&python)
        .args(["-B", &wrong])
        .output()
        .expect("Python starts");
    let said = String::from_utf8_lossy(&[list.stdout, list.stderr].concat()).into_owned();
    let bugs: Vec<&str> = said
        .split(": ")
        .nth(1)
        .expect("a list of bugs")
        .split_whitespace()
        .collect();
    assert!(bugs.len() >= 20, "{said}");
    for bug in bugs {
        let groups = groups_with(bug);
        assert!(!groups.is_empty(), "no case shows {bug}");
        let mut options = vec!["--format", "json"];
        options.extend(groups.iter().flat_map(|group| ["--only", group]));
        let output = conform(&options, &[&python, "-B", &wrong, bug]);
        assert_eq!(output.status.code(), Some(1), "{bug} passes");
        let verdict: Value = serde_json::from_slice(&output.stdout).expect("JSON");
        let named = verdict["likely_bugs"]
            .as_array()
            .unwrap()
            .iter()
            .any(|likely| likely["flag"] == bug);
        assert!(named, "{bug} is not named: {}", verdict["likely_bugs"]);
    }
}

// Verifies: ORA-047. Our oracle, with requests that are changed on their way to it.
#[test]
fn bugs_of_laws_and_nuisances_are_named() {
    let palpate = palpate();
    for (flag, group, change) in [
        (
            "noncentrality_ignored",
            "f_tail",
            r#"s/"noncentrality": [^,}]*/"noncentrality": 0/"#,
        ),
        (
            "noncentrality_sign",
            "student_tail",
            r#"s/"noncentrality": -/"noncentrality": /"#,
        ),
        (
            "nuisances_ignored",
            "theta_nuisances",
            r#"s/"nuisances": .*, "level"/"nuisances": [], "level"/"#,
        ),
        (
            "level_ignored",
            "theta_nuisances",
            r#"s/"unknown"/"known"/"#,
        ),
        (
            "bias_ignored",
            "theta_nuisances",
            r#"s/"bias": [^,}]*/"bias": 0/"#,
        ),
        (
            "prior_ignored",
            "bank_posterior",
            r#"s/"prior": \[[^],]*, [^],]*\]/"prior": [0.5, 0.5]/"#,
        ),
        ("level_ignored", "bank_posterior", r#"s/"unknown"/"known"/"#),
        (
            "nuisances_ignored",
            "bank_posterior",
            r#"s/"nuisances": .*, "level"/"nuisances": [], "level"/"#,
        ),
    ] {
        let program = format!("sed -u '{change}' | '{palpate}' oracle");
        let options = ["--format", "json", "--only", group];
        let output = conform(&options, &["sh", "-c", &program]);
        let verdict: Value = serde_json::from_slice(&output.stdout).expect("JSON");
        let likely = &verdict["likely_bugs"];
        assert_eq!(likely[0]["flag"], flag, "{likely}");
    }
}
