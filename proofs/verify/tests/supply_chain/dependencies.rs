//! The crates on which the program depends, by `cargo metadata`. Licences, bans and sources are `cargo deny`'s.

use std::collections::BTreeSet;

use serde_json::Value;

use super::{ROOT, cargo};

/// Every package of the workspace on the platform for which the program is shipped, as cargo describes it.
fn packages() -> Vec<Value> {
    let platform = "--filter-platform=x86_64-unknown-linux-gnu";
    let text = cargo(&["metadata", "--locked", "--format-version=1", platform]);
    let metadata: Value = serde_json::from_str(&text).unwrap();
    metadata["packages"].as_array().unwrap().clone()
}

/// Whether a package builds the program.
fn builds_the_program(package: &Value) -> bool {
    let mut targets = package["targets"].as_array().unwrap().iter();
    targets.any(|target| target["kind"][0] == "bin" && target["name"] == "palpate")
}

#[test]
fn the_specification_has_the_reason_for_each_direct_dependency_of_the_program() {
    let packages = packages();
    let mut found = BTreeSet::new();
    // The members of the workspace of which the program is made.
    let mut members: Vec<&Value> = packages
        .iter()
        .filter(|package| builds_the_program(package))
        .collect();
    while let Some(member) = members.pop() {
        let all = member["dependencies"].as_array().unwrap().iter();
        for dependency in all.filter(|dependency| dependency["kind"] != "dev") {
            if dependency["source"].is_null() {
                let named = |package: &&Value| package["name"] == dependency["name"];
                members.extend(packages.iter().find(named));
            } else {
                found.insert(dependency["name"].as_str().unwrap());
            }
        }
    }
    assert!(found.contains("libm") && found.len() > 15, "{found:?}");
    let spec = std::fs::read_to_string(format!("{ROOT}/spec/supply-chain.md")).unwrap();
    let (_, table) = spec.split_once("| crate | why |\n|---|---|\n").unwrap();
    let rows = table
        .lines()
        .map_while(|row| row.strip_prefix("| ")?.split_once(" | "));
    let (mut listed, mut reasons): (BTreeSet<&str>, Vec<&str>) = (BTreeSet::new(), Vec::new());
    for (name, reason) in rows {
        assert!(listed.insert(name), "{name} twice");
        reasons.push(reason);
    }
    assert_eq!(listed, found);
    assert!(
        reasons.iter().all(|reason| reason.len() > 20),
        "{reasons:?}"
    );
}

#[test]
fn the_core_depends_on_libm_alone() {
    let tree =
        "tree --locked --package=palpate-core --edges=normal,build --prefix=none --format={lib}";
    let tree = cargo(&tree.split(' ').collect::<Vec<_>>());
    assert_eq!(tree.lines().collect::<Vec<_>>(), ["palpate_core", "libm"]);
}

#[test]
fn no_crate_needs_a_newer_rust_than_we_do() {
    // `1.89` is `1.89.0`.
    let minor = |version: &str| version.split('.').nth(1).unwrap().parse::<u32>().unwrap();
    let ours = minor(env!("CARGO_PKG_RUST_VERSION"));
    let packages = packages();
    let stated = packages.iter().filter_map(|package| {
        let version = package["rust_version"].as_str()?;
        Some((&package["name"], version))
    });
    assert!(stated.clone().count() > 50);
    for (name, version) in stated {
        assert!(
            version.starts_with("1.") && minor(version) <= ours,
            "{name}: {version}"
        );
    }
}
