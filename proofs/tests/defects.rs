//! Bugs planted in a copy of the sources, one at a time: for each, the harness that it names must
//! fail. `cargo test --release -p palpate-proofs --test defects -- --ignored`. And bugs of people, which the tests that they name found.
#![cfg(not(any(kani, fuzzing)))]

#[path = "defects/list.rs"]
mod list;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use list::{Defect, defects, of_people};

/// The packages that the harnesses see.
const PACKAGES: [&str; 4] = ["src/core", "bindings/c", "proofs", "tests/asserts"];

/// A copy of the core and its proofs, with a target folder of its own.
struct Copy {
    root: PathBuf,
}

impl Copy {
    fn new() -> Copy {
        let root = Path::new(env!("CARGO_TARGET_TMPDIR")).join("defects");
        let from = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap();
        for package in PACKAGES {
            let _ = fs::remove_dir_all(root.join(package));
            copy_folder(&from.join(package), &root.join(package));
        }
        fs::copy(from.join("Cargo.lock"), root.join("Cargo.lock")).unwrap();
        let manifest = fs::read_to_string(from.join("Cargo.toml")).unwrap();
        let (_, shared) = manifest.split_once("[workspace.package]").unwrap();
        let workspace = format!("[workspace]\nresolver = \"3\"\nmembers = {PACKAGES:?}\n");
        let manifest = format!("{workspace}[workspace.package]{shared}");
        fs::write(root.join("Cargo.toml"), manifest).unwrap();
        Copy { root }
    }

    /// The harnesses that fail among those with `name` in their name.
    fn failing(&self, name: &str) -> Vec<String> {
        let run = Command::new(env!("CARGO"))
            .current_dir(&self.root)
            .env("CARGO_TARGET_DIR", self.root.join("target"))
            // Most of the time goes into building.
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

    /// Those that fail with a defect among the ones that it names.
    fn failing_with(&self, defect: &Defect) -> Vec<String> {
        let path = self.root.join(defect.file);
        let sound = fs::read_to_string(&path).unwrap();
        let [from, to] = &defect.edit;
        let found = sound.matches(from).count();
        let Defect { name, file, .. } = defect;
        assert_eq!(found, 1, "{name}: {file} must have once: {from}");
        fs::write(&path, sound.replace(from, to)).unwrap();
        let failing = self.failing(defect.found_by);
        fs::write(&path, sound).unwrap();
        failing
    }
}

fn copy_folder(from: &Path, to: &Path) {
    fs::create_dir_all(to).unwrap();
    for entry in fs::read_dir(from).unwrap() {
        let entry = entry.unwrap();
        let to = to.join(entry.file_name());
        if entry.file_type().unwrap().is_dir() {
            copy_folder(&entry.path(), &to);
        } else {
            fs::copy(entry.path(), to).unwrap();
        }
    }
}

#[test]
#[ignore = "builds the proofs once for each defect"]
fn each_planted_defect_is_found_by_its_harness() {
    let copy = Copy::new();
    assert_eq!(copy.failing(""), [""; 0], "without a defect nothing fails");
    let mut missed = Vec::new();
    for defect in defects() {
        let failing = copy.failing_with(&defect);
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
fn each_defect_of_people_has_its_place_and_its_test() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap();
    let folders = [
        "src",
        "tests",
        "vectors/conform",
        "bindings/c",
        "bindings/python",
    ];
    let tests = folders.map(|folder| sources(&root.join(folder))).concat();
    for Defect {
        name,
        file,
        edit: [from, to],
        found_by,
    } in of_people()
    {
        let found = fs::read_to_string(root.join(file))
            .unwrap()
            .matches(&from)
            .count();
        assert!(
            found == 1 && from != to,
            "{name}: {file} must have once: {from}"
        );
        let is_there = ["fn", "def"]
            .iter()
            .any(|word| tests.contains(&format!("{word} {found_by}(")));
        assert!(is_there, "{name}: no test {found_by}");
    }
}
