//! The rules of `deny.toml`, without `cargo deny`.

use std::collections::BTreeSet;
use std::path::Path;

use super::ROOT;
use super::cargo::{locked, packages};

pub fn rules() -> toml::Table {
    let text = std::fs::read_to_string(format!("{ROOT}/deny.toml")).unwrap();
    text.parse().unwrap()
}

/// Major, minor and patch; what follows them is left out.
fn numbers(version: &str) -> Vec<u64> {
    let plain = version.split(['-', '+']).next().unwrap();
    plain.split('.').map(|part| part.parse().unwrap()).collect()
}

/// Whether a ban of the rules forbids it: each is a name and a version that it must not be below.
fn forbidden(bans: &toml::Value, name: &str, version: &str) -> bool {
    bans["deny"].as_array().unwrap().iter().any(|ban| {
        let below = ban["version"].as_str().unwrap().strip_prefix('<').unwrap();
        ban["name"].as_str() == Some(name) && numbers(version) < numbers(below)
    })
}

/// Whether an SPDX expression can be kept with the allowed licences: of alternatives one is enough. `AND` binds
/// closer than `OR`; a licence with an exception is another licence.
fn allowed(expression: &str, allow: &[&str]) -> bool {
    let spaced = expression.replace('/', " OR ").replace(" or ", " OR ");
    let plain = spaced.trim();
    let inner = plain.strip_prefix('(');
    let inner = inner.and_then(|inner| inner.strip_suffix(')'));
    match (parts(plain, " OR "), parts(plain, " AND "), inner) {
        (any, ..) if any.len() > 1 => any.iter().any(|part| allowed(part, allow)),
        (_, all, _) if all.len() > 1 => all.iter().all(|part| allowed(part, allow)),
        (.., Some(inner)) => allowed(inner, allow),
        _ => allow.contains(&plain),
    }
}

/// An expression between the places of a word that are in no parentheses.
fn parts<'a>(expression: &'a str, word: &str) -> Vec<&'a str> {
    let (mut parts, mut start, mut depth) = (Vec::new(), 0, 0);
    for (at, c) in expression.char_indices() {
        depth += i32::from(c == '(') - i32::from(c == ')');
        if depth == 0 && expression[at..].starts_with(word) {
            parts.push(&expression[start..at]);
            start = at + word.len();
        }
    }
    parts.push(&expression[start..]);
    parts
}

#[test]
fn alternatives_need_one_licence_and_sums_all() {
    let allow = ["MIT", "Unicode-3.0"];
    for (expression, verdict) in [
        ("MIT", true),
        ("GPL-3.0", false),
        ("GPL-3.0/MIT", true),
        ("MIT AND GPL-3.0", false),
        ("(MIT OR Apache-2.0) AND Unicode-3.0", true),
        ("GPL-3.0 OR MIT AND Apache-2.0", false),
        ("Apache-2.0 WITH LLVM-exception OR MIT", true),
        ("MIT WITH Strange-exception", false),
    ] {
        assert_eq!(allowed(expression, &allow), verdict, "{expression}");
    }
}

#[test]
fn every_licence_is_allowed_and_every_allowance_is_needed() {
    let rules = rules();
    let allow = rules["licenses"]["allow"].as_array().unwrap().iter();
    let allow: Vec<&str> = allow.map(|licence| licence.as_str().unwrap()).collect();
    let mut expressions = Vec::new();
    for package in packages() {
        let licence = package["license"].as_str().unwrap_or("none");
        assert!(allowed(licence, &allow), "{}: {licence}", package["name"]);
        expressions.push(licence.to_string());
    }
    assert!(expressions.len() > 100, "{} packages", expressions.len());
    for licence in &allow {
        let others: Vec<&str> = allow.iter().filter(|l| *l != licence).copied().collect();
        let is_needed = expressions.iter().any(|text| !allowed(text, &others));
        assert!(is_needed, "{licence} is allowed for nothing");
    }
}

#[test]
fn no_crate_is_banned() {
    let bans = &rules()["bans"];
    let gemm = |version| forbidden(bans, "private-gemm-x86", version);
    assert!(gemm("0.1.20") && gemm("0.1.21") && !gemm("0.1.22") && !gemm("0.2.0"));
    assert!(!forbidden(bans, "libm", "0.1.20"));
    for package in locked() {
        let (name, version) = (&package.name, &package.version);
        assert!(!forbidden(bans, name, version), "{name} {version}");
    }
}

#[test]
fn every_crate_comes_from_the_registry_with_a_checksum() {
    // Without `allow-registry`, cargo's own registry alone.
    let sources = &rules()["sources"];
    assert!(sources["allow-git"].as_array().unwrap().is_empty());
    assert!(sources.get("allow-registry").is_none());
    // One registry, whose address the lock file holds: `cargo deny` compares it with cargo's own.
    let registries: BTreeSet<String> = locked().into_iter().filter_map(|p| p.source).collect();
    assert_eq!(registries.len(), 1, "{registries:?}");
    let mut members = Vec::new();
    for package in locked() {
        match package.source {
            None => members.push(package.name),
            Some(source) => {
                let name = package.name;
                assert!(source.starts_with("registry+https://"), "{name}: {source}");
                assert_eq!(package.checksum.unwrap_or_default().len(), 64, "{name}");
            }
        }
    }
    // A member of the workspace has no source, and lies in this folder.
    let root = std::fs::canonicalize(ROOT).unwrap();
    let local: Vec<String> = (packages().iter())
        .filter(|package| package["source"].is_null())
        .map(|package| {
            let manifest = package["manifest_path"].as_str().unwrap();
            assert!(Path::new(manifest).starts_with(&root), "{manifest}");
            package["name"].as_str().unwrap().to_string()
        })
        .collect();
    for name in &members {
        assert!(local.contains(name), "{name} has no source");
    }
    assert!(members.contains(&"palpate".to_string()));
}

#[test]
fn no_crate_asks_for_a_newer_rust_than_we_do() {
    let ours = numbers(env!("CARGO_PKG_RUST_VERSION"));
    let mut asking = 0;
    for package in packages() {
        let Some(version) = package["rust_version"].as_str() else {
            continue;
        };
        asking += 1;
        let asked = numbers(version);
        // `1.89` is `1.89.0`.
        assert!(asked[..2] <= ours[..2], "{}: {version}", package["name"]);
    }
    assert!(asking > 50, "{asking} say so");
}
