//! Faults planted into a small repository: each must be found, with its place.

use crate::log::Log;
use crate::problem::listed;
use crate::sources::{Repository, Source};
use crate::trace::Trace;

/// A repository of one requirement on the code, one on the numbers and one on a budget, which is as it should be.
///
/// An annotation is put together here, so that the search of the real sources does not take it for one of theirs.
fn sound() -> Vec<(&'static str, String)> {
    let says = |word: &str, ids: &str| format!("{word}: {ids}.");
    let (implements, verifies) = (
        |ids: &str| says("Implements", ids),
        |ids: &str| says("Verifies", ids),
    );
    vec![
        (
            "spec/a.md",
            "# A\n\n- **AAA-001** It MUST be `right`,\n  always.\n- **AAA-002** So [MUST](b.md) that.\n\n| **AAA-003** | \
             printed | true |\n"
                .into(),
        ),
        ("Cargo.toml", "[package]\nname = \"small-one\"\n".into()),
        (
            "src/lib.rs",
            format!(
                "//! {}\n\nmod deep;\n\nimpl<'a> One<'a> {{\n    /// Does it.\n    ///\n    /// {}\n    #[inline]\n    pub fn \
                 it(&self) {{\n    }}\n}}\n",
                implements("AAA-003"),
                implements("AAA-001,\n    /// AAA-002"),
            ),
        ),
        (
            "src/deep/mod.rs",
            format!(
                "mod tests {{\n    // {} And more.\n    #[test]\n    fn holds() {{\n    }}\n}}\n",
                verifies("AAA-001")
            ),
        ),
        (
            "tests/slow/main.rs",
            format!(
                "#[path = \"other/name.rs\"]\nmod cases;\n\n// {}\n#[test]\n#[ignore = \"slow\"]\nfn waits() {{\n}}\n",
                verifies("AAA-002")
            ),
        ),
        (
            "tests/slow/other/name.rs",
            format!("// {}\n#[test]\nfn named() {{\n}}\n", verifies("AAA-002")),
        ),
        (
            "benches/quick.rs",
            format!("// {}\nfn main() {{\n}}\n", verifies("AAA-003")),
        ),
        (
            "proofs/bound.g",
            format!("# {}\n", says("Proves", "AAA-003")),
        ),
        (
            "vectors/generator/kinds.py",
            format!("# {}\ndef kind():\n    pass\n", verifies("AAA-001")),
        ),
        (
            ".ci/run",
            "step cargo bench --bench quick\nfor script in proofs/*.g; do\n    step gappa \"$script\"\n".into(),
        ),
    ]
}

