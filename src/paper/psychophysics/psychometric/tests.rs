//! Expected values: scipy, Nelder and Mead from 27 starts, and Brent's method (`reference.py`).

use super::*;
use crate::psychophysics::AnswerTable;
use palpate_asserts::{assert_near, numbers};

fn fitted(table: &AnswerTable, condition: usize) -> Option<Psychometric> {
    let condition = &table.conditions()[condition];
    let dispersion = Overdispersion::new(condition, table.inclusions().len()).unwrap();
    psychometric(table.inclusions(), condition, dispersion).unwrap()
}

/// The golden section leaves ln s within 2 · 0.86 · 4·10⁻⁶ = 7·10⁻⁶, and with it m and λ, which move by less than 3 mm
/// and 0.1 for 1 of ln s; m by itself is within 2 · 1.3 mm · 4·10⁻⁶.
const OF_LENGTH: f64 = 5e-8;
const OF_LAPSE: f64 = 2e-6;

/// For each condition the midpoint and the spread, mm, and the lapse: the value, and its ends, binomial and dispersed.
const EXPECTED: &str = "
0 7.7450074400 7.1545209862 8.3352296625 6.5539482954 9.2771090507
0 2.4695137100 1.6778529458 3.8427891939 1.0706728176 5.4209094835
0 0.0322562100 0.0000000000 0.0650366616 0.0000000000 0.1010487789
1 7.5588688400 7.1038913982 8.0332078377 6.7426816241 8.4382758845
1 2.1029176600 1.4215729521 3.0816117317 1.0230577927 3.7782608787
1 0.0258421500 0.0000000000 0.0548494097 0.0000000000 0.0766215619
2 5.6038125500 5.0557020800 7.5267074592 4.6489548907 8.3552241438
2 4.0580699600 2.0684164153 5.3947996638 0.8675007282 6.9386421267
2 0.0000000000 0.0000000000 0.1467907667 0.0000000000 0.1984146067
";
/// Those of the three fits.
const DEVIANCES: [f64; 3] = [0.1524763348, 2.4262896179, 10.1608743260];

// Verifies: PSY-040, PSY-042.
#[test]
fn fits_of_table_1() {
    let table = AnswerTable::paper().unwrap();
    let expected = numbers::<6>(EXPECTED);
    for (condition, deviance) in DEVIANCES.into_iter().enumerate() {
        let found = fitted(&table, condition).unwrap();
        let parameters = [
            (found.midpoint_m, 1e-3, OF_LENGTH),
            (found.spread_m, 1e-3, OF_LENGTH),
            (found.lapse, 1.0, OF_LAPSE),
        ];
        let rows = expected[3 * condition..].iter();
        for ((parameter, scale, tolerance), row) in parameters.into_iter().zip(rows) {
            let [_, value, ends @ ..] = row.map(|number| scale * number);
            assert_near(parameter.value, value, tolerance);
            let bounds = [parameter.bounds, parameter.dispersed_bounds];
            let found = bounds.map(|bounds| [bounds.lower, bounds.upper].map(Option::unwrap));
            for (found, end) in found.as_flattened().iter().zip(ends) {
                assert_near(*found, end, tolerance);
            }
        }
        assert_near(found.deviance, deviance, 1e-7);
        assert_eq!(found.degrees, 1);
        // One degree of freedom: twice the normal tail.
        let tail = 2.0 * palpate::stats::normal::upper_tail(deviance.sqrt()).unwrap();
        assert_near(found.p_value.unwrap(), tail, 1e-7);
    }
}

/// Scipy, Nelder and Mead from the best of a grid: a fall between two depths that are near to one another.
// Verifies: PSY-040.
#[test]
fn a_steep_fall_between_two_depths_is_found() {
    let text = "subject,condition,trials,0.43,2.1,2.77,8.43,8.77,13.43\n1,a,10,10,10,9,8,6,5\n2,a,10,10,9,9,8,5,4\n";
    let found = fitted(&AnswerTable::from_csv(text, "t").unwrap(), 0).unwrap();
    assert_near(found.midpoint_m.value, 8.518682422e-3, OF_LENGTH);
    assert_near(found.spread_m.value, 0.205889948e-3, OF_LENGTH);
    assert_near(found.lapse.value, 0.05, OF_LAPSE);
    assert_near(found.deviance, 3.078235205866136, 1e-7);
}

