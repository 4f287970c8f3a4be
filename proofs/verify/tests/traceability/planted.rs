//! Faults planted into a small repository: each must be found, with its place.

use crate::listed;
use palpate_verify::record::End;

use crate::log::Log;
use crate::repository::Repository;
use crate::trace::Trace;

/// A repository that is as it should be. The search of the real sources would take the words of annotations for theirs, so
/// these are `{I}`, `{V}` and `{P}` here.
const SOUND: &str = r#"
=== spec/a.md
# A

- **AAA-001** It MUST be `right`,
  always.
- **AAA-002** So [MUST](b.md) that.

| **AAA-003** | printed | true |
=== Cargo.toml
[package]
name = "small-one"
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
=== tests/hid-stack/Cargo.toml
[package]
name = "guest"
=== tests/hid-stack/src/main.rs
pub const ALL: &[(&str, Scenario)] = &[
    ("held up", || held_up("a", 1)),
    (
        "lost",
        crate::lost,
    ),
];
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
=== .ci/run
# {V}: AAA-003.
step cargo doc
"#;

fn words(text: &str) -> String {
    text.replace("{I}", "Implements")
        .replace("{V}", "Verifies")
        .replace("{P}", "Proves")
}

/// The trace with `from` replaced by `to` in a file, which must hold it.
fn changed(path: &str, from: &str, to: &str) -> Trace {
    let mut repository = Repository::new();
    for file in SOUND.split("\n=== ").skip(1) {
        let (name, text) = file.split_once('\n').unwrap_or((file, ""));
        let mut text = text.to_string() + "\n";
        if name == path {
            assert!(text.contains(from), "{path}: {from}\n{text}");
            text = text.replacen(from, to, 1);
        }
        repository.insert(name.into(), words(&text));
    }
    Trace::of(&repository)
}

fn sound() -> Trace {
    changed("Cargo.toml", "small", "small")
}

#[test]
fn a_sound_repository_has_its_trace() {
    let trace = sound();
    assert_eq!(listed(&trace.problems), "");
    assert_eq!(
        palpate_verify::traceability::csv(&trace.requirements),
        "requirement,chapter,text,code,tests,proofs,vectors,inspection\n\
         AAA-001,a.md,\"It MUST be right, always.\",src/lib.rs One::it,\
         src/lib.rs::deep::tests::holds; tests/hid-stack/src/main.rs::held_up; tests/slow/main.rs::cases::by_macro,,vectors/kind.json,\n\
         AAA-002,a.md,So MUST that.,src/lib.rs One::it,\
         tests/hid-stack/src/main.rs::lost; tests/slow/main.rs::cases::named; tests/slow/main.rs::waits,,,\n\
         AAA-003,a.md,printed | true,src/lib.rs,.ci/run cargo doc; benches/quick.rs,proofs/bound.g,,\n"
    );
}