fn repository(files: Vec<(&'static str, String)>) -> Repository {
    let mut repository = Repository::default();
    for (path, text) in files {
        let path = path.to_string();
        let source = Source { path, text };
        match source.path.starts_with("spec/") {
            true => repository.chapters.push(source),
            false => repository.sources.push(source),
        }
    }
    repository.vectors.push("vectors/kind.json".into());
    repository
}

/// A text with `{I}` and `{V}` for the words, which the search of the real sources would take for annotations.
fn words(text: &str) -> String {
    text.replace("{I}", "Implements").replace("{V}", "Verifies")
}

/// The trace with `from` replaced by `to` in a file, which must hold it once.
fn changed(path: &str, from: &str, to: &str) -> Trace {
    let mut files = sound();
    let from = &words(from);
    let (_, text) = files.iter_mut().find(|(name, _)| *name == path).unwrap();
    assert_eq!(text.matches(from).count(), 1, "{path}: {from}\n{text}");
    *text = words(&text.replace(from, to));
    Trace::of(&repository(files))
}

/// The problems after such a change, all of them in one text.
fn problems(path: &str, from: &str, to: &str) -> String {
    listed(&changed(path, from, to).problems)
}

fn set(names: &[&str]) -> std::collections::BTreeSet<String> {
    names.iter().map(|name| name.to_string()).collect()
}

// Verifies: EVD-020, EVD-030.
#[test]
fn a_sound_repository_has_its_trace() {
    let trace = Trace::of(&repository(sound()));
    assert_eq!(listed(&trace.problems), "");
    let [first, second, third] = ["AAA-001", "AAA-002", "AAA-003"].map(|id| &trace.rows[id]);
    assert_eq!(first.code, set(&["src/lib.rs One::it"]));
    assert_eq!(first.tests, set(&["src/lib.rs::deep::tests::holds"]));
    assert_eq!(first.vectors, set(&["vectors/kind.json"]));
    assert_eq!(second.code, first.code);
    let both = [
        "tests/slow/main.rs::cases::named",
        "tests/slow/main.rs::waits",
    ];
    assert_eq!(second.tests, set(&both));
    assert_eq!(third.code, set(&["src/lib.rs"]));
    assert_eq!(third.tests, set(&["benches/quick.rs"]));
    assert_eq!(third.proofs, set(&["proofs/bound.g"]));
    let text = &trace.requirements[1].text;
    assert_eq!(text, "So MUST that.");
    let table = crate::table::csv(&trace);
    let line = "AAA-001,a.md,\"It MUST be right, always.\",src/lib.rs One::it,src/lib.rs::deep::tests::holds,,vectors/kind.json,";
    assert_eq!(table.lines().nth(1), Some(line));
}

// Verifies: EVD-020, EVD-025.
#[test]
fn a_requirement_without_code_or_test_is_named() {
    let lonely = problems("spec/a.md", "\n| ", "- **AAA-009** It MUST.\n\n| ");
    assert_eq!(
        lonely,
        words(
            "\nspec/a.md:6: AAA-009 has no code: nothing says \"{I}: AAA-009.\"\
         \nspec/a.md:6: AAA-009 has neither test nor proof: nothing says \"{V}: AAA-009.\""
        )
    );
    let untested = problems("src/deep/mod.rs", "AAA-001", "AAA-002");
    assert!(
        untested.starts_with("\nspec/a.md:3: AAA-001 has neither"),
        "{untested}"
    );
    // A vector is no test.
    assert_eq!(untested.lines().count(), 2, "{untested}");
}

// Verifies: EVD-021.
#[test]
fn an_annotation_of_an_unknown_requirement_is_named() {
    let unknown = problems("tests/slow/main.rs", "AAA-002", "AAA-002, AAA-004");
    assert_eq!(
        unknown,
        "\ntests/slow/main.rs:4: no chapter in spec/ has a requirement AAA-004"
    );
}

// Verifies: EVD-022.
#[test]
fn a_requirement_is_defined_once_and_says_must() {
    let twice = problems("spec/a.md", "\n| ", "- **AAA-001** It MUST again.\n\n| ");
    assert_eq!(
        twice,
        "\nspec/a.md:6: AAA-001 is defined a second time; first in spec/a.md:3"
    );
    let weak = problems("spec/a.md", "So [MUST](b.md)", "So should");
    assert_eq!(weak, "\nspec/a.md:5: AAA-002 has no MUST");
    let inline = problems("spec/a.md", "# A\n", "# A, with **AAA-008** in it\n");
    assert!(
        inline.starts_with("\nspec/a.md:1: **AAA-008** begins neither"),
        "{inline}"
    );
}

// Verifies: EVD-023.
#[test]
fn what_is_nearly_an_annotation_is_refused() {
    let line = "// {V}: AAA-002.";
    for near in [
        "// {V}: AAA-002",
        "// {V} AAA-002.",
        "// {V}: AAA-2.",
        "// {V}: AAA-002 AAA-001.",
        "// {V}: AAA-002 and AAA-001.",
        "// {V}: AAA-002,",
        "// Verified: AAA-002.",
        "// verifies: AAA-002.",
        "// This one {V}: AAA-002.",
        "let x = 1; // {V}: AAA-002.",
    ] {
        let found = problems("tests/slow/main.rs", line, near);
        let named = found.contains("\ntests/slow/main.rs:4: ");
        assert!(named, "{near}: {found}");
    }
}

// Verifies: EVD-024.
#[test]
fn an_annotation_in_the_wrong_place_is_refused() {
    for (from, to, message) in [
        ("#[test]\n", "", "`waits` below it has no #[test]"),
        (
            "fn waits() {",
            "struct Waits {",
            "it does not stand above a test function",
        ),
        (
            "AAA-002.\n",
            "AAA-002.\n\n",
            "it does not stand above a test function",
        ),
    ] {
        let found = problems("tests/slow/main.rs", from, to);
        assert_eq!(found, format!("\ntests/slow/main.rs:4: {message}"));
    }
    let lost = problems("tests/slow/main.rs", "mod cases;\n", "");
    let expected = "\ntests/slow/other/name.rs:1: the file belongs to no crate";
    assert!(lost.starts_with(expected), "{lost}");
    let floating = problems("src/lib.rs", "    pub fn it", "\n    pub fn it");
    assert!(
        floating.contains("src/lib.rs:8: below it stands no item"),
        "{floating}"
    );
    let group = problems("vectors/generator/kinds.py", "def kind(", "def sort(");
    assert_eq!(
        group,
        "\nvectors/generator/kinds.py:1: there is no vectors/sort.json"
    );
}

// Verifies: EVD-026.
#[test]
fn a_proof_is_in_the_folder_of_proofs() {
    let found = problems("tests/slow/other/name.rs", "Verifies", "Proves");
    assert_eq!(
        found,
        "\ntests/slow/other/name.rs:1: \"Proves:\" stands in proofs/ alone"
    );
}

// Verifies: EVD-027.
#[test]
fn what_nothing_runs_is_no_evidence() {
    let bench = problems(".ci/run", "--bench quick", "--bench other");
    assert!(
        bench.contains("\nbenches/quick.rs:1: benches/quick.rs is no evidence of its own: .ci/run"),
        "{bench}"
    );
    let commented = problems(".ci/run", "for script", "# for script");
    assert!(commented.contains("\nproofs/bound.g:1: "), "{commented}");

    let list = "pub const ALL: &[(&str, Scenario)] = &[\n    (\"held up\", || held_up(1)),\n    (\n        \"lost\",\n        \
                crate::lost,\n    ),\n];\n";
    let scenario = |name: &str| {
        let annotation = ["/// Verifies", "AAA-001."].join(": ");
        let text = format!("{list}{annotation}\nfn {name}() {{\n}}\n");
        let mut files = sound();
        let manifest = "[package]\nname = \"guest\"\n";
        files.push(("tests/hid-stack/Cargo.toml", manifest.into()));
        files.push(("tests/hid-stack/src/main.rs", text));
        Trace::of(&repository(files))
    };
    for name in ["held_up", "lost"] {
        let trace = scenario(name);
        assert_eq!(listed(&trace.problems), "");
        let test = format!("tests/hid-stack/src/main.rs::{name}");
        assert!(trace.rows["AAA-001"].tests.contains(&test));
    }
    let forgotten = listed(&scenario("forgotten").problems);
    assert!(
        forgotten.ends_with(": no list `ALL` of scenarios runs `forgotten`"),
        "{forgotten}"
    );
}

// Verifies: EVD-024, EVD-031.
#[test]
fn a_step_of_the_script_that_runs_everything_can_be_a_test() {
    let (before, step) = (
        "step cargo bench",
        "# {V}: AAA-001.\nstep cargo doc\nstep cargo bench",
    );
    let trace = changed(".ci/run", before, step);
    assert_eq!(listed(&trace.problems), "");
    assert!(trace.rows["AAA-001"].tests.contains(".ci/run cargo doc"));
    let mut log = Log::default();
    log.read(PASSED);
    let how = ".ci/run cargo doc did not run: no line \"== ok: cargo doc\" (AAA-001)";
    assert_eq!(log.missing(&trace), [how]);
    log.read("== ok: cargo doc\n");
    assert_eq!(log.missing(&trace), [""; 0]);
    let loose = problems(".ci/run", before, "# {V}: AAA-001.\n\nstep cargo bench");
    assert_eq!(loose, "\n.ci/run:1: it does not stand above a step");
}

// Verifies: EVD-029.
#[test]
fn an_inspection_has_a_reason_and_no_test() {
    let lonely = "- **AAA-009** It MUST. (by inspection: the rule, since no test has udev.)\n\n| ";
    let trace = changed("spec/a.md", "\n| ", lonely);
    let inspected = trace.requirements.iter().find(|r| r.id == "AAA-009");
    let inspected = inspected.unwrap();
    assert_eq!(inspected.text, "It MUST.");
    let reason = "the rule, since no test has udev.";
    assert_eq!(inspected.inspection.as_deref(), Some(reason));
    // Code it must have all the same.
    assert_eq!(
        listed(&trace.problems),
        words("\nspec/a.md:6: AAA-009 has no code: nothing says \"{I}: AAA-009.\"")
    );
    let empty = problems("spec/a.md", "always.", "always. (by inspection: )");
    assert!(
        empty.contains("AAA-001 is marked \"by inspection\", but"),
        "{empty}"
    );
    let many: String = (10..21)
        .map(|k| format!("- **AAA-0{k}** It MUST. (by inspection: here)\n"))
        .collect();
    let many = problems("spec/a.md", "\n| ", &format!("{many}\n| "));
    assert!(
        many.contains("11 requirements are marked \"by inspection\", at most 10"),
        "{many}"
    );
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
test waits ... ignored, slow
   Doc-tests small_one
test src/lib.rs - it (line 3) ... ok
== cargo test -- --ignored
     Running tests/slow/main.rs (target/release/deps/slow-fedcba9876543210)
test waits ... ok
== ok: cargo bench --bench quick
== ok: gappa proofs/bound.g
";

fn missing(from: &str, to: &str) -> Vec<String> {
    assert_eq!(PASSED.matches(from).count(), 1, "{from}");
    let mut log = Log::default();
    log.read(&PASSED.replace(from, to));
    log.missing(&Trace::of(&repository(sound())))
}

// Verifies: EVD-031.
#[test]
fn a_test_that_did_not_pass_is_named_with_its_requirements() {
    assert_eq!(missing("running 1 test\n", ""), [""; 0]);
    let holds = "src/lib.rs::deep::tests::holds";
    let waits = "tests/slow/main.rs::waits";
    for (from, to, name, how) in [
        (
            "holds ... ok",
            "holds ... FAILED",
            holds,
            "failed (AAA-001)",
        ),
        (
            "test deep::tests::holds ... ok\n",
            "",
            holds,
            "did not run: it is not in the log (AAA-001)",
        ),
        (
            "test deep::tests::holds",
            "test deep::tests::renamed",
            holds,
            "did not run: it is not in the log (AAA-001)",
        ),
        (
            "waits ... ok",
            "waits ... ignored, slow",
            waits,
            "was ignored in every run (AAA-002)",
        ),
        (
            "waits ... ok",
            "waits ... FAILED",
            waits,
            "failed (AAA-002)",
        ),
        (
            "small_one-",
            "another-",
            holds,
            "did not run: it is not in the log (AAA-001)",
        ),
        (
            "== ok: gappa proofs/bound.g\n",
            "== gappa proofs/bound.g\n",
            "proofs/bound.g",
            "did not run: no line \"== ok: …\" names it (AAA-003)",
        ),
        (
            "--bench quick",
            "--bench quicker",
            "benches/quick.rs",
            "did not run: no line \"== ok: …\" names it (AAA-003)",
        ),
    ] {
        assert_eq!(missing(from, to), [format!("{name} {how}")], "{from}");
    }
}
