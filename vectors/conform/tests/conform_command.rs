//! `palpate-conform` against programs that answer rightly, wrongly, late, or not at all: `spec/oracle.md`.

#[path = "../../../tests/witness/present.rs"]
mod present;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::time::Instant;

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

/// With the words of `options`, and in a folder with other vectors than the program's own.
fn conform_at(folder: &Path, options: &str, program: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_palpate-conform"));
    command.current_dir(folder).args(options.split_whitespace());
    command.arg("--").args(program);
    command.output().expect("the program starts")
}

fn conform(options: &str, program: &[&str]) -> Output {
    conform_at(Path::new("."), options, program)
}

/// The rows of a table, one a line.
fn rows<const N: usize>(table: &str) -> impl Iterator<Item = [&str; N]> {
    table.trim().lines().map(|row| {
        let cells: Vec<&str> = row.trim().split(" | ").collect();
        cells.try_into().expect("as many cells as columns")
    })
}

fn stdout(output: &Output) -> &str {
    std::str::from_utf8(&output.stdout).expect("UTF-8")
}

fn json_of(output: &Output) -> Value {
    serde_json::from_slice(&output.stdout).unwrap_or_else(|e| panic!("{e}: {output:?}"))
}

/// The one line of an error.
fn error(output: &Output) -> &str {
    let text = std::str::from_utf8(&output.stderr).expect("UTF-8");
    assert_eq!(text.lines().count(), 1, "{text}");
    text.trim_end()
}

const CASES: [&str; 4] = ["choice-001", "choice-002", "choice-003", "choice-004"];

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

/// A folder for a test with these vectors.
fn write(test: &str, vectors: &Value) -> PathBuf {
    let folder = folder(test);
    fs::write(folder.join("choice.json"), vectors.to_string()).expect("written");
    folder
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
    let options = format!("--vectors . --format json --timeout-s {timeout}");
    let folder = write(test, &vectors());
    let output = conform_at(&folder, &options, &["sh", "-c", script]);
    let verdict = json_of(&output);
    let text = |failure: &Value, key: &str| failure[key].as_str().unwrap().to_string();
    let failures = verdict["findings"].as_array().unwrap();
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
        let code = i32::from(!failures.is_empty());
        assert_eq!(self.code, Some(code), "{}", self.verdict);
        assert_eq!(self.reasons.len(), failures.len(), "{:?}", self.reasons);
        for ((case, reason), (wanted, word)) in self.reasons.iter().zip(failures) {
            let is_so = case == wanted && reason.contains(word);
            assert!(is_so, "{case}: {reason}, not {wanted}: {word}");
        }
    }
}

// Verifies: ORA-040, ORA-048, ORA-049, ORA-069, VEC-011.
#[test]
fn our_oracle_passes_all_the_vectors_that_the_program_carries() {
    let ours = &palpate();
    let output = conform("", &[ours, "oracle"]);
    let text = stdout(&output);
    assert_eq!(output.status.code(), Some(0), "{text}");
    assert!(output.stderr.is_empty());
    let is_short = !text.contains("not right") && !text.contains("likely");
    assert!(is_short, "{text}");
    let started = Instant::now();
    let carried = conform("--format json", &[ours, "oracle"]);
    let seconds = started.elapsed().as_secs_f64();
    // Of a release build; a debug build on a loaded machine is some ten times slower.
    assert!(
        seconds < if cfg!(debug_assertions) { 60.0 } else { 2.0 },
        "{seconds} s"
    );
    let read = conform("--format json --vectors ..", &[ours, "oracle"]);
    let same = "the vectors of the folder are those of the program";
    assert_eq!(stdout(&carried), stdout(&read), "{same}");
    let verdict = json_of(&carried);
    let manifest = fs::read_to_string("../manifest.json").unwrap();
    let manifest: Value = serde_json::from_str(&manifest).unwrap();
    assert_eq!(verdict["suite_sha256"], manifest["suite_sha256"]);
    let groups = verdict["groups"].as_array().unwrap();
    let total = |key: &str| -> u64 { groups.iter().map(|of| of[key].as_u64().unwrap()).sum() };
    assert_eq!(total("cases"), manifest["cases"].as_u64().unwrap());
    assert_eq!(total("right"), total("cases"));
    assert!(total("cases") >= 1500 && manifest["refused"].as_u64().unwrap() >= 250);
}

// Verifies: ORA-046, ORA-049.
#[test]
fn a_right_program_passes() {
    let palpate = palpate();
    run("right", &format!("exec '{palpate}' oracle"), "20").expect(&[]);
    run("right-by-line", &shell(""), "20").expect(&[]);
}

