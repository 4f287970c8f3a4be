use super::*;

fn experiment(trials: usize) -> Experiment {
    Experiment::new(Setup {
        schema_version: 2,
        seed: 3,
        trials,
        subject: "1".into(),
        condition: "FEM data".into(),
        inclusions: ["2.6", "4.6", "6.6", "8.6"].map(String::from).into(),
        observer: "ideal".into(),
        noise_sd: Some(0.5),
        seconds: 3,
        maps_sha256: ["5c", "d2", "07", "1e", "33"].map(String::from).into(),
    })
    .unwrap()
}

// Verifies: PSY-003, PSY-004.
#[test]
fn an_aborted_experiment_goes_on_where_it_stopped() {
    let mut lines = Vec::new();
    let plan = plan(3, 4, 30);
    let mut expected = [0; 4];
    for number in 0..120 {
        // Each time anew from what the journal keeps.
        let mut experiment = experiment(30);
        lines
            .iter()
            .for_each(|line: &String| experiment.take(line).unwrap());
        let (at, trial) = experiment.next().unwrap();
        assert_eq!((at, trial), (number, plan[number]));
        assert_eq!(experiment.table_row(), None);
        let right = number % 5 != 0;
        expected[trial.inclusion] += usize::from(right);
        lines.push(serde_json::to_string(&Answer { right }).unwrap());
    }
    assert_eq!(lines[..2], ["{\"right\":false}", "{\"right\":true}"]);
    let mut experiment = experiment(30);
    lines.iter().for_each(|line| experiment.take(line).unwrap());
    assert_eq!(experiment.next(), None);
    let [a, b, c, d] = expected;
    let row = format!("subject,condition,trials,2.6,4.6,6.6,8.6\n1,FEM data,30,{a},{b},{c},{d}\n");
    assert_eq!(experiment.table_row(), Some(row));
    let error = experiment.take(&lines[0]).unwrap_err().to_string();
    assert_eq!(error, "one answer too many: the experiment has 120 pairs");
}

// Verifies: PSY-003.
#[test]
fn a_line_that_is_no_answer_is_refused() {
    let mut experiment = experiment(1);
    let lines = r#"|right|{}|{"right":1}|{"right":true,"x":0}|{"right":true} ?"#;
    for line in lines.split('|') {
        let error = experiment.take(line).unwrap_err().to_string();
        let expected = format!("{line:?} is not an answer; delete the line or the file");
        assert_eq!(error, expected);
    }
    assert_eq!(experiment.next().unwrap().0, 0);
}

// Verifies: PSY-003.
#[test]
fn the_first_line_states_the_experiment() {
    let line = serde_json::to_string(&experiment(30).setup).unwrap();
    assert!(
        line.starts_with("{\"schema\":\"palpate-experiment\","),
        "{line}"
    );
    let rest = ",\"schema_version\":2,\"seed\":3,\"trials\":30,\"subject\":\"1\",\"condition\":\"FEM data\",\"inclusions\":[\"2.6\",\"4.6\",\"6.6\",\"8.6\"],\"observer\":\"ideal\",\"noise_sd_n\":0.5,\"seconds\":3,\"maps_sha256\":[\"5c\",\"d2\",\"07\",\"1e\",\"33\"]}";
    assert!(line.ends_with(rest), "{line}");
}
