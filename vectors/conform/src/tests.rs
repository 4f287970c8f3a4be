use serde_json::{Value, json};

use super::text::{cut, escaped};
use super::tolerance::{Condition, Limit, Tolerance, compare};
use super::{Choice, Class, Form, Measure, Outcome, Profile, Program, Require, Suite, Verdict};
use super::{judge, junit, questions, table};

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

// Verifies: ORA-046.
#[test]
fn a_difference_names_its_place() {
    let exact = Limit::stated(Tolerance::Exact, 1.0);
    let compare = |expected, found| compare("k", &expected, &found, exact);
    let same = compare(json!([[1, 2.0], [3]]), json!([[1.0, 2], [3]]));
    assert_eq!(same, Ok(()));
    let cases = r#"
        [[1,2],[3]] [[1,2],[4]] k[1][0] is 4, expected 3 within 0: off by 1.00e0, 2.3e15 ulp
        1 1.0000000000000004 k is 1.0000000000000004, expected 1 within 0: off by 4.44e-16, 2.0 ulp
        1 1e300 k is 1e+300, expected 1 within 0: off by 1.00e300
        [1,2] [1] k has 1 entries, expected 2
        [1,2] [1,"2"] k[1] is "2", expected 2
        "0xff" "0xFF" k is "0xFF", expected "0xff"
        true 1 k is 1, expected true
        1 null k is null, expected 1
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

/// A file of one group with these cases, each with the two flags; ids are added.
fn group(name: &str, cases: Vec<Value>) -> (String, String) {
    let bug = |what: &str| json!({"bug": format!("{what} of {name}"), "notes": ""});
    let case = |(number, mut case): (usize, Value)| {
        case["id"] = json!(format!("{name}-{number}"));
        case["comment"] = json!("");
        if case.get("flags").is_none() {
            case["flags"] = json!(["sign", "unit"]);
        }
        if case.get("line").is_none() && case.get("args").is_none() {
            case["args"] = json!({});
        }
        case
    };
    let cases: Vec<Value> = cases.into_iter().enumerate().map(case).collect();
    let tolerance = json!({"absolute": 0, "unit": "1", "reason": "exact"});
    let file = json!({
        "schema": "palpate-vectors", "schema_version": 1, "group": name, "op": "roc",
        "source": "by hand", "generator_version": "1", "tolerance": {"a": tolerance, "b": tolerance},
        "flags": {"sign": bug("sign"), "unit": bug("unit")}, "cases": cases,
    });
    (format!("{name}.json"), file.to_string())
}

/// A question that must be refused.
fn refusal() -> Value {
    json!({"error": "out_of_range"})
}

/// Two groups of three questions that must be refused.
fn two_groups() -> Suite {
    let groups = ["a", "b"].map(|name| group(name, vec![refusal(), refusal(), refusal()]));
    Suite::of_files(groups.into()).unwrap()
}

/// For these groups, an outcome of each kind.
fn one_of_each() -> Vec<Vec<Outcome>> {
    let wrong = |class| Outcome::wrong(class, "");
    vec![
        vec![
            Outcome::Acceptable("loose".into()),
            wrong(Class::Protocol),
            wrong(Class::Range),
        ],
        vec![
            wrong(Class::Mathematics),
            Outcome::Right,
            Outcome::Skipped(String::new()),
        ],
    ]
}

fn measure(profile: &str) -> Measure {
    let profile = Profile::named(profile).unwrap();
    Measure {
        profile,
        ..Measure::exact()
    }
}

fn verdict(suite: &Suite, outcomes: Vec<Vec<Outcome>>) -> Verdict {
    Verdict::new(
        suite,
        &measure("exact"),
        Program::default(),
        outcomes,
        vec![],
    )
}

/// Cases with the answer a = 1, b = 2: the first bug makes both negative, the second one takes thousands.
fn signs_and_units(cases: usize) -> Suite {
    let bits = json!({"a": "0x3ff0000000000000", "b": "0x4000000000000000"});
    let wrong = json!([{"flag": "sign", "ok": {"a": -1.0, "b": -2.0}}, {"flag": "unit", "ok": {"a": 1000.0, "b": 2.0}}]);
    let case = json!({"ok": {"a": 1.0, "b": 2.0}, "bits": bits, "wrong": wrong});
    Suite::of_files([group("a", vec![case; cases])].into()).unwrap()
}

/// The verdict on these answers for a and b.
fn answered(answers: &[(f64, f64)]) -> Verdict {
    let suite = signs_and_units(answers.len());
    let cases = suite.groups[0].cases.iter().zip(answers);
    let outcome = |(case, (a, b)): (_, &(f64, f64))| {
        judge(case, &json!({"ok": {"a": a, "b": b}}), &Profile::exact())
    };
    verdict(&suite, vec![cases.map(outcome).collect()])
}

// Verifies: ORA-047.
#[test]
fn bugs_are_named_that_explain_half_of_a_group_and_pairs_that_explain_more() {
    let (right, sign, unit, odd) = ((1.0, 2.0), (-1.0, -2.0), (1000.0, 2.0), (7.0, 7.0));
    let told = |answers: &[(f64, f64)]| {
        let verdict = answered(answers);
        let of = |one: &super::Explanation| {
            let flags: Vec<&str> = one.bugs.iter().map(|bug| &bug.flag[..]).collect();
            format!(
                "{} {}/{} against {} from {}",
                flags.join("+"),
                one.explains,
                verdict.diagnosis[0].wrong,
                one.against,
                one.first_case
            )
        };
        let found: Vec<String> = verdict.diagnosis[0].explanations.iter().map(of).collect();
        found
    };
    assert_eq!(
        told(&[right, sign, sign, odd]),
        ["sign 2/3 against 1 from a-1"]
    );
    // Less than half is no name.
    assert_eq!(told(&[sign, odd, odd]), Vec::<String>::new());
    // What explains most comes first; a pair, only if it explains more than each alone.
    assert_eq!(
        told(&[sign, unit, sign]),
        [
            "sign+unit 3/3 against 0 from a-0",
            "sign 2/3 against 0 from a-0"
        ]
    );
    assert_eq!(told(&[sign, sign]), ["sign 2/2 against 0 from a-0"]);
    // One key by one bug, one by the other; a key that is right by neither explains nothing alone.
    assert_eq!(
        told(&[(1000.0, -2.0), (1000.0, -2.0)]),
        ["sign+unit 2/2 against 0 from a-0"]
    );
    assert_eq!(told(&[(1.0, -2.0)]), Vec::<String>::new());
}

// Verifies: ORA-047.
#[test]
fn of_pairs_of_bugs_the_one_that_explains_most_is_named() {
    let ok = |[a, b, c]: [f64; 3]| json!({"a": a, "b": b, "c": c});
    // One bug of a and two of b; c is right with each of them.
    let bugs = json!({
        "f": ok([-1.0, 2.0, 3.0]), "g": ok([1.0, -2.0, 3.0]), "h": ok([1.0, 20.0, 3.0]),
        // Two that are right in b, and wrong elsewhere.
        "i": ok([-5.0, 2.0, 9.0]), "j": ok([8.0, 2.0, 7.0]),
    });
    let wrong = bugs.as_object().unwrap().iter();
    let wrong: Vec<Value> = wrong
        .map(|(flag, ok)| json!({"flag": flag, "ok": ok}))
        .collect();
    let bits =
        json!({"a": "0x3ff0000000000000", "b": "0x4000000000000000", "c": "0x4008000000000000"});
    let flags = ["f", "g", "h", "i", "j"];
    let case = json!({"ok": ok([1.0, 2.0, 3.0]), "bits": bits, "wrong": wrong, "flags": flags});
    let told = |answers: &[[f64; 3]]| {
        let (name, text) = group("a", vec![case.clone(); answers.len()]);
        let mut file: Value = serde_json::from_str(&text).unwrap();
        file["flags"] = flags
            .map(|flag| (flag, json!({"bug": flag, "notes": ""})))
            .into_iter()
            .collect();
        file["tolerance"]["c"] = file["tolerance"]["a"].clone();
        let suite = Suite::of_files([(name, file.to_string())].into()).unwrap();
        let cases = suite.groups[0].cases.iter().zip(answers);
        let judged =
            cases.map(|(case, &found)| judge(case, &json!({"ok": ok(found)}), &Profile::exact()));
        let verdict = verdict(&suite, vec![judged.collect()]);
        let of = |one: &super::Explanation| {
            let flags: Vec<&str> = one.bugs.iter().map(|bug| &bug.flag[..]).collect();
            format!("{} {}", flags.join("+"), one.explains)
        };
        let found: Vec<String> = verdict.diagnosis[0].explanations.iter().map(of).collect();
        found
    };
    let (with_g, with_h) = ([-1.0, -2.0, 3.0], [-1.0, 20.0, 3.0]);
    assert_eq!(told(&[with_g, with_h, with_h]), ["f+h 2"]);
    assert_eq!(told(&[with_h, with_g, with_g]), ["f+g 2"]);
    // Of equals the first.
    assert_eq!(told(&[with_h, with_g]), ["f+g 1"]);
    // Only a is wrong, as i has it: no other bug has anything to explain.
    assert_eq!(told(&[[-5.0, 2.0, 3.0]]), Vec::<String>::new());
}

// Verifies: ORA-047.
#[test]
fn classes_are_diagnosed_apart() {
    let suite = two_groups();
    let answered = |case| judge(case, &json!({"ok": {}}), &Profile::exact());
    let cases = &suite.groups[0].cases;
    let lost = Outcome::wrong(Class::Protocol, "no answer");
    let outcomes = vec![
        vec![answered(&cases[0]), lost.clone(), lost],
        vec![Outcome::Right; 3],
    ];
    let verdict = verdict(&suite, outcomes);
    let told = verdict
        .diagnosis
        .iter()
        .map(|one| (one.class, one.wrong, one.explanations.len()));
    assert_eq!(
        told.collect::<Vec<_>>(),
        [(Class::Range, 1, 2), (Class::Protocol, 2, 0)]
    );
}

/// Normal numbers of f32 are from 2⁻¹²⁶ to 2¹²⁸, whose roots are 2⁻⁶³ and 2⁶⁴.
// Verifies: ORA-067, VEC-018.
#[test]
fn extreme_cases_are_those_beyond_the_precision() {
    let power = |exponent| 2.0_f64.powi(exponent);
    let cases = [
        (json!({"args": {"x": power(-63)}}), false),
        (json!({"args": {"x": [[1.0, 0.0], [power(-64), 1]]}}), true),
        (json!({"args": {"x": power(63)}}), false),
        (json!({"args": {"x": -power(65)}}), true),
        (
            json!({"args": {"x": 1, "name": "text"}, "roundoff": power(-24)}),
            false,
        ),
        (json!({"args": {"x": 1}, "roundoff": power(-25)}), true),
        (
            json!({"ok": {"a": 1e-37}, "bits": {"a": format!("{:#018x}", 1e-37_f64.to_bits())}}),
            false,
        ),
        (
            json!({"ok": {"a": 1e-38}, "bits": {"a": format!("{:#018x}", 1e-38_f64.to_bits())}}),
            true,
        ),
    ];
    let texts = cases.iter().map(|(case, _)| {
        let mut case = case.clone();
        if case.get("ok").is_none() {
            case["error"] = json!("out_of_range");
        }
        case
    });
    let suite = Suite::of_files([group("a", texts.collect())].into()).unwrap();
    let [single, exact] = ["f32", "exact"].map(|name| Profile::named(name).unwrap());
    for (case, (text, extreme)) in suite.groups[0].cases.iter().zip(&cases) {
        assert_eq!(single.is_extreme(case), *extreme, "{text}");
        assert!(!exact.is_extreme(case));
    }
    // Wrong in mathematics and range, they do not count; in protocol they do.
    let lost = Outcome::wrong(Class::Protocol, "");
    let wrong = |class| vec![Outcome::wrong(class, ""); 8];
    let failed = |measure: &Measure, outcomes: Vec<Outcome>| {
        Verdict::new(&suite, measure, Program::default(), vec![outcomes], vec![]).failed()
    };
    let mut measure = measure("f32");
    assert_eq!(failed(&measure, wrong(Class::Mathematics)), 4);
    assert_eq!(failed(&measure, wrong(Class::Range)), 4);
    assert_eq!(failed(&measure, vec![lost; 8]), 8);
    measure.extreme = true;
    assert_eq!(failed(&measure, wrong(Class::Mathematics)), 8);
}

// Verifies: ORA-067.
#[test]
fn what_is_required_decides_what_fails() {
    let suite = two_groups();
    for (require, failed) in [
        (Require::Right, 4),
        (Require::Acceptable, 3),
        (Require::Range, 2),
        (Require::Mathematics, 1),
    ] {
        let measure = Measure {
            require,
            ..measure("exact")
        };
        let verdict = Verdict::new(&suite, &measure, Program::default(), one_of_each(), vec![]);
        assert_eq!(verdict.failed(), failed, "{require:?}");
        assert!(
            verdict
                .failure()
                .unwrap()
                .starts_with(&format!("{failed} of 5 cases failed"))
        );
    }
}

// Verifies: ORA-048, ORA-050.
#[test]
fn the_table_has_a_column_for_each_kind_of_answer_that_came() {
    let suite = two_groups();
    let mut verdict = verdict(&suite, one_of_each());
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
    let text = table(&answered(&[(-1.0, -2.0), (-1.0, -2.0)]));
    let bug = "\nlikely bugs\n  a, mathematics: sign, sign of a; explains 2 of 2, first a-0\n";
    assert!(text.contains(bug), "{text}");
}

// Verifies: ORA-058, VEC-006.
#[test]
fn a_wrong_answer_has_a_class() {
    let one = json!({"a": 1.0, "b": 2.0});
    let bits = json!({"a": "0x3ff0000000000000", "b": "0x4000000000000000"});
    let cases = vec![
        json!({"ok": one, "bits": bits}),
        refusal(),
        json!({"error": "bad_argument", "lenient": {"a": 1.0}}),
        json!({"error": "bad_argument"}),
        json!({"error": "overflow", "flags": []}),
    ];
    let suite = Suite::of_files([group("a", cases)].into()).unwrap();
    for (case, answer, kind) in [
        (0, json!({"ok": {"a": 1, "b": 2, "more": 3}}), "right"),
        (0, json!({"ok": {"a": 1, "b": 3}}), "mathematics"),
        (0, json!({"ok": {"a": 1}}), "protocol"),
        (0, json!({"ok": {"a": "1", "b": 2}}), "protocol"),
        (0, json!({"ok": {"a": null, "b": 2}}), "range"),
        (0, json!({"ok": 1}), "protocol"),
        (0, json!({"error": {"code": "x"}}), "range"),
        (0, json!({"error": null}), "protocol"),
        (0, json!({}), "protocol"),
        (1, json!({"error": {"code": "x"}}), "right"),
        (1, json!({"error": "x"}), "acceptable"),
        (1, json!({"error": {}}), "acceptable"),
        (1, json!({"error": 1}), "protocol"),
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
            Outcome::Skipped(_) => "skipped",
        };
        assert_eq!(found, kind, "{case} {answer}");
    }
}

