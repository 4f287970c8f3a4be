//! Table 1, and files of its form.

use super::*;
use crate::report::paper::PRINTED_MEANS;

/// Table 1, typed a second time: one row a subject, one column an inclusion. It shows a slip of the pen in the table that is used.
#[rustfmt::skip]
const TYPED_AGAIN: [(&str, [[u32; 4]; 10]); 3] = [
    ("direct contact", [
        [30, 28, 27, 27], [30, 30, 28, 23], [30, 29, 20, 21], [28, 25, 18, 16], [27, 26, 23, 19],
        [30, 30, 27, 17], [23, 19, 18, 13], [30, 30, 30, 19], [30, 30, 29, 23], [30, 28, 27, 22],
    ]),
    ("FEM data", [
        [30, 30, 30, 21], [30, 30, 29, 25], [30, 29, 28, 16], [28, 29, 24, 20], [29, 25, 20, 17],
        [29, 29, 27, 15], [27, 23, 18, 15], [30, 30, 27, 20], [29, 24, 21, 16], [30, 28, 29, 24],
    ]),
    ("measured data", [
        [30, 22, 24, 18], [30, 28, 28, 21], [28, 27, 19, 15], [25, 19, 19, 21], [29, 24, 23, 18],
        [26, 21, 23, 17], [17, 15, 19, 18], [29, 26, 26, 13], [26, 21, 22, 15], [28, 25, 26, 18],
    ]),
];

// Verifies: PSY-020.
#[test]
fn fields_may_stand_in_quotes() {
    let plain = "subject,condition,trials,2.6,4.6\n1,a; b,30,30,28\n2,a; b,30,29,25\n";
    let read = |text: &str| AnswerTable::from_csv(text, "counts.csv").unwrap();
    let all = "\"subject\",\"condition\",\"trials\",\"2.6\",\"4.6\"\n\"1\",\"a; b\",30,30,28\n\"2\",\"a; b\",30,29,25\n";
    assert_eq!(read(all), read(plain));
    assert_eq!(read(&plain.replacen("a; b", "\"a; b\"", 1)), read(plain));
    // A comma between quotation marks separates no fields.
    let comma = plain.replace("a; b", "\"a, b\"");
    assert_eq!(read(&comma).conditions()[0].name, "a, b");
}

// Verifies: PSY-020.
#[test]
fn table_1_is_built_in() {
    let table = AnswerTable::paper().unwrap();
    let depths: Vec<f64> = table.inclusions().iter().map(|i| i.depth).collect();
    assert_eq!(depths, [2.6e-3, 4.6e-3, 6.6e-3, 8.6e-3]);
    // The means that the paper prints below each experiment, with one decimal.
    for (condition, printed) in table.conditions().iter().zip(PRINTED_MEANS) {
        assert_eq!(condition.subjects.len(), 10);
        for (column, printed) in printed.into_iter().enumerate() {
            let (correct, trials) = condition.pooled(column);
            assert_eq!((correct as f64, trials), (10.0 * printed, 300));
        }
    }
}

// Verifies: PSY-020.
#[test]
fn table_1_is_that_of_a_second_typist() {
    let table = AnswerTable::paper().unwrap();
    for (condition, (name, correct)) in table.conditions().iter().zip(TYPED_AGAIN) {
        assert_eq!(condition.name, name);
        let subjects: Vec<&[u32]> = condition.subjects.iter().map(|s| &s.correct[..]).collect();
        assert_eq!(subjects, correct);
    }
}

// Verifies: PSY-020.
#[test]
fn names_and_trials_are_free() {
    let text = "\u{feff}# mine\nsubject, condition, trials, soft 6.6, stiff 6.6\n a b , x , 7 , 0 , 7 \n\nc,x,1000,999,1\na b,y,1,1,0\n";
    let table = AnswerTable::from_csv(text, "file").unwrap();
    let names = table.inclusions().iter().map(|i| (&i.name[..], i.depth));
    assert!(names.eq([("soft 6.6", 6.6e-3), ("stiff 6.6", 6.6e-3)]));
    let [x, y] = table.conditions() else { panic!() };
    assert_eq!((x.name.as_str(), x.subjects.len()), ("x", 2));
    assert_eq!(x.counts(0), [(0, 7), (999, 1000)]);
    assert_eq!(y.pooled(0), (1, 1));
}

