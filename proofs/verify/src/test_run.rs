//! Test runs: what became of each test, proof and script, and for which requirements. A test of this package writes one
//! (`proofs/verify/tests/traceability`); here they are joined to the requirements.

use std::collections::BTreeMap;
use std::path::Path;

use serde::{Deserialize, Serialize};

use super::{Claim, Outcome, json};

/// The value of the key `schema`.
pub const SCHEMA: &str = "palpate-test-run";

/// What a test run found.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TestRun {
    /// [`SCHEMA`].
    pub schema: String,
    /// The commit that was tested, and whether the sources differed from it.
    pub commit: String,
    /// When the run began, UTC.
    pub began: String,
    /// When this was written, UTC.
    pub ended: String,
    /// Operating system, C library, compiler and processor.
    pub system: String,
    /// SHA-256 of the results of cargo-nextest and of the steps from which this was made.
    pub results_sha256: String,
    /// The requirements, in the order of their ids.
    pub requirements: Vec<Requirement>,
    /// Tests, proofs and steps by their names.
    pub entries: Vec<Entry>,
}

/// A requirement and what the annotations in the sources name for it (`spec/verification-plan.md`).
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Requirement {
    /// As `FEM-012`.
    pub id: String,
    /// The file of its chapter in `spec/`.
    pub chapter: String,
    /// Its sentence.
    pub text: String,
    /// What implements it: a file, and after a space the item in it, `src/fem/mesh.rs Mesh`.
    pub code: Vec<String>,
    /// What checks it: the test program and the name of a test in it, or the path of a script or bench.
    pub tests: Vec<String>,
    /// What shows it for every input in a stated range, named likewise.
    pub proofs: Vec<String>,
    /// Files with cases of it for other implementations.
    pub vectors: Vec<String>,
}

/// A test, proof or step.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Entry {
    /// Its name.
    pub name: String,
    /// What became of it.
    pub result: End,
    /// How long it took, s; `None` if it did not run.
    pub seconds: Option<f64>,
}

/// How a test ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum End {
    /// It did not run.
    Missing,
    /// The run left it to another part of `.ci/run`.
    Left,
    /// It has the attribute `#[ignore]`, and no step ran it.
    Ignored,
    /// It passed.
    Passed,
    /// It failed.
    Failed,
}

impl TestRun {
    /// Reads a test run.
    ///
    /// # Errors
    /// A line that names the file and what is wrong with it.
    pub fn read(path: &Path) -> Result<TestRun, String> {
        let run: TestRun = json(path)?;
        if run.schema != SCHEMA {
            let shown = path.display();
            return Err(format!(
                "{shown}: schema is {:?}; it must be {SCHEMA:?}",
                run.schema
            ));
        }
        Ok(run)
    }
}

/// The evidence that a dossier has of one requirement.
#[derive(Debug, Clone, PartialEq)]
pub struct Evidenced {
    /// The requirement.
    pub requirement: Requirement,
    /// Checks of this run of `palpate-verify` that passed.
    pub checks: Vec<String>,
    /// Tests that passed in the test runs.
    pub tests: Vec<String>,
    /// Proofs that passed in the test runs.
    pub proofs: Vec<String>,
    /// Tests and proofs that the test runs left to another one.
    pub left: Vec<String>,
    /// Tests and proofs that failed, were ignored or did not run.
    pub missing: Vec<String>,
}

impl Evidenced {
    /// Whether a check of this run, a test or a proof shows the requirement.
    pub fn is_shown(&self) -> bool {
        !(self.checks.is_empty() && self.tests.is_empty() && self.proofs.is_empty())
    }
}

