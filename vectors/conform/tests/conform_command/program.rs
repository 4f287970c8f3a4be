//! Runs `palpate-conform`, on vectors and programs made for a test.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use serde_json::{Value, json};

use crate::present::present;

pub const CONFORM: &str = env!("CARGO_BIN_EXE_palpate-conform");
pub const TOYS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/toys");

/// The program itself, which stands beside this package's; `cargo test --workspace` builds both.
pub fn palpate() -> String {
    let program = Path::new(CONFORM).with_file_name("palpate");
    assert!(program.exists(), "first: cargo build -p palpate");
    program.into_os_string().into_string().expect("UTF-8")
}

/// The folder of a test.
pub fn folder_of(test: &str) -> PathBuf {
    Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("conform-{test}"))
}

/// A folder of its own for each test, emptied at the start.
pub fn folder(test: &str) -> PathBuf {
    let path = folder_of(test);
    let _ = fs::remove_dir_all(&path);
    fs::create_dir_all(&path).expect("a folder for the test");
    path
}

/// Runs `palpate-conform` in a folder with the words of `options`, and after `--` those of a program, if there is one.
pub fn conform_at(folder: &Path, options: &str, program: &[&str]) -> Output {
    let separator = (!program.is_empty()).then_some("--");
    Command::new(CONFORM)
        .current_dir(folder)
        .args(options.split_whitespace())
        .args(separator)
        .args(program)
        .output()
        .expect("the program starts")
}

pub fn conform(options: &str, program: &[&str]) -> Output {
    conform_at(Path::new("."), options, program)
}

/// Runs a script, which must end well, in a folder.
pub fn sh(folder: &Path, script: &str) {
    let mut shell = Command::new("sh");
    let status = shell.current_dir(folder).args(["-c", script]).status();
    assert!(status.expect("a shell").success(), "{script}");
}

/// The rows of a table, one a line.
pub fn rows<const N: usize>(table: &str) -> impl Iterator<Item = [&str; N]> {
    table.trim().lines().map(|row| {
        let cells: Vec<&str> = row.trim().split(" | ").collect();
        cells.try_into().expect("as many cells as columns")
    })
}

pub fn stdout(output: &Output) -> &str {
    std::str::from_utf8(&output.stdout).expect("UTF-8")
}

pub fn json_of(output: &Output) -> Value {
    serde_json::from_slice(&output.stdout).unwrap_or_else(|e| panic!("{e}: {output:?}"))
}

/// The one line of an error.
pub fn error(output: &Output) -> &str {
    let text = std::str::from_utf8(&output.stderr).expect("UTF-8");
    assert_eq!(text.lines().count(), 1, "{text}");
    text.trim_end()
}

/// Asserts the exit code and, for each of these words with commas between them, that the one line of the error has it.
#[track_caller]
pub fn fails(output: &Output, code: i32, words: &str) {
    assert_eq!(output.status.code(), Some(code), "{words}: {output:?}");
    let error = error(output);
    for word in words.split(", ") {
        assert!(error.contains(word), "{error} lacks {word}");
    }
}

#[track_caller]
pub fn passes(output: &Output) {
    assert_eq!(output.status.code(), Some(0), "{output:?}");
}

pub const CASES: [&str; 4] = ["choice-001", "choice-002", "choice-003", "choice-004"];

/// A file of four cases: ½, Φ(1), a refusal, and a whole line to be refused.
pub fn vectors() -> Value {
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
pub fn write(test: &str, vectors: &Value) -> PathBuf {
    let folder = folder(test);
    fs::write(folder.join("choice.json"), vectors.to_string()).expect("written");
    folder
}

/// A shell that answers each line by the oracle, but for what `special` cases do: patterns of `case`.
pub fn shell(special: &str) -> String {
    let palpate = palpate();
    format!(
        "while IFS= read -r line; do case \"$line\" in\n{special}\n*) printf '%s\\n' \"$line\" | '{palpate}' oracle;;\nesac; done"
    )
}

/// Such a shell that gives this answer, without its id, to a case.
pub fn answering(case: &str, answer: &str) -> String {
    shell(&format!(
        "*{case}*) echo '{{\"id\":\"{case}\",{answer}}}';;"
    ))
}

/// A shell that claims these ops and refuses each question, but first does what `first` says.
pub fn refusing(ops: &str, first: &str) -> String {
    let shell = r#"
        answered=0
        while IFS= read -r line; do
            id=$(printf '%s' "$line" | sed 's/.*"id":"\([^"]*\)".*/\1/')
            case $id in
            capabilities) echo '{"id":"capabilities","ok":{"version":"1","ops":[OPS]}}';;
            *) FIRST
               echo "{\"id\":\"$id\",\"error\":{\"code\":\"x\"}}"; answered=$((answered + 1));;
            esac
        done"#;
    shell.replace("OPS", ops).replace("FIRST", first)
}

/// Asks a shell program the vectors of a folder.
pub fn ask(folder: &Path, options: &str, script: &str) -> Output {
    let options = format!("--vectors . {options}");
    conform_at(folder, &options, &["sh", "-c", script])
}

/// The verdict on a shell program. Just these cases must fail, each for a reason with this word.
#[track_caller]
pub fn run(test: &str, script: &str, failures: &[(&str, &str)]) -> Value {
    run_within("20", test, script, failures)
}

/// The same with another timeout, s.
#[track_caller]
pub fn run_within(timeout: &str, test: &str, script: &str, failures: &[(&str, &str)]) -> Value {
    let options = format!("--format json --timeout-s {timeout}");
    let output = ask(&write(test, &vectors()), &options, script);
    let verdict = json_of(&output);
    let code = i32::from(!failures.is_empty());
    assert_eq!(output.status.code(), Some(code), "{verdict}");
    let findings = verdict["findings"].as_array().unwrap();
    assert_eq!(findings.len(), failures.len(), "{findings:?}");
    for (finding, (case, word)) in findings.iter().zip(failures) {
        let reason = finding["reason"].as_str().unwrap();
        let is_so = finding["case"] == *case && reason.contains(word);
        assert!(is_so, "{finding}, not {case}: {word}");
    }
    verdict
}

/// The flag of the bug that a verdict names first.
pub fn first_bug(verdict: &Value) -> &str {
    let bugs = &verdict["diagnosis"][0]["explanations"][0]["bugs"];
    bugs[0]["flag"].as_str().unwrap_or("none")
}

/// The sum of one count over the groups of a verdict.
pub fn total(verdict: &Value, count: &str) -> u64 {
    let groups = verdict["groups"].as_array().unwrap().iter();
    groups.map(|group| group[count].as_u64().unwrap()).sum()
}

/// Python: the one of the environment, or the system's. It must be there, if `PALPATE_REQUIRE_WITNESSES=1`.
pub fn python() -> Option<String> {
    let python = std::env::var("PALPATE_PYTHON").unwrap_or_else(|_| "python3".into());
    let missing = Command::new(&python).arg("--version").output().is_err();
    present(missing.then_some(&python)).then_some(python)
}
