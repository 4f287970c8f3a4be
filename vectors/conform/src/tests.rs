use serde_json::{Map, Value, json};

use super::answers::Answers;
use super::columns::judge_table;
use super::text::{cut, escaped};
use super::tolerance::{Limit, compare};
use super::*;

// Verifies: VEC-004, ORA-046.
#[test]
fn a_tolerance_ends_where_it_says() {
    let one_up = 1.0_f64.next_up();
    let below = 1.0_f64.next_down();
    let least = f64::from_bits(1);
    for (tolerance, expected, found, accepted) in [
        (Tolerance::Ulp(1.0), 1.0, one_up, true),
        (Tolerance::Ulp(1.0), 1.0, one_up.next_up(), false),
        // An ulp of 1 is that above it, twice the one below.
        (Tolerance::Ulp(1.0), 1.0, below.next_down(), true),
        (Tolerance::Ulp(1.0), 1.0, 1.0 - 1.5 * f64::EPSILON, false),
        (Tolerance::Ulp(1.0), -1.0, -one_up, true),
        (Tolerance::Ulp(2.0), 0.0, 2.0 * least, true),
        (Tolerance::Ulp(2.0), 0.0, 3.0 * least, false),
        (Tolerance::Ulp(0.0), 0.0, -0.0, true),
        (Tolerance::Ulp(8.0), 1.0, f64::INFINITY, false),
        (Tolerance::Ulp(8.0), 1.0, f64::NAN, false),
        (Tolerance::Absolute(0.5), 1e300, 1e300, true),
        (Tolerance::Absolute(0.5), 1.0, 1.5, true),
        (Tolerance::Absolute(0.5), 1.0, 0.49, false),
        (Tolerance::Relative(0.5), -4.0, -6.0, true),
        (Tolerance::Relative(0.5), -4.0, -6.0_f64.next_up(), false),
        (Tolerance::Relative(0.5), -4.0, -6.1, false),
        (Tolerance::Relative(0.5), 0.0, least, false),
        (Tolerance::Exact, 0.0, -0.0, true),
        (Tolerance::Exact, 1.0, one_up, false),
    ] {
        let accepts = Limit::stated(tolerance, 1.0).accepts(expected, found);
        assert_eq!(accepts, accepted, "{tolerance:?} {expected} {found}");
    }
    assert!(Limit::stated(Tolerance::Ulp(1.0), 10.0).accepts(1.0, one_up.next_up()));
}

// Verifies: VEC-004.
#[test]
fn a_tolerance_is_of_one_kind_and_at_least_0_with_its_reason() {
    let read = |text: Value| serde_json::from_value::<Tolerance>(text);
    for kind in ["ulp", "absolute", "relative"] {
        let of = |size: f64, reason: &str| json!({kind: size, "unit": "N", "reason": reason});
        assert!(read(of(0.0, "exact")).is_ok());
        for (size, reason, words) in [
            (-0.5, "half", "-0.5 is below 0"),
            (0.5, "", "needs a reason"),
            (0.5, " \t", "needs a reason"),
        ] {
            let error = read(of(size, reason)).unwrap_err().to_string();
            assert!(error.contains(words), "{kind}: {error}");
        }
    }
    let without_unit = json!({"absolute": 1.0, "reason": "r"});
    let two = json!({"ulp": 1.0, "relative": 1.0, "reason": "r"});
    for (text, words) in [
        (without_unit, "needs a unit"),
        (two, "needs one of"),
        (json!({}), "reason"),
    ] {
        let error = read(text).unwrap_err().to_string();
        assert!(error.contains(words), "{error}");
    }
}

// Verifies: VEC-004, ORA-046.
#[test]
fn each_number_of_a_list_has_its_own_tolerance() {
    for (tolerance, allowed) in [
        (Tolerance::Ulp(2.0), 2.0 * f64::EPSILON),
        (Tolerance::Relative(1e-9), 1e-9),
    ] {
        for at in 0..3 {
            // Powers of two, whose ulp is ε times them.
            let expected = [1024.0, 1.0, 1.0 / 1024.0];
            let off_by = |factor: f64| {
                let mut found = expected;
                found[at] += factor * allowed * found[at];
                let lists = [json!([expected, expected]), json!([expected, found])];
                compare("k", &lists[0], &lists[1], Limit::stated(tolerance, 1.0))
            };
            assert_eq!(off_by(0.5), Ok(()));
            assert_eq!(off_by(2.0).unwrap_err().place, format!("k[1][{at}]"));
        }
    }
}

