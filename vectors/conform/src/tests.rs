use serde_json::json;

use super::junit::{escaped, junit};
use super::tolerance::{Tolerance, compare, cut};
use super::{Outcome, Suite, Verdict};

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
        let accepts = tolerance.accepts(expected, found, 1.0);
        assert_eq!(accepts, accepted, "{tolerance:?} {expected} {found}");
    }
    assert!(Tolerance::Ulp(1.0).accepts(1.0, one_up.next_up(), 10.0));
}

// Verifies: ORA-046.
#[test]
fn a_difference_names_its_place() {
    let tolerance = Tolerance::Exact;
    let compare = |expected, found| compare("k", &expected, &found, tolerance, 1.0);
    let same = compare(json!([[1, 2.0], [3]]), json!([[1.0, 2], [3]]));
    assert_eq!(same, Ok(()));
    let cases = r#"
        [[1,2],[3]] [[1,2],[4]] k[1][0] is 4, expected 3
        [1,2] [1] k has 1 entries, expected 2
        [1,2] [1,"2"] k[1] is "2", expected 2
        "0xff" "0xFF" k is "0xFF", expected "0xff"
        true 1 k is 1, expected true
        1 null k is null, expected 1
    "#;
    for case in cases.trim().lines() {
        let parts: Vec<&str> = case.trim().splitn(4, ' ').collect();
        let [expected, found] =
            [parts[0], parts[1]].map(|json| serde_json::from_str(json).unwrap());
        let difference = compare(expected, found).unwrap_err();
        assert_eq!(difference.place, parts[2]);
        assert!(difference.text.starts_with(parts[3]), "{difference}");
    }
}

/// Two groups of three questions that must be refused, each with two flags.
fn two_groups() -> Suite {
    let file = |group: &str| {
        let case = |k: u32| {
            let (id, flags) = (format!("{group}-{k}"), ["sign", "unit"]);
            json!({"id": id, "comment": "", "args": {}, "error": "out_of_range", "flags": flags})
        };
        let bug = |what: &str| json!({"bug": format!("{what} of {group}"), "notes": ""});
        json!({
            "schema": "palpate-vectors", "schema_version": 1, "group": group, "op": "roc",
            "source": "by hand", "generator_version": "1", "tolerance": {},
            "flags": {"sign": bug("sign"), "unit": bug("unit")}, "cases": [case(0), case(1), case(2)],
        })
    };
    let groups = ["a", "b"].map(|group| (format!("{group}.json"), file(group).to_string()));
    Suite::of_files(groups.into()).unwrap()
}

fn failed(bugs: &[&str]) -> Outcome {
    Outcome::Failed {
        reason: String::new(),
        bugs: bugs.iter().map(|bug| bug.to_string()).collect(),
    }
}

// Verifies: ORA-053.
#[test]
fn bugs_are_counted_by_group_and_the_most_frequent_comes_first() {
    let [sign, unit, both] = [&["sign"][..], &["unit"], &["unit", "sign"]].map(failed);
    let outcomes = vec![
        vec![unit.clone(), sign, Outcome::Refused],
        vec![unit.clone(), both, unit],
    ];
    let verdict = Verdict::new(&two_groups(), vec![], String::new(), outcomes, vec![]);
    let likely = verdict.likely_bugs.iter();
    let found = likely.map(|l| format!("{}: {}, {}", l.bug, l.cases, l.first_case));
    let expected = [
        "unit of b: 3, b-0",
        "unit of a: 1, a-0",
        "sign of a: 1, a-1",
        "sign of b: 1, b-1",
    ];
    assert_eq!(found.collect::<Vec<_>>(), expected);
}

// Verifies: ORA-050.
#[test]
fn the_xml_counts_the_cases_that_it_holds() {
    let suite = two_groups();
    let outcomes = vec![
        vec![Outcome::Skipped, Outcome::Skipped, Outcome::Skipped],
        vec![failed(&["unit"]), Outcome::Refused, failed(&[])],
    ];
    let verdict = Verdict::new(&suite, vec![], String::new(), outcomes, vec![]);
    let xml = junit(&verdict, &suite);
    let parts: Vec<&str> = xml.split("<testsuite ").collect();
    assert_eq!(parts.len(), 3);
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
