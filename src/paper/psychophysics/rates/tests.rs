//! Expected values: scipy (`reference.py`), and closed forms. The intervals of Clopper and Pearson and of Wilson have
//! their own tests in `stats`.

use super::*;
use crate::psychophysics::AnswerTable;
use palpate::detect::two_afc;
use palpate::stats::dispersion::dispersion;
use palpate_asserts::{assert_near, numbers};

// Verifies: PSY-023.
#[test]
fn gamma_is_the_image_of_the_share_and_of_its_interval() {
    let rate = Rate::new(253, 300).unwrap();
    assert_near(rate.rate, 253.0 / 300.0, 0.0);
    // mpmath: √2 Φ⁻¹(253/300) as in the errata.
    assert_near(rate.gamma.gamma.unwrap(), 1.4258841436632816, 1e-14);
    for (gamma, share) in [
        (rate.gamma.bounds.lower, rate.clopper_pearson.lower),
        (rate.gamma.bounds.upper, rate.clopper_pearson.upper),
    ] {
        // Φ(γ/√2) and its inverse are good to some ULP.
        assert_near(two_afc(gamma.unwrap()).unwrap(), share, 1e-15);
    }
    // Confidence 95 %: tails of 2.5 % (scipy: beta.ppf(0.025, 253, 48)).
    assert_near(rate.clopper_pearson.lower, 0.7971688875873385, 1e-13);
    assert!(rate.wilson.lower > rate.clopper_pearson.lower);
}

// Verifies: PSY-023.
#[test]
fn nothing_is_infinite_and_nothing_negative() {
    let all = Rate::new(30, 30).unwrap().gamma;
    assert_eq!((all.gamma, all.bounds.upper), (None, None));
    assert!(all.bounds.lower.unwrap() > 1.0);
    for correct in [0, 13, 15] {
        let few = Rate::new(correct, 30).unwrap().gamma;
        assert_eq!((few.gamma, few.bounds.lower), (Some(0.0), Some(0.0)));
    }
    let text = serde_json::to_string(&all).unwrap();
    assert!(text.contains("\"upper\":null"));
}

/// Lower and upper end before the cut-off, χ² and its tail, for each condition and inclusion.
const EXPECTED: &str = "
0.9051617305621628 1.014838269437837  41.31944444444446  4.374804485492237e-06
0.8338733779880325 0.9994599553453007 47.345454545454544 3.383915055317462e-07
0.7143212442431454 0.9323454224235214 43.10595065312046  2.0611933374887466e-06
0.5699700848127016 0.7633632485206316 22.200000000000003 0.008266275900149146
0.9487060854807214 0.9979605811859453 12.328767123287674 0.19540307994314718
0.8596963946298454 0.9869702720368213 30.183644639773977 0.0004082428194519249
0.7415129904453714 0.9451536762212953 41.40105962492641  4.227475307496366e-06
0.5426036258747011 0.7173963741252989 17.288717288717287 0.04438204724797066
0.8014612650152119 0.9852054016514548 46.73507462686569  4.396686039699827e-07
0.6647516448284977 0.8552483551715023 26.242690058479532 0.0018642518493005985
0.6867228642189007 0.8399438024477659 17.14127560120549  0.046549034415613436
0.5192583355609178 0.6407416644390821 7.991242474001094  0.5350290076823754
";

// Verifies: PSY-023, PSY-031.
#[test]
fn subjects_as_the_sample_and_chi_square_of_table_1() {
    let table = AnswerTable::paper().unwrap();
    let conditions = table.conditions().iter();
    let cells = conditions.flat_map(|condition| (0..4).map(move |j| (condition, j)));
    for ((condition, column), [lower, upper, chi_square, p_value]) in cells.zip(numbers(EXPECTED)) {
        let counts = condition.counts(column);
        let (correct, trials) = condition.pooled(column);
        let pooled = Rate::new(correct, trials).unwrap();
        let found = clustered(&counts, &pooled).unwrap().unwrap();
        // Sums of ten numbers, and a quantile of 1e-13.
        assert_near(found.bounds.lower, lower, 1e-13);
        assert_near(found.bounds.upper, upper.min(1.0), 1e-13);
        let exact = pooled.clopper_pearson;
        let ratio = (upper.min(1.0) - lower) / (exact.upper - exact.lower);
        assert_near(found.width_ratio, ratio, 1e-11);
        let dispersion = dispersion(&counts).unwrap().unwrap();
        assert_near(dispersion.chi_square / chi_square, 1.0, 1e-13);
        assert_near(dispersion.p_value / p_value, 1.0, 1e-12);
        assert_eq!(dispersion.degrees, 9);
        let expected = 30.0 * pooled.rate.min(1.0 - pooled.rate);
        assert_near(dispersion.smallest_expected, expected, 1e-12);
        assert_eq!(dispersion.is_rough, 300 - correct < 50);
    }
}

// Verifies: PSY-023, PSY-031.
#[test]
fn trials_may_differ_between_subjects() {
    let counts = [(27, 30), (50, 60), (5, 10), (9, 20)];
    let pooled = Rate::new(91, 120).unwrap();
    let found = clustered(&counts, &pooled).unwrap().unwrap();
    assert_near(found.standard_error, 0.08767252245382037, 1e-15);
    let dispersion = dispersion(&counts).unwrap().unwrap();
    assert_near(dispersion.chi_square, 19.14361500568397, 1e-12);
    assert_near(dispersion.p_value, 0.0002553272005041417, 1e-15);
}

// A tenth of all answers is right: 1 of 10 and 3 of 30 are expected, and 9 and 27 wrong ones.
// Verifies: PSY-031.
#[test]
fn where_few_answers_are_right_they_make_the_law_rough() {
    let found = dispersion(&[(3, 10), (1, 30)]).unwrap().unwrap();
    assert_near(found.smallest_expected, 1.0, 1e-15);
    assert!(found.is_rough);
}

// Verifies: PSY-023, PSY-031.
#[test]
fn one_subject_or_equal_ones_say_nothing_of_the_next() {
    let same = Rate::new(50, 60).unwrap();
    assert_eq!(clustered(&[(50, 60)], &same), Ok(None));
    assert_eq!(clustered(&[(25, 30), (25, 30)], &same), Ok(None));
    // 29/35 is no binary number: 35 times its double is not 29.
    let shares = [(29, 35), (58, 70)];
    assert_eq!(
        clustered(&shares[..1].repeat(2), &Rate::new(58, 70).unwrap()),
        Ok(None)
    );
    assert_eq!(clustered(&shares, &Rate::new(87, 105).unwrap()), Ok(None));
    let differs = clustered(&[(29, 35), (57, 70)], &Rate::new(86, 105).unwrap());
    assert!(differs.unwrap().is_some());
    assert_eq!(dispersion(&[(50, 60)]), Ok(None));
    assert_eq!(dispersion(&[(30, 30), (30, 30)]), Ok(None));
    assert_eq!(dispersion(&[(0, 30), (0, 30)]), Ok(None));
    assert_eq!(
        dispersion(&[(25, 30), (25, 30)]).unwrap().unwrap().p_value,
        1.0
    );
}