// Verifies: ORA-046.
#[test]
fn a_difference_names_its_place() {
    let exact = Limit::stated(Tolerance::Exact, 1.0);
    let compare = |expected, found| compare("k", &expected, &found, exact);
    let same = compare(json!([[1, 2.0], [3]]), json!([[1.0, 2], [3]]));
    assert_eq!(same, Ok(()));
    let cases = r#"
        [[1,2],[3]] [[1,2],[4]] k[1][0] is 4, but should be 3 within 0: off by 1.00e0, 2.3e15 ulp
        1 1.0000000000000004 k is 1.0000000000000004, but should be 1 within 0: off by 4.44e-16, 2.0 ulp
        1 1e300 k is 1e+300, but should be 1 within 0: off by 1.00e300
        [1,2] [1] k has 1 entries instead of 2
        [1,2] [1,"2"] k[1] is "2", but should be 2
        "0xff" "0xFF" k is "0xFF", but should be "0xff"
        true 1 k is 1, but should be true
        1 null k is null, but should be 1
    "#;
    for case in cases.trim().lines() {
        let parts: Vec<&str> = case.trim().splitn(3, ' ').collect();
        let [expected, found] =
            [parts[0], parts[1]].map(|json| serde_json::from_str(json).unwrap());
        let difference = compare(expected, found).unwrap_err();
        assert_eq!(difference.to_string(), parts[2]);
    }
}

/// A condition adds so many unit roundoffs to the tolerance, entry by entry: the largest error of a product of
/// two numbers of f32 is 2⁻²⁴ of it.
// Verifies: ORA-046, VEC-016.
#[test]
fn a_condition_adds_roundoffs_to_the_tolerance() {
    let condition: Condition = serde_json::from_value(json!([[1.0, 3.0], 2.0])).unwrap();
    let expected = json!([[1.0, 1.0], [1.0, 1.0]]);
    assert!(condition.fits(&expected) && !condition.fits(&json!([[1.0], 1.0])));
    assert!(!Condition::All(f64::NAN).fits(&json!(1.0)) && !Condition::All(-1.0).fits(&json!(1.0)));
    let u = 2.0_f64.powi(-24);
    let limit = Limit {
        condition: &condition,
        unit_roundoff: u,
        ..Limit::stated(Tolerance::Absolute(0.5), 1.0)
    };
    for (row, column, most) in [(0, 0, 1.0), (0, 1, 3.0), (1, 0, 2.0), (1, 1, 2.0)] {
        let with = |off: f64| {
            let mut found = expected.clone();
            found[row][column] = json!(1.5 + off * u);
            compare("k", &expected, &found, limit)
        };
        assert_eq!(with(most), Ok(()), "{row} {column}");
        let beyond = with(most + 0.5).unwrap_err().text;
        assert!(beyond.contains(" within 5.00e-1: "), "{beyond}");
    }
}

/// Groups with these cases, each case with these flags unless it has its own; ids and bits, of single numbers, are added.
fn suite(groups: &[(&str, &[Value])], flags: &[&str]) -> Suite {
    let file = |&(name, cases): &(&str, &[Value])| {
        let cases = cases.iter().enumerate().map(|(number, case)| {
            let mut full =
                json!({"id": format!("{name}-{number}"), "comment": "", "args": {}, "flags": flags});
            if let Some(ok) = case["ok"].as_object() {
                let bits = |value: f64| format!("{:#018x}", value.to_bits());
                let numbers = ok.iter().filter_map(|(key, value)| Some((key, value.as_f64()?)));
                full["bits"] = numbers.map(|(key, value)| (key.clone(), bits(value))).collect();
            }
            let case = case.as_object().unwrap().clone();
            full.as_object_mut().unwrap().extend(case);
            full
        });
        let tolerance = json!({"absolute": 0, "unit": "1", "reason": "exact"});
        let bug = |flag: &&str| {
            let bug = json!({"bug": format!("{flag} of {name}"), "notes": ""});
            (flag.to_string(), bug)
        };
        let file = json!({
            "schema": "palpate-vectors", "schema_version": 1, "group": name, "op": "roc",
            "source": "by hand", "generator_version": "1", "cases": cases.collect::<Value>(),
            "tolerance": {"a": tolerance, "b": tolerance, "c": tolerance},
            "flags": flags.iter().map(bug).collect::<Value>(),
        });
        (format!("{name}.json"), file.to_string())
    };
    Suite::of_files(groups.iter().map(file).collect()).unwrap()
}