/// Faults, a line each: a file, a text in it, what stands there instead, and what is found. `\n` is a line's end.
const FAULTS: &str = r#"
spec/a.md ¦ \n|  ¦ - **AAA-009** It MUST.\n\n|  ¦ spec/a.md:6: AAA-009 has no code
spec/a.md ¦ \n|  ¦ - **AAA-009** It MUST.\n\n|  ¦ spec/a.md:6: AAA-009 has neither test nor proof
tests/hid-stack/src/main.rs ¦ AAA-001 ¦ AAA-004 ¦ tests/hid-stack/src/main.rs:8: no chapter in spec/ has a requirement AAA-004
spec/a.md ¦ \n|  ¦ - **AAA-001** It MUST again.\n\n|  ¦ spec/a.md:6: AAA-001 is defined a second time; first in spec/a.md:3
spec/a.md ¦ So [MUST](b.md) ¦ So should ¦ spec/a.md:5: AAA-002 has no MUST
spec/a.md ¦ # A\n ¦ # A, with **AAA-008** in it\n ¦ spec/a.md:1: **AAA-008** begins neither an item of a list
tests/slow/cases.rs ¦ AAA-002. ¦ AAA-002 ¦ tests/slow/cases.rs:1: "{V}: AAA-002" is no annotation, expected
tests/slow/cases.rs ¦ {V}: ¦ {V} ¦ tests/slow/cases.rs:1: "// {V} AAA-002." is no annotation: a comment
tests/slow/cases.rs ¦ AAA-002 ¦ AAA-2 ¦ tests/slow/cases.rs:1: "{V}: AAA-2." is no annotation
tests/slow/cases.rs ¦ AAA-002 ¦ AAA-002 AAA-001 ¦ tests/slow/cases.rs:1: "{V}: AAA-002 AAA-001." is no annotation
tests/slow/cases.rs ¦ AAA-002 ¦ AAA-002 and AAA-001 ¦ tests/slow/cases.rs:1: "{V}: AAA-002 and AAA-001." is no annotation
tests/slow/cases.rs ¦ AAA-002. ¦ AAA-002, ¦ tests/slow/cases.rs:1: "{V}: AAA-002," is no annotation
tests/slow/cases.rs ¦ {V} ¦ verifies ¦ tests/slow/cases.rs:1: "// verifies: AAA-002." is no annotation
tests/slow/cases.rs ¦ {V} ¦ This one {V} ¦ tests/slow/cases.rs:1: "// This one {V}: AAA-002." is no annotation
tests/slow/cases.rs ¦ // ¦ let x = 1; // ¦ tests/slow/cases.rs:1: "let x = 1; // {V}: AAA-002." is no annotation
tests/slow/cases.rs ¦ #[test]\n ¦  ¦ tests/slow/cases.rs:1: `named` below it has no #[test]
tests/slow/cases.rs ¦ fn named() { ¦ struct Named { ¦ tests/slow/cases.rs:1: it does not stand above a test function
tests/slow/cases.rs ¦ #[test]\n ¦ \n#[test]\n ¦ tests/slow/cases.rs:1: it does not stand above a test function
Cargo.toml ¦ name ¦ title ¦ tests/slow/cases.rs:1: the file belongs to no program
src/lib.rs ¦     pub fn it ¦ \n    pub fn it ¦ src/lib.rs:8: below it stands no item
vectors/generator/kinds.py ¦ def kind( ¦ def sort( ¦ vectors/generator/kinds.py:1: there is no vectors/sort.json
tests/slow/cases.rs ¦ {V} ¦ {P} ¦ tests/slow/cases.rs:1: "Proves:" stands in proofs/ alone
.ci/run ¦ AAA-003.\n ¦ AAA-003.\n\n ¦ .ci/run:1: it does not stand above a step
tests/hid-stack/src/main.rs ¦ crate::lost ¦ found ¦ tests/hid-stack/src/main.rs:11: no list `ALL` of scenarios runs `lost`
spec/a.md ¦ always. ¦ always. (by inspection: here) ¦ spec/a.md:3: AAA-001 is marked "by inspection", but there is a test
spec/a.md ¦ \n|  ¦ - **AAA-009** It MUST. (by inspection: )\n\n|  ¦ spec/a.md:6: AAA-009 does not say where it is inspected, and why
spec/a.md ¦ \n|  ¦ - **AAA-009** It MUST. (by inspection: here)\n\n|  ¦ spec/a.md:6: AAA-009 has no code
"#;

#[test]
fn a_planted_fault_is_named_with_its_place() {
    for line in FAULTS.trim().lines() {
        let parts = line.split(" ¦ ").map(|part| part.replace("\\n", "\n"));
        let parts: Vec<String> = parts.collect();
        let [path, from, to, found] = &parts[..] else {
            panic!("{line}");
        };
        let problems = listed(&changed(path, from, to).problems);
        let named = problems.contains(&format!("\n{}", words(found)));
        assert!(named, "{line}: {problems}");
    }
    let inspected = |reasons: std::ops::Range<u32>| {
        let row = |k| format!("- **AAA-1{k}** It MUST. (by inspection: the rule, {k}.)\n");
        let rows = reasons.map(row);
        changed("spec/a.md", "\n| ", &(rows.collect::<String>() + "\n| "))
    };
    let one = &inspected(10..11).requirements[3];
    assert_eq!((&*one.id, &*one.text), ("AAA-110", "It MUST."));
    assert_eq!(one.inspection.as_deref(), Some("the rule, 10."));
    let many = listed(&inspected(10..21).problems);
    let expected =
        "\nspec:0: 11 requirements are marked \"by inspection\", at most 10 may be: AAA-110, ";
    assert!(many.starts_with(expected), "{many}");
}

/// Output of a run in which everything passed, `waits` in the second part.
const PASSED: &str = "\
== cargo test
     Running unittests src/lib.rs (target/debug/deps/small_one-0123456789abcdef)

running 1 test
test deep::tests::holds ... ok

     Running tests/slow/main.rs (/elsewhere/debug/deps/slow-0123456789abcdef)
\u{1b}[0mtest cases::named - should panic ... something printed by another program
\u{1b}[32mok\u{1b}[0m
test cases::by_macro ... ok
test waits ... ignored, slow
   Doc-tests small_one
test src/lib.rs - it (line 3) ... ok
== cargo test -- --ignored
     Running tests/slow/main.rs (target/release/deps/slow-fedcba9876543210)
test waits ... ok
hid-stack: ok held up: 3 ms
hid-stack: ok lost: 3 ms
== ok: cargo doc
== ok: cargo bench --bench quick
== ok: gappa proofs/bound.g
";

/// What is changed in that output, and what is then missing.
const MISSED: &str = r#"
holds ... ok ¦ holds ... FAILED ¦ src/lib.rs::deep::tests::holds failed (AAA-001)
test deep::tests::holds ¦ deep::tests::holds ¦ src/lib.rs::deep::tests::holds did not run: the log has no "small_one src/lib.rs deep::tests::holds" (AAA-001)
test deep::tests::holds ¦ test deep::tests::renamed ¦ src/lib.rs::deep::tests::holds did not run: the log has no "small_one src/lib.rs deep::tests::holds" (AAA-001)
small_one- ¦ another- ¦ src/lib.rs::deep::tests::holds did not run: the log has no "small_one src/lib.rs deep::tests::holds" (AAA-001)
waits ... ok ¦ waits ... ignored, slow ¦ tests/slow/main.rs::waits was ignored in every run (AAA-002)
waits ... ok ¦ waits ... FAILED ¦ tests/slow/main.rs::waits failed (AAA-002)
ok lost ¦ FAILED lost ¦ tests/hid-stack/src/main.rs::lost did not run: the log has no "hid-stack: ok lost" (AAA-002)
== ok: gappa ¦ == gappa ¦ proofs/bound.g did not run: the log has no "proofs/bound.g" (AAA-003)
--bench quick ¦ --bench quicker ¦ benches/quick.rs did not run: the log has no "benches/quick.rs" (AAA-003)
== ok: cargo doc ¦ == cargo doc ¦ .ci/run cargo doc did not run: the log has no "== ok: cargo doc" (AAA-003)
"#;

#[test]
fn what_is_left_to_the_night_is_not_missed_by_day() {
    // The slow test and the bound where what runs them is known.
    let mut trace = sound();
    for (from, to) in [
        ("tests/slow/main.rs::waits", "proofs/tests/slow.rs::waits"),
        ("proofs/bound.g", "tests/same_bits/run"),
    ] {
        let lines = trace.evidence.remove(from).expect("in the sound trace");
        trace.evidence.insert(to.into(), lines);
    }
    let left = "== left to .ci/run all:";
    let by_day = PASSED
        .replace("waits ... ok", "waits ... ignored, slow")
        .replace(
            "== ok: gappa proofs/bound.g",
            &format!("{left} tests/same_bits/run"),
        )
        .replace(
            "hid-stack: ok lost: 3 ms",
            &format!("{left} env A=1 tests/hid-stack/run"),
        );
    let missing = |output: &str, trace: &Trace| {
        let mut log = Log::default();
        log.read(output);
        log.missing(trace)
    };
    assert_eq!(missing(&by_day, &trace).len(), 1);
    let ignored = "cargo test --release -p palpate-proofs -p palpate-verify -- --ignored";
    let left = format!("{by_day}{left} {ignored}\n");
    assert_eq!(missing(&left, &trace), Vec::<String>::new());
    // It hides no failure, no test that nothing runs, and none that is not even listed.
    let failed = left.clone() + &PASSED.replace("waits ... ok", "waits ... FAILED");
    let unlisted = left.replace("test waits", "waits");
    assert_eq!(missing(&failed, &trace).len(), 1);
    assert_eq!(missing(&left, &sound()).len(), 2);
    assert_eq!(missing(&unlisted, &trace).len(), 1);
}

#[test]
fn a_test_that_did_not_pass_is_named_with_its_requirements() {
    let missing = |from: &str, to: &str| {
        assert_eq!(PASSED.matches(from).count(), 1, "{from}");
        let mut log = Log::default();
        log.read(PASSED.replace(from, to));
        log.missing(&sound()).join("\n")
    };
    assert_eq!(missing("running 1 test\n", ""), "");
    for line in MISSED.trim().lines() {
        let parts: Vec<&str> = line.split(" ¦ ").collect();
        let [from, to, found] = parts[..] else {
            panic!("{line}");
        };
        assert_eq!(missing(from, to), found, "{from}");
    }
}

#[test]
fn the_record_has_what_became_of_each_test_and_who_ran_it() {
    let mut log = Log::default();
    let timed = PASSED.replace(
        "waits ... ok",
        "waits ... ok\ntest result: ok. 1 passed; 0 failed; finished in 2.50s",
    );
    let step = "== 7 s\n== ok: gappa proofs/bound.g";
    let outputs = [
        timed.replace("== ok: gappa proofs/bound.g", step),
        "== commit: 0123\n== system: Debian\n== left to .ci/run all: tests/same_bits/run\n".into(),
    ];
    outputs.iter().for_each(|output| log.read(output));
    let mut trace = sound();
    trace.evidence.insert(
        "tests/same_bits/run".into(),
        vec!["tests/same_bits/run".into()],
    );
    trace.evidence.insert(
        "src/lib.rs::never".into(),
        vec!["small src/lib.rs never".into()],
    );
    let record = log.record(&trace);
    assert_eq!(
        (&*record.commit, &*record.system, &*record.ended),
        ("0123", "Debian", "not known")
    );
    assert_eq!(record.log_sha256, palpate_conform::sha256(outputs.concat()));
    let entry = |name: &str| {
        let entry = record.entries.iter().find(|entry| entry.name == name);
        entry
            .map(|entry| (entry.result, entry.seconds))
            .unwrap_or_else(|| panic!("{name}"))
    };
    assert_eq!(entry("tests/slow/main.rs::waits"), (End::Passed, Some(2.5)));
    assert_eq!(entry("proofs/bound.g"), (End::Passed, Some(7.0)));
    assert_eq!(entry("tests/same_bits/run"), (End::Left, None));
    assert_eq!(entry("src/lib.rs::never"), (End::Missing, None));
}
