//! Vectors.

use std::collections::{BTreeMap, HashSet};

use palpate::oracle::Oracle;
use palpate_conform::{Expected, Question, Suite, Tolerance};
use serde_json::Value;

use crate::message::check_message;
use crate::{Outcome, judged};

/// The name of the file of cases.
const GROUP: &str = "fuzz.json";
/// Between the file of cases and, if there is one, the manifest.
const SEPARATOR: char = '\u{1e}';

/// An accepted file has unique ids, explained flags and bounded tolerances, and each of its
/// questions is one line with one answer; a refusal names the file.
///
/// The bytes are the file, and after a record separator (1E) a manifest.
pub fn vectors(text: &str) -> Outcome {
    let (group, manifest) = match text.split_once(SEPARATOR) {
        Some((group, manifest)) => (group, Some(manifest)),
        None => (text, None),
    };
    let mut files = BTreeMap::from([(GROUP.to_string(), group.to_string())]);
    if let Some(manifest) = manifest {
        files.insert("manifest.json".into(), manifest.into());
    }
    let accepted = |suite: Suite| {
        check_suite(&suite);
        assert_eq!(Suite::of_files(files.clone()).as_ref(), Ok(&suite));
    };
    judged(Suite::of_files(files.clone()), accepted, |error| {
        check_message(&error.to_string());
        assert!(error.file == GROUP || manifest.is_some(), "{error}");
        assert!(error.to_string().starts_with(&error.file), "{error}");
    })
}

fn check_suite(suite: &Suite) {
    assert_eq!(suite.sha256.len(), 64);
    let [group] = &suite.groups[..] else {
        panic!("one file is one group");
    };
    let ids: HashSet<_> = group.cases.iter().map(|case| &case.id).collect();
    assert!(!ids.is_empty() && ids.len() == group.cases.len());
    for case in &group.cases {
        assert!(case.flags.iter().all(|flag| group.flags.contains_key(flag)));
        let values = match &case.expected {
            Expected::Values(values) => &values[..],
            Expected::Refusal { .. } => &[],
        };
        for wanted in values {
            assert!(wanted.condition.fits(&wanted.value));
            let (Tolerance::Ulp(size) | Tolerance::Absolute(size) | Tolerance::Relative(size)) =
                wanted.tolerance
            else {
                continue;
            };
            assert!(size.is_finite() && size >= 0.0);
        }
        let line = case.line(&group.op);
        let content = line.strip_suffix('\n').expect("a line");
        assert!(!content.contains('\n'));
        if matches!(case.question, Question::Arguments(_)) {
            let read: Value = serde_json::from_str(content).expect("JSON");
            assert_eq!(
                (&read["id"], &read["op"]),
                (&case.id[..].into(), &group.op[..].into())
            );
        }
        // A question that the solver would answer takes seconds, and is no matter of reading.
        if group.op == "probe_force" || matches!(case.question, Question::Line(_)) {
            continue;
        }
        let mut answer = Vec::new();
        Oracle::default().answer(content.as_bytes(), &mut answer);
        assert_eq!(answer.iter().filter(|&&byte| byte == b'\n').count(), 1);
    }
}