/// Two groups of three questions that must be refused.
fn two_groups() -> Suite {
    let refusals = vec![json!({"error": "out_of_range"}); 3];
    suite(&[("a", &refusals), ("b", &refusals)], &["sign", "unit"])
}

/// For these groups, an outcome of each kind.
fn one_of_each() -> Vec<Outcome> {
    let wrong = |class| Outcome::wrong(class, "");
    vec![
        Outcome::Acceptable("loose".into()),
        wrong(Class::Protocol),
        wrong(Class::Range),
        wrong(Class::Mathematics),
        Outcome::Right,
        Outcome::Skipped(String::new()),
    ]
}

fn verdict(suite: &Suite, measure: &Measure, outcomes: Vec<Outcome>) -> Verdict {
    Verdict::new(suite, measure, Program::default(), outcomes, vec![], 0)
}

/// An answer with the keys a, b, c.
fn answer(values: &[f64]) -> Value {
    let values = values.iter().map(|value| json!(value));
    let keys = ["a", "b", "c"].map(String::from).into_iter();
    Value::Object(keys.zip(values).collect::<Map<_, _>>())
}

/// The right answer of the cases for [`answered`].
const RIGHT: [f64; 3] = [1.0, 2.0, 3.0];

/// The verdict on these answers to as many equal cases, which show these bugs.
fn answered(bugs: &[(&str, [f64; 3])], answers: &[[f64; 3]]) -> Verdict {
    let wrong = bugs
        .iter()
        .map(|(flag, values)| json!({"flag": flag, "ok": answer(values)}));
    let case = json!({"ok": answer(&RIGHT), "wrong": wrong.collect::<Value>()});
    let flags: Vec<&str> = bugs.iter().map(|(flag, _)| *flag).collect();
    let suite = suite(&[("a", &vec![case; answers.len()])], &flags);
    let cases = suite.groups[0].cases.iter().zip(answers);
    let outcomes = cases
        .map(|(case, found)| judge(case, &json!({"ok": answer(found)}), &Profile::exact()))
        .collect();
    verdict(&suite, &Measure::exact(), outcomes)
}

/// The bugs that the verdict names, with what it says of them.
fn named(bugs: &[(&str, [f64; 3])], answers: &[[f64; 3]]) -> Vec<String> {
    let found = &answered(bugs, answers).diagnosis[0];
    let of = |one: &Explanation| {
        let flags: Vec<&str> = one.bugs.iter().map(|bug| &bug.flag[..]).collect();
        let (flags, share) = (flags.join("+"), format!("{}/{}", one.explains, found.wrong));
        format!(
            "{flags} {share} against {} from {}",
            one.against, one.first_case
        )
    };
    found.explanations.iter().map(of).collect()
}

const SIGN: [f64; 3] = [-1.0, -2.0, 3.0];

