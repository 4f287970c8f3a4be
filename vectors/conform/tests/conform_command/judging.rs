//! Answers are right, acceptable or wrong, and the verdict says so.

use std::fs;

use serde_json::{Value, json};

use crate::program::*;

// Verifies: ORA-047, ORA-048.
#[test]
fn wrong_answers_name_their_bug() {
    for [case, ok, word, bug] in rows(
        r#"
        choice-002 | {"p_correct":0.15865525393145707,"more":1} | should be 0.8413447460685429 within 2 ulp | complement
        choice-002 | {"p_correct":0.5} | p_correct is 0.5 | none
        choice-003 | {"p_correct":0.2} | must be refused | negative
        "#,
    ) {
        let script = answering(case, &format!("\"ok\":{ok}"));
        let verdict = run("bug", &script, &[(case, word)]);
        assert_eq!(first_bug(&verdict), bug);
        if bug == "complement" {
            let bug =
                json!({"flag": bug, "bug": "the rate of wrong answers", "notes": "p for 1 - p"});
            let explanation =
                json!({"bugs": [bug], "explains": 1, "against": 0, "first_case": case});
            let diagnosis = json!([{"group": "choice", "class": "mathematics", "wrong": 1, "explanations": [explanation]}]);
            assert_eq!(verdict["diagnosis"], diagnosis);
        }
    }
}