/// The requirements, which are those of the first test run, with the evidence from all test runs and these checks.
pub fn evidence_by_requirement(runs: &[TestRun], outcomes: &[Outcome]) -> Vec<Evidenced> {
    let mut ends: BTreeMap<&str, End> = BTreeMap::new();
    for entry in runs.iter().flat_map(|run| &run.entries) {
        let end = ends.entry(&entry.name).or_insert(entry.result);
        *end = entry.result.max(*end);
    }
    let of = |names: &[String], keep: fn(End) -> bool| -> Vec<String> {
        let kept = |name: &&String| keep(*ends.get(name.as_str()).unwrap_or(&End::Missing));
        names.iter().filter(kept).cloned().collect()
    };
    let evidenced = |requirement: &Requirement| {
        let all = [requirement.tests.as_slice(), &requirement.proofs].concat();
        let serves = |outcome: &&Outcome| {
            outcome.passed() && outcome.requirements.contains(&requirement.id.as_str())
        };
        let checks = outcomes.iter().filter(serves);
        Evidenced {
            requirement: requirement.clone(),
            checks: checks.map(|outcome| outcome.name.clone()).collect(),
            tests: of(&requirement.tests, |end| end == End::Passed),
            proofs: of(&requirement.proofs, |end| end == End::Passed),
            left: of(&all, |end| end == End::Left),
            missing: of(&all, |end| !matches!(end, End::Passed | End::Left)),
        }
    };
    let requirements = runs.first().map_or(&[][..], |run| &run.requirements);
    requirements.iter().map(evidenced).collect()
}

/// What a run of `palpate-verify` claims of the test runs that it was given.
pub const CLAIM: Claim = Claim {
    name: "tests.complete",
    text: "Every requirement has a test or proof that passed in the test runs, no test of them failed, and they are of the \
           commit of this build.",
    requirements: &[],
    limits: "None: every requirement counts. Fixed in 0.2.0.",
};