// Verifies: ORA-047.
#[test]
fn bugs_are_named_that_explain_half_of_a_group_and_pairs_that_explain_more() {
    let (unit, both, odd) = ([1000.0, 2.0, 3.0], [1000.0, -2.0, 3.0], [7.0; 3]);
    let named = |answers: &[_]| named(&[("sign", SIGN), ("unit", unit)], answers).join("; ");
    let of_right = named(&[RIGHT, SIGN, SIGN, odd]);
    assert_eq!(of_right, "sign 2/3 against 1 from a-1");
    // Less than half is no name.
    assert_eq!(named(&[SIGN, odd, odd]), "");
    // What explains most comes first; a pair, only if it explains more than each alone.
    let pair = "sign+unit 3/3 against 0 from a-0; sign 2/3 against 0 from a-0";
    assert_eq!(named(&[SIGN, unit, SIGN]), pair);
    assert_eq!(named(&[SIGN, SIGN]), "sign 2/2 against 0 from a-0");
    // One key by one bug, one by the other; a key that is right by neither explains nothing alone.
    assert_eq!(named(&[both, both]), "sign+unit 2/2 against 0 from a-0");
    assert_eq!(named(&[[1.0, -2.0, 3.0]]), "");
}

// Verifies: ORA-047.
#[test]
fn of_pairs_of_bugs_the_one_that_explains_most_is_named() {
    let bugs = [
        // One bug of a and two of b; c is right with each of them.
        ("f", [-1.0, 2.0, 3.0]),
        ("g", [1.0, -2.0, 3.0]),
        ("h", [1.0, 20.0, 3.0]),
        // Two that are right in b, and wrong elsewhere.
        ("i", [-5.0, 2.0, 9.0]),
        ("j", [8.0, 2.0, 7.0]),
    ];
    let named = |answers: &[_]| named(&bugs, answers).join("; ");
    let (with_g, with_h) = ([-1.0, -2.0, 3.0], [-1.0, 20.0, 3.0]);
    assert_eq!(
        named(&[with_g, with_h, with_h]),
        "f+h 2/3 against 0 from a-1"
    );
    assert_eq!(
        named(&[with_h, with_g, with_g]),
        "f+g 2/3 against 0 from a-1"
    );
    // Of equals the first.
    assert_eq!(named(&[with_h, with_g]), "f+g 1/2 against 0 from a-1");
    // Only a is wrong, as i has it: no other bug has anything to explain.
    assert_eq!(named(&[[-5.0, 2.0, 3.0]]), "");
}

// Verifies: ORA-047.
#[test]
fn classes_are_diagnosed_apart() {
    let suite = two_groups();
    let answered = judge(
        &suite.groups[0].cases[0],
        &json!({"ok": {}}),
        &Profile::exact(),
    );
    let lost = Outcome::wrong(Class::Protocol, "no answer");
    let outcomes = [vec![answered, lost.clone(), lost], vec![Outcome::Right; 3]].concat();
    let found = verdict(&suite, &Measure::exact(), outcomes).diagnosis;
    let told = |one: &Diagnosis| (one.class, one.wrong, one.explanations.len());
    let told: Vec<_> = found.iter().map(told).collect();
    assert_eq!(told, [(Class::Range, 1, 2), (Class::Protocol, 2, 0)]);
}

/// Normal numbers of f32 are from 2⁻¹²⁶ to 2¹²⁸, whose roots are 2⁻⁶³ and 2⁶⁴.
// Verifies: ORA-067, VEC-018.
#[test]
fn extreme_cases_are_those_beyond_the_precision() {
    let power = |exponent| 2.0_f64.powi(exponent);
    let refusal = |args: Value| json!({"error": "out_of_range", "args": args});
    let coarse = |exponent| json!({"error": "out_of_range", "args": {"x": 1, "name": "text"}, "roundoff": power(exponent)});
    let cases = [
        (refusal(json!({"x": power(-63)})), false),
        (refusal(json!({"x": [[1.0, 0.0], [power(-64), 1]]})), true),
        (refusal(json!({"x": power(63)})), false),
        (refusal(json!({"x": -power(65)})), true),
        (coarse(-24), false),
        (coarse(-25), true),
        (json!({"ok": {"a": 1e-37}}), false),
        (json!({"ok": {"a": 1e-38}}), true),
    ];
    let suite = suite(&[("a", &cases.clone().map(|(case, _)| case))], &[]);
    let [single, exact] = ["f32", "exact"].map(|name| Profile::named(name).unwrap());
    for (case, (text, extreme)) in suite.groups[0].cases.iter().zip(&cases) {
        assert_eq!(single.is_extreme(case), *extreme, "{text}");
        assert!(!exact.is_extreme(case));
    }
    // Wrong in mathematics and range, they do not count; in protocol they do.
    for (class, extreme, failed) in [
        (Class::Mathematics, false, 4),
        (Class::Range, false, 4),
        (Class::Protocol, false, 8),
        (Class::Mathematics, true, 8),
    ] {
        let mut measure = Measure::exact();
        (measure.profile, measure.extreme) = (single.clone(), extreme);
        let verdict = verdict(&suite, &measure, vec![Outcome::wrong(class, ""); 8]);
        assert_eq!(verdict.totals.failed, failed, "{class:?} {extreme}");
    }
}

