//! Faults planted into a small repository: each must be found, with its place.

use palpate_verify::test_run::{End, Requirement, TestRun};

use crate::annotations::Traceability;
use crate::listed;
use crate::repository::Repository;
use crate::results::Results;

/// A repository that is as it should be. The search of the real sources would take the words of annotations for theirs, so
/// these are `{I}`, `{V}` and `{P}` here. `programs` is no file, but what cargo says of the workspace.
const SOUND: &str = r#"
=== spec/a.md
# A

- **AAA-001** It MUST be `right`,
  always.
- **AAA-002** So [MUST](b.md) that.

| **AAA-003** | printed | true |
=== programs
src/lib.rs small-one
tests/slow/main.rs small-one::slow
tests/hid-stack/src/main.rs guest::bin/guest
=== src/lib.rs
//! {I}: AAA-003.

mod deep;

impl<'a> One<'a> {
    /// Does it.
    ///
    /// {I}: AAA-001,
    /// AAA-002.
    #[inline]
    pub fn it(&self) {
    }
}
=== src/deep/mod.rs
mod tests {
    // {V}: AAA-001. And more.
    #[test]
    fn holds() {
    }
}
proptest! {
    #![proptest_config(many())]

    // {V}: AAA-002.
    #[test]
    fn any(x in 0..3) {
    }
}
=== tests/slow/main.rs
mod cases;

// {V}: AAA-002.
#[test]
#[ignore = "slow"]
fn waits() {
}
=== tests/slow/cases.rs
// {V}: AAA-002.
#[test]
fn named() {
}
macro_rules! made {
    ($name:ident) => {
        // {V}: AAA-001.
        #[test]
        fn $name() {}
    };
}

made!(by_macro);
=== tests/hid-stack/src/main.rs
/// {V}: AAA-001.
fn held_up() {
}
/// {V}: AAA-002.
fn lost() {
}
=== benches/quick.rs
// {V}: AAA-003.
fn main() {
}
=== proofs/bound.g
# {P}: AAA-003.
=== vectors/kind.json
=== vectors/generator/kinds.py
# {V}: AAA-001.
def kind():
    pass
"#;

fn words(text: &str) -> String {
    text.replace("{I}", "Implements")
        .replace("{V}", "Verifies")
        .replace("{P}", "Proves")
}

/// What is found with `from` replaced by `to` in a file, which must hold it.
fn changed(path: &str, from: &str, to: &str) -> Traceability {
    let mut repository = Repository::default();
    for file in SOUND.split("\n=== ").skip(1) {
        let (name, text) = file.split_once('\n').unwrap_or((file, ""));
        let mut text = text.to_string() + "\n";
        if name == path {
            assert!(text.contains(from), "{path}: {from}\n{text}");
            text = text.replacen(from, to, 1);
        }
        if name == "programs" {
            let programs = text.lines().filter_map(|line| line.split_once(' '));
            repository.programs = programs
                .map(|(root, id)| (root.into(), id.into()))
                .collect();
        } else {
            repository.files.insert(name.into(), words(&text));
        }
    }
    Traceability::of(&repository)
}

fn sound() -> Traceability {
    changed("programs", "small", "small")
}

#[test]
fn a_sound_repository_has_its_evidence() {
    let found = sound();
    assert_eq!(listed(&found.problems), "");
    let row = |line: &str| {
        let [id, text, code, tests, proofs, vectors] = cells(line);
        let names = |text: String| {
            let names = text.split("; ").filter(|name| !name.is_empty());
            names.map(String::from).collect()
        };
        Requirement {
            id,
            chapter: "a.md".into(),
            text,
            code: names(code),
            tests: names(tests),
            proofs: names(proofs),
            vectors: names(vectors),
        }
    };
    let rows: Vec<Requirement> = ROWS.trim().lines().map(row).collect();
    assert_eq!(found.requirements, rows);
}

/// The requirements of the sound repository: id, text, code, tests, proofs and vectors.
const ROWS: &str = "
AAA-001 ¦ It MUST be right, always. ¦ src/lib.rs One::it ¦ small-one deep::tests::holds; small-one::slow cases::by_macro; tests/hid-stack/run held_up ¦  ¦ vectors/kind.json
AAA-002 ¦ So MUST that. ¦ src/lib.rs One::it ¦ small-one deep::any; small-one::slow cases::named; small-one::slow waits; tests/hid-stack/run lost ¦  ¦
AAA-003 ¦ printed | true ¦ src/lib.rs ¦ benches/quick.rs ¦ proofs/bound.g ¦
";