/// What stands in a good table, what stands there instead, and words of the refusal.
const REFUSED: &str = "
subject, => sbjct, => t.csv:1: header \"sbjct,condition,trials,2.6,8.6\"; give subject,condition,trials
,2.6,8.6 =>  => t.csv:1: header
8.6 => deep => t.csv:1: header, column 5 = \"deep\", but must be the name of an inclusion that ends in its depth in mm
8.6 => -8.6 => \"-8.6\", but must be the name
8.6 => inf => \"inf\", but must be the name
8.6 => 2.6 => column 5 = \"2.6\", but must be each inclusion once
2,gel,30,30,21 => 2,gel,30,30 => t.csv:3: 4 fields; give 5
30,21 => 31,21 => t.csv:3: 2.6 = \"31\", but must be a whole number from 0 to the 30 trials of the row
30,21 => 30,-1 => t.csv:3: 8.6 = \"-1\", but must be a whole number from 0
30,21 => 30,21.0 => t.csv:3: 8.6 = \"21.0\", but must be a whole number
2,gel,30 => 2,gel,0 => t.csv:3: trials = \"0\", but must be a whole number from 1 to 1000
2,gel,30 => 2,gel,1001 => t.csv:3: trials = \"1001\", but must be
2,gel => 2, => t.csv:3: condition = \"\", but must be a name
2,gel => \u{1b}[2m,gel => t.csv:3: subject = \"\\u{1b}[2m\", but must be a name of printable
2,gel => 1,gel => t.csv:3: subject \"1\" again under condition \"gel\"; keep one row; the first is line 2
";

// Verifies: PSY-020.
#[test]
fn what_is_no_table_is_refused_with_line_column_and_value() {
    let good = "subject,condition,trials,2.6,8.6\n1,gel,30,28,20\n2,gel,30,30,21\n";
    assert!(AnswerTable::from_csv(good, "t.csv").is_ok());
    for case in REFUSED.trim().lines() {
        let [from, to, message] = case.split(" => ").collect::<Vec<_>>()[..] else {
            panic!("{case}");
        };
        let text = good.replacen(from, to, 1);
        let error = AnswerTable::from_csv(&text, "t.csv")
            .unwrap_err()
            .to_string();
        assert!(error.contains(message) && !error.contains('\n'), "{error}");
    }
    let empty = AnswerTable::from_csv("subject,condition,trials,2.6\n", "t").unwrap_err();
    let words = "t:1: no rows under the header; give at least one";
    assert_eq!(empty.to_string(), words);
    assert!(AnswerTable::from_csv("", "t").is_err());
}

/// Asserts that two columns of one kind are refused, but for the stimulus beside the inclusion.
fn assert_columns_are_told_apart() {
    let read = |header: &str, row: &str| {
        let text = format!("# mine\n{header}\n{row}\n");
        AnswerTable::from_csv(&text, "t.csv").map_err(|refusal| refusal.to_string())
    };
    for (header, expected) in [
        (
            "participant,condition,inclusion,key_resp.corr,response.corr",
            "4 (\"key_resp.corr\") and 5 (\"response.corr\") for the answer",
        ),
        (
            "participant,condition,stimulus,Correct,SUBJECT",
            "1 (\"participant\") and 5 (\"SUBJECT\") for the subject",
        ),
        (
            "subject,inclusion,corr,inclusion,condition",
            "2 (\"inclusion\") and 4 (\"inclusion\") for the inclusion",
        ),
    ] {
        let message = format!("t.csv:2: columns {expected} in the header; keep one of them");
        assert_eq!(read(header, "1,2.6,1,1,1"), Err(message));
    }
    // As jsPsych writes it.
    let one = read("subject,condition,inclusion,correct", "1,a,2.6,1");
    for (header, row) in [
        (
            "stimulus,subject,condition,inclusion,correct",
            "a.png,1,a,2.6,1",
        ),
        (
            "inclusion,subject,condition,stimulus,correct",
            "2.6,1,a,6.6,1",
        ),
    ] {
        assert_eq!(read(header, row), one);
    }
    assert!(one.is_ok());
}

// Verifies: PSY-021.
#[test]
fn a_row_for_each_trial_is_counted() {
    // As PsychoPy writes it, in random order, with a row of instructions.
    let text = "participant,condition,thisN,stimulus,key_resp.corr,\"note, free\"\n\
        ,,,,,\"read, please\"\n\
        2,glove,0,6.6,0,\n2,glove,1,soft 2.6,1,\n1,glove,0,soft 2.6,1.0,\n1,glove,1,6.6,1.0,\n\
        1,glove,2,soft 2.6,0.0,\n1,glove,3,6.6,True,\n1,none,0,6.6,false,\n1,none,1,soft 2.6,TRUE,\n";
    let counts =
        "subject,condition,trials,soft 2.6,6.6\n2,glove,1,1,0\n1,glove,2,1,2\n1,none,1,1,0\n";
    let found = AnswerTable::from_csv(text, "trials.csv").unwrap();
    assert_eq!(found, AnswerTable::from_csv(counts, "counts.csv").unwrap());
    let head = "subject,condition,inclusion,correct\n";
    for (rows, expected) in [
        ("1,a,2.6,1\n1,a,2.6\n", "t.csv:3: 3 fields; give 4"),
        (
            "1,a,2.6,2\n",
            "t.csv:2: correct = \"2\", but must be 1 or 0, or true or false",
        ),
        (
            "1,a,soft,1\n",
            "t.csv:2: inclusion = \"soft\", but must be the name of an inclusion",
        ),
        (",a,2.6,1\n", "t.csv:2: subject = \"\", but must be a name"),
        (
            "1,,2.6,1\n",
            "t.csv:2: condition = \"\", but must be a name",
        ),
        (
            "1,a,2.6,1\n1,a,2.6,1\n1,a,6.6,0\n",
            "t.csv:2: subject \"1\" has 2 trials of \"2.6\" and 1 of \"6.6\"; give as many",
        ),
        (
            "1,a,2.6,\n",
            "t.csv:1: no rows under the header; give at least one",
        ),
    ] {
        let error = AnswerTable::from_csv(&format!("{head}{rows}"), "t.csv")
            .unwrap_err()
            .to_string();
        assert!(error.starts_with(expected), "{error}");
    }
    assert_columns_are_told_apart();
    let many = "1,a,2.6,1\n".repeat(1001);
    let error = AnswerTable::from_csv(&format!("{head}{many}"), "t.csv").unwrap_err();
    assert!(
        error
            .to_string()
            .contains("1001 trials of an inclusion; give at most 1000"),
        "{error}"
    );
}