// Verifies: ORA-067.
#[test]
fn what_is_required_decides_what_fails() {
    for (require, failed) in [
        (Require::Right, 4),
        (Require::Acceptable, 3),
        (Require::Range, 2),
        (Require::Mathematics, 1),
    ] {
        let mut measure = Measure::exact();
        measure.require = require;
        let failure = verdict(&two_groups(), &measure, one_of_each()).failure;
        assert_eq!(failure.unwrap(), format!("{failed} of 5 cases failed"));
    }
}

/// No answer, and a refusal of everything, show nothing about mathematics.
// Verifies: ORA-067.
#[test]
fn a_program_without_a_value_that_was_judged_fails_whatever_is_required() {
    let suite = suite(&[("a", &vec![json!({"ok": {"a": 1.0}}); 2])], &[]);
    let lost = Outcome::wrong(Class::Protocol, "no answer");
    let refused = Outcome::wrong(Class::Range, "refused");
    let mut measure = Measure::exact();
    measure.require = Require::Mathematics;
    for (outcomes, passed) in [
        ([&lost, &lost], false),
        ([&Outcome::Right, &lost], false),
        ([&refused, &refused], false),
        ([&Outcome::Right, &refused], true),
    ] {
        let found = verdict(&suite, &measure, outcomes.map(Outcome::clone).to_vec());
        assert_eq!(found.passed, passed, "{outcomes:?}");
    }
}

/// Every value of the group is extreme in the profile: a wrong one does not count, and shows nothing either.
// Verifies: ORA-078, ORA-048.
#[test]
fn a_group_fails_of_which_no_value_is_right() {
    let value = json!({"ok": {"a": 1e-38}});
    let refusal = json!({"error": "out_of_range"});
    let suite = suite(&[("a", &[value.clone(), value, refusal])], &[]);
    let mut measure = Measure::exact();
    measure.profile = Profile::named("f32").unwrap();
    let [near, refused] = [Class::Mathematics, Class::Range].map(|of| Outcome::wrong(of, ""));
    let loose = Outcome::Acceptable(String::new());
    let left_out = Outcome::Skipped(String::new());
    let right = Outcome::Right;
    let words = "no value is right, so that nothing is shown of a";
    for (require, known, values, failure) in [
        (Require::Right, None, [&refused, &refused], Some(words)),
        (Require::Right, None, [&near, &refused], Some(words)),
        (Require::Mathematics, None, [&near, &refused], Some(words)),
        (Require::Right, Some("a-0"), [&near, &refused], Some(words)),
        (Require::Right, None, [&left_out, &refused], Some(words)),
        (Require::Right, None, [&left_out, &left_out], Some(words)),
        (Require::Right, None, [&right, &refused], None),
        (Require::Right, None, [&right, &right], None),
        (Require::Acceptable, None, [&loose, &near], None),
        (Require::Right, Some("a-1"), [&right, &near], None),
    ] {
        measure.require = require;
        let reason = |case: &str| (case.to_string(), "known".to_string());
        measure.accepted = known.map(reason).into_iter().collect();
        let outcomes = [values[0].clone(), values[1].clone(), Outcome::Right];
        let found = verdict(&suite, &measure, outcomes.to_vec());
        assert_eq!(found.failure.as_deref(), failure, "{require:?} {values:?}");
        assert_eq!(found.passed, failure.is_none());
        // Who reads the XML alone is told too.
        let xml = junit(&found, &suite);
        let failures = xml.matches("<failure").count();
        assert_eq!(failures, failure.iter().count(), "{xml}");
        assert!(xml.contains(failure.unwrap_or_default()), "{xml}");
    }
    // Extreme and accepted answers are not as they should be.
    measure.accepted = [("a-0".into(), "known".into())].into();
    let text = table(&verdict(&suite, &measure, vec![near, refused, right]));
    let last = "\n1 of 3 cases as they should be, 1 accepted, 1 extreme, 0 skipped; profile f32 (unit roundoff 5.96e-8); ";
    assert!(text.contains(last), "{text}");
    // Of an op that is not claimed or not asked there is nothing to show.
    let unclaimed = vec![Outcome::Unclaimed("roc".into()); 3];
    for outcomes in [unclaimed, vec![left_out; 3]] {
        let failure = verdict(&suite, &measure, outcomes).failure.unwrap();
        assert!(failure.starts_with("nothing checked"), "{failure}");
    }
}