/// The flag of the bug that a verdict names first.
fn first_bug(verdict: &Value) -> &str {
    let bugs = &verdict["diagnosis"][0]["explanations"][0]["bugs"];
    bugs[0]["flag"].as_str().unwrap_or("none")
}

// Verifies: ORA-047, ORA-053, ORA-068, ORA-077.
#[test]
fn wrong_answers_name_their_bug() {
    let answer = r#"echo '{"id":"choice-002","ok":{"p_correct":0.15865525393145707,"more":1}}';;"#;
    let found = run("wrong", &shell(&format!("*choice-002*) {answer}")), "20");
    found.expect(&[("choice-002", "expected 0.8413447460685429 within 2 ulp")]);
    let complement =
        json!({"flag": "complement", "bug": "the rate of wrong answers", "notes": "p for 1 - p"});
    assert_eq!(
        found.verdict["diagnosis"],
        json!([{"group": "choice", "class": "mathematics", "wrong": 1, "explanations": [
            {"bugs": [complement], "explains": 1, "against": 0, "first_case": "choice-002"}]}])
    );
    // A wrong answer that is no known bug's names none.
    let answer = r#"echo '{"id":"choice-002","ok":{"p_correct":0.5}}';;"#;
    let found = run("odd", &shell(&format!("*choice-002*) {answer}")), "20");
    found.expect(&[("choice-002", "p_correct is 0.5")]);
    assert_eq!(found.verdict["diagnosis"][0]["explanations"], json!([]));
    // What is not refused names the flags of the case.
    let answer = r#"echo '{"id":"choice-003","ok":{"p_correct":0.2}}';;"#;
    let found = run("accepts", &shell(&format!("*choice-003*) {answer}")), "20");
    found.expect(&[("choice-003", "must be refused")]);
    assert_eq!(first_bug(&found.verdict), "negative");
}

// Verifies: ORA-052.
#[test]
fn an_error_without_a_code_is_no_refusal() {
    for (error, class) in [
        ("null", json!("protocol")),
        ("false", json!("protocol")),
        ("[]", json!("protocol")),
        (r#""no""#, Value::Null),
        ("{}", Value::Null),
        (r#"{"code":null}"#, Value::Null),
    ] {
        let answer = format!("*choice-003*) echo '{{\"id\":\"choice-003\",\"error\":{error}}}';;");
        let word = "expected an object with a code";
        let found = run("no-refusal", &shell(&answer), "20");
        found.expect(&[("choice-003", word)]);
        assert_eq!(found.verdict["findings"][0]["class"], class, "{error}");
    }
    let answer = r#"*choice-003*) echo '{"id":"choice-003","error":{"code":"own"}}';;"#;
    run("refusal-of-its-own", &shell(answer), "20").expect(&[]);
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
        no-key | echo '{"id":"choice-002","ok":{"p":1}}' | p_correct is missing
        a-text | echo '{"id":"choice-002","ok":{"p_correct":"0.84"}}' | expected 0.8413447460685429
        a-list | echo '{"id":"choice-002","ok":{"p_correct":[0.8413447460685429]}}' | expected 0.8413447460685429
        refusal | echo '{"id":"choice-002","error":{"code":"x"}}' | refused
        no-error | echo '{"id":"choice-002","error":null}' | error is null
        nothing | : | no answer: the next one was for choice-003
        utf8 | printf '\377\n' | no JSON
        "#,
    ) {
        let script = shell(&format!("*choice-002*) {answer};;"));
        run(&format!("none-{test}"), &script, "20").expect(&[("choice-002", word)]);
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
    let word = "exit status: 7; standard error: division by zero";
    run("crash", &script, "20").expect(&[("choice-002", word)]);
    // A program that dies of everything but the first question.
    let script = format!("read -r line; printf '%s\\n' \"$line\" | '{palpate}' oracle");
    let found = run("dies", &script, "20");
    found.expect(&CASES.map(|case| (case, "ended without an answer")));
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
    let (folder, script) = (write("silent", &many), shell("*choice*) exec sleep 60;;"));
    let options = "--vectors . --timeout-s 0.5";
    let output = conform_at(&folder, options, &["sh", "-c", &script]);
    assert_eq!(output.status.code(), Some(1));
    let (error, text) = (error(&output), stdout(&output));
    assert!(error.contains("9 of 9 cases failed"), "{error}");
    assert!(text.contains("silent 6 times"), "{text}");
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
        assert_eq!(output.status.code(), Some(1), "{script}");
        let error = error(&output);
        let is_told = error.contains(word) && error.contains("expected a line like");
        assert!(is_told, "{script}: {error}");
        assert!(output.stdout.is_empty());
    }
}

// Verifies: ORA-043, ORA-044.
#[test]
fn a_flood_ends() {
    let claims = r#"echo '{"id":"capabilities","ok":{"version":"1","ops":["two_afc"]}}'"#;
    let script = format!("{claims}; exec yes garbage");
    run("garbage", &script, "20").expect(&CASES.map(|case| (case, "no JSON: garbage")));
    // Answers without end to what is judged already are no sign of life.
    let script =
        format!("{claims}; exec yes '{{\"id\":\"choice-001\",\"ok\":{{\"p_correct\":0.5}}}}'");
    let silent = [1, 2, 3].map(|case| (CASES[case], "no answer within"));
    run("repeats", &script, "0.3").expect(&silent);
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
    let output = conform("--timeout-s 0.2", &["sh", "-c", &claim]);
    // The lines that everybody must refuse are asked, and not answered here.
    assert_eq!(output.status.code(), Some(1));
    let folder = write("claims-other", &vectors());
    let output = conform_at(&folder, "--vectors .", &["sh", "-c", &claim]);
    let error = error(&output);
    let is_told = error.contains("nothing checked") && error.contains("two_afc");
    assert!(is_told, "{error}");
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
        let output = conform_at(&folder, options, &program);
        assert_eq!(output.status.code(), Some(2), "{options} {output:?}");
        let error = error(&output);
        assert!(error.contains(word), "{options}: {error}");
    }
}

