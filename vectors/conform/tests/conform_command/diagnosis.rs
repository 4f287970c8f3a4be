//! The bug that explains wrong answers is named.

use std::process::Command;

use palpate_conform::Suite;
use serde_json::{Value, json};

use crate::program::*;

// Verifies: ORA-042, ORA-048.
#[test]
fn another_implementation_passes() {
    let Some(python) = python() else { return };
    passes(&conform("", &[&python, "-B", &format!("{TOYS}/right.py")]));
}

/// The groups with a case that can show a bug.
fn groups_with(flag: &str) -> Vec<String> {
    let suite = Suite::embedded().expect("the vectors");
    let groups = suite.groups.into_iter();
    let with_flag = groups.filter(|group| group.flags.contains_key(flag));
    with_flag.map(|group| group.name).collect()
}

/// The names of the bugs of a toy.
fn planted(python: &str, toy: &str) -> Vec<String> {
    let list = Command::new(python).args(["-B", toy]).output();
    let list = list.expect("Python starts");
    let said = stdout(&list).to_string() + error(&list);
    let (_, bugs) = said.split_once(": ").expect("a list of bugs");
    bugs.split_whitespace().map(str::to_string).collect()
}

/// The diagnosis of a toy with a bug, which must make it fail.
fn diagnosis(python: &str, toy: &str, bug: &str, groups: &[String]) -> Vec<Value> {
    let options = format!("--format json --only {}", groups.join(" --only "));
    let output = conform(&options, &[python, "-B", toy, bug]);
    assert_eq!(output.status.code(), Some(1), "{bug} passes");
    json_of(&output)["diagnosis"].as_array().unwrap().clone()
}

// Verifies: ORA-047, ORA-049.
#[test]
#[ignore = "slow, and rarely breaks"]
fn the_bugs_of_another_implementation_are_named_first() {
    let Some(python) = python() else { return };
    let toy = format!("{TOYS}/wrong.py");
    let bugs = planted(&python, &toy);
    assert!(bugs.len() >= 30, "{bugs:?}");
    let is_first = |bug: &&String| {
        let groups = groups_with(bug);
        assert!(!groups.is_empty(), "no case shows {bug}");
        let found = diagnosis(&python, &toy, bug, &groups);
        let first = |one: &Value| one["explanations"][0]["bugs"][0]["flag"] == ***bug;
        // The gravest class of every group that the bug shows in.
        let gravest = found
            .chunk_by(|a, b| a["group"] == b["group"])
            .map(|of_group| &of_group[0]);
        gravest.clone().count() > 0 && gravest.into_iter().all(first)
    };
    let first = bugs.iter().filter(is_first).count();
    assert!(
        10 * first >= 9 * bugs.len(),
        "{first} of {} named first",
        bugs.len()
    );
}

// Verifies: ORA-047.
#[test]
#[ignore = "slow, and rarely breaks"]
fn bugs_that_the_vectors_do_not_foresee_get_no_name_that_explains_less_than_half() {
    let Some(python) = python() else { return };
    let toy = format!("{TOYS}/unforeseen.py");
    let bugs = planted(&python, &toy);
    assert!(bugs.len() >= 10, "{bugs:?}");
    let groups = "theta scan matched_filter theta_colored normal_cdf error_rates roc interpolate";
    let groups: Vec<String> = groups.split(' ').map(String::from).collect();
    let mut unexplained = 0;
    for bug in &bugs {
        assert!(groups_with(bug).is_empty(), "{bug} is foreseen");
        let found = diagnosis(&python, &toy, bug, &groups);
        for one in &found {
            let wrong = one["wrong"].as_u64().unwrap();
            for explanation in one["explanations"].as_array().unwrap() {
                let explains = explanation["explains"].as_u64().unwrap();
                assert!(2 * explains >= wrong, "{bug}: {one}");
            }
        }
        let is_named = |one: &Value| one["explanations"] != json!([]);
        unexplained += usize::from(!found.iter().any(is_named));
    }
    // `erf` for `erfc` is a cancelled tail.
    assert_eq!(unexplained, bugs.len() - 1);
}

// Verifies: ORA-047. Our oracle, with requests that are changed on their way to it.
#[test]
fn bugs_of_laws_and_nuisances_are_named() {
    let palpate = palpate();
    for [flag, group, change] in rows(
        r#"
        noncentrality_ignored | f_tail | s/"noncentrality":[^,}]*/"noncentrality":0/
        noncentrality_sign | student_tail | s/"noncentrality":-/"noncentrality":/
        nuisances_ignored | theta_nuisances | s/"nuisances":.*,"residual"/"nuisances":[],"residual"/
        level_ignored | theta_nuisances | s/"unknown"/"known"/
        bias_ignored | theta_nuisances | s/"bias":[^,}]*/"bias":0/
        prior_ignored | bank_posterior | s/"prior":\[[^],]*,[^],]*\]/"prior":[0.5,0.5]/
        level_ignored | bank_posterior | s/"unknown"/"known"/
        weights_ignored | robust_evidence | s/"weights":\[[^],]*,[^],]*\]/"weights":[1,1]/
        nuisances_ignored | bank_posterior | s/"nuisances":.*,"prior"/"nuisances":[],"prior"/
        "#,
    ) {
        let program = format!("sed -u '{change}' | '{palpate}' oracle");
        let options = format!("--format json --only {group}");
        let verdict = json_of(&conform(&options, &["sh", "-c", &program]));
        assert_eq!(first_bug(&verdict), flag, "{}", verdict["diagnosis"]);
    }
}