/// The cells of a row. `\n` is a line's end, `\t` a tab.
fn cells<const N: usize>(row: &str) -> [String; N] {
    let cells = row.split('¦').map(|cell| {
        let cell = cell.strip_prefix(' ').unwrap_or(cell);
        let cell = cell.strip_suffix(' ').unwrap_or(cell);
        cell.replace("\\n", "\n").replace("\\t", "\t")
    });
    let cells: Vec<String> = cells.collect();
    cells.try_into().unwrap_or_else(|_| panic!("{row}"))
}

/// Faults, a line each: a file, a text in it, what stands there instead, and what is found. `\n` is a line's end.
const FAULTS: &str = r#"
spec/a.md ¦ \n|  ¦ - **AAA-009** It MUST.\n\n|  ¦ spec/a.md:6: AAA-009 has no code
spec/a.md ¦ \n|  ¦ - **AAA-009** It MUST.\n\n|  ¦ spec/a.md:6: AAA-009 has neither test nor proof
tests/hid-stack/src/main.rs ¦ AAA-001 ¦ AAA-004 ¦ tests/hid-stack/src/main.rs:1: no chapter in spec/ has a requirement AAA-004
spec/a.md ¦ \n|  ¦ - **AAA-001** It MUST again.\n\n|  ¦ spec/a.md:6: AAA-001 is defined a second time; first in spec/a.md:3
src/deep/mod.rs ¦ #[test]\n    fn any ¦ fn any ¦ src/deep/mod.rs:10: `any` below it has no #[test]
spec/a.md ¦ So [MUST](b.md) ¦ So should ¦ spec/a.md:5: AAA-002 has no MUST
spec/a.md ¦ # A\n ¦ # A, with **AAA-008** in it\n ¦ spec/a.md:1: **AAA-008** begins neither an item of a list
tests/slow/cases.rs ¦ AAA-002. ¦ AAA-002 ¦ tests/slow/cases.rs:1: "{V}: AAA-002" is no annotation; it must be like
tests/slow/cases.rs ¦ {V}: ¦ {V} ¦ tests/slow/cases.rs:1: "// {V} AAA-002." is no annotation: a comment
tests/slow/cases.rs ¦ AAA-002 ¦ AAA-2 ¦ tests/slow/cases.rs:1: "{V}: AAA-2." is no annotation
tests/slow/cases.rs ¦ AAA-002 ¦ AAA-002 AAA-001 ¦ tests/slow/cases.rs:1: "{V}: AAA-002 AAA-001." is no annotation
tests/slow/cases.rs ¦ AAA-002 ¦ AAA-002 and AAA-001 ¦ tests/slow/cases.rs:1: "{V}: AAA-002 and AAA-001." is no annotation
tests/slow/cases.rs ¦ AAA-002. ¦ AAA-002, ¦ tests/slow/cases.rs:1: "{V}: AAA-002," is no annotation
tests/slow/cases.rs ¦ {V} ¦ verifies ¦ tests/slow/cases.rs:1: "// verifies: AAA-002." is no annotation
tests/slow/cases.rs ¦ {V} ¦ This one {V} ¦ tests/slow/cases.rs:1: "// This one {V}: AAA-002." is no annotation
tests/slow/cases.rs ¦ // ¦ const X: u8 = 1; // ¦ tests/slow/cases.rs:1: "const X: u8 = 1; // {V}: AAA-002." is no annotation
tests/slow/cases.rs ¦ #[test]\n ¦  ¦ tests/slow/cases.rs:1: `named` below it has no #[test]
tests/slow/cases.rs ¦ #[test]\nfn named() { ¦ struct Named { ¦ tests/slow/cases.rs:1: `Named` below it has no #[test]
tests/slow/cases.rs ¦ ($name:ident) => {\n        // {V}: AAA-001.\n        #[test] ¦ ($name:ident) => {\n        // {V}: AAA-001. ¦ tests/slow/cases.rs:7: `by_macro` below it has no #[test]
tests/slow/cases.rs ¦ made!(by_macro) ¦ mad!(by_macro) ¦ tests/slow/cases.rs:7: it does not stand above a test function
tests/slow/cases.rs ¦ named() { ¦ named() {{ ¦ tests/slow/cases.rs:
tests/slow/cases.rs ¦ #[test]\n ¦ \n#[test]\n ¦ tests/slow/cases.rs:1: it does not stand above a test function
programs ¦ tests/slow/ ¦ tests/fast/ ¦ tests/slow/cases.rs:1: the file belongs to no program
src/lib.rs ¦ /// {I}: AAA-001,\n    /// AAA-002.\n ¦ // {I}: AAA-001,\n    // AAA-002.\n\n ¦ src/lib.rs:8: below it stands no item
vectors/generator/kinds.py ¦ def kind( ¦ def sort( ¦ vectors/generator/kinds.py:1: there is no vectors/sort.json
tests/slow/cases.rs ¦ {V} ¦ {P} ¦ tests/slow/cases.rs:1: "Proves:" stands in proofs/ alone
"#;

#[test]
fn a_planted_fault_is_named_with_its_place() {
    for line in FAULTS.trim().lines() {
        let [path, from, to, found] = cells(line);
        let problems = listed(&changed(&path, &from, &to).problems);
        let named = problems.contains(&format!("\n{}", words(&found)));
        assert!(named, "{line}: {problems}");
    }
}

/// The steps of a run in which everything passed.
const STEPS: &str = "\
commit\t\t0123
system\t\tDebian
passed\t3\tcargo bench --bench quick
passed\t7\tgappa proofs/bound.g
passed\t60\tenv A=1 tests/hid-stack/run
";

/// Tests of that run by cargo-nextest: the ordinary ones, then those that are ignored by default.
const TESTS: [&str; 2] = [
    r#"<?xml version="1.0" encoding="UTF-8"?>
<testsuites name="nextest-run" tests="3" failures="0" errors="0">
    <testsuite name="small-one" tests="1" disabled="0" errors="0" failures="0">
        <testcase name="deep::any" classname="small-one" time="0.75"/>
        <testcase name="deep::tests::holds" classname="small-one" time="0.25"/>
    </testsuite>
    <testsuite name="small-one::slow" tests="2" disabled="0" errors="0" failures="0">
        <testcase name="cases::named" classname="small-one::slow" time="0.125">
        </testcase>
        <testcase name="cases::by_macro" classname="small-one::slow" time="0.5"/>
    </testsuite>
</testsuites>
"#,
    r#"<testsuites name="nextest-run">
    <testsuite name="small-one::slow">
        <testcase name="waits" classname="small-one::slow" time="2.5"/>
    </testsuite>
</testsuites>
"#,
];

/// The results with `from` replaced by `to`, which one of the files must hold.
fn results(from: &str, to: &str) -> Results {
    let files = [STEPS, TESTS[0], TESTS[1]];
    assert!(files.iter().any(|text| text.contains(from)), "{from}");
    let [steps, ordinary, ignored] = files.map(|text| text.replacen(from, to, 1));
    let mut results = Results::default();
    results.add_steps(&steps).expect("three columns");
    for junit in [ordinary, ignored] {
        results.add_junit(&junit).expect("well formed");
    }
    results
}

/// What is changed in those results, and what is then missing.
const MISSED: &str = r#"
time="0.25"/> ¦ ><failure/></testcase> ¦ small-one deep::tests::holds failed (AAA-001)
time="0.25"/> ¦ ><error/></testcase> ¦ small-one deep::tests::holds failed (AAA-001)
time="0.25"/> ¦ ><skipped/></testcase> ¦ small-one deep::tests::holds did not run (AAA-001)
tests::holds ¦ tests::renamed ¦ small-one deep::tests::holds did not run (AAA-001)
testsuite name="small-one" ¦ testsuite name="another" ¦ small-one deep::any did not run (AAA-002), small-one deep::tests::holds did not run (AAA-001)
name="waits" ¦ name="waits_no_more" ¦ small-one::slow waits has the attribute #[ignore], and no step ran it (AAA-002)
time="2.5"/> ¦ ><failure/></testcase> ¦ small-one::slow waits failed (AAA-002)
tests/hid-stack/run ¦ tests/hid-stack/ran ¦ tests/hid-stack/run held_up did not run (AAA-001), tests/hid-stack/run lost did not run (AAA-002)
proofs/bound.g ¦ proofs/bound.gg ¦ proofs/bound.g did not run (AAA-003)
passed\t7 ¦ began\t7 ¦ proofs/bound.g did not run (AAA-003)
passed\t7 ¦ failed\t7 ¦ proofs/bound.g failed (AAA-003)
--bench quick ¦ --bench quicker ¦ benches/quick.rs did not run (AAA-003)
"#;

#[test]
fn a_test_that_did_not_pass_is_named_with_its_requirements() {
    let missing = |from: &str, to: &str| results(from, to).missing(&sound()).join(", ");
    assert_eq!(missing("Debian", "another"), "");
    for line in MISSED.trim().lines() {
        let [from, to, found] = cells(line);
        assert_eq!(missing(&from, &to), found, "{from}");
    }
}

#[test]
fn what_is_left_to_the_night_is_not_missed_by_day() {
    let missing = |steps: &str| {
        let mut results = results("name=\"waits\"", "name=\"other\"");
        results.add_steps(steps).expect("three columns");
        results.missing(&sound()).len()
    };
    assert_eq!(missing(""), 1);
    for (options, number) in [
        ("--release -p other -p small-one --run-ignored only", 0),
        ("--test slow --run-ignored only", 0),
        ("-p small-one", 1),
        ("-p small --run-ignored only", 1),
        ("-p small-one --test quick --run-ignored only", 1),
    ] {
        let left = format!("left\t\tcargo nextest run {options}\n");
        assert_eq!(missing(&left), number, "{options}");
    }
    let left = results("passed\t60", "left\t").missing(&sound());
    assert_eq!(left, [""; 0]);
    // It hides no failure, and no test of another kind.
    let left = "left\t\tcargo nextest run -p small-one --run-ignored only\n";
    for (from, to) in [
        ("time=\"2.5\"/>", "><failure/></testcase>"),
        ("holds", "held"),
    ] {
        let mut results = results(from, to);
        results.add_steps(left).expect("three columns");
        assert_eq!(results.missing(&sound()).len(), 1, "{from}");
    }
}

#[test]
fn what_is_left_to_the_day_is_not_missed_by_night() {
    let left = |step: &str| {
        let mut results = results("tests::holds", "tests::renamed");
        results.add_steps(&format!("left\t\t{step}\n")).unwrap();
        results.missing(&sound())
    };
    assert_eq!(left("cargo nextest run --workspace"), [""; 0]);
    assert_eq!(left("cargo nextest run -p small-one"), [""; 0]);
    for other in [
        "cargo nextest run --workspace --test slow",
        "cargo nextest run --workspace --run-ignored only",
        "cargo clippy --workspace",
    ] {
        assert_eq!(left(other).len(), 1, "{other}");
    }
}

#[test]
fn the_test_run_has_what_became_of_each_test_and_who_ran_it() {
    let mut results = results("name=\"waits\"", "name=\"other\"");
    let left = "left\t\ttests/same_bits/run\n";
    results.add_steps(left).expect("three columns");
    let traceability = sound();
    let run: TestRun = results.test_run(&traceability);
    let facts = [&*run.commit, &*run.system, &*run.ended];
    assert_eq!(facts, ["0123", "Debian", "not known"]);
    let text = [STEPS, TESTS[0], &TESTS[1].replace("waits", "other"), left].concat();
    assert_eq!(run.results_sha256, palpate_conform::sha256(text));
    assert_eq!(run.requirements, traceability.requirements);
    for (name, result, seconds) in [
        ("small-one deep::tests::holds", End::Passed, Some(0.25)),
        ("small-one::slow other", End::Passed, Some(2.5)),
        ("small-one::slow waits", End::Ignored, None),
        ("proofs/bound.g", End::Passed, Some(7.0)),
        ("gappa proofs/bound.g", End::Passed, Some(7.0)),
        ("tests/hid-stack/run lost", End::Passed, Some(60.0)),
        ("tests/same_bits/run", End::Left, None),
    ] {
        let found = run.entries.iter().filter(|entry| entry.name == name);
        let [entry] = found.collect::<Vec<_>>()[..] else {
            panic!("{name}");
        };
        assert_eq!((entry.result, entry.seconds), (result, seconds), "{name}");
    }
}

#[test]
fn results_that_cannot_be_read_are_refused() {
    let mut results = Results::default();
    let error = results.add_steps("passed 3 cargo doc\n").unwrap_err();
    assert!(error.starts_with("\"passed 3 cargo doc\" does not have three parts"));
    for text in [
        "",
        "<testsuites>",
        "<testsuites><testcase name=\"a\"/></testsuites>",
    ] {
        assert!(results.add_junit(text).is_err(), "{text}");
    }
}
