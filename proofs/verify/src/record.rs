//! The record of a test run: what became of each test, step and proof. `.ci/run` writes it; here it is joined to the trace.

use std::collections::BTreeMap;
use std::path::Path;

use serde::{Deserialize, Serialize};

use super::traceability::Requirement;
use super::{Claim, Outcome};

/// The value of the key `schema`.
pub const SCHEMA: &str = "palpate-test-record";

/// What a test run found.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Record {
    /// [`SCHEMA`].
    pub schema: String,
    /// The commit that was tested, and whether the sources differed from it.
    pub commit: String,
    /// When the run began, UTC.
    pub began: String,
    /// When the record was written, UTC.
    pub ended: String,
    /// Operating system, C library, compiler and processor.
    pub system: String,
    /// SHA-256 of the log that the record was read from.
    pub log_sha256: String,
    /// Tests, proofs and steps by their names; those of the trace have its names.
    pub entries: Vec<Entry>,
}

/// A test, proof or step.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Entry {
    /// Its name.
    pub name: String,
    /// What became of it.
    pub result: End,
    /// How long it took, s; of a test, how long all tests of its program took. `None` where nothing tells.
    pub seconds: Option<f64>,
}

/// How a test ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum End {
    /// It did not run.
    Missing,
    /// The run left it to `.ci/run all`.
    Left,
    /// It is marked to be ignored, and no step asked for it.
    Ignored,
    /// It passed.
    Passed,
    /// It failed.
    Failed,
}

impl Record {
    /// Reads a record.
    ///
    /// # Errors
    /// A line that names the file and what is wrong with it.
    pub fn read(path: &Path) -> Result<Record, String> {
        let shown = path.display();
        let text = std::fs::read_to_string(path).map_err(|error| format!("{shown}: {error}"))?;
        let record: Record =
            serde_json::from_str(&text).map_err(|error| format!("{shown}: {error}"))?;
        match record.schema == SCHEMA {
            true => Ok(record),
            false => Err(format!(
                "{shown}: schema = {:?}, expected {SCHEMA:?}",
                record.schema
            )),
        }
    }
}

/// The evidence that a dossier has of one requirement.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Joined {
    /// Its id.
    pub requirement: String,
    /// Checks of this run of `palpate-verify` that passed.
    pub checks: Vec<String>,
    /// Tests that passed in the records.
    pub tests: Vec<String>,
    /// Proofs that passed in the records.
    pub proofs: Vec<String>,
    /// Tests and proofs that the records leave to another run.
    pub left: Vec<String>,
    /// Tests and proofs that failed, were ignored or did not run.
    pub missing: Vec<String>,
    /// Where a person inspects it.
    pub inspection: Option<String>,
}

impl Joined {
    /// Whether anything shows the requirement in this run or in the records.
    pub fn is_there(&self) -> bool {
        !(self.checks.is_empty() && self.tests.is_empty() && self.proofs.is_empty())
            || self.inspection.is_some()
    }
}

/// Joins checks and records to the requirements.
pub fn join(requirements: &[Requirement], outcomes: &[Outcome], records: &[Record]) -> Vec<Joined> {
    let mut ends: BTreeMap<&str, End> = BTreeMap::new();
    for entry in records.iter().flat_map(|record| &record.entries) {
        let end = ends.entry(&entry.name).or_insert(entry.result);
        *end = entry.result.max(*end);
    }
    let of = |names: &[String], keep: fn(End) -> bool| -> Vec<String> {
        let kept = |name: &&String| keep(*ends.get(name.as_str()).unwrap_or(&End::Missing));
        names.iter().filter(kept).cloned().collect()
    };
    let join = |row: &Requirement| {
        let all = [row.tests.as_slice(), &row.proofs].concat();
        let serves = |outcome: &&Outcome| {
            outcome.passed() && outcome.requirements.contains(&row.id.as_str())
        };
        Joined {
            requirement: row.id.clone(),
            checks: outcomes
                .iter()
                .filter(serves)
                .map(|outcome| outcome.name.clone())
                .collect(),
            tests: of(&row.tests, |end| end == End::Passed),
            proofs: of(&row.proofs, |end| end == End::Passed),
            left: of(&all, |end| end == End::Left),
            missing: of(&all, |end| !matches!(end, End::Passed | End::Left)),
            inspection: row.inspection.clone(),
        }
    };
    requirements.iter().map(join).collect()
}

/// What a run of `palpate-verify` that was given records claims of them.
pub const CLAIM: Claim = Claim::new(
    "record.complete",
    "Every requirement has a test or proof that passed in the records of the test runs, no test of the records failed, and the \
     records are of the commit of this build.",
    &[],
    "None: every requirement counts. Fixed in 0.2.0.",
);

