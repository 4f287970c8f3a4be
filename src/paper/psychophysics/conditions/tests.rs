//! Closed forms: few subjects, whose exchanges of signs can be counted by hand.

use super::*;
use palpate_asserts::assert_near;

// Verifies: PSY-050.
#[test]
fn exchanges_of_signs_are_all_counted() {
    // All of one sign: only that and its mirror image of 2^m are as far.
    assert_eq!(sign_flip(&[1.0, 2.0, 3.0, 4.0]), Some(2.0 / 16.0));
    // 1 + 2 − 3 = 0: every sum is as far.
    assert_eq!(sign_flip(&[1.0, 2.0, -3.0]), Some(1.0));
    // Sums of ±1 ±2 ±4: 5 = −1 + 2 + 4, so ±5 and ±7 of 8.
    assert_eq!(sign_flip(&[-1.0, 2.0, 4.0]), Some(4.0 / 8.0));
    // In binary 0.1 + 0.2 − 0.3 is not −(0.1 + 0.2 − 0.3) + …: equal sums count as equal.
    assert_eq!(
        sign_flip(&[0.1, 0.2, 0.3, -0.3, -0.2]),
        sign_flip(&[1.0, 2.0, 3.0, -3.0, -2.0])
    );
    assert_eq!(sign_flip(&[0.0, 0.0]), Some(1.0));
    assert_eq!(sign_flip(&[1.0; 20]), Some(2.0 / f64::from(1 << 20)));
    assert_eq!(sign_flip(&[1.0; 21]), None);
}

// Verifies: PSY-050.
#[test]
fn subjects_are_their_own_blocks() {
    // Subjects 1 to 3 lose 3, 6 and 6 of 30; subject 4 took part once. The order in the file does not matter.
    let text = "subject,condition,trials,2,4\n1,a,30,30,30\n2,a,30,28,28\n3,a,30,20,20\n4,a,30,0,0\n3,b,10,5,5\n2,b,30,22,22\n1,b,60,60,48\n";
    let found = comparisons(&AnswerTable::from_csv(text, "t").unwrap()).unwrap();
    let [comparison] = &found[..] else { panic!() };
    assert_eq!([&comparison.first[..], &comparison.second], ["a", "b"]);
    assert_eq!(comparison.subjects, 3);
    // Means over both inclusions: 0.1, 0.2, 1/6.
    let mean = (0.1 + 0.2 + 1.0 / 6.0) / 3.0;
    assert_near(comparison.overall.mean, mean, 1e-15);
    assert_eq!(comparison.overall.p_value, Some(2.0 / 8.0));
    // Student's quantile with 2 degrees of freedom at 95 %: 4.302652729749464 (closed form, 0.95 √2/√(1 − 0.95²)).
    let squares = [0.1_f64, 0.2, 1.0 / 6.0].map(|d| (d - mean).powi(2));
    let spread: f64 = squares.iter().sum();
    let reach = 4.302652729749464 * (spread / 2.0 / 3.0).sqrt();
    let bounds = comparison.overall.bounds.unwrap();
    assert_near(bounds.lower, mean - reach, 1e-13);
    assert_near(bounds.upper, mean + reach, 1e-13);
    assert_eq!(comparison.by_inclusion[1].inclusion, "4");
    for (column, first) in [0.0, 0.2].into_iter().enumerate() {
        let found = comparison.by_inclusion[column].difference.mean;
        assert_near(found, (first + 0.2 + 1.0 / 6.0) / 3.0, 1e-15);
    }
}

// Verifies: PSY-050.
#[test]
fn conditions_of_table_1() {
    let found = comparisons(&AnswerTable::paper().unwrap()).unwrap();
    let p_values = found.iter().map(|found| found.overall.p_value.unwrap());
    let p_values: Vec<f64> = p_values.collect();
    // Direct less measured, right answers of 120: 18 4 11 3 1 17 4 15 28 10, so only all signs or none; FEM less
    // measured: 17 7 14 17 −3 13 14 13 6 14, so with the −3 of either sign. Direct less FEM adds up to −1, the least
    // that it can, since it is odd.
    assert_eq!(p_values, [1.0, 2.0 / 1024.0, 4.0 / 1024.0]);
    let holm = found.iter().map(|found| found.p_value_holm.unwrap());
    let holm: Vec<f64> = holm.collect();
    assert_eq!(holm, [1.0, 3.0 * 2.0 / 1024.0, 2.0 * 4.0 / 1024.0]);
}

// Verifies: PSY-050.
#[test]
fn holm_orders_multiplies_and_never_decreases() {
    let corrected = holm(&[Some(0.04), None, Some(0.01), Some(0.03), Some(0.9)]);
    // 4·0.01, 3·0.03, then 2·0.04 = 0.08 below 0.09, and 0.9.
    let expected = [Some(0.09), None, Some(0.04), Some(0.09), Some(0.9)];
    assert_eq!(corrected, expected);
    assert_eq!(holm(&[Some(0.8), Some(0.7)]), [Some(1.0), Some(1.0)]);
}

// Verifies: PSY-050.
#[test]
fn conditions_without_a_common_subject_are_not_compared() {
    let compared = |rows: &str| {
        let text = format!("subject,condition,trials,2\n{rows}");
        comparisons(&AnswerTable::from_csv(&text, "t").unwrap()).unwrap()
    };
    assert_eq!(compared("1,a,30,30\n2,b,30,28\n"), []);
    // One subject, or equal differences: no interval.
    let overall = compared("1,a,30,30\n1,b,30,28\n")[0].overall;
    assert_eq!((overall.bounds, overall.p_value), (None, Some(1.0)));
    // Each is better by a third, and by a tenth of other shares and trials, though no double is either.
    for (a, b) in [
        (["30,30"; 3], ["30,20"; 3]),
        (["30,27", "10,5", "20,8"], ["30,24", "20,8", "10,3"]),
    ] {
        let rows = |name: &str, of: [&str; 3]| {
            let rows = (1..)
                .zip(of)
                .map(|(subject, of)| format!("{subject},{name},{of}\n"));
            rows.collect::<String>()
        };
        let [found] = &compared(&(rows("a", a) + &rows("b", b)))[..] else {
            panic!("two conditions")
        };
        let alone = found.by_inclusion[0].difference;
        assert_eq!((found.overall.bounds, alone.bounds), (None, None), "{a:?}");
        assert_eq!(found.overall.p_value, Some(2.0 / 8.0));
    }
}