// Verifies: ORA-041, VEC-001, VEC-002, VEC-003, VEC-004, VEC-005, VEC-006.
#[test]
fn files_that_are_not_valid_are_refused_with_file_and_case() {
    // What becomes the value at a place, which is there unless it is the last key, and words of the refusal.
    for [place, value, words] in rows(
        r#"
        /schema | "other" | palpate-vectors
        /schema_version | 2 | version 2, version 1
        /extra | 1 | extra
        /cases/1/extra | 1 | case choice-002, extra
        /cases/1/line | "x" | case choice-002, either args or line
        /cases/1/args | [] | case choice-002, expected a map
        /cases/3/line | "a\nb" | case choice-004, one line
        /cases/1/error | "bad_json" | case choice-002, either ok or error
        /cases/2/error | "wrong" | case choice-003, bad_argument
        /cases/1/id | "choice-001" | choice-001, twice
        /cases/1/flags | ["other"] | case choice-002, other
        /flags/unused | {"bug": "a", "notes": ""} | unused
        /cases/1/bits/p_correct | "0x3feaec4bd120d37e" | case choice-002, bits, p_correct
        /cases/1/bits | {} | case choice-002, bits
        /tolerance | {} | case choice-001, no tolerance
        /tolerance/p_correct | {"ulp": 1, "relative": 1, "reason": "a"} | one of ulp
        /tolerance/p_correct | {"ulp": 1, "reason": " "} | reason
        /tolerance/p_correct | {"absolute": 1, "reason": "a"} | unit
        /tolerance/p_correct | {"ulp": -1, "reason": "a"} | -1
        /cases/1/wrong/0/ok/p_correct | 0.8413447460685439 | case choice-002, ten times
        /cases/1/condition | {"p": 1} | case choice-002, "p"
        /cases/1/condition | {"p_correct": [1]} | case choice-002, another shape
        /cases/1/condition | {"p_correct": -1} | case choice-002, another shape
        /cases/1/roundoff | 1 | case choice-002, roundoff = 1
        /cases/1/wrong/0/flag | "negative" | case choice-002, negative
        /cases | [] | no cases
        "#,
    ) {
        let (object, key) = place.rsplit_once('/').expect("a place");
        let mut vectors = vectors();
        vectors.pointer_mut(object).expect(place)[key] = serde_json::from_str(value).expect(value);
        let folder = write(&format!("invalid{}", place.replace('/', "-")), &vectors);
        let output = conform_at(&folder, "--vectors .", &[&palpate(), "oracle"]);
        assert_eq!(output.status.code(), Some(2), "{place}: {output:?}");
        let error = error(&output);
        for word in ["choice.json"].into_iter().chain(words.split(", ")) {
            assert!(error.contains(word), "{place}: {error} lacks {word}");
        }
    }
}

