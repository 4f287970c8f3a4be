//! Which requirements `cargo test` leaves unchecked, and what checks them.

use std::collections::{BTreeMap, BTreeSet};

use crate::trace::Trace;

const WITNESSES: &str = "PALPATE_REQUIRE_WITNESSES=1 cargo test";
const CHROMIUM: &str = "PALPATE_REQUIRE_CHROMIUM=1 cargo test";
const WORKSPACE: &str = "cargo test --workspace";
const IGNORED: &str = "cargo test --release -p palpate-proofs -p palpate-verify -- --ignored";
const RECORDS: &str = "cargo test --release --test real_records -- --ignored";
const GENERATED: &str = "cargo test --test vectors_suite -- --ignored";
const BANK: &str = "cargo test --release --test bank_of_the_paper -- --ignored";

/// Evidence that `cargo test` does not run, or skips where a program is missing: by the beginning of its name, with what runs it.
const ELSEWHERE: [(&str, &str); 26] = [
    ("tests/hid-stack/", "tests/hid-stack/run"),
    ("tests/accuracy.rs", WITNESSES),
    ("tests/vectors_suite.rs::the_files_are", GENERATED),
    ("tests/vectors_suite.rs", WITNESSES),
    ("tests/witness/", WITNESSES),
    ("tests/real_records.rs", RECORDS),
    ("tests/bank_of_the_paper.rs", BANK),
    ("tests/report_page/", CHROMIUM),
    ("proofs/src/", WORKSPACE),
    ("proofs/fuzz/", WORKSPACE),
    ("proofs/tests/", IGNORED),
    ("proofs/verify/tests/exhaustive.rs", IGNORED),
    ("proofs/verify/", WORKSPACE),
    ("vectors/conform/", WORKSPACE),
    ("proofs/gappa/", ".ci/run"),
    ("benches/", ".ci/run"),
    (".ci/run", ".ci/run"),
    ("bindings/firmware/", "bindings/firmware/run"),
    ("tests/same_bits/aarch64", "tests/same_bits/aarch64"),
    ("tests/same_bits/", "tests/same_bits/run"),
    ("tests/reproducible/", "tests/reproducible/run"),
    ("tests/slurm/", "tests/slurm/run"),
    ("bindings/c/", "bindings/c/run"),
    ("contrib/github/", "contrib/github/check"),
    ("bindings/python/", "bindings/python/run"),
    ("vectors/adapters/", "vectors/adapters/run"),
];

/// What runs a test or proof that `cargo test` does not run, or skips where a program is missing.
pub fn runner(name: &str) -> Option<&'static str> {
    let mut elsewhere = ELSEWHERE.iter();
    let (_, command) = elsewhere.find(|(begin, _)| name.starts_with(begin))?;
    Some(command)
}

/// What runs one of these tests and proofs, if `cargo test` runs none; `asked` says which of the variables are set.
fn command<'a>(
    evidence: impl IntoIterator<Item = &'a String>,
    asked: &impl Fn(&str) -> bool,
) -> Option<&'static str> {
    let mut commands = evidence.into_iter().map(|name| {
        let command = runner(name)?;
        let variable = command.split_once("=1 cargo");
        let runs = variable.is_some_and(|(variable, _)| asked(variable));
        (!runs).then_some(command)
    });
    let first = commands.next()??;
    commands.all(|command| command.is_some()).then_some(first)
}

/// The requirements that `cargo test` does not check, or not where a program is missing, with what checks them.
pub fn unchecked(trace: &Trace, asked: impl Fn(&str) -> bool) -> String {
    let mut by_command: BTreeMap<&str, BTreeSet<&str>> = BTreeMap::new();
    for row in &trace.requirements {
        if let Some(command) = command(row.tests.iter().chain(&row.proofs), &asked) {
            by_command.entry(command).or_default().insert(&row.id);
        }
    }
    let count: usize = by_command.values().map(BTreeSet::len).sum();
    let mut text = format!("\n{count} requirements are not checked by `cargo test` alone:\n");
    for (command, ids) in by_command {
        let ids: Vec<&str> = ids.into_iter().collect();
        text += &format!("  {} by `{command}`: {}\n", ids.len(), ids.join(" "));
    }
    text
}

#[test]
fn what_runs_elsewhere_alone_is_told_with_its_command() {
    let found = |names: &[&str], variable: &str| {
        let names: Vec<String> = names.iter().map(|name| name.to_string()).collect();
        command(&names, &|asked| asked == variable)
    };
    let witness = "tests/accuracy.rs::a";
    assert_eq!(found(&[witness], ""), Some(WITNESSES));
    assert_eq!(found(&[witness], "PALPATE_REQUIRE_WITNESSES"), None);
    assert_eq!(found(&[witness, "src/lib.rs::b"], ""), None);
    assert_eq!(found(&["src/lib.rs::b", witness], ""), None);
    let both = ["tests/hid-stack/src/main.rs::c", witness];
    assert_eq!(found(&both, ""), Some("tests/hid-stack/run"));
    assert_eq!(found(&[], ""), None);
}