// Verifies: ORA-040, ORA-049.
#[test]
fn what_is_chosen_by_name_must_be_asked() {
    let mut measure = Measure::exact();
    let of = |measure: &Measure, second: Outcome| {
        let outcomes = [vec![Outcome::Right; 3], vec![second; 3]].concat();
        verdict(&two_groups(), measure, outcomes).failure
    };
    let [unclaimed, left_out] = [Outcome::Unclaimed, Outcome::Skipped].map(|of| of("roc".into()));
    assert_eq!(of(&measure, unclaimed.clone()), None);
    measure.named = true;
    assert!(
        of(&measure, unclaimed.clone())
            .unwrap()
            .starts_with("roc not checked")
    );
    assert_eq!(of(&measure, left_out.clone()), None);
    // A case of the group that is left out besides changes nothing.
    let outcomes = [
        vec![Outcome::Right; 3],
        vec![left_out, unclaimed.clone(), unclaimed],
    ]
    .concat();
    let failure = verdict(&two_groups(), &measure, outcomes).failure;
    assert!(failure.unwrap().starts_with("roc not checked"));
}

// Verifies: ORA-047.
#[test]
fn each_answer_of_a_bug_is_wrong_and_names_it() {
    let suite = Suite::embedded().unwrap();
    let cases = suite.groups.iter().flat_map(|group| &group.cases);
    let mut bugs = 0;
    for (case, bug) in cases.flat_map(|case| case.wrong.iter().map(move |bug| (case, bug))) {
        let found = judge(case, &json!({"ok": bug.values}), &Profile::exact());
        let Outcome::Wrong(wrong) = found else {
            panic!("{} {}: {found:?}", case.id, bug.flag)
        };
        assert!(
            wrong.traces.are_of(&[&bug.flag]),
            "{} {}",
            case.id,
            bug.flag
        );
        bugs += 1;
    }
    assert!(bugs > 1000, "{bugs}");
}

// Verifies: ORA-064, ORA-075.
#[test]
fn a_table_that_does_not_count_from_0_or_says_two_things_is_wrong() {
    let bits = ["0x3ff0000000000000", "0x4000000000000000"];
    let suite = suite(
        &[(
            "a",
            &[json!({"ok": {"a": [1.0, 2.0]}, "bits": {"a": bits}})],
        )],
        &[],
    );
    let judged = |rows: &[&str]| {
        let profile = Profile::exact();
        let mut answers = Answers::new(&suite, &[], &profile, true);
        let rows: Vec<String> = rows.iter().map(|row| format!("a-0,{row}")).collect();
        judge_table(&mut answers, &rows.join("\n")).unwrap();
        let (outcomes, notes) = answers.outcomes("");
        let class = match &outcomes[0] {
            Outcome::Wrong(wrong) => wrong.class.name(),
            _ => "right",
        };
        (class, notes.len())
    };
    for (rows, class) in [
        (&["a,0,,1", "a,1,,2"][..], "right"),
        (&["a,1,,2", "a,0,,1"], "right"),
        (&["a,1,,1", "a,2,,2"], "protocol"),
        (&["a,0,,1", "a,2,,2"], "protocol"),
        (&["a,,,1", "a,0,,1", "a,1,,2"], "protocol"),
        (&["a,0,,1", "a,1,,2", "error,,,x"], "protocol"),
        // A list in a list: of one entry instead of two.
        (&["a,0,0,1", "a,0,1,2"], "mathematics"),
    ] {
        assert_eq!(judged(rows), (class, 0), "{rows:?}");
    }
    // Of two rows for one place the first counts, and a note tells it.
    assert_eq!(judged(&["a,0,,1", "a,1,,2", "a,1,,3"]), ("right", 1));
    assert_eq!(judged(&["a,0,,1", "a,1,,3", "a,1,,2"]), ("mathematics", 1));
}

