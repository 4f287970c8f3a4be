//! Counts of right answers, and the journal of an experiment.

use std::collections::HashSet;

use palpate_paper::psychophysics::Journal;
use palpate_paper::psychophysics::{AnswerTable, MOST_TRIALS, analyse};

use crate::message::{check_file_message, check_message, check_quoting};
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

/// An accepted journal is the same when it is written and read again, its counts are those of its
/// answers, and a line that an abort left unfinished does not count; a refusal names the line.
pub fn journal(text: &str) -> Outcome {
    let accepted = |journal: Journal| {
        let written = journal.to_text();
        let again = Journal::parse(&written).expect("what was written can be read");
        assert_eq!((&again, again.to_text()), (&journal, written.clone()));
        for cut in ["right", "nonsense"] {
            let again = Journal::parse(&format!("{written}{cut}"));
            assert_eq!(again.as_ref(), Ok(&journal), "{cut:?}");
        }
        check_counts(&journal, &written);
    };
    judged(Journal::parse(text), accepted, |error| {
        let quoted = check_quoting(&error, text);
        // Of an unfinished line, and behind the last one, there is nothing.
        assert!([quoted, "\"\"".into()].contains(&error.found));
    })
}

fn check_counts(journal: &Journal, written: &str) {
    let count = |answer| written.lines().filter(|&line| line == answer).count();
    let counts = journal.counts();
    let right: usize = counts.iter().map(|(right, _)| right).sum();
    let answers: usize = counts.iter().map(|(_, all)| all).sum();
    assert_eq!(right, count("right"));
    assert_eq!(answers, right + count("wrong"));
    let setup = journal.setup();
    let inclusions = setup.inclusions.split(',').count();
    assert!((1..=1000).contains(&setup.trials));
    assert!((1..=100).contains(&inclusions));
    let all = setup.trials * inclusions;
    assert_eq!(journal.next().is_none(), answers == all);
    assert_eq!(journal.table_row().is_some(), answers == all);
}