// Verifies: ORA-041, VEC-007.
#[test]
fn files_that_are_not_those_of_the_manifest_are_refused() {
    let here = write("manifest", &vectors());
    let manifest = |file: &str, sum: &str, suite: &str| {
        let text = json!({"suite_sha256": suite, "files": [{"name": file, "sha256": sum}]});
        fs::write(here.join("manifest.json"), text.to_string()).unwrap();
        let output = conform_at(&here, "--vectors .", &[&palpate(), "oracle"]);
        assert_eq!(output.status.code(), Some(2));
        error(&output).to_string()
    };
    let wrong = manifest("choice.json", "00", "00");
    let is_told = wrong.contains("choice.json") && wrong.contains("expected 00");
    assert!(is_told, "{wrong}");
    let sum = wrong.split("SHA-256 ").nth(1).unwrap();
    let sum = sum.split(',').next().unwrap();
    assert!(manifest("choice.json", sum, "00").contains("suite_sha256 is 00"));
    assert!(manifest("other.json", sum, "00").contains("choice.json: is not in manifest.json"));
}

/// Runs `palpate-conform` with these words.
fn plain(folder: &Path, words: &str) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_palpate-conform"));
    let words = words.split_whitespace();
    command
        .current_dir(folder)
        .args(words)
        .output()
        .expect("it starts")
}

// Verifies: ORA-054, ORA-055, ORA-056.
#[test]
fn a_profile_widens_the_tolerance_by_the_condition() {
    let mut file = vectors();
    // Φ(1) and a condition of 2: 2⁻⁵³·2 = 2.2e-16 beside 2 ulp, 2⁻²⁴·2 = 1.2e-7.
    file["cases"][1]["condition"] = json!({"p_correct": 2.0});
    let folder = write("profile", &file);
    let profile =
        json!({"name": "coarse", "unit_roundoff": 0.001, "smallest": 1e-3, "largest": 1e3});
    fs::write(folder.join("coarse.json"), profile.to_string()).unwrap();
    fs::rename(folder.join("choice.json"), folder.join("choice")).unwrap();
    fs::create_dir(folder.join("v")).unwrap();
    fs::rename(folder.join("choice"), folder.join("v/choice.json")).unwrap();
    let found = |profile: &str, answer: &str, more: &str| {
        let answer = format!(
            "*choice-002*) echo '{{\"id\":\"choice-002\",\"ok\":{{\"p_correct\":{answer}}}}}';;"
        );
        let options = format!("--vectors v --profile {profile} {more}");
        conform_at(&folder, &options, &["sh", "-c", &shell(&answer)])
            .status
            .code()
    };
    for [profile, answer, code] in rows(
        "exact | 0.8413447460685433 | 1\n f64 | 0.8413447460685433 | 0\n f64 | 0.8413447460685436 | 1
         f32 | 0.8413448 | 0\n f32 | 0.8413449 | 1\n coarse.json | 0.8433 | 0\n coarse.json | 0.8434 | 1",
    ) {
        assert_eq!(found(profile, answer, ""), Some(code.parse().unwrap()), "{profile} {answer}");
    }
    for (text, word) in [
        ("{", "EOF"),
        (
            "{\"name\":\"a\",\"unit_roundoff\":1,\"smallest\":0.1,\"largest\":9}",
            "unit_roundoff = 1",
        ),
        (
            "{\"name\":\"a\",\"unit_roundoff\":0.1,\"smallest\":2,\"largest\":9}",
            "smallest = 2",
        ),
    ] {
        fs::write(folder.join("coarse.json"), text).unwrap();
        let output = conform_at(&folder, "--vectors v --profile coarse.json", &["true"]);
        assert_eq!(output.status.code(), Some(2));
        assert!(
            error(&output).contains(word) && error(&output).contains("coarse.json"),
            "{}",
            error(&output)
        );
    }
    let output = conform_at(&folder, "--vectors v --profile f16", &["true"]);
    assert!(
        error(&output).contains("expected exact, f64, f32 or a file"),
        "{}",
        error(&output)
    );
}

// Verifies: ORA-061.
#[test]
fn known_mistakes_are_accepted_with_their_reason_and_told_when_they_are_mended() {
    let folder = write("accept", &vectors());
    let answer = r#"*choice-002*) echo '{"id":"choice-002","ok":{"p_correct":0.5}}';;"#;
    let accept = |list: &str| {
        fs::write(folder.join("known"), list).unwrap();
        let options = "--vectors . --accept known --format json";
        conform_at(&folder, options, &["sh", "-c", &shell(answer)])
    };
    let output =
        accept("# of version 1\n\nchoice-002   a table of five digits\nchoice-001 once wrong\n");
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let verdict = json_of(&output);
    assert_eq!(verdict["findings"][0]["accepted"], "a table of five digits");
    assert_eq!(verdict["groups"][0]["accepted"], 1);
    assert_eq!(verdict["mended"], json!(["choice-001"]));
    for (list, word) in [
        ("choice-002", "known:1: choice-002 has no reason"),
        ("\nchoice-9 a", "known:2: no case \"choice-9\""),
        (
            "choice-002 a\nchoice-002 b",
            "known:2: choice-002 stands here twice",
        ),
    ] {
        let output = accept(list);
        assert_eq!(output.status.code(), Some(2));
        assert!(error(&output).contains(word), "{}", error(&output));
    }
}