// Verifies: ORA-048, ORA-050.
#[test]
fn the_table_has_a_column_for_each_kind_of_answer_that_came() {
    let suite = two_groups();
    let mut verdict = verdict(&suite, &Measure::exact(), one_of_each());
    verdict.program.version = "7".into();
    let expected = "\
group  cases  right  acceptable  mathematics  range  protocol  skipped
a          3      0           1            0      1         1        0
b          3      1           0            1      0         0        1
";
    let text = table(&verdict);
    assert!(text.starts_with(expected), "{text}");
    let last = format!(
        "\nversion 7: 1 of 5 cases as they should be, 1 skipped; profile exact; vectors {}\n",
        suite.sha256
    );
    assert!(text.ends_with(&last), "{text}");
    let text = table(&answered(&[("sign", SIGN)], &[SIGN, SIGN]));
    let bug = "\nlikely bugs\n  a, mathematics: sign, sign of a; explains 2 of 2, first a-0\n";
    assert!(text.contains(bug), "{text}");
}

// Verifies: ORA-058, VEC-006.
#[test]
fn a_wrong_answer_has_a_class() {
    let cases = [
        json!({"ok": {"a": 1.0, "b": 2.0}}),
        json!({"error": "out_of_range"}),
        json!({"error": "bad_argument", "lenient": {"a": 1.0}}),
        json!({"error": "bad_argument"}),
        json!({"error": "overflow"}),
    ];
    let suite = suite(&[("a", &cases)], &[]);
    for (case, answer, kind) in [
        (0, json!({"ok": {"a": 1, "b": 2, "more": 3}}), "right"),
        (0, json!({"ok": {"a": 1, "b": 3}}), "mathematics"),
        (0, json!({"ok": {"a": 1}}), "protocol"),
        (0, json!({"ok": {"a": "1", "b": 2}}), "protocol"),
        (0, json!({"ok": {"a": null, "b": 2}}), "range"),
        (0, json!({"ok": {"a": null, "b": 3}}), "mathematics"),
        (0, json!({"ok": 1}), "protocol"),
        (0, json!({"error": {"code": "x"}}), "range"),
        (0, json!({"error": null}), "protocol"),
        (0, json!({}), "protocol"),
        (1, json!({"error": {"code": "x"}}), "right"),
        (1, json!({"error": "x"}), "acceptable"),
        (1, json!({"error": {}}), "acceptable"),
        (1, json!({"error": {"code": null}}), "acceptable"),
        (1, json!({"error": 1}), "protocol"),
        (1, json!({"error": null}), "protocol"),
        (1, json!({"error": false}), "protocol"),
        (1, json!({"error": []}), "protocol"),
        (1, json!({"ok": {"a": 1}}), "range"),
        (2, json!({"ok": {"a": 1}}), "acceptable"),
        (2, json!({"ok": {"a": 1.1}}), "protocol"),
        (3, json!({"ok": {}}), "protocol"),
        (4, json!({"ok": {}}), "range"),
    ] {
        let found = match judge(&suite.groups[0].cases[case], &answer, &Profile::exact()) {
            Outcome::Right => "right",
            Outcome::Acceptable(_) => "acceptable",
            Outcome::Wrong(wrong) => wrong.class.name(),
            Outcome::Skipped(_) | Outcome::Unclaimed(_) => "skipped",
        };
        assert_eq!(found, kind, "{case} {answer}");
    }
}