/// Where only the deepest inclusion is missed, in a share p, each spread has the midpoint that explains it: Φ((m − d)/s) = 1 − 2p, so
/// that the deviance is 0 whatever the spread, down to the least that is searched.
// Verifies: PSY-040.
#[test]
fn a_fall_at_the_last_depth_bounds_no_spread_from_below() {
    for (depths, counts) in [
        ("2.6,4.6,6.6,8.6", "30,30,30"),
        ("9,10,11,13,17", "30,30,30,30"),
    ] {
        let subjects = [28, 29, 27, 30].map(|last| format!("{last},c,30,{counts},{last}\n"));
        let text = format!("subject,condition,trials,{depths}\n{}", subjects.concat());
        let found = fitted(&AnswerTable::from_csv(&text, "t").unwrap(), 0).unwrap();
        let spread = found.spread_m;
        assert_near(found.deviance, 0.0, 1e-7);
        assert_eq!(
            [spread.bounds.lower, spread.dispersed_bounds.lower],
            [None; 2]
        );
        assert!(spread.bounds.upper.is_some());
    }
}

// φ of direct contact is (41.3194 + 47.3455 + 43.1060 + 22.2)/36 = 4.2770; scipy: f.sf(0.1524763/4.2769680, 1, 36).
// Verifies: PSY-034, PSY-042.
#[test]
fn dispersion_makes_deviances_smaller() {
    let table = AnswerTable::paper().unwrap();
    let found = Overdispersion::new(&table.conditions()[0], 4).unwrap();
    let mut found = found.unwrap();
    assert_near(found.ratio, 4.276968045639429, 1e-12);
    assert_eq!(found.degrees, 36);
    let p = fitted(&table, 0).unwrap().p_value_dispersed.unwrap();
    assert_near(p, 0.8512993614712892, 1e-6);
    // Never narrower than a binomial.
    found.ratio = 0.5;
    assert_eq!(found.factor(), 1.0);
}

// Verifies: PSY-040.
#[test]
fn without_three_depths_or_wrong_answers_there_is_no_function() {
    let table = |header: &str, rows: &str| {
        AnswerTable::from_csv(&format!("subject,condition,trials,{header}\n{rows}"), "t").unwrap()
    };
    for (header, rows) in [
        ("2,4", "1,x,30,30,20\n2,x,30,28,21\n"),
        ("a 2,b 2,4", "1,x,30,30,29,20\n2,x,30,28,29,21\n"),
        ("2,4,6", "1,x,30,30,30,30\n2,x,30,30,30,30\n"),
    ] {
        assert_eq!(fitted(&table(header, rows), 0), None);
    }
    // Three depths leave no degree of freedom, and answers that do not fall set no bounds.
    let flat = fitted(&table("2,4,6", "1,x,30,25,25,26\n2,x,30,26,25,26\n"), 0).unwrap();
    assert_eq!((flat.degrees, flat.p_value), (0, None));
    assert_eq!(flat.midpoint_m.bounds.upper, None);
}

// Answers as the function has them are fitted by it, so that a midpoint taken for a threshold, or a spread for a slope,
// shows. Counts of 1000 trials are rounded: share to 5·10⁻⁴, and the parameters to some times that.
// Verifies: PSY-040.
#[test]
fn the_function_is_the_one_that_the_spec_states() {
    let depths = [2.0, 4.0, 5.0, 6.0, 8.0, 11.0];
    let (midpoint, spread, lapse) = (6.0, 2.0, 0.04);
    let right = depths.map(|depth| {
        let share = 0.5 + (0.5 - lapse) * lower_tail((midpoint - depth) / spread);
        format!(",{}", (1000.0 * share).round())
    });
    let (header, right) = (
        depths.map(|depth| format!(",{depth}")).concat(),
        right.concat(),
    );
    let text = format!("subject,condition,trials{header}\n1,x,1000{right}\n2,x,1000{right}\n");
    let table = AnswerTable::from_csv(&text, "t").unwrap();
    let (ratio, degrees) = (1.0, 6);
    let dispersion = Some(Overdispersion { ratio, degrees });
    let found = psychometric(table.inclusions(), &table.conditions()[0], dispersion);
    let found = found.unwrap().unwrap();
    assert_near(found.midpoint_m.value, 1e-3 * midpoint, 2e-5);
    assert_near(found.spread_m.value, 1e-3 * spread, 4e-5);
    assert_near(found.lapse.value, lapse, 2e-3);
}
