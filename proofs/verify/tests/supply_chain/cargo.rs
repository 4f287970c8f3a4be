//! What cargo says of the crates that are built.

use std::collections::{BTreeMap, BTreeSet};
use std::process::Command;
use std::sync::Mutex;

use super::ROOT;

/// For which the program is shipped.
const TARGET: &str = "x86_64-unknown-linux-gnu";

/// What cargo answers, without the network.
pub fn cargo(arguments: &[&str]) -> String {
    let output = Command::new(env!("CARGO"))
        .args(arguments)
        .arg("--offline")
        .current_dir(ROOT)
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "cargo {arguments:?}: {said}");
    String::from_utf8(output.stdout).unwrap()
}

/// This package in a tree.
pub const OURS: &str = concat!("palpate ", env!("CARGO_PKG_VERSION"));

/// A crate in the tree of dependencies.
#[derive(Debug, Clone)]
pub struct Built {
    pub licence: String,
    pub depends_on: BTreeSet<String>,
}

/// Which edges of the tree to follow.
pub const ALL: &str = "normal,build";
pub const WITHOUT_BUILD_SCRIPTS: &str = "normal";
pub const IN_THE_PROGRAM: &str = "normal,no-proc-macro";

/// Crates by name and version, with a space between them.
pub type Crates = BTreeMap<String, Built>;

/// The crates that the package is built from with these features; itself too.
pub fn tree(features: &'static str, edges: &'static str) -> Crates {
    // Several tests ask the same.
    static KNOWN: Mutex<BTreeMap<(&str, &str), Crates>> = Mutex::new(BTreeMap::new());
    let mut known = KNOWN.lock().unwrap_or_else(|broken| broken.into_inner());
    let crates = known
        .entry((features, edges))
        .or_insert_with(|| asked(features, edges));
    crates.clone()
}

fn asked(features: &str, edges: &str) -> Crates {
    let tree = "tree --locked --package=palpate --no-default-features --no-dedupe --prefix=depth --format=|{p}|{l}";
    let of = ["--target", TARGET, "--features", features, "--edges", edges];
    let words: Vec<&str> = tree.split(' ').chain(of).collect();
    let text = cargo(&words);
    let mut found = Crates::new();
    let mut above: Vec<String> = Vec::new();
    for line in text.lines() {
        let [depth, package, licence] = line.split('|').collect::<Vec<_>>()[..] else {
            panic!("{line}");
        };
        let mut words = package.split(' ');
        let (name, version) = (words.next().unwrap(), words.next().unwrap());
        let name = format!("{name} {}", version.trim_start_matches('v'));
        found.entry(name.clone()).or_insert_with(|| Built {
            licence: licence.replace(" / ", "/").replace('/', " OR "),
            depends_on: BTreeSet::new(),
        });
        above.truncate(depth.parse().unwrap());
        if let Some(parent) = above.last() {
            let parent = found.get_mut(parent).unwrap();
            parent.depends_on.insert(name.clone());
        }
        above.push(name);
    }
    assert!(found.contains_key(OURS), "{text}");
    found
}

/// Every package of the workspace on this platform, as cargo describes it.
pub fn packages() -> Vec<serde_json::Value> {
    let metadata = "metadata --locked --format-version=1 --filter-platform";
    let text = cargo(&metadata.split(' ').chain([TARGET]).collect::<Vec<_>>());
    let metadata: serde_json::Value = serde_json::from_str(&text).unwrap();
    metadata["packages"].as_array().unwrap().clone()
}

/// A package of the lock file.
#[derive(serde::Deserialize)]
pub struct Locked {
    pub name: String,
    pub version: String,
    pub source: Option<String>,
    pub checksum: Option<String>,
}

/// All packages of the lock file.
pub fn locked() -> Vec<Locked> {
    #[derive(serde::Deserialize)]
    struct Lock {
        package: Vec<Locked>,
    }
    let text = std::fs::read_to_string(format!("{ROOT}/Cargo.lock")).unwrap();
    let lock: Lock = toml::from_str(&text).unwrap();
    lock.package
}