// Verifies: ORA-046, ORA-067.
#[test]
fn a_profile_widens_the_tolerance_by_the_condition() {
    let mut file = vectors();
    // Φ(1) and a condition of 2: 2⁻⁵³·2 = 2.2e-16 beside 2 ulp, 2⁻²⁴·2 = 1.2e-7.
    file["cases"][1]["condition"] = json!({"p_correct": 2.0});
    write("profile/v", &file);
    let folder = folder_of("profile");
    let coarse = |text: &str| fs::write(folder.join("coarse.json"), text).unwrap();
    coarse(r#"{"name": "coarse", "unit_roundoff": 0.001, "smallest": 1e-3, "largest": 1e3}"#);
    for [profile, answer, code] in rows(
        "exact | 0.8413447460685433 | 1\n f64 | 0.8413447460685433 | 0\n f64 | 0.8413447460685436 | 1
         f32 | 0.8413448 | 0\n f32 | 0.8413449 | 1\n coarse.json | 0.8433 | 0\n coarse.json | 0.8434 | 1",
    ) {
        let script = answering("choice-002", &format!("\"ok\":{{\"p_correct\":{answer}}}"));
        let options = format!("--vectors v --profile {profile}");
        let found = conform_at(&folder, &options, &["sh", "-c", &script]);
        let found = found.status.code();
        assert_eq!(found, Some(code.parse().unwrap()), "{profile} {answer}");
    }
    for [text, words] in rows(
        r#"
        { | coarse.json, EOF
        {"name":"a","unit_roundoff":1,"smallest":0.1,"largest":9} | coarse.json, unit_roundoff = 1
        {"name":"a","unit_roundoff":0.1,"smallest":2,"largest":9} | coarse.json, smallest = 2
        {"name":"exact","unit_roundoff":0.1,"smallest":0.1,"largest":9} | coarse.json, name = "exact" is that of another profile
        "#,
    ) {
        coarse(text);
        fails(
            &conform_at(&folder, "--vectors v --profile coarse.json", &["true"]),
            2,
            words,
        );
    }
    let output = conform_at(&folder, "--vectors v --profile f16", &["true"]);
    fails(&output, 2, "a profile is exact, f64, f32 or a JSON file");
}

/// In a precision without numbers above 1 every value of these ops is extreme.
// Verifies: ORA-078.
#[test]
fn who_refuses_everything_fails_in_every_precision() {
    let folder = folder("refuses");
    let q31 = r#"{"name": "Q31", "unit_roundoff": 2.3e-10, "smallest": 1e-9, "largest": 1}"#;
    fs::write(folder.join("q31.json"), q31).expect("written");
    let refuses = refusing(r#""theta","noise_budget""#, "");
    let ours = format!("exec '{}' oracle", palpate());
    let options = "--profile q31.json --only theta --only noise_budget --format html";
    let asked = |script: &str| conform_at(&folder, options, &["sh", "-c", script]);
    let output = asked(&refuses);
    let words = "no value is right, so that nothing is shown of noise_budget, theta";
    fails(&output, 1, words);
    let page = stdout(&output);
    assert!(
        page.contains("vectors: failed") && page.contains(words),
        "{page}"
    );
    // Who answers rightly passes, though none of it counts.
    passes(&asked(&ours));
}

// Verifies: ORA-067.
#[test]
fn known_mistakes_are_accepted_with_their_reason_and_told_when_they_are_mended() {
    let folder = write("accept", &vectors());
    let script = answering("choice-002", r#""ok":{"p_correct":0.5}"#);
    let accept = |list: &str| {
        fs::write(folder.join("known"), list).unwrap();
        ask(&folder, "--accept known --format json", &script)
    };
    let output =
        accept("# of version 1\n\nchoice-002   a table of five digits\nchoice-001 once wrong\n");
    passes(&output);
    let verdict = json_of(&output);
    assert_eq!(verdict["findings"][0]["accepted"], "a table of five digits");
    assert_eq!(verdict["groups"][0]["accepted"], 1);
    assert_eq!(verdict["mended"], json!(["choice-001"]));
    for (list, word) in [
        ("choice-002", "known:1: choice-002 has no reason"),
        ("\nchoice-9 a", "known:2: no case \"choice-9\""),
        (
            "choice-002 a\nchoice-002 b",
            "known:2: choice-002 is listed twice",
        ),
    ] {
        fails(&accept(list), 2, word);
    }
}

// Verifies: ORA-040.
#[test]
fn cases_are_chosen_left_out_and_shown() {
    let folder = write("choice", &vectors());
    let oracle = [&palpate()[..], "oracle"];
    for (options, counts) in [
        ("", [4, 4, 0]),
        ("--case choice-002 --case choice-004", [2, 2, 0]),
        ("--skip choice-002", [4, 3, 1]),
    ] {
        let options = format!("--vectors . --format json {options}");
        let verdict = json_of(&conform_at(&folder, &options, &oracle));
        let found = ["cases", "right", "skipped"].map(|count| total(&verdict, count));
        assert_eq!(found, counts, "{options}");
    }
    let output = conform_at(&folder, "--vectors . --skip choice", &oracle);
    fails(&output, 1, "nothing checked");
    let output = conform_at(&folder, "--vectors . --case choice-002 --show", &[]);
    let expected = "choice-002: root 2\n{\"args\":{\"gamma\":1.4142135623730951},\"id\":\"choice-002\",\"op\":\"two_afc\"}\n\
                    p_correct = 0.8413447460685429 within 2 ulp\n";
    assert_eq!(stdout(&output), expected);
    for [words, word] in rows(
        "--case choice-009 --show | choice-009\n --skip choice-009 -- true | choice-009\n --show -- true | --case",
    ) {
        let output = conform_at(&folder, &format!("--vectors . {words}"), &[]);
        fails(&output, 2, word);
    }
}

// Verifies: ORA-043, ORA-058.
#[test]
fn loose_answers_are_told() {
    let folder = write("loose", &vectors());
    let right = r#""ok":{"p_correct":0.8413447460685429}"#;
    let banner =
        format!("*choice-002*) echo 'Octave 7'; echo '{{\"id\":\"choice-002\",{right}}}';;");
    let hello = format!("echo hello; {}", shell(""));
    let no_id = shell(&format!("*choice-002*) echo '{{{right}}}';;"));
    for (options, script, code, note) in [
        (
            "--lenient",
            &shell(&banner),
            0,
            "note: ignored, since it is no answer: Octave 7",
        ),
        ("--lenient", &hello, 0, "\n"),
        ("", &hello, 1, ""),
        ("--require right", &no_id, 1, ""),
        ("--require acceptable", &no_id, 0, "choice-002"),
    ] {
        let output = ask(&folder, options, script);
        assert_eq!(output.status.code(), Some(code), "{output:?}");
        assert!(stdout(&output).contains(note), "{}", stdout(&output));
    }
}

// Verifies: ORA-048, ORA-050.
#[test]
fn the_page_says_what_was_judged_and_stands_alone() {
    let folder = write("page", &vectors());
    fs::write(folder.join("known"), "choice-003 <b>later</b>\n").unwrap();
    fs::write(folder.join("program"), answering("choice-003", "\"ok\":{}")).unwrap();
    let page = |format: &str| {
        let options = format!("--vectors . --accept known --format {format}");
        conform_at(&folder, &options, &["sh", "program"])
    };
    let (html, verdict) = (page("html"), json_of(&page("json")));
    passes(&html);
    let text = stdout(&html);
    let files = verdict["program"]["files"].as_array().unwrap();
    assert_eq!(files.len(), 2, "the shell, and the file that it reads");
    let sums = files.iter().map(|file| &file["sha256"]);
    let sums = sums.chain([&verdict["suite_sha256"]]);
    // Numbers are set to the right, words and cells of nothing are not.
    let words = [
        "<td>choice-003</td>",
        "<td class=\"n\">1</td>",
        "&lt;b&gt;later&lt;/b&gt;",
        "passed",
        "Signature",
        "Every answer is right; extreme cases do not count",
    ];
    for word in sums.filter_map(Value::as_str).chain(words) {
        assert!(text.contains(word), "{word} is not in {text}");
    }
    assert!(!text.contains("<b>") && !text.contains("src=") && !text.contains("href="));
}

// Verifies: ORA-050.
#[test]
fn the_verdict_for_ci_holds_every_case_and_is_the_same_each_time() {
    let folder = write("junit", &vectors());
    let script = answering("choice-003", r#""ok":{"p_correct":"<&>"}"#);
    let [output, again] = [0; 2].map(|_| ask(&folder, "--format junit", &script));
    assert_eq!(output.status.code(), Some(1));
    let text = stdout(&output);
    assert_eq!(text, stdout(&again));
    assert!(text.starts_with("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites name=\"palpate-conform, profile exact, vectors "));
    for (part, count) in [
        (
            r#"<testsuite name="choice" tests="4" failures="1" errors="0" skipped="0">"#,
            1,
        ),
        ("<testcase ", 4),
        ("<failure ", 1),
        (
            "name=\"choice-003: below 0 &lt;&amp;&gt;\"><failure type=\"range\" message=\"answered {&quot;p_correct&quot;:&quot;&lt;&amp;&gt;&quot;}",
            1,
        ),
    ] {
        assert_eq!(text.matches(part).count(), count, "{part}: {text}");
    }
}