// Verifies: ORA-059, ORA-073, ORA-074.
#[test]
fn cases_are_chosen_left_out_and_shown() {
    let folder = write("choice", &vectors());
    let oracle = [&palpate()[..], "oracle"];
    let counts = |options: &str| {
        let options = format!("--vectors . --format json {options}");
        let verdict = json_of(&conform_at(&folder, &options, &oracle));
        let of = &verdict["groups"][0];
        [&of["cases"], &of["right"], &of["skipped"]].map(|count| count.as_u64().unwrap())
    };
    assert_eq!(counts(""), [4, 4, 0]);
    assert_eq!(counts("--case choice-002 --case choice-004"), [2, 2, 0]);
    assert_eq!(counts("--skip choice-002"), [4, 3, 1]);
    let output = conform_at(&folder, "--vectors . --skip choice", &oracle);
    assert_eq!(output.status.code(), Some(1), "nothing is checked");
    let output = plain(&folder, "--vectors . --case choice-002 --show");
    let expected = "choice-002: root 2\n{\"args\":{\"gamma\":1.4142135623730951},\"id\":\"choice-002\",\"op\":\"two_afc\"}\n\
                    p_correct = 0.8413447460685429 within 2 ulp\n";
    assert_eq!(stdout(&output), expected);
    for words in [
        "--case choice-009 --show",
        "--skip choice-009 -- true",
        "--show -- true",
    ] {
        let output = plain(&folder, &format!("--vectors . {words}"));
        assert_eq!(output.status.code(), Some(2), "{words} {output:?}");
        error(&output);
    }
}

// Verifies: ORA-060, ORA-066.
#[test]
fn loose_answers_are_told() {
    let folder = write("loose", &vectors());
    let banner = r#"*choice-002*) echo 'Octave 7'; echo '{"id":"choice-002","ok":{"p_correct":0.8413447460685429}}';;"#;
    let output = conform_at(
        &folder,
        "--vectors . --lenient",
        &["sh", "-c", &shell(banner)],
    );
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let told = "note: passed over, since it is no answer: Octave 7";
    assert!(stdout(&output).contains(told), "{}", stdout(&output));
    let script = format!("echo hello; {}", shell(""));
    for (lenient, code) in [("--lenient", 0), ("", 1)] {
        let options = format!("--vectors . {lenient}");
        let output = conform_at(&folder, &options, &["sh", "-c", &script]);
        assert_eq!(output.status.code(), Some(code), "{output:?}");
    }
    let no_id = r#"*choice-002*) echo '{"ok":{"p_correct":0.8413447460685429}}';;"#;
    for (require, code) in [("right", 1), ("acceptable", 0)] {
        let options = format!("--vectors . --require {require}");
        let output = conform_at(&folder, &options, &["sh", "-c", &shell(no_id)]);
        assert_eq!(output.status.code(), Some(code), "{output:?}");
    }
}

