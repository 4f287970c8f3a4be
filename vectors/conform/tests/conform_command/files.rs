//! Questions and answers in files.

use std::fs;
use std::process::Command;

use crate::program::*;

// Verifies: ORA-049.
#[test]
fn output_that_cannot_be_written_is_an_error_unless_its_reader_has_gone() {
    let run = |end: &str| {
        let script = format!("set -o pipefail; '{CONFORM}' questions {end}");
        let mut shell = Command::new("bash");
        shell.args(["-c", &script]).output().expect("a shell")
    };
    let gone = run("| head -n 1");
    assert!(gone.status.success() && gone.stderr.is_empty(), "{gone:?}");
    fails(&run("> /dev/full"), 1, "palpate-conform: standard output: ");
}

// Verifies: ORA-075.
#[test]
fn answers_from_a_file_may_lack_claims_and_have_a_banner() {
    let (folder, palpate) = (folder("offline"), palpate());
    let at = |words: &str| conform_at(&folder, words, &[]);
    // Without the claims, the ops with an answer count; a lost line is a wrong answer; a banner is told.
    passes(&at("questions --only two_afc --out q2.jsonl"));
    let script = format!(
        "'{palpate}' oracle <q2.jsonl | grep -v 'capabilities\\|two_afc-003' >a2.jsonl; sed -i 1iMATLAB a2.jsonl"
    );
    sh(&folder, &script);
    let verdict = json_of(&at("judge q2.jsonl a2.jsonl --lenient --format json"));
    assert_eq!(
        verdict["findings"].as_array().unwrap().len(),
        1,
        "{verdict}"
    );
    assert_eq!(verdict["findings"][0]["case"], "two_afc-003");
    let notes = verdict["notes"].to_string();
    let is_told = notes.contains("MATLAB") && notes.contains("no answer to capabilities");
    assert!(is_told, "{notes}");
    // Other questions.
    fs::write(folder.join("q2.jsonl"), "{\"id\":\"two_afc-001\"}\n").unwrap();
    let words = "palpate-conform: q2.jsonl: line 1 is no question of these vectors";
    fails(&at("judge q2.jsonl a2.jsonl"), 2, words);
    fails(&at("judge none a2.jsonl"), 2, "none: No such file");
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

// Verifies: ORA-064.
#[test]
fn a_table_holds_questions_and_answers() {
    let Some(python) = python() else { return };
    let folder = folder("table");
    let at = |words: &str| conform_at(&folder, words, &[]);
    passes(&at("questions --form csv --out q.csv"));
    fs::write(folder.join("table.py"), TABLE).unwrap();
    let script = format!("'{python}' table.py q.csv '{}' >a.csv", palpate());
    sh(&folder, &script);
    let judged = at("judge q.csv a.csv --format json");
    passes(&judged);
    let verdict = json_of(&judged);
    // All that have an answer, and the refusals for a range.
    let (right, groups) = (total(&verdict, "right"), verdict["groups"].as_array());
    let groups = groups.unwrap().len();
    assert!(right > 2245 && groups == 29, "{right} {groups}");
    let notes = verdict["notes"].to_string();
    assert!(notes.contains("no answer to capabilities"), "{notes}");
    // A digit, a row too few, a row that is none.
    let text = fs::read_to_string(folder.join("a.csv")).unwrap();
    let mut rows = text.lines();
    let row = rows
        .find(|row| row.starts_with("theta-004,theta,"))
        .expect("a row");
    for (new, code) in [("theta-004,theta,,,1", 1), ("", 1), ("theta-004 theta", 2)] {
        fs::write(folder.join("a.csv"), text.replace(row, new)).unwrap();
        let judged = at("judge q.csv a.csv");
        assert_eq!(judged.status.code(), Some(code), "{new} {judged:?}");
        assert!(code == 2 || stdout(&judged).contains("theta-004"));
    }
}
