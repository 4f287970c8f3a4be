//! The bill of materials, read by a program that is not ours.

use std::collections::{BTreeMap, BTreeSet};
use std::io::Write as _;
use std::process::{Command, Stdio};

use palpate::build::Build;
use palpate_verify::supply::{components, sbom};
use serde_json::Value;

use super::cargo::{ALL, OURS, tree};
use super::present::present;

/// For each text in the list on standard input: validates it against the schema of CycloneDX 1.6, and says how many
/// components and dependencies it read in it, or `refused`.
const VALIDATE: &str = "
import json, sys
from cyclonedx.model.bom import Bom
from cyclonedx.schema import SchemaVersion
from cyclonedx.validation.json import JsonStrictValidator
validator = JsonStrictValidator(SchemaVersion.V1_6)
for text in json.load(sys.stdin):
    error = validator.validate_str(text)
    if error is not None:
        print('refused')
        print(error, file=sys.stderr)
        continue
    bom = Bom.from_json(json.loads(text))
    bom.validate()
    print(len(bom.components), len(bom.dependencies))
";

fn text() -> String {
    serde_json::to_string_pretty(&sbom().unwrap()).unwrap()
}

fn python() -> Command {
    Command::new(std::env::var_os("PALPATE_PYTHON").unwrap_or_else(|| "python3".into()))
}

/// What the validator says of some texts, a line each; and its errors.
fn validated(texts: &[String]) -> (String, String) {
    let mut child = python()
        .args(["-c", VALIDATE])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut stdin = child.stdin.take().unwrap();
    let texts = serde_json::to_string(texts).unwrap();
    stdin.write_all(texts.as_bytes()).unwrap();
    drop(stdin);
    let output = child.wait_with_output().unwrap();
    let read = |bytes| String::from_utf8(bytes).unwrap();
    (read(output.stdout), read(output.stderr))
}

// Verifies: EVD-065.
#[test]
fn an_independent_program_reads_it() {
    let probe = python()
        .args(["-c", "import cyclonedx.validation.json, jsonschema"])
        .output();
    let missing = !probe.is_ok_and(|output| output.status.success());
    if !present(missing.then_some("cyclonedx-python-lib[json-validation]")) {
        return;
    }
    let crates = components().unwrap().len();
    // It does look: what is no version, no algorithm and no scope does not pass.
    let mut texts = vec![text()];
    for (right, wrong) in [
        ("\"specVersion\": \"1.6\"", "\"specVersion\": 1.6"),
        ("\"alg\": \"SHA-256\"", "\"alg\": \"SHA-257\""),
        ("\"scope\": \"required\"", "\"scope\": \"needed\""),
    ] {
        texts.push(text().replace(right, wrong));
        assert_ne!(texts.last(), texts.first());
    }
    // The standard library is one more, and the program asks for all of them.
    let expected = format!("{} {}\nrefused\nrefused\nrefused\n", crates + 1, crates + 2);
    let (verdicts, errors) = validated(&texts);
    assert_eq!(verdicts, expected, "{errors}");
}

// Verifies: EVD-065.
#[test]
fn it_has_every_component_with_its_hash_and_what_asks_for_what() {
    let bom = sbom().unwrap();
    let text = |value: &Value| value.as_str().unwrap().to_string();
    let parts: BTreeMap<String, &Value> = (bom["components"].as_array().unwrap().iter())
        .map(|part| (text(&part["name"]) + " " + &text(&part["version"]), part))
        .collect();
    let components = components().unwrap();
    assert_eq!(parts.len(), components.len() + 1);
    for component in &components {
        let part = parts[&format!("{} {}", component.name, component.version)];
        assert_eq!(part["hashes"][0]["content"], component.sha256);
        assert_eq!(part["licenses"][0]["expression"], component.licence);
    }
    assert!(parts.contains_key(&format!("rust-standard-library {}", Build::THIS.compiler)));

    let program = text(&bom["metadata"]["component"]["bom-ref"]);
    let mut known: BTreeSet<String> = parts.values().map(|part| text(&part["bom-ref"])).collect();
    // The `+` of a version is no character of a package URL.
    assert!(known.iter().all(|reference| !reference.contains('+')));
    known.insert(program.clone());
    let mut asked: BTreeMap<&str, Vec<&str>> = BTreeMap::new();
    for entry in bom["dependencies"].as_array().unwrap() {
        let names = entry["dependsOn"].as_array().unwrap().iter();
        let names: Vec<&str> = names.map(|name| name.as_str().unwrap()).collect();
        assert!(names.iter().all(|name| known.contains(*name)), "{entry}");
        asked.insert(entry["ref"].as_str().unwrap(), names);
    }
    // From the program everything is reached.
    let (mut open, mut reached) = (vec![&*program], BTreeSet::new());
    while let Some(name) = open.pop() {
        if reached.insert(name.to_string()) {
            open.extend(asked.get(name).into_iter().flatten());
        }
    }
    assert_eq!(reached, known);
    // What the program asks for by itself, without what its tests do.
    let direct: BTreeSet<String> = (asked[&*program].iter())
        .filter_map(|purl| purl.strip_prefix("pkg:cargo/"))
        .map(|purl| purl.replace('@', " ").replace("%2B", "+"))
        .collect();
    assert_eq!(direct, tree("default", ALL)[OURS].depends_on);
}

// Verifies: EVD-066.
#[test]
fn it_is_the_same_each_time() {
    let first = text();
    assert_eq!(first, text());
    for chance in ["serialNumber", "timestamp"] {
        assert!(!first.contains(chance), "{chance}");
    }
}