/// Whether [`CLAIM`] holds.
pub fn outcome(requirements: &[Requirement], records: &[Record], commit: &str) -> Outcome {
    Outcome::measured(&CLAIM, || {
        let joined = join(requirements, &[], records);
        let without: Vec<&Joined> = joined.iter().filter(|row| !row.is_there()).collect();
        let left = without.iter().filter(|row| !row.left.is_empty()).count();
        let nothing = without.iter().find(|row| row.left.is_empty());
        let first = nothing.map_or(String::new(), |row| {
            format!(", the first {}", row.requirement)
        });
        let entries = || records.iter().flat_map(|record| &record.entries);
        let count = |end| entries().filter(|entry| entry.result == end).count() as u64;
        let foreign = records.iter().filter(|record| record.commit != commit);
        Ok(figures! {
            "requirements" => told(requirements.len() as f64);
            "tests, proofs and steps that passed" => told(count(End::Passed) as f64);
            "tests, proofs and steps that failed" => count(count(End::Failed), 0);
            "requirements whose evidence the records leave to another run" => told(left as f64);
            "requirements without evidence{first}" => count((without.len() - left) as u64, 0);
            "records of another commit than this build's" => count(foreign.count() as u64, 0);
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Check, Figure};

    fn requirement(id: &str, tests: &[&str], proofs: &[&str]) -> Requirement {
        let names = |names: &[&str]| names.iter().map(|name| name.to_string()).collect();
        Requirement {
            id: id.into(),
            tests: names(tests),
            proofs: names(proofs),
            ..Requirement::default()
        }
    }

    fn record(entries: &[(&str, End)]) -> Record {
        let entry = |&(name, result): &(&str, End)| Entry {
            name: name.into(),
            result,
            seconds: None,
        };
        Record {
            schema: SCHEMA.into(),
            commit: "c".into(),
            began: String::new(),
            ended: String::new(),
            system: String::new(),
            log_sha256: String::new(),
            entries: entries.iter().map(entry).collect(),
        }
    }

    #[test]
    fn a_requirement_without_a_passed_test_or_proof_is_seen() {
        let rows = [
            requirement("AAA-001", &["a", "b"], &[]),
            requirement("AAA-002", &[], &["p"]),
        ];
        let passes = |records: &[Record]| outcome(&rows, records, "c").passed();
        use End::*;
        assert!(passes(&[record(&[
            ("a", Passed),
            ("b", Missing),
            ("p", Passed)
        ])]));
        // What one run leaves another may have.
        let day = record(&[("a", Passed), ("p", Left)]);
        assert!(passes(std::slice::from_ref(&day)));
        let left = &outcome(&rows, std::slice::from_ref(&day), "c").figures[3];
        assert_eq!(left.value, 1.0, "{left}");
        let both = outcome(&rows, &[day.clone(), record(&[("p", Passed)])], "c");
        assert_eq!(both.figures[3].value, 0.0);
        assert!(!passes(&[day.clone(), record(&[("p", Failed)])]));
        for end in [Missing, Ignored, Failed] {
            assert!(!passes(&[record(&[("a", Passed), ("p", end)])]), "{end:?}");
        }
        assert!(!passes(&[]) && !outcome(&rows, &[day], "d").passed());
        let none = outcome(&rows, &[record(&[("p", Passed)])], "c")
            .complaint()
            .unwrap();
        assert!(
            none.contains("requirements without evidence, the first AAA-001"),
            "{none}"
        );
    }

    #[test]
    fn a_failed_test_counts_even_if_it_is_not_in_the_trace() {
        let rows = [requirement("AAA-001", &["a"], &[])];
        let records = [record(&[("a", End::Passed), ("other", End::Failed)])];
        assert!(!outcome(&rows, &records, "c").passed());
    }

    #[test]
    fn checks_and_records_are_told_apart() {
        let rows = [requirement("AAA-001", &["a", "b", "n"], &["p"])];
        let here = Outcome::of(&Check::new(
            "part.what",
            "It holds.",
            &["AAA-001"],
            "Fixed in 0.2.0.",
            || Ok(vec![Figure::told("n", 1.0)]),
        ));
        let records = [record(&[
            ("a", End::Passed),
            ("b", End::Ignored),
            ("p", End::Passed),
            ("n", End::Left),
        ])];
        let joined = &join(&rows, &[here], &records)[0];
        assert_eq!(joined.checks, ["part.what"]);
        assert_eq!(
            (&joined.tests[..], &joined.proofs[..]),
            (&["a".to_string()][..], &["p".to_string()][..])
        );
        assert_eq!(
            (&joined.left[..], &joined.missing[..]),
            (&["n".to_string()][..], &["b".to_string()][..])
        );
    }

    #[test]
    fn a_file_that_is_no_record_is_refused_with_its_name() {
        let path = std::env::temp_dir().join(format!("palpate-record-{}", std::process::id()));
        let with = |text: &str| {
            std::fs::write(&path, text).unwrap();
            Record::read(&path)
        };
        let record = record(&[("a", End::Passed)]);
        let text = serde_json::to_string(&record).unwrap();
        assert_eq!(with(&text), Ok(record));
        for wrong in [
            "",
            "{}",
            &text.replace(SCHEMA, "other"),
            &text.replace("passed", "fine"),
        ] {
            let error = with(wrong).unwrap_err();
            assert!(
                error.starts_with(&format!("{}: ", path.display())),
                "{error}"
            );
        }
        std::fs::remove_file(&path).unwrap();
    }
}
