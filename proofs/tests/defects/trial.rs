//! The ledger, tried: which tests find each of its defects, and so how much the tests of this project find.

use std::collections::BTreeSet;
use std::fs::{self, File, OpenOptions};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::Command;

use palpate_core::stats::binomial::clopper_pearson;
use serde_json::{Value, json};

use crate::copy::{Copy, ROOT};
use crate::list::{CLASSES, Entry, ledger};
use crate::suite::Suite;
use crate::switch::{SWITCH, switched};

/// The crates: where their files are, their root files, their packages, and the parts of the project that they are.
const CRATES: [[&str; 4]; 7] = [
    ["src/core/", "lib.rs", "palpate-core", "core"],
    ["src/palpate/", "lib.rs", "palpate", "library"],
    ["src/paper/", "lib.rs", "palpate-paper", "paper"],
    [
        "src/program/",
        "lib.rs main.rs",
        "palpate-program",
        "program",
    ],
    [
        "vectors/conform/src/",
        "lib.rs main.rs",
        "palpate-conform",
        OUTSIDE,
    ],
    ["bindings/c/src/", "lib.rs", "palpate-c", OUTSIDE],
    ["bindings/python/src/", "lib.rs", "palpate-python", OUTSIDE],
];

/// What others use the product by.
const OUTSIDE: &str = "bindings and vectors";

/// The crate of a file.
fn crate_of(file: &str) -> [&'static str; 4] {
    let mut crates = CRATES.into_iter();
    crates
        .find(|[folder, ..]| file.starts_with(folder))
        .expect(file)
}

/// The confidence of the interval of the power.
const CONFIDENCE: f64 = 0.95;

// Verifies: CON-011.
#[test]
fn what_is_shipped_has_no_switch() {
    for folder in ["src", "bindings", "vectors"] {
        let text = crate::sources(&Path::new(ROOT).join(folder));
        assert!(text.len() > 10_000, "{folder}");
        assert!(!text.contains("crate::planted(") && !text.contains(crate::switch::VARIABLE));
    }
    // And would have it, if it were planted there.
    assert!(SWITCH.contains("fn planted(") && SWITCH.contains(crate::switch::VARIABLE));
}

#[test]
#[ignore = "runs the tests once for each defect, half an hour"]
fn the_tests_find_the_defects_of_the_ledger() {
    let entries = ledger();
    let copy = Copy::new("ledger", &["."]);
    let suite = Suite::new(&copy);
    let mut report = Report::open();
    let build = || suite.build().unwrap_or_else(|error| panic!("{error}"));
    let (mut switched, alone) = with_switches(&copy, &entries, build);
    println!("{} of {} are built alone", alone.len(), entries.len());
    // What states the power comes first, and what is quick.
    switched.sort_by_key(|&number| !entries[number].is_drawn);
    for find in [by_own, by_others] {
        for &number in &switched {
            let entry = &entries[number];
            report.add(entry, || find(&suite, entry, Some(number)));
        }
    }
    let found_by = report.found_by();
    let passes = [
        suite.failing(&found_by.join(" | "), None),
        suite.failing_in_python(None),
    ];
    let sound = "without a defect the tests that found one must pass";
    assert_eq!(passes, [None, None], "{sound}");
    assert_eq!(suite.ran(), found_by.len());
    for entry in alone.iter().map(|&number| &entries[number]) {
        let find = || {
            copy.forget();
            by_named(&suite, entry).or_else(|| {
                build();
                by_own(&suite, entry, None).or_else(|| by_others(&suite, entry, None))
            })
        };
        report.add(entry, || copy.with(&entry.defect, find));
    }
    report.end(&entries);
}

/// Builds with all defects behind their switches, and has the sources as they were when the tests look at them. The defects that are, and
/// those that cannot be.
fn with_switches(copy: &Copy, entries: &[Entry], build: impl FnOnce()) -> (Vec<usize>, Vec<usize>) {
    let root = |[folder, roots, ..]: [&'static str; 4]| {
        roots.split(' ').map(move |root| format!("{folder}{root}"))
    };
    let roots: BTreeSet<String> = CRATES.into_iter().flat_map(root).collect();
    let files = entries.iter().map(|entry| entry.defect.file.clone());
    let (mut alone, mut sound) = (Vec::new(), Vec::new());
    for file in files.chain(roots.clone()).collect::<BTreeSet<_>>() {
        let text = copy.read(&file);
        let of_file = |number: &usize| entries[*number].defect.file == file;
        let numbers: Vec<usize> = (0..entries.len()).filter(of_file).collect();
        let (mut planted, others) = switched(&text, entries, &numbers);
        alone.extend(others);
        if roots.contains(&file) {
            planted += SWITCH;
        }
        if planted != text {
            copy.write_or_take(&file, &planted);
            sound.push((file, text));
        }
    }
    build();
    for (file, text) in sound {
        copy.put_aside(&file, &text);
    }
    let is_switched = |number: &usize| !alone.contains(number);
    ((0..entries.len()).filter(is_switched).collect(), alone)
}