// Verifies: ORA-050.
#[test]
fn the_xml_counts_the_cases_that_it_holds() {
    let suite = two_groups();
    let outcomes = vec![
        vec![
            Outcome::Skipped(String::new()),
            Outcome::Right,
            Outcome::Acceptable("loose".into()),
        ],
        vec![
            Outcome::wrong(Class::Range, ""),
            Outcome::Right,
            Outcome::wrong(Class::Protocol, ""),
        ],
    ];
    let mut measure = measure("exact");
    measure.require = Require::Acceptable;
    measure.accepted = vec![super::Accepted {
        case: "b-2".into(),
        reason: "known <&>".into(),
    }];
    let verdict = Verdict::new(&suite, &measure, Program::default(), outcomes, vec![]);
    let xml = junit(&verdict, &suite);
    assert!(xml.contains("accepted, known &lt;&amp;&gt;"), "{xml}");
    let parts: Vec<&str> = xml.split("<testsuite ").collect();
    assert_eq!(parts.len(), 3);
    assert_eq!(parts[2].matches("<failure").count(), 1);
    for part in [&xml[..], parts[1], parts[2]] {
        for (key, element) in [
            ("tests", "<testcase"),
            ("failures", "<failure"),
            ("skipped", "<skipped"),
        ] {
            let expected = format!(" {key}=\"{}\"", part.matches(element).count());
            // The first mention is that of the whole, or of the group.
            let (_, counted) = part.split_once(&format!(" {key}=")).unwrap();
            let found = format!(" {key}={}", &counted[..3]);
            assert_eq!(found, expected, "{part}");
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
    for group in &suite.groups {
        for case in &group.cases {
            let line = case.line(&group.op);
            assert!(
                line.len() <= 65_536 && line.matches('\n').count() == 1,
                "{}",
                case.id
            );
            if matches!(case.question, super::Question::Arguments(_)) {
                let value: Value = serde_json::from_str(&line).unwrap();
                // A map of serde_json is sorted, and written without spaces.
                assert_eq!(value.to_string() + "\n", line);
            }
        }
    }
    let one = suite
        .select(&Choice {
            case: vec!["theta_colored-004".into()],
            ..Choice::default()
        })
        .unwrap();
    let table = questions(&one, Form::Csv);
    let cell = |place: &str| {
        table
            .lines()
            .any(|row| row.starts_with(&format!("theta_colored-004,theta_colored,{place},")))
    };
    assert!(
        cell("covariance,0,1") && cell("residual,0,") && !cell("residual,,"),
        "{table}"
    );
}

// Verifies: ORA-064.
#[test]
fn a_table_leaves_out_what_needs_quotes() {
    let values = [
        json!("a_1"),
        json!(1.5),
        json!("a,b"),
        json!("a b"),
        json!("\""),
        json!([["a", 2]]),
        json!([["a b"]]),
        json!(null),
    ];
    let case = |value: &Value| json!({"error": "out_of_range", "args": {"x": value}});
    let cases = values.iter().map(case).collect();
    let suite = Suite::of_files([group("a", cases)].into()).unwrap();
    let table = super::columns::questions(&suite);
    let rows: Vec<&str> = table.lines().skip(1).collect();
    let right = "a-0,roc,x,,,a_1 a-1,roc,x,,,1.5 a-5,roc,x,0,0,a a-5,roc,x,0,1,2";
    assert_eq!(rows.join(" "), right);
}