// Verifies: ORA-057, ORA-063, ORA-075.
#[test]
fn answers_from_a_file_are_judged_as_those_from_a_pipe() {
    let folder = folder("offline");
    let written = plain(&folder, "questions --out q.jsonl");
    assert_eq!(written.status.code(), Some(0), "{written:?}");
    let palpate = palpate();
    let script = format!("'{palpate}' oracle <q.jsonl >a.jsonl");
    let mut shell = Command::new("sh");
    let answered = shell.current_dir(&folder).args(["-c", &script]).status();
    assert!(answered.expect("a shell").success());
    let judged = plain(&folder, "judge q.jsonl a.jsonl --format json");
    assert_eq!(judged.status.code(), Some(0), "{}", stdout(&judged));
    let piped = conform("--format json", &[&palpate, "oracle"]);
    let [mut judged, mut piped] = [json_of(&judged), json_of(&piped)];
    let sum = judged["program"]["files"][0]["sha256"].take();
    assert_eq!(sum.as_str().map(str::len), Some(64));
    judged["program"] = Value::Null;
    piped["program"] = Value::Null;
    assert_eq!(judged, piped);
    // Without the claims, the ops with an answer count; a lost line is a wrong answer; a banner is told.
    let script = format!(
        "'{palpate}' oracle <q2.jsonl | grep -v 'capabilities\\|two_afc-003' >a2.jsonl; sed -i 1iMATLAB a2.jsonl"
    );
    assert!(
        plain(&folder, "questions --only two_afc --out q2.jsonl")
            .status
            .success()
    );
    let answered = Command::new("sh")
        .current_dir(&folder)
        .args(["-c", &script])
        .status();
    assert!(answered.expect("a shell").success());
    let judged = plain(&folder, "judge q2.jsonl a2.jsonl --lenient --format json");
    let verdict = json_of(&judged);
    assert_eq!(
        verdict["findings"].as_array().map(Vec::len),
        Some(1),
        "{verdict}"
    );
    assert_eq!(verdict["findings"][0]["case"], "two_afc-003");
    let notes = verdict["notes"].to_string();
    assert!(
        notes.contains("MATLAB") && notes.contains("no answer to capabilities"),
        "{notes}"
    );
    // Other questions.
    fs::write(folder.join("q.jsonl"), "{\"id\":\"two_afc-001\"}\n").unwrap();
    let output = plain(&folder, "judge q.jsonl a.jsonl");
    assert_eq!(output.status.code(), Some(2));
    assert_eq!(
        error(&output),
        "palpate-conform: q.jsonl: line 1 is no question of these vectors"
    );
    let output = plain(&folder, "judge none a.jsonl");
    assert!(error(&output).contains("none: No such file"), "{output:?}");
}

/// A program between the oracle and a table of answers: each question of the table becomes a request, each answer rows.
const TABLE: &str = r#"
import csv, json, subprocess, sys
def value(text):
    try: return json.loads(text)
    except ValueError: return text
ops, cases = {}, {}
for row in csv.DictReader(open(sys.argv[1])):
    ops[row["id"]] = row["op"]
    args = cases.setdefault(row["id"], {})
    is_text = row["argument"] in ("bytes", "criterion", "method", "level", "phantom")
    v = row["value"] if is_text else value(row["value"])
    if row["row"] == "": args[row["argument"]] = v
    elif row["column"] == "": args.setdefault(row["argument"], []).append(v)
    else:
        rows = args.setdefault(row["argument"], [])
        if len(rows) <= int(row["row"]): rows.append([])
        rows[-1].append(v)
lines = "".join(json.dumps({"id": i, "op": ops[i], "args": a}) + "\n" for i, a in cases.items())
said = subprocess.run([sys.argv[2], "oracle"], input=lines, capture_output=True, text=True).stdout
out = ["id,key,row,column,value"]
for line in said.splitlines():
    a = json.loads(line)
    if "error" in a: out.append(f"{a['id']},error,,,{a['error']['code']}")
    for k, v in a.get("ok", {}).items():
        if not isinstance(v, list): out.append(f"{a['id']},{k},,,{v!r}".replace("'", ""))
        elif not v: out.append(f"{a['id']},{k},,,[]")
        for i, e in enumerate(v if isinstance(v, list) else []):
            if isinstance(e, list): out += [f"{a['id']},{k},{i},{j},{x!r}" for j, x in enumerate(e)]
            else: out.append(f"{a['id']},{k},{i},,{e!r}")
out[1:] = sorted(out[1:], reverse=True)
print("\n".join(out))
"#;

// Verifies: ORA-064, ORA-076.
#[test]
fn a_table_holds_questions_and_answers() {
    let Some(python) = python() else { return };
    let folder = folder("table");
    assert!(
        plain(&folder, "questions --form csv --out q.csv")
            .status
            .success()
    );
    fs::write(folder.join("table.py"), TABLE).unwrap();
    let answers = Command::new(&python)
        .current_dir(&folder)
        .args(["table.py", "q.csv", &palpate()])
        .output();
    let answers = answers.expect("Python starts").stdout;
    fs::write(folder.join("a.csv"), &answers).unwrap();
    let judged = plain(&folder, "judge q.csv a.csv --format json");
    assert_eq!(judged.status.code(), Some(0), "{}", stdout(&judged));
    let verdict = json_of(&judged);
    let groups = verdict["groups"].as_array().unwrap();
    let cases: u64 = groups
        .iter()
        .map(|group| group["right"].as_u64().unwrap())
        .sum();
    // All that have an answer, and the refusals for a range.
    assert!(
        cases > 2143 && groups.len() == 27,
        "{cases} {}",
        groups.len()
    );
    // A digit, a row too few, a row that is none.
    let text = String::from_utf8(answers).unwrap();
    let row = text
        .lines()
        .find(|row| row.starts_with("theta-004,theta,"))
        .expect("a row");
    for (new, code) in [("theta-004,theta,,,1", 1), ("", 1), ("theta-004 theta", 2)] {
        fs::write(folder.join("a.csv"), text.replace(row, new)).unwrap();
        let judged = plain(&folder, "judge q.csv a.csv");
        assert_eq!(judged.status.code(), Some(code), "{new} {judged:?}");
        assert!(code == 2 || stdout(&judged).contains("theta-004"));
    }
}