// Verifies: ORA-050.
#[test]
fn the_xml_counts_the_cases_that_it_holds() {
    let mut suite = two_groups();
    suite.groups[1].cases[0].comment = "less < more".into();
    let mut outcomes = one_of_each();
    // Skipped, right, acceptable; range, protocol, mathematics, which is accepted.
    outcomes.reverse();
    outcomes.swap(2, 5);
    let measure = Measure {
        require: Require::Acceptable,
        accepted: [("b-2".into(), "known <&>".into())].into(),
        ..Measure::exact()
    };
    let xml = junit(&verdict(&suite, &measure, outcomes), &suite);
    for escaped in ["accepted, known &lt;&amp;&gt;", "less &lt; more"] {
        assert!(xml.contains(escaped), "{xml}");
    }
    let (_, whole) = xml.split_once('\n').unwrap();
    let parts: Vec<&str> = xml.split("<testsuite").collect();
    let &[_, _, a, b] = &parts[..] else {
        panic!("{xml}");
    };
    assert_eq!(b.matches("<failure").count(), 2);
    for part in [whole, a, b] {
        let tag = part.lines().next().unwrap();
        for (key, element) in [
            ("tests", "testcase"),
            ("failures", "failure"),
            ("skipped", "skipped"),
        ] {
            let count = part.matches(&format!("<{element}")).count();
            assert!(
                tag.contains(&format!(" {key}=\"{count}\"")),
                "{key}: {part}"
            );
        }
    }
}

// Verifies: ORA-050.
#[test]
fn no_text_breaks_the_xml() {
    assert_eq!(
        escaped("a<b>&\"'\t\u{0}\u{b}\u{ffff}γ"),
        "a&lt;b&gt;&amp;&quot;' \u{fffd}\u{fffd}\u{fffd}γ"
    );
}

// Verifies: ORA-043.
#[test]
fn what_a_program_says_is_quoted_short_and_plain() {
    assert_eq!(cut("a\u{1b}[2J\r\nγ"), "a\u{fffd}[2J\u{fffd}\u{fffd}γ");
    assert_eq!(cut(&"é".repeat(200)), "é".repeat(200));
    assert_eq!(cut(&"é".repeat(201)), "é".repeat(200) + "…");
}

// Verifies: ORA-057, ORA-064.
#[test]
fn requests_have_one_form_and_bounded_lines() {
    let suite = Suite::embedded().unwrap();
    for (case, line) in suite.requests() {
        let is_bounded = line.len() <= 65_536 && line.matches('\n').count() == 1;
        assert!(is_bounded, "{}", case.id);
        if matches!(case.question, Question::Arguments(_)) {
            let value: Value = serde_json::from_str(&line).unwrap();
            // A map of serde_json is sorted, and written without spaces.
            assert_eq!(value.to_string() + "\n", line);
        }
    }
    let case = vec!["theta_colored-004".into()];
    let choice = Choice {
        case,
        ..Choice::default()
    };
    let table = questions(&suite.select(&choice).unwrap(), Form::Csv);
    for (place, is_there) in [
        ("covariance,0,1", true),
        ("residual,0,", true),
        ("residual,,", false),
    ] {
        let start = format!("\ntheta_colored-004,theta_colored,{place},");
        assert_eq!(table.contains(&start), is_there, "{place}: {table}");
    }
}

// Verifies: ORA-064.
#[test]
fn a_table_leaves_out_what_needs_quotes() {
    let values = json!(["a_1", 1.5, "a,b", "a b", "\"", [["a", 2]], [["a b"]], null]);
    let case = |value: &Value| json!({"error": "out_of_range", "args": {"x": value}});
    let cases: Vec<Value> = values.as_array().unwrap().iter().map(case).collect();
    let table = questions(&suite(&[("a", &cases)], &[]), Form::Csv);
    let rows: Vec<&str> = table.lines().skip(1).collect();
    let right = "a-0,roc,x,,,a_1 a-1,roc,x,,,1.5 a-5,roc,x,0,0,a a-5,roc,x,0,1,2";
    assert_eq!(rows.join(" "), right);
}
