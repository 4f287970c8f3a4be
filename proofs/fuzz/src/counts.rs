//! Counts of right answers, and the journal of an experiment.

use std::collections::HashSet;
use std::path::Path;

use palpate::journal::take_lines;
use palpate::refusal::Refusal;
use palpate_paper::psychophysics::{AnswerTable, Experiment, MOST_TRIALS, Setup, analyse};

use crate::message::{check_file_message, check_message};
use crate::{FILE, Outcome, judged};

/// An accepted table has counts that fit their trials and names that can be printed, is the same
/// when it is written and read again, and can be analysed; a refusal names file and line.
pub fn counts_csv(text: &str) -> Outcome {
    let refused = |error| check_file_message(&error, text);
    let accepted = |table| check_table(&table);
    judged(AnswerTable::from_csv(text, FILE), accepted, refused)
}

fn check_table(table: &AnswerTable) {
    let plain = |name: &str| !name.is_empty() && !name.chars().any(char::is_control);
    let inclusions = table.inclusions();
    let names: HashSet<_> = inclusions.iter().map(|one| &one.name).collect();
    assert!(!names.is_empty() && names.len() == inclusions.len());
    for inclusion in inclusions {
        assert!(plain(&inclusion.name));
        assert!(inclusion.depth.is_finite() && inclusion.depth > 0.0);
    }
    let mut rows = 0;
    assert!(!table.conditions().is_empty());
    for condition in table.conditions() {
        assert!(plain(&condition.name));
        let names: HashSet<_> = condition.subjects.iter().map(|one| &one.name).collect();
        assert!(!names.is_empty() && names.len() == condition.subjects.len());
        for subject in &condition.subjects {
            assert!(plain(&subject.name));
            assert!((1..=MOST_TRIALS).contains(&subject.trials));
            assert_eq!(subject.correct.len(), inclusions.len());
            assert!(subject.correct.iter().all(|&k| k <= subject.trials));
            rows += 1;
        }
    }
    let again = AnswerTable::from_csv(&written(table), FILE).expect("what was written can be read");
    assert_eq!(again, *table);
    // The fits take some milliseconds for each count: small tables have all their cases.
    if rows * inclusions.len() <= 4 {
        check_analysis(table);
    }
}

/// An analysis is there or is refused, and holds no number that JSON cannot.
fn check_analysis(table: &AnswerTable) {
    match analyse(table) {
        Ok(analysis) => {
            let written = serde_json::to_string(&analysis).expect("numbers and texts");
            let read: serde_json::Value = serde_json::from_str(&written).expect("JSON");
            assert!(read.is_object());
        }
        Err(error) => check_message(&error.to_string()),
    }
}

fn written(table: &AnswerTable) -> String {
    let mut text = String::from("subject,condition,trials");
    for inclusion in table.inclusions() {
        text += &format!(",{}", inclusion.name);
    }
    for condition in table.conditions() {
        for subject in &condition.subjects {
            text += &format!("\n{},{},{}", subject.name, condition.name, subject.trials);
            for correct in &subject.correct {
                text += &format!(",{correct}");
            }
        }
    }
    text
}

/// The answers of an experiment, as the lines of its journal after the first. Accepted lines are read alike again, the counts are those
/// of the lines, and a line that an abort left unfinished does not count; a refusal names the line.
pub fn journal(text: &str) -> Outcome {
    let accepted = |experiment: Experiment| {
        let counts = experiment.counts();
        let right: usize = counts.iter().map(|(right, _)| right).sum();
        let answers: usize = counts.iter().map(|(_, all)| all).sum();
        let whole = text.rfind('\n').map_or("", |end| &text[..=end]);
        assert_eq!(answers, whole.lines().count());
        assert_eq!(right, whole.matches("true").count());
        assert_eq!(experiment.next().is_none(), answers == PAIRS);
        assert_eq!(experiment.table_row().is_some(), answers == PAIRS);
        for cut in ["{\"right\":true}", "nonsense"] {
            assert_eq!(read(&format!("{whole}{cut}")).as_ref(), Ok(&experiment));
        }
    };
    judged(read(text), accepted, |error| {
        check_file_message(&error, text)
    })
}

/// Pairs of the experiment.
const PAIRS: usize = 2 * 3;

fn read(lines: &str) -> Result<Experiment, Refusal> {
    let mut experiment = Experiment::new(Setup {
        schema_version: 2,
        seed: 1,
        trials: 3,
        subject: "1".into(),
        condition: "FEM data".into(),
        inclusions: vec!["2.6".into(), "8.6".into()],
        observer: "person".into(),
        noise_sd: None,
        seconds: 3,
        maps_sha256: vec!["5c".into(), "d2".into(), "07".into()],
    })?;
    take_lines(lines.as_bytes(), Path::new(FILE), 1, |line| {
        experiment.take(line)
    })?;
    Ok(experiment)
}