// Verifies: ORA-062, ORA-065.
#[test]
fn the_page_says_what_was_judged_and_stands_alone() {
    let folder = write("page", &vectors());
    fs::write(folder.join("known"), "choice-003 <b>later</b>\n").unwrap();
    fs::write(
        folder.join("program"),
        shell("*choice-003*) echo '{\"id\":\"choice-003\",\"ok\":{}}';;"),
    )
    .unwrap();
    let page = |options: &str| {
        conform_at(
            &folder,
            &format!("--vectors . --accept known {options}"),
            &["sh", "program"],
        )
    };
    let (html, verdict) = (page("--format html"), json_of(&page("--format json")));
    let text = stdout(&html);
    assert_eq!(html.status.code(), Some(0));
    let mut wanted = vec![
        "choice-003",
        "&lt;b&gt;later&lt;/b&gt;",
        "passed",
        "Signature",
    ];
    wanted.push(verdict["suite_sha256"].as_str().unwrap());
    let files = verdict["program"]["files"].as_array().unwrap();
    assert_eq!(files.len(), 2, "the shell, and the file that it reads");
    wanted.extend(files.iter().map(|file| file["sha256"].as_str().unwrap()));
    for word in wanted {
        assert!(text.contains(word), "{word} is not in {text}");
    }
    assert!(!text.contains("<b>") && !text.contains("src=") && !text.contains("href="));
}

// Verifies: ORA-050, ORA-051.
#[test]
fn the_verdict_for_ci_holds_every_case_and_is_the_same_each_time() {
    let folder = write("junit", &vectors());
    let answer = r#"echo '{"id":"choice-003","ok":{"p_correct":"<&>"}}';;"#;
    let script = shell(&format!("*choice-003*) {answer}"));
    let run = || {
        conform_at(
            &folder,
            "--vectors . --format junit",
            &["sh", "-c", &script],
        )
    };
    let output = run();
    let text = stdout(&output);
    assert_eq!(output.status.code(), Some(1));
    assert!(text.starts_with("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites "));
    let suite = r#"<testsuite name="choice" tests="4" failures="1" errors="0" skipped="0">"#;
    assert!(text.contains(suite), "{text}");
    assert_eq!(text.matches("<testcase ").count(), 4);
    assert_eq!(text.matches("<failure ").count(), 1);
    assert!(text.contains("name=\"choice-003: below 0 &lt;&amp;&gt;\"><failure type=\"range\" message=\"answered {&quot;p_correct&quot;:&quot;&lt;&amp;&gt;&quot;}"), "{text}");
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
    let output = conform("", &[&python, "-B", &format!("{TOYS}/right.py")]);
    assert_eq!(output.status.code(), Some(0), "{}", stdout(&output));
}

