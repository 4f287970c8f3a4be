//! The rules of `deny.toml`, without `cargo deny`.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use super::ROOT;
use super::cargo::{locked, packages};

#[derive(serde::Deserialize)]
pub struct Rules {
    licenses: Licences,
    pub bans: Bans,
    sources: Sources,
}

#[derive(serde::Deserialize)]
struct Licences {
    allow: Vec<String>,
}

#[derive(serde::Deserialize)]
pub struct Bans {
    deny: Vec<BTreeMap<String, String>>,
    pub skip: Vec<BTreeMap<String, String>>,
}

#[derive(serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
struct Sources {
    /// Absent: cargo's own registry alone.
    #[serde(default)]
    allow_registry: Vec<String>,
    allow_git: Vec<String>,
}

pub fn rules() -> Rules {
    let text = std::fs::read_to_string(format!("{ROOT}/deny.toml")).unwrap();
    toml::from_str(&text).unwrap()
}

/// Major, minor and patch; what follows them is left out.
fn numbers(version: &str) -> Vec<u64> {
    let plain = version.split(['-', '+']).next().unwrap();
    plain.split('.').map(|part| part.parse().unwrap()).collect()
}

impl Bans {
    /// Whether an entry bans it: each is a name and a version that it must not be below.
    fn forbid(&self, name: &str, version: &str) -> bool {
        self.deny.iter().any(|ban| {
            let below = ban["version"].strip_prefix('<').unwrap();
            ban["name"] == name && numbers(version) < numbers(below)
        })
    }
}

/// Whether an SPDX expression can be kept with the allowed licences: of alternatives one is enough. `AND` binds
/// closer than `OR`; a licence with an exception is another licence.
fn allowed(expression: &str, allow: &[String]) -> bool {
    let spaced = expression.replace('/', " OR ").replace(" or ", " OR ");
    let spaced = spaced.replace('(', " ( ").replace(')', " ) ");
    let words: Vec<&str> = spaced.split_whitespace().collect();
    let (verdict, rest) = alternatives(&words, allow);
    assert!(rest.is_empty(), "{expression}");
    verdict
}

fn alternatives<'a, 'b>(words: &'b [&'a str], allow: &[String]) -> (bool, &'b [&'a str]) {
    let (mut verdict, mut rest) = together(words, allow);
    while let ["OR", more @ ..] = rest {
        let (other, after) = together(more, allow);
        (verdict, rest) = (verdict | other, after);
    }
    (verdict, rest)
}

fn together<'a, 'b>(words: &'b [&'a str], allow: &[String]) -> (bool, &'b [&'a str]) {
    let (mut verdict, mut rest) = single(words, allow);
    while let ["AND", more @ ..] = rest {
        let (other, after) = single(more, allow);
        (verdict, rest) = (verdict & other, after);
    }
    (verdict, rest)
}

fn single<'a, 'b>(words: &'b [&'a str], allow: &[String]) -> (bool, &'b [&'a str]) {
    match words {
        ["(", inner @ ..] => match alternatives(inner, allow) {
            (verdict, [")", rest @ ..]) => (verdict, rest),
            _ => panic!("{words:?}"),
        },
        [licence, "WITH", exception, rest @ ..] => {
            let whole = format!("{licence} WITH {exception}");
            (allow.contains(&whole), rest)
        }
        [licence, rest @ ..] => (allow.iter().any(|allowed| allowed == licence), rest),
        [] => panic!("an expression that ends too early"),
    }
}

#[test]
fn alternatives_need_one_licence_and_sums_all() {
    let allow = ["MIT".to_string(), "Unicode-3.0".into()];
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

// Verifies: EVD-063.
#[test]
fn every_licence_is_allowed_and_every_allowance_is_needed() {
    let allow = rules().licenses.allow;
    let mut expressions = Vec::new();
    for package in packages() {
        let licence = package["license"].as_str().unwrap_or("none");
        assert!(allowed(licence, &allow), "{}: {licence}", package["name"]);
        expressions.push(licence.to_string());
    }
    assert!(expressions.len() > 100, "{} packages", expressions.len());
    for licence in &allow {
        let others: Vec<String> = allow.iter().filter(|l| *l != licence).cloned().collect();
        assert!(
            expressions.iter().any(|text| !allowed(text, &others)),
            "{licence} is allowed for nothing"
        );
    }
}

// Verifies: EVD-063.
#[test]
fn no_crate_is_banned() {
    let bans = rules().bans;
    let gemm = |version| bans.forbid("private-gemm-x86", version);
    assert!(gemm("0.1.20") && gemm("0.1.21") && !gemm("0.1.22") && !gemm("0.2.0"));
    assert!(!bans.forbid("libm", "0.1.20"));
    for package in locked() {
        let (name, version) = (&package.name, &package.version);
        assert!(!bans.forbid(name, version), "{name} {version}");
    }
}

// Verifies: EVD-063.
#[test]
fn every_crate_comes_from_the_registry_with_a_checksum() {
    let sources = rules().sources;
    assert!(sources.allow_git.is_empty() && sources.allow_registry.is_empty());
    // One registry, whose address the lock file holds: `cargo deny` compares it with cargo's own.
    let registries: BTreeSet<String> = locked().into_iter().filter_map(|p| p.source).collect();
    assert_eq!(registries.len(), 1, "{registries:?}");
    let mut members = Vec::new();
    for package in locked() {
        match package.source {
            None => members.push(package.name),
            Some(source) => {
                assert!(
                    source.starts_with("registry+https://"),
                    "{}: {source}",
                    package.name
                );
                let checksum = package.checksum.unwrap_or_default();
                assert_eq!(checksum.len(), 64, "{}", package.name);
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

// Verifies: EVD-064.
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
