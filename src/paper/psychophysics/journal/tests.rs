use super::*;

fn setup(seed: u64) -> Setup {
    Setup {
        seed,
        trials: 30,
        subject: "1".into(),
        condition: "FEM data".into(),
        inclusions: "2.6,4.6,6.6,8.6".into(),
    }
}

// Verifies: PSY-003, PSY-004.
#[test]
fn an_aborted_experiment_goes_on_where_it_stopped() {
    let mut journal = Journal::new(setup(3));
    let mut text = journal.to_text();
    let plan = plan(3, 4, 30);
    let mut expected = [0; 4];
    for number in 0..120 {
        let (at, trial) = journal.next().unwrap();
        assert_eq!((at, trial), (number, plan[number]));
        assert_eq!(journal.table_row(), None);
        let right = number % 5 != 0;
        expected[trial.inclusion] += usize::from(right);
        text += journal.answer(right);
        // The next line is torn off by an abort.
        journal = Journal::parse(&format!("{text}ri")).unwrap();
    }
    assert_eq!(journal.next(), None);
    let [a, b, c, d] = expected;
    let row = format!("subject,condition,trials,2.6,4.6,6.6,8.6\n1,FEM data,30,{a},{b},{c},{d}\n");
    assert_eq!(journal.table_row(), Some(row));
    let error = Journal::parse(&format!("{text}right\n")).unwrap_err();
    assert_eq!(error.line, Some(127));
    assert_eq!(error.expected, "no more answers than pairs");
}

// Verifies: PSY-003.
#[test]
fn what_is_no_journal_is_refused_with_its_line() {
    let good = Journal::new(setup(3)).to_text();
    for (from, to, line) in [
        ("palpate-experiment 1", "palpate-experiment 2", 1),
        ("seed 3", "seed -3", 2),
        ("trials 30", "trials 0", 3),
        ("trials 30", "trials 1e3", 3),
        ("subject", "sbjct", 4),
        ("condition", "", 5),
        ("2.6,4.6", "2.6,,4.6", 6),
    ] {
        let error = Journal::parse(&good.replace(from, to)).unwrap_err();
        assert_eq!(error.line, Some(line), "{error}");
    }
    for (text, message) in [
        (
            good + "maybe\n",
            "line 7: \"maybe\", expected right or wrong",
        ),
        (String::new(), "line 1: \"\", expected palpate-experiment 1"),
    ] {
        assert_eq!(Journal::parse(&text).unwrap_err().to_string(), message);
    }
}
