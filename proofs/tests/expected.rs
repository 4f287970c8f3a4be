//! The proofs that there must be: `expected.txt` beside what the sources have, so that none ceases to run unseen.
#![cfg(not(any(kani, fuzzing)))]

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

/// The name that a line such as `fn name() {` or `macro_rules! name {` defines.
fn defined<'a>(line: &'a str, keyword: &str) -> Option<&'a str> {
    let (name, _) = line.strip_prefix(keyword)?.split_once(['(', ' '])?;
    Some(name)
}

/// The harnesses in a file: each as its line of `expected.txt`, with its module, solver (`none` outside Kani) and requirements.
fn harnesses(module: &str, text: &str) -> BTreeSet<String> {
    let (mut found, mut verifies, mut proof, mut within) = (BTreeSet::new(), "", None, "");
    let row = |name: &str, solver: &str, verifies: &str| {
        format!("{module}::{name} {solver} {}", verifies.replace(", ", ","))
    };
    for line in text.lines().map(str::trim) {
        if let Some(ids) = line.strip_prefix("// Verifies: ") {
            verifies = ids.trim_end_matches('.');
        } else if let Some(name) = defined(line, "macro_rules! ") {
            within = name;
        } else if line == "#[test]" {
            proof = Some("none");
        } else if line.contains("kani::proof") {
            let (_, solver) = line
                .split_once("kani::solver(")
                .expect("each proof names its solver");
            proof = solver.split_once(')').map(|(solver, _)| solver);
        } else if let Some((name, solver)) = defined(line, "fn ").zip(proof) {
            proof = None;
            if name != "$name" {
                found.insert(row(name, solver, verifies));
                continue;
            }
            let start = format!("\n{within}!");
            let uses = text.split(&start).skip(1).filter_map(|rest| {
                rest.trim_start_matches(['(', '{', ' '])
                    .split([',', ')'])
                    .next()
            });
            found.extend(uses.map(|name| row(name, solver, verifies)));
        }
    }
    found
}

#[test]
fn the_harnesses_are_those_that_are_expected() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut found = BTreeSet::new();
    for entry in fs::read_dir(folder.join("src")).unwrap() {
        let path = entry.unwrap().path();
        let module = path.file_stem().unwrap().to_str().unwrap();
        found.extend(harnesses(module, &fs::read_to_string(&path).unwrap()));
    }
    for entry in fs::read_dir(folder.join("gappa")).unwrap() {
        let path = entry.unwrap().path();
        let text = fs::read_to_string(&path).unwrap();
        let proved = text
            .lines()
            .find_map(|line| line.strip_prefix("# Proves: "));
        let (ids, _) = proved.unwrap().split_once('.').unwrap();
        let name = path.file_name().unwrap().to_str().unwrap();
        found.insert(format!("gappa/{name} gappa {ids}"));
    }
    let rows = include_str!("../expected.txt").lines();
    let rows = rows.filter(|line| !line.starts_with('#'));
    // The last word of a row says where Kani verified it.
    let expected = rows.filter_map(|row| Some(row.rsplit_once(' ')?.0.to_string()));
    assert_eq!(found, expected.collect());
}