/// Whether [`CLAIM`] holds, for a build of a known `commit`. What a run leaves to another counts as no evidence until that is given.
pub fn outcome(runs: &[TestRun], commit: Option<&str>) -> Outcome {
    Outcome::measured(&CLAIM, || {
        let requirements = evidence_by_requirement(runs, &[]);
        let without: Vec<&Evidenced> = requirements.iter().filter(|row| !row.is_shown()).collect();
        let left = without.iter().filter(|row| !row.left.is_empty()).count();
        let first = without.first().map_or(String::new(), |row| {
            format!(", the first {}", row.requirement.id)
        });
        let entries = || runs.iter().flat_map(|run| &run.entries);
        let count = |end| entries().filter(|entry| entry.result == end).count() as u64;
        let foreign = runs
            .iter()
            .filter(|run| commit != Some(run.commit.as_str()));
        let other = runs
            .iter()
            .filter(|run| run.requirements != runs[0].requirements);
        Ok(figures! {
            "requirements" => at_least(requirements.len() as f64, 1.0);
            "tests, proofs and steps that passed" => told(count(End::Passed) as f64);
            "tests, proofs and steps that failed" => count(count(End::Failed), 0);
            "requirements without evidence{first}" => count(without.len() as u64, 0);
            "of these, requirements whose evidence the test runs leave to another one" => told(left as f64);
            "test runs of another commit than this build's" => count(foreign.count() as u64, 0);
            "test runs with other requirements than the first" => count(other.count() as u64, 0);
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Figure;
    use End::*;

    fn requirement(id: &str, tests: &[&str], proofs: &[&str]) -> Requirement {
        let names = |names: &[&str]| names.iter().map(|name| name.to_string()).collect();
        Requirement {
            id: id.into(),
            tests: names(tests),
            proofs: names(proofs),
            ..Requirement::default()
        }
    }

    fn test_run(requirements: &[Requirement], entries: &[(&str, End)]) -> TestRun {
        let entry = |&(name, result): &(&str, End)| Entry {
            name: name.into(),
            result,
            seconds: None,
        };
        TestRun {
            schema: SCHEMA.into(),
            commit: "c".into(),
            requirements: requirements.to_vec(),
            entries: entries.iter().map(entry).collect(),
            ..TestRun::default()
        }
    }

    /// Test runs of two requirements, one with the tests `a` and `b`, the other with the proof `p`.
    fn test_runs<const N: usize>(entries: [&[(&str, End)]; N]) -> [TestRun; N] {
        let requirements = [
            requirement("AAA-001", &["a", "b"], &[]),
            requirement("AAA-002", &[], &["p"]),
        ];
        entries.map(|entries| test_run(&requirements, entries))
    }

    #[test]
    fn a_requirement_without_a_passed_test_or_proof_is_seen() {
        let all: &[_] = &[("a", Passed), ("b", Missing), ("p", Passed)];
        // What one run leaves another may have.
        let day: &[_] = &[("a", Passed), ("p", Left)];
        let night: &[_] = &[("p", Passed)];
        let figures = |runs: &[TestRun]| outcome(runs, Some("c")).figures;
        assert!(outcome(&test_runs([all]), Some("c")).passed());
        assert!(!outcome(&test_runs([day]), Some("c")).passed());
        assert!(outcome(&test_runs([day, night]), Some("c")).passed());
        assert_eq!(figures(&test_runs([day]))[4].value, 1.0);
        assert_eq!(figures(&test_runs([day, night]))[4].value, 0.0);
        let failed: &[_] = &[("p", Failed)];
        assert!(!outcome(&test_runs([day, failed]), Some("c")).passed());
        for end in [Missing, Ignored, Failed] {
            let runs = test_runs([&[("a", Passed), ("p", end)]]);
            assert!(!outcome(&runs, Some("c")).passed(), "{end:?}");
        }
        let complaint = outcome(&test_runs([night]), Some("c")).complaint().unwrap();
        let words = "requirements without evidence, the first AAA-001";
        assert!(complaint.contains(words), "{complaint}");
    }

    #[test]
    fn test_runs_without_requirements_or_of_other_sources_are_seen() {
        let all: &[_] = &[("a", Passed), ("p", Passed)];
        assert!(!outcome(&[], Some("c")).passed());
        assert!(!outcome(&[test_run(&[], all)], Some("c")).passed());
        assert!(!outcome(&test_runs([all]), Some("d")).passed());
        // A build without a known commit is not that of any sources, whatever its text says.
        assert!(!outcome(&test_runs([all]), None).passed());
        let [mut one, two] = test_runs([all, all]);
        assert!(outcome(&[one.clone(), two.clone()], Some("c")).passed());
        one.requirements.pop();
        assert!(!outcome(&[one, two], Some("c")).passed());
    }

    #[test]
    fn a_failed_test_counts_even_if_no_requirement_names_it() {
        let runs = test_runs([&[("a", Passed), ("p", Passed), ("other", Failed)]]);
        assert!(!outcome(&runs, Some("c")).passed());
    }

    #[test]
    fn checks_and_test_runs_are_told_apart() {
        let rows = [requirement("AAA-001", &["a", "b", "n"], &["p"])];
        let claim = Claim {
            name: "part.what",
            requirements: &["AAA-001"],
            ..CLAIM
        };
        let here = Outcome::measured(&claim, || Ok(vec![Figure::told("n", 1.0)]));
        let entries = [("a", Passed), ("b", Ignored), ("p", Passed), ("n", Left)];
        let found = &evidence_by_requirement(&[test_run(&rows, &entries)], &[here])[0];
        let lists = [
            &found.checks,
            &found.tests,
            &found.proofs,
            &found.left,
            &found.missing,
        ];
        assert_eq!(lists, [&["part.what"], &["a"], &["p"], &["n"], &["b"]]);
    }

    #[test]
    fn a_file_that_is_no_test_run_is_refused_with_its_name() {
        let path = tempfile::NamedTempFile::new().unwrap().into_temp_path();
        let with = |text: &str| {
            std::fs::write(&path, text).unwrap();
            TestRun::read(&path)
        };
        let [run] = test_runs([&[("a", Passed)]]);
        let text = serde_json::to_string(&run).unwrap();
        assert_eq!(with(&text), Ok(run));
        for wrong in [
            "",
            "{}",
            &text.replace(SCHEMA, "other"),
            &text.replace("passed", "fine"),
        ] {
            let error = with(wrong).unwrap_err();
            let named = error.starts_with(&format!("{}: ", path.display()));
            assert!(named, "{error}");
        }
    }
}