/// Who found a defect, and the test.
type Found = Option<(&'static str, String)>;

/// Builds the tests of its package alone, and tries the one that the entry names if it is there.
fn by_named(suite: &Suite<'_>, entry: &Entry) -> Found {
    let (package, own) = own_tests(&entry.defect.file);
    if package == "palpate-python" || entry.defect.found_by == "?" {
        return None;
    }
    let test = suite.failing_in(package, &format!("({own}) & {}", named(entry)));
    test.map(|test| ("own", test))
}

/// The filter for the test that an entry names.
fn named(entry: &Entry) -> String {
    format!("test(/(^|::){}$/)", entry.defect.found_by)
}

/// Tries the tests of its own module.
fn by_own(suite: &Suite<'_>, entry: &Entry, planted: Option<usize>) -> Found {
    let (package, own) = own_tests(&entry.defect.file);
    let test = match package {
        "palpate-python" => suite.failing_in_python(planted),
        _ => failing(suite, entry, &own, planted),
    };
    test.map(|test| ("own", test))
}

/// Tries whatever else depends on its package.
fn by_others(suite: &Suite<'_>, entry: &Entry, planted: Option<usize>) -> Found {
    let (package, own) = own_tests(&entry.defect.file);
    let others = format!("rdeps(={package}) - ({own})");
    let test = failing(suite, entry, &others, planted);
    Some(test.map_or(("nothing", String::new()), |test| ("others", test)))
}

/// The first test of a filter that fails; the one that the entry names is tried before the others.
fn failing(
    suite: &Suite<'_>,
    entry: &Entry,
    filter: &str,
    planted: Option<usize>,
) -> Option<String> {
    let named = named(entry);
    let (first, others) = (
        format!("({filter}) & {named}"),
        format!("({filter}) - {named}"),
    );
    let parts = match &*entry.defect.found_by {
        "?" => vec![filter],
        _ => vec![&*first, &others],
    };
    parts
        .into_iter()
        .find_map(|part| suite.failing(part, planted))
}

/// The package of a file, and the tests of its module: those of its folder, and those that see it from outside, `NAME_command` and the like.
/// The library for C and the judge of vectors are of one piece each; the harnesses are the core's own.
fn own_tests(file: &str) -> (&'static str, String) {
    let [folder, _, package, _] = crate_of(file);
    let path = file[folder.len()..].trim_start_matches("templates/");
    let module = path.split(['/', '.']).next().unwrap();
    let outside = format!("package(=palpate-tests) & test(/^{module}_/)");
    let own = match package {
        "palpate-conform" | "palpate-c" | "palpate-python" => format!("package(={package})"),
        "palpate-core" => format!(
            "package(={package}) & test(/^{module}::/) | {outside} | package(=palpate-proofs) & kind(lib)"
        ),
        _ => format!("package(={package}) & test(/^{module}::/) | {outside}"),
    };
    (package, own)
}

/// What was found, a line for each defect as soon as it is known, so that a run that was stopped goes on.
struct Report {
    path: PathBuf,
    commit: String,
    lines: Vec<Value>,
}

impl Report {
    /// Goes on with the lines of the same commit, or begins.
    fn open() -> Report {
        let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join("ledger.jsonl");
        let text = fs::read_to_string(&path).unwrap_or_default();
        // Half a line is one that was being written.
        let lines = text.lines().map(serde_json::from_str);
        let mut report = Report {
            path,
            commit: commit(),
            lines: lines.flatten().collect(),
        };
        let first = report.lines.first();
        if first.is_none_or(|first| first["commit"] != *report.commit) {
            report.lines.clear();
            File::create(&report.path).unwrap();
            report.push(json!({"commit": report.commit}));
        }
        report
    }

    fn push(&mut self, line: Value) {
        let mut file = OpenOptions::new().append(true).open(&self.path).unwrap();
        writeln!(file, "{line}").unwrap();
        self.lines.push(line);
    }

    /// Adds what is found, unless it is known.
    fn add(&mut self, entry: &Entry, find: impl FnOnce() -> Found) {
        let Entry {
            defect,
            class,
            is_alone,
            is_drawn,
        } = entry;
        if self.lines.iter().any(|line| is_of(line, entry)) {
            return;
        }
        let Some((found, test)) = find() else { return };
        println!("{found:8} {}: {} {test}", defect.file, defect.name);
        self.push(json!({
            "file": defect.file, "name": defect.name, "class": class, "is_alone": is_alone, "is_drawn": is_drawn,
            "found": found, "test": test,
        }));
    }

    /// The tests in Rust that found a defect, each once, as filters of cargo-nextest.
    fn found_by(&self) -> Vec<String> {
        let tests = self.lines.iter().filter_map(|line| line["test"].as_str());
        let in_rust: BTreeSet<_> = tests.filter_map(|test| test.split_once(' ')).collect();
        let filter = |(binary, test)| format!("binary_id(={binary}) & test(={test})");
        in_rust.into_iter().map(filter).collect()
    }

    /// Writes `ledger.json`, and fails if a defect that names its test was not found.
    fn end(&self, entries: &[Entry]) {
        let power = power(&self.lines[1..]);
        for row in &power {
            let [of, defects, found, own] =
                ["of", "defects", "found", "by_own"].map(|key| &row[key]);
            let [lower, upper] = ["lower", "upper"].map(|key| row[key].as_f64().unwrap());
            println!(
                "{of}: {found} of {defects} found, {own} by own tests, {lower:.3} to {upper:.3}"
            );
        }
        let report = json!({"commit": self.commit, "confidence": CONFIDENCE, "power": power, "defects": self.lines[1..]});
        let path = Path::new(env!("CARGO_TARGET_TMPDIR")).with_file_name("ledger.json");
        fs::write(path, format!("{report:#}\n")).unwrap();
        let names_a_test = |line: &&Value| {
            let mut named = entries.iter().filter(|entry| entry.defect.found_by != "?");
            line["found"] == "nothing" && named.any(|entry| is_of(line, entry))
        };
        let lost: Vec<_> = self.lines.iter().filter(names_a_test).collect();
        assert!(
            lost.is_empty(),
            "these name a test, and nothing finds them: {lost:?}"
        );
    }
}

/// Whether a line tells of a defect.
fn is_of(line: &Value, entry: &Entry) -> bool {
    line["file"] == *entry.defect.file && line["name"] == *entry.defect.name
}

/// The share of the drawn defects that is found, of all and by part and class.
fn power(lines: &[Value]) -> Vec<Value> {
    let drawn: Vec<&Value> = lines
        .iter()
        .filter(|line| line["is_drawn"] == true)
        .collect();
    let mut power = Vec::new();
    let mut add = |of: &str, is_in: &dyn Fn(&Value) -> bool| {
        let among: Vec<&&Value> = drawn.iter().filter(|line| is_in(line)).collect();
        let found = among
            .iter()
            .filter(|line| line["found"] != "nothing")
            .count();
        let own = among.iter().filter(|line| line["found"] == "own").count();
        if let Ok(bounds) = clopper_pearson(found as u64, among.len() as u64, CONFIDENCE) {
            power.push(json!({"of": of, "defects": among.len(), "found": found, "by_own": own, "lower": bounds.lower, "upper": bounds.upper}));
        }
    };
    add("all", &|_| true);
    for part in CRATES
        .map(|[.., part]| part)
        .into_iter()
        .collect::<BTreeSet<_>>()
    {
        add(part, &|line| {
            crate_of(line["file"].as_str().unwrap())[3] == part
        });
    }
    for class in CLASSES {
        add(class, &|line| line["class"] == class);
    }
    power
}

/// The commit, and whether the sources differ from it.
fn commit() -> String {
    let git = |arguments: &str| {
        let mut command = Command::new("git");
        let output = command
            .current_dir(ROOT)
            .args(arguments.split(' '))
            .output();
        String::from_utf8(output.unwrap().stdout).unwrap()
    };
    let changes = git("status --porcelain --untracked-files=no");
    let is_changed = ["", " with changes"][usize::from(!changes.is_empty())];
    git("rev-parse HEAD").trim().to_string() + is_changed
}