/// The groups with a case that can show a bug.
fn groups_with(flag: &str) -> Vec<String> {
    let mut groups = Vec::new();
    for entry in fs::read_dir("..").expect("the vectors") {
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

/// The names of the bugs of a toy.
fn planted(python: &str, toy: &str) -> Vec<String> {
    let list = Command::new(python).args(["-B", toy]).output();
    let list = list.expect("Python starts");
    let said = String::from_utf8_lossy(&[list.stdout, list.stderr].concat()).into_owned();
    let bugs = said.split(": ").nth(1).expect("a list of bugs");
    bugs.split_whitespace().map(str::to_string).collect()
}

/// The diagnosis of a toy with a bug, which must make it fail.
fn diagnosis(python: &str, toy: &str, bug: &str, groups: &[String]) -> Vec<Value> {
    let options = format!("--format json --only {}", groups.join(" --only "));
    let output = conform(&options, &[python, "-B", toy, bug]);
    assert_eq!(output.status.code(), Some(1), "{bug} passes");
    json_of(&output)["diagnosis"].as_array().unwrap().clone()
}

// Verifies: ORA-047, ORA-049, ORA-053.
#[test]
fn the_bugs_of_another_implementation_are_named_first() {
    let Some(python) = python() else { return };
    let toy = format!("{TOYS}/wrong.py");
    let bugs = planted(&python, &toy);
    assert!(bugs.len() >= 30, "{bugs:?}");
    let is_first = |bug: &&String| {
        let groups = groups_with(bug);
        assert!(!groups.is_empty(), "no case shows {bug}");
        let found = diagnosis(&python, &toy, bug, &groups);
        let first = |one: &Value| one["explanations"][0]["bugs"][0]["flag"] == ***bug;
        // The gravest class of every group that the bug shows in.
        let gravest = found
            .chunk_by(|a, b| a["group"] == b["group"])
            .map(|of_group| &of_group[0]);
        gravest.clone().count() > 0 && gravest.into_iter().all(first)
    };
    let first = bugs.iter().filter(is_first).count();
    assert!(
        10 * first >= 9 * bugs.len(),
        "{first} of {} named first",
        bugs.len()
    );
}

// Verifies: ORA-053, ORA-068.
#[test]
fn bugs_that_the_vectors_do_not_foresee_get_no_name_that_explains_less_than_half() {
    let Some(python) = python() else { return };
    let toy = format!("{TOYS}/unforeseen.py");
    let bugs = planted(&python, &toy);
    assert!(bugs.len() >= 10, "{bugs:?}");
    let groups = "theta scan matched_filter theta_colored normal_cdf error_rates roc interpolate";
    let groups: Vec<String> = groups.split(' ').map(String::from).collect();
    let mut unexplained = 0;
    for bug in &bugs {
        assert!(groups_with(bug).is_empty(), "{bug} is foreseen");
        let found = diagnosis(&python, &toy, bug, &groups);
        for one in &found {
            let wrong = one["wrong"].as_u64().unwrap();
            let explanations = one["explanations"].as_array().unwrap();
            let least = explanations
                .iter()
                .map(|one| 2 * one["explains"].as_u64().unwrap());
            assert!(
                least.min().is_none_or(|least| least >= wrong),
                "{bug}: {one}"
            );
        }
        let is_named = |one: &Value| one["explanations"] != json!([]);
        unexplained += usize::from(!found.iter().any(is_named));
    }
    // `erf` for `erfc` is a cancelled tail.
    assert_eq!(unexplained, bugs.len() - 1);
}

/// Few enough crates, none of them of the solver, the device or the plots.
// Verifies: ORA-070.
#[test]
fn the_program_stands_on_few_crates() {
    let words = [
        "tree",
        "--offline",
        "-p",
        "palpate-conform",
        "-e",
        "normal,build",
        "--prefix",
        "none",
    ];
    let tree = Command::new(env!("CARGO")).args(words).output();
    let tree = tree.expect("cargo starts");
    let tree = stdout(&tree);
    let mut crates: Vec<&str> = tree
        .lines()
        .filter_map(|line| line.split(' ').next())
        .collect();
    crates.sort();
    crates.dedup();
    assert!(
        crates.contains(&"serde_json") && crates.len() <= 30,
        "{crates:?}"
    );
    assert!(!crates.contains(&"palpate"), "{crates:?}");
}

// Verifies: ORA-047. Our oracle, with requests that are changed on their way to it.
#[test]
fn bugs_of_laws_and_nuisances_are_named() {
    let palpate = palpate();
    for [flag, group, change] in rows(
        r#"
        noncentrality_ignored | f_tail | s/"noncentrality":[^,}]*/"noncentrality":0/
        noncentrality_sign | student_tail | s/"noncentrality":-/"noncentrality":/
        nuisances_ignored | theta_nuisances | s/"nuisances":.*,"residual"/"nuisances":[],"residual"/
        level_ignored | theta_nuisances | s/"unknown"/"known"/
        bias_ignored | theta_nuisances | s/"bias":[^,}]*/"bias":0/
        prior_ignored | bank_posterior | s/"prior":\[[^],]*,[^],]*\]/"prior":[0.5,0.5]/
        level_ignored | bank_posterior | s/"unknown"/"known"/
        nuisances_ignored | bank_posterior | s/"nuisances":.*,"prior"/"nuisances":[],"prior"/
        "#,
    ) {
        let program = format!("sed -u '{change}' | '{palpate}' oracle");
        let options = format!("--format json --only {group}");
        let verdict = json_of(&conform(&options, &["sh", "-c", &program]));
        assert_eq!(first_bug(&verdict), flag, "{}", verdict["diagnosis"]);
    }
}
