//! Bugs planted in a copy of the sources, one at a time: for each, the harness that it names must
//! fail. `cargo test --release -p palpate-proofs --test defects -- --ignored`. And bugs of people, which the tests that they name found.
#![cfg(not(any(kani, fuzzing)))]

#[path = "defects/copy.rs"]
mod copy;
#[path = "defects/list.rs"]
mod list;
#[path = "defects/suite.rs"]
mod suite;
#[path = "defects/switch.rs"]
mod switch;
#[path = "defects/trial.rs"]
mod trial;

use std::fs;
use std::path::Path;
use std::process::Command;

use copy::{Copy, ROOT};
use list::{Entry, defects, ledger};

/// The packages that the harnesses see.
const PACKAGES: [&str; 4] = ["src/core", "bindings/c", "proofs", "tests/asserts"];

/// A copy of the core and its proofs.
struct Harnesses(Copy);

impl Harnesses {
    fn new() -> Harnesses {
        let manifests = ["Cargo.toml", "Cargo.lock"];
        let copy = Copy::new("defects", &[&PACKAGES[..], &manifests].concat());
        let manifest = copy.read("Cargo.toml");
        let (_, shared) = manifest.split_once("[workspace.package]").unwrap();
        let workspace = format!("[workspace]\nresolver = \"3\"\nmembers = {PACKAGES:?}\n");
        let manifest = format!("{workspace}[workspace.package]{shared}");
        copy.write("Cargo.toml", manifest.as_bytes());
        Harnesses(copy)
    }

    /// The harnesses that fail among those with `name` in their name.
    fn failing(&self, name: &str) -> Vec<String> {
        let run = Command::new(env!("CARGO"))
            .current_dir(&self.0.root)
            .env("CARGO_TARGET_DIR", self.0.root.join("target"))
            // Most of the time goes into building, again and again.
            .env("CARGO_INCREMENTAL", "1")
            .env("CARGO_PROFILE_DEV_OPT_LEVEL", "1")
            .env("CARGO_PROFILE_DEV_DEBUG", "false")
            .env("RUST_BACKTRACE", "0")
            .args(["test", "--offline", "-p", "palpate-proofs", "--lib", name])
            .output()
            .unwrap();
        let said = String::from_utf8_lossy(&run.stdout);
        assert!(
            said.contains("test result:"),
            "it does not build: {}",
            String::from_utf8_lossy(&run.stderr)
        );
        said.lines()
            .filter_map(|line| line.strip_prefix("test ")?.strip_suffix(" ... FAILED"))
            .map(str::to_owned)
            .collect()
    }
}

#[test]
#[ignore = "builds the proofs once for each defect"]
fn each_planted_defect_is_found_by_its_harness() {
    let harnesses = Harnesses::new();
    assert_eq!(
        harnesses.failing(""),
        [""; 0],
        "without a defect nothing fails"
    );
    let mut missed = Vec::new();
    for defect in defects() {
        let found = || harnesses.failing(&defect.found_by);
        let failing = harnesses.0.with(&defect, found);
        println!("{}: {}", defect.name, failing.join(", "));
        if failing.is_empty() {
            missed.push(defect.name);
        }
    }
    assert_eq!(missed, [""; 0], "not found by the harness that they name");
}

/// The sources below a folder, as one text.
fn sources(folder: &Path) -> String {
    let mut text = String::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            text += &sources(&path);
        } else if path
            .extension()
            .is_some_and(|end| end == "rs" || end == "py")
        {
            text += &fs::read_to_string(path).unwrap();
        }
    }
    text
}

#[test]
fn each_defect_of_the_ledger_has_its_place_and_its_test() {
    let root = Path::new(ROOT);
    let folders = [
        "src",
        "tests",
        "proofs",
        "vectors/conform",
        "bindings/c",
        "bindings/python",
    ];
    let tests = folders.map(|folder| sources(&root.join(folder))).concat();
    for Entry { defect, .. } in ledger() {
        defect.place(&fs::read_to_string(root.join(&defect.file)).unwrap());
        let test = &defect.found_by;
        let is_there = ["fn", "def"]
            .iter()
            .any(|word| tests.contains(&format!("{word} {test}(")));
        assert!(test == "?" || is_there, "{}: no test {test}", defect.name);
    }
}
